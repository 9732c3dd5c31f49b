//! `gradient`.

use super::*;
use footwork::kernels::learn::gradient;

#[test]
fn gradient_agrees() {
    for case in Case::all() {
        let params = gradient::Params {
            parameters: case.plan.head.parameters,
        };
        let numbers = params.parameters as usize + SUMS;
        let poison = vec![POISON; case.plan.head.pieces as usize * numbers];
        let mut twin = poison.clone();
        gradient::twin(&case.plan, &case.rows, &case.slopes, &mut twin, &params);
        let (table, partials) = (up(&case.table), up(&poison));
        let (rows, slopes) = (up(&case.rows), up(&case.slopes));
        let planned = (&case.plan, &table);
        gradient::launch(&gpu(), planned, &rows, &slopes, &partials, &params);
        let buffers: [&[u8]; 4] = [
            cast_slice(&case.table),
            cast_slice(&case.rows),
            cast_slice(&case.slopes),
            cast_slice(&poison),
        ];
        let groups = gradient::groups(&case.plan);
        let outcome = checked::run(&shader::GRADIENT, groups, &buffers, &params);
        assert!(twin.iter().all(|&value| value != POISON), "all is written");
        near("launch", &down(&partials), &twin);
        near("checked", &outcome.of::<f32>(3), &twin);
    }
}
