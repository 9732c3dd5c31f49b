//! How many steps a discriminator takes in an update: fewer once it tells all agents and their reward dwindles.

use crate::container::{Section, SectionError};

/// An accuracy of the agents' side above which a discriminator is certain, and how many updates in a row it must
/// be so. Both are common in a training that goes well: the reward decides.
const CERTAIN: f64 = 0.97;
const PATIENCE: usize = 10;
/// A style reward that has fallen to this part of what it was when the certainty began.
const DWINDLED: f64 = 0.8;
/// An accuracy below which a discriminator may have its steps back.
const UNCERTAIN: f64 = 0.9;

/// The steps of an update, and what decides on them.
pub struct AdaptiveSteps {
    most: usize,
    steps: usize,
    /// Style rewards of the latest updates in which the discriminator was certain.
    style: Vec<f64>,
}

impl AdaptiveSteps {
    /// As many steps as the configuration says.
    pub fn new(most: usize) -> AdaptiveSteps {
        AdaptiveSteps {
            most,
            steps: most,
            style: Vec::new(),
        }
    }

    /// Steps of the present update.
    pub fn count(&self) -> usize {
        self.steps
    }

    /// Takes in an update: the accuracy of the agents' side, and the style reward of a step.
    pub fn update(&mut self, agent_accuracy: f64, style: f64) {
        if agent_accuracy <= CERTAIN {
            self.style.clear();
        } else {
            self.style.push(style);
        }
        if agent_accuracy < UNCERTAIN {
            self.steps = (2 * self.steps).min(self.most);
        }
        if self.style.len() > PATIENCE {
            let before = self.style.remove(0);
            if style < DWINDLED * before {
                self.steps = (self.steps / 2).max(1);
                self.style.clear();
            }
        }
    }

    /// Saves all of it.
    pub fn save(&self, to: &mut Section) {
        to.put("discriminator.steps", [self.steps, self.style.len()]);
        to.put_array("discriminator.steps", &self.style);
    }

    /// Puts a saved state back.
    ///
    /// # Errors
    /// It is none.
    pub fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let [steps, count]: [usize; 2] = from.get("discriminator.steps")?;
        self.style = from.take_array("discriminator.steps", count)?;
        if steps == 0 || count > PATIENCE || self.style.iter().any(|style| !style.is_finite()) {
            return Err(SectionError(
                "the steps of its discriminator are none".into(),
            ));
        }
        self.steps = steps.min(self.most);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_halved_when_agents_lose_what_they_had() {
        let mut steps = AdaptiveSteps::new(8);
        (0..30).for_each(|_| steps.update(0.99, 0.5));
        assert_eq!(steps.count(), 8, "a reward that holds");
        (0..30).for_each(|update| steps.update(0.99, 0.5 * 0.9f64.powi(update)));
        assert!(steps.count() < 8, "a reward that dwindles");
        let few = steps.count();
        steps.update(0.95, 0.1);
        assert_eq!(steps.count(), few);
        (0..3).for_each(|_| steps.update(0.8, 0.1));
        assert_eq!(steps.count(), 8, "a discriminator that is uncertain");
    }
}
