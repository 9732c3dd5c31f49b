// Mean contact forces over the steps of an action, and what there was of contacts. One invocation an
// environment.
//
// model_table   see `model_table`
// contacts     [max_contacts * 10][envs]
// contact_ids  [max_contacts][envs]
// counts       [2][envs]: contacts, overflow
// warm_start     see `solve_and_integrate`
// force_pairs  [1 + force_pairs * 2]: how many, and pairs of bodies
// forces       [(bodies + force_pairs) * 3][envs], N in the world's frame: on every body, and on the second of
//          each pair force_pairs by the first
// counters     [COUNTERS][envs]

#import model_table
#import contacts
#import counters

struct Params {
    envs: u32,
    max_contacts: u32,
    first: u32, // 1 in an action's first step
    weight: f32, // of a step in the mean
}

@group(0) @binding(0) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(1) var<storage, read_write> contacts: array<f32>;
@group(0) @binding(2) var<storage, read_write> contact_ids: array<u32>;
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
@group(0) @binding(4) var<storage, read_write> warm_start: array<u32>;
@group(0) @binding(5) var<storage, read_write> force_pairs: array<u32>;
@group(0) @binding(6) var<storage, read_write> forces: array<f32>;
@group(0) @binding(7) var<storage, read_write> counters: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

var<private> env: u32;

fn add(entry: u32, force: vec3f) {
    for (var k = 0u; k < 3u; k++) { forces[(3u * entry + k) * params.envs + env] += force[k]; }
}

// What a contact pushes its second body with.
fn force_of(slot: u32, friction: f32) -> vec3f {
    let e = params.envs;
    let at = (params.max_contacts + 4u * slot) * e + env;
    let edges = bitcast<vec4f>(vec4u(warm_start[at], warm_start[at + e], warm_start[at + 2u * e], warm_start[at + 3u * e]));
    let normal = contact3(CONTACT_DIM * slot + CONTACT_NORMAL);
    let tangent = contact3(CONTACT_DIM * slot + CONTACT_TANGENT);
    if (friction <= 0.0) { return normal * edges.x; }
    let sideways = tangent * (edges.x - edges.y) + cross(normal, tangent) * (edges.z - edges.w);
    return normal * (edges.x + edges.y + edges.z + edges.w) + friction * sideways;
}

@compute @workgroup_size(64)
fn contact_forces(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let bodies = model_table[BODY_COUNT];
    for (var k = 0u; k < 3u * (bodies + force_pairs[0]); k++) {
        let at = k * params.envs + env;
        forces[at] = select(forces[at], 0.0, params.first == 1u);
    }
    let count = counts[env];
    for (var slot = 0u; slot < count; slot++) {
        let pair = model_table[PAIRS_AT] + contact_ids[slot * params.envs + env] / 8u * PAIR;
        let force = params.weight * force_of(slot, real(pair + PAIR_FRICTION));
        let first = model_table[pair + PAIR_BODIES];
        let second = model_table[pair + PAIR_BODIES + 1u];
        if (second != NONE) { add(second, force); }
        if (first != NONE) { add(first, -force); }
        for (var k = 0u; k < force_pairs[0]; k++) {
            let a = force_pairs[1u + 2u * k];
            let b = force_pairs[2u + 2u * k];
            if (a == first && b == second) { add(bodies + k, force); }
            if (a == second && b == first) { add(bodies + k, -force); }
        }
    }
    counters[CONTACTS * params.envs + env] += count;
    let most = PEAK_CONTACTS * params.envs + env;
    counters[most] = max(counters[most], count);
    counters[OVERFLOW * params.envs + env] += counts[params.envs + env];
}
