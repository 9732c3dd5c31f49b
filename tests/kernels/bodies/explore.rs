//! `explore`.

use super::worlds::*;

#[test]
fn explore_agrees_bit_for_bit() {
    let params = explore::Params {
        envs: 129,
        std: 0.5,
        seed: 7,
        step_counter: 3,
        stream: 11,
    };
    let mut wanted = vec![POISON; 129 * 28];
    let gpu = gpu();
    let targets = up(&gpu, &wanted);
    let blank = wanted.clone();
    explore::twin(&mut wanted, &params);
    explore::launch(&gpu, 28, &targets, &params);
    let groups = [3, 28, 1];
    let outcome = checked::run(&shader::RANDOM_TARGETS, groups, &[cast_slice(&blank)], &params);
    assert_eq!(targets.read(&gpu).unwrap(), wanted);
    assert_eq!(outcome.of::<f32>(0), wanted);
}
