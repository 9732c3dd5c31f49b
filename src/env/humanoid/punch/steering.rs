//! How well a character keeps to the wanted direction and speed on its way to a far target.

use super::PunchTask;
use crate::env::humanoid::task::CpuHumanoidEnv;
use glam::Vec2;
use serde::Serialize;

/// Steps over which a motion has a direction: within a step of a gait the body sways. A second.
const STEPS: usize = 30;
/// An angle up to which a heading is kept, rad.
const STRAIGHT: f32 = 15.0 * std::f32::consts::PI / 180.0;

/// How a character moved while the target was far, over every second of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SteeringReport {
    /// Mean angle between the wanted direction and that of the motion, degrees.
    pub heading_error_deg: f64,
    /// Fraction of the seconds in which that angle was at most 15 degrees.
    pub heading_within_15_deg: f64,
    /// Mean difference of the speed from the wanted one, m/s.
    pub speed_error: f64,
}

/// Watches the first episode of each environment.
pub struct SteeringProbe<'a> {
    task: &'a PunchTask,
    /// Where each character was while its target was far, m.
    paths: Vec<Vec<Vec2>>,
    seconds: usize,
    straight: usize,
    angle_sum: f64,
    speed_error_sum: f64,
}

impl<'a> SteeringProbe<'a> {
    /// A probe of so many environments at the start of their episodes.
    pub fn new(task: &'a PunchTask, envs: usize) -> Self {
        SteeringProbe {
            task,
            paths: vec![Vec::new(); envs],
            seconds: 0,
            straight: 0,
            angle_sum: 0.0,
            speed_error_sum: 0.0,
        }
    }

    /// Takes in a step; `running` says which environments are still in their first episode.
    pub fn observe(&mut self, envs: &CpuHumanoidEnv, running: &[bool]) {
        let (task, punch) = (self.task, self.task.punch());
        for (env, (world, state)) in envs.batch.worlds.iter().zip(&envs.task_states).enumerate() {
            let near = task.gap(&world.state.q).length() < punch.near;
            if !running[env] || near || task.is_hit(state) {
                self.paths[env].clear();
                continue;
            }
            let path = &mut self.paths[env];
            path.push(Vec2::from_slice(&world.state.q));
            if path.len() > STEPS {
                let way = path[path.len() - 1] - path[path.len() - 1 - STEPS];
                let wanted = task.wanted_direction(state);
                let angle = way.angle_to(wanted).abs();
                self.seconds += 1;
                self.straight += usize::from(angle <= STRAIGHT);
                self.angle_sum += f64::from(angle);
                self.speed_error_sum += f64::from((way.length() - punch.speed).abs());
            }
        }
    }

    /// What came of the episodes.
    pub fn report(&self) -> SteeringReport {
        let seconds = self.seconds.max(1) as f64;
        SteeringReport {
            heading_error_deg: (self.angle_sum / seconds).to_degrees(),
            heading_within_15_deg: self.straight as f64 / seconds,
            speed_error: self.speed_error_sum / seconds,
        }
    }
}
