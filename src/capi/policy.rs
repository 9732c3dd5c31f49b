//! Policies: opening, and what they are.

use super::arguments::{out, path};
use super::handles::Handles;
use super::status::{Failure, FootworkStatus, failure, guard};
use crate::runtime::{CharacterPolicy, PolicyError};
use std::ffi::c_char;
use std::sync::Arc;

/// An open policy. Zero is none.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FootworkPolicy {
    /// Its number.
    pub id: u64,
}

/// What a policy is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FootworkPolicyInfo {
    /// The number by which it knows its database.
    pub fingerprint: u32,
    /// 1 if it sees obstacles, else 0.
    pub sees_obstacles: u32,
    /// The distance to the target that counted as arrival when it learned, m.
    pub success_radius: f32,
}

static POLICIES: Handles<Arc<CharacterPolicy>> = Handles::new("a policy");

/// The policy of a handle.
pub fn policy(policy: FootworkPolicy) -> Result<Arc<CharacterPolicy>, Failure> {
    Ok(Arc::clone(&*POLICIES.get(policy.id)?))
}

/// Opens a policy of the task `plane` or `obstacles`: `path` (UTF-8) is a run's folder, whose last checkpoint is taken,
/// or a checkpoint.
///
/// # Safety
/// `path` is null or a text that ends with a zero, `policy` null or a place for a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_policy_open(
    path: *const c_char,
    policy: *mut FootworkPolicy,
) -> FootworkStatus {
    guard(|| {
        // SAFETY: the caller's promise.
        let (policy, path) = unsafe { (out(policy, "policy")?, self::path(path, "path")?) };
        let opened = CharacterPolicy::open(path).map_err(|error| {
            let status = match error {
                PolicyError::Task { .. } => FootworkStatus::Unsupported,
                _ => FootworkStatus::CannotRead,
            };
            failure(status, error)
        })?;
        let id = POLICIES.add(Arc::new(opened));
        *policy = FootworkPolicy { id };
        Ok(())
    })
}

/// Closes a policy. Characters that were opened with it go on.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_policy_close(policy: FootworkPolicy) -> FootworkStatus {
    guard(|| POLICIES.remove(policy.id))
}

/// Says what a policy is.
///
/// # Safety
/// `info` is null or a place for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn footwork_policy_info(
    policy: FootworkPolicy,
    info: *mut FootworkPolicyInfo,
) -> FootworkStatus {
    guard(|| {
        let policy = self::policy(policy)?;
        // SAFETY: the caller's promise.
        *unsafe { out(info, "info")? } = FootworkPolicyInfo {
            fingerprint: policy.fingerprint,
            sees_obstacles: policy.task.has_maps().into(),
            success_radius: policy.task.success_radius(),
        };
        Ok(())
    })
}
