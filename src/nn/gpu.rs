//! Networks of dense layers on a GPU, by launches of our own: [`forward`] for all layers at once, and
//! [`minibatch_step`] for gradient steps, six for a minibatch.

pub mod forward;
pub mod minibatch_step;

use super::layer::Bend;
use super::network::Shape;
use crate::kernels::locomotion::locomotion_layout::BASE_OBS_DIM;
use crate::kernels::learn::network::{BLOCK, Head, Place, Plan, SUMS};
use crate::motion::features::TRAJECTORY_DIM;

/// Blocks of a piece. Where that made more than [`PIECES`], pieces grow.
const PIECE: usize = 8;
const PIECES: usize = 64;

/// How the networks and so many samples lie in memory; none if a layer is not dense.
fn plan(shape: &Shape, rows: usize) -> Option<Plan> {
    if shape.actor.sees {
        return None;
    }
    let (mut places, mut below, mut column) = (Vec::new(), [0, BASE_OBS_DIM], 2 * BASE_OBS_DIM);
    for (actor, critic) in shape.actor.hidden.iter().zip(&shape.critic.hidden) {
        for (below, place) in below.iter_mut().zip([actor, critic]) {
            places.push(Place {
                inputs: place.layer.patch() as u32,
                outputs: place.layer.filters() as u32,
                weights: place.weights().start as u32,
                below: *below as u32,
                above: column as u32,
                bent: u32::from(place.layer.bend() == Bend::Tanh),
            });
            *below = column;
            column += place.layer.filters();
        }
    }
    let judged = TRAJECTORY_DIM + SUMS;
    places.push(Place {
        inputs: 0,
        outputs: judged as u32,
        weights: shape.log_std as u32,
        below: 0,
        above: column as u32,
        bent: 0,
    });
    let blocks = rows.div_ceil(BLOCK);
    let piece = PIECE * blocks.div_ceil(PIECE * PIECES);
    let head = Head {
        rows: rows as u32,
        pitch: (column + judged) as u32,
        pieces: blocks.div_ceil(piece) as u32,
        piece: piece as u32,
        parameters: shape.parameters() as u32,
        count: places.len() as u32,
    };
    Some(Plan { head, places })
}
