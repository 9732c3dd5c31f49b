// Upright boxes, one an instance.

#import light

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
}

@vertex
fn place(
    // Of the cube from -1 to 1, and its side's normal.
    @location(0) corner: vec3f,
    @location(1) normal: vec3f,
    // m
    @location(2) centre: vec3f,
    @location(3) half: vec3f,
    @location(4) colour: vec3f,
) -> Corner {
    let at = centre + corner * half;
    return Corner(view.clip * vec4f(at, 1.0), at, normal, colour);
}

@fragment
fn paint(corner: Corner) -> @location(0) vec4f {
    return shade(corner.at, normalize(corner.normal), corner.colour);
}
