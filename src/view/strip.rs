//! Film strips of a motion: as it was recorded, and as the simulated body does it when its drives are
//! given the recorded angles.

use super::bout_bars;
use super::camera::Camera;
use super::image_files;
use super::recorded_bout::RecordedBout;
use super::render_target::RenderTarget;
use super::renderer::Renderer;
use super::scene::Scene;
use super::shapes::{self, Look};
use crate::env::humanoid::boxing::bout::Bout;
use crate::gpu::Gpu;
use crate::physics::model::Model;
use crate::physics::motion_clip::{MotionClip, pd_targets};
use crate::physics::pose::Pose;
use crate::physics::simulator::{STEP_RATE, SUBSTEPS, Simulator, SimulatorState, SolverOptions};
use anyhow::{Context, Result};
use glam::Vec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Size of a picture of the strip, and the gap between two, pixels.
const SIZE: [u32; 2] = [280, 340];
const GAP: usize = 4;
pub(super) const PICTURES: usize = 7;
/// Nothing balances a body whose drives follow angles: so long after its start it has fallen, s.
const FALL: f32 = 1.5;
/// From the front of the body to the camera, rad.
const YAW: f32 = 1.1;
/// From the camera to a single body, m, and how much further for each metre to either side.
const NEAR: f32 = 4.1;
const WIDE: f32 = 3.0;
/// From the simulated body to the recorded one: to the right of the picture, and away, m.
const ASIDE: [f32; 2] = [0.9, 0.6];

/// Writes two film strips into a folder: the motion replayed for its whole length, and the body
/// driven to its angles from its first state on, before the recorded one. Returns the files.
///
/// # Errors
/// The folder cannot be made, a file cannot be written, or the GPU was lost.
pub fn strips(
    gpu: &Gpu,
    model: &Arc<Model>,
    motion: &MotionClip,
    folder: &Path,
) -> Result<[PathBuf; 2]> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let mut strip = Strip::new(gpu, model, motion.q(0), SIZE);
    let [replayed, driven] =
        ["replayed", "driven"].map(|what| folder.join(format!("{}-{what}.png", motion.name)));
    let shots = strip.replayed(motion, times([0.0, motion.seconds()]));
    strip.write(&replayed, &shots)?;
    let shots = strip.driven(motion);
    strip.write(&driven, &shots)?;
    Ok([replayed, driven])
}

/// Writes a film strip of the motion, replayed from a time on for so many seconds, or to its end; `bout` is what it was
/// besides, if it was one.
///
/// # Errors
/// The file cannot be written, or the GPU was lost.
pub fn film_strip(
    gpu: &Gpu,
    model: &Arc<Model>,
    motion: &MotionClip,
    bout: Option<&RecordedBout>,
    [start, seconds]: [f32; 2],
    path: &Path,
) -> Result<()> {
    let mut strip = Strip::new(gpu, model, motion.q(0), SIZE);
    let end = motion.seconds();
    let start = start.min(end);
    let times: Vec<f32> = times([start, (start + seconds).min(end)]).collect();
    let mut shots = strip.replayed(motion, times.iter().copied());
    if let Some(bout) = bout {
        for (shot, time) in shots.iter_mut().zip(times) {
            let frame = (time * motion.rate).round() as usize;
            bout.draw(&mut shot.scene, frame);
            shot.bout = Some(bout.at(frame).clone());
        }
    }
    strip.write(path, &shots)
}

/// What one picture shows: a scene about a point, and how much there is to either side, m.
pub(super) struct Shot {
    scene: Scene,
    focus: Vec3,
    side: f32,
    /// How it stands, if it is of a bout.
    bout: Option<Bout>,
}

/// What draws the pictures of a strip.
pub(super) struct Strip<'a> {
    model: &'a Arc<Model>,
    renderer: Renderer,
    target: RenderTarget,
    camera: Camera,
}

impl<'a> Strip<'a> {
    /// Pictures of `size` pixels from beside the front of a body at positions `start`.
    pub(super) fn new(
        gpu: &Gpu,
        model: &'a Arc<Model>,
        start: &[f32],
        size: [u32; 2],
    ) -> Strip<'a> {
        let front = shapes::seen(shapes::poses(model, start)[0].rotation * Vec3::X);
        Strip {
            model,
            renderer: Renderer::new(gpu),
            target: RenderTarget::new(&gpu.setup.device, size),
            camera: Camera {
                yaw: front.x.atan2(front.z) + YAW,
                ..Camera::default()
            },
        }
    }

    /// A motion at some times, s.
    pub(super) fn replayed(
        &self,
        motion: &MotionClip,
        times: impl IntoIterator<Item = f32>,
    ) -> Vec<Shot> {
        let shots = times.into_iter().map(|time| {
            let recorded = self.recorded(motion, time);
            let mut scene = Scene::default();
            shapes::draw(&mut scene, self.model, &recorded, Vec3::ZERO, Look::Solid);
            let (focus, side) = shapes::company(self.model, &recorded);
            Shot {
                scene,
                focus,
                side,
                bout: None,
            }
        });
        shots.collect()
    }

    fn driven(&self, motion: &MotionClip) -> Vec<Shot> {
        let aside = self.camera.over_ground(ASIDE);
        let mut body = Driven::new(self.model, motion);
        let shots = times([0.0, FALL.min(motion.seconds())]).map(|time| {
            body.until(time);
            let (simulated, recorded) = (
                shapes::poses(self.model, &body.state.q),
                self.recorded(motion, time),
            );
            let [one, other] = [&simulated, &recorded].map(|poses| shapes::seen(poses[0].position));
            let between = other + aside - one;
            let mut scene = Scene::default();
            shapes::draw(&mut scene, self.model, &recorded, aside, Look::Ghost);
            shapes::draw(&mut scene, self.model, &simulated, Vec3::ZERO, Look::Solid);
            Shot {
                scene,
                focus: one + between / 2.0,
                side: between.length() / 2.0,
                bout: None,
            }
        });
        shots.collect()
    }

    fn recorded(&self, motion: &MotionClip, time: f32) -> Vec<Pose> {
        shapes::poses(self.model, &motion.at(self.model, time).0)
    }

    /// A picture, RGB.
    ///
    /// # Errors
    /// The GPU was lost.
    pub(super) fn picture(&mut self, shot: &Shot) -> Result<Vec<u8>> {
        self.camera.follow([shot.focus.x, shot.focus.z], 1.0);
        self.camera.distance = NEAR + WIDE * shot.side;
        self.renderer
            .draw(&shot.scene, None, &self.camera, &self.target);
        let (device, queue) = (&self.renderer.device, &self.renderer.queue);
        let mut rgb = self.target.read(device, queue)?;
        if let Some(bout) = &shot.bout {
            bout_bars::draw(&mut rgb, self.target.size, bout);
        }
        Ok(rgb)
    }

    /// One picture beside the other.
    fn write(&mut self, path: &Path, shots: &[Shot]) -> Result<()> {
        let [width, height] = self.target.size.map(|side| side as usize);
        let total_width = PICTURES * (width + GAP) - GAP;
        let mut strip = vec![255; 3 * total_width * height];
        for (index, shot) in shots.iter().enumerate() {
            let picture = self.picture(shot)?;
            let rows = strip.chunks_exact_mut(3 * total_width);
            for (row, pixels) in rows.zip(picture.chunks_exact(3 * width)) {
                row[3 * index * (width + GAP)..][..3 * width].copy_from_slice(pixels);
            }
        }
        image_files::png(path, [total_width as u32, height as u32], &strip)
    }
}

/// The simulated body, its drives' targets the recorded angles.
struct Driven<'a> {
    motion: &'a MotionClip,
    simulator: Simulator,
    state: SimulatorState,
    steps: usize,
}

impl<'a> Driven<'a> {
    fn new(model: &Arc<Model>, motion: &'a MotionClip) -> Driven<'a> {
        let (q, v) = motion.at(model, 0.0);
        Driven {
            motion,
            simulator: Simulator::new(model.clone(), SolverOptions::fast(model)),
            state: SimulatorState {
                q,
                v,
                ..SimulatorState::new(model)
            },
            steps: 0,
        }
    }

    /// An action requests the angles at its end.
    fn until(&mut self, time: f32) {
        let model = self.simulator.model.clone();
        while (self.steps as f32) < (time * STEP_RATE).round() {
            let end = (self.steps / SUBSTEPS + 1) * SUBSTEPS;
            let (wanted, _) = self.motion.at(&model, end as f32 / STEP_RATE);
            self.simulator
                .step(&mut self.state, &pd_targets(&model, &wanted), &[]);
            self.steps += 1;
        }
    }
}

/// The times of a strip's pictures, s.
pub(super) fn times([start, end]: [f32; 2]) -> impl Iterator<Item = f32> {
    let part = |picture: usize| picture as f32 / (PICTURES - 1) as f32;
    (0..PICTURES).map(move |picture| start + (end - start) * part(picture))
}
