//! Speeds that were measured on this machine, kept for later trainings.

use crate::container::write_whole;
use crate::gpu::Device;
use crate::input_file;
use crate::train::config::{Config, VERSION};
use crate::train::fingerprint::Fingerprint;
use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Speeds that are kept; the oldest give way.
const MOST: usize = 1000;
/// Bytes of the longest file.
const MAX_BYTES: u64 = 1 << 24;

/// What a speed is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Workload {
    version: String,
    device: String,
    task: String,
    envs: usize,
    /// Checksum of the choices of task and learning, its networks among them.
    choices: u32,
    #[serde(flatten)]
    fingerprint: Fingerprint,
}

impl Workload {
    /// Updates of a training on a device.
    pub fn new(device: &Device, config: &Config, fingerprint: Fingerprint) -> Self {
        Workload {
            version: VERSION.to_string(),
            device: name(device),
            task: config.task.name.clone(),
            envs: config.ppo.envs,
            choices: config.workload(),
            fingerprint,
        }
    }
}

/// A name that tells devices of different machines apart, too: they may share a home.
fn name(device: &Device) -> String {
    match (device, processor()) {
        (Device::Cpu, Some(processor)) => format!("{}, {processor}", device.name()),
        _ => device.name(),
    }
}

/// The model of the processor, where the system tells.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_string())
}

#[derive(Serialize, Deserialize)]
struct Row {
    #[serde(flatten)]
    workload: Workload,
    steps_per_s: f64,
}

/// The kept speeds, the oldest first.
pub struct KeptSpeeds {
    file: Option<PathBuf>,
    rows: Vec<Row>,
}

impl KeptSpeeds {
    /// What a file holds. Nothing if there is none or it is damaged, which is told.
    pub fn open(file: Option<PathBuf>, tell: &dyn Fn(&str)) -> Self {
        let rows = file.as_deref().map_or(Ok(Vec::new()), read);
        let rows = rows.unwrap_or_else(|error| {
            tell(&format!("note: {error:#}: all is measured anew"));
            Vec::new()
        });
        KeptSpeeds { file, rows }
    }

    /// The speed of a workload, steps/s.
    pub fn find(&self, workload: &Workload) -> Option<f64> {
        let row = self.rows.iter().find(|row| row.workload == *workload);
        row.map(|row| row.steps_per_s)
    }

    /// Takes a speed in, in place of the workload's former one. What other versions measured is dropped.
    pub fn put(&mut self, workload: Workload, steps_per_s: f64) {
        let rows = &mut self.rows;
        rows.retain(|row| row.workload.version == VERSION && row.workload != workload);
        rows.drain(..rows.len().saturating_sub(MOST - 1));
        rows.push(Row {
            workload,
            steps_per_s,
        });
    }

    /// Writes the file, whole or not at all; that it cannot be written is told.
    pub fn save(&self, tell: &dyn Fn(&str)) {
        if let Err(error) = self.write() {
            tell(&format!(
                "note: {error:#}; the next training measures again"
            ));
        }
    }

    fn write(&self) -> Result<()> {
        let Some(path) = &self.file else {
            bail!("there is no folder to keep speeds in");
        };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        }
        let text = serde_json::to_string_pretty(&self.rows)? + "\n";
        Ok(write_whole(path, text.as_bytes())?)
    }
}

fn read(path: &Path) -> Result<Vec<Row>> {
    let damaged = || format!("{} is damaged", path.display());
    let text = match input_file::text(path, MAX_BYTES) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        text => text.with_context(|| format!("cannot read {}", path.display()))?,
    };
    let rows: Vec<Row> = serde_json::from_str(&text).with_context(damaged)?;
    let sound = rows.iter().all(|row| row.steps_per_s > 0.0);
    ensure!(sound, damaged());
    Ok(rows)
}

/// The file of this user and machine: in the folder for what programs can make again. None where there is none.
pub fn file() -> Option<PathBuf> {
    let variable = |name| std::env::var_os(name).map(PathBuf::from);
    let named = |name| variable(name).filter(|folder: &PathBuf| folder.is_absolute());
    let at_home = |folder| std::env::home_dir().map(|home| home.join(folder));
    let folder = named("XDG_CACHE_HOME").or_else(|| match std::env::consts::OS {
        "windows" => named("LOCALAPPDATA"),
        "macos" => at_home("Library/Caches"),
        _ => at_home(".cache"),
    });
    Some(folder?.join("footwork").join("calibration.json"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::config::Preset;
    use crate::train::tasks::find;
    use std::cell::RefCell;

    fn workload(envs: usize, data: u32) -> Workload {
        let mut config = find("plane").unwrap().config(Preset::Fast);
        config.ppo.envs = envs;
        Workload::new(&Device::Cpu, &config, data.into())
    }

    /// The speeds of a file, and what is told of it.
    fn opened(path: &Path) -> (KeptSpeeds, String) {
        let told = RefCell::new(String::new());
        let kept = KeptSpeeds::open(Some(path.to_path_buf()), &|note| {
            told.borrow_mut().push_str(note)
        });
        (kept, told.into_inner())
    }

    #[test]
    fn speeds_are_found_by_all_that_decides_over_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/er/speeds.json");
        let (mut kept, told) = opened(&path);
        assert_eq!(told, "");
        kept.put(workload(256, 1), 1.0);
        kept.put(workload(512, 1), 2.0);
        kept.put(workload(256, 1), 3.0);
        kept.save(&|note| panic!("{note}"));
        let (kept, told) = opened(&path);
        assert_eq!((told.as_str(), kept.rows.len()), ("", 2));
        assert_eq!(kept.find(&workload(256, 1)), Some(3.0));
        assert_eq!(kept.find(&workload(512, 1)), Some(2.0));
        assert_eq!(kept.find(&workload(256, 2)), None);
        let mut config = find("plane").unwrap().config(Preset::Fast);
        config.ppo.network.hidden.push(8);
        let wider = Workload::new(&Device::Cpu, &config, 1.into());
        assert_eq!(kept.find(&wider), None);
        config = find("plane").unwrap().config(Preset::Fast);
        (config.seed, config.steps) = (7, 7);
        let other_seed = Workload::new(&Device::Cpu, &config, 1.into());
        assert_eq!(kept.find(&other_seed), Some(3.0));
    }

    #[test]
    fn what_other_versions_measured_and_what_is_old_gives_way() {
        let mut kept = KeptSpeeds::open(None, &|_| {});
        let other = Workload {
            version: "0.0.1".into(),
            ..workload(256, 0)
        };
        kept.rows.push(Row {
            workload: other.clone(),
            steps_per_s: 1.0,
        });
        assert_eq!(kept.find(&workload(256, 0)), None);
        for data in 0..=MOST as u32 {
            kept.put(workload(256, data), 1.0);
        }
        assert_eq!((kept.rows.len(), kept.find(&other)), (MOST, None));
        assert_eq!(kept.find(&workload(256, 0)), None);
        assert_eq!(kept.find(&workload(256, MOST as u32)), Some(1.0));
    }

    #[test]
    fn a_damaged_file_is_told_and_holds_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("speeds.json");
        let (mut kept, _) = opened(&path);
        kept.put(workload(256, 1), 1.0);
        kept.save(&|note| panic!("{note}"));
        let good = std::fs::read_to_string(&path).unwrap();
        let zero = good.replace("1.0", "0.0");
        for text in ["", "[", "[{}]", "{}", &zero, &good[..good.len() / 2]] {
            std::fs::write(&path, text).unwrap();
            let (kept, told) = opened(&path);
            assert!(told.contains("speeds.json is damaged"), "{text}: {told}");
            assert!(kept.rows.is_empty());
        }
    }
}
