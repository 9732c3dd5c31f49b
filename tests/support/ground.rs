//! Characters among boxes, as inputs of the kernels of obstacles.

use super::geometry::{Obstacle, Stance};
use super::inputs::{Draw, POISON};
use footwork::kernels::locomotion::locomotion_layout::{VELOCITY_DIM, boxes, state_f32, state_u32};

/// Half a cell of the map: in exact worlds every length is a multiple of it, so that cell centres
/// lie on edges and no arithmetic rounds.
pub const GRAIN: f32 = 0.1875;
/// Half the side of the obstacles' square, m.
pub const SQUARE: f32 = 50.0 * GRAIN;
/// Most of a box's half sides, m.
const HALF: f32 = 8.0 * GRAIN;

/// What kernels may differ by from the oracle, m: in exact worlds nothing, else some roundings of
/// places up to 16 m.
const BAR: f64 = 1e-5;

/// Obstacles of an environment.
pub const COUNTS: [usize; 4] = [0, 1, 100, 400];

/// Numbers after the last box, which no kernel may write or read.
const MIN_FUTURE_FRAMES: usize = 5;

pub struct Ground {
    pub envs: usize,
    pub count: usize,
    pub exact: bool,
    pub boxes: Vec<f32>,
    pub obstacle_velocity: Vec<f32>,
    pub state_f32: Vec<f32>,
    pub state_u32: Vec<u32>,
}

impl Ground {
    pub fn new(envs: usize, count: usize, seed: u32, exact: bool) -> Self {
        let mut draw = Draw::new(seed);
        let (state_f32, state_u32) = draw.state(envs, 100);
        let mut ground = Ground {
            boxes: vec![POISON; envs * boxes::FIELDS * count + MIN_FUTURE_FRAMES],
            obstacle_velocity: vec![POISON; envs * VELOCITY_DIM * count + MIN_FUTURE_FRAMES],
            envs,
            count,
            exact,
            state_f32,
            state_u32,
        };
        // Few boxes lie close together, so that characters meet them.
        let span = SQUARE.min((count as f32).sqrt() + 2.0);
        for env in 0..envs {
            ground.place(&mut draw, env, span);
            for slot in 0..count {
                ground.build(&mut draw, env, slot, span);
            }
        }
        ground
    }

    pub fn bar(&self) -> f64 {
        if self.exact { 0.0 } else { BAR }
    }

    /// A length up to `most`, m.
    pub fn length(&self, draw: &mut Draw, most: f32) -> f32 {
        let length = draw.within(most);
        match self.exact {
            true => (length / GRAIN).round() * GRAIN,
            false => length,
        }
    }

    pub fn heading(&self, draw: &mut Draw) -> [f32; 2] {
        match self.exact {
            true => [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]][draw.below(4)],
            false => draw.unit(),
        }
    }

    fn place(&mut self, draw: &mut Draw, env: usize, span: f32) {
        let heading = self.heading(draw);
        let values = [
            (state_f32::X, self.length(draw, span)),
            (state_f32::Z, self.length(draw, span)),
            (state_f32::HEADING_X, heading[0]),
            (state_f32::HEADING_Z, heading[1]),
        ];
        for (field, value) in values {
            self.state_f32[field * self.envs + env] = value;
        }
    }

    /// Some boxes are points or lines, some as large as they get, some on the square's edge.
    fn build(&mut self, draw: &mut Draw, env: usize, slot: usize, span: f32) {
        // Many boxes are smaller, so that about a third of the ground is covered.
        let most = HALF.min(12.0 / (self.count as f32).sqrt());
        let mut centre = [0; 2].map(|_| self.length(draw, span));
        let mut half = [0; 2].map(|_| self.length(draw, most).abs());
        match draw.below(10) {
            0 => half = [0.0; 2],
            1 => half[draw.below(2)] = 0.0,
            2 if self.count < 50 => half = [HALF; 2],
            3 => centre[draw.below(2)] = SQUARE,
            4 => centre = [-SQUARE, SQUARE],
            _ => {}
        }
        let values = [centre[0], centre[1], half[0], half[1]];
        for (field, value) in values.into_iter().enumerate() {
            self.boxes[(env * boxes::FIELDS + field) * self.count + slot] = value;
        }
        for axis in 0..VELOCITY_DIM {
            // In a 32nd of a second by grains.
            let speed = 32.0 * self.length(draw, 1.0);
            self.obstacle_velocity[(env * VELOCITY_DIM + axis) * self.count + slot] = speed;
        }
    }

    /// So many boxes that a loop may stop early, of which only the last is near.
    pub fn crowded(envs: usize, count: usize) -> Self {
        let mut ground = Ground::new(envs, count, 1, true);
        for env in 0..envs {
            let places = env * boxes::FIELDS * count;
            ground.boxes[places..][..2 * count].fill(1000.0);
            ground.boxes[places + 2 * count..][..2 * count].fill(1.5);
            for field in 0..2 {
                ground.boxes[places + (field + 1) * count - 1] = 0.0;
                ground.state_f32[(state_f32::X + field) * envs + env] = 0.0;
            }
        }
        ground.obstacle_velocity.fill(0.0);
        ground
    }

    /// Without the tail.
    pub fn own_boxes(&self) -> &[f32] {
        &self.boxes[..self.boxes.len() - MIN_FUTURE_FRAMES]
    }

    pub fn own_drift(&self) -> &[f32] {
        &self.obstacle_velocity[..self.obstacle_velocity.len() - MIN_FUTURE_FRAMES]
    }

    pub fn stance(&self, env: usize) -> Stance {
        stance(&self.state_f32, self.envs, env)
    }

    pub fn obstacles(&self, env: usize) -> Vec<Obstacle> {
        obstacles(&self.boxes, &self.obstacle_velocity, self.count, env)
    }

    pub fn just_reset(&self, env: usize) -> bool {
        self.state_u32[state_u32::EPISODE_STEP * self.envs + env] == 0
    }
}

/// A character of a state.
pub fn stance(reals: &[f32], envs: usize, env: usize) -> Stance {
    let at = |field: usize| f64::from(reals[field * envs + env]);
    Stance {
        at: [at(state_f32::X), at(state_f32::Z)],
        forward: [at(state_f32::HEADING_X), at(state_f32::HEADING_Z)],
    }
}

/// The obstacles around it.
pub fn obstacles(
    all: &[f32],
    obstacle_velocity: &[f32],
    count: usize,
    env: usize,
) -> Vec<Obstacle> {
    let obstacle = |slot: usize| {
        let of = |field: usize| f64::from(all[(env * boxes::FIELDS + field) * count + slot]);
        let velocity =
            |axis: usize| f64::from(obstacle_velocity[(env * VELOCITY_DIM + axis) * count + slot]);
        Obstacle {
            centre: [of(boxes::X), of(boxes::Z)],
            half: [of(boxes::HALF_X), of(boxes::HALF_Z)],
            velocity: [velocity(0), velocity(1)],
        }
    };
    (0..count).map(obstacle).collect()
}
