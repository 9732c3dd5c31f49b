//! Whole trainings, short ones: they must learn, repeat bit for bit, go on after a stop as if there
//! had been none, and leave the last good checkpoint alone when learning diverges.

#[path = "support/events.rs"]
mod events;

use events::images;
use footwork::env::locomotion::{LocomotionTask, Obstacles, Plane};
use footwork::gpu::{Choice, Device};
use footwork::matching::MotionMatcher;
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use footwork::nn::Policy;
use footwork::ranks::Ranks;
use footwork::report::events::FILE_NAME;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::config::{Config, Preset};
use footwork::train::controller::Scripted;
use footwork::train::evaluate::hardest;
use footwork::train::observer::Observer;
use footwork::train::planner::plan;
use footwork::train::run_dir::{RunDir, Summary};
use footwork::train::tasks::find;
use footwork::train::trainer::{Training, train};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tempfile::TempDir;

fn matcher(minutes: f32) -> Arc<MotionMatcher> {
    let (clips, roles) = synthetic::perform(1, minutes);
    let database = Database::build(&clips, roles, Weights::PAPER);
    let database = database.expect("synthetic motion can be matched");
    Arc::new(MotionMatcher::new(Arc::new(database)))
}

/// A folder for runs, with a database file of so many minutes of synthetic motion.
struct Place(TempDir);

impl Place {
    fn new(minutes: f32) -> Place {
        let place = Place(tempfile::tempdir().expect("a folder"));
        let database = &matcher(minutes).database;
        database.save(&place.path("motion")).expect("a database");
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Trains on the folder's motion in its folder `run`, from its last checkpoint if there is one.
    fn train(&self, config: &Config, device: Choice, run: &str) -> anyhow::Result<Summary> {
        let mut config = config.clone();
        config.data = Some(self.path("motion"));
        self.train_on(config, device, run)
    }

    /// Trains on the configuration's own motion.
    fn train_on(&self, config: Config, device: Choice, run: &str) -> anyhow::Result<Summary> {
        self.train_seen_by(config, device, run, &mut ())
    }

    fn train_seen_by(
        &self,
        config: Config,
        device: Choice,
        run: &str,
        observer: &mut (dyn Observer + Send),
    ) -> anyhow::Result<Summary> {
        let device = Device::open(device).expect("an adapter");
        let (entry, out) = (find(&config.task.name)?, self.path(run));
        let begun = out.exists();
        let training = Training {
            config: &config,
            task: &*(entry.load)(&config)?.task,
            run: &match begun {
                true => RunDir::open(&out)?,
                false => RunDir::create(Some(&out), entry.name)?,
            },
            device: &device,
            ranks: &Ranks::alone(),
            start: None,
        };
        let from = begun.then(|| self.last(run));
        train(training, from, &AtomicBool::new(false), observer)
    }

    /// A run's last checkpoint.
    fn last(&self, run: &str) -> Checkpoint {
        let path = self.path(run).join("checkpoints/last.ckpt");
        Checkpoint::load(&path).expect("a checkpoint")
    }
}

fn preset(task: &str, preset: Preset) -> Config {
    find(task).expect("a task").config(preset)
}

/// Small enough for a few updates to take no time.
fn small(steps: u64) -> Config {
    let mut config = preset("plane", Preset::Fast);
    let ppo = &mut config.ppo;
    (ppo.envs, ppo.rollout_length, ppo.minibatch_size) = (64, 8, 128);
    (config.steps, config.checkpoint_every) = (steps, 512);
    config
}

#[test]
fn learns_to_reach_targets_on_the_cpu() {
    let place = Place::new(10.0);
    let config = Config {
        steps: 150_000,
        ..preset("plane", Preset::Fast)
    };
    let summary = place
        .train(&config, Choice::Cpu, "run")
        .expect("a training");
    assert!(summary.evaluation.success >= 0.95, "{summary:?}");
}

#[test]
fn learns_to_reach_targets_on_lavapipe() {
    let place = Place::new(2.0);
    let config = Config {
        steps: 130_000,
        ..preset("plane", Preset::Fast)
    };
    let summary = place.train(&config, Choice::Lavapipe, "run");
    let summary = summary.expect("a training");
    assert!(summary.evaluation.success >= 0.8, "{summary:?}");
}

/// The performer's walk, by style alone.
#[test]
fn learns_to_walk_on_the_cpu() {
    let place = Place(tempfile::tempdir().expect("a folder"));
    let config = Config {
        steps: 1_000_000,
        ..preset("imitate", Preset::Fast)
    };
    let summary = place.train_on(config, Choice::Cpu, "run");
    let summary = summary.expect("a training");
    assert!(summary.evaluation.success >= 0.5, "{summary:?}");
}

/// Trains without a stop, again, and with a stop.
fn repeats_and_resumes(config: impl Fn(u64) -> Config, half: u64, device: Choice) {
    let place = Place::new(1.0);
    let train = |steps: u64, run: &str| {
        let trained = place.train(&config(steps), device, run);
        trained.expect("a training");
        place.last(run)
    };
    let whole = train(2 * half, "whole");
    assert!(whole.sections == train(2 * half, "again").sections);
    assert!(whole.sections != train(half, "halves").sections);
    assert!(whole.sections == train(2 * half, "halves").sections);
}

#[test]
fn repeats_and_resumes_bit_for_bit_on_the_cpu() {
    repeats_and_resumes(small, 2 * 512, Choice::Cpu);
}

#[test]
fn repeats_and_resumes_bit_for_bit_on_lavapipe() {
    repeats_and_resumes(small, 2 * 512, Choice::Lavapipe);
}

/// Obstacles on small networks. The first level is passed at the first look, so that the second half of
/// a training is on a level where obstacles move.
fn small_among_obstacles(steps: u64) -> Config {
    let mut config = preset("obstacles", Preset::Fast);
    let ppo = &mut config.ppo;
    (ppo.envs, ppo.rollout_length, ppo.minibatch_size, ppo.epochs) = (64, 8, 128, 1);
    (ppo.network.encoder_hidden, ppo.network.hidden) = (vec![16], vec![16]);
    (config.steps, config.checkpoint_every) = (steps, 512);
    let set = config.set("task.promotion_success", 0.001.into());
    set.expect("a key of the task");
    config
}

/// Skills of few environments; latents live longer than an update.
fn small_skills(low_level: &str, steps: u64) -> Config {
    let mut config = preset("skills", Preset::Fast);
    let ppo = &mut config.ppo;
    (ppo.envs, ppo.rollout_length, ppo.minibatch_size, ppo.epochs) = (16, 8, 64, 1);
    ppo.network.hidden = vec![16];
    (config.steps, config.checkpoint_every) = (steps, 128);
    for (key, value) in [
        ("minibatch_size", 32),
        ("steps", 2),
        ("replay_capacity", 256),
    ] {
        let set = config.set(&format!("amp.{key}"), value.into());
        set.expect("a key of the discriminator");
    }
    let set = config.set("ase.low_level", low_level.into());
    set.expect("a low level");
    let set = config.set("task.episode_s", 0.5.into());
    set.expect("a length of episodes");
    config
}

/// Trains skills without a stop, and with a stop in the middle of latents' lives.
fn skills_resume(low_level: &str, device: Choice) {
    let place = Place(tempfile::tempdir().expect("a folder"));
    let (clips, _) = synthetic::perform_boxing(1, 0.2);
    footwork::motion::bvh::write(&place.path("clip.bvh"), &clips[0]).expect("a file");
    let train = |steps: u64, run: &str| {
        let mut config = small_skills(low_level, steps);
        config.data = Some(place.path("clip.bvh"));
        let trained = place.train_on(config, device, run);
        trained.expect("a training");
        place.last(run)
    };
    let whole = train(512, "whole");
    assert!(whole.sections != train(256, "halves").sections);
    assert!(whole.sections == train(512, "halves").sections);
}

#[test]
fn skills_resume_bit_for_bit_on_the_cpu() {
    skills_resume("ase", Choice::Cpu);
}

#[test]
fn skills_resume_bit_for_bit_on_lavapipe() {
    skills_resume("per-clip", Choice::Lavapipe);
}

#[test]
fn repeats_and_resumes_among_obstacles_on_the_cpu() {
    repeats_and_resumes(small_among_obstacles, 4 * 512, Choice::Cpu);
}

#[test]
fn repeats_and_resumes_among_obstacles_on_lavapipe() {
    repeats_and_resumes(small_among_obstacles, 4 * 512, Choice::Lavapipe);
}

#[test]
fn levels_rise_and_are_remembered() {
    let place = Place::new(1.0);
    let train = |updates: u64| {
        let config = small_among_obstacles(updates * 512);
        let summary = place.train(&config, Choice::Cpu, "run");
        summary.expect("a training").level
    };
    let half = train(4);
    assert!(half > Some(0), "no level passed");
    assert!(train(5) >= half);
}

#[test]
fn learns_to_pass_the_first_level_among_obstacles() {
    let place = Place::new(10.0);
    let config = Config {
        steps: 300_000,
        ..preset("obstacles", Preset::Fast)
    };
    let summary = place
        .train(&config, Choice::Cpu, "run")
        .expect("a training");
    assert!(summary.levels_passed > Some(0), "no level passed");
}

#[test]
fn plans_reach_what_nothing_is_in_the_way_of() {
    let matcher = matcher(2.0);
    let task = |count| {
        LocomotionTask::Obstacles(Obstacles {
            count,
            ..Obstacles::FAST
        })
    };
    assert_eq!(plan(&matcher, task(0), 9, 6).success, 1.0);
    assert!(plan(&matcher, task(100), 9, 6).success >= 0.5);
}

/// One update of the paper's preset moves the policy.
fn one_update(task: &str) {
    let place = Place::new(1.0);
    let mut config = preset(task, Preset::Paper);
    (config.steps, config.ppo.epochs) = (config.batch(), 1);
    let summary = place
        .train(&config, Choice::Cpu, "run")
        .expect("a training");
    assert_eq!(summary.stopped_by, "steps");
    let text = std::fs::read_to_string(place.path("run/metrics.jsonl")).expect("metrics");
    let row: serde_json::Value = serde_json::from_str(&text).expect("an update");
    assert!(row["kl"].as_f64() > Some(0.0), "nothing was learned: {row}");
}

#[test]
fn the_paper_s_network_learns_among_obstacles() {
    one_update("obstacles");
}

#[test]
fn the_paper_s_network_learns_on_the_plane() {
    one_update("plane");
}

#[test]
fn another_seed_is_another_run() {
    let place = Place::new(1.0);
    let [one, two] = [1, 2].map(|seed| {
        let config = Config { seed, ..small(512) };
        let run = format!("run-{seed}");
        place.train(&config, Choice::Cpu, &run).expect("a training");
        place.last(&run).sections
    });
    assert!(one != two);
}

#[test]
fn divergence_stops_and_leaves_the_last_good_checkpoint() {
    let place = Place::new(1.0);
    let train = |config: &Config| place.train(config, Choice::Cpu, "run");
    train(&small(2 * 512)).expect("a training");
    let good = place.last("run");
    let mut config = small(40 * 512);
    (config.ppo.max_grad_norm, config.ppo.learning_rate) = (0.0, 1e30);
    config.checkpoint_every = 1 << 40;
    // Annealing puts the configuration's learning rate in the place of the checkpoint's.
    (config.ppo.anneal_steps, config.ppo.final_lr_fraction) = (1 << 40, 1.0);
    let error = format!("{:#}", train(&config).expect_err("must diverge"));
    assert!(error.contains("learning diverged: the "), "{error}");
    assert!(place.last("run").sections == good.sections);
    let summary = std::fs::read_to_string(place.path("run/summary.json")).expect("a summary");
    assert!(summary.contains("\"failure\""), "{summary}");
}

#[test]
fn faster_scripts_arrive_sooner_and_an_untrained_policy_hardly_ever() {
    let matcher = matcher(10.0);
    let task = LocomotionTask::Plane(Plane::default());
    let evaluate = |speed| {
        let database = &matcher.database;
        let script = Scripted { database, speed };
        hardest(&script, &matcher, task, 200).expect("an evaluation")
    };
    let (slow, quick) = (evaluate(1.0), evaluate(3.0));
    assert!(
        slow.success > 0.97 && quick.success > 0.97,
        "{slow:?} {quick:?}"
    );
    assert!(
        quick.time_to_target_mean_s < slow.time_to_target_mean_s,
        "{slow:?} {quick:?}"
    );
    assert!(quick.mean_speed > slow.mean_speed && slow.path_ratio >= 1.0);

    let place = Place::new(10.0);
    let mut config = small(512);
    config.ppo.learning_rate = 1e-9;
    let summary = place
        .train(&config, Choice::Cpu, "run")
        .expect("a training");
    assert!(summary.evaluation.success < 0.5, "{summary:?}");
}

/// A camera whose every film is one grey pixel.
struct Camera(usize);

/// A whole GIF file.
const PIXEL: &[u8] = b"GIF89a\x01\x00\x01\x00\x80\x00\x00\x80\x80\x80\x00\x00\x00,\x00\x00\x00\x00\x01\x00\x01\x00\x00\x02\x02D\x01\x00;";

impl Observer for Camera {
    fn film(&mut self, _: &Policy) -> anyhow::Result<Option<Vec<u8>>> {
        self.0 += 1;
        Ok(Some(PIXEL.to_vec()))
    }
}

/// Pictures of the policies that are kept, and the figures of the end, are what TensorBoard shows; also after a
/// training has gone on.
#[test]
fn pictures_of_policies_are_events() {
    let place = Place::new(1.0);
    let train = |steps: u64, film_share: f64| {
        let mut config = Config {
            checkpoint_every: 1024,
            film_share,
            ..small(steps)
        };
        config.data = Some(place.path("motion"));
        let mut camera = Camera(0);
        let trained = place.train_seen_by(config, Choice::Cpu, "run", &mut camera);
        trained.expect("a training");
        camera.0
    };
    let shown = || {
        let file = place.path("run").join(FILE_NAME);
        let found = images(&std::fs::read(file).expect("an event file"));
        found
            .into_iter()
            .map(|one| {
                if one.file.starts_with(b"GIF") {
                    assert_eq!((&*one.file, one.size), (PIXEL, [1, 1]));
                } else {
                    let decoder = png::Decoder::new(std::io::Cursor::new(&one.file));
                    let mut reader = decoder.read_info().expect("a PNG file");
                    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
                    let info = reader.next_frame(&mut pixels).expect("a whole PNG file");
                    assert_eq!(one.size, [info.width, info.height].map(u64::from));
                }
                (one.step, one.tag)
            })
            .collect::<Vec<_>>()
    };
    let kept = |steps: u64| ["film", "walks"].map(|of| (steps, format!("episodes/{of}")));
    let curve = |steps: u64| (steps, "figures/learning_curve".to_string());

    assert_eq!(train(2048, 1000.0), 2);
    let mut found = shown();
    found.sort();
    let first = [kept(1024), kept(2048)].concat();
    let mut wanted = [&first[..], &[curve(2048)]].concat();
    wanted.sort();
    assert_eq!(found, wanted);
    // No film where films may take no time; those of before are still there.
    assert_eq!(train(3072, 0.0), 0);
    let mut found = shown();
    found.sort();
    let [_, walks] = kept(3072);
    let mut wanted = [&first[..], &[walks, curve(3072)]].concat();
    wanted.sort();
    assert_eq!(found, wanted);
}
