// Acts for opponents that follow a script: each does the one of its strides by which it comes nearest to a place and
// faces it most. One invocation an environment; those of policies are left alone.
//
// own          [envs]   the learner's row of an environment
// place        [envs]   a script's index, SCRIPTED added
// scripts      numbers of an action and of an observation; then of every script: where it observes the place, two
//              numbers in its heading frame, m; its first stride; how many it has
// strides      [..][2 + action]   speed along the heading, m/s; speed of the heading to the left, rad/s; the action
// observation  [2 envs][observation]
// action       [2 envs][action]

#import bout_rows

struct Params {
    envs: u32,
}

struct Scripts {
    action: u32,
    observation: u32,
    words: array<u32>,
}

@group(0) @binding(0) var<storage, read> own: array<u32>;
@group(0) @binding(1) var<storage, read> place: array<u32>;
@group(0) @binding(2) var<storage, read> scripts: Scripts;
@group(0) @binding(3) var<storage, read> strides: array<f32>;
@group(0) @binding(4) var<storage, read> observation: array<f32>;
@group(0) @binding(5) var<storage, read_write> action: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

// How far a body looks ahead that chooses how to move, s.
const AHEAD_S = 0.5;
// Weight of facing the place beside a metre of the way there.
const FACING = 2.0;

fn score(stride: u32, bearing: f32) -> f32 {
    let at = stride * (2u + scripts.action);
    let turned = strides[at + 1u] * AHEAD_S;
    return strides[at] * AHEAD_S * cos(bearing - 0.5 * turned) + FACING * cos(bearing - turned);
}

@compute @workgroup_size(64)
fn scripted_actions(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs || place[env] < SCRIPTED) { return; }
    let script = 3u * (place[env] - SCRIPTED);
    let first = scripts.words[script + 1u];
    let end = first + scripts.words[script + 2u];
    let row = own[env] ^ 1u;
    let seen = row * scripts.observation + scripts.words[script];
    let bearing = atan2(observation[seen + 1u], observation[seen]);
    var best = first;
    var most = score(first, bearing);
    for (var stride = first + 1u; stride < end; stride++) {
        let found = score(stride, bearing);
        if (found >= most) {
            best = stride;
            most = found;
        }
    }
    let chosen = best * (2u + scripts.action) + 2u;
    for (var i = 0u; i < scripts.action; i++) { action[row * scripts.action + i] = strides[chosen + i]; }
}
