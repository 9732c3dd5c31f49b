//! The parameters of every kernel, for a task on a level at one moment of a run.

use super::config::EnvConfig;
use super::task::{LEVELS, LocomotionTask, Reward, SpeedDistribution};
use crate::kernels::locomotion::locomotion_layout::{BASE_OBS_DIM, CELLS, MAP_OBS_DIM};
use crate::kernels::locomotion::{
    advance_and_reward, build_query, episode_stats, hits, move_obstacles, observe,
    obstacle_collision, rasterize_maps, reset, spawn_obstacles,
};
use crate::kernels::termination;
use crate::motion::RATE;
use crate::motion::features::FRAMES_PER_STEP;

/// What the parameters depend on.
#[derive(Clone, Debug)]
pub struct KernelParams {
    /// Task with its choices.
    pub task: LocomotionTask,
    /// Number of environments.
    pub envs: usize,
    /// Number of the first environment in its batch.
    pub first: usize,
    /// Candidates of the database.
    pub candidates: usize,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Steps of the run so far: the random numbers' counter.
    pub step_counter: u32,
    /// Level of the curriculum, from 0: new episodes are as hard as it says.
    pub level: u32,
    /// Ends of episodes whose last observation is written, `1 << termination` each: those whose value goes on.
    pub final_observations: u32,
    /// Where this step's rewards and terminations begin in the columns they are written to.
    pub offset: usize,
}

impl KernelParams {
    /// At the start of a run over a database of so many candidates.
    pub fn new(config: &EnvConfig, first: usize, candidates: usize) -> Self {
        KernelParams {
            task: config.task,
            envs: config.envs,
            first,
            candidates,
            seed: config.seed,
            step_counter: 0,
            level: config.level,
            final_observations: config.task.bootstrap(),
            offset: 0,
        }
    }

    /// `action_at`: where the first number of this step's actions is.
    pub fn hits(&self, action_at: usize) -> hits::Params {
        hits::Params {
            envs: self.envs as u32,
            action_at: action_at as u32,
            count: self.task.obstacles() as u32,
        }
    }

    /// `action_at`: as for [`KernelParams::hits`].
    pub fn build_query(&self, action_at: usize) -> build_query::Params {
        build_query::Params {
            envs: self.envs as u32,
            action_at: action_at as u32,
        }
    }

    /// Parameters of the kernel `obstacle_collision`.
    pub fn obstacle_collision(&self) -> obstacle_collision::Params {
        obstacle_collision::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            square: self.task.arena_half_extent().unwrap_or(0.0),
            frame_time: 1.0 / RATE,
        }
    }

    /// Parameters of the kernel `move_obstacles`: one step.
    pub fn move_obstacles(&self) -> move_obstacles::Params {
        move_obstacles::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            time: FRAMES_PER_STEP as f32 / RATE,
            square: self.task.arena_half_extent().unwrap_or(0.0),
        }
    }

    /// Parameters of the kernel `advance_and_reward`: the task's rewards.
    pub fn advance_and_reward(&self) -> advance_and_reward::Params {
        let (envs, offset) = (self.envs as u32, self.offset as u32);
        match self.task {
            LocomotionTask::Plane(task) => advance_and_reward::Params {
                envs,
                offset,
                reach: task.success_radius,
                near: 1.0,
                progress: 0.0,
                clear: 0.0,
                shift: 0.0,
                bonus: task.success_bonus,
                crash: 0.0,
            },
            LocomotionTask::Obstacles(task) => {
                let (near, progress) = match task.reward {
                    Reward::Paper => (1.0, 0.0),
                    Reward::Progress => (0.0, super::task::PROGRESS),
                };
                advance_and_reward::Params {
                    envs,
                    offset,
                    reach: task.success_radius,
                    near,
                    progress,
                    clear: task.hit_reward,
                    shift: f32::from(task.hit_reward_is_penalty),
                    bonus: task.success_bonus,
                    crash: task.collision_reward,
                }
            }
        }
    }

    /// `just_reset`: only the episodes that have just begun, or only the others.
    pub fn rasterize_maps(&self, just_reset: bool) -> rasterize_maps::Params {
        let (edge, back) = match self.task {
            LocomotionTask::Plane(_) => (0.0, 0.0),
            LocomotionTask::Obstacles(task) => (task.map_edge_width, task.map_history_s),
        };
        rasterize_maps::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            just_reset: just_reset.into(),
            square: self.task.arena_half_extent().unwrap_or(0.0),
            edge,
            back,
        }
    }

    /// Observations of all environments; `to`: the first row to write.
    pub fn observe(&self, to: usize) -> observe::Params {
        observe::Params {
            envs: self.envs as u32,
            rows: if self.task.has_maps() {
                CELLS as u32
            } else {
                1
            },
            width: self.observation_dim() as u32,
            offset: self.offset as u32,
            only: termination::ANY,
            to: to as u32,
        }
    }

    /// Observations of the environments whose episode this step ended, as one of
    /// [`KernelParams::final_observations`].
    pub fn observe_final(&self, to: usize) -> observe::Params {
        observe::Params {
            only: self.final_observations,
            ..self.observe(to)
        }
    }

    /// Numbers of an observation.
    pub fn observation_dim(&self) -> usize {
        BASE_OBS_DIM + if self.task.has_maps() { MAP_OBS_DIM } else { 0 }
    }

    /// New obstacles `everywhere` or where this step ended an episode.
    pub fn spawn_obstacles(&self, all: bool) -> spawn_obstacles::Params {
        let LocomotionTask::Obstacles(task) = self.task else {
            unreachable!("only the task with obstacles draws them")
        };
        spawn_obstacles::Params {
            envs: self.envs as u32,
            first: self.first as u32,
            count: task.count,
            seed: self.seed,
            step_counter: self.reset_counter(all),
            offset: self.offset as u32,
            all: all.into(),
            side_min: task.side_min,
            side_max: task.side_max,
            square: task.arena_half_extent,
            margin: task.spawn_clearance,
            speed: task.speed * self.level as f32 / (LEVELS - 1) as f32,
            speed_min: match task.speed_distribution {
                SpeedDistribution::Same => 1.0,
                SpeedDistribution::Uniform => 0.0,
            },
        }
    }

    /// New episodes `everywhere` or where this step ended one, with limits up to `spread` early.
    pub fn reset(&self, all: bool, initial_age_jitter: u32) -> reset::Params {
        let clear = match self.task {
            LocomotionTask::Plane(_) => false,
            LocomotionTask::Obstacles(task) => task.target_clear,
        };
        reset::Params {
            envs: self.envs as u32,
            first: self.first as u32,
            candidates: self.candidates as u32,
            count: self.task.obstacles() as u32,
            seed: self.seed,
            step_counter: self.reset_counter(all),
            offset: self.offset as u32,
            all: all.into(),
            max_steps: self.task.max_steps(),
            initial_age_jitter,
            half_side: self.task.target_extent(self.level),
            reach: self.task.success_radius(),
            clear: clear.into(),
        }
    }

    /// The counter of a reset's random numbers: after a step it is the next step's, so that the very
    /// first episodes have one of their own.
    fn reset_counter(&self, all: bool) -> u32 {
        self.step_counter.wrapping_add(u32::from(!all))
    }

    /// Parameters of the kernel `episode_stats`.
    pub fn episode_stats(&self) -> episode_stats::Params {
        episode_stats::Params {
            envs: self.envs as u32,
        }
    }
}
