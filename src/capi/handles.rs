//! Tables of what callers have opened: a handle that was closed is never used again, and is found out.

use super::status::{Failure, FootworkStatus, failure};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

/// What is open of a kind, by number.
pub struct Handles<T> {
    /// The kind, for texts.
    kind: &'static str,
    open: RwLock<BTreeMap<u64, Arc<T>>>,
}

/// Numbers of handles, of all kinds together: one of another kind is found out too.
static NEXT: AtomicU64 = AtomicU64::new(1);

impl<T> Handles<T> {
    pub const fn new(kind: &'static str) -> Self {
        Handles {
            kind,
            open: RwLock::new(BTreeMap::new()),
        }
    }

    pub fn add(&self, value: T) -> u64 {
        let id = NEXT.fetch_add(1, Ordering::Relaxed);
        let mut open = self.open.write().unwrap_or_else(PoisonError::into_inner);
        open.insert(id, Arc::new(value));
        id
    }

    pub fn get(&self, id: u64) -> Result<Arc<T>, Failure> {
        let open = self.open.read().unwrap_or_else(PoisonError::into_inner);
        open.get(&id).cloned().ok_or_else(|| self.unknown(id))
    }

    pub fn remove(&self, id: u64) -> Result<(), Failure> {
        let mut open = self.open.write().unwrap_or_else(PoisonError::into_inner);
        let removed = open.remove(&id);
        // What is freed is freed after the table is free for others.
        drop(open);
        removed.map(drop).ok_or_else(|| self.unknown(id))
    }

    fn unknown(&self, id: u64) -> Failure {
        let kind = self.kind;
        let text = match id {
            0 => format!("the handle is zero: open {kind} first"),
            _ => format!("the handle {id} is not that of {kind}, or it was closed"),
        };
        failure(FootworkStatus::InvalidHandle, text)
    }
}
