//! A task of a simulated body, to be watched: an episode at a time.

use crate::env::humanoid::boxing::BoxingTask;
use crate::env::humanoid::task::{CpuHumanoidEnv, HumanoidTask};
use crate::physics::motion_library::MotionLibrary;
use crate::rl::ase::LatentDraw;
use std::sync::Arc;

/// Seed of the evaluation episodes: the same for every policy.
pub const EPISODES_SEED: u32 = 0x4556_414c;

/// The evaluation episodes of a task of a simulated body.
#[derive(Clone)]
pub struct BodyEpisodes {
    task: Arc<dyn Fn(u32) -> Arc<dyn HumanoidTask> + Send + Sync>,
    /// What the body is to move like.
    pub recordings: Option<Arc<MotionLibrary>>,
    /// The latents under which it moves, if it does.
    pub latents: Option<LatentDraw>,
    /// The task, if its episodes are bouts.
    pub bouts: Option<Arc<BoxingTask>>,
}

impl BodyEpisodes {
    /// `task` makes the task whose episodes a seed decides.
    pub fn new<T: HumanoidTask + 'static>(
        task: impl Fn(u32) -> Arc<T> + Send + Sync + 'static,
        recordings: Option<&Arc<MotionLibrary>>,
    ) -> BodyEpisodes {
        BodyEpisodes {
            task: Arc::new(move |seed| -> Arc<dyn HumanoidTask> { task(seed) }),
            recordings: recordings.cloned(),
            latents: None,
            bouts: None,
        }
    }

    /// Lets bodies move under latents, if there are any.
    pub fn with_latents(self, latents: Option<LatentDraw>) -> BodyEpisodes {
        BodyEpisodes { latents, ..self }
    }

    /// Says that episodes are bouts, if they are, of this task.
    pub fn with_bouts(self, bouts: Option<Arc<BoxingTask>>) -> BodyEpisodes {
        BodyEpisodes { bouts, ..self }
    }

    /// So many environments at the start of the episodes that evaluations begin with.
    pub fn open_all(&self, episodes: usize) -> CpuHumanoidEnv {
        CpuHumanoidEnv::unstaggered((self.task)(EPISODES_SEED), 0..episodes, EPISODES_SEED)
    }

    /// One environment at the start of an episode.
    pub fn open(&self, episode: u32) -> CpuHumanoidEnv {
        let seed = EPISODES_SEED.wrapping_add(episode);
        CpuHumanoidEnv::unstaggered((self.task)(seed), 0..1, seed)
    }
}
