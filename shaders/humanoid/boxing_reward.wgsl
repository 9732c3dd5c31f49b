// Rewards, measures and end of a step of the task `box`, for both fighters. One invocation an environment. Rows are
// fighters, those of an environment side by side.
//
// poses       [bodies * 7][envs], after the step
// dynamics    see `smooth_dynamics`: the velocities of the same state, from `velocities_at` on
// forces      [(bodies + 8) * 3][envs], N: on bodies, then of each fighter's right and left hand on the other's torso
//             and head
// task_state  [..][envs], see `boxing`; `joint_accelerations` has taken the step in
// reward      [rows], from `at` on
// measures    [6][rows]: impulse on the opponent, N s; that part of it from behind; a knock-down; out of the arena;
//             near the opponent; the beginning of a clinch
// task_end    [rows]
// kind        [rows], from `at` on: 0 the opponent is far, 1 near

#import termination
#import spatial
#import boxing
#import boxing_terms
#import approach
#import fallen
#import fighters

struct Params {
    envs: u32,
    at: u32,
    velocities_at: u32,
    bodies: u32,           // of a fighter, whose first has these:
    head: u32,
    pelvis: u32,
    torso: u32,
    right_hand: u32,
    left_hand: u32,
    right_foot: u32,
    left_foot: u32,
    torso_up: f32,         // m, of its centre above its origin
    head_up: f32,
    min_head: f32,         // m; below them it has fallen
    min_pelvis: f32,
    min_body: f32,         // of all but the feet
    fall_ends: u32,        // 1 if a fall ends the bout
    facing: u32,           // 1 if facing is rewarded, and required for the reward of a fall
    additive: u32,         // 1 if the way to a far opponent is rewarded by a sum
    stagger_steps: u32,    // after a blow in which a fall is a knock-down; 0 if every fall is one
    blow_force: f32,       // N, above which a touch is a blow
    clinch_steps: u32,     // within `clinch` after which fighters are in one
    clinch: f32,           // m, the distance of one
    arena: f32,            // m, half its width
    near: f32,             // m; nearer than this is near
    speed: f32,            // wanted, m/s
    dt: f32,               // s
    damage_scale: f32,     // of the forces in the reward
    damage_taken: f32,     // weight of those taken against those given
    dense: f32,            // weight of what is neither damage nor penalty nor a knock-down
    knockdown_bonus: f32,
    far_weight: f32,       // of the reward for an opponent that is far
    damage_weight: f32,    // the paper's table 3
    close_weight: f32,
    facing_weight: f32,
    fall_weight: f32,
    energy_weight: f32,
    penalty_weight: f32,
}

@group(0) @binding(0) var<storage, read_write> poses: array<f32>;
@group(0) @binding(1) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(2) var<storage, read_write> forces: array<f32>;
@group(0) @binding(3) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(4) var<storage, read_write> reward: array<f32>;
@group(0) @binding(5) var<storage, read_write> measures: array<f32>;
@group(0) @binding(6) var<storage, read_write> task_end: array<u32>;
@group(0) @binding(7) var<storage, read_write> kind: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

var<private> env: u32;

// Of the fighters to each other; two numbers are those of the two.
var<private> distance_apart: f32;  // m, over the ground
var<private> toward: vec2f;        // the second, from the first
var<private> ahead: vec2f;
var<private> mutual: bool;         // they face each other
var<private> alignment: f32;
// What happened to them in this step.
var<private> fallen: vec2<bool>;
var<private> left: vec2<bool>;     // the arena
var<private> given: vec2f;         // N
var<private> stagger: vec2f;
var<private> knocks_down: vec2<bool>;

fn bound(count: u32) -> u32 { return select(0u, count, task_end[2u * env] <= FAILED + LEADS); }

fn carried(field: u32) -> f32 { return task_state[field * params.envs + env]; }
fn carry(field: u32, value: f32) { task_state[field * params.envs + env] = value; }
fn is(fact: bool) -> f32 { return select(0.0, 1.0, fact); }

fn look() {
    let gap = position_of(root_of(1u)).xy - position_of(root_of(0u)).xy;
    distance_apart = length(gap);
    toward = unit2(gap);
    let red = heading_of_fighter(0u);
    let blue = heading_of_fighter(1u);
    ahead = vec2f(dot(red, toward), dot(blue, -toward));
    mutual = face_each_other(ahead.x, ahead.y);
    alignment = -dot(red, blue);
}

fn is_out(fighter: u32) -> bool {
    let at = abs(position_of(root_of(fighter)).xy);
    return max(at.x, at.y) > params.arena;
}

// Of a fighter's hands on the other's torso and head, N.
fn force_of(fighter: u32) -> f32 {
    var sum = 0.0;
    for (var pair = 0u; pair < 4u; pair++) {
        let at = 3u * (2u * params.bodies + 4u * fighter + pair) * params.envs + env;
        sum += length(vec3f(forces[at], forces[at + params.envs], forces[at + 2u * params.envs]));
    }
    return sum;
}

// Of the hand that does best.
fn closest(me: u32) -> f32 {
    let way = select(-toward, toward, me == 0u);
    var most = 0.0;
    for (var hand = 0u; hand < 2u; hand++) {
        let own = hand_of(me, hand);
        let torso = target_of(1u - me, 0u).position - own.position;
        let head = target_of(1u - me, 1u).position - own.position;
        let apart = select(head, torso, dot(torso, torso) < dot(head, head));
        most = max(most, close(apart, dot(way, own.velocity.xy)));
    }
    return most;
}

fn far_reward(me: u32) -> f32 {
    let way = select(-toward, toward, me == 0u);
    let along = dot(way, root_velocity(me).xy);
    let faces = params.facing == 1u;
    let printed = far(
        position(distance_apart), velocity(along, params.speed), select(0.0, facing_from_afar(ahead[me]), faces),
    );
    let sum = approach(along, select(0.0, 0.5 * (1.0 + ahead[me]), faces), distance_apart);
    return params.dense * params.far_weight * select(printed, sum, params.additive == 1u);
}

// Table 3.
fn near_reward(me: u32) -> f32 {
    let other = 1u - me;
    let up = rotate(rotation_of(root_of(other)), vec3f(0.0, 0.0, 1.0)).z;
    let faces = select(0.0, facing(alignment, mutual), params.facing == 1u);
    let falls = select(0.0, fall(up), mutual || params.facing == 0u);
    let dense = params.close_weight * closest(me) + params.facing_weight * faces + params.fall_weight * falls
        - params.energy_weight * energy(distance_apart, carried(SQUARED_ACCELERATION + me));
    return params.damage_weight * params.damage_scale * damage(given[me], given[other], params.damage_taken)
        + params.dense * dense - params.penalty_weight * penalty(fallen[me], left[me]);
}

// Steps that are left in which a fall of the other is this one's doing.
fn stagger_of(me: u32) -> f32 {
    return select(max(carried(STAGGER_STEPS + me) - 1.0, 0.0), f32(params.stagger_steps), given[me] > params.blow_force);
}

// A fall together is nobody's knock-down, and a fall long after the last blow is the own fault of who falls.
fn has_knocked_down(me: u32) -> bool {
    let other = 1u - me;
    let caused = params.stagger_steps == 0u || stagger[me] > 0.0;
    return fallen[other] && carried(DOWN + other) == 0.0 && !fallen[me] && caused;
}

fn leads(me: u32) -> bool {
    let other = 1u - me;
    let knocked = carried(KNOCKDOWNS + me) - carried(KNOCKDOWNS + other);
    return knocked > 0.0 || (knocked == 0.0 && carried(DAMAGE + me) > carried(DAMAGE + other));
}

// By falling or by leaving the arena.
fn is_over(fighter: u32) -> bool { return (fallen[fighter] && params.fall_ends == 1u) || left[fighter]; }

fn end_of(me: u32) -> u32 {
    let lost = is_over(me);
    let outlasts = is_over(1u - me) && !lost;
    let remains = select(TRUNCATED, SUCCESS, knocks_down[me]);
    return select(select(RUNNING, remains, outlasts), FAILED, lost) + select(0u, LEADS, outlasts || leads(me));
}

fn measure(me: u32, clinches: bool) {
    let rows = 2u * params.envs;
    let row = 2u * env + me;
    let impulse = params.dt * given[me];
    measures[row] = impulse;
    measures[rows + row] = select(0.0, impulse, ahead[1u - me] < 0.0);
    measures[2u * rows + row] = is(knocks_down[me]);
    measures[3u * rows + row] = is(left[me]);
    measures[4u * rows + row] = is(distance_apart < params.near);
    measures[5u * rows + row] = is(clinches);
}

@compute @workgroup_size(64)
fn boxing_reward(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    look();
    fallen = vec2<bool>(has_fallen(0u), has_fallen(params.bodies));
    left = vec2<bool>(is_out(0u), is_out(1u));
    given = vec2f(force_of(0u), force_of(1u));
    stagger = vec2f(stagger_of(0u), stagger_of(1u));
    knocks_down = vec2<bool>(has_knocked_down(0u), has_knocked_down(1u));
    let clinch = select(0.0, carried(CLINCH_STEPS) + 1.0, distance_apart < params.clinch);
    carry(CLINCH_STEPS, clinch);
    for (var me = 0u; me < 2u; me++) {
        let at = params.at + 2u * env + me;
        let near = distance_apart < params.near;
        let own = select(far_reward(me), near_reward(me), near);
        reward[at] = select(own, params.knockdown_bonus, knocks_down[me]);
        kind[at] = select(0u, 1u, near);
        measure(me, clinch == f32(params.clinch_steps));
        carry(DAMAGE + me, carried(DAMAGE + me) + params.dt * given[me]);
        carry(KNOCKDOWNS + me, carried(KNOCKDOWNS + me) + is(knocks_down[me]));
    }
    for (var me = 0u; me < 2u; me++) {
        task_end[2u * env + me] = end_of(me);
        carry(DOWN + me, is(fallen[me]));
        carry(STAGGER_STEPS + me, stagger[me]);
    }
}
