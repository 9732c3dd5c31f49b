//! The sticks of a gamepad.

use super::pressed::Pressed;
use gilrs::{Axis, Button, Gilrs};

/// A stick nearer to its middle than this rests there.
const REST: f32 = 0.15;

/// All gamepads there are.
pub struct Gamepad(Gilrs);

/// A stick pushed: to the right and away from the player, 1 at most together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// To the right, -1 to 1.
    pub right: f32,
    /// Away from the user, -1 to 1.
    pub away: f32,
    /// Whether the right shoulder button or trigger is held.
    pub run: bool,
}

impl Gamepad {
    /// `None` where the system has no gamepads to offer.
    pub fn open() -> Option<Gamepad> {
        Gilrs::new().ok().map(Gamepad)
    }

    /// The left stick of the first gamepad that pushes it.
    pub fn push(&mut self) -> Option<Push> {
        while self.0.next_event().is_some() {}
        self.0.gamepads().find_map(|(_, pad)| {
            let run = [Button::RightTrigger, Button::RightTrigger2];
            let push = Push {
                right: pad.value(Axis::LeftStickX),
                away: pad.value(Axis::LeftStickY),
                run: run.iter().any(|&button| pad.is_pressed(button)),
            };
            (push.right.hypot(push.away) > REST).then_some(push)
        })
    }

    /// What is pressed by who fights on the first gamepad that is touched: both sticks, and the right shoulder button or
    /// trigger.
    pub fn pressed(&mut self) -> Option<Pressed> {
        while self.0.next_event().is_some() {}
        self.0.gamepads().find_map(|(_, pad)| {
            let stick = |axes: [Axis; 2]| {
                let at = axes.map(|axis| pad.value(axis));
                let pushed = at[0].hypot(at[1]) > REST;
                if pushed { at } else { [0.0; 2] }
            };
            let punch = [Button::RightTrigger, Button::RightTrigger2];
            let pressed = Pressed {
                walk: stick([Axis::LeftStickX, Axis::LeftStickY]),
                face: stick([Axis::RightStickX, Axis::RightStickY]),
                turn: 0.0,
                punch: punch.iter().any(|&button| pad.is_pressed(button)),
            };
            (pressed != Pressed::default()).then_some(pressed)
        })
    }
}
