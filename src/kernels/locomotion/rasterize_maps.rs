//! The two obstacle maps of every character (paper, section 4). Shader:
//! `shaders/locomotion/rasterize_maps.wgsl`.

use super::locomotion_layout::{
    CELL, CELLS, FULL, MAP_WORDS, ROW, VELOCITY_DIM, boxes, state_f32, state_u32,
};
use super::obstacles::{bounce, depth};
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::character_frame::to_world;
use multiversion::multiversion;
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for rasterize_maps {
        /// Environments of the batch.
        pub envs: u32,
        /// Obstacles of an environment.
        pub count: u32,
        /// 1: only the episodes that have just begun; 0: only the others.
        pub just_reset: u32,
        /// Half the side of the obstacles' square, m.
        pub square: f32,
        /// Width over which a cell rises from 0 to 1 across an obstacle's edge, m; 0 for a step.
        pub edge: f32,
        /// The other map shows what was there so long ago, s; 0 for what was seen a step before.
        pub back: f32,
    }
}

/// No cell's centre is farther from the character than this along an axis, m: 7.5 cells on the
/// diagonal, and some room for rounding.
const REACH: f32 = 4.0;

/// Queues the shader on `gpu`.
///
/// `boxes` is `[envs][boxes::FIELDS][count]`, `obstacle_velocity` `[envs][VELOCITY_DIM][count]`,
/// `state_f32` `[state_f32::FIELDS][envs]`, `state_u32` `[state_u32::FIELDS][envs]`, `maps`
/// `[envs][MAP_WORDS]`.
pub fn launch(
    gpu: &Gpu,
    boxes: &Buffer<f32>,
    obstacle_velocity: &Buffer<f32>,
    state_f32: &Buffer<f32>,
    state_u32: &Buffer<u32>,
    maps: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::RASTERIZE_MAPS, params.envs as usize * CELLS);
    gpu.launch(
        &shader::RASTERIZE_MAPS,
        groups,
        &[boxes, obstacle_velocity, state_f32, state_u32, maps],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    boxes: &[f32],
    obstacle_velocity: &[f32],
    state_f32: &[f32],
    state_u32: &[u32],
    maps: &mut [u32],
    params: &Params,
) {
    let (envs, count) = (params.envs as usize, params.count as usize);
    let worlds = maps.par_chunks_exact_mut(MAP_WORDS).enumerate();
    let worlds = worlds.with_min_len(16);
    worlds.for_each_init(Vec::new, |past, (env, maps)| {
        let just_reset = state_u32[state_u32::EPISODE_STEP * envs + env] == 0;
        if just_reset != (params.just_reset == 1) {
            return;
        }
        let r = |field: usize| state_f32[field * envs + env];
        let seen = Surroundings {
            boxes: &boxes[env * boxes::FIELDS * count..][..boxes::FIELDS * count],
            velocity: &obstacle_velocity[env * VELOCITY_DIM * count..][..VELOCITY_DIM * count],
            at: [r(state_f32::X), r(state_f32::Z)],
            heading: [r(state_f32::HEADING_X), r(state_f32::HEADING_Z)],
        };
        seen.draw(params, just_reset, past, maps);
    });
}

/// What one character's maps are drawn of.
pub struct Surroundings<'a> {
    /// `[boxes::FIELDS][count]`
    pub boxes: &'a [f32],
    /// `[VELOCITY_DIM][count]`
    pub velocity: &'a [f32],
    /// The character's position on the ground, m.
    pub at: [f32; 2],
    /// Its unit forward direction.
    pub heading: [f32; 2],
}

impl Surroundings<'_> {
    /// Draws the maps `[MAP_WORDS]`. `params` says how, `just_reset` that there are no earlier ones; `past` is
    /// memory for the obstacles' earlier places.
    pub fn draw(&self, params: &Params, just_reset: bool, past: &mut Vec<f32>, maps: &mut [u32]) {
        let ground = Ground {
            boxes: self.boxes,
            count: params.count as usize,
            points: points(self.at, self.heading),
            at: self.at,
            edge: params.edge,
        };
        let centres = &self.boxes[..VELOCITY_DIM * ground.count];
        let now = map(&ground, centres);
        let (current, other) = maps.split_at_mut(CELLS * ROW);
        if params.back > 0.0 {
            let places = centres.iter().zip(self.velocity);
            let before = places
                .map(|(&place, velocity)| bounce(place, -velocity, params.back, params.square).0);
            past.clear();
            past.extend(before);
            other.copy_from_slice(&map(&ground, past));
        } else {
            other.copy_from_slice(if just_reset { &now } else { current });
        }
        current.copy_from_slice(&now);
    }
}

/// A cell's centre along one axis of the character frame, m. Exact in floating point.
pub fn centre(cell: usize) -> f32 {
    (cell as f32 - 7.5) * CELL
}

/// What a map is made of.
struct Ground<'a> {
    /// `[boxes::FIELDS][count]`
    boxes: &'a [f32],
    count: usize,
    /// For every row, the cells' x and z.
    points: [[[f32; CELLS]; 2]; CELLS],
    /// The character.
    at: [f32; 2],
    edge: f32,
}

fn points(at: [f32; 2], heading: [f32; 2]) -> [[[f32; CELLS]; 2]; CELLS] {
    std::array::from_fn(|row| {
        let points: [[f32; 2]; CELLS] =
            std::array::from_fn(|column| to_world([centre(column), centre(row)], heading));
        [0, 1].map(|axis| points.map(|moved| at[axis] + moved[axis]))
    })
}

/// Words of every row, of boxes whose `centres` are `[VELOCITY_DIM][count]`.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn map(ground: &Ground, centres: &[f32]) -> [u32; CELLS * ROW] {
    let count = ground.count;
    let field = |field: usize| &ground.boxes[field * count..][..count];
    let (x, z) = centres.split_at(count);
    let (half_x, half_z) = (field(boxes::HALF_X), field(boxes::HALF_Z));
    let mut deepest = [[-1e30_f32; CELLS]; CELLS];
    let reach = REACH + ground.edge;
    for slot in 0..count {
        let near = (x[slot] - ground.at[0]).abs() <= half_x[slot] + reach
            && (z[slot] - ground.at[1]).abs() <= half_z[slot] + reach;
        if !near {
            continue;
        }
        let (centre, half) = ([x[slot], z[slot]], [half_x[slot], half_z[slot]]);
        for (deepest, [xs, zs]) in deepest.iter_mut().zip(&ground.points) {
            for (column, deepest) in deepest.iter_mut().enumerate() {
                let deep = depth([xs[column], zs[column]], centre, half);
                *deepest = if deep > *deepest { deep } else { *deepest };
            }
        }
    }
    let mut words = [0; CELLS * ROW];
    for (cells, words) in deepest.iter().zip(words.chunks_exact_mut(ROW)) {
        let bytes = cells.map(|deep| shade(deep, ground.edge));
        for (word, bytes) in words.iter_mut().zip(bytes.chunks_exact(4)) {
            *word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        }
    }
    words
}

/// A cell's byte, `depth` metres inside an obstacle.
#[inline(always)]
fn shade(depth: f32, edge: f32) -> u8 {
    if edge == 0.0 {
        return if depth >= 0.0 { FULL } else { 0 };
    }
    ((0.5 + depth / edge).clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// A cell of one of an environment's maps, from 0 to [`FULL`].
pub fn cell(maps: &[u32], map: usize, row: usize, column: usize) -> u8 {
    let word = maps[(map * CELLS + row) * ROW + column / 4];
    word.to_le_bytes()[column % 4]
}
