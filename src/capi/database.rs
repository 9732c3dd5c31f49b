//! Databases: opening, what they hold, the search.

use super::arguments::{array, array_out, finite, index, out, path, wrong_size};
use super::handles::Handles;
use super::status::{Failure, FootworkStatus, failure, guard};
use crate::matching::SearchScratch;
use crate::motion::RATE;
use crate::motion::features::{FEATURE_DIM, POSE_DIM, TRAJECTORY_DIM};
use crate::runtime::CharacterMotion;
use std::cell::RefCell;
use std::ffi::c_char;
use std::sync::Arc;

/// An open database. Zero is none.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FootworkDatabase {
    /// Its number.
    pub id: u64,
}

/// What a database holds.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FootworkDatabaseInfo {
    /// Frames of all clips.
    pub frames: u32,
    /// Frames that the search can find.
    pub candidates: u32,
    /// Clips.
    pub clips: u32,
    /// Joints of the skeleton; joint 0 is the root, and parents precede their children.
    pub joints: u32,
    /// The number by which a policy knows its database.
    pub fingerprint: u32,
    /// Frames a second.
    pub frame_rate: f32,
}

static DATABASES: Handles<Arc<CharacterMotion>> = Handles::new("a database");

/// The motion of a handle.
pub fn motion(database: FootworkDatabase) -> Result<Arc<CharacterMotion>, Failure> {
    Ok(Arc::clone(&*DATABASES.get(database.id)?))
}

/// Opens the database file at `path` (UTF-8), and the index beside it; without an index it builds one, which takes
/// seconds and all cores.
///
/// # Safety
/// `path` is null or a text that ends with a zero, `database` null or a place for a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_database_open(
    path: *const c_char,
    database: *mut FootworkDatabase,
) -> FootworkStatus {
    guard(|| {
        // SAFETY: the caller's promise.
        let (database, path) = unsafe { (out(database, "database")?, self::path(path, "path")?) };
        let motion = CharacterMotion::open(path);
        let motion = motion.map_err(|error| failure(FootworkStatus::CannotRead, error))?;
        let id = DATABASES.add(Arc::new(motion));
        *database = FootworkDatabase { id };
        Ok(())
    })
}

/// Closes a database. Characters that were opened with it go on.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_database_close(database: FootworkDatabase) -> FootworkStatus {
    guard(|| DATABASES.remove(database.id))
}

/// Says what a database holds.
///
/// # Safety
/// `info` is null or a place for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_database_info(
    database: FootworkDatabase,
    info: *mut FootworkDatabaseInfo,
) -> FootworkStatus {
    guard(|| {
        let motion = motion(database)?;
        let database = motion.database();
        // SAFETY: the caller's promise.
        *unsafe { out(info, "info")? } = FootworkDatabaseInfo {
            frames: database.frames() as u32,
            candidates: database.candidates.len() as u32,
            clips: database.clips.len() as u32,
            joints: database.skeleton.joints() as u32,
            fingerprint: database.fingerprint,
            frame_rate: RATE,
        };
        Ok(())
    })
}

/// Copies the name of a joint, UTF-8 with a zero behind it, to `name`, which has `size` bytes.
///
/// # Safety
/// `name` is null or points to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_database_joint_name(
    database: FootworkDatabase,
    joint: u32,
    name: *mut c_char,
    size: usize,
) -> FootworkStatus {
    guard(|| {
        let motion = motion(database)?;
        let names = &motion.database().skeleton.names;
        let joint = &names[index(joint, names.len(), "joint")?];
        // SAFETY: the caller's promise.
        let place = unsafe { array_out(name.cast::<u8>(), size, size, "name")? };
        if place.len() <= joint.len() {
            let wanted = format!("{} or more", joint.len() + 1);
            return Err(wrong_size("name", size, &wanted));
        }
        place[..joint.len()].copy_from_slice(joint.as_bytes());
        place[joint.len()] = 0;
        Ok(())
    })
}

/// Copies the parent of every joint, -1 for the root's, to `parents`, whose size `count` must be the number of
/// joints.
///
/// # Safety
/// `parents` is null or points to `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_database_joint_parents(
    database: FootworkDatabase,
    parents: *mut i32,
    count: usize,
) -> FootworkStatus {
    guard(|| {
        let motion = motion(database)?;
        let all = &motion.database().skeleton.parents;
        // SAFETY: the caller's promise.
        let places = unsafe { array_out(parents, count, all.len(), "parents")? };
        for (place, parent) in places.iter_mut().zip(all) {
            *place = parent.map_or(-1, |parent| parent as i32);
        }
        Ok(())
    })
}

/// Copies the position of every joint relative to its parent, in the parent's frame (x, y, z, m), to `offsets`,
/// whose size `count` must be three times the number of joints. The root's is not used.
///
/// # Safety
/// `offsets` is null or points to `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_database_joint_offsets(
    database: FootworkDatabase,
    offsets: *mut f32,
    count: usize,
) -> FootworkStatus {
    guard(|| {
        let motion = motion(database)?;
        let all = &motion.database().skeleton.offsets;
        // SAFETY: the caller's promise.
        let places = unsafe { array_out(offsets, count, 3 * all.len(), "offsets")? };
        for (place, offset) in places.chunks_exact_mut(3).zip(all) {
            place.copy_from_slice(&offset.to_array());
        }
        Ok(())
    })
}

thread_local! {
    static SEARCH: RefCell<SearchScratch> = RefCell::default();
}

/// Finds the frame to play on from: the one nearest to the pose of `frame` and to a requested trajectory. That is 12
/// numbers (`count`), for 1/3, 2/3 and 1 second ahead: the position x, z (m) and the unit heading x, z, in the
/// character's frame (x to its left, z forward). `found` may be null; so may `distance`, which becomes the squared
/// distance of the normalised features.
///
/// # Safety
/// `trajectory` is null or points to `count` numbers, `found` and `distance` are null or places for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_database_search(
    database: FootworkDatabase,
    frame: u32,
    trajectory: *const f32,
    count: usize,
    found: *mut u32,
    distance: *mut f32,
) -> FootworkStatus {
    guard(|| {
        let motion = motion(database)?;
        let database = motion.database();
        let shown = index(frame, database.frames(), "frame")?;
        // SAFETY: the caller's promise.
        let requested = unsafe { array(trajectory, count, "trajectory")? };
        if requested.len() != TRAJECTORY_DIM {
            return Err(wrong_size("trajectory", count, &TRAJECTORY_DIM.to_string()));
        }
        finite(requested, "trajectory")?;
        let (mut query, normal) = (database.features[shown], &database.normalisation);
        for (i, value) in (POSE_DIM..FEATURE_DIM).zip(requested) {
            query[i] = (value - normal.mean[i]) * normal.scale[i];
        }
        let matcher = &motion.matcher;
        let nearest =
            SEARCH.with_borrow_mut(|scratch| matcher.nearest_with(frame, &query, scratch));
        // SAFETY: the caller's promise.
        let (found, distance) = unsafe { (found.as_mut(), distance.as_mut()) };
        if let Some(found) = found {
            *found = database.candidates[nearest.index as usize];
        }
        if let Some(distance) = distance {
            *distance = nearest.distance;
        }
        Ok(())
    })
}
