// Terms of the reward of boxing, the twin of src/kernels/humanoid/boxing_terms.rs. Numbers are those of the paper's
// equations; `ahead` is the cosine between a fighter's heading and the direction to its opponent.

const REACH = 1.0;           // m
const LEAST_DAMAGE = -200.0; // N

// 11
fn far(position: f32, velocity: f32, facing: f32) -> f32 { return 0.5 * position + 0.4 * velocity + 0.1 * facing; }

// 12
fn position(distance: f32) -> f32 { return exp(-0.5 * distance * distance); }

// 13
fn velocity(along: f32, wanted: f32) -> f32 {
    let short = max(wanted - along, 0.0);
    return exp(-4.0 * short * short);
}

// 14
fn facing_from_afar(ahead: f32) -> f32 { return max(ahead, 0.0); }

// 15
fn damage(given: f32, taken: f32, factor: f32) -> f32 { return max(given - factor * taken, LEAST_DAMAGE); }

// 2 to 4, of a hand
fn close(apart: vec3f, along: f32) -> f32 {
    return 0.2 * exp(-4.0 * dot(apart, apart)) + 0.8 * clamp(along, 0.0, 1.0);
}

// Back to back the directions of equation 16 agree as well.
fn face_each_other(ahead: f32, opponent_ahead: f32) -> bool { return ahead > 0.0 && opponent_ahead > 0.0; }

// 16
fn facing(alignment: f32, face_each_other: bool) -> f32 {
    return select(0.0, exp(-5.0 * abs(alignment - 1.0)), face_each_other);
}

// 17
fn fall(up: f32) -> f32 { return 0.6 * max(1.0 - up, 0.0); }

// 18
fn nearness(distance: f32) -> f32 {
    let beyond = max(distance - REACH, 0.0);
    return exp(-10.0 * beyond * beyond);
}

// 19
fn energy(distance: f32, squared_acceleration: f32) -> f32 { return nearness(distance) * squared_acceleration; }

// Of who has fallen, and of who has left the arena.
fn penalty(fallen: bool, out: bool) -> f32 { return select(0.0, 1.0, fallen) + select(0.0, 1.0, out); }
