//! Oracles: `rollout_moments::twin`, and the definitions of mean, variance and explained variance in f64.
//! Bar: what f32 may make of sums of n numbers in 256 lanes, n / 256 + 16 roundings of their absolute sum,
//! carried through the formulas as intervals.

use crate::inputs::{Draw, SEEDS};
use crate::support::forms::Forms;
use footwork::kernels::learn::rollout_moments::{self, scale};

/// Around the workgroup's 256 invocations, at two samples each a round.
const SIZES: [usize; 9] = [1, 2, 255, 256, 257, 511, 512, 513, 5000];

struct Case {
    value: Vec<f32>,
    advantage: Vec<f32>,
    returned: Vec<f32>,
    moments: [f32; 2],
    /// Mean and standard deviation of the critic's outputs.
    old: [f32; 2],
    weight: f32,
}

/// Moments, then the scale.
type Moments = (Vec<f32>, Vec<f32>);

/// From and to.
type Interval = [f64; 2];

/// Around a number.
fn about(value: f64, bar: f64) -> Interval {
    [value - bar, value + bar]
}

fn root(of: Interval, least: f64) -> Interval {
    let [low, high] = of.map(|end| end.max(least).sqrt());
    [low * (1.0 - UNIT), high * (1.0 + UNIT)]
}

/// Least standard deviation of a group's advantages, of that of all.
const LEAST_OF_ALL: f64 = 0.2;
const UNIT: f64 = f32::EPSILON as f64;

impl Case {
    /// Returns about `mean`, which the critic half explains.
    fn new(samples: usize, mean: f32, std: f32, seed: u32) -> Self {
        let mut draw = Draw::new(seed);
        let returned: Vec<f32> = (0..samples).map(|_| mean + std * draw.normal()).collect();
        let old = [mean + draw.normal(), std * (1.0 + draw.within(0.5))];
        let value = returned.iter().map(|value| (value - old[0]) / old[1]);
        Case {
            value: value.map(|value| value + 0.7 * draw.normal()).collect(),
            advantage: draw.normals(samples),
            moments: [mean, mean * mean + std * std],
            old,
            weight: 0.1,
            returned,
        }
    }

    fn samples(&self) -> usize {
        self.returned.len()
    }

    fn run(&self) -> Forms<Moments> {
        let params = rollout_moments::Params {
            samples: self.samples() as u32,
            weight: self.weight,
            streams: 1,
            stream: 0,
        };
        let mut scale = [f32::NAN; scale::FIELDS];
        scale[scale::WEIGHT] = 0.25;
        let group = vec![0u32; self.samples()];
        [scale[scale::OLD_MEAN], scale[scale::OLD_STD]] = self.old;
        forms!(
            rollout_moments, ROLLOUT_MOMENTS, [1, 1, 1], params;
            // Logarithms of densities are not looked at.
            [vec![f32::NAN; self.samples()], self.value.clone()].concat(),
            [&self.advantage[..], &self.returned].concat(),
            group, mut self.moments, mut scale
        )
    }

    /// Roundings of a sum of all samples.
    fn roundings(&self) -> f64 {
        (self.samples().div_ceil(256) + 16) as f64 * UNIT
    }

    fn mean(&self, values: &[f64]) -> Interval {
        let n = values.len() as f64;
        let absolute = values.iter().map(|value| value.abs()).sum::<f64>() / n;
        about(values.iter().sum::<f64>() / n, self.roundings() * absolute)
    }

    /// Of values that are known within `bar`.
    fn variance(&self, values: &[f64], bar: f64) -> Interval {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values
            .iter()
            .map(|value| (value - mean).powi(2))
            .sum::<f64>()
            / n;
        let [low, high] = self.mean(values);
        // The mean that is subtracted is wrong itself, and each value is.
        let off = 0.5 * (high - low) + bar;
        let bar =
            off * off + 2.0 * bar * variance.sqrt() + self.roundings() * (variance + off * off);
        let [low, high] = about(variance, bar);
        [low.max(0.0), high]
    }

    /// A running moment after this rollout.
    fn moved(&self, from: f32, [low, high]: Interval) -> Interval {
        let (from, weight) = (f64::from(from), f64::from(self.weight));
        let bar = 4.0 * UNIT * (from.abs() + low.abs().max(high.abs()));
        let moved = |newest: f64| from * (1.0 - weight) + newest * weight;
        [moved(low) - bar, moved(high) + bar]
    }

    fn oracle(&self) -> ([Interval; 2], [Interval; scale::FIELDS]) {
        let wide = |values: &[f32]| {
            values
                .iter()
                .map(|&value| f64::from(value))
                .collect::<Vec<_>>()
        };
        let (advantage, returned) = (wide(&self.advantage), wide(&self.returned));
        let [old_mean, old_std] = self.old.map(f64::from);
        let terms = |(value, returned): (&f32, &f64)| {
            let value = f64::from(*value) * old_std;
            let largest = value.abs().max(returned.abs()).max(old_mean.abs());
            (returned - value - old_mean, largest)
        };
        let (error, largest): (Vec<f64>, Vec<f64>) =
            self.value.iter().zip(&returned).map(terms).unzip();
        let bar = 3.0 * UNIT * largest.into_iter().fold(0.0, f64::max);
        let error = self.variance(&error, bar);
        let spread = self.variance(&returned, 0.0);
        let explained = [
            1.0 - error[1] / (spread[0] + 1e-12),
            1.0 - error[0] / (spread[1] + 1e-12),
        ];
        let squares: Vec<f64> = returned.iter().map(|value| value * value).collect();
        let mean = self.moved(self.moments[0], self.mean(&returned));
        let square = self.moved(self.moments[1], self.mean(&squares));
        let largest = mean[0].abs().max(mean[1].abs()).powi(2);
        let least = match mean[0] * mean[1] > 0.0 {
            true => mean[0].abs().min(mean[1].abs()).powi(2),
            false => 0.0,
        };
        let bar = 4.0 * UNIT * (square[1].abs() + largest);
        let new_std = root([square[0] - largest - bar, square[1] - least + bar], 1e-6);
        let std = root(self.variance(&advantage, 0.0), 0.0);
        let scale = [
            about(old_mean, 0.0),
            about(old_std, 0.0),
            mean,
            new_std,
            explained.map(|end| end + UNIT * end.abs()),
            about(0.25, 0.0),
            self.mean(&advantage),
            // The other groups are empty: theirs is the least standard deviation.
            about(0.0, 0.0),
            about(0.0, 0.0),
            std,
            std.map(|end| LEAST_OF_ALL * end),
            std.map(|end| LEAST_OF_ALL * end),
        ];
        ([mean, square], scale)
    }

    #[track_caller]
    fn agrees(&self) -> Forms<Moments> {
        let (moments, scale) = self.oracle();
        let forms = self.run();
        for (form, got) in forms.all() {
            let found = got.0.iter().chain(&got.1);
            for (i, (&got, [low, high])) in found.zip(moments.iter().chain(&scale)).enumerate() {
                let slack = UNIT * low.abs().max(high.abs());
                let within = (low - slack..=high + slack).contains(&f64::from(got));
                assert!(within, "{form}, number {i}: {got} is not in {low}..={high}");
            }
        }
        forms
    }
}

/// Streams of rewards lie side by side, and leave each other alone.
#[test]
fn one_of_two_streams_is_as_if_alone() {
    let case = Case::new(700, 3.0, 2.0, 6);
    let beside = |values: &[f32]| -> Vec<f32> {
        values.iter().flat_map(|&value| [f32::NAN, value]).collect()
    };
    let params = rollout_moments::Params {
        samples: 700,
        weight: case.weight,
        streams: 2,
        stream: 1,
    };
    const F: usize = scale::FIELDS;
    let mut scale = [-1.0; 2 * F];
    [scale[F + scale::OLD_MEAN], scale[F + scale::OLD_STD]] = case.old;
    scale[F + scale::WEIGHT] = 0.25;
    let moments = [7.0, 8.0, case.moments[0], case.moments[1]];
    let forms = forms!(
        rollout_moments, ROLLOUT_MOMENTS, [1, 1, 1], params;
        [vec![f32::NAN; 700], beside(&case.value)].concat(),
        [beside(&case.advantage), beside(&case.returned)].concat(),
        vec![0u32; 700], mut moments, mut scale
    );
    let alone = case.run();
    for ((form, got), (_, want)) in forms.all().into_iter().zip(alone.all()) {
        let (moments, scale): &Moments = got;
        assert_eq!(
            (&moments[..2], &moments[2..]),
            (&[7.0, 8.0][..], &want.0[..]),
            "{form}"
        );
        assert!(scale[..F].iter().all(|&value| value == -1.0), "{form}");
        assert_eq!(scale[F..], want.1[..], "{form}");
    }
}

/// Kinds of situations have moments of their own, but for a least standard deviation.
#[test]
fn groups_are_apart() {
    let group: Vec<u32> = (0..700).map(|i| [0, 0, 1, 2][i % 4]).collect();
    let mut draw = Draw::new(8);
    let advantage: Vec<f32> = group
        .iter()
        .map(|&kind| match kind {
            0 => 5.0 + draw.normal(),
            1 => -20.0 + 10.0 * draw.normal(),
            _ => 3.0,
        })
        .collect();
    let params = rollout_moments::Params {
        samples: 700,
        weight: 0.1,
        streams: 1,
        stream: 0,
    };
    let scale = [1.0f32; scale::FIELDS];
    let forms = forms!(
        rollout_moments, ROLLOUT_MOMENTS, [1, 1, 1], params;
        vec![0.0f32; 1400], [advantage.clone(), vec![1.0; 700]].concat(), group,
        mut [0.0f32, 1.0], mut scale
    );
    let deviation = |kind: Option<u32>| {
        let own = advantage
            .iter()
            .zip(&group)
            .filter(|(_, own)| kind.is_none_or(|kind| kind == **own));
        let own: Vec<f64> = own.map(|(&advantage, _)| f64::from(advantage)).collect();
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let variance = own.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / own.len() as f64;
        (mean, variance.sqrt())
    };
    let least = 0.2 * deviation(None).1;
    for (form, (_, scale)) in forms.all() {
        let scale: &Vec<f32> = scale;
        for kind in 0..3 {
            let (mean, std) = deviation(Some(kind));
            let at = kind as usize;
            let got = [
                scale[scale::ADVANTAGE_MEAN + at],
                scale[scale::ADVANTAGE_STD + at],
            ];
            for (got, want) in got.into_iter().zip([mean, std.max(least)]) {
                assert!(
                    (f64::from(got) - want).abs() < 1e-4 * want.abs(),
                    "{form}, {kind}: {got} {want}"
                );
            }
        }
    }
}

#[test]
fn agrees_with_its_twin_and_the_definitions() {
    for seed in SEEDS {
        for samples in SIZES {
            for weight in [0.0, 0.1, 1.0] {
                let mut case = Case::new(samples, 30.0, 20.0, seed);
                case.weight = weight;
                case.agrees();
            }
        }
    }
}

/// Sums of many samples; lavapipe silently stops after 65,535 loop iterations.
#[test]
fn agrees_for_large_rollouts() {
    for samples in [131_072, 1_000_003, 4_000_001] {
        Case::new(samples, 5.0, 20.0, 1).agrees();
    }
    // The very last sample counts.
    let mut case = Case::new(4_000_001, 0.0, 1.0, 2);
    case.returned[4_000_000] = 1e6;
    case.advantage[4_000_000] = -1e6;
    let [mean, advantage] = [scale::NEW_MEAN, scale::ADVANTAGE_MEAN];
    case.weight = 1.0;
    for (form, (_, scale)) in case.agrees().all() {
        assert!((scale[mean] - 0.25).abs() < 0.01, "{form}");
        assert!((scale[advantage] + 0.25).abs() < 0.01, "{form}");
    }
}

/// By hand: returns 1 and 3, explained by a critic that is wrong by 0.5 in opposite ways.
#[test]
fn two_samples_by_hand() {
    let case = Case {
        value: vec![0.75, 0.75],
        advantage: vec![-2.0, 4.0],
        returned: vec![1.0, 3.0],
        moments: [0.0, 1.0],
        old: [0.5, 2.0],
        weight: 0.5,
    };
    for (form, (moments, scale)) in case.agrees().all() {
        // Mean square 5 halfway from 1; mean 2 halfway from 0.
        assert_eq!(moments[..], [1.0, 3.0], "{form}");
        assert_eq!(scale[..3], [0.5, 2.0, 1.0], "{form}");
        assert!((scale[scale::NEW_STD] - 2f32.sqrt()).abs() < 1e-6, "{form}");
        assert_eq!(scale[scale::ADVANTAGE_MEAN], 1.0, "{form}");
        assert_eq!(scale[scale::ADVANTAGE_STD], 3.0, "{form}");
        assert!(scale[scale::EXPLAINED_VARIANCE].abs() < 1e-6, "{form}");
    }
}

/// Where all returns are the same, a standard deviation of 0 would divide by nothing.
#[test]
fn returns_without_spread_keep_a_least_standard_deviation() {
    for returned in [0.0, 0.5] {
        let mut case = Case::new(1000, 0.0, 1.0, 3);
        case.returned.fill(returned);
        case.advantage.fill(returned);
        case.value.fill(returned);
        case.old = [0.0, 1.0];
        case.weight = 1.0;
        for (form, (_, scale)) in case.agrees().all() {
            assert!((scale[scale::NEW_STD] - 1e-3).abs() < 1e-8, "{form}");
            assert_eq!(scale[scale::ADVANTAGE_STD], 0.0, "{form}");
            assert_eq!(scale[scale::EXPLAINED_VARIANCE], 1.0, "{form}");
        }
    }
}

#[test]
fn agrees_for_extreme_returns() {
    for (mean, std) in [(1000.0, 1.0), (1e6, 1e5), (-1e-3, 1e-6), (0.0, 1e15)] {
        for samples in [1, 300, 5000] {
            Case::new(samples, mean, std, 4).agrees();
        }
    }
}

/// A return that is no number must show: it stops the training.
#[test]
fn what_is_no_number_stays_none() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut case = Case::new(300, 0.0, 1.0, 5);
        (case.returned[299], case.advantage[7]) = (bad, bad);
        for (form, (moments, scale)) in case.run().all() {
            for (what, value) in [("moment", moments[0]), ("mean", scale[scale::NEW_MEAN])] {
                assert!(!value.is_finite(), "{form}: {what} {value}");
            }
            assert!(!scale[scale::ADVANTAGE_MEAN].is_finite(), "{form}");
        }
    }
}
