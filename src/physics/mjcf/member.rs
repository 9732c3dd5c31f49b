//! What stands in a body: what is in frames counts as if it stood in the body itself.

use super::class::Classes;
use super::element::Element;
use super::frame::Frame;
use super::grammar::FRAME;
use super::settings::MjcfSettings;
use glam::DVec3;

/// An element in a body.
pub struct Member<'a> {
    pub element: Element<'a>,
    /// The frames around it, seen from the body, if there are any.
    around: Option<Frame>,
    /// The default class of the elements around it.
    pub class: Option<usize>,
}

impl<'a> Member<'a> {
    /// The frame of something in the element, seen from the body.
    pub fn place(&self, frame: Frame) -> Frame {
        self.around.map_or(frame, |around| around * frame)
    }

    /// A direction in the element, seen from the body.
    pub fn turned(&self, direction: DVec3) -> DVec3 {
        self.around
            .map_or(direction, |around| around.rotation * direction)
    }

    /// All that is in a body or the world, in the file's order, but for what is in bodies within.
    pub fn all(
        body: &Element<'a>,
        class: Option<usize>,
        classes: &Classes<'a>,
        settings: &MjcfSettings,
    ) -> Vec<Member<'a>> {
        let mut found = Vec::new();
        let mut open = Vec::new();
        enter(body, None, class, &mut open);
        while let Some(member) = open.pop() {
            if member.element.tag() != "frame" {
                found.push(member);
                continue;
            }
            let element = &member.element;
            element.check(&FRAME);
            let own = element.keep(Frame::read(element, settings));
            let frame = member.place(own.unwrap_or_default());
            let class = classes.of_children(element).or(member.class);
            enter(element, Some(frame), class, &mut open);
        }
        found
    }
}

/// Puts the children of an element on the stack, the first on top.
fn enter<'a>(
    element: &Element<'a>,
    around: Option<Frame>,
    class: Option<usize>,
    open: &mut Vec<Member<'a>>,
) {
    let from = open.len();
    open.extend(element.children().map(|element| Member {
        element,
        around,
        class,
    }));
    open[from..].reverse();
}
