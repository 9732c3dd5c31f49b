//! Policy, critic and their learning are the same on both devices, whatever runs them: our own kernels
//! on the CPU, and on lavapipe burn's, whose gradients are burn's own, or launches of ours where all layers are
//! dense. They agree up to rounding.

use burn::tensor::{Device as Tensors, Tensor};
use footwork::gpu::{Choice, Device};
use footwork::kernels::locomotion::locomotion_layout::{BASE_OBS_DIM, MAP_OBS_DIM};
use footwork::kernels::rng::{gaussian, random4};
use footwork::motion::features::TRAJECTORY_DIM;
use footwork::rl::ppo::Ppo;
use footwork::nn::layer::Convolution;
use footwork::nn::network::{Network, Shape};
use footwork::rl::rollout::Rollout;
use footwork::rl::ppo::update::Learner;
use footwork::nn::tensors::{mean, read, sum, upload, vector};
use footwork::train::config::{Config, Kind, Preset};

/// More than a chunk, and no whole number of pieces.
const SAMPLES: usize = 75;

fn normal(length: usize, stream: u32) -> Vec<f32> {
    let normal = |i| gaussian(random4(1, i, 0, stream));
    (0..length as u32).map(normal).collect()
}

/// Observations whose maps are binary.
fn observations(width: usize) -> Vec<f32> {
    let mut all = normal(SAMPLES * width, 3);
    for row in all.chunks_exact_mut(width) {
        row[BASE_OBS_DIM..]
            .iter_mut()
            .for_each(|cell| *cell = f32::from(*cell > 0.0));
    }
    all
}

/// Parameters through whose last layers, too, something is seen.
fn parameters(shape: &Shape) -> Vec<f32> {
    let (begun, noise) = (shape.init(5, -0.5), normal(shape.parameters(), 7));
    begun.iter().zip(noise).map(|(p, n)| p + 0.05 * n).collect()
}

fn rollout(width: usize, device: &Tensors) -> Rollout {
    let scalars = |stream, scale: f32, shift: f32| {
        let values: Vec<f32> = normal(SAMPLES, stream)
            .iter()
            .map(|value| scale * value + shift)
            .collect();
        vector(&values, device)
    };
    let actions = |stream| {
        upload(
            normal(SAMPLES * TRAJECTORY_DIM, stream),
            [SAMPLES, TRAJECTORY_DIM],
            device,
        )
    };
    Rollout {
        observation: upload(observations(width), [SAMPLES, width], device),
        action: actions(11),
        mean: actions(12),
        // About what the actions have: some ratios are within the clip range, most are not.
        log_prob: scalars(13, 2.0, -22.0),
        value: scalars(14, 1.0, 0.0),
        advantage: scalars(15, 3.0, 1.0),
        target: scalars(16, 2.0, 0.5),
        log_std: vector(&[-0.4; TRAJECTORY_DIM], device),
        act_s: 0.0,
        simulate_s: 0.0,
    }
}

/// Mean, value, losses, and the gradient of a whole batch as Adam has taken it in.
fn answers(ppo: &Ppo, width: usize, device: &Device) -> [Vec<f32>; 4] {
    let mut learner = Learner::new(ppo, width, device, 1).expect("a network that fits");
    let device = &device.tensors();
    learner.parameters = vector(&parameters(&learner.shape), device);
    let policy = learner.policy();
    let observation = upload(observations(width), [SAMPLES, width], device);
    let mean = policy.mean(observation.clone());
    let value = policy.value(observation);
    let losses = learner.update(&rollout(width, device), ppo);
    [
        read(mean),
        read(value),
        read(losses),
        read(learner.adam.first),
    ]
    .map(|values| values.expect("the device is there"))
}

#[track_caller]
fn close(got: &[f32], wanted: &[f32], what: &str) {
    assert_eq!(got.len(), wanted.len());
    let largest = wanted.iter().fold(0.0f32, |most, w| most.max(w.abs()));
    assert!(largest > 1e-4, "{what}: nothing to compare");
    for (i, (g, w)) in got.iter().zip(wanted).enumerate() {
        assert!(
            (g - w).abs() <= 3e-4 * largest,
            "{what} {i}: {g} instead of {w}"
        );
    }
}

/// One step on all samples at once.
fn agree(mut ppo: Ppo, width: usize) {
    (ppo.epochs, ppo.minibatch) = (1, SAMPLES);
    (ppo.envs, ppo.horizon) = (SAMPLES, 1);
    let lavapipe = Device::open(Choice::Lavapipe).expect("an adapter");
    let cpu = answers(&ppo, width, &Device::Cpu);
    let gpu = answers(&ppo, width, &lavapipe);
    for (i, what) in ["mean", "value", "losses", "gradient"]
        .into_iter()
        .enumerate()
    {
        close(&cpu[i], &gpu[i], what);
    }
}

fn preset(kind: Kind, preset: Preset) -> Ppo {
    Config::preset(kind, preset).ppo
}

#[test]
fn the_plane_s_networks_agree() {
    agree(preset(Kind::Plane, Preset::Fast), BASE_OBS_DIM);
}

/// With a KL penalty and a value clip.
#[test]
fn the_paper_s_networks_on_the_plane_agree() {
    agree(preset(Kind::Plane, Preset::Paper), BASE_OBS_DIM);
}

#[test]
fn the_networks_among_obstacles_agree() {
    agree(preset(Kind::Obstacles, Preset::Fast), BASE_OBS_DIM + MAP_OBS_DIM);
}

#[test]
fn the_paper_s_networks_among_obstacles_agree() {
    agree(preset(Kind::Obstacles, Preset::Paper), BASE_OBS_DIM + MAP_OBS_DIM);
}

/// Widths that no block of registers fits, and all terms of the loss.
#[test]
fn odd_networks_agree() {
    let convolution = |filters, size, stride| Convolution {
        filters,
        size,
        stride,
    };
    let networks: [(&[Convolution], &[usize], &[usize]); 4] = [
        (
            &[convolution(5, 3, 1), convolution(7, 2, 3)],
            &[13],
            &[29, 6],
        ),
        (&[convolution(53, 3, 2), convolution(35, 7, 1)], &[], &[9]),
        (&[convolution(20, 16, 1)], &[31], &[]),
        (&[], &[17, 3], &[33]),
    ];
    for (convolutions, sight, hidden) in networks {
        let ppo = Ppo {
            network: Network {
                convolutions: convolutions.to_vec(),
                sight: sight.to_vec(),
                hidden: hidden.to_vec(),
            },
            value_clip: 0.2,
            entropy_coefficient: 0.01,
            kl_coefficient: 0.5,
            max_gradient: 0.5,
            ..preset(Kind::Obstacles, Preset::Fast)
        };
        agree(ppo, BASE_OBS_DIM + MAP_OBS_DIM);
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    for (kind, width) in [(Kind::Plane, BASE_OBS_DIM), (Kind::Obstacles, BASE_OBS_DIM + MAP_OBS_DIM)] {
        let mut ppo = preset(kind, Preset::Fast);
        (ppo.epochs, ppo.minibatch) = (2, 40);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().expect("threads start");
            pool.install(|| answers(&ppo, width, &Device::Cpu))
        };
        assert_eq!(on(1), on(2));
    }
}

#[test]
fn a_sample_does_not_depend_on_its_neighbours() {
    let (ppo, width) = (preset(Kind::Obstacles, Preset::Fast), BASE_OBS_DIM + MAP_OBS_DIM);
    let device = Tensors::flex();
    let shape = Shape::new(&ppo.network, width).expect("a network that fits");
    let policy = shape.cut(&vector(&parameters(&shape), &device));
    let all = observations(width);
    let mean = |rows: &[f32]| {
        let samples = rows.len() / width;
        read(policy.mean(upload(rows.to_vec(), [samples, width], &device))).expect("the CPU")
    };
    let one = mean(&all[33 * width..34 * width]);
    assert_eq!(mean(&all)[33 * TRAJECTORY_DIM..34 * TRAJECTORY_DIM], one);
}

/// What launches of our own would need at once, lavapipe has no buffer for.
#[test]
fn networks_wider_than_a_buffer_answer_all_the_same() {
    let mut ppo = preset(Kind::Plane, Preset::Fast);
    (ppo.envs, ppo.horizon, ppo.network.hidden) = (1024, 16, vec![1100]);
    let lavapipe = Device::open(Choice::Lavapipe).expect("an adapter");
    let mean = |device: &Device| {
        let learner = Learner::new(&ppo, BASE_OBS_DIM, device, 1).expect("a network that fits");
        let observation = upload(observations(BASE_OBS_DIM), [SAMPLES, BASE_OBS_DIM], &device.tensors());
        read(learner.policy().mean(observation)).expect("answers")
    };
    close(&mean(&lavapipe), &mean(&Device::Cpu), "mean");
}

#[test]
fn filters_that_do_not_fit_are_refused() {
    let fits = |size: usize, stride: usize, filters: usize| {
        let convolution = Convolution {
            filters,
            size,
            stride,
        };
        let network = Network {
            convolutions: vec![convolution; 2],
            sight: vec![],
            hidden: vec![8],
        };
        Shape::new(&network, BASE_OBS_DIM + MAP_OBS_DIM).is_some()
    };
    assert!(fits(8, 1, 4));
    assert!(!fits(9, 1, 4));
    assert!(!fits(4, 0, 4) && !fits(0, 1, 4) && !fits(4, 1, 0));
}

/// burn's own sum of a vector leaves out most of a long one on lavapipe.
#[test]
fn vectors_of_any_length_are_summed_whole() {
    let lavapipe = Device::open(Choice::Lavapipe)
        .expect("an adapter")
        .tensors();
    for device in [Tensors::flex(), lavapipe] {
        for length in [1, 511, 512, 1000, 65_534, 65_536, 226_553, 3_000_000] {
            let ones = Tensor::<1>::ones([length], &device);
            assert_eq!(read(sum(ones.clone())).expect("a number"), [length as f32]);
            let mean = read(mean(ones)).expect("a number")[0];
            assert!((mean - 1.0).abs() < 1e-6, "{mean}");
        }
    }
}
