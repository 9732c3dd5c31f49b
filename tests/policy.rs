//! The networks are the same on both devices, whatever runs their convolutions: answers and
//! gradients agree up to rounding.

use burn::tensor::{Device as Tensors, Tensor};
use footwork::gpu::{Choice, Device};
use footwork::kernels::layout::GOAL;
use footwork::kernels::rng::{gaussian, random4};
use footwork::motion::features::TRAJECTORY;
use footwork::ppo::network::Shape;
use footwork::tensors::{read, upload, vector};
use footwork::train::config::{Config, Kind, Preset};

const SAMPLES: usize = 9;

/// Observations with binary maps.
fn observation(width: usize) -> Vec<f32> {
    let draw = |i: usize| random4(3, i as u32, 0, 0);
    let number = |i: usize| match i % width {
        ..GOAL => gaussian(draw(i)),
        _ => (draw(i)[0] & 1) as f32,
    };
    (0..SAMPLES * width).map(number).collect()
}

/// Mean, value and the gradient of a loss of both.
fn answers(shape: &Shape, width: usize, device: &Tensors) -> [Vec<f32>; 3] {
    let mut parameters = shape.init(5, -0.5);
    // The last layers begin near zero: nothing would be seen through them.
    for (i, parameter) in parameters.iter_mut().enumerate() {
        *parameter += 0.05 * gaussian(random4(7, i as u32, 0, 0));
    }
    let policy = shape.cut(&vector(&parameters, device));
    let observation = upload(observation(width), [SAMPLES, width], device);
    let mean = policy.mean(observation.clone());
    let value = policy.value(observation.clone());
    let study = policy.study(&observation);
    let spread = study.log_std.clone().exp().sum_dim(0);
    let loss = total(study.mean().square())
        .add(study.value().square().sum_dim(0))
        .add(spread);
    let gradient = study.gradient(&loss.backward());
    [read(mean), read(value), read(gradient)].map(|values| values.expect("the device is there"))
}

fn total(values: Tensor<2>) -> Tensor<1> {
    values.reshape([SAMPLES * TRAJECTORY]).sum_dim(0)
}

#[track_caller]
fn close(got: &[f32], wanted: &[f32]) {
    assert_eq!(got.len(), wanted.len());
    let largest = wanted.iter().fold(0.0f32, |most, w| most.max(w.abs()));
    assert!(largest > 1e-3, "nothing to compare");
    for (g, w) in got.iter().zip(wanted) {
        assert!((g - w).abs() <= 2e-4 * largest, "{g} instead of {w}");
    }
}

fn agree(kind: Kind, preset: Preset) {
    let config = Config::preset(kind, preset);
    let width = config.task.width();
    let shape = Shape::new(&config.ppo.network, width).expect("a network that fits");
    let lavapipe = Device::open(Choice::Lavapipe)
        .expect("an adapter")
        .tensors();
    let cpu = answers(&shape, width, &Tensors::flex());
    let gpu = answers(&shape, width, &lavapipe);
    assert_eq!(cpu[2].len(), shape.parameters());
    for (got, wanted) in gpu.iter().zip(&cpu) {
        close(got, wanted);
    }
}

#[test]
fn the_plane_s_networks_agree() {
    agree(Kind::Plane, Preset::Fast);
}

#[test]
fn the_networks_among_obstacles_agree() {
    agree(Kind::Obstacles, Preset::Fast);
}

#[test]
fn the_paper_s_networks_among_obstacles_agree() {
    agree(Kind::Obstacles, Preset::Paper);
}
