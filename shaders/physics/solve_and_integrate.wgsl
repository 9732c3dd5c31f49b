// Projected Gauss-Seidel over limits and contacts (src/body/sweep.rs) in mass-weighted coordinates, then one
// semi-implicit step forward. One invocation an environment.
//
// tables       see `tables`
// state        [positions + dofs][envs], moved on
// dynamics     see `articulate`
// rows         see `constrain`
// constraints  see `constrain`
// keys         [slots][envs]
// counts       [2][envs]
// warm         [slots * 5 + joints][envs]: of the step before, and then of this one, the contacts' keys
//              their edges' forces [slots][4], and the limits' forces, as bit casts

#import tables
#import state
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
@group(0) @binding(3) var<storage, read_write> rows: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> constraints: array<f32>;
@group(0) @binding(5) var<storage, read_write> keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> counts: array<u32>;
@group(0) @binding(7) var<storage, read_write> warm: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

// Rust refuses more.
const SLOTS_MOST = 32u;
const JOINTS_MOST = 64u;

// Mass-weighted, of the degrees of freedom.
var<private> acceleration: array<vec4f, ALL_DOFS_MOST / 4u>;
// Of the degrees of freedom themselves.
var<private> plain: array<f32, ALL_DOFS_MOST>;
var<private> forces: array<vec4f, SLOTS_MOST>;
var<private> limits: array<f32, JOINTS_MOST>;

fn field(constraint: u32, at: u32) -> f32 { return constraints[(constraint * CONSTRAINT + at) * params.envs + env]; }

// Forces of the step before of the contact that is now in this slot.
fn remembered(slot: u32) -> vec4f {
    let key = keys[slot * params.envs + env];
    for (var before = 0u; before < tables[SLOTS]; before++) {
        if (warm[before * params.envs + env] == key) {
            let at = (tables[SLOTS] + 4u * before) * params.envs + env;
            let e = params.envs;
            return bitcast<vec4f>(vec4u(warm[at], warm[at + e], warm[at + 2u * e], warm[at + 3u * e]));
        }
    }
    return vec4f(0.0);
}

// Edge forces as forces along the normal and the tangents.
fn along(friction: f32, edges: vec4f) -> vec3f {
    if (friction <= 0.0) { return vec3f(edges.x, 0.0, 0.0); }
    return vec3f(edges.x + edges.y + edges.z + edges.w, friction * (edges.x - edges.y), friction * (edges.z - edges.w));
}

fn push(row: u32, force: f32) {
    let at = row * tables[QUADS];
    for (var quad = 0u; quad < tables[QUADS]; quad++) {
        acceleration[quad] += force * rows[(at + quad) * params.envs + env];
    }
}

fn pushes(row: u32, force: vec3f) {
    let at = row * tables[QUADS];
    for (var quad = 0u; quad < tables[QUADS]; quad++) {
        let n = rows[(at + quad) * params.envs + env];
        let t = rows[(at + tables[QUADS] + quad) * params.envs + env];
        let s = rows[(at + 2u * tables[QUADS] + quad) * params.envs + env];
        acceleration[quad] += force.x * n + force.y * t + force.z * s;
    }
}

fn accelerated(row: u32) -> f32 {
    var sum = 0.0;
    for (var quad = 0u; quad < tables[QUADS]; quad++) {
        sum += dot(rows[(row * tables[QUADS] + quad) * params.envs + env], acceleration[quad]);
    }
    return sum;
}

fn accelerations(row: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var quad = 0u; quad < tables[QUADS]; quad++) {
        let a = acceleration[quad];
        let n = rows[(row * tables[QUADS] + quad) * params.envs + env];
        let t = rows[((row + 1u) * tables[QUADS] + quad) * params.envs + env];
        let s = rows[((row + 2u) * tables[QUADS] + quad) * params.envs + env];
        sum += vec3f(dot(n, a), dot(t, a), dot(s, a));
    }
    return sum;
}

fn relax_limit(joint: u32) {
    let constraint = tables[SLOTS] + joint;
    if (field(constraint, ACTIVE) == 0.0) { return; }
    let row = 3u * tables[SLOTS] + joint;
    let soft = field(constraint, SOFTNESS);
    let before = limits[joint];
    let lack = field(constraint, TARGET) - accelerated(row);
    let after = max(before + (lack - soft * before) / (field(constraint, BLOCK) + soft), 0.0);
    limits[joint] = after;
    if (after != before) { push(row, after - before); }
}

fn relax_contact(slot: u32) {
    let friction = field(slot, FRICTION);
    let soft = field(slot, SOFTNESS);
    let wanted = vec3f(field(slot, TARGET), field(slot, TARGET + 1u), field(slot, TARGET + 2u));
    let nn = field(slot, BLOCK);
    let nt = field(slot, BLOCK + 1u);
    let ns = field(slot, BLOCK + 2u);
    let tt = field(slot, BLOCK + 3u);
    let ts = field(slot, BLOCK + 4u);
    let ss = field(slot, BLOCK + 5u);
    var now = accelerations(3u * slot);
    var change = vec3f(0.0);
    var edges = forces[slot];
    let count = select(1u, 4u, friction > 0.0);
    for (var edge = 0u; edge < count; edge++) {
        let slope = select(friction, -friction, edge % 2u == 1u);
        let second = edge >= 2u;
        let tangent = select(vec3f(nt, tt, ts), vec3f(ns, ts, ss), second);
        let own_tangent = select(tt, ss, second);
        let off = select(nt, ns, second);
        let lack_n = wanted.x - now.x;
        let lack_t = select(wanted.y - now.y, wanted.z - now.z, second);
        let own = nn + 2.0 * slope * off + slope * slope * own_tangent + soft;
        let before = edges[edge];
        let after = max(before + (lack_n + slope * lack_t - soft * before) / own, 0.0);
        edges[edge] = after;
        let more = after - before;
        now += more * (vec3f(nn, nt, ns) + slope * tangent);
        change += more * vec3f(1.0, select(slope, 0.0, second), select(0.0, slope, second));
    }
    forces[slot] = edges;
    if (any(change != vec3f(0.0))) { pushes(3u * slot, change); }
}

// Turns a quaternion of the state, w first, by an angular velocity in its own frame.
fn turn(at: u32, dof: u32) {
    let spin = vec3f(v(dof), v(dof + 1u), v(dof + 2u)) * params.dt;
    let before = vec4f(q(at + 1u), q(at + 2u), q(at + 3u), q(at));
    let after = normalize(turned(before, from_rotation(spin)));
    state[at * params.envs + env] = after.w;
    for (var k = 0u; k < 3u; k++) { state[(at + 1u + k) * params.envs + env] = after[k]; }
}

// L^-1 of the mass-weighted acceleration.
fn unweigh() {
    for (var dof = 0u; dof < tables[DOF_COUNT]; dof++) {
        let info = tables[DOFS_AT] + dof * DOF;
        let row = tables[info + DOF_ROW];
        var value = acceleration[dof / 4u][dof % 4u];
        for (var k = 1u; k < tables[info + DOF_DEPTH]; k++) {
            value -= dynamics[(FACTORS_AT() + row + k) * params.envs + env] * plain[tables[tables[COLUMNS_AT] + row + k]];
        }
        plain[dof] = value * dynamics[(FACTORS_AT() + row) * params.envs + env];
    }
}

fn integrate() {
    for (var dof = 0u; dof < tables[DOF_COUNT]; dof++) {
        state[(tables[POSITIONS] + dof) * params.envs + env] += params.dt * plain[dof];
    }
    for (var index = 0u; index < tables[JOINT_COUNT]; index++) {
        let joint = tables[JOINTS_AT] + index * JOINT;
        let kind = tables[joint + JOINT_KIND];
        let at = tables[joint + JOINT_Q];
        let dof = tables[joint + JOINT_V];
        let straight = select(select(0u, 3u, kind == FREE), 1u, kind == HINGE);
        for (var k = 0u; k < straight; k++) { state[(at + k) * params.envs + env] += params.dt * v(dof + k); }
        if (kind != HINGE) { turn(at + straight, dof + straight); }
    }
}

@compute @workgroup_size(64)
fn solve_and_integrate(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let contacts = counts[env];
    let joints = tables[JOINT_COUNT];
    for (var dof = 0u; dof < tables[DOF_COUNT]; dof++) {
        acceleration[dof / 4u][dof % 4u] = dynamics[(WEIGHTED_AT() + dof) * params.envs + env];
    }
    let limits_at = 5u * tables[SLOTS];
    for (var joint = 0u; joint < joints; joint++) {
        limits[joint] = 0.0;
        if (field(tables[SLOTS] + joint, ACTIVE) == 0.0) { continue; }
        limits[joint] = bitcast<f32>(warm[(limits_at + joint) * params.envs + env]);
        push(3u * tables[SLOTS] + joint, limits[joint]);
    }
    for (var slot = 0u; slot < contacts; slot++) {
        forces[slot] = remembered(slot);
        pushes(3u * slot, along(field(slot, FRICTION), forces[slot]));
    }
    for (var round = 0u; round < tables[SWEEPS]; round++) {
        for (var joint = 0u; joint < joints; joint++) { relax_limit(joint); }
        for (var slot = 0u; slot < contacts; slot++) { relax_contact(slot); }
    }
    unweigh();
    integrate();
    for (var slot = 0u; slot < tables[SLOTS]; slot++) {
        let used = slot < contacts;
        warm[slot * params.envs + env] = select(NONE, keys[slot * params.envs + env], used);
        for (var edge = 0u; edge < 4u; edge++) {
            warm[(tables[SLOTS] + 4u * slot + edge) * params.envs + env] = bitcast<u32>(select(0.0, forces[slot][edge], used));
        }
    }
    for (var joint = 0u; joint < joints; joint++) {
        warm[(limits_at + joint) * params.envs + env] = bitcast<u32>(limits[joint]);
    }
}
