//! The list of a run's checkpoints.

use anyhow::Result;
use eframe::egui::{self, Ui};

/// A policy that can be chosen.
pub struct PolicyEntry<P> {
    /// Name in the list.
    pub name: String,
    /// Loads it.
    pub load: Box<dyn Fn() -> Result<P>>,
}

/// Policies, of which one is chosen.
pub struct Policies<P> {
    entries: Vec<PolicyEntry<P>>,
    chosen: usize,
}

impl<P> Policies<P> {
    /// The last of them is chosen.
    pub fn new(entries: Vec<PolicyEntry<P>>) -> Policies<P> {
        Policies {
            chosen: entries.len().saturating_sub(1),
            entries,
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Loads the chosen one; nothing if there are none.
    pub fn load(&self) -> Option<Result<P>> {
        self.entries.get(self.chosen).map(|entry| (entry.load)())
    }

    /// Draws the list. If another is chosen, returns it; one that cannot be loaded is not chosen.
    pub fn show(&mut self, ui: &mut Ui) -> Option<Result<P>> {
        let mut chosen = self.chosen;
        egui::ComboBox::from_label("Checkpoint")
            .selected_text(&self.entries[chosen].name)
            .show_ui(ui, |ui| {
                for (index, entry) in self.entries.iter().enumerate() {
                    ui.selectable_value(&mut chosen, index, &entry.name);
                }
            });
        if chosen == self.chosen {
            return None;
        }
        let loaded = (self.entries[chosen].load)();
        if loaded.is_ok() {
            self.chosen = chosen;
        }
        Some(loaded)
    }
}
