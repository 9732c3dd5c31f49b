//! The map of latents in a window: what the character does under which, and which it is to do.

use crate::env::humanoid::task::DT;
use crate::train::body_policy::BodyPolicy;
use crate::view::body_playthrough::{BodyContext, BodyPlaythrough};
use crate::view::latent_map::{LatentMap, MapPoint};
use eframe::egui::ecolor::HsvaGamma;
use eframe::egui::{self, Color32, Pos2, Response, Sense, Stroke, Ui, Vec2, WidgetInfo};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Points from the disc's edge to the panel's.
const MARGIN: f32 = 8.0;
/// From a point of the map to the pointer, points: as near it is taken hold of.
const REACH: f32 = 6.0;
/// How long it takes to glide to another latent, s.
const GLIDE_S: f32 = 2.0;
/// How often it is looked whether the map is ready.
const LOOK_AGAIN: Duration = Duration::from_millis(100);

/// What somebody wants of the latents.
#[derive(Clone, Debug, PartialEq)]
pub enum LatentWish {
    /// This one is held, after a way of so many steps.
    Hold(Vec<f32>, usize),
    /// They change as in training.
    Change,
}

/// The panel of a policy of skills.
pub struct SkillsPanel {
    map: Option<LatentMap>,
    /// The map in the making.
    making: Option<JoinHandle<LatentMap>>,
    glides: bool,
}

impl SkillsPanel {
    /// A panel whose map is made beside everything else; `None` if the task has no latents.
    pub fn new(context: &BodyContext, policy: &BodyPolicy) -> Option<SkillsPanel> {
        let episodes = context.episodes().clone();
        let (library, draw) = (episodes.recordings.clone()?, episodes.latents.clone()?);
        let driver = policy.driver.clone();
        let make = move || LatentMap::new(&episodes, &library, &draw, &*driver);
        Some(SkillsPanel {
            map: None,
            making: Some(thread::spawn(make)),
            glides: false,
        })
    }

    /// The map, once it is made.
    pub fn map(&self) -> Option<&LatentMap> {
        self.map.as_ref()
    }

    /// Draws the panel of a moment, and takes its input.
    pub fn show(&mut self, ui: &mut Ui, now: &BodyPlaythrough) -> Option<LatentWish> {
        self.take_map();
        ui.strong("Skills");
        let chosen = match &self.map {
            Some(map) => disc(ui, map, now),
            None if self.making.is_none() => {
                ui.label("The map could not be made.");
                None
            }
            None => {
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.label("Playing under many latents …");
                });
                ui.ctx().request_repaint_after(LOOK_AGAIN);
                None
            }
        };
        ui.small("Click to hold a latent: the character does it.");
        ui.checkbox(&mut self.glides, "Glide there")
            .on_hover_text("Along the great circle, in two seconds");
        let change = egui::Button::new("Change latents as in training");
        let change = ui.add_enabled(now.path.is_some(), change).clicked();
        ui.separator();
        let named = self.map.as_ref().and_then(|map| legend(ui, map));
        let steps = if self.glides { GLIDE_S / DT } else { 0.0 } as usize;
        let held = chosen
            .or(named)
            .map(|latent| LatentWish::Hold(latent, steps));
        held.or(change.then_some(LatentWish::Change))
    }

    fn take_map(&mut self) {
        if let Some(made) = self.making.take_if(|making| making.is_finished()) {
            self.map = made.join().ok();
        }
    }
}

/// The disc. Returns the latent that is clicked.
fn disc(ui: &mut Ui, map: &LatentMap, now: &BodyPlaythrough) -> Option<Vec<f32>> {
    let side = Vec2::splat(ui.available_width());
    let (rect, response) = ui.allocate_exact_size(side, Sense::click());
    let disc = Disc {
        centre: rect.center(),
        radius: 0.5 * side.x - MARGIN,
    };
    disc.draw(ui, map, now);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Map of latents"));
    let pointed = |at: Pos2| map.near(disc.at(at), REACH / disc.radius);
    let response = told(response, map, pointed);
    let clicked = response.interact_pointer_pos();
    let at = clicked.filter(|_| response.clicked())?;
    Some(match pointed(at) {
        Some(point) => point.latent.clone(),
        None => map.latent(disc.at(at), now.latent()),
    })
}

/// Tells what the character does under the point at the pointer.
fn told<'a>(
    response: Response,
    map: &LatentMap,
    pointed: impl Fn(Pos2) -> Option<&'a MapPoint>,
) -> Response {
    let Some(point) = response.hover_pos().and_then(pointed) else {
        return response;
    };
    let own = point.own.as_ref().map(|name| format!("latent of {name}"));
    let does = match point.clip {
        Some(clip) => format!("moves like {}", map.legend[clip]),
        None => "falls".to_string(),
    };
    let words: Vec<String> = own.into_iter().chain([does]).collect();
    response.on_hover_text_at_pointer(words.join("\n"))
}

/// Where the map is in the window.
struct Disc {
    centre: Pos2,
    radius: f32,
}

impl Disc {
    /// The place on the map of a place in the window.
    fn at(&self, pos: Pos2) -> [f32; 2] {
        let away = (pos - self.centre) / self.radius;
        [away.x, -away.y]
    }

    /// Where a latent is in the window.
    fn pos(&self, map: &LatentMap, latent: &[f32]) -> Pos2 {
        let [x, y] = map.place(latent);
        self.centre + self.radius * Vec2::new(x, -y)
    }

    fn draw(&self, ui: &Ui, map: &LatentMap, now: &BodyPlaythrough) {
        let (painter, ink) = (ui.painter(), ui.visuals().strong_text_color());
        let edge = Stroke::new(1.0, ui.visuals().weak_text_color());
        painter.circle(
            self.centre,
            self.radius,
            ui.visuals().extreme_bg_color,
            edge,
        );
        for point in &map.points {
            let pos = self.pos(map, &point.latent);
            match point.own {
                Some(_) => painter.circle(pos, 5.0, colour(point.clip), Stroke::new(1.0, ink)),
                None => painter.circle_filled(pos, 3.5, colour(point.clip)),
            };
        }
        if let Some(path) = &now.path {
            painter.circle_stroke(self.pos(map, path.end()), 9.0, Stroke::new(1.5, ink));
        }
        if !now.latent().is_empty() {
            let present = self.pos(map, now.latent());
            painter.circle(present, 4.5, ink, Stroke::new(1.5, Color32::BLACK));
        }
    }
}

/// The clips and their colours. Returns a latent of the clip that is clicked.
fn legend(ui: &mut Ui, map: &LatentMap) -> Option<Vec<f32>> {
    let clips = map.legend.iter().enumerate();
    let clips = clips.map(|(clip, name)| (Some(clip), &**name));
    let mut chosen = None;
    egui::ScrollArea::vertical().show(ui, |ui| {
        for (clip, name) in clips.chain([(None, "falls")]) {
            ui.horizontal(|ui| {
                let (rect, _) = ui.allocate_exact_size(Vec2::splat(10.0), Sense::hover());
                ui.painter().circle_filled(rect.center(), 4.5, colour(clip));
                if ui.selectable_label(false, name).clicked() {
                    chosen = map.points.iter().find(|point| point.clip == clip);
                }
            });
        }
    });
    chosen.map(|point| point.latent.clone())
}

/// The colour of a clip in the legend: one behind the other they are far apart.
fn colour(clip: Option<usize>) -> Color32 {
    /// Part of a circle of hues between two colours: the golden section.
    const BETWEEN: f32 = 0.618_034;
    let Some(clip) = clip else {
        return Color32::from_gray(75);
    };
    let hue = (0.58 + BETWEEN * clip as f32).fract();
    let (saturation, value) = [(0.9, 0.95), (0.55, 1.0), (1.0, 0.65)][clip % 3];
    HsvaGamma {
        h: hue,
        s: saturation,
        v: value,
        a: 1.0,
    }
    .into()
}
