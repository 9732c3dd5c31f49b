//! Folders as people have them.

use super::{import, walking};
use footwork::motion::bvh;
use footwork::motion::import::{ImportOptions, ImportedMotion};
use std::path::Path;

/// A folder with the walk as `walk.bvh`.
fn with_walk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("walk.bvh"));
    folder
}

fn write(path: &Path) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    bvh::write(path, &walking(90)).unwrap();
}

fn names(import: &ImportedMotion) -> Vec<&str> {
    import.clips.iter().map(|clip| &*clip.name).collect()
}

#[test]
fn hidden_files_are_no_recordings() {
    let folder = with_walk();
    std::fs::write(folder.path().join("._walk.bvh"), b"\0\x05\x16\x07\xff").unwrap();
    std::fs::write(folder.path().join(".hidden.bvh"), "").unwrap();
    write(&folder.path().join(".git/more.bvh"));
    let import = import(folder.path(), &ImportOptions::default()).unwrap();
    assert_eq!((names(&import), import.notes.len()), (vec!["walk"], 0));
}

#[test]
fn sub_folders_are_mentioned_or_read() {
    let folder = with_walk();
    for path in ["b/w.bvh", "a/w.bvh", "a/deep/w.bvh"] {
        write(&folder.path().join(path));
    }
    let flat = import(folder.path(), &ImportOptions::default()).unwrap();
    assert_eq!(names(&flat), ["walk"]);
    assert_eq!(
        flat.notes,
        ["recordings in sub-folders were not read: 3 in a, b; `--recursive` reads them"]
    );
    let recursive = ImportOptions {
        recursive: true,
        ..ImportOptions::default()
    };
    let all = import(folder.path(), &recursive).unwrap();
    assert_eq!(names(&all), ["walk", "a/deep/w", "a/w", "b/w"]);
    assert!(all.notes.is_empty(), "{:?}", all.notes);
    std::fs::remove_file(folder.path().join("walk.bvh")).unwrap();
    let message = import(folder.path(), &ImportOptions::default())
        .unwrap_err()
        .to_string();
    assert!(message.contains("--recursive"), "{message}");
}

#[test]
fn a_manifest_may_be_a_strangers_or_a_spreadsheets() {
    let folder = with_walk();
    let path = folder.path().join("manifest.csv");
    for table in [&b"id,url,bytes\n1,x,2\n"[..], b"", b"PK\x03\x04\xff\xfe"] {
        std::fs::write(&path, table).unwrap();
        let import = import(folder.path(), &ImportOptions::default()).unwrap();
        assert!(
            import.notes[0].contains("manifest.csv has no column `file`"),
            "{:?}",
            import.notes
        );
        assert_eq!((names(&import), import.notes.len()), (vec!["walk"], 1));
    }
    let table = "\u{feff}file;skip_head;unit_m;licence\r\nwalk.bvh;10;0,02;\"CC; free\"\r\n";
    std::fs::write(&path, table).unwrap();
    let import = import(folder.path(), &ImportOptions::default()).unwrap();
    let clip = &import.clips[0];
    assert_eq!((clip.frames(), &*clip.licence), (80, "CC; free"));
    assert_eq!(import.findings[0].unit_m, Some(0.02));
    std::fs::write(&path, "file,skip_head\nwalk.bvh,x\n").unwrap();
    let message = import_error(folder.path());
    assert!(message.contains("line 2: skip_head is 'x'"), "{message}");
}

fn import_error(path: &Path) -> String {
    import(path, &ImportOptions::default())
        .unwrap_err()
        .to_string()
}

#[test]
fn all_bad_files_are_named_at_once_or_left_out() {
    let folder = with_walk();
    write(&folder.path().join("walk2.bvh"));
    let text = bvh::to_text(&walking(90)).unwrap();
    for (name, text) in [
        ("empty", ""),
        ("other", &text.replace("Hips", "Pelvis")),
        ("truncated", &text[..text.len() / 2]),
        (
            "unknown1",
            &text
                .replace("Left", "Sinister")
                .replace("OFFSET 0 -42 0", "OFFSET 0 -1 0"),
        ),
    ] {
        std::fs::write(folder.path().join(format!("{name}.bvh")), text).unwrap();
    }
    let message = import_error(folder.path());
    assert!(message.starts_with("4 of 6 files in "), "{message}");
    for part in [
        "--skip-bad",
        "empty.bvh, line 1: the file is empty",
        "two different skeletons",
        "truncated.bvh, line ",
        "unknown1.bvh: unknown skeleton",
    ] {
        assert!(message.contains(part), "{part} / {message}");
    }
    let skip = ImportOptions {
        skip_bad: true,
        ..ImportOptions::default()
    };
    let import = import(folder.path(), &skip).unwrap();
    assert_eq!(names(&import), ["walk", "walk2"]);
    assert!(
        import.notes[0].starts_with("4 of 6 files left out"),
        "{:?}",
        import.notes
    );
    assert!(
        import.notes[0].contains("empty.bvh, line 1"),
        "{:?}",
        import.notes
    );

    for name in ["walk", "walk2", "other"] {
        std::fs::remove_file(folder.path().join(format!("{name}.bvh"))).unwrap();
    }
    let message = super::import(folder.path(), &skip).unwrap_err().to_string();
    assert!(message.starts_with("3 of 3 files in "), "{message}");
}
