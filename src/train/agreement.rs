//! Whether all ranks of a training begin with the same.

use super::checkpoint::Checkpoint;
use super::config::Config;
use super::task::Task;
use crate::ranks::Ranks;
use anyhow::{Result, anyhow};

/// Refuses to train with a rank that has another program, other choices, other data or another checkpoint than the
/// first.
///
/// # Errors
/// Says which rank has what.
pub fn check(
    ranks: &Ranks,
    config: &Config,
    task: &dyn Task,
    checkpoint: Option<&Checkpoint>,
) -> Result<()> {
    if ranks.is_alone() {
        return Ok(());
    }
    let program = std::fs::read(std::env::current_exe()?)?;
    let fingerprint = task.fingerprint();
    let parameters = checkpoint.map_or(0, |checkpoint| checkpoint.policy.hash());
    let own = [
        ("program", crc32fast::hash(&program)),
        (
            "configuration",
            crc32fast::hash(config.to_toml().as_bytes()),
        ),
        ("motion data", fingerprint.data),
        ("low level", fingerprint.low_level),
        ("checkpoint", parameters),
    ];
    let mut first: Vec<u8> = own.iter().flat_map(|(_, own)| own.to_le_bytes()).collect();
    ranks.broadcast(&mut first);
    let mut pairs = own.iter().zip(first.chunks_exact(4));
    let other = pairs.find(|((_, own), first)| own.to_le_bytes() != *first);
    // None goes on, to write something, before all are asked.
    ranks.all_or_none(match other {
        None => Ok(()),
        Some(((what, _), _)) => Err(anyhow!(
            "another {what} than the first rank's: give all of them the same files and options"
        )),
    })
}
