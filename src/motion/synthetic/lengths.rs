//! How a number of minutes is cut into clips.

use super::random::Random;
use crate::motion::RATE;

/// Frames of each clip, of `shortest` to `longest` seconds; together they are exactly as long as
/// requested.
pub fn lengths(random: &mut Random, minutes: f32, (shortest, longest): (f32, f32)) -> Vec<usize> {
    let mut left = (minutes * 60.0 * RATE).round() as usize;
    let mut lengths = Vec::new();
    while left > 0 {
        let drawn = (random.range(shortest, longest) * RATE) as usize;
        // A rest too short for a clip of its own is added to the last one.
        let short = left < drawn + (shortest * RATE) as usize;
        let frames = if short { left } else { drawn };
        lengths.push(frames);
        left -= frames;
    }
    lengths
}
