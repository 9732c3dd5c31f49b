// The encoder's loss of every row and its gradient: how far the direction that it finds is from the latent
// under which an agent moved. One invocation a row.
//
// dims          [3]            numbers of a window; parameters; outputs
// samples       [..][width]    a window, its label, then the latent [outputs - heads], zero where there is none
// outputs       [rows][outputs]   of the discriminator, whose heads come first
// output_grads  [rows][outputs]   of those behind the heads
// extras        [rows][SUMS]   the last: cosine between the direction and the latent

struct Params {
    rows: u32,
    // The first sample.
    start: u32,
    // Numbers of a sample.
    width: u32,
    heads: u32,
    // Weight of a row.
    weight: f32,
}

@group(0) @binding(0) var<storage, read> dims: array<u32>;
@group(0) @binding(1) var<storage, read> samples: array<f32>;
@group(0) @binding(2) var<storage, read> outputs: array<f32>;
@group(0) @binding(3) var<storage, read_write> output_grads: array<f32>;
@group(0) @binding(4) var<storage, read_write> extras: array<f32>;
@group(0) @binding(5) var<uniform> params: Params;

const SUMS = 6u;
// Least length of an output that has a direction.
const LEAST = 1e-6;

@compute @workgroup_size(64)
fn encoder_loss(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows) { return; }
    let dim = dims[2] - params.heads;
    let out = row * dims[2] + params.heads;
    let latent = (params.start + row) * params.width + dims[0] + 1u;
    var square = 0.0;
    var product = 0.0;
    for (var i = 0u; i < dim; i++) {
        square += outputs[out + i] * outputs[out + i];
        product += outputs[out + i] * samples[latent + i];
    }
    let inv_length = 1.0 / max(sqrt(square), LEAST);
    let cosine = product * inv_length;
    for (var i = 0u; i < dim; i++) {
        let away = samples[latent + i] - cosine * outputs[out + i] * inv_length;
        output_grads[out + i] = -params.weight * away * inv_length;
    }
    extras[row * SUMS + 5u] = cosine;
}
