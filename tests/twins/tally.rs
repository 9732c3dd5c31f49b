//! Oracle: `tally::twin`.
//! Bar: counts equal and state cleared bit for bit; the summed return, added up in another
//! order, within (n - 1) roundings of the sum of absolute returns (Higham, section 4.2).

use crate::checked;
use crate::inputs::{Draw, POISON, SEEDS, SIZES, close, gpu, same};
use bytemuck::cast_slice;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::layout::{real, whole};
use footwork::kernels::tally::{self, SUMS};

/// What is counted, in the order of the sums.
const COUNTS: [usize; 5] = [
    whole::EPISODES,
    whole::SUCCESSES,
    whole::COLLISIONS,
    whole::TRUNCATIONS,
    whole::LENGTHS,
];

fn agrees(envs: usize, reals: &[f32], wholes: &[u32]) -> [f32; SUMS] {
    let params = tally::Params { envs: envs as u32 };
    let mut twin = (reals.to_vec(), wholes.to_vec(), [POISON; SUMS]);
    tally::twin(&mut twin.0, &mut twin.1, &mut twin.2, &params);

    let gpu = gpu();
    let real = Buffer::from_slice(&gpu, reals);
    let whole = Buffer::from_slice(&gpu, wholes);
    let sums = Buffer::from_slice(&gpu, &[POISON; SUMS + 2]);
    tally::launch(&gpu, &real, &whole, &sums, &params);
    let launched = (
        real.read(&gpu).expect("real"),
        whole.read(&gpu).expect("whole"),
        sums.read(&gpu).expect("sums"),
    );
    let buffers: [&[u8]; 3] = [
        cast_slice(reals),
        cast_slice(wholes),
        cast_slice(&[POISON; SUMS + 2]),
    ];
    let outcome = checked::run(&shader::TALLY, [1, 1, 1], &buffers, &params);
    let checked = (outcome.of(0), outcome.of(1), outcome.of(2));

    let returns = &reals[real::RETURNS * envs..(real::RETURNS + 1) * envs];
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
    reals[real::RETURNS * 65..].fill(0.0);
    assert_eq!(agrees(65, &reals, &wholes), [0.0; SUMS]);
    // Even numbers up to 2^25 are floats.
    wholes[whole::LENGTHS * 65..].fill(1 << 18);
    assert_eq!(agrees(65, &reals, &wholes)[4], (65 << 18) as f32);
}
