// Reward, measures and end of a step of the tasks `punch` and `joystick`. One invocation an environment.
//
// poses       [bodies * 7][envs], after the step; the target is the last body
// dynamics    see `smooth_dynamics`: the velocities of the same state, from `velocities_at` on
// forces      [(bodies + characters' bodies) * 3][envs]: on bodies, then of each body of the character on the
//             target, N
// task_state  [PUNCH_STATE][envs]
// reward      [envs], from `at` on
// measures    [4][envs]: 1 in the step of a hit; of a hit by a fist; far from the target; the angle there
//             between facing and wanted facing, rad
// task_end    [envs]
// kind        [envs], from `at` on: 0 the target is far, 1 near, 2 it has been hit
//
// Equations are those of the paper, with `far` 0 as printed, 1 with a slower distance, 2 as a sum, 3 as a
// sum for a velocity.

#import termination
#import spatial
#import punch
#import approach

struct Params {
    envs: u32,
    at: u32,
    velocities_at: u32,
    bodies: u32,          // of a world
    own_bodies: u32,      // of the character
    right_hand: u32,
    left_hand: u32,
    joystick: u32,        // 1: facing and moving as the state says, else to the target
    far: u32,
    facing: u32,          // 1 if facing is rewarded
    fist_only: u32,       // 1 if only a fist hits
    steps_after: u32,     // that the episode goes on after a hit
    speed: f32,           // wanted, m/s
    near: f32,            // m; nearer than this is near
    far_weight: f32,      // of the reward for a target that is farther
    hand_speed: f32,      // m/s toward the target, at which a hand's reward is largest
    fist_speed: f32,      // m/s; a slower fist is none
}

@group(0) @binding(0) var<storage, read_write> poses: array<f32>;
@group(0) @binding(1) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(2) var<storage, read_write> forces: array<f32>;
@group(0) @binding(3) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(4) var<storage, read_write> reward: array<f32>;
@group(0) @binding(5) var<storage, read_write> measures: array<f32>;
@group(0) @binding(6) var<storage, read_write> task_end: array<u32>;
@group(0) @binding(7) var<storage, read_write> kind: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

const PI = 3.14159265;
const TOPPLED = 0.2; // of the target's up axis along the world's

var<private> env: u32;

fn pose(at: u32) -> f32 { return poses[at * params.envs + env]; }
fn position_of(body: u32) -> vec3f { return vec3f(pose(7u * body), pose(7u * body + 1u), pose(7u * body + 2u)); }
fn rotation_of(body: u32) -> vec4f {
    return vec4f(pose(7u * body + 3u), pose(7u * body + 4u), pose(7u * body + 5u), pose(7u * body + 6u));
}
fn carried(field: u32) -> f32 { return task_state[field * params.envs + env]; }
fn carry(field: u32, value: f32) { task_state[field * params.envs + env] = value; }

fn velocity3(at: u32) -> vec3f {
    let first = (params.velocities_at + at) * params.envs + env;
    return vec3f(dynamics[first], dynamics[first + params.envs], dynamics[first + 2u * params.envs]);
}

// Of a body's own origin; the tree's is where its root is.
fn velocity_of(body: u32) -> vec3f {
    return velocity3(6u * body + 3u) + cross(velocity3(6u * body), position_of(body) - position_of(0u));
}

// Equations 2 to 4 for one hand.
fn near_reward(hand: u32, toward: vec2f, target_position: vec3f) -> f32 {
    let apart = target_position - position_of(hand);
    let speed = dot(toward, velocity_of(hand).xy) / params.hand_speed;
    return 0.2 * exp(-4.0 * dot(apart, apart)) + 0.8 * clamp(speed, 0.0, 1.0);
}

// Equations 5 to 10, or a sum with a slope everywhere: of the speed toward the target, or of the difference
// from the wanted velocity.
fn far_reward(distance: f32, way: vec2f, velocity: vec2f, alignment: f32) -> f32 {
    let along = dot(way, velocity);
    if (params.far == 2u) {
        let facing = select(1.0, 0.5 * (1.0 + alignment), params.facing == 1u);
        return approach(along, facing, distance);
    }
    if (params.far == 3u) {
        let off = length(velocity - params.speed * way) / params.speed;
        let turned = acos(clamp(alignment, -1.0, 1.0)) / PI;
        let facing = select(1.0, 1.0 - turned, params.facing == 1u);
        let speed = max(1.0 - off, -0.3);
        return 0.75 * speed * facing * facing + 0.2 * facing + 0.05 / (1.0 + distance);
    }
    let across = velocity - along * way;
    let short = params.speed - along;
    let velocity_factor = exp(-4.0 * (dot(across, across) + short * short));
    let facing_factor = select(1.0, exp(-5.0 * abs(alignment - 1.0)), params.facing == 1u);
    let distance_factor = select(exp(-distance * distance), 1.0 / (1.0 + distance), params.far == 1u);
    return distance_factor * velocity_factor * facing_factor;
}

// 1 + the first body that touches the target, or 0.
fn toucher() -> u32 {
    var first = 0u;
    for (var back = 0u; back < select(0u, params.own_bodies, task_end[env] <= FAILED); back++) {
        let body = params.own_bodies - 1u - back;
        let at = 3u * (params.bodies + body) * params.envs + env;
        let force = vec3f(forces[at], forces[at + params.envs], forces[at + 2u * params.envs]);
        // A hand goes before what it drags along.
        let hand = first == params.right_hand + 1u || first == params.left_hand + 1u;
        if (dot(force, force) > 0.0 && !hand) { first = body + 1u; }
    }
    return first;
}

@compute @workgroup_size(64)
fn punch_reward(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let e = params.envs;
    let box_body = params.bodies - 1u;
    let target_position = position_of(box_body);
    let box_rotation = rotation_of(box_body);
    let up = rotate(box_rotation, vec3f(0.0, 0.0, 1.0)).z;
    let gap = target_position.xy - position_of(0u).xy;
    let distance = length(gap);
    let toward = unit2(gap);
    let moving = vec2f(carried(MOVING), carried(MOVING + 1u));
    let way = select(toward, moving, params.joystick == 1u);
    let wanted = select(toward, vec2f(carried(FACING), carried(FACING + 1u)), params.joystick == 1u);
    let alignment = dot(heading_of(rotation_of(0u)), wanted);

    if (carried(FIRST) == 0.0) {
        let first = toucher();
        if (first > 0u) {
            carry(FIRST, f32(first));
            carry(FIRST_SPEED, carried(HAND_SPEED));
        }
    }
    let speeds = vec2f(length(velocity_of(params.right_hand)), length(velocity_of(params.left_hand)));
    carry(HAND_SPEED, max(speeds.x, speeds.y));
    let first_body = u32(carried(FIRST));
    let by_hand = first_body == params.right_hand + 1u || first_body == params.left_hand + 1u;
    let by_fist = by_hand && carried(FIRST_SPEED) >= params.fist_speed;
    let before = carried(HIT_STEPS);
    let toppled = up < TOPPLED && (by_fist || params.fist_only == 0u);
    let hit = before > 0.0 || toppled;
    if (hit) { carry(HIT_STEPS, before + 1.0); }

    let near = distance < params.near;
    let hands = max(near_reward(params.right_hand, toward, target_position),
        near_reward(params.left_hand, toward, target_position));
    let far = far_reward(distance, way, velocity3(3u).xy, alignment);
    reward[params.at + env] = select(select(params.far_weight * far, 0.3 + 0.3 * hands, near), 1.4, hit);
    kind[params.at + env] = select(select(0u, 1u, near), 2u, hit);
    let counts = !hit && !near;
    measures[env] = select(0.0, 1.0, toppled && before == 0.0);
    measures[e + env] = select(0.0, 1.0, toppled && before == 0.0 && by_fist);
    measures[2u * e + env] = select(0.0, 1.0, counts);
    measures[3u * e + env] = select(0.0, acos(clamp(alignment, -1.0, 1.0)), counts);
    task_end[env] = select(RUNNING, SUCCESS, before + 1.0 > f32(params.steps_after) && hit);
}
