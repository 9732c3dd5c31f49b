//! Oracle: the six places of the character and of the boxes in f64, see `geometry`; twin and
//! shader are both judged by it.
//! Bar: none where no arithmetic rounds; else 1e-5 m from an edge.

use crate::inputs::{Draw, POISON_WHOLE, SIZES, places_but};
use crate::support::forms::Forms;
use crate::support::geometry::{Stance, depth, right};
use crate::support::ground::{COUNTS, GRAIN, Ground, SQUARE};
use footwork::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use footwork::kernels::locomotion::obstacle_collision;

const FRAMES: usize = 600;

struct Case {
    ground: Ground,
    candidates: Vec<u32>,
    matched: Vec<u32>,
    path: Vec<[f32; 4]>,
    params: obstacle_collision::Params,
}

impl Case {
    fn new(mut ground: Ground, seed: u32) -> Self {
        let mut draw = Draw::new(seed);
        let candidates: Vec<u32> = (0..97).map(|place| 6 * place + 2).collect();
        ground.state_u32[state_u32::HAS_COLLIDED * ground.envs..][..ground.envs].fill(POISON_WHOLE);
        Case {
            matched: (0..ground.envs).map(|_| draw.below(97) as u32).collect(),
            path: walk(&ground, &mut draw),
            candidates,
            params: obstacle_collision::Params {
                envs: ground.envs as u32,
                count: ground.count as u32,
                square: SQUARE,
                frame_time: if ground.exact { 1.0 / 32.0 } else { 1.0 / 30.0 },
            },
            ground,
        }
    }

    fn run(&self) -> Forms<Vec<u32>> {
        let ground = &self.ground;
        forms!(
            obstacle_collision, OBSTACLE_COLLISION, ground.envs, self.params;
            self.candidates, self.matched, self.path, ground.boxes, ground.obstacle_velocity,
            ground.state_f32, mut ground.state_u32
        )
    }

    /// How deep the character gets into an obstacle.
    fn depth(&self, env: usize) -> f64 {
        let (stance, obstacles) = (self.ground.stance(env), self.ground.obstacles(env));
        let frame = self.candidates[self.matched[env] as usize] as usize;
        let [x, z, hx, hz] = self.path[frame].map(f64::from);
        let recorded = Stance {
            at: [x, z],
            forward: [hx, hz],
        };
        let depths = (1..=6).map(|k| {
            let [x, z, ..] = self.path[frame + k].map(f64::from);
            let [left, ahead] = recorded.sees([x, z]);
            let time = k as f64 * f64::from(self.params.frame_time);
            let moved: Vec<_> = obstacles
                .iter()
                .map(|obstacle| obstacle.moved(time, f64::from(self.params.square)))
                .collect();
            depth(&moved, stance.point(left, ahead))
        });
        depths.fold(f64::NEG_INFINITY, f64::max)
    }

    fn agrees(&self) -> Vec<u32> {
        let envs = self.ground.envs;
        let written = state_u32::HAS_COLLIDED * envs..(state_u32::HAS_COLLIDED + 1) * envs;
        let forms = self.run();
        let depths: Vec<f64> = (0..envs).map(|env| self.depth(env)).collect();
        for (form, got) in forms.all() {
            assert!(places_but(&written, got).eq(places_but(&written, &self.ground.state_u32)));
            for (env, (&struck, &depth)) in got[written.clone()].iter().zip(&depths).enumerate() {
                let fits = struck < 2 && right(struck == 1, depth, self.ground.bar());
                assert!(fits, "{form}: environment {env}: {struck}, {depth:e} m");
            }
        }
        forms.twin[written].to_vec()
    }
}

/// A path of steps up to 0.2 m, as a runner's in a frame.
fn walk(ground: &Ground, draw: &mut Draw) -> Vec<[f32; 4]> {
    let mut at = [0.0; 2];
    let step = |draw: &mut Draw| {
        at = at.map(|place: f32| (place + ground.length(draw, 0.2)).clamp(-20.0, 20.0));
        let [hx, hz] = ground.heading(draw);
        [at[0], at[1], hx, hz]
    };
    std::iter::repeat_with({
        let mut step = step;
        move || step(draw)
    })
    .take(FRAMES)
    .collect()
}

#[test]
fn agrees_with_geometry_in_all_worlds() {
    let mut counts = [0; 2];
    for exact in [true, false] {
        for count in COUNTS {
            for envs in SIZES {
                let ground = Ground::new(envs, count, envs as u32, exact);
                for struck in Case::new(ground, count as u32).agrees() {
                    counts[struck as usize] += 1;
                }
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 1000), "{counts:?}");
}

/// A character that stands at `x` on the square's edge, and a box of no size that runs towards it.
fn met(x: f32, from: f32, grains_a_frame: f32) -> bool {
    let mut ground = Ground::new(1, 1, 1, true);
    (
        ground.state_f32[state_f32::X],
        ground.state_f32[state_f32::Z],
    ) = (x, 0.0);
    ground.boxes[..4].copy_from_slice(&[from, 0.0, 0.0, 0.0]);
    ground.obstacle_velocity[..2].copy_from_slice(&[32.0 * GRAIN * grains_a_frame, 0.0]);
    let mut case = Case::new(ground, 1);
    case.path.fill([3.0, 4.0, 0.0, 1.0]);
    case.agrees() == [1]
}

#[test]
fn boxes_are_met_at_the_frames_and_only_there() {
    let grains = |count: f32| count * GRAIN;
    assert!(!met(0.0, 0.0, 1.0), "not before the first frame");
    assert!(met(0.0, 0.0, 0.0));
    assert!(met(grains(1.0), 0.0, 1.0), "at the first");
    assert!(met(grains(6.0), 0.0, 1.0), "at the sixth");
    assert!(!met(grains(7.0), 0.0, 1.0), "not after it");
    assert!(!met(grains(1.0), 0.0, 2.0), "not between frames");
    assert!(met(SQUARE, SQUARE - grains(3.0), 1.0), "at the wall");
    assert!(met(SQUARE - grains(3.0), SQUARE, 1.0), "bounced");
    assert!(!met(SQUARE + grains(1.0), SQUARE, 1.0), "not beyond it");
}

/// Lavapipe silently stops after 65,535 loop iterations.
#[test]
fn the_last_of_ten_thousand_boxes_is_met() {
    let mut case = Case::new(Ground::crowded(3, 10_000), 1);
    case.params.square = 1024.0;
    case.path.fill([3.0, 4.0, 0.0, 1.0]);
    assert_eq!(case.agrees(), [1; 3]);
}
