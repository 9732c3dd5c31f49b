//! `blows`.

use super::worlds::*;

#[test]
fn blows_agree() {
    for (scene, model, envs) in scenes() {
        let mut worlds = Worlds::new(model, envs, 4);
        worlds.solve();
        let params = blows::Params {
            envs: envs as u32,
            slots: worlds.settings.slots as u32,
            first: 1,
            share: 0.25,
        };
        let gpu = gpu();
        let (forces, tallies) = (up(&gpu, &worlds.forces), up(&gpu, &worlds.tallies));
        blows::launch(
            &gpu,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.touches),
            &up(&gpu, &worlds.keys),
            &up(&gpu, &worlds.counts),
            &up(&gpu, &worlds.warm),
            &up(&gpu, &worlds.watched),
            &forces,
            &tallies,
            &params,
        );
        let buffers: [&[u8]; 8] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.touches),
            cast_slice(&worlds.keys),
            cast_slice(&worlds.counts),
            cast_slice(&worlds.warm),
            cast_slice(&worlds.watched),
            cast_slice(&worlds.forces),
            cast_slice(&worlds.tallies),
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
            &worlds.touches,
            &worlds.keys,
            &worlds.counts,
            &worlds.warm,
            &worlds.watched,
            &mut worlds.forces,
            &mut worlds.tallies,
            &params,
        );
        let fields = worlds.forces.len() / envs;
        for (form, forces, tallies) in [
            (
                "launch",
                forces.read(&gpu).unwrap(),
                tallies.read(&gpu).unwrap(),
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
            assert_eq!(tallies, worlds.tallies, "{scene}, {form}");
        }
    }
}
