// Capsules, one an instance.

#import round
#import solid

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
    return seen(surface.at, surface.normal, colour);
}
