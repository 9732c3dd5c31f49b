//! Variants of the task with obstacles side by side, trained from several seeds each and judged on the
//! hardest level: what each part of the method is worth (paper, section 6, figure 6), and what the
//! readings of its reward lead to.

use super::checkpoint::Checkpoint;
use super::config::Config;
use super::controller::Trained;
use super::evaluate::{Report, hardest};
use super::run_dir::Folder;
use super::figures::point;
use super::metrics::{self, Row};
use super::trainer::{EPISODES, train};
use crate::gpu::Device;
use crate::motion::database::Database;
use crate::report::ablation::{self, Method};
use crate::report::table::table;
use crate::container::write_whole;
use crate::env::locomotion::task::Arrival;
use crate::env::locomotion::{Obstacles, Task};
use anyhow::{Result, bail};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A variant of the method.
pub struct Variant {
    /// Of its runs' folders and in tables.
    pub name: &'static str,
    change: fn(&mut Obstacles),
}

/// The whole method, then each without one part.
pub const PARTS: [Variant; 3] = [
    Variant {
        name: "full",
        change: |_| {},
    },
    Variant {
        name: "no-hit-reward",
        change: |task| task.hit_reward = 0.0,
    },
    Variant {
        name: "no-curriculum",
        change: |task| task.curriculum = false,
    },
];

/// The paper's reward (its equation 4) as printed, then in other readings.
pub const READINGS: [Variant; 6] = [
    Variant {
        name: "printed",
        change: |task| *task = Obstacles::PRINTED,
    },
    Variant {
        name: "arrival-continues",
        change: |task| {
            *task = Obstacles {
                arrival: Arrival::Continue,
                ..Obstacles::PRINTED
            }
        },
    },
    Variant {
        name: "and-targets-clear",
        change: |task| {
            *task = Obstacles {
                arrival: Arrival::Continue,
                target_clear: true,
                ..Obstacles::PRINTED
            }
        },
    },
    Variant {
        name: "and-hits-shifted",
        change: |task| *task = Obstacles::PAPER,
    },
    Variant {
        name: "that-but-terminal",
        change: |task| {
            *task = Obstacles {
                arrival: Arrival::Terminal,
                ..Obstacles::PAPER
            }
        },
    },
    Variant {
        name: "progress",
        change: |task| *task = Obstacles::FAST,
    },
];

/// One variant's training from one seed.
pub struct Outcome {
    pub variant: &'static str,
    pub seed: u32,
    pub rows: Vec<Row>,
    /// On the hardest level.
    pub report: Report,
}

/// Trains all `variants` from the seeds 1 to `seeds` in folders of `out`, and writes `ablation.png`,
/// `ablation.txt`, `evaluation.csv` and `curves.csv` there. What an earlier call has finished is kept,
/// what it has begun, or ended after fewer steps, is gone on with. `None` if it was interrupted.
///
/// # Errors
/// See [`train`]; or `out` holds runs of another configuration.
pub fn ablate(
    variants: &[Variant],
    base: &Config,
    seeds: u32,
    out: &Path,
    database: &Arc<Database>,
    device: &Device,
    interrupted: &AtomicBool,
) -> Result<Option<Vec<Outcome>>> {
    let mut outcomes = Vec::new();
    // Seed by seed, so that a first picture of all variants is there soon.
    for seed in 1..=seeds {
        for variant in variants {
            let config = configure(base, variant, seed);
            let path = out.join(format!("{}-{seed}", variant.name));
            eprintln!("{} of {}", path.display(), variants.len() * seeds as usize);
            let folder = finish(&config, &path, database, device, interrupted)?;
            if interrupted.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let checkpoint = Checkpoint::load(&folder.last()?)?;
            let policy = Trained::from(&checkpoint);
            outcomes.push(Outcome {
                variant: variant.name,
                seed,
                rows: metrics::read(&folder.file("metrics.jsonl"), config.steps + config.batch())?,
                report: hardest(&policy, database, config.task, EPISODES)?,
            });
        }
        write(out, variants, &outcomes)?;
    }
    Ok(Some(outcomes))
}

fn configure(base: &Config, variant: &Variant, seed: u32) -> Config {
    let mut config = base.clone();
    config.seed = seed;
    if let Task::Obstacles(task) = &mut config.task {
        (variant.change)(task);
    }
    config
}

/// Trains a run to its end, from wherever it is.
fn finish(
    config: &Config,
    path: &Path,
    database: &Arc<Database>,
    device: &Device,
    interrupted: &AtomicBool,
) -> Result<Folder> {
    if !path.join("config.toml").exists() {
        let folder = Folder::create(Some(path), config.task.name())?;
        folder.write_config(config)?;
        train(config, &folder, database, device, None, interrupted, None)?;
        return Ok(folder);
    }
    let folder = Folder::open(path)?;
    let found = Config {
        steps: config.steps,
        ..folder.read_config()?
    };
    if found != *config {
        bail!(
            "{} holds a run of another configuration: give another --out, or what that one was given",
            path.display()
        );
    }
    let checkpoint = match folder.checkpoint("last").exists() {
        true => Some(Checkpoint::load_for(
            &folder.last()?,
            &config.task,
            database.fingerprint,
        )?),
        false => None,
    };
    let done = checkpoint.as_ref().map_or(0, |found| found.header.steps);
    if done >= config.steps + config.batch() {
        bail!(
            "{} has done {done} steps, more than are asked for: give --steps {done}, or another --out",
            path.display()
        );
    }
    if done < config.steps {
        folder.write_config(config)?;
        train(
            config,
            &folder,
            database,
            device,
            checkpoint,
            interrupted,
            None,
        )?;
    }
    Ok(folder)
}

fn write(out: &Path, variants: &[Variant], outcomes: &[Outcome]) -> Result<()> {
    let of = |name: &'static str| outcomes.iter().filter(move |o| o.variant == name);
    let curve = |outcome: &Outcome| outcome.rows.iter().map(point).collect();
    let methods = variants.iter().enumerate().map(|(colour, variant)| Method {
        name: variant.name.to_string(),
        colour,
        seeds: of(variant.name).map(curve).collect(),
    });
    let methods: Vec<_> = methods.collect();
    ablation::draw(&out.join("ablation.png"), &methods)?;
    write_whole(
        &out.join("ablation.txt"),
        summary(variants, outcomes).as_bytes(),
    )?;
    write_whole(&out.join("evaluation.csv"), evaluation(outcomes).as_bytes())?;
    write_whole(&out.join("curves.csv"), curves(outcomes).as_bytes())?;
    Ok(())
}

/// A table of the variants: means over the seeds on the hardest level.
pub fn summary(variants: &[Variant], outcomes: &[Outcome]) -> String {
    let headers = [
        "variant",
        "seeds",
        "success %",
        "of each seed",
        "collision %",
        "loiter %",
        "time s",
        "episode s",
    ];
    let rows: Vec<_> = variants
        .iter()
        .map(|variant| {
            let found: Vec<&Report> = outcomes
                .iter()
                .filter(|outcome| outcome.variant == variant.name)
                .map(|outcome| &outcome.report)
                .collect();
            let mean = |of: fn(&Report) -> f64| {
                found.iter().map(|report| of(report)).sum::<f64>() / found.len().max(1) as f64
            };
            let each = found
                .iter()
                .map(|report| format!("{:.1}", 100.0 * report.success));
            vec![
                variant.name.to_string(),
                found.len().to_string(),
                format!("{:.1}", 100.0 * mean(|report| report.success)),
                each.collect::<Vec<_>>().join(" "),
                format!("{:.1}", 100.0 * mean(|report| report.collision)),
                format!("{:.1}", 100.0 * mean(|report| report.loiter)),
                format!("{:.2}", mean(|report| report.time_to_target_mean_s)),
                format!("{:.2}", mean(|report| report.episode_length_mean_s)),
            ]
        })
        .collect();
    table(&headers, &rows)
}

fn evaluation(outcomes: &[Outcome]) -> String {
    let mut text =
        "variant,seed,episodes,success,collision,loiter,time_to_target_mean_s,episode_length_mean_s\n"
            .to_string();
    for Outcome {
        variant,
        seed,
        report,
        ..
    } in outcomes
    {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{variant},{seed},{},{},{},{},{},{}",
            report.episodes,
            report.success,
            report.collision,
            report.loiter,
            report.time_to_target_mean_s,
            report.episode_length_mean_s
        );
    }
    text
}

fn curves(outcomes: &[Outcome]) -> String {
    let mut text =
        "variant,seed,steps,wall_s,level,episodes,success,collision,return,length\n".to_string();
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for outcome in outcomes {
        for row in &outcome.rows {
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{},{},{}",
                outcome.variant,
                outcome.seed,
                row.steps,
                row.wall_s,
                row.level.map_or(String::new(), |level| level.to_string()),
                row.episodes,
                number(row.success),
                number(row.collision),
                number(row.episode_return),
                number(row.episode_length)
            );
        }
    }
    text
}
