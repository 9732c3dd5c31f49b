//! Obstacles: axis-aligned boxes whose centres bounce between the walls of a square. The twin of
//! `shaders/shared/obstacles.wgsl`.

/// The boundary counts as inside.
#[inline(always)]
pub fn inside(point: [f32; 2], centre: [f32; 2], half: [f32; 2]) -> bool {
    ((point[0] - centre[0]).abs() <= half[0]) & ((point[1] - centre[1]).abs() <= half[1])
}

/// How far a point lies inside, m: along the axis on which it is nearest to the boundary. Less than
/// nothing outside.
#[inline(always)]
pub fn depth(point: [f32; 2], centre: [f32; 2], half: [f32; 2]) -> f32 {
    let [x, z] = [0, 1].map(|axis: usize| half[axis] - (point[axis] - centre[axis]).abs());
    if x < z { x } else { z }
}

/// Place and velocity after `time`, however many walls are met: the path between walls at `-side`
/// and `side` is a triangle wave of period `4 * side`.
#[inline(always)]
pub fn bounce(place: f32, velocity: f32, time: f32, side: f32) -> (f32, f32) {
    let moved = place + velocity * time;
    if moved.abs() <= side {
        return (moved, velocity);
    }
    let period = 4.0 * side;
    let along = moved + side;
    let phase = along - (along / period).floor() * period;
    let (folded, velocity) = match phase > 2.0 * side {
        true => (period - phase, -velocity),
        false => (phase, velocity),
    };
    ((folded - side).clamp(-side, side), velocity)
}
