//! The low level that a high-level policy steers: a run of the task `skills`.

use super::checkpoint::Checkpoint;
use super::config::{Config, ConfigError, check_amp, check_ase};
use super::run_dir::checkpoint_of;
use crate::env::EnvSpec;
use crate::rl::amp::{Amp, FrozenDiscriminator};
use crate::rl::ase::{Ase, FrozenLowLevel};
use anyhow::{Context, Result, anyhow, bail};
use serde::Deserialize;
use std::path::Path;

/// The task whose runs are low levels.
const TASK: &str = "skills";

/// What must be known of a low level's choices to read it.
#[derive(Deserialize)]
struct LowLevelConfig {
    amp: Amp,
    ase: Ase,
}

/// Reads the low level of a run: its folder's last checkpoint, or a given one.
///
/// # Errors
/// There is none, or it is of another task, damaged or of an older version.
pub fn load(run: &Path) -> Result<FrozenLowLevel> {
    let path = checkpoint_of(run)?;
    let mut checkpoint = Checkpoint::load(&path)?;
    let header = &checkpoint.header;
    if header.task != TASK {
        bail!(
            "{} is of the task `{}`, not of `{TASK}`: --skills takes a run that has learned skills",
            path.display(),
            header.task
        );
    }
    let path = path.display();
    let config: Result<LowLevelConfig, _> = toml::from_str(&header.config);
    let config =
        config.map_err(|error| anyhow!("{path}: its configuration: {}", error.message()))?;
    check_amp(&config.amp)?;
    check_ase(&config.ase)?;
    let widths = [header.spec.style, config.ase.latent];
    let fits = FrozenLowLevel::check(&checkpoint.policy, widths);
    fits.map_err(|why| anyhow!("{path} is no low level: {why}"))?;
    let (style, data) = (header.spec.style, header.fingerprint.data);
    let latents = config.ase.rewards().latents;
    let mut learner = checkpoint.sections.take("learner")?;
    let discriminator = FrozenDiscriminator::load(&config.amp, latents, &mut learner, style)
        .with_context(|| format!("the discriminator of {path} cannot be read"))?;
    Ok(FrozenLowLevel::new(
        checkpoint.policy,
        discriminator,
        config.ase,
        style,
        data,
    ))
}

/// The dimensions of a body's environments under a configuration: those of latents, where it names a low level.
///
/// # Errors
/// The low level cannot be read, or is of another body.
pub fn steered(config: &Config, body: EnvSpec) -> Result<EnvSpec, ConfigError> {
    let Some(run) = &config.skills else {
        return Ok(body);
    };
    let low_level = load(run).map_err(|error| ConfigError::LowLevel(format!("{error:#}")))?;
    config.check_style_rewards(low_level.discriminator.loss())?;
    low_level.steered(&body).map_err(|why| {
        let run = run.display();
        ConfigError::LowLevel(format!("the low level {run} does not fit: {why}"))
    })
}
