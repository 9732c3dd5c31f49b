//! Oracle: the asked-for positions in f64, see `geometry`; twin and shader are both judged by it.
//! Bar: none where no arithmetic rounds; else 1e-5 m from an edge.

use crate::inputs::{Draw, POISON, POISON_WHOLE, SIZES, places_but};
use crate::support::forms::Forms;
use crate::support::geometry::{depth, right};
use crate::support::ground::{COUNTS, GRAIN, Ground};
use footwork::kernels::locomotion::hits;
use footwork::kernels::locomotion::locomotion_layout::{boxes, state_f32, state_u32};
use footwork::motion::features::TRAJECTORY_DIM;

struct Case {
    ground: Ground,
    action: Vec<f32>,
    normal: Vec<f32>,
    params: hits::Params,
}

impl Case {
    fn new(mut ground: Ground, seed: u32) -> Self {
        let mut draw = Draw::new(seed);
        let exact = ground.exact;
        let mut normal: Vec<f32> = (0..TRAJECTORY_DIM)
            .map(|_| ground.length(&mut draw, 1.0))
            .collect();
        // Powers of two, which divide exactly; or any.
        normal.extend((0..TRAJECTORY_DIM).map(|_| match exact {
            true => [0.5, 1.0, 2.0, 4.0][draw.below(4)],
            false => 0.3 + draw.within(1.0).abs(),
        }));
        let asked = |i: usize, draw: &mut Draw| {
            let away = ground.length(draw, 3.0);
            away * normal[TRAJECTORY_DIM + i % TRAJECTORY_DIM]
        };
        let numbers = ground.envs * TRAJECTORY_DIM;
        // Those of steps before, which are not looked at.
        let action_at = seed as usize % 3 * numbers;
        let mut action = vec![POISON; action_at];
        action.extend((0..numbers).map(|i| asked(i, &mut draw)));
        ground.state_u32[state_u32::HITS * ground.envs..][..ground.envs].fill(POISON_WHOLE);
        Case {
            action,
            normal,
            params: hits::Params {
                envs: ground.envs as u32,
                action_at: action_at as u32,
                count: ground.count as u32,
            },
            ground,
        }
    }

    fn run(&self) -> Forms<Vec<u32>> {
        let ground = &self.ground;
        forms!(
            hits, HITS, ground.envs, self.params;
            self.action, self.normal, ground.boxes, ground.state_f32, mut ground.state_u32
        )
    }

    /// How deep each of the three positions lies in an obstacle.
    fn depths(&self, env: usize) -> [f64; 3] {
        let (stance, obstacles) = (self.ground.stance(env), self.ground.obstacles(env));
        [0, 4, 8].map(|x| {
            let [left, ahead] = [x, x + 1].map(|i| {
                let [action, scale, mean] = [
                    self.action[self.params.action_at as usize + env * TRAJECTORY_DIM + i],
                    self.normal[TRAJECTORY_DIM + i],
                    self.normal[i],
                ]
                .map(f64::from);
                action / scale + mean
            });
            depth(&obstacles, stance.point(left, ahead))
        })
    }

    fn agrees(&self) -> Vec<u32> {
        let envs = self.ground.envs;
        let written = state_u32::HITS * envs..(state_u32::HITS + 1) * envs;
        let forms = self.run();
        for (form, got) in forms.all() {
            assert!(places_but(&written, got).eq(places_but(&written, &self.ground.state_u32)));
            for (env, &hits) in got[written.clone()].iter().enumerate() {
                let depths = self.depths(env);
                // Each position may be found inside or outside if it is on the edge.
                let fits = (0..8u32).any(|found| {
                    let of = |k: usize| found >> k & 1 == 1;
                    let fit = |k: usize| right(of(k), depths[k], self.ground.bar());
                    found.count_ones() == hits && (0..3).all(fit)
                });
                assert!(fits, "{form}: environment {env}: {hits} hits, {depths:?}");
            }
        }
        forms.twin[written].to_vec()
    }
}

#[test]
fn agrees_with_geometry_in_all_worlds() {
    let mut counts = [0; 4];
    for exact in [true, false] {
        for count in COUNTS {
            for envs in SIZES {
                let ground = Ground::new(envs, count, envs as u32, exact);
                for hits in Case::new(ground, count as u32).agrees() {
                    counts[hits as usize] += 1;
                }
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 100), "{counts:?}");
}

#[test]
fn a_position_in_many_boxes_is_one_hit() {
    let mut ground = Ground::new(3, 100, 1, true);
    for env in 0..3 {
        let half = (env * boxes::FIELDS + boxes::HALF_X) * 100;
        ground.boxes[half..half + 200].fill(64.0);
    }
    assert_eq!(Case::new(ground, 2).agrees(), [3; 3]);
}

#[test]
fn the_edge_counts_as_inside() {
    for (away, hits) in [(GRAIN, 3), (GRAIN.next_up(), 0)] {
        let mut ground = Ground::new(1, 1, 1, true);
        ground.state_f32[state_f32::X] = away;
        ground.state_f32[state_f32::Z] = 0.0;
        ground.boxes[..4].copy_from_slice(&[0.0, 0.0, GRAIN, 0.0]);
        let mut case = Case::new(ground, 3);
        case.action.fill(0.0);
        case.normal[..TRAJECTORY_DIM].fill(0.0);
        assert_eq!(case.agrees(), [hits]);
    }
}

/// Lavapipe silently stops after 65,535 loop iterations.
#[test]
fn the_last_of_ten_thousand_boxes_is_hit() {
    let mut case = Case::new(Ground::crowded(3, 10_000), 4);
    case.action.fill(0.0);
    case.normal[..TRAJECTORY_DIM].fill(0.0);
    assert_eq!(case.agrees(), [3; 3]);
}
