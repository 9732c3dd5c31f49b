//! What a low level is given under a high level, and what a decision is made of.
//! Oracles: the twins; the definitions by hand.

use crate::inputs::{Draw, POISON, SIZES, close, same};
use footwork::kernels::learn::{keep_first_end, low_level_input, sum_decision};
use footwork::kernels::termination::{FAILED, RUNNING, SUCCESS, TRUNCATED};

const OBSERVATION: usize = 11;
const STYLE: usize = 7;
const LATENT: usize = 5;
/// Where the arrays of a decision begin.
const AT: usize = 3;

#[test]
fn inputs_are_the_body_and_a_unit_latent() {
    for rows in SIZES {
        let mut draw = Draw::new(rows as u32);
        let observation = draw.normals(rows * OBSERVATION);
        let mut action = draw.normals(AT + rows * LATENT);
        action[AT..][..LATENT].fill(0.0);
        let params = low_level_input::Params {
            rows: rows as u32,
            observation: OBSERVATION as u32,
            at: AT as u32,
        };
        let widths = [STYLE as u32, LATENT as u32];
        let forms = forms!(
            low_level_input, LOW_LEVEL_INPUT, rows, params;
            observation, action, widths, out rows * (STYLE + LATENT)
        );
        for (form, input) in forms.shaders() {
            close(form, input, &forms.twin, |_| 1e-6);
        }
        for (row, input) in forms.twin.chunks_exact(STYLE + LATENT).enumerate() {
            let (body, latent) = input.split_at(STYLE);
            assert_eq!(body, &observation[row * OBSERVATION..][..STYLE]);
            let within = action[AT + row * LATENT..][..LATENT].iter();
            let within: Vec<f32> = within.map(|x| x.clamp(-1.0, 1.0)).collect();
            let norm = within.iter().map(|x| x * x).sum::<f32>().sqrt();
            let wanted: Vec<f32> = match row {
                0 => vec![1.0, 0.0, 0.0, 0.0, 0.0],
                _ => within.iter().map(|x| x / norm).collect(),
            };
            close("latent", latent, &wanted, |_| 1e-6);
        }
    }
}

/// Steps of three low-level steps, of which some end an episode, some in two of them.
#[test]
fn decisions_are_sums_up_to_the_first_end() {
    for rows in SIZES {
        let mut draw = Draw::new(7 + rows as u32);
        let kinds = [RUNNING, RUNNING, RUNNING, SUCCESS, TRUNCATED, FAILED];
        let mut decision = (
            vec![POISON; AT + rows],
            vec![POISON; AT + rows],
            vec![u32::MAX; AT + rows],
            vec![u32::MAX; AT + rows],
        );
        let mut finals = vec![POISON; AT + rows * OBSERVATION];
        let mut by_hand = vec![ByHand::default(); rows];
        for step in 0..3 {
            let (reward, style) = (draw.normals(rows), draw.normals(rows));
            let ends: Vec<u32> = (0..rows).map(|_| kinds[draw.below(6)]).collect();
            let group: Vec<u32> = (0..rows).map(|_| draw.below(3) as u32).collect();
            let last = draw.normals(rows * OBSERVATION);
            let params = keep_first_end::Params {
                rows: rows as u32,
                observation: OBSERVATION as u32,
                at: AT as u32,
                final_at: AT as u32,
                step,
            };
            let size = [rows.div_ceil(64) as u32, OBSERVATION as u32, 1];
            let forms = forms!(
                keep_first_end, KEEP_FIRST_END, size, params;
                ends, decision.2, last, mut finals
            );
            for (form, kept) in forms.shaders() {
                same(form, kept, &forms.twin);
            }
            finals = forms.twin;
            let params = sum_decision::Params {
                rows: rows as u32,
                at: AT as u32,
                step,
                reward_share: 0.2,
            };
            let forms = forms!(
                sum_decision, SUM_DECISION, rows, params;
                reward, style, ends, group,
                mut decision.0, mut decision.1, mut decision.2, mut decision.3
            );
            for (form, (rewards, styles, ends, groups)) in forms.shaders() {
                close(form, rewards, &forms.twin.0, |_| 1e-6);
                close(form, styles, &forms.twin.1, |_| 1e-6);
                assert_eq!((ends, groups), (&forms.twin.2, &forms.twin.3), "{form}");
            }
            decision = forms.twin;
            for (row, hand) in by_hand.iter_mut().enumerate() {
                if hand.end == RUNNING {
                    hand.rewards.push(reward[row]);
                    hand.styles.push(style[row]);
                    (hand.end, hand.group) = (ends[row], group[row]);
                    hand.last = last[row * OBSERVATION..][..OBSERVATION].to_vec();
                }
            }
        }
        for (row, hand) in by_hand.iter().enumerate() {
            let at = AT + row;
            let mean = hand.styles.iter().sum::<f32>() / hand.styles.len() as f32;
            assert!((decision.0[at] - 0.2 * hand.rewards.iter().sum::<f32>()).abs() < 1e-6);
            assert!((decision.1[at] - mean).abs() < 1e-5);
            assert_eq!((decision.2[at], decision.3[at]), (hand.end, hand.group));
            let kept = &finals[AT + row * OBSERVATION..][..OBSERVATION];
            match hand.end {
                RUNNING => assert_eq!(kept, [POISON; OBSERVATION]),
                _ => assert_eq!(kept, hand.last),
            }
        }
        assert_eq!(decision.0[..AT], [POISON; AT]);
    }
}

/// A decision of one row.
#[derive(Clone, Default)]
struct ByHand {
    rewards: Vec<f32>,
    styles: Vec<f32>,
    end: u32,
    group: u32,
    last: Vec<f32>,
}
