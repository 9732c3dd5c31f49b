//! Policies of every kind that nobody has trained, what they are given, and what our own pass makes of it.

use super::low_level;
use footwork::env::EnvSpec;
use footwork::env::humanoid::driver::DriverState;
use footwork::env::humanoid::task::play::play_by;
use footwork::env::locomotion::{CpuLocomotion, EnvConfig};
use footwork::export::{FORMATS, TrainedRun, export};
use footwork::gpu::{Array, Device};
use footwork::kernels::humanoid::action_targets::set_targets;
use footwork::kernels::rng::{gaussian, random4};
use footwork::motion::features::POSE_DIM;
use footwork::nn::layer::{Activation, Convolution};
use footwork::nn::{NetworkConfig, Policy, RunningMeanStd};
use footwork::rl::ase::{LowLevel, STEPS_PER_DECISION};
use footwork::train::body_episodes::BodyEpisodes;
use footwork::train::checkpoint::{Checkpoint, Header};
use footwork::train::config::{Config, Preset};
use footwork::train::locomotion::Locomotion;
use footwork::train::task::Task;
use footwork::train::tasks::find;
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

/// Steps that are recorded, and environments that are stepped.
const STEPS: usize = 12;
const ENVS: usize = 4;
/// Random observations besides.
const RANDOM_ROWS: usize = 32;

/// A run that nobody has trained.
pub struct UntrainedRun {
    pub name: String,
    pub config: Config,
    pub task: Box<dyn Task>,
    pub checkpoint: Checkpoint,
}

/// Numbers of inputs and outputs by name, each `[rows][..]`.
#[derive(Default)]
pub struct Recorded {
    pub inputs: BTreeMap<&'static str, Vec<f32>>,
    pub outputs: BTreeMap<&'static str, Vec<f32>>,
}

impl UntrainedRun {
    /// The bytes of the run in a format.
    pub fn exported(&self, format: &str) -> Vec<u8> {
        let run = TrainedRun {
            config: &self.config,
            task: &*self.task,
            checkpoint: &self.checkpoint,
        };
        let format = FORMATS.iter().find(|found| found.name == format);
        export(&run, format.expect("such a format")).expect("an exported run")
    }

    /// What our own pass does in some steps, and for random observations.
    pub fn recorded(&self) -> Recorded {
        match (self.task.locomotion(), self.task.body()) {
            (Some(locomotion), _) => self.locomotion(locomotion),
            (None, Some(body)) => self.body(&body),
            (None, None) => panic!("a task of no kind"),
        }
    }

    fn locomotion(&self, locomotion: &Locomotion) -> Recorded {
        let policy = &self.checkpoint.policy;
        let config = EnvConfig {
            task: locomotion.task,
            envs: ENVS,
            seed: 5,
            level: 9,
        };
        let mut envs = CpuLocomotion::new(locomotion.matcher.clone(), &config);
        let mut seen = noise(RANDOM_ROWS * policy.observation().dim(), 3);
        for _ in 0..STEPS {
            let observation = envs.observation();
            envs.step_without_reset(&policy.mean(&observation));
            seen.extend(observation);
        }
        let action = policy.mean(&seen);
        let normal = &locomotion.matcher.database.normalisation;
        let (mean, scale) = (&normal.mean[POSE_DIM..], &normal.scale[POSE_DIM..]);
        let metres = |(at, action): (usize, &f32)| action / scale[at % 12] + mean[at % 12];
        let trajectory = action.iter().enumerate().map(metres).collect();
        let spec = policy.observation();
        let rows = || seen.chunks_exact(spec.dim());
        let mut recorded = Recorded {
            inputs: [(
                "observation",
                rows().flat_map(|row| row[..spec.vector].to_vec()).collect(),
            )]
            .into(),
            outputs: [("trajectory", trajectory), ("action", action)].into(),
        };
        if let Some([height, width, channels]) = spec.grid {
            let cells = |row: &[f32]| {
                let maps = row[spec.vector..].to_vec();
                let order = (0..channels).flat_map(move |channel| {
                    (0..height * width).map(move |cell| cell * channels + channel)
                });
                order.map(move |at| maps[at]).collect::<Vec<f32>>()
            };
            recorded
                .inputs
                .insert("maps", rows().flat_map(cells).collect());
        }
        recorded
    }

    fn body(&self, body: &BodyEpisodes) -> Recorded {
        let mut recorded = Recorded::default();
        let mut envs = body.open_all(ENVS);
        let act = |seen: &[f32], state: &mut DriverState| self.act(seen, state, &mut recorded);
        play_by(&mut envs, act, DriverState::default(), |_, _, state| {
            state.steps < STEPS
        });
        let observation = envs.task().observation() + self.checkpoint.header.spec.style;
        let random = noise(RANDOM_ROWS * observation, 7);
        let mut state = DriverState::default();
        for _ in 0..2 {
            self.act(&random, &mut state, &mut recorded);
        }
        recorded
    }

    /// Lets the run's driver act, and records what it was given and did.
    fn act(&self, seen: &[f32], state: &mut DriverState, recorded: &mut Recorded) -> Vec<f32> {
        let body = self.task.body().expect("a body");
        let before = state.latents.clone();
        let decides = state.steps.is_multiple_of(STEPS_PER_DECISION);
        let action = self.task.driver(&self.checkpoint.policy).act(seen, state);
        let drives = self.drives();
        let scale = action_scale(&body, drives);
        let mut input =
            |name, values: &[f32]| recorded.inputs.entry(name).or_default().extend(values);
        input("observation", seen);
        if self.task.low_level().is_some() {
            let held = if before.is_empty() {
                vec![0.5; state.latents.len()]
            } else {
                before
            };
            input("latent", &held);
            input(
                "decide",
                &vec![f32::from(u8::from(decides)); action.len() / drives],
            );
        } else if body.latents.is_some() {
            input("latent", &state.latents);
        }
        let mut output =
            |name, values: &[f32]| recorded.outputs.entry(name).or_default().extend(values);
        output("action", &action);
        let mut targets = vec![0.0; drives];
        for action in action.chunks_exact(drives) {
            set_targets(action, &scale, &mut targets);
            output("targets", &targets);
        }
        if self.task.low_level().is_some() {
            output("next_latent", &state.latents);
        }
        action
    }

    /// Drives of one body.
    fn drives(&self) -> usize {
        match self.task.low_level() {
            Some(low_level) => low_level.policy.action(),
            None => self.checkpoint.policy.action(),
        }
    }
}

/// Of one body of a model, `[2][drives]`.
fn action_scale(body: &BodyEpisodes, drives: usize) -> Vec<f32> {
    let env = body.open(0);
    let model = env.task().model();
    let scale = footwork::env::humanoid::action::action_scale(model);
    let (offset, scale) = scale.split_at(model.nu());
    [&offset[..drives], &scale[..drives]].concat()
}

/// Runs of every kind. Files that they need are in the folder.
pub fn all(folder: &Path) -> Vec<UntrainedRun> {
    let low_level = folder.join("low_level.ckpt");
    let body = find("imitate").expect("a task").config(Preset::Fast);
    let body = find("imitate")
        .expect("a task")
        .check(&body)
        .expect("its dimensions");
    let rest: Vec<f32> = (0..body.action).map(|at| 0.02 * at as f32 - 0.3).collect();
    low_level::checkpoint(LowLevel::Ase, body.style, &rest, 4)
        .save(&low_level)
        .expect("a file");
    let mut runs = Vec::new();
    for task in [
        "plane",
        "obstacles",
        "stand",
        "imitate",
        "track",
        "punch",
        "joystick",
        "skills",
        "box",
    ] {
        runs.push(run(task, task, |_| {}));
    }
    for task in ["punch", "joystick", "box"] {
        let name = format!("{task}-over-skills");
        runs.push(run(&name, task, |config| {
            config.skills = Some(low_level.clone())
        }));
    }
    runs.push(run("plane-normalized", "plane", |config| {
        config.ppo.normalize_observations = true;
        config.ppo.network.activation = Activation::Relu;
    }));
    runs.push(run("obstacles-paper", "obstacles", |config| {
        let set = |key: &str, value: f64| (key.to_string(), toml::Value::Float(value));
        config
            .task
            .settings
            .extend([set("map_edge_width", 0.0), set("map_history_s", 0.0)]);
        config.ppo.normalize_observations = true;
        config.ppo.network.encoder_hidden = vec![9, 7];
    }));
    runs.push(run("obstacles-dense-encoder", "obstacles", |config| {
        config.ppo.network.convolutions.clear();
    }));
    runs.push(run("obstacles-no-encoder", "obstacles", |config| {
        config.ppo.network.convolutions.clear();
        config.ppo.network.encoder_hidden.clear();
    }));
    runs
}

/// One run of a task, for a name.
pub fn one(task: &str) -> UntrainedRun {
    run(task, task, |_| {})
}

fn run(name: &str, task: &str, change: impl Fn(&mut Config)) -> UntrainedRun {
    let entry = find(task).expect("a task");
    // Whether a low level is steered decides on the preset.
    let mut probe = entry.config(Preset::Fast);
    change(&mut probe);
    let mut config = entry.config_of(Preset::Fast, probe.skills.is_some());
    config.ppo.network = network(task);
    change(&mut config);
    let spec = entry.check(&config).expect("possible choices");
    let task = (entry.load)(&config).expect("its data").task;
    let policy = policy(&config, &spec);
    let header = Header {
        version: "test".into(),
        task: entry.name.into(),
        spec,
        fingerprint: task.fingerprint(),
        config: String::new(),
        steps: 1,
    };
    let checkpoint = Checkpoint {
        header,
        policy,
        sections: Default::default(),
        path: Default::default(),
    };
    UntrainedRun {
        name: name.to_string(),
        config,
        task,
        checkpoint,
    }
}

fn network(task: &str) -> NetworkConfig {
    let convolution = |filters, size, stride| Convolution {
        filters,
        size,
        stride,
    };
    let dense = NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden: vec![24, 16],
        activation: Activation::Tanh,
    };
    match task {
        "obstacles" => NetworkConfig {
            convolutions: vec![convolution(4, 4, 2), convolution(3, 3, 1)],
            encoder_hidden: vec![11],
            activation: Activation::Relu,
            ..dense
        },
        _ => dense,
    }
}

/// A policy whose outputs depend on all that it observes.
fn policy(config: &Config, spec: &EnvSpec) -> Policy {
    let (network, observation) = (&config.ppo.network, &spec.observation);
    let policy = Policy::new(network, observation, spec.action, 1);
    let mut policy = policy.expect("such networks");
    policy.parameters = noise(policy.parameters.len(), 1);
    policy.parameters.iter_mut().for_each(|value| *value *= 0.2);
    if config.ppo.normalize_observations {
        let mut moments = RunningMeanStd::new(&Device::Cpu, observation.dim());
        moments.update(&Array::Host(noise(50 * observation.dim(), 2)), 50);
        policy.normalizer = Some(moments);
    }
    policy
}

/// Normal numbers, the first ones far out, where observations are clipped.
fn noise(count: usize, seed: u32) -> Vec<f32> {
    let number = |at| gaussian(random4(seed, at as u32, 0, 0x6578_7074));
    (0..count).map(number).collect()
}

/// A folder for a test.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}
