// Whether a character has fallen, the twin of src/kernels/humanoid/fallen.rs. The importing shader binds `poses`,
// has its environment in `env` and bounds loops by `bound`; its parameters are those of a character whose bodies are
// counted from `first`.

fn height(body: u32) -> f32 { return poses[(7u * body + 2u) * params.envs + env]; }

fn has_fallen(first: u32) -> bool {
    var low = height(first + params.head) < params.min_head || height(first + params.pelvis) < params.min_pelvis;
    for (var body = 0u; body < bound(params.bodies); body++) {
        let foot = body == params.right_foot || body == params.left_foot;
        low = low || (!foot && height(first + body) < params.min_body);
    }
    return low;
}
