//! `footwork train`.

use super::Usage;
#[cfg(feature = "viewer")]
use super::filming::Filming;
use super::opened::{Opened, Shared};
use super::progress::Progress;
use super::run::{Moved, locate};
use super::say::{say, tell};
use super::setting::{Setting, Settings};
#[cfg(feature = "viewer")]
use super::watch::watched;
use anyhow::Result;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use footwork::gpu::Choice;
use footwork::ranks::Ranks;
use footwork::rl::ase::LowLevel;
use footwork::rl::task_weight::WeightRule;
use footwork::train::agreement;
use footwork::train::calibration::Configure;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::config::{Base, Config, Preset};
use footwork::train::metrics;
use footwork::train::run_dir::{RunDir, Summary, checkpoint_of};
use footwork::train::task::TaskEntry;
use footwork::train::tasks::{REGISTRY, config_of, find};
use footwork::train::trainer::{Training, train};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Args)]
pub struct Train {
    /// What to learn
    #[arg(value_parser = names())]
    task: String,
    #[command(flatten)]
    choices: Choices,
    #[command(flatten)]
    settings: Settings,
    /// Stop after this time in all, like 90s, 5m or 1h30m; looked at after each update
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration, allow_hyphen_values = true)]
    max_time: Option<std::time::Duration>,
    /// Stop at this fraction of successful evaluation episodes, like 0.99
    #[arg(long, value_name = "FRACTION", allow_negative_numbers = true)]
    stop_at_success: Option<f64>,
    /// The same seed on the same device gives the same result, bit for bit [default: 1]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    seed: Option<u32>,
    /// Open a window on all environments; closing it does not stop the training
    #[cfg(feature = "viewer")]
    #[arg(long)]
    watch: bool,
    /// The run's folder [default: runs/TASK-N]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Go on with a run as if it had never stopped: its folder, or one of its checkpoints
    #[arg(long, value_name = "RUN", conflicts_with_all = ["device", "envs", "seed", "preset", "config", "set", "out", "from"])]
    resume: Option<PathBuf>,
    /// Do not reward requests of positions outside obstacles: --set task.hit_reward=0
    #[arg(long, conflicts_with = "resume", help_heading = "Among obstacles")]
    no_hit_reward: bool,
    /// Train on the hardest level from the start: --set task.curriculum=false
    #[arg(long, conflicts_with = "resume", help_heading = "Among obstacles")]
    no_curriculum: bool,
    /// Reward for reaching the target: --set task.success_bonus=REWARD
    #[arg(
        long,
        value_name = "REWARD",
        conflicts_with = "resume",
        allow_negative_numbers = true,
        help_heading = "Among obstacles"
    )]
    success_bonus: Option<f64>,
    /// How the task's reward weighs beside the style's: --set task_weight.rule=RULE
    #[arg(
        long,
        value_name = "RULE",
        value_enum,
        conflicts_with = "resume",
        help_heading = "In the style of recordings"
    )]
    task_weight: Option<WeightRule>,
    /// How latents come to mean movements, for `skills`: --set ase.low_level=WAY
    #[arg(
        long,
        value_name = "WAY",
        value_enum,
        conflicts_with = "resume",
        help_heading = "In the style of recordings"
    )]
    low_level: Option<LowLevel>,
}

/// What every kind of training may be asked for.
#[derive(Args, Clone)]
pub struct Choices {
    /// A folder of BVH files, one BVH file, or a database file; for simulated bodies also DeepMimic's
    /// recordings, or a motion list in TOML [default: synthetic motion]
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
    /// Folder of the files that a motion list names [default: the list's own]
    #[arg(long, value_name = "DIR")]
    data_folder: Option<PathBuf>,
    /// Bring recordings whose feet stand off the ground to it, for simulated bodies
    #[arg(long)]
    ground: bool,
    /// A TOML file that names the joints of roles that are not found in recordings, for simulated bodies
    #[arg(long, value_name = "FILE")]
    roles: Option<PathBuf>,
    /// Metres of one unit of BVH files, for simulated bodies [default: found from the length of the legs]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    unit: Option<f32>,
    /// Learn to steer the skills of a low level, for `punch`, `joystick` and `box`: a run of `skills`, or one of its
    /// checkpoints; with --resume, where it is now
    #[arg(long, value_name = "RUN")]
    pub skills: Option<PathBuf>,
    /// Begin with what another run of a simulated body has learned: its folder, or one of its checkpoints
    #[arg(long, value_name = "RUN")]
    from: Option<PathBuf>,
    /// Where to run: `auto` is the quicker of the CPU and a real GPU, as measured [default: auto]
    #[arg(long, value_enum)]
    pub device: Option<Choice>,
    /// Environments stepped together, or `auto`: as many as make training quicker, as measured. In more than
    /// the preset's, rollouts, minibatches and the learning rate follow
    #[arg(long, value_name = "N|auto", value_parser = envs, allow_negative_numbers = true)]
    envs: Option<Envs>,
    /// Stop after this many environment steps in all, resumptions included [default: the preset's]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    steps: Option<u64>,
    /// `fast` as measured here, or `paper` with the paper's settings [default: fast]
    #[arg(long, value_enum)]
    preset: Option<Preset>,
    /// A TOML file that changes keys of the preset: see any run's config.toml
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
}

/// How many environments are stepped together.
#[derive(Clone, Copy)]
enum Envs {
    /// As many as make training quicker.
    Auto,
    Number(usize),
}

fn envs(text: &str) -> Result<Envs, String> {
    let number = || match text.parse() {
        Ok(number) => Ok(Envs::Number(number)),
        Err(error) => Err(format!("{error}; give a number or `auto`")),
    };
    match text {
        "auto" => Ok(Envs::Auto),
        _ => number(),
    }
}

/// The names of all tasks.
pub fn names() -> PossibleValuesParser {
    let names = REGISTRY.iter();
    PossibleValuesParser::new(names.map(|entry| PossibleValue::new(entry.name).help(entry.about)))
}

impl Train {
    /// Trains, or does this rank's share of it.
    pub fn run(self, ranks: &Ranks) -> Result<()> {
        let entry = find(&self.task)?;
        let interrupted = on_interrupt()?;
        let resumed = self.resume.as_deref();
        let resumed = resumed.map(|run| claim(run, ranks)).transpose()?;
        let opened = match &resumed {
            Some((run, _)) => Opened::resumed(entry, ranks, self.same(run, entry)?)?,
            None => {
                let configure = |envs| self.fresh(entry, envs);
                self.choices
                    .open(entry, ranks, Shared::Environments, &configure)?
            }
        };
        let config = &opened.config;
        let start = self.choices.start()?;
        let from = match &resumed {
            Some((run, path)) => Some(go_on(run, path, &opened)?),
            None => None,
        };
        let checkpoint = from.as_ref().or(start.as_ref());
        agreement::check(ranks, config, &*opened.task, checkpoint)?;
        let run = match resumed {
            Some((run, _)) => run,
            None => shared_folder(ranks, || RunDir::create(self.out.as_deref(), entry.name))?,
        };
        let (task, device) = (&*opened.task, &opened.device);
        let several = match ranks.count() {
            1 => String::new(),
            count => format!(" shared by {count} ranks"),
        };
        tell!(
            "training `{}` on {}: {} environments{several}, {}; run folder {}",
            entry.name,
            device.name(),
            config.ppo.envs,
            task.describe(),
            run.path().display(),
        );
        let training = Training {
            config,
            task,
            run: &run,
            device,
            ranks,
            start: start.as_ref(),
        };
        let summary = self.train(training, from, interrupted)?;
        if ranks.is_first() {
            tell(training, &summary);
        }
        Ok(())
    }

    fn train(
        &self,
        training: Training,
        from: Option<Checkpoint>,
        interrupted: &AtomicBool,
    ) -> Result<Summary> {
        if !training.ranks.is_first() {
            return train(training, from, interrupted, &mut ());
        }
        let progress = Progress::new(training.config);
        #[cfg(feature = "viewer")]
        if self.watch {
            return watched(training, from, interrupted, progress);
        }
        #[cfg(feature = "viewer")]
        let mut observer = Filming::new(&training, progress);
        #[cfg(not(feature = "viewer"))]
        let mut observer = progress;
        train(training, from, interrupted, &mut observer)
    }

    /// The configuration of a new run in so many environments: see [`Choices::config`].
    fn fresh(&self, entry: &TaskEntry, envs: Option<usize>) -> Result<Config> {
        let mut config = self.choices.config(entry, envs, &self.settings.all)?;
        config.seed = self.seed.unwrap_or(config.seed);
        if self.no_hit_reward {
            config.set("task.hit_reward", 0.0.into())?;
        }
        if self.no_curriculum {
            config.set("task.curriculum", false.into())?;
        }
        match (&mut config.ase, self.low_level) {
            (Some(ase), Some(low_level)) => ase.low_level = low_level,
            (None, Some(_)) => {
                let why = format!(
                    "--low-level is for `skills`: `{}` has no latents",
                    entry.name
                );
                return Err(Usage(why).into());
            }
            (_, None) => {}
        }
        config.task_weight.rule = self.task_weight.unwrap_or(config.task_weight.rule);
        if let Some(bonus) = self.success_bonus {
            config.set("task.success_bonus", bonus.into())?;
        }
        self.limit(&mut config);
        Ok(config)
    }

    /// The configuration of a run that goes on, whose data may have moved.
    fn same(&self, run: &RunDir, entry: &TaskEntry) -> Result<Config> {
        let mut config = same_task(run, entry)?;
        let moved = Moved {
            data: self.choices.data.as_deref(),
            skills: self.choices.skills.as_deref(),
        };
        moved.find(&mut config)?;
        if let Some(folder) = &self.choices.data_folder {
            config.data_folder = Some(std::path::absolute(folder)?);
        }
        self.limit(&mut config);
        Ok(config)
    }

    /// Takes over what a resumed run may change too: when to stop.
    fn limit(&self, config: &mut Config) {
        config.steps = self.choices.steps.unwrap_or(config.steps);
        let max_time_s = self.max_time.map(|time| time.as_secs_f64());
        config.max_time_s = max_time_s.or(config.max_time_s);
        config.stop_at_success = self.stop_at_success.or(config.stop_at_success);
    }
}

impl Choices {
    /// The checkpoint that a new run begins with.
    pub fn start(&self) -> Result<Option<Checkpoint>> {
        let Some(run) = &self.from else {
            return Ok(None);
        };
        Ok(Some(Checkpoint::load(&checkpoint_of(run)?)?))
    }

    /// Whether the number of environments is to be found by measuring.
    pub fn grows(&self) -> bool {
        matches!(self.envs, Some(Envs::Auto))
    }

    /// Opens a new training, whose configuration is made for a number of environments.
    pub fn open(
        &self,
        entry: &TaskEntry,
        ranks: &Ranks,
        shared: Shared,
        configure: Configure,
    ) -> Result<Opened> {
        Opened::new(entry, ranks, shared, self.grows(), configure)
    }

    /// Preset, changed by the file, changed by `settings`, changed by the options. In so many environments if that is said
    /// here or by an option, to which the preset is scaled first.
    pub fn config(
        &self,
        entry: &TaskEntry,
        envs: Option<usize>,
        settings: &[Setting],
    ) -> Result<Config> {
        let given = match self.envs {
            Some(Envs::Number(envs)) => Some(envs),
            Some(Envs::Auto) | None => None,
        };
        let base = Base {
            preset: self.preset.unwrap_or_default(),
            steers: self.skills.is_some(),
            envs: envs.or(given),
        };
        let mut config = match &self.config {
            Some(path) => entry.config_from(path, base)?,
            None => entry.config_of(base),
        };
        if self.preset.is_some_and(|asked| asked != config.preset) {
            return Err(Usage(format!(
                "--preset {:?} and the configuration's preset {:?} differ: drop one",
                base.preset, config.preset
            ))
            .into());
        }
        for Setting { key, value } in settings {
            config.set(key, value.clone())?;
        }
        config.device = self.device.unwrap_or(config.device);
        config.ppo.envs = base.envs.unwrap_or(config.ppo.envs);
        config.steps = self.steps.unwrap_or(config.steps);
        if let Some(data) = self.data.clone().or(config.data.take()) {
            // A run must find its data again from any folder.
            config.data = Some(std::path::absolute(&data).unwrap_or(data));
        }
        if let Some(folder) = self.data_folder.clone().or(config.data_folder.take()) {
            config.data_folder = Some(std::path::absolute(&folder).unwrap_or(folder));
        }
        if let Some(skills) = self.skills.clone().or(config.skills.take()) {
            config.skills = Some(std::path::absolute(&skills).unwrap_or(skills));
        }
        config.ground |= self.ground;
        if let Some(roles) = self.roles.clone().or(config.roles.take()) {
            config.roles = Some(std::path::absolute(&roles).unwrap_or(roles));
        }
        config.unit_m = self.unit.or(config.unit_m);
        Ok(config)
    }
}

/// The configuration of a run that goes on with the task it has.
fn same_task(run: &RunDir, entry: &TaskEntry) -> Result<Config> {
    let config = config_of(run)?;
    let (found, wanted) = (&config.task.name, entry.name);
    if found != wanted {
        return Err(Usage(format!(
            "{} is a run of the task `{found}`, not of `{wanted}`: go on with `footwork train {found} --resume {0}`",
            run.path().display()
        ))
        .into());
    }
    Ok(config)
}

/// A run that nobody else writes, and the checkpoint that it goes on from.
fn claim(run: &Path, ranks: &Ranks) -> Result<(RunDir, PathBuf)> {
    let (run, checkpoint) = locate(run)?;
    Ok((shared_folder(ranks, || run.claimed())?, checkpoint))
}

/// A run's folder that the first rank makes or claims, for all.
fn shared_folder(ranks: &Ranks, first: impl FnOnce() -> Result<RunDir>) -> Result<RunDir> {
    if ranks.is_first() {
        let run = first()?;
        let path = run.path().as_os_str().as_encoded_bytes();
        ranks.broadcast(&mut path.to_vec());
        return Ok(run);
    }
    let mut path = Vec::new();
    ranks.broadcast(&mut path);
    Ok(RunDir::of_first(
        String::from_utf8_lossy(&path).as_ref().as_ref(),
    ))
}

/// The checkpoint that a run goes on from.
fn go_on(run: &RunDir, path: &Path, opened: &Opened) -> Result<Checkpoint> {
    let config = &opened.config;
    let (name, fingerprint) = (&config.task.name, opened.task.fingerprint());
    let checkpoint = Checkpoint::load_for(path, name, &opened.spec, fingerprint)?;
    checkpoint.check_same(config)?;
    let done = checkpoint.header.steps;
    if done >= config.steps {
        let why = format!("the run has done {done} steps: give a larger --steps");
        return Err(Usage(why).into());
    }
    let known = metrics::read(&run.metrics_path(), done)?;
    let wall_s = known.rows.last().map_or(0.0, |row| row.wall_s);
    if config.max_time_s.is_some_and(|max| wall_s >= max) {
        let why = format!(
            "the run has trained for {wall_s:.1} s, which is all that --max-time gave it: give a larger --max-time"
        );
        return Err(Usage(why).into());
    }
    Ok(checkpoint)
}

/// Says how a training ended.
fn tell(training: Training, summary: &Summary) {
    let (name, path) = (&training.config.task.name, training.run.path().display());
    say!(
        "{} steps in {:.1} s ({:.0} steps/s), stopped by {}: {}",
        summary.steps,
        summary.wall_s,
        summary.steps_per_s,
        summary.stopped_by,
        training.task.sentence(&summary.evaluation)
    );
    let figures = if cfg!(feature = "report") {
        format!("see {path}/learning_curve.png, ")
    } else {
        String::new()
    };
    say!("{figures}evaluate with `footwork eval {path}`");
    if summary.stopped_by == "interrupt" {
        say!("go on with `footwork train {name} --resume {path}`");
    }
}

/// The first Ctrl-C asks the run to save and stop, the second ends the program.
pub fn on_interrupt() -> Result<&'static AtomicBool> {
    static INTERRUPTED: AtomicBool = AtomicBool::new(false);
    ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        tell!("\nstopping after this update; Ctrl-C again to stop at once");
    })?;
    Ok(&INTERRUPTED)
}
