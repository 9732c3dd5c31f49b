//! The contents of the window of a simulated body.

use super::bout_panel::BoutPanel;
use super::policies::Policies;
use super::screen::{PointerAction, Screen};
use super::skills_panel::{LatentWish, SkillsPanel};
use super::timeline::Timeline;
use super::transport::{self, Seek, Transport};
use crate::env::humanoid::task::DT;
use crate::gpu::Gpu;
use crate::train::body_policy::BodyPolicy;
use crate::view::Camera;
use crate::view::body_grip::{BodyGrip, centres};
use crate::view::body_playthrough::{BodyContext, BodyPlaythrough, BodyPush};
use crate::view::body_scene::{BodyExtras, body_scene};
use crate::view::camera::{FOLLOW, Ray};
use crate::view::latent_map::LatentMap;
use crate::view::shapes::{self, simulated};
use anyhow::{Context, Result};
use eframe::egui::{self, Ui};
use eframe::egui_wgpu::RenderState;
use glam::Vec3;

/// The window of `play` of a simulated body.
pub struct BodyViewer {
    context: BodyContext,
    policies: Policies<BodyPolicy>,
    policy: BodyPolicy,
    timeline: Timeline<BodyPlaythrough>,
    transport: Transport,
    camera: Camera,
    extras: BodyExtras,
    /// The panel of a policy of skills.
    skills: Option<SkillsPanel>,
    /// The panel of a bout.
    bout: Option<BoutPanel>,
    grip: Option<BodyGrip>,
    /// What went wrong last.
    problem: Option<String>,
    screen: Screen,
}

impl BodyViewer {
    /// Shows the last of a run's policies.
    ///
    /// # Errors
    /// There is none, or it cannot be loaded.
    pub fn new(
        gpu: &Gpu,
        window: &RenderState,
        mut context: BodyContext,
        mut policies: Policies<BodyPolicy>,
    ) -> Result<Self> {
        let policy = policies.load().context("the run has no checkpoints")??;
        // Between fighters, arrows and a third body would be in the way.
        let alone = context.episodes().bouts.is_none();
        let mut viewer = BodyViewer {
            timeline: Timeline::new(BodyPlaythrough::new(&mut context, 0)?),
            skills: SkillsPanel::new(&context, &policy),
            bout: (!alone).then(BoutPanel::open),
            policy,
            policies,
            context,
            transport: Transport::default(),
            camera: Camera::default(),
            extras: BodyExtras {
                forces: alone,
                reference: alone,
            },
            grip: None,
            problem: None,
            screen: Screen::new(gpu, window),
        };
        viewer.look_at_it(1.0);
        Ok(viewer)
    }

    /// Draws the window and takes its input.
    pub fn show(&mut self, ui: &mut Ui) {
        self.keys(ui);
        for _ in 0..self.transport.due(ui) {
            self.forward();
        }
        let (frame, frames) = (self.timeline.at(), self.timeline.len());
        let bar = egui::Panel::bottom("transport");
        let seek = bar.show(ui, |ui| self.transport.show(ui, frame, frames));
        if let Some(seek) = seek.inner {
            self.seek(seek);
        }
        egui::Panel::right("state")
            .default_size(260.0)
            .show(ui, |ui| self.state(ui));
        self.skills(ui);
        self.bout(ui);
        egui::CentralPanel::default()
            .frame(egui::Frame::NONE)
            .show(ui, |ui| self.world(ui));
        if self.transport.playing {
            ui.ctx().request_repaint();
        }
    }

    /// The map of latents, once it is made.
    pub fn latent_map(&self) -> Option<&LatentMap> {
        self.skills.as_ref().and_then(SkillsPanel::map)
    }

    /// What has been played.
    pub fn timeline(&self) -> &Timeline<BodyPlaythrough> {
        &self.timeline
    }

    fn keys(&mut self, ui: &Ui) {
        let taken = transport::keys_are_taken(ui);
        if let Some(bout) = &mut self.bout {
            match taken {
                true => bout.release(),
                false => bout.keys(ui),
            }
        }
        if taken {
            return;
        }
        if let Some(seek) = self.transport.keys(ui) {
            self.seek(seek);
        }
    }

    /// A step on.
    fn forward(&mut self) {
        self.command();
        let push = self.push();
        let next = |now: &BodyPlaythrough| now.next(&mut self.context, &self.policy, push);
        let advanced = self.timeline.forward(next);
        if self.succeeded(advanced).is_none() {
            self.transport.playing = false;
        }
        self.look_at_it(FOLLOW);
    }

    /// Tells red what is pressed. Who presses something in the middle of what has been played goes on from there.
    fn command(&mut self) {
        let Some(bout) = &self.bout else {
            return;
        };
        let now = self.timeline.now();
        let is_last = self.timeline.at() + 1 == self.timeline.len();
        let command = bout.command(&self.camera, &now.q);
        if command != now.command && (is_last || bout.is_pressed()) {
            self.timeline.change().obey(command);
        }
    }

    /// Stops at another frame.
    fn seek(&mut self, seek: Seek) {
        self.transport.playing = false;
        match seek {
            Seek::Next => return self.forward(),
            Seek::Previous => self.timeline.go_to(self.timeline.at().saturating_sub(1)),
            Seek::To(frame) => self.timeline.go_to(frame),
        }
        self.look_at_it(1.0);
    }

    /// What came of something; a failure is shown.
    fn succeeded<T>(&mut self, result: Result<T>) -> Option<T> {
        if let Err(error) = &result {
            self.problem = Some(format!("{error:#}"));
        }
        result.ok()
    }

    fn look_at_it(&mut self, fraction: f32) {
        if self.transport.follow {
            let model = self.context.model();
            let poses = shapes::poses(model, &self.timeline.now().q);
            let (at, side) = shapes::company(model, &poses);
            let aspect = self.screen.aspect();
            self.camera.frame([at.x, at.z], side, aspect, fraction);
        }
    }

    fn skills(&mut self, ui: &mut Ui) {
        let Some(skills) = &mut self.skills else {
            return;
        };
        let panel = egui::Panel::left("skills").default_size(250.0);
        let now = self.timeline.now();
        match panel.show(ui, |ui| skills.show(ui, now)).inner {
            Some(LatentWish::Hold(latent, steps)) => self.timeline.change().hold(latent, steps),
            Some(LatentWish::Change) => self.timeline.change().path = None,
            None => {}
        }
    }

    fn bout(&mut self, ui: &mut Ui) {
        let now = self.timeline.now();
        if let (Some(panel), Some(bout)) = (&mut self.bout, &now.bout) {
            let side = egui::Panel::left("bout").default_size(190.0);
            side.show(ui, |ui| panel.show(ui, bout, now.steps as f32 * DT));
        }
    }

    fn state(&mut self, ui: &mut Ui) {
        if let Some(problem) = &self.problem {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        if let Some(loaded) = self.policies.show(ui)
            && let Some(policy) = self.succeeded(loaded)
        {
            self.skills = SkillsPanel::new(&self.context, &policy);
            self.policy = policy;
            self.problem = None;
            self.timeline.change();
        }
        if ui.button("Next episode").clicked() {
            let begun = self.timeline.now().next_episode(&mut self.context);
            if let Some(first) = self.succeeded(begun) {
                self.timeline = Timeline::new(first);
                self.look_at_it(1.0);
            }
        }
        ui.small("Drag the body to push it; drag elsewhere to turn the camera.");
        if self.has_target() {
            ui.small("Click the ground to put the target there.");
        }
        ui.separator();
        ui.checkbox(&mut self.extras.forces, "Contact forces");
        if self.context.reference.is_some() {
            ui.checkbox(&mut self.extras.reference, "Recording");
        }
        ui.separator();
        self.moment(ui);
    }

    fn moment(&self, ui: &mut Ui) {
        let now = self.timeline.now();
        ui.strong(format!("Episode {}", now.episode));
        ui.label(format!("{:.2} s", now.steps as f32 * DT));
        ui.label(format!("reward {:.2}", now.reward));
        if let [own, target] = &self.context.model().trees[..] {
            let centres = centres(self.context.model(), &now.q);
            let far = centres[target.bodies.start].distance(centres[own.bodies.start]);
            let what = self.bout.as_ref().map_or("target", |_| "opponent");
            ui.label(format!("{what} {far:.1} m away"));
        }
        if let (Some(discriminator), Some(style)) = (&self.policy.discriminator, now.style) {
            let bar = egui::ProgressBar::new(discriminator.share(style).clamp(0.0, 1.0));
            ui.add(bar.text(format!("style reward {style:.2}")))
                .on_hover_text("Full: taken for a recording. Half: not told from one.");
        }
        if let Some(push) = now.push {
            let body = &self.context.model().bodies[push.body].name;
            ui.label(format!("pushed by {:.0} N: {body}", push.force.length()));
        }
        if let (Some(reference), Some(frame)) = (&self.context.reference, now.reference) {
            let (name, time) = reference.name(frame);
            ui.label(format!("most like {name} at {time:.2} s"));
        }
    }

    fn world(&mut self, ui: &mut Ui) {
        let (now, context) = (self.timeline.now(), &self.context);
        let scene = body_scene(now, context, self.push(), self.extras, &self.camera);
        let grabbed = self.grip.is_some();
        let touch = self
            .screen
            .show(ui, &scene, None, &mut self.camera, grabbed);
        match touch {
            Some(PointerAction::Click(ray)) => self.move_target(&ray),
            Some(PointerAction::Press(ray)) => {
                let (model, now) = (self.context.model(), self.timeline.now());
                self.grip = BodyGrip::take(model, &now.q, &ray);
            }
            Some(PointerAction::Drag(ray)) => {
                if let Some(grip) = &mut self.grip {
                    grip.ray = ray;
                    self.timeline.change();
                }
            }
            Some(PointerAction::Release) => self.grip = None,
            None => {}
        }
    }

    fn has_target(&self) -> bool {
        self.context.model().trees.len() > 1 && self.bout.is_none()
    }

    fn move_target(&mut self, ray: &Ray) {
        let Some([x, z]) = ray.ground().filter(|_| self.has_target()) else {
            return;
        };
        let at = simulated(Vec3::new(x, 0.0, z));
        let moment = self.timeline.change();
        let moved = moment.move_target(&mut self.context, [at.x, at.y]);
        self.succeeded(moved);
    }

    /// The push of the body that is held.
    fn push(&self) -> Option<BodyPush> {
        let (model, now) = (self.context.model(), self.timeline.now());
        self.grip?.push(model, &now.q, &self.camera)
    }
}
