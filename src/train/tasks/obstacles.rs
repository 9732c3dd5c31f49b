//! The task `obstacles`: reach a target among moving obstacles, on levels of rising difficulty.

use super::presets::{convolutional, paper};
use crate::env::locomotion::{LocomotionTask, Obstacles};
use crate::env::{EnvBatch, EnvSpec};
use crate::gpu::Device;
use crate::motion::normalise::Weights;
use crate::nn::Policy;
use crate::ranks::Ranks;
use crate::rl::ppo::Ppo;
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, table, within};
use crate::train::eval_report::{levels, levels_json};
use crate::train::evaluation::{EvalOptions, EvalReport, Evaluation};
use crate::train::fingerprint::Fingerprint;
use crate::train::locomotion::{Locomotion, rollout_spec, split, with_weights};
use crate::train::task::{Ablation, Loaded, Measure, Task, TaskEntry, Variant};
#[cfg(feature = "report")]
use crate::train::{figures, metrics::UpdateMetrics, run_dir::RunDir};
use anyhow::Result;
#[cfg(feature = "report")]
use std::path::PathBuf;

/// The task in the registry.
pub const ENTRY: TaskEntry = TaskEntry {
    name: "obstacles",
    about: "Reach a target among 100 moving obstacles",
    preset,
    steering: None,
    spec,
    takes_motions: false,
    load,
    with_recordings: None,
    ablations: &[PARTS, REWARDS],
};

fn preset(preset: Preset) -> TaskPreset {
    let (task, ppo) = match preset {
        Preset::Fast => (Obstacles::FAST, fast_among_obstacles()),
        Preset::Paper => (Obstacles::PAPER, paper_among_obstacles()),
    };
    TaskPreset {
        settings: with_weights(&task, Weights::PAPER),
        ppo,
        amp: None,
        ase: None,
        self_play: None,
        steps: 6_000_000,
    }
}

/// Found by measuring: see `docs/measurements/2026-11-29.md`.
fn fast_among_obstacles() -> Ppo {
    Ppo {
        rollout_length: 32,
        epochs: 4,
        minibatch_size: 1024,
        learning_rate: 7e-4,
        final_lr_fraction: 0.05,
        anneal_steps: 6_000_000,
        gamma: 0.99,
        // Wide: who never asks for a run does not learn to run.
        init_log_std: 1.0,
        network: convolutional(2),
        ..Ppo::default()
    }
}

fn paper_among_obstacles() -> Ppo {
    Ppo {
        network: convolutional(1),
        ..paper()
    }
}

fn spec(config: &Config) -> Result<EnvSpec, ConfigError> {
    let (task, _) = split::<Obstacles>(config)?;
    let boxes = config.ppo.envs.saturating_mul(task.count as usize);
    // `reset` looks through all of them up to 32 times, and lavapipe stops after 65,535 iterations.
    within("task.count", task.count, 0, 2000)?;
    within("ppo.envs times task.count", boxes, 0, 1 << 23)?;
    within("task.side_min", task.side_min, 0.001, 1000.0)?;
    within("task.side_max", task.side_max, task.side_min, 1000.0)?;
    within(
        "task.arena_half_extent",
        task.arena_half_extent,
        0.1,
        1000.0,
    )?;
    within("task.spawn_clearance", task.spawn_clearance, 0.0, 1000.0)?;
    let least = 0.5 * task.side_max + task.spawn_clearance;
    if task.arena_half_extent <= least {
        return Err(ConfigError::Value {
            key: "task.arena_half_extent",
            value: task.arena_half_extent.to_string(),
            why: format!(
                "the start cannot be kept clear: an obstacle of side {} with a clearance of {} reaches it from everywhere; it must be over {least}",
                task.side_max, task.spawn_clearance,
            ),
        });
    }
    within("task.map_edge_width", task.map_edge_width, 0.0, 100.0)?;
    within("task.map_history_s", task.map_history_s, 0.0, 10.0)?;
    within("task.speed", task.speed, 0.0, 100.0)?;
    let (first, last) = (task.target_extent_first, task.target_extent_last);
    within("task.target_extent_first", first, 0.1, 1000.0)?;
    within("task.target_extent_last", last, 0.1, 1000.0)?;
    within(
        "task.success_radius",
        task.success_radius,
        0.001,
        first.min(last),
    )?;
    within("task.max_steps", task.max_steps, 1, 10_000)?;
    within("task.hit_reward", task.hit_reward, 0.0, 1e6)?;
    within("task.success_bonus", task.success_bonus, -1e6, 1e6)?;
    within("task.collision_reward", task.collision_reward, -1e6, 0.0)?;
    within("task.promotion_success", task.promotion_success, 0.0, 1.0)?;
    rollout_spec(LocomotionTask::Obstacles(task), config)
}

fn load(config: &Config) -> Result<Loaded> {
    let (obstacles, weights) = split::<Obstacles>(config)?;
    let task = LocomotionTask::Obstacles(obstacles);
    let (locomotion, notes) = Locomotion::load(task, weights, config)?;
    let task = Box::new(ObstaclesTask {
        obstacles,
        locomotion,
    });
    Ok(Loaded { task, notes })
}

struct ObstaclesTask {
    obstacles: Obstacles,
    locomotion: Locomotion,
}

impl Task for ObstaclesTask {
    fn settings(&self) -> toml::Table {
        with_weights(&self.obstacles, self.locomotion.matcher.database.weights)
    }

    fn with_choices(&self, config: &Config) -> Result<Box<dyn Task>, ConfigError> {
        let (obstacles, _) = split::<Obstacles>(config)?;
        let locomotion = self
            .locomotion
            .with_task(LocomotionTask::Obstacles(obstacles));
        Ok(Box::new(ObstaclesTask {
            obstacles,
            locomotion,
        }))
    }

    fn fingerprint(&self) -> Fingerprint {
        self.locomotion.matcher.database.fingerprint.into()
    }

    fn describe(&self) -> String {
        self.locomotion.describe()
    }

    fn open(&self, device: &Device, ranks: &Ranks, envs: usize, seed: u32) -> Result<EnvBatch> {
        self.locomotion.open(device, ranks, envs, seed)
    }

    fn evaluate(&self, policy: &Policy, episodes: usize) -> Result<Evaluation> {
        self.locomotion.evaluate(policy, episodes)
    }

    fn sentence(&self, found: &Evaluation) -> String {
        format!(
            "{:.1} % of {} episodes on the hardest level reach the target, in {:.2} s on average",
            100.0 * found.success,
            found.episodes,
            found.measure("time_to_target_mean_s")
        )
    }

    fn report(&self, policy: &Policy, wanted: &EvalOptions) -> Result<EvalReport> {
        let all = self.locomotion.levels(policy, wanted.episodes)?;
        let hardest = &all[all.len() - 1];
        let mut report = self.locomotion.report(policy, hardest, wanted)?;
        report.text = format!("{}\n{}", levels(&all), report.text);
        report.json["levels"] = levels_json(&all);
        Ok(report)
    }

    #[cfg(feature = "report")]
    fn figures(&self, run: &RunDir, rows: &[UpdateMetrics]) -> Result<Vec<PathBuf>> {
        figures::obstacles::draw(run, rows, &self.locomotion)
    }

    fn locomotion(&self) -> Option<&Locomotion> {
        Some(&self.locomotion)
    }
}

/// What is compared of the variants below.
const MEASURES: &[Measure] = &[
    Measure::percent("collision %", "collision"),
    Measure::percent("loiter %", "loiter"),
    Measure::seconds("time s", "time_to_target_mean_s"),
    Measure::seconds("episode s", "episode_length_mean_s"),
];

/// What each part of the method is worth (paper, section 6, figure 6): the whole method, then each
/// without one part.
const PARTS: Ablation = Ablation {
    name: "obstacles",
    about: "The task with obstacles: the method whole, without its hit reward, without its curriculum",
    folder: "runs/ablation",
    measures: MEASURES,
    rates: &["collision"],
    variants: &[
        Variant {
            name: "full",
            changes: toml::Table::new,
        },
        Variant {
            name: "no-hit-reward",
            changes: || toml::toml! { hit_reward = 0.0 },
        },
        Variant {
            name: "no-curriculum",
            changes: || toml::toml! { curriculum = false },
        },
    ],
};

/// The paper's reward (its equation 4) as printed, then in other readings.
const REWARDS: Ablation = Ablation {
    name: "reward",
    about: "The task with obstacles: the paper's reward as printed, and other readings of it",
    folder: "runs/reward",
    measures: MEASURES,
    rates: &["collision"],
    variants: &[
        Variant {
            name: "printed",
            changes: || table(&Obstacles::PRINTED),
        },
        Variant {
            name: "arrival-continues",
            changes: || {
                table(&Obstacles {
                    success_is_terminal: false,
                    ..Obstacles::PRINTED
                })
            },
        },
        Variant {
            name: "and-targets-clear",
            changes: || {
                table(&Obstacles {
                    success_is_terminal: false,
                    target_clear: true,
                    ..Obstacles::PRINTED
                })
            },
        },
        Variant {
            name: "and-hits-penalised",
            changes: || table(&Obstacles::PAPER),
        },
        Variant {
            name: "that-but-terminal",
            changes: || {
                table(&Obstacles {
                    success_is_terminal: true,
                    ..Obstacles::PAPER
                })
            },
        },
        Variant {
            name: "progress",
            changes: || table(&Obstacles::FAST),
        },
    ],
};
