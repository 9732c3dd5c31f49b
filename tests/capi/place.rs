//! A database, and policies that were trained with it for a moment.

use footwork::gpu::Device;
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use footwork::ranks::Ranks;
use footwork::runtime::{CharacterMotion, CharacterPolicy, Characters};
use footwork::train::config::Preset;
use footwork::train::run_dir::RunDir;
use footwork::train::tasks::find;
use footwork::train::trainer::{Training, train};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};
use tempfile::TempDir;

pub struct Place {
    folder: TempDir,
    pub motion: Arc<CharacterMotion>,
}

pub static PLACE: LazyLock<Place> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("motion.footwork");
    let (clips, roles) = synthetic::perform(1, 3.0);
    let database = Database::build(&clips, roles, Weights::PAPER).expect("three minutes");
    database.save(&path).expect("a database");
    let motion = Arc::new(CharacterMotion::open(&path).expect("a database"));
    let place = Place { folder, motion };
    place.train("plane", 20_000);
    place.train("obstacles", 1024);
    place
});

impl Place {
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn train(&self, task: &str, steps: u64) {
        let entry = find(task).expect("a task");
        let mut config = entry.config(Preset::Fast);
        let ppo = &mut config.ppo;
        (ppo.envs, ppo.rollout_length, ppo.minibatch_size) = (64, 8, 128);
        config.data = Some(self.path("motion.footwork"));
        config.steps = steps;
        let training = Training {
            task: &*(entry.load)(&config).expect("its data").task,
            config: &config,
            run: &RunDir::create(Some(&self.path(task)), task).expect("a run"),
            device: &Device::Cpu,
            ranks: &Ranks::alone(),
            start: None,
        };
        let stop = AtomicBool::new(false);
        train(training, None, &stop, &mut ()).expect("a training");
    }

    pub fn policy(&self, task: &str) -> Arc<CharacterPolicy> {
        Arc::new(CharacterPolicy::open(&self.path(task)).expect("a policy"))
    }

    pub fn characters(&self, task: &str, count: usize) -> Characters {
        Characters::new(self.motion.clone(), self.policy(task), count).expect("the same database")
    }
}
