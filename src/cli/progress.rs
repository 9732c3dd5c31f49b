//! A live line on a terminal, a plain line now and then otherwise.

use super::say::tell;
use footwork::train::config::Config;
use footwork::train::metrics::UpdateMetrics;
use footwork::train::observer::Observer;
use footwork::train::state::RecentMeans;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Between two plain lines.
const PLAIN: Duration = Duration::from_secs(5);

pub struct Progress {
    /// What the lines begin with, where there are several.
    name: Option<String>,
    bar: Option<ProgressBar>,
    spoken: Option<Instant>,
    steps: u64,
    max_time_s: Option<f64>,
}

impl Progress {
    /// The progress of a training.
    pub fn new(config: &Config) -> Self {
        let mut progress = Progress::with(None, bar());
        progress.limit(config);
        progress
    }

    /// The progress of trainings at once, which are told apart by their names if they are several.
    pub fn several(count: usize) -> Vec<Self> {
        let bars = MultiProgress::new();
        let name = (count > 1).then(String::new);
        let progress = |_| Progress::with(name.clone(), bar().map(|bar| bars.add(bar)));
        (0..count).map(progress).collect()
    }

    fn with(name: Option<String>, bar: Option<ProgressBar>) -> Self {
        Progress {
            name,
            bar,
            spoken: None,
            steps: 0,
            max_time_s: None,
        }
    }

    /// Takes over when a training will end.
    fn limit(&mut self, config: &Config) {
        (self.steps, self.max_time_s) = (config.steps, config.max_time_s);
        if let Some(bar) = &self.bar {
            bar.set_length(config.steps);
        }
    }
}

impl Observer for Progress {
    fn begins(&mut self, name: &str, config: &Config) {
        if let Some(own) = &mut self.name {
            *own = format!("{name}: ");
        }
        self.limit(config);
    }

    fn noted(&mut self, note: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| tell!("{note}")),
            None => tell!("{note}"),
        }
    }

    fn updated(&mut self, row: &UpdateMetrics, recent: RecentMeans) {
        let rate = row.steps as f64 / row.wall_s.max(1e-9);
        let by_steps = self.steps.saturating_sub(row.steps) as f64 / rate.max(1e-9);
        let left = self
            .max_time_s
            .map_or(by_steps, |max| by_steps.min(max - row.wall_s))
            .max(0.0);
        let line = format!(
            "{}{:>9} steps{}  success {:>5.1} %  return {:>7.1}{}  {:>7.0} steps/s{}  {} gone, at most {} left",
            self.name.as_deref().unwrap_or_default(),
            row.steps,
            row.level
                .map_or(String::new(), |level| format!("  level {level}")),
            100.0 * recent.success,
            recent.episode_return,
            style(row),
            row.steps_per_s,
            communication(row),
            clock(row.wall_s),
            clock(left),
        );
        match &self.bar {
            Some(bar) => {
                bar.set_position(row.steps.min(self.steps));
                bar.set_message(line);
            }
            None if self.spoken.is_none_or(|at| at.elapsed() >= PLAIN) => {
                self.spoken = Some(Instant::now());
                tell!("{line}");
            }
            None => {}
        }
    }
}

/// The style reward of a step, the task's weight if a rule finds it, how many of the agents' windows and of the recorded
/// ones the discriminator recognised if it learns, and falls; nothing where there is no style.
fn style(row: &UpdateMetrics) -> String {
    let Some(reward) = row.rate("style_reward") else {
        return String::new();
    };
    let percent = |name: &str| row.rate(name).map(|share| 100.0 * share);
    let weight = row.rate("task_weight");
    let weight = weight.map_or(String::new(), |weight| format!("  task weight {weight:.2}"));
    let recognised = percent("agent_accuracy").zip(percent("recorded_accuracy"));
    let recognised = recognised.map_or(String::new(), |(agents, recorded)| {
        format!("  recognised {agents:.0} / {recorded:.0} %")
    });
    let fall = percent("fall").unwrap_or(0.0);
    format!("  style {reward:.2}{weight}{recognised}  fall {fall:>3.0} %")
}

/// The share of an update's time in which ranks talk to each other, if there are several.
fn communication(row: &UpdateMetrics) -> String {
    let all = row.policy_s + row.env_s + row.learn_s;
    let share = row.communication_s.map(|seconds| seconds / all.max(1e-9));
    share.map_or(String::new(), |share| {
        format!("  communication {:.0} %", 100.0 * share)
    })
}

/// A bar, where somebody looks on.
fn bar() -> Option<ProgressBar> {
    std::io::stderr().is_terminal().then(|| {
        let bar = ProgressBar::no_length();
        if let Ok(style) = ProgressStyle::with_template("{bar:24} {msg}") {
            bar.set_style(style);
        }
        bar
    })
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn clock(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    match seconds {
        0..3600 => format!("{}:{:02}", seconds / 60, seconds % 60),
        _ => format!(
            "{}:{:02}:{:02}",
            seconds / 3600,
            seconds / 60 % 60,
            seconds % 60
        ),
    }
}
