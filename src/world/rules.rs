//! The parameters of every kernel, for a task on a level at one moment of a run.

use super::task::{LEVELS, Motion, Reward, Task};
use crate::kernels::layout::{CELLS, end};
use crate::kernels::{
    act, collide, gae, hits, observe, query, reset, scatter, sense, step, tally, wander,
};
use crate::motion::RATE;
use crate::motion::features::PLAYED;

/// What the parameters depend on.
#[derive(Clone, Debug)]
pub struct Rules {
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
    pub clock: u32,
    pub level: u32,
}

impl Rules {
    /// Where this step's rewards and ends begin in the rollout.
    pub fn offset(&self) -> usize {
        self.clock as usize % self.horizon * self.envs
    }

    /// Steps of a rollout whose last real states are kept: one row of environments suffices if none
    /// can have two such ends in a rollout.
    pub fn final_steps(&self) -> usize {
        match self.task.bootstrap() == 1 << end::TRUNCATED {
            true => 1,
            false => self.horizon,
        }
    }

    pub fn act(&self) -> act::Params {
        act::Params {
            envs: self.envs as u32,
            first: self.first as u32,
            seed: self.seed,
            clock: self.clock,
        }
    }

    pub fn hits(&self) -> hits::Params {
        hits::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
        }
    }

    pub fn query(&self) -> query::Params {
        query::Params {
            envs: self.envs as u32,
        }
    }

    pub fn collide(&self) -> collide::Params {
        collide::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            square: self.square(),
            frame_time: 1.0 / RATE,
        }
    }

    pub fn wander(&self) -> wander::Params {
        wander::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            time: PLAYED as f32 / RATE,
            square: self.square(),
        }
    }

    fn square(&self) -> f32 {
        match self.task {
            Task::Plane(_) => 0.0,
            Task::Obstacles(task) => task.square,
        }
    }

    pub fn step(&self) -> step::Params {
        let (envs, offset) = (self.envs as u32, self.offset() as u32);
        match self.task {
            Task::Plane(task) => step::Params {
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
                step::Params {
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
    pub fn sense(&self, begun: bool) -> sense::Params {
        let (edge, back) = match self.task {
            Task::Plane(_) => (0.0, 0.0),
            Task::Obstacles(task) => (task.edge, task.look_back),
        };
        sense::Params {
            envs: self.envs as u32,
            count: self.task.obstacles() as u32,
            begun: begun.into(),
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
            only: end::ANY,
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
    pub fn scatter(&self, everywhere: bool) -> scatter::Params {
        let Task::Obstacles(task) = self.task else {
            unreachable!("only the task with obstacles draws them")
        };
        scatter::Params {
            envs: self.envs as u32,
            first: self.first as u32,
            count: task.count,
            seed: self.seed,
            clock: self.draws(everywhere),
            offset: self.offset() as u32,
            everywhere: everywhere.into(),
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
    pub fn reset(&self, everywhere: bool, spread: u32) -> reset::Params {
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
            clock: self.draws(everywhere),
            offset: self.offset() as u32,
            everywhere: everywhere.into(),
            max_steps: self.task.max_steps(),
            spread,
            half_side: self.task.half_side(self.level),
            reach,
            clear: clear.into(),
        }
    }

    /// The counter of a reset's random numbers: after a step it is the next step's, so that the very
    /// first episodes have one of their own.
    fn draws(&self, everywhere: bool) -> u32 {
        self.clock.wrapping_add(u32::from(!everywhere))
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

    pub fn tally(&self) -> tally::Params {
        tally::Params {
            envs: self.envs as u32,
        }
    }
}
