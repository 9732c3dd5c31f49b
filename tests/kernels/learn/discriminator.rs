//! What a discriminator sees, loses and rewards, and the learning rate that adapts to the KL divergence.
//! Oracles: the twins; differences of the plain loss in f64; the rewards by hand.

use super::network::agree;
use crate::inputs::{Draw, close, same};
use footwork::kernels::learn::{adapt_lr, discriminator_loss, style_reward, style_windows};
use footwork::kernels::termination::{FAILED, RUNNING, TRUNCATED};

#[test]
fn windows_agree() {
    for (rows, final_steps) in [(1, 1), (65, 1), (65, 4), (250, 4)] {
        let (steps, observation, style) = (4, 11, 7);
        let params = style_windows::Params {
            steps,
            rows,
            observation,
            style,
            final_steps,
        };
        let samples = (steps * rows) as usize;
        let mut draw = Draw::new(rows);
        let observations = draw.normals(samples * 11);
        let next = draw.normals(rows as usize * 11);
        let mut last = draw.normals((final_steps * rows) as usize * 11);
        // Some diverge.
        let odd = [f32::NAN, 1e20, f32::NEG_INFINITY];
        for (at, value) in last.iter_mut().step_by(13).enumerate() {
            *value = odd[at % 3];
        }
        let ends = [RUNNING, RUNNING, TRUNCATED, RUNNING, FAILED];
        let termination: Vec<u32> = (0..samples).map(|sample| ends[sample % 5]).collect();
        let forms = forms!(
            style_windows, STYLE_WINDOWS, samples, params;
            observations, next, last, termination, out samples * 14
        );
        for (form, windows) in forms.shaders() {
            same(form, windows, &forms.twin);
        }
        assert!(forms.twin.iter().all(|value| value.abs() < 100.0));
        for (sample, window) in forms.twin.chunks_exact(14).enumerate() {
            assert_eq!(window[..7], observations[sample * 11..][..7]);
            let after = sample + rows as usize;
            if termination[sample] == RUNNING && after < samples {
                assert_eq!(window[7..], observations[after * 11..][..7]);
            }
        }
    }
}

/// The same moments make the same windows, whether 64 environments play 64 steps or 256 play 16.
#[test]
fn windows_do_not_depend_on_how_samples_are_laid_out() {
    let (rows, steps, dim) = (64, 64, 5);
    let mut draw = Draw::new(2);
    // One more: what follows the last step.
    let moments = draw.normals((steps + 1) * rows * dim);
    let finals = draw.normals(steps * rows * dim);
    let ends: Vec<u32> = (0..steps * rows)
        .map(|at| if at % 7 == 3 { FAILED } else { RUNNING })
        .collect();
    let laid_out = |parts: usize| {
        let (rows_of, steps_of) = (rows * parts, steps / parts);
        let place = |step: usize, row: usize| (row / rows * steps_of + step) * rows + row % rows;
        let order: Vec<usize> = (0..steps_of * rows_of)
            .map(|sample| place(sample / rows_of, sample % rows_of))
            .collect();
        let pick = |from: &[f32], order: &[usize]| -> Vec<f32> {
            let rows = order.iter().flat_map(|&at| &from[at * dim..][..dim]);
            rows.copied().collect()
        };
        let next: Vec<usize> = (0..rows_of).map(|row| place(steps_of, row)).collect();
        let params = style_windows::Params {
            steps: steps_of as u32,
            rows: rows_of as u32,
            observation: dim as u32,
            style: dim as u32,
            final_steps: steps_of as u32,
        };
        let mut windows = vec![0.0; order.len() * 2 * dim];
        let termination: Vec<u32> = order.iter().map(|&at| ends[at]).collect();
        style_windows::twin(
            &pick(&moments, &order),
            &pick(&moments, &next),
            &pick(&finals, &order),
            &termination,
            &mut windows,
            &params,
        );
        let mut windows: Vec<(usize, Vec<f32>)> = order
            .into_iter()
            .zip(windows.chunks_exact(2 * dim).map(<[f32]>::to_vec))
            .collect();
        windows.sort_by_key(|(at, _)| *at);
        windows
    };
    assert_eq!(laid_out(1), laid_out(4));
}

#[test]
fn style_rewards_agree() {
    for (samples, heads, hinge) in [(1, 1, 0), (65, 1, 0), (1000, 3, 0), (1000, 32, 1)] {
        // An encoder's outputs may follow.
        let outputs = heads + samples % 5;
        let params = style_reward::Params {
            samples,
            outputs,
            heads,
            hinge,
        };
        let mut output = Draw::new(samples).normals((samples * outputs) as usize);
        output[0] = 50.0;
        let forms = forms!(
            style_reward, STYLE_REWARD, samples as usize, params; output, out samples as usize
        );
        for (form, reward) in forms.shaders() {
            close(form, reward, &forms.twin, |_| 2e-5);
        }
    }
}

#[test]
fn style_rewards_of_simple_cases() {
    let reward = |out: f32, hinge: u32| {
        let params = style_reward::Params {
            samples: 1,
            outputs: 1,
            heads: 1,
            hinge,
        };
        let mut reward = [0.0];
        style_reward::twin(&[out], &mut reward, &params);
        reward[0]
    };
    // -log(1 - 1/2); what is surely taken for recorded; what is surely not.
    assert!((reward(0.0, 0) - 2f32.ln()).abs() < 1e-6);
    assert!((reward(100.0, 0) + 1e-4f32.ln()).abs() < 1e-4);
    assert!(reward(-100.0, 0).abs() < 1e-6);
    assert_eq!(
        [-3.0, 0.25, 3.0].map(|out| reward(out, 1)),
        [-1.0, 0.25, 1.0]
    );
}

const DIM: usize = 3;
const WIDTH: usize = DIM + 1;
const START: usize = 5;

/// The CPU's function, row after row, as the shader has its arrays.
mod by_rows {
    use super::*;
    use discriminator_loss::{Params, SUMS};
    pub use footwork::kernels::learn::discriminator_loss::launch;

    pub fn twin(
        dims: &[u32],
        samples: &[f32],
        outputs: &[f32],
        output_grads: &mut [f32],
        extras: &mut [f32],
        params: &Params,
    ) {
        let (heads, rows) = (dims[2] as usize, params.rows as usize);
        let output_grads = &mut output_grads[..rows * heads];
        output_grads.copy_from_slice(outputs);
        let rows = output_grads.chunks_exact_mut(heads);
        for (row, (grads, extras)) in rows.zip(extras.chunks_exact_mut(SUMS)).enumerate() {
            let sample = &samples[(params.start as usize + row) * WIDTH..][..WIDTH];
            extras.fill(0.0);
            discriminator_loss::rows(&[sample], DIM, grads, extras, params);
        }
    }
}

#[test]
fn discriminator_losses_agree() {
    for (rows, heads, hinge) in [(1, 1, 0), (64, 1, 0), (75, 32, 1), (200, 4, 0)] {
        let params = discriminator_loss::Params {
            rows: rows as u32,
            start: START as u32,
            width: WIDTH as u32,
            hinge,
            heads: heads as u32,
            inv_count: 1.0 / rows as f32,
        };
        let mut draw = Draw::new(3);
        let mut samples = draw.normals((START + rows) * WIDTH);
        for (row, sample) in samples.chunks_exact_mut(WIDTH).enumerate() {
            sample[DIM] = (row % 2) as f32;
        }
        let outputs: Vec<f32> = draw.normals(rows * heads).iter().map(|x| 3.0 * x).collect();
        let dims = [DIM as u32, 100, heads as u32];
        let forms = forms!(
            by_rows, DISCRIMINATOR_LOSS, rows, params;
            dims, samples, outputs, out rows * heads, out rows * discriminator_loss::SUMS
        );
        for (form, (grads, extras)) in forms.shaders() {
            agree(&format!("grads, {form}"), grads, &forms.twin.0);
            agree(&format!("extras, {form}"), extras, &forms.twin.1);
        }
        // Against differences of the definition.
        let loss = |row: usize, out: f64| {
            let sign = if samples[(START + row) * WIDTH + DIM] > 0.5 {
                -1.0
            } else {
                1.0
            };
            match hinge {
                1 => (1.0 + sign * out).max(0.0),
                _ => (1.0 + (sign * out).exp()).ln(),
            }
        };
        for (at, grad) in forms.twin.0.iter().enumerate() {
            let out = f64::from(outputs[at]);
            if hinge == 1 && (out.abs() - 1.0).abs() < 1e-3 {
                continue;
            }
            let slope = (loss(at / heads, out + 1e-6) - loss(at / heads, out - 1e-6)) / 2e-6;
            let want = slope / (rows * heads) as f64;
            assert!(
                (f64::from(*grad) - want).abs() < 1e-5 / rows as f64,
                "{at}: {grad} {want}"
            );
        }
    }
}

#[test]
fn learning_rates_agree_and_follow_the_kl_divergence() {
    let adapted = |kl: f32, first: u32, rates: [f32; 3]| {
        let params = adapt_lr::Params {
            kl_at: 3,
            inv_count: 0.01,
            first,
            desired_kl: 0.02,
            least: 0.1,
            most: 10.0,
        };
        let sums = [0.0, 0.0, 0.0, kl];
        let forms = forms!(adapt_lr, ADAPT_LR, [1, 1, 1], params; mut sums, mut rates);
        for (form, (_, rates)) in forms.shaders() {
            same(form, rates, &forms.twin.1);
        }
        forms.twin.1
    };
    // A sum of 10 over a hundred samples is far too much, of 0.5 too little, of 2 as wanted.
    assert_eq!(adapted(10.0, 1, [1.0, 2.0, 77.0]), [1.0 / 1.5, 2.0, 10.0]);
    assert_eq!(adapted(0.5, 1, [1.0, 2.0, 0.0]), [1.5, 2.0, 0.5]);
    assert_eq!(adapted(2.0, 1, [1.0, 2.0, 0.0]), [1.0, 2.0, 2.0]);
    // Within an epoch only what this minibatch added counts; rates stay in their range.
    assert_eq!(adapted(10.0, 0, [1.0, 2.0, 8.0]), [1.0, 2.0, 10.0]);
    assert_eq!(adapted(10.0, 1, [0.1, 1.0, 0.0])[0], 0.1);
    assert_eq!(adapted(0.0, 1, [9.0, 1.0, 0.0])[0], 10.0);
}
