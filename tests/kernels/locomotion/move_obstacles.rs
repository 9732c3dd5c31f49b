//! Oracle: boxes that run from wall to wall in f64, see `geometry`, and the same by tiny steps.
//! Bar: 4 roundings of the way and the square's circumference; a velocity's sign may differ only
//! that near to a wall. What no arithmetic rounds is equal bit for bit.

use crate::inputs::{Draw, SIZES, same};
use crate::support::geometry::bounced;
use crate::support::ground::{COUNTS, Ground, SQUARE};
use footwork::kernels::locomotion::locomotion_layout::{VELOCITY_DIM, boxes};
use footwork::kernels::locomotion::move_obstacles;
use footwork::kernels::locomotion::obstacles::bounce;

struct Case {
    ground: Ground,
    params: move_obstacles::Params,
}

type Moved = (Vec<f32>, Vec<f32>);

impl Case {
    fn new(ground: Ground, time: f32) -> Self {
        Case {
            params: move_obstacles::Params {
                envs: ground.envs as u32,
                count: ground.count as u32,
                time,
                square: SQUARE,
            },
            ground,
        }
    }

    fn agrees(&self) {
        let ground = &self.ground;
        let forms = forms!(
            move_obstacles, MOVE_OBSTACLES, ground.envs * ground.count, self.params;
            mut ground.boxes, mut ground.obstacle_velocity
        );
        for (form, moved) in forms.all() {
            self.judge(form, moved);
        }
    }

    fn judge(&self, form: &str, (got_boxes, got_drift): &Moved) {
        let (ground, count) = (&self.ground, self.ground.count);
        let (mut boxes, mut obstacle_velocity) =
            (ground.boxes.clone(), ground.obstacle_velocity.clone());
        for i in 0..ground.envs * VELOCITY_DIM * count {
            let (env, axis, slot) = (
                i / count / VELOCITY_DIM,
                i / count % VELOCITY_DIM,
                i % count,
            );
            let at = (env * boxes::FIELDS + axis) * count + slot;
            let found = (got_boxes[at], got_drift[i]);
            let from = (ground.boxes[at], ground.obstacle_velocity[i]);
            if ground.exact {
                let expected = [from.0, from.1, self.params.time, SQUARE].map(f64::from);
                let [place, velocity, time, side] = expected;
                let (place, velocity) = bounced(place, velocity, time, side);
                (boxes[at], obstacle_velocity[i]) = (place as f32, velocity as f32);
            } else {
                assert_moved(form, from, found, self.params.time, SQUARE);
                (boxes[at], obstacle_velocity[i]) = found;
            }
        }
        // Nothing but places and velocities is written.
        same(form, got_boxes, &boxes);
        same(form, got_drift, &obstacle_velocity);
    }
}

/// What rounding may change in a place.
fn bar(velocity: f32, time: f32, side: f32) -> f64 {
    4.0 * f64::from(f32::EPSILON) * f64::from((velocity * time).abs() + 4.0 * side)
}

#[track_caller]
fn assert_moved(what: &str, from: (f32, f32), found: (f32, f32), time: f32, side: f32) {
    let [place, velocity, seconds, wall] = [from.0, from.1, time, side].map(f64::from);
    let want = bounced(place, velocity, seconds, wall);
    let bar = bar(from.1, time, side);
    let what = format!("{what}: {from:?} in {time} s: {found:?} instead of {want:?}");
    assert!(found.0.abs() <= side, "{what}: outside");
    assert_eq!(found.1.abs(), from.1.abs(), "{what}: speed");
    assert!(
        (f64::from(found.0) - want.0).abs() <= bar,
        "{what} +- {bar:e}"
    );
    let turned = f64::from(found.1) != want.1;
    assert!(!turned || wall - want.0.abs() <= bar, "{what}: direction");
}

#[test]
fn agrees_with_geometry_in_all_worlds() {
    for exact in [true, false] {
        for count in COUNTS {
            for envs in SIZES {
                let time = if exact { 6.0 / 32.0 } else { 0.2 };
                Case::new(Ground::new(envs, count, envs as u32, exact), time).agrees();
            }
        }
    }
}

#[test]
fn agrees_for_steps_of_any_length() {
    for time in [0.0, 1e-6, 1.0, 37.5, 1e4] {
        Case::new(Ground::new(65, 9, 1, false), time).agrees();
    }
}

/// Corners and walls, and anywhere between.
fn starts(draw: &mut Draw, side: f32) -> [f32; 6] {
    let inner = side.next_down();
    [side, -side, inner, -inner, 0.0, draw.within(side)]
}

#[test]
fn no_speed_and_no_time_leads_out_of_the_square() {
    let mut draw = Draw::new(1);
    for side in [0.1875, 1.0, 10.0, 33.3] {
        for round in 0..3000 {
            let speed = [1e-30, 1e-3, 0.5, 7.0, 100.0][round % 5];
            let time = [1e-9, 0.2, 10.0, 1e3, 1e4][round / 5 % 5];
            let (velocity, time) = (draw.within(speed), draw.within(time).abs());
            // Walls met, each of which costs the oracle a turn.
            if velocity.abs() * time > 1e6 * side {
                continue;
            }
            for place in starts(&mut draw, side) {
                let found = bounce(place, velocity, time, side);
                assert_moved("bounce", (place, velocity), found, time, side);
            }
        }
    }
}

#[test]
fn twice_a_time_is_double_the_time() {
    let mut draw = Draw::new(2);
    for _ in 0..10_000 {
        let (velocity, time) = (draw.within(30.0), draw.within(3.0).abs());
        for place in starts(&mut draw, 10.0) {
            let (halfway, turned) = bounce(place, velocity, time, 10.0);
            let twice = bounce(halfway, turned, time, 10.0);
            let once = bounce(place, velocity, 2.0 * time, 10.0);
            let bar = 3.0 * bar(velocity, 2.0 * time, 10.0);
            let [twice_at, once_at] = [twice.0, once.0].map(f64::from);
            let what = format!("{place} at {velocity} in {time}: {twice:?}, {once:?}");
            // A place halfway may be found on either side of a wall: the same point of the way.
            assert!((twice_at - once_at).abs() <= bar, "{what}");
            assert!(twice.1 == once.1 || 10.0 - once_at.abs() <= bar, "{what}");
        }
    }
}

/// By ten thousand steps, none of which meets two walls.
fn by_tiny_steps(mut place: f64, mut velocity: f64, time: f64, side: f64) -> (f64, f64) {
    for _ in 0..10_000 {
        place += velocity * time / 1e4;
        if place.abs() > side {
            place = (2.0 * side).copysign(place) - place;
            velocity = -velocity;
        }
    }
    (place, velocity)
}

#[test]
fn agrees_with_tiny_steps() {
    let mut draw = Draw::new(3);
    for _ in 0..500 {
        let (velocity, time) = (draw.within(100.0), draw.within(10.0).abs());
        for place in starts(&mut draw, 10.0) {
            let [x, v, t] = [place, velocity, time].map(f64::from);
            let want = by_tiny_steps(x, v, t, 10.0);
            let found = bounce(place, velocity, time, 10.0);
            let bar = bar(velocity, time, 10.0);
            let what = format!("{place} at {velocity} in {time}: {found:?}, {want:?}");
            assert!((f64::from(found.0) - want.0).abs() <= bar, "{what}");
            let turned = f64::from(found.1) != want.1;
            assert!(!turned || 10.0 - want.0.abs() <= bar, "{what}");
        }
    }
}
