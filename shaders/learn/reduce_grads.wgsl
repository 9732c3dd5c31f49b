// Adds up the pieces of a gradient and of the losses. One invocation a number.
//
// plan      see network
// partials  [pieces][parameters + SUMS]
// gradient  [parameters]
// squares   [workgroups]                  of the gradient, added up
// losses    [SUMS]                        added to, or begun

#import network

struct Params {
    parameters: u32,
    // 1: the first minibatch of a pass.
    begin: u32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> partials: array<f32>;
@group(0) @binding(2) var<storage, read_write> gradient: array<f32>;
@group(0) @binding(3) var<storage, read_write> squares: array<f32>;
@group(0) @binding(4) var<storage, read_write> losses: array<f32>;
@group(0) @binding(5) var<uniform> params: Params;

var<workgroup> own: array<f32, 64>;

@compute @workgroup_size(64)
fn reduce_grads(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let numbers = params.parameters + SUMS;
    var sum = 0.0;
    if (id.x < numbers) {
        for (var piece = 0u; piece < plan.pieces; piece++) {
            sum += partials[piece * numbers + id.x];
        }
    }
    own[local] = 0.0;
    if (id.x < params.parameters) {
        gradient[id.x] = sum;
        own[local] = sum * sum;
    } else if (id.x < numbers) {
        let which = id.x - params.parameters;
        losses[which] = sum + select(losses[which], 0.0, params.begin == 1u);
    }
    workgroupBarrier();
    if (local == 0u) {
        var all = 0.0;
        for (var i = 0u; i < GROUP; i++) { all += own[i]; }
        squares[group.x] = all;
    }
}
