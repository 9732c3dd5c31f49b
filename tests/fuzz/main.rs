//! Readers of outside bytes, given bytes that nobody meant: none may panic, take long, or ask for more memory
//! than a multiple of what it was given.
//!
//! Every reader is tried for a second. `FOOTWORK_FUZZ_SECONDS=600 cargo test --release --test fuzz bvh` tries one
//! for ten minutes, `FOOTWORK_FUZZ_SEED` begins elsewhere. An input that fails is left in the folder that the
//! message names; copied into `tests/fuzz/corpus/READER` it is tried first from then on.

mod memory;
mod mutate;
mod seeds;

use memory::{Counting, peak_during};
use mutate::Mutator;
use seeds::Seeds;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bytes that a reader may hold at once: so many whatever it is given, and so many times its input.
const LEAST: usize = 16 << 20;
const MULTIPLE: usize = 256;
/// No input takes longer.
const PATIENCE: Duration = Duration::from_secs(2);
/// The longest input: what is quick is tried often.
const LONGEST: usize = 1 << 16;

/// One at a time: the allocator counts for all.
static TURN: Mutex<()> = Mutex::new(());

/// Tries a reader of files with this ending.
fn fuzz(reader: &str, ending: &str, seeds: Seeds, read: impl Fn(&Path)) {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let number = |name: &str| std::env::var(name).ok()?.parse().ok();
    let seconds = number("FOOTWORK_FUZZ_SECONDS").unwrap_or(1);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(format!("input.{ending}"));
    let attempt = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("a file");
        let begin = Instant::now();
        let (outcome, peak) = peak_during(|| catch_unwind(AssertUnwindSafe(|| read(&path))));
        let most = LEAST + MULTIPLE * bytes.len();
        let why = match (outcome, begin.elapsed()) {
            (Err(_), _) => Some("it panics".to_string()),
            (_, took) if took > PATIENCE => Some(format!("it takes {took:.1?}")),
            _ if peak > most => Some(format!("it holds {peak} bytes at once, of {}", bytes.len())),
            _ => None,
        };
        if let Some(why) = why {
            let kept = std::env::temp_dir().join(format!("footwork-fuzz-{reader}.{ending}"));
            std::fs::write(&kept, bytes).expect("a file");
            panic!("{reader}: {why}; the input is {}", kept.display());
        }
    };
    let all = seeds.all(reader);
    all.iter().for_each(|bytes| attempt(bytes));
    let mut mutator = Mutator::new(number("FOOTWORK_FUZZ_SEED").unwrap_or(1), &all, seeds.words);
    let end = Instant::now() + Duration::from_secs(seconds);
    let mut inputs = all.len();
    while Instant::now() < end {
        let mut bytes = mutator.next(LONGEST);
        if seeds.sealed && mutator.lot(2) {
            seeds::seal(&mut bytes);
        }
        attempt(&bytes);
        inputs += 1;
    }
    assert!(inputs > 20, "{reader}: only {inputs} inputs in {seconds} s");
}

#[test]
fn bvh() {
    fuzz("bvh", "bvh", seeds::bvh(), |path| {
        let options = footwork::motion::import::ImportOptions::default();
        let _ = footwork::motion::import::import(path, &options);
    });
}

#[test]
fn mjcf() {
    fuzz("mjcf", "xml", seeds::mjcf(), |path| {
        let _ = footwork::physics::mjcf::read(path, Default::default());
    });
}

#[test]
fn database() {
    fuzz("database", "footwork", seeds::database(), |path| {
        let Ok(database) = footwork::motion::database::Database::load(path) else {
            return;
        };
        // What has been accepted can be used.
        let _ = (
            database.minutes(),
            database.rows(),
            database.ground_motion(),
        );
        for frame in 0..database.frames() {
            let _ = database.clip(frame);
        }
    });
}

#[test]
fn index() {
    let database = seeds::small_database();
    fuzz("index", "index", seeds::index(&database), |path| {
        let (frames, candidates) = (&database.features, &database.candidates);
        let _ = footwork::matching::Index::load(path, 1, frames, candidates);
    });
}

#[test]
fn checkpoint() {
    fuzz("checkpoint", "ckpt", seeds::checkpoint(), |path| {
        if let Ok(checkpoint) = footwork::train::checkpoint::Checkpoint::load(path) {
            let seen = checkpoint.policy.observation().dim();
            let _ = checkpoint.policy.mean(&vec![0.5; seen]);
        }
    });
}

#[test]
fn configuration() {
    fuzz("configuration", "toml", seeds::configuration(), |path| {
        for entry in &footwork::train::tasks::REGISTRY {
            let config = entry.config_from(path, footwork::train::config::Base::default());
            let _ = config.map(|config| entry.check(&config));
        }
    });
}

#[test]
fn motion_list() {
    fuzz("motion_list", "toml", seeds::motion_list(), |path| {
        let model = std::sync::Arc::new(footwork::physics::scenes::humanoid());
        let list = footwork::physics::motion_list::MotionList::read(path, None);
        let _ = list.map(|list| list.load(&model, &Default::default()));
    });
}

#[test]
fn deepmimic() {
    let model = footwork::physics::scenes::humanoid();
    fuzz("deepmimic", "txt", seeds::deepmimic(), |path| {
        let _ = footwork::physics::deepmimic::read(path, &model);
    });
}

#[test]
fn roles() {
    let (clips, _) = footwork::motion::synthetic::perform(1, 0.1);
    fuzz("roles", "toml", seeds::roles(), |path| {
        let _ = footwork::motion::roles::Roles::read(path, &clips[0].skeleton);
    });
}

#[test]
fn metrics() {
    fuzz("metrics", "jsonl", seeds::metrics(), |path| {
        let _ = footwork::train::metrics::read(path, u64::MAX);
    });
}
