//! Oracles: `adam::twin`, and Kingma and Ba's algorithm 1 in f64.

use super::network::agree;
use crate::inputs::Draw;
use footwork::kernels::learn::adam::{self, groups};
use footwork::kernels::learn::grad_norm::{self, NORM_PARTIALS};

/// A step with a norm that is clipped, one that is not, and none.
#[test]
fn adam_agrees() {
    for (parameters, max_grad_norm) in [(1, 0.5), (75, 0.5), (5000, 1e9), (70_001, 0.0)] {
        let mut draw = Draw::new(4);
        let mut some = || draw.normals(parameters);
        let (start, gradient, m) = (some(), some(), some());
        let v: Vec<f32> = some().into_iter().map(|value| value * value).collect();
        let mut norm_partials = vec![0.0; NORM_PARTIALS];
        grad_norm::twin(&gradient, &mut norm_partials);
        let params = adam::Params::new(
            parameters,
            3,
            0.01,
            max_grad_norm,
            parameters / 3..parameters / 2,
        );
        let rates = [1.0, 0.25];
        let forms = forms!(
            adam, ADAM, groups(parameters), params;
            gradient, norm_partials, mut start, mut m, mut v, rates
        );
        for (form, (parameters, m, v)) in forms.shaders() {
            agree(&format!("parameters, {form}"), parameters, &forms.twin.0);
            agree(&format!("m, {form}"), m, &forms.twin.1);
            agree(&format!("v, {form}"), v, &forms.twin.2);
        }
        let wide = |values: &[f32]| values.iter().map(|&v| f64::from(v)).collect::<Vec<_>>();
        let (gradient, m, v) = (wide(&gradient), wide(&m), wide(&v));
        let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        let scale = match max_grad_norm > 0.0 {
            true => (max_grad_norm / norm).min(1.0),
            false => 1.0,
        };
        let stepped = (0..parameters).map(|i| {
            let gradient = gradient[i] * scale;
            let m = (0.9 * m[i] + 0.1 * gradient) / (1.0 - 0.9f64.powi(3));
            let v = (0.999 * v[i] + 0.001 * gradient * gradient) / (1.0 - 0.999f64.powi(3));
            let second = (parameters / 3..parameters / 2).contains(&i);
            let lr = if second { 0.0025 } else { 0.01 };
            (f64::from(start[i]) - lr * m / (v.sqrt() + 1e-5)) as f32
        });
        let stepped: Vec<f32> = stepped.collect();
        crate::inputs::close("algorithm 1", &forms.twin.0, &stepped, |_| 1e-5);
    }
}

/// Workgroups reach every parameter, and none lies in a dimension that is too long.
#[test]
fn groups_reach_every_parameter() {
    for parameters in [1, 64, 65, 3_000_000, 100_000_000] {
        let [x, y, z] = groups(parameters);
        assert!(x < 65_536 && y < 65_536 && z == 1);
        assert!(x as usize * y as usize * 64 >= parameters);
    }
}
