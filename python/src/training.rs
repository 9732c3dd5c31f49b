//! Trainings, on a thread of their own: Python's stays free to hear of signals and of the updates.

use crate::errors::raised;
use crate::opened::Opened;
use crate::pool;
use crate::settings::{self, Choices};
use anyhow::{Result, bail};
use footwork::gpu::{Choice, Device};
use footwork::ranks::Ranks;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::config::Config;
use footwork::train::metrics::UpdateMetrics;
use footwork::train::observer::Observer;
use footwork::train::run_dir::{RunDir, Summary};
use footwork::train::state::RecentMeans;
use footwork::train::tasks::{config_of, find};
use footwork::train::trainer::{self, Training};
use pyo3::exceptions::{PyKeyboardInterrupt, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long a signal may go unheard.
const LISTEN: Duration = Duration::from_millis(50);

/// What a training tells.
enum Message {
    Note(String),
    /// An update's metrics as JSON.
    Update(String),
}

/// Passes on what a training tells, for as long as somebody listens.
struct Reporter(Sender<Message>);

impl Observer for Reporter {
    fn noted(&mut self, note: &str) {
        let _ = self.0.send(Message::Note(note.to_string()));
    }

    fn updated(&mut self, row: &UpdateMetrics, _: RecentMeans) {
        if let Ok(text) = serde_json::to_string(row) {
            let _ = self.0.send(Message::Update(text));
        }
    }
}

/// When to stop, and where to write.
struct Limits {
    num_envs: Option<usize>,
    steps: Option<u64>,
    max_time_s: Option<f64>,
    stop_at_success: Option<f64>,
    out: Option<PathBuf>,
}

impl Limits {
    fn apply(&self, config: &mut Config) {
        config.ppo.envs = self.num_envs.unwrap_or(config.ppo.envs);
        config.steps = self.steps.unwrap_or(config.steps);
        config.max_time_s = self.max_time_s.or(config.max_time_s);
        config.stop_at_success = self.stop_at_success.or(config.stop_at_success);
    }
}

/// Trains a policy; see the package's `train`. Returns the run's folder and its summary as JSON.
#[pyfunction]
#[pyo3(signature = (task, out=None, steps=None, seed=None, data=None, num_envs=None, preset="fast", skills=None,
    max_time_s=None, stop_at_success=None, resume=None, on_note=None, on_update=None, settings=None))]
#[expect(clippy::too_many_arguments, reason = "Python's keyword arguments")]
pub fn train(
    py: Python<'_>,
    task: &str,
    out: Option<PathBuf>,
    steps: Option<u64>,
    seed: Option<&Bound<PyAny>>,
    data: Option<PathBuf>,
    num_envs: Option<usize>,
    preset: &str,
    skills: Option<PathBuf>,
    max_time_s: Option<f64>,
    stop_at_success: Option<f64>,
    resume: Option<PathBuf>,
    on_note: Option<&Bound<PyAny>>,
    on_update: Option<&Bound<PyAny>>,
    settings: Option<&Bound<PyDict>>,
) -> PyResult<(PathBuf, String)> {
    let entry = find(task).map_err(|error| raised(error.into()))?;
    let limits = Limits {
        num_envs,
        steps,
        max_time_s,
        stop_at_success,
        out,
    };
    let decided = limits.out.is_some()
        || num_envs.is_some()
        || seed.is_some()
        || data.is_some()
        || skills.is_some();
    let config = match &resume {
        Some(_) if decided || settings.is_some_and(|settings| !settings.is_empty()) => {
            return Err(PyTypeError::new_err(
                "a run that is resumed goes on as it was begun: only steps, max_time_s and stop_at_success may change",
            ));
        }
        Some(_) => None,
        None => {
            let choices = Choices {
                seed: seed.map_or(Ok(1), settings::seed)?,
                data,
                preset,
                skills,
                settings,
            };
            Some(choices.config(entry)?)
        }
    };
    let (sender, receiver) = mpsc::channel();
    let interrupted = Arc::new(AtomicBool::new(false));
    let heard = interrupted.clone();
    let task = task.to_string();
    let worker = std::thread::Builder::new()
        .name("footwork-train".to_string())
        .spawn(move || {
            pool::install(|| {
                run(
                    &task,
                    config,
                    resume.as_deref(),
                    &limits,
                    &heard,
                    Reporter(sender),
                )
            })
        })?;
    listen(py, &Mutex::new(receiver), &interrupted, on_note, on_update)?;
    let (path, summary) = py.detach(|| joined(worker)).map_err(raised)?;
    let summary = serde_json::to_string(&summary).map_err(|error| raised(error.into()))?;
    Ok((path, summary))
}

fn joined(worker: JoinHandle<Result<(PathBuf, Summary)>>) -> Result<(PathBuf, Summary)> {
    match worker.join() {
        Ok(outcome) => outcome,
        Err(_) => bail!("the training has failed for a reason of its own: standard error has more"),
    }
}

/// Passes on what a training tells until it ends. The first Ctrl-C lets it save and stop; the second does not wait.
fn listen(
    py: Python<'_>,
    receiver: &Mutex<Receiver<Message>>,
    interrupted: &AtomicBool,
    on_note: Option<&Bound<PyAny>>,
    on_update: Option<&Bound<PyAny>>,
) -> PyResult<()> {
    let mut failed = None;
    loop {
        let message = py.detach(|| {
            let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
            receiver.recv_timeout(LISTEN)
        });
        let told = match message {
            Err(RecvTimeoutError::Disconnected) => return failed.map_or(Ok(()), Err),
            Err(RecvTimeoutError::Timeout) => Ok(()),
            Ok(_) if failed.is_some() => Ok(()),
            Ok(Message::Note(note)) => {
                on_note.map_or(Ok(()), |hear| hear.call1((note,)).map(|_| ()))
            }
            Ok(Message::Update(row)) => {
                on_update.map_or(Ok(()), |hear| hear.call1((row,)).map(|_| ()))
            }
        };
        if let Err(error) = told.and_then(|()| py.check_signals()) {
            let again = interrupted.swap(true, Ordering::Relaxed);
            match error.is_instance_of::<PyKeyboardInterrupt>(py) {
                true if again => return Err(error),
                true => {}
                false => failed = failed.or(Some(error)),
            }
        }
    }
}

/// Runs a training to its end: a new one with a configuration, or one that goes on.
fn run(
    task: &str,
    config: Option<Config>,
    resume: Option<&Path>,
    limits: &Limits,
    interrupted: &AtomicBool,
    mut reporter: Reporter,
) -> Result<(PathBuf, Summary)> {
    let resumed = resume.map(|run| RunDir::open(run)?.claimed()).transpose()?;
    let mut config = match (&resumed, config) {
        (Some(run), _) => same(run, task)?,
        (None, Some(config)) => config,
        (None, None) => unreachable!("a new run has a configuration"),
    };
    limits.apply(&mut config);
    let opened = Opened::new(&mut config)?;
    opened.notes.iter().for_each(|note| reporter.noted(note));
    let (run, from) = match resumed {
        Some(run) => {
            let from = go_on(&run, &config, &opened)?;
            (run, Some(from))
        }
        None => (RunDir::create(limits.out.as_deref(), task)?, None),
    };
    let training = Training {
        config: &config,
        task: &*opened.task,
        run: &run,
        device: &Device::Cpu,
        ranks: &Ranks::alone(),
        start: None,
    };
    let summary = trainer::train(training, from, interrupted, &mut reporter)?;
    Ok((run.path().to_path_buf(), summary))
}

/// The configuration of a run of the same task.
fn same(run: &RunDir, task: &str) -> Result<Config> {
    let config = config_of(run)?;
    let (found, path) = (&config.task.name, run.path().display());
    if found != task {
        bail!("{path} is a run of the task `{found}`, not of `{task}`");
    }
    Ok(Config {
        device: Choice::Cpu,
        ..config
    })
}

/// The checkpoint that a run goes on from.
fn go_on(run: &RunDir, config: &Config, opened: &Opened) -> Result<Checkpoint> {
    let (name, fingerprint) = (&config.task.name, opened.task.fingerprint());
    let checkpoint = Checkpoint::load_for(&run.last()?, name, &opened.spec, fingerprint)?;
    checkpoint.check_same(config)?;
    let done = checkpoint.header.steps;
    if done >= config.steps {
        bail!("the run has done {done} steps: give a larger `steps`");
    }
    Ok(checkpoint)
}
