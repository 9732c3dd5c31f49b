use super::worlds::*;

#[test]
fn agrees() {
    for (scene, model, envs) in scenes() {
        let mut worlds = Worlds::new(model, envs, 5);
        let starts = worlds.state.clone();
        worlds.solve_and_integrate();
        let nq = worlds.model.nq();
        let mask: Vec<u32> = (0..envs as u32)
            .map(|env| u32::from(env % 3 == 1))
            .collect();
        worlds.state[0] = f32::NAN;
        worlds.state[5 * envs + 4] = f32::NEG_INFINITY;
        worlds.state[(nq + 2) * envs + 3] = 2000.0;
        worlds.state[nq * envs + 6] = 900.0;
        let params = reset_worlds::Params {
            envs: envs as u32,
            max_contacts: worlds.options.max_contacts as u32,
            max_speed: 1000.0,
        };
        let forms = forms!(
            reset_worlds, RESET_WORLDS, envs, params;
            &worlds.model => worlds.model_table, mask, starts, mut worlds.state,
            mut worlds.warm_start, worlds.force_pairs, mut worlds.forces, mut worlds.counters
        );
        let twin: &(Vec<f32>, Vec<u32>, Vec<f32>, Vec<u32>) = &forms.twin;
        let diverged = &twin.3[contact_forces::DIVERGED * envs..][..envs];
        assert_eq!(diverged.iter().sum::<u32>(), 3, "{scene}");
        for (form, (state, warm_start, forces, counters)) in forms.shaders() {
            same(&format!("{scene}, {form}"), state, &twin.0);
            assert_eq!(*warm_start, twin.1, "{scene}, {form}");
            assert_eq!(*forces, twin.2, "{scene}, {form}");
            assert_eq!(*counters, twin.3, "{scene}, {form}");
        }
    }
}
