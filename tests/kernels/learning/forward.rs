//! `forward`.

use super::*;
use footwork::kernels::learn::forward;
use footwork::kernels::learn::network::BLOCK;

/// How many networks answer, the first of them, and so many numbers a sample.
const ASKED: [(u32, u32, usize); 3] = [(2, 0, TRAJECTORY_DIM + 1), (1, 0, TRAJECTORY_DIM), (1, 1, 1)];

impl Case {
    fn forward(&self, first: u32) -> forward::Params {
        forward::Params {
            rows: self.plan.head.rows,
            start: self.start,
            width: WIDTH as u32,
            first,
        }
    }

    /// Rows and answers.
    fn answered(&self, networks: u32, answers: &[f32], params: &forward::Params) -> [Vec<f32>; 2] {
        let (mut rows, mut answers) = (self.rows.clone(), answers.to_vec());
        forward::twin(
            networks,
            &self.plan,
            &self.samples,
            &self.parameters,
            &mut rows,
            &mut answers,
            params,
        );
        [rows, answers]
    }

    fn launched(&self, networks: u32, answers: &[f32], params: &forward::Params) -> [Vec<f32>; 2] {
        let (rows, answers) = (up(&self.rows), up(answers));
        forward::launch(
            &gpu(),
            networks,
            &up(&self.table),
            &up(&self.samples),
            &up(&self.parameters),
            &rows,
            &answers,
            params,
        );
        [down(&rows), down(&answers)]
    }
}

#[test]
fn forward_agrees() {
    for case in Case::all() {
        for (networks, first, each) in ASKED {
            let params = case.forward(first);
            let poison = vec![POISON; case.rows() * each];
            let [rows, answers] = case.answered(networks, &poison, &params);
            assert_ne!(rows, case.rows);
            assert!(answers.iter().all(|&answer| answer != POISON));
            let launched = case.launched(networks, &poison, &params);
            near("rows", &launched[0], &rows);
            near("answers", &launched[1], &answers);
            let buffers: [&[u8]; 5] = [
                cast_slice(&case.table),
                cast_slice(&case.samples),
                cast_slice(&case.parameters),
                cast_slice(&case.rows),
                cast_slice(&poison),
            ];
            let groups = [case.rows().div_ceil(BLOCK) as u32, 1, networks];
            let outcome = checked::run(&shader::FORWARD, groups, &buffers, &params);
            near("checked rows", &outcome.of(3), &rows);
            near("checked answers", &outcome.of(4), &answers);
        }
    }
}

/// Layer after layer, in f64, of one sample: no blocks, no columns.
#[test]
fn it_answers_what_the_layers_say() {
    let case = Case::new(&[33, 7], 75);
    let poison = vec![POISON; case.rows() * (TRAJECTORY_DIM + 1)];
    let [_, answers] = case.answered(2, &poison, &case.forward(0));
    let sample = 70;
    let seen = &case.samples[(case.start as usize + sample) * WIDTH..][..BASE_OBS_DIM];
    for network in 0..2 {
        let mut values: Vec<f64> = seen.iter().map(|&value| value.into()).collect();
        for place in case.plan.places[network..6].iter().step_by(2) {
            let at = |i: u32| f64::from(case.parameters[(place.weights + i) as usize]);
            let sum = |output: u32| {
                let bias = at(place.inputs * place.outputs + output);
                let terms = (0..).zip(&values);
                terms.fold(bias, |sum, (i, value)| {
                    sum + value * at(i * place.outputs + output)
                })
            };
            let sums = (0..place.outputs).map(sum);
            values = match place.bent {
                1 => sums.map(f64::tanh).collect(),
                _ => sums.collect(),
            };
        }
        let got = match network {
            0 => &answers[sample * TRAJECTORY_DIM..][..TRAJECTORY_DIM],
            _ => &answers[case.rows() * TRAJECTORY_DIM + sample..][..1],
        };
        let want: Vec<f32> = values.into_iter().map(|value| value as f32).collect();
        near("answer", got, &want);
    }
}

/// What is too large for the exponential.
#[test]
fn sums_of_any_size_are_bent() {
    let mut case = Case::new(&[32, 32], 9);
    let place = case.plan.places[0];
    for (output, bias) in [1e30, -1e30, f32::INFINITY, 20.0, -20.0, 0.0]
        .into_iter()
        .enumerate()
    {
        case.parameters[(place.weights + place.inputs * place.outputs) as usize + output] = bias;
    }
    let params = case.forward(0);
    let poison = vec![POISON; case.rows() * (TRAJECTORY_DIM + 1)];
    let [rows, answers] = case.answered(2, &poison, &params);
    let launched = case.launched(2, &poison, &params);
    near("rows", &launched[0], &rows);
    near("answers", &launched[1], &answers);
    let bent = |output: usize| rows[case.plan.at(0, place.above as usize + output)];
    assert_eq!([0, 1, 2].map(bent), [1.0, -1.0, 1.0]);
}
