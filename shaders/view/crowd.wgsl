// Every environment's character and its target, drawn from the worlds' own buffers: one instance a
// bone, and one more a target.
//
// state_f32  [STATE_F32_FIELDS][envs]
// state_u32  [STATE_U32_FIELDS][envs]
// points     [frames][points]   the bones' ends in the character frame, in shares of REACH
// bones      [bones]

#import crowd
#import locomotion_layout
#import math
#import round
#import solid

struct Bone {
    // Numbers of its ends' points.
    a: u32,
    b: u32,
    // m
    radius_a: f32,
    radius_b: f32,
    colour: vec4f,
}

@group(2) @binding(0) var<storage, read> state_f32: array<f32>;
@group(2) @binding(1) var<storage, read> state_u32: array<u32>;
@group(2) @binding(2) var<storage, read> points: array<vec2u>;
@group(2) @binding(3) var<storage, read> bones: array<Bone>;
@group(2) @binding(4) var<uniform> crowd: Crowd;

// Farthest of a body's points from its origin, m.
const REACH = 4.0;
const TARGET = vec3f(0.06, 0.50, 0.22);

fn field(place: u32, env: u32) -> f32 {
    return state_f32[place * crowd.envs + env];
}

fn end(point: u32, env: u32, radius: f32) -> vec4f {
    let frame = state_u32[FRAME * crowd.envs + env];
    let packed = points[frame * crowd.points + point];
    let xy = REACH * unpack2x16snorm(packed.x);
    let z = REACH * unpack2x16snorm(packed.y).x;
    let heading = vec2f(field(HEADING_X, env), field(HEADING_Z, env));
    let ground = origin(crowd, env) + vec2f(field(X, env), field(Z, env)) + to_world(vec2f(xy.x, z), heading);
    return vec4f(ground.x, xy.y, ground.y, radius);
}

@vertex
fn place(
    @builtin(instance_index) instance: u32,
    // As of `capsule`.
    @location(0) unit: vec4f,
) -> Corner {
    let env = instance / (crowd.bones + 1u);
    let index = instance % (crowd.bones + 1u);
    var a: vec4f;
    var b: vec4f;
    var colour = TARGET;
    if (index < crowd.bones) {
        let bone = bones[index];
        a = end(bone.a, env, bone.radius_a);
        b = end(bone.b, env, bone.radius_b);
        colour = bone.colour.xyz;
    } else {
        let ground = origin(crowd, env) + vec2f(field(TARGET_X, env), field(TARGET_Z, env));
        a = vec4f(ground.x, 0.0, ground.y, 0.06);
        b = vec4f(ground.x, 0.5, ground.y, 0.12);
    }
    let surface = capsule_surface(unit.xyz, unit.w, a, b);
    return seen(surface.at, surface.normal, colour);
}
