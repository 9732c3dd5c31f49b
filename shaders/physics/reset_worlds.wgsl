// Starts worlds anew: those that are asked to, and, counted, those with a number that is none or a speed
// that no body has. One invocation an environment.
//
// model_table   see `model_table`
// mask      [envs]: not 0 where to start anew
// starts    [positions + dofs][envs]: where to
// state     [positions + dofs][envs]
// warm_start     see `solve_and_integrate`
// force_pairs  see `contact_forces`
// forces   see `contact_forces`: none where a world starts anew
// counters  [COUNTERS][envs]

#import model_table
#import counters

struct Params {
    envs: u32,
    max_contacts: u32,
    max_speed: f32, // m/s and rad/s
}

@group(0) @binding(0) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(1) var<storage, read_write> mask: array<u32>;
@group(0) @binding(2) var<storage, read_write> starts: array<f32>;
@group(0) @binding(3) var<storage, read_write> state: array<f32>;
@group(0) @binding(4) var<storage, read_write> warm_start: array<u32>;
@group(0) @binding(5) var<storage, read_write> force_pairs: array<u32>;
@group(0) @binding(6) var<storage, read_write> forces: array<f32>;
@group(0) @binding(7) var<storage, read_write> counters: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

// Compilers may assume that there is no NaN; bits they must take as they are.
fn number(value: f32) -> bool { return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u; }

@compute @workgroup_size(64)
fn reset_worlds(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    let positions = model_table[NQ];
    let values = positions + model_table[DOF_COUNT];
    var diverged = false;
    for (var k = 0u; k < values; k++) {
        let value = state[k * params.envs + env];
        diverged = diverged || !number(value) || (k >= positions && abs(value) > params.max_speed);
    }
    if (diverged) { counters[DIVERGED * params.envs + env] += 1u; }
    if (!diverged && mask[env] == 0u) { return; }
    for (var k = 0u; k < values; k++) { state[k * params.envs + env] = starts[k * params.envs + env]; }
    for (var k = 0u; k < 5u * params.max_contacts + model_table[JOINT_COUNT]; k++) {
        warm_start[k * params.envs + env] = select(0u, NONE, k < params.max_contacts);
    }
    for (var k = 0u; k < 3u * (model_table[BODY_COUNT] + force_pairs[0]); k++) { forces[k * params.envs + env] = 0.0; }
}
