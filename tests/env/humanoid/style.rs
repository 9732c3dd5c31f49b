//! The tasks `imitate`, `punch`, `joystick`, `track` and `box`.
//! Oracle: the same environments on the other device, or from a saved state; recorded motion. Bar: equal bit
//! for bit on one device; between devices what the physics' rounding grows to.

use crate::support::inputs::{Draw, POISON, gpu};
use footwork::container::Section;
use footwork::env::humanoid::boxing::{Boxing, BoxingTask};
use footwork::env::humanoid::imitate::ImitateTask;
use footwork::env::humanoid::punch::{Punch, PunchTask};
use footwork::env::humanoid::recorded::{demonstrations, observe};
use footwork::env::humanoid::task::{CpuHumanoidEnv, EpisodeRules, HumanoidTask, open};
use footwork::env::humanoid::track::{TrackTask, Tracking};
use footwork::env::{Transition, VecEnv, termination};
use footwork::gpu::{Array, Device};
use footwork::motion::synthetic::{perform_boxing, perform_walk};
use footwork::physics::motion_library::MotionLibrary;
use footwork::physics::scenes;
use footwork::ranks::Ranks;
use footwork::rl::amp::{Amp, Discriminator, DiscriminatorLoss, FrozenDiscriminator, LatentUse};
use footwork::rl::rollout::Rollout;
use std::sync::{Arc, LazyLock};

pub static LIBRARY: LazyLock<Arc<MotionLibrary>> = LazyLock::new(|| {
    let model = Arc::new(scenes::humanoid());
    let (mut clips, roles) = perform_walk(1, 6.0, 1.2);
    clips.extend(perform_boxing(1, 0.4).0);
    Arc::new(MotionLibrary::of(&clips, &roles, &model).expect("the performer fits the body"))
});

pub fn rules(episode_s: f32) -> EpisodeRules {
    EpisodeRules {
        episode_s,
        ..EpisodeRules::default()
    }
}

/// The tasks, with episodes of so many seconds.
fn tasks(episode_s: f32) -> [Arc<dyn HumanoidTask>; 5] {
    let punch = Punch {
        rules: rules(episode_s),
        after_hit_s: 0.2,
        ..Punch::default()
    };
    let track = Tracking {
        rules: rules(episode_s),
        ..Tracking::default()
    };
    let boxing = Boxing {
        rules: rules(episode_s),
        ..Boxing::default()
    };
    [
        Arc::new(ImitateTask::new(&rules(episode_s), &LIBRARY, 3)),
        Arc::new(PunchTask::new(&punch, false, &LIBRARY, 3)),
        Arc::new(PunchTask::new(&punch, true, &LIBRARY, 3)),
        Arc::new(TrackTask::new(&track, &LIBRARY, 3)),
        Arc::new(BoxingTask::new(&boxing, &LIBRARY, 3)),
    ]
}

/// The task `imitate`, with episodes of so many seconds.
pub fn imitate(episode_s: f32) -> Arc<dyn HumanoidTask> {
    let [imitate, ..] = tasks(episode_s);
    imitate
}

/// What some steps came to.
#[derive(PartialEq, Debug)]
pub struct Played {
    pub observations: Vec<f32>,
    pub rewards: Vec<f32>,
    pub ends: Vec<u32>,
    pub groups: Vec<u32>,
    pub finals: Vec<f32>,
}

/// Plays steps of actions near the pose that the environments rest in.
pub fn play(device: &Device, envs: &mut dyn VecEnv, steps: usize, seed: u32) -> Played {
    let (spec, rest) = (*envs.spec(), envs.rest_action());
    let (rows, dim) = (spec.rows(), spec.observation.dim());
    let (mut reward, mut finals) = (
        Array::zeroed(device, steps * rows),
        Array::zeroed(device, steps * rows * dim),
    );
    let mut ends = Array::zeroed(device, steps * rows);
    let mut groups = Array::zeroed(device, steps * rows);
    let mut draw = Draw::new(seed);
    let mut observations = Vec::new();
    for step in 0..steps {
        let mut seen = Array::from_slice(device, &vec![POISON; rows * dim]);
        envs.observe(&mut seen, 0);
        observations.extend(seen.read(device).unwrap());
        let actions = std::iter::repeat_n(&rest, rows).flatten();
        let actions: Vec<f32> = actions
            .map(|action| action + 0.05 * draw.normal())
            .collect();
        let out = Transition {
            step,
            reward: &mut reward,
            style_reward: &mut Array::zeroed(device, steps * rows),
            termination: &mut ends,
            group: &mut groups,
            final_observation: &mut finals,
        };
        envs.step(&Array::from_slice(device, &actions), 0, out);
    }
    Played {
        observations,
        rewards: reward.read(device).unwrap(),
        ends: ends.read(device).unwrap(),
        groups: groups.read(device).unwrap(),
        finals: finals.read(device).unwrap(),
    }
}

#[test]
fn the_gpu_plays_what_the_cpu_plays() {
    let (cpu, gpu) = (Device::Cpu, Device::from(gpu()));
    for task in tasks(0.3) {
        let [one, other] = [&cpu, &gpu].map(|device| {
            let mut envs = open(device, task.clone(), 5..75, 3).unwrap();
            play(device, envs.as_mut(), 8, 1)
        });
        assert_eq!(one.ends, other.ends);
        assert!(one.ends.contains(&termination::TRUNCATED));
        let close = |a: &[f32], b: &[f32]| {
            for (at, (a, b)) in a.iter().zip(b).enumerate() {
                // Speeds of joints are of the order of ten.
                assert!((a - b).abs() < 3e-2 * (1.0 + a.abs()), "{at}: {a} {b}");
            }
        };
        close(&one.observations, &other.observations);
        close(&one.finals, &other.finals);
        close(&one.rewards, &other.rewards);
        assert_eq!(one.groups, other.groups);
    }
}

#[test]
fn a_saved_state_goes_on_as_if_nothing_had_happened() {
    for device in [Device::Cpu, Device::from(gpu())] {
        for task in tasks(0.5) {
            let opened = || open(&device, task.clone(), 2..11, 5).unwrap();
            let mut original = opened();
            play(&device, original.as_mut(), 6, 2);
            let mut section = Section::default();
            original.save(&mut section).unwrap();
            let mut restored = opened();
            restored.load(&mut section).unwrap();
            let [a, b] =
                [original.as_mut(), restored.as_mut()].map(|envs| play(&device, envs, 6, 3));
            assert!(a == b);
        }
    }
}

/// What an episode begins in is a recorded moment, but for the lift out of the ground: a discriminator could
/// not tell them apart.
#[test]
fn a_reset_is_a_recorded_moment() {
    let [imitate, ..] = tasks(10.0);
    let mut envs = open(&Device::Cpu, imitate.clone(), 0..64, 1).unwrap();
    let style = envs.spec().style;
    let mut seen = Array::zeroed(&Device::Cpu, 64 * style);
    envs.observe(&mut seen, 0);
    let recorded = demonstrations(&LIBRARY, |_, _| Vec::new());
    assert_eq!(recorded.dim, 2 * style);
    for row in seen.host().chunks_exact(style) {
        let distance = |window: &[f32]| {
            let pairs = row.iter().zip(window).skip(1);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max)
        };
        let windows = recorded.windows.chunks_exact(recorded.dim);
        let nearest = windows.map(distance).fold(f32::INFINITY, f32::min);
        // Starts are drawn between frames, too; fists are fast.
        assert!(nearest < 6.0, "{nearest}");
    }
    // Start states have their own velocities: a moment seen at rest would be another.
    let model = LIBRARY.model();
    let start = &imitate.start_states()[..model.nq() + model.nv()];
    let (q, v) = start.split_at(model.nq());
    assert!(v.iter().any(|speed| speed.abs() > 0.1));
    assert_ne!(
        observe(model, q, v),
        observe(model, q, &vec![0.0; model.nv()])
    );
}

#[test]
fn demonstrations_are_drawn_by_weight() {
    let recorded = demonstrations(&LIBRARY, |_, _| Vec::new());
    let boundary = (6.0 * 30.0) as u32 - 1;
    let share = LIBRARY.share(0);
    let mut draw = Draw::new(4);
    let walks = (0..20_000)
        .filter(|_| recorded.draw(draw.bits()[0]) < boundary)
        .count();
    assert!(
        (walks as f32 / 20_000.0 - share).abs() < 0.02,
        "{walks} of 20000, {share}"
    );
    assert!(recorded.windows.iter().all(|value| value.is_finite()));
}

/// What a discriminator gives once it learns no more is what it gave.
#[test]
fn a_frozen_discriminator_rewards_as_it_did() {
    let [imitate, ..] = tasks(10.0);
    let mut envs = open(&Device::Cpu, imitate, 0..6, 1).unwrap();
    let (spec, rest, steps) = (*envs.spec(), envs.rest_action(), 4);
    let mut rollout = Rollout::new(&Device::Cpu, &spec, steps, 1);
    rollout.action = Array::Host(rest.repeat(rollout.samples()));
    for step in 0..steps {
        rollout.observe(envs.as_mut(), step);
        rollout.step(envs.as_mut(), step);
    }
    rollout.observe(envs.as_mut(), steps);
    let running = |&end: &u32| end == termination::RUNNING;
    assert!(rollout.termination.host().iter().all(running));
    let recorded = Arc::new(demonstrations(&LIBRARY, |_, _| Vec::new()));
    let mut rollouts = [rollout];
    for loss in [DiscriminatorLoss::Bce, DiscriminatorLoss::Hinge] {
        let amp = Amp {
            loss,
            heads: 3,
            hidden: vec![32, 16],
            minibatch_size: 64,
            ..Amp::default()
        };
        let samples = rollouts[0].samples();
        let learning = Discriminator::new(
            &amp,
            LatentUse::None,
            &recorded,
            &Device::Cpu,
            &Ranks::alone(),
            samples,
            1,
        );
        let mut learning = learning.unwrap();
        learning.reward(&mut rollouts);
        learning.learn().unwrap();
        learning.reward(&mut rollouts);
        let (mut own, mut section) = (Section::default(), Section::default());
        learning.save(&mut own).unwrap();
        section.put_section("discriminator", own);
        let load = |section: &mut Section, style: usize| {
            FrozenDiscriminator::load(&amp, LatentUse::None, section, style)
        };
        let frozen = load(&mut section.clone(), spec.style).unwrap();
        let [rollout] = &rollouts;
        let moments = rollout.observation.host().chunks_exact(spec.style);
        let after = moments.clone().skip(spec.envs);
        let given = rollout.style_reward.host();
        for ((before, after), given) in moments.zip(after).zip(given) {
            let reward = frozen.reward([before, after], &[]);
            assert!((reward - given).abs() < 1e-4, "{reward} {given}");
            assert!((0.0..=1.0).contains(&frozen.share(reward)));
        }
        assert!(load(&mut section, spec.style + 1).is_err());
        assert!(load(&mut Section::default(), spec.style).is_err());
    }
}

/// A box that has been put elsewhere is as one that always stood there.
#[test]
fn a_moved_target_stands_where_it_was_put() {
    let [_, _, joystick, ..] = tasks(10.0);
    let mut envs = CpuHumanoidEnv::unstaggered(joystick, 0..2, 4);
    let rest = Array::Host(envs.rest_action().repeat(2));
    let still = envs.batch.worlds[0].state.q.clone();
    envs.move_target(1, [3.0, -4.0]);
    assert_eq!(envs.batch.worlds[0].state.q, still);
    let spec = *envs.spec();
    let (mut reward, mut finals) = (
        Array::zeroed(&Device::Cpu, 2),
        Array::zeroed(&Device::Cpu, 2 * spec.observation.dim()),
    );
    let mut ends = Array::zeroed(&Device::Cpu, 2);
    let out = Transition {
        step: 0,
        reward: &mut reward,
        style_reward: &mut Array::zeroed(&Device::Cpu, 2),
        termination: &mut ends,
        group: &mut Array::zeroed(&Device::Cpu, 2),
        final_observation: &mut finals,
    };
    envs.step(&rest, 0, out);
    let q = &envs.batch.worlds[1].state.q;
    let target = &q[q.len() - 7..];
    assert!((target[0] - 3.0).abs() < 1e-3 && (target[1] + 4.0).abs() < 1e-3);
    assert!((target[2] - 0.9).abs() < 5e-3 && target[3] > 0.999);
}

/// The box stands where it was put until somebody touches it.
#[test]
fn the_target_stands_by_itself() {
    let punch = Punch {
        near_share: 0.0,
        distance: [5.0, 10.0],
        ..Punch::default()
    };
    let task = Arc::new(PunchTask::new(&punch, false, &LIBRARY, 3));
    let mut envs = open(&Device::Cpu, task, 0..32, 1).unwrap();
    let played = play(&Device::Cpu, envs.as_mut(), 40, 6);
    assert!(!played.ends.contains(&termination::SUCCESS));
    assert!(
        played.groups.iter().all(|&group| group == 0),
        "far, and never hit"
    );
    let dim = envs.spec().observation.dim();
    for row in played.observations.chunks_exact(dim) {
        // Height of the box, and its up axis.
        assert!((row[105 + 5] - 0.9).abs() < 0.01 && (row[105 + 12] - 1.0).abs() < 1e-3);
    }
}
