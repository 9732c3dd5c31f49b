// What the task `box` adds to the observation of the body, in the fighter's heading frame. One invocation a fighter.
//
// poses        [bodies * 7][envs]
// dynamics     see `smooth_dynamics`: the velocities of the same state, from `velocities_at` on
// termination  [envs]: how the last step ended
// observation  rows of `width`, from `at` on: the arena's centre over half its width (2); of the opponent's root the
//              position from the own (3), the rotation (6), the velocity against the own (3) and the angular velocity
//              (3); of the own right and left hand where the opponent's torso and head are from there (3), and
//              the velocity against it (3); the same of the opponent's hands and the own torso and head

#import spatial
#import fighters

struct Params {
    envs: u32,
    at: u32,
    width: u32,
    only: u32, // environments whose step ended as one of these, 1 << termination
    velocities_at: u32,
    bodies: u32, // of a fighter, whose first has these:
    torso: u32,
    head: u32,
    right_hand: u32,
    left_hand: u32,
    torso_up: f32, // m, of its centre above its origin
    head_up: f32,
    arena: f32,    // m, half its width
}

@group(0) @binding(0) var<storage, read_write> poses: array<f32>;
@group(0) @binding(1) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(2) var<storage, read_write> termination: array<u32>;
@group(0) @binding(3) var<storage, read_write> observation: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

var<private> env: u32;
var<private> cursor: u32;
var<private> heading: vec2f;

fn put(value: f32) {
    observation[cursor] = value;
    cursor += 1u;
}

fn put2(value: vec2f) {
    put(heading.x * value.x + heading.y * value.y);
    put(heading.x * value.y - heading.y * value.x);
}

fn put3(value: vec3f) {
    put2(value.xy);
    put(value.z);
}

// From every hand of one fighter to what it is to hit of the other.
fn put_reach(hitter: u32, hit: u32) {
    for (var hand = 0u; hand < 2u; hand++) {
        let own = hand_of(hitter, hand);
        for (var part = 0u; part < 2u; part++) {
            let aim = target_of(hit, part);
            put3(aim.position - own.position);
            put3(aim.velocity - own.velocity);
        }
    }
}

@compute @workgroup_size(64)
fn boxing_observe(@builtin(global_invocation_id) id: vec3u) {
    env = id.x / 2u;
    if (env >= params.envs) { return; }
    if ((params.only >> termination[env] & 1u) == 0u) { return; }
    let me = id.x % 2u;
    let other = 1u - me;
    cursor = params.at + id.x * params.width;
    heading = heading_of_fighter(me);
    let position = position_of(root_of(me));
    let rotation = rotation_of(root_of(other));
    put2(-position.xy / params.arena);
    put3(position_of(root_of(other)) - position);
    put3(rotate(rotation, vec3f(1.0, 0.0, 0.0)));
    put3(rotate(rotation, vec3f(0.0, 0.0, 1.0)));
    put3(root_velocity(other) - root_velocity(me));
    put3(velocity3(6u * root_of(other)));
    put_reach(me, other);
    put_reach(other, me);
}
