//! `advance_and_reward::twin` against equation 4 of the paper, the bonuses and the penalties in f64.
//! Bar: 1e-5 of the terms' sum; ends and counts equal.

use crate::inputs::Draw;
use crate::support::database::DATABASE;
use footwork::env::locomotion::kernel_params::KernelParams;
use footwork::env::locomotion::task::Reward;
use footwork::env::locomotion::{EnvConfig, LocomotionTask, Obstacles};
use footwork::kernels::locomotion::advance_and_reward;
use footwork::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use footwork::kernels::termination;

const ENVS: usize = 2000;

/// Every weight 0.
const NOTHING: advance_and_reward::Params = advance_and_reward::Params {
    envs: ENVS as u32,
    offset: 0,
    reach: 0.5,
    near: 0.0,
    progress: 0.0,
    clear: 0.0,
    shift: 0.0,
    bonus: 0.0,
    crash: 0.0,
};

struct Worlds {
    before: (Vec<f32>, Vec<u32>),
    state_f32: Vec<f32>,
    state_u32: Vec<u32>,
    reward: Vec<f32>,
    termination: Vec<u32>,
}

impl Worlds {
    /// A step of random characters, some of which arrive, collide or are out of time.
    fn stepped(params: &advance_and_reward::Params) -> Self {
        let mut draw = Draw::new(1);
        let (mut state_f32, mut state_u32) = draw.state(ENVS, DATABASE.frames());
        for env in 0..ENVS {
            for (target, place) in [
                (state_f32::TARGET_X, state_f32::X),
                (state_f32::TARGET_Z, state_f32::Z),
            ] {
                state_f32[target * ENVS + env] = state_f32[place * ENVS + env] + draw.within(1.5);
            }
            state_u32[state_u32::HAS_COLLIDED * ENVS + env] = u32::from(draw.below(4) == 0);
        }
        let matched: Vec<u32> = (0..ENVS)
            .map(|_| draw.below(DATABASE.candidates.len()) as u32)
            .collect();
        let mut worlds = Worlds {
            before: (state_f32.clone(), state_u32.clone()),
            state_f32,
            state_u32,
            reward: vec![0.0; ENVS],
            termination: vec![0; ENVS],
        };
        advance_and_reward::twin(
            &DATABASE.candidates,
            &matched,
            &DATABASE.motion,
            &mut worlds.state_f32,
            &mut worlds.state_u32,
            &mut worlds.reward,
            &mut worlds.termination,
            params,
        );
        worlds
    }

    /// Distance to the target in a state.
    fn distance(reals: &[f32], env: usize) -> f64 {
        let at = |field: usize| f64::from(reals[field * ENVS + env]);
        (at(state_f32::TARGET_X) - at(state_f32::X))
            .hypot(at(state_f32::TARGET_Z) - at(state_f32::Z))
    }

    fn count(&self, field: usize, env: usize) -> u32 {
        self.state_u32[field * ENVS + env]
    }

    /// How a step has to end: a collision counts before an arrival, that before the last step.
    fn expected(&self, env: usize, distance: f64) -> u32 {
        let out_of_time =
            self.count(state_u32::EPISODE_STEP, env) >= self.count(state_u32::EPISODE_LIMIT, env);
        match (
            self.count(state_u32::HAS_COLLIDED, env) == 1,
            distance <= 0.5,
        ) {
            (true, _) => termination::FAILED,
            (false, true) => termination::SUCCESS,
            _ if out_of_time => termination::TRUNCATED,
            _ => termination::RUNNING,
        }
    }

    /// Judges rewards, ends and counts; how often each end came.
    fn judge(&self, params: &advance_and_reward::Params) -> [u32; 4] {
        let mut ends = [0; 4];
        let weights = [
            params.near,
            params.progress,
            params.clear,
            params.shift,
            params.bonus,
            params.crash,
        ];
        let [near, progress, clear, shift, bonus, crash] = weights.map(f64::from);
        for env in 0..ENVS {
            let before = Self::distance(&self.before.0, env);
            let after = Self::distance(&self.state_f32, env);
            if (after - 0.5).abs() < 1e-5 {
                continue;
            }
            let termination = self.expected(env, after);
            assert_eq!(self.termination[env], termination, "{env}");
            let hits = f64::from(self.count(state_u32::HITS, env));
            let mut reward = near * (-after).exp()
                + progress * (before - after)
                + clear * ((-hits).exp() - shift);
            reward += match termination {
                termination::SUCCESS => bonus,
                termination::FAILED => crash,
                _ => 0.0,
            };
            let got = f64::from(self.reward[env]);
            let bar = 1e-5 * weights.iter().fold(0.0, |sum, w| sum + f64::from(w.abs()));
            assert!(
                (got - reward).abs() <= bar,
                "{env}: {got} instead of {reward}"
            );
            self.judge_counts(env, termination);
            ends[termination as usize] += 1;
        }
        ends
    }

    fn judge_counts(&self, env: usize, termination: u32) {
        let gained = |field: usize| self.count(field, env) - self.before.1[field * ENVS + env];
        let of = |end: u32| u32::from(termination == end);
        assert_eq!(gained(state_u32::EPISODE_STEP), 1);
        assert_eq!(gained(state_u32::EPISODES), 1 - of(termination::RUNNING));
        assert_eq!(gained(state_u32::SUCCESSES), of(termination::SUCCESS));
        assert_eq!(gained(state_u32::COLLISIONS), of(termination::FAILED));
        assert_eq!(gained(state_u32::TRUNCATIONS), of(termination::TRUNCATED));
        let length = match termination {
            termination::RUNNING => 0,
            _ => self.count(state_u32::EPISODE_STEP, env),
        };
        assert_eq!(gained(state_u32::LENGTHS), length);
        for field in [
            state_u32::EPISODE_LIMIT,
            state_u32::HITS,
            state_u32::HAS_COLLIDED,
        ] {
            assert_eq!(gained(field), 0);
        }
    }
}

#[test]
fn every_weight_by_itself_and_all_together() {
    let all = advance_and_reward::Params {
        near: 1.0,
        progress: 4.0,
        clear: 1.0,
        shift: 1.0,
        bonus: 10.0,
        crash: -5.0,
        ..NOTHING
    };
    for params in [
        NOTHING,
        advance_and_reward::Params {
            near: 1.0,
            ..NOTHING
        },
        advance_and_reward::Params {
            progress: 4.0,
            ..NOTHING
        },
        advance_and_reward::Params {
            clear: 1.0,
            ..NOTHING
        },
        advance_and_reward::Params {
            shift: 1.0,
            ..NOTHING
        },
        advance_and_reward::Params {
            clear: 1.0,
            shift: 1.0,
            ..NOTHING
        },
        advance_and_reward::Params {
            bonus: 10.0,
            ..NOTHING
        },
        advance_and_reward::Params {
            crash: -5.0,
            ..NOTHING
        },
        all,
    ] {
        let ends = Worlds::stepped(&params).judge(&params);
        assert!(ends.iter().all(|&count| count > 100), "{ends:?}");
    }
}

/// The parameters of a reading of the task.
fn weights(task: Obstacles) -> advance_and_reward::Params {
    let config = EnvConfig {
        task: LocomotionTask::Obstacles(task),
        envs: ENVS,
        seed: 0,
        level: 9,
    };
    KernelParams::new(&config, 0, 1).advance_and_reward()
}

#[test]
fn the_papers_reward_is_equation_4_and_its_bonus() {
    let params = weights(Obstacles::PRINTED);
    let worlds = Worlds::stepped(&params);
    for env in 0..ENVS {
        let distance = Worlds::distance(&worlds.state_f32, env);
        let hits = f64::from(worlds.count(state_u32::HITS, env));
        let bonus = match worlds.termination[env] {
            termination::SUCCESS => 10.0,
            _ => 0.0,
        };
        let reward = (-distance).exp() + (-hits).exp() + bonus;
        assert!((f64::from(worlds.reward[env]) - reward).abs() < 1e-5);
    }
}

#[test]
fn every_switch_of_the_reward_has_its_weight() {
    let of = |task: Obstacles| {
        let p = weights(task);
        [p.near, p.progress, p.clear, p.shift, p.bonus, p.crash]
    };
    let paper = Obstacles::PRINTED;
    assert_eq!(of(paper), [1.0, 0.0, 1.0, 0.0, 10.0, 0.0]);
    let without = Obstacles {
        hit_reward: 0.0,
        success_bonus: 0.0,
        ..paper
    };
    assert_eq!(of(without), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let all = Obstacles {
        reward: Reward::Progress,
        hit_reward_is_penalty: true,
        collision_reward: -5.0,
        success_is_terminal: false,
        ..paper
    };
    assert_eq!(of(all), [0.0, 4.0, 1.0, 1.0, 10.0, -5.0]);
}
