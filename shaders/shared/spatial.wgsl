// Quaternions (x, y, z, w) and spatial vectors, the twin of src/physics/spatial.rs.

fn rotate(rotation: vec4f, v: vec3f) -> vec3f {
    let t = 2.0 * cross(rotation.xyz, v);
    return v + rotation.w * t + cross(rotation.xyz, t);
}

fn quat_mul(a: vec4f, b: vec4f) -> vec4f {
    return vec4f(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}

fn unit2(v: vec2f) -> vec2f { return select(vec2f(1.0, 0.0), v / length(v), length(v) > 1e-6); }

// Which way a root faces on the ground. Upright is the rule: one who faces straight up or down has no heading, and
// gets the world's.
fn heading_of(root: vec4f) -> vec2f { return unit2(rotate(root, vec3f(1.0, 0.0, 0.0)).xy); }

// Quaternion of an axis times an angle, rad.
fn from_rotation(v: vec3f) -> vec4f {
    let angle = length(v);
    if (angle < 1e-9) { return vec4f(0.5 * v, 1.0); }
    return vec4f(v * (sin(0.5 * angle) / angle), cos(0.5 * angle));
}

// The inverse of `from_rotation`, its angle at most pi.
fn rotation_vector(rotation: vec4f) -> vec3f {
    let q = select(rotation, -rotation, rotation.w < 0.0);
    let sine = length(q.xyz);
    if (sine <= 1e-9) { return 2.0 * q.xyz; }
    return q.xyz * (2.0 * atan2(sine, q.w) / sine);
}

struct Spatial {
    angular: vec3f, // or torque
    linear: vec3f,  // or force
}

fn add(a: Spatial, b: Spatial) -> Spatial { return Spatial(a.angular + b.angular, a.linear + b.linear); }
fn scaled(a: Spatial, by: f32) -> Spatial { return Spatial(a.angular * by, a.linear * by); }
fn product(a: Spatial, b: Spatial) -> f32 { return dot(a.angular, b.angular) + dot(a.linear, b.linear); }

fn cross_motion(a: Spatial, b: Spatial) -> Spatial {
    return Spatial(cross(a.angular, b.angular), cross(a.linear, b.angular) + cross(a.angular, b.linear));
}

fn cross_force(a: Spatial, b: Spatial) -> Spatial {
    return Spatial(cross(a.angular, b.angular) + cross(a.linear, b.linear), cross(a.angular, b.linear));
}

struct Inertia {
    mass: f32,
    moment: vec3f,
    diagonal: vec3f, // xx yy zz about the origin
    mixed: vec3f,    // xy xz yz
}

fn momentum(i: Inertia, m: Spatial) -> Spatial {
    let w = m.angular;
    let spin = vec3f(
        i.diagonal.x * w.x + i.mixed.x * w.y + i.mixed.y * w.z,
        i.mixed.x * w.x + i.diagonal.y * w.y + i.mixed.z * w.z,
        i.mixed.y * w.x + i.mixed.z * w.y + i.diagonal.z * w.z,
    );
    return Spatial(spin + cross(i.moment, m.linear), m.linear * i.mass + cross(w, i.moment));
}
