//! Whole trainings, short ones: they must learn, repeat bit for bit, go on after a stop as if there
//! had been none, and leave the last good checkpoint alone when learning diverges.

use footwork::gpu::{Choice, Device};
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use footwork::nn::network::Shape;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::config::{Config, Kind, Preset};
use footwork::train::controller::{Scripted, Trained};
use footwork::train::evaluate::hardest;
use footwork::train::run_dir::{Folder, Summary};
use footwork::train::planner::plan;
use footwork::train::trainer::train;
use footwork::env::locomotion::{Obstacles, Plane, Task};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

fn database(minutes: f32) -> Arc<Database> {
    let (clips, roles) = synthetic::perform(1, minutes);
    Arc::new(
        Database::build(&clips, roles, Weights::PAPER).expect("synthetic motion can be matched"),
    )
}

/// Small enough for a few updates to take no time.
fn small(steps: u64) -> Config {
    let mut config = Config::preset(Kind::Plane, Preset::Fast);
    (config.ppo.envs, config.ppo.horizon, config.ppo.minibatch) = (64, 8, 128);
    (config.steps, config.checkpoint_every) = (steps, 512);
    config
}

fn run(
    config: &Config,
    database: &Arc<Database>,
    device: Choice,
    out: &Path,
    from: Option<Checkpoint>,
) -> anyhow::Result<Summary> {
    let device = Device::open(device).expect("an adapter");
    let folder = match from {
        Some(_) => Folder::open(out)?,
        None => Folder::create(Some(out), config.task.name())?,
    };
    folder.write_config(config)?;
    train(
        config,
        &folder,
        database,
        &device,
        from,
        &AtomicBool::new(false),
        None,
    )
}

/// Everything that must repeat: all but the time it took.
fn state(out: &Path) -> Checkpoint {
    let mut checkpoint =
        Checkpoint::load(&out.join("checkpoints/last.ckpt")).expect("a checkpoint");
    checkpoint.header.wall_s = 0.0;
    checkpoint
}

#[test]
fn learns_to_reach_targets_on_the_cpu() {
    let out = tempfile::tempdir().expect("a folder");
    let config = Config {
        steps: 150_000,
        ..Config::preset(Kind::Plane, Preset::Fast)
    };
    let summary = run(&config, &database(10.0), Choice::Cpu, out.path(), None).expect("a training");
    assert!(summary.success >= 0.95, "{summary:?}");
}

#[test]
fn learns_to_reach_targets_on_lavapipe() {
    let out = tempfile::tempdir().expect("a folder");
    let config = Config {
        steps: 130_000,
        ..Config::preset(Kind::Plane, Preset::Fast)
    };
    let summary =
        run(&config, &database(2.0), Choice::Lavapipe, out.path(), None).expect("a training");
    assert!(summary.success >= 0.8, "{summary:?}");
}

fn repeats_and_resumes(device: Choice) {
    let database = database(1.0);
    let [whole, again, halves] = [(); 3].map(|()| tempfile::tempdir().expect("a folder"));
    let config = small(4 * 512);
    run(&config, &database, device, whole.path(), None).expect("a training");
    run(&config, &database, device, again.path(), None).expect("a training");
    assert!(state(whole.path()) == state(again.path()));

    run(&small(2 * 512), &database, device, halves.path(), None).expect("a training");
    let half =
        Checkpoint::load(&halves.path().join("checkpoints/last.ckpt")).expect("a checkpoint");
    run(&config, &database, device, halves.path(), Some(half)).expect("a training");
    assert!(state(whole.path()) == state(halves.path()));
}

#[test]
fn repeats_and_resumes_bit_for_bit_on_the_cpu() {
    repeats_and_resumes(Choice::Cpu);
}

#[test]
fn repeats_and_resumes_bit_for_bit_on_lavapipe() {
    repeats_and_resumes(Choice::Lavapipe);
}

/// Obstacles on small networks.
fn small_among_obstacles(steps: u64) -> Config {
    let mut config = Config::preset(Kind::Obstacles, Preset::Fast);
    let small_ppo = small(steps).ppo;
    (config.ppo.envs, config.ppo.horizon) = (small_ppo.envs, small_ppo.horizon);
    (config.ppo.minibatch, config.ppo.epochs) = (small_ppo.minibatch, 1);
    (config.ppo.network.sight, config.ppo.network.hidden) = (vec![16], vec![16]);
    (config.steps, config.checkpoint_every) = (steps, 512);
    config
}

/// Stopped in the middle of a level, with obstacles on their way.
fn repeats_and_resumes_among_obstacles(device: Choice) {
    let database = database(1.0);
    let [whole, halves] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let config = |steps| {
        let mut config = small_among_obstacles(steps);
        let Task::Obstacles(task) = &mut config.task else {
            unreachable!("asked for")
        };
        // Passed at the first look, so that the second half is on a level where obstacles move.
        task.pass = 0.001;
        config
    };
    run(&config(6 * 512), &database, device, whole.path(), None).expect("a training");
    run(&config(4 * 512), &database, device, halves.path(), None).expect("a training");
    let half =
        Checkpoint::load(&halves.path().join("checkpoints/last.ckpt")).expect("a checkpoint");
    assert!(half.header.memory.curriculum.level() > 0, "no level passed");
    run(
        &config(6 * 512),
        &database,
        device,
        halves.path(),
        Some(half),
    )
    .expect("a training");
    assert!(state(whole.path()) == state(halves.path()));
}

#[test]
fn repeats_and_resumes_among_obstacles_on_the_cpu() {
    repeats_and_resumes_among_obstacles(Choice::Cpu);
}

#[test]
fn repeats_and_resumes_among_obstacles_on_lavapipe() {
    repeats_and_resumes_among_obstacles(Choice::Lavapipe);
}

#[test]
fn learns_to_pass_the_first_level_among_obstacles() {
    let out = tempfile::tempdir().expect("a folder");
    let config = Config {
        steps: 300_000,
        ..Config::preset(Kind::Obstacles, Preset::Fast)
    };
    run(&config, &database(10.0), Choice::Cpu, out.path(), None).expect("a training");
    let passed = state(out.path()).header.memory.curriculum.passed;
    assert!(passed > 0, "no level passed");
}

#[test]
fn plans_reach_what_nothing_is_in_the_way_of() {
    let database = database(2.0);
    let task = |count| {
        Task::Obstacles(Obstacles {
            count,
            ..Obstacles::FAST
        })
    };
    assert_eq!(plan(&database, task(0), 9, 6).success, 1.0);
    assert!(plan(&database, task(100), 9, 6).success >= 0.5);
}

#[test]
fn the_paper_s_network_learns_among_obstacles() {
    let out = tempfile::tempdir().expect("a folder");
    let mut config = Config::preset(Kind::Obstacles, Preset::Paper);
    (config.steps, config.ppo.epochs) = (config.ppo.batch() as u64, 1);
    let summary = run(&config, &database(1.0), Choice::Cpu, out.path(), None).expect("a training");
    assert_eq!((summary.stopped_by, summary.level), ("steps", Some(0)));
}

#[test]
fn another_seed_is_another_run() {
    let database = database(1.0);
    let [one, two] = [1, 2].map(|seed| {
        let out = tempfile::tempdir().expect("a folder");
        let config = Config { seed, ..small(512) };
        run(&config, &database, Choice::Cpu, out.path(), None).expect("a training");
        state(out.path()).parameters
    });
    assert_ne!(one, two);
}

#[test]
fn divergence_stops_and_leaves_the_last_good_checkpoint() {
    let out = tempfile::tempdir().expect("a folder");
    let database = database(1.0);
    run(&small(2 * 512), &database, Choice::Cpu, out.path(), None).expect("a training");
    let good = state(out.path());
    let mut config = small(40 * 512);
    config.ppo.max_gradient = 0.0;
    let mut from = good.clone();
    from.header.rates[0] = 1e30;
    let error =
        run(&config, &database, Choice::Cpu, out.path(), Some(from)).expect_err("must diverge");
    assert!(error.to_string().contains("diverged"), "{error:#}");
    assert_eq!(state(out.path()), good);
    let summary = std::fs::read_to_string(out.path().join("summary.json")).expect("a summary");
    assert!(summary.contains("\"failure\""), "{summary}");
}

#[test]
fn the_paper_preset_trains() {
    let out = tempfile::tempdir().expect("a folder");
    let mut config = Config::preset(Kind::Plane, Preset::Paper);
    (config.steps, config.ppo.epochs) = (config.ppo.batch() as u64, 2);
    let summary = run(&config, &database(1.0), Choice::Cpu, out.path(), None).expect("a training");
    assert_eq!(summary.stopped_by, "steps");
}

#[test]
fn faster_scripts_arrive_sooner_and_an_untrained_policy_hardly_ever() {
    let database = database(10.0);
    let judge = |speed| {
        let script = Scripted {
            database: &database,
            speed,
        };
        hardest(&script, &database, Task::Plane(Plane::default()), 200).expect("an evaluation")
    };
    let (slow, quick) = (judge(1.0), judge(3.0));
    assert!(
        slow.success > 0.97 && quick.success > 0.97,
        "{slow:?} {quick:?}"
    );
    assert!(
        quick.time_to_target_mean_s < slow.time_to_target_mean_s,
        "{slow:?} {quick:?}"
    );
    assert!(quick.mean_speed > slow.mean_speed && slow.path_ratio >= 1.0);

    let config = Config::preset(Kind::Plane, Preset::Fast);
    let shape = Shape::new(&config.ppo.network, config.task.width()).expect("a network that fits");
    let untrained = Trained::new(&shape, &shape.init(1, 0.0));
    let report = hardest(&untrained, &database, config.task, 200).expect("an evaluation");
    assert!(report.success < 0.5, "{report:?}");
}
