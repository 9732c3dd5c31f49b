//! A low level that nobody has trained: random numbers in the form of a run of `skills`.

use footwork::container::{Section, Sections};
use footwork::env::{Demonstrations, EnvSpec, ObservationSpec};
use footwork::gpu::{Array, Device};
use footwork::kernels::rng::{gaussian, random4};
use footwork::nn::layer::Activation;
use footwork::nn::{NetworkConfig, Policy, RunningMeanStd};
use footwork::ranks::Ranks;
use footwork::rl::amp::{Amp, Discriminator};
use footwork::rl::ase::{Ase, LowLevel};
use footwork::train::checkpoint::{Checkpoint, Header};
use std::path::PathBuf;
use std::sync::Arc;

/// Numbers of a latent.
pub const LATENT: usize = 6;

/// A checkpoint of the low level of a body that observes `style` numbers of itself and rests in an action.
pub fn checkpoint(kind: LowLevel, style: usize, rest: &[f32], seed: u32) -> Checkpoint {
    let ase = Ase {
        low_level: kind,
        latent: LATENT,
        ..Ase::default()
    };
    let amp = Amp {
        hidden: vec![24, 16],
        heads: 2,
        minibatch_size: 8,
        ..Amp::default()
    };
    let policy = policy(style, rest, seed);
    let mut sections = Sections::default();
    let mut section = Section::default();
    policy.save(&mut section).expect("numbers in host memory");
    sections.put("policy", section);
    sections.put("learner", learner(&amp, &ase, style, seed));
    Checkpoint {
        header: header(&amp, &ase, style, rest.len()),
        policy,
        sections,
        path: PathBuf::new(),
    }
}

fn header(amp: &Amp, ase: &Ase, style: usize, action: usize) -> Header {
    let [amp, ase] = [toml::Table::try_from(amp), toml::Table::try_from(ase)];
    let tables = [("amp", amp), ("ase", ase)].map(|(name, table)| {
        let table = table.expect("plain choices");
        (name.to_string(), toml::Value::from(table))
    });
    let config = toml::Table::from_iter(tables);
    Header {
        version: "test".into(),
        task: "skills".into(),
        spec: EnvSpec {
            envs: 4,
            agents: 1,
            observation: ObservationSpec {
                vector: style + LATENT,
                grid: None,
            },
            style,
            action,
            dt: 1.0 / 30.0,
            bootstrap: 0,
            bootstraps_often: true,
        },
        fingerprint: 0.into(),
        config: config.to_string(),
        steps: 1,
    }
}

/// A policy whose actions hang on its latent.
fn policy(style: usize, rest: &[f32], seed: u32) -> Policy {
    let network = NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden: vec![32, 16],
        activation: Activation::Relu,
    };
    let observation = ObservationSpec {
        vector: style + LATENT,
        grid: None,
    };
    let mut policy = Policy::new(&network, &observation, rest.len(), 1).expect("such networks");
    policy.parameters = policy.networks().init(seed, -2.9, rest);
    for (at, parameter) in policy.parameters.iter_mut().enumerate() {
        *parameter += 0.02 * noise(seed, at);
    }
    policy.normalizer = Some(moments(style + LATENT, seed));
    policy
}

/// Moments of random rows.
fn moments(dim: usize, seed: u32) -> RunningMeanStd {
    let mut moments = RunningMeanStd::new(&Device::Cpu, dim);
    let rows: Vec<f32> = (0..50 * dim).map(|at| noise(seed, at)).collect();
    moments.update(&Array::Host(rows), 50);
    moments
}

fn learner(amp: &Amp, ase: &Ase, style: usize, seed: u32) -> Section {
    let latents = ase.rewards().latents;
    let dim = 2 * style + latents.shown();
    let windows = (0..dim).map(|at| noise(seed, at)).collect();
    let demonstrations = Arc::new(Demonstrations::new(dim, windows, &[1.0]));
    let discriminator = Discriminator::new(
        amp,
        latents,
        &demonstrations,
        &Device::Cpu,
        &Ranks::alone(),
        1,
        seed,
    );
    let (mut own, mut learner) = (Section::default(), Section::default());
    let discriminator = discriminator.expect("such a network");
    discriminator
        .save(&mut own)
        .expect("numbers in host memory");
    learner.put_section("discriminator", own);
    learner
}

fn noise(seed: u32, at: usize) -> f32 {
    gaussian(random4(seed, at as u32, 0, 0x6c6f_7721))
}
