//! Windows of earlier agents, so that the discriminator does not forget what it has seen through.

use crate::container::{Section, SectionError};
use crate::gpu::{Array, Device};
use crate::nn::rows;
use anyhow::Result;

/// A ring of windows: the oldest make room for the newest.
pub struct Replay {
    device: Device,
    /// `[capacity][dim]`
    windows: Array,
    dim: usize,
    /// Windows that have been put in since the start.
    seen: u64,
}

impl Replay {
    pub fn new(device: &Device, capacity: usize, dim: usize) -> Replay {
        Replay {
            windows: Array::zeroed(device, capacity * dim),
            device: device.clone(),
            dim,
            seen: 0,
        }
    }

    fn capacity(&self) -> usize {
        self.windows.len() / self.dim
    }

    /// Windows in the ring.
    pub fn len(&self) -> usize {
        (self.seen as usize).min(self.capacity())
    }

    /// The ring, `[capacity][dim]`, of which the first [`Replay::len`] are filled.
    pub fn windows(&self) -> &Array {
        &self.windows
    }

    /// Puts windows `[n][dim]` in, at most as many as there is room for.
    pub fn push(&mut self, windows: &Array) {
        let (count, capacity) = (windows.len() / self.dim, self.capacity());
        let at = (self.seen % capacity as u64) as usize;
        let first = count.min(capacity - at);
        let part =
            |from: usize, to: usize| windows.copy(&self.device, from * self.dim..to * self.dim);
        let parts = [(at, part(0, first)), (0, part(first, count))];
        for (at, part) in parts.into_iter().filter(|(_, part)| !part.is_empty()) {
            rows::replace(&self.device, &mut self.windows, at * self.dim, &part);
        }
        self.seen += count as u64;
    }

    pub fn save(&self, to: &mut Section) -> Result<()> {
        to.put("replay.seen", self.seen);
        let filled = self.len() * self.dim;
        to.put_array(
            "replay.windows",
            &self.windows.read(&self.device)?[..filled],
        );
        Ok(())
    }

    pub fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        self.seen = from.get("replay.seen")?;
        let mut windows = from.take_finite("replay.windows", self.len() * self.dim)?;
        windows.resize(self.windows.len(), 0.0);
        self.windows = Array::from_slice(&self.device, &windows);
        Ok(())
    }
}
