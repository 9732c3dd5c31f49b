// Plays six frames from the matched candidate, moves the character, rewards and ends.
// One invocation an environment. Paper: equations 3 and 4, and the bonus on arrival; the weights
// choose among them and their readings.
//
// candidates  [candidates]      database frame of every candidate
// matched     [envs]            candidate found by the search
// motion      [candidates][5]   six frames of root motion from that frame: x, z, heading x,
//                               heading z (character frame, m), path length (m)
// real        [REALS][envs]
// whole       [WHOLES][envs]
// reward      [.. + envs]       written from `offset` on
// ended       [.. + envs]       written from `offset` on

#import layout
#import math

struct Params {
    envs: u32,
    offset: u32,
    reach: f32,
    near: f32,
    progress: f32,
    clear: f32,
    shift: f32,
    bonus: f32,
    crash: f32,
}

@group(0) @binding(0) var<storage, read> candidates: array<u32>;
@group(0) @binding(1) var<storage, read> matched: array<u32>;
@group(0) @binding(2) var<storage, read> motion: array<f32>;
@group(0) @binding(3) var<storage, read_write> real: array<f32>;
@group(0) @binding(4) var<storage, read_write> whole: array<u32>;
@group(0) @binding(5) var<storage, read_write> reward: array<f32>;
@group(0) @binding(6) var<storage, read_write> ended: array<u32>;
@group(0) @binding(7) var<uniform> params: Params;

const PLAYED = 6u;

@compute @workgroup_size(64)
fn step(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let envs = params.envs;
    if (env >= envs) { return; }
    let candidate = matched[env];
    let heading = vec2f(real[HEADING_X * envs + env], real[HEADING_Z * envs + env]);
    let moved = to_world(vec2f(motion[5u * candidate], motion[5u * candidate + 1u]), heading);
    let turned = to_world(vec2f(motion[5u * candidate + 2u], motion[5u * candidate + 3u]), heading);
    // Rounding would let the heading's length drift over thousands of steps.
    let facing = turned / sqrt(dot(turned, turned));
    let before = vec2f(real[X * envs + env], real[Z * envs + env]);
    let at = before + moved;
    real[X * envs + env] = at.x;
    real[Z * envs + env] = at.y;
    real[HEADING_X * envs + env] = facing.x;
    real[HEADING_Z * envs + env] = facing.y;
    real[TRAVELLED * envs + env] += motion[5u * candidate + 4u];
    whole[FRAME * envs + env] = candidates[candidate] + PLAYED;

    let age = whole[AGE * envs + env] + 1u;
    whole[AGE * envs + env] = age;
    let goal = vec2f(real[TARGET_X * envs + env], real[TARGET_Z * envs + env]);
    let distance = sqrt(dot(goal - at, goal - at));
    let approached = sqrt(dot(goal - before, goal - before)) - distance;
    let hits = f32(whole[HITS * envs + env]);
    var gained = params.near * exp(-distance) + params.progress * approached
        + params.clear * (exp(-hits) - params.shift);
    var end = RUNNING;
    if (whole[STRUCK * envs + env] == 1u) {
        end = COLLIDED;
        gained += params.crash;
    } else if (distance <= params.reach) {
        end = REACHED;
        gained += params.bonus;
    } else if (age >= whole[LIMIT * envs + env]) {
        end = TRUNCATED;
    }
    reward[params.offset + env] = gained;
    ended[params.offset + env] = end;
    let total = real[RETURN * envs + env] + gained;
    real[RETURN * envs + env] = total;
    if (end != RUNNING) {
        real[RETURNS * envs + env] += total;
        whole[EPISODES * envs + env] += 1u;
        whole[SUCCESSES * envs + env] += u32(end == REACHED);
        whole[COLLISIONS * envs + env] += u32(end == COLLIDED);
        whole[TRUNCATIONS * envs + env] += u32(end == TRUNCATED);
        whole[LENGTHS * envs + env] += age;
    }
}
