//! A training's configuration, resolved, with its device and its data.

use super::say::tell;
use anyhow::Result;
use footwork::env::EnvSpec;
use footwork::gpu::Device;
use footwork::train::calibration::{Calibration, Configure};
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
    /// Checks the configuration of a run that goes on and opens its device and data.
    pub fn resumed(entry: &TaskEntry, config: Config) -> Result<Opened> {
        let spec = entry.check(&config)?;
        let device = Device::open(config.device)?;
        check_training(&device, &spec, &config)?;
        let task = load(entry, &config)?;
        Opened::of(entry, config, device, task)
    }

    /// The same of a new run, whose device and, if it is to `grow`, number of environments are found by measuring where
    /// there is a choice.
    pub fn new(entry: &TaskEntry, grow: bool, configure: Configure) -> Result<Opened> {
        let mut config = configure(None)?;
        let spec = entry.check(&config)?;
        let mut devices = Device::all(config.device)?;
        let measures = grow || devices.len() > 1;
        if !measures {
            check_training(&devices[0], &spec, &config)?;
        }
        let task = load(entry, &config)?;
        if measures {
            config = measured(entry, &*task, &devices, grow, configure)?;
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

/// Loads the data and says what is to be said of it.
fn load(entry: &TaskEntry, config: &Config) -> Result<Box<dyn Task>> {
    let loaded = (entry.load)(config)?;
    for note in loaded.notes {
        tell!("note: {note}");
    }
    Ok(loaded.task)
}

/// The configuration on the device and in the number of environments that train quickest.
fn measured(
    entry: &TaskEntry,
    task: &dyn Task,
    devices: &[Device],
    grow: bool,
    configure: Configure,
) -> Result<Config> {
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
    let chosen = &found.chosen;
    tell!(
        "chosen: {} environments on `{}`: {}",
        chosen.envs,
        chosen.device,
        found.reason
    );
    Ok(found.config)
}

/// Says what follows from more environments than the preset's.
fn tell_scaled(entry: &TaskEntry, config: &Config) {
    let base = Base {
        preset: config.preset,
        steers: config.skills.is_some(),
        envs: None,
    };
    let (preset, ppo) = (entry.config_of(base).ppo, &config.ppo);
    if ppo.envs > preset.envs {
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
