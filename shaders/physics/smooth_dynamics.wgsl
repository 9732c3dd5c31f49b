// Poses, velocities, mass matrix and unconstrained acceleration of articulated bodies, their drives and
// what external_forces them included. One row of workgroups a tree, one invocation an environment: what is of the
// tree is then the same for all invocations of a group, which software adapters read once.
//
// model_table    see `model_table`
// state            [positions + dofs][envs], q then v
// targets          [driven][envs], of the drives, rad or, of motors, controls
// external_forces  [bodies * 6][envs], torque and force at the centres of mass
// poses            [bodies * 7][envs], place and quaternion x y z w, in the world
// dynamics         [..][envs]: axes [dofs * 6], factor of the mass matrix with armature and what is implicit in the
//           drives [packed], mass-qacc_whitened smooth acceleration [dofs], velocities [bodies * 6]; spatial
//           vectors about a tree's origin
//
// What is read often on the way is private: software adapters read that many times faster than a buffer, but
// compile the longer the more of it there is.

#import model_table
#import state
#import spatial
#import dynamics

const GRAVITY = 9.81; // m/s^2

struct Params {
    envs: u32,
    dt: f32,
    trees: u32,
    kinematics_only: u32, // 1: poses and velocities alone
}

@group(0) @binding(0) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(1) var<storage, read_write> state: array<f32>;
@group(0) @binding(2) var<storage, read_write> targets: array<f32>;
@group(0) @binding(3) var<storage, read_write> external_forces: array<f32>;
@group(0) @binding(4) var<storage, read_write> poses: array<f32>;
@group(0) @binding(5) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

// Of a tree; Rust refuses more.
const BODY_BOUND = 24u;
const DOF_BOUND = 48u;
const NM_BOUND = 512u;

// Of the tree's bodies, counted from its first.
// Accelerations on the way out, forces on the way in.
var<private> forces: array<Spatial, BODY_BOUND>;
var<private> inertias: array<Inertia, BODY_BOUND>;
// Of the tree's degrees of freedom, counted from its first.
var<private> axes: array<Spatial, DOF_BOUND>;
var<private> efforts: array<Effort, DOF_BOUND>;
var<private> bias: array<f32, DOF_BOUND>;
var<private> acceleration: array<f32, DOF_BOUND>;
var<private> qacc_whitened: array<f32, DOF_BOUND>;
// Packed, counted from the tree's first entry.
var<private> factors: array<f32, NM_BOUND>;

struct Pose {
    position: vec3f,
    rotation: vec4f,
}

// Of a drive or spring: force, and armature of its implicit part (src/physics/drive.rs).
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

fn load(at: u32) -> f32 { return dynamics[at * params.envs + env]; }
fn store(at: u32, value: f32) { dynamics[at * params.envs + env] = value; }

fn velocity_of(body: u32) -> Spatial {
    let at = VELOCITIES_AT() + 6u * body;
    return Spatial(vec3f(load(at), load(at + 1u), load(at + 2u)), vec3f(load(at + 3u), load(at + 4u), load(at + 5u)));
}

fn store_spatial(at: u32, value: Spatial) {
    for (var k = 0u; k < 3u; k++) {
        store(at + k, value.angular[k]);
        store(at + 3u + k, value.linear[k]);
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

fn store_pose(body: u32, pose: Pose) {
    for (var k = 0u; k < 3u; k++) { poses[(body * 7u + k) * params.envs + env] = pose.position[k]; }
    for (var k = 0u; k < 4u; k++) { poses[(body * 7u + 3u + k) * params.envs + env] = pose.rotation[k]; }
}

// Where a body is, how it moves and would accelerate unforced; the motions of its degrees of freedom, and
// what its drives do.
fn forward_pass(tree: Tree, local: u32) {
    let at = model_table[BODIES_AT] + (tree.body + local) * BODY;
    var pose = Pose(real3(at + BODY_POSITION), real4(at + BODY_ROTATION));
    var velocity = Spatial(vec3f(0.0), vec3f(0.0));
    var now = Spatial(vec3f(0.0), vec3f(0.0, 0.0, GRAVITY));
    let parent = model_table[at + BODY_PARENT];
    if (parent != NONE) {
        let outer = pose_of(parent);
        pose = Pose(outer.position + rotate(outer.rotation, pose.position), quat_mul(outer.rotation, pose.rotation));
        velocity = velocity_of(parent);
        now = forces[parent - tree.body];
    }
    let joints = model_table[at + BODY_JOINTS];
    for (var j = 0u; j < joints; j++) {
        let joint = model_table[JOINTS_AT] + (model_table[at + BODY_JOINT] + j) * JOINT;
        let kind = model_table[joint + JOINT_KIND];
        let position = real3(joint + JOINT_POSITION);
        let where_q = model_table[joint + JOINT_Q];
        let dof = model_table[joint + JOINT_V];
        let anchor = pose.position + rotate(pose.rotation, position) - tree.origin;
        let shifts = select(0u, 3u, kind == FREE);
        for (var k = 0u; k < shifts; k++) {
            var along = vec3f(0.0);
            along[k] = 1.0;
            let motion = Spatial(vec3f(0.0), along);
            axes[dof + k - tree.dof] = motion;
            efforts[dof + k - tree.dof] = Effort(0.0, 0.0);
            bias[dof + k - tree.dof] = -spring_effort(dof + k, 0.0, v(dof + k)).force;
            velocity = add(velocity, scaled(motion, v(dof + k)));
        }
        // Of a drive: the angle, or the parts of the rotation vector.
        var angles = vec3f(0.0);
        var rotation = vec4f(0.0);
        if (kind == HINGE) {
            angles = vec3f(q(where_q));
            rotation = from_rotation(real3(joint + JOINT_AXIS) * angles.x);
        } else {
            rotation = q_rotation(where_q + shifts);
            angles = rotation_vector(rotation);
        }
        if (kind == FREE) {
            pose = Pose(q3(where_q), rotation);
        } else {
            let after = quat_mul(pose.rotation, rotation);
            pose = Pose(pose.position + rotate(pose.rotation, position) - rotate(after, position), after);
        }
        let count = select(3u, 1u, kind == HINGE);
        let arm = select(anchor, vec3f(0.0), kind == FREE);
        let before = velocity;
        for (var k = 0u; k < count; k++) {
            var own = vec3f(0.0);
            own[k] = 1.0;
            if (kind == HINGE) { own = real3(joint + JOINT_AXIS); }
            let axis = rotate(pose.rotation, own);
            let motion = Spatial(axis, cross(arm, axis));
            let turning = dof + shifts + k;
            let speed = v(turning);
            axes[turning - tree.dof] = motion;
            efforts[turning - tree.dof] = effort(turning, angles[k], speed);
            bias[turning - tree.dof] = -spring_effort(turning, angles[k], speed).force;
            now = add(now, scaled(cross_motion(before, motion), speed));
            velocity = add(velocity, scaled(motion, speed));
        }
    }
    pose.rotation = normalize(pose.rotation);
    store_pose(tree.body + local, pose);
    store_spatial(VELOCITIES_AT() + 6u * (tree.body + local), velocity);
    forces[local] = now;
    inertias[local] = inertia_of(at, pose, tree.origin);
}

fn inertia_of(at: u32, pose: Pose, origin: vec3f) -> Inertia {
    let mass = real(at + BODY_MASS);
    let c = pose.position + rotate(pose.rotation, real3(at + BODY_COM)) - origin;
    let d = real3(at + BODY_INERTIA);
    let m = real3(at + BODY_INERTIA + 3u);
    let x = rotate(pose.rotation, vec3f(1.0, 0.0, 0.0));
    let y = rotate(pose.rotation, vec3f(0.0, 1.0, 0.0));
    let z = rotate(pose.rotation, vec3f(0.0, 0.0, 1.0));
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

// A pull towards a target, and against motion: gains are stiffness and damping.
fn pull(gains: vec2f, wanted: f32, angle: f32, speed: f32) -> Effort {
    return Effort(
        gains.x * (wanted - angle - params.dt * speed) - gains.y * speed,
        params.dt * gains.y + params.dt * params.dt * gains.x,
    );
}

fn effort(dof: u32, angle: f32, speed: f32) -> Effort {
    let info = model_table[DOFS_AT] + dof * DOF;
    let target_at = model_table[info + DOF_TARGET];
    if (target_at == NONE) { return Effort(0.0, 0.0); }
    let control = clamp(targets[target_at * params.envs + env], real(info + DOF_CONTROL), real(info + DOF_CONTROL + 1u));
    let own = pull(vec2f(real(info + DOF_STIFFNESS), real(info + DOF_DAMPING)), control, angle, speed);
    return Effort(real(info + DOF_TORQUE) * control + own.force, own.armature);
}

// A joint's own spring and damper.
fn spring_effort(dof: u32, angle: f32, speed: f32) -> Effort {
    let info = model_table[DOFS_AT] + dof * DOF + DOF_SPRING;
    return pull(vec2f(real(info), real(info + 1u)), real(info + 2u), angle, speed);
}

// The force that a body's motion and weight ask for, less what external_forces it.
fn body_force(tree: Tree, local: u32) {
    let own = inertias[local];
    let velocity = velocity_of(tree.body + local);
    let moving = cross_force(velocity, momentum(own, velocity));
    let index = 6u * (tree.body + local);
    let torque = external3(index);
    let force = external3(index + 3u);
    let pose = pose_of(tree.body + local);
    let centre = real3(model_table[BODIES_AT] + (tree.body + local) * BODY + BODY_COM);
    let arm = pose.position + rotate(pose.rotation, centre) - tree.origin;
    let applied = Spatial(-torque - cross(arm, force), -force);
    forces[local] = add(add(momentum(own, forces[local]), moving), applied);
}

fn external3(at: u32) -> vec3f {
    let e = params.envs;
    let index = at * e + env;
    return vec3f(external_forces[index], external_forces[index + e], external_forces[index + 2u * e]);
}

// Bias forces, besides those of springs, which are there; and what the parent carries.
fn backward_pass(tree: Tree, local: u32) {
    let at = model_table[BODIES_AT] + (tree.body + local) * BODY;
    for (var k = 0u; k < model_table[at + BODY_DOFS]; k++) {
        let dof = model_table[at + BODY_DOF] + k - tree.dof;
        bias[dof] += product(axes[dof], forces[local]);
    }
    let parent = model_table[at + BODY_PARENT];
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
fn factorize(tree: Tree) {
    for (var left = tree.dofs; left > 0u; left--) {
        let own = left - 1u;
        let info = model_table[DOFS_AT] + (tree.dof + own) * DOF;
        let body = model_table[info + DOF_BODY] - tree.body;
        let moved = momentum(inertias[body], axes[own]);
        let row = model_table[info + DOF_ROW];
        let depth = model_table[info + DOF_DEPTH];
        let last = model_table[info + DOF_LAST] - tree.dof;
        var inverse = 1.0;
        for (var k = 0u; k < depth; k++) {
            var entry = product(moved, axes[model_table[model_table[COLUMNS_AT] + row + k] - tree.dof]);
            if (k == 0u) {
                let spring = spring_effort(tree.dof + own, 0.0, 0.0).armature;
                entry += real(info + DOF_ARMATURE) + efforts[own].armature + spring;
            }
            for (var beyond = left; beyond < last; beyond++) {
                let at = ancestor_entry(tree, beyond, depth);
                entry -= factors[at] * factors[at + k];
            }
            if (k == 0u) { inverse = 1.0 / sqrt(entry); }
            factors[row + k - tree.packed] = select(entry, 1.0, k == 0u) * inverse;
        }
        var value = efforts[own].force - bias[own];
        for (var beyond = left; beyond < last; beyond++) {
            value -= factors[ancestor_entry(tree, beyond, depth)] * qacc_whitened[beyond];
        }
        qacc_whitened[own] = value * inverse;
    }
}

// Where a degree of freedom's row has the one of the given depth on its way to the root.
fn ancestor_entry(tree: Tree, dof: u32, depth: u32) -> u32 {
    return model_table[model_table[DOFS_AT] + (tree.dof + dof) * DOF + DOF_END] - tree.packed - depth;
}

// L^-1 of the mass-qacc_whitened acceleration.
fn solve_l(tree: Tree) {
    for (var own = 0u; own < tree.dofs; own++) {
        let info = model_table[DOFS_AT] + (tree.dof + own) * DOF;
        let row = model_table[info + DOF_ROW];
        var value = qacc_whitened[own];
        for (var k = 1u; k < model_table[info + DOF_DEPTH]; k++) {
            value -= factors[row + k - tree.packed] * acceleration[model_table[model_table[COLUMNS_AT] + row + k] - tree.dof];
        }
        acceleration[own] = value * factors[row - tree.packed];
    }
}

// Drives that would pass their limit applied with just that limit.
fn limit_drives(tree: Tree) -> bool {
    var any_over = false;
    for (var own = 0u; own < tree.dofs; own++) {
        let info = model_table[DOFS_AT] + (tree.dof + own) * DOF;
        if (model_table[info + DOF_TARGET] == NONE) { continue; }
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
    let at = model_table[TREES_AT] + index * TREE;
    let body = model_table[at + TREE_BODY];
    let dof = model_table[at + TREE_DOF];
    let packed = model_table[model_table[DOFS_AT] + dof * DOF + DOF_ROW];
    return Tree(body, model_table[at + TREE_BODIES], dof, model_table[at + TREE_DOFS], packed, origin_of(at));
}

@compute @workgroup_size(64)
fn smooth_dynamics(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    env = id.x;
    if (env >= params.envs || group.y >= params.trees) { return; }
    let tree = tree_of(group.y);
    for (var local = 0u; local < tree.bodies; local++) {
        forward_pass(tree, local);
    }
    if (params.kinematics_only == 1u) { return; }
    for (var local = 0u; local < tree.bodies; local++) { body_force(tree, local); }
    for (var left = tree.bodies; left > 0u; left--) { backward_pass(tree, left - 1u); }
    // Twice only where a drive is at its limit.
    for (var round = 0u; round < 2u; round++) {
        factorize(tree);
        solve_l(tree);
        if (round == 1u || !limit_drives(tree)) { break; }
    }
    for (var own = 0u; own < tree.dofs; own++) {
        let dof = tree.dof + own;
        let row = model_table[model_table[DOFS_AT] + dof * DOF + DOF_ROW];
        store_spatial(6u * dof, axes[own]);
        store(QACC_WHITENED_AT() + dof, qacc_whitened[own]);
        for (var k = 0u; k < model_table[model_table[DOFS_AT] + dof * DOF + DOF_DEPTH]; k++) {
            store(FACTORS_AT() + row + k, factors[row + k - tree.packed]);
        }
    }
}
