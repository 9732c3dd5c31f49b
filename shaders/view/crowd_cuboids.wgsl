// Every environment's obstacles, drawn from the environments' own buffer, one instance each.
//
// boxes  [envs][BOX][count]

#import crowd
#import locomotion_layout
#import solid

@group(2) @binding(0) var<storage, read> boxes: array<f32>;
@group(2) @binding(1) var<uniform> crowd: Crowd;

const COLOUR = vec3f(0.42, 0.34, 0.30);
// m
const HEIGHT = 0.35;

@vertex
fn place(
    @builtin(instance_index) instance: u32,
    // As of `cuboid`.
    @location(0) corner: vec3f,
    @location(1) normal: vec3f,
) -> Corner {
    let env = instance / crowd.count;
    let slot = instance % crowd.count;
    let first = env * BOX * crowd.count + slot;
    // Obstacles overlap: each has its own height and shade.
    let own = fract(0.618034 * f32(slot));
    let height = HEIGHT * (0.8 + 0.4 * own);
    let centre = origin(crowd, env) + vec2f(boxes[first], boxes[first + crowd.count]);
    let half = vec2f(boxes[first + HALF_X * crowd.count], boxes[first + HALF_Z * crowd.count]);
    let across = centre + half * corner.xz;
    let at = vec3f(across.x, 0.5 * height * (1.0 + corner.y), across.y);
    return seen(at, normal, COLOUR * (0.75 + 0.5 * own));
}
