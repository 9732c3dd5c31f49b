//! Environments whose agents move under latents.
//! Oracle: the environments within, played by the same actions; the same on the other device, or from a saved
//! state. Bar: equal.

use super::style::{Played, imitate, play};
use crate::support::inputs::gpu;
use footwork::container::Section;
use footwork::env::humanoid::task::open;
use footwork::env::{VecEnv, termination};
use footwork::gpu::{Array, Device};
use footwork::rl::ase::{Ase, LatentDraw, LatentEnv, LowLevel};

const ROWS: usize = 9;
const LATENT: usize = 6;

fn draw(low_level: LowLevel) -> LatentDraw {
    let ase = Ase {
        low_level,
        latent: LATENT,
        kept_steps: [2, 5],
        ..Ase::default()
    };
    LatentDraw::new(&ase, &[0.5, 0.25, 0.25])
}

fn opened(device: &Device, low_level: LowLevel) -> LatentEnv {
    let inner = open(device, imitate(0.3), 4..4 + ROWS, 2).unwrap();
    LatentEnv::new(inner, &draw(low_level), device, 4, 2)
}

/// Rows of `width` numbers, split at `at`.
fn split(values: &[f32], width: usize, at: usize) -> (Vec<f32>, Vec<f32>) {
    let rows = values.chunks_exact(width).map(|row| row.split_at(at));
    let (first, second): (Vec<&[f32]>, Vec<&[f32]>) = rows.unzip();
    (first.concat(), second.concat())
}

#[test]
fn agents_move_as_without_latents_and_observe_them_too() {
    let device = Device::Cpu;
    let mut plain = open(&device, imitate(0.3), 4..4 + ROWS, 2).unwrap();
    let want = play(&device, plain.as_mut(), 12, 1);
    let mut envs = opened(&device, LowLevel::Ase);
    assert_eq!(envs.spec().style, plain.spec().style);
    let inner = plain.spec().observation.dim();
    assert_eq!(envs.spec().observation.dim(), inner + LATENT);
    let got = play(&device, &mut envs, 12, 1);
    assert_eq!((got.rewards, &got.ends), (want.rewards, &want.ends));
    let (observed, latents) = split(&got.observations, inner + LATENT, inner);
    assert_eq!(observed, want.observations);
    let (finals, final_latents) = split(&got.finals, inner + LATENT, inner);
    let mut changes = 0;
    for (at, end) in got.ends.iter().enumerate() {
        let own = at * LATENT..(at + 1) * LATENT;
        let length: f32 = latents[own.clone()].iter().map(|x| x * x).sum();
        assert!((length - 1.0).abs() < 1e-5);
        let next = own.start + ROWS * LATENT..own.end + ROWS * LATENT;
        let changed = latents
            .get(next)
            .is_some_and(|next| *next != latents[own.clone()]);
        changes += u32::from(changed);
        if *end != termination::RUNNING {
            // An episode ends under the latent that it was played with.
            assert_eq!(final_latents[own.clone()], latents[own]);
            let rows = at * inner..(at + 1) * inner;
            assert_eq!(finals[rows.clone()], want.finals[rows]);
            assert!(changed || at + ROWS >= got.ends.len());
        }
    }
    // Kept for 3.5 steps on average.
    assert!((20..60).contains(&changes), "{changes}");
}

#[test]
fn latents_are_the_same_on_the_gpu_and_from_a_saved_state() {
    for low_level in [LowLevel::Ase, LowLevel::PerClip] {
        let latents =
            |played: &Played, width: usize| split(&played.observations, width, width - LATENT).1;
        let mut all = Vec::new();
        for device in [Device::Cpu, Device::from(gpu())] {
            let mut envs = opened(&device, low_level);
            let width = envs.spec().observation.dim();
            let first = play(&device, &mut envs, 5, 1);
            let mut section = Section::default();
            envs.save(&mut section).unwrap();
            let mut restored = opened(&device, low_level);
            restored.load(&mut section).unwrap();
            let [a, b] = [&mut envs, &mut restored].map(|envs| play(&device, envs, 5, 3));
            assert!(a == b);
            all.push([latents(&first, width), latents(&a, width)].concat());
        }
        for (cpu, gpu) in all[0].iter().zip(&all[1]) {
            assert!((cpu - gpu).abs() < 1e-5, "{cpu} {gpu}");
        }
    }
}

/// Every clip has a latent of its own, and all that are drawn are near one.
#[test]
fn latents_of_clips_lie_about_their_clips() {
    let clips = draw(LowLevel::PerClip);
    let centres: Vec<&[f32]> = clips.clips().collect();
    assert_eq!(centres.len(), 3);
    let mut envs = opened(&Device::Cpu, LowLevel::PerClip);
    let width = envs.spec().observation.dim();
    let played = play(&Device::Cpu, &mut envs, 20, 1);
    let mut own = Vec::new();
    for latent in split(&played.observations, width, width - LATENT)
        .1
        .chunks_exact(LATENT)
    {
        let cosine = |centre: &&[f32]| centre.iter().zip(latent).map(|(a, b)| a * b).sum::<f32>();
        let nearest = centres.iter().map(cosine).fold(-1.0, f32::max);
        assert!(nearest > 0.95, "{nearest}");
        own.push(nearest);
    }
    // What a discriminator is shown beside recordings lies as far from them.
    let shown = (0..own.len()).map(|number| {
        let latent = clips.about_clip(1, number);
        let pairs = centres[1].iter().zip(&latent);
        pairs.map(|(a, b)| a * b).sum::<f32>()
    });
    let shown: Vec<f32> = shown.collect();
    let mean = |cosines: &[f32]| cosines.iter().sum::<f32>() / cosines.len() as f32;
    let spread = 1.0 - mean(&own);
    assert!((1e-3..0.05).contains(&spread), "{spread}");
    assert!(
        (1.0 - mean(&shown) - spread).abs() < 0.3 * spread,
        "{spread}"
    );
}

#[test]
fn a_restart_draws_latents_for_those_who_begin() {
    for device in [Device::Cpu, Device::from(gpu())] {
        let mut envs = opened(&device, LowLevel::Ase);
        let width = envs.spec().observation.dim();
        let latents = |envs: &mut LatentEnv| {
            let mut seen = Array::zeroed(&device, ROWS * width);
            envs.observe(&mut seen, 0);
            split(&seen.read(&device).unwrap(), width, width - LATENT).1
        };
        let before = latents(&mut envs);
        let which: Vec<bool> = (0..ROWS).map(|row| row % 2 == 0).collect();
        envs.restart(&which).unwrap();
        let after = latents(&mut envs);
        for (row, &restarted) in which.iter().enumerate() {
            let own = row * LATENT..(row + 1) * LATENT;
            assert_eq!(after[own.clone()] != before[own], restarted);
        }
    }
}
