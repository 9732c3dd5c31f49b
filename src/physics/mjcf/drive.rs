//! Actuators, as the drives of degrees of freedom: of a control u, position q and velocity v each is a torque
//! g u - kp q - kd v within limits, as MuJoCo means it.
//!
//! With [`MjcfOptions::pd_motors`](super::MjcfOptions) `motor` is read as Isaac Gym does: the joint's own
//! stiffness and damping are the gains of its drive, the gear its largest torque.

use super::element::Element;
use super::error::Checked;
use super::grammar::{ACTUATOR, GENERAL, Grammar, MOTOR, POSITION};
use super::worldbody::WorldBuilder;
use crate::physics::model::{Drive, Joint, JointKind, JointSpring};

/// An actuator before its gear: g, kp and kd.
struct Affine {
    gain: f64,
    stiffness: f64,
    damping: f64,
}

impl<'a> WorldBuilder<'a> {
    /// Reads the actuators and gives the joints the springs that are left; returns notes for the user.
    pub fn drives(&mut self, root: &Element<'a>) -> Vec<String> {
        let mut sprung = false;
        for child in root.within("actuator", &ACTUATOR) {
            self.name(&child);
            let element = self.classes.apply(child, None);
            element.check(grammar(&element));
            if let Some(joint) = element.keep(self.driven(&element)).flatten() {
                sprung |= element.tag() == "motor" && self.joints[joint].gains[0] > 0.0;
                let drive = self.drive(&element, joint);
                element.keep(drive);
            }
        }
        self.springs();
        match sprung && !self.settings.options.pd_motors {
            true => vec![
                "motors are torques, and the stiffness and damping of their joints passive springs, as in MuJoCo; if the model is written for an engine that reads them as drives to a position (Isaac Gym), use --pd-motors".to_string(),
            ],
            false => Vec::new(),
        }
    }

    /// The joint that an actuator drives; none if it may be one that could not be read.
    fn driven(&self, element: &Element<'a>) -> Checked<Option<usize>> {
        let name = element.naming("joint")?;
        let mut joints = self.model.joints.iter();
        match joints.position(|joint| joint.name == name) {
            None if self.named_all("joint") => {
                Err(element.wrong("joint", "there is no such joint"))
            }
            joint => Ok(joint),
        }
    }

    fn drive(&mut self, element: &Element<'a>, index: usize) -> Checked<()> {
        let joint = &self.model.joints[index];
        let (axis, gear) = gear(element, joint)?;
        let dof = joint.v + axis;
        let pd_motor = self.settings.options.pd_motors && element.tag() == "motor";
        let drive = match pd_motor {
            true => self.pd_motor(element, index, gear)?,
            false => self.affine_drive(element, index, gear)?,
        };
        match self.model.dofs[dof].drive.replace(drive) {
            None => Ok(()),
            Some(_) => Err(element.error("drives what another actuator drives already")),
        }
    }

    fn affine_drive(&self, element: &Element, joint: usize, gear: f64) -> Checked<Drive> {
        let affine = match element.tag() {
            "motor" => motor(),
            "position" => position(element)?,
            _ => general(element)?,
        };
        let limit = self.settings.bound(element, "forcerange", "forcelimited")?;
        let range = self.settings.limits(element, "ctrlrange", "ctrllimited")?;
        let range = range.map(|range| range.map(|end| end as f32));
        let range = match range {
            None => self.inherited_range(element, joint)?,
            given => given,
        };
        let stiffness = gear * gear * affine.stiffness;
        Ok(Drive {
            torque: (gear * affine.gain - stiffness) as f32,
            stiffness: stiffness as f32,
            damping: (gear * gear * affine.damping) as f32,
            limit: (gear.abs() * limit).min(self.joints[joint].limit) as f32,
            control: range.unwrap_or([f32::MIN, f32::MAX]),
        })
    }

    /// The range of targets that is a part of the joint's (`inheritrange`).
    fn inherited_range(&self, element: &Element, joint: usize) -> Checked<Option<[f32; 2]>> {
        let part = element.number("inheritrange")?.unwrap_or(0.0) as f32;
        match self.model.joints[joint].range {
            _ if part == 0.0 => Ok(None),
            Some([low, high]) if part > 0.0 => {
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) * part);
                Ok(Some([middle - half, middle + half]))
            }
            _ => Err(element.wrong(
                "inheritrange",
                "it needs a joint with a range, and a positive part of it",
            )),
        }
    }

    /// A drive whose gains are the joint's own.
    fn pd_motor(&mut self, element: &Element, joint: usize, gear: f64) -> Checked<Drive> {
        let [stiffness, damping] = self.joints[joint].gains;
        if stiffness == 0.0 {
            let problem = "drives a joint without stiffness; give it that and damping, the gains of a drive whose largest torque is the gear, or leave out --pd-motors";
            return Err(element.error(problem));
        }
        if gear <= 0.0 {
            return Err(element.wrong("gear", "as the largest torque it must be positive"));
        }
        self.joints[joint].sprung = false;
        Ok(Drive::to_target(stiffness, damping, gear as f32))
    }

    fn springs(&mut self) {
        for (joint, read) in self.model.joints.iter().zip(&self.joints) {
            let [stiffness, damping] = read.gains;
            if !read.sprung || read.gains == [0.0; 2] {
                continue;
            }
            for dof in &mut self.model.dofs[joint.v..][..joint.kind.nv()] {
                dof.spring = Some(JointSpring {
                    stiffness,
                    damping,
                    rest: read.rest,
                });
            }
        }
    }
}

fn grammar(element: &Element) -> &'static Grammar {
    match element.tag() {
        "motor" => &MOTOR,
        "position" => &POSITION,
        _ => &GENERAL,
    }
}

fn motor() -> Affine {
    Affine {
        gain: 1.0,
        stiffness: 0.0,
        damping: 0.0,
    }
}

fn position(element: &Element) -> Checked<Affine> {
    let gain = |name: &str, usual: f64| match element.number(name)?.unwrap_or(usual) {
        gain if gain >= 0.0 => Ok(gain),
        _ => Err(element.wrong(name, "it must not be negative")),
    };
    let stiffness = gain("kp", 1.0)?;
    Ok(Affine {
        gain: stiffness,
        stiffness,
        damping: gain("kv", 0.0)?,
    })
}

fn general(element: &Element) -> Checked<Affine> {
    let [gain, ..] = element.overlay("gainprm", [1.0; 10])?;
    let affine = element.choice("biastype", &["none", "affine"])? == Some(1);
    let bias: [f64; 10] = element.overlay("biasprm", [0.0; 10])?;
    match (affine, bias) {
        (false, _) => Ok(Affine { gain, ..motor() }),
        (true, [constant, by_position, by_velocity, ..])
            if constant == 0.0 && by_position <= 0.0 && by_velocity <= 0.0 =>
        {
            Ok(Affine {
                gain,
                stiffness: -by_position,
                damping: -by_velocity,
            })
        }
        _ => {
            let problem = "supported are \"0 -kp -kv\", kp and kv not negative";
            Err(element.wrong("biasprm", problem))
        }
    }
}

/// Which of a joint's degrees of freedom is driven, and the gear's number for it.
fn gear(element: &Element, joint: &Joint) -> Checked<(usize, f64)> {
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
