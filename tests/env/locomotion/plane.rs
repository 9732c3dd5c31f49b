//! A thousand steps of 256 worlds under the same actions, on the GPU against the CPU.
//! Oracle: `CpuWorld`, which runs the twins.
//! Bar: frames, ages and counts equal; headings within a rounding or two a step of the episode,
//! places within that angle times the path walked. An environment may go another way only after
//! a proven tie: an arrival decided within that bar of reach, or two rows as near in f64 as f32
//! can tell.

use crate::inputs::{Draw, gpu};
use crate::oracle::Oracle;
use crate::paper::DATABASE;
use burn::tensor::Device as Tensors;
use footwork::gpu::Device;
use footwork::kernels::locomotion::locomotion_layout::{BASE_OBS_DIM, state_f32, state_u32};
use footwork::motion::features::{FEATURE_DIM, FRAMES_PER_STEP, POSE_DIM, TRAJECTORY_DIM};
use footwork::nn::tensors::{read, upload, vector};
use footwork::train::controller::{Controller, Scripted};
use footwork::env::locomotion::{LEVELS, Plane, Setup, EnvState, Task, World, open};
use std::collections::HashSet;
use std::sync::Arc;

const ENVS: usize = 256;
const STEPS: usize = 1000;
const HORIZON: usize = 16;

/// The two batches of worlds, and what differs.
struct Pair {
    cpu: Box<dyn World>,
    gpu: Box<dyn World>,
    tensors: [Tensors; 2],
    oracle: Oracle,
    /// Environments that went another way after a tie.
    parted: HashSet<usize>,
    /// The largest difference of places seen, m.
    most: f32,
}

impl Pair {
    fn new() -> Self {
        let database = Arc::new(DATABASE.clone());
        let devices = [Device::Cpu, Device::from(gpu())];
        let setup = Setup {
            task: Task::Plane(Plane::default()),
            envs: ENVS,
            horizon: HORIZON,
            seed: 42,
            level: LEVELS - 1,
        };
        let world = |device| open(device, &database, &setup);
        Pair {
            cpu: world(&devices[0]),
            gpu: world(&devices[1]),
            tensors: devices.map(|device| device.tensors()),
            oracle: Oracle::new(&database.rows()),
            parted: HashSet::new(),
            most: 0.0,
        }
    }

    fn snapshots(&self) -> [EnvState; 2] {
        [&self.cpu, &self.gpu].map(|world| world.snapshot().expect("snapshot"))
    }

    fn step(&mut self, action: &[f32]) {
        let [before, _] = self.snapshots();
        for (world, device) in [&mut self.cpu, &mut self.gpu]
            .into_iter()
            .zip(&self.tensors)
        {
            world.step(upload(action.to_vec(), [ENVS, TRAJECTORY_DIM], device));
        }
        let [cpu, gpu] = self.snapshots();
        assert_eq!(cpu.step_counter, gpu.step_counter);
        for env in 0..ENVS {
            if self.parted.contains(&env) {
                continue;
            }
            let count = |of: &EnvState| -> [u32; state_u32::FIELDS] {
                std::array::from_fn(|field| of.state_u32[field * ENVS + env])
            };
            if count(&cpu) == count(&gpu) {
                self.close(&cpu, &gpu, env);
            } else {
                let action = &action[env * TRAJECTORY_DIM..][..TRAJECTORY_DIM];
                self.prove_tie(&before, [&cpu, &gpu], env, action);
                self.parted.insert(env);
            }
        }
    }

    fn close(&mut self, cpu: &EnvState, gpu: &EnvState, env: usize) {
        let bar = Bar::of(cpu, env);
        for field in 0..state_f32::FIELDS {
            let [want, got] = [cpu, gpu].map(|of| of.state_f32[field * ENVS + env]);
            let allowed = match field {
                state_f32::X | state_f32::Z => bar.place,
                state_f32::HEADING_X | state_f32::HEADING_Z => bar.heading,
                // A reward is as wrong as the distance, and each sum rounds.
                state_f32::RETURN | state_f32::RETURNS => 200.0 * (bar.place + want.abs() * f32::EPSILON),
                _ => 0.0,
            };
            let what = format!("step {}, environment {env}, field {field}", cpu.step_counter);
            assert!(
                (got - want).abs() <= allowed,
                "{what}: {got} instead of {want} +- {allowed}"
            );
            if [state_f32::X, state_f32::Z].contains(&field) {
                self.most = self.most.max((got - want).abs());
            }
        }
    }

    /// Fails unless the two ways of an environment are equally right.
    fn prove_tie(&self, before: &EnvState, after: [&EnvState; 2], env: usize, action: &[f32]) {
        let [cpu, gpu] = after.map(|of| of.state_u32[state_u32::EPISODE_STEP * ENVS + env]);
        if cpu != gpu {
            let on = if cpu == 0 { after[1] } else { after[0] };
            assert_eq!(cpu.min(gpu), 0, "environment {env}: ages {cpu} and {gpu}");
            let at = |field: usize| on.state_f32[field * ENVS + env];
            let (x, z) = (
                at(state_f32::TARGET_X) - at(state_f32::X),
                at(state_f32::TARGET_Z) - at(state_f32::Z),
            );
            let beyond = (x.hypot(z) - Plane::default().success_radius).abs();
            assert!(
                beyond <= 2.0 * Bar::of(on, env).place,
                "environment {env}: {beyond} m"
            );
            return;
        }
        let mut query = DATABASE.features[before.state_u32[state_u32::FRAME * ENVS + env] as usize];
        query[POSE_DIM..FEATURE_DIM].copy_from_slice(action);
        let best = self.oracle.nearest_all(&[query])[0];
        for of in after {
            let frame = of.state_u32[state_u32::FRAME * ENVS + env] - FRAMES_PER_STEP as u32;
            let found = DATABASE
                .candidates
                .binary_search(&frame)
                .expect("a candidate");
            self.oracle
                .check("a parted environment", &query, found as u32, best);
        }
    }

    /// Straight to the target at a brisk pace, with a new policy's noise.
    fn actions(&mut self, draw: &mut Draw) -> Vec<f32> {
        let seen = read(self.cpu.observe()).expect("observation");
        let scripted = Scripted {
            database: &DATABASE,
            speed: 2.0,
        };
        let mut action = scripted.act(&seen, BASE_OBS_DIM).expect("action");
        for value in &mut action {
            *value += 0.5 * draw.normal();
        }
        action
    }

    fn compare_observations(&mut self) {
        let [cpu, gpu] =
            [&mut self.cpu, &mut self.gpu].map(|w| read(w.observe()).expect("observation"));
        let [state, _] = self.snapshots();
        for env in (0..ENVS).filter(|env| !self.parted.contains(env)) {
            let part = env * BASE_OBS_DIM..(env + 1) * BASE_OBS_DIM;
            let (want, got) = (&cpu[part.clone()], &gpu[part]);
            let bar = Bar::of(&state, env);
            assert_eq!(want[..POSE_DIM], got[..POSE_DIM]);
            for (want, got) in want[POSE_DIM..].iter().zip(&got[POSE_DIM..]) {
                let allowed = bar.place + bar.heading * 2.0 * want.abs().max(1.0);
                assert!((want - got).abs() <= allowed, "environment {env}");
            }
        }
    }

    /// Each world's tally is the sum of what its own environments counted.
    fn compare_tallies(&mut self) {
        let snapshots = self.snapshots();
        for (world, before) in [&mut self.cpu, &mut self.gpu].into_iter().zip(snapshots) {
            let sums = read(world.tally()).expect("sums");
            let fields = [
                state_u32::EPISODES,
                state_u32::SUCCESSES,
                state_u32::COLLISIONS,
                state_u32::TRUNCATIONS,
                state_u32::LENGTHS,
            ];
            for (sum, field) in sums.iter().zip(fields) {
                let counted: u32 = before.state_u32[field * ENVS..(field + 1) * ENVS].iter().sum();
                assert_eq!(*sum, counted as f32);
            }
            let returns = &before.state_f32[state_f32::RETURNS * ENVS..];
            let sum: f64 = returns.iter().map(|&r| f64::from(r)).sum();
            assert!((f64::from(sums[5]) - sum).abs() <= 256.0 * f64::from(f32::EPSILON) * sum);
        }
    }
}

/// What rounding may have changed so far in an environment's episode.
struct Bar {
    heading: f32,
    place: f32,
}

impl Bar {
    fn of(state: &EnvState, env: usize) -> Self {
        let age = state.state_u32[state_u32::EPISODE_STEP * ENVS + env] as f32;
        let path = state.state_f32[state_f32::TRAVELLED * ENVS + env];
        let heading = 2.0 * f32::EPSILON * (2.0 + age);
        Bar {
            heading,
            place: heading * (1.0 + path),
        }
    }
}

#[test]
fn a_thousand_steps_agree_on_gpu_and_cpu() {
    let mut pair = Pair::new();
    let mut draw = Draw::new(1);
    for step in 0..STEPS {
        let action = pair.actions(&mut draw);
        pair.step(&action);
        if step % 50 == 0 {
            pair.compare_observations();
            pair.compare_tallies();
        }
    }
    println!(
        "{} parted, places within {:e} m",
        pair.parted.len(),
        pair.most
    );
    assert!(pair.parted.len() <= ENVS / 50, "{} ties", pair.parted.len());
}

#[test]
fn the_same_actions_are_drawn_on_gpu_and_cpu() {
    let mut pair = Pair::new();
    let mut draw = Draw::new(2);
    let (mean, log_std) = (draw.normals(ENVS * TRAJECTORY_DIM), draw.normals(TRAJECTORY_DIM));
    let [want, got] = [0, 1].map(|at| {
        let (world, device) = ([&mut pair.cpu, &mut pair.gpu], &pair.tensors[at]);
        let mean = upload(mean.clone(), [ENVS, TRAJECTORY_DIM], device);
        let [cpu, gpu] = world;
        let world = if at == 0 { cpu } else { gpu };
        let (action, log_prob) = world.act(mean, vector(&log_std, device));
        (
            read(action).expect("action"),
            read(log_prob).expect("log_prob"),
        )
    });
    for (want, got) in [(want.0, got.0), (want.1, got.1)] {
        let fits = |(w, g): (&f32, &f32)| (w - g).abs() <= 1e-5 * w.abs().max(1.0);
        assert!(want.iter().zip(&got).all(fits));
    }
}
