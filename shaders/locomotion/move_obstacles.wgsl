// Moves the obstacles for one step; they bounce at the square's edge. One invocation an obstacle.
//
// boxes              [envs][BOX][count]
// obstacle_velocity  [envs][VELOCITY_DIM][count]

#import locomotion_layout
#import obstacles

struct Params {
    envs: u32,
    count: u32,
    time: f32,
    square: f32,
}

@group(0) @binding(0) var<storage, read_write> boxes: array<f32>;
@group(0) @binding(1) var<storage, read_write> obstacle_velocity: array<f32>;
@group(0) @binding(2) var<uniform> params: Params;

@compute @workgroup_size(256)
fn move_obstacles(@builtin(global_invocation_id) id: vec3u) {
    let count = params.count;
    let env = id.x / max(count, 1u);
    let slot = id.x % max(count, 1u);
    if (env >= params.envs) { return; }
    for (var axis = 0u; axis < VELOCITY_DIM; axis++) {
        let place = (env * BOX + axis) * count + slot;
        let speed = (env * VELOCITY_DIM + axis) * count + slot;
        let bounced = bounce(boxes[place], obstacle_velocity[speed], params.time, params.square);
        boxes[place] = bounced.place;
        obstacle_velocity[speed] = bounced.velocity;
    }
}
