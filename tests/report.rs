//! Pictures are whole, of the right size and not blank, whatever they are given; event
//! files hold what TensorBoard expects.

use std::collections::HashSet;
use std::fs;
use std::io::BufReader;
use std::path::Path;

use footwork::report::ablation::{self, Method};
use footwork::report::coverage::{self, Samples};
use footwork::report::events::{self, EventWriter};
use footwork::report::learning_curve::{self, Level, Mark, Point};
use footwork::report::obstacle_walks::{self, CELLS, End, Episode, Obstacle};
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

    fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * self.width + x);
        [self.rgb[at], self.rgb[at + 1], self.rgb[at + 2]]
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
    let picture = drawn(|path| learning_curve::draw(path, &training(), &marks, &[]));
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
        let picture = drawn(|path| learning_curve::draw(path, &points, &marks, &[]));
        assert!(picture.colours((0.0, 1.0), (0.0, 1.0)) > 5);
    }
}

#[test]
fn more_labels_than_fit_are_left_out() {
    let marks: Vec<Mark> = (0..60).map(|index| mark(1000 * index, 0)).collect();
    let picture = drawn(|path| learning_curve::draw(path, &training(), &marks, &[]));
    assert!(picture.height < 1300);
}

fn levels(begins: &[u64]) -> Vec<Level> {
    let level = |(level, &steps)| Level { steps, level };
    begins.iter().enumerate().map(level).collect()
}

#[test]
fn levels_take_one_row_however_close_they_begin() {
    let plain = drawn(|path| learning_curve::draw(path, &training(), &[], &[]));
    for begins in [
        vec![0],
        vec![0, 90_000, 300_000, 301_000, 302_000, 999_999],
        vec![500_000; 10],
        (0..1000).map(|index| 1000 * index).collect(),
        vec![u64::MAX, 0],
    ] {
        let levels = levels(&begins);
        let picture = drawn(|path| learning_curve::draw(path, &training(), &[], &levels));
        assert_eq!(picture.height, plain.height + 30);
        assert!(picture.colours((0.0, 1.0), (0.022, 0.045)) > 10, "numbers");
    }
    let beyond = levels(&[u64::MAX]);
    let picture = drawn(|path| learning_curve::draw(path, &training(), &[], &beyond));
    assert_eq!(
        picture.rgb, plain.rgb,
        "a level beyond the end is not shown"
    );
}

#[test]
fn marks_stand_above_the_levels() {
    let (marks, levels) = ([mark(100_000, 1)], levels(&[0, 100_000]));
    let picture = drawn(|path| learning_curve::draw(path, &training(), &marks, &levels));
    for row in [(0.02, 0.045), (0.05, 0.07)] {
        assert!(picture.colours((0.1, 0.3), row) > 10);
    }
    assert!(picture.has([0xd5, 0x5e, 0x00]), "the mark");
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

const BOX: [u8; 3] = [0xe0, 0xe3, 0xe8];
const BLOCKED: [u8; 3] = [0x8b, 0x97, 0xa8];

/// Boxes on a grid, each on its way for 0.7 m, and a walk of `steps` steps.
fn episode(boxes: usize, steps: usize, end: End) -> Episode {
    let obstacle = |index: usize| {
        let (x, z) = ((index % 20) as f32 - 9.5, (index / 20) as f32 - 9.5);
        Obstacle {
            start: [x - 0.5, z],
            end: [x, z + 0.5],
            half: [0.2 + 0.02 * (index % 7) as f32, 0.3],
        }
    };
    let time = |step: usize| 0.2 * step as f32;
    let mut maps = [[[false; CELLS]; CELLS]; 2];
    maps[0][12][9] = true;
    Episode {
        title: "level 9".to_owned(),
        obstacles: (0..boxes).map(obstacle).collect(),
        points: (0..=steps)
            .map(|step| [time(step), time(step).sin()])
            .collect(),
        target: [4.0, -3.0],
        end,
        seen: steps / 2,
        heading: [0.6, 0.8],
        maps,
    }
}

#[test]
fn every_episode_has_its_panel_and_its_maps() {
    let episodes = [
        episode(100, 20, End::Reached),
        episode(100, 15, End::Collided),
        episode(100, 25, End::UnderWay),
    ];
    let picture = drawn(|path| obstacle_walks::draw(path, &episodes, 0.2));
    assert_eq!((picture.width, picture.height), (1854, 1526));
    let (panels, rows) = ([(0.06, 0.36), (0.54, 0.84)], [(0.07, 0.43), (0.55, 0.91)]);
    for (panel, row) in [(0, 0), (1, 0), (0, 1)] {
        assert!(picture.colours(panels[panel], rows[row]) > 30);
    }
    let ends = [[0x00, 0x9e, 0x73], [0xd5, 0x5e, 0x00], [0x00, 0x72, 0xb2]];
    let seen = [0xa6, 0x4d, 0x8a];
    for colour in ends.into_iter().chain([seen, BOX, BLOCKED]) {
        assert!(picture.has(colour), "{colour:x?}");
    }
}

#[test]
fn the_view_from_above_and_the_maps_are_not_mirrored() {
    let mut episode = Episode {
        // Relative to the start 8 m along x and 5 m along z: right of it, and below.
        points: vec![[100.0, -50.0]],
        obstacles: vec![Obstacle {
            start: [108.0, -45.0],
            end: [108.0, -45.0],
            half: [1.0, 1.0],
        }],
        ..Episode::default()
    };
    // Ahead and to the left, which is up and on the left.
    episode.maps[0][CELLS - 1][CELLS - 1] = true;
    // A step before: behind and to the right.
    episode.maps[1][0][0] = true;
    let picture = drawn(|path| obstacle_walks::draw(path, &[episode], 0.2));
    let metre = 560.0 / 23.0;
    let at = |x: f64, z: f64| {
        let (right, down) = (110.0 + (11.5 + x) * metre, 100.0 + (11.5 + z) * metre);
        picture.pixel(right as usize, down as usize)
    };
    assert_eq!(at(8.5, 5.5), BOX);
    for (x, z) in [(-8.5, 5.5), (8.5, -5.5), (-8.5, -5.5), (5.5, 8.5)] {
        assert_eq!(at(x, z), [255; 3]);
    }
    let map = |top: usize| {
        let (left, right, bottom) = (698 + 7, 938 - 8, top + 240 - 8);
        [
            (left, top + 7),
            (right, top + 7),
            (left, bottom),
            (right, bottom),
        ]
        .map(|(x, y)| picture.pixel(x, y) == BLOCKED)
    };
    assert_eq!(map(140), [true, false, false, false]);
    assert_eq!(map(420), [false, false, false, true]);
}

#[test]
fn episodes_survive_whatever_they_are_given() {
    let far = Episode {
        points: vec![[0.0, 0.0], [1e30, -1e30], [3.0, f32::MAX]],
        target: [1e30, 0.0],
        obstacles: vec![Obstacle {
            start: [-1e30, 0.0],
            end: [1e30, 5.0],
            half: [1e20, 1e30],
        }],
        seen: 1,
        heading: [1e30, -1e30],
        ..episode(0, 0, End::Collided)
    };
    let lost = Episode {
        points: vec![[0.0, 0.0], [f32::NAN, 1.0], [1.0, f32::INFINITY]],
        target: [f32::NAN; 2],
        heading: [f32::NAN, 0.0],
        ..episode(3, 0, End::Collided)
    };
    let unseen = Episode {
        seen: usize::MAX,
        ..episode(1, 3, End::Reached)
    };
    let episodes = [
        Episode::default(),
        episode(0, 0, End::Collided),
        episode(400, 300, End::Reached),
        far,
        lost,
        unseen,
    ];
    for step_s in [0.2, 0.0, 100.0, f32::NAN, f32::INFINITY] {
        drawn(|path| obstacle_walks::draw(path, &episodes[..3], step_s));
    }
    let picture = drawn(|path| obstacle_walks::draw(path, &episodes, 0.2));
    assert!(picture.colours((0.06, 0.36), (0.4, 0.6)) > 30, "400 boxes");
    let none = drawn(|path| obstacle_walks::draw(path, &[], 0.2));
    assert_eq!(none.width, 962);
}

fn method(colour: usize, lengths: &[usize]) -> Method {
    let seed = |(seed, &length): (usize, &usize)| {
        let points = training().into_iter().take(length);
        let scaled = |point: Point| Point {
            success: point.success.map(|share| share / (1.0 + 0.2 * seed as f64)),
            ..point
        };
        points.map(scaled).collect()
    };
    Method {
        name: format!("method {colour}"),
        colour,
        seeds: lengths.iter().enumerate().map(seed).collect(),
    }
}

#[test]
fn an_ablation_has_a_line_and_a_band_for_every_method() {
    let methods = [method(0, &[200; 5]), method(2, &[150, 200]), method(4, &[])];
    let picture = drawn(|path| ablation::draw(path, &methods));
    assert_eq!((picture.width, picture.height), (1736, 574));
    for chart in [(0.07, 0.32), (0.4, 0.65), (0.73, 0.98)] {
        assert!(picture.colours(chart, (0.14, 0.76)) > 30);
    }
    let lines = [[0x00, 0x72, 0xb2], [0x00, 0x9e, 0x73]];
    for colour in lines {
        assert!(picture.has(colour), "{colour:x?}");
    }
    assert!(!picture.has([0xe6, 0x9f, 0x00]), "nothing to show");

    let single = [method(0, &[200])];
    let without = drawn(|path| ablation::draw(path, &single));
    let light = |picture: &Picture| {
        let plot = |index: usize| index / picture.width > 100;
        let pixels = picture.rgb.chunks_exact(3).enumerate();
        let band = |pixel: &[u8]| pixel[0] < 210 && pixel[2] > 225;
        pixels
            .filter(|&(index, pixel)| plot(index) && band(pixel))
            .count()
    };
    assert!(
        light(&picture) > 10 * light(&without),
        "bands of several seeds only"
    );
}

#[test]
fn an_ablation_survives_whatever_it_is_given() {
    let odd = |value| Point {
        steps: 10,
        success: Some(value),
        episode_return: Some(value),
        episode_length: None,
        wall_s: 0.0,
    };
    let late = Point {
        steps: u64::MAX,
        ..odd(0.5)
    };
    let of = |seeds| Method {
        seeds,
        ..method(1, &[])
    };
    let cases = [
        vec![],
        vec![method(0, &[])],
        vec![method(0, &[0, 1, 200])],
        vec![method(0, &[1])],
        vec![of(vec![vec![odd(f64::NAN)], vec![odd(f64::INFINITY)]])],
        vec![of(vec![
            vec![odd(f64::MAX)],
            vec![odd(f64::MIN)],
            vec![odd(1.0)],
        ])],
        vec![of(vec![vec![odd(1.0), odd(2.0)], vec![odd(0.0), late]])],
        (0..40).map(|colour| method(colour, &[20])).collect(),
    ];
    for methods in cases {
        let picture = drawn(|path| ablation::draw(path, &methods));
        assert!(picture.colours((0.0, 1.0), (0.0, 1.0)) > 5);
    }
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
    let error = learning_curve::draw(&missing, &training(), &[], &[]).unwrap_err();
    assert!(error.to_string().contains("missing"), "{error}");

    // A folder in the picture's place: everything succeeds but the last step.
    let taken = folder.path().join("taken.png");
    fs::create_dir(&taken).unwrap();
    assert!(learning_curve::draw(&taken, &training(), &[], &[]).is_err());
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
fn events_refuse_what_is_no_folder() {
    let folder = tempfile::tempdir().unwrap();
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
