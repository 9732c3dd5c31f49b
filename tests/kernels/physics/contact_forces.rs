use super::worlds::*;

#[test]
fn agrees() {
    for (scene, model, envs) in scenes() {
        let mut worlds = Worlds::new(model, envs, 4);
        worlds.solve_and_integrate();
        let params = contact_forces::Params {
            envs: envs as u32,
            max_contacts: worlds.options.max_contacts as u32,
            first: 1,
            weight: 0.25,
        };
        let forms = forms!(
            contact_forces, CONTACT_FORCES, envs, params;
            &worlds.model => worlds.model_table, worlds.contacts, worlds.contact_ids,
            worlds.counts, worlds.warm_start, worlds.force_pairs, mut worlds.forces,
            mut worlds.counters
        );
        let twin: &(Vec<f32>, Vec<u32>) = &forms.twin;
        let fields = worlds.forces.len() / envs;
        for (form, (forces, counters)) in forms.shaders() {
            near(
                &format!("{scene}, {form}"),
                forces,
                &twin.0,
                envs,
                0..fields,
                1e-4,
            );
            assert_eq!(*counters, twin.1, "{scene}, {form}");
        }
    }
}
