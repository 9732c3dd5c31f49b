//! Whether what is asked for fits into the memory of the machine: better said before anything is made.

use super::config::Config;
use crate::env::EnvSpec;
use crate::gpu::Device;
use crate::rl::rollout::check_fits;
use anyhow::{Result, bail};
use std::fs::read_to_string;

/// Bytes of a number.
const NUMBER: u64 = 4;
/// What an environment carries besides its rollout, about: the state of a simulated body, or of a hundred
/// obstacles with their maps.
pub const ENVIRONMENT: u64 = 4096;

/// Refuses a training that a device cannot hold.
///
/// # Errors
/// Says what is too large and by how much.
pub fn check_training(device: &Device, spec: &EnvSpec, config: &Config) -> Result<()> {
    check_fits(device, spec, config.ppo.rollout_length)?;
    match device {
        Device::Cpu => check(
            of_training(spec, config),
            "use a smaller --envs or ppo.rollout_length",
        ),
        Device::Gpu(_) => Ok(()),
    }
}

/// Bytes that a training on the CPU needs besides its data, about: rollouts, the rows that are learned from, and
/// the windows of a discriminator.
pub fn of_training(spec: &EnvSpec, config: &Config) -> u64 {
    let [observation, action, style] =
        [spec.observation.dim(), spec.action, spec.style].map(|dim| dim as u64);
    let windows = if config.amp.is_some() { 4 * style } else { 0 };
    // Observed, then, where an episode ended, observed once more; a row of what is learned.
    let sample = 3 * observation + 4 * action + windows + 16;
    let samples = (config.ppo.rollout_length * spec.rows()) as u64;
    // Of an opponent no rollout is kept.
    let bodies = if config.self_play.is_some() { 2 } else { 1 };
    samples * sample * NUMBER + bodies * spec.envs as u64 * ENVIRONMENT
}

/// Refuses what needs more bytes than there are.
///
/// # Errors
/// Says how many are needed and how many there are; `advice` is what to do.
pub fn check(bytes: u64, advice: &str) -> Result<()> {
    match available() {
        Some(free) if bytes > free => bail!(
            "this needs about {} of memory and {} are free: {advice}",
            in_words(bytes),
            in_words(free)
        ),
        _ => Ok(()),
    }
}

fn in_words(bytes: u64) -> String {
    match bytes >> 20 {
        mib @ 0..1024 => format!("{mib} MiB"),
        mib => format!("{:.1} GiB", mib as f64 / 1024.0),
    }
}

/// Bytes that this process may still have: the least of what the machine has left, of its control group's limit and
/// of its own address space. None where the system does not tell.
fn available() -> Option<u64> {
    let meminfo = read_to_string("/proc/meminfo").ok();
    let machine = meminfo.and_then(|text| Some(1024 * after(&text, "MemAvailable:")?));
    let number = |path: &str| read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max");
    let used = number("/sys/fs/cgroup/memory.current").unwrap_or(0);
    // What files are cached gives way.
    let stat = read_to_string("/sys/fs/cgroup/memory.stat").unwrap_or_default();
    let cached = ["inactive_file", "active_file"].map(|name| after(&stat, name).unwrap_or(0));
    let used = used.saturating_sub(cached.iter().sum());
    let group = group.map(|most| most.saturating_sub(used));
    let limits = read_to_string("/proc/self/limits").ok();
    let space = limits.and_then(|text| after(&text, "Max address space"));
    let status = read_to_string("/proc/self/status").ok();
    let taken = status.and_then(|text| Some(1024 * after(&text, "VmSize:")?));
    let space = space.map(|most| most.saturating_sub(taken.unwrap_or(0)));
    [machine, group, space].into_iter().flatten().min()
}

/// The number that follows a name at the start of a line.
fn after(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_by_name() {
        let text = "MemTotal: 9 kB\nMemAvailable:    123 kB\n";
        assert_eq!(after(text, "MemAvailable:"), Some(123));
        assert_eq!(
            after(
                "Max address space unlimited unlimited bytes",
                "Max address space"
            ),
            None
        );
        assert_eq!(after(text, "Nothing:"), None);
    }

    #[test]
    fn too_much_is_refused_with_both_figures() {
        if available().is_some() {
            let error = check(1 << 60, "ask for less").unwrap_err().to_string();
            assert!(
                error.contains("GiB") && error.ends_with("ask for less"),
                "{error}"
            );
            assert!(check(1, "").is_ok());
        }
    }
}
