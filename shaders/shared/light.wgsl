// How everything in a picture is lit: a sun with soft shadows, a sky that brightens what looks up,
// and haze that takes the far ground to the colour of the sky.

struct View {
    // World to clip space, of the camera or, where shadows are drawn, of the sun.
    clip: mat4x4f,
    // World to the shadow map's clip space.
    sunlit: mat4x4f,
    eye: vec3f,
    // Distance of half the haze, m.
    haze: f32,
    // Unit vector towards the sun.
    sun: vec3f,
    // Radius of the shadows' soft edge, in shares of the shadow map.
    soft: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(1) @binding(0) var shadows: texture_depth_2d;
@group(1) @binding(1) var compare: sampler_comparison;

const SKY = vec3f(0.70, 0.77, 0.84);
const TAPS = 16u;
// Whether colours are written as sRGB values, where the target does not encode them itself.
const ENCODES = false;

// Share of the sun that reaches a point: taps on a spiral around its place in the shadow map.
fn sunlight(at: vec3f, normal: vec3f) -> f32 {
    // A surface must not shade itself: look a little above it.
    let clip = view.sunlit * vec4f(at + 0.02 * normal, 1.0);
    let place = vec2f(0.5 + 0.5 * clip.x, 0.5 - 0.5 * clip.y);
    if (any(place < vec2f(0.0)) || any(place > vec2f(1.0))) { return 1.0; }
    var lit = 0.0;
    for (var tap = 0u; tap < TAPS; tap++) {
        let angle = 2.399963 * f32(tap);
        let radius = view.soft * sqrt((f32(tap) + 0.5) / f32(TAPS));
        let offset = radius * vec2f(cos(angle), sin(angle));
        lit += textureSampleCompareLevel(shadows, compare, place + offset, clip.z - 0.0005);
    }
    return lit / f32(TAPS);
}

fn hazy(at: vec3f, colour: vec3f) -> vec4f {
    let far = distance(at, view.eye) / view.haze;
    let linear = mix(SKY, colour, exp2(-far * far));
    if (!ENCODES) { return vec4f(linear, 1.0); }
    let bright = 1.055 * pow(linear, vec3f(1.0 / 2.4)) - 0.055;
    return vec4f(select(bright, 12.92 * linear, linear < vec3f(0.0031308)), 1.0);
}

// Light that a surface of a colour sends to the eye.
fn shade(at: vec3f, normal: vec3f, colour: vec3f) -> vec4f {
    let facing = max(dot(normal, view.sun), 0.0);
    let sun = 0.85 * facing * sunlight(at, normal);
    let sky = mix(vec3f(0.22, 0.20, 0.19), vec3f(0.42, 0.46, 0.52), 0.5 + 0.5 * normal.y);
    let halfway = normalize(view.sun + normalize(view.eye - at));
    let shine = 0.12 * pow(max(dot(normal, halfway), 0.0), 24.0) * sun;
    return hazy(at, colour * (sky + sun * vec3f(1.0, 0.96, 0.88)) + shine);
}
