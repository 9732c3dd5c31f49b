//! Oracles: `ppo_loss::{actor, critic}`, and differences of the loss itself in f64.

use super::network::{ACTION, OBSERVATION, agree};
use crate::inputs::Draw;
use crate::support::forms::Forms;
use footwork::kernels::learn::ppo_loss::{self, Params, SUMS};

/// Streams of rewards, each with a value.
const VALUES: usize = 2;
const SCALARS: usize = 2 + 2 * VALUES;
const WIDTH: usize = OBSERVATION + 2 * ACTION + SCALARS;
/// Rows before the minibatch.
const START: usize = 6;
/// Where `log_std` begins in the parameters.
const LOG_STD: usize = 3;
const OLD_LOG_STD: [f32; ACTION] = [-0.4; ACTION];

/// Ratios on either side of the clip range and in it; values on either side of theirs.
struct Case {
    samples: Vec<f32>,
    parameters: Vec<f32>,
    outputs: Vec<f32>,
    params: Params,
}

impl Case {
    fn new(rows: usize) -> Case {
        let mut draw = Draw::new(8);
        let mut some = |count: usize| -> Vec<f32> {
            let values = draw.normals(count).into_iter();
            values.map(|value| 0.5 * value).collect()
        };
        let mut samples = some((START + rows + 2) * WIDTH);
        for sample in samples.chunks_exact_mut(WIDTH) {
            // About what the actions have.
            sample[WIDTH - SCALARS] = 1.5 * sample[WIDTH - SCALARS] - 12.5;
        }
        Case {
            samples,
            parameters: [vec![9.0; LOG_STD], vec![-0.5; ACTION]].concat(),
            outputs: some(rows * (ACTION + VALUES)),
            params: Params {
                rows: rows as u32,
                start: START as u32,
                width: WIDTH as u32,
                clip: 0.3,
                value_clip: 0.4,
                value_coefficient: 0.7,
                entropy_coefficient: 0.01,
                kl_coefficient: 0.2,
                std_coefficient: 1.0,
                inv_count: 1.0 / rows as f32,
            },
        }
    }

    fn rows(&self) -> usize {
        self.params.rows as usize
    }

    fn run(&self) -> Forms<(Vec<f32>, Vec<f32>)> {
        let dims = [OBSERVATION, LOG_STD, ACTION, VALUES].map(|dim| dim as u32);
        forms!(
            both, PPO_LOSS, self.rows(), self.params;
            dims, self.samples, self.parameters, OLD_LOG_STD, self.outputs,
            out self.outputs.len(), out self.rows() * (ACTION + SUMS)
        )
    }
}

/// The CPU's functions, row after row, as the shader has its arrays.
mod both {
    use super::*;
    pub use footwork::kernels::learn::ppo_loss::launch;

    pub fn twin(
        _: &[u32],
        samples: &[f32],
        parameters: &[f32],
        old_log_std: &[f32],
        outputs: &[f32],
        output_grads: &mut [f32],
        extras: &mut [f32],
        params: &Params,
    ) {
        let rows = params.rows as usize;
        let log_std = &parameters[LOG_STD..];
        let (means, values) = output_grads.split_at_mut(rows * ACTION);
        let (answered, valued) = outputs.split_at(rows * ACTION);
        let values = &mut values[..rows * VALUES];
        means.copy_from_slice(answered);
        values.copy_from_slice(valued);
        for row in 0..rows {
            let sample = &samples[(params.start as usize + row) * WIDTH..][..WIDTH];
            let extras = &mut extras[row * (ACTION + SUMS)..][..ACTION + SUMS];
            extras.fill(0.0);
            let mean = &mut means[row * ACTION..][..ACTION];
            let values = &mut values[row * VALUES..][..VALUES];
            ppo_loss::actor(
                log_std,
                old_log_std,
                &[sample],
                mean,
                extras,
                VALUES,
                params,
            );
            ppo_loss::critic(&[sample], values, extras, VALUES, params);
        }
    }
}

#[test]
fn ppo_loss_agrees() {
    for rows in [1, 64, 75, 200] {
        let forms = Case::new(rows).run();
        for (form, (grads, extras)) in forms.shaders() {
            agree(&format!("grads, {form}"), grads, &forms.twin.0);
            agree(&format!("extras, {form}"), extras, &forms.twin.1);
        }
    }
}

/// The loss of a sample as Schulman et al. 2017, equations 7 to 9, have it, with a penalty on the KL
/// divergence of the new policy from the old (equation 8) and a bound on the critic's change.
fn plain(case: &Case, row: usize, mean: &[f64], log_std: &[f64], values: &[f64]) -> f64 {
    let params = &case.params;
    let sample = &case.samples[(START + row) * WIDTH..][..WIDTH];
    let at = |i: usize| f64::from(sample[i]);
    let mut log_prob = 0.0;
    let (mut kl, mut entropy) = (0.0, 0.0);
    for i in 0..ACTION {
        let (action, old_mean) = (at(OBSERVATION + i), at(OBSERVATION + ACTION + i));
        let (deviation, old) = (log_std[i].exp(), f64::from(OLD_LOG_STD[i]).exp());
        let tau = std::f64::consts::TAU;
        log_prob -= (action - mean[i]).powi(2) / (2.0 * deviation.powi(2));
        log_prob -= (deviation * tau.sqrt()).ln();
        let moved = old.powi(2) + (old_mean - mean[i]).powi(2);
        kl += (deviation / old).ln() + moved / (2.0 * deviation.powi(2)) - 0.5;
        entropy += (deviation * (tau * std::f64::consts::E).sqrt()).ln();
    }
    let scalars = WIDTH - SCALARS;
    let ratio = (log_prob - at(scalars)).exp();
    let advantage = at(scalars + 1);
    let (low, high) = (1.0 - f64::from(params.clip), 1.0 + f64::from(params.clip));
    let surrogate = (ratio * advantage).min(ratio.clamp(low, high) * advantage);
    let limit = f64::from(params.value_clip);
    let errors = values.iter().enumerate().map(|(i, value)| {
        let (target, old_value) = (at(scalars + 2 + i), at(scalars + 2 + VALUES + i));
        let near = old_value + (value - old_value).clamp(-limit, limit);
        (value - target).powi(2).max((near - target).powi(2))
    });
    let error: f64 = errors.sum();
    -surrogate + 0.5 * f64::from(params.value_coefficient) * error
        - f64::from(params.entropy_coefficient) * entropy
        + f64::from(params.kl_coefficient) * kl
}

#[test]
fn a_fixed_standard_deviation_has_no_gradient() {
    let mut case = Case::new(75);
    let (grads, _) = case.run().twin;
    case.params.std_coefficient = 0.0;
    for (form, got) in case.run().all() {
        agree(&format!("grads, {form}"), &got.0, &grads);
        let rows = got.1.chunks_exact(ACTION + SUMS);
        assert!(
            rows.flat_map(|row| &row[..ACTION]).all(|&grad| grad == 0.0),
            "{form}"
        );
    }
}

#[test]
fn its_gradient_is_that_of_the_papers_loss() {
    let case = Case::new(200);
    let (grads, extras) = case.run().twin;
    let inv_count = f64::from(case.params.inv_count);
    let mut clipped = 0;
    for row in 0..case.rows() {
        let values = case.rows() * ACTION;
        let mean = row * ACTION..(row + 1) * ACTION;
        let point = [
            &case.outputs[mean.clone()],
            &case.parameters[LOG_STD..],
            &case.outputs[values + row * VALUES..][..VALUES],
        ];
        let point: Vec<f64> = point.concat().into_iter().map(f64::from).collect();
        let extras = &extras[row * (ACTION + SUMS)..][..ACTION + SUMS];
        let own = &grads[values + row * VALUES..][..VALUES];
        let got = [&grads[mean], &extras[..ACTION], own].concat();
        let loss = |point: &[f64]| {
            let (mean, rest) = point.split_at(ACTION);
            plain(&case, row, mean, &rest[..ACTION], &rest[ACTION..])
        };
        for (i, got) in got.into_iter().enumerate() {
            const STEP: f64 = 1e-6;
            let moved = |by: f64| {
                let mut point = point.clone();
                point[i] += by;
                loss(&point)
            };
            let want = (moved(STEP) - moved(-STEP)) / (2.0 * STEP) * inv_count;
            let got = f64::from(got);
            assert!(
                (got - want).abs() <= 1e-4 * want.abs().max(inv_count),
                "row {row}, number {i}: {got} instead of {want}"
            );
        }
        clipped += usize::from(extras[ACTION + 4] == 1.0);
    }
    assert!(
        (10..190).contains(&clipped),
        "{clipped} of 200 left the clip range"
    );
}
