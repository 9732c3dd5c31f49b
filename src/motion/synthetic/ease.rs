//! Small shapes to blend with.

/// 0 below `from`, 1 above `to`, smooth between.
pub fn smooth(from: f32, to: f32, x: f32) -> f32 {
    let s = ((x - from) / (to - from)).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

pub fn mix(a: f32, b: f32, s: f32) -> f32 {
    a + (b - a) * s
}

/// Rises from 0 at 0 to 1 at one half and falls to 0 at 1, level at both ends.
pub fn bell(s: f32) -> f32 {
    let x = s.clamp(0.0, 1.0);
    16.0 * x * x * (1.0 - x) * (1.0 - x)
}

/// `x` up to `limit`, then levelling off below `most`.
pub fn level_off(x: f32, limit: f32, most: f32) -> f32 {
    let room = most - limit;
    if x <= limit {
        x
    } else {
        most - room * ((limit - x) / room).exp()
    }
}
