// What draws with a colour of its own at every corner: all but `place`.

#import light

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
}

// A corner (m) as the camera sees it or, where shadows are drawn, the sun.
fn seen(at: vec3f, normal: vec3f, colour: vec3f) -> Corner {
    return Corner(view.clip * vec4f(at, 1.0), at, normal, colour);
}

@fragment
fn paint(corner: Corner) -> @location(0) vec4f {
    return shade(corner.at, normalize(corner.normal), corner.colour);
}
