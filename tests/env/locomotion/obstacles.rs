//! Environments with obstacles under the same actions, on the GPU against the CPU.
//! Oracle: `CpuLocomotion`, which runs the twins.
//! Bar: random numbers equal bit for bit; frames, hits, maps and ends equal (soft cells up to a step of
//! their bytes); places within the roundings of the steps so far. An environment may go another way only where something it
//! decides lies within 1e-5 m of an edge, as geometry in f64 tells.

use super::config;
use super::player::{Player, devices};
use crate::support::database::{DATABASE, MATCHER};
use crate::support::geometry::{Point, Stance, depth};
use crate::support::ground::{obstacles, stance};
use crate::support::inputs::Draw;
use footwork::env::locomotion::task::SpeedDistribution;
use footwork::env::locomotion::{EnvState, LocomotionTask, Obstacles};
use footwork::kernels::locomotion::locomotion_layout::{
    BASE_OBS_DIM, CELLS, MAP_WORDS, VELOCITY_DIM, boxes, state_f32, state_u32,
};
use footwork::motion::features::{POSE_DIM, TRAJECTORY_DIM};
use std::collections::HashSet;
use std::ops::Range;

const ENVS: usize = 64;
const ROLLOUT: usize = 8;
/// This near to an edge rounding decides, m.
const EDGE: f64 = 1e-5;

/// The two batches, and what differs.
struct Pair {
    task: Obstacles,
    /// On the CPU and on the GPU.
    players: [Player; 2],
    /// Environments that went another way on an edge.
    parted: HashSet<usize>,
    /// Episodes ended, collisions, arrivals and hits, so that the test is known to meet them.
    met: [u32; 4],
}

impl Pair {
    fn new(task: Obstacles) -> Self {
        let config = config(LocomotionTask::Obstacles(task), ENVS);
        Pair {
            task,
            players: devices().map(|device| Player::together(&device, &config, ROLLOUT)),
            parted: HashSet::new(),
            met: [0; 4],
        }
    }

    fn states(&self) -> [EnvState; 2] {
        [0, 1].map(|at| self.players[at].state())
    }

    fn together(&self) -> Vec<usize> {
        (0..ENVS).filter(|env| !self.parted.contains(env)).collect()
    }

    fn step(&mut self, action: &[f32]) {
        let [before, _] = self.states();
        self.players
            .iter_mut()
            .for_each(|player| player.step(action));
        let [cpu, gpu] = self.states();
        assert_eq!((cpu.step_counter, cpu.level), (gpu.step_counter, gpu.level));
        for env in self.together() {
            if decisions(&cpu, env) == decisions(&gpu, env) && self.maps_agree(&cpu, &gpu, env) {
                close(&cpu, &gpu, env, self.task.count as usize);
            } else {
                let margin = self.margin(&before, &cpu, env, &action[env * TRAJECTORY_DIM..]);
                assert!(
                    margin < EDGE,
                    "environment {env} parts {margin:e} m from an edge"
                );
                self.parted.insert(env);
            }
            self.met[3] += u32::from(cpu.state_u32[state_u32::HITS * ENVS + env] > 0);
        }
    }

    fn maps_agree(&self, cpu: &EnvState, gpu: &EnvState, env: usize) -> bool {
        let [cpu, gpu] = [cpu, gpu].map(|of| &of.maps[env * MAP_WORDS..][..MAP_WORDS]);
        let bytes = |words: &[u32]| -> Vec<u8> {
            words.iter().flat_map(|word| word.to_le_bytes()).collect()
        };
        let mut pairs = std::iter::zip(bytes(cpu), bytes(gpu));
        pairs.all(|(cpu, gpu)| cpu.abs_diff(gpu) <= self.step_of_a_cell())
    }

    /// What rounding may change a cell's byte by.
    fn step_of_a_cell(&self) -> u8 {
        u8::from(self.task.map_edge_width > 0.0)
    }

    /// How far the nearest decision of a step is from going the other way, m.
    fn margin(&self, before: &EnvState, after: &EnvState, env: usize, action: &[f32]) -> f64 {
        let count = self.task.count as usize;
        let around = |of: &EnvState| obstacles(&of.boxes, &of.obstacle_velocity, count, env);
        let (then, now) = (around(before), around(after));
        let stood = stance(&before.state_f32, ENVS, env);
        let normal = DATABASE.normalisation.trajectory();
        let asked = [0, 4, 8].map(|x| {
            let [left, ahead] =
                [x, x + 1].map(|i| f64::from(action[i] / normal[TRAJECTORY_DIM + i] + normal[i]));
            depth(&then, stood.point(left, ahead))
        });
        let walked = self.walked(before, env, action);
        let side = f64::from(self.task.arena_half_extent);
        let struck = walked.iter().enumerate().map(|(k, &point)| {
            let moved = then.iter().map(|o| o.moved((k + 1) as f64 / 30.0, side));
            depth(&moved.collect::<Vec<_>>(), point)
        });
        let target = [state_f32::TARGET_X, state_f32::TARGET_Z]
            .map(|field| f64::from(before.state_f32[field * ENVS + env]));
        let [x, z] = [0, 1].map(|i| target[i] - walked[5][i]);
        let arrival = x.hypot(z) - f64::from(self.task.success_radius);
        let stands = stance(&after.state_f32, ENVS, env);
        let cells = (0..CELLS * CELLS).map(|i| depth(&now, stands.cell(i / CELLS, i % CELLS)));
        let all = asked.into_iter().chain(struck).chain(cells);
        all.chain([arrival])
            .fold(f64::INFINITY, |least, d| least.min(d.abs()))
    }

    /// Where the character is at the six frames of a step.
    fn walked(&self, before: &EnvState, env: usize, action: &[f32]) -> [Point; 6] {
        let frame = before.state_u32[state_u32::FRAME * ENVS + env];
        let mut query = DATABASE.features[frame as usize];
        query[POSE_DIM..][..TRAJECTORY_DIM].copy_from_slice(&action[..TRAJECTORY_DIM]);
        let matched = MATCHER.nearest(frame, &query).index as usize;
        let frame = DATABASE.candidates[matched] as usize;
        let path = |frame: usize| DATABASE.path[frame].map(f64::from);
        let [x, z, hx, hz] = path(frame);
        let recorded = Stance {
            at: [x, z],
            forward: [hx, hz],
        };
        let stood = stance(&before.state_f32, ENVS, env);
        std::array::from_fn(|k| {
            let [x, z, ..] = path(frame + k + 1);
            let [left, ahead] = recorded.sees([x, z]);
            stood.point(left, ahead)
        })
    }

    /// Maps of the observation equal, the rest within rounding.
    fn compare_observations(&mut self) {
        let [cpu, gpu] = [0, 1].map(|at| self.players[at].observation());
        let width = cpu.len() / ENVS;
        for env in self.together() {
            let part = env * width..(env + 1) * width;
            assert_seen(&cpu[part.clone()], &gpu[part], self.step_of_a_cell());
        }
    }

    /// The columns of a rollout: rewards within rounding, terminations equal, final observations as all
    /// others.
    fn compare_columns(&mut self) {
        let together = self.together();
        let [cpu, gpu] = [0, 1].map(|at| self.players[at].final_observations());
        let width = self.players[0].spec().observation.dim();
        assert_eq!(cpu.len(), gpu.len());
        for row in (0..cpu.len() / width).filter(|row| together.contains(&(row % ENVS))) {
            let part = row * width..(row + 1) * width;
            assert_seen(&cpu[part.clone()], &gpu[part], self.step_of_a_cell());
        }
        let [ended, also_ended] = [0, 1].map(|at| self.players[at].terminations());
        let [cpu, gpu] = [0, 1].map(|at| self.players[at].rewards());
        for at in (0..ROLLOUT * ENVS).filter(|at| together.contains(&(at % ENVS))) {
            let (want, got) = (cpu[at], gpu[at]);
            assert!(
                (got - want).abs() < 1e-3,
                "sample {at}: {got} instead of {want}"
            );
            assert_eq!(ended[at], also_ended[at], "sample {at}");
        }
    }

    /// Counts agree unless an environment has parted.
    fn compare_stats(&mut self) {
        let [cpu, gpu] = [0, 1].map(|at| self.players[at].stats());
        if self.parted.is_empty() {
            for ((name, want), (_, got)) in cpu.iter().zip(gpu.iter()) {
                let bar = if name == "returns" {
                    1e-4 * want.abs().max(1.0)
                } else {
                    0.0
                };
                assert!((got - want).abs() <= bar, "{name}: {got} instead of {want}");
            }
        }
        let [episodes, successes, collisions, truncations] =
            ["episodes", "successes", "collision", "truncation"].map(|name| cpu.sum(name));
        assert_eq!(
            episodes,
            successes + collisions + truncations,
            "each episode ended in one way"
        );
        for (met, count) in self.met.iter_mut().zip([episodes, collisions, successes]) {
            *met += count as u32;
        }
    }

    fn play(&mut self, steps: usize) {
        let [cpu, gpu] = self.states();
        for env in 0..ENVS {
            close(&cpu, &gpu, env, self.task.count as usize);
        }
        let mut draw = Draw::new(1);
        for step in 1..=steps {
            let action = self.players[0].actions(&mut draw);
            self.step(&action);
            if step % ROLLOUT == 0 {
                self.compare_observations();
                self.compare_columns();
                self.compare_stats();
            }
        }
        println!("{} parted of {ENVS}, met {:?}", self.parted.len(), self.met);
        assert!(self.parted.len() <= 3);
        assert!(self.met.iter().all(|&count| count > 10), "{:?}", self.met);
    }
}

/// Whatever of a state is whole numbers.
fn decisions(of: &EnvState, env: usize) -> Vec<u32> {
    let counts = (0..state_u32::FIELDS).map(|field| of.state_u32[field * ENVS + env]);
    counts.collect()
}

fn part(fields: Range<usize>, width: usize, env: usize, count: usize) -> Range<usize> {
    (env * width + fields.start) * count..(env * width + fields.end) * count
}

#[track_caller]
fn close(cpu: &EnvState, gpu: &EnvState, env: usize, count: usize) {
    let what = format!("step {}, environment {env}", cpu.step_counter);
    let age = cpu.state_u32[state_u32::EPISODE_STEP * ENVS + env] as f32;
    let heading = 2.0 * f32::EPSILON * (2.0 + age);
    let place = heading * (1.0 + cpu.state_f32[state_f32::TRAVELLED * ENVS + env]);
    for field in 0..state_f32::FIELDS {
        let [want, got] = [cpu, gpu].map(|of| of.state_f32[field * ENVS + env]);
        let allowed = match field {
            state_f32::X | state_f32::Z => place,
            state_f32::HEADING_X | state_f32::HEADING_Z => heading,
            // A reward is as wrong as the distance, and each sum rounds.
            state_f32::RETURN | state_f32::RETURNS => 200.0 * (place + want.abs() * f32::EPSILON),
            _ => 0.0,
        };
        assert!(
            (got - want).abs() <= allowed,
            "{what}, field {field}: {got} instead of {want} +- {allowed}"
        );
    }
    // Freshly drawn boxes are equal; moved ones round at every step, and sizes never change.
    let centres = part(boxes::X..boxes::HALF_X, boxes::FIELDS, env, count);
    for (want, got) in cpu.boxes[centres.clone()].iter().zip(&gpu.boxes[centres]) {
        assert!(
            (got - want).abs() <= age * 40.0 * f32::EPSILON,
            "{what}: centres"
        );
    }
    let sizes = part(boxes::HALF_X..boxes::FIELDS, boxes::FIELDS, env, count);
    assert_eq!(cpu.boxes[sizes.clone()], gpu.boxes[sizes], "{what}: sizes");
    let axes = part(0..VELOCITY_DIM, VELOCITY_DIM, env, count);
    for (want, got) in cpu.obstacle_velocity[axes.clone()]
        .iter()
        .zip(&gpu.obstacle_velocity[axes])
    {
        // A sign may differ at a wall, where the next step makes up for it.
        assert!(
            (got.abs() - want.abs()).abs() <= 4.0 * f32::EPSILON,
            "{what}: speeds"
        );
    }
}

#[track_caller]
fn assert_seen(want: &[f32], got: &[f32], step: u8) {
    assert_eq!(want[..POSE_DIM], got[..POSE_DIM]);
    for (want, got) in want[POSE_DIM..BASE_OBS_DIM]
        .iter()
        .zip(&got[POSE_DIM..BASE_OBS_DIM])
    {
        assert!((want - got).abs() <= 1e-4);
    }
    for (want, got) in want[BASE_OBS_DIM..].iter().zip(&got[BASE_OBS_DIM..]) {
        assert!((want - got).abs() <= 1.001 * f32::from(step) / 255.0);
    }
}

#[test]
fn two_hundred_steps_of_the_papers_task_agree() {
    Pair::new(Obstacles::PRINTED).play(200);
}

#[test]
fn every_other_switch_agrees() {
    let task = Obstacles {
        speed_distribution: SpeedDistribution::Uniform,
        success_is_terminal: false,
        count: 37,
        speed: 3.0,
        max_steps: 12,
        ..Obstacles::FAST
    };
    Pair::new(task).play(80);
}

/// A state put back goes on as the one it was taken of.
#[test]
fn the_state_of_one_device_goes_on_on_the_other() {
    let mut pair = Pair::new(Obstacles::PRINTED);
    let mut draw = Draw::new(3);
    for _ in 0..ROLLOUT {
        let action = draw.normals(ENVS * TRAJECTORY_DIM);
        pair.step(&action);
    }
    let [cpu, gpu] = pair.states();
    let [from_cpu, from_gpu] = [0, 1].map(|at| pair.players[at].save());
    pair.players[0]
        .load(from_gpu)
        .expect("the same environments");
    pair.players[1]
        .load(from_cpu)
        .expect("the same environments");
    let [swapped_cpu, swapped_gpu] = pair.states();
    assert!(swapped_cpu == gpu && swapped_gpu == cpu);
    for _ in 0..ROLLOUT {
        let action = draw.normals(ENVS * TRAJECTORY_DIM);
        pair.step(&action);
    }
    pair.compare_observations();
}
