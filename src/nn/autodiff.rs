//! Policy and critic while they learn in burn: the same networks in a gradient graph.

use super::network::{Net, Place, Shape};
use super::policy::Dense;
use crate::motion::features::TRAJECTORY_DIM;
use burn::tensor::{Gradients, Tensor};

/// The parameters as leaves of a gradient graph.
pub(super) struct Study {
    pub actor: Net<Dense>,
    pub critic: Net<Dense>,
    /// `[TRAJECTORY_DIM]`.
    pub log_std: Tensor<1>,
}

impl Study {
    pub fn new(shape: &Shape, flat: &Tensor<1>) -> Study {
        let leaves = |place: &Place| {
            let Dense {
                layer,
                weights,
                biases,
            } = Dense::cut(place, flat);
            Dense {
                layer,
                weights: Tensor::from_inner(weights).require_grad(),
                biases: Tensor::from_inner(biases).require_grad(),
            }
        };
        let log_std = flat.clone().narrow(0, shape.log_std, TRAJECTORY_DIM);
        Study {
            actor: shape.actor.map(leaves),
            critic: shape.critic.map(leaves),
            log_std: Tensor::from_inner(log_std).require_grad(),
        }
    }

    /// Gradients of all parameters in the flat vector's order; zero where the loss does not depend
    /// on one.
    pub fn gradient(&self, gradients: &Gradients) -> Tensor<1> {
        let layers = self.actor.layers().chain(self.critic.layers());
        let mut parts: Vec<Tensor<1>> = layers
            .flat_map(|layer| {
                let weights = gradient_of(&layer.weights, gradients).flatten::<1>(0, 1);
                [weights, gradient_of(&layer.biases, gradients)]
            })
            .collect();
        parts.push(gradient_of(&self.log_std, gradients));
        Tensor::cat(parts, 0)
    }
}

fn gradient_of<const D: usize>(leaf: &Tensor<D>, gradients: &Gradients) -> Tensor<D> {
    let gradient = leaf.grad(gradients);
    gradient.unwrap_or_else(|| leaf.clone().inner().zeros_like())
}
