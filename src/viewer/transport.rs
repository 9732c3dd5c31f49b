//! The bar below a window: plays, pauses, goes a frame on or back, or to any.

use crate::motion::RATE;
use eframe::egui::{self, Key, Ui};

/// Frames played at once, at most, when drawing is slower than the motion.
const CATCH_UP: f32 = 6.0;

/// Whether frames are played, and how fast.
pub struct Transport {
    /// Whether they are.
    pub playing: bool,
    /// Whether the camera follows the character.
    pub follow: bool,
    /// Of the motion's own.
    speed: f32,
    /// Frames that time has passed for and that are not played yet.
    owed: f32,
}

impl Default for Transport {
    fn default() -> Self {
        Transport {
            playing: true,
            follow: true,
            speed: 1.0,
            owed: 0.0,
        }
    }
}

/// Another frame that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seek {
    /// The next one.
    Next,
    /// The one before.
    Previous,
    /// One by its number.
    To(usize),
}

/// Whether a widget waits for keys, which are then the widget's.
pub fn keys_are_taken(ui: &Ui) -> bool {
    ui.ctx().memory(|memory| memory.focused().is_some())
}

impl Transport {
    /// Takes the keys: space, and left and right.
    pub fn keys(&mut self, ui: &Ui) -> Option<Seek> {
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        if pressed(Key::Space) {
            self.playing = !self.playing;
        }
        let next = pressed(Key::ArrowRight).then_some(Seek::Next);
        next.or(pressed(Key::ArrowLeft).then_some(Seek::Previous))
    }

    /// Frames to play now.
    pub fn due(&mut self, ui: &Ui) -> usize {
        if !self.playing {
            return 0;
        }
        let passed = ui.input(|input| input.stable_dt);
        self.owed = (self.owed + passed * RATE * self.speed).min(CATCH_UP);
        let due = self.owed.floor();
        self.owed -= due;
        due as usize
    }

    /// Draws the bar at a frame of so many, and takes its input.
    pub fn show(&mut self, ui: &mut Ui, frame: usize, frames: usize) -> Option<Seek> {
        let mut seek = None;
        ui.horizontal(|ui| {
            let play = if self.playing { "Pause" } else { "Play" };
            if ui.button(play).on_hover_text("Space").clicked() {
                self.playing = !self.playing;
            }
            if ui.button("Back").on_hover_text("Left arrow").clicked() {
                seek = Some(Seek::Previous);
            }
            if ui.button("Step").on_hover_text("Right arrow").clicked() {
                seek = Some(Seek::Next);
            }
            ui.label("Speed");
            let speed = egui::Slider::new(&mut self.speed, 0.1..=4.0).logarithmic(true);
            ui.add(speed.max_decimals(2));
            ui.checkbox(&mut self.follow, "Follow");
            let mut chosen = frame;
            ui.spacing_mut().slider_width = (ui.available_width() - 110.0).max(60.0);
            let scrubber = egui::Slider::new(&mut chosen, 0..=frames.saturating_sub(1))
                .custom_formatter(|frame, _| format!("{:.2} s", frame / f64::from(RATE)));
            if ui.add(scrubber).changed() {
                seek = Some(Seek::To(chosen));
            }
        });
        seek
    }
}
