// Whatever reaches below a plane, the twin of src/body/collide/plane.rs.

// A box touches with its lowest corners, at most so many.
const CORNERS = 4u;

// A sphere, or a capsule's two ends: its first tangent follows it.
fn plane_round(plane: Placed, round: Placed) {
    let normal = plane.turn[2];
    let axis = round.turn[2];
    let rod = round.kind == CAPSULE;
    let tangent = select(any_across(normal), across(normal, axis), rod);
    for (var number = 0u; number < select(1u, 2u, rod); number++) {
        let along = select(0.0, round.size.y, rod) * (1.0 - 2.0 * f32(number));
        let centre = round.place + axis * along;
        let distance = dot(normal, centre - plane.place) - round.size.x;
        add_touch(number, centre - normal * (round.size.x + 0.5 * distance), normal, tangent, distance);
    }
}

fn corner_of(half: vec3f, number: u32) -> vec3f {
    return select(-half, half, (vec3u(number) & vec3u(1u, 2u, 4u)) != vec3u(0u));
}

fn plane_box(plane: Placed, box: Placed) {
    let normal = plane.turn[2];
    let tangent = any_across(normal);
    let height = dot(normal, box.place - plane.place);
    var found = 0u;
    for (var number = 0u; number < 8u; number++) {
        let corner = box.turn * corner_of(box.size, number);
        // Of a box whose centre is below, the upper corners do not count.
        let rise = dot(normal, corner);
        let distance = height + rise;
        if (distance >= 0.0 || rise > 0.0 || found == CORNERS) { continue; }
        found++;
        add_touch(number, box.place + corner - normal * (0.5 * distance), normal, tangent, distance);
    }
}
