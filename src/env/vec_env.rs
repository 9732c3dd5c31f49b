//! What a learner sees of environments, whatever the task and the device.

use super::live_view::LiveView;
use super::spec::EnvSpec;
use crate::container::{Section, SectionError};
use crate::gpu::Array;
use anyhow::{Result, bail};
use std::any::Any;

pub use crate::kernels::learn::rollout_moments::GROUPS;

/// The columns of a rollout that a step fills.
pub struct Transition<'a> {
    /// Which step of the rollout this is, from 0.
    pub step: usize,
    /// `[steps][rows]`
    pub reward: &'a mut Array,
    /// `[steps][rows]`: the reward for style of environments that know one; others leave it as it is.
    pub style_reward: &'a mut Array,
    /// `[steps][rows]`, see [`crate::kernels::termination`].
    pub termination: &'a mut Array<u32>,
    /// `[steps][rows]`: what kind of situation an agent is in, below [`GROUPS`]. Advantages of different
    /// kinds are normalised apart. Environments that know one kind leave it at 0.
    pub group: &'a mut Array<u32>,
    /// `[final_steps][rows][observation]`: the last observation of the episodes that this step ended
    /// and whose value goes on; a simulated body's, however it ended. The rows of others are left as they
    /// are.
    pub final_observation: &'a mut Array,
}

/// Environments that are stepped together, with same-step reset (Gymnasium's `SAME_STEP`): a step that
/// ends an episode begins the next one, and the next observation is of that. Being [`Any`], the parts of a batch can
/// be had back as the type that they are of.
pub trait VecEnv: Any + Send {
    /// The dimensions of the batch.
    fn spec(&self) -> &EnvSpec;

    /// The environments that these are around, if they are: what these do not do themselves, those do.
    fn inner(&self) -> Option<&dyn VecEnv> {
        None
    }

    /// [`VecEnv::inner`], to be changed.
    fn inner_mut(&mut self) -> Option<&mut dyn VecEnv> {
        None
    }

    /// An action that keeps an agent as it is, `[action]`: what a policy begins near. Empty: all zero.
    fn rest_action(&self) -> Vec<f32> {
        self.inner().map_or(Vec::new(), VecEnv::rest_action)
    }

    /// Writes the observations `[rows][observation]` of this moment to `out` from the index `at` on.
    fn observe(&mut self, out: &mut Array, at: usize);

    /// Plays one step of all environments. `action` holds `[rows][action]` from the index `at` on.
    fn step(&mut self, action: &Array, at: usize, out: Transition);

    /// Names of the sums that [`VecEnv::stats`] writes: `episodes`, `successes`, `steps` and `returns`
    /// of the episodes that ended, and the environment's own, by the names that their means have in
    /// `metrics.jsonl`.
    fn stat_names(&self) -> &'static [&'static str];

    /// Writes the sums over all episodes that ended since the last call to `out`, in the order of
    /// [`VecEnv::stat_names`].
    fn stats(&mut self, out: &mut Array);

    /// What each row would add to [`VecEnv::stats`] now, `[stats][rows]`, on their device; none of environments that do
    /// not know.
    fn row_stats(&self) -> Option<Array> {
        self.inner().and_then(VecEnv::row_stats)
    }

    /// Begins new episodes, of full length, in the environments that `which`, `[envs]`, marks. What there was of the
    /// old ones goes into no statistics.
    ///
    /// # Errors
    /// The device was lost.
    fn restart(&mut self, which: &[bool]) -> Result<()> {
        self.inner_mut()
            .map_or(Ok(()), |inner| inner.restart(which))
    }

    /// Episodes that begin from now on are of this level of a [curriculum](super::curriculum).
    fn set_level(&mut self, level: u32) {
        if let Some(inner) = self.inner_mut() {
            inner.set_level(level);
        }
    }

    /// What there is to see while the batch goes on, if there is a view of it.
    ///
    /// # Errors
    /// The device was lost.
    fn live_view(&mut self) -> Result<Option<LiveView>> {
        self.inner_mut().map_or(Ok(None), VecEnv::live_view)
    }

    /// Contacts that found no room on their device since the environments were opened.
    ///
    /// # Errors
    /// The device was lost.
    fn contact_overflow(&self) -> Result<u64> {
        self.inner().map_or(Ok(0), VecEnv::contact_overflow)
    }

    /// Writes everything that the environments need to go on as if they had never stopped. Only
    /// between rollouts.
    ///
    /// # Errors
    /// The device was lost; or these cannot be saved, as those of a training without checkpoints need not be.
    fn save(&self, _to: &mut Section) -> Result<()> {
        bail!("these environments cannot be saved")
    }

    /// Puts a saved state back.
    ///
    /// # Errors
    /// It is not of such environments, or these cannot be saved.
    fn load(&mut self, _from: &mut Section) -> Result<(), SectionError> {
        Err(SectionError("these environments cannot be saved".into()))
    }
}
