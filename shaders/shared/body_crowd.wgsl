// The bodies of every environment, from where their simulation keeps them.
//
// poses   [bodies * 7][envs]
// starts  [..][envs]          of which the first two rows are where the episodes began, x and y

#import crowd
#import spatial

@group(2) @binding(0) var<storage, read> poses: array<f32>;
@group(2) @binding(1) var<storage, read> starts: array<f32>;
@group(2) @binding(3) var<uniform> crowd: Crowd;

struct BodyPose {
    // m
    position: vec3f,
    // Quaternion.
    rotation: vec4f,
}

fn pose_number(body: u32, field: u32, env: u32) -> f32 {
    return poses[(7u * body + field) * crowd.envs + env];
}

fn body_pose(body: u32, env: u32) -> BodyPose {
    let position = vec3f(pose_number(body, 0u, env), pose_number(body, 1u, env), pose_number(body, 2u, env));
    let vector = vec3f(pose_number(body, 3u, env), pose_number(body, 4u, env), pose_number(body, 5u, env));
    return BodyPose(position, vec4f(vector, pose_number(body, 6u, env)));
}

// A direction of a simulated world in the scene, where y is up instead of z.
fn upright(direction: vec3f) -> vec3f {
    return direction.yzx;
}

// A point of a body (m) in the scene: episodes begin where their environment stands in the crowd.
fn in_scene(pose: BodyPose, point: vec3f, env: u32) -> vec3f {
    let start = vec3f(starts[env], starts[crowd.envs + env], 0.0);
    let ground = origin(crowd, env);
    return upright(pose.position + rotate(pose.rotation, point) - start) + vec3f(ground.x, 0.0, ground.y);
}
