// The leaves of the index (src/matching) that may hold something nearer to a query than what is known,
// or as near: those whose bound is within the limit.
//
// Sixteen queries an invocation: lavapipe fetches a box lane by lane even where all lanes want the
// same one, so each fetch must serve many queries.
//
// boxes, distance_codes, shown, query_projection  as in search_seed
// distance   [LANES][count]   squared, of the best that each lane knows
// leaf_mask  [words][count]   bit i of word w: leaf first + 32 w + i

#import locomotion_layout
#import search_index

struct Params {
    count: u32,
    groups: u32,
    // The leaves tested, a multiple of 32, and how many of them an invocation tests.
    first: u32,
    last: u32,
    run: u32,
    // Frames of the database: word of `distance_codes` where those of the groups begin.
    frames: u32,
    // Word of `distance_codes` where those of the leaves begin; 0 if there are none.
    leaf_codes: u32,
    // Distance a unit of a byte.
    step: f32,
}

@group(0) @binding(0) var<storage, read> boxes: array<vec4f>;
@group(0) @binding(1) var<storage, read> distance_codes: array<u32>;
@group(0) @binding(2) var<storage, read> shown: array<u32>;
@group(0) @binding(3) var<storage, read> query_projection: array<f32>;
@group(0) @binding(4) var<storage, read> distance: array<f32>;
@group(0) @binding(5) var<storage, read_write> leaf_mask: array<u32>;
@group(0) @binding(6) var<uniform> params: Params;

const QUERIES = 16u; // an invocation

struct Four { t: Projected, limit: vec4f, block_row: vec4u }

fn load_box(box: u32) -> Box {
    let i = CORNERS * (PCA_BOXES + box);
    return Box(boxes[i], boxes[i + 1u], boxes[i + 2u], boxes[i + 3u], boxes[i + 4u], boxes[i + 5u]);
}

fn load_projection(number: u32, at: vec4u) -> vec4f {
    let i = number * params.count + at;
    return vec4f(query_projection[i.x], query_projection[i.y], query_projection[i.z], query_projection[i.w]);
}

fn limit_at(at: u32) -> f32 {
    var least = distance[at];
    for (var lane = 1u; lane < LANES; lane++) {
        least = min(least, distance[lane * params.count + at]);
    }
    return limit_of(least, query_projection[12u * params.count + at]);
}

// Queries past the end repeat the last one and are not written.
fn load_four(first: u32) -> Four {
    let at = min(first + vec4u(0u, LANES, 2u * LANES, 3u * LANES), vec4u(params.count - 1u));
    let t = Projected(
        load_projection(0u, at), load_projection(1u, at), load_projection(2u, at), load_projection(3u, at),
        load_projection(4u, at), load_projection(5u, at), load_projection(6u, at), load_projection(7u, at),
        load_projection(8u, at), load_projection(9u, at), load_projection(10u, at), load_projection(11u, at),
    );
    let limit = vec4f(limit_at(at.x), limit_at(at.y), limit_at(at.z), limit_at(at.w));
    let block_row = vec4u(distance_codes[shown[at.x]], distance_codes[shown[at.y]], distance_codes[shown[at.z]], distance_codes[shown[at.w]]) * params.groups;
    return Four(t, limit, block_row);
}

// The codes of four neighbouring leaves; a group's own code holds for each of its leaves.
fn codes_at(block_row: u32, leaf: u32) -> u32 {
    let group = block_row + leaf / GROUP;
    let word = select(params.leaf_codes + (block_row * GROUP + leaf) / 4u, params.frames + group / 4u, params.leaf_codes == 0u);
    let found = distance_codes[word];
    return select(found, (found >> (8u * (group % 4u)) & 0xffu) * 0x01010101u, params.leaf_codes == 0u);
}

fn four_codes(four: Four, leaf: u32) -> vec4u {
    let row = four.block_row;
    return vec4u(codes_at(row.x, leaf), codes_at(row.y, leaf), codes_at(row.z, leaf), codes_at(row.w, leaf));
}

fn bits(box: Box, four: Four, codes: vec4u, bit: u32) -> vec4u {
    let bound = bounds(box, four.t, squares(codes, params.step));
    return select(vec4u(bit), vec4u(0u), bound > four.limit);
}

fn write(word: u32, at: u32, found: vec4u) {
    let row = word * params.count;
    for (var i = 0u; i < 4u; i++) {
        let query = at + i * LANES;
        if (query < params.count) {
            leaf_mask[row + query] = found[i];
        }
    }
}

@compute @workgroup_size(8)
fn search_prune(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let at = group.x * LANES * QUERIES + local.x;
    let four = 4u * LANES;
    let a = load_four(at);
    let b = load_four(at + four);
    let c = load_four(at + 2u * four);
    let d = load_four(at + 3u * four);
    let first = params.first + group.y * params.run;
    let last = min(first + params.run, params.last);
    for (var word = first; word < last; word += 32u) {
        var in_a = vec4u(0u);
        var in_b = vec4u(0u);
        var in_c = vec4u(0u);
        var in_d = vec4u(0u);
        let end = min(word + 32u, last);
        for (var quad = word; quad < end; quad += 4u) {
            let codes_a = four_codes(a, quad);
            let codes_b = four_codes(b, quad);
            let codes_c = four_codes(c, quad);
            let codes_d = four_codes(d, quad);
            for (var i = 0u; i < 4u; i++) {
                let box = load_box(params.groups + quad + i);
                let bit = 1u << (quad + i - word);
                let shift = vec4u(8u * i);
                in_a |= bits(box, a, codes_a >> shift, bit);
                in_b |= bits(box, b, codes_b >> shift, bit);
                in_c |= bits(box, c, codes_c >> shift, bit);
                in_d |= bits(box, d, codes_d >> shift, bit);
            }
        }
        let row = (word - params.first) / 32u;
        write(row, at, in_a);
        write(row, at + four, in_b);
        write(row, at + 2u * four, in_c);
        write(row, at + 3u * four, in_d);
    }
}
