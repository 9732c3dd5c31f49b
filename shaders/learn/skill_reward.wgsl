// Reward for moving so that the encoder finds the latent again. One invocation a sample.
//
// output   [samples][outputs] of the discriminator, whose heads come first
// latents  [samples][outputs - heads]
// reward   [samples]

struct Params {
    samples: u32,
    outputs: u32,
    heads: u32,
}

@group(0) @binding(0) var<storage, read> output: array<f32>;
@group(0) @binding(1) var<storage, read> latents: array<f32>;
@group(0) @binding(2) var<storage, read_write> reward: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

// Least length of an output that has a direction.
const LEAST = 1e-6;

@compute @workgroup_size(64)
fn skill_reward(@builtin(global_invocation_id) id: vec3u) {
    let sample = id.x;
    if (sample >= params.samples) { return; }
    let dim = params.outputs - params.heads;
    var square = 0.0;
    var product = 0.0;
    for (var i = 0u; i < dim; i++) {
        let found = output[sample * params.outputs + params.heads + i];
        square += found * found;
        product += found * latents[sample * dim + i];
    }
    reward[sample] = 0.5 + 0.5 * product / max(sqrt(square), LEAST);
}
