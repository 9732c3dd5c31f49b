//! Networks that cannot be.

use super::*;
use footwork::container::Section;
use footwork::nn::{Network, NetworkError};

fn refusal(config: &NetworkConfig, observation: ObservationSpec) -> String {
    match Network::new(config, &observation, 3, 0) {
        Ok(_) => panic!("{config:?} is no network"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn networks_that_cannot_be_are_refused() {
    let dense = |hidden: &[usize]| dense(hidden, Activation::Tanh);
    let maps = |convolutions: Vec<Convolution>| NetworkConfig {
        convolutions,
        ..dense(&[8])
    };
    for (config, observation, message) in [
        (dense(&[8; 9]), plain(), "hidden has 9 layers"),
        (dense(&[8, 0]), plain(), "hidden has a layer of width 0"),
        (dense(&[2049]), plain(), "hidden has a layer of width 2049"),
        (
            NetworkConfig {
                encoder_hidden: vec![0],
                ..dense(&[])
            },
            with_maps(),
            "encoder_hidden has a layer of width 0",
        ),
        (
            NetworkConfig {
                encoder_hidden: vec![8],
                ..dense(&[])
            },
            plain(),
            "encoder_hidden needs maps",
        ),
        (
            maps(vec![convolution(4, 3, 1)]),
            plain(),
            "convolutions needs maps",
        ),
        (
            maps(vec![convolution(4, 9, 1); 2]),
            with_maps(),
            "a filter of 9 x 9 cells over an input of 8 x 8",
        ),
        (
            maps(vec![convolution(4, 4, 0)]),
            with_maps(),
            "a stride of 0",
        ),
        (
            maps(vec![convolution(0, 4, 1)]),
            with_maps(),
            "a number of filters of 0",
        ),
        (
            maps(vec![convolution(4, 17, 1)]),
            with_maps(),
            "a filter size of 17",
        ),
    ] {
        let refusal = refusal(&config, observation);
        assert!(refusal.contains(message), "{refusal}");
    }
    let fits = Network::new(&maps(vec![convolution(4, 8, 1); 2]), &with_maps(), 3, 0);
    assert!(fits.is_ok());
    let deep = NetworkError::TooDeep {
        key: "hidden",
        layers: 9,
    };
    assert_eq!(Network::new(&dense(&[8; 9]), &plain(), 3, 0), Err(deep));
}

/// The keys of the file, and activations in lower case.
#[test]
fn configurations_are_read_from_toml() {
    let text = "convolutions = []\nencoder_hidden = []\nhidden = [32]\nactivation = \"relu\"";
    let config: NetworkConfig = toml::from_str(text).expect("a network");
    assert_eq!(config, dense(&[32], Activation::Relu));
    let error = toml::from_str::<NetworkConfig>(&format!("{text}\nsight = []"));
    assert!(error.is_err_and(|error| error.to_string().contains("sight")));
}

#[test]
fn policies_come_back_from_a_section() {
    let config = dense(&[32, 32], Activation::Tanh);
    let mut policy = Policy::new(&config, &plain(), ACTION, 1).expect("networks that fit");
    policy.parameters = policy.networks().init(3, -0.5, &[]);
    let mut normalizer = footwork::nn::RunningMeanStd::new(&Device::Cpu, VECTOR);
    let observations = normal(20 * VECTOR, 4);
    normalizer.update(&Array::from(observations.clone()), 20);
    policy.normalizer = Some(normalizer);
    let mut section = Section::default();
    policy.save(&mut section).expect("in host memory");
    let back = Policy::load(&mut section).expect("as it was saved");
    assert_eq!(back.mean(&observations), policy.mean(&observations));
    assert_eq!(back.log_std(), &[-0.5; ACTION]);

    let damaged = |damage: fn(&mut Section)| {
        let mut section = Section::default();
        policy.save(&mut section).expect("in host memory");
        damage(&mut section);
        let refused = Policy::load(&mut section)
            .err()
            .expect("something is wrong");
        refused.to_string()
    };
    let action = damaged(|section| section.put("action", 6));
    assert!(action.contains("`parameters` has"), "{action}");
    let none = damaged(|section| section.put("action", 0));
    assert!(none.contains("cannot be"), "{none}");
    let unknown = damaged(|section| section.put("network", "deep"));
    assert!(unknown.contains("`network`"), "{unknown}");
}
