//! Oracles: `gather_samples::twin`, and what a sample is, in f64.
//! Bar: what is copied is equal bit for bit; a normalised number within 8 roundings of its terms.

use crate::inputs::{Draw, SEEDS, SIZES, close, same};
use crate::support::forms::Forms;
use footwork::kernels::learn::gather_samples::{self, scalars, width};
use footwork::kernels::learn::rollout_moments::scale;
use footwork::kernels::rng::permutation;

struct Case {
    order: Vec<u32>,
    observation: Vec<f32>,
    action: Vec<f32>,
    mean: Vec<f32>,
    log_prob_and_value: Vec<f32>,
    advantage_and_return: Vec<f32>,
    scale: Vec<f32>,
    params: gather_samples::Params,
}

impl Case {
    /// Of one stream of rewards.
    fn new(samples: usize, observation: usize, action: usize, seed: u32) -> Self {
        Case::of_streams(samples, observation, action, 1, seed)
    }

    fn of_streams(
        samples: usize,
        observation: usize,
        action: usize,
        streams: usize,
        seed: u32,
    ) -> Self {
        let mut draw = Draw::new(seed);
        Case {
            order: permutation(seed, 1, 2, samples),
            observation: draw.normals(samples * observation),
            action: draw.normals(samples * action),
            mean: draw.normals(samples * action),
            log_prob_and_value: draw.normals((1 + streams) * samples),
            advantage_and_return: draw.normals(2 * streams * samples),
            scale: (0..streams * scale::FIELDS)
                .map(|i| draw.normal().abs() + [0.1, 300.0][i % 2])
                .collect(),
            params: gather_samples::Params {
                samples: samples as u32,
                observation: observation as u32,
                action: action as u32,
                streams: streams as u32,
            },
        }
    }

    fn samples(&self) -> usize {
        self.params.samples as usize
    }

    fn streams(&self) -> usize {
        self.params.streams as usize
    }

    /// Numbers of an observation, of an action, and of a sample.
    fn widths(&self) -> [usize; 3] {
        let (observation, action) = (self.params.observation, self.params.action);
        let [observation, action] = [observation as usize, action as usize];
        [
            observation,
            action,
            width(observation, action, self.streams()),
        ]
    }

    fn run(&self) -> Forms<Vec<f32>> {
        let [.., width] = self.widths();
        // As many workgroups along x as WebGPU allows.
        let across = self.params.samples.min(65_535);
        let groups = [across, self.params.samples.div_ceil(across), 1];
        forms!(
            gather_samples, GATHER_SAMPLES, groups, self.params;
            self.order, self.observation, self.action, self.mean, self.log_prob_and_value,
            self.advantage_and_return, self.scale, out self.samples() * width
        )
    }

    /// The scalars of a sample, and the largest term of each.
    fn scalars(&self, from: usize) -> Vec<(f64, f64)> {
        let (streams, n) = (self.streams(), self.samples());
        let mut all = vec![(0.0, 0.0); scalars(streams)];
        all[0].0 = f64::from(self.log_prob_and_value[from]);
        for stream in 0..streams {
            let [advantage, target, value] = self.stream(n, from, stream);
            all[1].0 += advantage.0;
            all[1].1 += advantage.1;
            (all[2 + stream], all[2 + streams + stream]) = (target, value);
        }
        all
    }

    /// Advantage, target and value of a stream, and the largest term of each.
    fn stream(&self, n: usize, from: usize, stream: usize) -> [(f64, f64); 3] {
        let scale = |field: usize| f64::from(self.scale[scale::FIELDS * stream + field]);
        let at = from * self.streams() + stream;
        let value = f64::from(self.log_prob_and_value[n + at]) * scale(scale::OLD_STD);
        let normalised = |terms: &[f64], std: f64| {
            let largest = terms.iter().fold(0.0f64, |most, term| most.max(term.abs()));
            (terms.iter().sum::<f64>() / std, largest / std)
        };
        let advantage = f64::from(self.advantage_and_return[at]);
        let returned = f64::from(self.advantage_and_return[n * self.streams() + at]);
        let new_mean = scale(scale::NEW_MEAN);
        [
            (advantage, advantage.abs()),
            normalised(&[returned, -new_mean], scale(scale::NEW_STD)),
            normalised(
                &[value, scale(scale::OLD_MEAN), -new_mean],
                scale(scale::NEW_STD),
            ),
        ]
    }

    fn agrees(&self) {
        let [observation, action, width] = self.widths();
        let forms = self.run();
        for (form, got) in forms.all() {
            for (row, &from) in got.chunks_exact(width).zip(&self.order) {
                let from = from as usize;
                let (seen, row) = row.split_at(observation);
                let (acted, row) = row.split_at(action);
                let (mean, scalars) = row.split_at(action);
                same(
                    form,
                    seen,
                    &self.observation[from * observation..][..observation],
                );
                same(form, acted, &self.action[from * action..][..action]);
                same(form, mean, &self.mean[from * action..][..action]);
                let oracle = self.scalars(from);
                let want: Vec<f32> = oracle.iter().map(|(value, _)| *value as f32).collect();
                close(form, scalars, &want, |i| {
                    8.0 * f32::EPSILON * oracle[i].1 as f32
                });
            }
        }
    }
}

#[test]
fn agrees_with_its_twin_and_the_definition() {
    for seed in SEEDS {
        for samples in SIZES {
            Case::new(samples, 105, 12, seed).agrees();
        }
    }
}

#[test]
fn agrees_for_rows_around_the_lanes_of_a_workgroup() {
    for observation in [1, 31, 32, 33, 64, 65] {
        for action in [1, 31, 32, 33] {
            Case::new(65, observation, action, 3).agrees();
        }
    }
}

#[test]
fn agrees_for_several_streams_of_rewards() {
    for streams in [2, 3] {
        Case::of_streams(130, 7, 5, streams, 9).agrees();
    }
}

/// WebGPU launches 65,535 workgroups in a dimension.
#[test]
fn agrees_for_more_samples_than_workgroups_in_a_dimension() {
    for samples in [65_535, 65_536, 140_001] {
        Case::new(samples, 3, 2, 4).agrees();
    }
}

/// Part of an epoch takes any samples, in any order, some of them twice.
#[test]
fn any_order_will_do() {
    let mut case = Case::new(1000, 5, 3, 5);
    let mut draw = Draw::new(6);
    case.order.fill_with(|| draw.below(1000) as u32);
    case.agrees();
    case.order.fill(999);
    case.agrees();
}

#[test]
fn odd_numbers_are_passed_on() {
    let mut case = Case::new(65, 6, 6, 7);
    let odd = [0.0, -0.0, 1e-45, f32::MAX, f32::NEG_INFINITY, f32::NAN];
    for values in [
        &mut case.observation,
        &mut case.action,
        &mut case.mean,
        &mut case.log_prob_and_value,
    ] {
        let odd = odd.into_iter().cycle();
        values
            .iter_mut()
            .zip(odd)
            .for_each(|(value, odd)| *value = odd);
    }
    // A value of the critic is computed with: only the logarithms stay odd.
    case.log_prob_and_value[65..].fill(1.0);
    case.agrees();
}
