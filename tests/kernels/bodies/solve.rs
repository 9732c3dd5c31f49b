//! `solve`.

use super::worlds::*;

#[test]
fn solve_agrees() {
    for (scene, model, envs) in scenes() {
        let before = Worlds::new(model, envs, 3);
        let mut after = before.clone();
        after.solve();
        let params = before.solve_params();
        let gpu = gpu();
        let (state, warm) = (up(&gpu, &before.state), up(&gpu, &before.warm));
        solve::launch(
            &gpu,
            &up(&gpu, &before.tables),
            &state,
            &up(&gpu, &before.dynamics),
            &up(&gpu, &before.rows),
            &up(&gpu, &before.constraints),
            &up(&gpu, &before.keys),
            &up(&gpu, &before.counts),
            &warm,
            &params,
        );
        let launched = (state.read(&gpu).unwrap(), warm.read(&gpu).unwrap());
        let buffers: [&[u8]; 8] = [
            cast_slice(&before.tables),
            cast_slice(&before.state),
            cast_slice(&before.dynamics),
            cast_slice(&before.rows),
            cast_slice(&before.constraints),
            cast_slice(&before.keys),
            cast_slice(&before.counts),
            cast_slice(&before.warm),
        ];
        let outcome = checked::run(
            &shader::SOLVE_AND_INTEGRATE,
            groups(&shader::SOLVE_AND_INTEGRATE, envs),
            &buffers,
            &params,
        );
        let checked = (outcome.of(1), outcome.of(7));
        let (slots, joints) = (before.settings.slots, before.model.joints.len());
        let positions = before.model.positions();
        for (form, (state, warm)) in [("launch", launched), ("checked", checked)] {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            let values = positions + before.model.velocities();
            near(
                &what("positions"),
                &state,
                &after.state,
                envs,
                0..positions,
                1e-4,
            );
            near(
                &what("velocities"),
                &state,
                &after.state,
                envs,
                positions..values,
                1e-3,
            );
            let (found, wanted) = (&warm[..slots * envs], &after.warm[..slots * envs]);
            assert_eq!(found, wanted, "{}", what("keys"));
            let forces = |warm: &[u32]| -> Vec<f32> {
                let forces = warm[slots * envs..].iter();
                forces.map(|&force| f32::from_bits(force)).collect()
            };
            near(
                &what("forces"),
                &forces(&warm),
                &forces(&after.warm),
                envs,
                0..solve::warm(slots, joints) - slots,
                1e-2,
            );
        }
    }
}
