//! Skills of a toy body, a pendulum that turns: recordings turn either way, and latents must come to say which.
//! Oracle: the direction of turning under latents that are kept. Bar: a latent turns the same way in 85 % of
//! the steps, and both ways have theirs.

use footwork::container::{Section, SectionError};
use footwork::env::{
    Demonstrations, EnvBatch, EnvSpec, ObservationSpec, Transition, VecEnv, termination,
};
use footwork::gpu::{Array, Device};
use footwork::kernels::rng::{random4, uniform01};
use footwork::nn::layer::Activation;
use footwork::nn::network::NetworkConfig;
use footwork::rl::Algorithm;
use footwork::rl::amp::{Amp, AmpLearner};
use footwork::rl::ase::{Ase, LatentDraw, LatentEnv, LowLevel};
use footwork::rl::ppo::Ppo;
use footwork::train::config::Preset;
use footwork::train::tasks::find;
use std::f32::consts::TAU;
use std::sync::Arc;

const ENVS: usize = 64;
const DT: f32 = 0.1;
/// Speed of the recordings, rad/s.
const SPEED: f32 = 1.5;

/// Pendulums without weight, of which an action is the torque. An episode is 50 steps.
struct Pendulums {
    spec: EnvSpec,
    /// Angle, rad, and speed, rad/s.
    states: Vec<[f32; 2]>,
    steps: u32,
}

fn observed([angle, speed]: [f32; 2]) -> [f32; 3] {
    [angle.cos(), angle.sin(), speed]
}

fn start(env: usize, clock: u32) -> [f32; 2] {
    let [angle, way, ..] = random4(5, env as u32, clock, 9);
    let way = if uniform01(way) < 0.5 { -1.0 } else { 1.0 };
    [TAU * uniform01(angle), way * SPEED]
}

impl Pendulums {
    fn new() -> Pendulums {
        Pendulums {
            spec: EnvSpec {
                envs: ENVS,
                agents: 1,
                observation: ObservationSpec {
                    vector: 3,
                    grid: None,
                },
                style: 3,
                action: 1,
                dt: DT,
                bootstrap: 1 << termination::TRUNCATED,
                bootstraps_often: true,
            },
            states: (0..ENVS).map(|env| start(env, 0)).collect(),
            steps: 0,
        }
    }
}

impl VecEnv for Pendulums {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        let seen: Vec<f32> = self
            .states
            .iter()
            .flat_map(|&state| observed(state))
            .collect();
        out.host_mut()[at..][..seen.len()].copy_from_slice(&seen);
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        self.steps += 1;
        let first = out.step * ENVS;
        for (env, state) in self.states.iter_mut().enumerate() {
            let torque = action.host()[at + env].clamp(-1.0, 1.0);
            let speed = state[1] + DT * (6.0 * torque - state[1]);
            *state = [state[0] + DT * speed, speed];
            let over = (self.steps as usize + env).is_multiple_of(50);
            let end = if over {
                termination::TRUNCATED
            } else {
                termination::RUNNING
            };
            out.termination.host_mut()[first + env] = end;
            out.reward.host_mut()[first + env] = 0.0;
            if over {
                let last = &mut out.final_observation.host_mut()[3 * (first + env)..][..3];
                last.copy_from_slice(&observed(*state));
                *state = start(env, self.steps);
            }
        }
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &["episodes"]
    }

    fn stats(&mut self, out: &mut Array) {
        out.host_mut().fill(0.0);
    }

    fn save(&self, _: &mut Section) -> anyhow::Result<()> {
        Ok(())
    }

    fn load(&mut self, _: &mut Section) -> Result<(), SectionError> {
        Ok(())
    }
}

fn recordings() -> Demonstrations {
    let windows = (0..400).flat_map(|number| {
        let way = if number % 2 == 0 { -1.0 } else { 1.0 };
        let angle = TAU * number as f32 / 400.0;
        let moment = |steps: f32| observed([angle + way * SPEED * DT * steps, way * SPEED]);
        [moment(0.0), moment(1.0)].concat()
    });
    Demonstrations::new(6, windows.collect(), &[1.0; 400])
}

fn learner(envs: &EnvBatch, ase: &Ase) -> AmpLearner {
    let preset = find("imitate").unwrap().config(Preset::Fast);
    let hidden = vec![32, 32];
    let ppo = Ppo {
        envs: ENVS,
        rollout_length: 16,
        minibatch_size: 256,
        init_log_std: -1.0,
        network: NetworkConfig {
            hidden: hidden.clone(),
            activation: Activation::Relu,
            ..preset.ppo.network.clone()
        },
        ..preset.ppo
    };
    let amp = Amp {
        hidden,
        minibatch_size: 128,
        replay_per_update: 256,
        replay_capacity: 2048,
        style_weight: 0.5,
        ..Amp::default()
    };
    let recordings = Arc::new(recordings());
    AmpLearner::new(
        &ppo,
        &amp,
        &ase.rewards(),
        &recordings,
        envs,
        &Device::Cpu,
        1,
    )
    .unwrap()
}

/// How a policy turns under latents that are kept: of each, the fraction of steps one way.
fn turning(learner: &AmpLearner, latent: usize) -> Vec<f32> {
    let policy = learner.policy().unwrap();
    let mut envs = Pendulums::new();
    let latents: Vec<Vec<f32>> = (0..ENVS)
        .map(|env| {
            let angle = TAU * (env / 4) as f32 / 16.0;
            let mut direction = vec![0.0; latent];
            (direction[0], direction[1]) = (angle.cos(), angle.sin());
            direction
        })
        .collect();
    let mut forward = vec![0.0; ENVS];
    for step in 0..40 {
        let seen = envs.states.iter().zip(&latents);
        let seen: Vec<f32> = seen
            .flat_map(|(&state, latent)| [&observed(state)[..], latent].concat())
            .collect();
        let action = Array::Host(policy.mean(&seen));
        let out = Transition {
            step: 0,
            reward: &mut Array::Host(vec![0.0; ENVS]),
            style_reward: &mut Array::Host(vec![0.0; ENVS]),
            termination: &mut Array::Host(vec![0; ENVS]),
            group: &mut Array::Host(vec![0; ENVS]),
            final_observation: &mut Array::Host(vec![0.0; 3 * ENVS]),
        };
        envs.step(&action, 0, out);
        if step >= 20 {
            for (forward, state) in forward.iter_mut().zip(&envs.states) {
                *forward += f32::from(u8::from(state[1] > 0.0)) / 20.0;
            }
        }
    }
    forward
}

#[test]
fn latents_come_to_mean_ways_of_turning() {
    let ase = Ase {
        low_level: LowLevel::Ase,
        latent: 2,
        kept_steps: [1, 50],
        ..Ase::default()
    };
    let draw = LatentDraw::new(&ase, &[1.0]);
    let inner = Box::new(Pendulums::new());
    let envs = LatentEnv::new(inner, &draw, &Device::Cpu, 0, 1);
    let mut envs = EnvBatch::new(vec![Box::new(envs)], None);
    let mut learner = learner(&envs, &ase);
    let mut cosine = 0.0;
    for update in 0..500 {
        let found = learner.iterate(&mut envs, update * 1024).unwrap();
        let own = found
            .losses
            .iter()
            .find(|(name, _)| *name == "encoder_cosine");
        cosine = own.unwrap().1;
    }
    let forward = turning(&learner, 2);
    // Every latent has four pendulums.
    let ways = forward
        .chunks_exact(4)
        .map(|own| own.iter().sum::<f32>() / 4.0);
    let ways: Vec<f32> = ways.collect();
    let same = ways.iter().map(|way| way.max(1.0 - way)).sum::<f32>() / 16.0;
    let one_way = ways.iter().filter(|way| **way > 0.5).count();
    assert!(cosine > 0.5, "{cosine}");
    assert!(same > 0.85 && (4..=12).contains(&one_way), "{ways:?}");
}
