// The discriminator's loss of every row and its gradient. One invocation a row.
//
// dims          [3]            numbers of a window; parameters; outputs
// samples       [..][width]    a window, then 1 if it was recorded, 0 if it is an agent's
// outputs       [rows][outputs]   the heads come first
// output_grads  [rows][outputs]   of the heads
// extras        [rows][SUMS]   loss; recorded, recorded and taken for it; an agent's, and taken for it; 0

struct Params {
    rows: u32,
    // The first sample.
    start: u32,
    // Numbers of a sample.
    width: u32,
    // 1 for the hinge loss, 0 for binary cross-entropy.
    hinge: u32,
    heads: u32,
    // 1 / rows of the mean.
    inv_count: f32,
}

@group(0) @binding(0) var<storage, read> dims: array<u32>;
@group(0) @binding(1) var<storage, read> samples: array<f32>;
@group(0) @binding(2) var<storage, read> outputs: array<f32>;
@group(0) @binding(3) var<storage, read_write> output_grads: array<f32>;
@group(0) @binding(4) var<storage, read_write> extras: array<f32>;
@group(0) @binding(5) var<uniform> params: Params;

const SUMS = 6u;

// The logarithm of 1 + exp(x), of large x as well.
fn softplus(x: f32) -> f32 { return max(x, 0.0) + log(1.0 + exp(-abs(x))); }

@compute @workgroup_size(64)
fn discriminator_loss(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows) { return; }
    let heads = params.heads;
    let recorded = samples[(params.start + row) * params.width + dims[0]] > 0.5;
    let sign = select(1.0, -1.0, recorded);
    let weight = params.inv_count / f32(heads);
    var loss = 0.0;
    var sum = 0.0;
    for (var head = 0u; head < heads; head++) {
        let at = row * dims[2] + head;
        let out = outputs[at];
        let wrong = sign * out;
        let hinge = max(1.0 + wrong, 0.0);
        let slope = select(1.0 / (1.0 + exp(-wrong)), select(0.0, 1.0, hinge > 0.0), params.hinge == 1u);
        loss += select(softplus(wrong), hinge, params.hinge == 1u);
        output_grads[at] = sign * slope * weight;
        sum += out;
    }
    let extra = row * SUMS;
    let right = select(0.0, 1.0, sign * sum < 0.0);
    extras[extra] = loss / f32(heads);
    extras[extra + 1u] = select(0.0, 1.0, recorded);
    extras[extra + 2u] = select(0.0, right, recorded);
    extras[extra + 3u] = select(1.0, 0.0, recorded);
    extras[extra + 4u] = select(right, 0.0, recorded);
    extras[extra + 5u] = 0.0;
}
