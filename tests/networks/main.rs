//! Networks and PPO's objective on every engine, against burn's tensors and their gradients: custom kernels
//! and products of matrices on the CPU; on lavapipe fused WGSL kernels and tensors. They agree up to
//! rounding.

#[expect(
    clippy::disallowed_methods,
    reason = "on the CPU, in an order that does not change"
)]
mod autodiff;
mod penalty;
mod refused;
mod running;
mod task_weight;

use footwork::gpu::{Array, Choice, Device};
use footwork::kernels::rng::{gaussian, random4};
use footwork::nn::layer::{Activation, Convolution};
use footwork::nn::observation::ObservationSpec;
use footwork::nn::{ActorCritic, Adam, Engine, EngineSize, NetworkConfig, Policy, Rows};
use footwork::rl::ppo::loss::{Diversity, LossCoefficients, PpoLoss, SUMS};

const ACTION: usize = 5;
/// A vector of 11 numbers, and two maps of 16 x 16.
const VECTOR: usize = 11;
const GRID: [usize; 3] = [16, 16, 2];
/// More than a chunk, and no whole number of splits.
const SAMPLES: usize = 75;

fn normal(length: usize, stream: u32) -> Vec<f32> {
    let normal = |i| gaussian(random4(1, i, 0, stream));
    (0..length as u32).map(normal).collect()
}

fn lavapipe() -> Device {
    Device::open(Choice::Lavapipe).expect("an adapter")
}

/// What learns, and from what.
struct Case {
    networks: ActorCritic,
    parameters: Vec<f32>,
    /// `[samples][width]`
    samples: Vec<f32>,
    width: usize,
    old_log_std: Vec<f32>,
    coefficients: LossCoefficients,
    diversity: Diversity,
}

/// What an engine makes of a case.
struct Outcome {
    mean: Vec<f32>,
    value: Vec<f32>,
    gradient: Vec<f32>,
    sums: Vec<f32>,
}

impl Case {
    fn new(config: &NetworkConfig, observation: ObservationSpec, samples: usize) -> Case {
        let networks =
            ActorCritic::new(config, &observation, ACTION, 1).expect("networks that fit");
        // Something is seen through the last layers, too.
        let begun = networks.init(5, -0.5, &[0.1; ACTION]);
        let noise = normal(networks.parameters(), 7).into_iter();
        let parameters = begun.iter().zip(noise).map(|(p, n)| p + 0.03 * n).collect();
        let dim = observation.dim();
        let width = dim + 2 * ACTION + 4;
        let mut rows = normal(samples * width, 3);
        for row in rows.chunks_exact_mut(width) {
            // Maps are binary.
            let maps = row[observation.vector..dim].iter_mut();
            maps.for_each(|cell| *cell = f32::from(*cell > 0.0));
            // About what the actions have: some ratios are within the clip range, some are not.
            row[width - 4] = 0.5 * row[width - 4] - 5.5;
        }
        Case {
            networks,
            parameters,
            samples: rows,
            width,
            old_log_std: vec![-0.4; ACTION],
            coefficients: LossCoefficients {
                clip: 0.2,
                value_clip: 0.4,
                value_coefficient: 0.7,
                entropy_coefficient: 0.01,
                kl_coefficient: 0.5,
                std_coefficient: 1.0,
                inv_count: 1.0 / samples as f32,
            },
            diversity: Diversity::default(),
        }
    }

    /// Samples that end with the action under another latent, and with both latents.
    fn diverse(mut self, latent: usize, weight: f32) -> Case {
        let more = ACTION + 2 * latent;
        let ends = normal(self.count() * more, 13);
        let rows = self.samples.chunks_exact(self.width);
        let rows = rows.zip(ends.chunks_exact(more));
        self.samples = rows.flat_map(|(row, end)| [row, end].concat()).collect();
        self.width += more;
        self.diversity = Diversity { latent, weight };
        self
    }

    fn count(&self) -> usize {
        self.samples.len() / self.width
    }

    fn size(&self) -> EngineSize {
        EngineSize {
            parameters: self.networks.parameters(),
            extras: ACTION + SUMS,
            max_rows: self.count(),
            minibatch: self.count(),
        }
    }

    fn engine(&self, device: &Device) -> Engine {
        let size = self.size();
        let networks = self.networks.networks();
        Engine::new(
            device,
            networks,
            size.parameters,
            size.extras,
            size.max_rows,
            size.minibatch,
        )
        .expect("an engine")
    }

    /// Observations without what follows them.
    fn observations(&self) -> Vec<f32> {
        let dim = self.networks.actor.observation().dim();
        let rows = self.samples.chunks_exact(self.width);
        rows.flat_map(|row| &row[..dim]).copied().collect()
    }

    /// By the engine that the device has for such networks.
    fn on(&self, device: &Device) -> Outcome {
        self.by(self.engine(device), device)
    }

    /// In tensors, whatever the networks.
    fn layerwise(&self) -> Outcome {
        let device = lavapipe();
        let engine = Engine::layerwise(&device, self.networks.networks(), self.size());
        self.by(engine.expect("an engine"), &device)
    }

    fn by(&self, mut engine: Engine, device: &Device) -> Outcome {
        let array = |values: &[f32]| Array::from_slice(device, values);
        let (parameters, observations) = (array(&self.parameters), array(&self.observations()));
        let count = self.count();
        let mut out = array(&vec![7.0; 2 + count * (ACTION + 1)]);
        engine.forward(0, &parameters, &observations, 0, count, &mut out, 1);
        // Some rows after others.
        let (at, half) = (1 + count * ACTION, count / 2);
        engine.forward(1, &parameters, &observations, 0, half, &mut out, at);
        let rest = count - half;
        engine.forward(
            1,
            &parameters,
            &observations,
            half,
            rest,
            &mut out,
            at + half,
        );
        let old_log_std = array(&self.old_log_std);
        let objective = self.objective(&old_log_std);
        let mut gradient = array(&vec![9.0; self.parameters.len()]);
        let mut sums = array(&[0.5; SUMS]);
        engine.gradient(
            &parameters,
            &array(&self.samples),
            self.width,
            Rows::Range(0..count),
            &objective,
            &mut gradient,
            &mut sums,
        );
        self.outcome(device, &out, &gradient, &sums)
    }

    fn objective<'a>(&self, old_log_std: &'a Array) -> PpoLoss<'a> {
        PpoLoss {
            action: ACTION,
            values: 1,
            log_std: self.networks.log_std(),
            old_log_std,
            diversity: self.diversity,
            coefficients: self.coefficients,
        }
    }

    fn outcome(&self, device: &Device, out: &Array, gradient: &Array, sums: &Array) -> Outcome {
        let read = |array: &Array| array.read(device).expect("the device is there");
        let out = read(out);
        assert_eq!(
            [out[0], out[out.len() - 1]],
            [7.0; 2],
            "nothing else is written"
        );
        let (mean, value) = out[1..out.len() - 1].split_at(self.count() * ACTION);
        Outcome {
            mean: mean.to_vec(),
            value: value.to_vec(),
            gradient: read(gradient),
            sums: read(sums).into_iter().map(|sum| sum - 0.5).collect(),
        }
    }

    fn oracle(&self) -> Outcome {
        let count = self.count();
        let flat = autodiff::leaf(&self.parameters);
        let samples = autodiff::tensor(&self.samples, [count, self.width]);
        let dim = self.networks.actor.observation().dim();
        let observation = burn::tensor::Tensor::from_inner(samples.clone().narrow(1, 0, dim));
        let networks = [&self.networks.actor, &self.networks.critic];
        let outputs = networks.map(|n| autodiff::outputs(n, &flat, observation.clone()));
        let [mean, value] = [0, 1].map(|n| autodiff::values(outputs[n].clone().inner()));
        let log_std = flat.clone().slice([self.networks.log_std()]);
        let old_log_std = autodiff::tensor(&self.old_log_std, [ACTION]);
        let (loss, sums) = autodiff::ppo_loss(
            &samples,
            ACTION,
            outputs,
            log_std,
            old_log_std,
            &self.coefficients,
        );
        Outcome {
            mean,
            value,
            gradient: autodiff::gradient(&flat, &loss.backward()),
            sums: sums.to_vec(),
        }
    }
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

impl Outcome {
    #[track_caller]
    fn agrees(&self, oracle: &Outcome, what: &str) {
        close(&self.mean, &oracle.mean, &format!("{what}: mean"));
        close(&self.value, &oracle.value, &format!("{what}: value"));
        close(
            &self.gradient,
            &oracle.gradient,
            &format!("{what}: gradient"),
        );
        close(&self.sums, &oracle.sums, &format!("{what}: sums"));
    }
}

fn plain() -> ObservationSpec {
    ObservationSpec {
        vector: VECTOR,
        grid: None,
    }
}

fn with_maps() -> ObservationSpec {
    ObservationSpec {
        vector: VECTOR,
        grid: Some(GRID),
    }
}

fn dense(hidden: &[usize], activation: Activation) -> NetworkConfig {
    NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden: hidden.to_vec(),
        activation,
    }
}

fn convolution(filters: usize, size: usize, stride: usize) -> Convolution {
    Convolution {
        filters,
        size,
        stride,
    }
}

/// On all engines.
fn agree(config: &NetworkConfig, observation: ObservationSpec, samples: usize) {
    let case = Case::new(config, observation, samples);
    let oracle = case.oracle();
    let what = format!("{:?}, {:?}", config.hidden, config.activation);
    case.on(&Device::Cpu)
        .agrees(&oracle, &format!("cpu, {what}"));
    case.on(&lavapipe())
        .agrees(&oracle, &format!("gpu, {what}"));
    case.layerwise()
        .agrees(&oracle, &format!("tensors, {what}"));
}

/// On a GPU that has fused kernels for them; a hidden layer of any activation is not the output layer.
#[test]
fn narrow_dense_networks_agree() {
    for activation in [Activation::Tanh, Activation::Relu, Activation::Identity] {
        for (hidden, samples) in [
            (&[32, 32][..], SAMPLES),
            (&[17, 3, 33], 200),
            (&[], 9),
            (&[128, 5], 1),
        ] {
            agree(&dense(hidden, activation), plain(), samples);
        }
    }
}

/// Products of matrices, and narrow layers before and behind them.
#[test]
fn wide_networks_agree() {
    for activation in [Activation::Tanh, Activation::Relu] {
        for (hidden, samples) in [(&[131, 260, 100][..], 300), (&[150, 20, 140], SAMPLES)] {
            agree(&dense(hidden, activation), plain(), samples);
        }
    }
}

/// More rows than wide layers keep at once.
#[test]
fn large_minibatches_agree() {
    agree(&dense(&[100, 100], Activation::Tanh), plain(), 2500);
}

/// Widths that no block of registers fits, cells that no filter reaches, maps without an encoder.
#[test]
fn networks_with_maps_agree() {
    for activation in [Activation::Tanh, Activation::Relu] {
        for (convolutions, encoder_hidden, hidden) in [
            (
                vec![convolution(16, 4, 2), convolution(32, 3, 1)],
                vec![128],
                vec![256, 128],
            ),
            (
                vec![convolution(5, 3, 1), convolution(7, 2, 3)],
                vec![13],
                vec![29, 6],
            ),
            (
                vec![convolution(53, 3, 2), convolution(35, 7, 1)],
                vec![],
                vec![9],
            ),
            (vec![convolution(20, 16, 1)], vec![31], vec![]),
            (vec![convolution(4, 5, 3)], vec![], vec![100, 97]),
            (vec![], vec![17, 3], vec![33]),
            (vec![], vec![], vec![12]),
        ] {
            let config = NetworkConfig {
                convolutions,
                encoder_hidden,
                hidden,
                activation,
            };
            agree(&config, with_maps(), SAMPLES);
        }
    }
}

/// A list of rows, as the CPU takes them, is the range of the rows in that order.
#[test]
fn rows_may_be_a_list() {
    let mut case = Case::new(&dense(&[20, 100, 100], Activation::Tanh), plain(), SAMPLES);
    let gradient = |case: &Case, rows: Rows| {
        let old_log_std = Array::from(case.old_log_std.clone());
        let mut gradient = Array::from(vec![0.0; case.parameters.len()]);
        let mut sums = Array::from(vec![0.0; SUMS]);
        case.engine(&Device::Cpu).gradient(
            &Array::from(case.parameters.clone()),
            &Array::from(case.samples.clone()),
            case.width,
            rows,
            &case.objective(&old_log_std),
            &mut gradient,
            &mut sums,
        );
        gradient.host().to_vec()
    };
    let order = [3, 70, 3, 0, 41];
    let listed = gradient(&case, Rows::Indices(&order));
    let rows = order.iter().flat_map(|&at| {
        let at = at as usize * case.width;
        case.samples[at..at + case.width].to_vec()
    });
    case.samples = rows.collect();
    assert_eq!(listed, gradient(&case, Rows::Range(0..order.len())));
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let maps = NetworkConfig {
        convolutions: vec![convolution(8, 4, 2)],
        encoder_hidden: vec![20],
        ..dense(&[130, 110], Activation::Relu)
    };
    for (config, observation) in [
        (dense(&[32, 32], Activation::Tanh), plain()),
        (dense(&[200, 150], Activation::Tanh), plain()),
        (maps, with_maps()),
    ] {
        let case = Case::new(&config, observation, 700);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().expect("threads start");
            let outcome = pool.install(|| case.on(&Device::Cpu));
            [outcome.mean, outcome.value, outcome.gradient, outcome.sums].concat()
        };
        let one = on(1);
        assert!(one == on(2) && one == on(3));
    }
}

/// Oracle: the CPU against both engines of a GPU; without the loss the gradient is another, but for the critic's.
#[test]
fn actions_under_other_latents_count_on_all_engines() {
    let case = || Case::new(&dense(&[20], Activation::Relu), plain(), 300);
    let without = case().on(&Device::Cpu);
    let case = case().diverse(3, 5.0);
    let with = case.on(&Device::Cpu);
    let critic = case.networks.critic.span();
    assert_eq!(with.gradient[critic.clone()], without.gradient[critic]);
    assert_eq!(with.sums, without.sums);
    let actor = case.networks.actor.span();
    let changes = with.gradient[actor.clone()]
        .iter()
        .zip(&without.gradient[actor]);
    assert!(changes.filter(|(a, b)| (*a - *b).abs() > 1e-4).count() > 20);
    close(&case.on(&lavapipe()).gradient, &with.gradient, "gpu");
    close(&case.layerwise().gradient, &with.gradient, "tensors");
}

#[test]
fn a_row_does_not_depend_on_its_neighbours() {
    let case = Case::new(&dense(&[32, 32], Activation::Tanh), plain(), SAMPLES);
    let config = dense(&[32, 32], Activation::Tanh);
    let mut policy = Policy::new(&config, &plain(), ACTION, 1).expect("networks that fit");
    policy.parameters = case.parameters.clone();
    let all = case.observations();
    let one = policy.mean(&all[33 * VECTOR..34 * VECTOR]);
    assert_eq!(policy.mean(&all)[33 * ACTION..34 * ACTION], one);
    assert_eq!(policy.mean(&all), case.on(&Device::Cpu).mean);
}

/// Adam steps the same way on both devices, whether or not the gradient is clipped.
#[test]
fn adam_steps_agree() {
    let (start, gradient) = (normal(5000, 1), normal(5000, 2));
    for max_grad_norm in [0.0, 0.5, 1e9] {
        let on = |device: &Device| {
            let mut adam = Adam::new(device, start.len());
            let mut parameters = Array::from_slice(device, &start);
            let gradient = Array::from_slice(device, &gradient);
            for _ in 0..3 {
                adam.step(&mut parameters, &gradient, 0.01, max_grad_norm);
            }
            let norm = adam.grad_norm().expect("the device is there");
            let wanted = 5000f32.sqrt();
            assert!((norm - wanted).abs() < 0.1 * wanted, "{norm}");
            parameters.read(device).expect("the device is there")
        };
        let (cpu, gpu) = (on(&Device::Cpu), on(&lavapipe()));
        close(&gpu, &cpu, "parameters");
        // A step is at most about as long as the learning rate.
        let moved = cpu
            .iter()
            .zip(&start)
            .map(|(now, before)| (now - before).abs());
        assert!(moved.fold(0.0, f32::max) < 0.04);
    }
}

/// What fused kernels would need at once, lavapipe has no buffer for.
#[test]
fn minibatches_wider_than_a_buffer_are_taken_in_tensors() {
    let case = Case::new(&dense(&[32, 32], Activation::Tanh), plain(), 9);
    let engine = |minibatch: usize| {
        let (parameters, extras) = (case.networks.parameters(), ACTION + SUMS);
        let networks = case.networks.networks();
        Engine::new(&lavapipe(), networks, parameters, extras, 9, minibatch)
    };
    let outcome = case.by(engine(500_000).expect("an engine"), &lavapipe());
    outcome.agrees(&case.oracle(), "tensors");
    let refused = engine(1 << 23).err().expect("no room");
    let message = refused.to_string();
    assert!(
        message.contains("activations of a minibatch take 1024 MiB"),
        "{message}"
    );
}
