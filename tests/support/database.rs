//! Three minutes of synthetic motion.

use footwork::matching::MotionMatcher;
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic::perform;
use std::sync::{Arc, LazyLock};

pub static DATABASE: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let (clips, roles) = perform(1, 3.0);
    let database = Database::build(&clips, roles, Weights::PAPER);
    Arc::new(database.expect("three minutes of motion"))
});

/// The same with its index.
pub static MATCHER: LazyLock<Arc<MotionMatcher>> =
    LazyLock::new(|| Arc::new(MotionMatcher::new(DATABASE.clone())));
