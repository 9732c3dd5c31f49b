//! The task `track`: follow recordings moment by moment, as DeepMimic does (Peng et al. 2018).
//!
//! [`Tracking`] are its choices, [`TrackTask`] plays it, and [`evaluate`] judges a policy.

mod describe;
mod references;

use super::batch::SimulatedWorld;
use super::driver::{BodyDriver, DriverState};
use super::fidelity::{FidelityProbe, FidelityReport};
use super::recorded::mean_action;
use super::task::play::play_episodes;
use super::task::{
    CpuHumanoidEnv, EpisodeRules, GpuHumanoidTask, HumanoidTask, KEY_BODIES, StepContext,
    StepOutcome, TaskBuffers, check_range,
};
use crate::env::description::VectorPart;
use crate::gpu::{Buffer, Gpu};
use crate::kernels::humanoid::track_reward::{KEYS, TrackedBody};
use crate::kernels::humanoid::track_state::{ROW, TRACK_STATE};
use crate::kernels::humanoid::{begin_track, track_observe, track_reward};
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::simulator::Simulator;
use references::References;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Choices of the task `track`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Tracking {
    /// Length and failures of an episode.
    #[serde(flatten)]
    pub rules: EpisodeRules,
    /// Distance of the root from where it should be at which an episode has failed, m.
    pub max_distance: f32,
}

impl Default for Tracking {
    fn default() -> Self {
        Tracking {
            rules: EpisodeRules::default(),
            max_distance: 1.0,
        }
    }
}

impl Tracking {
    /// Whether the choices can be played.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self) -> Result<(), String> {
        self.rules.check()?;
        check_range(&[("max_distance", self.max_distance)])
    }
}

/// How a policy fared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrackReport {
    /// How its motion compares with recordings, whichever it was to follow.
    #[serde(flatten)]
    pub fidelity: FidelityReport,
    /// Mean distance of the root from where it should be, m.
    pub root_error_m: f64,
    /// Mean distance of hands and feet from where they should be, m.
    pub key_error_m: f64,
}

/// The task with what is to be followed.
pub struct TrackTask {
    rules: EpisodeRules,
    library: Arc<MotionLibrary>,
    references: References,
    params: Params,
}

/// Parameters of its kernels, but for the moment.
#[derive(Clone, Copy)]
struct Params {
    begin: begin_track::Params,
    reward: track_reward::Params,
    observe: track_observe::Params,
}

impl TrackTask {
    /// The task, with starts that depend on `seed`.
    pub fn new(track: &Tracking, library: &Arc<MotionLibrary>, seed: u32) -> TrackTask {
        let steps = track.rules.steps() as usize;
        let references = References::new(library, steps, seed);
        TrackTask {
            rules: track.rules,
            params: params(track, library.model(), references.start_rows.len() / 2),
            references,
            library: library.clone(),
        }
    }
}

fn params(track: &Tracking, model: &Model, starts: usize) -> Params {
    let keys = KEY_BODIES.map(|name| model.body(name).expect("a body of the humanoid") as u32);
    let (nq, nv) = (model.nq() as u32, model.nv() as u32);
    Params {
        begin: begin_track::Params {
            envs: 0,
            first: 0,
            seed: 0,
            reset_counter: 0,
            count: starts as u32,
        },
        reward: track_reward::Params {
            envs: 0,
            at: 0,
            nq,
            nv,
            right_hand: keys[0],
            left_hand: keys[1],
            right_foot: keys[2],
            left_foot: keys[3],
            max_distance: track.max_distance,
        },
        observe: track_observe::Params {
            envs: 0,
            at: 0,
            width: 0,
            only: 0,
            nq,
            nv,
        },
    }
}

impl Params {
    fn begin(&self, moment: &StepContext) -> begin_track::Params {
        begin_track::Params {
            envs: moment.envs,
            first: moment.first,
            seed: moment.seed,
            reset_counter: moment.step_counter,
            ..self.begin
        }
    }
}

impl HumanoidTask for TrackTask {
    fn model(&self) -> &Arc<Model> {
        self.library.model()
    }

    fn rules(&self) -> &EpisodeRules {
        &self.rules
    }

    fn start_states(&self) -> &[f32] {
        &self.references.start_states
    }

    fn rest_action(&self) -> Vec<f32> {
        mean_action(&self.library)
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &[
            "episodes",
            "successes",
            "steps",
            "returns",
            "fall",
            "root_error_sum",
            "key_error_sum",
        ]
    }

    fn observation(&self) -> usize {
        track_observe::dim(self.model())
    }

    fn describe(&self) -> Vec<VectorPart> {
        describe::parts(self.model())
    }

    fn state_dim(&self) -> usize {
        TRACK_STATE
    }

    fn reward(
        &self,
        _moment: &StepContext,
        simulator: &Simulator,
        world: &SimulatedWorld,
        state: &mut [f32],
        outcomes: &mut [StepOutcome],
        measures: &mut [f32],
    ) {
        let body = TrackedBody {
            model: &simulator.model,
            q: &world.state.q,
            v: &world.state.v,
            poses: &simulator.poses,
        };
        let rows = &self.references.rows;
        let (reward, end) = track_reward::step(&body, rows, state, measures, &self.params.reward);
        (outcomes[0].reward, outcomes[0].end) = (reward, end);
    }

    fn wanted(&self, state: &[f32]) -> Option<&[f32]> {
        let model = self.model();
        let width = model.nq() + model.nv() + 3 * KEYS;
        let row = state[ROW] as usize;
        Some(&self.references.rows[row * width..][..model.nq()])
    }

    fn begin(&self, env: usize, moment: &StepContext, _start: &mut [f32], state: &mut [f32]) {
        let rows = &self.references.start_rows;
        begin_track::begin(rows, env, state, &self.params.begin(moment));
    }

    fn observe(
        &self,
        _agent: usize,
        simulator: &Simulator,
        _world: &SimulatedWorld,
        state: &[f32],
        out: &mut [f32],
    ) {
        let (root, rows) = (simulator.poses[0], &self.references.rows);
        let params = &self.params.observe;
        track_observe::observe(&simulator.model, root, rows, state, out, params);
    }

    fn on_gpu(&self, gpu: &Gpu) -> Box<dyn GpuHumanoidTask> {
        Box::new(GpuTrack {
            rows: Buffer::from_slice(gpu, &self.references.rows),
            start_rows: Buffer::from_slice(gpu, &self.references.start_rows),
            params: self.params,
        })
    }
}

struct GpuTrack {
    rows: Buffer<f32>,
    start_rows: Buffer<u32>,
    params: Params,
}

impl GpuHumanoidTask for GpuTrack {
    fn reward(
        &self,
        worlds: &TaskBuffers,
        reward: &Buffer<f32>,
        _group: &Buffer<u32>,
        at: usize,
        moment: &StepContext,
    ) {
        let params = track_reward::Params {
            envs: moment.envs,
            at: at as u32,
            ..self.params.reward
        };
        track_reward::launch(
            &worlds.gpu,
            &worlds.batch.model_table,
            &worlds.batch.state,
            &worlds.batch.poses,
            &self.rows,
            &worlds.state,
            reward,
            &worlds.measures,
            &worlds.task_end,
            &params,
        );
    }

    fn begin(&self, worlds: &TaskBuffers, moment: &StepContext) {
        begin_track::launch(
            &worlds.gpu,
            &worlds.ended,
            &self.start_rows,
            &worlds.state,
            &self.params.begin(moment),
        );
    }

    fn observe(&self, worlds: &TaskBuffers, out: &Buffer<f32>, at: usize, width: usize, only: u32) {
        let params = track_observe::Params {
            envs: worlds.ended.len() as u32,
            at: at as u32,
            width: width as u32,
            only,
            ..self.params.observe
        };
        track_observe::launch(
            &worlds.gpu,
            &worlds.batch.model_table,
            &worlds.batch.poses,
            &self.rows,
            &worlds.state,
            &worlds.ended,
            out,
            &params,
        );
    }
}

/// Plays `episodes` episodes, whose starts depend on `seed` alone.
pub fn evaluate(
    task: Arc<TrackTask>,
    driver: &dyn BodyDriver,
    episodes: usize,
    seed: u32,
) -> TrackReport {
    let library = task.library.clone();
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..episodes, seed);
    let mut probe = FidelityProbe::new(&library, &envs);
    let found = play_episodes(
        &mut envs,
        driver,
        DriverState::default(),
        |envs, running, _| {
            probe.observe(envs, running);
        },
    );
    // In the order of the statistics.
    let [steps, root, keys] = [2, 5, 6].map(|stat| found.mean(stat));
    TrackReport {
        fidelity: probe.report(&found),
        root_error_m: root / steps.max(1.0),
        key_error_m: keys / steps.max(1.0),
    }
}
