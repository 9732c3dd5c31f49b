// Reading the world `env`'s state: q, then v. The importing shader binds `model_table` and `state`.

var<private> env: u32;

fn q(index: u32) -> f32 { return state[index * params.envs + env]; }
fn q3(index: u32) -> vec3f { return vec3f(q(index), q(index + 1u), q(index + 2u)); }
// A quaternion of the state, where w comes first.
fn q_rotation(index: u32) -> vec4f { return normalize(vec4f(q3(index + 1u), q(index))); }
fn v(dof: u32) -> f32 { return state[(model_table[NQ] + dof) * params.envs + env]; }

// Where a tree's spatial vectors begin: at its root if that is free, else where the root is fastened.
fn origin_of(tree: u32) -> vec3f {
    let root = model_table[BODIES_AT] + model_table[tree + TREE_BODY] * BODY;
    if (model_table[tree + TREE_FREE] == 1u) {
        return q3(model_table[model_table[JOINTS_AT] + model_table[root + BODY_JOINT] * JOINT + JOINT_Q]);
    }
    return real3(root + BODY_POSITION);
}
