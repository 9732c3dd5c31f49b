// Reading the world `env`'s state: q, then v. The importing shader binds `tables` and `state`.

var<private> env: u32;

fn q(index: u32) -> f32 { return state[index * params.envs + env]; }
fn q3(index: u32) -> vec3f { return vec3f(q(index), q(index + 1u), q(index + 2u)); }
// A quaternion of the state, where w comes first.
fn q_turn(index: u32) -> vec4f { return normalize(vec4f(q3(index + 1u), q(index))); }
fn v(dof: u32) -> f32 { return state[(tables[POSITIONS] + dof) * params.envs + env]; }

// Where a tree's spatial vectors begin: at its root if that is free, else where the root is fastened.
fn origin_of(tree: u32) -> vec3f {
    let root = tables[BODIES_AT] + tables[tree + TREE_BODY] * BODY;
    if (tables[tree + TREE_FREE] == 1u) {
        return q3(tables[tables[JOINTS_AT] + tables[root + BODY_JOINT] * JOINT + JOINT_Q]);
    }
    return real3(root + BODY_PLACE);
}
