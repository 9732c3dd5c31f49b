// Poses, velocities, mass matrix and unconstrained acceleration of articulated bodies, their drives and
// what pushes them included. One row of workgroups a tree, one invocation an environment: what is of the
// tree is then the same for all invocations of a group, which software adapters read once.
//
// tables    see `tables`
// state     [positions + dofs][envs], q then v
// targets   [driven][envs], of the drives, rad
// pushes    [bodies * 6][envs], torque and force at the centres of mass
// poses     [bodies * 7][envs], place and quaternion x y z w, in the world
// dynamics  [..][envs]: axes [dofs * 6], mass matrix with armature [packed], its factors [packed],
//           smooth acceleration [dofs], velocities [bodies * 6]; spatial vectors about a tree's origin

#import tables
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

// Most bodies of a tree; Rust refuses more.
const TREE_MOST = 32u;

var<private> env: u32;
// Of the tree's bodies, counted from its first.
var<private> velocities: array<Spatial, 32>;
// Accelerations on the way out, forces on the way in.
var<private> forces: array<Spatial, 32>;
var<private> inertias: array<Inertia, 32>;

fn q(index: u32) -> f32 { return state[index * params.envs + env]; }
fn q3(index: u32) -> vec3f { return vec3f(q(index), q(index + 1u), q(index + 2u)); }
// A quaternion of the state, where w comes first.
fn q_turn(index: u32) -> vec4f { return normalize(vec4f(q3(index + 1u), q(index))); }
fn v(dof: u32) -> f32 { return state[(tables[POSITIONS] + dof) * params.envs + env]; }
fn kept(at: u32) -> f32 { return dynamics[at * params.envs + env]; }
fn keep(at: u32, value: f32) { dynamics[at * params.envs + env] = value; }

fn axis_of(dof: u32) -> Spatial {
    let at = 6u * dof;
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

struct Pose {
    place: vec3f,
    turn: vec4f,
}

// Where a body is, how it moves and would accelerate unforced; the motions of its degrees of freedom.
fn outward(body: u32, local: u32, first: u32, origin: vec3f) {
    let at = tables[BODIES_AT] + body * BODY;
    var pose = Pose(real3(at + BODY_PLACE), real4(at + BODY_TURN));
    var velocity = Spatial(vec3f(0.0), vec3f(0.0));
    var acceleration = Spatial(vec3f(0.0), vec3f(0.0, 0.0, GRAVITY));
    let parent = tables[at + BODY_PARENT];
    if (parent != NONE) {
        let outer = pose_of(parent);
        pose = Pose(outer.place + rotate(outer.turn, pose.place), turned(outer.turn, pose.turn));
        velocity = velocities[parent - first];
        acceleration = forces[parent - first];
    }
    let joints = tables[at + BODY_JOINTS];
    for (var j = 0u; j < joints; j++) {
        let joint = tables[JOINTS_AT] + (tables[at + BODY_JOINT] + j) * JOINT;
        let kind = tables[joint + JOINT_KIND];
        let place = real3(joint + JOINT_PLACE);
        let where_q = tables[joint + JOINT_Q];
        let dof = tables[joint + JOINT_V];
        let anchor = pose.place + rotate(pose.turn, place) - origin;
        if (kind == FREE) {
            pose = Pose(q3(where_q), q_turn(where_q + 3u));
            for (var k = 0u; k < 3u; k++) {
                var along = vec3f(0.0);
                along[k] = 1.0;
                let motion = Spatial(vec3f(0.0), along);
                keep_spatial(6u * (dof + k), motion);
                velocity = add(velocity, scaled(motion, v(dof + k)));
            }
        } else {
            var turn = vec4f(0.0);
            if (kind == BALL) { turn = q_turn(where_q); } else { turn = from_rotation(real3(joint + JOINT_AXIS) * q(where_q)); }
            let after = turned(pose.turn, turn);
            pose = Pose(pose.place + rotate(pose.turn, place) - rotate(after, place), after);
        }
        let turning = select(dof, dof + 3u, kind == FREE);
        let count = select(3u, 1u, kind == HINGE);
        let arm = select(anchor, vec3f(0.0), kind == FREE);
        let before = velocity;
        for (var k = 0u; k < count; k++) {
            var own = vec3f(0.0);
            own[k] = 1.0;
            if (kind == HINGE) { own = real3(joint + JOINT_AXIS); }
            let axis = rotate(pose.turn, own);
            let motion = Spatial(axis, cross(arm, axis));
            keep_spatial(6u * (turning + k), motion);
            let speed = v(turning + k);
            acceleration = add(acceleration, scaled(cross_motion(before, motion), speed));
            velocity = add(velocity, scaled(motion, speed));
        }
    }
    pose.turn = normalize(pose.turn);
    keep_pose(body, pose);
    velocities[local] = velocity;
    forces[local] = acceleration;
    inertias[local] = inertia_of(at, pose, origin);
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

// Forces that motion and weight ask for, the mass matrix's rows, and what the parent carries.
fn inward(body: u32, local: u32, first: u32, origin: vec3f) {
    let at = tables[BODIES_AT] + body * BODY;
    let pushed = 6u * body;
    let torque = push3(pushed);
    let force = push3(pushed + 3u);
    let pose = pose_of(body);
    let arm = pose.place + rotate(pose.turn, real3(at + BODY_CENTRE)) - origin;
    forces[local] = add(forces[local], Spatial(-torque - cross(arm, force), -force));
    for (var k = 0u; k < tables[at + BODY_DOFS]; k++) {
        let dof = tables[at + BODY_DOF] + k;
        let info = tables[DOFS_AT] + dof * DOF;
        let motion = axis_of(dof);
        keep(SMOOTH_AT() + dof, -product(motion, forces[local]));
        let moved = momentum(inertias[local], motion);
        let row = tables[info + DOF_ROW];
        for (var i = 0u; i < tables[info + DOF_DEPTH]; i++) {
            let along = axis_of(tables[tables[COLUMNS_AT] + row + i]);
            keep(MATRIX_AT() + row + i, product(moved, along) + select(0.0, real(info + DOF_ARMATURE), i == 0u));
        }
    }
    let parent = tables[at + BODY_PARENT];
    if (parent != NONE) {
        let up = parent - first;
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

fn push3(at: u32) -> vec3f {
    let e = params.envs;
    let place = at * e + env;
    return vec3f(pushes[place], pushes[place + e], pushes[place + 2u * e]);
}

// The drive of a degree of freedom: force, and armature of its implicit part (src/body/drive.rs).
fn effort(dof: u32) -> vec2f {
    let info = tables[DOFS_AT] + dof * DOF;
    let target_at = tables[info + DOF_TARGET];
    if (target_at == NONE) { return vec2f(0.0); }
    let joint = tables[JOINTS_AT] + tables[info + DOF_JOINT] * JOINT;
    let where_q = tables[joint + JOINT_Q];
    var angle = q(where_q);
    if (tables[joint + JOINT_KIND] == BALL) {
        angle = rotation_vector(q_turn(where_q))[dof - tables[joint + JOINT_V]];
    }
    let stiffness = real(info + DOF_STIFFNESS);
    let damping = real(info + DOF_DAMPING);
    let wanted = targets[target_at * params.envs + env];
    let speed = v(dof);
    return vec2f(
        stiffness * (wanted - angle - params.dt * speed) - damping * speed,
        params.dt * damping + params.dt * params.dt * stiffness,
    );
}

// Most degrees of freedom of a tree; Rust refuses more.
const DOFS_MOST = 64u;
var<private> efforts: array<vec2f, 64>;
var<private> x: array<f32, 64>;

// M = L^T D L of this tree, and x = M^-1 (efforts - bias).
fn solve_smooth(first: u32, count: u32) {
    for (var local = 0u; local < count; local++) {
        let info = tables[DOFS_AT] + (first + local) * DOF;
        let row = tables[info + DOF_ROW];
        let depth = tables[info + DOF_DEPTH];
        for (var k = 0u; k < depth; k++) {
            keep(FACTORS_AT() + row + k, kept(MATRIX_AT() + row + k) + select(0.0, efforts[local].y, k == 0u));
        }
        x[local] = efforts[local].x + kept(SMOOTH_AT() + first + local);
    }
    for (var left = count; left > 0u; left--) {
        let info = tables[DOFS_AT] + (first + left - 1u) * DOF;
        let row = tables[info + DOF_ROW];
        let depth = tables[info + DOF_DEPTH];
        let inverse = 1.0 / kept(FACTORS_AT() + row);
        for (var k = 1u; k < depth; k++) {
            let scaled_by = kept(FACTORS_AT() + row + k) * inverse;
            let ancestor = tables[tables[COLUMNS_AT] + row + k];
            let above = tables[tables[DOFS_AT] + ancestor * DOF + DOF_ROW];
            for (var i = k; i < depth; i++) {
                let place = FACTORS_AT() + above + i - k;
                keep(place, kept(place) - scaled_by * kept(FACTORS_AT() + row + i));
            }
            // L^T x, on the way.
            x[ancestor - first] -= scaled_by * x[left - 1u];
        }
        for (var k = 1u; k < depth; k++) {
            keep(FACTORS_AT() + row + k, kept(FACTORS_AT() + row + k) * inverse);
        }
    }
    for (var local = 0u; local < count; local++) {
        let info = tables[DOFS_AT] + (first + local) * DOF;
        let row = tables[info + DOF_ROW];
        var value = x[local] / kept(FACTORS_AT() + row);
        for (var k = 1u; k < tables[info + DOF_DEPTH]; k++) {
            value -= kept(FACTORS_AT() + row + k) * x[tables[tables[COLUMNS_AT] + row + k] - first];
        }
        x[local] = value;
    }
}

// Drives that would pass their limit push with just that limit.
fn limit_drives(first: u32, count: u32) -> bool {
    var any_over = false;
    for (var local = 0u; local < count; local++) {
        let info = tables[DOFS_AT] + (first + local) * DOF;
        if (tables[info + DOF_TARGET] == NONE) { continue; }
        let torque = efforts[local].x - efforts[local].y * x[local];
        let most = real(info + DOF_LIMIT);
        if (abs(torque) > most) {
            efforts[local] = vec2f(select(-most, most, torque > 0.0), 0.0);
            any_over = true;
        }
    }
    return any_over;
}

@compute @workgroup_size(64)
fn articulate(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let at = tables[TREES_AT] + group.y * TREE;
    let first = tables[at + TREE_BODY];
    let bodies = tables[at + TREE_BODIES];
    let root = tables[BODIES_AT] + first * BODY;
    var origin = real3(root + BODY_PLACE);
    if (tables[at + TREE_FREE] == 1u) {
        origin = q3(tables[tables[JOINTS_AT] + tables[root + BODY_JOINT] * JOINT + JOINT_Q]);
    }
    for (var local = 0u; local < bodies; local++) {
        outward(first + local, local, first, origin);
        keep_spatial(VELOCITIES_AT() + 6u * (first + local), velocities[local]);
    }
    for (var local = 0u; local < bodies; local++) {
        let moving = cross_force(velocities[local], momentum(inertias[local], velocities[local]));
        forces[local] = add(momentum(inertias[local], forces[local]), moving);
    }
    for (var left = bodies; left > 0u; left--) {
        inward(first + left - 1u, left - 1u, first, origin);
    }
    let dof = tables[at + TREE_DOF];
    let dofs = tables[at + TREE_DOFS];
    for (var local = 0u; local < dofs; local++) { efforts[local] = effort(dof + local); }
    // Twice only where a drive is at its limit.
    for (var round = 0u; round < 2u; round++) {
        solve_smooth(dof, dofs);
        if (round == 1u || !limit_drives(dof, dofs)) { break; }
    }
    for (var local = 0u; local < dofs; local++) { keep(SMOOTH_AT() + dof + local, x[local]); }
}
