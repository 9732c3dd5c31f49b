//! `learning_curve`: panels, marks and levels.

use super::{drawn, training};
use footwork::report::learning_curve::{self, Level, Mark, Point};

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
        fall: Some(value),
        style_reward: Some(value),
        task_weight: Some(value),
        recorded_accuracy: Some(value),
        agent_accuracy: Some(value),
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

#[test]
fn a_training_with_a_discriminator_has_its_panels() {
    let plain = drawn(|path| learning_curve::draw(path, &training(), &[], &[]));
    let styled: Vec<Point> = training()
        .into_iter()
        .map(|point| Point {
            fall: point.success,
            style_reward: Some(0.4),
            recorded_accuracy: Some(0.99),
            agent_accuracy: Some(0.97),
            ..point
        })
        .collect();
    let picture = drawn(|path| learning_curve::draw(path, &styled, &[], &[]));
    assert!(picture.height > plain.height + 3 * 250);
    assert!(picture.has([0xd5, 0x5e, 0x00]), "the recordings' line");
    let weighed: Vec<Point> = styled
        .into_iter()
        .map(|point| Point {
            task_weight: Some(0.6),
            ..point
        })
        .collect();
    let weighed = drawn(|path| learning_curve::draw(path, &weighed, &[], &[]));
    assert!(weighed.height > picture.height + 250, "one for the weight");
}
