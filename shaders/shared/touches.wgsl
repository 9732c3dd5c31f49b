// Fields of a contact found: touches[(slot * TOUCH + field) * envs + env]. The importing shader binds `touches`, and
// `env` is its world.

// Of the place, 3.
const TOUCH_NORMAL = 3u;   // 3, from the first geom to the second
const TOUCH_TANGENT = 6u;  // 3
const TOUCH_DISTANCE = 9u; // below zero inside each other, m
const TOUCH = 10u;

fn touch3(at: u32) -> vec3f {
    let e = params.envs;
    let place = at * e + env;
    return vec3f(touches[place], touches[place + e], touches[place + 2u * e]);
}
