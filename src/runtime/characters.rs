//! Any number of characters of one database under one policy.

use super::character::{Character, CharacterState, DecisionScratch, MovingObstacle};
use super::character_motion::CharacterMotion;
use super::character_policy::CharacterPolicy;
use crate::motion::features::FRAMES_PER_STEP;
use crate::motion::skeleton::JointTransforms;
use crate::playback::CharacterPose;
use std::sync::Arc;

/// Characters that step one by one or together.
///
/// They decide in different frames, so that a batch's frames take about equally long: the character `i` plays
/// `i % 6` frames before its first decision.
///
/// ```no_run
/// use footwork::runtime::{CharacterMotion, CharacterPolicy, Characters};
/// use std::{path::Path, sync::Arc};
///
/// let motion = Arc::new(CharacterMotion::open(Path::new("motion.footwork"))?);
/// let policy = Arc::new(CharacterPolicy::open(Path::new("runs/plane-1"))?);
/// let mut characters = Characters::new(motion, policy, 1)?;
/// characters.set_target(0, [3.0, 4.0]);
/// for _frame in 0..90 {
///     characters.step(0);
///     let pose = characters.pose(0); // root position, a rotation a joint
///     assert!(pose.root.is_finite());
/// }
/// # Ok::<(), anyhow::Error>(())
/// ```
pub struct Characters {
    motion: Arc<CharacterMotion>,
    policy: Arc<CharacterPolicy>,
    characters: Vec<Character>,
    scratch: DecisionScratch,
}

/// Why there can be no such characters.
#[derive(Debug, thiserror::Error)]
pub enum CharactersError {
    /// The policy was trained with another database.
    #[error(
        "the policy was trained with another database (fingerprint {wanted:08x}, this one has {found:08x}): give the one that the run was started with"
    )]
    OtherDatabase {
        /// Fingerprint of the policy's database.
        wanted: u32,
        /// Fingerprint of the database at hand.
        found: u32,
    },
}

impl Characters {
    /// So many characters, standing at the origin, their heading along z, without targets.
    ///
    /// # Errors
    /// See [`CharactersError`].
    pub fn new(
        motion: Arc<CharacterMotion>,
        policy: Arc<CharacterPolicy>,
        count: usize,
    ) -> Result<Self, CharactersError> {
        let (wanted, found) = (policy.fingerprint, motion.database().fingerprint);
        if wanted != found {
            return Err(CharactersError::OtherDatabase { wanted, found });
        }
        let all = (0..count).map(|number| Character::new(&motion, &policy, wait(number)));
        Ok(Characters {
            characters: all.collect(),
            scratch: DecisionScratch::default(),
            motion,
            policy,
        })
    }

    /// Their number.
    pub fn count(&self) -> usize {
        self.characters.len()
    }

    /// The motion they play.
    pub fn motion(&self) -> &Arc<CharacterMotion> {
        &self.motion
    }

    /// The policy that steers them.
    pub fn policy(&self) -> &Arc<CharacterPolicy> {
        &self.policy
    }

    /// Puts a character elsewhere on the ground (m), standing, with a unit heading.
    pub fn place(&mut self, character: usize, at: [f32; 2], heading: [f32; 2]) {
        let wait = wait(character);
        self.characters[character].place(&self.motion, at, heading, wait);
    }

    /// Sends a character to a point on the ground, m. It goes there from its next decision on.
    pub fn set_target(&mut self, character: usize, at: [f32; 2]) {
        self.characters[character].set_target(at);
    }

    /// Whether a character has been sent somewhere.
    pub fn has_target(&self, character: usize) -> bool {
        self.characters[character].has_target()
    }

    /// Says where the obstacles are that a character sees in its next decisions. Without as many as never before
    /// nothing is allocated. A policy of the plane sees none.
    pub fn set_obstacles(&mut self, character: usize, obstacles: &[MovingObstacle]) {
        self.characters[character].set_obstacles(obstacles);
    }

    /// Moves a character on by a frame, a thirtieth of a second. One without a target goes to the origin.
    pub fn step(&mut self, character: usize) {
        let Characters {
            motion,
            policy,
            characters,
            scratch,
        } = self;
        characters[character].step(motion, policy, scratch);
    }

    /// Moves all characters on by a frame.
    pub fn step_all(&mut self) {
        (0..self.count()).for_each(|character| self.step(character));
    }

    /// Where a character is.
    pub fn state(&self, character: usize) -> CharacterState {
        self.characters[character].state()
    }

    /// Its pose: stitched where the motion jumps, its standing feet held.
    pub fn pose(&self, character: usize) -> &CharacterPose {
        self.characters[character].pose()
    }

    /// The joints of its pose in the world.
    pub fn world(&self, character: usize) -> &JointTransforms {
        self.characters[character].world()
    }
}

/// Frames that a character plays before its first decision.
fn wait(character: usize) -> usize {
    character % FRAMES_PER_STEP
}
