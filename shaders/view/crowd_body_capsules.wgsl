// The capsules of every environment's bodies, one an instance.
//
// capsules  [bones]

#import body_crowd
#import round
#import solid

struct BodyCapsule {
    // In the body's frame: centre (m) and radius (m) of either end.
    a: vec4f,
    b: vec4f,
    colour: vec3f,
    body: u32,
}

@group(2) @binding(2) var<storage, read> capsules: array<BodyCapsule>;

@vertex
fn place(
    @builtin(instance_index) instance: u32,
    // As of `capsule`.
    @location(0) unit: vec4f,
) -> Corner {
    let env = instance / crowd.bones;
    let own = capsules[instance % crowd.bones];
    let pose = body_pose(own.body, env);
    let a = vec4f(in_scene(pose, own.a.xyz, env), own.a.w);
    let b = vec4f(in_scene(pose, own.b.xyz, env), own.b.w);
    let surface = capsule_surface(unit.xyz, unit.w, a, b);
    return seen(surface.at, surface.normal, own.colour);
}
