//! Networks: their form, their evaluation, their gradients, and the steps against these.
//!
//! [`layer`] and [`network`] say where everything lies in one flat vector of parameters, [`actor_critic`]
//! for an actor and its critic; an [`engine`] evaluates networks and takes the gradient of an
//! [`objective`], on the CPU ([`cpu`]) or a GPU ([`gpu`]); [`adam`] steps against it.
//! [`network_copies`] evaluates one network with several parameters at once. [`running_mean_std`] normalises; a [`policy`] is what is left when learning is over.

pub mod actor_critic;
pub mod adam;
pub mod cpu;
pub mod engine;
pub mod extent;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod layer;
pub mod network;
pub mod network_copies;
pub mod objective;
pub mod observation;
pub mod policy;
pub mod rows;
pub mod running_mean_std;

pub use actor_critic::ActorCritic;
pub use adam::Adam;
pub use engine::Engine;
pub use extent::{EngineSize, Rows};
pub use network::{Network, NetworkConfig, NetworkError};
pub use network_copies::NetworkCopies;
pub use objective::Objective;
pub use policy::{Policy, PolicyScratch};
pub use running_mean_std::RunningMeanStd;
