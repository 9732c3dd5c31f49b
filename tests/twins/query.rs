//! Oracle: `query::twin`. Bar: equal bit for bit; nothing is computed.

use crate::checked;
use crate::inputs::{Draw, POISON, SEEDS, SIZES, gpu, same};
use bytemuck::cast_slice;
use footwork::gpu::kernel::groups;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::query;
use footwork::motion::database::PADDED;
use footwork::motion::features::{FEATURE, POSE, TRAJECTORY};

const FRAMES: usize = 500;

fn agrees(envs: usize, features: &[[f32; PADDED]], whole: &[u32], action: &[f32]) -> Vec<f32> {
    let params = query::Params { envs: envs as u32 };
    // One row too many: it must stay untouched.
    let mut twin = vec![[POISON; PADDED]; envs + 1];
    let poison = twin.clone();
    query::twin(features, whole, action, &mut twin, &params);

    let gpu = gpu();
    let launched = Buffer::from_slice(&gpu, poison.as_flattened());
    query::launch(
        &gpu,
        &Buffer::from_slice(&gpu, features.as_flattened()),
        &Buffer::from_slice(&gpu, whole),
        &Buffer::from_slice(&gpu, action),
        &launched,
        &params,
    );
    let buffers: [&[u8]; 4] = [
        cast_slice(features),
        cast_slice(whole),
        cast_slice(action),
        cast_slice(&poison),
    ];
    let checked = checked::run(
        &shader::QUERY,
        groups(&shader::QUERY, envs),
        &buffers,
        &params,
    );
    same(
        "launched",
        &launched.read(&gpu).expect("queries"),
        twin.as_flattened(),
    );
    same("checked", &checked.of::<f32>(3), twin.as_flattened());
    twin.as_flattened().to_vec()
}

#[test]
fn agrees_with_its_twin_and_the_definition() {
    for seed in SEEDS {
        for envs in SIZES {
            let mut draw = Draw::new(seed);
            let features = draw.rows(FRAMES, 0.0);
            let (_, whole) = draw.state(envs, FRAMES);
            let action = draw.normals(envs * TRAJECTORY);
            let queries = agrees(envs, &features, &whole, &action);
            for (env, row) in queries.chunks(PADDED).take(envs).enumerate() {
                assert_eq!(row[..POSE], features[whole[env] as usize][..POSE]);
                assert_eq!(row[POSE..FEATURE], action[env * TRAJECTORY..][..TRAJECTORY]);
                assert_eq!(row[FEATURE], 1.0);
            }
            assert!(queries[envs * PADDED..].iter().all(|&q| q == POISON));
        }
    }
}

#[test]
fn passes_odd_actions_on() {
    let mut draw = Draw::new(1);
    let features = draw.rows(FRAMES, 0.0);
    let (_, whole) = draw.state(65, FRAMES);
    let odd = [0.0, -0.0, 1e-45, f32::MAX, f32::NEG_INFINITY, f32::NAN];
    let action: Vec<f32> = odd.into_iter().cycle().take(65 * TRAJECTORY).collect();
    agrees(65, &features, &whole, &action);
}
