//! Oracles: `normalize_advantages::twin`, and its definition. Bar: a few roundings.

use crate::inputs::{Draw, SIZES, close};
use footwork::kernels::learn::normalize_advantages::{self, groups};
use footwork::kernels::learn::rollout_moments::{GROUPS, scale};

#[test]
fn agrees_with_its_twin_and_the_definition() {
    for (samples, streams) in SIZES.into_iter().zip([1, 2, 3].into_iter().cycle()) {
        let mut draw = Draw::new(2);
        let group: Vec<u32> = (0..samples).map(|_| draw.below(GROUPS) as u32).collect();
        let scales: Vec<f32> = draw
            .normals(streams * scale::FIELDS)
            .iter()
            .map(|x| x.abs())
            .collect();
        let values = draw.normals(2 * samples * streams);
        let params = normalize_advantages::Params {
            samples: samples as u32,
            streams: streams as u32,
        };
        let forms = forms!(
            normalize_advantages, NORMALIZE_ADVANTAGES, groups(samples * streams), params;
            group, scales, mut values
        );
        for (form, got) in forms.shaders() {
            close(form, got, &forms.twin, |i| {
                1e-5 * forms.twin[i].abs().max(1.0)
            });
        }
        let (advantages, returns) = forms.twin.split_at(samples * streams);
        assert_eq!(returns, &values[samples * streams..]);
        for (at, got) in advantages.iter().enumerate() {
            let scale = &scales[at % streams * scale::FIELDS..];
            let kind = group[at / streams] as usize;
            let centered = values[at] - scale[scale::ADVANTAGE_MEAN + kind];
            let want =
                scale[scale::WEIGHT] * centered / (scale[scale::ADVANTAGE_STD + kind] + 1e-6);
            assert_eq!(*got, want);
        }
    }
}

/// Advantages that are all the same become nothing, not infinite.
#[test]
fn advantages_without_spread_stay_finite() {
    let mut scales = [0.0; scale::FIELDS];
    scales[scale::WEIGHT] = 1.0;
    scales[scale::ADVANTAGE_MEAN] = 2.5;
    let params = normalize_advantages::Params {
        samples: 65,
        streams: 1,
    };
    let values = [vec![2.5f32; 65], vec![1.0; 65]].concat();
    let forms = forms!(
        normalize_advantages, NORMALIZE_ADVANTAGES, groups(65), params;
        vec![0u32; 65], scales, mut values
    );
    for (form, got) in forms.all() {
        assert!(
            got[..65].iter().all(|&advantage| advantage == 0.0),
            "{form}"
        );
    }
}
