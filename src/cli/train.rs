//! `footwork train`.

use super::Usage;
use anyhow::Result;
use clap::{Args, Subcommand};
use footwork::gpu::{Choice, Device, Gpu};
use footwork::motion::database::Database;
use footwork::viewer::window;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::config::{Config, Kind, Preset};
use footwork::train::data;
use footwork::train::run_dir::{Folder, Summary};
use footwork::train::trainer::{Watch, train};
use footwork::env::locomotion::Task;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Subcommand)]
pub enum Train {
    /// Reach a target on an empty plane
    Plane(Options),
    /// Reach a target among 100 moving obstacles
    Obstacles(Obstacles),
}

#[derive(Args)]
pub struct Obstacles {
    #[command(flatten)]
    options: Options,
    /// Do not reward asking for positions outside obstacles
    #[arg(long, conflicts_with = "resume")]
    no_hit_reward: bool,
    /// Train on the hardest level from the start
    #[arg(long, conflicts_with = "resume")]
    no_curriculum: bool,
    /// Reward for reaching the target [default: 10]
    #[arg(
        long,
        value_name = "REWARD",
        conflicts_with = "resume",
        allow_negative_numbers = true
    )]
    success_bonus: Option<f32>,
}

#[derive(Args)]
pub struct Options {
    #[command(flatten)]
    choices: Choices,
    /// Stop after this time in all, like 90s, 5m or 1h30m; looked at after each update
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration, allow_hyphen_values = true)]
    max_time: Option<std::time::Duration>,
    /// Stop at this share of successful evaluation episodes, like 0.99
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    stop_success: Option<f64>,
    /// The same seed on the same device gives the same result, bit for bit [default: 1]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    seed: Option<u32>,
    /// Open a window on all environments; closing it does not stop the training
    #[arg(long)]
    watch: bool,
    /// The run's folder [default: runs/TASK-N]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Go on with a run as if it had never stopped
    #[arg(long, value_name = "DIR", conflicts_with_all = ["data", "device", "envs", "seed", "preset", "config", "out"])]
    resume: Option<PathBuf>,
}

/// What every kind of training may be asked for.
#[derive(Args)]
pub struct Choices {
    /// A folder of BVH files, one BVH file, or a database file [default: synthetic motion]
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
    /// Where to run: a real GPU if there is one, else the CPU [default: auto]
    #[arg(long, value_enum)]
    device: Option<Choice>,
    /// Environments stepped together
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    envs: Option<usize>,
    /// Stop after this many environment steps in all, resumptions included [default: 1000000 on
    /// the plane, 3000000 among obstacles]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    steps: Option<u64>,
    /// `fast` as measured here, or `paper` with the paper's settings [default: fast]
    #[arg(long, value_enum)]
    preset: Option<Preset>,
    /// A TOML file that changes keys of the preset: see any run's config.toml
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
}

impl Train {
    pub fn run(self) -> Result<()> {
        match self {
            Train::Plane(options) => options.run(Kind::Plane, |_| {}),
            Train::Obstacles(obstacles) => {
                let change = |task: &mut Task| {
                    if let Task::Obstacles(task) = task {
                        if obstacles.no_hit_reward {
                            task.hit_reward = 0.0;
                        }
                        task.curriculum &= !obstacles.no_curriculum;
                        task.success_bonus = obstacles.success_bonus.unwrap_or(task.success_bonus);
                    }
                };
                obstacles.options.run(Kind::Obstacles, change)
            }
        }
    }
}

impl Options {
    /// `change` applies the options of one task alone.
    fn run(&self, kind: Kind, change: impl FnOnce(&mut Task)) -> Result<()> {
        let interrupted = on_interrupt()?;
        let resumed = self.resume.as_deref().map(Folder::open).transpose()?;
        let mut config = match &resumed {
            Some(folder) => self.limited(same_task(folder, kind)?),
            None => self.fresh(kind)?,
        };
        if resumed.is_none() {
            change(&mut config.task);
        }
        let (device, database) = open(&mut config)?;
        let checkpoint = match &resumed {
            Some(folder) => Some(Checkpoint::load_for(
                &folder.last()?,
                &config.task,
                database.fingerprint,
            )?),
            None => None,
        };
        if let Some(checkpoint) = &checkpoint {
            checkpoint.check_same(&config)?;
            if checkpoint.header.steps >= config.steps {
                let done = checkpoint.header.steps;
                let why = format!("the run has done {done} steps: give a larger --steps");
                return Err(Usage(why).into());
            }
        }
        let folder = match resumed {
            Some(folder) => folder,
            None => Folder::create(self.out.as_deref(), config.task.name())?,
        };
        let written = folder.write_config(&config);
        written.inspect_err(|_| folder.remove_empty())?;
        introduce(&config, &folder, &database, &device);
        let run = |watch: Option<&Watch>| {
            let folder = &folder;
            train(
                &config,
                folder,
                &database,
                &device,
                checkpoint,
                interrupted,
                watch,
            )
        };
        let summary = match self.watch {
            false => run(None)?,
            true => watched(&device, &database, &config, |watch| run(Some(watch)))?,
        };
        println!(
            "{} steps in {:.1} s ({:.0} steps/s), stopped by {}: {:.1} % of 1000 episodes{} reach the target, in {:.2} s on average",
            summary.steps,
            summary.wall_s,
            summary.steps_per_s,
            summary.stopped_by,
            100.0 * summary.success,
            summary.level.map_or("", |_| " on the hardest level"),
            summary.time_to_target_mean_s,
        );
        println!(
            "see {0}/learning_curve.png, judge with `footwork eval {0}`",
            folder.path().display()
        );
        if summary.stopped_by == "interrupt" {
            println!(
                "go on with `footwork train {} --resume {}`",
                config.task.name(),
                folder.path().display()
            );
        }
        Ok(())
    }

    fn fresh(&self, kind: Kind) -> Result<Config> {
        let mut config = self.choices.config(kind)?;
        config.seed = self.seed.unwrap_or(config.seed);
        Ok(self.limited(config))
    }

    /// With what a resumed run may change too: when to stop.
    fn limited(&self, mut config: Config) -> Config {
        config.steps = self.choices.steps.unwrap_or(config.steps);
        config.max_time_s = self
            .max_time
            .map(|time| time.as_secs_f64())
            .or(config.max_time_s);
        config.stop_success = self.stop_success.or(config.stop_success);
        config
    }
}

impl Choices {
    /// Preset, changed by the file, changed by the options.
    pub fn config(&self, kind: Kind) -> Result<Config> {
        let preset = self.preset.unwrap_or_default();
        let mut config = match &self.config {
            Some(path) => Config::from_file(path, kind, preset)?,
            None => Config::preset(kind, preset),
        };
        if self.preset.is_some_and(|asked| asked != config.preset) {
            return Err(Usage(format!(
                "--preset {preset:?} and the configuration's preset {:?} differ: drop one",
                config.preset
            ))
            .into());
        }
        config.device = self.device.unwrap_or(config.device);
        config.ppo.envs = self.envs.unwrap_or(config.ppo.envs);
        config.steps = self.steps.unwrap_or(config.steps);
        if let Some(data) = self.data.clone().or(config.data.take()) {
            // A run must find its data again from any folder.
            config.data = Some(std::path::absolute(&data).unwrap_or(data));
        }
        Ok(config)
    }
}

/// Checks a configuration and opens its device and data; what they turn out to be goes into it.
pub fn open(config: &mut Config) -> Result<(Device, Arc<Database>)> {
    config.check()?;
    let device = Device::open(config.device)?;
    let observations = config.ppo.batch() * config.task.width();
    device
        .holds("observations of an update", observations)
        .map_err(|error| anyhow::anyhow!("{error}: use a smaller --envs or ppo.horizon"))?;
    // A resumed run must not change its device because another has appeared.
    config.device = device.choice();
    let (database, notes) = data::load(config.data.as_deref(), config.weights)?;
    for note in notes {
        eprintln!("note: {note}");
    }
    if config.weights != database.weights {
        eprintln!("note: the database was made with other weights than asked for; its own hold");
        config.weights = database.weights;
    }
    Ok((device, Arc::new(database)))
}

/// The configuration of a run that goes on with the task it has.
fn same_task(folder: &Folder, kind: Kind) -> Result<Config> {
    let config = folder.read_config()?;
    let asked = match kind {
        Kind::Plane => "plane",
        Kind::Obstacles => "obstacles",
    };
    let found = config.task.name();
    if found != asked {
        return Err(Usage(format!(
            "{} is a run of the task `{found}`, not of `{asked}`: go on with `footwork train {found} --resume {0}`",
            folder.path().display()
        ))
        .into());
    }
    Ok(config)
}

fn introduce(config: &Config, folder: &Folder, database: &Database, device: &Device) {
    eprintln!(
        "training `{}` on {}: {} environments, {:.1} minutes of motion, {} candidates; run folder {}",
        config.task.name(),
        device.name(),
        config.ppo.envs,
        database.minutes(),
        database.candidates.len(),
        folder.path().display(),
    );
}

/// Trains on a thread of its own while this one, as windows want it, shows the worlds.
fn watched(
    device: &Device,
    database: &Arc<Database>,
    config: &Config,
    train: impl FnOnce(&Watch) -> Result<Summary> + Send,
) -> Result<Summary> {
    // Training on the CPU is drawn on what there is to draw on.
    let gpu = match device {
        Device::Gpu(gpu) => (**gpu).clone(),
        Device::Cpu => Gpu::drawing()?,
    };
    let (watch, over) = (Arc::new(Watch::default()), Arc::new(AtomicBool::new(false)));
    std::thread::scope(|scope| {
        let training = scope.spawn(|| {
            let summary = train(&watch);
            over.store(true, Ordering::Relaxed);
            summary
        });
        let shown = window::watch(
            &gpu,
            database.clone(),
            config.task,
            config.ppo.envs,
            watch.clone(),
            over.clone(),
        );
        if let Err(error) = shown {
            eprintln!("note: the training goes on unwatched: {error:#}");
        }
        training
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// The first Ctrl-C asks the run to save and stop, the second ends the program.
pub fn on_interrupt() -> Result<&'static AtomicBool> {
    static INTERRUPTED: AtomicBool = AtomicBool::new(false);
    ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        eprintln!("\nstopping after this update; Ctrl-C again to stop at once");
    })?;
    Ok(&INTERRUPTED)
}
