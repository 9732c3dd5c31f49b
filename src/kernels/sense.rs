//! The two obstacle maps of every character (paper, section 4). Shader: `shaders/world/sense.wgsl`.

use super::layout::{CELL, CELLS, MAPS, boxes, real, whole};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::frame::to_world;
use multiversion::multiversion;
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for sense {
        pub envs: u32,
        /// Obstacles of an environment.
        pub count: u32,
        /// 1: only the episodes that have just begun; 0: only the others.
        pub begun: u32,
    }
}

/// No cell's centre is farther from the character than this along an axis, m: 7.5 cells on the
/// diagonal, and some room for rounding.
const REACH: f32 = 4.0;

pub fn launch(
    gpu: &Gpu,
    boxes: &Buffer<f32>,
    real: &Buffer<f32>,
    whole: &Buffer<u32>,
    maps: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::SENSE, params.envs as usize * CELLS);
    gpu.launch(&shader::SENSE, groups, &[boxes, real, whole, maps], params);
}

pub fn twin(boxes: &[f32], real: &[f32], whole: &[u32], maps: &mut [u32], params: &Params) {
    let (envs, count) = (params.envs as usize, params.count as usize);
    let worlds = maps.par_chunks_exact_mut(MAPS * CELLS).enumerate();
    worlds.with_min_len(16).for_each(|(env, maps)| {
        let begun = whole[whole::AGE * envs + env] == 0;
        if begun != (params.begun == 1) {
            return;
        }
        let r = |field: usize| real[field * envs + env];
        let boxes = &boxes[env * boxes::FIELDS * count..][..boxes::FIELDS * count];
        let at = [r(real::X), r(real::Z)];
        let now = map(boxes, count, at, [r(real::HEADING_X), r(real::HEADING_Z)]);
        let (current, previous) = maps.split_at_mut(CELLS);
        previous.copy_from_slice(if begun { &now } else { current });
        current.copy_from_slice(&now);
    });
}

/// A cell's centre along one axis of the character frame, m. Exact in floating point.
pub fn centre(cell: usize) -> f32 {
    (cell as f32 - 7.5) * CELL
}

/// Bits of every row, among an environment's boxes `[boxes::FIELDS][count]`.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn map(boxes: &[f32], count: usize, at: [f32; 2], heading: [f32; 2]) -> [u32; CELLS] {
    let rows: [[[f32; CELLS]; 2]; CELLS] = std::array::from_fn(|row| {
        let points: [[f32; 2]; CELLS] =
            std::array::from_fn(|column| to_world([centre(column), centre(row)], heading));
        [0, 1].map(|axis| points.map(|moved| at[axis] + moved[axis]))
    });
    let field = |field: usize| &boxes[field * count..][..count];
    let (x, z) = (field(boxes::X), field(boxes::Z));
    let (half_x, half_z) = (field(boxes::HALF_X), field(boxes::HALF_Z));
    let mut map = [0; CELLS];
    for slot in 0..count {
        let near = (x[slot] - at[0]).abs() <= half_x[slot] + REACH
            && (z[slot] - at[1]).abs() <= half_z[slot] + REACH;
        if !near {
            continue;
        }
        for (bits, [xs, zs]) in map.iter_mut().zip(&rows) {
            for (column, (px, pz)) in xs.iter().zip(zs).enumerate() {
                let inside =
                    ((px - x[slot]).abs() <= half_x[slot]) & ((pz - z[slot]).abs() <= half_z[slot]);
                *bits |= u32::from(inside) << column;
            }
        }
    }
    map
}
