//! `backward`.

use super::*;
use footwork::kernels::backward;

#[test]
fn backward_agrees() {
    for case in Case::all() {
        let turned = case.turned();
        for first in (2..case.plan.head.count - 1).step_by(2) {
            let params = backward::Params { first };
            let mut twin = case.slopes.clone();
            backward::twin(&case.plan, &turned, &case.rows, &mut twin, &params);
            assert_ne!(twin, case.slopes);
            let (table, slopes) = (up(&case.table), up(&case.slopes));
            let planned = (&case.plan, &table);
            backward::launch(
                &gpu(),
                planned,
                &up(&turned),
                &up(&case.rows),
                &slopes,
                &params,
            );
            let buffers: [&[u8]; 4] = [
                cast_slice(&case.table),
                cast_slice(&turned),
                cast_slice(&case.rows),
                cast_slice(&case.slopes),
            ];
            let groups = backward::groups(&case.plan, &params);
            let outcome = checked::run(&shader::BACKWARD, groups, &buffers, &params);
            near("launch", case.used(&down(&slopes)), case.used(&twin));
            near("checked", case.used(&outcome.of(3)), case.used(&twin));
        }
    }
}
