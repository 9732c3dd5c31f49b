//! Oracle: `sample_action::twin`, and the density of the drawn action in f64.
//! Bar: the noise is equal bit for bit, so an action differs by its exp, 3e-6 of the deviation's
//! share, and a rounding; the density's logarithm, a sum of 3 terms a number, by as many roundings of
//! their absolute sum.

use crate::inputs::{Draw, POISON, SEEDS, SIZES, close, within_terms};
use crate::support::forms::Forms;
use footwork::kernels::learn::sample_action;

/// Numbers of an action.
const ACTION: usize = 12;

struct Case {
    mean: Vec<f32>,
    log_std: Vec<f32>,
    params: sample_action::Params,
}

/// Actions and the logarithms of their densities.
type Drawn = (Vec<f32>, Vec<f32>);

impl Case {
    /// Rows in the middle of the arrays, as those of a step are.
    fn new(rows: usize, seed: u32, log_std: Vec<f32>) -> Self {
        let mut draw = Draw::new(seed);
        let before = draw.below(3) * rows;
        Case {
            mean: draw.normals((before + 2 * rows) * log_std.len()),
            params: sample_action::Params {
                rows: rows as u32,
                action: log_std.len() as u32,
                row: before as u32,
                first: draw.below(1000) as u32,
                seed,
                step_counter: draw.bits()[0],
            },
            log_std,
        }
    }

    /// Whether a row of the arrays acts.
    fn acts(&self, row: usize) -> bool {
        let first = self.params.row as usize;
        (first..first + self.params.rows as usize).contains(&row)
    }

    fn run(&self) -> Forms<Drawn> {
        let numbers = self.mean.len();
        forms!(
            sample_action, SAMPLE_ACTION, self.params.rows as usize, self.params;
            self.mean, self.log_std, out numbers, out numbers / self.log_std.len()
        )
    }

    /// Sum of the absolute terms of a density's logarithm: it holds up to 12 * 9.8^2 / 2.
    fn terms(&self, log_prob: f32) -> f32 {
        let constants: f32 = self.log_std.iter().map(|log| 2.0 * log.abs() + 2.0).sum();
        log_prob.abs() + constants
    }

    fn agrees(&self) -> Drawn {
        let forms = self.run();
        let (action, log_prob) = &forms.twin;
        let width = self.log_std.len();
        let action_bar = |i: usize| match self.acts(i / width) {
            true => {
                let (mean, action) = (self.mean[i], action[i]);
                3e-6 * (action - mean).abs() + within_terms(&[mean, action])
            }
            false => 0.0,
        };
        let log_bar = |row: usize| match self.acts(row) {
            true => 3.0 * width as f32 * f32::EPSILON * self.terms(log_prob[row]),
            false => 0.0,
        };
        for (form, got) in forms.shaders() {
            close(form, &got.0, action, action_bar);
            close(form, &got.1, log_prob, log_bar);
        }
        for (row, log_prob) in log_prob.iter().enumerate() {
            assert_eq!(*log_prob == POISON, !self.acts(row), "row {row}");
        }
        forms.twin
    }
}

#[test]
fn agrees_with_its_twin_on_random_policies() {
    for seed in SEEDS {
        for rows in SIZES {
            for action in [1, ACTION, 28] {
                let log_std = Draw::new(seed).normals(action);
                Case::new(rows, seed, log_std).agrees();
            }
        }
    }
}

#[test]
fn agrees_for_extreme_deviations_and_keys() {
    for log in [-80.0, -20.0, 0.0, 5.0, 80.0] {
        let mut case = Case::new(65, u32::MAX, vec![log; ACTION]);
        case.params.step_counter = u32::MAX;
        case.agrees();
    }
}

#[test]
fn the_density_is_that_of_the_drawn_action() {
    let log_std = vec![
        -2.0, -1.0, -0.5, 0.0, 0.3, 1.0, -2.0, -1.0, -0.5, 0.0, 0.3, 1.0,
    ];
    let case = Case::new(1000, 3, log_std);
    let (action, log_prob) = case.run().twin;
    for row in (0..log_prob.len()).filter(|&row| case.acts(row)) {
        let density: f64 = (0..ACTION)
            .map(|i| {
                let at = row * ACTION + i;
                let log = f64::from(case.log_std[i]);
                let away = (f64::from(action[at]) - f64::from(case.mean[at])) / log.exp();
                -0.5 * away * away - log - 0.5 * std::f64::consts::TAU.ln()
            })
            .sum();
        // The action is rounded: at 5 deviations of e^-2 that moves the density by 1e-5.
        assert!((density - f64::from(log_prob[row])).abs() < 1e-4, "{row}");
    }
}

/// A row draws by its number in the batch: parts of a batch draw what the whole batch draws.
#[test]
fn parts_draw_what_all_together_draw() {
    let mut all = Case::new(100, 5, vec![0.5; ACTION]);
    (all.params.row, all.params.first) = (0, 0);
    let (actions, log_probs) = all.run().twin;
    let part = Case {
        params: sample_action::Params {
            rows: 40,
            row: 60,
            first: 60,
            ..all.params
        },
        ..all
    };
    let (action, log_prob) = part.run().twin;
    assert_eq!(
        action[60 * ACTION..][..40 * ACTION],
        actions[60 * ACTION..][..40 * ACTION]
    );
    assert_eq!(log_prob[60..100], log_probs[60..100]);
}
