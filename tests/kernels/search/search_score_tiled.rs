//! Oracle, bar and inputs: those of `search_score_lanes`.

use super::search_score_lanes::{Case, SHAPES};

#[test]
fn agrees_with_its_twin_and_the_oracle() {
    for (seed, shape) in (100..).zip(SHAPES) {
        for far in [1.0, 1e4] {
            Case::new(shape, far, seed).tiles_agree();
        }
    }
}
