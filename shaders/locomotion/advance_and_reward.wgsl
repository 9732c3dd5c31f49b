// Plays six frames from the matched candidate, moves the character, rewards and ends.
// One invocation an environment. Paper: equations 3 and 4, and the bonus on arrival; the weights
// choose among them and their readings.
//
// candidates   [candidates]      database frame of every candidate
// matched      [envs]            candidate found by the search
// motion       [candidates][5]   six frames of root motion from that frame: x, z, heading x,
//                               heading z (character frame, m), path length (m)
// state_f32    [STATE_F32_FIELDS][envs]
// state_u32    [STATE_U32_FIELDS][envs]
// reward       [.. + envs]       written from `offset` on
// termination  [.. + envs]       written from `offset` on

#import locomotion_layout
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
@group(0) @binding(3) var<storage, read_write> state_f32: array<f32>;
@group(0) @binding(4) var<storage, read_write> state_u32: array<u32>;
@group(0) @binding(5) var<storage, read_write> reward: array<f32>;
@group(0) @binding(6) var<storage, read_write> termination: array<u32>;
@group(0) @binding(7) var<uniform> params: Params;

const FRAMES_PER_STEP = 6u;

@compute @workgroup_size(64)
fn advance_and_reward(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let envs = params.envs;
    if (env >= envs) { return; }
    let candidate = matched[env];
    let heading = vec2f(state_f32[HEADING_X * envs + env], state_f32[HEADING_Z * envs + env]);
    let moved = to_world(vec2f(motion[5u * candidate], motion[5u * candidate + 1u]), heading);
    let turned = to_world(vec2f(motion[5u * candidate + 2u], motion[5u * candidate + 3u]), heading);
    // Rounding would let the heading's length drift over thousands of steps.
    let facing = turned / sqrt(dot(turned, turned));
    let before = vec2f(state_f32[X * envs + env], state_f32[Z * envs + env]);
    let at = before + moved;
    state_f32[X * envs + env] = at.x;
    state_f32[Z * envs + env] = at.y;
    state_f32[HEADING_X * envs + env] = facing.x;
    state_f32[HEADING_Z * envs + env] = facing.y;
    state_f32[TRAVELLED * envs + env] += motion[5u * candidate + 4u];
    state_u32[FRAME * envs + env] = candidates[candidate] + FRAMES_PER_STEP;

    let age = state_u32[EPISODE_STEP * envs + env] + 1u;
    state_u32[EPISODE_STEP * envs + env] = age;
    let goal = vec2f(state_f32[TARGET_X * envs + env], state_f32[TARGET_Z * envs + env]);
    let distance = sqrt(dot(goal - at, goal - at));
    let approached = sqrt(dot(goal - before, goal - before)) - distance;
    let hits = f32(state_u32[HITS * envs + env]);
    var gained = params.near * exp(-distance) + params.progress * approached
        + params.clear * (exp(-hits) - params.shift);
    var end = RUNNING;
    if (state_u32[HAS_COLLIDED * envs + env] == 1u) {
        end = FAILED;
        gained += params.crash;
    } else if (distance <= params.reach) {
        end = SUCCESS;
        gained += params.bonus;
    } else if (age >= state_u32[EPISODE_LIMIT * envs + env]) {
        end = TRUNCATED;
    }
    reward[params.offset + env] = gained;
    termination[params.offset + env] = end;
    let total = state_f32[RETURN * envs + env] + gained;
    state_f32[RETURN * envs + env] = total;
    if (end != RUNNING) {
        state_f32[RETURNS * envs + env] += total;
        state_u32[EPISODES * envs + env] += 1u;
        state_u32[SUCCESSES * envs + env] += u32(end == SUCCESS);
        state_u32[COLLISIONS * envs + env] += u32(end == FAILED);
        state_u32[TRUNCATIONS * envs + env] += u32(end == TRUNCATED);
        state_u32[LENGTHS * envs + env] += age;
    }
}
