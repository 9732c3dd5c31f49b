//! Oracle: the splits added up in their order.

use super::network::*;
use crate::inputs::Draw;
use footwork::kernels::learn::network::BatchLayout;

/// The kernel, which has no parameters.
mod plain {
    use super::*;
    use footwork::gpu::{Buffer, Gpu};

    pub fn launch(
        gpu: &Gpu,
        layout: &Buffer<u32>,
        partials: &Buffer<f32>,
        gradient: &Buffer<f32>,
        sums: &Buffer<f32>,
        _: &(),
    ) {
        footwork::kernels::learn::reduce_grads::launch(gpu, layout, partials, gradient, sums);
    }

    pub fn twin(
        layout: &BatchLayout,
        partials: &[f32],
        gradient: &mut [f32],
        sums: &mut [f32],
        (): &(),
    ) {
        let parameters = layout.head.parameters as usize;
        let splits = partials.chunks_exact(parameters + SUMS);
        gradient[..parameters].fill(0.0);
        for split in splits.take(layout.head.splits as usize) {
            let (gradients, more) = split.split_at(parameters);
            gradient
                .iter_mut()
                .zip(gradients)
                .for_each(|(sum, value)| *sum += value);
            sums.iter_mut()
                .zip(more)
                .for_each(|(sum, value)| *sum += value);
        }
    }
}

#[test]
fn reduce_grads_agrees() {
    for case in Case::all() {
        let parameters = case.layout.head.parameters as usize;
        let partials = Draw::new(3).normals(case.layout.partials());
        let forms = forms!(
            plain, REDUCE_GRADS, parameters + SUMS, ();
            &case.layout => case.layout.words(), partials, out parameters, mut [0.5; SUMS]
        );
        for (form, (gradient, sums)) in forms.shaders() {
            agree(&format!("gradient, {form}"), gradient, &forms.twin.0);
            agree(&format!("sums, {form}"), sums, &forms.twin.1);
        }
    }
}
