//! The contents of the viewer's window.

#[cfg(feature = "gamepad")]
use super::gamepad::Gamepad;
use super::maps;
use super::policies::Policies;
use super::runners_up::{Found, nearest};
use super::screen::{PointerAction, Screen};
use super::source::{self, Source, Steered};
use super::timeline::Timeline;
use super::transport::{self, Seek, Transport};
use crate::gpu::Gpu;
use crate::kernels::locomotion::locomotion_layout::CELL;
use crate::motion::RATE;
use crate::motion::features::{FRAMES_PER_STEP, ROW_STRIDE};
use crate::playback::PlacedFrame;
use crate::train::controller::Controller;
use crate::train::playthrough::{Playthrough, PlaythroughContext};
use crate::view::camera::FOLLOW;
use crate::view::debug_draw::{self, MATCHED, trajectory};
use crate::view::{Camera, Scene};
use anyhow::Result;
use eframe::egui::{self, Key, Ui};
use eframe::egui_wgpu::RenderState;

/// Width of a frame's name in the search's table, points.
const NAME: f32 = 150.0;
/// Search results listed.
const LISTED: usize = 8;

/// The window of `play` of motion matching.
pub struct Viewer {
    context: PlaythroughContext,
    source: Source,
    /// A run's checkpoints; none when only motion is shown.
    policies: Policies<Box<dyn Controller>>,
    timeline: Timeline<Playthrough>,
    /// Frame of a clip.
    clip_frame: usize,
    transport: Transport,
    camera: Camera,
    /// The obstacle being dragged, and the pointer relative to its centre, m.
    grabbed: Option<(usize, [f32; 2])>,
    search: bool,
    found: Vec<Found>,
    /// The query of `found`.
    found_for: Option<[f32; ROW_STRIDE]>,
    /// What went wrong last.
    problem: Option<String>,
    screen: Screen,
    #[cfg(feature = "gamepad")]
    gamepad: Option<Gamepad>,
}

impl Viewer {
    /// Shows the last of a run's policies, or without any steered motion matching.
    ///
    /// # Errors
    /// The policy cannot be loaded.
    pub fn new(
        gpu: &Gpu,
        window: &RenderState,
        context: PlaythroughContext,
        mut policies: Policies<Box<dyn Controller>>,
    ) -> Result<Self> {
        let source = match policies.load() {
            Some(policy) => Source::Policy(policy?),
            None => Source::Steered(Steered::new(context.database().clone())),
        };
        let mut camera = Camera::default();
        if context.task.obstacles() > 0 {
            camera.distance = 9.0;
            camera.pitch = 0.6;
        }
        Ok(Viewer {
            timeline: Timeline::new(Playthrough::new(&context, 0)),
            context,
            source,
            policies,
            clip_frame: 0,
            transport: Transport::default(),
            camera,
            grabbed: None,
            search: true,
            found: Vec::new(),
            found_for: None,
            problem: None,
            screen: Screen::new(gpu, window),
            #[cfg(feature = "gamepad")]
            gamepad: Gamepad::open(),
        })
    }

    /// Draws the window and takes its input.
    pub fn show(&mut self, ui: &mut Ui) {
        self.keys(ui);
        for _ in 0..self.transport.due(ui) {
            self.forward();
        }
        let (frame, frames) = (self.frame(), self.frames());
        let bar = egui::Panel::bottom("transport");
        let seek = bar.show(ui, |ui| self.transport.show(ui, frame, frames));
        if let Some(seek) = seek.inner {
            self.seek(seek);
        }
        egui::Panel::right("why")
            .default_size(300.0)
            .show(ui, |ui| {
                egui::ScrollArea::vertical().show(ui, |ui| self.why(ui));
            });
        let frame = egui::Frame::NONE;
        egui::CentralPanel::default()
            .frame(frame)
            .show(ui, |ui| self.world(ui));
        if self.transport.playing {
            ui.ctx().request_repaint();
        }
    }

    /// The shown frame and its position.
    pub fn shown(&self) -> PlacedFrame {
        match self.source {
            Source::Clip(clip) => self.clip_shown(clip),
            _ => self.timeline.now().shown,
        }
    }

    /// What has been played.
    pub fn timeline(&self) -> &Timeline<Playthrough> {
        &self.timeline
    }

    fn keys(&mut self, ui: &Ui) {
        if transport::keys_are_taken(ui) {
            return;
        }
        let seek = self.transport.keys(ui);
        match (&self.source, seek) {
            (Source::Steered(_), _) => self.steer(ui),
            (_, Some(seek)) => self.seek(seek),
            (_, None) => {}
        }
    }

    /// Arrow keys or WASD, or a gamepad's stick: up is away from the camera. With shift or the right
    /// shoulder the character runs.
    fn steer(&mut self, ui: &Ui) {
        #[cfg(feature = "gamepad")]
        if let Some(push) = self.gamepad.as_mut().and_then(Gamepad::push) {
            return self.steer_to(push.right, push.away, push.run);
        }
        let down = |keys: [Key; 2]| {
            let down = ui.input(|input| keys.iter().any(|&key| input.key_down(key)));
            f32::from(u8::from(down))
        };
        let right = down([Key::ArrowRight, Key::D]) - down([Key::ArrowLeft, Key::A]);
        let away = down([Key::ArrowUp, Key::W]) - down([Key::ArrowDown, Key::S]);
        let run = ui.input(|input| input.modifiers.shift);
        self.steer_to(right, away, run);
    }

    /// Takes effect where the next step is decided, at the end of what has been played.
    fn steer_to(&mut self, right: f32, away: f32, run: bool) {
        let now = self.timeline.now();
        if now.played != FRAMES_PER_STEP || self.timeline.at() + 1 != self.timeline.len() {
            return;
        }
        let push = right.hypot(away);
        let Source::Steered(steered) = &mut self.source else {
            return;
        };
        let pace = if run { source::RUN } else { source::WALK };
        steered.ease_to(pace * push.min(1.0));
        let at = now.shown.at;
        let direction = match push > 0.0 {
            true => {
                let (sin, cos) = self.camera.yaw.sin_cos();
                let x = right * cos - away * sin;
                let z = -right * sin - away * cos;
                [x / push, z / push]
            }
            false => now.shown.heading,
        };
        let target = [0, 1].map(|i| at[i] + source::LOOK_AHEAD_M * direction[i]);
        self.timeline.change().set_target(target);
    }

    /// A frame on.
    fn forward(&mut self) {
        match self.source.controller() {
            Some(controller) => {
                let advanced = self.timeline.forward(|now| {
                    let mut next = now.clone();
                    next.advance(&self.context, controller)?;
                    Ok(next)
                });
                if let Err(error) = advanced {
                    self.problem = Some(format!("{error:#}"));
                    self.transport.playing = false;
                }
            }
            None => self.clip_frame = (self.clip_frame + 1) % self.frames(),
        }
        if self.transport.follow {
            self.camera.follow(self.shown().at, FOLLOW);
        }
    }

    /// Frames there are to go to.
    fn frames(&self) -> usize {
        match self.source {
            Source::Clip(clip) => self.context.database().clips[clip].frames,
            _ => self.timeline.len(),
        }
    }

    fn frame(&self) -> usize {
        match self.source {
            Source::Clip(_) => self.clip_frame,
            _ => self.timeline.at(),
        }
    }

    /// Stops at another frame.
    fn seek(&mut self, seek: Seek) {
        self.transport.playing = false;
        match seek {
            Seek::Next => self.forward(),
            Seek::Previous => self.go_to(self.frame().saturating_sub(1)),
            Seek::To(frame) => self.go_to(frame),
        }
    }

    fn go_to(&mut self, frame: usize) {
        match self.source {
            Source::Clip(_) => self.clip_frame = frame,
            _ => self.timeline.go_to(frame),
        }
        if self.transport.follow {
            self.camera.follow(self.shown().at, 1.0);
        }
    }

    fn why(&mut self, ui: &mut Ui) {
        if let Some(problem) = &self.problem {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        match self.policies.is_empty() {
            true => self.choose_motion(ui),
            false => self.choose_policy(ui),
        }
        if let Source::Clip(_) = self.source {
            return;
        }
        ui.separator();
        self.state(ui);
        let count = self.context.task.obstacles();
        if count > 0 {
            ui.separator();
            ui.strong("Obstacle maps");
            ui.small(format!("cells of {CELL} m, ahead is up"));
            maps::show(ui, self.timeline.now().maps());
        }
        ui.separator();
        ui.checkbox(&mut self.search, "Search");
        if self.search {
            self.show_search(ui);
        }
    }

    fn choose_policy(&mut self, ui: &mut Ui) {
        match self.policies.show(ui) {
            Some(Ok(policy)) => {
                self.source = Source::Policy(policy);
                self.problem = None;
                self.timeline.change();
            }
            Some(Err(error)) => self.problem = Some(format!("{error:#}")),
            None => {}
        }
        if ui.button("Next episode").clicked() {
            let next = self.timeline.now().episode + 1;
            self.timeline = Timeline::new(Playthrough::new(&self.context, next));
        }
        ui.small("Click the ground to move the target; drag an obstacle; drag elsewhere to turn the camera.");
    }

    fn choose_motion(&mut self, ui: &mut Ui) {
        let steered = matches!(self.source, Source::Steered(_));
        if ui.selectable_label(steered, "Steer").clicked() && !steered {
            self.source = Source::Steered(Steered::new(self.context.database().clone()));
            self.transport.playing = true;
        }
        ui.small("Arrow keys or WASD walk, with shift run.");
        ui.separator();
        ui.strong("Clips");
        let chosen = match self.source {
            Source::Clip(clip) => Some(clip),
            _ => None,
        };
        let list = egui::ScrollArea::vertical()
            .id_salt("clips")
            .max_height(260.0);
        list.show(ui, |ui| {
            for index in 0..self.context.database().clips.len() {
                self.clip_entry(ui, index, chosen == Some(index));
            }
        });
    }

    fn clip_entry(&mut self, ui: &mut Ui, index: usize, chosen: bool) {
        let clip = &self.context.database().clips[index];
        let seconds = clip.frames as f32 / RATE;
        let label = format!("{} ({seconds:.0} s)", clip.name);
        let response = ui.selectable_label(chosen, label);
        let response = response.on_hover_text(format!("{}\n{}", clip.source, clip.licence));
        if response.clicked() {
            self.source = Source::Clip(index);
            self.clip_frame = 0;
            self.transport.playing = true;
            self.camera.follow(self.clip_shown(index).at, 1.0);
        }
    }

    fn state(&self, ui: &mut Ui) {
        let now = self.timeline.now();
        let [x, z] = now.shown.at;
        ui.label(format!("at {x:.2}, {z:.2} m"));
        if let Source::Policy(_) = self.source {
            ui.strong(format!("Episode {}", now.episode));
            let [tx, tz] = now.target();
            ui.label(format!("{:.2} m to the target", (tx - x).hypot(tz - z)));
        }
        ui.label(format!("plays {}", self.name(now.shown.frame)));
        ui.horizontal(|ui| {
            ui.colored_label(colour(debug_draw::REQUESTED), "requested");
            ui.colored_label(colour(MATCHED), "matched");
        });
    }

    /// A frame, by its clip and its number there.
    fn name(&self, frame: usize) -> String {
        let clip = self.context.database().clip(frame);
        format!("{} {}", clip.name, frame - clip.first)
    }

    fn show_search(&mut self, ui: &mut Ui) {
        let now = self.timeline.now();
        if now.step.is_none() {
            return;
        }
        let query = now.env.queries[0];
        if self.found_for != Some(query) {
            self.found = nearest(self.context.database(), &query, LISTED);
            self.found_for = Some(query);
        }
        egui::Grid::new("found").striped(true).show(ui, |ui| {
            for header in ["frame", "pose", "trajectory", "sum"] {
                ui.small(header);
            }
            ui.end_row();
            for found in &self.found {
                // Columns do not move with the names' lengths.
                let name = egui::Label::new(self.name(found.frame)).truncate();
                ui.add_sized([NAME, ui.spacing().interact_size.y], name);
                for part in [found.pose, found.trajectory, found.total()] {
                    ui.monospace(format!("{part:.2}"));
                }
                ui.end_row();
            }
        });
        ui.small("Squared distances to the query, the frame played first.");
    }

    fn clip_shown(&self, clip: usize) -> PlacedFrame {
        let frame = self.context.database().clips[clip].first + self.clip_frame;
        let [x, z, hx, hz] = self.context.database().path[frame];
        PlacedFrame {
            frame,
            at: [x, z],
            heading: [hx, hz],
        }
    }

    fn scene(&self) -> Scene {
        let (context, now) = (&self.context, self.timeline.now());
        match self.source {
            Source::Policy(_) => debug_draw::scene(now, context),
            Source::Steered(_) => debug_draw::untargeted(now, context),
            Source::Clip(clip) => {
                let (mut scene, shown) = (Scene::default(), self.clip_shown(clip));
                let skeleton = &context.database().skeleton;
                let pose = shown.pose(context.database());
                scene.character(&context.rig, skeleton, &pose);
                let path = shown.path(context.database());
                trajectory(&mut scene, shown.at, &path, MATCHED);
                scene
            }
        }
    }

    fn world(&mut self, ui: &mut Ui) {
        let scene = self.scene();
        let grabbed = self.grabbed.is_some();
        let touch = self
            .screen
            .show(ui, &scene, None, &mut self.camera, grabbed);
        let Source::Policy(_) = self.source else {
            return;
        };
        match touch {
            Some(PointerAction::Click(ray)) => {
                if let Some(at) = ray.ground() {
                    self.timeline.change().set_target(at);
                }
            }
            Some(PointerAction::Press(ray)) => {
                self.grabbed = ray
                    .ground()
                    .and_then(|at| self.timeline.now().obstacle_at(at));
            }
            Some(PointerAction::Drag(ray)) => {
                if let (Some((slot, [x, z])), Some(at)) = (self.grabbed, ray.ground()) {
                    self.timeline
                        .change()
                        .move_obstacle(slot, [at[0] - x, at[1] - z]);
                }
            }
            Some(PointerAction::Release) => self.grabbed = None,
            None => {}
        }
    }
}

/// A linear colour as the window's.
fn colour(linear: [f32; 3]) -> egui::Color32 {
    let [r, g, b] = linear;
    egui::Rgba::from_rgb(r, g, b).into()
}
