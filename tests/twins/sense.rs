//! Oracle: cell centres and boxes in f64, see `geometry`; twin and shader are both judged by it.
//! Bar: none where no arithmetic rounds; else 1e-5 m from an edge.

use crate::checked;
use crate::geometry::{depth, right};
use crate::ground::{COUNTS, Ground};
use crate::inputs::{Draw, SEEDS, gpu};
use bytemuck::cast_slice;
use footwork::gpu::kernel::groups;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::layout::{CELLS, MAPS, boxes, real, whole};
use footwork::kernels::sense;

/// Batch sizes around the workgroup's 64 rows of a map.
const SIZES: [usize; 6] = [1, 3, 4, 5, 64, 65];

struct Case {
    ground: Ground,
    /// What was seen before, and five numbers past the end.
    maps: Vec<u32>,
    params: sense::Params,
}

impl Case {
    fn new(ground: Ground, begun: bool) -> Self {
        let mut draw = Draw::new(1);
        let mut case = Case {
            maps: (0..ground.envs * MAPS * CELLS + 5)
                .map(|_| draw.bits()[0])
                .collect(),
            params: sense::Params {
                envs: ground.envs as u32,
                count: ground.count as u32,
                begun: begun.into(),
            },
            ground,
        };
        for env in (0..case.ground.envs).filter(|env| env % 3 == 0) {
            case.ground.whole[whole::AGE * case.ground.envs + env] = 0;
        }
        case
    }

    fn twin(&self) -> Vec<u32> {
        let mut maps = self.maps.clone();
        let ground = &self.ground;
        sense::twin(
            ground.own_boxes(),
            &ground.real,
            &ground.whole,
            &mut maps,
            &self.params,
        );
        maps
    }

    fn launch(&self) -> Vec<u32> {
        let gpu = gpu();
        let maps = Buffer::from_slice(&gpu, &self.maps);
        sense::launch(
            &gpu,
            &Buffer::from_slice(&gpu, &self.ground.boxes),
            &Buffer::from_slice(&gpu, &self.ground.real),
            &Buffer::from_slice(&gpu, &self.ground.whole),
            &maps,
            &self.params,
        );
        maps.read(&gpu).expect("maps")
    }

    fn checked(&self) -> Vec<u32> {
        let buffers: [&[u8]; 4] = [
            cast_slice(&self.ground.boxes),
            cast_slice(&self.ground.real),
            cast_slice(&self.ground.whole),
            cast_slice(&self.maps),
        ];
        let groups = groups(&shader::SENSE, self.ground.envs * CELLS);
        checked::run(&shader::SENSE, groups, &buffers, &self.params).of(3)
    }

    fn agrees(&self) -> Vec<u32> {
        let twin = self.twin();
        let (launched, checked) = (self.launch(), self.checked());
        for (form, got) in [
            ("twin", &twin),
            ("launched", &launched),
            ("checked", &checked),
        ] {
            self.judge(form, got);
        }
        twin
    }

    fn judge(&self, form: &str, got: &[u32]) {
        let (before, after) = (self.maps.chunks(MAPS * CELLS), got.chunks(MAPS * CELLS));
        for (env, (before, after)) in before.zip(after).enumerate() {
            let written =
                env < self.ground.envs && self.ground.begun(env) == (self.params.begun == 1);
            if !written {
                assert_eq!(before, after, "{form}: environment {env}");
                continue;
            }
            let (now, previous) = after.split_at(CELLS);
            let shown = if self.params.begun == 1 {
                now
            } else {
                &before[..CELLS]
            };
            assert_eq!(previous, shown, "{form}: environment {env}");
            self.judge_map(form, env, now);
        }
    }

    fn judge_map(&self, form: &str, env: usize, map: &[u32]) {
        let (stance, obstacles) = (self.ground.stance(env), self.ground.obstacles(env));
        for (row, bits) in map.iter().enumerate() {
            assert_eq!(bits >> CELLS, 0, "{form}: more than a row of cells");
            for column in 0..CELLS {
                let depth = depth(&obstacles, stance.cell(row, column));
                let found = bits >> column & 1 == 1;
                assert!(
                    right(found, depth, self.ground.bar()),
                    "{form}: environment {env}, cell {row} {column}: {depth:e} m"
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
                Case::new(ground(), false).agrees();
                Case::new(ground(), true).agrees();
            }
        }
    }
}

#[test]
fn agrees_for_every_seed() {
    for seed in SEEDS {
        for exact in [true, false] {
            Case::new(Ground::new(40, 100, seed, exact), false).agrees();
        }
    }
}

/// A character at the origin and a single box.
fn alone(centre: [f32; 2], half: [f32; 2], heading: [f32; 2]) -> Case {
    let mut ground = Ground::new(1, 1, 1, true);
    ground.whole[whole::AGE] = 0;
    for (field, value) in [(real::X, 0.0), (real::Z, 0.0)] {
        ground.real[field] = value;
    }
    (ground.real[real::HEADING_X], ground.real[real::HEADING_Z]) = (heading[0], heading[1]);
    (ground.boxes[boxes::X], ground.boxes[boxes::Z]) = (centre[0], centre[1]);
    (ground.boxes[boxes::HALF_X], ground.boxes[boxes::HALF_Z]) = (half[0], half[1]);
    Case::new(ground, true)
}

/// Bits of the cells that hold something.
fn seen(case: &Case) -> Vec<(usize, u32)> {
    let maps = case.agrees();
    let rows = maps[..CELLS].iter().copied().enumerate();
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
    ground.whole[whole::AGE * 3..][..3].fill(0);
    let maps = Case::new(ground, true).agrees();
    assert_eq!(maps[8], 0xff << 4);
}
