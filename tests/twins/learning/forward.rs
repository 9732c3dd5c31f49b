//! `forward`.

use super::*;
use footwork::kernels::forward;

#[test]
fn forward_agrees() {
    for case in Case::all() {
        let layers = (0..case.plan.head.count - 1).step_by(2);
        let both = layers.clone().map(|first| (first, 2));
        let alone = layers.flat_map(|first| [(first, 1), (first + 1, 1)]);
        for (first, count) in both.chain(alone) {
            let params = forward::Params { first, count };
            let mut twin = case.rows.clone();
            forward::twin(&case.plan, &case.parameters, &mut twin, &params);
            assert_ne!(twin, case.rows);
            let (table, parameters) = (up(&case.table), up(&case.parameters));
            let rows = up(&case.rows);
            let planned = (&case.plan, &table);
            forward::launch(&gpu(), planned, &parameters, &rows, &params);
            let buffers: [&[u8]; 3] = [
                cast_slice(&case.table),
                cast_slice(&case.parameters),
                cast_slice(&case.rows),
            ];
            let groups = forward::groups(&case.plan, &params);
            let outcome = checked::run(&shader::FORWARD, groups, &buffers, &params);
            near("launch", case.used(&down(&rows)), case.used(&twin));
            near("checked", case.used(&outcome.of(2)), case.used(&twin));
        }
    }
}

/// What is too large for the exponential, and what is no number.
#[test]
fn sums_of_any_size_are_bent() {
    let mut case = Case::new(&[32, 32], 9);
    let places = &case.plan.places[0];
    for (output, bias) in [1e30, -1e30, f32::INFINITY, 20.0, -20.0, 0.0]
        .into_iter()
        .enumerate()
    {
        case.parameters[(places.weights + places.inputs * places.outputs) as usize + output] = bias;
    }
    let params = forward::Params { first: 0, count: 2 };
    let mut twin = case.rows.clone();
    forward::twin(&case.plan, &case.parameters, &mut twin, &params);
    let (table, rows) = (up(&case.table), up(&case.rows));
    let planned = (&case.plan, &table);
    forward::launch(&gpu(), planned, &up(&case.parameters), &rows, &params);
    near("launch", case.used(&down(&rows)), case.used(&twin));
    assert_eq!(twin[GOAL..][..3], [1.0, -1.0, 1.0]);
}
