//! How well a policy finds and topples its target, and keeps to the wanted directions on the way.

use super::PunchTask;
use super::steering::{SteeringProbe, SteeringReport};
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::env::humanoid::fidelity::{COMPARED, FidelityProbe, FidelityReport, PoseTrack};
use crate::env::humanoid::task::play::{Episodes, play_episodes};
use crate::env::humanoid::task::{CpuHumanoidEnv, DT};
use crate::physics::motion_library::MotionLibrary;
use serde::Serialize;
use std::sync::Arc;

/// Kind of the clips that are punches.
pub const BOXING: &str = "boxing";
/// How near to the target poses are compared with recordings, m.
const NEAR: f32 = 1.5;

/// How a policy fared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PunchReport {
    /// How its motion compares with recordings.
    #[serde(flatten)]
    pub fidelity: FidelityReport,
    /// Fraction of the targets that were hit.
    pub hit_rate: f64,
    /// Fraction of the targets that were toppled by a first contact of a fast fist.
    pub fist_rate: f64,
    /// Mean time from the start to the hit, of those that were hit, s.
    pub time_to_hit_mean_s: f64,
    /// Fraction of the moments within 1.5 m of a target not yet hit whose nearest recorded pose is of a clip
    /// of the kind `boxing`; `None` if there is no such clip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boxing_share: Option<f64>,
    /// Mean angle between facing and wanted facing while the target is far, degrees.
    pub facing_error_deg: f64,
    /// How the wanted directions were kept; `None` where there are none.
    #[serde(flatten)]
    pub steering: Option<SteeringReport>,
}

/// Plays `episodes` episodes, whose starts depend on `seed` alone.
pub fn evaluate(
    task: Arc<PunchTask>,
    library: &MotionLibrary,
    driver: &dyn BodyDriver,
    episodes: usize,
    seed: u32,
) -> PunchReport {
    let mut envs = CpuHumanoidEnv::unstaggered(task.clone(), 0..episodes, seed);
    let mut probe = FidelityProbe::new(library, &envs);
    let mut steering = SteeringProbe::new(&task, episodes);
    let mut near = PoseTrack::default();
    let found = play_episodes(
        &mut envs,
        driver,
        DriverState::default(),
        |envs, running, _| {
            probe.observe(envs, running);
            steering.observe(envs, running);
            let worlds = envs.batch.worlds.iter().zip(&envs.task_states);
            for (env, (world, state)) in worlds.enumerate().take(COMPARED) {
                let gap = task.gap(&world.state.q);
                if running[env] && gap.length() < NEAR && !task.is_hit(state) {
                    near.push(envs.task().model(), &world.state.q);
                }
            }
        },
    );
    // In the order of the statistics.
    let [hit, fist, far, angle] = [5, 6, 7, 8].map(|stat| found.mean(stat));
    PunchReport {
        fidelity: probe.report(&found),
        hit_rate: hit,
        fist_rate: fist,
        time_to_hit_mean_s: time_to_hit(&task, &found),
        boxing_share: probe.share_of_kind(&near, BOXING),
        facing_error_deg: (angle / far.max(1e-9)).to_degrees(),
        steering: task.joystick().then(|| steering.report()),
    }
}

/// Mean time from the start to the hit, of those that were hit, s.
fn time_to_hit(task: &PunchTask, found: &Episodes) -> f64 {
    let after = f64::from(task.punch().steps_after_hit());
    let hits = found.sums.iter().filter(|sums| sums.get(5) == Some(&1.0));
    let times: Vec<f64> = hits.map(|sums| f64::from(sums[2]) - after).collect();
    // The sum of nothing is a negative zero.
    let sum = times.iter().fold(0.0, |sum, time| sum + time);
    sum * f64::from(DT) / times.len().max(1) as f64
}
