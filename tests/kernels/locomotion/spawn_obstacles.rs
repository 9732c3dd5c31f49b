//! Oracle: `spawn_obstacles::twin`; the distribution it draws is tested here too.
//! Bar: boxes equal bit for bit; velocities, a quotient of a square root, within 4 roundings.

use crate::inputs::{Draw, POISON, SEEDS, SIZES, close, same, within_terms};
use footwork::kernels::locomotion::locomotion_layout::{VELOCITY_DIM, boxes};
use footwork::kernels::locomotion::spawn_obstacles;
use footwork::kernels::termination;

struct Case {
    termination: Vec<u32>,
    params: spawn_obstacles::Params,
}

type Drawn = (Vec<f32>, Vec<f32>);

impl Case {
    /// The paper's obstacles on the hardest level.
    fn new(envs: usize, count: usize, seed: u32, termination: impl Fn(usize) -> u32) -> Self {
        let mut draw = Draw::new(seed);
        let offset = draw.below(3) * envs;
        // Ends of other steps would draw anew if they were read.
        let mut ends = vec![termination::SUCCESS; offset + envs + 5];
        for env in 0..envs {
            ends[offset + env] = termination(env);
        }
        Case {
            termination: ends,
            params: spawn_obstacles::Params {
                envs: envs as u32,
                first: 3,
                count: count as u32,
                seed,
                step_counter: draw.bits()[0],
                offset: offset as u32,
                all: 0,
                side_min: 0.5,
                side_max: 3.0,
                square: 10.0,
                margin: 0.5,
                speed: 0.5,
                speed_min: 1.0,
            },
        }
    }

    fn obstacles(&self) -> usize {
        (self.params.envs * self.params.count) as usize
    }

    fn agrees(&self) -> Vec<Obstacle> {
        let obstacles = self.obstacles();
        let forms = forms!(
            spawn_obstacles, SPAWN_OBSTACLES, obstacles, self.params; self.termination,
            out obstacles * boxes::FIELDS, out obstacles * VELOCITY_DIM
        );
        for (form, got) in forms.shaders() {
            same(form, &got.0, &forms.twin.0);
            close(form, &got.1, &forms.twin.1, |_| {
                within_terms(&[self.params.speed])
            });
        }
        self.read(&forms.twin)
    }

    fn read(&self, (all, obstacle_velocity): &Drawn) -> Vec<Obstacle> {
        let count = self.params.count as usize;
        let obstacle = |i: usize| {
            let (env, slot) = (i / count, i % count);
            let of = |field: usize| all[(env * boxes::FIELDS + field) * count + slot];
            let along = |axis: usize| obstacle_velocity[(env * VELOCITY_DIM + axis) * count + slot];
            Obstacle {
                centre: [of(boxes::X), of(boxes::Z)],
                half: [of(boxes::HALF_X), of(boxes::HALF_Z)],
                velocity: [along(0), along(1)],
            }
        };
        (0..self.obstacles()).map(obstacle).collect()
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Obstacle {
    centre: [f32; 2],
    half: [f32; 2],
    velocity: [f32; 2],
}

impl Obstacle {
    const UNDRAWN: Obstacle = Obstacle {
        centre: [POISON; 2],
        half: [POISON; 2],
        velocity: [POISON; 2],
    };

    fn speed(&self) -> f64 {
        f64::from(self.velocity[0]).hypot(self.velocity[1].into())
    }

    /// Distance of the box, with its inside, from the start along the farther axis.
    fn clearance(&self) -> f32 {
        let along = |i: usize| self.centre[i].abs() - self.half[i];
        along(0).max(along(1))
    }
}

#[test]
fn agrees_with_its_twin_and_draws_only_where_an_episode_ended() {
    for seed in SEEDS {
        for envs in SIZES {
            for count in [0, 1, 100] {
                let mut draw = Draw::new(seed);
                let ends: Vec<u32> = (0..envs).map(|_| draw.below(4) as u32).collect();
                let drawn = Case::new(envs, count, seed, |env| ends[env]).agrees();
                for (i, obstacle) in drawn.into_iter().enumerate() {
                    let untouched = ends[i / count] == termination::RUNNING;
                    assert_eq!(obstacle == Obstacle::UNDRAWN, untouched);
                }
            }
        }
    }
}

#[test]
fn agrees_at_the_edges_of_its_parameters() {
    for (seed, step_counter) in [(0, 0), (u32::MAX, u32::MAX), (1, 12345)] {
        for (side_min, side_max) in [(0.0, 0.0), (3.0, 3.0), (0.0, 1e6)] {
            for (square, margin) in [(10.0, 0.0), (1.0, 5.0), (1e5, 0.5)] {
                for (speed, speed_min) in [(0.0, 1.0), (100.0, 0.0), (1e-20, 0.5)] {
                    let mut case = Case::new(3, 400, seed, |_| termination::RUNNING);
                    case.params = spawn_obstacles::Params {
                        all: 1,
                        step_counter,
                        side_min,
                        side_max,
                        square,
                        margin,
                        speed,
                        speed_min,
                        ..case.params
                    };
                    case.agrees();
                }
            }
        }
    }
}

#[test]
fn boxes_that_find_no_place_stand_in_the_corner() {
    let mut case = Case::new(65, 10, 3, |_| termination::FAILED);
    (case.params.square, case.params.margin) = (2.0, 2.0);
    for obstacle in case.agrees() {
        assert_eq!(obstacle.centre, [2.0; 2]);
    }
}

/// 300 environments of 100 boxes.
fn many(speed_min: f32) -> Vec<Obstacle> {
    let mut case = Case::new(300, 100, 11, |_| termination::TRUNCATED);
    case.params.speed_min = speed_min;
    case.agrees()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
    sum / count
}

#[test]
fn sizes_and_places_are_uniform_and_clear_of_the_start() {
    let drawn = many(1.0);
    for axis in 0..2 {
        let sides = || drawn.iter().map(|o| 2.0 * f64::from(o.half[axis]));
        assert!(sides().all(|side| (0.5..=3.0).contains(&side)));
        // Deviation of a mean of 30,000: 0.004. Large boxes are not drawn again, their places are.
        assert!((mean(sides()) - 1.75).abs() < 0.02);
        assert!((mean(sides().map(|side| (side - 1.75).powi(2))) - 6.25 / 12.0).abs() < 0.01);
        let places = || drawn.iter().map(|o| f64::from(o.centre[axis]));
        assert!(places().all(|place| place.abs() <= 10.0));
        assert!(mean(places()).abs() < 0.15, "deviation 0.033");
        // 100 / 3, and a little more without the start.
        assert!((mean(places().map(|place| place * place)) - 33.8).abs() < 0.9);
    }
    let nearest = drawn.iter().map(Obstacle::clearance).fold(10.0, f32::min);
    assert!((0.499_999..0.52).contains(&nearest), "{nearest}");
    let both = mean(drawn.iter().map(|o| f64::from(o.half[0] * o.half[1])));
    assert!((both - 0.875 * 0.875).abs() < 0.01, "sides are independent");
}

#[test]
fn directions_are_uniform_and_speeds_the_levels() {
    let drawn = many(1.0);
    assert!(drawn.iter().all(|o| (o.speed() - 0.5).abs() < 1e-6));
    let mut eighths = [0; 8];
    for obstacle in &drawn {
        let [x, z] = obstacle.velocity;
        let eighth =
            4 * usize::from(x > 0.0) + 2 * usize::from(z > 0.0) + usize::from(x.abs() > z.abs());
        eighths[eighth] += 1;
    }
    // 3750 each, deviation 57.
    assert!(
        eighths
            .iter()
            .all(|&count: &i32| (count - 3750).abs() < 300),
        "{eighths:?}"
    );
    for axis in 0..2 {
        let mean = mean(drawn.iter().map(|o| f64::from(o.velocity[axis])));
        assert!(mean.abs() < 0.01, "{mean}, deviation 0.002");
    }
    // No two boxes have the same.
    let mut along: Vec<u32> = drawn.iter().map(|o| o.velocity[0].to_bits()).collect();
    along.sort_unstable();
    along.dedup();
    assert!(along.len() > 29_000);
}

#[test]
fn speeds_are_uniform_up_to_the_levels_if_asked() {
    let drawn = many(0.0);
    let speeds = || drawn.iter().map(Obstacle::speed);
    assert!(speeds().all(|speed| speed < 0.500_001));
    assert!((mean(speeds()) - 0.25).abs() < 0.005, "deviation 0.0008");
    assert!((mean(speeds().map(|speed| speed * speed)) - 0.25 / 3.0).abs() < 0.003);
    // As fast whatever their size.
    let together = mean(drawn.iter().map(|o| o.speed() * f64::from(o.half[0])));
    assert!((together - 0.25 * 0.875).abs() < 0.005);
}
