//! The character frame on the ground: x is left, z is forward.
//!
//! `heading` is the unit forward direction in the world, `[x, z]`. Everything is metres. The same
//! two functions are in `shaders/shared/math.wgsl`.

/// A ground vector from the character frame to the world.
pub fn to_world(local: [f32; 2], heading: [f32; 2]) -> [f32; 2] {
    [
        heading[1] * local[0] + heading[0] * local[1],
        heading[1] * local[1] - heading[0] * local[0],
    ]
}

/// A ground vector from the world to the character frame.
pub fn to_local(world: [f32; 2], heading: [f32; 2]) -> [f32; 2] {
    [
        heading[1] * world[0] - heading[0] * world[1],
        heading[0] * world[0] + heading[1] * world[1],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facing_east_left_is_north() {
        // y up, facing +x: the left side is -z, since up x forward = (0,1,0) x (1,0,0) = (0,0,-1).
        assert_eq!(to_world([1.0, 0.0], [1.0, 0.0]), [0.0, -1.0]);
        assert_eq!(to_world([0.0, 1.0], [1.0, 0.0]), [1.0, 0.0]);
        assert_eq!(to_local([0.0, -1.0], [1.0, 0.0]), [1.0, 0.0]);
    }
}
