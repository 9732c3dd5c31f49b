// Contacts and joint limits as mass-qacc_whitened rows of the soft constraint problem (src/physics/constraints.rs). One
// row of workgroups a contact, then one for every three joints; one invocation an environment.
//
// model_table       see `model_table`
// state        [positions + dofs][envs]
// dynamics     see `smooth_dynamics`
// contacts     [max_contacts * 10][envs]: position, normal, tangent, distance
// contact_ids  [max_contacts][envs]: pair * 8 + point
// counts       [2][envs]: contacts, overflow
// rows         [max_contacts * 3 + joints][quads][envs], each over the degrees of freedom
// constraints  [max_contacts + joints][CONSTRAINT_DIM][envs]

#import model_table
#import state
#import contacts
#import spatial
#import dynamics
#import constraints

struct Params {
    envs: u32,
    dt: f32,
    row_groups: u32,
}

@group(0) @binding(0) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(1) var<storage, read_write> state: array<f32>;
@group(0) @binding(2) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(3) var<storage, read_write> contacts: array<f32>;
@group(0) @binding(4) var<storage, read_write> contact_ids: array<u32>;
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> rows: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> constraints: array<f32>;
@group(0) @binding(8) var<uniform> params: Params;

// Of each degree of freedom, three rows: a contact's normal and tangents, or three joints' limits.
var<private> x: array<vec3f, WORLD_DOF_BOUND>;

fn load(at: u32) -> f32 { return dynamics[at * params.envs + env]; }

// Which degrees of freedom move a body.
fn dof_mask(body: u32) -> vec3u {
    if (body == NONE) { return vec3u(0u); }
    let at = model_table[BODIES_AT] + body * BODY + BODY_DOF_MASK;
    return vec3u(model_table[at], model_table[at + 1u], model_table[at + 2u]);
}

// How the second body's point moves from the first's along three directions. All trees and degrees of
// freedom in turn, so that all invocations read the same.
fn add_point(first: u32, second: u32, point: vec3f, directions: mat3x3f) {
    let mask_of_second = dof_mask(second);
    let mask_of_first = dof_mask(first);
    for (var index = 0u; index < model_table[TREE_COUNT]; index++) {
        let tree = model_table[TREES_AT] + index * TREE;
        let arm = point - origin_of(tree);
        for (var k = 0u; k < model_table[tree + TREE_DOFS]; k++) {
            let dof = model_table[tree + TREE_DOF] + k;
            let sign = f32((mask_of_second[dof / 32u] >> (dof % 32u)) & 1u) - f32((mask_of_first[dof / 32u] >> (dof % 32u)) & 1u);
            let m = 6u * dof;
            let angular = vec3f(load(m), load(m + 1u), load(m + 2u));
            let linear = vec3f(load(m + 3u), load(m + 4u), load(m + 5u));
            x[dof] = sign * ((linear + cross(angular, arm)) * directions);
        }
    }
}

// Speeds along the rows, of the velocities that there are.
fn row_velocities() -> vec3f {
    var sum = vec3f(0.0);
    for (var dof = 0u; dof < model_table[DOF_COUNT]; dof++) { sum += x[dof] * v(dof); }
    return sum;
}

// x = L^-T x. The degrees of freedom beyond one stand right behind it.
fn solve_lt() {
    for (var left = model_table[DOF_COUNT]; left > 0u; left--) {
        let info = model_table[DOFS_AT] + (left - 1u) * DOF;
        let depth = model_table[info + DOF_DEPTH];
        var value = x[left - 1u];
        for (var beyond = left; beyond < model_table[info + DOF_LAST]; beyond++) {
            let end = model_table[model_table[DOFS_AT] + beyond * DOF + DOF_END];
            value -= load(FACTORS_AT() + end - depth) * x[beyond];
        }
        x[left - 1u] = value * load(FACTORS_AT() + model_table[info + DOF_ROW]);
    }
}

// The least regularisation (src/physics/constraints.rs says why).
const MIN_REGULARIZATION = 1e-6;

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
    constraints[(constraint * CONSTRAINT_DIM + field) * params.envs + env] = value;
}

// Weighs the rows and writes as many as there are.
fn write_rows(row: u32, count: u32) {
    solve_lt();
    for (var k = 0u; k < count; k++) {
        for (var quad = 0u; quad < model_table[QUADS]; quad++) {
            let d = 4u * quad;
            let at = (row + k) * model_table[QUADS] + quad;
            rows[at * params.envs + env] = vec4f(x[d][k], x[d + 1u][k], x[d + 2u][k], x[d + 3u][k]);
        }
    }
}

// Of the three rows with each other.
fn products() -> mat3x3f {
    var sum = mat3x3f();
    for (var dof = 0u; dof < model_table[DOF_COUNT]; dof++) {
        let j = x[dof];
        sum += mat3x3f(j * j.x, j * j.y, j * j.z);
    }
    return sum;
}

fn contact(slot: u32) {
    if (slot >= counts[env]) { return; }
    let pair = model_table[PAIRS_AT] + contact_ids[slot * params.envs + env] / 8u * PAIR;
    let at = slot * CONTACT_DIM;
    let point = contact3(at);
    let normal = contact3(at + CONTACT_NORMAL);
    let tangent = contact3(at + CONTACT_TANGENT);
    let distance = contacts[(at + CONTACT_DISTANCE) * params.envs + env];
    let directions = mat3x3f(normal, tangent, cross(normal, tangent));
    add_point(model_table[pair + PAIR_BODIES], model_table[pair + PAIR_BODIES + 1u], point, directions);
    let soft = compliance(pair + PAIR_SOLVER_PARAMS, distance);
    let target_now = -soft.y * row_velocities() - vec3f(soft.x * soft.z * distance, 0.0, 0.0);
    let friction = real(pair + PAIR_FRICTION);
    let regular = (1.0 - soft.z) / soft.z * real(pair + PAIR_INVWEIGHT0);
    for (var k = 0u; k < 3u; k++) { write(slot, TARGET + k, target_now[k]); }
    let pyramid = 2.0 * friction * friction * (1.0 + friction * friction);
    write(slot, REGULARIZATION, max(regular * select(1.0, pyramid, friction > 0.0), MIN_REGULARIZATION));
    write(slot, FRICTION, friction);
    write_rows(3u * slot, 3u);
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
    let joint = model_table[JOINTS_AT] + index * JOINT;
    let constraint = model_table[MAX_CONTACTS] + index;
    write(constraint, ACTIVE, 0.0);
    if (model_table[joint + JOINT_LIMITED] == 0u) { return; }
    let low = real(joint + JOINT_RANGE);
    let high = real(joint + JOINT_RANGE + 1u);
    let where_q = model_table[joint + JOINT_Q];
    let dof = model_table[joint + JOINT_V];
    var distance = 0.0;
    var axis = vec3f(0.0);
    var count = 1u;
    if (model_table[joint + JOINT_KIND] == BALL) {
        let rotation = rotation_vector(q_rotation(where_q));
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
    let soft = compliance(joint + JOINT_SOLVER_PARAMS, distance);
    let looseness = real(model_table[DOFS_AT] + dof * DOF + DOF_INVWEIGHT0);
    write(constraint, TARGET, -soft.y * speed - soft.x * soft.z * distance);
    write(constraint, REGULARIZATION, max((1.0 - soft.z) / soft.z * looseness, MIN_REGULARIZATION));
    write(constraint, ACTIVE, 1.0);
}

fn limits(first: u32) {
    let count = min(3u, model_table[JOINT_COUNT] - first);
    for (var k = 0u; k < count; k++) { limit(first + k, k); }
    write_rows(3u * model_table[MAX_CONTACTS] + first, count);
    var squares = vec3f(0.0);
    for (var dof = 0u; dof < model_table[DOF_COUNT]; dof++) { squares += x[dof] * x[dof]; }
    for (var k = 0u; k < count; k++) { write(model_table[MAX_CONTACTS] + first + k, BLOCK, squares[k]); }
}

@compute @workgroup_size(64)
fn make_constraints(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    if (group.y < model_table[MAX_CONTACTS]) { contact(group.y); } else { limits(3u * (group.y - model_table[MAX_CONTACTS])); }
}
