// The surface of a capsule: two balls, of radii that may differ, and the hull between them.

struct Surface {
    at: vec3f,
    normal: vec3f,
}

// `unit` is a point of the unit sphere around +z, `end` 0 at `a`, whose half is the lower one, and 1 at
// `b`. Of radii that differ the hull does not touch the balls at their equators.
fn capsule_surface(unit: vec3f, end: f32, a: vec4f, b: vec4f) -> Surface {
    let along = b.xyz - a.xyz;
    let length = length(along);
    let z = select(vec3f(0.0, 1.0, 0.0), along / length, length > 1e-6);
    let least = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(z.x) > 0.7);
    let x = normalize(cross(least, z));
    let seam = clamp((a.w - b.w) / max(length, 1e-6), -1.0, 1.0);
    let height = select(mix(seam, -1.0, -unit.z), mix(seam, 1.0, unit.z), end > 0.5);
    let out = normalize(vec3f(unit.xy, 1e-9)).xy * sqrt(max(1.0 - height * height, 0.0));
    let normal = out.x * x + out.y * cross(z, x) + height * z;
    let ball = mix(a, b, end);
    return Surface(ball.xyz + ball.w * normal, normal);
}
