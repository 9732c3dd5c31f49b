//! The readers in Python and JavaScript, field by field and bit by bit against what was written.
//!
//! They need NumPy, in the interpreter that `PYTHON` names (else `python3`), and Node.

use footwork::motion::database::Database;
use footwork::motion::features::{FEATURE_DIM, MIN_FUTURE_FRAMES};
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::TempDir;

static DATABASE: LazyLock<Database> = LazyLock::new(|| {
    let (clips, roles) = synthetic::perform(1, 1.0);
    Database::build(&clips, roles, Weights::HOLDEN).expect("a minute of motion")
});

/// A program and the script that dumps what its reader reads.
type Reader = (&'static str, &'static str);

const READERS: [Reader; 2] = [("PYTHON", "dump.py"), ("NODE", "dump.mjs")];

/// Has a reader write its fields into `out`.
fn dump((variable, script): Reader, database: &Path, out: &Path) -> Output {
    let [usual, install] = match variable {
        "PYTHON" => ["python3", "python3-numpy"],
        _ => ["node", "nodejs"],
    };
    let program = std::env::var_os(variable).unwrap_or(usual.into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/readers")
        .join(script);
    let output = Command::new(&program)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .args([&script, database, out])
        .output();
    let output = output.unwrap_or_else(|error| {
        panic!("{program:?}: {error}; install {install}, or name the program by {variable}")
    });
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        !errors.contains("ModuleNotFoundError"),
        "{program:?} has no NumPy: install {install}, or name an interpreter that has it by {variable}"
    );
    output
}

/// A folder with the database in it.
fn saved() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("motion.footwork");
    DATABASE.save(&path).expect("a file");
    (folder, path)
}

fn bytes<T: bytemuck::NoUninit>(values: &[T]) -> Vec<u8> {
    bytemuck::cast_slice(values).to_vec()
}

/// The arrays of the database as both scripts write them.
fn arrays() -> [(&'static str, Vec<u8>); 10] {
    let Database {
        skeleton,
        normalisation,
        ..
    } = &*DATABASE;
    let parents = skeleton.parents.iter();
    let parents: Vec<i32> = parents.map(|p| p.map_or(-1, |p| p as i32)).collect();
    let offsets: Vec<_> = skeleton.offsets.iter().map(|o| o.to_array()).collect();
    let features = DATABASE.features.iter();
    let features: Vec<f32> = features
        .flat_map(|row| row[..FEATURE_DIM].to_vec())
        .collect();
    let hips: Vec<_> = DATABASE.hips.iter().map(|hips| hips.to_array()).collect();
    let rotations: Vec<_> = DATABASE.rotations.iter().map(|r| r.to_array()).collect();
    [
        ("parents", bytes(&parents)),
        ("offsets", bytes(&offsets)),
        ("mean", bytes(&normalisation.mean)),
        ("scale", bytes(&normalisation.scale)),
        ("features", bytes(&features)),
        ("path", bytes(&DATABASE.path)),
        ("hips", bytes(&hips)),
        ("rotations", bytes(&rotations)),
        ("candidates", bytes(&DATABASE.candidates)),
        ("motion", bytes(&DATABASE.motion)),
    ]
}

#[test]
fn every_field_is_read_as_it_was_written() {
    let (folder, database) = saved();
    for reader in READERS {
        let out = folder.path().join(reader.1);
        std::fs::create_dir(&out).unwrap();
        let output = dump(reader, &database, &out);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {errors}", reader.1);
        for (name, written) in arrays() {
            let read = std::fs::read(out.join(name)).unwrap();
            assert!(read == written, "{}: {name} differs", reader.1);
        }
        let header = std::fs::read(out.join("header.json")).unwrap();
        let header: Value = serde_json::from_slice(&header).unwrap();
        let written = json!({
            "names": DATABASE.skeleton.names,
            "roles": DATABASE.roles,
            "clips": DATABASE.clips,
            "fingerprint": DATABASE.fingerprint,
        });
        assert_eq!(header, written, "{}", reader.1);
    }
}

#[test]
fn poses_are_placed_in_the_world_as_the_crate_does() {
    let (folder, database) = saved();
    let output = dump(READERS[0], &database, folder.path());
    assert!(output.status.success(), "{output:?}");
    let read = std::fs::read(folder.path().join("world")).unwrap();
    let read: &[f32] = bytemuck::cast_slice(&read);
    let (positions, _) = DATABASE.recording(0).world(7);
    let positions = positions.iter().flat_map(|position| position.to_array());
    assert!(
        positions
            .zip(read)
            .all(|(ours, read)| (ours - read).abs() < 1e-5)
    );
}

#[test]
fn what_cannot_be_read_is_refused_with_a_sentence() {
    let (folder, database) = saved();
    let good = std::fs::read(&database).unwrap();
    let newer = [&good[..16], &2u32.to_le_bytes(), &good[20..]].concat();
    let checkpoint = [&good[..8], b"checkpt\0", &good[16..]].concat();
    let mut changed = good.clone();
    changed[1000] ^= 1;
    for (contents, sentence) in [
        (&newer, "has format version 2; this reader reads version 1"),
        (&checkpoint, "is a footwork checkpt, not a database"),
        (&changed, "its checksum does not match its contents"),
        (&b"a text".to_vec(), "is not a footwork database"),
    ] {
        std::fs::write(&database, contents).unwrap();
        assert!(Database::load(&database).is_err(), "{sentence}");
        for reader in READERS {
            let output = dump(reader, &database, folder.path());
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(
                !output.status.success() && errors.contains(sentence),
                "{errors}"
            );
        }
    }
}

#[test]
fn the_layout_is_that_of_the_documentation() {
    // Who changes one of these changes the version, the readers and `docs/database.md`.
    let (_folder, database) = saved();
    let file = std::fs::read(&database).unwrap();
    let length = u64::from_le_bytes(file[24..32].try_into().unwrap()) as usize;
    let header: Value = serde_json::from_slice(&file[32..][..length]).unwrap();
    let (frames, joints) = (DATABASE.frames(), DATABASE.skeleton.joints());
    let arrays = json!([
        ["features", 28 * frames],
        ["path", 4 * frames],
        ["hips", 3 * frames],
        ["rotations", 4 * joints * frames],
    ]);
    assert_eq!(header["arrays"], arrays);
    let keys: Vec<&String> = header["header"].as_object().unwrap().keys().collect();
    let documented = [
        "clips",
        "frames",
        "normalisation",
        "roles",
        "skeleton",
        "weights",
    ];
    assert_eq!(keys, documented);
    assert_eq!(file[16..20], 1u32.to_le_bytes());
    assert_eq!(MIN_FUTURE_FRAMES, 30);
}
