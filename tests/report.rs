//! Pictures are whole, of the right size and not blank, whatever they are given; event
//! files hold what TensorBoard expects.

use std::collections::HashSet;
use std::fs;
use std::io::BufReader;
use std::path::Path;

use footwork::report::coverage::{self, Samples};
use footwork::report::events::{self, EventWriter};
use footwork::report::learning_curve::{self, Mark, Point};
use footwork::report::trajectories::{self, Group};
use footwork::report::{Error, picture, table::table};

struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Picture {
    fn open(path: &Path) -> Self {
        let file = BufReader::new(fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut rgb).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        Self {
            width: info.width as usize,
            height: info.height as usize,
            rgb,
        }
    }

    /// How many different colours a part of the picture has; the part is given in
    /// shares of the width and the height.
    fn colours(&self, x: (f64, f64), y: (f64, f64)) -> usize {
        let range = |(from, to): (f64, f64), size: usize| {
            (from * size as f64) as usize..(to * size as f64) as usize
        };
        let mut seen = HashSet::new();
        for row in range(y, self.height) {
            for column in range(x, self.width) {
                let at = 3 * (row * self.width + column);
                seen.insert(self.rgb[at..at + 3].to_vec());
            }
        }
        seen.len()
    }

    fn has(&self, colour: [u8; 3]) -> bool {
        self.rgb.chunks_exact(3).any(|pixel| pixel == colour)
    }
}

/// Draws into a fresh folder and checks that the picture is all that is left there.
fn drawn(draw: impl FnOnce(&Path) -> Result<(), Error>) -> Picture {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    draw(&path).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    Picture::open(&path)
}

fn training() -> Vec<Point> {
    (1..=200)
        .map(|update| {
            let part = f64::from(update) / 200.0;
            Point {
                steps: update as u64 * 5000,
                wall_s: 300.0 * part,
                success: Some(part.sqrt()),
                episode_return: Some(1000.0 * part + 20.0 * (40.0 * part).sin()),
                episode_length: Some(200.0 - 180.0 * part),
            }
        })
        .collect()
}

fn mark(steps: u64, colour: usize) -> Mark {
    Mark {
        steps,
        label: format!("{steps}"),
        colour,
    }
}

#[test]
fn a_learning_curve_fills_its_panels() {
    let marks = [mark(100_000, 1), mark(533_000, 2)];
    let picture = drawn(|path| learning_curve::draw(path, &training(), &marks));
    assert_eq!((picture.width, picture.height), (1600, 1100));
    for panel in [(0.05, 0.28), (0.33, 0.56), (0.6, 0.84)] {
        assert!(picture.colours((0.1, 0.9), panel) > 30);
    }
    assert!(picture.has([0x1e, 0x3a, 0x5f]), "the curve");
}

#[test]
fn a_learning_curve_survives_whatever_it_is_given() {
    let odd = |value| Point {
        steps: 10,
        wall_s: value,
        success: Some(value),
        episode_return: Some(value),
        episode_length: Some(value),
    };
    let equal: Vec<Point> = (0..50).map(|steps| Point { steps, ..odd(0.25) }).collect();
    let cases = [
        vec![],
        vec![Point::default()],
        vec![odd(f64::NAN)],
        vec![odd(f64::INFINITY), odd(f64::NEG_INFINITY)],
        vec![odd(0.0)],
        vec![odd(f64::MAX), odd(f64::MIN)],
        vec![odd(1e-300), odd(0.0)],
        vec![odd(-7.5), odd(f64::NAN), odd(3.0)],
        vec![training()[0]],
        vec![
            Point {
                steps: u64::MAX,
                ..odd(1e9)
            },
            odd(1.0),
        ],
        equal,
    ];
    let marks = [mark(0, 0), mark(5, 99), mark(u64::MAX, 1)];
    for points in cases {
        let picture = drawn(|path| learning_curve::draw(path, &points, &marks));
        assert!(picture.colours((0.0, 1.0), (0.0, 1.0)) > 5);
    }
}

#[test]
fn more_labels_than_fit_are_left_out() {
    let marks: Vec<Mark> = (0..60).map(|index| mark(1000 * index, 0)).collect();
    let picture = drawn(|path| learning_curve::draw(path, &training(), &marks));
    assert!(picture.height < 1300);
}

fn walk(colour: usize, reached: bool) -> trajectories::Path {
    trajectories::Path {
        points: (0..60)
            .map(|frame| frame as f32 / 20.0)
            .map(|time| [time, time.sin()])
            .collect(),
        target: [3.4, 0.2],
        reached,
        label: "2.0 s".to_owned(),
        colour,
    }
}

#[test]
fn every_stage_has_its_panel_of_paths() {
    let groups: Vec<Group> = (0..4)
        .map(|stage| Group {
            title: format!("stage {stage}"),
            paths: vec![walk(stage, stage > 0)],
        })
        .collect();
    let picture = drawn(|path| trajectories::draw(path, &groups));
    assert_eq!((picture.width, picture.height), (1978, 572));
    for panel in 0..4 {
        let left = 0.06 + 0.236 * f64::from(panel);
        assert!(picture.colours((left, left + 0.22), (0.12, 0.85)) > 30);
    }
    for colour in [[0x00, 0x72, 0xb2], [0xd5, 0x5e, 0x00]] {
        assert!(picture.has(colour));
    }
}

#[test]
fn paths_survive_whatever_they_are_given() {
    let nowhere = trajectories::Path {
        points: vec![[f32::NAN, 0.0], [f32::INFINITY, 1.0]],
        target: [f32::NAN; 2],
        ..walk(0, true)
    };
    let standing = trajectories::Path {
        points: vec![[1.0, 1.0]; 20],
        target: [1.0, 1.0],
        ..walk(1, false)
    };
    let far = trajectories::Path {
        points: vec![[0.0, 0.0], [1e30, -1e30]],
        ..walk(2, false)
    };
    let cases = [
        vec![],
        vec![trajectories::Path::default()],
        vec![nowhere],
        vec![standing],
        vec![far],
    ];
    let groups = cases.map(|paths| Group {
        title: String::new(),
        paths,
    });
    for group in &groups {
        drawn(|path| trajectories::draw(path, std::slice::from_ref(group)));
    }
    drawn(|path| trajectories::draw(path, &[]));
    let picture = drawn(|path| trajectories::draw(path, &groups));
    assert_eq!(picture.height, 2 * 572, "five panels take two rows");
}

#[test]
fn coverage_shows_both_densities_and_their_scale() {
    let waves = |scale: f32, speed: f32| -> Vec<f32> {
        (0..5000)
            .map(|frame| scale * (frame as f32 * speed).sin())
            .collect()
    };
    let speed: Vec<f32> = waves(2.0, 0.013).iter().map(|value| value.abs()).collect();
    let turning = waves(90.0, 0.0071);
    let velocity: Vec<[f32; 2]> = waves(0.5, 0.031)
        .into_iter()
        .zip(waves(2.0, 0.017))
        .map(|(side, ahead)| [side, ahead])
        .collect();
    let samples = Samples {
        rate_hz: 30.0,
        speed: &speed,
        turning: &turning,
        velocity: &velocity,
    };
    let picture = drawn(|path| coverage::draw(path, &samples));
    assert_eq!((picture.width, picture.height), (1660, 724));
    for part in [(0.08, 0.43), (0.53, 0.88), (0.9, 0.95)] {
        assert!(picture.colours(part, (0.06, 0.82)) > 10);
    }
}

#[test]
fn coverage_survives_whatever_it_is_given() {
    for (rate_hz, value, frames) in [
        (30.0, 0.0, 0),
        (30.0, 1.5, 1),
        (30.0, 1.5, 500),
        (30.0, f32::NAN, 10),
        (30.0, f32::INFINITY, 10),
        (30.0, f32::MAX, 10),
        (0.0, 1.0, 10),
        (f32::NAN, 1.0, 10),
    ] {
        let samples = Samples {
            rate_hz,
            speed: &vec![value; frames],
            turning: &vec![-value; frames],
            velocity: &vec![[value, -value]; frames],
        };
        drawn(|path| coverage::draw(path, &samples));
    }
}

#[test]
fn a_picture_that_cannot_be_written_is_an_error_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing").join("picture.png");
    let error = learning_curve::draw(&missing, &training(), &[]).unwrap_err();
    assert!(error.to_string().contains("missing"), "{error}");

    // A folder in the picture's place: everything succeeds but the last step.
    let taken = folder.path().join("taken.png");
    fs::create_dir(&taken).unwrap();
    assert!(learning_curve::draw(&taken, &training(), &[]).is_err());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_failed_picture_leaves_the_previous_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    picture::save(&path, 2, 1, &[0, 1, 2, 3, 4, 5]).unwrap();
    assert!(picture::save(&path, 2, 1, &[9; 5]).is_err(), "a byte short");
    assert_eq!(Picture::open(&path).rgb, [0, 1, 2, 3, 4, 5]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// The data of every record, after checking its length and both checksums.
fn records(mut file: &[u8]) -> Vec<Vec<u8>> {
    let mut records = Vec::new();
    while !file.is_empty() {
        let length = u64::from_le_bytes(file[..8].try_into().unwrap()) as usize;
        let (data, rest) = file[12..].split_at(length);
        assert_eq!(file[8..12], masked_crc(&file[..8]));
        assert_eq!(rest[..4], masked_crc(data));
        records.push(data.to_vec());
        file = &rest[4..];
    }
    records
}

/// CRC-32C bit by bit, from its definition.
fn masked_crc(data: &[u8]) -> [u8; 4] {
    let mut crc = u32::MAX;
    for &byte in data {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ if crc & 1 == 1 { 0x82f6_3b78 } else { 0 };
        }
    }
    (!crc)
        .rotate_right(15)
        .wrapping_add(0xa282_ead8)
        .to_le_bytes()
}

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
fn events_go_on_after_a_resume_and_after_a_torn_record() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(events::FILE_NAME);
    let add = |count: u64| {
        let mut writer = EventWriter::append(folder.path(), 0.0).unwrap();
        (0..count).for_each(|step| writer.scalar("loss", step, 0.0, f64::NAN).unwrap());
        writer.flush().unwrap();
        records(&fs::read(&path).unwrap()).len()
    };
    assert_eq!(add(3), 4, "started, with its version");
    assert_eq!(add(2), 6, "continued");

    let file = fs::read(&path).unwrap();
    fs::write(&path, &file[..file.len() - 7]).unwrap();
    assert_eq!(add(1), 6, "one torn record lost, one added");
}

#[test]
fn events_refuse_what_is_not_theirs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(events::FILE_NAME);
    fs::write(&path, "something else").unwrap();
    let error = EventWriter::append(folder.path(), 0.0).err().unwrap();
    assert!(error.to_string().contains("not an event file"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"something else");

    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    assert!(EventWriter::create(&file, 0.0).is_err());
}

#[test]
fn tables_align_numbers_to_the_right() {
    let rows = [
        vec!["walk".to_owned(), "3.25".to_owned(), "1.31 m/s".to_owned()],
        vec!["übergang".to_owned(), "12.00".to_owned(), "–".to_owned()],
        vec!["stub".to_owned()],
    ];
    let text = table(&["clip", "minutes", "speed"], &rows);
    let expected = "\
clip      minutes     speed
────────  ───────  ────────
walk         3.25  1.31 m/s
übergang    12.00         –
stub
";
    assert_eq!(text, expected);
    assert_eq!(table(&["a"], &[]), "a\n─\n");
    assert_eq!(table(&[], &[vec![]]), "\n\n\n");
}
