use super::worlds::*;

#[test]
fn agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 2);
        let (params, joints) = (worlds.make_constraints_params(), worlds.model.joints.len());
        let groups = [envs.div_ceil(64) as u32, params.row_groups, 1];
        let forms = forms!(
            make_constraints, MAKE_CONSTRAINTS, groups, params;
            &mut worlds.simulator() => worlds.model_table, worlds.state, worlds.dynamics,
            worlds.contacts, worlds.contact_ids, worlds.counts, out worlds.rows.len(),
            out worlds.constraints.len()
        );
        let twin: &(Vec<f32>, Vec<f32>) = &forms.twin;
        // What constraints that do not act are left with means nothing.
        let acting = |values: &[f32], wanted: &[f32]| -> Vec<f32> {
            let pairs = values.iter().zip(wanted);
            pairs
                .map(|(&v, &w)| if w == POISON { POISON } else { v })
                .collect()
        };
        let contacts: u32 = worlds.counts[..envs].iter().sum();
        assert!(contacts as usize > envs, "{scene}: {contacts} contacts");
        for (form, (rows, constraints)) in forms.shaders() {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            let found = acting(constraints, &twin.1);
            for index in 0..worlds.options.max_contacts + joints {
                let fields = index * CONSTRAINT_DIM..(index + 1) * CONSTRAINT_DIM;
                near(&what("constraints"), &found, &twin.1, envs, fields, 1e-4);
            }
            let numbers = twin.0.iter().filter(|&&w| w != POISON);
            let most = numbers.fold(0.0f32, |most, w| most.max(w.abs()));
            for (found, wanted) in acting(rows, &twin.0).iter().zip(&twin.0) {
                let off = (found - wanted).abs() / most;
                assert!(off <= 1e-4, "{}: {found} instead of {wanted}", what("rows"));
            }
        }
    }
}
