// Keeps the final observations of episodes whose end is the first in a decision. One invocation a number of a row.
// Before `sum_decision`.
//
// termination           [rows] of a step
// decision_termination  of the decision so far, from the index `at` on
// last                  [rows][observation] of the step
// final_observation     [rows][observation] of the decision, from the index `final_at` on

#import termination

struct Params {
    rows: u32,
    observation: u32,
    at: u32,
    final_at: u32,
    step: u32, // of the decision, from 0
}

@group(0) @binding(0) var<storage, read> termination: array<u32>;
@group(0) @binding(1) var<storage, read> decision_termination: array<u32>;
@group(0) @binding(2) var<storage, read> last: array<f32>;
@group(0) @binding(3) var<storage, read_write> final_observation: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

@compute @workgroup_size(64)
fn keep_first_end(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows || termination[row] == RUNNING) { return; }
    if (params.step > 0u && decision_termination[params.at + row] != RUNNING) { return; }
    let number = row * params.observation + id.y;
    final_observation[params.final_at + number] = last[number];
}
