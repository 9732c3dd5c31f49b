//! Oracle: `build_query::twin`. Bar: equal bit for bit; nothing is computed.

use crate::inputs::{Draw, SEEDS, SIZES, same};
use footwork::kernels::locomotion::build_query;
use footwork::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

const FRAMES: usize = 500;

/// Queries of all environments, whose actions begin at `action_at`.
fn agrees(
    envs: usize,
    features: &[[f32; ROW_STRIDE]],
    state_u32: &[u32],
    action: &[f32],
    action_at: usize,
) -> Vec<[f32; ROW_STRIDE]> {
    let params = build_query::Params {
        envs: envs as u32,
        action_at: action_at as u32,
    };
    let forms = forms!(
        build_query, BUILD_QUERY, envs, params; features, state_u32, action, out envs
    );
    for (form, got) in forms.shaders() {
        same(form, got.as_flattened(), forms.twin.as_flattened());
    }
    forms.twin
}

#[test]
fn agrees_with_its_twin_and_the_definition() {
    for seed in SEEDS {
        for envs in SIZES {
            let mut draw = Draw::new(seed);
            let features = draw.rows(FRAMES, 0.0);
            let (_, state_u32) = draw.state(envs, FRAMES);
            let action_at = draw.below(3) * envs * TRAJECTORY_DIM;
            let action = draw.normals(action_at + envs * TRAJECTORY_DIM);
            let queries = agrees(envs, &features, &state_u32, &action, action_at);
            let actions = action[action_at..].chunks(TRAJECTORY_DIM);
            for (env, (row, action)) in queries.iter().zip(actions).enumerate() {
                assert_eq!(
                    row[..POSE_DIM],
                    features[state_u32[env] as usize][..POSE_DIM]
                );
                assert_eq!(row[POSE_DIM..FEATURE_DIM], *action);
                assert_eq!(row[FEATURE_DIM], 1.0);
            }
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
    agrees(65, &features, &state_u32, &action, 0);
}
