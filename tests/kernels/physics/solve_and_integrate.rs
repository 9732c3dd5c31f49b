use super::worlds::*;

#[test]
fn agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 3);
        let params = worlds.solve_and_integrate_params();
        let forms = forms!(
            solve_and_integrate, SOLVE_AND_INTEGRATE, envs, params;
            &mut worlds.simulator() => worlds.model_table, mut worlds.state, worlds.dynamics,
            worlds.rows, worlds.constraints, worlds.contact_ids, worlds.counts,
            mut worlds.warm_start
        );
        let twin: &(Vec<f32>, Vec<u32>) = &forms.twin;
        let (max_contacts, joints) = (worlds.options.max_contacts, worlds.model.joints.len());
        let (nq, nv) = (worlds.model.nq(), worlds.model.nv());
        let dim = warm_start_dim(max_contacts, joints);
        for (form, (state, warm_start)) in forms.shaders() {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            near(&what("positions"), state, &twin.0, envs, 0..nq, 1e-4);
            near(&what("velocities"), state, &twin.0, envs, nq..nq + nv, 1e-3);
            let ids = max_contacts * envs;
            assert_eq!(warm_start[..ids], twin.1[..ids], "{}", what("ids"));
            let forces = |warm_start: &[u32]| -> Vec<f32> {
                let forces = warm_start[ids..].iter();
                forces.map(|&force| f32::from_bits(force)).collect()
            };
            let (found, wanted) = (forces(warm_start), forces(&twin.1));
            near(
                &what("forces"),
                &found,
                &wanted,
                envs,
                0..dim - max_contacts,
                1e-2,
            );
        }
    }
}
