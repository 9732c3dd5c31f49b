// Reward for moving in the style of recordings. One invocation a sample.
//
// output  [samples][outputs] of the discriminator, whose heads come first
// reward  [samples]

struct Params {
    samples: u32,
    outputs: u32,
    heads: u32,
    hinge: u32, // 1 for the hinge loss, 0 for binary cross-entropy
}

@group(0) @binding(0) var<storage, read> output: array<f32>;
@group(0) @binding(1) var<storage, read_write> reward: array<f32>;
@group(0) @binding(2) var<uniform> params: Params;

const LEAST = 1e-4;

@compute @workgroup_size(64)
fn style_reward(@builtin(global_invocation_id) id: vec3u) {
    let sample = id.x;
    if (sample >= params.samples) { return; }
    var sum = 0.0;
    for (var head = 0u; head < params.heads; head++) {
        let out = output[sample * params.outputs + head];
        let taken = 1.0 - 1.0 / (1.0 + exp(-out));
        sum += select(-log(max(taken, LEAST)), clamp(out, -1.0, 1.0), params.hinge == 1u);
    }
    reward[sample] = sum / f32(params.heads);
}
