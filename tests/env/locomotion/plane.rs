//! A thousand steps of 256 environments under the same actions, on the GPU against the CPU.
//! Oracle: `CpuLocomotion`, which runs the twins.
//! Bar: frames, ages and counts equal; headings within a rounding or two a step of the episode,
//! places within that angle times the path walked. An environment may go another way only after
//! a proven tie: an arrival decided within that bar of reach, or two rows as near in f64 as f32
//! can tell.

use super::config;
use super::player::{Player, devices};
use crate::support::database::DATABASE;
use crate::support::inputs::Draw;
use crate::support::oracle::Oracle;
use footwork::env::locomotion::{EnvState, LocomotionTask, Plane};
use footwork::kernels::locomotion::locomotion_layout::{BASE_OBS_DIM, state_f32, state_u32};
use footwork::motion::features::{FEATURE_DIM, FRAMES_PER_STEP, POSE_DIM, TRAJECTORY_DIM};
use std::collections::HashSet;

const ENVS: usize = 256;
const STEPS: usize = 1000;
const ROLLOUT: usize = 16;

/// The two batches, and what differs.
struct Pair {
    cpu: Player,
    gpu: Player,
    oracle: Oracle,
    /// Environments that went another way after a tie.
    parted: HashSet<usize>,
    /// The largest difference of places seen, m.
    most: f32,
}

impl Pair {
    fn new() -> Self {
        let config = config(LocomotionTask::Plane(Plane::default()), ENVS);
        let [cpu, gpu] = devices().map(|device| Player::together(&device, &config, ROLLOUT));
        Pair {
            cpu,
            gpu,
            oracle: Oracle::new(&DATABASE.rows()),
            parted: HashSet::new(),
            most: 0.0,
        }
    }

    fn states(&self) -> [EnvState; 2] {
        [self.cpu.state(), self.gpu.state()]
    }

    fn step(&mut self, action: &[f32]) {
        let [before, _] = self.states();
        self.cpu.step(action);
        self.gpu.step(action);
        let [cpu, gpu] = self.states();
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
                state_f32::RETURN | state_f32::RETURNS => {
                    200.0 * (bar.place + want.abs() * f32::EPSILON)
                }
                _ => 0.0,
            };
            let what = format!(
                "step {}, environment {env}, field {field}",
                cpu.step_counter
            );
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

    fn compare_observations(&mut self) {
        let (cpu, gpu) = (self.cpu.observation(), self.gpu.observation());
        let [state, _] = self.states();
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

    /// Each batch's statistics are sums of what its own environments counted.
    fn compare_stats(&mut self) {
        let states = self.states();
        for (player, before) in [&mut self.cpu, &mut self.gpu].into_iter().zip(states) {
            let stats = player.stats();
            for (name, field) in [
                ("episodes", state_u32::EPISODES),
                ("successes", state_u32::SUCCESSES),
                ("collision", state_u32::COLLISIONS),
                ("truncation", state_u32::TRUNCATIONS),
                ("steps", state_u32::LENGTHS),
            ] {
                let counted: u32 = before.state_u32[field * ENVS..(field + 1) * ENVS]
                    .iter()
                    .sum();
                assert_eq!(stats.sum(name), f64::from(counted), "{name}");
            }
            let returns = &before.state_f32[state_f32::RETURNS * ENVS..];
            let sum: f64 = returns.iter().map(|&r| f64::from(r)).sum();
            let off = (stats.sum("returns") - sum).abs();
            assert!(off <= 256.0 * f64::from(f32::EPSILON) * sum);
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
        let action = pair.cpu.actions(&mut draw);
        pair.step(&action);
        if step % 50 == 0 {
            pair.compare_observations();
            pair.compare_stats();
        }
    }
    println!(
        "{} parted, places within {:e} m",
        pair.parted.len(),
        pair.most
    );
    assert!(pair.parted.len() <= ENVS / 50, "{} ties", pair.parted.len());
}
