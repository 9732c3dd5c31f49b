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
        let (state, warm_start) = (up(&gpu, &before.state), up(&gpu, &before.warm_start));
        solve::launch(
            &gpu,
            &up(&gpu, &before.tables),
            &state,
            &up(&gpu, &before.dynamics),
            &up(&gpu, &before.rows),
            &up(&gpu, &before.constraints),
            &up(&gpu, &before.contact_ids),
            &up(&gpu, &before.counts),
            &warm_start,
            &params,
        );
        let launched = (state.read(&gpu).unwrap(), warm_start.read(&gpu).unwrap());
        let buffers: [&[u8]; 8] = [
            cast_slice(&before.tables),
            cast_slice(&before.state),
            cast_slice(&before.dynamics),
            cast_slice(&before.rows),
            cast_slice(&before.constraints),
            cast_slice(&before.contact_ids),
            cast_slice(&before.counts),
            cast_slice(&before.warm_start),
        ];
        let outcome = checked::run(
            &shader::SOLVE_AND_INTEGRATE,
            groups(&shader::SOLVE_AND_INTEGRATE, envs),
            &buffers,
            &params,
        );
        let checked = (outcome.of(1), outcome.of(7));
        let (max_contacts, joints) = (before.settings.max_contacts, before.model.joints.len());
        let positions = before.model.nq();
        for (form, (state, warm_start)) in [("launch", launched), ("checked", checked)] {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            let values = positions + before.model.nv();
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
            let (found, wanted) = (&warm_start[..max_contacts * envs], &after.warm_start[..max_contacts * envs]);
            assert_eq!(found, wanted, "{}", what("contact_ids"));
            let forces = |warm_start: &[u32]| -> Vec<f32> {
                let forces = warm_start[max_contacts * envs..].iter();
                forces.map(|&force| f32::from_bits(force)).collect()
            };
            near(
                &what("forces"),
                &forces(&warm_start),
                &forces(&after.warm_start),
                envs,
                0..solve::warm_start(max_contacts, joints) - max_contacts,
                1e-2,
            );
        }
    }
}
