//! A run of a simulated body in a page.

use super::played_run::{FrameProgress, PlayedRun, RunState};
use super::run_file::Recordings;
use crate::nn::Policy;
use crate::physics::scenes;
use crate::train::body_policy::BodyPolicy;
use crate::train::config::Config;
use crate::train::tasks;
use crate::view::body_grip::{BodyGrip, centres};
use crate::view::body_playthrough::{BodyContext, BodyPlaythrough};
use crate::view::body_scene::{BodyExtras, body_scene};
use crate::view::camera::{Camera, Ray};
use crate::view::scene::Scene;
use crate::view::shapes::{self, simulated};
use anyhow::{Context, Result, bail};
use glam::Vec3;
use std::sync::Arc;

/// A simulated body under its policy.
pub struct BodyRun {
    context: BodyContext,
    policy: BodyPolicy,
    now: BodyPlaythrough,
    extras: BodyExtras,
    grip: Option<BodyGrip>,
    /// The camera of the last picture, for which the pointer pushes.
    camera: Camera,
    frames_shown: u64,
}

impl BodyRun {
    /// The run at the start of its first episode.
    ///
    /// # Errors
    /// Choices or recordings that do not fit the task.
    pub fn new(
        policy: &Policy,
        config: &Config,
        recordings: Option<Recordings>,
    ) -> Result<BodyRun> {
        let entry = tasks::find(&config.task.name)?;
        let task = match (recordings, entry.with_recordings) {
            (Some(recordings), Some(with_recordings)) => {
                let library = recordings.library(&Arc::new(scenes::humanoid()))?;
                with_recordings(config, library)?
            }
            _ => (entry.load)(config)?.task,
        };
        let episodes = task
            .body()
            .context("the task has no body to be simulated")?;
        let policy = BodyPolicy {
            driver: task.driver(policy).into(),
            discriminator: None,
        };
        let mut context = BodyContext::new(episodes);
        let alone = context.episodes().bouts.is_none();
        Ok(BodyRun {
            now: BodyPlaythrough::new(&mut context, 0)?,
            context,
            policy,
            extras: BodyExtras {
                forces: alone,
                reference: false,
            },
            grip: None,
            camera: Camera::default(),
            frames_shown: 0,
        })
    }

    fn has_target(&self) -> bool {
        self.context.model().trees.len() > 1 && self.context.episodes().bouts.is_none()
    }
}

impl PlayedRun for BodyRun {
    fn add_part(&mut self, _: &[u8]) -> Result<()> {
        bail!("a simulated body needs no motion")
    }

    fn is_ready(&self) -> bool {
        true
    }

    fn advance(&mut self) -> Result<FrameProgress> {
        let grip = self.grip.as_ref();
        let push = grip.and_then(|grip| grip.push(self.context.model(), &self.now.q, &self.camera));
        self.now = self.now.next(&mut self.context, &self.policy, push)?;
        self.frames_shown += 1;
        Ok(FrameProgress::Shown)
    }

    fn scene(&self, camera: &Camera) -> Scene {
        body_scene(&self.now, &self.context, None, self.extras, camera)
    }

    fn focus(&self) -> ([f32; 2], f32) {
        let model = self.context.model();
        let (at, side) = shapes::company(model, &shapes::poses(model, &self.now.q));
        ([at.x, at.z], side)
    }

    fn look(&mut self, camera: &Camera) {
        self.camera = *camera;
    }

    fn press(&mut self, ray: &Ray) -> bool {
        self.grip = BodyGrip::take(self.context.model(), &self.now.q, ray);
        self.grip.is_some()
    }

    fn drag(&mut self, ray: &Ray) {
        if let Some(grip) = &mut self.grip {
            grip.ray = *ray;
        }
    }

    fn release(&mut self) {
        self.grip = None;
    }

    fn click(&mut self, ray: &Ray) -> Result<()> {
        let Some([x, z]) = ray.ground().filter(|_| self.has_target()) else {
            return Ok(());
        };
        let at = simulated(Vec3::new(x, 0.0, z));
        self.now.move_target(&mut self.context, [at.x, at.y])
    }

    fn state(&self) -> RunState {
        let model = self.context.model();
        let centres = centres(model, &self.now.q);
        let ground = |tree: usize| {
            let tree = model.trees.get(tree)?;
            Some(centres[tree.bodies.start]).map(|at| [at.x, at.z])
        };
        let (at, target) = (ground(0).unwrap_or_default(), ground(1));
        RunState {
            at,
            target,
            distance: target.map(|[x, z]| (x - at[0]).hypot(z - at[1])),
            episode: self.now.episode as usize,
            frames_shown: self.frames_shown,
            height: centres.iter().map(|at| at.y).fold(0.0, f32::max),
            ..RunState::default()
        }
    }
}
