//! `step::twin` against equation 4 of the paper, the bonuses and the penalties in f64.
//! Bar: 1e-5 of the terms' sum; ends and counts equal.

use crate::inputs::Draw;
use crate::paper::DATABASE;
use footwork::kernels::layout::{end, real, whole};
use footwork::kernels::step;
use footwork::world::rules::Rules;
use footwork::world::task::{Arrival, Reward};
use footwork::world::{Obstacles, Task};

const ENVS: usize = 2000;

/// Every weight 0.
const NOTHING: step::Params = step::Params {
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
    real: Vec<f32>,
    whole: Vec<u32>,
    reward: Vec<f32>,
    ended: Vec<u32>,
}

impl Worlds {
    /// A step of random characters, some of which arrive, collide or are out of time.
    fn stepped(params: &step::Params) -> Self {
        let mut draw = Draw::new(1);
        let (mut real, mut whole) = draw.state(ENVS, DATABASE.frames());
        for env in 0..ENVS {
            for (target, place) in [(real::TARGET_X, real::X), (real::TARGET_Z, real::Z)] {
                real[target * ENVS + env] = real[place * ENVS + env] + draw.within(1.5);
            }
            whole[whole::STRUCK * ENVS + env] = u32::from(draw.below(4) == 0);
        }
        let matched: Vec<u32> = (0..ENVS)
            .map(|_| draw.below(DATABASE.candidates.len()) as u32)
            .collect();
        let mut worlds = Worlds {
            before: (real.clone(), whole.clone()),
            real,
            whole,
            reward: vec![0.0; ENVS],
            ended: vec![0; ENVS],
        };
        step::twin(
            &DATABASE.candidates,
            &matched,
            &DATABASE.motion,
            &mut worlds.real,
            &mut worlds.whole,
            &mut worlds.reward,
            &mut worlds.ended,
            params,
        );
        worlds
    }

    /// Distance to the target in a state.
    fn distance(reals: &[f32], env: usize) -> f64 {
        let at = |field: usize| f64::from(reals[field * ENVS + env]);
        (at(real::TARGET_X) - at(real::X)).hypot(at(real::TARGET_Z) - at(real::Z))
    }

    fn count(&self, field: usize, env: usize) -> u32 {
        self.whole[field * ENVS + env]
    }

    /// How a step has to end: a collision counts before an arrival, that before the last step.
    fn expected(&self, env: usize, distance: f64) -> u32 {
        let out_of_time = self.count(whole::AGE, env) >= self.count(whole::LIMIT, env);
        match (self.count(whole::STRUCK, env) == 1, distance <= 0.5) {
            (true, _) => end::COLLIDED,
            (false, true) => end::REACHED,
            _ if out_of_time => end::TRUNCATED,
            _ => end::RUNNING,
        }
    }

    /// Judges rewards, ends and counts; how often each end came.
    fn judge(&self, params: &step::Params) -> [u32; 4] {
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
            let after = Self::distance(&self.real, env);
            if (after - 0.5).abs() < 1e-5 {
                continue;
            }
            let ended = self.expected(env, after);
            assert_eq!(self.ended[env], ended, "{env}");
            let hits = f64::from(self.count(whole::HITS, env));
            let mut reward = near * (-after).exp()
                + progress * (before - after)
                + clear * ((-hits).exp() - shift);
            reward += match ended {
                end::REACHED => bonus,
                end::COLLIDED => crash,
                _ => 0.0,
            };
            let got = f64::from(self.reward[env]);
            let bar = 1e-5 * weights.iter().fold(0.0, |sum, w| sum + f64::from(w.abs()));
            assert!(
                (got - reward).abs() <= bar,
                "{env}: {got} instead of {reward}"
            );
            self.judge_counts(env, ended);
            ends[ended as usize] += 1;
        }
        ends
    }

    fn judge_counts(&self, env: usize, ended: u32) {
        let gained = |field: usize| self.count(field, env) - self.before.1[field * ENVS + env];
        let of = |end: u32| u32::from(ended == end);
        assert_eq!(gained(whole::AGE), 1);
        assert_eq!(gained(whole::EPISODES), 1 - of(end::RUNNING));
        assert_eq!(gained(whole::SUCCESSES), of(end::REACHED));
        assert_eq!(gained(whole::COLLISIONS), of(end::COLLIDED));
        assert_eq!(gained(whole::TRUNCATIONS), of(end::TRUNCATED));
        let length = match ended {
            end::RUNNING => 0,
            _ => self.count(whole::AGE, env),
        };
        assert_eq!(gained(whole::LENGTHS), length);
        for field in [whole::LIMIT, whole::HITS, whole::STRUCK] {
            assert_eq!(gained(field), 0);
        }
    }
}

#[test]
fn every_weight_by_itself_and_all_together() {
    let all = step::Params {
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
        step::Params {
            near: 1.0,
            ..NOTHING
        },
        step::Params {
            progress: 4.0,
            ..NOTHING
        },
        step::Params {
            clear: 1.0,
            ..NOTHING
        },
        step::Params {
            shift: 1.0,
            ..NOTHING
        },
        step::Params {
            clear: 1.0,
            shift: 1.0,
            ..NOTHING
        },
        step::Params {
            bonus: 10.0,
            ..NOTHING
        },
        step::Params {
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
fn weights(task: Obstacles) -> step::Params {
    let rules = Rules {
        task: Task::Obstacles(task),
        envs: ENVS,
        first: 0,
        horizon: 8,
        candidates: 1,
        seed: 0,
        clock: 0,
        level: 9,
    };
    rules.step()
}

#[test]
fn the_papers_reward_is_equation_4_and_its_bonus() {
    let params = weights(Obstacles::PRINTED);
    let worlds = Worlds::stepped(&params);
    for env in 0..ENVS {
        let distance = Worlds::distance(&worlds.real, env);
        let hits = f64::from(worlds.count(whole::HITS, env));
        let bonus = match worlds.ended[env] {
            end::REACHED => 10.0,
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
        hit_shift: true,
        collision: -5.0,
        arrival: Arrival::Continue,
        ..paper
    };
    assert_eq!(of(all), [0.0, 4.0, 1.0, 1.0, 10.0, -5.0]);
}
