//! A bout that was played to its end, to be drawn frame by frame.

use super::bout_scene::{flashes, ring};
use super::scene::Scene;
use crate::env::humanoid::boxing::BoxingTask;
use crate::env::humanoid::boxing::bout::{Bout, tally};
use crate::env::humanoid::driver::BodyDriver;
use crate::env::humanoid::task::{CpuHumanoidEnv, play};
use crate::physics::motion_clip::MotionClip;
use std::sync::Arc;

/// What happened in a bout besides the fighters' motion.
pub struct RecordedBout {
    task: Arc<BoxingTask>,
    /// The start, and every step.
    moments: Vec<Bout>,
}

impl RecordedBout {
    /// A bout that begins.
    pub fn new(task: Arc<BoxingTask>) -> RecordedBout {
        RecordedBout {
            task,
            moments: vec![Bout::default()],
        }
    }

    /// Takes in a step of the only environment. A knock-down in the last one is seen in the frame before it: after it
    /// the next bout has begun.
    pub fn push(&mut self, env: &CpuHumanoidEnv, running: bool) {
        let last = self.moments.last_mut().expect("the start");
        if running {
            let next = last.next(&self.task, &env.batch.worlds[0], &env.task_states[0]);
            self.moments.push(next);
        } else {
            *last = last.ended(&tally(env));
        }
    }

    /// How it stood in a frame.
    pub fn at(&self, frame: usize) -> &Bout {
        &self.moments[frame.min(self.moments.len() - 1)]
    }

    /// Adds the ring, and a frame's flashes.
    pub fn draw(&self, scene: &mut Scene, frame: usize) {
        ring(scene, self.task.boxing().arena);
        flashes(scene, &self.at(frame).strikes);
    }
}

/// An episode of the only environment to its end, and what it was besides, if it was a bout of `bouts`.
pub fn recorded_episode(
    env: &mut CpuHumanoidEnv,
    driver: &dyn BodyDriver,
    name: &str,
    bouts: Option<Arc<BoxingTask>>,
) -> (MotionClip, Option<RecordedBout>) {
    let mut bout = bouts.map(RecordedBout::new);
    let motion = play::record(env, driver, name, |env, running| {
        if let Some(bout) = &mut bout {
            bout.push(env, running);
        }
    });
    (motion, bout)
}
