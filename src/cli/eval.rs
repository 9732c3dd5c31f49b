//! `footwork eval`.

use super::Usage;
use super::run::{locate, motion};
use anyhow::Result;
use clap::Args;
use footwork::motion::database::Database;
use footwork::playback::quality::{Comparison, Quality, compare};
use footwork::report::table::table;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::controller::{Controller, Scripted, Trained};
use footwork::train::evaluate::{Report, evaluate, hardest};
use footwork::train::planner::{Planned, plan};
use footwork::train::rendered_frames::shown;
use footwork::env::locomotion::{LEVELS, Task};
use std::path::PathBuf;
use std::sync::Arc;

/// Speeds the scripted baseline asks for, m/s.
const SPEEDS: [f32; 8] = [0.8, 1.2, 1.6, 2.0, 2.5, 3.0, 3.5, 4.0];

/// Episodes whose motion is judged, at most: some hundred thousand frames.
const WALKS: usize = 500;

#[derive(Args)]
pub struct Eval {
    /// A run's folder, whose last checkpoint is judged, or one of its checkpoints
    run: PathBuf,
    /// Where the run's motion is now, if it has been moved
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
    /// Episodes, the same ones for every policy
    #[arg(
        long,
        default_value_t = 1000,
        value_name = "N",
        allow_negative_numbers = true
    )]
    episodes: usize,
    /// Judge scripted motion matching beside it: a straight trajectory to the target
    #[arg(long)]
    baseline: bool,
    /// Among obstacles: plan so many of the episodes on the hardest level with full knowledge of
    /// everything, to see what can be reached at all
    #[arg(
        long,
        default_value_t = 0,
        value_name = "N",
        hide_default_value = true,
        allow_negative_numbers = true
    )]
    plan: usize,
    /// Judge the whole body's motion: feet that slide or sink, and what the jumps between pieces of
    /// motion leave to be seen, with each remedy
    #[arg(long)]
    motion: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Eval {
    pub fn run(self) -> Result<()> {
        if self.episodes == 0 || self.episodes > 1_000_000 {
            return Err(Usage("--episodes must be from 1 to 1000000".into()).into());
        }
        let (folder, path) = locate(&self.run)?;
        let config = folder.read_config()?;
        if self.plan > 0 && matches!(config.task, Task::Plane(_)) {
            let why = "--plan is for runs among obstacles: on the plane nothing is in the way";
            return Err(Usage(why.into()).into());
        }
        let database = motion(&config, self.data.as_deref())?;
        let checkpoint = Checkpoint::load_for(&path, &config.task, database.fingerprint)?;
        let task = checkpoint.header.task;
        let policy = Trained::from(&checkpoint);
        let levels = match task {
            Task::Plane(_) => Vec::new(),
            Task::Obstacles(_) => levels(&policy, &database, task, self.episodes)?,
        };
        let trained = match levels.last() {
            Some(hardest) => hardest.clone(),
            None => hardest(&policy, &database, task, self.episodes)?,
        };
        let planned = (self.plan > 0)
            .then(|| plan(&database, task, LEVELS - 1, self.plan.min(self.episodes)));
        let mut baseline = Vec::new();
        if self.baseline {
            for speed in SPEEDS {
                let scripted = Scripted {
                    database: &database,
                    speed,
                };
                baseline.push((speed, hardest(&scripted, &database, task, self.episodes)?));
            }
        }
        let motion = match self.motion {
            true => {
                let walks = shown(&policy, &database, task, self.episodes.min(WALKS))?;
                Some(compare(&database, &walks))
            }
            false => None,
        };
        match self.json {
            true => print_json(&trained, &baseline, &levels, planned, motion),
            false => {
                println!(
                    "{} at {} steps, {} episodes",
                    path.display(),
                    checkpoint.header.steps,
                    self.episodes
                );
                print_levels(&levels);
                print_table(&trained, &baseline);
                if let Some(planned) = planned {
                    println!(
                        "with full knowledge, {:.1} % of {} episodes can be taken to their target",
                        100.0 * planned.success,
                        planned.episodes
                    );
                }
                if let Some(motion) = motion {
                    print_motion(&motion);
                }
                Ok(())
            }
        }
    }
}

/// Reports of all levels, the hardest last.
fn levels(
    policy: &dyn Controller,
    database: &Arc<Database>,
    task: Task,
    episodes: usize,
) -> Result<Vec<Report>> {
    (0..LEVELS)
        .map(|level| evaluate(policy, database, task, level, episodes))
        .collect()
}

fn print_json(
    trained: &Report,
    baseline: &[(f32, Report)],
    levels: &[Report],
    planned: Option<Planned>,
    motion: Option<Comparison>,
) -> Result<()> {
    let mut object = serde_json::to_value(trained)?;
    if !baseline.is_empty() {
        let rows: Result<Vec<_>, serde_json::Error> = baseline
            .iter()
            .map(|(speed, report)| {
                let mut row = serde_json::to_value(report)?;
                row["asked_speed"] = serde_json::json!((f64::from(*speed) * 10.0).round() / 10.0);
                Ok(row)
            })
            .collect();
        object["baseline"] = rows?.into();
    }
    if !levels.is_empty() {
        let rows = levels.iter().enumerate().map(|(level, report)| {
            serde_json::json!({
                "level": level,
                "success": report.success,
                "collision": report.collision,
                "loiter": report.loiter,
                "time_to_target_mean_s": report.time_to_target_mean_s,
                "episode_length_mean_s": report.episode_length_mean_s,
            })
        });
        object["levels"] = rows.collect();
    }
    if let Some(planned) = planned {
        object["planned"] = serde_json::to_value(planned)?;
    }
    if let Some(motion) = motion {
        object["motion"] = serde_json::to_value(motion)?;
    }
    println!("{object}");
    Ok(())
}

fn print_levels(levels: &[Report]) {
    if levels.is_empty() {
        return;
    }
    let headers = [
        "level",
        "success %",
        "collision %",
        "loiter %",
        "time s",
        "episode s",
    ];
    let rows: Vec<_> = levels
        .iter()
        .enumerate()
        .map(|(level, report)| {
            vec![
                level.to_string(),
                format!("{:.1}", 100.0 * report.success),
                format!("{:.1}", 100.0 * report.collision),
                format!("{:.1}", 100.0 * report.loiter),
                format!("{:.2}", report.time_to_target_mean_s),
                format!("{:.2}", report.episode_length_mean_s),
            ]
        })
        .collect();
    println!("{}", table(&headers, &rows));
}

fn print_table(trained: &Report, baseline: &[(f32, Report)]) {
    let headers = [
        "controller",
        "success %",
        "time s",
        "p95 s",
        "path ratio",
        "speed m/s",
        "turn delay s",
    ];
    let row = |name: String, report: &Report| {
        vec![
            name,
            format!("{:.1}", 100.0 * report.success),
            format!("{:.2}", report.time_to_target_mean_s),
            format!("{:.2}", report.time_to_target_p95_s),
            format!("{:.2}", report.path_ratio),
            format!("{:.2}", report.mean_speed),
            report
                .turn_delay_mean_s
                .map_or("-".into(), |delay| format!("{delay:.2}")),
        ]
    };
    let mut rows = vec![row("policy".into(), trained)];
    rows.extend(
        baseline
            .iter()
            .map(|(speed, report)| row(format!("straight at {speed} m/s"), report)),
    );
    print!("{}", table(&headers, &rows));
}

fn print_motion(motion: &Comparison) {
    let styles: [(&str, &Quality); 5] = [
        ("as recorded, between jumps", &motion.recorded),
        ("no stitching", &motion.raw),
        ("simple stitching", &motion.simple),
        ("stitching", &motion.stitched),
        ("stitching and foot locking", &motion.locked),
    ];
    let headers = [
        "motion",
        "standing %",
        "skate cm/s",
        "sunk cm",
        "deepest cm",
        "jump cm",
        "m/s²",
        "m/s³",
    ];
    let rows = styles.map(|(name, quality)| {
        vec![
            name.to_string(),
            format!("{:.1}", 100.0 * quality.standing),
            format!("{:.2}", quality.foot_skate_cm_s),
            format!("{:.2}", quality.penetration_mean_cm),
            format!("{:.1}", quality.penetration_max_cm),
            format!("{:.2}", quality.jump_cm),
            format!("{:.1}", quality.acceleration),
            format!("{:.0}", quality.jerk),
        ]
    });
    println!(
        "\nthe motion of {} frames with {} jumps; jump, acceleration and jerk at jumps",
        motion.frames, motion.jumps
    );
    print!("{}", table(&headers, &rows));
}
