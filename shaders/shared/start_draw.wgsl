// Which of some start states an episode begins in (src/kernels/humanoid/draw_starts.rs). The importing shader
// imports `rng`.

const STREAM = 0x53544152u;

fn start_of(seed: u32, key: u32, reset_counter: u32, count: u32) -> u32 {
    return index_below(random4(seed, key, reset_counter, STREAM).x, count);
}
