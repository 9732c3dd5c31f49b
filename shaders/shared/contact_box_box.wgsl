// A box against a box, the twin of src/physics/collision/box_box.rs.

const EDGES_PARALLEL = 1e-10; // squared sine of the angle
const ALIKE = 0.99;
const BETTER = 0.05;
const PART = 1e-6;
const SLIP = 1e-7;            // m
const LEVEL = 1e-5;

// Axes: three of the first's faces, three of the second's, nine of their edges.
const FACES = 6u;
const AXES = 15u;

// Half sizes of both, and the second as the first sees it.
struct Boxes {
    first: vec3f,
    second: vec3f,
    between: vec3f,
    rotation: mat3x3f,
}

struct Overlap {
    axis: u32,
    along: vec3f, // unit, in the first's frame
    distance: f32,
}

var<private> boxes: Boxes;
var<private> polygon: array<vec3f, MAX_POINTS>;
var<private> clipped: array<vec3f, MAX_POINTS>;

fn axis_of(axis: u32) -> vec3f {
    if (axis < 3u) { return unit_of(axis); }
    let other = boxes.rotation[axis % 3u];
    if (axis < FACES) { return other; }
    return cross(unit_of((axis - FACES) / 3u), other);
}

// The axis of least overlap; its distance is positive if they are apart.
fn least_overlap() -> Overlap {
    var best = Overlap(0u, vec3f(0.0), -FAR);
    var face = best;
    for (var axis = 0u; axis < AXES; axis++) {
        var along = axis_of(axis);
        let length2 = dot(along, along);
        if (length2 < EDGES_PARALLEL) { continue; }
        along /= sqrt(length2);
        let reach = dot(boxes.first, abs(along)) + dot(boxes.second, abs(along * boxes.rotation));
        let distance = abs(dot(boxes.between, along)) - reach;
        if (distance > 0.0) { return Overlap(axis, along, distance); }
        if (distance * select(1.0 + PART, 1.0, axis < FACES) > best.distance) {
            best = Overlap(axis, along, distance);
        }
        if (axis + 1u == FACES) { face = best; }
    }
    let alike = abs(dot(best.along, face.along)) > ALIKE;
    if (alike && best.distance <= face.distance * (1.0 - BETTER) + SLIP) { return face; }
    return best;
}

// Middle of the edge that is farthest out; the other one if two may be and `other`.
fn outermost(half: vec3f, normal: vec3f, edge: u32, other: bool) -> vec3f {
    let corner = select(-half, half, normal >= vec3f(0.0));
    let level = abs(normal) < vec3f(LEVEL);
    return select(corner, -corner, level & vec3<bool>(other)) * (vec3f(1.0) - unit_of(edge));
}

fn edge_edge(frame: WorldGeom, edges: u32, along: vec3f) {
    let normal = along * sign_of(dot(along, boxes.between));
    let one = unit_of(edges / 3u);
    let other = boxes.rotation[edges % 3u];
    let half = boxes.first[edges / 3u];
    let other_half = boxes.second[edges % 3u];
    let seen = -(normal * boxes.rotation);
    let cosine = dot(one, other);
    let sideways = cross(one, other);
    var nearest = FAR;
    var middle = vec3f(0.0);
    var depth = 0.0;
    for (var choice = 0u; choice < 4u; choice++) {
        let a = outermost(boxes.first, normal, edges / 3u, (choice & 1u) != 0u);
        let b = boxes.rotation * outermost(boxes.second, seen, edges % 3u, (choice & 2u) != 0u) + boxes.between;
        let along_one = dot(one, b - a);
        let along_other = dot(other, b - a);
        var s = clamp((along_one - cosine * along_other) / dot(sideways, sideways), -half, half);
        let t = clamp(cosine * s - along_other, -other_half, other_half);
        s = clamp(along_one + cosine * t, -half, half);
        let apart = b + other * t - a - one * s;
        if (dot(apart, apart) < nearest) {
            nearest = dot(apart, apart);
            middle = a + one * s + 0.5 * apart;
            depth = dot(normal, apart);
        }
    }
    let outwards = frame.rotation * normal;
    add_contact(0u, frame.rotation * middle + frame.position, outwards, any_across(outwards), depth);
}

fn beyond(point: vec3f, axis: vec3f, limit: f32) -> f32 {
    let beyond = dot(axis, point) - limit;
    return select(beyond, 0.0, abs(beyond) < SLIP);
}

// The polygon within the sides of a face (Sutherland and Hodgman 1974): how many corners it has.
fn clip(limits: vec2f) -> u32 {
    var count = 4u;
    for (var side = 0u; side < 4u; side++) {
        let axis = unit_of(side / 2u) * (1.0 - 2.0 * f32(side % 2u));
        let limit = limits[side / 2u];
        var inside = 0u;
        for (var i = 0u; i < count; i++) {
            let point = polygon[i];
            let next = polygon[(i + 1u) % count];
            let here = beyond(point, axis, limit);
            let there = beyond(next, axis, limit);
            if (here <= 0.0 && inside < MAX_POINTS) {
                clipped[inside] = point;
                inside++;
            }
            if (here * there < 0.0 && inside < MAX_POINTS) {
                clipped[inside] = mix(point, next, here / (here - there));
                inside++;
            }
        }
        count = inside;
        polygon = clipped;
    }
    return count;
}

// The corners of that face of the second box that looks at the first's most.
fn opposing(face: u32, side: f32) {
    let slopes = unit_of(face) * boxes.rotation;
    let steep = abs(slopes);
    var axis = select(0u, 1u, steep.y > steep.x);
    axis = select(axis, 2u, steep.z > steep[axis]);
    let u = boxes.rotation[(axis + 1u) % 3u] * boxes.second[(axis + 1u) % 3u];
    let v = boxes.rotation[(axis + 2u) % 3u] * boxes.second[(axis + 2u) % 3u];
    let out = boxes.rotation[axis] * boxes.second[axis];
    let centre = boxes.between - out * select(-1.0, 1.0, side * slopes[axis] > 0.0);
    polygon[0] = centre + u + v;
    polygon[1] = centre + v - u;
    polygon[2] = centre - u - v;
    polygon[3] = centre + u - v;
}

// `way` is -1 if normals lead to the box whose face it is, `frame`.
fn face_face(frame: WorldGeom, face: u32, way: f32) {
    let x = (face + 1u) % 3u;
    let y = (face + 2u) % 3u;
    let side = sign_of(boxes.between[face]);
    let height = boxes.first[face];
    opposing(face, side);
    // Along the face, and above it.
    for (var i = 0u; i < 4u; i++) {
        let corner = polygon[i];
        polygon[i] = vec3f(corner[x], corner[y], side * corner[face] - height);
    }
    let count = clip(vec2f(boxes.first[x], boxes.first[y]));
    let normal = frame.rotation * unit_of(face) * (side * way);
    let tangent = any_across(normal);
    for (var number = 0u; number < count; number++) {
        let point = polygon[number];
        var again = false;
        for (var earlier = 0u; earlier < number; earlier++) {
            let apart = polygon[earlier].xy - point.xy;
            again |= dot(apart, apart) < 4.0 * SLIP * SLIP;
        }
        if (again) { continue; }
        let inside = point.x * unit_of(x) + point.y * unit_of(y) + side * (height + 0.5 * point.z) * unit_of(face);
        add_contact(number, frame.rotation * inside + frame.position, normal, tangent, point.z);
    }
}

fn box_box(first: WorldGeom, second: WorldGeom) {
    let inverse = transpose(first.rotation);
    boxes = Boxes(first.size, second.size, inverse * (second.position - first.position), inverse * second.rotation);
    let overlap = least_overlap();
    if (overlap.distance > 0.0) { return; }
    if (overlap.axis >= FACES) {
        edge_edge(first, overlap.axis - FACES, overlap.along);
        return;
    }
    var frame = first;
    var way = 1.0;
    if (overlap.axis >= 3u) {
        frame = second;
        way = -1.0;
        let rotation = transpose(boxes.rotation);
        boxes = Boxes(second.size, first.size, -(rotation * boxes.between), rotation);
    }
    face_face(frame, overlap.axis % 3u, way);
}
