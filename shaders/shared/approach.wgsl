// Reward for the way to what is far, a sum with a slope everywhere; the twin of src/kernels/humanoid/approach.rs.

const QUICK = 1.5; // m/s

// `along` m/s towards it, `facing` from 0 to 1, `distance` m.
fn approach(along: f32, facing: f32, distance: f32) -> f32 {
    return 0.6 * clamp(along / QUICK, -0.3, 1.0) + 0.2 * facing + 0.2 / (1.0 + distance);
}
