// Starts worlds anew: those that are asked to, and, counted, those with a number that is none or a speed
// that no body has. One invocation an environment.
//
// tables   see `tables`
// mask     [envs]: not 0 where to start anew
// starts   [positions + dofs][envs]: where to
// state    [positions + dofs][envs]
// warm     see `solve`
// watched  see `blows`
// forces   see `blows`: none where a world starts anew
// tallies  [TALLIES][envs]

#import tables
#import tallies

struct Params {
    envs: u32,
    fastest: f32, // m/s and rad/s
}

@group(0) @binding(0) var<storage, read_write> tables: array<u32>;
@group(0) @binding(1) var<storage, read_write> mask: array<u32>;
@group(0) @binding(2) var<storage, read_write> starts: array<f32>;
@group(0) @binding(3) var<storage, read_write> state: array<f32>;
@group(0) @binding(4) var<storage, read_write> warm: array<u32>;
@group(0) @binding(5) var<storage, read_write> watched: array<u32>;
@group(0) @binding(6) var<storage, read_write> forces: array<f32>;
@group(0) @binding(7) var<storage, read_write> tallies: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

// Compilers may assume that there is no NaN; bits they must take as they are.
fn number(value: f32) -> bool { return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u; }

@compute @workgroup_size(64)
fn reset_worlds(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    let positions = tables[POSITIONS];
    let values = positions + tables[DOF_COUNT];
    var broken = false;
    for (var k = 0u; k < values; k++) {
        let value = state[k * params.envs + env];
        broken = broken || !number(value) || (k >= positions && abs(value) > params.fastest);
    }
    if (broken) { tallies[BROKEN * params.envs + env] += 1u; }
    if (!broken && mask[env] == 0u) { return; }
    for (var k = 0u; k < values; k++) { state[k * params.envs + env] = starts[k * params.envs + env]; }
    for (var k = 0u; k < 5u * tables[SLOTS] + tables[JOINT_COUNT]; k++) {
        warm[k * params.envs + env] = select(0u, NONE, k < tables[SLOTS]);
    }
    for (var k = 0u; k < 3u * (tables[BODY_COUNT] + watched[0]); k++) { forces[k * params.envs + env] = 0.0; }
}
