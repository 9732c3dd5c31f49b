// Policy and critic, all of dense layers, side by side; a minibatch on its way through them.
//
// Rows are samples in blocks of BLOCK: [blocks][pitch][BLOCK]. A row is what is observed, once for each
// network, then the activations of every layer, the actor's before the critic's. In a second array of that
// form stand the gradients with respect to them, and behind those what the loss adds up: the gradient
// with respect to log_std, then SUMS sums.

struct Place {
    // Numbers that come in and go out.
    inputs: u32,
    outputs: u32,
    // Where in the parameters its weights [inputs][outputs] begin; its biases [outputs] follow.
    weights: u32,
    // Columns of what comes in and goes out.
    below: u32,
    above: u32,
    // 1: tanh of the sums. 0: the sums.
    bent: u32,
}

struct Plan {
    rows: u32,
    pitch: u32,
    // The rows are added up in so many pieces of `piece` blocks.
    pieces: u32,
    piece: u32,
    parameters: u32,
    // Layers of both networks, and one without inputs for what the loss adds up.
    count: u32,
    // Layer by layer, the actor's before the critic's; the one without inputs last.
    places: array<Place>,
}

const BLOCK = 8u;   // rows, or inputs, an invocation computes at once: each fetch serves so many
const HALVES = 2u;  // vec4 of a block
const LANES = 32u;  // invocations of a workgroup, each with an output or an input of a layer
const SUMS = 5u;    // surrogate, value loss, entropy, KL divergence, samples out of the clip range
const GROUP = 64u;  // numbers a workgroup of `total` adds up
