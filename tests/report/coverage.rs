//! `coverage`: what a database holds, as densities.

use super::drawn;
use footwork::report::coverage::{self, CoverageSamples};

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
    let samples = CoverageSamples {
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
        let samples = CoverageSamples {
            rate_hz,
            speed: &vec![value; frames],
            turning: &vec![-value; frames],
            velocity: &vec![[value, -value]; frames],
        };
        drawn(|path| coverage::draw(path, &samples));
    }
}
