//! Oracle: `sample_action::twin`, and the density of the drawn action in f64.
//! Bar: the noise is equal bit for bit, so an action differs by its exp, 3e-6 of the deviation's
//! share, and a rounding; the density's logarithm, a sum of 12 times 3 terms, by 36 roundings of
//! their absolute sum.

use crate::checked;
use crate::inputs::{Draw, POISON, SEEDS, SIZES, close, gpu, within_terms};
use bytemuck::cast_slice;
use footwork::gpu::kernel::groups;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::learn::sample_action;
use footwork::motion::features::TRAJECTORY_DIM;

struct Case {
    mean: Vec<f32>,
    log_std: Vec<f32>,
    params: sample_action::Params,
}

type Drawn = (Vec<f32>, Vec<f32>);

impl Case {
    fn new(envs: usize, seed: u32, log_std: Vec<f32>) -> Self {
        let mut draw = Draw::new(seed);
        Case {
            mean: draw.normals(envs * TRAJECTORY_DIM),
            log_std,
            params: sample_action::Params {
                envs: envs as u32,
                first: draw.below(1000) as u32,
                seed,
                step_counter: draw.bits()[0],
            },
        }
    }

    fn envs(&self) -> usize {
        self.params.envs as usize
    }

    fn poison(&self) -> Drawn {
        let envs = self.envs();
        (vec![POISON; envs * TRAJECTORY_DIM + 5], vec![POISON; envs + 5])
    }

    fn twin(&self) -> Drawn {
        let (mut action, mut log_prob) = self.poison();
        sample_action::twin(
            &self.mean,
            &self.log_std,
            &mut action,
            &mut log_prob,
            &self.params,
        );
        (action, log_prob)
    }

    fn launch(&self) -> Drawn {
        let gpu = gpu();
        let (action, log_prob) = self.poison();
        let action = Buffer::from_slice(&gpu, &action);
        let log_prob = Buffer::from_slice(&gpu, &log_prob);
        sample_action::launch(
            &gpu,
            &Buffer::from_slice(&gpu, &self.mean),
            &Buffer::from_slice(&gpu, &self.log_std),
            &action,
            &log_prob,
            &self.params,
        );
        (
            action.read(&gpu).expect("action"),
            log_prob.read(&gpu).expect("log_prob"),
        )
    }

    fn checked(&self) -> Drawn {
        let (action, log_prob) = self.poison();
        let buffers: [&[u8]; 4] = [
            cast_slice(&self.mean),
            cast_slice(&self.log_std),
            cast_slice(&action),
            cast_slice(&log_prob),
        ];
        let outcome = checked::run(
            &shader::SAMPLE_ACTION,
            groups(&shader::SAMPLE_ACTION, self.envs()),
            &buffers,
            &self.params,
        );
        (outcome.of(2), outcome.of(3))
    }

    /// Sum of the absolute terms of a density's logarithm: it holds up to 12 * 9.8^2 / 2.
    fn terms(&self, log_prob: f32) -> f32 {
        let constants: f32 = self.log_std.iter().map(|log| 2.0 * log.abs() + 2.0).sum();
        log_prob.abs() + constants
    }

    fn agrees(&self) -> Drawn {
        let twin = self.twin();
        let action_bar = |i: usize| match self.mean.get(i) {
            Some(mean) => 3e-6 * (twin.0[i] - mean).abs() + within_terms(&[*mean, twin.0[i]]),
            None => 0.0,
        };
        let log_bar = |env: usize| match env {
            env if env < self.envs() => 36.0 * f32::EPSILON * self.terms(twin.1[env]),
            _ => 0.0,
        };
        for (form, got) in [("launched", self.launch()), ("checked", self.checked())] {
            close(form, &got.0, &twin.0, action_bar);
            close(form, &got.1, &twin.1, log_bar);
        }
        twin
    }
}

#[test]
fn agrees_with_its_twin_on_random_policies() {
    for seed in SEEDS {
        for envs in SIZES {
            let log_std = Draw::new(seed).normals(TRAJECTORY_DIM);
            Case::new(envs, seed, log_std).agrees();
        }
    }
}

#[test]
fn agrees_for_extreme_deviations_and_keys() {
    for log in [-80.0, -20.0, 0.0, 5.0, 80.0] {
        let mut case = Case::new(65, u32::MAX, vec![log; TRAJECTORY_DIM]);
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
    let (action, log_prob) = case.twin();
    for (env, log_prob) in log_prob.into_iter().enumerate().take(1000) {
        let density: f64 = (0..TRAJECTORY_DIM)
            .map(|i| {
                let at = env * TRAJECTORY_DIM + i;
                let log = f64::from(case.log_std[i]);
                let away = (f64::from(action[at]) - f64::from(case.mean[at])) / log.exp();
                -0.5 * away * away - log - 0.5 * std::f64::consts::TAU.ln()
            })
            .sum();
        // The action is rounded: at 5 deviations of e^-2 that moves the density by 1e-5.
        assert!((density - f64::from(log_prob)).abs() < 1e-4, "{env}");
    }
}
