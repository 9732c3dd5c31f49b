//! Trained characters outside of a training, stepped from somebody's own loop.
//!
//! [`CharacterMotion`] is a database made ready, [`CharacterPolicy`] what a run has learned, [`Characters`] are
//! any number of characters that both move. They step on the calling thread alone and, once opened, without
//! allocating.

mod character;
mod character_motion;
mod character_policy;
mod characters;

pub use character::{CharacterState, MovingObstacle};
pub use character_motion::CharacterMotion;
pub use character_policy::{CharacterPolicy, PolicyError};
pub use characters::{Characters, CharactersError};
