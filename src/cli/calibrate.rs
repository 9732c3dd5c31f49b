//! `footwork bench --calibrate`: where tasks train quickest, measured anew.

use super::say::{say, show, tell};
use anyhow::Result;
use footwork::gpu::{Choice, Device};
use footwork::report::table::table;
use footwork::train::calibration::{Calibrated, Calibration};
use footwork::train::config::{Base, Config};
use footwork::train::task::TaskEntry;
use footwork::train::tasks::{REGISTRY, find};
use std::path::{Path, PathBuf};

/// Measures one task or, without a name, all of them, on the devices of a choice and with the given motion.
pub fn calibrate(task: Option<&str>, device: Choice, data: Option<&Path>) -> Result<()> {
    let devices = Device::all(device)?;
    let data = data.map(std::path::absolute).transpose()?;
    let entries: Vec<&TaskEntry> = match task {
        Some(name) => vec![find(name)?],
        None => REGISTRY.iter().collect(),
    };
    let (mut rows, mut reasons) = (Vec::new(), Vec::new());
    for entry in entries {
        tell!("{}:", entry.name);
        let found = measured(entry, &devices, data.as_ref())?;
        rows.extend(cells(entry.name, &found));
        reasons.push(format!("{}: {}", entry.name, found.reason));
    }
    let headers = ["task", "device", "environments", "steps/s", "chosen"];
    show!("{}", table(&headers, &rows));
    for reason in reasons {
        say!("{reason}");
    }
    Ok(())
}

fn measured(entry: &TaskEntry, devices: &[Device], data: Option<&PathBuf>) -> Result<Calibrated> {
    let configure = |envs| {
        let config = entry.config_of(Base {
            envs,
            ..Base::default()
        });
        Ok(Config {
            data: data.cloned(),
            ..config
        })
    };
    let config = configure(None)?;
    entry.check(&config)?;
    let calibration = Calibration {
        entry,
        task: &*(entry.load)(&config)?.task,
        configure: &configure,
        devices,
        grow: true,
        anew: true,
        tell: &|line| tell!("{line}"),
    };
    calibration.run()
}

fn cells(task: &str, found: &Calibrated) -> Vec<Vec<String>> {
    let speeds = found.speeds.iter();
    let cells = speeds.map(|speed| {
        let chosen = if *speed == found.chosen { "yes" } else { "" };
        vec![
            task.to_string(),
            speed.device.to_string(),
            speed.envs.to_string(),
            format!("{:.0}", speed.steps_per_s),
            chosen.to_string(),
        ]
    });
    cells.collect()
}
