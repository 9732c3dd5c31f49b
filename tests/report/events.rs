//! `events`: what TensorBoard reads.

use crate::event_file::{images, records};
use footwork::report::events::{self, EventWriter};
use footwork::report::png_file;
use std::fs;

#[test]
fn events_decode() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = EventWriter::create(folder.path(), 1.5).unwrap();
    writer.scalar("a/b", 300, 2.5, 0.25).unwrap();
    writer.flush().unwrap();
    let file = fs::read(folder.path().join(events::FILE_NAME)).unwrap();

    let mut version = vec![0x09];
    version.extend(1.5_f64.to_le_bytes());
    version.extend([0x1a, 13]);
    version.extend(b"brain.Event:2");
    let mut scalar = vec![0x09];
    scalar.extend(2.5_f64.to_le_bytes());
    scalar.extend([0x10, 0xac, 0x02, 0x2a, 12, 0x0a, 10, 0x0a, 3]);
    scalar.extend(b"a/b");
    scalar.push(0x15);
    scalar.extend(0.25_f32.to_le_bytes());
    assert_eq!(records(&file), [version, scalar]);
}

#[test]
fn events_refuse_what_is_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    assert!(EventWriter::create(&file, 0.0).is_err());
}

#[test]
fn pictures_decode() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("picture.png");
    png_file::save(&picture, 3, 2, &[7; 18]).unwrap();
    let png = fs::read(&picture).unwrap();
    let gif = b"GIF89a\x40\x01\xb4\x00 and so on".to_vec();
    let mut writer = EventWriter::create(folder.path(), 0.0).unwrap();
    writer.image("episodes/walks", 20_000, 1.0, &png).unwrap();
    writer.scalar("a/b", 20_000, 1.0, 0.5).unwrap();
    writer.image("episodes/film", 1 << 33, 2.0, &gif).unwrap();
    // What is no picture is not written.
    let error = writer.image("episodes/film", 3, 2.0, b"text").unwrap_err();
    assert!(error.to_string().contains("episodes/film"), "{error}");
    writer
        .image("episodes/film", 3, 2.0, b"GIF89a")
        .unwrap_err();
    writer.flush().unwrap();

    let file = fs::read(folder.path().join(events::FILE_NAME)).unwrap();
    assert_eq!(records(&file).len(), 4);
    let found = images(&file);
    let told = found.iter().map(|one| (&*one.tag, one.step, one.size));
    assert_eq!(
        told.collect::<Vec<_>>(),
        [
            ("episodes/walks", 20_000, [3, 2]),
            ("episodes/film", 1 << 33, [320, 180])
        ]
    );
    assert!(found[0].file == png && found[1].file == gif);
}
