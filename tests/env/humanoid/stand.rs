//! The task `stand`.
//! Oracle: the same environments by another way: on the other device, in parts, on one thread, from a
//! saved state. Bar: equal bit for bit on one device; between devices what the physics' rounding grows to.

use crate::support::inputs::{Draw, POISON, gpu};
use footwork::container::Section;
use footwork::env::humanoid::action::rest_action;
use footwork::env::humanoid::stand::evaluate::evaluate;
use footwork::env::humanoid::stand::{Stand, StandTask};
use footwork::env::humanoid::starts::{START_STATES, StartSpread, lowest_point, start_states};
use footwork::env::humanoid::task::play::record;
use footwork::env::humanoid::task::{CpuHumanoidEnv, EpisodeRules, open};
use footwork::env::{EnvBatch, Stats, Transition, VecEnv, termination};
use footwork::gpu::{Array, Device};
use footwork::kernels::humanoid::fallen::{FallRules, has_fallen};
use footwork::kernels::humanoid::stand_reward::{stillness, uprightness};
use footwork::physics::kinematics::kinematics;
use footwork::physics::pose::Pose;
use footwork::physics::scenes;
use footwork::physics::spatial::Spatial;
use footwork::ranks::Ranks;
use glam::{Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// Environments of the task `stand`.
fn opened(device: &Device, stand: &Stand, envs: Range<usize>, seed: u32) -> Box<dyn VecEnv> {
    let task = Arc::new(StandTask::new(stand, seed));
    open(device, task, envs, seed).unwrap()
}

/// Choices with episodes of so many seconds.
fn short(episode_s: f32) -> Stand {
    let rules = EpisodeRules {
        episode_s,
        ..EpisodeRules::default()
    };
    Stand {
        rules,
        ..Stand::default()
    }
}

/// Numbers that the body observes of itself.
const OBSERVATION: usize = 105;

/// Columns of a rollout, and the environments that fill them.
struct Rollout {
    device: Device,
    reward: Array,
    termination: Array<u32>,
    group: Array<u32>,
    final_observation: Array,
    steps: usize,
}

impl Rollout {
    fn new(device: &Device, envs: usize, steps: usize) -> Rollout {
        let dim = OBSERVATION;
        Rollout {
            reward: Array::from_slice(device, &vec![POISON; steps * envs]),
            group: Array::zeroed(device, steps * envs),
            termination: Array::from_slice(device, &vec![POISON.to_bits(); steps * envs]),
            final_observation: Array::from_slice(device, &vec![POISON; steps * envs * dim]),
            device: device.clone(),
            steps: 0,
        }
    }

    /// Observes, then steps with these actions; returns the observation.
    fn step(&mut self, envs: &mut dyn VecEnv, action: &[f32]) -> Vec<f32> {
        let spec = *envs.spec();
        let mut observation = Array::zeroed(&self.device, spec.rows() * spec.observation.dim() + 3);
        envs.observe(&mut observation, 3);
        let action = Array::from_slice(&self.device, action);
        let out = Transition {
            step: self.steps,
            reward: &mut self.reward,
            style_reward: &mut Array::zeroed(&self.device, 1),
            termination: &mut self.termination,
            group: &mut self.group,
            final_observation: &mut self.final_observation,
        };
        envs.step(&action, 0, out);
        self.steps += 1;
        observation.read(&self.device).unwrap()[3..].to_vec()
    }

    fn terminations(&self) -> Vec<u32> {
        self.termination.read(&self.device).unwrap()
    }
}

/// Actions near the standing pose.
fn actions(draw: &mut Draw, envs: usize) -> Vec<f32> {
    let rest = rest_action(&scenes::humanoid(), &scenes::humanoid().qpos0);
    let rows = std::iter::repeat_n(rest, envs).flatten();
    rows.map(|action| action + 0.05 * draw.normal()).collect()
}

fn sums(device: &Device, envs: &mut dyn VecEnv) -> Stats {
    let names = envs.stat_names();
    let mut sums = Array::from_slice(device, &vec![POISON; names.len()]);
    envs.stats(&mut sums);
    Stats::new(names, &sums.read(device).unwrap())
}

#[test]
fn the_gpu_plays_what_the_cpu_plays() {
    let (cpu, gpu) = (Device::Cpu, Device::from(gpu()));
    let (envs, steps) = (70, 12);
    let stand = short(0.5);
    let open = |device| opened(device, &stand, 5..5 + envs, 3);
    let (mut one, mut other) = (open(&cpu), open(&gpu));
    let mut rollouts = [&cpu, &gpu].map(|device| Rollout::new(device, envs, steps));
    let mut draw = Draw::new(1);
    for step in 0..steps {
        let actions = actions(&mut draw, envs);
        let [first, second] = &mut rollouts;
        let seen = first.step(one.as_mut(), &actions);
        let on_gpu = second.step(other.as_mut(), &actions);
        for (index, (a, b)) in seen.iter().zip(&on_gpu).enumerate() {
            // Speeds of joints are of the order of ten.
            assert!((a - b).abs() < 2e-2, "step {step}, {index}: {a} {b}");
        }
    }
    let [first, second] = &rollouts;
    assert_eq!(first.terminations(), second.terminations());
    let ended = first.terminations();
    let truncated = ended.iter().filter(|&&end| end == termination::TRUNCATED);
    assert!(truncated.count() > envs / 2, "{ended:?}");
    let pairs = [&first.reward, &first.final_observation].map(|array| array.host().to_vec());
    let others = [&second.reward, &second.final_observation].map(|array| array.read(&gpu).unwrap());
    for (a, b) in pairs.concat().iter().zip(&others.concat()) {
        assert!((a - b).abs() < 2e-2, "{a} {b}");
    }
    let [a, b] = [sums(&cpu, one.as_mut()), sums(&gpu, other.as_mut())];
    for ((name, a), (_, b)) in a.iter().zip(b.iter()) {
        assert!((a - b).abs() < 0.05, "{name}: {a} {b}");
    }
    assert!(a.sum("episodes") > 0.0 && a.sum("successes") > 0.0);
    assert_eq!(sums(&gpu, other.as_mut()).sum("episodes"), 0.0);
}

#[test]
fn parts_play_what_all_play() {
    let (envs, steps) = (22, 40);
    let stand = short(1.0);
    let mut all = opened(&Device::Cpu, &stand, 0..envs, 7);
    let open = |range| Ok(opened(&Device::Cpu, &stand, range, 7));
    let mut batch = EnvBatch::open(&Device::Cpu, &Ranks::alone(), envs, None, open).unwrap();
    assert_eq!(batch.parts.len(), 4);
    let mut whole = Rollout::new(&Device::Cpu, envs, steps);
    let mut parts: Vec<Rollout> = batch
        .parts
        .iter()
        .map(|part| Rollout::new(&Device::Cpu, part.spec().envs, steps))
        .collect();
    let mut draw = Draw::new(2);
    for _ in 0..steps {
        let actions = actions(&mut draw, envs);
        let expected = whole.step(all.as_mut(), &actions);
        let (mut seen, mut first) = (Vec::new(), 0);
        for (part, rollout) in batch.parts.iter_mut().zip(&mut parts) {
            let len = part.spec().envs * part.spec().action;
            seen.extend(rollout.step(part.as_mut(), &actions[first..first + len]));
            first += len;
        }
        assert!(seen == expected);
    }
    let mut env = 0;
    for part in &parts {
        let count = part.reward.len() / steps;
        for step in 0..steps {
            let (own, all) = (step * count, step * envs + env);
            assert_eq!(
                part.reward.host()[own..][..count],
                whole.reward.host()[all..][..count]
            );
            assert_eq!(
                part.termination.host()[own..][..count],
                whole.termination.host()[all..][..count]
            );
        }
        env += count;
    }
    let [mut a, mut b] = [(); 2].map(|()| Array::Host(vec![0.0; batch.stat_names().len()]));
    all.stats(&mut a);
    batch.stats(&mut b);
    for (a, b) in a.host().iter().zip(b.host()) {
        assert!((a - b).abs() <= 1e-5 * a.abs(), "{a} {b}");
    }
    assert!(a.host()[0] > 10.0);
}

#[test]
fn a_saved_state_goes_on_as_if_nothing_had_happened() {
    for device in [Device::Cpu, Device::from(gpu())] {
        let (envs, steps) = (9, 8);
        let stand = short(0.4);
        let mut draw = Draw::new(3);
        let open = || opened(&device, &stand, 2..2 + envs, 5);
        let mut original = open();
        let mut rollout = Rollout::new(&device, envs, 2 * steps);
        for _ in 0..steps {
            rollout.step(original.as_mut(), &actions(&mut draw, envs));
        }
        let mut section = Section::default();
        original.save(&mut section).unwrap();
        let mut restored = open();
        restored.load(&mut section).unwrap();
        let mut other = Rollout::new(&device, envs, 2 * steps);
        other.steps = steps;
        for _ in 0..steps {
            let actions = actions(&mut draw, envs);
            let expected = rollout.step(original.as_mut(), &actions);
            assert!(other.step(restored.as_mut(), &actions) == expected);
        }
        let later = |array: &Array| array.read(&device).unwrap()[steps * envs..].to_vec();
        assert_eq!(later(&rollout.reward), later(&other.reward));
        assert_eq!(
            sums(&device, original.as_mut()),
            sums(&device, restored.as_mut())
        );
        let error = restored.load(&mut Section::default()).unwrap_err();
        assert!(error.to_string().contains("step_counter"), "{error}");
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let play = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let mut envs = opened(&Device::Cpu, &Stand::default(), 0..33, 1);
            let mut rollout = Rollout::new(&Device::Cpu, 33, 20);
            let mut draw = Draw::new(4);
            let seen = (0..20).map(|_| rollout.step(envs.as_mut(), &actions(&mut draw, 33)));
            seen.flatten().map(f32::to_bits).collect::<Vec<_>>()
        })
    };
    assert!(play(1) == play(3));
}

#[test]
fn starts_stand_on_the_ground_and_differ() {
    let model = scenes::humanoid();
    let feet = ["right_foot", "left_foot"].map(|name| model.body(name).unwrap());
    let spread = StartSpread {
        joint: 0.3,
        tilt: 0.3,
        root_speed: 1.0,
        joint_speed: 1.0,
    };
    let states = start_states(&model, &feet, &spread, 3, START_STATES);
    let width = model.nq() + model.nv();
    for state in states.chunks_exact(width) {
        let (q, v) = state.split_at(model.nq());
        assert!((0.0..0.002).contains(&lowest_point(&model, &feet, q)));
        assert!(v.iter().all(|speed| speed.abs() <= 1.0));
        for joint in &model.joints {
            if let (1, Some([low, high])) = (joint.kind.nq(), joint.range) {
                assert!((low..=high).contains(&q[joint.q]), "{}", joint.name);
            }
        }
    }
    assert_ne!(states[..width], states[width..2 * width]);
}

#[test]
fn wild_actions_never_bring_numbers_that_are_none() {
    for device in [Device::Cpu, Device::from(gpu())] {
        let envs = 16;
        let mut batch = opened(&device, &Stand::default(), 0..envs, 1);
        let mut rollout = Rollout::new(&device, envs, 40);
        let mut draw = Draw::new(5);
        for _ in 0..40 {
            let wild: Vec<f32> = (0..envs * 28).map(|_| 1e4 * draw.normal()).collect();
            let seen = rollout.step(batch.as_mut(), &wild);
            assert!(seen.iter().all(|value| value.is_finite()));
        }
        assert!(
            rollout
                .reward
                .read(&device)
                .unwrap()
                .iter()
                .all(|reward| reward.is_finite())
        );
        assert!(rollout.terminations().contains(&termination::FAILED));
    }
}

#[test]
fn a_diverged_world_fails_and_begins_anew() {
    for device in [Device::Cpu, Device::from(gpu())] {
        let envs = 5;
        let mut batch = opened(&device, &Stand::default(), 0..envs, 1);
        let mut section = Section::default();
        batch.save(&mut section).unwrap();
        let model = scenes::humanoid();
        let len = (model.nq() + model.nv()) * envs;
        let mut state: Vec<f32> = section.take_array("state", len).unwrap();
        // A spin that no joint has.
        state[(model.nq() + 4) * envs + 2] = 1e30;
        section.put_array("state", &state);
        batch.load(&mut section).unwrap();
        let mut rollout = Rollout::new(&device, envs, 2);
        rollout.step(batch.as_mut(), &actions(&mut Draw::new(1), envs));
        let seen = rollout.step(batch.as_mut(), &actions(&mut Draw::new(2), envs));
        assert!(
            seen.iter()
                .all(|value| value.is_finite() && value.abs() < 100.0)
        );
        assert_eq!(rollout.terminations()[2], termination::FAILED);
        assert_eq!(rollout.reward.read(&device).unwrap()[2], 0.0);
        assert_eq!(sums(&device, batch.as_mut()).sum("fall"), 1.0);
    }
}

#[test]
fn reward_terms_of_simple_cases() {
    assert_eq!(uprightness(Quat::IDENTITY), 1.0);
    assert!((uprightness(Quat::from_rotation_z(1.0)) - 1.0).abs() < 1e-6);
    assert!(uprightness(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)).abs() < 1e-6);
    assert!((uprightness(Quat::from_rotation_y(std::f32::consts::PI)) + 1.0).abs() < 1e-6);
    let mut v = vec![9.0; 34];
    v[6..].fill(0.0);
    assert_eq!(stillness(&v), 1.0, "the root may move");
    v[6..].fill(2.0);
    assert!((stillness(&v) - (-0.4f32).exp()).abs() < 1e-6);
}

#[test]
fn a_body_has_fallen_when_a_part_is_low() {
    let model = scenes::humanoid();
    let index = |name: &str| model.body(name).unwrap() as u32;
    let rules = FallRules {
        bodies: model.bodies.len() as u32,
        head: index("head"),
        pelvis: index("pelvis"),
        feet: ["right_foot", "left_foot"].map(index),
        min_head: 0.9,
        min_pelvis: 0.5,
        min_body: 0.15,
    };
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let mut axes = vec![Spatial::ZERO; model.nv()];
    kinematics(&model, &model.qpos0, &mut poses, &mut axes);
    assert!(!has_fallen(&poses, &rules));
    for (name, height, fallen) in [
        ("head", 0.91, false),
        ("head", 0.89, true),
        ("pelvis", 0.51, false),
        ("pelvis", 0.49, true),
        ("left_hand", 0.16, false),
        ("left_hand", 0.14, true),
        ("right_shin", 0.14, true),
        ("right_foot", 0.01, false),
    ] {
        let mut poses = poses.clone();
        poses[index(name) as usize].position = Vec3::Z * height;
        assert_eq!(has_fallen(&poses, &rules), fallen, "{name} at {height} m");
    }
}

#[test]
fn an_evaluation_tells_how_long_bodies_stay_up() {
    let stand = Stand::default();
    let rest = rest_action(&scenes::humanoid(), &scenes::humanoid().qpos0);
    let policy = |observation: &[f32]| {
        let rows = observation.len() / OBSERVATION;
        rest.repeat(rows)
    };
    let report = evaluate(&stand, &policy, 20, 4);
    assert_eq!(report.episodes, 20);
    // Nothing balances it: it falls within seconds.
    assert!(report.survival < 0.5, "{report:?}");
    assert!((0.3..5.0).contains(&report.mean_episode_s), "{report:?}");
    assert!((0.5..1.0).contains(&report.mean_uprightness), "{report:?}");
    assert_eq!(report, evaluate(&stand, &policy, 20, 4));
    assert_ne!(report, evaluate(&stand, &policy, 20, 5));
    let task = Arc::new(StandTask::new(&stand, 4));
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..1, 4);
    let motion = record(&mut envs, &policy, "stand", |_, _| ());
    assert!((2..=300).contains(&motion.frames) && motion.rate == 30.0);
}

#[test]
fn choices_that_cannot_be_played_are_refused() {
    assert_eq!(Stand::default().check(), Ok(()));
    assert_eq!(Stand::default().rules.steps(), 300);
    let wrong = |change: fn(&mut Stand)| {
        let mut stand = Stand::default();
        change(&mut stand);
        stand.check().unwrap_err()
    };
    assert!(wrong(|stand| stand.rules.episode_s = 0.0).contains("episode_s"));
    assert!(wrong(|stand| stand.min_push = -1.0).contains("min_push"));
    assert!(wrong(|stand| stand.min_push = 16.0).contains("must not exceed"));
    assert!(wrong(|stand| stand.start_tilt = f32::NAN).contains("start_tilt"));
    let short: Stand = toml::from_str("episode_s = 5.0").unwrap();
    assert_eq!(short.rules.steps(), 150);
}

/// An episode begins with its full length, whatever was left of the one before; others go on.
#[test]
fn a_restart_begins_full_episodes_where_it_is_asked_for() {
    const ENVS: usize = 6;
    let which = [true, false, true, false, false, true];
    for device in [Device::Cpu, Device::from(gpu())] {
        let mut envs = opened(&device, &short(8.0 / 30.0), 0..ENVS, 3);
        let action = envs.rest_action().repeat(ENVS);
        let mut rollout = Rollout::new(&device, ENVS, 10);
        rollout.step(envs.as_mut(), &action);
        let seen = |envs: &mut dyn VecEnv| {
            let mut seen = Array::zeroed(&device, ENVS * OBSERVATION);
            envs.observe(&mut seen, 0);
            seen.read(&device).unwrap()
        };
        let before = seen(envs.as_mut());
        envs.restart(&which).unwrap();
        let after = seen(envs.as_mut());
        for (env, &restarted) in which.iter().enumerate() {
            let row = env * OBSERVATION..(env + 1) * OBSERVATION;
            assert_eq!(after[row.clone()] != before[row], restarted);
        }
        for _ in 0..8 {
            rollout.step(envs.as_mut(), &action);
        }
        let ends = rollout.terminations();
        for env in (0..ENVS).filter(|&env| which[env]) {
            let ends: Vec<u32> = (1..9).map(|step| ends[step * ENVS + env]).collect();
            let mut full = [termination::RUNNING; 8];
            full[7] = termination::TRUNCATED;
            assert_eq!(ends, full);
        }
    }
}
