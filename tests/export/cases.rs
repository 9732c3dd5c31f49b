//! Policies of every kind that nobody has trained, what they are given, and what our own pass makes of it.

use super::low_level;
use footwork::env::humanoid::action::action_scale;
use footwork::env::humanoid::driver::{BodyDriver, DriverState};
use footwork::env::humanoid::task::CpuHumanoidEnv;
use footwork::env::humanoid::task::play::play_by;
use footwork::env::humanoid::task::spec;
use footwork::env::locomotion::{CpuLocomotion, EnvConfig};
use footwork::env::{EnvSpec, VecEnv};
use footwork::export::{Excerpt, FORMATS, TrainedRun, export};
use footwork::gpu::{Array, Device};
use footwork::kernels::humanoid::action_targets::set_targets;
use footwork::kernels::rng::{gaussian, random4};
use footwork::motion::features::{POSE_DIM, TRAJECTORY_DIM};
use footwork::motion::{bvh, synthetic};
use footwork::nn::layer::{Activation, Convolution};
use footwork::nn::{NetworkConfig, Policy, RunningMeanStd};
use footwork::physics::scenes;
use footwork::rl::ase::{LowLevel, STEPS_PER_DECISION};
use footwork::train::body_episodes::BodyEpisodes;
use footwork::train::checkpoint::{Checkpoint, Header};
use footwork::train::config::{Base, Config, Preset};
use footwork::train::locomotion::Locomotion;
use footwork::train::task::Task;
use footwork::train::tasks::{REGISTRY, find};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
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
    /// The run as it is exported.
    pub fn trained(&self) -> TrainedRun<'_> {
        TrainedRun {
            config: &self.config,
            task: &*self.task,
            checkpoint: &self.checkpoint,
            excerpt: Excerpt {
                episode: 3,
                seconds: 2.0,
            },
        }
    }

    /// The bytes of the run in a format.
    pub fn exported(&self, format: &str) -> Vec<u8> {
        let format = FORMATS.iter().find(|found| found.name == format);
        export(&self.trained(), format.expect("such a format")).expect("an exported run")
    }

    /// Writes the run in a format, and beside it what our own pass does.
    pub fn write(&self, recorded: &Recorded, format: &str, folder: &Path) {
        let file = |ending: &str| folder.join(format!("{}.{ending}", self.name));
        std::fs::write(file(format), self.exported(format)).expect("a file");
        for (name, values) in recorded.inputs.iter().chain(&recorded.outputs) {
            let bytes: &[u8] = bytemuck::cast_slice(values);
            std::fs::write(file(&format!("{name}.f32")), bytes).expect("a file");
        }
    }

    /// What our own pass does in some steps, and for random observations.
    fn recorded(&self) -> Recorded {
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
        let mut seen = self.random(policy.observation().dim());
        for _ in 0..STEPS {
            let observation = envs.observation();
            envs.step_without_reset(&policy.mean(&observation));
            seen.extend(observation);
        }
        let action = policy.mean(&seen);
        let normal = &locomotion.matcher.database.normalisation;
        let (mean, scale) = (&normal.mean[POSE_DIM..], &normal.scale[POSE_DIM..]);
        let metres = |(at, action): (usize, &f32)| {
            action / scale[at % TRAJECTORY_DIM] + mean[at % TRAJECTORY_DIM]
        };
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

    /// Random observations of so many numbers, `[RANDOM_ROWS][width]`; some are far beyond what policies are
    /// normalised by.
    fn random(&self, width: usize) -> Vec<f32> {
        let normalizes = self.checkpoint.policy.normalizer.is_some();
        let numbers = noise(RANDOM_ROWS * width, 3).into_iter().enumerate();
        let far = |(at, number): (usize, f32)| match normalizes && at % 7 == 0 {
            true => 20.0 * number,
            false => number,
        };
        numbers.map(far).collect()
    }

    fn body(&self, body: &BodyEpisodes) -> Recorded {
        let mut envs = body.open_all(ENVS);
        let mut recorder = Recorder::new(self, body, &envs);
        let act = |seen: &[f32], state: &mut DriverState| recorder.act(seen, state);
        let mut steps = 0;
        play_by(&mut envs, act, DriverState::default(), |_, _, _| {
            steps += 1;
            steps < STEPS
        });
        let observation = envs.task().observation() + self.checkpoint.header.spec.style;
        let random = self.random(observation);
        let mut state = DriverState::default();
        for _ in 0..2 {
            recorder.act(&random, &mut state);
        }
        recorder.recorded
    }
}

/// A run's driver, and what it was given and did.
struct Recorder {
    driver: Box<dyn BodyDriver>,
    /// Of one body, `[2][drives]`.
    scale: Vec<f32>,
    has_latents: bool,
    steers: bool,
    recorded: Recorded,
}

impl Recorder {
    fn new(run: &UntrainedRun, body: &BodyEpisodes, envs: &CpuHumanoidEnv) -> Recorder {
        let (model, spec) = (envs.task().model(), envs.spec());
        let scale = action_scale(model);
        let (offset, scale) = scale.split_at(model.nu());
        Recorder {
            driver: run.task.driver(&run.checkpoint.policy),
            scale: [&offset[..spec.action], &scale[..spec.action]].concat(),
            has_latents: body.latents.is_some(),
            steers: run.task.low_level().is_some(),
            recorded: Recorded::default(),
        }
    }

    fn act(&mut self, seen: &[f32], state: &mut DriverState) -> Vec<f32> {
        let drives = self.scale.len() / 2;
        let before = state.latents.clone();
        let decides = state.steps.is_multiple_of(STEPS_PER_DECISION);
        let action = self.driver.act(seen, state);
        let Recorded { inputs, outputs } = &mut self.recorded;
        let mut input = |name, values: &[f32]| inputs.entry(name).or_default().extend(values);
        input("observation", seen);
        if self.steers {
            let held = match before.is_empty() {
                true => vec![0.5; state.latents.len()],
                false => before,
            };
            input("latent", &held);
            let decides = f32::from(u8::from(decides));
            input("decide", &vec![decides; action.len() / drives]);
        } else if self.has_latents {
            input("latent", &state.latents);
        }
        let mut output = |name, values: &[f32]| outputs.entry(name).or_default().extend(values);
        output("action", &action);
        let mut targets = vec![0.0; drives];
        for action in action.chunks_exact(drives) {
            set_targets(action, &self.scale, &mut targets);
            output("targets", &targets);
        }
        if self.steers {
            output("next_latent", &state.latents);
        }
        action
    }
}

/// A run of every kind, and what our own pass does in it.
pub static CASES: LazyLock<Vec<(UntrainedRun, Recorded)>> = LazyLock::new(|| {
    let files = Files::new();
    let low_level = Some(files.low_level());
    let mut runs: Vec<UntrainedRun> = REGISTRY.iter().map(|entry| files.run(entry.name)).collect();
    for task in ["punch", "joystick", "box"] {
        runs.push(files.changed(task, "-over-skills", |config| {
            config.skills = low_level.clone()
        }));
    }
    runs.push(files.changed("plane", "-normalized", |config| {
        config.ppo.normalize_observations = true;
        config.ppo.network.activation = Activation::Relu;
    }));
    runs.push(files.changed("obstacles", "-paper", |config| {
        for key in ["map_edge_width", "map_history_s"] {
            config.task.settings.insert(key.into(), 0.0.into());
        }
        config.ppo.normalize_observations = true;
        config.ppo.network.encoder_hidden = vec![9, 7];
    }));
    runs.push(files.changed("obstacles", "-dense", |config| {
        config.ppo.network.convolutions.clear();
    }));
    runs.push(files.changed("obstacles", "-no-encoder", |config| {
        config.ppo.network.convolutions.clear();
        config.ppo.network.encoder_hidden.clear();
    }));
    let recorded = |run: UntrainedRun| {
        let recorded = run.recorded();
        (run, recorded)
    };
    runs.into_iter().map(recorded).collect()
});

/// What runs are made from: a walk of ten seconds.
pub struct Files(TempDir);

impl Files {
    pub fn new() -> Files {
        let files = Files(tempfile::tempdir().expect("a folder"));
        let (clips, _) = synthetic::perform_walk(1, 10.0, 1.2);
        bvh::write(&files.path("walk.bvh"), &clips[0]).expect("a file");
        files
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A low level that nobody has trained.
    fn low_level(&self) -> PathBuf {
        let body = spec(&scenes::humanoid(), 0, 1);
        let rest: Vec<f32> = (0..body.action).map(|at| 0.02 * at as f32 - 0.3).collect();
        let checkpoint = low_level::checkpoint(LowLevel::Ase, body.style, &rest, 4);
        checkpoint
            .save(&self.path("low_level.ckpt"))
            .expect("a file");
        self.path("low_level.ckpt")
    }

    /// A run of a task.
    pub fn run(&self, task: &str) -> UntrainedRun {
        self.changed(task, "", |_| {})
    }

    fn changed(&self, task: &str, suffix: &str, change: impl Fn(&mut Config)) -> UntrainedRun {
        let entry = find(task).expect("a task");
        // Whether a low level is steered decides on the preset.
        let mut probe = entry.config(Preset::Fast);
        change(&mut probe);
        let mut config = entry.config_of(Base {
            steers: probe.skills.is_some(),
            ..Base::default()
        });
        config.data = (task != "stand").then(|| self.path("walk.bvh"));
        config.ppo.network = network(task);
        change(&mut config);
        let spec = entry.check(&config).expect("possible choices");
        let task = (entry.load)(&config).expect("its data").task;
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
            policy: policy(&config, &spec),
            sections: Default::default(),
            path: Default::default(),
        };
        UntrainedRun {
            name: format!("{}{suffix}", entry.name),
            config,
            task,
            checkpoint,
        }
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

/// Normal numbers.
fn noise(count: usize, seed: u32) -> Vec<f32> {
    let number = |at| gaussian(random4(seed, at as u32, 0, 0x6578_7074));
    (0..count).map(number).collect()
}
