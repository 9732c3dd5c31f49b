//! Oracle: `reset::twin`; the distribution it draws is tested here too.
//! Bar: everything equal bit for bit but the heading, a quotient of a square root: 4 roundings.

use crate::inputs::{Draw, POISON, POISON_WHOLE, SEEDS, SIZES, close, same, within_terms};
use crate::support::forms::Forms;
use crate::support::geometry::depth;
use crate::support::ground::{COUNTS, Ground};
use footwork::kernels::locomotion::locomotion_layout::{boxes, state_f32, state_u32};
use footwork::kernels::locomotion::reset;
use footwork::kernels::termination;

/// Numbers past the last box.
const MIN_FUTURE_FRAMES: usize = 5;

struct Case {
    candidates: Vec<u32>,
    termination: Vec<u32>,
    boxes: Vec<f32>,
    params: reset::Params,
}

type State = (Vec<f32>, Vec<u32>);

impl Case {
    fn new(envs: usize, seed: u32, termination: impl Fn(usize) -> u32) -> Self {
        let mut draw = Draw::new(seed);
        let candidates: Vec<u32> = (0..=draw.below(5000))
            .map(|place| 7 * place as u32)
            .collect();
        let offset = draw.below(3) * envs;
        // Ends of other steps would start episodes anew if they were read.
        let mut ends = vec![termination::SUCCESS; offset + envs + 5];
        for env in 0..envs {
            ends[offset + env] = termination(env);
        }
        Case {
            params: reset::Params {
                envs: envs as u32,
                first: 3,
                candidates: candidates.len() as u32,
                seed,
                step_counter: draw.bits()[0],
                offset: offset as u32,
                all: 0,
                count: 0,
                max_steps: 200,
                initial_age_jitter: 0,
                half_side: 5.0,
                reach: 0.5,
                clear: 0,
            },
            candidates,
            termination: ends,
            boxes: vec![0.0; MIN_FUTURE_FRAMES],
        }
    }

    /// The same among obstacles that targets keep out of.
    fn among(mut self, ground: &Ground) -> Self {
        self.boxes = ground.boxes.clone();
        (self.params.count, self.params.clear) = (ground.count as u32, 1);
        self
    }

    fn envs(&self) -> usize {
        self.params.envs as usize
    }

    fn run(&self) -> Forms<State> {
        let envs = self.envs();
        forms!(
            reset, RESET, envs, self.params; self.candidates, self.termination, self.boxes,
            out state_f32::FIELDS * envs, out state_u32::FIELDS * envs
        )
    }

    fn agrees(&self) -> State {
        let forms = self.run();
        let twin = &forms.twin;
        for (form, got) in forms.shaders() {
            assert_eq!(got.1, twin.1, "{form}, {:?}", self.params);
            for field in 0..state_f32::FIELDS {
                let part = field * self.envs()..(field + 1) * self.envs();
                let (got, want) = (&got.0[part.clone()], &twin.0[part]);
                if [state_f32::HEADING_X, state_f32::HEADING_Z].contains(&field) {
                    close(form, got, want, |_| within_terms(&[1.0]));
                } else {
                    same(form, got, want);
                }
            }
        }
        forms.twin
    }
}

#[test]
fn agrees_with_its_twin_on_random_ends() {
    for seed in SEEDS {
        for envs in SIZES {
            let mut draw = Draw::new(seed);
            let ends: Vec<u32> = (0..envs).map(|_| draw.below(4) as u32).collect();
            let (state_f32, state_u32) = Case::new(envs, seed, |env| ends[env]).agrees();
            for env in 0..envs {
                let untouched = ends[env] == termination::RUNNING;
                assert_eq!(state_f32[env] == POISON, untouched);
                assert_eq!(state_u32[env] == POISON_WHOLE, untouched);
                let at = |field: usize| state_u32[field * envs + env];
                let just_reset = if untouched {
                    [POISON_WHOLE; 2]
                } else {
                    [0, 200]
                };
                assert_eq!(
                    [at(state_u32::EPISODE_STEP), at(state_u32::EPISODE_LIMIT)],
                    just_reset
                );
            }
            assert!(
                state_f32[state_f32::RETURNS * envs..]
                    .iter()
                    .all(|&r| r == POISON)
            );
            assert!(
                state_u32[state_u32::HITS * envs..]
                    .iter()
                    .all(|&w| w == POISON_WHOLE)
            );
        }
    }
}

#[test]
fn agrees_at_the_edges_of_its_parameters() {
    for (seed, step_counter) in [(0, 0), (u32::MAX, u32::MAX), (1, 12345)] {
        for (half_side, reach) in [
            (5.0, 0.5),
            (0.51, 0.5),
            (0.3536, 0.5),
            (0.2, 0.5),
            (1e4, 0.0),
        ] {
            for initial_age_jitter in [0, 1, 2, 199, 200] {
                let mut case = Case::new(130, seed, |_| termination::RUNNING);
                case.params.all = 1;
                (case.params.seed, case.params.step_counter) = (seed, step_counter);
                (case.params.half_side, case.params.reach) = (half_side, reach);
                case.params.initial_age_jitter = initial_age_jitter;
                case.agrees();
            }
        }
    }
}

#[test]
fn a_square_within_reach_leaves_the_corner() {
    let mut case = Case::new(65, 3, |_| termination::SUCCESS);
    (case.params.half_side, case.params.reach) = (0.36, 0.51);
    let (state_f32, _) = case.agrees();
    assert_eq!(
        state_f32[state_f32::TARGET_X * 65..(state_f32::TARGET_Z + 1) * 65],
        [0.36; 130]
    );
}

#[test]
fn one_candidate_and_none_ended() {
    let mut case = Case::new(65, 4, |_| termination::TRUNCATED);
    case.candidates = vec![42];
    case.params.candidates = 1;
    assert_eq!(case.agrees().1[..65], [42; 65]);
    let case = Case::new(65, 4, |_| termination::RUNNING);
    let (state_f32, state_u32) = case.agrees();
    assert!(state_f32.iter().all(|&value| value == POISON));
    assert!(state_u32.iter().all(|&value| value == POISON_WHOLE));
}

#[test]
fn starts_and_targets_are_uniform() {
    const ENVS: usize = 40_000;
    let mut case = Case::new(ENVS, 11, |_| termination::SUCCESS);
    case.candidates = (0..100).collect();
    (case.params.candidates, case.params.initial_age_jitter) = (100, 200);
    let (state_f32, state_u32) = case.run().twin;
    let field = |field: usize| {
        state_f32[field * ENVS..(field + 1) * ENVS]
            .iter()
            .map(|&v| f64::from(v))
    };
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / ENVS as f64;
    for axis in [state_f32::TARGET_X, state_f32::TARGET_Z] {
        assert!(field(axis).all(|v| v.abs() <= 5.0));
        assert!(mean(&mut field(axis)).abs() < 0.07, "deviation 0.0145");
        // Of [-5, 5] without the disc: 25/3 = 8.33, and a little more.
        assert!((mean(&mut field(axis).map(|v| v * v)) - 8.39).abs() < 0.2);
    }
    let distances = || {
        field(state_f32::TARGET_X)
            .zip(field(state_f32::TARGET_Z))
            .map(|(x, z)| x.hypot(z))
    };
    assert!(distances().all(|d| d > 0.5) && distances().any(|d| d < 0.6));
    for axis in [state_f32::HEADING_X, state_f32::HEADING_Z] {
        assert!(mean(&mut field(axis)).abs() < 0.02);
        assert!((mean(&mut field(axis).map(|v| v * v)) - 0.5).abs() < 0.01);
    }
    for (field, kinds) in [(state_u32::FRAME, 100), (state_u32::EPISODE_LIMIT, 200)] {
        let mut counts = vec![0.0f64; kinds];
        for &value in &state_u32[field * ENVS..(field + 1) * ENVS] {
            counts[value as usize % kinds] += 1.0;
        }
        let expected = ENVS as f64 / kinds as f64;
        let chi: f64 = counts
            .iter()
            .map(|c| (c - expected).powi(2) / expected)
            .sum();
        assert!(
            chi < kinds as f64 + 5.0 * (2.0 * kinds as f64).sqrt(),
            "chi {chi}"
        );
    }
}

#[test]
fn targets_lie_in_no_obstacle_if_asked() {
    for count in COUNTS {
        for envs in SIZES {
            let ground = Ground::new(envs, count, 5, false);
            let mut case = Case::new(envs, 5, |_| termination::SUCCESS).among(&ground);
            let (state_f32, _) = case.agrees();
            case.params.clear = 0;
            let (anywhere, _) = case.agrees();
            let mut inside = 0;
            for env in 0..envs {
                let target = |of: &[f32]| {
                    [state_f32::TARGET_X, state_f32::TARGET_Z]
                        .map(|field| f64::from(of[field * envs + env]))
                };
                let obstacles = ground.obstacles(env);
                assert!(
                    depth(&obstacles, target(&state_f32)) < 0.0,
                    "environment {env}"
                );
                assert!(target(&state_f32)[0].hypot(target(&state_f32)[1]) > 0.5);
                let drawn_inside = depth(&obstacles, target(&anywhere)) >= 0.0;
                inside += usize::from(drawn_inside);
                // Only those inside are drawn again.
                assert_eq!(target(&state_f32) != target(&anywhere), drawn_inside);
            }
            assert!(envs < 1000 || count < 100 || inside > envs / 8, "{inside}");
        }
    }
}

#[test]
fn where_all_is_covered_the_corner_remains() {
    let mut ground = Ground::new(65, 400, 6, false);
    for env in 0..65 {
        let half = (env * boxes::FIELDS + boxes::HALF_X) * 400;
        ground.boxes[half..half + 800].fill(64.0);
    }
    let (state_f32, _) = Case::new(65, 6, |_| termination::FAILED)
        .among(&ground)
        .agrees();
    let targets = state_f32::TARGET_X * 65..(state_f32::TARGET_Z + 1) * 65;
    assert_eq!(state_f32[targets], [5.0; 130]);
}

/// Lavapipe silently stops after 65,535 loop iterations: 32 draws look at 2,047 boxes at most.
#[test]
fn the_last_of_two_thousand_boxes_keeps_targets_out() {
    const MOST: usize = 2_000;
    let mut ground = Ground::crowded(65, MOST);
    for env in 0..65 {
        // All of the square but a rim, so that most targets are drawn again and again.
        let half = (env * boxes::FIELDS + boxes::HALF_X) * MOST;
        ground.boxes[half + MOST - 1] = 4.5;
        ground.boxes[half + 2 * MOST - 1] = 4.5;
    }
    let (state_f32, _) = Case::new(65, 7, |_| termination::FAILED)
        .among(&ground)
        .agrees();
    for env in 0..65 {
        let away = [state_f32::TARGET_X, state_f32::TARGET_Z]
            .map(|field| state_f32[field * 65 + env].abs());
        assert!(away[0].max(away[1]) > 4.5, "environment {env}");
    }
}
