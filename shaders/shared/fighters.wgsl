// The bodies of two fighters, the twin of src/kernels/humanoid/fighters.rs. Those of the first come first, those of
// the second follow `params.bodies` behind. The importing shader binds `poses` and `dynamics`, imports `spatial`
// and has its environment in `env`.

fn pose(at: u32) -> f32 { return poses[at * params.envs + env]; }
fn position_of(body: u32) -> vec3f { return vec3f(pose(7u * body), pose(7u * body + 1u), pose(7u * body + 2u)); }
fn rotation_of(body: u32) -> vec4f {
    return vec4f(pose(7u * body + 3u), pose(7u * body + 4u), pose(7u * body + 5u), pose(7u * body + 6u));
}

fn velocity3(at: u32) -> vec3f {
    let first = (params.velocities_at + at) * params.envs + env;
    return vec3f(dynamics[first], dynamics[first + params.envs], dynamics[first + 2u * params.envs]);
}

// A fighter's root, and where its own bodies are counted from.
fn root_of(fighter: u32) -> u32 { return fighter * params.bodies; }

fn heading_of_fighter(fighter: u32) -> vec2f { return heading_of(rotation_of(root_of(fighter))); }
fn root_velocity(fighter: u32) -> vec3f { return velocity3(6u * root_of(fighter) + 3u); }

struct PointMotion {
    position: vec3f, // m
    velocity: vec3f, // m/s
}

// A point `up` m along the z axis of a fighter's body; the tree's velocities are where its root is.
fn point_of(fighter: u32, own_body: u32, up: f32) -> PointMotion {
    let body = root_of(fighter) + own_body;
    let position = position_of(body) + rotate(rotation_of(body), vec3f(0.0, 0.0, up));
    let arm = position - position_of(root_of(fighter));
    return PointMotion(position, velocity3(6u * body + 3u) + cross(velocity3(6u * body), arm));
}

// 0 is the right one.
fn hand_of(fighter: u32, hand: u32) -> PointMotion {
    return point_of(fighter, select(params.left_hand, params.right_hand, hand == 0u), 0.0);
}

// 0 is the torso, 1 the head.
fn target_of(fighter: u32, part: u32) -> PointMotion {
    return point_of(fighter, select(params.head, params.torso, part == 0u), select(params.head_up, params.torso_up, part == 0u));
}
