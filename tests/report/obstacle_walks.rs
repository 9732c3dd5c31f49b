//! `obstacle_walks`: the view from above, and the maps beside it.

use super::drawn;
use footwork::report::obstacle_walks::{self, CELLS, DrawnEpisode, End, Obstacle};

const BOX: [u8; 3] = [0xe0, 0xe3, 0xe8];
const BLOCKED: [u8; 3] = [0x8b, 0x97, 0xa8];

/// Boxes on a grid, each on its way for 0.7 m, and a walk of `steps` steps.
fn episode(boxes: usize, steps: usize, end: End) -> DrawnEpisode {
    let obstacle = |index: usize| {
        let (x, z) = ((index % 20) as f32 - 9.5, (index / 20) as f32 - 9.5);
        Obstacle {
            start: [x - 0.5, z],
            end: [x, z + 0.5],
            half: [0.2 + 0.02 * (index % 7) as f32, 0.3],
        }
    };
    let time = |step: usize| 0.2 * step as f32;
    let mut maps = [[[0; CELLS]; CELLS]; 2];
    maps[0][12][9] = 255;
    DrawnEpisode {
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
    let mut episode = DrawnEpisode {
        // Relative to the start 8 m along x and 5 m along z: right of it, and below.
        points: vec![[100.0, -50.0]],
        obstacles: vec![Obstacle {
            start: [108.0, -45.0],
            end: [108.0, -45.0],
            half: [1.0, 1.0],
        }],
        ..DrawnEpisode::default()
    };
    // Ahead and to the left, which is up and on the left.
    episode.maps[0][CELLS - 1][CELLS - 1] = 255;
    // A step before: behind and to the right.
    episode.maps[1][0][0] = 255;
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
    let far = DrawnEpisode {
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
    let lost = DrawnEpisode {
        points: vec![[0.0, 0.0], [f32::NAN, 1.0], [1.0, f32::INFINITY]],
        target: [f32::NAN; 2],
        heading: [f32::NAN, 0.0],
        ..episode(3, 0, End::Collided)
    };
    let unseen = DrawnEpisode {
        seen: usize::MAX,
        ..episode(1, 3, End::Reached)
    };
    let episodes = [
        DrawnEpisode::default(),
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
