// Adapts the actor's learning rate to the KL divergence of the new policy from the old, as the minibatch about
// to be stepped against shows it. One invocation.
//
// sums   [SUMS]    what the objective has added up in this epoch: see `ppo_loss`
// rates  [3]       factors of the learning rate, of the actor and of the critic; the sum of the KL divergence
//                  before this minibatch

struct Params {
    // Index of the KL divergence in `sums`.
    kl_at: u32,
    // 1 / samples of the minibatch.
    inv_count: f32,
    // 1 in the first minibatch of an epoch.
    first: u32,
    desired_kl: f32,
    least: f32,
    most: f32,
}

@group(0) @binding(0) var<storage, read_write> sums: array<f32>;
@group(0) @binding(1) var<storage, read_write> rates: array<f32>;
@group(0) @binding(2) var<uniform> params: Params;

const FACTOR = 1.5;

@compute @workgroup_size(1)
fn adapt_lr() {
    let before = select(rates[2], 0.0, params.first == 1u);
    let kl = (sums[params.kl_at] - before) * params.inv_count;
    rates[2] = sums[params.kl_at];
    if (kl > 2.0 * params.desired_kl) { rates[0] = max(rates[0] / FACTOR, params.least); }
    else if (kl < 0.5 * params.desired_kl) { rates[0] = min(rates[0] * FACTOR, params.most); }
}
