//! Colours of characters: a mirrored or crossed leg shows at once.

/// Linear red, green and blue.
pub type Colour = [f32; 3];

/// Left limbs.
pub const LEFT: Colour = [0.10, 0.30, 0.68];
/// Right limbs.
pub const RIGHT: Colour = [0.85, 0.30, 0.06];
/// What is neither left nor right.
pub const TRUNK: Colour = [0.62, 0.64, 0.68];
/// What has no limbs.
const THING: Colour = [0.42, 0.34, 0.30];

/// Trunk, left limbs and right limbs of a bout's fighters: red, then blue.
const CORNERS: [(&str, [Colour; 3]); 2] = [
    (
        "red/",
        [[0.62, 0.06, 0.05], [0.86, 0.30, 0.22], [0.42, 0.03, 0.04]],
    ),
    (
        "blue/",
        [[0.05, 0.13, 0.62], [0.20, 0.42, 0.90], [0.03, 0.06, 0.36]],
    ),
];

/// The colour of a simulated body by its name; `alone` if nothing hangs on it, nor it on anything. Fighters have
/// the colours of their corners, paler at the left.
pub fn body_colour(name: &str, alone: bool) -> Colour {
    let corner = CORNERS.iter().find(|(corner, _)| name.starts_with(corner));
    let [trunk, left, right] = corner.map_or([TRUNK, LEFT, RIGHT], |(_, colours)| *colours);
    match name {
        _ if name.contains("left") => left,
        _ if name.contains("right") => right,
        _ if alone => THING,
        _ => trunk,
    }
}
