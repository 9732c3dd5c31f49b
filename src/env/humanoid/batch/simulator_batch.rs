//! What a batch of worlds can do, on whatever device.

use crate::kernels::physics::contact_forces;
use anyhow::Result;

/// Counts over all worlds since they were opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactCounters {
    /// Contacts of all steps.
    pub contacts: u64,
    /// Contacts of the step that had most.
    pub peak_contacts: u32,
    /// Contacts that found no room; see [`overflow_warning`].
    pub overflow: u64,
    /// Worlds that diverged and were reset.
    pub diverged: u64,
}

/// A batch of worlds on a device. Arrays of another length than is said panic.
pub trait SimulatorBatch {
    /// Draws the drives' targets, normal about zero with the standard deviation `std`, rad.
    fn draw_targets(&mut self, std: f32);

    /// Sets the drives' targets, `[driven][envs]`, rad.
    fn set_targets(&mut self, targets: &[f32]);

    /// Sets torques and forces on the bodies, `[bodies * 6][envs]`, Nm and N at the centres of mass in
    /// the world's frame, until they are set anew.
    fn set_external_forces(&mut self, forces: &[f32]);

    /// Plays one action; worlds that diverge are reset.
    fn step(&mut self);

    /// Resets the worlds whose `mask` is not 0 to `starts`, `[nq + nv][envs]`, to which diverged worlds
    /// will be reset, too.
    fn reset(&mut self, mask: &[u32], starts: &[f32]);

    /// Positions and velocities, `[nq + nv][envs]`.
    ///
    /// # Errors
    /// The device was lost.
    fn state(&self) -> Result<Vec<f32>>;

    /// Mean contact forces of the last action, `[(bodies + pairs) * 3][envs]`, N in the world's frame: on
    /// every body, and by the first on the second of every pair of [`force_pairs`](super::SimulatorBatchConfig::force_pairs);
    /// zero in worlds that have been reset.
    ///
    /// # Errors
    /// The device was lost.
    fn forces(&self) -> Result<Vec<f32>>;

    /// Counts since the batch was opened.
    ///
    /// # Errors
    /// The device was lost.
    fn counters(&self) -> Result<ContactCounters>;
}

/// What to tell of contacts that found no room, if there were any.
pub fn overflow_warning(overflow: u64) -> Option<String> {
    (overflow > 0).then(|| {
        format!(
            "warning: {overflow} contacts found no room, and the shallowest of their steps were left out: bodies may sink into each other; `--device cpu` has room for all"
        )
    })
}

impl ContactCounters {
    /// Sums over all environments of `[COUNTERS][envs]`.
    pub fn sum(counters: &[u32], envs: usize) -> ContactCounters {
        let of = |counter: usize| counters[counter * envs..][..envs].iter();
        let sum = |counter| of(counter).map(|&count| u64::from(count)).sum();
        let peak = of(contact_forces::PEAK_CONTACTS).copied().max();
        ContactCounters {
            contacts: sum(contact_forces::CONTACTS),
            peak_contacts: peak.unwrap_or(0),
            overflow: sum(contact_forces::OVERFLOW),
            diverged: sum(contact_forces::DIVERGED),
        }
    }
}
