// Normalises the advantages of a rollout in place, those of each group apart, and weighs them. One invocation a
// sample of a stream.
//
// kind                  [samples]   groups
// scale                 [streams][12]   see rollout_moments
// advantage_and_return  [2][samples][streams]

struct Params {
    samples: u32,
    streams: u32,
}

@group(0) @binding(0) var<storage, read> kind: array<u32>;
@group(0) @binding(1) var<storage, read> scale: array<f32>;
@group(0) @binding(2) var<storage, read_write> advantage_and_return: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const FIELDS = 12u;
const MIN_STD = 1e-6;

@compute @workgroup_size(64)
fn normalize_advantages(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
) {
    let at = id.x + id.y * groups.x * 64u;
    if (at >= params.samples * params.streams) { return; }
    let fields = FIELDS * (at % params.streams);
    let own = kind[at / params.streams];
    let centered = advantage_and_return[at] - scale[fields + 6u + own];
    advantage_and_return[at] = scale[fields + 5u] * centered / (scale[fields + 9u + own] + MIN_STD);
}
