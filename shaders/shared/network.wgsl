// Networks of dense layers side by side, and a batch of rows on its way through them.
//
// Rows lie in blocks of BLOCK: [blocks][row_stride][BLOCK]. A row is the observation, once for each
// network, then the activations of every hidden layer. A second array of that form holds the gradients
// with respect to the layers' sums; behind those stand the extras, what the objective adds up:
// gradients of the parameters behind the networks', then its sums.

const IDENTITY = 0u;
const RELU = 1u;
const TANH = 2u;

struct LayerWords {
    inputs: u32,
    outputs: u32,
    // Where in the parameters its weights [inputs][outputs] begin; its biases [outputs] follow.
    weights: u32,
    // Columns of the inputs and of the outputs.
    input_col: u32,
    output_col: u32,
    activation: u32,
}

struct BatchLayout {
    rows: u32,
    row_stride: u32,
    // Gradients are summed over so many parts of `split_blocks` blocks.
    splits: u32,
    split_blocks: u32,
    parameters: u32,
    // Sums of the objective.
    sums: u32,
    networks: u32,
    // Layers of all networks, and one without inputs: the extras.
    layers: u32,
    // The first layer of each network, and of the one behind the last.
    first_layer: array<u32, 5>,
    // Outputs of the networks before each.
    outputs_before: array<u32, 5>,
    layer: array<LayerWords>,
}

const BLOCK = 8u;   // rows, or inputs, an invocation computes at once: each fetch serves so many
const HALVES = 2u;  // vec4 of a block
const LANES = 32u;  // invocations of a workgroup, each with an output or an input of a layer

const NO_COPY = 0xffffffffu; // of the parameters: what it would evaluate is nobody's
