//! Oracle: `build_query::twin`. Bar: equal bit for bit; nothing is computed.

use crate::checked;
use crate::inputs::{Draw, POISON, SEEDS, SIZES, gpu, same};
use bytemuck::cast_slice;
use footwork::gpu::kernel::groups;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::locomotion::build_query;
use footwork::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

const FRAMES: usize = 500;

fn agrees(envs: usize, features: &[[f32; ROW_STRIDE]], state_u32: &[u32], action: &[f32]) -> Vec<f32> {
    let params = build_query::Params { envs: envs as u32 };
    // One row too many: it must stay untouched.
    let mut twin = vec![[POISON; ROW_STRIDE]; envs + 1];
    let poison = twin.clone();
    build_query::twin(features, state_u32, action, &mut twin, &params);

    let gpu = gpu();
    let launched = Buffer::from_slice(&gpu, poison.as_flattened());
    build_query::launch(
        &gpu,
        &Buffer::from_slice(&gpu, features.as_flattened()),
        &Buffer::from_slice(&gpu, state_u32),
        &Buffer::from_slice(&gpu, action),
        &launched,
        &params,
    );
    let buffers: [&[u8]; 4] = [
        cast_slice(features),
        cast_slice(state_u32),
        cast_slice(action),
        cast_slice(&poison),
    ];
    let checked = checked::run(
        &shader::BUILD_QUERY,
        groups(&shader::BUILD_QUERY, envs),
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
            let (_, state_u32) = draw.state(envs, FRAMES);
            let action = draw.normals(envs * TRAJECTORY_DIM);
            let queries = agrees(envs, &features, &state_u32, &action);
            for (env, row) in queries.chunks(ROW_STRIDE).take(envs).enumerate() {
                assert_eq!(row[..POSE_DIM], features[state_u32[env] as usize][..POSE_DIM]);
                assert_eq!(row[POSE_DIM..FEATURE_DIM], action[env * TRAJECTORY_DIM..][..TRAJECTORY_DIM]);
                assert_eq!(row[FEATURE_DIM], 1.0);
            }
            assert!(queries[envs * ROW_STRIDE..].iter().all(|&q| q == POISON));
        }
    }
}

#[test]
fn passes_odd_actions_on() {
    let mut draw = Draw::new(1);
    let features = draw.rows(FRAMES, 0.0);
    let (_, state_u32) = draw.state(65, FRAMES);
    let odd = [0.0, -0.0, 1e-45, f32::MAX, f32::NEG_INFINITY, f32::NAN];
    let action: Vec<f32> = odd.into_iter().cycle().take(65 * TRAJECTORY_DIM).collect();
    agrees(65, &features, &state_u32, &action);
}
