use crate::{DATABASE, Picture, Walker, context};
use footwork::env::locomotion::{LocomotionTask, Obstacles, Plane};
use footwork::playback::PlacedFrame;
use footwork::playback::capsule_rig::CapsuleRig;
use footwork::train::playthrough::Playthrough;
use footwork::view::debug_draw::scene;
use footwork::view::{Camera, Scene};

const SIZE: [u32; 2] = [240, 160];

fn blue([r, _, b]: [u8; 3]) -> bool {
    b > 100 && b - b.min(r) > 60
}

fn orange([r, _, b]: [u8; 3]) -> bool {
    r > 120 && r - r.min(b) > 70
}

/// The body at a frame of the database, walking towards +z.
fn body(frame: usize) -> Scene {
    let shown = PlacedFrame {
        frame,
        at: [0.0; 2],
        heading: [0.0, 1.0],
    };
    let mut scene = Scene::default();
    let body = CapsuleRig::of(&DATABASE.skeleton, &DATABASE.roles);
    scene.character(&body, &DATABASE.skeleton, &shown.pose(&DATABASE));
    scene
}

#[test]
fn a_character_stands_on_its_feet_and_has_its_left_side_on_the_left() {
    let from_behind = Camera {
        yaw: std::f32::consts::PI,
        ..Camera::default()
    };
    let picture = Picture::draw(&body(40), None, &from_behind, SIZE);
    let columns = |pick: fn([u8; 3]) -> bool| {
        let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
        let found: Vec<u32> = pixels
            .filter(|&(x, y)| pick(picture.pixel(x, y)))
            .map(|(x, _)| x)
            .collect();
        assert!(found.len() > 30, "{}", found.len());
        found.iter().sum::<u32>() as f32 / found.len() as f32
    };
    assert!(columns(blue) < columns(orange));
    // What is highest is the head, which is neither blue nor orange; what is lowest are the feet.
    let bare = Picture::draw(&Scene::default(), None, &from_behind, SIZE);
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let mut drawn = pixels.filter(|&(x, y)| {
        let (a, b) = (picture.pixel(x, y), bare.pixel(x, y));
        a.iter().zip(&b).any(|(a, b)| a.abs_diff(*b) > 40)
    });
    let (x, y) = drawn.next().unwrap();
    let head = picture.pixel(x, y);
    assert!(!blue(head) && !orange(head), "{head:?}");
    let legs = picture.mean_row(blue).unwrap();
    assert!(legs > y as f32 + 20.0, "{legs} {y}");
}

#[test]
fn a_ball_casts_its_shadow_away_from_the_sun() {
    let camera = Camera {
        yaw: 0.0,
        pitch: 1.5,
        ..Camera::default()
    };
    let bare = Picture::draw(&Scene::default(), None, &camera, SIZE);
    let mut scene = Scene::default();
    scene.ball(glam::Vec3::new(0.0, 1.0, 0.0), 0.3, [0.9, 0.1, 0.1]);
    let lit = Picture::draw(&scene, None, &camera, SIZE);
    let mut shadow = Vec::new();
    for (y, x) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (y, x))) {
        let ([r, g, b], before) = (lit.pixel(x, y), bare.pixel(x, y));
        if r.abs_diff(b) < 30 && before[1] > g + 25 {
            shadow.push([x as f32 - 120.0, y as f32 - 80.0]);
        }
    }
    assert!(shadow.len() > 50, "{}", shadow.len());
    let mean = |axis: usize| shadow.iter().map(|at| at[axis]).sum::<f32>() / shadow.len() as f32;
    // Seen from above with -z up, the sun stands to the left and below.
    assert!(mean(0) > 5.0 && mean(1) < -5.0, "{} {}", mean(0), mean(1));
}

#[test]
fn a_walk_looks_as_it_did() {
    let context = context(LocomotionTask::Plane(Plane::default()));
    let mut playthrough = Playthrough::new(&context, 2);
    let mut camera = Camera {
        distance: 4.0,
        ..Camera::default()
    };
    for _ in 0..20 {
        playthrough.advance(&context, &Walker).unwrap();
    }
    camera.follow(playthrough.shown.at, 1.0);
    Picture::draw(&scene(&playthrough, &context), None, &camera, SIZE).must_be("walk");
}

#[test]
fn obstacles_look_as_they_did() {
    let context = context(LocomotionTask::Obstacles(Obstacles::FAST));
    let mut playthrough = Playthrough::new(&context, 1);
    let mut camera = Camera {
        distance: 9.0,
        pitch: 0.7,
        ..Camera::default()
    };
    for _ in 0..4 {
        playthrough.advance(&context, &Walker).unwrap();
    }
    camera.follow(playthrough.shown.at, 1.0);
    Picture::draw(&scene(&playthrough, &context), None, &camera, SIZE).must_be("obstacles");
}

#[test]
fn the_same_scene_is_the_same_picture() {
    let (scene, camera) = (body(100), Camera::default());
    let [once, again] = [0, 1].map(|_| Picture::draw(&scene, None, &camera, SIZE).rgb);
    assert!(once == again);
}
