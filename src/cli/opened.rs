//! A training's configuration, resolved, with its device and its data.

use super::Usage;
use super::say::tell;
use anyhow::{Result, bail};
use footwork::env::EnvSpec;
use footwork::gpu::{Choice, Device};
use footwork::ranks::Ranks;
use footwork::rl::ppo::Ppo;
use footwork::train::calibration::{Calibration, Configure, Speed};
use footwork::train::config::{Base, Config};
use footwork::train::memory::check_training;
use footwork::train::task::{Task, TaskEntry};

/// What a training is of.
pub struct Opened {
    pub config: Config,
    pub device: Device,
    pub task: Box<dyn Task>,
    /// The dimensions of the environments.
    pub spec: EnvSpec,
}

impl Opened {
    /// Checks the configuration of a run that goes on and opens its device and data for a rank.
    pub fn resumed(entry: &TaskEntry, ranks: &Ranks, config: Config) -> Result<Opened> {
        let spec = entry.check(&config)?;
        let device = Device::open(config.device)?;
        check_training(&device, &share(ranks.count(), spec)?, &config)?;
        let task = load(entry, &config)?;
        Opened::of(entry, config, device, task)
    }

    /// Checks the configuration of a new run and opens its device and data for a rank. The device and, if it is to `grow`,
    /// the number of every rank's environments are found by measuring where there is a choice.
    pub fn new(
        entry: &TaskEntry,
        ranks: &Ranks,
        shared: Shared,
        grow: bool,
        configure: Configure,
    ) -> Result<Opened> {
        let mut config = configure(None)?;
        let spec = entry.check(&config)?;
        let mut devices = Device::all(config.device)?;
        let measures = grow || devices.len() > 1;
        let shares = match shared {
            Shared::Environments => ranks.count(),
            Shared::Trainings => 1,
        };
        let own = share(shares, spec)?;
        if !measures {
            check_training(&devices[0], &own, &config)?;
        }
        let task = load(entry, &config)?;
        if measures {
            // As it would be in one rank's environments.
            let of_a_rank = |envs: Option<usize>| configure(Some(envs.unwrap_or(own.envs)));
            let configure_one: Configure = match shares {
                1 => configure,
                _ => &of_a_rank,
            };
            let measure = || measured(entry, &*task, &devices, grow, configure_one);
            let chosen = chosen(ranks, &devices, measure)?;
            config = configure(grow.then_some(chosen.envs * shares))?;
            config.device = chosen.device;
            devices.retain(|device| device.choice() == config.device);
        }
        tell_scaled(entry, &config);
        Opened::of(entry, config, devices.remove(0), task)
    }

    /// What the device and the data turn out to be goes into the configuration: a resumed run must not change its
    /// device because another has appeared.
    fn of(
        entry: &TaskEntry,
        mut config: Config,
        device: Device,
        task: Box<dyn Task>,
    ) -> Result<Opened> {
        config.device = device.choice();
        config.task.settings = task.settings();
        Ok(Opened {
            spec: entry.check(&config)?,
            config,
            device,
            task,
        })
    }
}

/// What ranks share out among them.
#[derive(Clone, Copy)]
pub enum Shared {
    /// The environments of one training.
    Environments,
    /// Whole trainings.
    Trainings,
}

/// The environments of one of so many ranks.
fn share(count: usize, spec: EnvSpec) -> Result<EnvSpec> {
    let envs = spec.envs;
    if !envs.is_multiple_of(count) {
        return Err(Usage(format!(
            "{count} ranks cannot share {envs} environments: give a multiple of {count} as --envs"
        ))
        .into());
    }
    Ok(EnvSpec {
        envs: envs / count,
        ..spec
    })
}

/// A device and the number of a rank's environments on it.
struct Chosen {
    device: Choice,
    envs: usize,
}

/// What the first rank finds by measuring, for all.
fn chosen(
    ranks: &Ranks,
    devices: &[Device],
    measure: impl FnOnce() -> Result<Chosen>,
) -> Result<Chosen> {
    let choices = [Choice::Cpu, Choice::Gpu, Choice::Lavapipe];
    let mut told = Vec::new();
    if ranks.is_first() {
        let Chosen { device, envs } = measure()?;
        let device = choices.iter().position(|choice| *choice == device);
        told = vec![device.unwrap_or_default() as u64, envs as u64];
    }
    let mut bytes = bytemuck::cast_slice(&told).to_vec();
    ranks.broadcast(&mut bytes);
    let told: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
    let chosen = Chosen {
        device: choices[told[0] as usize],
        envs: told[1] as usize,
    };
    if !devices
        .iter()
        .any(|device| device.choice() == chosen.device)
    {
        bail!(
            "the first rank trains on `{}`, which this one has not: name a --device that all have",
            chosen.device
        );
    }
    Ok(chosen)
}

/// Loads the data and says what is to be said of it.
fn load(entry: &TaskEntry, config: &Config) -> Result<Box<dyn Task>> {
    let loaded = (entry.load)(config)?;
    for note in loaded.notes {
        tell!("note: {note}");
    }
    Ok(loaded.task)
}

/// The device and the number of environments that train quickest.
fn measured(
    entry: &TaskEntry,
    task: &dyn Task,
    devices: &[Device],
    grow: bool,
    configure: Configure,
) -> Result<Chosen> {
    tell!("where `{}` trains quickest:", entry.name);
    let calibration = Calibration {
        entry,
        task,
        configure,
        devices,
        grow,
        anew: false,
        tell: &|line| tell!("{line}"),
    };
    let found = calibration.run()?;
    let Speed { device, envs, .. } = found.chosen;
    tell!(
        "chosen: {envs} environments on `{device}`: {}",
        found.reason
    );
    Ok(Chosen { device, envs })
}

/// Says what follows from more environments than the preset's.
fn tell_scaled(entry: &TaskEntry, config: &Config) {
    let base = Base {
        preset: config.preset,
        steers: config.skills.is_some(),
        envs: None,
    };
    let (preset, ppo) = (entry.config_of(base).ppo, &config.ppo);
    let scaled = |ppo: &Ppo| {
        let Ppo {
            rollout_length,
            minibatch_size,
            learning_rate,
            ..
        } = *ppo;
        (rollout_length, minibatch_size, learning_rate)
    };
    if ppo.envs > preset.envs && scaled(ppo) != scaled(&preset) {
        tell!(
            "{} environments take rollouts of {} steps, minibatches of {} and a learning rate of {:.2e} (the preset's {}: {}, {}, {:.2e})",
            ppo.envs,
            ppo.rollout_length,
            ppo.minibatch_size,
            ppo.learning_rate,
            preset.envs,
            preset.rollout_length,
            preset.minibatch_size,
            preset.learning_rate,
        );
    }
}
