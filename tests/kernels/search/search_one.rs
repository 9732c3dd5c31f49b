//! Oracle: `search_exact::twin`, which compares every row.
//! Bar: bit-equal pairs, and of all workgroups' the oracle's row. Features are small integers: no distance is rounded,
//! and ties abound.

use crate::checked;
use crate::inputs::{Draw, POISON_WHOLE, gpu};
use bytemuck::cast_slice;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::search::{search_exact, search_one};
use footwork::motion::features::{FEATURE_DIM, ROW_STRIDE};

fn whole(draw: &mut Draw) -> [f32; ROW_STRIDE] {
    std::array::from_fn(|i| {
        if i < FEATURE_DIM {
            draw.below(3) as f32
        } else {
            1.0
        }
    })
}

#[test]
fn finds_the_lowest_of_many_ties() {
    let gpu = gpu();
    for (seed, candidates, groups) in [
        (1, 1, 1),
        (2, 63, 1),
        (3, 64, 2),
        (4, 65, 2),
        (5, 1000, 3),
        (6, 1000, 64),
        (7, 20_000, 64),
    ] {
        let mut draw = Draw::new(seed);
        // The last number of a row is not compared.
        let rows: Vec<_> = (0..candidates).map(|_| whole(&mut draw)).collect();
        let mut query = whole(&mut draw);
        query[FEATURE_DIM] = 77.0;
        let params = search_one::Params {
            candidates: candidates as u32,
            groups,
        };
        let start = vec![[POISON_WHOLE; 2]; groups as usize + 1];
        let mut twin = start.clone();
        search_one::twin(&rows, &query, &mut twin, &params);
        let nearest = Buffer::from_slice(&gpu, start.as_flattened());
        search_one::launch(
            &gpu,
            &Buffer::from_slice(&gpu, rows.as_flattened()),
            &Buffer::from_slice(&gpu, &query),
            &nearest,
            &params,
        );
        let launched = nearest.read(&gpu).expect("pairs");
        assert_eq!(launched, twin.as_flattened(), "{params:?}");
        let buffers: [&[u8]; 3] = [cast_slice(&rows), cast_slice(&query), cast_slice(&start)];
        let checked = checked::run(&shader::SEARCH_ONE, [groups, 1, 1], &buffers, &params);
        assert_eq!(checked.of::<[u32; 2]>(2), twin, "{params:?}");
        let exact = search_exact::Params {
            count: 1,
            candidates: candidates as u32,
            block: 64,
            max_norm: 0.0,
        };
        let mut matched = [0];
        search_exact::twin(&rows, &[query], &[], &mut matched, &exact);
        let least = twin[..groups as usize].iter().min().expect("pairs");
        assert_eq!(least[1], matched[0], "{params:?}");
    }
}
