//! A task of your own: carts that are pushed to the middle of a track and stopped there.
//!
//! You learn what an environment has to do to be learned in: [`VecEnv`].
//!
//! `cargo run --release --no-default-features --features train --example task_of_your_own`

use footwork::prelude::*;
use footwork::ranks::Ranks;
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// Length of a step, s.
const DT: f32 = 0.05;
/// Steps after which an episode is truncated.
const MAX_STEPS: u32 = 100;
/// The strongest push, m/s^2.
const STRONGEST: f32 = 4.0;
/// From the middle of the track to its ends, m.
const END: f32 = 2.0;

/// A cart on its track.
#[derive(Clone, Copy)]
struct Cart {
    /// m
    position: f32,
    /// m/s
    velocity: f32,
    steps: u32,
    /// Rewards of its episode.
    earned: f32,
}

impl Cart {
    /// The start of an episode: anywhere, at rest.
    fn start(random: &mut SmallRng) -> Cart {
        Cart {
            position: random.random_range(-1.0..1.0),
            velocity: 0.0,
            steps: 0,
            earned: 0.0,
        }
    }

    /// What the policy sees.
    fn observation(&self) -> [f32; 2] {
        [self.position, self.velocity]
    }

    /// Plays a step and returns its reward.
    fn push(&mut self, force: f32) -> f32 {
        self.velocity += DT * STRONGEST * force.clamp(-1.0, 1.0);
        self.position += DT * self.velocity;
        self.steps += 1;
        let reward = -self.position.abs();
        self.earned += reward;
        reward
    }

    /// How the step ended.
    fn termination(&self) -> u32 {
        match (self.position.abs(), self.velocity.abs()) {
            (..0.02, ..0.05) => termination::SUCCESS,
            (END.., _) => termination::FAILED,
            _ if self.steps == MAX_STEPS => termination::TRUNCATED,
            _ => termination::RUNNING,
        }
    }
}

/// Many of them.
struct Carts {
    spec: EnvSpec,
    carts: Vec<Cart>,
    random: SmallRng,
    /// Sums over the episodes that ended, as [`VecEnv::stat_names`] names them.
    sums: [f32; 4],
}

impl Carts {
    fn new(envs: usize, seed: u64) -> Carts {
        let mut random = SmallRng::seed_from_u64(seed);
        Carts {
            spec: EnvSpec::new(envs, 2, 1, DT),
            carts: (0..envs).map(|_| Cart::start(&mut random)).collect(),
            random,
            sums: [0.0; 4],
        }
    }
}

impl VecEnv for Carts {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        let rows = out.host_mut()[at..].chunks_exact_mut(2);
        for (row, cart) in rows.zip(&self.carts) {
            row.copy_from_slice(&cart.observation());
        }
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        let first = out.step * self.carts.len();
        let last = self.spec.final_row(out.step);
        for (env, cart) in self.carts.iter_mut().enumerate() {
            out.reward.host_mut()[first + env] = cart.push(action.host()[at + env]);
            let termination = cart.termination();
            out.termination.host_mut()[first + env] = termination;
            if termination != termination::RUNNING {
                // What the episode ended with is of worth where it might have gone on.
                let seen = &mut out.final_observation.host_mut()[2 * (last + env)..][..2];
                seen.copy_from_slice(&cart.observation());
                let success = f32::from(u8::from(termination == termination::SUCCESS));
                let ended = [1.0, success, cart.steps as f32, cart.earned];
                let sums = self.sums.iter_mut().zip(ended);
                sums.for_each(|(sum, value)| *sum += value);
                *cart = Cart::start(&mut self.random);
            }
        }
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &["episodes", "successes", "steps", "returns"]
    }

    fn stats(&mut self, out: &mut Array) {
        out.host_mut().copy_from_slice(&self.sums);
        self.sums = [0.0; 4];
    }
}

fn main() -> anyhow::Result<()> {
    let ppo = Ppo {
        envs: 64,
        rollout_length: 32,
        ..Ppo::default()
    };
    // In a few parts, which the cores share.
    let mut envs = EnvBatch::open(&Device::Cpu, &Ranks::alone(), ppo.envs, None, |part| {
        Ok(Box::new(Carts::new(part.len(), part.start as u64)))
    })?;
    let mut learner = PpoLearner::new(&ppo, &envs, &Device::Cpu, 1)?;
    for update in 1..=60 {
        let steps = update * ppo.batch() as u64;
        let stats = learner.iterate(&mut envs, steps)?.stats;
        if let (0, Some(success), Some(length)) =
            (update % 10, stats.mean("successes"), stats.mean("steps"))
        {
            let seconds = length * f64::from(DT);
            println!(
                "{steps:>6} steps: {:>3.0} % stop in the middle, {seconds:.1} s",
                100.0 * success
            );
        }
    }
    Ok(())
}
