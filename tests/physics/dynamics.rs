//! Kinematics, mass matrix, bias, accelerations and flights without contact, against MuJoCo and against
//! the laws of mechanics.

use crate::golden::{Golden, quantile, relative};
use footwork::physics::collision::DetectedContacts;
use footwork::physics::factor::columns;
use footwork::physics::humanoid::humanoid;
use footwork::physics::model::Model;
use footwork::physics::simulator::{Simulator, SimulatorState, SolverOptions};
use footwork::physics::spatial::Spatial;
use glam::Vec3;
use std::sync::Arc;

/// Without anything to touch.
fn floating() -> Arc<Model> {
    let mut model = humanoid();
    model.pairs.clear();
    for joint in &mut model.joints {
        joint.range = None;
    }
    Arc::new(model)
}

fn times(model: &Model, matrix: &[f32], vector: &[f32]) -> Vec<f32> {
    let columns = columns(model);
    let mut product = vec![0.0; vector.len()];
    for (row, dof) in model.dofs.iter().enumerate() {
        for k in 0..dof.depth {
            let (entry, column) = (matrix[dof.row + k], columns[dof.row + k]);
            product[row] += entry * vector[column];
            if column != row {
                product[column] += entry * vector[row];
            }
        }
    }
    product
}

#[test]
fn agrees_with_mujoco_in_a_thousand_states() {
    let model = floating();
    let (nq, nv, driven) = (model.nq(), model.nv(), model.nu());
    let bodies = model.bodies.len();
    let mut simulator = Simulator::new(model.clone(), SolverOptions::fast(&model));
    let mut state = SimulatorState::new(&model);
    let golden = Golden::open("dynamics.f32", nq + nv + driven + nv + 3 * bodies + 3 * nv);
    let mut worst = [0.0f32; 4];
    let mut accelerations = Vec::new();
    for mut row in golden.rows() {
        state.q.copy_from_slice(row.take(nq));
        state.v.copy_from_slice(row.take(nv));
        let targets = row.take(driven);
        let probe = row.take(nv);
        simulator.forward(&state, targets, &[]);
        let places = row.take(3 * bodies);
        for (pose, position) in simulator.poses.iter().zip(places.chunks_exact(3)) {
            worst[0] = worst[0].max((pose.position - Vec3::from_slice(position)).length());
        }
        let moved = times(&model, &simulator.mass_matrix, probe);
        worst[1] = worst[1].max(relative(&moved, row.take(nv)));
        worst[2] = worst[2].max(relative(&simulator.bias, row.take(nv)));
        let off = relative(simulator.qacc(), row.take(nv));
        worst[3] = worst[3].max(off);
        accelerations.push(off);
    }
    println!(
        "places {:.1e} m, mass matrix {:.1e}, bias {:.1e}, acceleration {:.1e} (median {:.1e})",
        worst[0],
        worst[1],
        worst[2],
        worst[3],
        quantile(&accelerations, 0.5)
    );
    assert!(worst[0] <= 1e-6, "places: {:e} m", worst[0]);
    assert!(worst[1] <= 1e-5, "mass matrix: {:e}", worst[1]);
    assert!(worst[2] <= 1e-5, "bias: {:e}", worst[2]);
    assert!(worst[3] <= 1e-5, "acceleration: {:e}", worst[3]);
}

#[test]
fn flies_as_in_mujoco() {
    let model = floating();
    let (nq, nv, driven) = (model.nq(), model.nv(), model.nu());
    let mut simulator = Simulator::new(model.clone(), SolverOptions::fast(&model));
    let mut state = SimulatorState::new(&model);
    let golden = Golden::open("trajectories.f32", 2 * (nq + nv) + driven);
    let mut worst = 0.0f32;
    for mut row in golden.rows() {
        state.q.copy_from_slice(row.take(nq));
        state.v.copy_from_slice(row.take(nv));
        let targets = row.take(driven);
        for _ in 0..60 {
            simulator.step(&mut state, targets, &[]);
        }
        for (found, wanted) in state.q.iter().zip(row.take(nq)) {
            worst = worst.max((found - wanted).abs());
        }
    }
    println!("after half a second: {worst:.1e} rad or m");
    // Of a quaternion's parts half an angle; of places the same in metres.
    assert!(worst <= 5e-5, "{worst:e}");
}

/// Free of weight: momentum and energy of all bodies.
fn momentum(simulator: &Simulator, q: &[f32]) -> (Vec3, Vec3, f32) {
    let (mut linear, mut angular, mut energy) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for (index, body) in simulator.model.bodies.iter().enumerate() {
        let origin = Vec3::from_slice(q);
        let centre = simulator.poses[index].at(body.com);
        let velocity = simulator.velocities[index].at(centre - origin);
        let rotation = glam::Mat3::from_quat(simulator.poses[index].rotation);
        let inertia = rotation * body.inertia * rotation.transpose();
        let spin = simulator.velocities[index].angular;
        linear += velocity * body.mass;
        angular += inertia * spin + centre.cross(velocity * body.mass);
        energy += 0.5 * (body.mass * velocity.length_squared() + spin.dot(inertia * spin));
    }
    (linear, angular, energy)
}

/// A body that tumbles without weight, drives and contacts: its momentum and energy at the start, and
/// how far they drift within a second, as parts of what they were.
fn drift(dt: f32) -> [Vec3; 3] {
    let mut model = humanoid();
    model.pairs.clear();
    for joint in &mut model.joints {
        joint.range = None;
    }
    for dof in &mut model.dofs {
        dof.drive = None;
        dof.armature = 0.0;
    }
    let model = Arc::new(model);
    let settings = SolverOptions {
        dt,
        ..SolverOptions::fast(&model)
    };
    let mut simulator = Simulator::new(model.clone(), settings);
    let mut state = SimulatorState::new(&model);
    for (index, v) in state.v.iter_mut().enumerate() {
        *v = ((index * 7 + 3) % 11) as f32 * 0.1 - 0.5;
    }
    // Pushed up as much as it weighs, it floats.
    let lifts: Vec<Spatial> = model
        .bodies
        .iter()
        .map(|body| Spatial {
            angular: Vec3::ZERO,
            linear: Vec3::Z * (body.mass * 9.81),
        })
        .collect();
    simulator.forward(&state, &[], &lifts);
    let start = momentum(&simulator, &state.q);
    for _ in 0..(1.0 / dt).round() as usize {
        simulator.step(&mut state, &[], &lifts);
    }
    simulator.forward(&state, &[], &lifts);
    let end = momentum(&simulator, &state.q);
    assert_eq!(
        simulator.contacts.points.len(),
        DetectedContacts::default().points.len()
    );
    [
        (end.0 - start.0) / start.0.length(),
        (end.1 - start.1) / start.1.length(),
        Vec3::X * ((end.2 - start.2) / start.2),
    ]
}

/// What drifts is the integrator's error, MuJoCo's too, of the first order: a quarter of the step, a quarter
/// of the drift, and nothing left at no step at all, to which the two are extrapolated.
#[test]
fn momentum_and_energy_drift_with_the_step() {
    let [coarse, fine] = [1.0 / 120.0, 1.0 / 480.0].map(drift);
    for (what, (coarse, fine)) in ["momentum", "angular momentum", "energy"]
        .into_iter()
        .zip(coarse.into_iter().zip(fine))
    {
        let limit = (4.0 * fine - coarse).length() / 3.0;
        let (coarse, fine) = (coarse.length(), fine.length());
        println!(
            "{what} drifts by {coarse:.1e} a second at 120 Hz, {fine:.1e} at 480 Hz, {limit:.1e} in the limit"
        );
        assert!((3.5..4.5).contains(&(coarse / fine)), "{what}");
        assert!(limit <= 1e-5, "{what}");
    }
    let [linear, ..] = drift(1.0 / 15360.0);
    assert!(linear.length() <= 1e-5, "momentum at 15 kHz: {linear}");
}
