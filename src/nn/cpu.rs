//! Networks on the CPU: narrow layers and convolutions by custom kernels, wide layers as products of
//! matrices.
//!
//! A batch is split over the cores; a split goes through a network in chunks that stay in a core's cache.
//! Splits and chunks do not depend on how many cores there are, and sums over them are taken in their
//! order: nor do the results, bit for bit. The gradients of narrow layers are summed for each split and
//! then over the splits; those of wide layers over all rows at once, some rows of the weights a core.

mod layers;
mod matmul;
mod microkernel;
mod penalty;
mod tanh;

use super::extent::{EngineSize, Rows, Samples};
use super::network::{LayerParams, Network};
use super::objective::{HostBatch, Objective};
use crate::gpu::Array;
use layers::is_wide;
use rayon::prelude::*;

/// Rows evaluated together.
const FORWARD_ROWS: usize = 64;
/// Rows taken through a narrow network and back together.
const CHUNK_ROWS: usize = 32;
/// The fewest and the most rows taken through a network with wide layers: a quarter of a minibatch.
const WIDE_CHUNK_ROWS: [usize; 2] = [64, 256];
/// Splits of a batch of which each has gradients of its own: more would spend more time adding them.
const GRAD_SPLITS: usize = 8;
/// Rows of which wide layers keep what they see until their gradients are summed.
const BLOCK_ROWS: usize = 2048;
/// Inputs of a wide layer whose weights' gradients are summed together.
const WIDE_INPUTS: usize = 128;

/// Networks over one flat vector, on the CPU.
pub(super) struct CpuEngine {
    networks: Vec<Network>,
    size: EngineSize,
}

impl CpuEngine {
    pub fn new(networks: Vec<Network>, size: EngineSize) -> Self {
        CpuEngine { networks, size }
    }

    pub fn forward(
        &self,
        network: usize,
        parameters: &Array,
        samples: Samples,
        out: &mut Array,
        out_at: usize,
    ) {
        let network = &self.networks[network];
        let Samples { width, count, .. } = samples;
        let observations = &samples.values.host()[samples.first * width..][..count * width];
        let out = &mut out.host_mut()[out_at..][..count * network.outputs()];
        forward(network, parameters.host(), observations, out);
    }

    pub fn gradient(
        &self,
        parameters: &Array,
        samples: &Array,
        width: usize,
        rows: Rows,
        objective: &dyn Objective,
        gradient: &mut Array,
        sums: &mut Array,
    ) {
        let row = |at: usize| &samples.host()[at * width..][..width];
        let rows: Vec<&[f32]> = match rows {
            Rows::Range(rows) => rows.map(row).collect(),
            Rows::Indices(rows) => rows.iter().map(|&at| row(at as usize)).collect(),
        };
        let (gradient, sums) = (gradient.host_mut(), sums.host_mut());
        let batch = Minibatch {
            rows: &rows,
            flat: parameters.host(),
            objective,
            extras: self.size.extras,
        };
        let behind = self.size.parameters - self.size.others(&self.networks);
        let (mut rest, others) = gradient.split_at_mut(behind);
        let mut parts = Vec::new();
        for network in &self.networks {
            let (part, after) = rest.split_at_mut(network.span().len());
            (rest, _) = (after, parts.push(part));
        }
        let networks = self.networks.par_iter().zip(parts).enumerate();
        let extras: Vec<Vec<f32>> = networks
            .map(|(number, (network, gradient))| batch.gradient(number, network, gradient))
            .collect();
        others.fill(0.0);
        for extras in extras {
            let (of_others, of_sums) = extras.split_at(others.len());
            add(others, of_others);
            add(sums, of_sums);
        }
    }
}

/// Writes the outputs `[n][outputs]` for observations `[n][observation]`, on all cores.
pub fn forward(network: &Network, flat: &[f32], observations: &[f32], out: &mut [f32]) {
    let (width, outputs) = (network.observation().dim(), network.outputs());
    let chunks = observations.par_chunks(FORWARD_ROWS * width);
    let chunks = chunks.zip(out.par_chunks_mut(FORWARD_ROWS * outputs));
    chunks.for_each_init(Pass::default, |pass, (observations, out)| {
        let rows: Vec<&[f32]> = observations.chunks_exact(width).collect();
        pass.forward(network, flat, &rows);
        out.copy_from_slice(&pass.outputs());
    });
}

/// The memory of evaluations of a network for one observation at a time, which a next one uses again.
#[derive(Clone, Default)]
pub struct ForwardScratch(Pass);

/// The outputs for one observation, on this core alone. From the second evaluation of a network on nothing is
/// allocated.
pub fn forward_one<'a>(
    network: &Network,
    flat: &[f32],
    observation: &[f32],
    scratch: &'a mut ForwardScratch,
) -> &'a [f32] {
    scratch.0.forward(network, flat, &[observation]);
    &scratch.0.inputs[network.layers().len()]
}

fn add(sums: &mut [f32], values: &[f32]) {
    sums.iter_mut()
        .zip(values)
        .for_each(|(sum, value)| *sum += value);
}

/// What the gradient is taken of.
struct Minibatch<'a> {
    rows: &'a [&'a [f32]],
    flat: &'a [f32],
    objective: &'a dyn Objective,
    /// Numbers of the extras.
    extras: usize,
}

/// What a split leaves.
struct Split {
    /// Gradients of the narrow layers, one after another.
    narrow: Vec<f32>,
    extras: Vec<f32>,
    /// What the gradients of the wide layers are made of.
    wide: Vec<(Pass, Vec<Vec<f32>>)>,
}

impl Minibatch<'_> {
    /// Writes the gradient of a network's parameters. Returns the extras.
    fn gradient(&self, number: usize, network: &Network, gradient: &mut [f32]) -> Vec<f32> {
        let wide = network.layers().iter().any(|params| is_wide(&params.layer));
        let [fewest, most] = WIDE_CHUNK_ROWS;
        let (block, split) = match wide {
            true => (BLOCK_ROWS, (self.rows.len() / 4).clamp(fewest, most)),
            false => (self.rows.len(), self.rows.len().div_ceil(GRAD_SPLITS)),
        };
        let chunk = if wide { split } else { CHUNK_ROWS };
        let layers = network.layers().iter();
        let transposed = layers.map(|params| layers::transpose(params, self.flat));
        let transposed: Vec<Vec<f32>> = transposed.collect();
        let mut extras = vec![0.0; self.extras];
        gradient.fill(0.0);
        for rows in self.rows.chunks(block.max(1)) {
            let splits = rows.par_chunks(split.max(1));
            let splits = splits.map(|rows| self.split(number, network, &transposed, chunk, rows));
            let splits: Vec<Split> = splits.collect();
            splits
                .iter()
                .for_each(|split| add(&mut extras, &split.extras));
            sum_gradients(network, &splits, gradient);
        }
        extras
    }

    fn split(
        &self,
        number: usize,
        network: &Network,
        transposed: &[Vec<f32>],
        chunk: usize,
        rows: &[&[f32]],
    ) -> Split {
        let narrow = network.layers().iter().map(narrow_len);
        let mut split = Split {
            narrow: vec![0.0; narrow.sum()],
            extras: vec![0.0; self.extras],
            wide: Vec::new(),
        };
        let mut pass = Pass::default();
        for rows in rows.chunks(chunk) {
            pass.forward(network, self.flat, rows);
            let mut outputs = pass.outputs();
            let batch = HostBatch {
                network: number,
                rows,
                parameters: self.flat,
            };
            self.objective
                .loss_gradient(&batch, &mut outputs, &mut split.extras);
            let wide = pass.back(network, self.flat, transposed, outputs, &mut split.narrow);
            if wide.iter().any(|gradient| !gradient.is_empty()) {
                split.wide.push((std::mem::take(&mut pass), wide));
            }
        }
        split
    }
}

/// Parameters of a layer whose gradient every split sums by itself.
fn narrow_len(params: &LayerParams) -> usize {
    match is_wide(&params.layer) {
        true => 0,
        false => params.span().len(),
    }
}

/// Adds the splits' gradients to that of the network.
fn sum_gradients(network: &Network, splits: &[Split], gradient: &mut [f32]) {
    let (mut rest, mut narrow_at) = (gradient, 0);
    let mut parts = Vec::new();
    for (number, params) in network.layers().iter().enumerate() {
        let (sums, after) = rest.split_at_mut(params.span().len());
        rest = after;
        match is_wide(&params.layer) {
            true => {
                let rows = sums
                    .chunks_mut(WIDE_INPUTS * params.layer.filters())
                    .enumerate();
                parts.extend(rows.map(|(row, sums)| (number, Some(row * WIDE_INPUTS), 0, sums)));
            }
            false => parts.push((number, None, narrow_at, sums)),
        }
        narrow_at += narrow_len(params);
    }
    parts
        .into_par_iter()
        .for_each(|(number, first, narrow_at, sums)| {
            let layer = &network.layers()[number].layer;
            for split in splits {
                match first {
                    None => add(sums, &split.narrow[narrow_at..][..sums.len()]),
                    Some(first) => split.wide.iter().for_each(|(pass, gradients)| {
                        let (input, gradient) = (&pass.inputs[number], &gradients[number]);
                        layers::add_wide_gradient(layer, first, input, gradient, sums);
                    }),
                }
            }
        });
}

/// What some rows left on their way through a network.
#[derive(Clone, Default)]
struct Pass {
    /// Activations of every layer, `[rows][..]`; the outputs last.
    inputs: Vec<Vec<f32>>,
    rows: usize,
    /// Memory for the layers' patches, and for what joins maps and vectors.
    offsets: Vec<usize>,
    joined: Vec<f32>,
}

impl Pass {
    /// Takes rows that begin with observations through a network.
    fn forward(&mut self, network: &Network, flat: &[f32], rows: &[&[f32]]) {
        let (spec, encoder) = (network.observation(), network.encoder_len());
        self.rows = rows.len();
        self.inputs
            .resize_with(network.layers().len() + 1, Vec::new);
        self.inputs[0].clear();
        let begin = if encoder > 0 { spec.vector } else { 0 };
        for row in rows {
            self.inputs[0].extend_from_slice(&row[begin..spec.dim()]);
        }
        for (number, params) in network.layers().iter().enumerate() {
            let (inputs, outputs) = self.inputs.split_at_mut(number + 1);
            let output = &mut outputs[0];
            let offsets = &mut self.offsets;
            layers::forward(params, flat, &inputs[number], rows.len(), offsets, output);
            if number + 1 == encoder {
                join(rows, spec.vector, output, &mut self.joined);
                std::mem::swap(output, &mut self.joined);
            }
        }
    }

    /// Takes the outputs out.
    fn outputs(&mut self) -> Vec<f32> {
        self.inputs.pop().unwrap_or_default()
    }

    /// Adds the gradients of the narrow layers to `narrow`, given that of the outputs. Returns the gradients
    /// with respect to the sums of the wide layers, by layer.
    fn back(
        &self,
        network: &Network,
        flat: &[f32],
        transposed: &[Vec<f32>],
        mut gradient: Vec<f32>,
        narrow: &mut [f32],
    ) -> Vec<Vec<f32>> {
        let layers = network.layers();
        let mut wide = vec![Vec::new(); layers.len()];
        let mut narrow_at = narrow.len();
        for (number, params) in layers.iter().enumerate().rev() {
            let input = &self.inputs[number];
            narrow_at -= narrow_len(params);
            if !is_wide(&params.layer) {
                let sums = &mut narrow[narrow_at..][..params.span().len()];
                layers::add_gradient(&params.layer, input, &gradient, sums);
            }
            let Some(below) = number.checked_sub(1) else {
                if is_wide(&params.layer) {
                    wide[number] = gradient;
                }
                break;
            };
            let transposed = &transposed[number];
            let mut next = layers::input_gradient(params, flat, transposed, &gradient, input.len());
            let kind = layers[below].layer.activation();
            if number == network.encoder_len() {
                // The vector joined here; it does not learn.
                let vector = network.observation().vector;
                let joined = self.after(vector, input);
                next = self.after(vector, &next);
                layers::activation_backward(kind, &mut next, &joined);
            } else {
                layers::activation_backward(kind, &mut next, input);
            }
            let above = std::mem::replace(&mut gradient, next);
            if is_wide(&params.layer) {
                wide[number] = above;
            }
        }
        wide
    }

    /// Every row from a column on.
    fn after(&self, column: usize, values: &[f32]) -> Vec<f32> {
        let rows = values.chunks_exact(values.len() / self.rows);
        rows.flat_map(|row| &row[column..]).copied().collect()
    }
}

/// Puts the vector of every observation, and what an encoder made of its maps, in the place of `joined`.
fn join(rows: &[&[f32]], vector: usize, encoded: &[f32], joined: &mut Vec<f32>) {
    let width = encoded.len() / rows.len().max(1);
    joined.clear();
    joined.reserve(rows.len() * (vector + width));
    for (row, encoded) in rows.iter().zip(encoded.chunks_exact(width)) {
        joined.extend_from_slice(&row[..vector]);
        joined.extend_from_slice(encoded);
    }
}
