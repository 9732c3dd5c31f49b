// Capsules, one an instance.

#import light
#import round

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
}

@vertex
fn place(
    // On the unit sphere around +z; w is 0 at the capsule's `a`, 1 at its `b`.
    @location(0) unit: vec4f,
    // Centre (m) and radius (m) of either end.
    @location(1) a: vec4f,
    @location(2) b: vec4f,
    @location(3) colour: vec3f,
) -> Corner {
    let surface = capsule_surface(unit.xyz, unit.w, a, b);
    return Corner(view.clip * vec4f(surface.at, 1.0), surface.at, surface.normal, colour);
}

@fragment
fn paint(corner: Corner) -> @location(0) vec4f {
    return shade(corner.at, normalize(corner.normal), corner.colour);
}
