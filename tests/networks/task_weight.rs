//! The weights of several rewards: an update's weights are those that the last one left.

use super::*;
use anyhow::Result;
use footwork::container::{Section, SectionError};
use footwork::env::{EnvBatch, EnvSpec, Transition, VecEnv};
use footwork::kernels::learn::rollout_moments::scale;
use footwork::rl::Algorithm;
use footwork::rl::gae::RewardSource;
use footwork::rl::ppo::PpoLearner;
use footwork::rl::task_weight::{TaskWeight, TaskWeightConfig, WeightRule};
use footwork::train::config::Preset;
use footwork::train::tasks::find;

/// Environments in which nothing happens: all rewards are 0.
struct Still(EnvSpec);

impl VecEnv for Still {
    fn spec(&self) -> &EnvSpec {
        &self.0
    }

    fn observe(&mut self, _: &mut Array, _: usize) {}

    fn step(&mut self, _: &Array, _: usize, _: Transition) {}

    fn stat_names(&self) -> &'static [&'static str] {
        &["episodes", "successes", "steps", "returns"]
    }

    fn stats(&mut self, _: &mut Array) {}

    fn save(&self, _: &mut Section) -> Result<()> {
        Ok(())
    }

    fn load(&mut self, _: &mut Section) -> Result<(), SectionError> {
        Ok(())
    }
}

fn still() -> EnvBatch {
    let spec = EnvSpec {
        envs: 4,
        agents: 1,
        observation: ObservationSpec {
            vector: 2,
            grid: None,
        },
        style: 0,
        action: 1,
        dt: 0.1,
        bootstrap: 0,
        bootstraps_often: false,
    };
    EnvBatch::new(vec![Box::new(Still(spec))], None)
}

/// A learner of both rewards, whose style is to be 0.5.
fn learner(device: &Device, rule: WeightRule) -> PpoLearner {
    let mut ppo = find("plane").expect("a task").config(Preset::Fast).ppo;
    (ppo.rollout_length, ppo.minibatch_size) = (4, 8);
    let rewards = [(RewardSource::Task, 0.8), (RewardSource::Style, 0.4)];
    let learner = PpoLearner::with_rewards(&ppo, &still(), device, 1, &rewards);
    let config = TaskWeightConfig {
        rule,
        style_reference: 0.5,
    };
    let learner = learner.expect("networks that fit");
    learner.with_task_weight(TaskWeight::new(&config, 2.0))
}

fn saved(learner: &PpoLearner) -> Section {
    let mut section = Section::default();
    learner.save(&mut section).expect("the device is there");
    section
}

/// The weights that the next update is to have, task and style.
fn weights(learner: &PpoLearner) -> [f32; 2] {
    let values = saved(learner).take_finite("value_scale", 2 * scale::FIELDS);
    let values = values.expect("two streams");
    [0, 1].map(|stream| values[stream * scale::FIELDS + scale::WEIGHT])
}

#[test]
fn a_rule_weighs_the_rewards_of_the_next_update() {
    for device in [Device::Cpu, lavapipe()] {
        let mut learner = learner(&device, WeightRule::Pd);
        let mut envs = still();
        // There is no style at all: lambda goes from 2 to 1.45, to 1.4, to 1.35.
        for lambda in [2.0, 1.45, 1.4, 1.35] {
            let wanted = [lambda / (1.0 + lambda), 1.0 / (1.0 + lambda)];
            for (weight, wanted) in weights(&learner).into_iter().zip(wanted) {
                assert!((f64::from(weight) - wanted).abs() < 1e-6);
            }
            let iteration = learner.iterate(&mut envs, 0).expect("an update");
            let told = |name: &str| iteration.loss(name).expect("a curve");
            assert!((told("lambda") - lambda).abs() < 1e-12);
            assert!((told("task_weight") - wanted[0]).abs() < 1e-12);
            assert_eq!(told("style_reward"), 0.0);
        }
    }
}

#[test]
fn fixed_weights_stay_as_they_are() {
    for device in [Device::Cpu, lavapipe()] {
        let mut learner = learner(&device, WeightRule::Fixed);
        let iteration = learner.iterate(&mut still(), 0).expect("an update");
        assert_eq!(weights(&learner), [0.8, 0.4]);
        assert_eq!(iteration.loss("lambda"), None);
    }
}

#[test]
fn a_learner_that_is_loaded_goes_on_with_its_weights() {
    for device in [Device::Cpu, lavapipe()] {
        let mut whole = learner(&device, WeightRule::Pd);
        whole.iterate(&mut still(), 0).expect("an update");
        let policy = whole.policy().expect("the device is there");
        let mut resumed = learner(&device, WeightRule::Pd);
        let loaded = resumed.load(&mut saved(&whole), &policy);
        loaded.expect("what it saved itself");
        for learner in [&mut whole, &mut resumed] {
            learner.iterate(&mut still(), 0).expect("an update");
        }
        assert!(saved(&whole) == saved(&resumed));
    }
}

/// What comes from another training rests until its critic has learned.
#[test]
fn weights_stay_while_the_critic_learns_alone() {
    let mut other = learner(&Device::Cpu, WeightRule::Fixed);
    other.iterate(&mut still(), 0).expect("an update");
    let policy = other.policy().expect("a policy");
    let mut begun = learner(&Device::Cpu, WeightRule::Pd);
    let started = begun.start_from(&policy, &mut saved(&other));
    started.expect("the same networks");
    let mut updates = |count: usize| {
        for _ in 0..count {
            begun.iterate(&mut still(), 0).expect("an update");
        }
        weights(&begun)
    };
    let first = updates(20);
    assert!((first[0] - 2.0 / 3.0).abs() < 1e-6, "{first:?}");
    assert!(updates(1)[0] < first[0]);
}
