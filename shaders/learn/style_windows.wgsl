// What a discriminator sees of a rollout: two moments of every step, before and after it. One invocation a
// sample.
//
// Bounds of loops depend on a buffer, too: lavapipe compiles a shader anew for every launch in which the uniform
// alone decides how often a loop runs.
//
// observation        [steps][rows][observation], of which the first numbers, the style, say how the agent moves
// next_observation   [rows][observation], after the last step
// final_observation  [steps][rows][observation] of the episodes that ended there, or [rows][observation] if
//                    `final_steps` is 1
// termination        [steps][rows]
// windows            [steps][rows][2 style]; of an agent that has diverged, twice the moment before

#import termination

struct Params {
    steps: u32,
    rows: u32,
    observation: u32,
    style: u32,
    final_steps: u32,
}

@group(0) @binding(0) var<storage, read> observation: array<f32>;
@group(0) @binding(1) var<storage, read> next_observation: array<f32>;
@group(0) @binding(2) var<storage, read> final_observation: array<f32>;
@group(0) @binding(3) var<storage, read> termination: array<u32>;
@group(0) @binding(4) var<storage, read_write> windows: array<f32>;
@group(0) @binding(5) var<uniform> params: Params;

const MOST = 1024.0; // no body that has not diverged observes more

// Compilers may assume that there is no NaN; bits they must take as they are.
fn plausible(value: f32) -> bool { return (bitcast<u32>(value) & 0x7fffffffu) <= bitcast<u32>(MOST); }

@compute @workgroup_size(64)
fn style_windows(@builtin(global_invocation_id) id: vec3u) {
    let sample = id.x;
    let samples = params.steps * params.rows;
    if (sample >= samples) { return; }
    let style = select(0u, params.style, termination[sample] <= FAILED);
    let row = sample % params.rows;
    let seen = params.observation;
    let before = sample * seen;
    let ended = termination[sample] != RUNNING;
    let final_row = select(sample, row, params.final_steps == 1u);
    let last = sample + params.rows >= samples;
    var diverged = false;
    for (var k = 0u; k < style; k++) {
        var after = 0.0;
        if (ended) { after = final_observation[final_row * seen + k]; }
        else if (last) { after = next_observation[row * seen + k]; }
        else { after = observation[(sample + params.rows) * seen + k]; }
        let at = 2u * sample * style + k;
        windows[at] = observation[before + k];
        windows[at + style] = after;
        diverged = diverged || !plausible(after);
    }
    if (!diverged) { return; }
    for (var k = 0u; k < style; k++) {
        windows[(2u * sample + 1u) * style + k] = observation[before + k];
    }
}
