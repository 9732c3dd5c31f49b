//! A thousand rollouts from standing under random targets, against a thousand of MuJoCo's: a two-sample
//! test must not tell them apart.

use crate::golden::Golden;
use footwork::kernels::rng::{gaussian, random4};
use footwork::physics::humanoid::humanoid;
use footwork::physics::model::Model;
use footwork::physics::simulator::{SUBSTEPS, Simulator, SimulatorState, SolverOptions};
use rayon::prelude::*;
use std::sync::Arc;

const ROLLOUTS: usize = 1000;
const SECONDS: usize = 2;
/// The head is lower than this, m.
const FALLEN: f32 = 0.8;

const MEASURES: [&str; 5] = [
    "time to fall",
    "mean force on the feet",
    "largest force on the feet",
    "mean force on the body",
    "largest force on the body",
];

fn rollout(model: &Arc<Model>, seed: u32) -> [f32; MEASURES.len()] {
    let [head, left, right] =
        ["head", "left_foot", "right_foot"].map(|name| model.body(name).expect("a humanoid's"));
    let mut simulator = Simulator::new(model.clone(), SolverOptions::fast(model));
    let mut state = SimulatorState::new(model);
    let (mut fallen, mut feet, mut all) = (SECONDS as f32, Vec::new(), Vec::new());
    let control_steps = 30 * SECONDS;
    for control in 0..control_steps {
        let draw = |k: usize| 0.3 * gaussian(random4(seed, control as u32, k as u32, 9));
        let targets: Vec<f32> = (0..model.nu()).map(draw).collect();
        for sub in 0..SUBSTEPS {
            simulator.step(&mut state, &targets, &[]);
            let (mut on_feet, mut on_all) = (0.0, 0.0);
            for (force, &key) in simulator.contact_forces().zip(&simulator.contacts.ids) {
                let [first, second] = model.pairs[(key / 8) as usize];
                if model.geoms[first].body.is_none() {
                    let body = model.geoms[second].body;
                    on_all += force.z;
                    on_feet += if body == Some(left) || body == Some(right) {
                        force.z
                    } else {
                        0.0
                    };
                }
            }
            feet.push(on_feet);
            all.push(on_all);
            if fallen == SECONDS as f32 && simulator.poses[head].position.z < FALLEN {
                fallen = (SUBSTEPS * control + sub + 1) as f32 / 120.0;
            }
        }
    }
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    let most = |values: &[f32]| values.iter().copied().fold(0.0, f32::max);
    [fallen, mean(&feet), most(&feet), mean(&all), most(&all)]
}

/// Largest distance of two empirical distributions (Kolmogorov and Smirnov).
fn distance(one: &[f32], other: &[f32]) -> f64 {
    let sorted = |values: &[f32]| {
        let mut values = values.to_vec();
        values.sort_by(f32::total_cmp);
        values
    };
    let (one, other) = (sorted(one), sorted(other));
    let below =
        |values: &[f32], x: f32| values.partition_point(|&v| v <= x) as f64 / values.len() as f64;
    one.iter()
        .chain(&other)
        .map(|&x| (below(&one, x) - below(&other, x)).abs())
        .fold(0.0, f64::max)
}

#[test]
fn rollouts_are_not_told_from_mujocos() {
    let model = Arc::new(humanoid());
    let ours: Vec<[f32; 5]> = (0..ROLLOUTS as u32)
        .into_par_iter()
        .map(|seed| rollout(&model, seed))
        .collect();
    let golden = Golden::open("rollouts.f32", MEASURES.len());
    let theirs: Vec<Vec<f32>> = golden
        .rows()
        .map(|mut row| row.take(MEASURES.len()).to_vec())
        .collect();
    assert_eq!(theirs.len(), ROLLOUTS);
    for (measure, what) in MEASURES.iter().enumerate() {
        let one: Vec<f32> = ours.iter().map(|row| row[measure]).collect();
        let other: Vec<f32> = theirs.iter().map(|row| row[measure]).collect();
        let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
        let found = distance(&one, &other);
        // Kolmogorov's distribution at 0.2 %: five tests together err in 1 % of cases.
        let bar = 1.858 * (2.0 / ROLLOUTS as f64).sqrt();
        println!(
            "{what}: ours {:.3}, MuJoCo's {:.3}, distance {found:.3} of {bar:.3}",
            mean(&one),
            mean(&other)
        );
        assert!(found < bar, "{what}: distance {found}");
    }
}
