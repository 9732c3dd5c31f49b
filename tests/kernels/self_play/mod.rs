//! Bouts between a learner and its opponents.
//! Oracles: the twins; the definitions by hand. Bar: equal bit for bit, but for what an exponential rounds.

use crate::inputs::{Draw, POISON, POISON_WHOLE, SIZES, close, same};
use footwork::kernels::learn::sample_action;
use footwork::kernels::self_play::group_bouts::{MAX_POLICIES, blocks};
use footwork::kernels::self_play::scripted_actions::nearest;
use footwork::kernels::self_play::{
    NOBODY, OpponentTable, SCRIPTED, bout_actions, end_bouts, group_bouts, opponent_input,
    scripted_actions,
};
use footwork::kernels::termination::{FAILED, RUNNING, SUCCESS, TRUNCATED};

const OBSERVATION: usize = 11;
const ACTION: usize = 6;
const STATS: usize = 5;
const SUCCESSES: usize = 1;
/// Rows of a block on a GPU and on the CPU.
const BLOCK_SIZES: [usize; 2] = [8, 1];

/// Bouts of so many environments against scripts and policies, of whom some have left.
struct Case {
    draw: Draw,
    table: OpponentTable,
    own: Vec<u32>,
    opponent: Vec<u32>,
}

impl Case {
    fn new(envs: usize, scripted: usize, policies: usize) -> Case {
        let mut draw = Draw::new((envs + 7 * policies) as u32);
        let count = scripted + policies;
        // The numbers of policies begin later than those of scripts end: some have left.
        let number = |index: usize| (index + if index < scripted { 0 } else { 3 }) as u32;
        let mut lots: Vec<u32> = (0..count).map(|_| draw.bits()[0] >> 8).collect();
        lots.sort_unstable();
        Case {
            own: (0..envs)
                .map(|env| (2 * env + draw.below(2)) as u32)
                .collect(),
            opponent: (0..envs).map(|_| draw.below(count + 3) as u32).collect(),
            table: OpponentTable {
                envs,
                stats: STATS,
                scripted,
                numbers: (0..count).map(number).collect(),
                lots,
            },
            draw,
        }
    }

    fn all() -> impl Iterator<Item = Case> {
        let of = |envs: usize| {
            let pools = [(1, 0), (0, 1), (3, 4), (2, MAX_POLICIES)];
            pools.map(|(scripted, policies)| Case::new(envs, scripted, policies))
        };
        SIZES.into_iter().flat_map(of)
    }

    /// Where opponents have their places: `place`, `slots` and `blocks`.
    fn grouped(&self, block: usize) -> [Vec<u32>; 3] {
        let blocks = blocks(self.table.envs, self.table.policies(), block);
        let [mut place, mut slots, mut of] =
            [self.table.envs, blocks * block, blocks].map(|len| vec![0; len]);
        let params = group_bouts::Params {
            block: block as u32,
            blocks: blocks as u32,
        };
        group_bouts::twin(
            &self.table,
            &self.opponent,
            &mut place,
            &mut slots,
            &mut of,
            &params,
        );
        [place, slots, of]
    }
}

#[test]
fn policies_have_blocks_of_their_own() {
    for case in Case::all() {
        for block in BLOCK_SIZES {
            let (table, envs) = (&case.table, case.table.envs);
            let blocks = blocks(envs, table.policies(), block);
            let params = group_bouts::Params {
                block: block as u32,
                blocks: blocks as u32,
            };
            let forms = forms!(
                group_bouts, GROUP_BOUTS, [1; 3], params;
                table => table.words(), case.opponent, mut vec![0u32; envs],
                mut vec![0u32; blocks * block], mut vec![0u32; blocks]
            );
            for (form, got) in forms.shaders() {
                assert_eq!(got, &forms.twin, "{form}");
            }
            let (place, slots, of) = &forms.twin;
            for (env, &place) in place.iter().enumerate() {
                let index = table.index(case.opponent[env]);
                if index < table.scripted {
                    assert_eq!(place, SCRIPTED + index as u32);
                } else {
                    assert_eq!(slots[place as usize], env as u32);
                    let policy = of[place as usize / block] as usize;
                    assert_eq!(policy, index - table.scripted);
                }
            }
            let taken = slots.iter().filter(|&&env| env != NOBODY).count();
            let policies = place.iter().filter(|&&place| place < SCRIPTED).count();
            assert_eq!(taken, policies);
        }
    }
}

/// Who has left is stood in for by the newest.
#[test]
fn opponents_are_found_by_their_numbers() {
    let table = Case::new(1, 2, 3).table;
    assert_eq!(table.numbers, [0, 1, 5, 6, 7]);
    assert_eq!(
        [0, 1, 2, 4, 6, 7, 9].map(|number| table.index(number)),
        [0, 1, 4, 4, 3, 4, 4]
    );
}

#[test]
fn opponents_observe_their_rows_normalised() {
    for mut case in Case::all() {
        for block in BLOCK_SIZES {
            let [_, slots, of] = case.grouped(block);
            let observation = case.draw.normals(2 * case.table.envs * OBSERVATION);
            let scale = case
                .draw
                .normals(2 * case.table.policies().max(1) * OBSERVATION);
            let params = opponent_input::Params {
                slots: slots.len() as u32,
                observation: OBSERVATION as u32,
                block: block as u32,
                clip: 1.5,
            };
            let workgroups = [OBSERVATION.div_ceil(4), slots.len().div_ceil(64), 1];
            let forms = forms!(
                opponent_input, OPPONENT_INPUT, workgroups.map(|n| n as u32), params;
                slots, of, case.own, observation, scale, out slots.len() * OBSERVATION
            );
            for (form, input) in forms.shaders() {
                close(form, input, &forms.twin, |_| 1e-6);
            }
            for (slot, input) in forms.twin.chunks_exact(OBSERVATION).enumerate() {
                if slots[slot] == NOBODY {
                    assert_eq!(input, [POISON; OBSERVATION]);
                    continue;
                }
                let row = (case.own[slots[slot] as usize] ^ 1) as usize;
                let scale = &scale[2 * OBSERVATION * of[slot / block] as usize..];
                for (at, &got) in input.iter().enumerate() {
                    let away = observation[row * OBSERVATION + at] - scale[at];
                    let wanted = (away * scale[OBSERVATION + at]).clamp(-1.5, 1.5);
                    assert_eq!(got.to_bits(), wanted.to_bits());
                }
            }
        }
    }
}

/// What a policy draws is what `sample_action` draws in the row of that number.
#[test]
fn policies_act_beside_the_learner() {
    const AT: usize = 3;
    const LOG_STD: usize = 4;
    const PARAMETERS: usize = LOG_STD + ACTION;
    for mut case in Case::all() {
        let (envs, policies) = (case.table.envs, case.table.policies().max(1));
        let [place, slots, of] = case.grouped(8);
        let learner = case.draw.normals(AT + envs * ACTION);
        let mean = case.draw.normals(slots.len() * ACTION);
        let parameters = case.draw.normals(policies * PARAMETERS);
        let params = bout_actions::Params {
            envs: envs as u32,
            action: ACTION as u32,
            at: AT as u32,
            block: 8,
            parameters: PARAMETERS as u32,
            log_std: LOG_STD as u32,
            first: 17,
            seed: 5,
            step_counter: 9,
        };
        let workgroups = [ACTION.div_ceil(4), envs.div_ceil(64), 1].map(|n| n as u32);
        let forms = forms!(
            bout_actions, BOUT_ACTIONS, workgroups, params;
            case.own, place, of, learner, mean, parameters, out 2 * envs * ACTION
        );
        for (form, action) in forms.shaders() {
            close(form, action, &forms.twin, |at| {
                1e-5 * (1.0 + forms.twin[at].abs())
            });
        }
        let row = |row: u32| &forms.twin[row as usize * ACTION..][..ACTION];
        for env in 0..envs {
            same(
                "learner",
                row(case.own[env]),
                &learner[AT + env * ACTION..][..ACTION],
            );
            let theirs = row(case.own[env] ^ 1);
            if place[env] >= SCRIPTED {
                assert_eq!(theirs, [POISON; ACTION]);
                continue;
            }
            let (slot, policy) = (place[env] as usize, of[place[env] as usize / 8] as usize);
            let (mut action, mut log_prob) = ([0.0; ACTION], [0.0]);
            sample_action::twin(
                &mean[slot * ACTION..][..ACTION],
                &parameters[policy * PARAMETERS + LOG_STD..][..ACTION],
                &mut action,
                &mut log_prob,
                &sample_action::Params {
                    rows: 1,
                    action: ACTION as u32,
                    row: 0,
                    first: 17 + env as u32,
                    seed: 5,
                    step_counter: 9,
                },
            );
            same("opponent", theirs, &action);
        }
    }
}

#[test]
fn scripts_choose_strides() {
    // Of the three scripts one looks nowhere.
    let scripts = [[3, 0, 5], [0, 5, 1], [7, 6, 3]];
    let words: Vec<u32> = [ACTION as u32, OBSERVATION as u32]
        .into_iter()
        .chain(scripts.as_flattened().iter().copied())
        .collect();
    for mut case in Case::all().filter(|case| case.table.scripted <= scripts.len()) {
        let envs = case.table.envs;
        let [place, ..] = case.grouped(8);
        let strides = case.draw.normals(9 * (2 + ACTION));
        let observation = case.draw.normals(2 * envs * OBSERVATION);
        let params = scripted_actions::Params { envs: envs as u32 };
        let forms = forms!(
            scripted_actions, SCRIPTED_ACTIONS, envs, params;
            case.own, place, words, strides, observation, out 2 * envs * ACTION
        );
        for (form, action) in forms.shaders() {
            same(form, action, &forms.twin);
        }
        for env in 0..envs {
            let theirs = &forms.twin[(case.own[env] ^ 1) as usize * ACTION..][..ACTION];
            let own = &forms.twin[case.own[env] as usize * ACTION..][..ACTION];
            assert_eq!(own, [POISON; ACTION]);
            if place[env] < SCRIPTED {
                assert_eq!(theirs, [POISON; ACTION]);
                continue;
            }
            let [target, first, count] = scripts[(place[env] - SCRIPTED) as usize];
            let seen = &observation[(case.own[env] ^ 1) as usize * OBSERVATION + target as usize..];
            let stride = |index: usize| &strides[(first as usize + index) * (2 + ACTION)..];
            let speeds = (0..count as usize).map(|index| [stride(index)[0], stride(index)[1]]);
            let chosen = nearest(speeds, [seen[0], seen[1]]);
            assert_eq!(theirs, &stride(chosen)[2..][..ACTION]);
        }
    }
}

#[test]
fn ends_are_counted_and_bouts_drawn() {
    for mut case in Case::all() {
        let (envs, count) = (case.table.envs, case.table.numbers.len());
        let ends = [RUNNING, SUCCESS, TRUNCATED, FAILED];
        let termination: Vec<u32> = (0..envs)
            .flat_map(|_| [ends[case.draw.below(4)]; 2])
            .collect();
        let before: Vec<f32> = (0..STATS * 2 * envs)
            .map(|_| case.draw.below(9) as f32)
            .collect();
        let mut now = before.clone();
        // A win, a loss or a draw.
        for env in 0..envs {
            let winner = case.draw.below(3);
            if winner < 2 && termination[2 * env] != RUNNING {
                now[SUCCESSES * 2 * envs + 2 * env + winner] += 1.0;
            }
        }
        now[0] += 2.0;
        let (own, opponent) = (case.own.clone(), case.opponent.clone());
        let params = end_bouts::Params {
            successes: SUCCESSES as u32,
            first: 3,
            seed: 8,
            step_counter: 21,
        };
        let forms = forms!(
            end_bouts, END_BOUTS, envs, params;
            &case.table => case.table.words(), termination, now, before,
            mut own, mut opponent, mut vec![0.5f32; STATS * envs], mut vec![1u32; 2 * count]
        );
        for (form, got) in forms.shaders() {
            assert_eq!(got, &forms.twin, "{form}");
        }
        let (new_own, new_opponent, sums, tallies) = &forms.twin;
        let mut wanted = vec![1; 2 * count];
        for env in 0..envs {
            let row = own[env] as usize;
            let gained = |stat: usize, row: usize| {
                now[stat * 2 * envs + row] - before[stat * 2 * envs + row]
            };
            let over = termination[row] != RUNNING;
            for stat in 0..STATS {
                let gained = if over { gained(stat, row) } else { 0.0 };
                assert_eq!(sums[stat * envs + env], 0.5 + gained);
            }
            if !over {
                assert_eq!((new_own[env], new_opponent[env]), (own[env], opponent[env]));
                continue;
            }
            if let Some(index) = (case.table.numbers.iter()).position(|own| *own == opponent[env]) {
                wanted[2 * index] += 1;
                let won = gained(SUCCESSES, row) - gained(SUCCESSES, row ^ 1);
                wanted[2 * index + 1] += (1.0 + won) as u32;
            }
            let drawn = end_bouts::draw(&case.table, env, &params);
            assert_eq!([new_own[env] - 2 * env as u32, new_opponent[env]], drawn);
        }
        assert_eq!(tallies, &wanted);
        assert!(!tallies.contains(&POISON_WHOLE));
    }
}

/// Of 2^24 draws each opponent has those below its lot and not below the one before.
#[test]
fn opponents_are_drawn_by_their_lots() {
    let table = OpponentTable {
        lots: vec![0, 100, 1 << 24],
        numbers: vec![4, 5, 6],
        ..OpponentTable::default()
    };
    let drawn = [0, 99 << 8, 100 << 8, u32::MAX].map(|bits| table.drawn(bits));
    assert_eq!(drawn, [1, 1, 2, 2]);
}
