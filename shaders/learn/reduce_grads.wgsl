// Adds up the splits of a gradient and of the objective's sums. One invocation a number.
//
// batch     see network
// partials  [splits][parameters + sums]
// gradient  [parameters]
// sums      [sums]                      added to

#import network

@group(0) @binding(0) var<storage, read> batch: BatchLayout;
@group(0) @binding(1) var<storage, read> partials: array<f32>;
@group(0) @binding(2) var<storage, read_write> gradient: array<f32>;
@group(0) @binding(3) var<storage, read_write> sums: array<f32>;

@compute @workgroup_size(64)
fn reduce_grads(@builtin(global_invocation_id) id: vec3u) {
    let numbers = batch.parameters + batch.sums;
    if (id.x >= numbers) { return; }
    var sum = 0.0;
    for (var split = 0u; split < batch.splits; split++) {
        sum += partials[split * numbers + id.x];
    }
    if (id.x < batch.parameters) {
        gradient[id.x] = sum;
    } else {
        sums[id.x - batch.parameters] += sum;
    }
}
