//! Oracle: the asked-for positions in f64, see `geometry`; twin and shader are both judged by it.
//! Bar: none where no arithmetic rounds; else 1e-5 m from an edge.

use crate::checked;
use crate::geometry::{depth, right};
use crate::ground::{COUNTS, GRAIN, Ground};
use crate::inputs::{Draw, POISON_WHOLE, SIZES, gpu, places_but};
use bytemuck::cast_slice;
use footwork::gpu::kernel::groups;
use footwork::gpu::{Buffer, shader};
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
        let action = (0..numbers).map(|i| asked(i, &mut draw)).collect();
        ground.state_u32[state_u32::HITS * ground.envs..][..ground.envs].fill(POISON_WHOLE);
        Case {
            action,
            normal,
            params: hits::Params {
                envs: ground.envs as u32,
                count: ground.count as u32,
            },
            ground,
        }
    }

    fn twin(&self) -> Vec<u32> {
        let ground = &self.ground;
        let mut state_u32 = ground.state_u32.clone();
        hits::twin(
            &self.action,
            &self.normal,
            ground.own_boxes(),
            &ground.state_f32,
            &mut state_u32,
            &self.params,
        );
        state_u32
    }

    fn launch(&self) -> Vec<u32> {
        let gpu = gpu();
        let state_u32 = Buffer::from_slice(&gpu, &self.ground.state_u32);
        hits::launch(
            &gpu,
            &Buffer::from_slice(&gpu, &self.action),
            &Buffer::from_slice(&gpu, &self.normal),
            &Buffer::from_slice(&gpu, &self.ground.boxes),
            &Buffer::from_slice(&gpu, &self.ground.state_f32),
            &state_u32,
            &self.params,
        );
        state_u32.read(&gpu).expect("whole")
    }

    fn checked(&self) -> Vec<u32> {
        let buffers: [&[u8]; 5] = [
            cast_slice(&self.action),
            cast_slice(&self.normal),
            cast_slice(&self.ground.boxes),
            cast_slice(&self.ground.state_f32),
            cast_slice(&self.ground.state_u32),
        ];
        let groups = groups(&shader::HITS, self.ground.envs);
        checked::run(&shader::HITS, groups, &buffers, &self.params).of(4)
    }

    /// How deep each of the three positions lies in an obstacle.
    fn depths(&self, env: usize) -> [f64; 3] {
        let (stance, obstacles) = (self.ground.stance(env), self.ground.obstacles(env));
        [0, 4, 8].map(|x| {
            let [left, ahead] = [x, x + 1].map(|i| {
                let [action, scale, mean] = [
                    self.action[env * TRAJECTORY_DIM + i],
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
        let twin = self.twin();
        let (launched, checked) = (self.launch(), self.checked());
        for (form, got) in [
            ("twin", &twin),
            ("launched", &launched),
            ("checked", &checked),
        ] {
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
        twin[written].to_vec()
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
