//! Oracles: `gae::twin`, and the lambda-return as textbooks write it, in f64: the mean of all
//! n-step returns, weighted with powers of lambda, each an explicit sum of rewards.
//! Bar: roundings of the rollout's length times the absolute sum of what is added up.

use crate::inputs::{Draw, SEEDS, SIZES, close};
use crate::support::forms::Forms;
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

impl Case {
    /// Steps end where `termination(step, row)` says so. Rewards of 1000 on arrival.
    fn new(
        rows: usize,
        steps: usize,
        seed: u32,
        termination: impl Fn(usize, usize) -> u32,
    ) -> Self {
        let mut draw = Draw::new(seed);
        let samples = rows * steps;
        let termination: Vec<u32> = (0..samples)
            .map(|at| termination(at / rows, at % rows))
            .collect();
        let arrival = |&termination: &u32| {
            if termination == termination::SUCCESS {
                1000.0
            } else {
                0.0
            }
        };
        Case {
            reward: termination
                .iter()
                .map(|e| arrival(e) + draw.normal())
                .collect(),
            value: draw.normals(samples),
            next_value: draw.normals(rows),
            final_value: draw.normals(rows),
            scale: [draw.within(300.0), 150.0 + draw.within(100.0)],
            termination,
            params: gae::Params {
                rows: rows as u32,
                steps: steps as u32,
                gamma: 0.99,
                lambda: 0.95,
                bootstrap: 1 << termination::TRUNCATED,
                final_steps: 1,
                streams: 1,
                stream: 0,
            },
        }
    }

    fn samples(&self) -> usize {
        self.reward.len()
    }

    /// Logarithms of densities, which are not looked at, and values.
    fn log_prob_and_value(&self) -> Vec<f32> {
        [vec![f32::NAN; self.samples()], self.value.clone()].concat()
    }

    fn run(&self) -> Forms<Vec<f32>> {
        forms!(
            gae, GAE, self.params.rows as usize, self.params;
            self.reward, self.termination, self.log_prob_and_value(), self.next_value,
            self.final_value, self.scale, out 2 * self.samples()
        )
    }

    /// Advantage and return of the only sample.
    fn only(&self) -> (f32, f32) {
        let judged = self.run().twin;
        (judged[0], judged[1])
    }

    fn real(&self, normalised: f32) -> f64 {
        f64::from(normalised) * f64::from(self.scale[1]) + f64::from(self.scale[0])
    }

    /// The value of the last real state of an episode that ended at `step`.
    fn last(&self, step: usize, row: usize) -> f32 {
        match self.params.final_steps {
            1 => self.final_value[row],
            _ => self.final_value[step * self.params.rows as usize + row],
        }
    }

    /// The n-step returns from `step` on, n = 1, 2, .. to the end of episode or rollout.
    fn returns(&self, step: usize, row: usize) -> Vec<f64> {
        let (rows, steps) = (self.params.rows as usize, self.params.steps as usize);
        let gamma = f64::from(self.params.gamma);
        let (mut returns, mut sum) = (Vec::new(), 0.0);
        for (n, later) in (step..steps).enumerate() {
            sum += gamma.powi(n as i32) * f64::from(self.reward[later * rows + row]);
            let termination = self.termination[later * rows + row];
            let after = match termination {
                _ if termination != termination::RUNNING
                    && self.params.bootstrap & 1 << termination == 0 =>
                {
                    0.0
                }
                _ if termination != termination::RUNNING => self.real(self.last(later, row)),
                _ if later + 1 < steps => self.real(self.value[(later + 1) * rows + row]),
                _ => self.real(self.next_value[row]),
            };
            returns.push(sum + gamma.powi(n as i32 + 1) * after);
            if termination != termination::RUNNING {
                break;
            }
        }
        returns
    }

    /// Sutton and Barto, Reinforcement Learning, equation 12.3.
    fn lambda_return(&self, step: usize, row: usize) -> f64 {
        let lambda = f64::from(self.params.lambda);
        let returns = self.returns(step, row);
        let (last, others) = returns.split_last().expect("at least one step");
        let weighted = others
            .iter()
            .enumerate()
            .map(|(n, r)| lambda.powi(n as i32) * r);
        (1.0 - lambda) * weighted.sum::<f64>() + lambda.powi(others.len() as i32) * last
    }

    /// Advantages, then returns.
    fn oracle(&self) -> Vec<f32> {
        let rows = self.params.rows as usize;
        let returns = (0..self.samples()).map(|at| self.lambda_return(at / rows, at % rows));
        let returns: Vec<f64> = returns.collect();
        let advantages = returns.iter().zip(&self.value);
        let advantages = advantages.map(|(of, &value)| (of - self.real(value)) as f32);
        advantages
            .chain(returns.iter().map(|&of| of as f32))
            .collect()
    }

    /// Everything an advantage of this row may add up.
    fn absolute(&self, row: usize) -> f32 {
        let rows = self.params.rows as usize;
        let own = |all: &[f32]| {
            all.iter()
                .skip(row)
                .step_by(rows)
                .map(|v| v.abs())
                .sum::<f32>()
        };
        let values = own(&self.value) + self.next_value[row].abs() + own(&self.final_value);
        let offsets = (self.params.steps + 2) as f32 * self.scale[0].abs();
        own(&self.reward) + values * self.scale[1] + offsets
    }

    fn agrees(&self) {
        let oracle = self.oracle();
        let rows = self.params.rows as usize;
        let bars: Vec<f32> = (0..rows)
            .map(|row| 4.0 * f32::EPSILON * self.absolute(row))
            .collect();
        for (form, got) in self.run().all() {
            close(form, got, &oracle, |at| bars[at % rows]);
        }
    }
}

/// Arrivals anywhere and at most one truncation a row, as rollouts have them.
fn mixed(step: usize, row: usize) -> u32 {
    match (step * 31 + row * 17) % 11 {
        _ if step == row % 13 => termination::TRUNCATED,
        0 => termination::SUCCESS,
        1 => termination::FAILED,
        _ => termination::RUNNING,
    }
}

#[test]
fn agrees_with_its_twin_and_the_lambda_return() {
    for seed in SEEDS {
        for rows in SIZES {
            Case::new(rows, 16, seed, mixed).agrees();
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
fn crowded(step: usize, row: usize) -> u32 {
    match (step * 31 + row * 17) % 7 {
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
    for (bootstrap, worth) in [
        (1 << termination::TRUNCATED, 10.0),
        (1 << termination::SUCCESS, 12.0),
    ] {
        let mut case = Case::new(1, 1, 9, |_, _| termination::SUCCESS);
        (case.reward[0], case.value[0], case.final_value[0]) = (10.0, 3.0, 4.0);
        case.scale = [0.0, 1.0];
        (case.params.gamma, case.params.bootstrap) = (0.5, bootstrap);
        case.agrees();
        assert_eq!(case.only(), (worth - 3.0, worth));
    }
}
