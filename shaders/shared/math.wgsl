// Character frame on the ground: x is left, z is forward; `heading` is the unit forward
// direction in the world. Unit vectors instead of angles: no trigonometry in any kernel.

fn to_world(local: vec2f, heading: vec2f) -> vec2f {
    return vec2f(heading.y * local.x + heading.x * local.y, heading.y * local.y - heading.x * local.x);
}

fn to_local(world: vec2f, heading: vec2f) -> vec2f {
    return vec2f(heading.y * world.x - heading.x * world.y, heading.x * world.x + heading.y * world.y);
}
