//! A run in a browser, but for the browser: its files are read back, and the page that plays them is played here.
//! `web/test.mjs` opens pages in Chromium.

mod body;
mod folder;
mod motion;
mod walk;

use footwork::env::locomotion::{LocomotionTask, Plane};
use footwork::matching::MotionMatcher;
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic::perform;
use footwork::train::locomotion::Locomotion;
use std::sync::{Arc, LazyLock};

/// The plane on three minutes of synthetic motion.
static PLANE: LazyLock<Locomotion> = LazyLock::new(|| {
    let (clips, roles) = perform(1, 3.0);
    let database = Database::build(&clips, roles, Weights::PAPER).expect("three minutes of motion");
    Locomotion {
        task: LocomotionTask::Plane(Plane::default()),
        matcher: Arc::new(MotionMatcher::new(Arc::new(database))),
    }
});
