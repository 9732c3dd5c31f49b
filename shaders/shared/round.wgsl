// The surface of a capsule: two spheres, of radii that may differ, and the hull between them.

struct Surface {
    at: vec3f,
    normal: vec3f,
}

// `unit` is a point of the unit sphere around +z, `end` 0 at `a` and 1 at `b`.
fn capsule_surface(unit: vec3f, end: f32, a: vec4f, b: vec4f) -> Surface {
    let along = b.xyz - a.xyz;
    let length = length(along);
    let z = select(vec3f(0.0, 1.0, 0.0), along / length, length > 1e-6);
    let least = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(z.x) > 0.7);
    let x = normalize(cross(least, z));
    let normal = unit.x * x + unit.y * cross(z, x) + unit.z * z;
    let ball = mix(a, b, end);
    return Surface(ball.xyz + ball.w * normal, normal);
}
