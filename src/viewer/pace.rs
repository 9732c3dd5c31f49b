//! How often a training is drawn.

use crate::gpu::Gpu;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A GPU draws this often; a software rasteriser, which takes the training's own processors, at most
/// one part in so many of the time.
const OFTEN: Duration = Duration::from_millis(16);
const PART: u32 = 20;
/// Between two pictures of a software rasteriser, at least and at most.
const SELDOM: [Duration; 2] = [Duration::from_millis(100), Duration::from_secs(5)];

/// The time between two pictures.
pub struct Pace {
    software: bool,
    /// How long the last picture took.
    took: Arc<Mutex<Duration>>,
}

impl Pace {
    /// The pace of a device that has drawn nothing so far.
    pub fn new(gpu: &Gpu) -> Pace {
        Pace {
            software: gpu.software,
            took: Arc::default(),
        }
    }

    /// How long to wait for the next picture, right after one has been requested.
    pub fn next(&self, queue: &wgpu::Queue) -> Duration {
        if !self.software {
            return OFTEN;
        }
        let (began, took) = (Instant::now(), self.took.clone());
        queue.on_submitted_work_done(move || {
            *took.lock().unwrap_or_else(PoisonError::into_inner) = began.elapsed();
        });
        let took = *self.took.lock().unwrap_or_else(PoisonError::into_inner);
        (PART * took).clamp(SELDOM[0], SELDOM[1])
    }
}
