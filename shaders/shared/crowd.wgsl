// Where the worlds of a crowd stand: in rows, `spacing` apart, around the origin.

struct Crowd {
    envs: u32,
    bones: u32,
    points: u32,
    columns: u32,
    // Boxes of an environment.
    count: u32,
    // m
    spacing: f32,
}

// Where an environment's origin lies.
fn origin(crowd: Crowd, env: u32) -> vec2f {
    let rows = (crowd.envs + crowd.columns - 1u) / crowd.columns;
    let cell = vec2f(f32(env % crowd.columns), f32(env / crowd.columns));
    return (cell - 0.5 * (vec2f(f32(crowd.columns), f32(rows)) - 1.0)) * crowd.spacing;
}
