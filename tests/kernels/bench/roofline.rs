//! What measures the roofline does the work it claims. Oracle: the twins. Bar: bits for copies;
//! for sums, which each step halves, a few roundings.

use crate::checked;
use crate::inputs::{Draw, POISON, close, gpu, same};
use bytemuck::cast_slice;
use footwork::gpu::{Buffer, shader};
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
        let mut twin = vec![[POISON; 4]; count];
        bandwidth::twin(&source, &mut twin, &params);
        assert_eq!(twin, source);
        // One too many: it must stay untouched.
        let mut want = source.clone();
        want.push([POISON; 4]);
        let poison = vec![[POISON; 4]; count + 1];
        let gpu = gpu();
        let copy = Buffer::from_slice(&gpu, poison.as_flattened());
        let from = Buffer::from_slice(&gpu, source.as_flattened());
        bandwidth::launch(&gpu, &from, &copy, &params);
        same(
            "launched",
            &copy.read(&gpu).expect("a copy"),
            want.as_flattened(),
        );
        let buffers: [&[u8]; 2] = [cast_slice(&source), cast_slice(&poison)];
        let groups = [count.div_ceil(64) as u32, 1, 1];
        let outcome = checked::run(&shader::BANDWIDTH, groups, &buffers, &params);
        same("checked", &outcome.of(1), want.as_flattened());
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
        let mut twin = start.clone();
        arithmetic::twin(&mut twin, &params);
        // x + k goes half the way to 1 in each round.
        for (twin, start) in twin.as_flattened().iter().zip(start.as_flattened()) {
            let rest = 0.5f64.powi(4 * rounds as i32);
            let each = (0..8).map(|k| 1.0 + rest * (f64::from(*start) + f64::from(k) - 1.0));
            assert!((f64::from(*twin) - each.sum::<f64>()).abs() < 1e-4);
        }
        let gpu = gpu();
        let sums = Buffer::from_slice(&gpu, start.as_flattened());
        arithmetic::launch(&gpu, &sums, &params);
        let launched = sums.read(&gpu).expect("sums");
        close("launched", &launched, twin.as_flattened(), |_| 1e-4);
        let groups = [count.div_ceil(64) as u32, 1, 1];
        let outcome = checked::run(&shader::ARITHMETIC, groups, &[cast_slice(&start)], &params);
        close("checked", &outcome.of(0), twin.as_flattened(), |_| 1e-4);
    }
}
