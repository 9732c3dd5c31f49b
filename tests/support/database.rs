//! Three minutes of synthetic motion.

use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic::perform;
use std::sync::LazyLock;

pub static DATABASE: LazyLock<Database> = LazyLock::new(|| {
    let (clips, roles) = perform(1, 3.0);
    Database::build(&clips, roles, Weights::PAPER).expect("three minutes of motion")
});
