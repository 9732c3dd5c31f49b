// The index of the search (src/matching) as shaders read it: groups of sixteen leaves of sixteen rows,
// and for each group and leaf a box along the principal axes around its trajectories.

const LEAF = 16u;   // rows a leaf
const GROUP = 16u;  // leaves a group
const CORNERS = 6u; // vec4s a box: least along each axis, greatest along each
const PCA_BOXES = 6u; // boxes whose space the axes take, before all others
const PROJECTION_LEN = 13u; // numbers kept of a query: along the 12 axes, and its slack
const LANES = 8u;   // lavapipe's; so many invocations compare a query's rows, each with a result of its own
const FAR = 3.4e38;

// Bounds are widened by what rounding can do to them: 12 u |q| an axis for the projection (Higham, Accuracy
// and Stability, section 3.1), sqrt(12) times that in all, and a few roundings of the bound itself.
const RELATIVE = 1.00001;
const SLACK = 4e-6;

struct Box { low_a: vec4f, low_b: vec4f, low_c: vec4f, high_a: vec4f, high_b: vec4f, high_c: vec4f }

// Four trajectories along the axes.
struct Projected {
    a: vec4f, b: vec4f, c: vec4f, d: vec4f, e: vec4f, f: vec4f,
    g: vec4f, h: vec4f, i: vec4f, j: vec4f, k: vec4f, l: vec4f,
}

fn add_outside(low: f32, high: f32, at: vec4f, sum: vec4f) -> vec4f {
    let outside = max(max(low - at, at - high), vec4f(0.0));
    return fma(outside, outside, sum);
}

// Squared distances of four trajectories to a box, on top of what is known of their poses.
fn bounds(box: Box, t: Projected, poses: vec4f) -> vec4f {
    var sum = add_outside(box.low_a.x, box.high_a.x, t.a, poses);
    sum = add_outside(box.low_a.y, box.high_a.y, t.b, sum);
    sum = add_outside(box.low_a.z, box.high_a.z, t.c, sum);
    sum = add_outside(box.low_a.w, box.high_a.w, t.d, sum);
    sum = add_outside(box.low_b.x, box.high_b.x, t.e, sum);
    sum = add_outside(box.low_b.y, box.high_b.y, t.f, sum);
    sum = add_outside(box.low_b.z, box.high_b.z, t.g, sum);
    sum = add_outside(box.low_b.w, box.high_b.w, t.h, sum);
    sum = add_outside(box.low_c.x, box.high_c.x, t.i, sum);
    sum = add_outside(box.low_c.y, box.high_c.y, t.j, sum);
    sum = add_outside(box.low_c.z, box.high_c.z, t.k, sum);
    return add_outside(box.low_c.w, box.high_c.w, t.l, sum);
}

// Squares of distances given as bytes of `step`.
fn squares(codes: vec4u, step: f32) -> vec4f {
    let distance = vec4f(codes & vec4u(0xffu)) * step;
    return distance * distance;
}

// Bound beyond which nothing is nearer than this squared distance, or as near.
fn limit_of(squared: f32, slack: f32) -> f32 {
    let length = fma(sqrt(squared), RELATIVE, slack);
    return select(length * length, FAR, squared >= 1e37);
}
