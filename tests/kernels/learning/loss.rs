//! `loss`, and its gradient against differences of the loss itself in f64.

use super::*;
use footwork::gpu::kernel::groups;
use footwork::kernels::learn::loss;
use footwork::kernels::learn::network::BLOCK;

const OLD_LOG_STD: [f32; TRAJECTORY_DIM] = [-0.4; TRAJECTORY_DIM];

/// Ratios on either side of the clip range and in it; values on either side of theirs.
fn case(hidden: &[usize], rows: usize) -> Case {
    let mut case = Case::new(hidden, rows);
    let log_std = case.parameters.len() - TRAJECTORY_DIM;
    case.parameters[log_std..].fill(-0.5);
    let mut draw = Draw::new(8);
    for sample in case.samples.chunks_exact_mut(WIDTH) {
        // About what the actions have.
        sample[WIDTH - 4] = -12.5 + draw.within(2.0);
    }
    case
}

fn params(case: &Case) -> loss::Params {
    loss::Params {
        rows: case.plan.head.rows,
        start: case.start,
        width: WIDTH as u32,
        clip: 0.3,
        value_clip: 0.4,
        value_coefficient: 0.7,
        entropy_coefficient: 0.01,
        kl_coefficient: 0.2,
        share: 1.0 / case.rows() as f32,
    }
}

/// What the networks answered: some numbers within one.
fn answers(case: &Case) -> Vec<f32> {
    case.rows[..case.rows() * (TRAJECTORY_DIM + 1)].to_vec()
}

fn twin(case: &Case, answers: &[f32]) -> Vec<f32> {
    let mut slopes = case.slopes.clone();
    loss::twin(
        &case.plan,
        &case.samples,
        &case.parameters,
        &OLD_LOG_STD,
        answers,
        &mut slopes,
        &params(case),
    );
    slopes
}

#[test]
fn loss_agrees() {
    for (hidden, rows) in CASES {
        let case = case(hidden, rows);
        let (params, answers) = (params(&case), answers(&case));
        let twin = twin(&case, &answers);
        assert_ne!(twin, case.slopes);
        let slopes = up(&case.slopes);
        loss::launch(
            &gpu(),
            &up(&case.table),
            &up(&case.samples),
            &up(&case.parameters),
            &up(&OLD_LOG_STD),
            &up(&answers),
            &slopes,
            &params,
        );
        let buffers: [&[u8]; 6] = [
            cast_slice(&case.table),
            cast_slice(&case.samples),
            cast_slice(&case.parameters),
            cast_slice(&OLD_LOG_STD),
            cast_slice(&answers),
            cast_slice(&case.slopes),
        ];
        let groups = groups(&shader::LOSS, rows.next_multiple_of(BLOCK));
        let outcome = checked::run(&shader::LOSS, groups, &buffers, &params);
        near("launch", &down(&slopes), &twin);
        near("checked", &outcome.of(5), &twin);
    }
}

#[test]
fn what_fills_the_last_block_has_no_slopes() {
    let case = case(&[33, 7], 75);
    let slopes = twin(&case, &answers(&case));
    let [.., actor, critic, judged] = &case.plan.places[..] else {
        unreachable!("two networks")
    };
    for place in [actor, critic, judged] {
        for column in place.above..place.above + place.outputs {
            let of = |row: usize| slopes[case.plan.at(row, column as usize)];
            assert!((75..80).all(|row| of(row) == 0.0));
            assert!((0..75).any(|row| of(row) != 0.0));
        }
    }
}

/// The loss of a sample as Schulman et al. 2017, equations 7 to 9, have it, with a penalty on the KL
/// divergence of the new policy from the old (equation 8) and a bound on the critic's change.
fn plain(case: &Case, row: usize, mean: &[f64], log_std: &[f64], value: f64) -> f64 {
    let params = params(case);
    let sample = &case.samples[(case.start as usize + row) * WIDTH..][..WIDTH];
    let at = |i: usize| f64::from(sample[i]);
    let mut log_prob = 0.0;
    let (mut kl, mut entropy) = (0.0, 0.0);
    for i in 0..TRAJECTORY_DIM {
        let (action, old_mean) = (at(BASE_OBS_DIM + i), at(BASE_OBS_DIM + TRAJECTORY_DIM + i));
        let (deviation, old) = (log_std[i].exp(), f64::from(OLD_LOG_STD[i]).exp());
        let tau = std::f64::consts::TAU;
        log_prob -= (action - mean[i]).powi(2) / (2.0 * deviation.powi(2));
        log_prob -= (deviation * tau.sqrt()).ln();
        let moved = old.powi(2) + (old_mean - mean[i]).powi(2);
        kl += (deviation / old).ln() + moved / (2.0 * deviation.powi(2)) - 0.5;
        entropy += (deviation * (tau * std::f64::consts::E).sqrt()).ln();
    }
    let ratio = (log_prob - at(WIDTH - 4)).exp();
    let advantage = at(WIDTH - 3);
    let (low, high) = (1.0 - f64::from(params.clip), 1.0 + f64::from(params.clip));
    let surrogate = (ratio * advantage).min(ratio.clamp(low, high) * advantage);
    let (target, old_value) = (at(WIDTH - 2), at(WIDTH - 1));
    let limit = f64::from(params.value_clip);
    let near = old_value + (value - old_value).clamp(-limit, limit);
    let error = (value - target).powi(2).max((near - target).powi(2));
    -surrogate + 0.5 * f64::from(params.value_coefficient) * error
        - f64::from(params.entropy_coefficient) * entropy
        + f64::from(params.kl_coefficient) * kl
}

#[test]
fn its_gradient_is_that_of_the_papers_loss() {
    let case = case(&[32, 32], 200);
    let params = params(&case);
    let answers = answers(&case);
    let slopes = twin(&case, &answers);
    let [.., actor, critic, judged] = &case.plan.places[..] else {
        unreachable!("two networks")
    };
    let [mean, value, judged] = [actor, critic, judged].map(|place| place.above as usize);
    let mut left = 0;
    for row in 0..case.rows() {
        let at = |column: usize| slopes[case.plan.at(row, column)];
        let answered = &answers[row * TRAJECTORY_DIM..][..TRAJECTORY_DIM];
        let judge = answers[case.rows() * TRAJECTORY_DIM + row];
        let wide = |values: &[f32]| values.iter().map(|&v| f64::from(v)).collect::<Vec<_>>();
        let log_std = &case.parameters[case.parameters.len() - TRAJECTORY_DIM..];
        let point = [wide(answered), wide(log_std), vec![f64::from(judge)]];
        let point = point.concat();
        let of = |point: &[f64]| {
            let (mean, rest) = point.split_at(TRAJECTORY_DIM);
            plain(&case, row, mean, &rest[..TRAJECTORY_DIM], rest[TRAJECTORY_DIM])
        };
        let columns = (mean..mean + TRAJECTORY_DIM).chain(judged..judged + TRAJECTORY_DIM);
        let got = columns.chain([value]).map(at);
        for (i, got) in got.enumerate() {
            const STEP: f64 = 1e-6;
            let moved = |by: f64| {
                let mut point = point.clone();
                point[i] += by;
                of(&point)
            };
            let want = (moved(STEP) - moved(-STEP)) / (2.0 * STEP) * f64::from(params.share);
            let got = f64::from(got);
            assert!(
                (got - want).abs() <= 1e-4 * want.abs().max(f64::from(params.share)),
                "row {row}, number {i}: {got} instead of {want}"
            );
        }
        left += usize::from(at(judged + TRAJECTORY_DIM + 4) == 1.0);
    }
    assert!(
        (10..190).contains(&left),
        "{left} of 200 left the clip range"
    );
}
