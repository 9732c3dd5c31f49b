//! Policy and critic while they learn: the same networks in a gradient graph.

use super::convolution;
use super::network::Net;
use super::policy::{Dense, Policy, borrow, rows, split};
use crate::tensors::{upload, values};
use burn::tensor::{Gradients, Tensor};

impl Policy {
    /// The same parameters as leaves of a gradient graph, about to learn from observations
    /// `[n, width]`.
    pub fn study(&self, observation: &Tensor<2>) -> Study {
        Study {
            actor: self.actor.study(observation),
            critic: self.critic.study(observation),
            log_std: Tensor::from_inner(self.log_std.clone()).require_grad(),
        }
    }
}

/// Policy and critic on the way from a batch of observations to the gradients of a loss.
pub struct Study {
    actor: NetStudy,
    critic: NetStudy,
    pub log_std: Tensor<1>,
}

impl Study {
    /// See [`Policy::mean`].
    pub fn mean(&self) -> Tensor<2> {
        self.actor.answer()
    }

    /// See [`Policy::value`].
    pub fn value(&self) -> Tensor<1> {
        self.critic.answer().squeeze_dim::<1>(1)
    }

    /// Gradients of all parameters in the flat vector's order; zero where the loss does not depend
    /// on one.
    pub fn gradient(&self, gradients: &Gradients) -> Tensor<1> {
        let mut parts = self.actor.gradient(gradients);
        parts.extend(self.critic.gradient(gradients));
        parts.push(gradient_of(&self.log_std, gradients));
        Tensor::cat(parts, 0)
    }
}

fn gradient_of<const D: usize>(leaf: &Tensor<D>, gradients: &Gradients) -> Tensor<D> {
    let gradient = leaf.grad(gradients);
    gradient.unwrap_or_else(|| leaf.clone().inner().zeros_like())
}

impl Dense {
    /// The same parameters as leaves of a gradient graph.
    fn leaves(&self) -> Dense {
        Dense {
            weights: Tensor::from_inner(self.weights.clone()).require_grad(),
            biases: Tensor::from_inner(self.biases.clone()).require_grad(),
        }
    }
}

impl Net<Dense> {
    fn study(&self, observation: &Tensor<2>) -> NetStudy {
        let leaves = self.map(Dense::leaves);
        let (goal, maps) = split(observation);
        let goal = Tensor::from_inner(goal);
        if !self.native(&maps) {
            let seen = leaves.convolve(Tensor::from_inner(maps));
            let tape = None;
            return NetStudy {
                leaves,
                goal,
                seen,
                tape,
            };
        }
        let (filters, maps) = (self.filters(), values(maps));
        let activations = convolution::forward(&self.eyes, &borrow(&filters), &maps);
        let seen = activations.last().cloned().unwrap_or_default();
        let seen = rows(seen, observation.dims()[0], &observation.device());
        NetStudy {
            leaves,
            goal,
            seen: Tensor::from_inner(seen).require_grad(),
            tape: Some(Tape {
                filters,
                maps,
                activations,
            }),
        }
    }
}

/// One network's part of a [`Study`].
struct NetStudy {
    leaves: Net<Dense>,
    goal: Tensor<2>,
    /// What the convolutions saw: a leaf if they ran here.
    seen: Tensor<2>,
    tape: Option<Tape>,
}

/// What going back through the convolutions needs.
struct Tape {
    filters: Vec<convolution::Gradients>,
    maps: Vec<f32>,
    activations: Vec<Vec<f32>>,
}

impl NetStudy {
    fn answer(&self) -> Tensor<2> {
        self.leaves.decide(self.goal.clone(), self.seen.clone())
    }

    fn gradient(&self, gradients: &Gradients) -> Vec<Tensor<1>> {
        let dense = |layer: &Dense| {
            let weights = gradient_of(&layer.weights, gradients).flatten::<1>(0, 1);
            [weights, gradient_of(&layer.biases, gradients)]
        };
        let Some(tape) = &self.tape else {
            return self.leaves.layers().flat_map(dense).collect();
        };
        let seen = gradient_of(&self.seen, gradients);
        let device = seen.device();
        let convolutions = convolution::backward(
            &self.leaves.eyes,
            &borrow(&tape.filters),
            &tape.maps,
            &tape.activations,
            &values(seen),
        );
        let convolutions = convolutions.into_iter().flat_map(|(weights, biases)| {
            [weights, biases].map(|values| {
                let length = values.len();
                upload(values, [length], &device)
            })
        });
        let rest = self.leaves.sight.iter().chain(&self.leaves.hidden);
        convolutions.chain(rest.flat_map(dense)).collect()
    }
}
