use super::worlds::*;

#[test]
fn agrees_bit_for_bit() {
    let params = random_targets::Params {
        envs: 129,
        driven: 28,
        action_std: 0.5,
        seed: 7,
        step_counter: 3,
        stream: 11,
    };
    let forms = forms!(random_targets, RANDOM_TARGETS, [3, 28, 1], params; out 129 * 28);
    for (form, targets) in forms.shaders() {
        same(form, targets, &forms.twin);
    }
}
