//! Oracle: `episode_stats::twin`.
//! Bar: counts equal and state cleared bit for bit; the summed return, added up in another
//! order, within (n - 1) roundings of the sum of absolute returns (Higham, section 4.2).

use crate::checked;
use crate::inputs::{Draw, POISON, SEEDS, SIZES, close, gpu, same};
use bytemuck::cast_slice;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use footwork::kernels::locomotion::episode_stats::{self, SUMS};

/// What is counted, in the order of the sums.
const COUNTS: [usize; 5] = [
    state_u32::EPISODES,
    state_u32::SUCCESSES,
    state_u32::COLLISIONS,
    state_u32::TRUNCATIONS,
    state_u32::LENGTHS,
];

fn agrees(envs: usize, reals: &[f32], wholes: &[u32]) -> [f32; SUMS] {
    let params = episode_stats::Params { envs: envs as u32 };
    let mut twin = (reals.to_vec(), wholes.to_vec(), [POISON; SUMS]);
    episode_stats::twin(&mut twin.0, &mut twin.1, &mut twin.2, &params);

    let gpu = gpu();
    let state_f32 = Buffer::from_slice(&gpu, reals);
    let state_u32 = Buffer::from_slice(&gpu, wholes);
    let sums = Buffer::from_slice(&gpu, &[POISON; SUMS + 2]);
    episode_stats::launch(&gpu, &state_f32, &state_u32, &sums, &params);
    let launched = (
        state_f32.read(&gpu).expect("real"),
        state_u32.read(&gpu).expect("whole"),
        sums.read(&gpu).expect("sums"),
    );
    let buffers: [&[u8]; 3] = [
        cast_slice(reals),
        cast_slice(wholes),
        cast_slice(&[POISON; SUMS + 2]),
    ];
    let outcome = checked::run(&shader::EPISODE_STATS, [1, 1, 1], &buffers, &params);
    let checked = (outcome.of(0), outcome.of(1), outcome.of(2));

    let returns = &reals[state_f32::RETURNS * envs..(state_f32::RETURNS + 1) * envs];
    let absolute: f32 = returns.iter().map(|r| r.abs()).sum();
    for (form, got) in [("launched", launched), ("checked", checked)] {
        same(form, &got.0, &twin.0);
        assert_eq!(got.1, twin.1, "{form}");
        same(form, &got.2[..5], &twin.2[..5]);
        close(form, &got.2[5..6], &twin.2[5..], |_| {
            envs as f32 * f32::EPSILON * absolute
        });
        assert_eq!(got.2[SUMS..], [POISON; 2], "{form}");
    }
    twin.2
}

#[test]
fn agrees_with_its_twin_on_random_states() {
    for seed in SEEDS {
        for envs in SIZES.into_iter().chain([4096, 10_000]) {
            let (reals, wholes) = Draw::new(seed).state(envs, 1000);
            let sums = agrees(envs, &reals, &wholes);
            let count = |field: usize| wholes[field * envs..(field + 1) * envs].iter().sum::<u32>();
            for (sum, field) in sums.into_iter().zip(COUNTS) {
                assert_eq!(sum, count(field) as f32);
            }
        }
    }
}

#[test]
fn sums_nothing_and_large_counts() {
    let (mut reals, mut wholes) = Draw::new(1).state(65, 1000);
    wholes.fill(0);
    reals[state_f32::RETURNS * 65..].fill(0.0);
    assert_eq!(agrees(65, &reals, &wholes), [0.0; SUMS]);
    // Even numbers up to 2^25 are floats.
    wholes[state_u32::LENGTHS * 65..].fill(1 << 18);
    assert_eq!(agrees(65, &reals, &wholes)[4], (65 << 18) as f32);
}
