//! The map of latents, used as a person would.

use crate::body::{keep, open, pointer, press, task, untrained};
use eframe::egui::{Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use footwork::train::body_episodes::BodyEpisodes;
use footwork::train::body_policy::BodyPolicy;
use footwork::train::config::{Config, Preset};
use footwork::train::tasks::find;
use footwork::view::body_playthrough::{BodyContext, BodyPlaythrough};
use footwork::view::latent_map::LatentMap;
use footwork::view::sphere::dot;
use footwork::viewer::BodyViewer;
use std::time::{Duration, Instant};

/// A window of skills, paused, once it has its map.
fn window() -> Harness<'static, BodyViewer> {
    let mut harness = open("skills");
    press(&mut harness, "Pause");
    let begin = Instant::now();
    while harness.state().latent_map().is_none() {
        assert!(begin.elapsed() < Duration::from_secs(120), "no map");
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
    harness.run_steps(2);
    harness
}

/// Clicks a point of the map.
fn click(harness: &mut Harness<BodyViewer>, at: [f32; 2]) {
    let rect = harness.get_by_label("Map of latents").rect();
    let radius = 0.5 * rect.width() - 8.0;
    let centre = Pos2::new(rect.center().x, rect.center().y);
    let pos = centre + radius * Vec2::new(at[0], -at[1]);
    pointer(harness, pos, true);
    pointer(harness, pos, false);
    harness.run_steps(2);
}

fn steps(harness: &mut Harness<BodyViewer>, count: usize) -> Vec<f32> {
    for _ in 0..count {
        press(harness, "Step");
    }
    harness.state().timeline().now().q.clone()
}

/// Where the held latent is on the map.
fn held(harness: &Harness<BodyViewer>) -> Option<[f32; 2]> {
    let map: &LatentMap = harness.state().latent_map().unwrap();
    let path = harness.state().timeline().now().path.as_ref()?;
    let length = dot(path.end(), path.end());
    assert!((length - 1.0).abs() < 1e-4, "{length}");
    Some(map.place(path.end()))
}

#[test]
fn a_click_on_the_map_changes_what_the_body_does() {
    let mut harness = window();
    steps(&mut harness, 2);
    let start = harness.state().timeline().at();
    let back = |harness: &mut Harness<BodyViewer>| {
        while harness.state().timeline().at() > start {
            press(harness, "Back");
        }
    };
    assert_eq!(held(&harness), None);
    let free = steps(&mut harness, 6);
    let mut seen = vec![free];
    for at in [[0.7, 0.6], [-0.75, -0.55]] {
        back(&mut harness);
        click(&mut harness, at);
        let [x, y] = held(&harness).expect("a latent is held");
        // As near as a point of the map may be.
        assert!((x - at[0]).hypot(y - at[1]) < 0.1, "{at:?}: {x} {y}");
        let once = steps(&mut harness, 6);
        // Rewound, it does the same again.
        back(&mut harness);
        assert_eq!(steps(&mut harness, 6), once);
        assert!(!seen.contains(&once), "{at:?}");
        seen.push(once);
    }
    keep(&mut harness, "skills-held");
    press(&mut harness, "Change latents as in training");
    assert_eq!(held(&harness), None);
    let before = harness.state().timeline().now().latent().to_vec();
    steps(&mut harness, 1);
    assert_ne!(harness.state().timeline().now().latent(), before);
}

#[test]
fn it_glides_on_the_sphere_to_where_it_is_sent() {
    let mut harness = window();
    // So early that there is time before it falls.
    while harness.state().timeline().at() > 1 {
        press(&mut harness, "Back");
    }
    press(&mut harness, "Glide there");
    click(&mut harness, [0.1, 0.8]);
    let latent = |harness: &Harness<BodyViewer>| -> Vec<f32> {
        harness.state().timeline().now().latent().to_vec()
    };
    let end = harness.state().timeline().now().path.clone().unwrap();
    let mut near = dot(&latent(&harness), end.end());
    for _ in 0..8 {
        steps(&mut harness, 1);
        let now = latent(&harness);
        assert!((dot(&now, &now) - 1.0).abs() < 1e-4);
        let nearer = dot(&now, end.end());
        assert!(nearer > near, "{nearer} {near}");
        near = nearer;
    }
    assert!(near < 0.99, "it is there at once");
    keep(&mut harness, "skills-glide");
}

/// A playthrough of the first steps of skills, with the context and the policy for more.
fn played() -> (BodyContext, BodyPolicy, BodyPlaythrough) {
    let (config, task) = task("skills");
    let policy = untrained(&config, &*task);
    let mut context = BodyContext::new(task.body().unwrap());
    let first = BodyPlaythrough::new(&mut context, 0).unwrap();
    let first = first.next(&mut context, &policy, None).unwrap();
    (context, policy, first)
}

#[test]
fn a_glide_arrives_and_a_fall_does_not_let_go() {
    let (mut context, policy, mut moment) = played();
    let goal: Vec<f32> = moment.latent().iter().map(|number| -number).collect();
    moment.hold(goal.clone(), 10);
    for step in 1..=10 {
        moment = moment.next(&mut context, &policy, None).unwrap();
        assert_eq!(moment.latent() == goal, step == 10);
    }
    // Nothing balances it.
    while moment.episode == 0 {
        moment = moment.next(&mut context, &policy, None).unwrap();
    }
    moment = moment.next(&mut context, &policy, None).unwrap();
    assert_eq!(moment.latent(), goal);
    moment.path = None;
    moment = moment.next(&mut context, &policy, None).unwrap();
    assert_ne!(moment.latent(), goal);
}

#[test]
fn a_map_tells_what_the_body_does_and_is_the_same_every_time() {
    let entry = find("skills").unwrap();
    let mut config = entry.config(Preset::Fast);
    config.ppo.envs = 4;
    let policy_of = |config: &Config| {
        let task = (entry.load)(config).unwrap().task;
        (untrained(config, &*task), task.body().unwrap())
    };
    let map = |(policy, episodes): &(BodyPolicy, BodyEpisodes)| {
        let library = episodes.recordings.as_ref().unwrap();
        let draw = episodes.latents.as_ref().unwrap();
        LatentMap::new(episodes, library, draw, &*policy.driver)
    };
    // Hardly anything balances it.
    let falling = map(&policy_of(&config));
    let fallen = falling.points.iter().filter(|point| point.clip.is_none());
    assert!(2 * fallen.count() > falling.points.len());
    // Nothing is a fall now.
    for height in ["min_head_height", "min_pelvis_height", "min_body_height"] {
        config.task.settings.insert(height.into(), 0.0.into());
    }
    let lying = policy_of(&config);
    let (map, again) = (map(&lying), map(&lying));
    assert!(map.points.len() > 100 && !map.legend.is_empty());
    for (point, same) in map.points.iter().zip(&again.points) {
        assert!((dot(&point.latent, &point.latent) - 1.0).abs() < 1e-4);
        assert!(point.clip.is_some_and(|clip| clip < map.legend.len()));
        assert_eq!((&point.latent, point.clip), (&same.latent, same.clip));
    }
}
