//! Characters: stepping them, and what they show.

use super::arguments::{array, array_out, finite, ground, index, out};
use super::database::{FootworkDatabase, motion};
use super::handles::Handles;
use super::policy::{FootworkPolicy, policy};
use super::status::{Failure, FootworkStatus, failure, guard};
use crate::runtime::{Characters, MovingObstacle};
use std::cell::RefCell;
use std::sync::{Mutex, PoisonError};

/// Open characters. Zero is none.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FootworkCharacters {
    /// Their number.
    pub id: u64,
}

/// An obstacle on the ground: a box along the axes of the world.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FootworkObstacle {
    /// Its centre, x and z, m.
    pub centre: [f32; 2],
    /// Half its sides along x and z, m.
    pub half: [f32; 2],
    /// Its velocity along x and z, m/s.
    pub velocity: [f32; 2],
}

/// Where a character is, and what has been decided for it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FootworkCharacterState {
    /// Position on the ground, x and z, m.
    pub position: [f32; 2],
    /// Unit forward direction on the ground, x and z.
    pub heading: [f32; 2],
    /// The target on the ground, x and z, m; the origin as long as none was set.
    pub target: [f32; 2],
    /// The trajectory that the policy last requested, for 1/3, 2/3 and 1 second ahead: position x, z (m) and heading
    /// x, z in the world.
    pub requested: [[f32; 4]; 3],
    /// The frame of the database that is shown.
    pub frame: u32,
    /// The frame that the last search found.
    pub matched: u32,
}

static CHARACTERS: Handles<Mutex<Characters>> = Handles::new("characters");

/// The most characters of a handle.
const MOST: u32 = 1 << 20;

/// Works with the characters of a handle, whom no other thread uses meanwhile.
fn with(
    characters: FootworkCharacters,
    work: impl FnOnce(&mut Characters) -> Result<(), Failure>,
) -> FootworkStatus {
    guard(|| {
        let characters = CHARACTERS.get(characters.id)?;
        // A panic has left no more than a step half done.
        let mut characters = characters.lock().unwrap_or_else(PoisonError::into_inner);
        work(&mut characters)
    })
}

/// Opens `count` characters of a database under a policy that was trained with it. They stand at the origin, look along
/// z, and have no target.
///
/// # Safety
/// `characters` is null or a place for a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_characters_open(
    database: FootworkDatabase,
    policy: FootworkPolicy,
    count: u32,
    characters: *mut FootworkCharacters,
) -> FootworkStatus {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { out(characters, "characters")? };
        let (motion, policy) = (motion(database)?, self::policy(policy)?);
        if !(1..=MOST).contains(&count) {
            let text = format!("`count` is {count}; it must be from 1 to {MOST}");
            return Err(failure(FootworkStatus::InvalidValue, text));
        }
        let opened = Characters::new(motion, policy, count as usize);
        let opened = opened.map_err(|error| failure(FootworkStatus::OtherDatabase, error))?;
        let id = CHARACTERS.add(Mutex::new(opened));
        *place = FootworkCharacters { id };
        Ok(())
    })
}

/// Closes characters.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_characters_close(characters: FootworkCharacters) -> FootworkStatus {
    guard(|| CHARACTERS.remove(characters.id))
}

/// Puts a character elsewhere on the ground (m), standing, looking along a direction of any length but 0.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_characters_place(
    characters: FootworkCharacters,
    character: u32,
    x: f32,
    z: f32,
    heading_x: f32,
    heading_z: f32,
) -> FootworkStatus {
    with(characters, |characters| {
        let character = index(character, characters.count(), "character")?;
        let (at, heading) = (
            ground(x, z, "position")?,
            ground(heading_x, heading_z, "heading")?,
        );
        let length = heading[0].hypot(heading[1]);
        if !(1e-6..=1e6).contains(&length) {
            let text = "`heading` is no direction: its length is 0, or far too large";
            return Err(failure(FootworkStatus::InvalidValue, text));
        }
        characters.place(character, at, heading.map(|part| part / length));
        Ok(())
    })
}

/// Sends a character to a point on the ground, m. It goes there from its next decision on, in up to a fifth of a
/// second.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_characters_set_target(
    characters: FootworkCharacters,
    character: u32,
    x: f32,
    z: f32,
) -> FootworkStatus {
    with(characters, |characters| {
        let character = index(character, characters.count(), "character")?;
        characters.set_target(character, ground(x, z, "target")?);
        Ok(())
    })
}

/// Says where the obstacles are that a character sees in its next decisions; `count` may be 0. Whoever moves them
/// says so again before each step. A policy that sees none refuses.
///
/// # Safety
/// `obstacles` is null or points to `count` obstacles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_characters_set_obstacles(
    characters: FootworkCharacters,
    character: u32,
    obstacles: *const FootworkObstacle,
    count: usize,
) -> FootworkStatus {
    with(characters, |characters| {
        let character = index(character, characters.count(), "character")?;
        // SAFETY: the caller's promise.
        let obstacles = unsafe { array(obstacles, count, "obstacles")? };
        if !characters.policy().task.has_maps() {
            let text = "the policy is of the task `plane` and sees no obstacles: open one of the task `obstacles`";
            return Err(failure(FootworkStatus::Unsupported, text));
        }
        OBSTACLES.with_borrow_mut(|all| {
            all.clear();
            for obstacle in obstacles {
                let &FootworkObstacle {
                    centre,
                    half,
                    velocity,
                } = obstacle;
                finite([centre, half, velocity].as_flattened(), "obstacles")?;
                all.push(MovingObstacle {
                    centre,
                    half,
                    velocity,
                });
            }
            characters.set_obstacles(character, all);
            Ok(())
        })
    })
}

thread_local! {
    static OBSTACLES: RefCell<Vec<MovingObstacle>> = const { RefCell::new(Vec::new()) };
}

/// Moves a character on by a frame, a thirtieth of a second. Every sixth frame its policy decides. It must have a target.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_characters_step(
    characters: FootworkCharacters,
    character: u32,
) -> FootworkStatus {
    with(characters, |characters| {
        let character = index(character, characters.count(), "character")?;
        must_have_target(characters, character)?;
        characters.step(character);
        Ok(())
    })
}

/// Moves all characters on by a frame. All must have a target; if one has none, none moves.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_characters_step_all(characters: FootworkCharacters) -> FootworkStatus {
    with(characters, |characters| {
        for character in 0..characters.count() {
            must_have_target(characters, character)?;
        }
        characters.step_all();
        Ok(())
    })
}

fn must_have_target(characters: &Characters, character: usize) -> Result<(), Failure> {
    match characters.has_target(character) {
        true => Ok(()),
        false => {
            let text = format!(
                "the character {character} has no target: call footwork_characters_set_target first"
            );
            Err(failure(FootworkStatus::OutOfOrder, text))
        }
    }
}

/// Says where a character is.
///
/// # Safety
/// `state` is null or a place for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_characters_state(
    characters: FootworkCharacters,
    character: u32,
    state: *mut FootworkCharacterState,
) -> FootworkStatus {
    with(characters, |characters| {
        let character = index(character, characters.count(), "character")?;
        let found = characters.state(character);
        // SAFETY: the caller's promise.
        *unsafe { out(state, "state")? } = FootworkCharacterState {
            position: found.shown.at,
            heading: found.shown.heading,
            target: found.target.unwrap_or_default(),
            requested: found.requested,
            frame: found.shown.frame as u32,
            matched: found.matched as u32,
        };
        Ok(())
    })
}

/// Copies a character's pose as skeletons of engines take it: the root joint's position in the world (x, y, z, m) to
/// `root`, of 3 numbers, and each joint's rotation relative to its parent (a quaternion x, y, z, w; the root's relative
/// to the world) to `rotations`, whose size `count` must be four times the number of joints.
///
/// # Safety
/// `root` is null or points to 3 numbers, `rotations` null or to `count`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_characters_local_pose(
    characters: FootworkCharacters,
    character: u32,
    root: *mut f32,
    rotations: *mut f32,
    count: usize,
) -> FootworkStatus {
    with(characters, |characters| {
        let character = index(character, characters.count(), "character")?;
        let pose = characters.pose(character);
        let wanted = 4 * pose.rotations.len();
        // SAFETY: the caller's promise.
        let (root, rotations) = unsafe {
            (
                array_out(root, 3, 3, "root")?,
                array_out(rotations, count, wanted, "rotations")?,
            )
        };
        root.copy_from_slice(&pose.root.to_array());
        for (place, rotation) in rotations.chunks_exact_mut(4).zip(&pose.rotations) {
            place.copy_from_slice(&rotation.to_array());
        }
        Ok(())
    })
}

/// Copies a character's joints in the world: their positions (x, y, z, m) to `positions`, whose size
/// `position_count` must be three times the number of joints, and their rotations (x, y, z, w) to `rotations`, whose
/// size `rotation_count` must be four times that number.
///
/// # Safety
/// `positions` is null or points to `position_count` numbers, `rotations` null or to `rotation_count`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_characters_world_pose(
    characters: FootworkCharacters,
    character: u32,
    positions: *mut f32,
    position_count: usize,
    rotations: *mut f32,
    rotation_count: usize,
) -> FootworkStatus {
    with(characters, |characters| {
        let character = index(character, characters.count(), "character")?;
        let world = characters.world(character);
        let joints = world.positions.len();
        // SAFETY: the caller's promise.
        let (positions, rotations) = unsafe {
            (
                array_out(positions, position_count, 3 * joints, "positions")?,
                array_out(rotations, rotation_count, 4 * joints, "rotations")?,
            )
        };
        for (place, position) in positions.chunks_exact_mut(3).zip(&world.positions) {
            place.copy_from_slice(&position.to_array());
        }
        for (place, rotation) in rotations.chunks_exact_mut(4).zip(&world.rotations) {
            place.copy_from_slice(&rotation.to_array());
        }
        Ok(())
    })
}
