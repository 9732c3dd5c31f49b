//! The task `box`: its devices and saved states are tested with those of the other tasks.
//! Oracle: plain computations; the same bout with the fighters exchanged. Bar: rounding.

use super::style::{LIBRARY, Played, play, rules};
use crate::support::inputs::{Draw, gpu};
use footwork::container::Section;
use footwork::env::body_view::{BodyStates, BodyWorlds};
use footwork::env::humanoid::boxing::corners::Corners;
use footwork::env::humanoid::boxing::evaluate::evaluate;
use footwork::env::humanoid::boxing::{Boxing, BoxingTask, boxing_spec};
use footwork::env::humanoid::driver::{BodyDriver, DriverState, RepeatAction};
use footwork::env::humanoid::task::play::DrivenStep;
use footwork::env::humanoid::task::{CpuHumanoidEnv, HumanoidTask, open};
use footwork::env::live_view::LiveView;
use footwork::env::{Stats, VecEnv, termination};
use footwork::gpu::{Array, Device};
use footwork::kernels::humanoid::boxing_state::{DAMAGE, KNOCKDOWNS};
use footwork::physics::kinematics::{kinematics, velocities};
use footwork::physics::model::Model;
use footwork::physics::pose::Pose;
use footwork::physics::scenes;
use footwork::physics::spatial::Spatial;
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// Numbers of a fighter: positions, velocities, body observation, added observation.
const NQ: usize = 43;
const NV: usize = 34;
const BODY: usize = 105;
const ADDED: usize = 65;

fn task(boxing: &Boxing) -> Arc<BoxingTask> {
    Arc::new(BoxingTask::new(boxing, &LIBRARY, 3))
}

fn opened(boxing: &Boxing, envs: usize) -> CpuHumanoidEnv {
    CpuHumanoidEnv::unstaggered(task(boxing), 0..envs, 4)
}

/// Plays steps of all environments.
fn steps(envs: &mut CpuHumanoidEnv, count: usize) -> Played {
    play(&Device::Cpu, envs, count, 1)
}

fn observed(envs: &mut CpuHumanoidEnv) -> Vec<f32> {
    let spec = *envs.spec();
    let mut seen = Array::zeroed(&Device::Cpu, spec.rows() * spec.observation.dim());
    envs.observe(&mut seen, 0);
    seen.host().to_vec()
}

fn sums(envs: &mut dyn VecEnv) -> Stats {
    let names = envs.stat_names();
    let mut sums = Array::zeroed(&Device::Cpu, names.len());
    envs.stats(&mut sums);
    Stats::new(names, sums.host())
}

/// Moves a fighter over the ground.
fn put(q: &mut [f32], fighter: usize, at: [f32; 2]) {
    q[fighter * NQ..][..2].copy_from_slice(&at);
}

/// Poses and velocities of all bodies.
fn bodies(model: &Model, q: &[f32], v: &[f32]) -> (Vec<Pose>, Vec<Spatial>) {
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let mut axes = vec![Spatial::ZERO; model.nv()];
    let mut speeds = vec![Spatial::ZERO; model.bodies.len()];
    kinematics(model, q, &mut poses, &mut axes);
    velocities(model, v, &axes, &mut speeds);
    (poses, speeds)
}

#[test]
fn every_fighter_begins_in_a_recorded_moment_on_its_side() {
    let mut envs = opened(&Boxing::default(), 64);
    let spec = *envs.spec();
    assert_eq!((spec.rows(), spec.agents, spec.action), (128, 2, 28));
    assert_eq!((spec.style, spec.observation.dim()), (BODY, BODY + ADDED));
    assert_eq!(spec, boxing_spec(64));
    assert_eq!(spec.bootstrap, 1 << termination::TRUNCATED);
    let task = task(&Boxing::default());
    let recorded: Vec<&[f32]> = task.start_states().chunks_exact(NQ + NV).collect();
    let mut same = 0;
    for world in &envs.batch.worlds {
        let (q, v) = (&world.state.q, &world.state.v);
        let spots = [0, 1].map(|fighter| Vec2::from_slice(&q[fighter * NQ..]));
        assert!(
            spots
                .iter()
                .all(|spot| (0.99..3.0).contains(&spot.length()))
        );
        assert!(spots[0].dot(spots[1]) < 0.0);
        // Heights, joints and their speeds are those of one recorded moment.
        let moment = |fighter: usize| {
            let (q, v) = (&q[fighter * NQ..][..NQ], &v[fighter * NV..][..NV]);
            let own = recorded.iter().position(|start| {
                start[2] == q[2] && start[7..NQ] == q[7..] && start[NQ + 3..] == v[3..]
            });
            own.expect("a recorded moment")
        };
        same += usize::from(moment(0) == moment(1));
    }
    assert!(same < 8, "{same} of 64 pairs begin alike");
    let seen = observed(&mut envs);
    assert!(
        seen.iter()
            .all(|value| value.is_finite() && value.abs() < 100.0)
    );
}

/// What a bout does depends on its number, not on who else is in its part of a batch.
#[test]
fn parts_begin_as_all_do() {
    let begin = |envs| {
        observed(&mut CpuHumanoidEnv::unstaggered(
            task(&Boxing::default()),
            envs,
            4,
        ))
    };
    let parts = [begin(0..2), begin(2..6)].concat();
    assert!(parts == begin(0..6));
}

/// What a fighter sees, by formulas in the world's axes that are turned by its heading in the end.
#[test]
fn observations_are_what_they_say() {
    let mut envs = opened(&Boxing::default(), 4);
    steps(&mut envs, 3);
    let seen = observed(&mut envs);
    let model = scenes::boxing_match();
    for (row, seen) in seen.chunks_exact(BODY + ADDED).enumerate() {
        let (env, names) = (row / 2, [["red/", "blue/"], ["blue/", "red/"]][row % 2]);
        let state = &envs.batch.worlds[env].state;
        let (poses, speeds) = bodies(&model, &state.q, &state.v);
        let index = |side: usize, name: &str| {
            let name = format!("{}{name}", names[side]);
            model.body(&name).expect("a body")
        };
        let roots = [0, 1].map(|side| index(side, "pelvis"));
        let forward = poses[roots[0]].rotation * Vec3::X;
        let local = Quat::from_rotation_z(-forward.y.atan2(forward.x));
        let mut want = Vec::new();
        let centre = local * -poses[roots[0]].position / 3.0;
        want.extend([centre.x, centre.y]);
        let mut put = |v: Vec3| want.extend((local * v).to_array());
        put(poses[roots[1]].position - poses[roots[0]].position);
        put(poses[roots[1]].rotation * Vec3::X);
        put(poses[roots[1]].rotation * Vec3::Z);
        put(speeds[roots[1]].linear - speeds[roots[0]].linear);
        put(speeds[roots[1]].angular);
        let moving = |side: usize, name: &str, com: bool| {
            let body = index(side, name);
            let centre = if com {
                Vec3::Z * model.bodies[body].com.z
            } else {
                Vec3::ZERO
            };
            let position = poses[body].at(centre);
            let arm = position - poses[roots[side]].position;
            (
                position,
                speeds[body].linear + speeds[body].angular.cross(arm),
            )
        };
        for (hitter, hit) in [(0, 1), (1, 0)] {
            for hand in ["right_hand", "left_hand"] {
                for target in ["torso", "head"] {
                    let (hand, hand_speed) = moving(hitter, hand, false);
                    let (target, target_speed) = moving(hit, target, true);
                    put(target - hand);
                    put(target_speed - hand_speed);
                }
            }
        }
        assert_eq!(want.len(), ADDED);
        for (at, (got, want)) in seen[BODY..].iter().zip(&want).enumerate() {
            assert!(
                (got - want).abs() < 1e-4 * want.abs().max(1.0),
                "{at} of {row}: {got} {want}"
            );
        }
    }
}

/// A state with the fighters exchanged and the arena turned half around.
fn exchanged(q: &[f32], v: &[f32]) -> (Vec<f32>, Vec<f32>) {
    let turn = |q: &[f32], v: &[f32]| {
        let root = [-q[0], -q[1], q[2], -q[6], -q[5], q[4], q[3]];
        let speed = [-v[0], -v[1]];
        ([&root, &q[7..]].concat(), [&speed, &v[2..]].concat())
    };
    let (blue, red) = (turn(&q[..NQ], &v[..NV]), turn(&q[NQ..], &v[NV..]));
    ([red.0, blue.0].concat(), [red.1, blue.1].concat())
}

/// Red and blue have the same chances: who exchanges them exchanges what they see and get.
#[test]
fn exchanged_fighters_exchange_rewards_and_observations() {
    let boxing = Boxing {
        damage_taken: [0.5, 0.5],
        ..Boxing::default()
    };
    for apart in [0.5, 1.0, 3.0] {
        let mut envs = opened(&boxing, 2);
        let [first, second] = &mut envs.batch.worlds[..] else {
            panic!("two worlds")
        };
        put(&mut first.state.q, 0, [-0.5 * apart, 0.3]);
        put(&mut first.state.q, 1, [0.5 * apart, 0.3]);
        (second.state.q, second.state.v) = exchanged(&first.state.q, &first.state.v);
        // The speeds of the joints before the step: the state's last numbers.
        let joints = NV - 6;
        let mut carried = envs.task_states[0].clone();
        let first_joint = carried.len() - 2 * joints;
        carried[first_joint..].rotate_left(joints);
        envs.task_states[1] = carried;
        let rest = envs.rest_action().repeat(4);
        let mut step = DrivenStep::new(&envs);
        step.play_by(&mut envs, |_| rest);
        let reward = step.reward.host();
        assert!(
            (reward[0] - reward[3]).abs() < 2e-2 * reward[0].abs().max(1.0),
            "{reward:?}"
        );
        assert!(
            (reward[1] - reward[2]).abs() < 2e-2 * reward[1].abs().max(1.0),
            "{reward:?}"
        );
        assert_ne!(reward[0], reward[1]);
        let seen = observed(&mut envs);
        let rows: Vec<&[f32]> = seen.chunks_exact(BODY + ADDED).collect();
        for (a, b) in [(0, 3), (1, 2)] {
            for (at, (a, b)) in rows[a].iter().zip(rows[b]).enumerate() {
                assert!((a - b).abs() < 2e-2 * a.abs().max(1.0), "{at}: {a} {b}");
            }
        }
    }
}

/// Lays a fighter on its face, on the ground.
fn lay(q: &mut [f32], fighter: usize) {
    let rotation = Quat::from_rotation_y(FRAC_PI_2);
    let root = &mut q[fighter * NQ..];
    root[2] = 0.15;
    root[3..7].copy_from_slice(&[rotation.w, rotation.x, rotation.y, rotation.z]);
}

#[test]
fn only_hands_on_torso_and_head_do_damage() {
    let mut envs = opened(&Boxing::default(), 2);
    let model = scenes::boxing_match();
    // The first lie on the ground, far apart; of the second red's right hand is in blue's head.
    let [first, second] = &mut envs.batch.worlds[..] else {
        panic!("two worlds")
    };
    for fighter in 0..2 {
        put(
            &mut first.state.q,
            fighter,
            [2.0 - 4.0 * fighter as f32, 0.0],
        );
        lay(&mut first.state.q, fighter);
    }
    // Red's arm points ahead, somewhat up.
    second.state.q.clone_from(&model.qpos0);
    second.state.v.fill(0.0);
    let shoulder = model
        .joints
        .iter()
        .find(|joint| joint.name == "red/right_shoulder");
    let arm = Quat::from_rotation_y(-1.2 * FRAC_PI_2);
    let arm = [arm.w, arm.x, arm.y, arm.z];
    second.state.q[shoulder.unwrap().q..][..4].copy_from_slice(&arm);
    let (poses, _) = bodies(&model, &second.state.q, &second.state.v);
    let head = model.body("blue/head").unwrap();
    let head = poses[head].at(model.bodies[head].com);
    let hand = poses[model.body("red/right_hand").unwrap()].position;
    for k in 0..3 {
        // Somewhat behind its centre.
        let aside = if k == 0 { 0.1 } else { 0.0 };
        second.state.q[NQ + k] += hand[k] - head[k] + aside;
    }
    let mut forces = vec![(Vec::new(), Vec::new()); 2];
    let pairs: Vec<u32> = task(&Boxing::default())
        .force_pairs()
        .concat()
        .iter()
        .map(|&body| body as u32)
        .collect();
    assert_eq!(pairs.len(), 16);
    envs.batch.each(&mut forces, |_, simulator, world, found| {
        world.advance(simulator, &pairs);
        found.0 = world.pair_forces(model.bodies.len()).to_vec();
        found.1 = simulator.body_forces();
    });
    let (on_pairs, on_bodies) = &forces[0];
    assert!(
        on_bodies.iter().any(|force| force.length() > 50.0),
        "the ground bears them"
    );
    assert!(on_pairs.iter().all(|force| *force == Vec3::ZERO));
    let (on_pairs, _) = &forces[1];
    assert!(
        on_pairs[1].length() > 1.0,
        "the right hand on the head: {on_pairs:?}"
    );
    let named = |body: u32| model.bodies[body as usize].name.as_str();
    for (number, pair) in pairs.chunks_exact(2).enumerate() {
        let (own, other) = if number < 4 {
            ("red", "blue")
        } else {
            ("blue", "red")
        };
        let hand = ["right_hand", "left_hand"][number / 2 % 2];
        let part = ["torso", "head"][number % 2];
        assert_eq!(named(pair[0]), format!("{own}/{hand}"));
        assert_eq!(named(pair[1]), format!("{other}/{part}"));
    }
}

#[test]
fn a_fall_the_border_and_time_end_a_bout_for_both() {
    let boxing = Boxing {
        rules: rules(5.0 / 30.0),
        stagger_s: 0.0,
        ..Boxing::default()
    };
    let mut envs = opened(&boxing, 4);
    lay(&mut envs.batch.worlds[0].state.q, 1);
    put(&mut envs.batch.worlds[1].state.q, 0, [3.5, 0.0]);
    put(&mut envs.batch.worlds[1].state.q, 1, [-1.0, 0.0]);
    envs.batch.worlds[2].state.v[NV + 3] = f32::NAN;
    for world in [2, 3] {
        put(&mut envs.batch.worlds[world].state.q, 0, [-1.5, 0.0]);
        put(&mut envs.batch.worlds[world].state.q, 1, [1.5, 0.0]);
    }
    let played = steps(&mut envs, 1);
    use termination::{FAILED, RUNNING, SUCCESS, TRUNCATED};
    let expected = [
        SUCCESS, FAILED, FAILED, TRUNCATED, FAILED, FAILED, RUNNING, RUNNING,
    ];
    assert_eq!(played.ends, expected);
    assert_eq!(played.rewards[0], boxing.knockdown_bonus);
    assert_eq!(
        played.rewards[4..6],
        [0.0, 0.0],
        "a diverged bout is worth nothing"
    );
    let found = sums(&mut envs);
    let sum = |name: &str| found.sum(name);
    assert_eq!(
        (sum("episodes"), sum("successes"), sum("fall")),
        (6.0, 2.0, 4.0)
    );
    assert_eq!(
        (sum("knockdowns"), sum("out"), sum("steps")),
        (1.0, 1.0, 6.0)
    );
    assert!(found.iter().all(|(_, sum)| sum.is_finite()));
    // All that ended began anew.
    for (env, world) in envs.batch.worlds.iter().enumerate().take(3) {
        assert_eq!(world.state.q, world.start[..2 * NQ]);
        assert_eq!(envs.episodes[2 * env][0], 0.0);
        let carried = &envs.task_states[env];
        assert_eq!(carried[DAMAGE..KNOCKDOWNS + 2], [0.0; 4]);
        assert!(carried.iter().all(|value| value.is_finite()));
    }
    // Time.
    let played = steps(&mut envs, 4);
    assert_eq!(played.ends[3 * 8 + 6..], [termination::TRUNCATED; 2]);
    assert!(observed(&mut envs).iter().all(|value| value.is_finite()));
}

#[test]
fn a_bout_that_diverges_reaches_nothing() {
    for device in [Device::Cpu, Device::from(gpu())] {
        let mut envs = open(&device, task(&Boxing::default()), 0..3, 4).unwrap();
        let mut section = Section::default();
        envs.save(&mut section).unwrap();
        let mut state: Vec<f32> = section.take_array("state", 2 * (NQ + NV) * 3).unwrap();
        // A spin of blue that no joint has.
        state[(2 * NQ + NV + 8) * 3 + 1] = 1e30;
        section.put_array("state", &state);
        envs.load(&mut section).unwrap();
        let played = play(&device, envs.as_mut(), 2, 1);
        assert_eq!(played.ends[2..4], [termination::FAILED; 2]);
        assert_eq!(played.rewards[2..4], [0.0; 2]);
        let (first, then) = played.observations.split_at(6 * (BODY + ADDED));
        assert_eq!(first.len(), then.len());
        assert!(then.iter().all(|value| value.abs() < 100.0));
        assert!(played.rewards.iter().all(|reward| reward.is_finite()));
        let mut sums = Array::zeroed(&device, envs.stat_names().len());
        envs.stats(&mut sums);
        let found = Stats::new(envs.stat_names(), &sums.read(&device).unwrap());
        assert_eq!((found.sum("episodes"), found.sum("successes")), (2.0, 0.0));
        assert!(found.iter().all(|(_, sum)| sum.is_finite()));
    }
}

#[test]
fn more_damage_wins_when_time_is_up() {
    let boxing = Boxing {
        rules: rules(2.0 / 30.0),
        ..Boxing::default()
    };
    let mut envs = opened(&boxing, 3);
    envs.task_states[0][DAMAGE + 1] = 5.0;
    envs.task_states[1][DAMAGE] = 5.0;
    for world in &mut envs.batch.worlds {
        put(&mut world.state.q, 0, [-1.5, 0.0]);
        put(&mut world.state.q, 1, [1.5, 0.0]);
    }
    let ends = steps(&mut envs, 2).ends;
    assert_eq!(ends[6..], [termination::TRUNCATED; 6]);
    let found = sums(&mut envs);
    assert_eq!((found.sum("episodes"), found.sum("successes")), (6.0, 2.0));
    let running: Vec<f32> = envs.episodes.iter().map(|episode| episode[1]).collect();
    assert_eq!(running, [2.0; 6], "the next bouts have their full length");
}

#[test]
fn both_fighters_can_be_seen() {
    let mut envs = opened(&Boxing::default(), 3);
    let Some(LiveView::Bodies(view)) = envs.live_view().unwrap() else {
        panic!("bodies")
    };
    let BodyWorlds::Cpu(parts) = &view.worlds else {
        panic!("on the host")
    };
    steps(&mut envs, 1);
    let states = BodyStates::joined(parts);
    assert_eq!(states.q.len(), 3 * 2 * NQ);
    assert_eq!(states.q[..2 * NQ], envs.batch.worlds[0].state.q);
    assert_eq!(view.model.trees.len(), 2);
}

/// A driver that pushes its arms about, and counts.
struct Flailing(Vec<f32>);

impl BodyDriver for Flailing {
    fn act(&self, observation: &[f32], state: &mut DriverState) -> Vec<f32> {
        state.steps += 1;
        let mut draw = Draw::new(state.steps as u32);
        let rows = observation.len() / (BODY + ADDED);
        let rest = std::iter::repeat_n(&self.0, rows).flatten();
        rest.map(|action| action + 0.3 * draw.normal()).collect()
    }
}

/// Who holds the pose at rest.
fn standing(task: &BoxingTask) -> RepeatAction {
    RepeatAction::new(task.rest_action(), BODY + ADDED)
}

#[test]
fn every_corner_has_its_own_driver() {
    let task = task(&Boxing::default());
    let (standing, flailing) = (standing(&task), Flailing(vec![1.0; 28]));
    let mut corners = Corners::new([&standing, &flailing], BODY + ADDED);
    let action = corners.act(&vec![0.0; 6 * (BODY + ADDED)]);
    assert_eq!(action.len(), 6 * 28);
    let rest = task.rest_action();
    for (row, action) in action.chunks_exact(28).enumerate() {
        assert_eq!(action == rest, row % 2 == 0, "{row}");
    }
    assert_eq!(corners.states[1].steps, 1);
}

#[test]
fn an_evaluation_tells_who_won() {
    let boxing = Boxing {
        rules: rules(6.0),
        stagger_s: 0.0,
        ..Boxing::default()
    };
    let task = task(&boxing);
    let standing = standing(&task);
    let flailing = Flailing(task.rest_action());
    let report = evaluate(task.clone(), [&standing, &flailing], 12, 5);
    assert_eq!(report.bouts, 12);
    assert!(report.lost >= 0.0 && report.drawn >= -1e-9, "{report:?}");
    // Who flails falls first.
    assert!(report.won > 0.5, "{report:?}");
    assert!(report.knockdowns[0] > 0.5, "{report:?}");
    assert!((0.1..5.0).contains(&report.mean_bout_s), "{report:?}");
    assert!((0.0..=1.0).contains(&report.engagement), "{report:?}");
    assert!((0.0..=1.0).contains(&report.from_behind), "{report:?}");
    assert_eq!(
        report,
        evaluate(task.clone(), [&standing, &flailing], 12, 5)
    );
    let exchanged = evaluate(task, [&flailing, &standing], 12, 5);
    assert!(exchanged.lost > 0.5, "{exchanged:?}");
}

#[test]
fn winning_pays_more_than_clinching() {
    let boxing = Boxing::default();
    assert!(
        boxing.bonus_ratio(0.99) > 1.0,
        "{}",
        boxing.bonus_ratio(0.99)
    );
    let printed = Boxing::printed().bonus_ratio(0.99);
    assert!((printed - 500.0 / 1400.0).abs() < 1e-3, "{printed}");
    assert_eq!(boxing.rules.steps(), 1500);
}

#[test]
fn the_shortest_stagger_is_a_step() {
    let steps = |stagger_s| {
        let boxing = Boxing {
            stagger_s,
            ..Boxing::default()
        };
        boxing.stagger_steps()
    };
    assert_eq!([0.0, 0.01, 0.1, 1.0].map(steps), [0, 1, 3, 30]);
}

#[test]
fn damage_taken_and_dense_rewards_are_annealed() {
    let boxing = Boxing {
        damage_taken: [0.0, 2.0],
        dense: [1.0, 0.5],
        anneal_steps: 100,
        ..Boxing::default()
    };
    let at = |step| (boxing.damage_taken_at(step), boxing.dense_at(step));
    assert_eq!(
        [0, 50, 100, 5000].map(at),
        [(0.0, 1.0), (1.0, 0.75), (2.0, 0.5), (2.0, 0.5)]
    );
    let at_once = Boxing {
        anneal_steps: 0,
        ..boxing
    };
    assert_eq!(at_once.dense_at(0), 0.5);
    // The environments' own steps count, those before a stop as well.
    let short = Boxing {
        dense: [1.0, 0.0],
        anneal_steps: 4,
        ..Boxing::default()
    };
    let mut envs = open(&Device::Cpu, task(&short), 0..8, 4).unwrap();
    let played = play(&Device::Cpu, envs.as_mut(), 4, 1);
    let last = &played.rewards[3 * 16..];
    assert!(played.rewards[..16].iter().all(|reward| *reward != 0.0));
    let mut section = Section::default();
    envs.save(&mut section).unwrap();
    let mut resumed = open(&Device::Cpu, task(&short), 0..8, 4).unwrap();
    resumed.load(&mut section).unwrap();
    let after = play(&Device::Cpu, resumed.as_mut(), 1, 2);
    let quiet = |rewards: &[f32]| rewards.iter().filter(|reward| **reward == 0.0).count();
    assert!(
        quiet(&after.rewards) > 8 && quiet(last) < 8,
        "{:?}",
        after.rewards
    );
}

#[test]
fn wrong_choices_are_refused_by_name() {
    let refused = |boxing: Boxing, why: &str| {
        let error = boxing.check().unwrap_err();
        assert!(error.contains(why), "{error}");
    };
    Boxing::default().check().unwrap();
    Boxing::printed().check().unwrap();
    let choices = Boxing::default();
    refused(
        Boxing {
            arena: 2.0,
            ..choices
        },
        "too small to start in",
    );
    refused(
        Boxing {
            arena: f32::NAN,
            ..choices
        },
        "arena",
    );
    refused(
        Boxing {
            start_distance: [0.1, 1.0],
            ..choices
        },
        "start_distance",
    );
    refused(
        Boxing {
            start_distance: [2.0, 1.0],
            ..choices
        },
        "start_distance",
    );
    refused(
        Boxing {
            knockdown_bonus: -1.0,
            ..choices
        },
        "knockdown_bonus",
    );
    refused(
        Boxing {
            dense: [1.0, f32::INFINITY],
            ..choices
        },
        "dense",
    );
}
