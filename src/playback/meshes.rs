//! Meshes of the shapes, as triangles.

/// The unit sphere around z as triangles, cut open at its equator: `w` is 0 below, 1 above.
/// `around` corners a ring, `up` rings from the equator to a pole.
pub fn sphere(around: usize, up: usize) -> Vec<[f32; 4]> {
    use std::f32::consts::{FRAC_PI_2, TAU};
    let below = (0..=up).map(|ring| (ring as f32 / up as f32 - 1.0, 0.0));
    let above = (0..=up).map(|ring| (ring as f32 / up as f32, 1.0));
    let rings: Vec<(f32, f32)> = below.chain(above).collect();
    let corner = |(height, end): (f32, f32), step: usize| {
        let (sin, cos) = (TAU * step as f32 / around as f32).sin_cos();
        let (z, out) = (FRAC_PI_2 * height).sin_cos();
        [out * cos, out * sin, z, end]
    };
    let mut corners = Vec::new();
    for pair in rings.windows(2) {
        for step in 0..around {
            let [a, b] = [step, step + 1].map(|step| corner(pair[0], step));
            let [c, d] = [step, step + 1].map(|step| corner(pair[1], step));
            corners.extend([a, b, c, c, b, d]);
        }
    }
    corners
}

/// The cube from -1 to 1 as triangles: corner and normal.
pub fn cube() -> Vec<[[f32; 3]; 2]> {
    let mut corners = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0f32, 1.0] {
            for (u, v) in [(-1, -1), (1, -1), (-1, 1), (-1, 1), (1, -1), (1, 1)] {
                let (mut at, mut normal) = ([0.0; 3], [0.0; 3]);
                (at[axis], normal[axis]) = (sign, sign);
                // Counterclockwise, seen from outside.
                (at[(axis + 1) % 3], at[(axis + 2) % 3]) = (u as f32, sign * v as f32);
                corners.push([at, normal]);
            }
        }
    }
    corners
}
