// Contacts and joint limits as mass-weighted rows of the soft constraint problem (src/body/constrain.rs). One
// row of workgroups a contact, then one for every three joints; one invocation an environment.
//
// tables       see `tables`
// state        [positions + dofs][envs]
// dynamics     see `articulate`
// touches      [slots * 10][envs]: place, normal, tangent, distance
// keys         [slots][envs]: pair * 8 + point
// counts       [2][envs]: contacts, overflow
// rows         [slots * 3 + joints][quads][envs], each over the degrees of freedom
// constraints  [slots + joints][CONSTRAINT][envs]

#import tables
#import state
#import touches
#import spatial
#import dynamics
#import constraints

struct Params {
    envs: u32,
    dt: f32,
}

@group(0) @binding(0) var<storage, read_write> tables: array<u32>;
@group(0) @binding(1) var<storage, read_write> state: array<f32>;
@group(0) @binding(2) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(3) var<storage, read_write> touches: array<f32>;
@group(0) @binding(4) var<storage, read_write> keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> rows: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> constraints: array<f32>;
@group(0) @binding(8) var<uniform> params: Params;

// Of each degree of freedom, three rows: a contact's normal and tangents, or three joints' limits.
var<private> x: array<vec3f, ALL_DOFS_MOST>;

fn kept(at: u32) -> f32 { return dynamics[at * params.envs + env]; }

// Which degrees of freedom move a body.
fn movers(body: u32) -> vec3u {
    if (body == NONE) { return vec3u(0u); }
    let at = tables[BODIES_AT] + body * BODY + BODY_MOVERS;
    return vec3u(tables[at], tables[at + 1u], tables[at + 2u]);
}

// How the second body's point moves from the first's along three directions. All trees and degrees of
// freedom in turn, so that all invocations read the same.
fn part(first: u32, second: u32, point: vec3f, directions: mat3x3f) {
    let movers_of_second = movers(second);
    let movers_of_first = movers(first);
    for (var index = 0u; index < tables[TREE_COUNT]; index++) {
        let tree = tables[TREES_AT] + index * TREE;
        let arm = point - origin_of(tree);
        for (var k = 0u; k < tables[tree + TREE_DOFS]; k++) {
            let dof = tables[tree + TREE_DOF] + k;
            let sign = f32((movers_of_second[dof / 32u] >> (dof % 32u)) & 1u) - f32((movers_of_first[dof / 32u] >> (dof % 32u)) & 1u);
            let m = 6u * dof;
            let angular = vec3f(kept(m), kept(m + 1u), kept(m + 2u));
            let linear = vec3f(kept(m + 3u), kept(m + 4u), kept(m + 5u));
            x[dof] = sign * ((linear + cross(angular, arm)) * directions);
        }
    }
}

// Speeds along the rows, of the velocities that there are.
fn speeds() -> vec3f {
    var sum = vec3f(0.0);
    for (var dof = 0u; dof < tables[DOF_COUNT]; dof++) { sum += x[dof] * v(dof); }
    return sum;
}

// x = L^-T x. The degrees of freedom beyond one stand right behind it.
fn weigh() {
    for (var left = tables[DOF_COUNT]; left > 0u; left--) {
        let info = tables[DOFS_AT] + (left - 1u) * DOF;
        let depth = tables[info + DOF_DEPTH];
        var value = x[left - 1u];
        for (var beyond = left; beyond < tables[info + DOF_LAST]; beyond++) {
            let end = tables[tables[DOFS_AT] + beyond * DOF + DOF_END];
            value -= kept(FACTORS_AT() + end - depth) * x[beyond];
        }
        x[left - 1u] = value * kept(FACTORS_AT() + tables[info + DOF_ROW]);
    }
}

// The least regularisation (src/body/constrain.rs says why).
const SOFTEST = 1e-6;

// Stiffness and damping of a constraint, and its impedance at a distance.
fn compliance(softness: u32, distance: f32) -> vec3f {
    let time = max(real(softness), 2.0 * params.dt);
    let ratio = real(softness + 1u);
    let low = clamp(real(softness + 2u), 1e-4, 0.9999);
    let high = clamp(real(softness + 3u), 1e-4, 0.9999);
    let at = min(abs(distance) / max(real(softness + 4u), 1e-15), 1.0);
    let middle = real(softness + 5u);
    let power = real(softness + 6u);
    var rise = at;
    if (power == 2.0) {
        // The usual one, without the logarithms of pow.
        rise = select(1.0 - (1.0 - at) * (1.0 - at) / (1.0 - middle), at * at / middle, at <= middle);
    } else if (power != 1.0) {
        if (at <= middle) {
            rise = pow(at, power) / pow(middle, power - 1.0);
        } else {
            rise = 1.0 - pow(1.0 - at, power) / pow(1.0 - middle, power - 1.0);
        }
    }
    return vec3f(1.0 / (high * high * time * time * ratio * ratio), 2.0 / (high * time), low + rise * (high - low));
}

fn write(constraint: u32, field: u32, value: f32) {
    constraints[(constraint * CONSTRAINT + field) * params.envs + env] = value;
}

// Weighs the rows and writes as many as there are.
fn finish(row: u32, count: u32) {
    weigh();
    for (var k = 0u; k < count; k++) {
        for (var quad = 0u; quad < tables[QUADS]; quad++) {
            let d = 4u * quad;
            let at = (row + k) * tables[QUADS] + quad;
            rows[at * params.envs + env] = vec4f(x[d][k], x[d + 1u][k], x[d + 2u][k], x[d + 3u][k]);
        }
    }
}

// Of the three rows with each other.
fn products() -> mat3x3f {
    var sum = mat3x3f();
    for (var dof = 0u; dof < tables[DOF_COUNT]; dof++) {
        let j = x[dof];
        sum += mat3x3f(j * j.x, j * j.y, j * j.z);
    }
    return sum;
}

fn contact(slot: u32) {
    if (slot >= counts[env]) { return; }
    let pair = tables[PAIRS_AT] + keys[slot * params.envs + env] / 8u * PAIR;
    let at = slot * TOUCH;
    let point = touch3(at);
    let normal = touch3(at + TOUCH_NORMAL);
    let tangent = touch3(at + TOUCH_TANGENT);
    let distance = touches[(at + TOUCH_DISTANCE) * params.envs + env];
    let directions = mat3x3f(normal, tangent, cross(normal, tangent));
    part(tables[pair + PAIR_BODIES], tables[pair + PAIR_BODIES + 1u], point, directions);
    let soft = compliance(pair + PAIR_SOFTNESS, distance);
    let target_now = -soft.y * speeds() - vec3f(soft.x * soft.z * distance, 0.0, 0.0);
    let friction = real(pair + PAIR_FRICTION);
    let regular = (1.0 - soft.z) / soft.z * real(pair + PAIR_LOOSENESS);
    for (var k = 0u; k < 3u; k++) { write(slot, TARGET + k, target_now[k]); }
    let pyramid = 2.0 * friction * friction * (1.0 + friction * friction);
    write(slot, SOFTNESS, max(regular * select(1.0, pyramid, friction > 0.0), SOFTEST));
    write(slot, FRICTION, friction);
    finish(3u * slot, 3u);
    let block = products();
    write(slot, BLOCK, block[0][0]);
    write(slot, BLOCK + 1u, block[0][1]);
    write(slot, BLOCK + 2u, block[0][2]);
    write(slot, BLOCK + 3u, block[1][1]);
    write(slot, BLOCK + 4u, block[1][2]);
    write(slot, BLOCK + 5u, block[2][2]);
}

// A joint's limit, if it is past it, as one of the three rows.
fn limit(index: u32, k: u32) {
    let joint = tables[JOINTS_AT] + index * JOINT;
    let constraint = tables[SLOTS] + index;
    write(constraint, ACTIVE, 0.0);
    if (tables[joint + JOINT_LIMITED] == 0u) { return; }
    let low = real(joint + JOINT_RANGE);
    let high = real(joint + JOINT_RANGE + 1u);
    let where_q = tables[joint + JOINT_Q];
    let dof = tables[joint + JOINT_V];
    var distance = 0.0;
    var axis = vec3f(0.0);
    var count = 1u;
    if (tables[joint + JOINT_KIND] == BALL) {
        let rotation = rotation_vector(q_turn(where_q));
        let angle = length(rotation);
        distance = high - angle;
        axis = -rotation / angle;
        count = 3u;
    } else {
        let angle = q(where_q);
        let at_low = angle - low < high - angle;
        distance = select(high - angle, angle - low, at_low);
        axis.x = select(-1.0, 1.0, at_low);
    }
    if (distance >= 0.0) { return; }
    var speed = 0.0;
    for (var i = 0u; i < count; i++) {
        x[dof + i][k] = axis[i];
        speed += axis[i] * v(dof + i);
    }
    let soft = compliance(joint + JOINT_SOFTNESS, distance);
    let looseness = real(tables[DOFS_AT] + dof * DOF + DOF_LOOSENESS);
    write(constraint, TARGET, -soft.y * speed - soft.x * soft.z * distance);
    write(constraint, SOFTNESS, max((1.0 - soft.z) / soft.z * looseness, SOFTEST));
    write(constraint, ACTIVE, 1.0);
}

fn limits(first: u32) {
    let count = min(3u, tables[JOINT_COUNT] - first);
    for (var k = 0u; k < count; k++) { limit(first + k, k); }
    finish(3u * tables[SLOTS] + first, count);
    var squares = vec3f(0.0);
    for (var dof = 0u; dof < tables[DOF_COUNT]; dof++) { squares += x[dof] * x[dof]; }
    for (var k = 0u; k < count; k++) { write(tables[SLOTS] + first + k, BLOCK, squares[k]); }
}

@compute @workgroup_size(64)
fn make_constraints(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    if (group.y < tables[SLOTS]) { contact(group.y); } else { limits(3u * (group.y - tables[SLOTS])); }
}
