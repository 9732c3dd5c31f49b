//! Policy and critic on the CPU, by kernels of our own: burn's run convolutions of these sizes, and
//! many small operations after each other, several times slower.
//!
//! A batch is cut into pieces, spread over the cores; a piece goes through a network in chunks that
//! stay in a core's cache. Pieces and chunks do not depend on how many cores there are, and sums
//! over them are taken in their order: nor do the results, bit for bit.

pub mod layers;
pub mod minibatch_step;
mod kernels;
pub mod loss;
mod tanh;

use super::network::{Net, Place};
use crate::kernels::locomotion::locomotion_layout::BASE_OBS_DIM;
use chain::{backward, forward};
use rayon::prelude::*;

/// Samples taken through a network together.
const CHUNK: usize = 32;
/// Pieces of a batch of which each has gradients of its own: more would spend more time adding them.
const PIECES: usize = 8;

/// Answers `[n][..]` for observations `[n][width]`.
pub fn answer(net: &Net<Place>, flat: &[f32], observations: &[f32], width: usize) -> Vec<f32> {
    let observations: Vec<&[f32]> = observations.chunks_exact(width).collect();
    let answers = observations.par_chunks(CHUNK).flat_map_iter(|chunk| {
        let mut pass = Pass::new(net, flat, chunk);
        pass.hidden.pop().unwrap_or_default()
    });
    answers.collect()
}

/// Gradient with respect to the network's parameters of a loss that `judge` knows, and every piece's
/// other sums. `judge` is given rows, the answers to them `[rows][..]` and its sums to add to; it
/// writes over the answers the loss's gradient with respect to them. A row begins with an observation
/// of `width` numbers.
pub fn gradient<S: Send>(
    net: &Net<Place>,
    flat: &[f32],
    rows: &[&[f32]],
    width: usize,
    sums: impl Fn() -> S + Sync,
    judge: impl Fn(&[&[f32]], &mut [f32], &mut S) + Sync,
) -> (Vec<f32>, Vec<S>) {
    let transposed = net.map(|place| layers::transpose(&place.layer, &flat[place.weights()]));
    let span = net.span();
    let pieces = rows.par_chunks(rows.len().div_ceil(PIECES).max(1));
    let piece = |rows: &[&[f32]]| {
        let (mut gradient, mut sums) = (vec![0.0; span.len()], sums());
        for chunk in rows.chunks(CHUNK) {
            let observations: Vec<&[f32]> = chunk.iter().map(|row| &row[..width]).collect();
            let mut pass = Pass::new(net, flat, &observations);
            let mut answers = pass.hidden.pop().unwrap_or_default();
            judge(chunk, &mut answers, &mut sums);
            pass.back(net, &transposed, answers, &mut gradient, span.start);
        }
        (gradient, sums)
    };
    let (gradients, sums): (Vec<Vec<f32>>, Vec<S>) = pieces.map(piece).unzip();
    (total(gradients), sums)
}

/// The sum of vectors of one length, in their order.
fn total(vectors: Vec<Vec<f32>>) -> Vec<f32> {
    const STRIP: usize = 1 << 13;
    let mut vectors = vectors.into_iter();
    let mut total = vectors.next().unwrap_or_default();
    let rest: Vec<Vec<f32>> = vectors.collect();
    let strips = total.par_chunks_mut(STRIP).enumerate();
    strips.for_each(|(i, strip)| {
        for vector in &rest {
            let values = &vector[i * STRIP..][..strip.len()];
            strip
                .iter_mut()
                .zip(values)
                .for_each(|(sum, value)| *sum += value);
        }
    });
    total
}

/// Everything a chunk left on its way through a network.
struct Pass {
    maps: Vec<f32>,
    /// Of every layer.
    sight: Vec<Vec<f32>>,
    /// What the hidden layers begin with.
    joined: Vec<f32>,
    hidden: Vec<Vec<f32>>,
    samples: usize,
}

impl Pass {
    fn new(net: &Net<Place>, flat: &[f32], observations: &[&[f32]]) -> Pass {
        let maps: Vec<f32> = match net.sees {
            true => observations
                .iter()
                .flat_map(|row| &row[BASE_OBS_DIM..])
                .copied()
                .collect(),
            false => Vec::new(),
        };
        let samples = observations.len();
        let sight = forward(&net.sight, flat, &maps, samples);
        let seen = sight.last().unwrap_or(&maps);
        let width = seen.len() / samples.max(1);
        let mut joined = Vec::with_capacity(samples * (BASE_OBS_DIM + width));
        for (i, row) in observations.iter().enumerate() {
            joined.extend_from_slice(&row[..BASE_OBS_DIM]);
            joined.extend_from_slice(&seen[i * width..][..width]);
        }
        let hidden = forward(&net.hidden, flat, &joined, samples);
        Pass {
            maps,
            sight,
            joined,
            hidden,
            samples,
        }
    }

    /// Adds the gradients of the parameters from `first` on, given that of the answers, whose
    /// activations are no longer needed.
    fn back(
        &self,
        net: &Net<Place>,
        transposed: &Net<Vec<f32>>,
        answers: Vec<f32>,
        sums: &mut [f32],
        first: usize,
    ) {
        let below = net.sees && !net.sight.is_empty();
        let joined = backward(
            (&net.hidden, &transposed.hidden),
            (&self.joined, &self.hidden),
            answers,
            below,
            (sums, first),
        );
        if !below {
            return;
        }
        let width = joined.len() / self.samples;
        let seen: Vec<f32> = joined
            .chunks_exact(width)
            .flat_map(|row| &row[BASE_OBS_DIM..])
            .copied()
            .collect();
        backward(
            (&net.sight, &transposed.sight),
            (&self.maps, &self.sight),
            seen,
            false,
            (sums, first),
        );
    }
}
