//! Gradient steps on a GPU where all layers are dense, by launches of our own: ten for a minibatch.

use super::Ppo;
use super::adam::Adam;
use super::layer::Bend;
use super::loss::Terms;
use super::network::Shape;
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Buffer, Gpu};
use crate::kernels::layout::GOAL;
use crate::kernels::network::{GROUP, Head, Place, Plan, SUMS};
use crate::kernels::{adam, backward, forward, gradient, loss, take, total};
use crate::motion::features::TRAJECTORY;
use burn::tensor::{Device, Int, Tensor, TensorData};

/// Rows of a piece. Where that made more than [`PIECES`], pieces grow.
const PIECE: usize = 64;
const PIECES: usize = 64;

/// How the networks and so many samples lie in memory; none if a layer is not dense.
fn plan(shape: &Shape, rows: usize) -> Option<Plan> {
    if shape.actor.sees {
        return None;
    }
    let (mut places, mut below, mut column) = (Vec::new(), [0; 2], GOAL);
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
    let judged = TRAJECTORY + SUMS;
    places.push(Place {
        inputs: 0,
        outputs: judged as u32,
        weights: shape.log_std as u32,
        below: 0,
        above: column as u32,
        bent: 0,
    });
    let piece = PIECE * rows.div_ceil(PIECE * PIECES);
    let head = Head {
        rows: rows as u32,
        pitch: (column + judged) as u32,
        pieces: rows.div_ceil(piece) as u32,
        piece: piece as u32,
        parameters: shape.parameters() as u32,
        count: places.len() as u32,
    };
    Some(Plan { head, places })
}

/// A plan on the host and on the device.
struct Planned {
    plan: Plan,
    table: Buffer<u32>,
}

/// What gradient steps need on the device, made once.
pub(super) struct Descent {
    gpu: Gpu,
    /// For a whole minibatch, and for what may be left of a batch.
    plans: Vec<Planned>,
    /// Where each parameter stands when weights are `[outputs][inputs]`, and the reverse.
    turned: Buffer<u32>,
    order: Tensor<1, Int>,
    /// `[rows][pitch]`
    rows: Buffer<f32>,
    slopes: Buffer<f32>,
    /// `[pieces][parameters + SUMS]`
    partials: Buffer<f32>,
    gradient: Buffer<f32>,
    squares: Buffer<f32>,
    losses: Buffer<f32>,
}

/// What a gradient step changes.
pub(super) struct Moving {
    parameters: Buffer<f32>,
    /// The same with weights `[outputs][inputs]`.
    turned: Buffer<f32>,
    first: Buffer<f32>,
    second: Buffer<f32>,
}

impl Descent {
    /// None if a layer is not dense.
    pub fn new(gpu: &Gpu, device: &Device, shape: &Shape, config: &Ppo) -> Option<Self> {
        let (samples, minibatch) = (config.batch(), config.minibatch.min(config.batch()));
        let mut plans = vec![plan(shape, minibatch)?];
        if samples % minibatch > 0 {
            plans.push(plan(shape, samples % minibatch)?);
        }
        let (room, head) = (plans[0].room(), plans[0].head);
        let parameters = shape.parameters();
        let numbers = parameters + SUMS;
        let place = plans[0].turned();
        let mut order = vec![0; parameters];
        for (from, &to) in place.iter().enumerate() {
            order[to as usize] = from as i32;
        }
        let zeroed = |length: usize| Buffer::zeroed(gpu, length);
        Some(Descent {
            turned: Buffer::from_slice(gpu, &place),
            order: Tensor::from_data(TensorData::new(order, [parameters]), device),
            rows: zeroed(room * head.pitch as usize),
            slopes: zeroed(room * head.pitch as usize),
            partials: zeroed(head.pieces as usize * numbers),
            gradient: zeroed(parameters),
            squares: zeroed(numbers.div_ceil(GROUP)),
            losses: zeroed(SUMS),
            plans: plans
                .into_iter()
                .map(|plan| Planned {
                    table: Buffer::from_slice(gpu, &plan.words()),
                    plan,
                })
                .collect(),
            gpu: gpu.clone(),
        })
    }

    /// Copies, so that nobody else sees them move.
    pub fn begin(&self, parameters: &Tensor<1>, adam: &Adam) -> Moving {
        let copy = |of: &Tensor<1>| to_buffer(of.clone().mul_scalar(1.0));
        Moving {
            parameters: copy(parameters),
            turned: to_buffer(parameters.clone().select(0, self.order.clone())),
            first: copy(&adam.first),
            second: copy(&adam.second),
        }
    }

    /// A step on every minibatch of a batch in the order of this pass, at a learning rate and with a largest norm
    /// of the gradient. The losses begin at zero.
    pub fn pass(
        &self,
        moving: &Moving,
        batch: Tensor<2>,
        old_log_std: &Tensor<1>,
        adam: &mut Adam,
        [rate, max_norm]: [f64; 2],
        terms: impl Fn(usize) -> Terms,
    ) {
        let [samples, width] = batch.dims();
        let (batch, old_log_std) = (to_buffer(batch), to_buffer(old_log_std.clone()));
        let mut start = 0;
        while start < samples {
            let left = samples - start;
            let fits = |planned: &&Planned| planned.plan.head.rows as usize <= left;
            let Some(planned) = self.plans.iter().find(fits) else {
                unreachable!("a plan was made for what is left of a batch")
            };
            let rows = planned.plan.head.rows as usize;
            let params = loss_params(&terms(rows), start, rows, width);
            self.slope(planned, moving, &batch, &old_log_std, &params);
            let begin = u32::from(start == 0);
            let params = adam.next(moving.parameters.len(), rate, max_norm);
            self.step(planned, moving, begin, &params);
            start += rows;
        }
    }

    /// Leaves the gradient over a minibatch, in pieces.
    fn slope(
        &self,
        planned: &Planned,
        moving: &Moving,
        batch: &Buffer<f32>,
        old_log_std: &Buffer<f32>,
        params: &loss::Params,
    ) {
        let (gpu, plan, table) = (&self.gpu, &planned.plan, &planned.table);
        let (rows, slopes) = (&self.rows, &self.slopes);
        let observed = take::Params {
            rows: params.rows,
            start: params.start,
            width: params.width,
        };
        take::launch(gpu, table, batch, rows, &observed);
        let layers = (0..plan.head.count - 1).step_by(2);
        for first in layers.clone() {
            let params = forward::Params { first, count: 2 };
            forward::launch(gpu, (plan, table), &moving.parameters, rows, &params);
        }
        loss::launch(
            gpu,
            table,
            batch,
            &moving.parameters,
            old_log_std,
            rows,
            slopes,
            params,
        );
        // What is observed does not learn.
        for first in layers.skip(1).rev() {
            let params = backward::Params { first };
            backward::launch(gpu, (plan, table), &moving.turned, rows, slopes, &params);
        }
        let params = gradient::Params {
            parameters: plan.head.parameters,
        };
        gradient::launch(gpu, (plan, table), rows, slopes, &self.partials, &params);
    }

    /// Adds the pieces up and steps against them.
    fn step(&self, planned: &Planned, moving: &Moving, begin: u32, params: &adam::Params) {
        let (gpu, table) = (&self.gpu, &planned.table);
        total::launch(
            gpu,
            table,
            &self.partials,
            &self.gradient,
            &self.squares,
            &self.losses,
            &total::Params {
                parameters: params.parameters,
                begin,
            },
        );
        adam::launch(
            gpu,
            table,
            &self.gradient,
            &self.squares,
            &self.turned,
            &moving.parameters,
            &moving.turned,
            &moving.first,
            &moving.second,
            params,
        );
    }

    /// Puts back what has moved. Returns the losses of the last pass.
    pub fn end(&self, moving: Moving, parameters: &mut Tensor<1>, adam: &mut Adam) -> Tensor<1> {
        let tensor = |buffer: &Buffer<f32>| from_buffer(&self.gpu, buffer, [buffer.len()]);
        *parameters = tensor(&moving.parameters);
        adam.first = tensor(&moving.first);
        adam.second = tensor(&moving.second);
        tensor(&self.losses)
    }
}

fn loss_params(terms: &Terms, start: usize, rows: usize, width: usize) -> loss::Params {
    loss::Params {
        rows: rows as u32,
        start: start as u32,
        width: width as u32,
        clip: terms.clip as f32,
        value_clip: terms.value_clip as f32,
        value_coefficient: terms.value_coefficient as f32,
        entropy_coefficient: terms.entropy_coefficient as f32,
        kl_coefficient: terms.kl_coefficient as f32,
        share: terms.share,
    }
}
