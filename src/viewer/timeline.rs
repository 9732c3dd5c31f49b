//! What has been played, to go back to.

use anyhow::Result;
use std::collections::VecDeque;

/// Frames kept: five minutes.
const KEPT: usize = 9000;

/// Every frame of a playthrough with all that decides the next: going on from an earlier one plays the
/// same again, unless something is changed there.
pub struct Timeline<M> {
    moments: VecDeque<M>,
    /// The one shown.
    at: usize,
}

impl<M> Timeline<M> {
    /// A timeline of one frame.
    pub fn new(first: M) -> Timeline<M> {
        Timeline {
            moments: VecDeque::from([first]),
            at: 0,
        }
    }

    /// The shown frame.
    pub fn now(&self) -> &M {
        &self.moments[self.at]
    }

    /// The moment shown, to change: what came after it is forgotten.
    pub fn change(&mut self) -> &mut M {
        self.moments.truncate(self.at + 1);
        &mut self.moments[self.at]
    }

    /// Number of recorded frames.
    pub fn len(&self) -> usize {
        self.moments.len()
    }

    /// Whether there are no frames; there is always one.
    pub fn is_empty(&self) -> bool {
        self.moments.is_empty()
    }

    /// Index of the shown frame.
    pub fn at(&self) -> usize {
        self.at
    }

    /// Shows another recorded frame.
    pub fn go_to(&mut self, at: usize) {
        self.at = at.min(self.moments.len() - 1);
    }

    /// A frame on: the recorded one, or at the end the one that `next` makes of it.
    ///
    /// # Errors
    /// Those of `next`.
    pub fn forward(&mut self, next: impl FnOnce(&M) -> Result<M>) -> Result<()> {
        if self.at + 1 == self.moments.len() {
            let next = next(self.now())?;
            self.moments.push_back(next);
            if self.moments.len() > KEPT {
                self.moments.pop_front();
                self.at -= 1;
            }
        }
        self.at += 1;
        Ok(())
    }
}
