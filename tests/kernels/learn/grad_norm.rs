//! Oracles: `grad_norm::twin`, and the sum of squares in f64.

use super::network::agree;
use crate::inputs::Draw;
use footwork::kernels::learn::grad_norm::NORM_PARTIALS;

/// The kernel, which has no parameters.
mod plain {
    use footwork::gpu::{Buffer, Gpu};
    use footwork::kernels::learn::grad_norm;

    pub fn launch(
        gpu: &Gpu,
        parameters: &Buffer<u32>,
        gradient: &Buffer<f32>,
        norm_partials: &Buffer<f32>,
        _: &(),
    ) {
        grad_norm::launch(gpu, parameters, gradient, norm_partials);
    }

    pub fn twin(_: &[u32], gradient: &[f32], norm_partials: &mut [f32], (): &()) {
        grad_norm::twin(gradient, &mut norm_partials[..grad_norm::NORM_PARTIALS]);
    }
}

/// The last: three million parameters, more than one read of the whole gradient by each of them allows.
#[test]
fn grad_norm_agrees() {
    for parameters in [1, 63, 64, 65, 4097, 226_553, 3_000_000] {
        let gradient = Draw::new(4).normals(parameters);
        let forms = forms!(
            plain, GRAD_NORM, [NORM_PARTIALS as u32, 1, 1], ();
            [parameters as u32], gradient, out NORM_PARTIALS
        );
        let square: f64 = gradient.iter().map(|&g| f64::from(g) * f64::from(g)).sum();
        for (form, parts) in forms.all() {
            agree(form, parts, &forms.twin);
            let sum: f64 = parts.iter().map(|&part| f64::from(part)).sum();
            assert!(
                (sum - square).abs() < 1e-4 * square,
                "{form}: {sum} instead of {square}"
            );
        }
    }
}
