//! Oracle: layer after layer, input after input.

use super::network::*;
use crate::inputs::Draw;
use footwork::kernels::learn::backward::Params;
use footwork::kernels::learn::network::{BLOCK, BatchLayout, RELU, TANH};

/// The kernel for both networks.
mod both {
    use super::*;
    use footwork::gpu::{Buffer, Gpu};

    pub fn launch(
        gpu: &Gpu,
        layout: &Buffer<u32>,
        parameters: &Buffer<f32>,
        rows: &Buffer<f32>,
        output_grads: &Buffer<f32>,
        extras: &Buffer<f32>,
        grads: &Buffer<f32>,
        params: &Params,
    ) {
        footwork::kernels::learn::backward::launch(
            gpu,
            NETWORKS,
            layout,
            parameters,
            rows,
            output_grads,
            extras,
            grads,
            params,
        );
    }

    pub fn twin(
        layout: &BatchLayout,
        parameters: &[f32],
        rows: &[f32],
        output_grads: &[f32],
        extras: &[f32],
        grads: &mut [f32],
        params: &Params,
    ) {
        let count = params.rows as usize;
        let filled = count.next_multiple_of(BLOCK);
        let mut write = |values: &[f32], width: usize, column: usize| {
            for row in 0..filled {
                for i in 0..width {
                    let value = if row < count {
                        values[row * width + i]
                    } else {
                        0.0
                    };
                    grads[layout.at(row, column + i)] = value;
                }
            }
        };
        let [_, width, _, _, column] = layout.extras().sizes();
        write(extras, width, column);
        for network in 0..NETWORKS {
            let last = layout.network(network).last().expect("a layer");
            let [_, width, _, _, column] = last.sizes();
            write(
                &output_grads[count * layout.outputs(0, network)..],
                width,
                column,
            );
        }
        for network in 0..NETWORKS {
            for pair in layout.network(network).windows(2).rev() {
                let [inputs, outputs, weights, input_col, output_col] = pair[1].sizes();
                for row in 0..filled {
                    for input in 0..inputs {
                        let weights = &parameters[weights + input * outputs..][..outputs];
                        let terms = weights.iter().zip(output_col..);
                        let terms = terms.map(|(w, column)| w * grads[layout.at(row, column)]);
                        let sum: f32 = terms.sum();
                        let at = layout.at(row, input_col + input);
                        grads[at] = match pair[0].activation {
                            RELU if rows[at] > 0.0 => sum,
                            RELU => 0.0,
                            TANH => sum * (1.0 - rows[at] * rows[at]),
                            _ => sum,
                        };
                    }
                }
            }
        }
    }
}

#[test]
fn backward_agrees() {
    for case in Case::all() {
        let params = Params {
            rows: case.layout.head.rows,
        };
        let mut draw = Draw::new(2);
        let output_grads = draw.normals(case.count() * case.layout.outputs(0, NETWORKS));
        let extras = draw.normals(case.count() * (ACTION + SUMS));
        let groups = [case.count().div_ceil(BLOCK) as u32, 1, NETWORKS as u32];
        let forms = forms!(
            both, BACKWARD, groups, params;
            &case.layout => case.layout.words(), case.parameters, case.rows, output_grads, extras,
            mut case.grads
        );
        forms_agree("grads", &forms);
        assert_ne!(forms.twin, case.grads);
        let [_, width, _, _, column] = case.layout.extras().sizes();
        for row in case.count()..case.filled() {
            let at = |i: usize| forms.launched[case.layout.at(row, column + i)];
            assert!(
                (0..width).all(|i| at(i) == 0.0),
                "what fills a block has no gradient"
            );
        }
    }
}
