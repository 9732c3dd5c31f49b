//! The list of a run's checkpoints.

use super::watched_file::{EVERY_S, WatchedFile};
use anyhow::{Context, Result};
use eframe::egui::{self, Ui};
use std::path::PathBuf;
use std::time::Duration;

/// A policy with what is known of it.
pub struct LoadedPolicy<P> {
    /// The policy.
    pub policy: P,
    /// Environment steps that it has learned from.
    pub steps: u64,
}

/// A policy that can be chosen.
pub struct PolicyEntry<P> {
    /// Name in the list.
    pub name: String,
    /// Loads it.
    pub load: Box<dyn Fn() -> Result<LoadedPolicy<P>>>,
}

/// Policies, of which one is chosen.
pub struct Policies<P> {
    entries: Vec<PolicyEntry<P>>,
    chosen: usize,
    /// Environment steps of the policy that is shown.
    steps: u64,
    /// The file of the last entry, which a training writes anew, and whether each new one is to be shown.
    followed: Option<(WatchedFile, bool)>,
}

impl<P> Policies<P> {
    /// The last of them is chosen.
    pub fn new(entries: Vec<PolicyEntry<P>>) -> Policies<P> {
        Policies {
            chosen: entries.len().saturating_sub(1),
            entries,
            steps: 0,
            followed: None,
        }
    }

    /// Shows what a training writes into `file`, from which the last entry loads, as soon as it is written.
    pub fn following(self, file: PathBuf) -> Policies<P> {
        Policies {
            followed: Some((WatchedFile::new(file), true)),
            ..self
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Loads the chosen one; nothing if there are none.
    pub fn load(&mut self) -> Option<Result<P>> {
        let loaded = (self.entries.get(self.chosen)?.load)();
        Some(self.take(loaded))
    }

    /// Draws the list. If another is chosen, or a followed one is there anew, returns it; one that cannot be loaded
    /// leaves the present one.
    pub fn show(&mut self, ui: &mut Ui) -> Option<Result<P>> {
        let before = self.chosen;
        let mut chosen = before;
        egui::ComboBox::from_label("Checkpoint")
            .selected_text(&self.entries[chosen].name)
            .show_ui(ui, |ui| {
                for (index, entry) in self.entries.iter().enumerate() {
                    ui.selectable_value(&mut chosen, index, &entry.name);
                }
            });
        ui.label(format!("learned from {} steps", self.steps));
        if chosen != before {
            if let Some((_, follows)) = &mut self.followed {
                *follows = false;
            }
            let loaded = (self.entries[chosen].load)();
            if loaded.is_ok() {
                self.chosen = chosen;
            }
            return Some(self.take(loaded));
        }
        self.follow(ui)
    }

    /// Draws whether a training is followed, and loads what it has written.
    fn follow(&mut self, ui: &mut Ui) -> Option<Result<P>> {
        let (file, follows) = self.followed.as_mut()?;
        let clicked = ui.checkbox(follows, "Follow the training").clicked();
        if !*follows {
            return None;
        }
        ui.ctx()
            .request_repaint_after(Duration::from_secs_f64(EVERY_S));
        let is_new = file.is_new(ui.input(|input| input.time));
        if !is_new && !clicked {
            return None;
        }
        self.chosen = self.entries.len() - 1;
        let loaded = (self.entries[self.chosen].load)().with_context(|| {
            format!(
                "the newest checkpoint cannot be read; this is still the policy of {} steps",
                self.steps
            )
        });
        Some(self.take(loaded))
    }

    fn take(&mut self, loaded: Result<LoadedPolicy<P>>) -> Result<P> {
        let LoadedPolicy { policy, steps } = loaded?;
        self.steps = steps;
        Ok(policy)
    }
}
