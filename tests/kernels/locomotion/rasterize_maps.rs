//! Oracle: cell centres and boxes in f64, see `geometry`; twin and shader are both judged by it.
//! Bar: none where no arithmetic rounds but that of a cell to its byte; else 1e-5 m.

use crate::inputs::{Draw, SEEDS};
use crate::support::geometry::{Obstacle, depth, right};
use crate::support::ground::{COUNTS, Ground, SQUARE};
use footwork::kernels::locomotion::locomotion_layout::{
    CELLS, FULL, MAP_WORDS, boxes, state_f32, state_u32,
};
use footwork::kernels::locomotion::rasterize_maps::{self, cell};

/// Batch sizes around the workgroup's 64 rows of a map.
const SIZES: [usize; 6] = [1, 3, 4, 5, 64, 65];

struct Case {
    ground: Ground,
    /// What was seen before, and five numbers past the end.
    maps: Vec<u32>,
    params: rasterize_maps::Params,
}

/// What maps are like: `edge` (m) and `back` (s). In exact worlds obstacles move by whole grains in a
/// 32nd of a second.
const KINDS: [[f32; 2]; 5] = [
    [0.0, 0.0],
    [0.375, 0.0],
    [0.0, 0.03125],
    [0.75, 0.03125],
    [3.0, 0.5],
];

impl Case {
    fn new(ground: Ground, just_reset: bool, [edge, back]: [f32; 2]) -> Self {
        let mut draw = Draw::new(1);
        let mut case = Case {
            maps: (0..ground.envs * MAP_WORDS)
                .map(|_| draw.bits()[0])
                .collect(),
            params: rasterize_maps::Params {
                envs: ground.envs as u32,
                count: ground.count as u32,
                just_reset: just_reset.into(),
                square: SQUARE,
                edge,
                back,
            },
            ground,
        };
        for env in (0..case.ground.envs).filter(|env| env % 3 == 0) {
            case.ground.state_u32[state_u32::EPISODE_STEP * case.ground.envs + env] = 0;
        }
        case
    }

    fn agrees(&self) -> Vec<u32> {
        let ground = &self.ground;
        let forms = forms!(
            rasterize_maps, RASTERIZE_MAPS, ground.envs * CELLS, self.params;
            ground.boxes, ground.obstacle_velocity, ground.state_f32, ground.state_u32, mut self.maps
        );
        for (form, got) in forms.all() {
            self.judge(form, got);
        }
        forms.twin
    }

    fn judge(&self, form: &str, got: &[u32]) {
        let (before, after) = (self.maps.chunks(MAP_WORDS), got.chunks(MAP_WORDS));
        for (env, (before, after)) in before.zip(after).enumerate() {
            let written = env < self.ground.envs
                && self.ground.just_reset(env) == (self.params.just_reset == 1);
            if !written {
                assert_eq!(before, after, "{form}: environment {env}");
                continue;
            }
            let obstacles = self.ground.obstacles(env);
            self.judge_map(form, env, (after, 0), &obstacles);
            if self.params.back > 0.0 {
                let back = |obstacle: Obstacle| Obstacle {
                    velocity: obstacle.velocity.map(|v| -v),
                    ..obstacle
                };
                let (time, side) = (f64::from(self.params.back), f64::from(SQUARE));
                let moved = obstacles.into_iter().map(|o| back(o).moved(time, side));
                self.judge_map(form, env, (after, 1), &moved.collect::<Vec<_>>());
                continue;
            }
            let half = MAP_WORDS / 2;
            let shown = if self.params.just_reset == 1 {
                after
            } else {
                before
            };
            assert_eq!(after[half..], shown[..half], "{form}: environment {env}");
        }
    }

    fn judge_map(
        &self,
        form: &str,
        env: usize,
        (maps, map): (&[u32], usize),
        obstacles: &[Obstacle],
    ) {
        let (stance, edge) = (self.ground.stance(env), f64::from(self.params.edge));
        for row in 0..CELLS {
            for column in 0..CELLS {
                let depth = depth(obstacles, stance.cell(row, column));
                let found = cell(maps, map, row, column);
                let bar = self.ground.bar();
                let well = if edge == 0.0 {
                    (found == 0 || found == FULL) && right(found == FULL, depth, bar)
                } else {
                    let share = (0.5 + depth / edge).clamp(0.0, 1.0);
                    let off = (f64::from(found) / 255.0 - share).abs();
                    off <= 0.5001 / 255.0 + bar / edge
                };
                assert!(
                    well,
                    "{form}: environment {env}, map {map}, cell {row} {column}: {found}, {depth:e} m"
                );
            }
        }
    }
}

#[test]
fn agrees_with_geometry_in_all_worlds() {
    for exact in [true, false] {
        for count in COUNTS {
            for envs in SIZES {
                let ground = || Ground::new(envs, count, envs as u32, exact);
                for kind in KINDS {
                    Case::new(ground(), false, kind).agrees();
                    Case::new(ground(), true, kind).agrees();
                }
            }
        }
    }
}

#[test]
fn agrees_for_every_seed() {
    for seed in SEEDS {
        for exact in [true, false] {
            for kind in KINDS {
                Case::new(Ground::new(40, 100, seed, exact), false, kind).agrees();
            }
        }
    }
}

/// A character at the origin and a single box.
fn alone(centre: [f32; 2], half: [f32; 2], heading: [f32; 2]) -> Case {
    let mut ground = Ground::new(1, 1, 1, true);
    ground.state_u32[state_u32::EPISODE_STEP] = 0;
    for (field, value) in [(state_f32::X, 0.0), (state_f32::Z, 0.0)] {
        ground.state_f32[field] = value;
    }
    (
        ground.state_f32[state_f32::HEADING_X],
        ground.state_f32[state_f32::HEADING_Z],
    ) = (heading[0], heading[1]);
    (ground.boxes[boxes::X], ground.boxes[boxes::Z]) = (centre[0], centre[1]);
    (ground.boxes[boxes::HALF_X], ground.boxes[boxes::HALF_Z]) = (half[0], half[1]);
    Case::new(ground, true, [0.0; 2])
}

/// Rows that hold something, with a bit for every full cell.
fn seen(case: &Case) -> Vec<(usize, u32)> {
    let maps = case.agrees();
    let rows = (0..CELLS).map(|row| {
        let bit = |column: usize| u32::from(cell(&maps, 0, row, column) == FULL) << column;
        (row, (0..CELLS).map(bit).sum())
    });
    rows.filter(|&(_, bits)| bits != 0).collect()
}

#[test]
fn columns_run_to_the_left_and_rows_ahead() {
    let (near, point) = (0.1875, [0.0; 2]);
    // Facing +z, left is +x; facing +x, left is -z.
    for (heading, left, ahead) in [
        ([0.0, 1.0], [1.0, 0.0], [0.0, 1.0]),
        ([1.0, 0.0], [0.0, -1.0], [1.0, 0.0]),
    ] {
        let place = |l: f32, a: f32| [0, 1].map(|i| l * left[i] + a * ahead[i]);
        let corner = 7.5 * 0.375;
        for (at, row, column) in [
            (place(near, near), 8, 8),
            (place(-near, near), 8, 7),
            (place(near, -near), 7, 8),
            (place(corner, corner), 15, 15),
            (place(-corner, corner), 15, 0),
            (place(corner, -corner), 0, 15),
        ] {
            assert_eq!(seen(&alone(at, point, heading)), [(row, 1 << column)]);
        }
    }
}

#[test]
fn a_box_covers_its_edges_and_nothing_beyond() {
    let half = [0.1875, 0.375];
    let north = [0.0, 1.0];
    // From column centre to column centre, from row centre past the next.
    let covered = seen(&alone([0.0, 0.1875], half, north));
    assert_eq!(covered, [(7, 0b11 << 7), (8, 0b11 << 7), (9, 0b11 << 7)]);
    let thinner = half.map(f32::next_down);
    assert_eq!(seen(&alone([0.0, 0.1875], thinner, north)), []);
    // Boxes far larger and farther than the map.
    let all: Vec<(usize, u32)> = (0..CELLS).map(|row| (row, 0xffff)).collect();
    assert_eq!(seen(&alone([1000.0, -500.0], [2000.0; 2], north)), all);
    assert_eq!(seen(&alone([1000.0, 0.0], [990.0; 2], north)), []);
    assert_eq!(seen(&alone([1e6, 0.0], [1e30; 2], north)), all);
}

/// Lavapipe silently stops after 65,535 loop iterations.
#[test]
fn the_last_of_ten_thousand_boxes_is_seen() {
    let mut ground = Ground::crowded(3, 10_000);
    ground.state_u32[state_u32::EPISODE_STEP * 3..][..3].fill(0);
    assert_eq!(seen(&Case::new(ground, true, [0.0; 2]))[4], (8, 0xff << 4));
}

#[test]
fn a_soft_edge_tells_where_in_a_cell_it_lies() {
    let soft = |half: f32| {
        let mut case = alone([0.0, 0.1875], [half, 0.1], [0.0, 1.0]);
        case.params.edge = 0.375;
        cell(&case.agrees(), 0, 8, 8)
    };
    // The cell's centre is 0.1875 m from the box's middle.
    assert_eq!(soft(0.1875), 128);
    assert_eq!(soft(0.1875 - 0.2), 0);
    assert!(soft(0.2) > 128 && soft(0.17) < 128);
}
