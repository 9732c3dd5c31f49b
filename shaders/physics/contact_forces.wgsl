// Mean contact forces over the steps of an action, and what there was of contacts. One invocation an
// environment.
//
// tables   see `tables`
// touches  [slots * 10][envs]
// keys     [slots][envs]
// counts   [2][envs]: contacts, overflow
// warm     see `solve`
// watched  [1 + watched * 2]: how many, and pairs of bodies
// forces   [(bodies + watched) * 3][envs], N in the world's frame: on every body, and on the second of
//          each pair watched by the first
// tallies  [TALLIES][envs]

#import tables
#import touches
#import tallies

struct Params {
    envs: u32,
    slots: u32,
    first: u32, // 1 in an action's first step
    share: f32, // of a step in the mean
}

@group(0) @binding(0) var<storage, read_write> tables: array<u32>;
@group(0) @binding(1) var<storage, read_write> touches: array<f32>;
@group(0) @binding(2) var<storage, read_write> keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
@group(0) @binding(4) var<storage, read_write> warm: array<u32>;
@group(0) @binding(5) var<storage, read_write> watched: array<u32>;
@group(0) @binding(6) var<storage, read_write> forces: array<f32>;
@group(0) @binding(7) var<storage, read_write> tallies: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

var<private> env: u32;

fn add(entry: u32, force: vec3f) {
    for (var k = 0u; k < 3u; k++) { forces[(3u * entry + k) * params.envs + env] += force[k]; }
}

// What a contact pushes its second body with.
fn force_of(slot: u32, friction: f32) -> vec3f {
    let e = params.envs;
    let at = (params.slots + 4u * slot) * e + env;
    let edges = bitcast<vec4f>(vec4u(warm[at], warm[at + e], warm[at + 2u * e], warm[at + 3u * e]));
    let normal = touch3(TOUCH * slot + TOUCH_NORMAL);
    let tangent = touch3(TOUCH * slot + TOUCH_TANGENT);
    if (friction <= 0.0) { return normal * edges.x; }
    let sideways = tangent * (edges.x - edges.y) + cross(normal, tangent) * (edges.z - edges.w);
    return normal * (edges.x + edges.y + edges.z + edges.w) + friction * sideways;
}

@compute @workgroup_size(64)
fn contact_forces(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let bodies = tables[BODY_COUNT];
    for (var k = 0u; k < 3u * (bodies + watched[0]); k++) {
        let at = k * params.envs + env;
        forces[at] = select(forces[at], 0.0, params.first == 1u);
    }
    let count = counts[env];
    for (var slot = 0u; slot < count; slot++) {
        let pair = tables[PAIRS_AT] + keys[slot * params.envs + env] / 8u * PAIR;
        let force = params.share * force_of(slot, real(pair + PAIR_FRICTION));
        let first = tables[pair + PAIR_BODIES];
        let second = tables[pair + PAIR_BODIES + 1u];
        if (second != NONE) { add(second, force); }
        if (first != NONE) { add(first, -force); }
        for (var k = 0u; k < watched[0]; k++) {
            let a = watched[1u + 2u * k];
            let b = watched[2u + 2u * k];
            if (a == first && b == second) { add(bodies + k, force); }
            if (a == second && b == first) { add(bodies + k, -force); }
        }
    }
    tallies[CONTACTS * params.envs + env] += count;
    let most = MOST_CONTACTS * params.envs + env;
    tallies[most] = max(tallies[most], count);
    tallies[OVERFLOW * params.envs + env] += counts[params.envs + env];
}
