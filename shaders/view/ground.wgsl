// The ground: a square around the camera that ends behind the haze, with a line every metre and a
// bolder one every five.

#import light

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) at: vec3f,
}

// Half side in distances of half the haze.
const WIDE = 3.5;

@vertex
fn place(@builtin(vertex_index) index: u32) -> Corner {
    let side = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let at = vec3f(view.eye.x, 0.0, view.eye.z) + WIDE * view.haze * vec3f(side.x, 0.0, side.y);
    return Corner(view.clip * vec4f(at, 1.0), at);
}

// How much of a pixel lies on lines `every` so many metres that are `wide` m wide. Far away, where
// a pixel holds several lines, it tends to their share of the ground.
fn lines(at: vec2f, pixel: vec2f, every: f32, wide: f32) -> f32 {
    let off = abs(fract(at / every - 0.5) - 0.5) * every;
    let blur = max(pixel, vec2f(wide));
    let line = (1.0 - smoothstep(vec2f(0.0), blur, off)) * min(wide / blur, vec2f(1.0));
    return max(line.x, line.y);
}

@fragment
fn paint(corner: Corner) -> @location(0) vec4f {
    let at = corner.at.xz;
    let pixel = fwidth(at);
    let tile = 0.50 - 0.14 * max(lines(at, pixel, 1.0, 0.012), lines(at, pixel, 5.0, 0.03));
    return shade(corner.at, vec3f(0.0, 1.0, 0.0), tile * vec3f(0.96, 0.98, 1.0));
}
