// Draws the obstacles of every new episode: sizes, places clear of the start, velocities.
// One invocation an obstacle.
//
// termination        [.. + envs]            read from `offset` on
// boxes              [envs][BOX][count]
// obstacle_velocity  [envs][VELOCITY_DIM][count]

#import locomotion_layout
#import rng

struct Params {
    envs: u32,
    first: u32,
    count: u32,
    seed: u32,
    step_counter: u32,
    offset: u32,
    all: u32,
    side_min: f32,
    side_max: f32,
    square: f32,
    margin: f32,
    speed: f32,
    speed_min: f32,
}

@group(0) @binding(0) var<storage, read> termination: array<u32>;
@group(0) @binding(1) var<storage, read_write> boxes: array<f32>;
@group(0) @binding(2) var<storage, read_write> obstacle_velocity: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const BOXES = 0x424f5853u; // first random stream, 32 an obstacle
const DIRECTION = 1u;
const PLACE = 3u;
const TRIES = 29u;

@compute @workgroup_size(256)
fn spawn_obstacles(@builtin(global_invocation_id) id: vec3u) {
    let count = params.count;
    let env = id.x / max(count, 1u);
    let slot = id.x % max(count, 1u);
    if (env >= params.envs) { return; }
    if (params.all == 0u && termination[params.offset + env] == RUNNING) { return; }
    let stream = BOXES + 32u * slot;
    let size = random4(params.seed, params.first + env, params.step_counter, stream);
    let range = params.side_max - params.side_min;
    let half = 0.5 * (params.side_min + vec2f(uniform01(size.x), uniform01(size.y)) * range);

    // Drawn again while it covers the start; the square's corner after TRIES, which is clear.
    var centre = vec2f(params.square);
    for (var tried = 0u; tried < TRIES; tried++) {
        let bits = random4(params.seed, params.first + env, params.step_counter, stream + PLACE + tried);
        let place = (2.0 * vec2f(uniform01(bits.x), uniform01(bits.y)) - 1.0) * params.square;
        if (any(abs(place) > half + params.margin)) {
            centre = place;
            break;
        }
    }

    // A normalised pair of Gaussians points everywhere alike.
    let east = gaussian(random4(params.seed, params.first + env, params.step_counter, stream + DIRECTION));
    let north = gaussian(random4(params.seed, params.first + env, params.step_counter, stream + DIRECTION + 1u));
    let length = sqrt(east * east + north * north);
    let direction = select(vec2f(0.0, 1.0), vec2f(east, north) / length, length > 1e-6);
    let share = params.speed_min + uniform01(size.z) * (1.0 - params.speed_min);
    let velocity = direction * (params.speed * share);

    let box = env * BOX * count + slot;
    boxes[box + BOX_X * count] = centre.x;
    boxes[box + BOX_Z * count] = centre.y;
    boxes[box + HALF_X * count] = half.x;
    boxes[box + HALF_Z * count] = half.y;
    obstacle_velocity[env * VELOCITY_DIM * count + slot] = velocity.x;
    obstacle_velocity[(env * VELOCITY_DIM + 1u) * count + slot] = velocity.y;
}
