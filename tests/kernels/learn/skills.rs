//! Latents, and what makes them mean movements.
//! Oracles: the twins; the definitions and their differences in f64; frequencies of what is drawn.

use super::network::agree;
use crate::inputs::{Draw, close, same};
use footwork::kernels::learn::{
    advance_latents, discriminator_loss, diversity_loss, encoder_loss, skill_reward,
};
use footwork::kernels::termination::{FAILED, RUNNING, TRUNCATED};

fn latents_params(rows: u32, opening: u32) -> advance_latents::Params {
    advance_latents::Params {
        rows,
        first: 7,
        seed: 3,
        step_counter: 11,
        at: rows,
        final_row: 2 * rows,
        least: 2,
        most: 9,
        opening,
        spread: 0.2,
    }
}

#[test]
fn latents_advance_alike() {
    for (rows, opening, centre_count) in [(1u32, 0, 0u32), (65, 0, 0), (65, 1, 3), (250, 0, 3)] {
        let (dim, inner) = (5, 4);
        let mut draw = Draw::new(rows);
        let mut some = |rows: u32, width: usize| draw.normals(rows as usize * width);
        let (latents, inner_final) = (some(rows, dim), some(3 * rows, inner));
        let mut centres = some(centre_count.max(1), 1 + dim);
        for (number, row) in centres.chunks_exact_mut(1 + dim).enumerate() {
            row[0] = (number + 1) as f32 / 3.0;
        }
        let ends = [RUNNING, TRUNCATED, RUNNING, FAILED];
        let termination: Vec<u32> = (0..2 * rows as usize).map(|at| ends[at % 4]).collect();
        let ages: Vec<u32> = (0..rows).map(|row| 1 + row % 4).collect();
        let dims = [dim as u32, inner as u32, centre_count];
        let finals = vec![9.0f32; 3 * rows as usize * (inner + dim)];
        let forms = forms!(
            advance_latents, ADVANCE_LATENTS, rows as usize, latents_params(rows, opening);
            dims, termination, centres, inner_final, mut finals, mut latents, mut ages
        );
        let (twin_finals, twin_latents, twin_ages) = &forms.twin;
        for (form, (finals, latents, ages)) in forms.shaders() {
            same(form, finals, twin_finals);
            close(form, latents, twin_latents, |_| 1e-6);
            assert_eq!(ages, twin_ages, "{form}");
        }
        for row in 0..rows as usize {
            let end = termination[rows as usize + row];
            let kept = opening == 0 && end == RUNNING && ages[row] > 1;
            let own = row * dim..(row + 1) * dim;
            assert_eq!(kept, twin_latents[own.clone()] == latents[own.clone()]);
            let length: f32 = twin_latents[own.clone()].iter().map(|x| x * x).sum();
            assert!(kept || (length - 1.0).abs() < 1e-5);
            // Whoever has ended is observed with the latent of its time.
            let last = 2 * rows as usize + row;
            let last = &twin_finals[last * (inner + dim)..][..inner + dim];
            match opening == 0 && end != RUNNING {
                true => assert_eq!(last[inner..], latents[own]),
                false => assert!(last.iter().all(|&value| value == 9.0)),
            }
        }
    }
}

/// Directions without a preference, and ages of which each is as likely.
#[test]
fn latents_are_uniform_on_the_sphere_and_in_age() {
    let (count, dim) = (40_000u32, 3);
    let params = latents_params(count, 1);
    let (mut mean, mut squares) = ([0.0f64; 3], [0.0f64; 3]);
    let mut caps = 0;
    let mut ages = [0u32; 10];
    for row in 0..count {
        let mut latent = vec![0.0; dim];
        let age = advance_latents::draw(row, &[], &mut latent, &params);
        ages[age as usize] += 1;
        for (i, &value) in latent.iter().enumerate() {
            mean[i] += f64::from(value) / f64::from(count);
            squares[i] += f64::from(value).powi(2) / f64::from(count);
        }
        // Archimedes: of a sphere, a cap of height h has the share h / 2.
        caps += u32::from(latent[0] > 0.5);
    }
    assert!(mean.iter().all(|mean| mean.abs() < 0.01), "{mean:?}");
    assert!(
        squares
            .iter()
            .all(|square| (square - 1.0 / 3.0).abs() < 0.01)
    );
    assert!((f64::from(caps) / f64::from(count) - 0.25).abs() < 0.01);
    assert_eq!(ages[..2], [0, 0]);
    for &age in &ages[2..] {
        assert!(
            (f64::from(age) / f64::from(count) - 0.125).abs() < 0.01,
            "{ages:?}"
        );
    }
}

#[test]
fn centres_are_drawn_by_their_shares() {
    let centres = [0.5, 1.0, 0.0, 0.75, 0.0, 1.0, 1.0, -1.0, 0.0];
    let params = advance_latents::Params {
        spread: 0.01,
        ..latents_params(1, 1)
    };
    let mut counts = [0; 3];
    for row in 0..20_000 {
        let mut latent = vec![0.0; 2];
        advance_latents::draw(row, &centres, &mut latent, &params);
        let nearest = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]
            .iter()
            .position(|centre| centre[0] * latent[0] + centre[1] * latent[1] > 0.99);
        counts[nearest.expect("near a centre")] += 1;
    }
    for (count, share) in counts.iter().zip([0.5, 0.25, 0.25]) {
        assert!(
            (f64::from(*count) / 20_000.0 - share).abs() < 0.02,
            "{counts:?}"
        );
    }
}

const WINDOW: usize = 3;
const LATENT: usize = 4;
const HEADS: usize = 2;
const OUTPUTS: usize = HEADS + LATENT;
const START: usize = 5;
const WIDTH: usize = WINDOW + 1 + LATENT;

/// The CPU's function, row after row, as the shader has its arrays.
mod encoder_by_rows {
    use super::*;
    use discriminator_loss::SUMS;
    use encoder_loss::Params;
    pub use footwork::kernels::learn::encoder_loss::launch;

    pub fn twin(
        _dims: &[u32],
        samples: &[f32],
        outputs: &[f32],
        output_grads: &mut [f32],
        extras: &mut [f32],
        params: &Params,
    ) {
        let rows = output_grads.chunks_exact_mut(OUTPUTS);
        let rows = rows.zip(extras.chunks_exact_mut(SUMS));
        for (row, (grads, extras)) in rows.take(params.rows as usize).enumerate() {
            let sample = &samples[(params.start as usize + row) * WIDTH..][..WIDTH];
            grads[HEADS..].copy_from_slice(&outputs[row * OUTPUTS + HEADS..][..LATENT]);
            extras[discriminator_loss::COSINE] = 0.0;
            encoder_loss::rows(&[sample], grads, extras, params);
        }
    }
}

#[test]
fn encoder_losses_agree() {
    for rows in [1, 64, 75] {
        let params = encoder_loss::Params {
            rows: rows as u32,
            start: START as u32,
            width: WIDTH as u32,
            heads: HEADS as u32,
            weight: 0.3,
        };
        let mut draw = Draw::new(5);
        let mut samples = draw.normals((START + rows) * WIDTH);
        for (row, sample) in samples.chunks_exact_mut(WIDTH).enumerate() {
            let latent = &mut sample[WINDOW + 1..];
            advance_latents::to_sphere(latent);
            // The recorded ones have none.
            if row % 3 == 0 {
                latent.fill(0.0);
            }
        }
        let outputs = draw.normals(rows * OUTPUTS);
        let before = vec![4.0f32; rows * OUTPUTS];
        let sums = vec![2.0f32; rows * discriminator_loss::SUMS];
        let dims = [WINDOW as u32, 100, OUTPUTS as u32];
        let forms = forms!(
            encoder_by_rows, ENCODER_LOSS, rows, params; dims, samples, outputs, mut before, mut sums
        );
        for (form, (grads, extras)) in forms.shaders() {
            agree(&format!("grads, {form}"), grads, &forms.twin.0);
            agree(&format!("extras, {form}"), extras, &forms.twin.1);
        }
        for row in 0..rows {
            let latent = &samples[(START + row) * WIDTH + WINDOW + 1..][..LATENT];
            let found = &outputs[row * OUTPUTS + HEADS..][..LATENT];
            let loss = |at: usize, by: f64| {
                let found: Vec<f64> = (0..LATENT)
                    .map(|i| f64::from(found[i]) + if i == at { by } else { 0.0 })
                    .collect();
                let product =
                    |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
                let latent: Vec<f64> = latent.iter().map(|&x| f64::from(x)).collect();
                -0.3 * product(&found, &latent) / product(&found, &found).sqrt()
            };
            let grads = &forms.twin.0[row * OUTPUTS..][..OUTPUTS];
            assert_eq!(grads[..HEADS], [4.0; HEADS]);
            for (at, grad) in grads[HEADS..].iter().enumerate() {
                let slope = (loss(at, 1e-6) - loss(at, -1e-6)) / 2e-6;
                assert!((f64::from(*grad) - slope).abs() < 1e-4, "{grad} {slope}");
            }
            // A window without a latent asks nothing of the encoder.
            if (START + row).is_multiple_of(3) {
                assert_eq!(grads[HEADS..], [0.0; LATENT]);
            }
        }
    }
}

#[test]
fn skill_rewards_agree() {
    for samples in [1u32, 65, 1000] {
        let params = skill_reward::Params {
            samples,
            outputs: OUTPUTS as u32,
            heads: HEADS as u32,
        };
        let mut draw = Draw::new(samples);
        let mut output = draw.normals(samples as usize * OUTPUTS);
        let mut latents = draw.normals(samples as usize * LATENT);
        latents
            .chunks_exact_mut(LATENT)
            .for_each(advance_latents::to_sphere);
        // Found; and nothing at all.
        output[HEADS..OUTPUTS].copy_from_slice(&latents[..LATENT]);
        if samples > 1 {
            output[OUTPUTS + HEADS..2 * OUTPUTS].fill(0.0);
        }
        let forms = forms!(
            skill_reward, SKILL_REWARD, samples as usize, params;
            output, latents, out samples as usize
        );
        for (form, reward) in forms.shaders() {
            close(form, reward, &forms.twin, |_| 1e-6);
        }
        assert!((forms.twin[0] - 1.0).abs() < 1e-6);
        assert!(samples == 1 || forms.twin[1] == 0.5);
    }
}

const ACTION: usize = 3;
const SEEN: usize = 2 + LATENT;
const ROW: usize = SEEN + 5 + ACTION + 2 * LATENT;

/// The CPU's function as the shader has its arrays.
mod diversity_by_rows {
    use super::*;
    use diversity_loss::Params;
    pub use footwork::kernels::learn::diversity_loss::launch;

    pub fn twin(
        _dims: &[u32],
        samples: &[f32],
        outputs: &[f32],
        output_grads: &mut [f32],
        params: &Params,
    ) {
        let rows = params.rows as usize;
        let samples = samples[START * ROW..].chunks_exact(ROW).take(rows);
        let samples: Vec<&[f32]> = samples.collect();
        let means = &outputs[..rows * ACTION];
        let more = diversity_loss::gradients(&samples, means, params);
        let pairs = output_grads.iter_mut().zip(more);
        pairs.for_each(|(gradient, more)| *gradient += more);
    }
}

#[test]
fn diversity_losses_agree() {
    for rows in [1, 64, 75] {
        let params = diversity_loss::Params {
            rows: rows as u32,
            start: START as u32,
            width: ROW as u32,
            latent: LATENT as u32,
            weight: 0.1,
        };
        let mut draw = Draw::new(6);
        let samples = draw.normals((START + rows) * ROW);
        // The critic's outputs follow.
        let outputs = draw.normals(rows * (ACTION + 1));
        let before = vec![0.25f32; rows * (ACTION + 1)];
        let dims = [SEEN as u32, 100, ACTION as u32, 1];
        let forms = forms!(
            diversity_by_rows, DIVERSITY_LOSS, rows, params; dims, samples, outputs, mut before
        );
        for (form, grads) in forms.shaders() {
            agree(form, grads, &forms.twin);
        }
        // Twice the slope of the definition, for the other action stands still here.
        for row in 0..rows {
            let sample: Vec<f64> = samples[(START + row) * ROW..][..ROW]
                .iter()
                .map(|&x| f64::from(x))
                .collect();
            let (own, other) = sample[ROW - 2 * LATENT..].split_at(LATENT);
            let product =
                |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let cosine = product(own, other) / (product(own, own) * product(other, other)).sqrt();
            let loss = |at: usize, by: f64| {
                let change = |i: usize| {
                    let moved = if i == at { by } else { 0.0 };
                    let mean = f64::from(outputs[row * ACTION + i]) + moved;
                    (mean - sample[ROW - 2 * LATENT - ACTION + i]).powi(2)
                };
                let mean = (0..ACTION).map(change).sum::<f64>() / ACTION as f64;
                0.1 * (1.0 - mean / (0.5 - 0.5 * cosine + 1e-5)).powi(2)
            };
            for at in 0..ACTION {
                let slope = (loss(at, 1e-6) - loss(at, -1e-6)) / 1e-6;
                let got = f64::from(forms.twin[row * ACTION + at]) - 0.25;
                assert!(
                    (got - slope).abs() < 2e-3 * (1.0 + slope.abs()),
                    "{got} {slope}"
                );
            }
        }
        assert!(forms.twin[rows * ACTION..].iter().all(|&x| x == 0.25));
    }
}
