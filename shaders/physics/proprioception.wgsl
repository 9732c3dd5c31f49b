// What a character feels of itself, in its heading frame: origin on the ground below the root, x along the
// root's forward axis on the ground, z up. One invocation a character of an environment.
//
// tables      see `tables`
// state       [positions + dofs][envs]
// poses       [bodies * 7][envs], of this very state, as `articulate` finds them
// dynamics    see `articulate`
// characters  [1 + characters * (1 + keys)]: keys, then of each a tree and its bodies whose places it knows
// felt        [characters][envs][width]: height of the root, its turn (6), its velocity (3) and angular
//             velocity (3); every joint's turn, 6 of a ball and the angle of a hinge; all joints'
//             velocities; places of the known bodies (3)
//
// A turn in six numbers is where it takes the axes x and z: continuous, unlike angles and quaternions
// (Zhou et al., "On the Continuity of Rotation Representations in Neural Networks", CVPR 2019).

#import tables
#import state
#import spatial
#import dynamics

struct Params {
    envs: u32,
    characters: u32,
    width: u32,
}

@group(0) @binding(0) var<storage, read_write> tables: array<u32>;
@group(0) @binding(1) var<storage, read_write> state: array<f32>;
@group(0) @binding(2) var<storage, read_write> poses: array<f32>;
@group(0) @binding(3) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(4) var<storage, read_write> characters: array<u32>;
@group(0) @binding(5) var<storage, read_write> felt: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

var<private> cursor: u32;

fn pose(body: u32, k: u32) -> f32 { return poses[(7u * body + k) * params.envs + env]; }
fn place_of(body: u32) -> vec3f { return vec3f(pose(body, 0u), pose(body, 1u), pose(body, 2u)); }
fn turn_of(body: u32) -> vec4f { return vec4f(pose(body, 3u), pose(body, 4u), pose(body, 5u), pose(body, 6u)); }

fn feel(value: f32) {
    felt[cursor] = value;
    cursor += 1u;
}

fn feel3(value: vec3f) {
    feel(value.x);
    feel(value.y);
    feel(value.z);
}

// A vector of the world in the heading frame.
fn ahead(heading: vec2f, vector: vec3f) -> vec3f {
    return vec3f(
        heading.x * vector.x + heading.y * vector.y,
        heading.x * vector.y - heading.y * vector.x,
        vector.z,
    );
}

fn feel_turn(turn: vec4f, heading: vec2f) {
    feel3(ahead(heading, rotate(turn, vec3f(1.0, 0.0, 0.0))));
    feel3(ahead(heading, rotate(turn, vec3f(0.0, 0.0, 1.0))));
}

@compute @workgroup_size(64)
fn proprioception(@builtin(global_invocation_id) id: vec3u) {
    env = id.x % params.envs;
    let character = id.x / params.envs;
    if (character >= params.characters) { return; }
    cursor = id.x * params.width;
    let keys = characters[0];
    let list = 1u + character * (1u + keys);
    let tree = tables[TREES_AT] + characters[list] * TREE;
    let root = tables[tree + TREE_BODY];
    let place = place_of(root);
    let turn = turn_of(root);
    let forward = rotate(turn, vec3f(1.0, 0.0, 0.0)).xy;
    // Upright is the rule: one who faces straight up or down has no heading, and gets the world's.
    let heading = select(vec2f(1.0, 0.0), forward / length(forward), length(forward) > 1e-6);
    feel(place.z);
    feel_turn(turn, heading);
    let at = VELOCITIES_AT() + 6u * root;
    let e = params.envs;
    let spin = vec3f(dynamics[at * e + env], dynamics[(at + 1u) * e + env], dynamics[(at + 2u) * e + env]);
    let speed = vec3f(dynamics[(at + 3u) * e + env], dynamics[(at + 4u) * e + env], dynamics[(at + 5u) * e + env]);
    feel3(ahead(heading, speed));
    feel3(ahead(heading, spin));
    let straight = vec2f(1.0, 0.0);
    for (var index = 0u; index < tables[JOINT_COUNT]; index++) {
        let joint = tables[JOINTS_AT] + index * JOINT;
        let dof = tables[joint + JOINT_V];
        let kind = tables[joint + JOINT_KIND];
        let mine = dof >= tables[tree + TREE_DOF] && dof < tables[tree + TREE_DOF] + tables[tree + TREE_DOFS];
        if (!mine || kind == FREE) { continue; }
        if (kind == BALL) { feel_turn(q_turn(tables[joint + JOINT_Q]), straight); } else { feel(q(tables[joint + JOINT_Q])); }
    }
    for (var dof = select(0u, 6u, tables[tree + TREE_FREE] == 1u); dof < tables[tree + TREE_DOFS]; dof++) {
        feel(v(tables[tree + TREE_DOF] + dof));
    }
    for (var key = 0u; key < keys; key++) {
        let known = place_of(characters[list + 1u + key]) - vec3f(place.xy, 0.0);
        feel3(ahead(heading, known));
    }
}
