//! Oracle: layer after layer, output after output.

use super::network::*;
use crate::inputs::{Draw, POISON};
use crate::support::forms::Forms;
use footwork::kernels::learn::forward::Params;
use footwork::kernels::learn::network::{BLOCK, BatchLayout, NO_COPY, RELU, TANH};

/// The kernel for so many networks.
macro_rules! evaluate {
    ($name:ident, $networks:expr) => {
        mod $name {
            use super::*;
            use footwork::gpu::{Buffer, Gpu};

            pub fn launch(
                gpu: &Gpu,
                layout: &Buffer<u32>,
                samples: &Buffer<f32>,
                parameters: &Buffer<f32>,
                copies: &Buffer<u32>,
                rows: &Buffer<f32>,
                outputs: &Buffer<f32>,
                params: &Params,
            ) {
                footwork::kernels::learn::forward::launch(
                    gpu, $networks, layout, samples, parameters, copies, rows, outputs, params,
                );
            }

            pub fn twin(
                layout: &BatchLayout,
                samples: &[f32],
                parameters: &[f32],
                copies: &[u32],
                rows: &mut [f32],
                outputs: &mut [f32],
                params: &Params,
            ) {
                reference(
                    $networks, layout, samples, parameters, copies, rows, outputs, params,
                );
            }
        }
    };
}
evaluate!(one, 1);
evaluate!(both, 2);

fn reference(
    networks: usize,
    layout: &BatchLayout,
    samples: &[f32],
    parameters: &[f32],
    copies: &[u32],
    rows: &mut [f32],
    outputs: &mut [f32],
    params: &Params,
) {
    let copy = |row: usize| copies[row / BLOCK];
    let [count, start, width, first, mut to] = [
        params.rows,
        params.start,
        params.width,
        params.network,
        params.out_at,
    ]
    .map(|number| number as usize);
    let filled = count.next_multiple_of(BLOCK);
    for network in first..first + networks {
        let layers = layout.network(network);
        let [inputs, _, _, observed, _] = layers[0].sizes();
        let evaluated = |&(row, _): &(usize, usize)| copy(row) != NO_COPY;
        for (row, column) in pairs(filled, inputs).filter(evaluated) {
            let value = if row < count {
                samples[(start + row) * width + column]
            } else {
                0.0
            };
            rows[layout.at(row, observed + column)] = value;
        }
        for (index, layer) in layers.iter().enumerate() {
            let [inputs, width, weights, input_col, output_col] = layer.sizes();
            for (row, output) in pairs(filled, width).filter(evaluated) {
                let own = copy(row) as usize * layout.head.parameters as usize;
                let (weights, biases) = parameters[own + weights..].split_at(inputs * width);
                let terms = (0..inputs).zip(weights[output..].iter().step_by(width));
                let sum = terms.fold(biases[output], |sum, (input, weight)| {
                    sum + rows[layout.at(row, input_col + input)] * weight
                });
                let value = match layer.activation {
                    RELU => sum.max(0.0),
                    TANH => sum.tanh(),
                    _ => sum,
                };
                if index + 1 < layers.len() {
                    rows[layout.at(row, output_col + output)] = value;
                } else if row < count {
                    outputs[to + row * width + output] = value;
                }
            }
        }
        to += count * layout.outputs(network, network + 1);
    }
}

fn pairs(rows: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
}

/// Rows and outputs of both networks or of one of them, every block by one of the copies of the parameters.
fn run(case: &Case, copies: &[u32], networks: usize, network: u32) -> Forms<(Vec<f32>, Vec<f32>)> {
    let params = Params {
        rows: case.layout.head.rows,
        start: case.start,
        width: WIDTH as u32,
        network,
        out_at: 3,
    };
    let outputs = case
        .layout
        .outputs(network as usize, network as usize + networks);
    let len = 3 + case.count() * outputs;
    let groups = [case.count().div_ceil(BLOCK) as u32, 1, networks as u32];
    let words = case.layout.words();
    match networks {
        1 => forms!(
            one, FORWARD, groups, params;
            &case.layout => words, case.samples, case.parameters, copies, mut case.rows, out len
        ),
        _ => forms!(
            both, FORWARD, groups, params;
            &case.layout => words, case.samples, case.parameters, copies, mut case.rows, out len
        ),
    }
}

fn only_copy(case: &Case) -> Vec<u32> {
    vec![0; case.layout.blocks()]
}

/// Of three copies, in blocks that belong to any or to none.
#[test]
fn copies_of_the_parameters_evaluate_their_blocks() {
    for mut case in Case::all() {
        let mut draw = Draw::new(case.count() as u32);
        let others = draw.normals(2 * case.parameters.len());
        case.parameters
            .extend(others.iter().map(|value| 0.5 * value));
        let copies = [0, 1, 2, NO_COPY];
        let copies: Vec<u32> = (0..case.layout.blocks())
            .map(|_| copies[draw.below(4)])
            .collect();
        let forms = run(&case, &copies, 1, 0);
        let evaluated = |outputs: &[f32]| -> Vec<f32> {
            let rows = outputs[3..].chunks_exact(ACTION).enumerate();
            let rows = rows.filter(|(row, output)| {
                let none = copies[row / BLOCK] == NO_COPY;
                assert_eq!(*output == [POISON; ACTION], none, "row {row}");
                !none
            });
            rows.flat_map(|(_, output)| output).copied().collect()
        };
        for (form, (_, outputs)) in forms.shaders() {
            agree(form, &evaluated(outputs), &evaluated(&forms.twin.1));
        }
    }
}

#[test]
fn forward_agrees() {
    for case in Case::all() {
        for (networks, network) in [(2, 0), (1, 0), (1, 1)] {
            let forms = run(&case, &only_copy(&case), networks, network);
            for (form, (rows, outputs)) in forms.shaders() {
                agree(&format!("rows, {form}"), rows, &forms.twin.0);
                agree(
                    &format!("outputs, {form}"),
                    &outputs[3..],
                    &forms.twin.1[3..],
                );
                assert_eq!(outputs[..3], [POISON; 3]);
            }
        }
    }
}

/// What is too large for the exponential.
#[test]
fn sums_of_any_size_are_activated() {
    let mut case = Case::new(&[32, 32], TANH, 9);
    let layer = case.layout.layers[0];
    let biases = (layer.weights + layer.inputs * layer.outputs) as usize;
    let extreme = [1e30, -1e30, f32::INFINITY, 20.0, -20.0, 0.0];
    case.parameters[biases..][..6].copy_from_slice(&extreme);
    let forms = run(&case, &only_copy(&case), 2, 0);
    for (form, (rows, _)) in forms.shaders() {
        agree(form, rows, &forms.twin.0);
        let at = |output: usize| rows[case.layout.at(0, layer.output_col as usize + output)];
        assert_eq!([0, 1, 2].map(at), [1.0, -1.0, 1.0]);
    }
}
