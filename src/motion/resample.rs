//! To the one rate of everything behind the import.

use super::RATE;
use super::clip::Clip;
use glam::Quat;

/// A rate this close to a multiple of 30 Hz counts as that multiple: frame times are rounded
/// (0.0333333, .0083333), and so small a change of speed is not seen.
const TOLERANCE: f32 = 0.005;

/// The clip at 30 Hz: every n-th frame if its rate is n times 30, else between its frames,
/// linearly for positions and along the shortest arc for rotations. It starts at the same
/// instant and ends no later.
pub fn resample(clip: Clip) -> Clip {
    let step = (clip.rate / RATE).round().max(1.0);
    if (clip.rate / RATE / step - 1.0).abs() <= TOLERANCE {
        decimate(clip, step as usize)
    } else {
        interpolate(clip)
    }
}

fn decimate(mut clip: Clip, step: usize) -> Clip {
    clip.rate = RATE;
    if step == 1 {
        return clip;
    }
    let joints = clip.skeleton.joints();
    let frames = clip.rotations.chunks_exact(joints).step_by(step);
    clip.rotations = frames.flatten().copied().collect();
    clip.positions = clip.positions.into_iter().step_by(step).collect();
    clip
}

fn interpolate(clip: Clip) -> Clip {
    let Some(last) = clip.frames().checked_sub(1) else {
        return Clip { rate: RATE, ..clip };
    };
    // In f64: a long clip's frame numbers leave f32 no digits for the part between frames.
    let step = f64::from(clip.rate) / f64::from(RATE);
    let frames = (last as f64 / step + 1e-6).floor() as usize + 1;
    let mut positions = Vec::with_capacity(frames);
    let mut rotations = Vec::with_capacity(frames * clip.skeleton.joints());
    for frame in 0..frames {
        let at = frame as f64 * step;
        let before = (at as usize).min(last);
        let after = (before + 1).min(last);
        let part = (at - before as f64) as f32;
        positions.push(clip.positions[before].lerp(clip.positions[after], part));
        let pairs = clip.pose(before).iter().zip(clip.pose(after));
        rotations.extend(pairs.map(|(a, &b)| Quat::slerp(*a, b, part)));
    }
    Clip {
        rate: RATE,
        positions,
        rotations,
        ..clip
    }
}
