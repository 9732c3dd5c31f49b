//! Films of what policies do while they learn.

use anyhow::Result;
use footwork::env::EnvBatch;
use footwork::gpu::Device;
use footwork::nn::Policy;
use footwork::train::config::Config;
use footwork::train::metrics::UpdateMetrics;
use footwork::train::observer::Observer;
use footwork::train::state::RecentMeans;
use footwork::train::task::Task;
use footwork::train::trainer::Training;
use footwork::view::policy_film::policy_film;

/// Somebody who follows a training, with a camera.
pub struct Filming<'a, O> {
    inner: O,
    task: &'a dyn Task,
    device: &'a Device,
}

impl<'a, O: Observer> Filming<'a, O> {
    pub fn new(training: &Training<'a>, inner: O) -> Self {
        Filming {
            inner,
            task: training.task,
            device: training.device,
        }
    }
}

impl<O: Observer> Observer for Filming<'_, O> {
    fn begins(&mut self, name: &str, config: &Config) {
        self.inner.begins(name, config);
    }

    fn opened(&mut self, envs: &mut EnvBatch) -> Result<()> {
        self.inner.opened(envs)
    }

    fn noted(&mut self, note: &str) {
        self.inner.noted(note);
    }

    fn film(&mut self, policy: &Policy) -> Result<Option<Vec<u8>>> {
        policy_film(&self.device.drawing()?, self.task, policy)
    }

    fn updated(&mut self, row: &UpdateMetrics, recent: RecentMeans) {
        self.inner.updated(row, recent);
    }
}
