// Latents of agents are kept for their time; those whose time is over, or whose episode is, are drawn anew. What
// an ended episode observed last gets the latent of its time. One invocation a row.
//
// dims               [3]                  numbers of a latent; of the inner observation; centres: with 0 a latent has
//                                         any direction
// termination        [steps][rows]
// centres            [centres][1 + latent]   share of this centre and all before it, then the centre
// inner_final        [final_steps][rows][inner]
// final_observation  [final_steps][rows][inner + latent]
// latents            [rows][latent]
// steps_left         [rows]               steps for which a latent is still kept

#import rng
#import termination

struct Params {
    rows: u32,
    first: u32,          // number of the first row in the whole batch
    seed: u32,
    step_counter: u32,
    at: u32,             // index of the step's first termination
    final_row: u32,      // rows of the final observations before this step's
    least: u32,          // steps for which a latent is kept
    most: u32,
    opening: u32,        // 1 to draw all
    spread: f32,         // of latents about their centres, in each direction
}

@group(0) @binding(0) var<storage, read> dims: array<u32>;
@group(0) @binding(1) var<storage, read> termination: array<u32>;
@group(0) @binding(2) var<storage, read> centres: array<f32>;
@group(0) @binding(3) var<storage, read> inner_final: array<f32>;
@group(0) @binding(4) var<storage, read_write> final_observation: array<f32>;
@group(0) @binding(5) var<storage, read_write> latents: array<f32>;
@group(0) @binding(6) var<storage, read_write> steps_left: array<u32>;
@group(0) @binding(7) var<uniform> params: Params;

const STREAM = 0x4c415445u;

@compute @workgroup_size(64)
fn advance_latents(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows) { return; }
    let dim = dims[0];
    let inner = dims[1];
    let ended = params.opening == 0u && termination[params.at + row] != RUNNING;
    if (ended) {
        let last = params.final_row + row;
        for (var i = 0u; i < inner; i++) {
            final_observation[last * (inner + dim) + i] = inner_final[last * inner + i];
        }
        for (var i = 0u; i < dim; i++) {
            final_observation[last * (inner + dim) + inner + i] = latents[row * dim + i];
        }
    }
    if (params.opening == 0u && !ended && steps_left[row] > 1u) {
        steps_left[row] -= 1u;
        return;
    }
    let key = params.first + row;
    let bits = random4(params.seed, key, params.step_counter, STREAM);
    steps_left[row] = params.least + index_below(bits.x, params.most - params.least + 1u);
    // The centre whose share the lot falls into.
    let lot = uniform01(bits.y);
    var centre = 0u;
    for (var i = 0u; i + 1u < dims[2]; i++) {
        if (centres[i * (1u + dim)] <= lot) { centre = i + 1u; }
    }
    var square = 0.0;
    for (var i = 0u; i < dim; i++) {
        let noise = gaussian(random4(params.seed, key, params.step_counter, STREAM + 1u + i));
        var value = noise;
        if (dims[2] > 0u) { value = centres[centre * (1u + dim) + 1u + i] + params.spread * noise; }
        latents[row * dim + i] = value;
        square += value * value;
    }
    let scale = 1.0 / max(sqrt(square), 1e-6);
    for (var i = 0u; i < dim; i++) { latents[row * dim + i] *= scale; }
}
