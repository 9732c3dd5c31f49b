//! What any engine must do: a box rests, slides and tips as mechanics says; two characters push each
//! other with one force; what starts mirrored stays mirrored; what is not a number harms nobody else.

use footwork::env::humanoid::batch::{self, SimulatorBatchConfig};
use footwork::gpu::Device;
use footwork::physics::humanoid::humanoid;
use footwork::physics::kinematics::quaternion;
use footwork::physics::mjcf;
use footwork::physics::model::{JointKind, Model};
use footwork::physics::scenes;
use footwork::physics::simulator::{SUBSTEPS, Simulator, SimulatorState, SolverOptions};
use footwork::physics::spatial::Spatial;
use glam::{Quat, Vec3};
use std::path::Path;
use std::sync::Arc;

const HALF: Vec3 = Vec3::new(0.2, 0.2, 0.9);

/// The free box alone on the ground.
struct Block {
    simulator: Simulator,
    state: SimulatorState,
}

impl Block {
    fn new() -> Block {
        let model = Arc::new(scenes::punching_box());
        let settings = SolverOptions::fast(&model);
        let mut state = SimulatorState::new(&model);
        state.q[2] = HALF.z;
        Block {
            simulator: Simulator::new(model, settings),
            state,
        }
    }

    /// Leaning about the edge at x = 0.2, that edge on the ground.
    fn leaning(angle: f32) -> Block {
        let mut block = Block::new();
        let rotation = Quat::from_rotation_y(angle);
        let edge = Vec3::new(HALF.x, 0.0, -HALF.z);
        let position = Vec3::new(HALF.x, 0.0, 0.0) - rotation * edge;
        block.state.q[..3].copy_from_slice(&position.to_array());
        block.state.q[3..7].copy_from_slice(&[rotation.w, rotation.x, rotation.y, rotation.z]);
        block
    }

    /// Pushed along x at the height of the ground, so that nothing tips it.
    fn play(&mut self, seconds: f32, force: f32) {
        let push = Spatial {
            angular: Vec3::new(0.0, -HALF.z * force, 0.0),
            linear: Vec3::X * force,
        };
        for _ in 0..(seconds * 120.0) as usize {
            self.simulator.step(&mut self.state, &[], &[push]);
        }
    }

    fn position(&self) -> Vec3 {
        Vec3::from_slice(&self.state.q)
    }

    fn up(&self) -> f32 {
        (quaternion(&self.state.q[3..]) * Vec3::Z).z
    }
}

#[test]
fn a_box_rests_within_a_millimetre() {
    let mut block = Block::new();
    block.play(5.0, 0.0);
    let off = block.position() - Vec3::new(0.0, 0.0, HALF.z);
    println!("resting for 5 s it moved by {:.3} mm", off.length() * 1e3);
    assert!(off.length() < 1e-3, "{off}");
    assert!(block.state.v.iter().all(|v| v.abs() < 1e-3));
}

#[test]
fn a_box_tips_beyond_its_corner() {
    let edge = (HALF.x / HALF.z).atan();
    for (lean, falls) in [(0.97, false), (1.03, true)] {
        let mut block = Block::leaning(edge * lean);
        block.play(4.0, 0.0);
        let fallen = block.up() < 0.5;
        assert_eq!(
            fallen,
            falls,
            "leaning {lean} of the way, up is {}",
            block.up()
        );
    }
}

#[test]
fn a_box_slides_at_the_friction_coefficient() {
    let weight = 8.64 * 9.81;
    let mut block = Block::new();
    block.play(1.0, 0.0);
    let before = block.position().x;
    block.play(1.0, 0.95 * weight);
    let crept = block.position().x - before;
    println!("below the limit it creeps {:.2} mm/s", crept * 1e3);
    // Soft friction creeps, as MuJoCo's does: by a hundredth of what a box without it would slide.
    assert!(crept.abs() < 15e-3, "{crept}");
    let mut block = Block::new();
    block.play(1.0, 0.0);
    let before = block.position().x;
    block.play(1.0, 1.2 * weight);
    // What is left of the push accelerates it: s = a t^2 / 2.
    let wanted = 0.5 * 0.2 * 9.81;
    let slid = block.position().x - before;
    println!("above it slides {slid:.3} m, by mechanics {wanted:.3} m");
    assert!(
        (slid / wanted - 1.0).abs() < 0.05,
        "{slid} m instead of {wanted} m"
    );
}

/// Two humanoids that stand so near that they touch, the second turned to the first.
fn facing() -> (Arc<Model>, SimulatorState) {
    let model = Arc::new(scenes::boxing_match());
    let mut state = SimulatorState::new(&model);
    let half = model.nq() / 2;
    state.q[0] = -0.12;
    state.q[half] = 0.12;
    (model, state)
}

/// Half a turn about the vertical.
fn turned(model: &Model, state: &SimulatorState) -> Vec<f32> {
    let half_turn = Quat::from_rotation_z(std::f32::consts::PI);
    let half = model.nq() / 2;
    let mut q = state.q[half..].to_vec();
    let position = half_turn * Vec3::from_slice(&q);
    let rotation = half_turn * quaternion(&q[3..]);
    q[..3].copy_from_slice(&position.to_array());
    q[3..7].copy_from_slice(&[rotation.w, rotation.x, rotation.y, rotation.z]);
    q
}

#[test]
fn mirrored_characters_move_mirrored_and_push_alike() {
    let (model, mut state) = facing();
    let mut simulator = Simulator::new(model.clone(), SolverOptions::converged(&model));
    let driven = model.nu() / 2;
    let swing: Vec<f32> = (0..driven)
        .map(|k| ((k * 5 + 2) % 7) as f32 * 0.1 - 0.3)
        .collect();
    let targets = [&swing[..], &swing].concat();
    let (half, mut met, mut worst) = (model.nq() / 2, 0, 0.0f32);
    for _ in 0..36 {
        simulator.step(&mut state, &targets, &[]);
        // By the laws of action and reaction, what the ground does not hold cancels.
        let mut ground = Vec3::ZERO;
        for (force, &key) in simulator.contact_forces().zip(&simulator.contacts.ids) {
            let [first, second] =
                model.pairs[(key / 8) as usize].map(|geom| model.geoms[geom].body);
            match first {
                None => ground += force,
                Some(first) => {
                    let tree = |body: usize| model.bodies[body].tree;
                    met += usize::from(second.is_some_and(|second| tree(first) != tree(second)));
                }
            }
        }
        let net: Vec3 = simulator.body_forces().into_iter().sum();
        let scale = ground.length().max(1.0);
        assert!(
            (net - ground).length() <= 1e-4 * scale,
            "{net} and {ground}"
        );
        let mirrored = turned(&model, &state);
        let dot: f32 = (3..7).map(|k| mirrored[k] * state.q[k]).sum();
        for (index, (one, other)) in state.q[..half].iter().zip(&mirrored).enumerate() {
            // A quaternion and its opposite are one turn.
            let sign = if (3..7).contains(&index) {
                dot.signum()
            } else {
                1.0
            };
            worst = worst.max((one - sign * other).abs());
        }
    }
    println!("{met} contacts between them; mirrored within {worst:.1e}");
    assert!(met > 20, "they met {met} times");
    assert!(worst <= 1e-4, "{worst:e}");
}

fn config(envs: usize) -> SimulatorBatchConfig {
    let model = Arc::new(humanoid());
    SimulatorBatchConfig {
        options: SolverOptions::fast(&model),
        envs,
        seed: 3,
        force_pairs: Vec::new(),
        model,
    }
}

fn devices() -> [(&'static str, Device); 2] {
    let lavapipe = footwork::gpu::Gpu::lavapipe().unwrap_or_else(|error| panic!("{error}"));
    [("cpu", Device::Cpu), ("lavapipe", lavapipe.into())]
}

/// A batch's states after some actions, world 5 being told nonsense in one of them.
fn played(device: &Device, nonsense: f32) -> (Vec<f32>, u64) {
    let config = config(8);
    let mut worlds = batch::open(device, &config).expect("it fits");
    let mut targets = vec![0.1; config.model.nu() * 8];
    for action in 0..6 {
        targets[3 * 8 + 5] = if action == 3 { nonsense } else { 0.1 };
        worlds.set_targets(&targets);
        worlds.step();
    }
    let diverged = worlds.counters().expect("counters").diverged;
    (worlds.state().expect("state"), diverged)
}

#[test]
fn a_nan_action_restarts_its_world_alone() {
    for (name, device) in devices() {
        let (sound, none) = played(&device, 0.1);
        assert_eq!(none, 0, "{name}");
        for nonsense in [f32::NAN, f32::INFINITY] {
            let (state, diverged) = played(&device, nonsense);
            assert_eq!(diverged, 1, "{name}, {nonsense}");
            for (position, (found, wanted)) in state.iter().zip(&sound).enumerate() {
                assert!(found.is_finite(), "{name}");
                assert!(
                    position % 8 == 5 || found == wanted,
                    "{name}: world {}",
                    position % 8
                );
            }
        }
    }
}

#[test]
fn equal_runs_end_equal_and_devices_agree_at_first() {
    let mut ends = Vec::new();
    for (name, device) in devices() {
        let run = || {
            let mut worlds = batch::open(&device, &config(16)).expect("it fits");
            let mut early = Vec::new();
            for action in 0..20 {
                worlds.draw_targets(0.5);
                worlds.step();
                if action == 2 {
                    early = worlds.state().expect("state");
                }
            }
            (early, worlds.state().expect("state"))
        };
        let (first, second) = (run(), run());
        assert_eq!(first.1, second.1, "{name}");
        ends.push(first.0);
    }
    let worst = ends[0]
        .iter()
        .zip(&ends[1])
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max);
    println!(
        "after {} steps the devices differ by {worst:.1e}",
        3 * SUBSTEPS
    );
    assert!(worst < 1e-2, "{worst}");
}

#[test]
fn a_push_moves_a_body_and_a_restart_takes_it_back() {
    for (name, device) in devices() {
        let config = config(4);
        let model = &config.model;
        assert_eq!(model.joints[0].kind, JointKind::Free);
        let mut worlds = batch::open(&device, &config).expect("it fits");
        let mut external_forces = vec![0.0; 6 * model.bodies.len() * 4];
        // The root of world 2, along y.
        external_forces[4 * 4 + 2] = 400.0;
        worlds.set_external_forces(&external_forces);
        worlds.step();
        let at = |state: &[f32], field: usize, env: usize| state[field * 4 + env];
        let state = worlds.state().expect("state");
        assert!(at(&state, 1, 2) > at(&state, 1, 1) + 1e-3, "{name}");
        let starts = config.starts();
        worlds.reset(&[0, 0, 1, 0], &starts);
        let state = worlds.state().expect("state");
        for field in 0..state.len() / 4 {
            assert_eq!(
                at(&state, field, 2),
                at(&starts, field, 2),
                "{name}, field {field}"
            );
        }
        assert!(
            at(&state, 2, 1) != at(&starts, 2, 1),
            "{name}: the others go on"
        );
    }
}

#[test]
fn contact_with_what_cannot_be_moved_breaks_nothing() {
    // A wheel whose axle is fastened, pressed into the ground: nothing can push it out.
    let wheel = r#"<mujoco model="wheel"><worldbody>
        <geom name="ground" type="plane" size="0 0 1"/>
        <body name="wheel" pos="0 0 .09">
          <joint name="axle" axis="0 1 0"/><geom name="wheel" size=".1"/>
        </body>
      </worldbody></mujoco>"#;
    let model = Arc::new(mjcf::parse(wheel, Path::new("wheel.xml")).expect("a model"));
    let mut simulator = Simulator::new(model.clone(), SolverOptions::fast(&model));
    let mut state = SimulatorState::new(&model);
    state.v[0] = 3.0;
    for _ in 0..120 {
        simulator.step(&mut state, &[], &[]);
        assert_eq!(simulator.contacts.ids.len(), 1);
        assert!(
            state.q[0].is_finite() && state.v[0].abs() <= 3.0,
            "{state:?}"
        );
    }
}
