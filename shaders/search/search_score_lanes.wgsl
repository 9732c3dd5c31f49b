// Scores every block of the database for every query: the largest of q.r - |r|^2 / 2 over the
// block's rows, which is (|q|^2 - |q - r|^2) / 2. One multiply-add a dimension; search_exact then
// looks closely at the few blocks that rounding leaves in question.
//
// The form for software adapters: queries across lanes and 32 of them an invocation, because
// lavapipe fetches a row lane by lane even where all lanes want the same one; so each fetch must
// serve many queries. Measured there at 65k rows: 217 us a query with 8 queries an invocation,
// 175 with 16, 84 with 32. An invocation stays far below the 65,535 loop iterations after which
// lavapipe silently stops looping.
//
// rows     [candidates][QUADS] of vec4   normalised features; the last number is -|r|^2 / 2
// queries  [count][QUADS] of vec4        the last number is 1
// score    [blocks][count]

#import locomotion_layout

struct Params {
    count: u32,
    candidates: u32,
    block: u32,
    // Blocks an invocation scores.
    run: u32,
}

@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read> queries: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> score: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const LANES = 8u;
const QUERIES = 32u; // an invocation
const LEAST = vec4f(-3.4e38);

struct Feature { a: vec4f, b: vec4f, c: vec4f, d: vec4f, e: vec4f, f: vec4f, g: vec4f }
struct Four { a: Feature, b: Feature, c: Feature, d: Feature }

fn dot28(p: Feature, q: Feature) -> f32 {
    let sum = fma(p.g, q.g, fma(p.f, q.f, fma(p.e, q.e, fma(p.d, q.d, fma(p.c, q.c, fma(p.b, q.b, p.a * q.a))))));
    return (sum.x + sum.y) + (sum.z + sum.w);
}

fn scores(row: Feature, q: Four) -> vec4f {
    return vec4f(dot28(row, q.a), dot28(row, q.b), dot28(row, q.c), dot28(row, q.d));
}

fn load_row(at: u32) -> Feature {
    let i = at * QUADS;
    return Feature(rows[i], rows[i + 1u], rows[i + 2u], rows[i + 3u], rows[i + 4u], rows[i + 5u], rows[i + 6u]);
}

// Queries past the end repeat the last one and are not written.
fn load_query(at: u32) -> Feature {
    let i = min(at, params.count - 1u) * QUADS;
    return Feature(queries[i], queries[i + 1u], queries[i + 2u], queries[i + 3u], queries[i + 4u], queries[i + 5u], queries[i + 6u]);
}

fn load_four(at: u32) -> Four {
    return Four(load_query(at), load_query(at + LANES), load_query(at + 2u * LANES), load_query(at + 3u * LANES));
}

fn write(block: u32, at: u32, best: vec4f) {
    let row = block * params.count;
    for (var i = 0u; i < 4u; i++) {
        let query = at + i * LANES;
        if (query < params.count) {
            score[row + query] = best[i];
        }
    }
}

@compute @workgroup_size(8)
fn search_score_lanes(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let first = group.x * LANES * QUERIES + local.x;
    let four = 4u * LANES;
    let q0 = load_four(first + 0u * four);
    let q1 = load_four(first + 1u * four);
    let q2 = load_four(first + 2u * four);
    let q3 = load_four(first + 3u * four);
    let q4 = load_four(first + 4u * four);
    let q5 = load_four(first + 5u * four);
    let q6 = load_four(first + 6u * four);
    let q7 = load_four(first + 7u * four);
    let blocks = (params.candidates + params.block - 1u) / params.block;
    let last = min((group.y + 1u) * params.run, blocks);
    for (var block = group.y * params.run; block < last; block++) {
        var best0 = LEAST;
        var best1 = LEAST;
        var best2 = LEAST;
        var best3 = LEAST;
        var best4 = LEAST;
        var best5 = LEAST;
        var best6 = LEAST;
        var best7 = LEAST;
        let end = min((block + 1u) * params.block, params.candidates);
        for (var at = block * params.block; at < end; at++) {
            let row = load_row(at);
            best0 = max(best0, scores(row, q0));
            best1 = max(best1, scores(row, q1));
            best2 = max(best2, scores(row, q2));
            best3 = max(best3, scores(row, q3));
            best4 = max(best4, scores(row, q4));
            best5 = max(best5, scores(row, q5));
            best6 = max(best6, scores(row, q6));
            best7 = max(best7, scores(row, q7));
        }
        write(block, first + 0u * four, best0);
        write(block, first + 1u * four, best1);
        write(block, first + 2u * four, best2);
        write(block, first + 3u * four, best3);
        write(block, first + 4u * four, best4);
        write(block, first + 5u * four, best5);
        write(block, first + 6u * four, best6);
        write(block, first + 7u * four, best7);
    }
}
