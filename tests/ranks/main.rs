//! Trainings on several ranks: threads of this process, and processes that mpiexec starts (feature `mpi`).

#[cfg(feature = "mpi")]
mod processes;
mod threads;

use footwork::gpu::{Array, Choice, Device};
use footwork::nn::RunningMeanStd;
use footwork::ranks::Ranks;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::config::{Config, Preset};
use footwork::train::run_dir::{RunDir, Summary};
use footwork::train::tasks::{REGISTRY, find};
use footwork::train::trainer::{Training, train};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use threads::{sums_of, together};

/// A training of a second at most. An update is one gradient step on all samples.
fn small(task: &str, updates: u64) -> Config {
    let mut config = find(task).unwrap().config(Preset::Fast);
    let ppo = &mut config.ppo;
    (ppo.envs, ppo.rollout_length, ppo.epochs) = (16, 8, 1);
    ppo.minibatch_size = ppo.batch();
    ppo.network.hidden = vec![16];
    ppo.network.encoder_hidden.truncate(1);
    if let Some(amp) = &mut config.amp {
        (amp.minibatch_size, amp.steps) = (32, 2);
        (amp.replay_capacity, amp.replay_per_update) = (256, 64);
    }
    config.steps = updates * config.batch();
    config.film_share = 0.0;
    // Evaluations are of a thousand episodes. Motion matching's have their length.
    let _ = config.set("task.episode_s", 0.5.into());
    config
}

/// Trains one rank's share in a folder, from its last checkpoint if there is one.
fn trained(config: &Config, device: Choice, out: &Path, ranks: &Ranks) -> Summary {
    let device = Device::open(device).expect("an adapter");
    let entry = find(&config.task.name).unwrap();
    let begun = ranks.is_first() && out.join("config.toml").exists();
    let begun = ranks.any(begun);
    let run = match (begun, ranks.is_first()) {
        (false, true) => RunDir::create(Some(out), entry.name).unwrap(),
        _ => RunDir::of_first(out),
    };
    let training = Training {
        config,
        task: &*(entry.load)(config).unwrap().task,
        run: &run,
        device: &device,
        ranks,
        start: None,
    };
    let from = begun.then(|| last(out));
    train(training, from, &AtomicBool::new(false), &mut ()).unwrap()
}

/// A run's last checkpoint.
fn last(run: &Path) -> Checkpoint {
    Checkpoint::load(&run.join("checkpoints/last.ckpt")).unwrap()
}

/// Trains on so many ranks; returns the last checkpoint.
fn on_ranks(count: usize, config: &Config, device: Choice, out: &Path) -> Checkpoint {
    together(count, |ranks| trained(config, device, out, ranks));
    last(out)
}

fn folder() -> (tempfile::TempDir, impl Fn(&str) -> PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    (folder, move |name: &str| path.join(name))
}

fn largest_difference(one: &[f32], other: &[f32]) -> f32 {
    assert_eq!(one.len(), other.len());
    let differences = one
        .iter()
        .zip(other)
        .map(|(one, other)| (one - other).abs());
    differences.fold(0.0, f32::max)
}

#[test]
fn sums_are_taken_in_the_order_of_the_ranks() {
    let own = [1e8, 1.0, -1e8, 1.0];
    let sums = together(4, |ranks| {
        let mut values = [own[ranks.rank().number], ranks.rank().number as f32];
        ranks.sum(&mut values);
        values
    });
    let in_order = ((own[0] + own[1]) + own[2]) + own[3];
    assert_eq!(sums, vec![[in_order, 6.0]; 4]);
}

#[test]
fn ranks_tell_each_other() {
    let told = together(3, |ranks| {
        let number = ranks.rank().number;
        let mut first = vec![number as u8; number + 1];
        let all = ranks.gather(&first);
        ranks.broadcast(&mut first);
        let own = Array::from(vec![number as f32; 2]);
        let joined = ranks.join(&Device::Cpu, &own).unwrap();
        (first, all, joined.host().to_vec(), ranks.any(number == 2))
    });
    let all = vec![vec![0], vec![1, 1], vec![2, 2, 2]];
    let joined = vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0];
    assert_eq!(told, vec![(vec![0], all, joined, true); 3]);
}

#[test]
fn moments_are_of_the_rows_of_all_ranks() {
    let rows = |rank: usize| -> Vec<f32> {
        let numbers = 0..60;
        numbers
            .map(|i| 5.0 + rank as f32 + ((i * 7919 + rank) % 13) as f32)
            .collect()
    };
    let moments = together(4, |ranks| {
        let mut running = RunningMeanStd::new(&Device::Cpu, 3);
        for _ in 0..2 {
            let own = Array::from(rows(ranks.rank().number));
            running.update_over(ranks, &own, 20).unwrap();
        }
        running.moments().to_vec()
    });
    let mut whole = RunningMeanStd::new(&Device::Cpu, 3);
    for _ in 0..2 {
        let all = (0..4).flat_map(rows).collect::<Vec<f32>>();
        whole.update(&Array::from(all), 80);
    }
    assert!(moments.iter().all(|own| *own == moments[0]));
    let difference = largest_difference(&moments[0], whole.moments());
    assert!(difference < 1e-4, "{difference}");
}

/// Every task: the first update is that of one process, but for the order of sums, and two ranks have one policy.
#[test]
fn ranks_play_and_learn_what_one_process_would() {
    for entry in &REGISTRY {
        let (_folder, path) = folder();
        let config = small(entry.name, 1);
        let alone = on_ranks(1, &config, Choice::Cpu, &path("alone"));
        let both = on_ranks(2, &config, Choice::Cpu, &path("both"));
        let (alone, both) = (alone.policy.parameters, both.policy.parameters);
        let difference = largest_difference(&alone, &both);
        assert!(difference < 2e-4, "{}: {difference}", entry.name);
    }
}

/// What an update of a preset makes two ranks tell each other.
#[test]
fn an_update_sends_gradients_and_little_else() {
    for (task, most) in [("plane", 1.1), ("imitate", 2.0)] {
        let (_folder, path) = folder();
        let mut config = find(task).unwrap().config(Preset::Fast);
        (config.film_share, config.evaluate_every) = (0.0, u64::MAX);
        let _ = config.set("task.episode_s", 0.5.into());
        let train = |updates: u64| {
            let config = Config {
                steps: updates * config.batch(),
                ..config.clone()
            };
            sums_of(2, |ranks| {
                trained(&config, Choice::Cpu, &path(&updates.to_string()), ranks);
            })
        };
        let ([messages, numbers], [more_messages, more_numbers]) = (train(1), train(2));
        let (messages, numbers) = (more_messages - messages, more_numbers - numbers);
        let parameters = last(&path("1")).policy.parameters.len();
        let ppo = &config.ppo;
        let steps = ppo.epochs * ppo.batch().div_ceil(ppo.minibatch_size);
        println!(
            "{task}: {messages} sums of {numbers} numbers an update; {steps} gradients of {parameters}"
        );
        assert!((numbers as f64) < most * (steps * parameters) as f64);
        assert!(messages < steps + 40);
    }
}

#[test]
fn a_run_goes_on_bit_for_bit_on_as_many_ranks() {
    for task in ["obstacles", "imitate", "skills", "box"] {
        let (_folder, path) = folder();
        let (half, whole) = (small(task, 2), small(task, 4));
        on_ranks(2, &half, Choice::Cpu, &path("halves"));
        let halves = on_ranks(2, &whole, Choice::Cpu, &path("halves"));
        let whole = on_ranks(2, &whole, Choice::Cpu, &path("whole"));
        assert!(halves.sections == whole.sections, "{task}");
    }
}

#[test]
fn a_run_goes_on_with_another_number_of_ranks() {
    let (_folder, path) = folder();
    for (updates, count) in [(1, 1), (2, 4), (3, 8), (4, 2), (5, 1)] {
        let checkpoint = on_ranks(
            count,
            &small("obstacles", updates),
            Choice::Cpu,
            &path("run"),
        );
        assert_eq!(checkpoint.header.steps, updates * 128);
        assert_eq!(checkpoint.header.spec.envs, 16);
    }
    let rows = std::fs::read_to_string(path("run/metrics.jsonl")).unwrap();
    assert_eq!(rows.lines().count(), 5);
}

#[test]
fn ranks_share_a_gpu() {
    for task in ["plane", "imitate"] {
        let (_folder, path) = folder();
        let config = small(task, 2);
        let cpu = on_ranks(2, &config, Choice::Cpu, &path("cpu"));
        let gpu = on_ranks(2, &config, Choice::Lavapipe, &path("gpu"));
        let difference = largest_difference(&cpu.policy.parameters, &gpu.policy.parameters);
        assert!(difference < 1e-2, "{task}: {difference}");
    }
}
