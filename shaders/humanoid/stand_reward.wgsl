// Reward and end of a step of the task `stand`. One invocation an environment.
//
// state        [nq + nv][envs], after the step
// poses        [bodies * 7][envs], of that state
// episode      [FIELDS][envs]: the running episode, then sums over those that have ended
// reward       [envs], from `at` on
// termination  [envs], from `at` on
// ended        [envs]: the same, of this step alone

#import termination

struct Params {
    envs: u32,
    at: u32,
    nq: u32,
    nv: u32,
    bodies: u32,
    head: u32,
    pelvis: u32,
    torso: u32,
    right_foot: u32,
    left_foot: u32,
    max_steps: u32,      // of an episode
    min_head: f32,       // m; below them it has fallen
    min_pelvis: f32,
    min_body: f32,       // of all but the feet
    max_speed: f32,      // m/s and rad/s; what is faster has diverged
    alive_reward: f32,
    upright_reward: f32,
    stillness_reward: f32,
}

@group(0) @binding(0) var<storage, read_write> state: array<f32>;
@group(0) @binding(1) var<storage, read_write> poses: array<f32>;
@group(0) @binding(2) var<storage, read_write> episode: array<f32>;
@group(0) @binding(3) var<storage, read_write> reward: array<f32>;
@group(0) @binding(4) var<storage, read_write> termination: array<u32>;
@group(0) @binding(5) var<storage, read_write> ended: array<u32>;
@group(0) @binding(6) var<uniform> params: Params;

// The running episode.
const STEP = 0u;
const LIMIT = 1u;   // steps after which it is truncated
const RETURN = 2u;
const UPRIGHT = 3u; // sum of the uprightness
// Sums over those that have ended.
const SUMS = 4u;
const EPISODES = 4u;
const SUCCESSES = 5u;
const STEPS = 6u;
const RETURNS = 7u;
const FALLS = 8u;
const UPRIGHTNESS = 9u;
const FIELDS = 10u;

var<private> env: u32;

fn height(body: u32) -> f32 { return poses[(7u * body + 2u) * params.envs + env]; }

// How far the torso's up axis points up: 1 upright, -1 upside down.
fn uprightness() -> f32 {
    let at = (7u * params.torso + 3u) * params.envs + env;
    let x = poses[at];
    let y = poses[at + params.envs];
    return 1.0 - 2.0 * (x * x + y * y);
}

// How little the joints move: 1 for those that stand still, falling with their mean square speed.
fn stillness() -> f32 {
    var sum = 0.0;
    for (var dof = 6u; dof < params.nv; dof++) {
        let speed = state[(params.nq + dof) * params.envs + env];
        sum += speed * speed;
    }
    return exp(-0.1 * sum / f32(params.nv - 6u));
}

fn has_fallen() -> bool {
    var low = height(params.head) < params.min_head || height(params.pelvis) < params.min_pelvis;
    for (var body = 0u; body < params.bodies; body++) {
        let foot = body == params.right_foot || body == params.left_foot;
        low = low || (!foot && height(body) < params.min_body);
    }
    return low;
}

// Compilers may assume that there is no NaN; bits they must take as they are.
fn number(value: f32) -> bool { return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u; }

fn has_diverged() -> bool {
    var diverged = false;
    for (var k = 0u; k < params.nq + params.nv; k++) {
        let value = state[k * params.envs + env];
        diverged = diverged || !number(value) || (k >= params.nq && abs(value) > params.max_speed);
    }
    return diverged;
}

fn assign(field: u32, value: f32) { episode[field * params.envs + env] = value; }
fn add(field: u32, value: f32) { episode[field * params.envs + env] += value; }
fn field(at: u32) -> f32 { return episode[at * params.envs + env]; }

// Adds the episode to the sums and begins the next.
fn finish(end: u32) {
    add(EPISODES, 1.0);
    add(SUCCESSES, select(0.0, 1.0, end == TRUNCATED));
    add(FALLS, select(0.0, 1.0, end == FAILED));
    add(STEPS, field(STEP));
    add(RETURNS, field(RETURN));
    add(UPRIGHTNESS, field(UPRIGHT));
    assign(STEP, 0.0);
    assign(LIMIT, f32(params.max_steps));
    assign(RETURN, 0.0);
    assign(UPRIGHT, 0.0);
}

@compute @workgroup_size(64)
fn stand_reward(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let diverged = has_diverged();
    let upright = select(uprightness(), 0.0, diverged);
    let earned = params.alive_reward + params.upright_reward * upright + params.stillness_reward * stillness();
    let gain = select(earned, 0.0, diverged);
    add(STEP, 1.0);
    add(RETURN, gain);
    add(UPRIGHT, upright);
    var end = select(RUNNING, TRUNCATED, field(STEP) >= field(LIMIT));
    end = select(end, FAILED, diverged || has_fallen());
    reward[params.at + env] = gain;
    termination[params.at + env] = end;
    ended[env] = end;
    if (end != RUNNING) { finish(end); }
}
