//! `take`.

use super::*;
use footwork::gpu::kernel::groups;
use footwork::kernels::take;

#[test]
fn take_agrees() {
    for case in Case::all() {
        let params = take::Params {
            rows: case.plan.head.rows,
            start: case.start,
            width: WIDTH as u32,
        };
        let poison = vec![POISON; case.rows.len()];
        let mut twin = poison.clone();
        take::twin(&case.plan, &case.samples, &mut twin, &params);
        let rows = up(&poison);
        take::launch(&gpu(), &up(&case.table), &up(&case.samples), &rows, &params);
        let buffers: [&[u8]; 3] = [
            cast_slice(&case.table),
            cast_slice(&case.samples),
            cast_slice(&poison),
        ];
        let groups = groups(&shader::TAKE, case.rows() * GOAL);
        let outcome = checked::run(&shader::TAKE, groups, &buffers, &params);
        assert_eq!(down(&rows), twin);
        assert_eq!(outcome.of::<f32>(2), twin);
        let taken = twin.iter().filter(|&&value| value != POISON).count();
        assert_eq!(taken, case.rows() * GOAL);
        let first = case.start as usize * WIDTH;
        assert_eq!(twin[..GOAL], case.samples[first..][..GOAL]);
    }
}
