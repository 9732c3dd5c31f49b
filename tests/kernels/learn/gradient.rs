//! Oracle: split after split, layer after layer, row after row.

use super::network::*;
use crate::inputs::POISON;
use footwork::kernels::learn::gradient::groups;
use footwork::kernels::learn::network::{BLOCK, BatchLayout};

/// The kernel with the workgroups of its layout.
mod whole {
    use super::*;
    use footwork::gpu::{Buffer, Gpu};

    pub fn launch(
        gpu: &Gpu,
        layout: &Buffer<u32>,
        rows: &Buffer<f32>,
        grads: &Buffer<f32>,
        partials: &Buffer<f32>,
        groups: &[u32; 3],
    ) {
        footwork::kernels::learn::gradient::launch(gpu, *groups, layout, rows, grads, partials);
    }

    pub fn twin(
        layout: &BatchLayout,
        rows: &[f32],
        grads: &[f32],
        partials: &mut [f32],
        _: &[u32; 3],
    ) {
        let head = &layout.head;
        let (split, all) = (head.split_blocks as usize * BLOCK, layout.blocks() * BLOCK);
        let numbers = (head.parameters + head.sums) as usize;
        for (number, partial) in partials.chunks_exact_mut(numbers).enumerate() {
            for layer in &layout.layers {
                let [inputs, outputs, weights, input_col, output_col] = layer.sizes();
                let sums = &mut partial[weights..][..(inputs + 1) * outputs];
                sums.fill(0.0);
                for row in number * split..all.min((number + 1) * split) {
                    // A bias is the weight of an input that is always one.
                    let inputs = (0..inputs).map(|input| rows[layout.at(row, input_col + input)]);
                    for (input, sums) in inputs.chain([1.0]).zip(sums.chunks_exact_mut(outputs)) {
                        for (output, sum) in sums.iter_mut().enumerate() {
                            *sum += input * grads[layout.at(row, output_col + output)];
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn gradient_agrees() {
    for case in Case::all() {
        let groups = groups(&case.layout);
        let mut run = crate::support::forms::Run::new();
        let words = case.layout.words();
        let layout = run.input(&words);
        let (rows, grads) = (run.input(&case.rows), run.input(&case.grads));
        let poison = vec![POISON; case.layout.partials()];
        let mut partials = run.output(poison);
        whole::twin(
            &case.layout,
            &case.rows,
            &case.grads,
            &mut partials.host()[..case.layout.partials()],
            &groups,
        );
        whole::launch(&run.gpu, &layout, &rows, &grads, partials.device(), &groups);
        let checked = run.checked(&footwork::gpu::shader::GRADIENT, groups, &());
        let launched = partials.launched(&run.gpu);
        let checked = partials.checked(&checked);
        let twin = partials.twin();
        assert!(twin.iter().all(|&value| value != POISON), "all is written");
        agree("launched", &launched, &twin);
        agree("checked", &checked, &twin);
    }
}
