//! `backward`.

use super::*;
use footwork::kernels::learn::backward;
use footwork::kernels::learn::network::BLOCK;

#[test]
fn backward_agrees() {
    for case in Case::all() {
        let turned = case.turned();
        let params = backward::Params {
            rows: case.plan.head.rows,
        };
        let mut twin = case.slopes.clone();
        backward::twin(&case.plan, &turned, &case.rows, &mut twin, &params);
        assert_ne!(twin, case.slopes);
        let (table, rows, slopes) = (up(&case.table), up(&case.rows), up(&case.slopes));
        backward::launch(&gpu(), &table, &up(&turned), &rows, &slopes, &params);
        let buffers: [&[u8]; 4] = [
            cast_slice(&case.table),
            cast_slice(&turned),
            cast_slice(&case.rows),
            cast_slice(&case.slopes),
        ];
        let groups = [case.rows().div_ceil(BLOCK) as u32, 1, 2];
        let outcome = checked::run(&shader::BACKWARD, groups, &buffers, &params);
        near("launch", &down(&slopes), &twin);
        near("checked", &outcome.of(3), &twin);
    }
}
