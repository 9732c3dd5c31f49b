//! Rows by their numbers. Shader: `shaders/learn/gather_rows.wgsl`.

use crate::gpu::{Buffer, Gpu, shader};
use bytemuck::Pod;

crate::shader_params! {
    pub struct Params for gather_rows {
        /// Rows that are gathered.
        pub rows: u32,
        /// Numbers of a row.
        pub width: u32,
    }
}

/// Queues the shader on `gpu`: writes the rows of `table`, `[..][width]`, that have these `numbers`, `[rows]`, to `out`,
/// `[rows][width]`.
pub fn launch<T: Pod>(
    gpu: &Gpu,
    table: &Buffer<T>,
    numbers: &Buffer<u32>,
    out: &Buffer<T>,
    params: &Params,
) {
    let [across, down, _] = shader::GATHER_ROWS.workgroup;
    let groups = [params.width.div_ceil(across), params.rows.div_ceil(down), 1];
    gpu.launch(&shader::GATHER_ROWS, groups, &[table, numbers, out], params);
}

/// The shader's computation on the host.
pub fn twin<T: Copy>(table: &[T], numbers: &[u32], out: &mut [T], params: &Params) {
    let width = params.width as usize;
    let rows = numbers.iter().zip(out.chunks_exact_mut(width));
    for (&number, out) in rows.take(params.rows as usize) {
        out.copy_from_slice(&table[number as usize * width..][..width]);
    }
}
