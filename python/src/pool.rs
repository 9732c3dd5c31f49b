//! The threads that all work is done on.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicPtr, Ordering};

/// A pool, and the process whose threads it has.
struct OwnedPool {
    process: u32,
    threads: ThreadPool,
}

static POOL: AtomicPtr<OwnedPool> = AtomicPtr::new(std::ptr::null_mut());

/// Does `work` on the threads of this process. A forked process has inherited its parent's pool, but none of its
/// threads, and would wait for them for ever: it is given a pool of its own.
pub fn install<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let process = std::process::id();
    // A pool that was made lasts as long as its process.
    let found = unsafe { POOL.load(Ordering::Acquire).as_ref() };
    match found.filter(|pool| pool.process == process) {
        Some(pool) => pool.threads.install(work),
        None => fresh(process).threads.install(work),
    }
}

fn fresh(process: u32) -> &'static OwnedPool {
    let threads = ThreadPoolBuilder::new().thread_name(|number| format!("footwork-{number}"));
    let threads = threads.build().expect("threads can be started");
    let pool = Box::leak(Box::new(OwnedPool { process, threads }));
    POOL.store(pool, Ordering::Release);
    pool
}
