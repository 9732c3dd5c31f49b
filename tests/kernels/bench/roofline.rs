//! What measures the roofline does the work it claims. Oracle: arithmetic in f64. Bar: bits for copies;
//! for sums, which each step halves, a few roundings.

use crate::inputs::{Draw, same};
use footwork::kernels::bench::{arithmetic, bandwidth};

fn quadruples(count: usize) -> Vec<[f32; 4]> {
    let mut draw = Draw::new(3);
    (0..count)
        .map(|_| std::array::from_fn(|_| draw.normal()))
        .collect()
}

#[test]
fn all_is_copied() {
    for count in [1, 63, 64, 65, 20_000] {
        let params = bandwidth::Params::new(count as u32);
        let source = quadruples(count);
        let groups = [count.div_ceil(64) as u32, 1, 1];
        let forms = forms!(bandwidth, BANDWIDTH, groups, params; source, out count);
        for (form, copy) in forms.all() {
            same(form, copy.as_flattened(), source.as_flattened());
        }
    }
}

#[test]
fn all_is_added_up() {
    for (count, rounds) in [(4, 0), (64, 1), (1000, 3), (1000, 256)] {
        let params = arithmetic::Params {
            count: count as u32,
            rounds,
        };
        let start = quadruples(count);
        let forms = forms!(arithmetic, ARITHMETIC, count, params; mut start);
        for (form, sums) in forms.all() {
            // x + k goes half the way to 1 in each round.
            for (sum, start) in sums.as_flattened().iter().zip(start.as_flattened()) {
                let rest = 0.5f64.powi(4 * rounds as i32);
                let each = (0..8).map(|k| 1.0 + rest * (f64::from(*start) + f64::from(k) - 1.0));
                assert!((f64::from(*sum) - each.sum::<f64>()).abs() < 1e-4, "{form}");
            }
        }
    }
}
