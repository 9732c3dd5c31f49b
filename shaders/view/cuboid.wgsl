// Boxes, one an instance.

#import solid
#import spatial

@vertex
fn place(
    // Of the cube from -1 to 1, and its side's normal.
    @location(0) corner: vec3f,
    @location(1) normal: vec3f,
    // m
    @location(2) centre: vec3f,
    @location(3) half: vec3f,
    // Quaternion.
    @location(4) rotation: vec4f,
    @location(5) colour: vec3f,
) -> Corner {
    let at = centre + rotate(rotation, corner * half);
    return seen(at, rotate(rotation, normal), colour);
}
