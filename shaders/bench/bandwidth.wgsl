// Copies numbers, to see how fast memory can be read and written.
//
// source, copy  [count] of vec4

struct Params {
    count: u32,
    // Invocations along x.
    across: u32,
}

@group(0) @binding(0) var<storage, read> source: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> copy: array<vec4f>;
@group(0) @binding(2) var<uniform> params: Params;

@compute @workgroup_size(64)
fn bandwidth(@builtin(global_invocation_id) id: vec3u) {
    let at = id.y * params.across + id.x;
    if (at < params.count) { copy[at] = source[at]; }
}
