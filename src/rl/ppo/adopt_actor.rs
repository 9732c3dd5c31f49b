//! An actor that begins with what another has learned.

use crate::container::SectionError;
use crate::nn::Network;

/// Copies the parameters of an actor into one whose observation begins as the other's, and goes on: what
/// else it sees does not matter at first.
///
/// # Errors
/// Their hidden layers or actions differ.
pub fn adopt_actor(
    from: &Network,
    flat: &[f32],
    to: &Network,
    parameters: &mut [f32],
) -> Result<(), SectionError> {
    let widths = |network: &Network| -> Vec<usize> {
        let layers = network.layers().iter();
        layers.map(|params| params.layer.filters()).collect()
    };
    let (seen, sees) = (from.observation(), to.observation());
    let fits = seen.grid.is_none() && sees.grid.is_none() && seen.vector <= sees.vector;
    if !fits || widths(from) != widths(to) {
        return Err(SectionError(format!(
            "its policy of {} observations and layers of {:?} does not fit one of {} and {:?}",
            seen.dim(),
            widths(from),
            sees.dim(),
            widths(to)
        )));
    }
    for (from, to) in from.layers().iter().zip(to.layers()) {
        let weights = &flat[from.weights()];
        let own = &mut parameters[to.weights()];
        own.fill(0.0);
        own[..weights.len()].copy_from_slice(weights);
        parameters[to.biases()].copy_from_slice(&flat[from.biases()]);
    }
    Ok(())
}
