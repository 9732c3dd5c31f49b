//! The panel of a bout: how it stands, and the keys of who fights in it.

#[cfg(feature = "gamepad")]
use super::gamepad::Gamepad;
use super::pressed::Pressed;
use crate::env::humanoid::boxing::bout::Bout;
use crate::env::humanoid::boxing::command::{FightCommand, facing};
use crate::view::Camera;
use crate::view::bout_bars::{CORNERS, fill};
use crate::view::shapes::simulated;
use eframe::egui::{self, Color32, Key, Ui};
use glam::Vec2;

const NAMES: [&str; 2] = ["Red", "Blue"];
/// How far ahead of where it faces a fighter looks that is told to turn, rad.
const TURN: f32 = 1.0;

/// The panel.
pub struct BoutPanel {
    fights: bool,
    pressed: Pressed,
    #[cfg(feature = "gamepad")]
    gamepad: Option<Gamepad>,
}

impl BoutPanel {
    /// A bout between policies, at first.
    pub fn open() -> BoutPanel {
        BoutPanel {
            fights: false,
            pressed: Pressed::default(),
            #[cfg(feature = "gamepad")]
            gamepad: Gamepad::open(),
        }
    }

    /// Takes the keys, or what is pressed on a gamepad.
    pub fn keys(&mut self, ui: &Ui) {
        if ui.input(|input| input.key_pressed(Key::F)) {
            self.fights = !self.fights;
        }
        self.pressed = Pressed::keys(ui);
        #[cfg(feature = "gamepad")]
        if let Some(pressed) = self.gamepad.as_mut().and_then(Gamepad::pressed) {
            self.pressed = pressed;
        }
    }

    /// Takes no keys: somebody writes, or moves something.
    pub fn release(&mut self) {
        self.pressed = Pressed::default();
    }

    /// Whether somebody fights and presses something.
    pub fn is_pressed(&self) -> bool {
        self.fights && self.pressed != Pressed::default()
    }

    /// What is pressed as a command to a fighter of a bout with positions `q`; `None` if nobody fights.
    pub fn command(&self, camera: &Camera, q: &[f32]) -> Option<FightCommand> {
        let Pressed {
            walk, face, turn, ..
        } = self.pressed;
        let over_ground = |stick| {
            simulated(camera.over_ground(stick))
                .truncate()
                .try_normalize()
        };
        let turned = (turn != 0.0).then(|| Vec2::from_angle(TURN * turn).rotate(facing(q)));
        self.fights.then(|| FightCommand {
            walk: over_ground(walk),
            face: over_ground(face).or(turned),
            punch: self.pressed.punch,
        })
    }

    /// Draws the panel of a bout that has lasted for so many seconds.
    pub fn show(&mut self, ui: &mut Ui, bout: &Bout, seconds: f32) {
        ui.strong("Bout");
        for (corner, fill) in fill(bout).into_iter().enumerate() {
            let [r, g, b] = CORNERS[corner];
            let words = format!("{}: {:.0} N s", NAMES[corner], bout.damage[corner]);
            let bar = egui::ProgressBar::new(fill).fill(Color32::from_rgb(r, g, b));
            ui.add(bar.corner_radius(2.0).text(words))
                .on_hover_text("Impulse of the hands on the other's torso and head");
        }
        let leads = bout.leader().map_or("nobody leads".into(), |leader| {
            format!("{} leads", NAMES[leader].to_lowercase())
        });
        ui.label(format!("{seconds:.1} s, {leads}"));
        let pair = |[red, blue]: [u32; 2]| format!("{red} : {blue}");
        ui.label(format!("bouts won {}", pair(bout.before.won)));
        ui.label(format!("knock-downs {}", pair(bout.before.knockdowns)));
        ui.separator();
        ui.checkbox(&mut self.fights, "Fight yourself")
            .on_hover_text("F");
        ui.small("You are red. W, A, S and D walk, seen from the camera.");
        ui.small("Hold J to attack, Q or E to turn.");
        ui.small("Without a key you stand on guard, face to face.");
        #[cfg(feature = "gamepad")]
        ui.small("Gamepad: left stick walks, right stick turns, right trigger attacks.");
    }
}
