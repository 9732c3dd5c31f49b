//! `blows`.

use super::worlds::*;

#[test]
fn blows_agree() {
    for (scene, model, envs) in scenes() {
        let mut worlds = Worlds::new(model, envs, 4);
        worlds.solve();
        let params = blows::Params {
            envs: envs as u32,
            max_contacts: worlds.settings.max_contacts as u32,
            first: 1,
            share: 0.25,
        };
        let gpu = gpu();
        let (forces, counters) = (up(&gpu, &worlds.forces), up(&gpu, &worlds.counters));
        blows::launch(
            &gpu,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.contacts),
            &up(&gpu, &worlds.contact_ids),
            &up(&gpu, &worlds.counts),
            &up(&gpu, &worlds.warm_start),
            &up(&gpu, &worlds.force_pairs),
            &forces,
            &counters,
            &params,
        );
        let buffers: [&[u8]; 8] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.contacts),
            cast_slice(&worlds.contact_ids),
            cast_slice(&worlds.counts),
            cast_slice(&worlds.warm_start),
            cast_slice(&worlds.force_pairs),
            cast_slice(&worlds.forces),
            cast_slice(&worlds.counters),
        ];
        let outcome = checked::run(
            &shader::CONTACT_FORCES,
            groups(&shader::CONTACT_FORCES, envs),
            &buffers,
            &params,
        );
        let model = worlds.model.clone();
        blows::twin(
            &model,
            &worlds.contacts,
            &worlds.contact_ids,
            &worlds.counts,
            &worlds.warm_start,
            &worlds.force_pairs,
            &mut worlds.forces,
            &mut worlds.counters,
            &params,
        );
        let fields = worlds.forces.len() / envs;
        for (form, forces, counters) in [
            (
                "launch",
                forces.read(&gpu).unwrap(),
                counters.read(&gpu).unwrap(),
            ),
            ("checked", outcome.of(6), outcome.of(7)),
        ] {
            near(
                &format!("{scene}, {form}"),
                &forces,
                &worlds.forces,
                envs,
                0..fields,
                1e-4,
            );
            assert_eq!(counters, worlds.counters, "{scene}, {form}");
        }
    }
}
