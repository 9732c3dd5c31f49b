//! The kernels of learning on a GPU against their twins: what each makes of the same numbers, by its
//! own launch and through plain wgpu. Networks of odd widths, and minibatches that fill neither blocks nor
//! pieces.
//! Bar: a few roundings of the absolute sum of what is added up.

mod adam;
mod backward;
mod forward;
mod gradient;
mod loss;
mod total;

use crate::checked;
use crate::inputs::{Draw, POISON, close, gpu};
use bytemuck::cast_slice;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::locomotion::locomotion_layout::BASE_OBS_DIM;
use footwork::kernels::learn::network::{Head, Place, Plan, SUMS};
use footwork::motion::features::TRAJECTORY_DIM;

/// Numbers of a sample: observation, action, mean, and what PPO needs besides.
const WIDTH: usize = BASE_OBS_DIM + 2 * TRAJECTORY_DIM + 4;

/// Hidden widths, and samples.
const CASES: [(&[usize], usize); 5] = [
    (&[32, 32], 512),
    (&[32, 32], 1),
    (&[33, 7], 75),
    (&[5], 200),
    (&[40, 3, 65], 64),
];

struct Case {
    plan: Plan,
    table: Vec<u32>,
    /// Some more than the minibatch has, before and behind it.
    samples: Vec<f32>,
    start: u32,
    parameters: Vec<f32>,
    rows: Vec<f32>,
    slopes: Vec<f32>,
}

impl Case {
    fn new(hidden: &[usize], rows: usize) -> Case {
        let plan = plan(hidden, rows);
        let mut draw = Draw::new(rows as u32);
        let room = plan.numbers();
        let mut some = |count: usize| -> Vec<f32> {
            let values = draw.normals(count).into_iter();
            values.map(|value| 0.5 * value).collect()
        };
        Case {
            samples: some((rows + 9) * WIDTH),
            start: 6,
            parameters: some(plan.head.parameters as usize),
            // Activations of tanh lie within one.
            rows: some(room).into_iter().map(f32::tanh).collect(),
            slopes: some(room),
            table: plan.words(),
            plan,
        }
    }

    fn all() -> impl Iterator<Item = Case> {
        CASES.iter().map(|(hidden, rows)| Case::new(hidden, *rows))
    }

    fn rows(&self) -> usize {
        self.plan.head.rows as usize
    }

    /// Weights as `[outputs][inputs]`.
    fn turned(&self) -> Vec<f32> {
        let mut turned = self.parameters.clone();
        for (from, to) in self.plan.turned().into_iter().enumerate() {
            turned[to as usize] = self.parameters[from];
        }
        turned
    }
}

/// Both networks of such hidden layers; what the loss adds up.
fn plan(hidden: &[usize], rows: usize) -> Plan {
    let (mut places, mut below, mut inputs) = (Vec::new(), [0, BASE_OBS_DIM], BASE_OBS_DIM);
    let (mut column, mut start) = (2 * BASE_OBS_DIM, 0);
    for layer in 0..=hidden.len() {
        let last = layer == hidden.len();
        let outputs = if last {
            [TRAJECTORY_DIM, 1]
        } else {
            [hidden[layer]; 2]
        };
        for (outputs, below) in outputs.into_iter().zip(&mut below) {
            places.push(Place {
                inputs: inputs as u32,
                outputs: outputs as u32,
                weights: start as u32,
                below: *below as u32,
                above: column as u32,
                bent: u32::from(!last),
            });
            *below = column;
            column += outputs;
            start += (inputs + 1) * outputs;
        }
        inputs = outputs[0];
    }
    places.push(Place {
        inputs: 0,
        outputs: (TRAJECTORY_DIM + SUMS) as u32,
        weights: start as u32,
        below: 0,
        above: column as u32,
        bent: 0,
    });
    let head = Head {
        rows: rows as u32,
        pitch: (column + TRAJECTORY_DIM + SUMS) as u32,
        pieces: rows.div_ceil(64) as u32,
        piece: 8,
        parameters: (start + TRAJECTORY_DIM) as u32,
        count: places.len() as u32,
    };
    Plan { head, places }
}

fn up<T: bytemuck::Pod>(values: &[T]) -> Buffer<T> {
    Buffer::from_slice(&gpu(), values)
}

fn down(buffer: &Buffer<f32>) -> Vec<f32> {
    buffer.read(&gpu()).expect("a buffer")
}

/// Within some roundings of the largest.
#[track_caller]
fn near(what: &str, got: &[f32], want: &[f32]) {
    let largest = want.iter().fold(0.0f32, |most, w| match w.is_finite() {
        true => most.max(w.abs()),
        false => most,
    });
    close(what, got, want, |_| 64.0 * f32::EPSILON * largest);
}
