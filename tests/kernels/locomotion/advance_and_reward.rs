//! Oracle: `advance_and_reward::twin` (and the paper's formulas in `paper`).
//! Bar: frames, ages, counts and ends equal; positions and headings within 4 roundings of their
//! terms, as a compiler may fuse a product into a sum; rewards within 8 + 4 d units in the last
//! place at distance d, twice what WGSL grants exp(-d), and the roundings of the distance.

use crate::inputs::{
    Draw, POISON, POISON_WHOLE, SEEDS, SIZES, close, places_but, same, within_terms,
};
use footwork::kernels::locomotion::advance_and_reward;
use footwork::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use footwork::kernels::termination;
use footwork::motion::database::RootMotion;

struct Case {
    candidates: Vec<u32>,
    matched: Vec<u32>,
    motion: Vec<RootMotion>,
    state: State,
    params: advance_and_reward::Params,
}

#[derive(Clone)]
struct State {
    state_f32: Vec<f32>,
    state_u32: Vec<u32>,
    reward: Vec<f32>,
    termination: Vec<u32>,
}

impl Case {
    fn random(envs: usize, seed: u32) -> Self {
        let mut draw = Draw::new(seed);
        let candidates: Vec<u32> = (0..300).map(|place| 3 * place + 1).collect();
        let (state_f32, state_u32) = draw.state(envs, 1000);
        let offset = draw.below(3) * envs;
        let places = offset + envs + 5;
        Case {
            matched: (0..envs).map(|_| draw.below(300) as u32).collect(),
            motion: (0..300).map(|_| draw.motion()).collect(),
            state: State {
                state_f32,
                state_u32,
                reward: vec![POISON; places],
                termination: vec![POISON_WHOLE; places],
            },
            candidates,
            params: advance_and_reward::Params {
                envs: envs as u32,
                offset: offset as u32,
                reach: 0.5,
                near: 1.0,
                progress: 0.0,
                clear: 0.0,
                shift: 0.0,
                bonus: 1000.0,
                crash: 0.0,
            },
        }
    }

    fn envs(&self) -> usize {
        self.params.envs as usize
    }

    fn set(&mut self, env: usize, values: &[(usize, f32)]) {
        let envs = self.envs();
        for &(field, value) in values {
            self.state.state_f32[field * envs + env] = value;
        }
    }

    fn fill(&mut self, field: usize, value: u32) {
        let envs = self.envs();
        self.state.state_u32[field * envs..][..envs].fill(value);
    }

    fn agrees(&self) -> State {
        let State {
            state_f32,
            state_u32,
            reward,
            termination,
        } = &self.state;
        let forms = forms!(
            advance_and_reward, ADVANCE_AND_REWARD, self.envs(), self.params;
            self.candidates, self.matched, self.motion,
            mut state_f32, mut state_u32, mut reward, mut termination
        );
        let forms = forms.map(|(state_f32, state_u32, reward, termination)| State {
            state_f32,
            state_u32,
            reward,
            termination,
        });
        for (form, got) in forms.shaders() {
            self.compare(form, got, &forms.twin);
        }
        forms.twin
    }

    /// What a reward may differ by where the way to the target differs by `blur`.
    fn reward_bar(&self, want: &State, env: usize, blur: f32) -> f32 {
        let p = &self.params;
        let distance = |reals: &[f32]| {
            let at = |field: usize| reals[field * self.envs() + env];
            (at(state_f32::TARGET_X) - at(state_f32::X))
                .hypot(at(state_f32::TARGET_Z) - at(state_f32::Z))
        };
        let (before, after) = (distance(&self.state.state_f32), distance(&want.state_f32));
        let near = p.near * (-after).exp();
        let terms = near + p.clear * (1.0 + p.shift) + p.bonus + p.crash.abs();
        near * ((8.0 + 4.0 * after) * f32::EPSILON + blur)
            + p.progress * (2.0 * blur + 4.0 * f32::EPSILON * (before + after))
            + p.clear * 20.0 * f32::EPSILON
            + 4.0 * f32::EPSILON * terms
    }

    fn compare(&self, form: &str, got: &State, want: &State) {
        let envs = self.envs();
        assert_eq!(got.termination, want.termination, "{form}: ended");
        assert_eq!(got.state_u32, want.state_u32, "{form}: whole");
        // A place is the sum of the old place and two products.
        let place = |i: usize| within_terms(&[self.state.state_f32[i], want.state_f32[i], 2.0]);
        let fields = |field: usize| field * envs..(field + 1) * envs;
        for field in [state_f32::X, state_f32::Z] {
            let part = fields(field);
            close(
                form,
                &got.state_f32[part.clone()],
                &want.state_f32[part.clone()],
                |i| place(part.start + i),
            );
        }
        for field in [state_f32::HEADING_X, state_f32::HEADING_Z] {
            let part = fields(field);
            close(
                form,
                &got.state_f32[part.clone()],
                &want.state_f32[part],
                |_| within_terms(&[1.0]),
            );
        }
        for field in [
            state_f32::TARGET_X,
            state_f32::TARGET_Z,
            state_f32::TRAVELLED,
        ] {
            same(
                form,
                &got.state_f32[fields(field)],
                &want.state_f32[fields(field)],
            );
        }
        let offset = self.params.offset as usize;
        let gained = |i: usize| match i.checked_sub(offset) {
            Some(env) if env < envs => {
                let blur = 4.0 * place(env).max(place(envs + env));
                self.reward_bar(want, env, blur)
            }
            _ => 0.0,
        };
        close(form, &got.reward, &want.reward, |i| {
            gained(i) + f32::MIN_POSITIVE
        });
        for field in [state_f32::RETURN, state_f32::RETURNS] {
            let part = fields(field);
            close(
                form,
                &got.state_f32[part.clone()],
                &want.state_f32[part.clone()],
                |env| {
                    let terms = [
                        self.state.state_f32[part.start + env],
                        want.state_f32[part.start + env],
                    ];
                    gained(offset + env) + within_terms(&terms)
                },
            );
        }
        let written = self.params.offset as usize..self.params.offset as usize + envs;
        assert!(
            places_but(&written, &got.reward).all(|&r| r == POISON),
            "{form}"
        );
        assert!(
            places_but(&written, &got.termination).all(|&e| e == POISON_WHOLE),
            "{form}"
        );
    }
}

#[test]
fn agrees_with_its_twin_on_random_states() {
    for seed in SEEDS {
        for envs in SIZES {
            Case::random(envs, seed).agrees();
        }
    }
}

#[test]
fn agrees_with_its_twin_under_all_rewards_and_penalties() {
    for seed in SEEDS {
        for envs in SIZES {
            let mut case = Case::random(envs, seed);
            case.params = advance_and_reward::Params {
                reach: 10.0,
                progress: 4.0,
                clear: 1.0,
                shift: 1.0,
                bonus: 10.0,
                crash: -5.0,
                ..case.params
            };
            case.agrees();
        }
    }
}

#[test]
fn a_collision_comes_before_an_arrival_and_that_before_the_last_step() {
    let mut case = standing(80);
    (case.params.bonus, case.params.crash) = (10.0, -5.0);
    case.params.near = 0.0;
    case.fill(state_u32::EPISODE_STEP, 9);
    for env in 0..8 {
        let target = if env & 1 == 1 { 0.25 } else { 3.0 };
        case.set(
            env,
            &[(state_f32::TARGET_X, target), (state_f32::TARGET_Z, 0.0)],
        );
        case.state.state_u32[state_u32::HAS_COLLIDED * 80 + env] = (env >> 1 & 1) as u32;
        case.state.state_u32[state_u32::EPISODE_LIMIT * 80 + env] =
            if env & 4 == 4 { 10 } else { 11 };
    }
    let after = case.agrees();
    let (reached, struck) = ((termination::SUCCESS, 10.0), (termination::FAILED, -5.0));
    let (running, truncated) = ((termination::RUNNING, 0.0), (termination::TRUNCATED, 0.0));
    let expected = [
        running, reached, struck, struck, truncated, reached, struck, struck,
    ];
    for (env, expected) in expected.into_iter().enumerate() {
        let at = case.params.offset as usize + env;
        assert_eq!((after.termination[at], after.reward[at]), expected, "{env}");
    }
}

/// A character that stands still at the origin, so that distances are exact.
fn standing(envs: usize) -> Case {
    let mut case = Case::random(envs, 5);
    case.fill(state_u32::HAS_COLLIDED, 0);
    case.motion.fill(RootMotion {
        moved: [0.0; 2],
        turned: [0.0, 1.0],
        length: 0.0,
    });
    for env in 0..envs {
        case.set(
            env,
            &[
                (state_f32::X, 0.0),
                (state_f32::Z, 0.0),
                (state_f32::RETURN, 0.0),
            ],
        );
        case.set(
            env,
            &[(state_f32::HEADING_X, 0.0), (state_f32::HEADING_Z, 1.0)],
        );
        case.set(
            env,
            &[(state_f32::TARGET_X, 3.0), (state_f32::TARGET_Z, -4.0)],
        );
    }
    case
}

#[test]
fn ends_exactly_at_reach_and_at_the_last_step() {
    let mut case = standing(70);
    let further = 0.5f32.next_up();
    let places = [
        [0.5, 0.0],
        [0.0, -0.5],
        [0.0, further],
        [-further, 0.0],
        [3.0, 4.0],
    ];
    let ages = [0, 198, 199, 200, u32::MAX - 1];
    case.fill(state_u32::EPISODE_LIMIT, 200);
    for env in 0..25 {
        let [x, z]: [f32; 2] = places[env % 5];
        case.set(env, &[(state_f32::TARGET_X, x), (state_f32::TARGET_Z, z)]);
        case.state.state_u32[state_u32::EPISODE_STEP * 70 + env] = ages[env / 5];
    }
    let after = case.agrees();
    for env in 0..25 {
        // Arrival counts first, also at the last step.
        let expected = match (env % 5, env / 5) {
            (0 | 1, _) => termination::SUCCESS,
            (_, 2..) => termination::TRUNCATED,
            _ => termination::RUNNING,
        };
        assert_eq!(
            after.termination[case.params.offset as usize + env],
            expected,
            "{env}"
        );
    }
}

#[test]
fn survives_degenerate_headings() {
    let mut case = Case::random(65, 9);
    let headings = [
        [3.0, -4.0],
        [1e-3, 0.0],
        [0.0, 1e-12],
        [0.0, 0.0],
        [1e9, 1e9],
        [f32::NAN, 1.0],
    ];
    for (env, [x, z]) in headings.into_iter().enumerate() {
        case.set(env, &[(state_f32::HEADING_X, x), (state_f32::HEADING_Z, z)]);
    }
    // Huge and lost headings move the character as far: only the heading is compared there.
    for env in [4, 5] {
        case.set(
            env,
            &[(state_f32::TARGET_X, 1e12), (state_f32::TARGET_Z, 0.0)],
        );
        case.motion[case.matched[env] as usize].moved = [0.0; 2];
    }
    case.agrees();
}

#[test]
fn all_end_or_none_ends() {
    let mut case = standing(130);
    assert!(
        case.agrees().termination[case.params.offset as usize..][..130]
            != [termination::SUCCESS; 130]
    );
    case.params.reach = 5.0;
    assert_eq!(
        case.agrees().termination[case.params.offset as usize..][..130],
        [termination::SUCCESS; 130]
    );
    case.params.reach = 4.9;
    case.fill(state_u32::EPISODE_LIMIT, 0);
    assert_eq!(
        case.agrees().termination[case.params.offset as usize..][..130],
        [termination::TRUNCATED; 130]
    );
    case.fill(state_u32::EPISODE_LIMIT, u32::MAX);
    assert_eq!(
        case.agrees().termination[case.params.offset as usize..][..130],
        [termination::RUNNING; 130]
    );
}
