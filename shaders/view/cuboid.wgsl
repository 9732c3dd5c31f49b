// Upright boxes, one an instance.

#import solid

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
    return seen(at, normal, colour);
}
