//! A file that somebody else writes anew now and then.

use std::path::PathBuf;
use std::time::SystemTime;

/// Seconds between two looks at it.
pub const EVERY_S: f64 = 0.5;

/// A file that somebody else writes anew now and then.
pub struct WatchedFile {
    path: PathBuf,
    /// When it was written and how long it is, as it was seen last.
    seen: Option<(SystemTime, u64)>,
    looked_s: f64,
}

impl WatchedFile {
    /// The file as it is now is not new.
    pub fn new(path: PathBuf) -> WatchedFile {
        let mut file = WatchedFile {
            path,
            seen: None,
            looked_s: 0.0,
        };
        file.seen = file.stamp();
        file
    }

    /// Whether it has been written since it was seen last. `now_s` is the present time, s: it is looked at every
    /// [`EVERY_S`].
    pub fn is_new(&mut self, now_s: f64) -> bool {
        if now_s - self.looked_s < EVERY_S {
            return false;
        }
        self.looked_s = now_s;
        let stamp = self.stamp();
        let is_new = stamp.is_some() && stamp != self.seen;
        if is_new {
            self.seen = stamp;
        }
        is_new
    }

    /// Nothing while there is no such file.
    fn stamp(&self) -> Option<(SystemTime, u64)> {
        let file = self.path.metadata().ok()?;
        Some((file.modified().ok()?, file.len()))
    }
}
