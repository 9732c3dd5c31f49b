// Ends episodes: of worlds that have diverged, of bodies that have fallen, where the task says so, and out of
// steps. One invocation an environment. Rows are agents, those of an environment side by side.
//
// Bounds of loops depend on a buffer, too: lavapipe compiles a shader anew for every launch in which the uniform
// alone decides how often a loop runs.
//
// state        [nq + nv][envs], after the step
// poses        [bodies * 7][envs], of that state
// measures     [measures][rows]: what the task measured of this step
// task_end     [rows]: how the step ends for the task, and whether the agent leads; for all of an environment or none
// episode      [fields][rows]: step, limit, return and measures of the running episode, then sums over
//              those that have ended: how many, their successes, steps, returns, falls, measures
// reward       [rows], from `at` on; none of a world that has diverged
// termination  [rows], from `at` on
// ended        [envs]: that of an agent, of this step alone

#import termination
#import fallen

struct Params {
    envs: u32,
    agents: u32,         // of an environment
    at: u32,
    nq: u32,
    nv: u32,
    bodies: u32,         // of an agent; all agents' come first
    head: u32,           // of the first agent, as those that follow
    pelvis: u32,
    right_foot: u32,
    left_foot: u32,
    measures: u32,
    max_steps: u32,      // of an episode
    successes: u32,      // ends that are successes, 1 << end
    falls_end: u32,      // 1 if a fall ends the episode
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
var<private> row: u32;

fn bound(count: u32) -> u32 { return select(0u, count, task_end[env] <= FAILED + LEADS); }

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

fn rows() -> u32 { return params.envs * params.agents; }
fn assign(field: u32, value: f32) { episode[field * rows() + row] = value; }
fn add(field: u32, value: f32) { episode[field * rows() + row] += value; }
fn field(at: u32) -> f32 { return episode[at * rows() + row]; }

// Adds the episode to the sums and begins the next.
fn finish(end: u32, success: bool) {
    let sums = RUNNING_FIELDS + params.measures;
    add(sums + EPISODES, 1.0);
    add(sums + SUCCESSES, select(0.0, 1.0, success));
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

// Takes the step of an agent in; how it ends.
fn end_step(agent: u32, diverged: bool) -> u32 {
    let at = params.at + row;
    add(STEP, 1.0);
    if (diverged) {
        reward[at] = 0.0;
    } else {
        add(RETURN, reward[at]);
        for (var k = 0u; k < bound(params.measures); k++) {
            add(RUNNING_FIELDS + k, measures[k * rows() + row]);
        }
    }
    let task = task_end[row] % LEADS;
    let leads = task_end[row] >= LEADS;
    let falls = params.falls_end == 1u && has_fallen(agent * params.bodies);
    var end = select(RUNNING, TRUNCATED, field(STEP) >= field(LIMIT));
    end = select(end, task, task != RUNNING);
    end = select(end, FAILED, diverged || falls);
    // Who has failed has won nothing.
    let success = (params.successes >> end & 1u) == 1u || (leads && end != FAILED);
    if (end != RUNNING) { finish(end, success); }
    return end;
}

@compute @workgroup_size(64)
fn end_episode(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let diverged = has_diverged();
    for (var agent = 0u; agent < bound(params.agents); agent++) {
        row = env * params.agents + agent;
        let end = end_step(agent, diverged);
        termination[params.at + row] = end;
        ended[env] = end;
    }
}
