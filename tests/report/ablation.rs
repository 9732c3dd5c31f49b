//! `ablation`: a line and a band for every method.

use super::{Picture, drawn, training};
use footwork::report::ablation::{self, Method};
use footwork::report::learning_curve::Point;

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
        ..Point::default()
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
