// Spheres and capsules against a box, the twin of src/physics/collision/capsule_box.rs.

const NEARER = 3e-8;          // m
const EDGE_PARALLEL = 1e-15;  // m^4
const FAR = 1e30;

// A point of a capsule's axis, from -1 to 1, and the point of the box nearest to it; of `border` a bit
// for each direction in which that lies at the border.
struct Near {
    along: f32,
    gap: f32,
    nearest: vec3f,
    border: u32,
}

fn bits(flags: vec3<bool>) -> u32 { return dot(select(vec3u(0u), vec3u(1u, 2u, 4u), flags), vec3u(1u)); }
fn unit_of(direction: u32) -> vec3f { return select(vec3f(0.0), vec3f(1.0), vec3u(direction) == vec3u(0u, 1u, 2u)); }

// An end of the axis, if it is above a face or inside.
fn above(middle: vec3f, arm: vec3f, along: f32, half: vec3f) -> Near {
    let end = middle + arm * along;
    let nearest = clamp(end, -half, half);
    let border = bits(nearest != end);
    return Near(along, select(FAR, distance(end, nearest), countOneBits(border) <= 1u), nearest, border);
}

// Points nearest to each other of the axis and of the edge that leads from a corner.
fn edge(middle: vec3f, arm: vec3f, half: vec3f, direction: u32, corner: u32) -> Near {
    let unit = unit_of(direction);
    let size = half[direction];
    let flat = arm * (vec3f(1.0) - unit);
    let flat2 = dot(flat, flat);
    if (size * size * flat2 < EDGE_PARALLEL) { return Near(0.0, FAR, vec3f(0.0), 0u); }
    let start = corner_of(half, corner) * (vec3f(1.0) - unit);
    // Of the lines, then of the edge, then of both.
    var along = dot(flat, start - middle) / flat2;
    var position = (middle[direction] + along * arm[direction]) / size;
    var end = 0.0;
    if (abs(position) > 1.0) {
        position = sign_of(position);
        end = position;
        along = dot(arm, start + unit * (size * position) - middle) / dot(arm, arm);
    }
    if (abs(along) > 1.0) {
        along = sign_of(along);
        position = (middle[direction] + along * arm[direction]) / size;
        if (abs(position) > 1.0) {
            position = sign_of(position);
            end = position;
        }
    }
    let gap = distance(middle + arm * along, start + unit * (size * position));
    // Once at a corner it counts as there, even if the axis ends before.
    let cornered = end != 0.0;
    let nearest = start + unit * (size * select(position, end, cornered));
    return Near(along, gap, nearest, select(7u ^ (1u << direction), 7u, cornered));
}

// Two ends, then twelve edges: the first that is nearest.
fn nearest_of(middle: vec3f, arm: vec3f, half: vec3f) -> Near {
    var best = above(middle, arm, -1.0, half);
    let end = above(middle, arm, 1.0, half);
    if (end.gap + NEARER < best.gap) { best = end; }
    for (var i = 0u; i < 24u; i++) {
        if (((i % 8u) >> (i / 8u) & 1u) == 1u) { continue; }
        let near = edge(middle, arm, half, i / 8u, i % 8u);
        if (near.gap + NEARER < best.gap) { best = near; }
    }
    return best;
}

// Where the axis, running on from the nearest point, ends or leaves the box's outline; its way is 0 if
// it leads away from the box both ways.
fn second_of(arm: vec3f, near: Near, half: vec3f) -> vec2f {
    let inwards = (bits(arm > vec3f(0.0)) ^ bits(near.nearest > vec3f(0.0))) & near.border;
    let inward = countOneBits(inwards);
    var runs = 7u ^ near.border;
    var forwards = near.along < 0.0;
    switch (countOneBits(near.border)) {
        case 1u: {}
        case 2u: {
            if (inward != 1u) { return vec2f(0.0); }
            // Of the two directions across the edge the one with the larger part of the axis.
            let edge = firstTrailingBit(runs);
            let one = (edge + 1u) % 3u;
            let other = (edge + 2u) % 3u;
            let steeper = 1u << select(other, one, abs(arm[one]) > abs(arm[other]));
            forwards = (inwards & steeper) != 0u;
            runs |= steeper;
        }
        case 3u: {
            if (inward == 0u || inward == 3u) { return vec2f(0.0); }
            let lone = select(7u ^ inwards, inwards, inward == 1u);
            let part = arm[firstTrailingBit(lone)];
            let steep = part * part > 0.5 * dot(arm, arm);
            forwards = ((inwards & lone) != 0u) == steep;
            runs = select(7u ^ lone, lone, steep);
        }
        default: { return vec2f(0.0); }
    }
    let way = select(-1.0, 1.0, forwards);
    var length = 1.0 - way * near.along;
    for (var i = 0u; i < 3u; i++) {
        let step = arm[i] * way;
        if ((runs >> i & 1u) == 0u || step == 0.0) { continue; }
        let leave = (half[i] * sign_of(step) - near.nearest[i]) / step;
        if (leave > 0.0) { length = min(length, leave); }
    }
    return vec2f(near.along + way * length, way);
}

// `centre` is in the frame of the box.
fn sphere_box(number: u32, centre: vec3f, radius: f32, box: WorldGeom) {
    let away = clamp(centre, -box.size, box.size) - centre;
    var gap = length(away);
    var normal = away / gap;
    if (gap == 0.0) {
        let depths = box.size - abs(centre);
        let shallow = min(depths.x, min(depths.y, depths.z));
        let axis = firstTrailingBit(bits(depths == vec3f(shallow)));
        normal = unit_of(axis) * select(1.0, -1.0, centre[axis] > 0.0);
        gap = -shallow;
    }
    let position = box.rotation * (centre + normal * (0.5 * (radius + gap))) + box.position;
    let outwards = box.rotation * normal;
    add_contact(number, position, outwards, any_across(outwards), gap - radius);
}

fn capsule_box(round: WorldGeom, box: WorldGeom) {
    let inverse = transpose(box.rotation);
    let middle = inverse * (round.position - box.position);
    let rod = round.kind == CAPSULE;
    var along = vec2f(0.0);
    var points = 1u;
    var arm = vec3f(0.0);
    if (rod) {
        arm = inverse * round.rotation[2] * round.size.y;
        let near = nearest_of(middle, arm, box.size);
        if (near.gap == FAR) { return; }
        let second = second_of(arm, near, box.size);
        along = vec2f(near.along, second.x);
        points = select(1u, 2u, second.y != 0.0);
    }
    for (var number = 0u; number < points; number++) {
        sphere_box(number, middle + arm * along[number], round.size.x, box);
    }
}
