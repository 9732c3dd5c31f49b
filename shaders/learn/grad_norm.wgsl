// Squares of a gradient, added up in NORM_PARTIALS parts. One workgroup a part.
//
// parameters     [1]                their number
// gradient       [parameters]
// norm_partials  [NORM_PARTIALS]

#import adam

@group(0) @binding(0) var<storage, read> parameters: array<u32>;
@group(0) @binding(1) var<storage, read> gradient: array<f32>;
@group(0) @binding(2) var<storage, read_write> norm_partials: array<f32>;

var<workgroup> own: array<f32, 64>;

@compute @workgroup_size(64)
fn grad_norm(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let part = (parameters[0] + NORM_PARTIALS - 1u) / NORM_PARTIALS;
    let end = min((group.x + 1u) * part, parameters[0]);
    var sum = 0.0;
    for (var i = group.x * part + local; i < end; i += 64u) { sum += gradient[i] * gradient[i]; }
    own[local] = sum;
    workgroupBarrier();
    if (local == 0u) {
        var all = 0.0;
        for (var i = 0u; i < 64u; i++) { all += own[i]; }
        norm_partials[group.x] = all;
    }
}
