// Where the shapes of a world touch (src/body/collide.rs). One invocation an environment.
//
// geoms    [geoms][GEOM]
// tables   see `tables`
// poses    [bodies * 7][envs]: place, quaternion x y z w
// touches  [slots * 10][envs]: place, normal, first tangent, distance
// keys     [slots][envs]: pair * 8 + point, the same from step to step
// counts   [2][envs]: contacts kept, contacts that found no slot

#import tables
#import spatial
#import touch
#import touch_plane
#import touch_round
#import touch_round_box
#import touch_box_box

struct Params {
    envs: u32,
    slots: u32,
}

@group(0) @binding(0) var<storage, read_write> geoms: array<f32>;
@group(0) @binding(1) var<storage, read_write> tables: array<u32>;
@group(0) @binding(2) var<storage, read_write> poses: array<f32>;
@group(0) @binding(3) var<storage, read_write> touches: array<f32>;
@group(0) @binding(4) var<storage, read_write> keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var<uniform> params: Params;

// A geom.
const GEOM_BODY = 0u;  // -1 for what stands still
const GEOM_KIND = 1u;  // of `touch`
const GEOM_SIZE = 2u;  // 3: radius and half length, or half sizes
const GEOM_PLACE = 5u; // 3
const GEOM_TURN = 8u;  // 4, x y z w
const GEOM_REACH = 12u;
const GEOM = 13u;

const GEOMS_MOST = 64u;

// Of each geom its place in the world, and how far it reaches from there.
var<private> spheres: array<vec4f, GEOMS_MOST>;
var<private> turns: array<vec4f, GEOMS_MOST>;

fn geom3(at: u32) -> vec3f { return vec3f(geoms[at], geoms[at + 1u], geoms[at + 2u]); }
fn pose3(at: u32) -> vec3f {
    let e = params.envs;
    return vec3f(poses[at * e + env], poses[(at + 1u) * e + env], poses[(at + 2u) * e + env]);
}

fn place_geoms() {
    for (var geom = 0u; geom < tables[GEOM_COUNT]; geom++) {
        let at = geom * GEOM;
        var place = geom3(at + GEOM_PLACE);
        var turn = vec4f(geom3(at + GEOM_TURN), geoms[at + GEOM_TURN + 3u]);
        if (geoms[at + GEOM_BODY] >= 0.0) {
            let body = u32(geoms[at + GEOM_BODY]) * 7u;
            let pose = vec4f(pose3(body + 3u), poses[(body + 6u) * params.envs + env]);
            place = pose3(body) + rotate(pose, place);
            turn = turned(pose, turn);
        }
        spheres[geom] = vec4f(place, geoms[at + GEOM_REACH]);
        turns[geom] = turn;
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

fn placed(geom: u32) -> Placed {
    let at = geom * GEOM;
    let kind = u32(geoms[at + GEOM_KIND]);
    return Placed(kind, geom3(at + GEOM_SIZE), spheres[geom].xyz, matrix_of(turns[geom]));
}

// Whether a sphere around the second leaves no doubt that they do not touch.
fn apart(first: u32, second: u32, plane: bool) -> bool {
    let between = spheres[second].xyz - spheres[first].xyz;
    let reach = spheres[first].w + spheres[second].w;
    if (plane) { return dot(rotate(turns[first], vec3f(0.0, 0.0, 1.0)), between) > reach; }
    return dot(between, between) > reach * reach;
}

// Pairs that may touch, of some in a row. Software adapters run both sides of a branch, but a loop no
// oftener than the busiest lane needs: so the costly comparison comes after, and for these alone.
const ROW = 128u;
var<private> near: array<u32, ROW>;

fn sift(start: u32, to: u32, plane: bool) -> u32 {
    var count = 0u;
    for (var index = start; index < min(start + ROW, to); index++) {
        let geoms_at = tables[PAIRS_AT] + index * PAIR + PAIR_GEOMS;
        if (apart(tables[geoms_at], tables[geoms_at + 1u], plane)) { continue; }
        near[count] = index;
        count++;
    }
    return count;
}

fn leader(index: u32) -> Placed { return placed(tables[tables[PAIRS_AT] + index * PAIR + PAIR_GEOMS]); }
fn partner(index: u32) -> Placed { return placed(tables[tables[PAIRS_AT] + index * PAIR + PAIR_GEOMS + 1u]); }

@compute @workgroup_size(64)
fn collision(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    place_geoms();
    for (var start = 0u; start < tables[PLANE_ROUND]; start += ROW) {
        let count = sift(start, tables[PLANE_ROUND], true);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            let second = partner(pair);
            if (second.kind != PLANE) { plane_round(leader(pair), second); }
        }
    }
    for (var start = tables[PLANE_ROUND]; start < tables[PLANE_BOX]; start += ROW) {
        let count = sift(start, tables[PLANE_BOX], true);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            plane_box(leader(pair), partner(pair));
        }
    }
    for (var start = tables[PLANE_BOX]; start < tables[ROUND_ROUND]; start += ROW) {
        let count = sift(start, tables[ROUND_ROUND], false);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            round_round(leader(pair), partner(pair));
        }
    }
    for (var start = tables[ROUND_ROUND]; start < tables[ROUND_BOX]; start += ROW) {
        let count = sift(start, tables[ROUND_BOX], false);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            round_box(leader(pair), partner(pair));
        }
    }
    for (var start = tables[ROUND_BOX]; start < tables[BOX_BOX]; start += ROW) {
        let count = sift(start, tables[BOX_BOX], false);
        for (var i = 0u; i < count; i++) {
            pair = near[i];
            box_box(leader(pair), partner(pair));
        }
    }
    counts[env] = kept;
    counts[params.envs + env] = overflow;
}
