//! `footwork train --watch`.

use super::filming::Filming;
use super::progress::Progress;
use super::say::tell;
use anyhow::Result;
use footwork::env::EnvBatch;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::metrics::UpdateMetrics;
use footwork::train::observer::Observer;
use footwork::train::run_dir::Summary;
use footwork::train::state::RecentMeans;
use footwork::train::trainer::{Training, train};
use footwork::viewer::watch::{Watch, WatchedMotion};
use footwork::viewer::window;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Tells the terminal and the window.
struct Both {
    progress: Progress,
    watch: Arc<Watch>,
}

impl Observer for Both {
    fn opened(&mut self, envs: &mut EnvBatch) -> Result<()> {
        self.watch.opened(envs)
    }

    fn noted(&mut self, note: &str) {
        self.progress.noted(note);
    }

    fn updated(&mut self, row: &UpdateMetrics, recent: RecentMeans) {
        self.watch.updated(row);
        self.progress.updated(row, recent);
    }
}

/// Trains on a thread of its own while this one, as windows want it, shows the environments.
pub fn watched(
    training: Training,
    from: Option<Checkpoint>,
    interrupted: &AtomicBool,
    progress: Progress,
) -> Result<Summary> {
    let gpu = training.device.drawing()?;
    let (watch, over) = (Arc::new(Watch::default()), Arc::new(AtomicBool::new(false)));
    let both = Both {
        progress,
        watch: watch.clone(),
    };
    let mut filming = Filming::new(&training, both);
    std::thread::scope(|scope| {
        let running = scope.spawn(|| {
            let summary = train(training, from, interrupted, &mut filming);
            over.store(true, Ordering::Relaxed);
            summary
        });
        let motion = training.task.locomotion().map(|of| WatchedMotion {
            database: of.matcher.database.clone(),
            task: of.task,
            envs: training.config.ppo.envs,
        });
        if let Err(error) = window::watch(&gpu, motion, watch, over.clone()) {
            tell!("note: the training goes on unwatched: {error:#}");
        }
        running
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
