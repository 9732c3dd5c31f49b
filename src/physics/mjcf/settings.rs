//! `compiler` and `option`: how the rest is to be read, and what must be as it is here.

use super::element::Element;
use super::error::Checked;
use super::grammar::{COMPILER, FLAG, OPTION};
use super::options::MjcfOptions;

pub struct MjcfSettings {
    /// Radians that the file's unit of angles has.
    pub angle: f64,
    /// A range that is given limits.
    pub autolimits: bool,
    /// Where masses come from.
    pub masses: MassSource,
    pub options: MjcfOptions,
}

/// Where the mass of a body comes from (`inertiafromgeom`).
#[derive(Clone, Copy, PartialEq)]
pub enum MassSource {
    /// `inertial` alone.
    Inertial,
    /// Geoms, whatever `inertial` says.
    Geoms,
    /// `inertial`, or geoms where there is none.
    Auto,
}

impl MjcfSettings {
    pub fn read(root: &Element, options: MjcfOptions) -> MjcfSettings {
        let mut settings = MjcfSettings {
            angle: 1_f64.to_radians(),
            autolimits: true,
            masses: MassSource::Auto,
            options,
        };
        for compiler in root.sections("compiler") {
            settings.compiler(&compiler);
        }
        for flag in root.within("option", &OPTION) {
            flag.check(&FLAG);
        }
        settings
    }

    fn compiler(&mut self, element: &Element) {
        element.check(&COMPILER);
        let chosen = |name, words: &[&str]| element.keep(element.choice(name, words)).flatten();
        if let Some(unit) = chosen("angle", &["degree", "radian"]) {
            self.angle = [1_f64.to_radians(), 1.0][unit];
        }
        if let Some(choice) = chosen("autolimits", &["false", "true"]) {
            self.autolimits = choice == 1;
        }
        if let Some(choice) = chosen("inertiafromgeom", &["false", "true", "auto"]) {
            use MassSource::{Auto, Geoms, Inertial};
            self.masses = [Inertial, Geoms, Auto][choice];
        }
    }

    /// The range that limits `element`, if one does. `limited` names the attribute that says so.
    pub fn limits(
        &self,
        element: &Element,
        range: &str,
        limited: &str,
    ) -> Checked<Option<[f64; 2]>> {
        let choice = element
            .choice(limited, &["false", "true", "auto"])?
            .unwrap_or(2);
        let values = element.numbers::<2>(range)?.unwrap_or_default();
        if values[0] > values[1] {
            return Err(element.wrong(range, "the smaller number comes first"));
        }
        let given = values[0] < values[1];
        match choice {
            1 if !given => {
                Err(element.wrong(range, "limits need a range whose second number is larger"))
            }
            2 if given && !self.autolimits => Err(element.wrong(
                range,
                &format!("with autolimits off, {limited} must be given"),
            )),
            0 => Ok(None),
            _ => Ok(given.then_some(values)),
        }
    }

    /// The bound of a range that has zero in its middle, if one limits `element`.
    pub fn bound(&self, element: &Element, range: &str, limited: &str) -> Checked<f64> {
        match self.limits(element, range, limited)? {
            None => Ok(f64::from(f32::MAX)),
            Some([low, high]) if low == -high => Ok(high),
            Some(_) => Err(element.wrong(range, "supported are limits like \"-5 5\"")),
        }
    }
}
