// Whatever reaches below a plane, the twin of src/physics/collision/plane.rs.

// A box contacts with its lowest corners, at most so many.
const CORNERS = 4u;

// A sphere, or a capsule's two ends: its first tangent follows it.
fn plane_capsule(plane: WorldGeom, round: WorldGeom) {
    let normal = plane.rotation[2];
    let axis = round.rotation[2];
    let rod = round.kind == CAPSULE;
    let tangent = select(any_across(normal), across(normal, axis), rod);
    for (var number = 0u; number < select(1u, 2u, rod); number++) {
        let along = select(0.0, round.size.y, rod) * (1.0 - 2.0 * f32(number));
        let centre = round.position + axis * along;
        let distance = dot(normal, centre - plane.position) - round.size.x;
        add_contact(number, centre - normal * (round.size.x + 0.5 * distance), normal, tangent, distance);
    }
}

fn corner_of(half: vec3f, number: u32) -> vec3f {
    return select(-half, half, (vec3u(number) & vec3u(1u, 2u, 4u)) != vec3u(0u));
}

fn plane_box(plane: WorldGeom, box: WorldGeom) {
    let normal = plane.rotation[2];
    let tangent = any_across(normal);
    let height = dot(normal, box.position - plane.position);
    var found = 0u;
    for (var number = 0u; number < 8u; number++) {
        let corner = box.rotation * corner_of(box.size, number);
        // Of a box whose centre is below, the upper corners do not count.
        let rise = dot(normal, corner);
        let distance = height + rise;
        if (distance >= 0.0 || rise > 0.0 || found == CORNERS) { continue; }
        found++;
        add_contact(number, box.position + corner - normal * (0.5 * distance), normal, tangent, distance);
    }
}
