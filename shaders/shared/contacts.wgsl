// Fields of a contact found: contacts[(slot * CONTACT_DIM + field) * envs + env]. The importing shader binds `contacts`, and
// `env` is its world.

// Of the position, 3.
const CONTACT_NORMAL = 3u;   // 3, from the first geom to the second
const CONTACT_TANGENT = 6u;  // 3
const CONTACT_DISTANCE = 9u; // below zero inside each other, m
const CONTACT_DIM = 10u;

fn contact3(at: u32) -> vec3f {
    let e = params.envs;
    let index = at * e + env;
    return vec3f(contacts[index], contacts[index + e], contacts[index + 2u * e]);
}
