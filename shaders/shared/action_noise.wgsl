// The noise of the actions that a policy draws (src/kernels/learn/sample_action.rs).

#import rng

const NOISE = 0x4e4f4953u; // random stream

// Of a number of an action of the row that has this number in its batch.
fn action_noise(seed: u32, row: u32, step_counter: u32, number: u32) -> f32 {
    return gaussian(random4(seed, row, step_counter, NOISE + number));
}
