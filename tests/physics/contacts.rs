//! Accelerations and forces with contacts and joint limits, against MuJoCo's converged solver.

use crate::golden::{Golden, quantile, relative};
use footwork::physics::humanoid::humanoid;
use footwork::physics::simulator::{Simulator, SimulatorState, SolverOptions};
use std::sync::Arc;

#[test]
fn agrees_with_mujoco_in_a_thousand_states() {
    let model = Arc::new(humanoid());
    let (nq, nv, driven) = (model.nq(), model.nv(), model.nu());
    let bodies = model.bodies.len();
    let settings = SolverOptions {
        max_contacts: 64,
        ..SolverOptions::converged(&model)
    };
    let mut simulator = Simulator::new(model.clone(), settings);
    let mut state = SimulatorState::new(&model);
    let golden = Golden::open("contacts.f32", nq + nv + driven + 2 + nv + 3 * bodies);
    let (mut accelerations, mut forces) = (Vec::new(), Vec::new());
    let mut miscounted = 0;
    for mut row in golden.rows() {
        state.q.copy_from_slice(row.take(nq));
        state.v.copy_from_slice(row.take(nv));
        let targets = row.take(driven);
        let counts = row.take(2).to_vec();
        simulator.forward(&state, targets, &[]);
        let found = [
            simulator.contact_constraints.len(),
            simulator.limit_constraints.len(),
        ]
        .map(|n| n as f32);
        if found != counts[..] {
            miscounted += 1;
        }
        accelerations.push(relative(simulator.qacc(), row.take(nv)));
        let net: Vec<f32> = simulator
            .body_forces()
            .iter()
            .flat_map(|f| f.to_array())
            .collect();
        forces.push(relative(&net, row.take(3 * bodies)));
    }
    let of = |values: &[f32]| {
        [0.5, 0.99, 1.0]
            .map(|part| format!("{:.1e}", quantile(values, part)))
            .join(", ")
    };
    println!(
        "acceleration: median, 99 %, worst {}; net forces {}; other counts in {miscounted} of 1000",
        of(&accelerations),
        of(&forces)
    );
    assert!(quantile(&accelerations, 0.5) <= 1e-4);
    assert!(quantile(&accelerations, 0.99) <= 1e-2);
    assert!(quantile(&forces, 0.5) <= 1e-3);
}
