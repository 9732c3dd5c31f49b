//! `constrain`.

use super::worlds::*;

#[test]
fn constrain_agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 2);
        let (params, joints) = (worlds.constrain_params(), worlds.model.joints.len());
        let row_groups = constrain::row_groups(&worlds.model, worlds.settings.max_contacts);
        let blank = (
            vec![POISON; worlds.rows.len()],
            vec![POISON; worlds.constraints.len()],
        );
        let gpu = gpu();
        let (rows, constraints) = (up(&gpu, &blank.0), up(&gpu, &blank.1));
        constrain::launch(
            &gpu,
            row_groups,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.state),
            &up(&gpu, &worlds.dynamics),
            &up(&gpu, &worlds.contacts),
            &up(&gpu, &worlds.contact_ids),
            &up(&gpu, &worlds.counts),
            &rows,
            &constraints,
            &params,
        );
        let launched = (rows.read(&gpu).unwrap(), constraints.read(&gpu).unwrap());
        let buffers: [&[u8]; 8] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.state),
            cast_slice(&worlds.dynamics),
            cast_slice(&worlds.contacts),
            cast_slice(&worlds.contact_ids),
            cast_slice(&worlds.counts),
            cast_slice(&blank.0),
            cast_slice(&blank.1),
        ];
        let groups = [envs.div_ceil(64) as u32, row_groups as u32, 1];
        let outcome = checked::run(&shader::MAKE_CONSTRAINTS, groups, &buffers, &params);
        let checked = (outcome.of(6), outcome.of(7));
        // What constraints that do not act are left with means nothing.
        let acting = |values: &[f32], wanted: &[f32]| -> Vec<f32> {
            let pairs = values.iter().zip(wanted);
            pairs
                .map(|(&v, &w)| if w == POISON { POISON } else { v })
                .collect()
        };
        let contacts: u32 = worlds.counts[..envs].iter().sum();
        assert!(contacts as usize > envs, "{scene}: {contacts} contacts");
        for (form, (rows, constraints)) in [("launch", launched), ("checked", checked)] {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            for slot in 0..worlds.settings.max_contacts + joints {
                let fields = slot * CONSTRAINT_DIM..(slot + 1) * CONSTRAINT_DIM;
                let found = acting(&constraints, &worlds.constraints);
                near(
                    &what("constraints"),
                    &found,
                    &worlds.constraints,
                    envs,
                    fields,
                    1e-4,
                );
            }
            let real = worlds.rows.iter().filter(|&&w| w != POISON);
            let most = real.fold(0.0f32, |most, w| most.max(w.abs()));
            for (found, wanted) in acting(&rows, &worlds.rows).iter().zip(&worlds.rows) {
                let off = (found - wanted).abs() / most;
                assert!(off <= 1e-4, "{}: {found} instead of {wanted}", what("rows"));
            }
        }
    }
}
