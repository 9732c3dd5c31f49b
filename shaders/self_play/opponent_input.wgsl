// What opponents observe, row by row as policies are evaluated, normalised by their own moments. One invocation a
// number of a row; the rows of nobody are left as they are.
//
// slots        [slots]            the environment of a row, or NOBODY
// blocks       [slots / block]    the policy of a block of rows
// own          [envs]             the learner's row of an environment
// observation  [2 envs][observation]
// scale        [policies][2][observation]   means, inverse standard deviations
// input        [slots][observation]

#import bout_rows

struct Params {
    slots: u32,
    observation: u32,
    block: u32,  // rows of a block
    clip: f32,   // largest magnitude of a normalised number
}

@group(0) @binding(0) var<storage, read> slots: array<u32>;
@group(0) @binding(1) var<storage, read> blocks: array<u32>;
@group(0) @binding(2) var<storage, read> own: array<u32>;
@group(0) @binding(3) var<storage, read> observation: array<f32>;
@group(0) @binding(4) var<storage, read> scale: array<f32>;
@group(0) @binding(5) var<storage, read_write> input: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

@compute @workgroup_size(4, 64)
fn opponent_input(@builtin(global_invocation_id) id: vec3u) {
    let column = id.x;
    let slot = id.y;
    if (column >= params.observation || slot >= params.slots || slots[slot] == NOBODY) { return; }
    let row = own[slots[slot]] ^ 1u;
    let means = blocks[slot / params.block] * 2u * params.observation + column;
    let away = observation[row * params.observation + column] - scale[means];
    let number = away * scale[means + params.observation];
    input[slot * params.observation + column] = clamp(number, -params.clip, params.clip);
}
