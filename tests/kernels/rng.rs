//! Oracle: `src/kernels/rng.rs`. Bar: equal bit for bit.

use crate::inputs::{Draw, same};
use crate::support::forms::{Run, poison};
use footwork::gpu::shader::Shader;
use footwork::gpu::{Argument, groups};
use footwork::kernels::rng::{gaussian, index_below, random4, uniform01};

const KEYS: usize = 100_000;

static DRAW: Shader = Shader {
    name: "draw",
    source: concat!(
        include_str!("../../shaders/shared/rng.wgsl"),
        "
        @group(0) @binding(0) var<storage, read> keys: array<vec4u>;
        @group(0) @binding(1) var<storage, read_write> bits: array<vec4u>;
        @group(0) @binding(2) var<storage, read_write> below: array<u32>;
        @group(0) @binding(3) var<storage, read_write> reals: array<vec2f>;
        struct Params { count: u32 }
        @group(0) @binding(4) var<uniform> params: Params;
        @compute @workgroup_size(64)
        fn draw(@builtin(global_invocation_id) id: vec3u) {
            let at = id.x;
            if (at >= params.count) { return; }
            let key = keys[at];
            let drawn = random4(key.x, key.y, key.z, key.w);
            bits[at] = drawn;
            below[at] = index_below(drawn.x, key.y);
            reals[at] = vec2f(uniform01(drawn.y), gaussian(drawn));
        }
        "
    ),
    workgroup: [64, 1, 1],
    buffers: 4,
    params: 4,
};

/// All combinations of extreme words, then random and counting ones.
fn keys() -> Vec<[u32; 4]> {
    const EXTREME: [u32; 6] = [0, 1, 0xffff, 0x1_0000, 0x8000_0000, u32::MAX];
    let mut draw = Draw::new(1);
    (0..KEYS)
        .map(|i| match i {
            0..1296 => [1, 6, 36, 216].map(|place| EXTREME[i / place % 6]),
            1296..50_000 => [7, i as u32 % 4096, i as u32 / 4096, 3],
            _ => draw.bits(),
        })
        .collect()
}

#[test]
fn draws_the_same_numbers_on_every_device() {
    let keys = keys();
    let drawn: Vec<[u32; 4]> = keys
        .iter()
        .map(|&[a, b, c, d]| random4(a, b, c, d))
        .collect();
    let below: Vec<u32> = keys
        .iter()
        .zip(&drawn)
        .map(|(k, d)| index_below(d[0], k[1]))
        .collect();
    let reals: Vec<f32> = drawn
        .iter()
        .flat_map(|&d| [uniform01(d[1]), gaussian(d)])
        .collect();

    let mut run = Run::new();
    let input = run.input(&keys);
    let bits = run.output(poison::<[u32; 4]>(KEYS));
    let indices = run.output(poison::<u32>(KEYS));
    let numbers = run.output(poison::<[f32; 2]>(KEYS));
    let buffers: [&dyn Argument; 4] = [&input, bits.device(), indices.device(), numbers.device()];
    let groups = groups(&DRAW, KEYS);
    run.gpu.launch(&DRAW, groups, &buffers, &(KEYS as u32));
    assert_eq!(bits.launched(&run.gpu), drawn);
    assert_eq!(indices.launched(&run.gpu), below);
    same(
        "launched",
        numbers.launched(&run.gpu).as_flattened(),
        &reals,
    );

    let checked = run.checked(&DRAW, KEYS, &(KEYS as u32));
    assert_eq!(bits.checked(&checked), drawn);
    assert_eq!(indices.checked(&checked), below);
    same("checked", numbers.checked(&checked).as_flattened(), &reals);
}

#[test]
fn extreme_bits_stay_in_range() {
    for bits in [0, 1, 0x8000_0000, u32::MAX] {
        assert!((0.0..1.0).contains(&uniform01(bits)));
        for below in [1, 2, 65_536, 70_001, u32::MAX] {
            assert!(index_below(bits, below) < below);
        }
        assert!(gaussian([bits; 4]).abs() < 9.9);
    }
}
