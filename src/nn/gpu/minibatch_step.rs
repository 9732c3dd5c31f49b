//! Gradient steps, six launches for a minibatch.

use crate::rl::ppo::Ppo;
use crate::nn::adam::Adam;
use crate::rl::ppo::loss::Terms;
use crate::nn::network::Shape;
use super::plan;
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Buffer, Device, Gpu};
use crate::kernels::learn::network::{GROUP, Plan, ROWS, SUMS};
use crate::kernels::learn::{adam, backward, forward, gradient, loss, reduce_grads};
use crate::motion::features::TRAJECTORY_DIM;
use burn::tensor::{Int, Tensor, TensorData};

/// A plan on the host and on the device.
struct Planned {
    plan: Plan,
    table: Buffer<u32>,
}

/// What gradient steps need on the device, made once.
pub struct Descent {
    gpu: Gpu,
    /// For a whole minibatch, and for what may be left of a batch.
    plans: Vec<Planned>,
    /// Where each parameter stands when weights are `[outputs][inputs]`, and the reverse.
    turned: Buffer<u32>,
    order: Tensor<1, Int>,
    /// As [`Plan::at`] says.
    rows: Buffer<f32>,
    slopes: Buffer<f32>,
    /// `[rows][TRAJECTORY_DIM]`, then `[rows]`
    answers: Buffer<f32>,
    /// `[pieces][parameters + SUMS]`
    partials: Buffer<f32>,
    gradient: Buffer<f32>,
    squares: Buffer<f32>,
    losses: Buffer<f32>,
}

/// What a gradient step changes.
pub struct Moving {
    parameters: Buffer<f32>,
    /// The same with weights `[outputs][inputs]`.
    turned: Buffer<f32>,
    first: Buffer<f32>,
    second: Buffer<f32>,
}

impl Descent {
    /// None if a layer is not dense, or what a minibatch needs too large for the device.
    pub fn new(gpu: &Gpu, shape: &Shape, config: &Ppo) -> Option<Self> {
        let (samples, minibatch) = (config.batch(), config.minibatch.min(config.batch()));
        let mut plans = vec![plan(shape, minibatch)?];
        if samples % minibatch > 0 {
            plans.push(plans[0].fewer(samples % minibatch));
        }
        let (room, pieces) = (plans[0].numbers(), plans[0].head.pieces as usize);
        let parameters = shape.parameters();
        let numbers = parameters + SUMS;
        let device = Device::from(gpu.clone());
        device.holds("rows", room).ok()?;
        device.holds("partial sums", pieces * numbers).ok()?;
        if minibatch > ROWS {
            return None;
        }
        let place = plans[0].turned();
        let mut order = vec![0; parameters];
        for (from, &to) in place.iter().enumerate() {
            order[to as usize] = from as i32;
        }
        let zeroed = |length: usize| Buffer::zeroed(gpu, length);
        Some(Descent {
            turned: Buffer::from_slice(gpu, &place),
            order: Tensor::from_data(TensorData::new(order, [parameters]), &device.tensors()),
            rows: zeroed(room),
            slopes: zeroed(room),
            partials: zeroed(pieces * numbers),
            answers: zeroed(minibatch * (TRAJECTORY_DIM + 1)),
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
        let (rows, slopes, answers) = (&self.rows, &self.slopes, &self.answers);
        forward::launch(
            gpu,
            2,
            table,
            batch,
            &moving.parameters,
            rows,
            answers,
            &forward::Params {
                rows: params.rows,
                start: params.start,
                width: params.width,
                first: 0,
            },
        );
        loss::launch(
            gpu,
            table,
            batch,
            &moving.parameters,
            old_log_std,
            answers,
            slopes,
            params,
        );
        let filled = backward::Params { rows: params.rows };
        backward::launch(gpu, table, &moving.turned, rows, slopes, &filled);
        let params = gradient::Params {
            parameters: plan.head.parameters,
        };
        gradient::launch(gpu, (plan, table), rows, slopes, &self.partials, &params);
    }

    /// Adds the pieces up and steps against them.
    fn step(&self, planned: &Planned, moving: &Moving, begin: u32, params: &adam::Params) {
        let (gpu, table) = (&self.gpu, &planned.table);
        reduce_grads::launch(
            gpu,
            table,
            &self.partials,
            &self.gradient,
            &self.squares,
            &self.losses,
            &reduce_grads::Params {
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
