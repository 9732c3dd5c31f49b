//! Twins against the paper's formulas (section 3), written out in f64 with angles, where twins
//! have f32 and unit vectors. Bar: 1e-5 m, 1e-5 rad, rewards within 1e-5 of themselves.

use crate::inputs::Draw;
use crate::support::database::DATABASE;
use footwork::env::locomotion::Plane;
use footwork::kernels::locomotion::locomotion_layout::{BASE_OBS_DIM, state_f32, state_u32};
use footwork::kernels::locomotion::{advance_and_reward, observe};
use footwork::kernels::termination;
use footwork::motion::features::{FRAMES_PER_STEP, MIN_FUTURE_FRAMES, POSE_DIM};

const ENVS: usize = 2000;

/// A place and a direction on the ground: x, z, and the angle from z towards x.
#[derive(Clone, Copy)]
struct Stance {
    x: f64,
    z: f64,
    angle: f64,
}

impl Stance {
    fn of([x, z, hx, hz]: [f32; 4]) -> Self {
        Stance {
            x: x.into(),
            z: z.into(),
            angle: f64::from(hx).atan2(f64::from(hz)),
        }
    }

    fn of_env(reals: &[f32], env: usize) -> Self {
        let fields = [
            state_f32::X,
            state_f32::Z,
            state_f32::HEADING_X,
            state_f32::HEADING_Z,
        ];
        Stance::of(fields.map(|field| reals[field * ENVS + env]))
    }

    /// Where one ends who stands here and moves as a clip does between two of its stances.
    fn moved(self, from: Stance, to: Stance) -> Self {
        let (sin, cos) = (self.angle - from.angle).sin_cos();
        let (x, z) = (to.x - from.x, to.z - from.z);
        Stance {
            x: self.x + x * cos + z * sin,
            z: self.z - x * sin + z * cos,
            angle: self.angle + to.angle - from.angle,
        }
    }
}

/// The same angle but for whole turns.
fn same_angle(a: f64, b: f64) -> bool {
    ((a - b) / 2.0).sin().abs() < 5e-6
}

struct Worlds {
    state_f32: Vec<f32>,
    state_u32: Vec<u32>,
    reward: Vec<f32>,
    termination: Vec<u32>,
}

impl Worlds {
    fn random(seed: u32) -> Self {
        let (state_f32, mut state_u32) = Draw::new(seed).state(ENVS, DATABASE.frames());
        let mut fill = |field: usize, value| state_u32[field * ENVS..][..ENVS].fill(value);
        fill(state_u32::EPISODE_LIMIT, Plane::default().max_steps);
        fill(state_u32::HAS_COLLIDED, 0);
        Worlds {
            state_f32,
            state_u32,
            reward: vec![0.0; ENVS],
            termination: vec![0; ENVS],
        }
    }

    fn step(&mut self, matched: &[u32]) {
        let task = Plane::default();
        advance_and_reward::twin(
            &DATABASE.candidates,
            matched,
            &DATABASE.motion,
            &mut self.state_f32,
            &mut self.state_u32,
            &mut self.reward,
            &mut self.termination,
            &advance_and_reward::Params {
                envs: ENVS as u32,
                offset: 0,
                reach: task.success_radius,
                near: 1.0,
                progress: 0.0,
                clear: 0.0,
                shift: 0.0,
                bonus: task.success_bonus,
                crash: 0.0,
            },
        );
    }
}

#[test]
fn the_task_is_the_papers() {
    let task = Plane::default();
    assert_eq!((task.success_radius, task.success_bonus), (0.5, 1000.0));
    assert_eq!(
        (task.target_extent, task.max_steps, FRAMES_PER_STEP),
        (5.0, 200, 6)
    );
}

#[test]
fn a_step_plays_six_frames_of_the_recorded_path() {
    let mut draw = Draw::new(1);
    let mut worlds = Worlds::random(2);
    let before = worlds.state_f32.clone();
    let matched: Vec<u32> = (0..ENVS)
        .map(|_| draw.below(DATABASE.candidates.len()) as u32)
        .collect();
    worlds.step(&matched);
    for (env, matched) in matched.into_iter().enumerate() {
        let frame = DATABASE.candidates[matched as usize] as usize;
        let path = |frame: usize| Stance::of(DATABASE.path[frame]);
        let expected = Stance::of_env(&before, env).moved(path(frame), path(frame + 6));
        let got = Stance::of_env(&worlds.state_f32, env);
        assert!(
            (got.x - expected.x).hypot(got.z - expected.z) < 1e-5,
            "{env}"
        );
        assert!(same_angle(got.angle, expected.angle), "{env}");
        assert_eq!(
            worlds.state_u32[state_u32::FRAME * ENVS + env],
            frame as u32 + 6
        );
        let length: f64 = (frame..frame + 6)
            .map(|f| (path(f + 1).x - path(f).x).hypot(path(f + 1).z - path(f).z))
            .sum();
        let at = state_f32::TRAVELLED * ENVS + env;
        assert!((f64::from(worlds.state_f32[at] - before[at]) - length).abs() < 1e-5);
    }
}

#[test]
fn rewards_and_ends_are_those_of_equation_3() {
    let mut draw = Draw::new(3);
    let mut worlds = Worlds::random(4);
    let matched = vec![0; ENVS];
    for env in 0..ENVS {
        // Near enough that many arrive.
        for (target, place) in [
            (state_f32::TARGET_X, state_f32::X),
            (state_f32::TARGET_Z, state_f32::Z),
        ] {
            worlds.state_f32[target * ENVS + env] =
                worlds.state_f32[place * ENVS + env] + draw.within(1.0);
        }
    }
    let ages = worlds.state_u32
        [state_u32::EPISODE_STEP * ENVS..(state_u32::EPISODE_STEP + 1) * ENVS]
        .to_vec();
    worlds.step(&matched);
    let mut ends = [0; 3];
    for (env, age) in ages.into_iter().enumerate() {
        let at = |field: usize| f64::from(worlds.state_f32[field * ENVS + env]);
        let g = (at(state_f32::TARGET_X) - at(state_f32::X))
            .hypot(at(state_f32::TARGET_Z) - at(state_f32::Z));
        if (g - 0.5).abs() < 1e-5 {
            continue;
        }
        let (bonus, expected) = match (g < 0.5, age + 1 >= 200) {
            (true, _) => (1000.0, termination::SUCCESS),
            (false, true) => (0.0, termination::TRUNCATED),
            (false, false) => (0.0, termination::RUNNING),
        };
        let reward = (-g).exp() + bonus;
        assert!((f64::from(worlds.reward[env]) - reward).abs() < 1e-5 * reward);
        assert_eq!(worlds.termination[env], expected, "{env}");
        ends[expected as usize] += 1;
    }
    assert!(ends.iter().all(|&count| count > 50), "{ends:?}");
}

#[test]
fn an_episode_is_truncated_after_200_steps() {
    let mut worlds = Worlds::random(5);
    worlds.state_f32[state_f32::TARGET_X * ENVS..(state_f32::TARGET_Z + 1) * ENVS].fill(1e5);
    worlds.state_u32[state_u32::EPISODE_STEP * ENVS..][..ENVS].fill(0);
    worlds.state_u32[state_u32::EPISODES * ENVS..].fill(0);
    for step in 1..=200 {
        worlds.step(&[5; ENVS]);
        let expected = if step < 200 {
            termination::RUNNING
        } else {
            termination::TRUNCATED
        };
        assert!(
            worlds
                .termination
                .iter()
                .all(|&termination| termination == expected),
            "step {step}"
        );
    }
    let count = |field: usize| &worlds.state_u32[field * ENVS..(field + 1) * ENVS];
    assert!(count(state_u32::LENGTHS).iter().all(|&steps| steps == 200));
    assert!(
        count(state_u32::EPISODES)
            .iter()
            .all(|&episodes| episodes == 1)
    );
    assert!(count(state_u32::TRUNCATIONS).iter().all(|&ends| ends == 1));
    for field in [state_u32::SUCCESSES, state_u32::COLLISIONS] {
        assert!(count(field).iter().all(|&ends| ends == 0));
    }
}

#[test]
fn candidates_are_all_frames_whose_next_second_is_known() {
    let expected = DATABASE.clips.iter().flat_map(|clip| {
        let frames = clip.first..clip.first + clip.frames;
        frames.clone().filter(move |frame| frame + 30 < frames.end)
    });
    assert_eq!(MIN_FUTURE_FRAMES, 30);
    assert!(expected.eq(DATABASE.candidates.iter().map(|&frame| frame as usize)));
}

#[test]
fn an_observation_is_the_pose_and_a_fifth_of_the_way_to_the_target() {
    let worlds = Worlds::random(6);
    let mut observation = vec![0.0; ENVS * BASE_OBS_DIM];
    let params = observe::Params {
        envs: ENVS as u32,
        offset: 0,
        only: termination::ANY,
        rows: 1,
        width: BASE_OBS_DIM as u32,
        to: 0,
    };
    observe::twin(
        &DATABASE.features,
        &worlds.state_f32,
        &worlds.state_u32,
        &worlds.termination,
        &[],
        &mut observation,
        &params,
    );
    for (env, row) in observation.chunks(BASE_OBS_DIM).enumerate() {
        assert_eq!(
            row[..POSE_DIM],
            DATABASE.features[worlds.state_u32[env] as usize][..POSE_DIM]
        );
        let stance = Stance::of_env(&worlds.state_f32, env);
        let at = |field: usize| f64::from(worlds.state_f32[field * ENVS + env]);
        let (x, z) = (
            at(state_f32::TARGET_X) - stance.x,
            at(state_f32::TARGET_Z) - stance.z,
        );
        // Forward is the heading, left is a quarter turn from it.
        let bearing = x.atan2(z) - stance.angle;
        let goal = [bearing.sin(), bearing.cos()].map(|part| part * x.hypot(z) / 5.0);
        for (got, want) in row[POSE_DIM..].iter().zip(goal) {
            assert!((f64::from(*got) - want).abs() < 1e-5, "{env}");
        }
    }
}
