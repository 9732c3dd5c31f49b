//! Whether all ranks of a training begin with the same.

use super::checkpoint::Checkpoint;
use super::config::Config;
use super::task::Task;
use crate::ranks::Ranks;
use anyhow::{Result, bail};

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
    for ((what, own), first) in own.iter().zip(first.chunks_exact(4)) {
        if own.to_le_bytes() != first {
            bail!(
                "rank {} has another {what} than the first: give all of them the same files and options",
                ranks.rank().number
            );
        }
    }
    Ok(())
}
