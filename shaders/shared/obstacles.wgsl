// Obstacles: axis-aligned boxes whose centres bounce between the walls of a square.

// The boundary counts as inside.
fn inside(point: vec2f, centre: vec2f, half: vec2f) -> bool {
    return all(abs(point - centre) <= half);
}

// How far a point lies inside, m: along the axis on which it is nearest to the boundary. Less than
// nothing outside.
fn depth(point: vec2f, centre: vec2f, half: vec2f) -> f32 {
    let within = half - abs(point - centre);
    return min(within.x, within.y);
}

// Centre and velocity after `time`, however many walls are met: the path between walls at -side
// and side is a triangle wave of period 4 side.
struct Bounced {
    place: f32,
    velocity: f32,
}

fn bounce(place: f32, velocity: f32, time: f32, side: f32) -> Bounced {
    let moved = place + velocity * time;
    if (abs(moved) <= side) { return Bounced(moved, velocity); }
    let period = 4.0 * side;
    let along = moved + side;
    let phase = along - floor(along / period) * period;
    let back = phase > 2.0 * side;
    let folded = select(phase, period - phase, back) - side;
    return Bounced(clamp(folded, -side, side), select(velocity, -velocity, back));
}
