// Projected Gauss-Seidel over limits and contacts (src/physics/pgs.rs) in mass-qacc_whitened coordinates, then one
// semi-implicit step forward. One invocation an environment.
//
// model_table       see `model_table`
// state        [positions + dofs][envs], moved on
// dynamics     see `smooth_dynamics`
// rows         see `make_constraints`
// constraints  see `make_constraints`
// contact_ids  [max_contacts][envs]
// counts       [2][envs]
// warm_start   [max_contacts * 5 + joints][envs]: of the step before, and then of this one, the contacts' contact_ids
//              their edges' forces [max_contacts][4], and the limits' forces, as bit casts

#import model_table
#import state
#import spatial
#import dynamics
#import constraints

struct Params {
    envs: u32,
    dt: f32,
}

@group(0) @binding(0) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(1) var<storage, read_write> state: array<f32>;
@group(0) @binding(2) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(3) var<storage, read_write> rows: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> constraints: array<f32>;
@group(0) @binding(5) var<storage, read_write> contact_ids: array<u32>;
@group(0) @binding(6) var<storage, read_write> counts: array<u32>;
@group(0) @binding(7) var<storage, read_write> warm_start: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

// Rust refuses more.
const CONTACT_BOUND = 32u;
const JOINT_BOUND = 64u;

// Mass-qacc_whitened, of the degrees of freedom.
var<private> qacc_whitened: array<vec4f, WORLD_DOF_BOUND / 4u>;
// Of the degrees of freedom themselves.
var<private> qacc: array<f32, WORLD_DOF_BOUND>;
var<private> forces: array<vec4f, CONTACT_BOUND>;
var<private> limits: array<f32, JOINT_BOUND>;

fn field(constraint: u32, at: u32) -> f32 { return constraints[(constraint * CONSTRAINT_DIM + at) * params.envs + env]; }

// Forces of the step before of the contact that is row_acc in this slot.
fn warm_start_forces(slot: u32) -> vec4f {
    let id = contact_ids[slot * params.envs + env];
    for (var before = 0u; before < model_table[MAX_CONTACTS]; before++) {
        if (warm_start[before * params.envs + env] == id) {
            let at = (model_table[MAX_CONTACTS] + 4u * before) * params.envs + env;
            let e = params.envs;
            return bitcast<vec4f>(vec4u(warm_start[at], warm_start[at + e], warm_start[at + 2u * e], warm_start[at + 3u * e]));
        }
    }
    return vec4f(0.0);
}

// Edge forces as forces along the normal and the tangents.
fn pyramid_force(friction: f32, edges: vec4f) -> vec3f {
    if (friction <= 0.0) { return vec3f(edges.x, 0.0, 0.0); }
    return vec3f(edges.x + edges.y + edges.z + edges.w, friction * (edges.x - edges.y), friction * (edges.z - edges.w));
}

fn apply_force(row: u32, force: f32) {
    let at = row * model_table[QUADS];
    for (var quad = 0u; quad < model_table[QUADS]; quad++) {
        qacc_whitened[quad] += force * rows[(at + quad) * params.envs + env];
    }
}

fn apply_forces(row: u32, force: vec3f) {
    let at = row * model_table[QUADS];
    for (var quad = 0u; quad < model_table[QUADS]; quad++) {
        let n = rows[(at + quad) * params.envs + env];
        let t = rows[(at + model_table[QUADS] + quad) * params.envs + env];
        let s = rows[(at + 2u * model_table[QUADS] + quad) * params.envs + env];
        qacc_whitened[quad] += force.x * n + force.y * t + force.z * s;
    }
}

fn row_acceleration(row: u32) -> f32 {
    var sum = 0.0;
    for (var quad = 0u; quad < model_table[QUADS]; quad++) {
        sum += dot(rows[(row * model_table[QUADS] + quad) * params.envs + env], qacc_whitened[quad]);
    }
    return sum;
}

fn row_accelerations(row: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var quad = 0u; quad < model_table[QUADS]; quad++) {
        let a = qacc_whitened[quad];
        let n = rows[(row * model_table[QUADS] + quad) * params.envs + env];
        let t = rows[((row + 1u) * model_table[QUADS] + quad) * params.envs + env];
        let s = rows[((row + 2u) * model_table[QUADS] + quad) * params.envs + env];
        sum += vec3f(dot(n, a), dot(t, a), dot(s, a));
    }
    return sum;
}

fn solve_limit(joint: u32) {
    let constraint = model_table[MAX_CONTACTS] + joint;
    if (field(constraint, ACTIVE) == 0.0) { return; }
    let row = 3u * model_table[MAX_CONTACTS] + joint;
    let soft = field(constraint, REGULARIZATION);
    let before = limits[joint];
    let residual = field(constraint, TARGET) - row_acceleration(row);
    let after = max(before + (residual - soft * before) / (field(constraint, BLOCK) + soft), 0.0);
    limits[joint] = after;
    if (after != before) { apply_force(row, after - before); }
}

fn solve_contact(slot: u32) {
    let friction = field(slot, FRICTION);
    let soft = field(slot, REGULARIZATION);
    let target_acc = vec3f(field(slot, TARGET), field(slot, TARGET + 1u), field(slot, TARGET + 2u));
    let nn = field(slot, BLOCK);
    let nt = field(slot, BLOCK + 1u);
    let ns = field(slot, BLOCK + 2u);
    let tt = field(slot, BLOCK + 3u);
    let ts = field(slot, BLOCK + 4u);
    let ss = field(slot, BLOCK + 5u);
    var row_acc = row_accelerations(3u * slot);
    var change = vec3f(0.0);
    var edges = forces[slot];
    let count = select(1u, 4u, friction > 0.0);
    for (var edge = 0u; edge < count; edge++) {
        let slope = select(friction, -friction, edge % 2u == 1u);
        let second = edge >= 2u;
        let tangent = select(vec3f(nt, tt, ts), vec3f(ns, ts, ss), second);
        let own_tangent = select(tt, ss, second);
        let off = select(nt, ns, second);
        let residual_n = target_acc.x - row_acc.x;
        let residual_t = select(target_acc.y - row_acc.y, target_acc.z - row_acc.z, second);
        let diag = nn + 2.0 * slope * off + slope * slope * own_tangent + soft;
        let before = edges[edge];
        let after = max(before + (residual_n + slope * residual_t - soft * before) / diag, 0.0);
        edges[edge] = after;
        let more = after - before;
        row_acc += more * (vec3f(nn, nt, ns) + slope * tangent);
        change += more * vec3f(1.0, select(slope, 0.0, second), select(0.0, slope, second));
    }
    forces[slot] = edges;
    if (any(change != vec3f(0.0))) { apply_forces(3u * slot, change); }
}

// Turns a quaternion of the state, w first, by an angular velocity in its diag frame.
fn integrate_rotation(at: u32, dof: u32) {
    let spin = vec3f(v(dof), v(dof + 1u), v(dof + 2u)) * params.dt;
    let before = vec4f(q(at + 1u), q(at + 2u), q(at + 3u), q(at));
    let after = normalize(quat_mul(before, from_rotation(spin)));
    state[at * params.envs + env] = after.w;
    for (var k = 0u; k < 3u; k++) { state[(at + 1u + k) * params.envs + env] = after[k]; }
}

// L^-1 of the mass-qacc_whitened qacc_whitened.
fn solve_l() {
    for (var dof = 0u; dof < model_table[DOF_COUNT]; dof++) {
        let info = model_table[DOFS_AT] + dof * DOF;
        let row = model_table[info + DOF_ROW];
        var value = qacc_whitened[dof / 4u][dof % 4u];
        for (var k = 1u; k < model_table[info + DOF_DEPTH]; k++) {
            value -= dynamics[(FACTORS_AT() + row + k) * params.envs + env] * qacc[model_table[model_table[COLUMNS_AT] + row + k]];
        }
        qacc[dof] = value * dynamics[(FACTORS_AT() + row) * params.envs + env];
    }
}

fn integrate() {
    for (var dof = 0u; dof < model_table[DOF_COUNT]; dof++) {
        state[(model_table[NQ] + dof) * params.envs + env] += params.dt * qacc[dof];
    }
    for (var index = 0u; index < model_table[JOINT_COUNT]; index++) {
        let joint = model_table[JOINTS_AT] + index * JOINT;
        let kind = model_table[joint + JOINT_KIND];
        let at = model_table[joint + JOINT_Q];
        let dof = model_table[joint + JOINT_V];
        let straight = select(select(0u, 3u, kind == FREE), 1u, kind == HINGE);
        for (var k = 0u; k < straight; k++) { state[(at + k) * params.envs + env] += params.dt * v(dof + k); }
        if (kind != HINGE) { integrate_rotation(at + straight, dof + straight); }
    }
}

@compute @workgroup_size(64)
fn solve_and_integrate(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let contacts = counts[env];
    let joints = model_table[JOINT_COUNT];
    for (var dof = 0u; dof < model_table[DOF_COUNT]; dof++) {
        qacc_whitened[dof / 4u][dof % 4u] = dynamics[(QACC_WHITENED_AT() + dof) * params.envs + env];
    }
    let limits_at = 5u * model_table[MAX_CONTACTS];
    for (var joint = 0u; joint < joints; joint++) {
        limits[joint] = 0.0;
        if (field(model_table[MAX_CONTACTS] + joint, ACTIVE) == 0.0) { continue; }
        limits[joint] = bitcast<f32>(warm_start[(limits_at + joint) * params.envs + env]);
        apply_force(3u * model_table[MAX_CONTACTS] + joint, limits[joint]);
    }
    for (var slot = 0u; slot < contacts; slot++) {
        forces[slot] = warm_start_forces(slot);
        apply_forces(3u * slot, pyramid_force(field(slot, FRICTION), forces[slot]));
    }
    for (var round = 0u; round < model_table[ITERATIONS]; round++) {
        for (var joint = 0u; joint < joints; joint++) { solve_limit(joint); }
        for (var slot = 0u; slot < contacts; slot++) { solve_contact(slot); }
    }
    solve_l();
    integrate();
    for (var slot = 0u; slot < model_table[MAX_CONTACTS]; slot++) {
        let used = slot < contacts;
        warm_start[slot * params.envs + env] = select(NONE, contact_ids[slot * params.envs + env], used);
        for (var edge = 0u; edge < 4u; edge++) {
            warm_start[(model_table[MAX_CONTACTS] + 4u * slot + edge) * params.envs + env] = bitcast<u32>(select(0.0, forces[slot][edge], used));
        }
    }
    for (var joint = 0u; joint < joints; joint++) {
        warm_start[(limits_at + joint) * params.envs + env] = bitcast<u32>(limits[joint]);
    }
}
