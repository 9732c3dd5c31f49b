//! Oracle: `observe::twin`.
//! Bar: the pose is a copy; the goal, two products a number, within 4 roundings of the larger.

use crate::inputs::{Draw, POISON, SEEDS, SIZES, close, same, within_terms};
use footwork::kernels::locomotion::locomotion_layout::{
    BASE_OBS_DIM, CELLS, MAP_OBS_DIM, MAP_WORDS, MAPS, TARGET_SCALE, state_f32,
};
use footwork::kernels::locomotion::observe;
use footwork::kernels::locomotion::rasterize_maps::cell;
use footwork::kernels::termination;
use footwork::motion::features::{POSE_DIM, ROW_STRIDE};

const FRAMES: usize = 500;

struct Case {
    features: Vec<[f32; ROW_STRIDE]>,
    state_f32: Vec<f32>,
    state_u32: Vec<u32>,
    termination: Vec<u32>,
    maps: Vec<u32>,
    params: observe::Params,
}

impl Case {
    fn random(envs: usize, seed: u32, only: u32) -> Self {
        let mut draw = Draw::new(seed);
        let (state_f32, state_u32) = draw.state(envs, FRAMES);
        let offset = draw.below(3) * envs;
        Case {
            features: draw.rows(FRAMES, 0.0),
            state_f32,
            state_u32,
            termination: (0..offset + envs).map(|_| draw.below(4) as u32).collect(),
            maps: vec![0],
            params: observe::Params {
                envs: envs as u32,
                offset: offset as u32,
                only,
                rows: 1,
                width: BASE_OBS_DIM as u32,
                to: 0,
            },
        }
    }

    /// The same with maps, written from row `to` on.
    fn mapped(mut self, to: usize) -> Self {
        let mut draw = Draw::new(5);
        let words = self.envs() * MAP_WORDS;
        self.maps = (0..words).map(|_| draw.bits()[0]).collect();
        self.params.rows = CELLS as u32;
        self.params.width = (BASE_OBS_DIM + MAP_OBS_DIM) as u32;
        self.params.to = to as u32;
        self
    }

    fn width(&self) -> usize {
        self.params.width as usize
    }

    /// The environment whose observation a row is.
    fn env(&self, row: usize) -> Option<usize> {
        let env = row.checked_sub(self.params.to as usize);
        env.filter(|&env| env < self.envs())
    }

    fn envs(&self) -> usize {
        self.params.envs as usize
    }

    /// The larger of a goal's products.
    fn largest(&self, env: usize) -> f32 {
        let at = |field: usize| self.state_f32[field * self.envs() + env];
        let away = (at(state_f32::TARGET_X) - at(state_f32::X)).abs();
        let away = away.max((at(state_f32::TARGET_Z) - at(state_f32::Z)).abs());
        away * at(state_f32::HEADING_X)
            .abs()
            .max(at(state_f32::HEADING_Z).abs())
            * TARGET_SCALE
    }

    fn agrees(&self) -> Vec<f32> {
        let invocations = self.envs() * self.params.rows as usize;
        // One row too many: it must stay untouched.
        let numbers = (self.params.to as usize + self.envs() + 1) * self.width();
        let forms = forms!(
            observe, OBSERVE, invocations, self.params;
            self.features, self.state_f32, self.state_u32, self.termination, self.maps, out numbers
        );
        for (form, got) in forms.shaders() {
            let rows = got
                .chunks(self.width())
                .zip(forms.twin.chunks(self.width()));
            for (row, (got, want)) in rows.enumerate() {
                same(form, &got[..POSE_DIM], &want[..POSE_DIM]);
                close(
                    form,
                    &got[POSE_DIM..BASE_OBS_DIM],
                    &want[POSE_DIM..BASE_OBS_DIM],
                    |_| {
                        self.env(row)
                            .map_or(0.0, |env| within_terms(&[self.largest(env)]))
                    },
                );
                same(form, &got[BASE_OBS_DIM..], &want[BASE_OBS_DIM..]);
            }
        }
        forms.twin
    }
}

#[test]
fn agrees_with_its_twin_on_random_states() {
    for seed in SEEDS {
        for envs in SIZES {
            let seen = Case::random(envs, seed, termination::ANY).agrees();
            assert!(seen[..envs * BASE_OBS_DIM].iter().all(|&o| o != POISON));
            assert!(seen[envs * BASE_OBS_DIM..].iter().all(|&o| o == POISON));
        }
    }
}

#[test]
fn writes_only_the_rows_that_ended_as_asked() {
    for only in [termination::SUCCESS, termination::TRUNCATED] {
        let case = Case::random(130, 1, 1 << only);
        let seen = case.agrees();
        for (row, &termination) in seen
            .chunks(BASE_OBS_DIM)
            .zip(&case.termination[case.params.offset as usize..])
        {
            assert_eq!(row[0] != POISON, termination == only);
        }
    }
    let mut case = Case::random(65, 1, 1 << termination::TRUNCATED);
    case.termination.fill(termination::SUCCESS);
    assert!(case.agrees().iter().all(|&o| o == POISON));
    case.termination.fill(termination::TRUNCATED);
    assert!(
        case.agrees()[..65 * BASE_OBS_DIM]
            .iter()
            .all(|&o| o != POISON)
    );
}

#[test]
fn survives_degenerate_headings_and_targets() {
    let mut case = Case::random(65, 2, termination::ANY);
    let odd = [0.0, -0.0, 1e-30, 1e30, f32::INFINITY, f32::NAN];
    for (env, value) in odd.into_iter().enumerate() {
        case.state_f32[state_f32::HEADING_X * 65 + env] = value;
        case.state_f32[state_f32::TARGET_Z * 65 + 64 - env] = value;
    }
    case.agrees();
}

#[test]
fn maps_stand_after_the_goal_with_channels_last() {
    for envs in [1, 3, 4, 5, 64, 65] {
        for to in [0, envs, 7] {
            let case = Case::random(envs, 3, termination::ANY).mapped(to);
            let seen = case.agrees();
            for (row, seen) in seen.chunks(case.width()).enumerate() {
                let Some(env) = case.env(row) else {
                    assert!(seen.iter().all(|&o| o == POISON), "row {row}");
                    continue;
                };
                let maps = &case.maps[env * MAP_WORDS..][..MAP_WORDS];
                for (at, &seen) in seen[BASE_OBS_DIM..].iter().enumerate() {
                    let (place, map) = (at / MAPS, at % MAPS);
                    let byte = cell(maps, map, place / CELLS, place % CELLS);
                    assert_eq!(seen, f32::from(byte) / 255.0);
                }
            }
        }
    }
}

#[test]
fn only_whole_rows_that_ended_as_asked_are_written() {
    for ends in 0..16 {
        let case = Case::random(65, 4, ends).mapped(65);
        let seen = case.agrees();
        for (row, seen) in seen.chunks(case.width()).enumerate() {
            let termination = |env: usize| case.termination[case.params.offset as usize + env];
            let written = case
                .env(row)
                .is_some_and(|env| ends & 1 << termination(env) != 0);
            assert!(seen.iter().all(|&o| (o != POISON) == written), "row {row}");
        }
    }
}
