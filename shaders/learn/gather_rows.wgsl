// Rows by their numbers. One invocation a number of a row.
//
// table    [..][width]   numbers of any kind
// numbers  [rows]
// out      [rows][width]

struct Params {
    rows: u32,
    width: u32,
}

@group(0) @binding(0) var<storage, read> table: array<u32>;
@group(0) @binding(1) var<storage, read> numbers: array<u32>;
@group(0) @binding(2) var<storage, read_write> out: array<u32>;
@group(0) @binding(3) var<uniform> params: Params;

@compute @workgroup_size(4, 64)
fn gather_rows(@builtin(global_invocation_id) id: vec3u) {
    let column = id.x;
    let row = id.y;
    if (column >= params.width || row >= params.rows) { return; }
    out[row * params.width + column] = table[numbers[row] * params.width + column];
}
