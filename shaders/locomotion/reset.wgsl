// Starts a new episode in every environment whose step ended (or in all of them).
// One invocation an environment.
//
// candidates   [candidates]       database frame of every search candidate
// termination  [.. + envs]        read from `offset` on
// boxes        [envs][BOX][count]
// state_f32    [STATE_F32_FIELDS][envs]      see locomotion_layout
// state_u32    [STATE_U32_FIELDS][envs]

#import locomotion_layout
#import obstacles
#import rng

struct Params {
    envs: u32,
    first: u32,
    candidates: u32,
    count: u32,
    seed: u32,
    step_counter: u32,
    offset: u32,
    all: u32,
    max_steps: u32,
    initial_age_jitter: u32,
    half_side: f32,
    reach: f32,
    clear: u32,
}

@group(0) @binding(0) var<storage, read> candidates: array<u32>;
@group(0) @binding(1) var<storage, read> termination: array<u32>;
@group(0) @binding(2) var<storage, read> boxes: array<f32>;
@group(0) @binding(3) var<storage, read_write> state_f32: array<f32>;
@group(0) @binding(4) var<storage, read_write> state_u32: array<u32>;
@group(0) @binding(5) var<uniform> params: Params;

const START = 0u;   // random streams
const TARGET = 1u;
const DRAWS = 32u;

fn obstructed(point: vec2f, env: u32) -> bool {
    let count = params.count;
    for (var slot = 0u; slot < count; slot++) {
        let i = env * BOX * count + slot;
        let half = vec2f(boxes[i + HALF_X * count], boxes[i + HALF_Z * count]);
        if (inside(point, vec2f(boxes[i], boxes[i + count]), half)) { return true; }
    }
    return false;
}

@compute @workgroup_size(64)
fn reset(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let envs = params.envs;
    if (env >= envs) { return; }
    if (params.all == 0u && termination[params.offset + env] == RUNNING) { return; }
    let start = random4(params.seed, params.first + env, params.step_counter, START);
    state_u32[FRAME * envs + env] = candidates[index_below(start.x, params.candidates)];
    state_u32[EPISODE_STEP * envs + env] = 0u;
    // At the very start limits are spread, so that not all episodes are truncated at once.
    state_u32[EPISODE_LIMIT * envs + env] = params.max_steps - index_below(start.y, params.initial_age_jitter);

    // A normalised pair of Gaussians points everywhere alike.
    let east = gaussian(random4(params.seed, params.first + env, params.step_counter, START + 2u));
    let north = gaussian(random4(params.seed, params.first + env, params.step_counter, START + 3u));
    let length = sqrt(east * east + north * north);
    let heading = select(vec2f(0.0, 1.0), vec2f(east, north) / length, length > 1e-6);
    state_f32[X * envs + env] = 0.0;
    state_f32[Z * envs + env] = 0.0;
    state_f32[HEADING_X * envs + env] = heading.x;
    state_f32[HEADING_Z * envs + env] = heading.y;

    // Uniform in the square, drawn again while within reach, or in an obstacle if it shall be
    // clear; the corner after DRAWS tries.
    var target_at = vec2f(params.half_side);
    for (var draw = 0u; draw < DRAWS; draw++) {
        let bits = random4(params.seed, params.first + env, params.step_counter, TARGET + 4u * (draw + 1u));
        let tried = (2.0 * vec2f(uniform01(bits.x), uniform01(bits.y)) - 1.0) * params.half_side;
        let far = dot(tried, tried) > params.reach * params.reach;
        if (far && (params.clear == 0u || !obstructed(tried, env))) {
            target_at = tried;
            break;
        }
    }
    state_f32[TARGET_X * envs + env] = target_at.x;
    state_f32[TARGET_Z * envs + env] = target_at.y;
    state_f32[RETURN * envs + env] = 0.0;
    state_f32[TRAVELLED * envs + env] = 0.0;
}
