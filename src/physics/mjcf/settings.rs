//! `compiler` and `option`: how the rest is to be read, and what must be as it is here.

use super::element::Element;
use super::error::Result;
use super::grammar::{COMPILER, FLAG, OPTION};

pub struct MjcfSettings {
    /// Radians that the file's unit of angles has.
    pub angle: f64,
    /// A range that is given limits.
    pub autolimits: bool,
    /// Masses are those of the geoms, whatever `inertial` says.
    pub from_geoms: bool,
}

impl MjcfSettings {
    pub fn read(root: &Element) -> Result<MjcfSettings> {
        let mut settings = MjcfSettings {
            angle: 1_f64.to_radians(),
            autolimits: true,
            from_geoms: false,
        };
        for compiler in root.sections("compiler") {
            settings.compiler(&compiler)?;
        }
        for option in root.sections("option") {
            option.check(&OPTION)?;
            for flag in option.children() {
                flag.check(&FLAG)?;
            }
        }
        Ok(settings)
    }

    fn compiler(&mut self, element: &Element) -> Result<()> {
        element.check(&COMPILER)?;
        if let Some(unit) = element.choice("angle", &["degree", "radian"])? {
            self.angle = [1_f64.to_radians(), 1.0][unit];
        }
        if let Some(choice) = element.choice("autolimits", &["false", "true"])? {
            self.autolimits = choice == 1;
        }
        if let Some(choice) = element.choice("inertiafromgeom", &["auto", "true"])? {
            self.from_geoms = choice == 1;
        }
        Ok(())
    }

    /// The range that limits `element`, if one does. `limited` names the attribute that says so.
    pub fn limits(
        &self,
        element: &Element,
        range: &str,
        limited: &str,
    ) -> Result<Option<[f64; 2]>> {
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
}
