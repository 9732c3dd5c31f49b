//! Oracle: `episode_stats::twin`.
//! Bar: counts equal and state cleared bit for bit; the summed return, added up in another
//! order, within (n - 1) roundings of the sum of absolute returns (Higham, section 4.2).

use crate::inputs::{Draw, SEEDS, SIZES, close, same};
use footwork::kernels::locomotion::episode_stats::{self, SUMS};
use footwork::kernels::locomotion::locomotion_layout::{state_f32, state_u32};

/// What is counted, in the order of the sums.
const COUNTS: [usize; 5] = [
    state_u32::EPISODES,
    state_u32::SUCCESSES,
    state_u32::COLLISIONS,
    state_u32::TRUNCATIONS,
    state_u32::LENGTHS,
];

fn agrees(envs: usize, state_f32: &[f32], state_u32: &[u32]) -> Vec<f32> {
    let params = episode_stats::Params { envs: envs as u32 };
    let forms = forms!(
        episode_stats, EPISODE_STATS, [1, 1, 1], params; mut state_f32, mut state_u32, out SUMS
    );
    let returns = &state_f32[state_f32::RETURNS * envs..(state_f32::RETURNS + 1) * envs];
    let absolute: f32 = returns.iter().map(|r| r.abs()).sum();
    let twin = &forms.twin;
    for (form, got) in forms.shaders() {
        same(form, &got.0, &twin.0);
        assert_eq!(got.1, twin.1, "{form}");
        same(form, &got.2[..5], &twin.2[..5]);
        close(form, &got.2[5..], &twin.2[5..], |_| {
            envs as f32 * f32::EPSILON * absolute
        });
    }
    forms.twin.2
}

#[test]
fn agrees_with_its_twin_on_random_states() {
    for seed in SEEDS {
        for envs in SIZES.into_iter().chain([4096, 10_000]) {
            let (state_f32, state_u32) = Draw::new(seed).state(envs, 1000);
            let sums = agrees(envs, &state_f32, &state_u32);
            let count = |field: usize| {
                state_u32[field * envs..(field + 1) * envs]
                    .iter()
                    .sum::<u32>()
            };
            for (sum, field) in sums.into_iter().zip(COUNTS) {
                assert_eq!(sum, count(field) as f32);
            }
        }
    }
}

#[test]
fn sums_nothing_and_large_counts() {
    let (mut state_f32, mut state_u32) = Draw::new(1).state(65, 1000);
    state_u32.fill(0);
    state_f32[state_f32::RETURNS * 65..].fill(0.0);
    assert_eq!(agrees(65, &state_f32, &state_u32), [0.0; SUMS]);
    // Even numbers up to 2^25 are floats.
    state_u32[state_u32::LENGTHS * 65..].fill(1 << 18);
    assert_eq!(agrees(65, &state_f32, &state_u32)[4], (65 << 18) as f32);
}
