// A character's observation of its own body, in its heading frame: origin on the ground below the root, x along
// the root's forward axis on the ground, z up. One invocation a character of an environment.
//
// model_table       see `model_table`
// state        [positions + dofs][envs]
// poses        [bodies * 7][envs], of this very state, as `smooth_dynamics` finds them
// dynamics     see `smooth_dynamics`: the velocities
// characters   [1 + characters * (1 + keys)]: keys, then of each a tree and its key bodies
// termination  [envs]: how the last step ended
// observation  [envs][characters][width], from `at` on: height of the root, its rotation (6), its velocity (3) and
//              angular velocity (3); every joint's rotation, 6 of a ball and the angle of a hinge; all joints'
//              velocities; positions of the key bodies (3)
//
// A rotation in six numbers is where it takes the axes x and z: continuous, unlike angles and quaternions
// (Zhou et al., "On the Continuity of Rotation Representations in Neural Networks", CVPR 2019).

#import model_table
#import state
#import spatial
#import dynamics

struct Params {
    envs: u32,
    characters: u32,
    width: u32,
    at: u32,
    only: u32, // environments whose step ended as one of these, 1 << termination
}

@group(0) @binding(0) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(1) var<storage, read_write> state: array<f32>;
@group(0) @binding(2) var<storage, read_write> poses: array<f32>;
@group(0) @binding(3) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(4) var<storage, read_write> characters: array<u32>;
@group(0) @binding(5) var<storage, read_write> termination: array<u32>;
@group(0) @binding(6) var<storage, read_write> observation: array<f32>;
@group(0) @binding(7) var<uniform> params: Params;

var<private> cursor: u32;

fn pose(body: u32, k: u32) -> f32 { return poses[(7u * body + k) * params.envs + env]; }
fn position_of(body: u32) -> vec3f { return vec3f(pose(body, 0u), pose(body, 1u), pose(body, 2u)); }
fn rotation_of(body: u32) -> vec4f { return vec4f(pose(body, 3u), pose(body, 4u), pose(body, 5u), pose(body, 6u)); }

fn put(value: f32) {
    observation[cursor] = value;
    cursor += 1u;
}

fn put3(value: vec3f) {
    put(value.x);
    put(value.y);
    put(value.z);
}

// A vector of the world in the heading frame.
fn in_heading_frame(heading: vec2f, vector: vec3f) -> vec3f {
    return vec3f(
        heading.x * vector.x + heading.y * vector.y,
        heading.x * vector.y - heading.y * vector.x,
        vector.z,
    );
}

fn put_rotation(rotation: vec4f, heading: vec2f) {
    put3(in_heading_frame(heading, rotate(rotation, vec3f(1.0, 0.0, 0.0))));
    put3(in_heading_frame(heading, rotate(rotation, vec3f(0.0, 0.0, 1.0))));
}

@compute @workgroup_size(64)
fn proprioception(@builtin(global_invocation_id) id: vec3u) {
    env = id.x / params.characters;
    let character = id.x % params.characters;
    if (env >= params.envs) { return; }
    if ((params.only >> termination[env] & 1u) == 0u) { return; }
    cursor = params.at + id.x * params.width;
    let keys = characters[0];
    let list = 1u + character * (1u + keys);
    let tree = model_table[TREES_AT] + characters[list] * TREE;
    let root = model_table[tree + TREE_BODY];
    let position = position_of(root);
    let rotation = rotation_of(root);
    let heading = heading_of(rotation);
    put(position.z);
    put_rotation(rotation, heading);
    let at = VELOCITIES_AT() + 6u * root;
    let e = params.envs;
    let spin = vec3f(dynamics[at * e + env], dynamics[(at + 1u) * e + env], dynamics[(at + 2u) * e + env]);
    let speed = vec3f(dynamics[(at + 3u) * e + env], dynamics[(at + 4u) * e + env], dynamics[(at + 5u) * e + env]);
    put3(in_heading_frame(heading, speed));
    put3(in_heading_frame(heading, spin));
    let straight = vec2f(1.0, 0.0);
    for (var index = 0u; index < model_table[JOINT_COUNT]; index++) {
        let joint = model_table[JOINTS_AT] + index * JOINT;
        let dof = model_table[joint + JOINT_V];
        let kind = model_table[joint + JOINT_KIND];
        let mine = dof >= model_table[tree + TREE_DOF] && dof < model_table[tree + TREE_DOF] + model_table[tree + TREE_DOFS];
        if (!mine || kind == FREE) { continue; }
        if (kind == BALL) { put_rotation(q_rotation(model_table[joint + JOINT_Q]), straight); } else { put(q(model_table[joint + JOINT_Q])); }
    }
    for (var dof = select(0u, 6u, model_table[tree + TREE_FREE] == 1u); dof < model_table[tree + TREE_DOFS]; dof++) {
        put(v(model_table[tree + TREE_DOF] + dof));
    }
    for (var key = 0u; key < keys; key++) {
        let key_position = position_of(characters[list + 1u + key]) - vec3f(position.xy, 0.0);
        put3(in_heading_frame(heading, key_position));
    }
}
