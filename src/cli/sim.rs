//! `footwork sim`.

use super::Usage;
use super::say::{say, show, tell};
use anyhow::Result;
use clap::{Args, ValueEnum};
use footwork::env::humanoid::batch::{self, SimulatorBatchConfig};
use footwork::gpu::{Choice, Device};
use footwork::kernels::physics::model_table::CONTACT_BOUND;
use footwork::physics::mjcf::{self, MjcfOptions};
use footwork::physics::model::Model;
use footwork::physics::scenes;
use footwork::physics::simulator::{STEP_RATE, SUBSTEPS, SolverOptions};
use footwork::report::table::table;
use footwork::train::memory;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Scene {
    /// One humanoid
    Humanoid,
    /// Two humanoids face to face
    Boxing,
    /// A humanoid and the box it is to punch
    PunchingBox,
}

/// Let bodies move by random actions, and see how fast and how soundly they do; or see recorded motion
/// in the body.
#[derive(Args)]
pub struct Sim {
    /// Environments side by side
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1024,
        allow_negative_numbers = true
    )]
    envs: usize,
    /// Where to simulate
    #[arg(long, value_enum, default_value = "auto")]
    device: Choice,
    /// Simulated seconds of each environment
    #[arg(
        long,
        value_name = "S",
        default_value_t = 4.0,
        allow_negative_numbers = true
    )]
    seconds: f64,
    /// Who is in an environment
    #[arg(long, value_enum, default_value = "humanoid", conflicts_with = "model")]
    scene: Scene,
    /// A model of your own, MJCF, in place of the humanoid
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Read its motors as drives to a position, whose gains are the joints' stiffness and damping, as Isaac
    /// Gym does; to MuJoCo they are torques
    #[arg(long, requires = "model")]
    pd_motors: bool,
    /// Standard deviation of the drives' targets, rad; of motors' controls
    #[arg(
        long,
        value_name = "RAD",
        default_value_t = 0.5,
        allow_negative_numbers = true
    )]
    action_std: f32,
    /// Contacts that an environment on a GPU has room for [default: 16, of several bodies 32]; the CPU
    /// solves all there are
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    contacts: Option<usize>,
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u32,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    /// In place of random actions: recordings to put into the body, as `train --data` takes them
    #[cfg(feature = "viewer")]
    #[arg(long, value_name = "PATH", requires = "out", conflicts_with_all = RANDOM)]
    clip: Option<PathBuf>,
    /// A TOML file that names the joints of roles that are not found in the recordings
    #[cfg(feature = "viewer")]
    #[arg(long, value_name = "FILE", requires = "clip")]
    roles: Option<PathBuf>,
    /// Metres of one unit of BVH files [default: found from the length of the legs]
    #[cfg(feature = "viewer")]
    #[arg(
        long,
        value_name = "METRES",
        requires = "clip",
        allow_negative_numbers = true
    )]
    unit: Option<f32>,
    /// Bring recordings whose feet stand off the ground to it
    #[cfg(feature = "viewer")]
    #[arg(long, requires = "clip")]
    ground: bool,
    /// Folder for two film strips of each clip: replayed, and with the drives following its angles
    #[cfg(feature = "viewer")]
    #[arg(long, value_name = "FOLDER", requires = "clip")]
    out: Option<PathBuf>,
}

const MAX_ENVS: usize = 1 << 20;

/// What only random actions know.
#[cfg(feature = "viewer")]
const RANDOM: [&str; 8] = [
    "envs",
    "device",
    "seconds",
    "scene",
    "action_std",
    "contacts",
    "seed",
    "json",
];

/// What `--json` prints.
#[derive(Serialize)]
struct Figures {
    device: String,
    threads: usize,
    envs: usize,
    control_steps: u64,
    control_steps_per_s: f64,
    /// Simulated seconds in a second.
    real_time: f64,
    /// Times that an environment diverged and was reset.
    diverged_envs: u64,
    /// Contacts of an environment in a step.
    contacts_mean: f64,
    contacts_max: u32,
    /// Contacts that found no room.
    overflow: u64,
    /// Hash of all positions and velocities at the end: equal for equal runs on one device.
    state_hash: String,
}

impl Sim {
    pub fn run(self) -> Result<()> {
        #[cfg(feature = "viewer")]
        if let (Some(clip), Some(folder)) = (&self.clip, &self.out) {
            return self.draw(clip, folder);
        }
        if !(1..=MAX_ENVS).contains(&self.envs) {
            return Err(Usage(format!("--envs must be from 1 to {MAX_ENVS}")).into());
        }
        if !(self.seconds > 0.0 && self.seconds <= 1e6) {
            let why = "--seconds must be above zero and no more than a million";
            return Err(Usage(why.into()).into());
        }
        if !(0.0..=10.0).contains(&self.action_std) {
            return Err(Usage("--action-std must lie between 0 and 10 rad".into()).into());
        }
        let room = 1..=CONTACT_BOUND as usize;
        if self
            .contacts
            .is_some_and(|contacts| !room.contains(&contacts))
        {
            let why = format!(
                "--contacts must be from 1 to {CONTACT_BOUND}, which is all that shaders hold; `--device cpu` has room for all"
            );
            return Err(Usage(why).into());
        }
        let bytes = self.envs as u64 * memory::ENVIRONMENT;
        memory::check(bytes, "use a smaller --envs")?;
        let model = Arc::new(self.load()?);
        if model.dofs.is_empty() {
            anyhow::bail!(
                "nothing in the model '{}' can move: give a body a joint",
                model.name
            );
        }
        let device = Device::open(self.device)?;
        let figures = self.measure(model, &device)?;
        if let Some(warning) = batch::overflow_warning(figures.overflow) {
            tell!("{warning}, and --contacts gives up to {CONTACT_BOUND}");
        }
        match self.json {
            true => say!("{}", serde_json::to_string_pretty(&figures)?),
            false => show!("{}", shown(&figures)),
        }
        Ok(())
    }

    #[cfg(feature = "viewer")]
    fn draw(&self, clip: &std::path::Path, folder: &std::path::Path) -> Result<()> {
        use footwork::motion::import::ImportOptions;
        use footwork::physics::motion_list::{MotionList, MotionListOptions};
        use footwork::view::strip::strips;

        let model = Arc::new(self.load()?);
        let options = MotionListOptions {
            import: ImportOptions {
                unit_m: self.unit,
                roles: self.roles.clone(),
                ..ImportOptions::default()
            },
            ground: self.ground,
            ..MotionListOptions::default()
        };
        let library = MotionList::read(clip, None)?
            .load(&model, &options)?
            .library;
        for note in &library.notes {
            tell!("note: {note}");
        }
        let gpu = footwork::gpu::Gpu::drawing()?;
        for motion in library.motions() {
            for file in strips(&gpu, &model, motion, folder)? {
                say!("{}", file.display());
            }
        }
        Ok(())
    }

    fn load(&self) -> Result<Model> {
        Ok(match (&self.model, self.scene) {
            (Some(file), _) => {
                let pd_motors = self.pd_motors;
                let read = mjcf::read(file, MjcfOptions { pd_motors })?;
                for note in &read.notes {
                    tell!("note: {}: {note}", file.display());
                }
                read.model
            }
            (None, Scene::Humanoid) => scenes::humanoid(),
            (None, Scene::Boxing) => scenes::boxing_match(),
            (None, Scene::PunchingBox) => scenes::humanoid_and_box(),
        })
    }

    fn measure(&self, model: Arc<Model>, device: &Device) -> Result<Figures> {
        let usual = SolverOptions::fast(&model);
        let config = SimulatorBatchConfig {
            envs: self.envs,
            options: SolverOptions {
                max_contacts: self.contacts.unwrap_or(usual.max_contacts),
                ..usual
            },
            seed: self.seed,
            force_pairs: Vec::new(),
            model,
        };
        // Compiles the shaders.
        let mut worlds = batch::open(device, &config)?;
        worlds.draw_targets(self.action_std);
        worlds.step();
        worlds.counters()?;
        drop(worlds);
        let mut worlds = batch::open(device, &config)?;
        let rate = f64::from(STEP_RATE) / SUBSTEPS as f64;
        let steps = (self.seconds * rate).ceil() as u64;
        let line = ProgressBar::new(steps).with_style(ProgressStyle::with_template(
            "{elapsed} {wide_bar} {pos}/{len} actions",
        )?);
        let begun = Instant::now();
        for _ in 0..steps {
            worlds.draw_targets(self.action_std);
            worlds.step();
            device.pace()?;
            line.inc(1);
        }
        let counters = worlds.counters()?;
        let seconds = begun.elapsed().as_secs_f64();
        line.finish_and_clear();
        let actions = steps * self.envs as u64;
        let state = worlds.state()?;
        let per_s = actions as f64 / seconds;
        Ok(Figures {
            device: device.name(),
            threads: rayon::current_num_threads(),
            envs: self.envs,
            control_steps: actions,
            control_steps_per_s: per_s,
            real_time: per_s / rate,
            diverged_envs: counters.diverged,
            contacts_mean: counters.contacts as f64 / (actions * SUBSTEPS as u64) as f64,
            contacts_max: counters.peak_contacts,
            overflow: counters.overflow,
            state_hash: format!("{:08x}", crc32fast::hash(bytemuck::cast_slice(&state))),
        })
    }
}

fn shown(figures: &Figures) -> String {
    let rows = [
        ("device", figures.device.clone()),
        ("environments", figures.envs.to_string()),
        ("control steps", figures.control_steps.to_string()),
        (
            "control steps a second",
            format!("{:.0}", figures.control_steps_per_s),
        ),
        (
            "simulated seconds in a second",
            format!("{:.0}", figures.real_time),
        ),
        ("diverged environments", figures.diverged_envs.to_string()),
        (
            "contacts, mean of a step",
            format!("{:.2}", figures.contacts_mean),
        ),
        ("contacts, most of a step", figures.contacts_max.to_string()),
        ("contacts without room", figures.overflow.to_string()),
        ("hash of the final state", figures.state_hash.clone()),
    ];
    let rows = rows
        .into_iter()
        .map(|(what, value)| vec![what.to_string(), value]);
    table(&["", ""], &rows.collect::<Vec<_>>())
}
