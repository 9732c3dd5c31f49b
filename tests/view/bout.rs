//! Bouts: the ring, flashes and bars of their pictures, and who fights himself.

use crate::Picture;
use crate::body::{keep, open, press, task, untrained};
use eframe::egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use footwork::env::humanoid::boxing::bout::{Bout, REMEMBERED, Strike, Tally, tally};
use footwork::env::humanoid::boxing::command::{FightCommand, ImaginedWorld};
use footwork::env::humanoid::task::CpuHumanoidEnv;
use footwork::env::humanoid::task::play::DrivenStep;
use footwork::kernels::termination::{FAILED, SUCCESS};
use footwork::physics::scenes;
use footwork::train::body_episodes::BodyEpisodes;
use footwork::train::body_policy::BodyPolicy;
use footwork::view::body_playthrough::{BodyContext, BodyPlaythrough};
use footwork::view::own_fighter::OwnFighter;
use footwork::view::recorded_bout::RecordedBout;
use footwork::view::shapes::{self, seen, simulated};
use footwork::view::{Camera, Scene, bout_bars, bout_scene};
use footwork::viewer::BodyViewer;
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::PI;
use std::sync::{Arc, Mutex};

/// Numbers of what a fighter observes of itself, and of both together.
const BODY: usize = 105;
const SEEN: usize = 170;

fn episodes() -> BodyEpisodes {
    task("box").1.body().unwrap()
}

/// Positions and velocities of a bout's start.
fn start(env: &CpuHumanoidEnv) -> (Vec<f32>, Vec<f32>) {
    let state = &env.batch.worlds[0].state;
    (state.q.clone(), state.v.clone())
}

fn strike(force: f32, age: u32) -> Strike {
    Strike {
        at: Vec3::Z,
        force,
        age,
    }
}

#[test]
fn the_ring_is_drawn_where_the_arena_ends() {
    let above = Camera {
        focus: Vec3::ZERO,
        yaw: 0.0,
        pitch: 1.5,
        distance: 16.0,
        ..Camera::default()
    };
    let mut scene = Scene::default();
    let bare = Picture::draw(&scene, None, &above, [300, 300]);
    bout_scene::ring(&mut scene, 3.0);
    let ringed = Picture::draw(&scene, None, &above, [300, 300]);
    let is_ringed = |x: f32, y: f32| {
        let at = above.clip(1.0).project_point3(seen(Vec3::new(x, y, 0.0)));
        let [column, row] = [at.x, -at.y].map(|at| (150.0 * (1.0 + at)) as u32);
        let mut around = (0..9).map(|k| (column - 1 + k % 3, row - 1 + k / 3));
        around.any(|(x, y)| bare.pixel(x, y) != ringed.pixel(x, y))
    };
    for along in [-2.9, -1.0, 0.5, 2.9] {
        for side in [-3.0, 3.0] {
            assert!(is_ringed(along, side) && is_ringed(side, along));
        }
        assert!(!is_ringed(along, 2.5) && !is_ringed(3.5, along));
    }
}

#[test]
fn a_flash_grows_with_the_force_and_fades() {
    let size = |strikes: &[Strike]| {
        let mut scene = Scene::default();
        bout_scene::flashes(&mut scene, strikes);
        let picture = Picture::draw(&scene, None, &Camera::default(), [200, 160]);
        let glows = |[red, _, blue]: [u8; 3]| red > 240 && blue < 220;
        let pixels = picture.rgb.chunks_exact(3);
        pixels.filter(|rgb| glows([rgb[0], rgb[1], rgb[2]])).count()
    };
    let [none, weak, strong] = [
        size(&[]),
        size(&[strike(60.0, 0)]),
        size(&[strike(600.0, 0)]),
    ];
    assert!(
        none == 0 && weak > 3 && strong > 3 * weak,
        "{none} {weak} {strong}"
    );
    let later = size(&[strike(600.0, REMEMBERED / 2)]);
    assert!(weak < later && later < strong, "{weak} {later} {strong}");
}

#[test]
fn bars_tell_the_damage_and_squares_the_knock_downs() {
    let size = [320, 180];
    let pixels = |damage: [f32; 2], knockdowns: [u32; 2]| {
        let mut rgb = vec![255; 3 * 320 * 180];
        let bout = Bout {
            damage,
            knockdowns,
            ..Bout::default()
        };
        bout_bars::draw(&mut rgb, size, &bout);
        bout_bars::CORNERS.map(|colour| rgb.chunks_exact(3).filter(|rgb| *rgb == colour).count())
    };
    assert_eq!(pixels([0.0, 0.0], [0, 0]), [0, 0]);
    let [red, blue] = pixels([50.0, 25.0], [0, 0]);
    assert!(red == 2 * blue && blue > 50, "{red} {blue}");
    // Full, it shows the part of the other.
    let [red, blue] = pixels([400.0, 200.0], [0, 0]);
    assert!(red == 2 * blue && blue > 300, "{red} {blue}");
    assert!(pixels([0.0, 0.0], [1, 2])[1] == 2 * pixels([0.0, 0.0], [1, 0])[0]);
}

/// Puts red's right hand, at the end of its arm, into blue's head.
fn strike_blue(env: &mut CpuHumanoidEnv) {
    let model = env.task().model().clone();
    let world = &mut env.batch.worlds[0].state;
    world.q.copy_from_slice(&model.qpos0);
    world.v.fill(0.0);
    let mut joints = model.joints.iter();
    let shoulder = joints.find(|joint| joint.name == "red/right_shoulder");
    let arm = Quat::from_rotation_y(-0.6 * PI);
    world.q[shoulder.unwrap().q..][..4].copy_from_slice(&[arm.w, arm.x, arm.y, arm.z]);
    let poses = shapes::poses(&model, &world.q);
    let [hand, head] = ["red/right_hand", "blue/head"].map(|name| model.body(name).unwrap());
    let gap = poses[hand].position - poses[head].at(model.bodies[head].com);
    let blue = &mut world.q[model.nq() / 2..];
    // Not into its middle.
    for (q, way) in blue.iter_mut().zip((gap + 0.1 * Vec3::X).to_array()) {
        *q += way;
    }
}

#[test]
fn a_hand_on_the_other_is_a_strike_that_is_remembered_for_a_while() {
    let episodes = episodes();
    let mut env = episodes.open(0);
    let mut recorded = RecordedBout::new(episodes.bouts.clone().unwrap());
    let action = env.task().rest_action();
    let mut step = DrivenStep::new(&env);
    let mut play = |env: &mut CpuHumanoidEnv, recorded: &mut RecordedBout| {
        step.play_by(env, |_| action.repeat(2));
        recorded.push(env, true);
    };
    play(&mut env, &mut recorded);
    assert_eq!(recorded.at(1), &Bout::default());
    let (q, v) = start(&env);
    strike_blue(&mut env);
    play(&mut env, &mut recorded);
    let hit = recorded.at(2).clone();
    assert!(!hit.strikes.is_empty() && hit.damage[0] > 0.5, "{hit:?}");
    let model = env.task().model();
    let hand = model.body("red/right_hand").unwrap();
    let hand = shapes::poses(model, &env.batch.worlds[0].state.q)[hand].position;
    for strike in &hit.strikes {
        let far = strike.at.distance(hand);
        assert!(strike.age == 0 && far < 0.05, "{hit:?}");
    }
    let hardest = hit
        .strikes
        .iter()
        .map(|strike| strike.force)
        .fold(0.0, f32::max);
    assert!(
        hardest / 30.0 <= hit.damage[0] + hit.damage[1] + 1e-3,
        "{hit:?}"
    );
    // They part.
    for past in 1..=REMEMBERED {
        env.batch.worlds[0].state.q.copy_from_slice(&q);
        env.batch.worlds[0].state.v.copy_from_slice(&v);
        play(&mut env, &mut recorded);
        let now = recorded.at(2 + past as usize);
        let left = now.strikes.iter().filter(|strike| strike.age == past);
        let all = if past < REMEMBERED {
            hit.strikes.len()
        } else {
            0
        };
        assert_eq!(left.count(), all, "{now:?}");
        assert_eq!(now.damage, hit.damage);
    }
    // The ring, and flashes in it.
    let (mut bare, mut drawn) = (Scene::default(), Scene::default());
    bout_scene::ring(&mut bare, 3.0);
    recorded.draw(&mut drawn, 2);
    assert_eq!(bare.cuboids, drawn.cuboids);
    assert!(!drawn.capsules.is_empty());
}

#[test]
fn who_is_ahead_leads_and_bouts_won_are_counted() {
    let bout = |damage, knockdowns| Bout {
        damage,
        knockdowns,
        ..Bout::default()
    };
    for (damage, knockdowns, leader) in [
        ([0.0, 0.0], [0, 0], None),
        ([3.0, 0.0], [0, 0], Some(0)),
        ([3.0, 5.0], [0, 0], Some(1)),
        ([3.0, 5.0], [2, 1], Some(0)),
        ([5.0, 5.0], [1, 1], None),
    ] {
        assert_eq!(bout(damage, knockdowns).leader(), leader);
    }
    let mut now = bout([3.0, 5.0], [1, 0]);
    for (won, knockdowns, sum) in [
        ([1, 0], [1, 0], ([1, 0], [1, 0])),
        ([0, 0], [0, 0], ([1, 0], [1, 0])),
        ([0, 1], [0, 2], ([1, 1], [1, 2])),
    ] {
        now = now.over(&Tally { won, knockdowns });
        assert_eq!((now.before.won, now.before.knockdowns), sum);
        assert_eq!((now.damage, now.knockdowns), ([0.0; 2], [0; 2]));
    }
}

/// After it the world is that of the next bout.
#[test]
fn a_knock_down_is_seen_in_the_last_frame_of_its_bout() {
    let episodes = episodes();
    let mut env = episodes.open(0);
    let mut recorded = RecordedBout::new(episodes.bouts.clone().unwrap());
    let action = env.task().rest_action().repeat(2);
    let mut step = DrivenStep::new(&env);
    strike_blue(&mut env);
    step.play_by(&mut env, |_| action.clone());
    recorded.push(&env, true);
    // Blue lies, out of reach.
    let model = env.task().model().clone();
    let world = &mut env.batch.worlds[0].state;
    world.q.copy_from_slice(&model.qpos0);
    world.v.fill(0.0);
    let blue = &mut world.q[model.nq() / 2..];
    let lying = Quat::from_rotation_y(0.5 * PI);
    blue[..3].copy_from_slice(&[2.0, 0.0, 0.15]);
    blue[3..7].copy_from_slice(&[lying.w, lying.x, lying.y, lying.z]);
    step.play_by(&mut env, |_| action.clone());
    assert_eq!(step.ends.host(), [SUCCESS, FAILED]);
    recorded.push(&env, false);
    let sum = tally(&env);
    assert_eq!((sum.won, sum.knockdowns), ([1, 0], [1, 0]));
    let last = recorded.at(1);
    assert_eq!(last.knockdowns, [1, 0]);
    assert!(last.damage[0] > 0.0 && last == recorded.at(2));
}

#[test]
fn two_who_are_far_apart_are_in_the_picture() {
    for aspect in [0.7, 1.0, 1.6, 2.4] {
        for yaw in 0..12 {
            let mut camera = Camera {
                yaw: yaw as f32 * 0.5,
                ..Camera::default()
            };
            camera.frame([1.0, -2.0], 3.0, aspect, 1.0);
            let clip = camera.clip(aspect);
            for corner in [-3.0, 3.0]
                .iter()
                .flat_map(|x| [0.0, 1.8].map(|y| Vec3::new(*x, y, 0.0)))
            {
                let at = clip.project_point3(corner + Vec3::new(1.0, 0.0, -2.0));
                assert!(
                    at.x.abs() < 0.98 && at.y.abs() < 0.98,
                    "{aspect} {yaw}: {at}"
                );
            }
            // Together again, it is as near as before.
            camera.frame([0.0; 2], 0.0, aspect, 1.0);
            assert!((camera.distance - Camera::default().distance).abs() < 1e-4);
        }
    }
}

/// Turns a root to face a way, at a point of the ground.
fn stand(q: &mut [f32], at: Vec2, facing: Vec2) {
    q[..2].copy_from_slice(&at.to_array());
    let turned = Quat::from_rotation_z(facing.to_angle());
    q[3..7].copy_from_slice(&[turned.w, turned.x, turned.y, turned.z]);
}

#[test]
fn a_command_shows_the_world_in_which_it_is_what_one_would_do() {
    let episodes = episodes();
    let (q, v) = start(&episodes.open(0));
    let (half_q, half_v) = (q.len() / 2, v.len() / 2);
    let own = Vec2::from_slice(&q);
    let way = Vec2::from_angle(2.2);
    let mut imagined = ImaginedWorld::new(episodes.open(0));
    let mut told = |command: FightCommand| imagined.observe(&command, &q, &v).to_vec();
    // The opponent is really there.
    let mut env = episodes.open(0);
    let mut there = |far: f32, way: Vec2| {
        let world = &mut env.batch.worlds[0].state;
        world.q.copy_from_slice(&q);
        world.v.copy_from_slice(&v);
        world.q[half_q..].copy_from_slice(&scenes::humanoid().qpos0);
        stand(&mut world.q[half_q..], own + far * way, -way);
        world.v[half_v..].fill(0.0);
        env.observe_all();
        env.seen(0).to_vec()
    };
    let walk = FightCommand {
        walk: Some(way),
        ..FightCommand::default()
    };
    assert_eq!(told(walk), there(2.0, way));
    let face = FightCommand {
        face: Some(-way),
        ..FightCommand::default()
    };
    assert_eq!(told(face), there(1.2, -way));
    let gap = Vec2::from_slice(&q[half_q..]) - own;
    let opponent = gap / gap.length();
    assert_eq!(told(FightCommand::default()), there(1.2, opponent));
    let punch = FightCommand {
        punch: true,
        ..walk
    };
    assert_eq!(told(punch), episodes.open(0).seen(0));
}

#[test]
fn who_has_learned_to_topple_a_box_is_shown_one() {
    let (q, v) = start(&episodes().open(0));
    let own = Vec2::from_slice(&q);
    let opponent = Vec2::from_slice(&q[q.len() / 2..]) - own;
    for name in ["punch", "joystick"] {
        let learned = task(name).1.body().unwrap();
        let mut imagined = ImaginedWorld::new(learned.open(0));
        let way = Vec2::from_angle(-1.1);
        let mut told = |command: FightCommand| imagined.observe(&command, &q, &v).to_vec();
        let walk = told(FightCommand {
            walk: Some(way),
            ..FightCommand::default()
        });
        let heading = footwork::env::humanoid::boxing::command::facing(&q);
        let turned = |v: Vec2| [heading.dot(v), heading.perp_dot(v)];
        // The direction to the box comes first, then a fifth of its distance.
        let near = |seen: &[f32], wanted: &[f32]| {
            let far = seen.iter().zip(wanted).map(|(a, b)| (a - b).abs());
            assert!(far.fold(0.0, f32::max) < 1e-5, "{name} {seen:?} {wanted:?}");
        };
        near(&walk[BODY..], &turned(way));
        near(&walk[BODY + 2..], &[0.4]);
        let punch = told(FightCommand {
            punch: true,
            ..FightCommand::default()
        });
        near(&punch[BODY..], &turned(opponent.normalize()));
        near(&punch[BODY + 2..], &[0.2 * opponent.length()]);
        if name == "joystick" {
            near(&walk[BODY + 19..], &turned(way));
            near(&walk[BODY + 21..], &turned(opponent.normalize()));
        }
    }
}

/// A driver that leaves what it saw last, and always does the same.
fn spy(action: Vec<f32>, width: usize) -> (Arc<Mutex<Vec<f32>>>, BodyPolicy) {
    let saw = Arc::new(Mutex::new(Vec::new()));
    let told = saw.clone();
    let driver = move |seen: &[f32]| {
        *told.lock().unwrap() = seen.to_vec();
        action.repeat(seen.len() / width)
    };
    let policy = BodyPolicy {
        driver: Arc::new(driver),
        discriminator: None,
    };
    (saw, policy)
}

#[test]
fn a_command_changes_what_red_sees_and_nothing_else() {
    let episodes = episodes();
    let rest = episodes.open(0).task().rest_action();
    let (saw, policy) = spy(rest.clone(), SEEN);
    let mut context = BodyContext::new(episodes.clone());
    let mut first = BodyPlaythrough::new(&mut context, 0).unwrap();
    first.next(&mut context, &policy, None).unwrap();
    let alone = saw.lock().unwrap().clone();
    first.command = Some(FightCommand {
        walk: Some(Vec2::X),
        ..FightCommand::default()
    });
    let next = first.next(&mut context, &policy, None).unwrap();
    let told = saw.lock().unwrap().clone();
    assert_eq!(told[..BODY], alone[..BODY]);
    assert_ne!(told[BODY..SEEN], alone[BODY..SEEN]);
    assert_eq!(told[SEEN..], alone[SEEN..]);
    assert_eq!(next.command, first.command);
    // Somebody else's policy moves red alone.
    let learned = task("punch").1.body().unwrap().open(0);
    let width = learned.seen(0).len();
    let other: Vec<f32> = rest.iter().map(|angle| angle + 0.5).collect();
    let (own_saw, own) = spy(other, width);
    let fighter = OwnFighter::new(learned, Some(own.driver));
    let mut context = BodyContext::new(episodes).with_fighter(fighter);
    let moved = first.next(&mut context, &policy, None).unwrap();
    assert_eq!(own_saw.lock().unwrap().len(), width);
    assert_eq!(*saw.lock().unwrap(), alone);
    let half = moved.q.len() / 2;
    assert!(moved.q[..half] != next.q[..half]);
    assert!(moved.q[half..] == next.q[half..]);
}

/// The window of a bout, fought by whoever looks.
fn fought() -> Harness<'static, BodyViewer> {
    let mut harness = open("box");
    press(&mut harness, "Pause");
    press(&mut harness, "Fight yourself");
    harness
}

fn command(harness: &Harness<BodyViewer>) -> FightCommand {
    harness.state().timeline().now().command.expect("a command")
}

#[test]
fn keys_are_commands() {
    let mut harness = fought();
    assert_eq!(harness.state().timeline().now().command, None);
    press(&mut harness, "Step");
    assert_eq!(command(&harness), FightCommand::default());
    harness.key_down(Key::W);
    press(&mut harness, "Step");
    let away = simulated(Camera::default().over_ground([0.0, 1.0])).truncate();
    let walk = command(&harness).walk.expect("a direction");
    assert!(walk.distance(away) < 1e-5, "{walk} {away}");
    harness.key_up(Key::W);
    for key in [Key::J, Key::Q] {
        harness.key_down(key);
    }
    press(&mut harness, "Step");
    let told = command(&harness);
    assert!(
        told.punch && told.face.is_some() && told.walk.is_none(),
        "{told:?}"
    );
    for key in [Key::J, Key::Q] {
        harness.key_up(key);
    }
    harness.get_by_label_contains("leads");
    keep(&mut harness, "bout-fought");
    harness.key_press(Key::F);
    press(&mut harness, "Step");
    assert_eq!(harness.state().timeline().now().command, None);
}

#[test]
fn what_was_fought_is_played_again_until_somebody_intervenes() {
    let mut harness = fought();
    harness.key_down(Key::D);
    for _ in 0..4 {
        press(&mut harness, "Step");
    }
    harness.key_up(Key::D);
    let moment = |harness: &Harness<BodyViewer>| {
        let now = harness.state().timeline().now();
        (now.q.clone(), now.command)
    };
    let (after, frames) = (moment(&harness), harness.state().timeline().len());
    for _ in 0..3 {
        press(&mut harness, "Back");
    }
    for _ in 0..3 {
        press(&mut harness, "Step");
    }
    assert_eq!(moment(&harness), after);
    assert_eq!(harness.state().timeline().len(), frames);
    for _ in 0..3 {
        press(&mut harness, "Back");
    }
    harness.key_down(Key::A);
    press(&mut harness, "Step");
    assert_eq!(harness.state().timeline().len(), frames - 2);
    let again = moment(&harness);
    // The same command at the same moment leads to the same again.
    press(&mut harness, "Back");
    press(&mut harness, "Step");
    assert_eq!(moment(&harness), again);
}

#[test]
fn commands_lead_to_the_same_every_time() {
    let (config, task) = task("box");
    let policy = untrained(&config, &*task);
    let mut context = BodyContext::new(task.body().unwrap());
    let mut played = vec![BodyPlaythrough::new(&mut context, 1).unwrap()];
    for step in 0..40 {
        let mut now = played[step].clone();
        now.command = Some(FightCommand {
            walk: (step % 7 < 4).then(|| Vec2::from_angle(step as f32)),
            punch: step % 5 == 0,
            ..FightCommand::default()
        });
        played[step] = now;
        played.push(played[step].next(&mut context, &policy, None).unwrap());
    }
    for from in [0, 11, 39] {
        let again = played[from].next(&mut context, &policy, None).unwrap();
        assert_eq!(again.q, played[from + 1].q, "{from}");
        assert_eq!(again.bout, played[from + 1].bout, "{from}");
    }
}
