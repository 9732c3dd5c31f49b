//! Environments of self-play around those of the task `box`, and the pool of opponents.
//! Oracle: the same fighters, stepped by hand; counts by hand. Bar: equal bit for bit; drawn fractions within what
//! chance allows.

use super::style::{LIBRARY, imitate, play, rules};
use crate::support::inputs::{POISON, gpu, same};
use footwork::container::Section;
use footwork::env::humanoid::boxing::{Boxing, BoxingTask};
use footwork::env::humanoid::task::open;
use footwork::env::{ObservationSpec, Transition, VecEnv, termination};
use footwork::gpu::{Array, Device};
use footwork::kernels::rng::random4;
use footwork::nn::layer::Activation;
use footwork::nn::{NetworkConfig, Policy};
use footwork::rl::self_play::{BoutResults, Opponent, Pool, SelfPlay, SelfPlayEnv};
use std::ops::Range;
use std::sync::Arc;

const CPU: Device = Device::Cpu;
const ENVS: usize = 24;
const FIRST: usize = 5;
const SEED: u32 = 3;

fn fighters() -> Box<dyn VecEnv> {
    fighters_on(&CPU)
}

fn fighters_on(device: &Device) -> Box<dyn VecEnv> {
    some_fighters(device, FIRST..FIRST + ENVS)
}

fn some_fighters(device: &Device, envs: Range<usize>) -> Box<dyn VecEnv> {
    let boxing = Boxing {
        rules: rules(0.3),
        ..Boxing::default()
    };
    let task = Arc::new(BoxingTask::new(&boxing, &LIBRARY, SEED));
    open(device, task, envs, SEED).unwrap()
}

fn self_play() -> SelfPlayEnv {
    SelfPlayEnv::new(fighters(), &CPU, FIRST, SEED).unwrap()
}

/// A policy of random numbers, of such a standard deviation.
fn policy(envs: &dyn VecEnv, seed: u32, log_std: f32) -> Policy {
    let network = NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden: vec![16, 16],
        activation: Activation::Relu,
    };
    let spec = envs.spec();
    let mut policy = Policy::new(&network, &spec.observation, spec.action, 1).unwrap();
    policy.parameters = policy.networks().init(seed, log_std, &envs.rest_action());
    policy
}

/// No deviation at all.
const SURE: f32 = -1e9;

/// A pool of one who rests and two policies that do not hesitate.
fn pool(envs: &dyn VecEnv) -> Pool {
    pool_with(envs, SURE)
}

/// A pool of one who rests and two policies of such a standard deviation.
fn pool_with(envs: &dyn VecEnv, log_std: f32) -> Pool {
    let resting = resting(envs);
    let mut pool = Pool::new(
        &SelfPlay::default(),
        vec![resting],
        policy(envs, 1, log_std),
    );
    pool.admit(policy(envs, 2, log_std));
    pool
}

fn resting(envs: &dyn VecEnv) -> Opponent {
    Opponent::repeating(envs.rest_action())
}

/// What an opponent does that does not hesitate.
fn act(opponent: &Opponent, row: &[f32]) -> Vec<f32> {
    match opponent {
        Opponent::Scripted(strides) => strides.choose(row).to_vec(),
        Opponent::Frozen(policy) => policy.mean(row),
    }
}

/// A policy of the smallest kind.
fn tiny() -> Policy {
    small(1)
}

/// One of a hidden layer of such a width.
fn small(width: usize) -> Policy {
    let network = NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden: vec![width],
        activation: Activation::Relu,
    };
    let observation = ObservationSpec {
        vector: 1,
        grid: None,
    };
    Policy::new(&network, &observation, 1, 1).unwrap()
}

/// A pool of so many, all but one of whom never leave.
fn pool_of(count: usize, chosen: &SelfPlay) -> Pool {
    let scripted = (1..count).map(|number| Opponent::repeating(vec![number as f32]));
    Pool::new(chosen, scripted.collect(), tiny())
}

/// The learner's agent and the opponent of every bout.
fn bouts(envs: &SelfPlayEnv) -> Vec<[u32; 2]> {
    let mut section = Section::default();
    envs.save(&mut section).unwrap();
    section.take_array("bouts", ENVS).unwrap()
}

/// What one step came to, by row.
#[derive(Debug, PartialEq)]
struct Step {
    seen: Vec<f32>,
    reward: Vec<f32>,
    ends: Vec<u32>,
    group: Vec<u32>,
    last: Vec<f32>,
}

fn seen(envs: &mut dyn VecEnv) -> Vec<f32> {
    let mut seen = Array::zeroed(&CPU, envs.spec().rows() * envs.spec().observation.dim());
    envs.observe(&mut seen, 0);
    seen.host().to_vec()
}

fn step(envs: &mut dyn VecEnv, action: &[f32]) -> Step {
    let (rows, dim) = (envs.spec().rows(), envs.spec().observation.dim());
    let seen = seen(envs);
    let (mut reward, mut style) = (Array::zeroed(&CPU, rows), Array::zeroed(&CPU, rows));
    let (mut ends, mut group) = (Array::zeroed(&CPU, rows), Array::zeroed(&CPU, rows));
    let mut last = Array::Host(vec![POISON; rows * dim]);
    let out = Transition {
        step: 0,
        reward: &mut reward,
        style_reward: &mut style,
        termination: &mut ends,
        group: &mut group,
        final_observation: &mut last,
    };
    envs.step(&Array::Host(action.to_vec()), 0, out);
    Step {
        seen,
        reward: reward.host().to_vec(),
        ends: ends.host().to_vec(),
        group: group.host().to_vec(),
        last: last.host().to_vec(),
    }
}

/// Every other opponent's actions one by one; the learner's are those of a policy of its own.
#[test]
fn the_learner_sees_its_fighter_and_the_opponents_move_the_others() {
    let (mut envs, mut inner) = (self_play(), fighters());
    let (dim, width) = (inner.spec().observation.dim(), inner.spec().action);
    assert_eq!((envs.spec().agents, envs.spec().rows()), (1, ENVS));
    let pool = pool(&*inner);
    envs.set_opponents(&Arc::new(pool.opponents())).unwrap();
    let learner = policy(&*inner, 7, SURE);
    let (mut results, mut ended) = (Vec::new(), 0);
    for _ in 0..20 {
        let bouts = bouts(&envs);
        let rows: Vec<[usize; 2]> = (bouts.iter().enumerate())
            .map(|(env, bout)| [0, 1].map(|other| 2 * env + (bout[0] as usize ^ other)))
            .collect();
        let all = seen(&mut *inner);
        let mut action = vec![0.0; 2 * ENVS * width];
        for (&[own, other], bout) in rows.iter().zip(&bouts) {
            let row = |row: usize| &all[row * dim..][..dim];
            let members = pool.members().iter();
            let opponent = members.clone().find(|member| member.id == bout[1]);
            let theirs = act(&opponent.unwrap().opponent, row(other));
            action[own * width..][..width].copy_from_slice(&learner.mean(row(own)));
            action[other * width..][..width].copy_from_slice(&theirs);
        }
        let own: Vec<f32> = rows
            .iter()
            .flat_map(|&[own, _]| &all[own * dim..][..dim])
            .copied()
            .collect();
        let got = step(&mut envs, &learner.mean(&own));
        let wanted = step(&mut *inner, &action);
        same("observation", &got.seen, &own);
        for (env, &[own, _]) in rows.iter().enumerate() {
            assert_eq!(got.reward[env], wanted.reward[own], "reward of {env}");
            assert_eq!(got.ends[env], wanted.ends[own]);
            assert_eq!(got.group[env], wanted.group[own]);
            same(
                "final",
                &got.last[env * dim..][..dim],
                &wanted.last[own * dim..][..dim],
            );
            ended += usize::from(got.ends[env] != termination::RUNNING);
        }
        results.extend(envs.take_results().unwrap());
    }
    let games = results.iter().map(|result| result.games);
    assert!(
        ended > ENVS && games.sum::<u32>() == ended as u32,
        "{ended}"
    );
    // Statistics are the learner's.
    let mut sums = Array::zeroed(&CPU, envs.stat_names().len());
    envs.stats(&mut sums);
    let [episodes, successes] = [sums.host()[0], sums.host()[1]];
    assert_eq!(episodes, ended as f32);
    // A draw is half a win, and a lost bout is the opponent's success.
    let wins: f64 = results.iter().map(|result| result.wins).sum();
    let draws = 2.0 * (wins - f64::from(successes));
    assert!((0.0..=f64::from(episodes - successes)).contains(&draws));
    envs.stats(&mut sums);
    assert!(sums.host().iter().all(|&sum| sum == 0.0));
}

#[test]
fn sides_and_opponents_are_drawn_for_every_bout() {
    let mut envs = self_play();
    let pool = pool(&envs);
    envs.set_opponents(&Arc::new(pool.opponents())).unwrap();
    let rest = envs.rest_action().repeat(ENVS);
    let (mut sides, mut met) = ([0; 2], [0; 3]);
    for _ in 0..400 {
        let before = bouts(&envs);
        let ends = step(&mut envs, &rest).ends;
        for ((before, after), end) in before.iter().zip(bouts(&envs)).zip(ends) {
            if end == termination::RUNNING {
                assert_eq!(*before, after);
            } else {
                sides[after[0] as usize] += 1;
                met[after[1] as usize] += 1;
            }
        }
    }
    let count = (sides[0] + sides[1]) as f64;
    let within = |part: i32, wanted: f64| {
        let deviation = (wanted * (1.0 - wanted) / count).sqrt();
        assert!(
            (f64::from(part) / count - wanted).abs() < 3.0 * deviation,
            "{part} of {count}"
        );
    };
    sides.into_iter().for_each(|side| within(side, 0.5));
    // The first is scripted.
    for (opponent, wanted) in met.into_iter().zip([0.5, 0.25, 0.25]) {
        within(opponent, wanted);
    }
}

#[test]
fn self_play_goes_on_from_a_saved_state() {
    let mut original = self_play();
    let opponents = Arc::new(pool(&original).opponents());
    original.set_opponents(&opponents).unwrap();
    let rest = original.rest_action().repeat(ENVS);
    for _ in 0..7 {
        step(&mut original, &rest);
    }
    let mut section = Section::default();
    original.save(&mut section).unwrap();
    let mut restored = self_play();
    restored.load(&mut section.clone()).unwrap();
    restored.set_opponents(&opponents).unwrap();
    for _ in 0..12 {
        assert!(step(&mut original, &rest) == step(&mut restored, &rest));
    }
    section.put_array("bouts", &[[2u32, 0]; ENVS]);
    section.take_array::<[u32; 2]>("bouts", ENVS).unwrap();
    assert!(self_play().load(&mut section).is_err());
}

/// Sides and opponents are the same, and what these draw; what is played is what the physics' rounding leaves of it.
#[test]
fn self_play_on_a_gpu_is_that_on_the_cpu() {
    let (cpu, gpu) = (CPU, Device::from(gpu()));
    let opponents = Arc::new(pool_with(&*fighters(), -3.0).opponents());
    let [one, other] = [&cpu, &gpu].map(|device| {
        let mut envs = SelfPlayEnv::new(fighters_on(device), device, FIRST, SEED).unwrap();
        envs.set_opponents(&opponents).unwrap();
        let played = play(device, &mut envs, 12, 1);
        let mut sums = Array::zeroed(device, envs.stat_names().len());
        envs.stats(&mut sums);
        (
            played,
            envs.take_results().unwrap(),
            bouts(&envs),
            sums.read(device).unwrap(),
        )
    });
    let games: u32 = one.1.iter().map(|result| result.games).sum();
    assert!(games > ENVS as u32 && one.1 == other.1, "{games}");
    assert_eq!((one.2, one.3[0]), (other.2, other.3[0]));
    let (one, other) = (one.0, other.0);
    assert_eq!((&one.ends, &one.groups), (&other.ends, &other.groups));
    let near = |what: &str, a: &[f32], b: &[f32]| {
        for (at, (a, b)) in a.iter().zip(b).enumerate() {
            // Speeds of joints are of the order of ten.
            let bar = 3e-2 * (1.0 + a.abs());
            assert!((a - b).abs() < bar, "{what} {at}: {a} {b}");
        }
    };
    near("observation", &one.observations, &other.observations);
    near("final observation", &one.finals, &other.finals);
    near("reward", &one.rewards, &other.rewards);
}

#[test]
fn environments_of_one_agent_are_refused() {
    let alone = open(&CPU, imitate(1.0), 0..2, SEED).unwrap();
    let error = SelfPlayEnv::new(alone, &CPU, 0, SEED).err().unwrap();
    assert!(error.to_string().contains("two agents"), "{error}");
}

/// What opponents draw depends on the environment's number, not on who else is asked.
#[test]
fn opponents_act_together_as_in_parts() {
    let opponents = Arc::new(pool_with(&*fighters(), -1.5).opponents());
    let middle = FIRST + 7;
    let parts = [FIRST..FIRST + ENVS, FIRST..middle, middle..FIRST + ENVS];
    let [all, first, second] = parts.map(|part| {
        let (count, first) = (part.len(), part.start);
        let mut envs = SelfPlayEnv::new(some_fighters(&CPU, part), &CPU, first, SEED).unwrap();
        envs.set_opponents(&opponents).unwrap();
        let rest = envs.rest_action().repeat(count);
        (0..20)
            .map(|_| step(&mut envs, &rest).seen)
            .collect::<Vec<_>>()
    });
    for (step, all) in all.iter().enumerate() {
        same(
            "observation",
            all,
            &[&first[step][..], &second[step]].concat(),
        );
    }
}

#[test]
fn opponents_of_another_form_are_refused() {
    let mut pool = pool_of(1, &SelfPlay::default());
    pool.admit(small(2));
    let error = self_play().set_opponents(&Arc::new(pool.opponents()));
    assert!(error.unwrap_err().to_string().contains("one form"));
}

/// A bout.
fn result(opponent: u32, wins: f64) -> BoutResults {
    BoutResults {
        opponent,
        games: 1,
        wins,
    }
}

#[test]
fn a_copy_joins_when_enough_bouts_are_won() {
    let chosen = SelfPlay {
        games: 10,
        updates: 0,
        decay: 1.0,
        ..SelfPlay::default()
    };
    let mut pool = pool_of(2, &chosen);
    assert_eq!((pool.win_rate(), pool.is_due()), (None, false));
    // Draws are half a win: 8 of 10 are not more than four fifths.
    pool.end_update(
        16,
        &[
            [result(0, 1.0); 7].to_vec(),
            vec![result(1, 0.5); 2],
            vec![result(1, 0.0)],
        ]
        .concat(),
    );
    assert!((pool.win_rate().unwrap() - 0.8).abs() < 1e-9 && !pool.is_due());
    pool.end_update(16, &[result(1, 1.0)]);
    assert!(pool.is_due());
    pool.admit(tiny());
    // Bouts are counted anew, and those against strangers are not.
    assert!(!pool.is_due());
    pool.end_update(16, &[result(7, 1.0); 20]);
    assert!(!pool.is_due());
    pool.end_update(16, &[result(2, 1.0); 10]);
    assert!(pool.is_due());
}

#[test]
fn a_copy_joins_after_so_many_updates() {
    let chosen = SelfPlay {
        updates: 3,
        ..SelfPlay::default()
    };
    let mut pool = pool_of(1, &chosen);
    for update in 1..=3 {
        assert!(!pool.is_due());
        pool.end_update(16, &[]);
        assert_eq!(pool.is_due(), update == 3);
    }
    pool.admit(tiny());
    assert!(!pool.is_due());
}

#[test]
fn the_oldest_policy_leaves() {
    let chosen = SelfPlay {
        pool: 2,
        ..SelfPlay::default()
    };
    let mut pool = pool_of(2, &chosen);
    pool.admit(tiny());
    let ids = |pool: &Pool| {
        pool.members()
            .iter()
            .map(|member| member.id)
            .collect::<Vec<_>>()
    };
    assert_eq!(ids(&pool), [0, 1, 2]);
    pool.admit(tiny());
    assert_eq!(ids(&pool), [0, 2, 3]);
    assert_eq!(pool.joined(), 4);
    // Who has left is stood in for by the newest.
    let table = pool.opponents().table(1, 1);
    assert_eq!([0, 1, 2].map(|id| table.index(id)), [0, 2, 1]);
}

#[test]
fn earlier_bouts_count_less() {
    let chosen = SelfPlay {
        decay: 0.5,
        ..SelfPlay::default()
    };
    let mut pool = pool_of(1, &chosen);
    pool.end_update(2, &[result(0, 1.0); 8]);
    pool.end_update(2, &[result(0, 0.0); 2]);
    let member = &pool.members()[0];
    assert_eq!((member.games, member.wins), (4.0, 2.0));
}

#[test]
fn opponents_are_drawn_by_how_often_they_are_not_beaten() {
    let mut pool = pool_of(4, &SelfPlay::default());
    let (won, lost) = (|id| result(id, 1.0), |id| result(id, 0.0));
    // Beaten always, in three of four, never; the last is not met.
    pool.end_update(0, &[won(0), won(1), won(1), won(1), lost(1), lost(2)]);
    let drawn = |pool: &Pool| {
        let table = pool.opponents().table(1, 1);
        let mut counts = [0.0f64; 4];
        for number in 0..10_000 {
            let [bits, ..] = random4(8, number, 0, 1);
            counts[table.drawn(bits)] += 1e-4;
        }
        counts
    };
    // Three are scripted, and met in half of the bouts.
    let [a, b, c] = [0.05, 0.25, 1.0].map(|weight| 0.5 * weight / 1.3);
    let wanted = [a, b, c, 0.5];
    for (found, wanted) in drawn(&pool).into_iter().zip(wanted) {
        // Three standard deviations of ten thousand.
        assert!((found - wanted).abs() < 0.015, "{found}, not {wanted}");
    }
    let mut beaten = pool_of(4, &SelfPlay::default());
    beaten.end_update(0, &[won(0), won(1), won(2), won(3)]);
    for (found, wanted) in drawn(&beaten).into_iter().zip([1.0, 1.0, 1.0, 3.0]) {
        assert!((found - wanted / 6.0).abs() < 0.015, "{found}");
    }
}

#[test]
fn a_pool_is_what_it_was_when_saved() {
    let envs = fighters();
    let mut original = pool(&*envs);
    original.end_update(3, &[result(1, 1.0), result(2, 0.5)]);
    let mut section = Section::default();
    original.save(&mut section).unwrap();
    let begun =
        |chosen: &SelfPlay| Pool::new(chosen, vec![resting(&*envs)], policy(&*envs, 3, 0.0));
    let mut restored = begun(&SelfPlay::default());
    restored.load(&mut section.clone()).unwrap();
    let mut again = Section::default();
    restored.save(&mut again).unwrap();
    assert!(section == again);
    // Of others, or of nothing, it is refused.
    let mut other = Pool::new(&SelfPlay::default(), vec![resting(&*envs)], tiny());
    assert!(other.load(&mut section.clone()).is_err());
    assert!(restored.load(&mut Section::default()).is_err());
    let mut small = begun(&SelfPlay {
        pool: 1,
        ..SelfPlay::default()
    });
    assert!(small.load(&mut section.clone()).is_err());
    // So is one with other scripts.
    let mut other = pool_of(3, &SelfPlay::default());
    assert!(other.load(&mut section).is_err());
}
