// Where the shapes of a world touch . One invocation an environment.
//
// geoms        [geoms][GEOM_DIM]
// model_table   see `model_table`
// poses        [bodies * 7][envs]: position, quaternion x y z w
// contacts     [max_contacts * 10][envs]: position, normal, first tangent, distance
// contact_ids  [max_contacts][envs]: pair * 8 + point, the same from step to step
// counts       [2][envs]: contacts kept, contacts that found no slot: the shallowest

#import model_table
#import spatial
#import contact
#import contact_plane
#import contact_capsule
#import contact_capsule_box
#import contact_box_box

struct Params {
    envs: u32,
    max_contacts: u32,
}

@group(0) @binding(0) var<storage, read_write> geoms: array<f32>;
@group(0) @binding(1) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(2) var<storage, read_write> poses: array<f32>;
@group(0) @binding(3) var<storage, read_write> contacts: array<f32>;
@group(0) @binding(4) var<storage, read_write> contact_ids: array<u32>;
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var<uniform> params: Params;

// A geom.
const GEOM_BODY = 0u;  // -1 for what stands still
const GEOM_KIND = 1u;  // of `touch`
const GEOM_SIZE = 2u;  // 3: radius and half length, or half sizes
const GEOM_POSITION = 5u; // 3
const GEOM_ROTATION = 8u;  // 4, x y z w
const GEOM_BOUNDING_RADIUS = 12u;
const GEOM_DIM = 13u;

const GEOM_BOUND = 64u;

// Of each geom its place in the world, and how far it reaches from there.
var<private> spheres: array<vec4f, GEOM_BOUND>;
var<private> rotations: array<vec4f, GEOM_BOUND>;

fn geom3(at: u32) -> vec3f { return vec3f(geoms[at], geoms[at + 1u], geoms[at + 2u]); }
fn pose3(at: u32) -> vec3f {
    let e = params.envs;
    return vec3f(poses[at * e + env], poses[(at + 1u) * e + env], poses[(at + 2u) * e + env]);
}

fn place_geoms() {
    for (var geom = 0u; geom < model_table[GEOM_COUNT]; geom++) {
        let at = geom * GEOM_DIM;
        var position = geom3(at + GEOM_POSITION);
        var rotation = vec4f(geom3(at + GEOM_ROTATION), geoms[at + GEOM_ROTATION + 3u]);
        if (geoms[at + GEOM_BODY] >= 0.0) {
            let body = u32(geoms[at + GEOM_BODY]) * 7u;
            let pose = vec4f(pose3(body + 3u), poses[(body + 6u) * params.envs + env]);
            position = pose3(body) + rotate(pose, position);
            rotation = quat_mul(pose, rotation);
        }
        spheres[geom] = vec4f(position, geoms[at + GEOM_BOUNDING_RADIUS]);
        rotations[geom] = rotation;
    }
}

fn matrix_of(q: vec4f) -> mat3x3f {
    let x = 2.0 * q.x * q.xyz;
    let y = 2.0 * q.y * q.xyz;
    let z = 2.0 * q.z * q.xyz;
    let w = 2.0 * q.w * q.xyz;
    return mat3x3f(
        1.0 - y.y - z.z, x.y + w.z, x.z - w.y,
        x.y - w.z, 1.0 - x.x - z.z, y.z + w.x,
        x.z + w.y, y.z - w.x, 1.0 - x.x - y.y,
    );
}

fn world_geom(geom: u32) -> WorldGeom {
    let at = geom * GEOM_DIM;
    let kind = u32(geoms[at + GEOM_KIND]);
    return WorldGeom(kind, geom3(at + GEOM_SIZE), spheres[geom].xyz, matrix_of(rotations[geom]));
}

// Whether a sphere around the second leaves no doubt that they do not touch.
fn bounding_spheres_apart(first: u32, second: u32, plane: bool) -> bool {
    let between = spheres[second].xyz - spheres[first].xyz;
    let sum = spheres[first].w + spheres[second].w;
    if (plane) { return dot(rotate(rotations[first], vec3f(0.0, 0.0, 1.0)), between) > sum; }
    return dot(between, between) > sum * sum;
}

// Pairs that may touch, of some in a row. Software adapters run both sides of a branch, but a loop no
// oftener than the busiest lane needs: so the costly comparison comes after, and for these alone.
const ROW = 128u;
var<private> near: array<u32, ROW>;

fn broad_phase(start: u32, to: u32, plane: bool) -> u32 {
    var count = 0u;
    for (var index = start; index < min(start + ROW, to); index++) {
        let geoms_at = model_table[PAIRS_AT] + index * PAIR + PAIR_GEOMS;
        if (bounding_spheres_apart(model_table[geoms_at], model_table[geoms_at + 1u], plane)) { continue; }
        near[count] = index;
        count++;
    }
    return count;
}

fn first_geom(index: u32) -> WorldGeom { return world_geom(model_table[model_table[PAIRS_AT] + index * PAIR + PAIR_GEOMS]); }
fn second_geom(index: u32) -> WorldGeom { return world_geom(model_table[model_table[PAIRS_AT] + index * PAIR + PAIR_GEOMS + 1u]); }

@compute @workgroup_size(64)
fn collision(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    place_geoms();
    for (var start = 0u; start < model_table[PLANE_CAPSULE]; start += ROW) {
        let count = broad_phase(start, model_table[PLANE_CAPSULE], true);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            let second = second_geom(pair);
            if (second.kind != PLANE) { plane_capsule(first_geom(pair), second); }
        }
    }
    for (var start = model_table[PLANE_CAPSULE]; start < model_table[PLANE_BOX]; start += ROW) {
        let count = broad_phase(start, model_table[PLANE_BOX], true);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            plane_box(first_geom(pair), second_geom(pair));
        }
    }
    for (var start = model_table[PLANE_BOX]; start < model_table[CAPSULE_CAPSULE]; start += ROW) {
        let count = broad_phase(start, model_table[CAPSULE_CAPSULE], false);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            capsule_capsule(first_geom(pair), second_geom(pair));
        }
    }
    for (var start = model_table[CAPSULE_CAPSULE]; start < model_table[CAPSULE_BOX]; start += ROW) {
        let count = broad_phase(start, model_table[CAPSULE_BOX], false);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            capsule_box(first_geom(pair), second_geom(pair));
        }
    }
    for (var start = model_table[CAPSULE_BOX]; start < model_table[BOX_BOX]; start += ROW) {
        let count = broad_phase(start, model_table[BOX_BOX], false);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            box_box(first_geom(pair), second_geom(pair));
        }
    }
    counts[env] = kept;
    counts[params.envs + env] = overflow;
}
