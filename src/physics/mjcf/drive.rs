//! Actuators, as the drives of degrees of freedom.
//!
//! `position` is read as MuJoCo means it. `motor` is read as Isaac Gym does: the joint's own stiffness
//! and damping are the gains of its drive, the gear its largest torque.

use super::element::Element;
use super::error::Result;
use super::grammar::{ACTUATOR, MOTOR, POSITION};
use super::worldbody::WorldBuilder;
use crate::physics::model::{Drive, Joint, JointKind};

impl<'a> WorldBuilder<'a> {
    pub fn drives(&mut self, root: &Element<'a>) -> Result<()> {
        for child in root.within("actuator", &ACTUATOR)? {
            let grammar = match child.tag() {
                "motor" => &MOTOR,
                _ => &POSITION,
            };
            self.name(&child)?;
            let element = self.classes.apply(child, None)?;
            element.check(grammar)?;
            self.drive(&element)?;
        }
        self.springs()
    }

    fn drive(&mut self, element: &Element<'a>) -> Result<()> {
        let name = element.naming("joint")?;
        let joints = &self.model.joints;
        let Some(index) = joints.iter().position(|joint| joint.name == name) else {
            return Err(element.wrong("joint", "there is no such joint"));
        };
        let joint = &joints[index];
        let (axis, gear) = gear(element, joint)?;
        let drive = match element.tag() {
            "motor" => self.motor(element, index, gear)?,
            _ if gear != 1.0 => {
                return Err(element.wrong("gear", "that of a drive to a position is 1"));
            }
            _ => self.position(element, index)?,
        };
        let dof = joint.v + axis;
        match self.model.dofs[dof].drive.replace(drive) {
            None => Ok(()),
            Some(_) => Err(element.error("drives what another actuator drives already")),
        }
    }

    fn position(&self, element: &Element, joint: usize) -> Result<Drive> {
        if self.joints[joint].1 != [0.0; 2] {
            let problem = "drives a joint that has stiffness or damping of its own; give it none";
            return Err(element.error(problem));
        }
        let range = self
            .settings
            .limits(element, "forcerange", "forcelimited")?;
        let limit = match range {
            None => f32::MAX,
            Some([low, high]) if low == -high => high as f32,
            Some(_) => {
                return Err(element.wrong("forcerange", "supported are limits like \"-5 5\""));
            }
        };
        let gain = |name: &str, usual: f64| match element.number(name)?.unwrap_or(usual) {
            gain if gain >= 0.0 => Ok(gain as f32),
            _ => Err(element.wrong(name, "it must not be negative")),
        };
        Ok(Drive {
            stiffness: gain("kp", 1.0)?,
            damping: gain("kv", 0.0)?,
            limit,
        })
    }

    fn motor(&self, element: &Element, joint: usize, gear: f64) -> Result<Drive> {
        let [stiffness, damping] = self.joints[joint].1;
        if stiffness == 0.0 {
            let problem = "drives a joint without stiffness; give it that and damping, the gains of a drive whose largest torque is the gear, or use <position>";
            return Err(element.error(problem));
        }
        match gear > 0.0 {
            true => Ok(Drive {
                stiffness,
                damping,
                limit: gear as f32,
            }),
            false => Err(element.wrong("gear", "as the largest torque it must be positive")),
        }
    }

    /// Refuses springs and dampers that are not those of a drive.
    fn springs(&self) -> Result<()> {
        for (joint, (element, gains)) in self.model.joints.iter().zip(&self.joints) {
            let mut dofs = self.model.dofs[joint.v..][..joint.kind.nv()].iter();
            if *gains != [0.0; 2] && dofs.any(|dof| dof.drive.is_none()) {
                let problem = "has stiffness or damping, but not a motor for each way it moves; remove them, or add motors";
                return Err(element.error(problem));
            }
        }
        Ok(())
    }
}

/// Which of a joint's degrees of freedom is driven, and the gear's number for it.
fn gear(element: &Element, joint: &Joint) -> Result<(usize, f64)> {
    let gear = element.overlay("gear", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
    match joint.kind {
        JointKind::Free => {
            Err(element.wrong("joint", "this is free; only hinges and balls can be driven"))
        }
        JointKind::Hinge => Ok((0, gear[0])),
        JointKind::Ball => {
            let mut axes = (0..3).filter(|&axis| gear[axis] != 0.0);
            match (axes.next(), axes.next()) {
                (Some(axis), None) => Ok((axis, gear[axis])),
                _ => Err(element.wrong(
                    "gear",
                    "for a ball joint it picks one of three axes, like \"0 1 0\"",
                )),
            }
        }
    }
}
