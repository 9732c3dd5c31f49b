//! What somebody presses who fights.

use eframe::egui::{Key, Ui};

/// Keys or sticks that are held.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pressed {
    /// Where to walk: to the right of the picture and away from the user.
    pub walk: [f32; 2],
    /// Which way to face, likewise.
    pub face: [f32; 2],
    /// To the left, 1, or to the right, -1.
    pub turn: f32,
    /// Whether to attack.
    pub punch: bool,
}

impl Pressed {
    /// The keys that are held.
    pub fn keys(ui: &Ui) -> Pressed {
        let down = |key| ui.input(|input| input.key_down(key));
        let axis = |more, less| f32::from(u8::from(down(more))) - f32::from(u8::from(down(less)));
        Pressed {
            walk: [axis(Key::D, Key::A), axis(Key::W, Key::S)],
            face: [0.0; 2],
            turn: axis(Key::Q, Key::E),
            punch: down(Key::J),
        }
    }
}
