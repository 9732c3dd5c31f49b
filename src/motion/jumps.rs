//! Jumps in a recording: movements between two frames that no body can make.
//!
//! Converters put the rest pose before the motion, editors join takes, and trackers lose the
//! actor for a while. What all have in common is one step far longer than those around it.

use super::track::LimbTrack;
use glam::Vec3;
use std::ops::Range;

/// A step that no body takes. Lengths are those of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The frame after which it comes.
    pub after: usize,
    /// How far the hips go.
    pub hips: f32,
    /// How far two of hands and feet go against the hips, at least.
    pub limbs: f32,
}

impl Jump {
    /// The farther of both.
    pub fn length(&self) -> f32 {
        self.hips.max(self.limbs)
    }
}

/// Which frames of a recording are one motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Continuity {
    /// Frames without leftovers at either end.
    pub keep: Range<usize>,
    /// The jumps between leftovers, and between them and what is kept.
    pub cut: Vec<Jump>,
    /// The jumps in what is kept.
    pub inside: Vec<Jump>,
    /// Frames in what is kept after which a single limb jumps, and how far.
    pub twitches: Vec<(usize, f32)>,
}

/// From where on a step counts as a jump.
struct Limit {
    /// No body is faster, leg lengths a second.
    impossible: f32,
    /// A jump is faster than this,
    speed: f32,
    /// longer than this, leg lengths,
    length: f32,
    /// and this many times longer than the steps before and after.
    ratio: f32,
}

/// Hips: 15 m/s at most; 3 m/s only if a body gets there in more than one frame.
const HIPS: Limit = Limit {
    impossible: 17.6,
    speed: 3.5,
    length: 0.12,
    ratio: 4.0,
};

/// Hands and feet against the hips, two at a time: those of boxers and pitchers are slower than 50 m/s.
const LIMBS: Limit = Limit {
    impossible: 60.0,
    speed: 10.5,
    length: 0.25,
    ratio: 4.0,
};

/// Seconds that a piece at either end must last to be more than a leftover.
const LEFTOVER: f32 = 1.0;

/// Nothing of a rest pose is faster than this, leg lengths a second.
const STILL: f32 = 0.1;

/// Finds the jumps in the frames `within` of a track. A still or short piece between an end and a jump is
/// no part of the motion.
pub fn find(track: &LimbTrack, within: Range<usize>) -> Continuity {
    let steps = Steps::of(track, within.clone());
    let jumps: Vec<usize> = (0..steps.hips.len())
        .filter(|&step| steps.is_jump(step))
        .collect();
    let mut pieces = pieces(within.len(), &jumps);
    let longest = pieces.iter().map(Range::len).max().unwrap_or(0);
    let expendable = |piece: &Range<usize>| piece.len() < longest && steps.is_leftover(piece);
    let heads = pieces.iter().take_while(|&piece| expendable(piece)).count();
    pieces.drain(..heads);
    let tails = pieces
        .iter()
        .rev()
        .take_while(|&piece| expendable(piece))
        .count();
    pieces.truncate(pieces.len() - tails);
    let keep = match (pieces.first(), pieces.last()) {
        (Some(first), Some(last)) => first.start..last.end,
        _ => 0..within.len(),
    };
    let jump = |&step: &usize| Jump {
        after: within.start + step,
        hips: steps.hips[step],
        limbs: steps.limbs[step],
    };
    let is_inside = |step: &&usize| keep.start <= **step && **step + 1 < keep.end;
    let (inside, cut): (Vec<&usize>, Vec<&usize>) = jumps.iter().partition(is_inside);
    let twitch =
        |step: &usize| !steps.is_jump(*step) && LIMBS.exceeded(&steps.limb, *step, steps.rate);
    let twitches = (keep.start..keep.end.saturating_sub(1)).filter(twitch);
    Continuity {
        twitches: twitches
            .map(|step| (within.start + step, steps.limb[step]))
            .collect(),
        cut: cut.into_iter().map(jump).collect(),
        inside: inside.into_iter().map(jump).collect(),
        keep: within.start + keep.start..within.start + keep.end,
    }
}

/// The longest run of frames without a jump.
pub fn longest(continuity: &Continuity) -> Range<usize> {
    let start = continuity.keep.start;
    let jumps: Vec<usize> = continuity
        .inside
        .iter()
        .map(|jump| jump.after - start)
        .collect();
    let pieces = pieces(continuity.keep.len(), &jumps).into_iter();
    // The first of equals.
    let longest = pieces.reduce(|best, piece| {
        if piece.len() > best.len() {
            piece
        } else {
            best
        }
    });
    longest.map_or(continuity.keep.clone(), |piece| {
        start + piece.start..start + piece.end
    })
}

/// The frames between jumps.
fn pieces(frames: usize, jumps: &[usize]) -> Vec<Range<usize>> {
    let starts = std::iter::once(0).chain(jumps.iter().map(|after| after + 1));
    let ends = jumps.iter().map(|after| after + 1).chain([frames]);
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

/// Distances between frames and the next, leg lengths.
struct Steps {
    hips: Vec<f32>,
    /// The second longest of the four limbs: one alone may be a marker that was lost.
    limbs: Vec<f32>,
    /// The longest.
    limb: Vec<f32>,
    rate: f32,
}

impl Steps {
    fn of(track: &LimbTrack, within: Range<usize>) -> Steps {
        let hips = track.hips[within.clone()].windows(2);
        let ends = track.ends[within].windows(2);
        let ends = ends.map(|pair| farthest_two(&pair[0], &pair[1]));
        let (limb, limbs) = ends.unzip();
        Steps {
            hips: hips.map(|pair| pair[0].distance(pair[1])).collect(),
            limbs,
            limb,
            rate: track.rate,
        }
    }

    fn is_jump(&self, step: usize) -> bool {
        HIPS.exceeded(&self.hips, step, self.rate) || LIMBS.exceeded(&self.limbs, step, self.rate)
    }

    /// Whether a piece before the first jump or after the last is a rest pose, or too short for a take.
    fn is_leftover(&self, piece: &Range<usize>) -> bool {
        let steps = piece.start..piece.end - 1;
        let slow = |steps: &[f32]| steps.iter().all(|step| step * self.rate < STILL);
        (piece.len() as f32) < LEFTOVER * self.rate
            || slow(&self.hips[steps.clone()]) && slow(&self.limbs[steps])
    }
}

/// The longest and the second longest of four distances.
fn farthest_two(a: &[Vec3; 4], b: &[Vec3; 4]) -> (f32, f32) {
    let squares = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b));
    let (first, second) = squares.fold((0.0, 0.0), |(first, second): (f32, f32), square| {
        match square > first {
            true => (square, first),
            false => (first, second.max(square)),
        }
    });
    (first.sqrt(), second.sqrt())
}

impl Limit {
    fn exceeded(&self, steps: &[f32], step: usize, rate: f32) -> bool {
        let far = |length: f32| length > self.length && length * rate > self.speed;
        let length = steps[step];
        if !far(length) {
            return false;
        }
        // Beside a jump there may be the jump back.
        let beside = |next: Option<usize>, after: Option<usize>| {
            let at = |step: Option<usize>| step.and_then(|step| steps.get(step)).copied();
            let next = at(next).unwrap_or(0.0);
            if far(next) {
                at(after).unwrap_or(0.0)
            } else {
                next
            }
        };
        let before = beside(step.checked_sub(1), step.checked_sub(2));
        let behind = beside(Some(step + 1), Some(step + 2));
        length * rate > self.impossible || length > self.ratio * before.max(behind)
    }
}
