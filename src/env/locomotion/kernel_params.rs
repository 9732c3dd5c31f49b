//! The parameters of every kernel, for a task on a level at one moment of a run.

use super::task::{LEVELS, Motion, Reward, Task};
use crate::kernels::locomotion::locomotion_layout::{CELLS, termination};
use crate::kernels::learn::{sample_action, gae};
use crate::kernels::locomotion::{obstacle_collision, hits, observe, build_query, reset, spawn_obstacles, rasterize_maps, advance_and_reward, episode_stats, move_obstacles};
use crate::motion::RATE;
use crate::motion::features::FRAMES_PER_STEP;

/// What the parameters depend on.
#[derive(Clone, Debug)]
pub struct KernelParams {
    pub task: Task,
    pub envs: usize,
    /// The first one's number in its batch.
    pub first: usize,
    /// Steps of a rollout.
    pub horizon: usize,
    /// Candidates of the database.
    pub candidates: usize,
    pub seed: u32,
    /// Steps of the run so far: the random numbers' counter.
    pub step_counter: u32,
    pub level: u32,
}

impl KernelParams {
    /// Where this step's rewards and ends begin in the rollout.
    pub fn offset(&self) -> usize {
        self.step_counter as usize % self.horizon * self.envs
    }

    /// Steps of a rollout whose last real states are kept: one row of environments suffices if none
    /// can have two such ends in a rollout.
    pub fn final_steps(&self) -> usize {
        match self.task.bootstrap() == 1 << termination::TRUNCATED {
            true => 1,
            false => self.horizon,
        }
    }

    pub fn act(&self) -> sample_action::Params {
        sample_action::Params {
            envs: self.envs as u32,
            first: self.first as u32,
            seed: self.seed,
            step_counter: self.step_counter,
        }
    }

    pub fn hits(&self) -> hits::Params {
        hits::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
        }
    }

    pub fn query(&self) -> build_query::Params {
        build_query::Params {
            envs: self.envs as u32,
        }
    }

    pub fn collide(&self) -> obstacle_collision::Params {
        obstacle_collision::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            square: self.square(),
            frame_time: 1.0 / RATE,
        }
    }

    pub fn wander(&self) -> move_obstacles::Params {
        move_obstacles::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            time: FRAMES_PER_STEP as f32 / RATE,
            square: self.square(),
        }
    }

    fn square(&self) -> f32 {
        match self.task {
            Task::Plane(_) => 0.0,
            Task::Obstacles(task) => task.square,
        }
    }

    pub fn step(&self) -> advance_and_reward::Params {
        let (envs, offset) = (self.envs as u32, self.offset() as u32);
        match self.task {
            Task::Plane(task) => advance_and_reward::Params {
                envs,
                offset,
                reach: task.reach,
                near: 1.0,
                progress: 0.0,
                clear: 0.0,
                shift: 0.0,
                bonus: task.bonus,
                crash: 0.0,
            },
            Task::Obstacles(task) => {
                let (near, progress) = match task.reward {
                    Reward::Paper => (1.0, 0.0),
                    Reward::Progress => (0.0, super::task::PROGRESS),
                };
                advance_and_reward::Params {
                    envs,
                    offset,
                    reach: task.reach,
                    near,
                    progress,
                    clear: task.hit_reward,
                    shift: f32::from(task.hit_shift),
                    bonus: task.success_bonus,
                    crash: task.collision,
                }
            }
        }
    }

    /// `begun`: only the episodes that have just begun, or only the others.
    pub fn sense(&self, just_reset: bool) -> rasterize_maps::Params {
        let (edge, back) = match self.task {
            Task::Plane(_) => (0.0, 0.0),
            Task::Obstacles(task) => (task.edge, task.look_back),
        };
        rasterize_maps::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            just_reset: just_reset.into(),
            square: self.square(),
            edge,
            back,
        }
    }

    /// Of all environments.
    pub fn observe(&self) -> observe::Params {
        observe::Params {
            envs: self.envs as u32,
            rows: match self.task {
                Task::Plane(_) => 1,
                Task::Obstacles(_) => CELLS as u32,
            },
            width: self.task.width() as u32,
            offset: self.offset() as u32,
            only: termination::ANY,
            to: 0,
        }
    }

    /// Of the environments whose episode this step ended and whose value goes on.
    pub fn observe_last(&self) -> observe::Params {
        observe::Params {
            only: self.task.bootstrap(),
            to: match self.final_steps() {
                1 => 0,
                _ => self.offset() as u32,
            },
            ..self.observe()
        }
    }

    /// New obstacles `everywhere` or where this step ended an episode.
    pub fn scatter(&self, all: bool) -> spawn_obstacles::Params {
        let Task::Obstacles(task) = self.task else {
            unreachable!("only the task with obstacles draws them")
        };
        spawn_obstacles::Params {
            envs: self.envs as u32,
            first: self.first as u32,
            count: task.count,
            seed: self.seed,
            step_counter: self.draws(all),
            offset: self.offset() as u32,
            all: all.into(),
            side_min: task.side_min,
            side_max: task.side_max,
            square: task.square,
            margin: task.margin,
            speed: task.speed * self.level as f32 / (LEVELS - 1) as f32,
            speed_min: match task.motion {
                Motion::Same => 1.0,
                Motion::Uniform => 0.0,
            },
        }
    }

    /// New episodes `everywhere` or where this step ended one, with limits up to `spread` early.
    pub fn reset(&self, all: bool, initial_age_jitter: u32) -> reset::Params {
        let (reach, clear) = match self.task {
            Task::Plane(task) => (task.reach, false),
            Task::Obstacles(task) => (task.reach, task.target_clear),
        };
        reset::Params {
            envs: self.envs as u32,
            first: self.first as u32,
            candidates: self.candidates as u32,
            count: self.task.obstacles() as u32,
            seed: self.seed,
            step_counter: self.draws(all),
            offset: self.offset() as u32,
            all: all.into(),
            max_steps: self.task.max_steps(),
            initial_age_jitter,
            half_side: self.task.half_side(self.level),
            reach,
            clear: clear.into(),
        }
    }

    /// The counter of a reset's random numbers: after a step it is the next step's, so that the very
    /// first episodes have one of their own.
    fn draws(&self, all: bool) -> u32 {
        self.step_counter.wrapping_add(u32::from(!all))
    }

    pub fn gae(&self, gamma: f32, lambda: f32) -> gae::Params {
        gae::Params {
            envs: self.envs as u32,
            steps: self.horizon as u32,
            gamma,
            lambda,
            bootstrap: self.task.bootstrap(),
            final_steps: self.final_steps() as u32,
        }
    }

    pub fn tally(&self) -> episode_stats::Params {
        episode_stats::Params {
            envs: self.envs as u32,
        }
    }
}
