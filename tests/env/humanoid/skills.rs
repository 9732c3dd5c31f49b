//! Environments of latents over a frozen low level, here one of random numbers.
//! Oracle: the body's environments, stepped by hand with the low level's policy on the host; the same
//! environments on the other device. Bar: equal bit for bit where the arithmetic is the same.

use crate::support::inputs::{Draw, POISON, close, gpu, same};
use crate::support::low_level::{LATENT, checkpoint};
use footwork::container::Section;
use footwork::env::humanoid::boxing::{Boxing, BoxingTask};
use footwork::env::humanoid::driver::{BodyDriver, DriverState};
use footwork::env::humanoid::punch::{Punch, PunchTask};
use footwork::env::humanoid::task::play::DrivenStep;
use footwork::env::humanoid::task::{CpuHumanoidEnv, EpisodeRules, open};
use footwork::env::{EnvBatch, Transition, VecEnv, termination};
use footwork::gpu::{Array, Device};
use footwork::motion::synthetic::perform_walk;
use footwork::nn::Policy;
use footwork::physics::motion_library::MotionLibrary;
use footwork::physics::scenes;
use footwork::ranks::Ranks;
use footwork::rl::Algorithm;
use footwork::rl::ase::{
    FrozenLowLevel, HighLevelDriver, HighLevelEnv, LowLevel, STEPS_PER_DECISION,
};
use footwork::rl::gae::RewardSource;
use footwork::rl::ppo::PpoLearner;
use footwork::train::config::{Base, Preset};
use footwork::train::low_level;
use footwork::train::tasks::find;
use std::ops::Range;
use std::sync::{Arc, LazyLock};

/// The preset of a policy that steers a low level.
const STEERS: Base = Base {
    preset: Preset::Fast,
    steers: true,
    envs: None,
};

static LIBRARY: LazyLock<Arc<MotionLibrary>> = LazyLock::new(|| {
    let model = Arc::new(scenes::humanoid());
    let (clips, roles) = perform_walk(1, 6.0, 1.2);
    Arc::new(MotionLibrary::of(&clips, &roles, &model).expect("the performer fits the body"))
});

/// One whose discriminator has an encoder, and one whose discriminator is shown the latents.
static LOW_LEVELS: LazyLock<[Arc<FrozenLowLevel>; 2]> = LazyLock::new(|| {
    let envs = bodies(&Device::Cpu, 0..1, 1.0);
    let folder = tempfile::tempdir().unwrap();
    [LowLevel::Ase, LowLevel::PerClip].map(|kind| {
        let path = folder.path().join("low.ckpt");
        let checkpoint = checkpoint(kind, envs.spec().style, &envs.rest_action(), 5);
        checkpoint.save(&path).unwrap();
        Arc::new(low_level::load(&path).unwrap())
    })
});

fn task(episode_s: f32) -> Arc<PunchTask> {
    let punch = Punch {
        rules: EpisodeRules {
            episode_s,
            ..EpisodeRules::default()
        },
        ..Punch::default()
    };
    Arc::new(PunchTask::new(&punch, false, &LIBRARY, 3))
}

fn bodies(device: &Device, envs: Range<usize>, episode_s: f32) -> Box<dyn VecEnv> {
    open(device, task(episode_s), envs, 3).unwrap()
}

/// Rows of fighters, two an environment.
fn fighters(rows: Range<usize>, episode_s: f32) -> Box<dyn VecEnv> {
    let boxing = Boxing {
        rules: EpisodeRules {
            episode_s,
            ..EpisodeRules::default()
        },
        ..Boxing::default()
    };
    let task = Arc::new(BoxingTask::new(&boxing, &LIBRARY, 3));
    open(&Device::Cpu, task, rows.start / 2..rows.end / 2, 3).unwrap()
}

fn steered(device: &Device, envs: Range<usize>, episode_s: f32) -> HighLevelEnv {
    HighLevelEnv::new(bodies(device, envs, episode_s), &LOW_LEVELS[1], device).unwrap()
}

/// What some steps, or decisions, came to.
struct Columns {
    device: Device,
    reward: Array,
    style_reward: Array,
    termination: Array<u32>,
    group: Array<u32>,
    final_observation: Array,
    steps: usize,
}

impl Columns {
    /// Room for so many steps.
    fn new(device: &Device, envs: &dyn VecEnv, steps: usize) -> Columns {
        let (rows, dim) = (envs.spec().rows(), envs.spec().observation.dim());
        let poison = |len: usize| Array::from_slice(device, &vec![POISON; len]);
        Columns {
            reward: poison(steps * rows),
            style_reward: poison(steps * rows),
            termination: Array::from_slice(device, &vec![u32::MAX; steps * rows]),
            group: Array::from_slice(device, &vec![u32::MAX; steps * rows]),
            final_observation: poison(steps * rows * dim),
            device: device.clone(),
            steps: 0,
        }
    }

    fn step(&mut self, envs: &mut dyn VecEnv, action: &[f32]) {
        let out = Transition {
            step: self.steps,
            reward: &mut self.reward,
            style_reward: &mut self.style_reward,
            termination: &mut self.termination,
            group: &mut self.group,
            final_observation: &mut self.final_observation,
        };
        // Actions begin somewhere in their array.
        let action = [&[f32::NAN; 3][..], action].concat();
        envs.step(&Array::from_slice(&self.device, &action), 3, out);
        self.steps += 1;
    }

    /// Rewards, style rewards and final observations; terminations and groups.
    fn read(&self) -> ([Vec<f32>; 3], [Vec<u32>; 2]) {
        let floats = [&self.reward, &self.style_reward, &self.final_observation];
        let wholes = [&self.termination, &self.group];
        (
            floats.map(|column| column.read(&self.device).unwrap()),
            wholes.map(|column| column.read(&self.device).unwrap()),
        )
    }
}

fn observed(device: &Device, envs: &mut dyn VecEnv) -> Vec<f32> {
    let numbers = envs.spec().rows() * envs.spec().observation.dim();
    let mut out = Array::zeroed(device, numbers);
    envs.observe(&mut out, 0);
    out.read(device).unwrap()
}

/// Decisions, the first of a row of zeros.
fn decisions(rows: usize, count: usize, seed: u32) -> Vec<Vec<f32>> {
    let mut draw = Draw::new(seed);
    let mut all: Vec<Vec<f32>> = (0..count).map(|_| draw.normals(rows * LATENT)).collect();
    all[0][..LATENT].fill(0.0);
    all
}

#[test]
fn its_dimensions_are_those_of_latents() {
    let body = *bodies(&Device::Cpu, 0..3, 1.0).spec();
    let envs = steered(&Device::Cpu, 0..3, 1.0);
    let spec = envs.spec();
    assert_eq!(spec.action, LATENT);
    assert_eq!(
        (spec.observation, spec.style),
        (body.observation, body.style)
    );
    assert!((spec.dt - 5.0 * body.dt).abs() < 1e-6);
    assert!(envs.rest_action().is_empty());
}

/// A decision is what its steps come to up to the first end, and its final observation is that of the end.
#[test]
fn decisions_are_five_steps_of_the_low_level() {
    let alone = || bodies(&Device::Cpu, 5..5 + ROWS, 0.3);
    let in_pairs = || fighters(6..6 + ROWS, 0.3);
    type Opened<'a> = &'a dyn Fn() -> Box<dyn VecEnv>;
    let cases: [(&Arc<FrozenLowLevel>, Opened); 3] = [
        (&LOW_LEVELS[0], &alone),
        (&LOW_LEVELS[1], &alone),
        (&LOW_LEVELS[1], &in_pairs),
    ];
    for (low_level, open) in cases {
        let mut hand = ByHand {
            inner: open(),
            low_level,
        };
        let inner = open();
        let mut envs = HighLevelEnv::new(inner, low_level, &Device::Cpu).unwrap();
        let mut got = Columns::new(&Device::Cpu, &envs, 4);
        let mut found = Vec::new();
        for decision in decisions(ROWS, 4, 1) {
            let inner = hand.inner.as_mut();
            let (seen, wanted) = (
                observed(&Device::Cpu, &mut envs),
                observed(&Device::Cpu, inner),
            );
            same("observation", &seen, &wanted);
            got.step(&mut envs, &decision);
            found.extend(hand.decide(&decision));
        }
        let dim = envs.spec().observation.dim();
        let ([rewards, styles, finals], [ends, groups]) = got.read();
        for (at, row) in found.iter().enumerate() {
            close("reward", &rewards[at..=at], &[row.reward], |_| 1e-5);
            close("style", &styles[at..=at], &[row.style / row.steps], |_| {
                1e-4
            });
            assert_eq!((ends[at], groups[at]), (row.end, row.group));
            let kept = &finals[at * dim..][..dim];
            match &row.last {
                Some(last) => same("final observation", kept, last),
                None => assert!(kept.iter().all(|&number| number == POISON)),
            }
        }
        let ended = found.iter().filter(|row| row.last.is_some()).count();
        let counted: f32 = found.iter().map(|row| row.steps).sum();
        assert!(
            ended > ROWS && counted < (5 * found.len()) as f32,
            "{ended}, {counted}"
        );
    }
}

/// Environments of the test by hand.
const ROWS: usize = 40;

/// Environments of the body, stepped by hand.
struct ByHand<'a> {
    inner: Box<dyn VecEnv>,
    low_level: &'a FrozenLowLevel,
}

/// A decision of a row.
#[derive(Clone, Default)]
struct Decision {
    reward: f32,
    style: f32,
    steps: f32,
    end: u32,
    group: u32,
    last: Option<Vec<f32>>,
}

impl ByHand<'_> {
    fn decide(&mut self, action: &[f32]) -> Vec<Decision> {
        let latents: Vec<Vec<f32>> = action.chunks_exact(LATENT).map(unit).collect();
        let mut rows = vec![Decision::default(); ROWS];
        for _ in 0..STEPS_PER_DECISION {
            self.step(&latents, &mut rows);
        }
        rows
    }

    fn step(&mut self, latents: &[Vec<f32>], rows: &mut [Decision]) {
        let inner = self.inner.as_mut();
        let (dim, style) = (inner.spec().observation.dim(), inner.spec().style);
        let before = observed(&Device::Cpu, inner);
        let input = before.chunks_exact(dim).zip(latents);
        let input = input.flat_map(|(row, latent)| row[..style].iter().chain(latent));
        let action = self
            .low_level
            .policy
            .mean(&input.copied().collect::<Vec<f32>>());
        let mut step = Columns::new(&Device::Cpu, inner, 1);
        step.step(inner, &action);
        let after = observed(&Device::Cpu, inner);
        let ([rewards, _, finals], [ends, groups]) = step.read();
        for (at, row) in rows.iter_mut().enumerate() {
            if row.last.is_some() {
                continue;
            }
            let ended = ends[at] != termination::RUNNING;
            let now = if ended { &finals } else { &after };
            let moments = [&before, now].map(|of| &of[at * dim..][..style]);
            row.style += self.low_level.discriminator.reward(moments, &latents[at]);
            row.reward += rewards[at] / STEPS_PER_DECISION as f32;
            row.steps += 1.0;
            (row.end, row.group) = (ends[at], groups[at]);
            row.last = ended.then(|| finals[at * dim..][..dim].to_vec());
        }
    }
}

/// The definition of a latent.
fn unit(action: &[f32]) -> Vec<f32> {
    let within: Vec<f32> = action.iter().map(|x| x.clamp(-1.0, 1.0)).collect();
    let square: f32 = within.iter().map(|x| x * x).sum();
    match square == 0.0 {
        true => (0..LATENT).map(|k| f32::from(u8::from(k == 0))).collect(),
        false => within.iter().map(|x| x * (1.0 / square.sqrt())).collect(),
    }
}

#[test]
fn the_gpu_decides_as_the_cpu_does() {
    let (cpu, gpu) = (Device::Cpu, Device::from(gpu()));
    let rows = 70;
    let [one, other] = [&cpu, &gpu].map(|device| {
        let mut envs = steered(device, 5..5 + rows, 0.3);
        let mut columns = Columns::new(device, &envs, 2);
        for decision in decisions(rows, 2, 2) {
            columns.step(&mut envs, &decision);
        }
        (columns.read(), observed(device, &mut envs))
    });
    let ((floats, wholes), observation) = one;
    let ((gpu_floats, gpu_wholes), gpu_observation) = other;
    assert_eq!(wholes, gpu_wholes);
    assert!(wholes[0].contains(&termination::TRUNCATED));
    let near = |what: &str, a: &[f32], b: &[f32]| {
        for (at, (a, b)) in a.iter().zip(b).enumerate() {
            // Speeds of joints are of the order of ten.
            assert!(
                (a - b).abs() < 3e-2 * (1.0 + a.abs()),
                "{what} {at}: {a} {b}"
            );
        }
    };
    let names = ["reward", "style reward", "final observation"];
    for (name, pair) in names.iter().zip(floats.iter().zip(&gpu_floats)) {
        near(name, pair.0, pair.1);
    }
    near("observation", &observation, &gpu_observation);
}

#[test]
fn a_saved_state_decides_on_as_if_nothing_had_happened() {
    let device = Device::Cpu;
    let mut original = steered(&device, 2..11, 0.5);
    Columns::new(&device, &original, 1).step(&mut original, &decisions(9, 1, 3)[0]);
    let mut section = Section::default();
    original.save(&mut section).unwrap();
    let mut restored = steered(&device, 2..11, 0.5);
    restored.load(&mut section).unwrap();
    let [a, b] = [&mut original, &mut restored].map(|envs| {
        let mut columns = Columns::new(&device, envs, 2);
        for decision in decisions(9, 2, 4) {
            columns.step(envs, &decision);
        }
        columns.read()
    });
    assert!(a == b);
}

/// The mean of a policy drives bodies as it drives the environments that it learns in.
#[test]
fn a_driver_holds_latents_for_a_decision() {
    let device = Device::Cpu;
    let mut envs = steered(&device, 0..1, 10.0);
    let spec = *envs.spec();
    let config = find("punch").unwrap().config_of(STEERS);
    let network = &config.ppo.network;
    let mut policy = Policy::new(network, &spec.observation, spec.action, 1).unwrap();
    policy.parameters = policy.networks().init(1, -1.0, &[0.3; LATENT]);
    let driver = HighLevelDriver {
        policy: policy.clone(),
        low_level: LOW_LEVELS[1].clone(),
    };
    let mut body = CpuHumanoidEnv::unstaggered(task(10.0), 0..1, 3);
    let (mut step, mut state) = (DrivenStep::new(&body), DriverState::default());
    let mut columns = Columns::new(&device, &envs, 3);
    for _ in 0..3 {
        let seen = observed(&device, &mut envs);
        columns.step(&mut envs, &policy.mean(&seen));
        let mut sum = 0.0;
        for held in 0..STEPS_PER_DECISION {
            let before = state.clone();
            step.play(&mut body, &driver, &mut state);
            assert_eq!(held > 0, before.latents == state.latents);
            sum += step.reward.host()[0] / 5.0;
            // The same state and observation again: the same action.
            let mut again = before;
            let seen = step.observation.host();
            let action = driver.act(seen, &mut again);
            assert_eq!((action.len(), &again), (28, &state));
        }
        let reward = columns.reward.host()[columns.steps - 1];
        assert!((reward - sum).abs() < 1e-5, "{reward} {sum}");
        same(
            "observation",
            &observed(&device, &mut envs),
            &observed(&device, &mut body),
        );
    }
}

/// Whatever the high level learns, the low level is what it was.
#[test]
fn a_frozen_low_level_stays_as_it_is() {
    let device = Device::Cpu;
    let before = LOW_LEVELS[1].fingerprint();
    assert_ne!(before, LOW_LEVELS[0].fingerprint());
    let open = || {
        EnvBatch::open(&device, &Ranks::alone(), 12, None, |part| {
            Ok(Box::new(steered(&device, part, 1.0)) as Box<dyn VecEnv>)
        })
        .unwrap()
    };
    let mut envs = open();
    let mut ppo = find("punch").unwrap().config_of(STEERS).ppo;
    (ppo.rollout_length, ppo.minibatch_size) = (4, 16);
    let rewards = [(RewardSource::Task, 0.9), (RewardSource::Style, 0.1)];
    let mut learner = PpoLearner::with_rewards(&ppo, &envs, &device, 1, &rewards).unwrap();
    let first = learner.policy().unwrap().parameters;
    for update in 0..3 {
        let iteration = learner.iterate(&mut envs, 48 * update).unwrap();
        let style = iteration
            .losses
            .iter()
            .find(|(name, _)| *name == "style_reward");
        assert!(style.is_some_and(|(_, mean)| *mean > 0.0), "{style:?}");
    }
    assert_ne!(learner.policy().unwrap().parameters, first);
    assert_eq!(LOW_LEVELS[1].fingerprint(), before);
    // The environments' own copies: from the same state, they do what new ones do.
    let mut fresh = open();
    let saved = envs.save().unwrap();
    fresh
        .load(|name| {
            let found = saved.iter().find(|(other, _)| other == name);
            Ok(found.expect("a section").1.clone())
        })
        .unwrap();
    for (part, (used, new)) in envs.parts.iter_mut().zip(&mut fresh.parts).enumerate() {
        let [used, new] = [used, new].map(|envs| {
            let mut columns = Columns::new(&device, envs.as_ref(), 2);
            for decision in decisions(envs.spec().rows(), 2, part as u32) {
                columns.step(envs.as_mut(), &decision);
            }
            columns.read()
        });
        assert!(used == new);
    }
}
