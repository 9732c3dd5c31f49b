// Poses, velocities, mass matrix and unconstrained acceleration of articulated bodies, their drives and
// what pushes them included. One row of workgroups a tree, one invocation an environment: what is of the
// tree is then the same for all invocations of a group, which software adapters read once.
//
// tables    see `tables`
// state     [positions + dofs][envs], q then v
// targets   [driven][envs], of the drives, rad
// pushes    [bodies * 6][envs], torque and force at the centres of mass
// poses     [bodies * 7][envs], place and quaternion x y z w, in the world
// dynamics  [..][envs]: axes [dofs * 6], factor of the mass matrix with armature and what is implicit in the
//           drives [packed], mass-weighted smooth acceleration [dofs], velocities [bodies * 6]; spatial
//           vectors about a tree's origin
//
// What is read often on the way is private: software adapters read that many times faster than a buffer, but
// compile the longer the more of it there is.

#import tables
#import state
#import spatial
#import dynamics

const GRAVITY = 9.81; // m/s^2

struct Params {
    envs: u32,
    dt: f32,
}

@group(0) @binding(0) var<storage, read_write> tables: array<u32>;
@group(0) @binding(1) var<storage, read_write> state: array<f32>;
@group(0) @binding(2) var<storage, read_write> targets: array<f32>;
@group(0) @binding(3) var<storage, read_write> pushes: array<f32>;
@group(0) @binding(4) var<storage, read_write> poses: array<f32>;
@group(0) @binding(5) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

// Of a tree; Rust refuses more.
const BODIES_MOST = 24u;
const DOFS_MOST = 48u;
const PACKED_MOST = 512u;

// Of the tree's bodies, counted from its first.
// Accelerations on the way out, forces on the way in.
var<private> forces: array<Spatial, BODIES_MOST>;
var<private> inertias: array<Inertia, BODIES_MOST>;
// Of the tree's degrees of freedom, counted from its first.
var<private> axes: array<Spatial, DOFS_MOST>;
var<private> efforts: array<Effort, DOFS_MOST>;
var<private> bias: array<f32, DOFS_MOST>;
var<private> acceleration: array<f32, DOFS_MOST>;
var<private> weighted: array<f32, DOFS_MOST>;
// Packed, counted from the tree's first entry.
var<private> factors: array<f32, PACKED_MOST>;

struct Pose {
    place: vec3f,
    turn: vec4f,
}

// Of a drive: force, and armature of its implicit part (src/body/drive.rs).
struct Effort {
    force: f32,
    armature: f32,
}

struct Tree {
    body: u32,
    bodies: u32,
    dof: u32,
    dofs: u32,
    packed: u32,
    origin: vec3f,
}

fn kept(at: u32) -> f32 { return dynamics[at * params.envs + env]; }
fn keep(at: u32, value: f32) { dynamics[at * params.envs + env] = value; }

fn velocity_of(body: u32) -> Spatial {
    let at = VELOCITIES_AT() + 6u * body;
    return Spatial(vec3f(kept(at), kept(at + 1u), kept(at + 2u)), vec3f(kept(at + 3u), kept(at + 4u), kept(at + 5u)));
}

fn keep_spatial(at: u32, value: Spatial) {
    for (var k = 0u; k < 3u; k++) {
        keep(at + k, value.angular[k]);
        keep(at + 3u + k, value.linear[k]);
    }
}

fn pose_of(body: u32) -> Pose {
    let at = body * 7u * params.envs + env;
    let e = params.envs;
    return Pose(
        vec3f(poses[at], poses[at + e], poses[at + 2u * e]),
        vec4f(poses[at + 3u * e], poses[at + 4u * e], poses[at + 5u * e], poses[at + 6u * e]),
    );
}

fn keep_pose(body: u32, pose: Pose) {
    for (var k = 0u; k < 3u; k++) { poses[(body * 7u + k) * params.envs + env] = pose.place[k]; }
    for (var k = 0u; k < 4u; k++) { poses[(body * 7u + 3u + k) * params.envs + env] = pose.turn[k]; }
}

// Where a body is, how it moves and would accelerate unforced; the motions of its degrees of freedom, and
// what its drives do.
fn outward(tree: Tree, local: u32) {
    let at = tables[BODIES_AT] + (tree.body + local) * BODY;
    var pose = Pose(real3(at + BODY_PLACE), real4(at + BODY_TURN));
    var velocity = Spatial(vec3f(0.0), vec3f(0.0));
    var now = Spatial(vec3f(0.0), vec3f(0.0, 0.0, GRAVITY));
    let parent = tables[at + BODY_PARENT];
    if (parent != NONE) {
        let outer = pose_of(parent);
        pose = Pose(outer.place + rotate(outer.turn, pose.place), turned(outer.turn, pose.turn));
        velocity = velocity_of(parent);
        now = forces[parent - tree.body];
    }
    let joints = tables[at + BODY_JOINTS];
    for (var j = 0u; j < joints; j++) {
        let joint = tables[JOINTS_AT] + (tables[at + BODY_JOINT] + j) * JOINT;
        let kind = tables[joint + JOINT_KIND];
        let place = real3(joint + JOINT_PLACE);
        let where_q = tables[joint + JOINT_Q];
        let dof = tables[joint + JOINT_V];
        let anchor = pose.place + rotate(pose.turn, place) - tree.origin;
        let shifts = select(0u, 3u, kind == FREE);
        for (var k = 0u; k < shifts; k++) {
            var along = vec3f(0.0);
            along[k] = 1.0;
            let motion = Spatial(vec3f(0.0), along);
            axes[dof + k - tree.dof] = motion;
            efforts[dof + k - tree.dof] = Effort(0.0, 0.0);
            velocity = add(velocity, scaled(motion, v(dof + k)));
        }
        // Of a drive: the angle, or the parts of the rotation vector.
        var angles = vec3f(0.0);
        var turn = vec4f(0.0);
        if (kind == HINGE) {
            angles = vec3f(q(where_q));
            turn = from_rotation(real3(joint + JOINT_AXIS) * angles.x);
        } else {
            turn = q_turn(where_q + shifts);
            angles = rotation_vector(turn);
        }
        if (kind == FREE) {
            pose = Pose(q3(where_q), turn);
        } else {
            let after = turned(pose.turn, turn);
            pose = Pose(pose.place + rotate(pose.turn, place) - rotate(after, place), after);
        }
        let count = select(3u, 1u, kind == HINGE);
        let arm = select(anchor, vec3f(0.0), kind == FREE);
        let before = velocity;
        for (var k = 0u; k < count; k++) {
            var own = vec3f(0.0);
            own[k] = 1.0;
            if (kind == HINGE) { own = real3(joint + JOINT_AXIS); }
            let axis = rotate(pose.turn, own);
            let motion = Spatial(axis, cross(arm, axis));
            let turning = dof + shifts + k;
            let speed = v(turning);
            axes[turning - tree.dof] = motion;
            efforts[turning - tree.dof] = effort(turning, angles[k], speed);
            now = add(now, scaled(cross_motion(before, motion), speed));
            velocity = add(velocity, scaled(motion, speed));
        }
    }
    pose.turn = normalize(pose.turn);
    keep_pose(tree.body + local, pose);
    keep_spatial(VELOCITIES_AT() + 6u * (tree.body + local), velocity);
    forces[local] = now;
    inertias[local] = inertia_of(at, pose, tree.origin);
}

fn inertia_of(at: u32, pose: Pose, origin: vec3f) -> Inertia {
    let mass = real(at + BODY_MASS);
    let c = pose.place + rotate(pose.turn, real3(at + BODY_CENTRE)) - origin;
    let d = real3(at + BODY_INERTIA);
    let m = real3(at + BODY_INERTIA + 3u);
    let x = rotate(pose.turn, vec3f(1.0, 0.0, 0.0));
    let y = rotate(pose.turn, vec3f(0.0, 1.0, 0.0));
    let z = rotate(pose.turn, vec3f(0.0, 0.0, 1.0));
    // The columns of R I.
    let i = mat3x3f(
        x * d.x + y * m.x + z * m.y,
        x * m.x + y * d.y + z * m.z,
        x * m.y + y * m.z + z * d.z,
    );
    let world = i * transpose(mat3x3f(x, y, z));
    let diagonal = vec3f(world[0].x, world[1].y, world[2].z) + mass * (vec3f(dot(c, c)) - c * c);
    let mixed = vec3f(world[1].x, world[2].x, world[2].y) - mass * vec3f(c.x * c.y, c.x * c.z, c.y * c.z);
    return Inertia(mass, mass * c, diagonal, mixed);
}

fn effort(dof: u32, angle: f32, speed: f32) -> Effort {
    let info = tables[DOFS_AT] + dof * DOF;
    let target_at = tables[info + DOF_TARGET];
    if (target_at == NONE) { return Effort(0.0, 0.0); }
    let stiffness = real(info + DOF_STIFFNESS);
    let damping = real(info + DOF_DAMPING);
    let wanted = targets[target_at * params.envs + env];
    return Effort(
        stiffness * (wanted - angle - params.dt * speed) - damping * speed,
        params.dt * damping + params.dt * params.dt * stiffness,
    );
}

// The force that a body's motion and weight ask for, less what pushes it.
fn burden(tree: Tree, local: u32) {
    let own = inertias[local];
    let velocity = velocity_of(tree.body + local);
    let moving = cross_force(velocity, momentum(own, velocity));
    let pushed = 6u * (tree.body + local);
    let torque = push3(pushed);
    let force = push3(pushed + 3u);
    let pose = pose_of(tree.body + local);
    let centre = real3(tables[BODIES_AT] + (tree.body + local) * BODY + BODY_CENTRE);
    let arm = pose.place + rotate(pose.turn, centre) - tree.origin;
    let push = Spatial(-torque - cross(arm, force), -force);
    forces[local] = add(add(momentum(own, forces[local]), moving), push);
}

fn push3(at: u32) -> vec3f {
    let e = params.envs;
    let place = at * e + env;
    return vec3f(pushes[place], pushes[place + e], pushes[place + 2u * e]);
}

// Bias forces, and what the parent carries.
fn inward(tree: Tree, local: u32) {
    let at = tables[BODIES_AT] + (tree.body + local) * BODY;
    for (var k = 0u; k < tables[at + BODY_DOFS]; k++) {
        let dof = tables[at + BODY_DOF] + k - tree.dof;
        bias[dof] = product(axes[dof], forces[local]);
    }
    let parent = tables[at + BODY_PARENT];
    if (parent != NONE) {
        let up = parent - tree.body;
        forces[up] = add(forces[up], forces[local]);
        let mine = inertias[local];
        let theirs = inertias[up];
        inertias[up] = Inertia(
            theirs.mass + mine.mass,
            theirs.moment + mine.moment,
            theirs.diagonal + mine.diagonal,
            theirs.mixed + mine.mixed,
        );
    }
}

// M = L^T L of this tree, and L^-T (efforts - bias). An entry of a degree of freedom's row is what M has
// there, less what all those beyond it have in common; they stand right behind it.
fn factorise(tree: Tree) {
    for (var left = tree.dofs; left > 0u; left--) {
        let own = left - 1u;
        let info = tables[DOFS_AT] + (tree.dof + own) * DOF;
        let body = tables[info + DOF_BODY] - tree.body;
        let moved = momentum(inertias[body], axes[own]);
        let row = tables[info + DOF_ROW];
        let depth = tables[info + DOF_DEPTH];
        let last = tables[info + DOF_LAST] - tree.dof;
        var inverse = 1.0;
        for (var k = 0u; k < depth; k++) {
            var entry = product(moved, axes[tables[tables[COLUMNS_AT] + row + k] - tree.dof]);
            if (k == 0u) { entry += real(info + DOF_ARMATURE) + efforts[own].armature; }
            for (var beyond = left; beyond < last; beyond++) {
                let at = above(tree, beyond, depth);
                entry -= factors[at] * factors[at + k];
            }
            if (k == 0u) { inverse = 1.0 / sqrt(entry); }
            factors[row + k - tree.packed] = select(entry, 1.0, k == 0u) * inverse;
        }
        var value = efforts[own].force - bias[own];
        for (var beyond = left; beyond < last; beyond++) {
            value -= factors[above(tree, beyond, depth)] * weighted[beyond];
        }
        weighted[own] = value * inverse;
    }
}

// Where a degree of freedom's row has the one of the given depth on its way to the root.
fn above(tree: Tree, dof: u32, depth: u32) -> u32 {
    return tables[tables[DOFS_AT] + (tree.dof + dof) * DOF + DOF_END] - tree.packed - depth;
}

// L^-1 of the mass-weighted acceleration.
fn unweigh(tree: Tree) {
    for (var own = 0u; own < tree.dofs; own++) {
        let info = tables[DOFS_AT] + (tree.dof + own) * DOF;
        let row = tables[info + DOF_ROW];
        var value = weighted[own];
        for (var k = 1u; k < tables[info + DOF_DEPTH]; k++) {
            value -= factors[row + k - tree.packed] * acceleration[tables[tables[COLUMNS_AT] + row + k] - tree.dof];
        }
        acceleration[own] = value * factors[row - tree.packed];
    }
}

// Drives that would pass their limit push with just that limit.
fn limit_drives(tree: Tree) -> bool {
    var any_over = false;
    for (var own = 0u; own < tree.dofs; own++) {
        let info = tables[DOFS_AT] + (tree.dof + own) * DOF;
        if (tables[info + DOF_TARGET] == NONE) { continue; }
        let torque = efforts[own].force - efforts[own].armature * acceleration[own];
        let most = real(info + DOF_LIMIT);
        if (abs(torque) > most) {
            efforts[own] = Effort(select(-most, most, torque > 0.0), 0.0);
            any_over = true;
        }
    }
    return any_over;
}

fn tree_of(index: u32) -> Tree {
    let at = tables[TREES_AT] + index * TREE;
    let body = tables[at + TREE_BODY];
    let dof = tables[at + TREE_DOF];
    let packed = tables[tables[DOFS_AT] + dof * DOF + DOF_ROW];
    return Tree(body, tables[at + TREE_BODIES], dof, tables[at + TREE_DOFS], packed, origin_of(at));
}

@compute @workgroup_size(64)
fn smooth_dynamics(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let tree = tree_of(group.y);
    for (var local = 0u; local < tree.bodies; local++) {
        outward(tree, local);
    }
    for (var local = 0u; local < tree.bodies; local++) { burden(tree, local); }
    for (var left = tree.bodies; left > 0u; left--) { inward(tree, left - 1u); }
    // Twice only where a drive is at its limit.
    for (var round = 0u; round < 2u; round++) {
        factorise(tree);
        unweigh(tree);
        if (round == 1u || !limit_drives(tree)) { break; }
    }
    for (var own = 0u; own < tree.dofs; own++) {
        let dof = tree.dof + own;
        let row = tables[tables[DOFS_AT] + dof * DOF + DOF_ROW];
        keep_spatial(6u * dof, axes[own]);
        keep(WEIGHTED_AT() + dof, weighted[own]);
        for (var k = 0u; k < tables[tables[DOFS_AT] + dof * DOF + DOF_DEPTH]; k++) {
            keep(FACTORS_AT() + row + k, factors[row + k - tree.packed]);
        }
    }
}
