// Draws where ended episodes begin anew, for each agent by itself. One invocation an environment.
//
// Bounds of loops depend on a buffer, too: see `end_episode`.
//
// mask          [envs]: not 0 where to draw
// start_states  [count][positions + velocities]: to draw from
// starts        [agents * (positions + velocities)][envs]: those drawn, the positions of all agents and then
//               their velocities; the others stay

#import rng
#import start_draw

struct Params {
    envs: u32,
    agents: u32,
    first: u32,
    seed: u32,
    reset_counter: u32,
    count: u32,
    positions: u32, // of a start state
    velocities: u32,
}

@group(0) @binding(0) var<storage, read_write> mask: array<u32>;
@group(0) @binding(1) var<storage, read_write> start_states: array<f32>;
@group(0) @binding(2) var<storage, read_write> starts: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

@compute @workgroup_size(64)
fn draw_starts(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    let width = params.positions + params.velocities;
    for (var agent = 0u; agent < select(0u, params.agents, mask[env] != 0u); agent++) {
        let key = (params.first + env) * params.agents + agent;
        let start = width * start_of(params.seed, key, params.reset_counter, params.count);
        for (var k = 0u; k < width; k++) {
            let velocity = params.agents * params.positions + agent * params.velocities + k - params.positions;
            let field = select(velocity, agent * params.positions + k, k < params.positions);
            starts[field * params.envs + env] = start_states[start + k];
        }
    }
}
