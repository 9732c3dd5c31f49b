// Ends episodes: of worlds that have diverged, of bodies that have fallen, where the task says so, and out of
// steps. One invocation an environment.
//
// Bounds of loops depend on a buffer, too: lavapipe compiles a shader anew for every launch in which the uniform
// alone decides how often a loop runs.
//
// state        [nq + nv][envs], after the step
// poses        [bodies * 7][envs], of that state
// measures     [measures][envs]: what the task measured of this step
// task_end     [envs]: how the step ends for the task
// episode      [fields][envs]: step, limit, return and measures of the running episode, then sums over
//              those that have ended: how many, their successes, steps, returns, falls, measures
// reward       [envs], from `at` on; none of a world that has diverged
// termination  [envs], from `at` on
// ended        [envs]: the same, of this step alone

#import termination

struct Params {
    envs: u32,
    at: u32,
    nq: u32,
    nv: u32,
    bodies: u32,         // of the character
    head: u32,
    pelvis: u32,
    right_foot: u32,
    left_foot: u32,
    measures: u32,
    max_steps: u32,      // of an episode
    successes: u32,      // ends that are successes, 1 << end
    min_head: f32,       // m; below them it has fallen
    min_pelvis: f32,
    min_body: f32,       // of all but the feet
    max_speed: f32,      // m/s and rad/s; what is faster has diverged
}

@group(0) @binding(0) var<storage, read_write> state: array<f32>;
@group(0) @binding(1) var<storage, read_write> poses: array<f32>;
@group(0) @binding(2) var<storage, read_write> measures: array<f32>;
@group(0) @binding(3) var<storage, read_write> task_end: array<u32>;
@group(0) @binding(4) var<storage, read_write> episode: array<f32>;
@group(0) @binding(5) var<storage, read_write> reward: array<f32>;
@group(0) @binding(6) var<storage, read_write> termination: array<u32>;
@group(0) @binding(7) var<storage, read_write> ended: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

// The running episode; its measures follow.
const STEP = 0u;
const LIMIT = 1u;   // steps after which it is truncated
const RETURN = 2u;
const RUNNING_FIELDS = 3u;
// Sums over those that have ended, behind the measures; the sums of these follow.
const EPISODES = 0u;
const SUCCESSES = 1u;
const STEPS = 2u;
const RETURNS = 3u;
const FALLS = 4u;
const SUM_FIELDS = 5u;

var<private> env: u32;

fn bound(count: u32) -> u32 { return select(0u, count, task_end[env] <= FAILED); }

fn height(body: u32) -> f32 { return poses[(7u * body + 2u) * params.envs + env]; }

fn has_fallen() -> bool {
    var low = height(params.head) < params.min_head || height(params.pelvis) < params.min_pelvis;
    for (var body = 0u; body < bound(params.bodies); body++) {
        let foot = body == params.right_foot || body == params.left_foot;
        low = low || (!foot && height(body) < params.min_body);
    }
    return low;
}

// Compilers may assume that there is no NaN; bits they must take as they are.
fn number(value: f32) -> bool { return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u; }

fn has_diverged() -> bool {
    var diverged = false;
    for (var k = 0u; k < bound(params.nq + params.nv); k++) {
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
    let sums = RUNNING_FIELDS + params.measures;
    add(sums + EPISODES, 1.0);
    add(sums + SUCCESSES, f32(params.successes >> end & 1u));
    add(sums + STEPS, field(STEP));
    add(sums + RETURNS, field(RETURN));
    add(sums + FALLS, select(0.0, 1.0, end == FAILED));
    for (var k = 0u; k < bound(params.measures); k++) {
        add(sums + SUM_FIELDS + k, field(RUNNING_FIELDS + k));
        assign(RUNNING_FIELDS + k, 0.0);
    }
    assign(STEP, 0.0);
    assign(LIMIT, f32(params.max_steps));
    assign(RETURN, 0.0);
}

@compute @workgroup_size(64)
fn end_episode(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let at = params.at + env;
    let diverged = has_diverged();
    add(STEP, 1.0);
    if (diverged) {
        reward[at] = 0.0;
    } else {
        add(RETURN, reward[at]);
        for (var k = 0u; k < bound(params.measures); k++) {
            add(RUNNING_FIELDS + k, measures[k * params.envs + env]);
        }
    }
    var end = select(RUNNING, TRUNCATED, field(STEP) >= field(LIMIT));
    end = select(end, task_end[env], task_end[env] != RUNNING);
    end = select(end, FAILED, diverged || has_fallen());
    termination[at] = end;
    ended[env] = end;
    if (end != RUNNING) { finish(end); }
}
