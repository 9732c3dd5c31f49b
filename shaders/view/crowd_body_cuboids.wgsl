// The boxes of every environment's bodies, one an instance.
//
// cuboids  [count]

#import body_crowd
#import solid

struct BodyCuboid {
    // In the body's frame, m.
    centre: vec3f,
    body: u32,
    // m
    half: vec3f,
    // Quaternion.
    rotation: vec4f,
    colour: vec3f,
}

@group(2) @binding(2) var<storage, read> cuboids: array<BodyCuboid>;

@vertex
fn place(
    @builtin(instance_index) instance: u32,
    // As of `cuboid`.
    @location(0) corner: vec3f,
    @location(1) normal: vec3f,
) -> Corner {
    let env = instance / crowd.count;
    let own = cuboids[instance % crowd.count];
    let pose = body_pose(own.body, env);
    let at = in_scene(pose, own.centre + rotate(own.rotation, corner * own.half), env);
    let turned = rotate(pose.rotation, rotate(own.rotation, normal));
    return seen(at, upright(turned), own.colour);
}
