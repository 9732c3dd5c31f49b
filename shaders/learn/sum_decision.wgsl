// Takes a step of a low level into the decision of a high level that it is part of; steps after an episode's end
// do not count. One invocation a row.
//
// reward, style_reward, termination, situation  [rows] of the step; `situation` is Transition::group, whose name WGSL
//                                           reserves
// decision_...                              the decision's from the index `at` on: a share of the sum of rewards,
//                                           the mean of style rewards, how it ended, the group of the last step
//                                           that counts

#import termination

struct Params {
    rows: u32,
    at: u32,
    step: u32, // of the decision, from 0
    reward_share: f32,
}

@group(0) @binding(0) var<storage, read> reward: array<f32>;
@group(0) @binding(1) var<storage, read> style_reward: array<f32>;
@group(0) @binding(2) var<storage, read> termination: array<u32>;
@group(0) @binding(3) var<storage, read> situation: array<u32>;
@group(0) @binding(4) var<storage, read_write> decision_reward: array<f32>;
@group(0) @binding(5) var<storage, read_write> decision_style_reward: array<f32>;
@group(0) @binding(6) var<storage, read_write> decision_termination: array<u32>;
@group(0) @binding(7) var<storage, read_write> decision_situation: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

@compute @workgroup_size(64)
fn sum_decision(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows) { return; }
    let at = params.at + row;
    let first = params.step == 0u;
    if (!first && decision_termination[at] != RUNNING) { return; }
    var sum = 0.0;
    var mean = 0.0;
    if (!first) {
        sum = decision_reward[at];
        mean = decision_style_reward[at];
    }
    decision_reward[at] = sum + params.reward_share * reward[row];
    decision_style_reward[at] = mean + (style_reward[row] - mean) / f32(params.step + 1u);
    decision_termination[at] = termination[row];
    decision_situation[at] = situation[row];
}
