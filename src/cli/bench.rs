//! `footwork bench`.

use super::Usage;
use super::calibrate::calibrate;
use super::say::{say, show};
use super::train::names;
use super::usage::writable;
use anyhow::{Context, Result, ensure};
use clap::Args;
use footwork::bench::{BenchPlan, Measurement, STAGES, run};
use footwork::gpu::Choice;
use footwork::report::scaling::{self, Curve, ScalingPanel};
use footwork::report::table::table;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Args)]
pub struct Bench {
    /// Only stages with this in their name: memory, arithmetic, search, rasterize_maps, hits, environment,
    /// physics, network, gradient, training, drawing
    #[arg(
        long,
        value_name = "NAME",
        default_value = "",
        hide_default_value = true
    )]
    filter: String,
    /// Where to measure [default: one core, all cores, lavapipe and a real GPU, as far as there]
    #[arg(long, value_enum, default_value = "auto", hide_default_value = true)]
    device: Choice,
    /// A database file, a BVH file or a folder of them; larger databases are made of mirrored and
    /// time-warped copies of its clips [default: synthetic motion]
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
    /// Also write all figures to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Also draw the scaling curves of search and training
    #[arg(long, value_name = "PNG")]
    plot: Option<PathBuf>,
    /// Only measure where TASK, or every task, trains quickest, and keep that for `--device auto` and `--envs auto`
    #[arg(
        long,
        value_name = "TASK",
        num_args = 0..=1,
        value_parser = names(),
        conflicts_with_all = ["filter", "json", "plot"]
    )]
    calibrate: Option<Option<String>>,
}

impl Bench {
    pub fn run(self) -> Result<()> {
        if let Some(task) = &self.calibrate {
            return calibrate(task.as_deref(), self.device, self.data.as_deref());
        }
        if !STAGES.iter().any(|stage| stage.contains(&self.filter)) {
            let why = format!(
                "no stage is called like {:?}: there are {}",
                self.filter,
                STAGES.join(", ")
            );
            return Err(Usage(why).into());
        }
        for file in self.json.iter().chain(&self.plot) {
            writable(file)?;
        }
        let line = ProgressBar::new_spinner()
            .with_style(ProgressStyle::with_template("{elapsed} {wide_msg}")?);
        line.enable_steady_tick(Duration::from_secs(1));
        let plan = BenchPlan {
            filter: &self.filter,
            device: self.device,
            data: self.data.as_deref(),
        };
        let rows = run(&plan, &|what| line.set_message(what.to_string()))?;
        line.finish_and_clear();
        show!("{}", shown(&rows));
        if let Some(file) = &self.json {
            let text = serde_json::to_string_pretty(&json!({ "rows": rows }))?;
            footwork::container::write_whole(file, text.as_bytes())
                .with_context(|| format!("cannot write {}", file.display()))?;
        }
        if let Some(file) = &self.plot {
            let panels = panels(&rows);
            ensure!(
                !panels.is_empty(),
                "nothing to draw: there are curves of the stages search and training alone"
            );
            scaling::draw(file, &panels)?;
            say!("see {}", file.display());
        }
        for line in advice(&rows) {
            say!("{line}");
        }
        Ok(())
    }
}

fn shown(rows: &[Measurement]) -> String {
    let headers = [
        "stage",
        "variant",
        "device",
        "frames",
        "envs",
        "batch",
        "a second",
        "time each",
        "MB",
        "roofline %",
    ];
    let cells = rows.iter().map(|row| {
        let size = |size: usize| {
            if size > 0 {
                size.to_string()
            } else {
                String::new()
            }
        };
        vec![
            row.stage.to_string(),
            row.variant.clone(),
            device(row),
            size(row.frames),
            size(row.envs),
            size(row.batch),
            speed(row.per_s),
            duration(1.0 / row.per_s),
            row.bytes
                .map_or(String::new(), |b| format!("{:.1}", b as f64 / 1e6)),
            row.roofline
                .map_or(String::new(), |r| format!("{:.1}", 100.0 * r)),
        ]
    });
    table(&headers, &cells.collect::<Vec<_>>())
}

fn device(row: &Measurement) -> String {
    match (row.device.as_str(), row.threads) {
        ("cpu", 1) => "cpu, one core".to_string(),
        ("cpu", threads) => format!("cpu, {threads} cores"),
        (name, _) if name.contains("llvmpipe") => "lavapipe".to_string(),
        (name, _) => name.to_string(),
    }
}

fn speed(per_s: f64) -> String {
    match per_s {
        1e9.. => format!("{:.1} G", per_s / 1e9),
        1e6.. => format!("{:.1} M", per_s / 1e6),
        1e4.. => format!("{:.0} k", per_s / 1e3),
        1e2.. => format!("{per_s:.0}"),
        _ => format!("{per_s:.2}"),
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        1e-3.. => format!("{:.2} ms", seconds * 1e3),
        1e-6.. => format!("{:.2} us", seconds * 1e6),
        _ => format!("{:.2} ns", seconds * 1e9),
    }
}

/// Curves of the stages that are measured in several sizes: the search by frames, training by environments.
fn panels(rows: &[Measurement]) -> Vec<ScalingPanel> {
    let by_frames = |row: &Measurement| row.frames;
    let by_envs = |row: &Measurement| row.envs;
    let panel = |title: &str, x, y, stage, variant, size: &dyn Fn(&Measurement) -> usize| {
        let mut curves: Vec<Curve> = Vec::new();
        for row in rows
            .iter()
            .filter(|row| row.stage == stage && row.variant == variant)
        {
            let point = (size(row) as f64, row.per_s);
            let name = device(row);
            match curves.iter_mut().find(|curve| curve.name == name) {
                Some(curve) => curve.points.push(point),
                None => curves.push(Curve {
                    name,
                    points: vec![point],
                }),
            }
        }
        ScalingPanel {
            title: title.to_string(),
            x,
            y,
            curves,
        }
    };
    let (frames, envs) = ("frames", "environments");
    let all = [
        panel(
            "search, all rows",
            frames,
            "queries a second",
            "search",
            "brute",
            &by_frames,
        ),
        panel(
            "search, by the index",
            frames,
            "queries a second",
            "search",
            "indexed",
            &by_frames,
        ),
        panel(
            "training, plane",
            envs,
            "steps a second",
            "training",
            "plane",
            &by_envs,
        ),
        panel(
            "training, obstacles",
            envs,
            "steps a second",
            "training",
            "obstacles",
            &by_envs,
        ),
    ];
    all.into_iter()
        .filter(|panel| !panel.curves.is_empty())
        .collect()
}

/// The quickest device for each task.
fn advice(rows: &[Measurement]) -> Vec<String> {
    let best = |task: &str| {
        let of = rows
            .iter()
            .filter(|row| row.stage == "training" && row.variant == task);
        of.max_by(|a, b| a.per_s.total_cmp(&b.per_s))
    };
    let say = |task: &str| {
        let row = best(task)?;
        let option = match device(row).as_str() {
            "lavapipe" => "lavapipe",
            _ if row.device == "cpu" => "cpu",
            _ => "gpu",
        };
        Some(format!(
            "use `train {task} --device {option}`: {} steps/s with {} environments on {}",
            speed(row.per_s),
            row.envs,
            device(row)
        ))
    };
    ["plane", "obstacles"].into_iter().filter_map(say).collect()
}
