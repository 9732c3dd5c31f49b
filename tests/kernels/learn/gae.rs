//! Oracles: `gae::twin`, and the lambda-return as textbooks write it, in f64: the mean of all
//! n-step returns, weighted with powers of lambda, each an explicit sum of rewards.
//! Bar: roundings of the rollout's length times the absolute sum of what is added up.

use crate::checked;
use crate::inputs::{Draw, POISON, SEEDS, SIZES, close, gpu};
use bytemuck::cast_slice;
use footwork::gpu::kernel::groups;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::learn::gae;
use footwork::kernels::termination;

struct Case {
    reward: Vec<f32>,
    termination: Vec<u32>,
    value: Vec<f32>,
    next_value: Vec<f32>,
    final_value: Vec<f32>,
    scale: [f32; 2],
    params: gae::Params,
}

/// Advantages and target values.
type Judged = (Vec<f32>, Vec<f32>);

impl Case {
    /// Steps end where `ended(step, env)` says so. Rewards of 1000 on arrival.
    fn new(envs: usize, steps: usize, seed: u32, termination: impl Fn(usize, usize) -> u32) -> Self {
        let mut draw = Draw::new(seed);
        let samples = envs * steps;
        let termination: Vec<u32> = (0..samples).map(|at| termination(at / envs, at % envs)).collect();
        let arrival = |&termination: &u32| if termination == termination::SUCCESS { 1000.0 } else { 0.0 };
        Case {
            reward: termination.iter().map(|e| arrival(e) + draw.normal()).collect(),
            value: draw.normals(samples),
            next_value: draw.normals(envs),
            final_value: draw.normals(envs),
            scale: [draw.within(300.0), 150.0 + draw.within(100.0)],
            termination,
            params: gae::Params {
                envs: envs as u32,
                steps: steps as u32,
                gamma: 0.99,
                lambda: 0.95,
                bootstrap: 1 << termination::TRUNCATED,
                final_steps: 1,
            },
        }
    }

    fn samples(&self) -> usize {
        self.reward.len()
    }

    fn poison(&self) -> Vec<f32> {
        vec![POISON; self.samples() + 5]
    }

    fn twin(&self) -> Judged {
        let (mut advantage, mut target) = (self.poison(), self.poison());
        gae::twin(
            &self.reward,
            &self.termination,
            &self.value,
            &self.next_value,
            &self.final_value,
            &self.scale,
            &mut advantage,
            &mut target,
            &self.params,
        );
        (advantage, target)
    }

    fn launch(&self) -> Judged {
        let gpu = gpu();
        let advantage = Buffer::from_slice(&gpu, &self.poison());
        let target = Buffer::from_slice(&gpu, &self.poison());
        gae::launch(
            &gpu,
            &Buffer::from_slice(&gpu, &self.reward),
            &Buffer::from_slice(&gpu, &self.termination),
            &Buffer::from_slice(&gpu, &self.value),
            &Buffer::from_slice(&gpu, &self.next_value),
            &Buffer::from_slice(&gpu, &self.final_value),
            &Buffer::from_slice(&gpu, &self.scale),
            &advantage,
            &target,
            &self.params,
        );
        (
            advantage.read(&gpu).expect("advantage"),
            target.read(&gpu).expect("target"),
        )
    }

    fn checked(&self) -> Judged {
        let poison = self.poison();
        let buffers: [&[u8]; 8] = [
            cast_slice(&self.reward),
            cast_slice(&self.termination),
            cast_slice(&self.value),
            cast_slice(&self.next_value),
            cast_slice(&self.final_value),
            cast_slice(&self.scale),
            cast_slice(&poison),
            cast_slice(&poison),
        ];
        let groups = groups(&shader::GAE, self.params.envs as usize);
        let outcome = checked::run(&shader::GAE, groups, &buffers, &self.params);
        (outcome.of(6), outcome.of(7))
    }

    fn real(&self, normalised: f32) -> f64 {
        f64::from(normalised) * f64::from(self.scale[1]) + f64::from(self.scale[0])
    }

    /// The value of the last real state of an episode that ended at `step`.
    fn last(&self, step: usize, env: usize) -> f32 {
        match self.params.final_steps {
            1 => self.final_value[env],
            _ => self.final_value[step * self.params.envs as usize + env],
        }
    }

    /// The n-step returns from `step` on, n = 1, 2, .. to the end of episode or rollout.
    fn returns(&self, step: usize, env: usize) -> Vec<f64> {
        let (envs, steps) = (self.params.envs as usize, self.params.steps as usize);
        let gamma = f64::from(self.params.gamma);
        let (mut returns, mut sum) = (Vec::new(), 0.0);
        for (n, later) in (step..steps).enumerate() {
            sum += gamma.powi(n as i32) * f64::from(self.reward[later * envs + env]);
            let termination = self.termination[later * envs + env];
            let after = match termination {
                _ if termination != termination::RUNNING && self.params.bootstrap & 1 << termination == 0 => 0.0,
                _ if termination != termination::RUNNING => self.real(self.last(later, env)),
                _ if later + 1 < steps => self.real(self.value[(later + 1) * envs + env]),
                _ => self.real(self.next_value[env]),
            };
            returns.push(sum + gamma.powi(n as i32 + 1) * after);
            if termination != termination::RUNNING {
                break;
            }
        }
        returns
    }

    /// Sutton and Barto, Reinforcement Learning, equation 12.3.
    fn lambda_return(&self, step: usize, env: usize) -> f64 {
        let lambda = f64::from(self.params.lambda);
        let returns = self.returns(step, env);
        let (last, others) = returns.split_last().expect("at least one step");
        let weighted = others
            .iter()
            .enumerate()
            .map(|(n, r)| lambda.powi(n as i32) * r);
        (1.0 - lambda) * weighted.sum::<f64>() + lambda.powi(others.len() as i32) * last
    }

    fn oracle(&self) -> Judged {
        let envs = self.params.envs as usize;
        let (mut advantage, mut target) = (self.poison(), self.poison());
        for at in 0..self.samples() {
            let judged = self.lambda_return(at / envs, at % envs);
            advantage[at] = (judged - self.real(self.value[at])) as f32;
            target[at] = judged as f32;
        }
        (advantage, target)
    }

    /// Everything an advantage of this environment may add up.
    fn absolute(&self, env: usize) -> f32 {
        let envs = self.params.envs as usize;
        let own = |all: &[f32]| {
            all.iter()
                .skip(env)
                .step_by(envs)
                .map(|v| v.abs())
                .sum::<f32>()
        };
        let values = own(&self.value) + self.next_value[env].abs() + own(&self.final_value);
        let offsets = (self.params.steps + 2) as f32 * self.scale[0].abs();
        own(&self.reward) + values * self.scale[1] + offsets
    }

    fn agrees(&self) {
        let (twin, oracle) = (self.twin(), self.oracle());
        let (launched, checked) = (self.launch(), self.checked());
        let bars: Vec<f32> = (0..self.params.envs as usize)
            .map(|env| 4.0 * f32::EPSILON * self.absolute(env))
            .collect();
        let bar = |at: usize| {
            if at < self.samples() {
                bars[at % bars.len()]
            } else {
                0.0
            }
        };
        for (form, got) in [
            ("twin", &twin),
            ("launched", &launched),
            ("checked", &checked),
        ] {
            close(form, &got.0, &oracle.0, bar);
            close(form, &got.1, &oracle.1, bar);
        }
    }
}

/// Arrivals anywhere and at most one truncation an environment, as rollouts have them.
fn mixed(step: usize, env: usize) -> u32 {
    match (step * 31 + env * 17) % 11 {
        _ if step == env % 13 => termination::TRUNCATED,
        0 => termination::SUCCESS,
        1 => termination::FAILED,
        _ => termination::RUNNING,
    }
}

#[test]
fn agrees_with_its_twin_and_the_lambda_return() {
    for seed in SEEDS {
        for envs in SIZES {
            Case::new(envs, 16, seed, mixed).agrees();
        }
    }
}

#[test]
fn agrees_for_every_kind_of_discount() {
    for (gamma, lambda) in [
        (0.99, 0.0),
        (0.99, 1.0),
        (1.0, 1.0),
        (0.0, 0.5),
        (0.9, 0.5),
        (0.0, 0.0),
    ] {
        for steps in [1, 2, 16, 200] {
            let mut case = Case::new(65, steps, 5, mixed);
            (case.params.gamma, case.params.lambda) = (gamma, lambda);
            case.agrees();
        }
    }
}

#[test]
fn agrees_where_all_or_none_ends() {
    for termination in [termination::RUNNING, termination::SUCCESS] {
        Case::new(65, 16, 6, |_, _| termination).agrees();
    }
    Case::new(65, 16, 6, |step, _| {
        if step == 15 {
            termination::TRUNCATED
        } else {
            termination::RUNNING
        }
    })
    .agrees();
    Case::new(65, 16, 6, |step, _| {
        if step == 0 {
            termination::TRUNCATED
        } else {
            termination::SUCCESS
        }
    })
    .agrees();
}

/// Ends of all kinds, any number of each.
fn crowded(step: usize, env: usize) -> u32 {
    match (step * 31 + env * 17) % 7 {
        termination @ 1..=3 => termination as u32,
        _ => termination::RUNNING,
    }
}

#[test]
fn agrees_for_every_set_of_ends_after_which_value_goes_on() {
    for bootstrap in (0..16).chain([termination::ANY]) {
        for steps in [1, 2, 16] {
            // One row of last values for all steps, or a row a step.
            for final_steps in [1, steps] {
                let mut case = Case::new(65, steps, 7 + bootstrap, crowded);
                case.final_value = Draw::new(8).normals(65 * final_steps);
                (case.params.bootstrap, case.params.final_steps) = (bootstrap, final_steps as u32);
                case.agrees();
            }
        }
    }
}

/// One arrival valued as if the walk went on, by hand: reward 10, then half of the value 4.
#[test]
fn an_arrival_that_goes_on_is_worth_its_value() {
    for (bootstrap, worth) in [(1 << termination::TRUNCATED, 10.0), (1 << termination::SUCCESS, 12.0)] {
        let mut case = Case::new(1, 1, 9, |_, _| termination::SUCCESS);
        (case.reward[0], case.value[0], case.final_value[0]) = (10.0, 3.0, 4.0);
        case.scale = [0.0, 1.0];
        (case.params.gamma, case.params.bootstrap) = (0.5, bootstrap);
        case.agrees();
        let (advantage, target) = case.twin();
        assert_eq!((advantage[0], target[0]), (worth - 3.0, worth));
    }
}
