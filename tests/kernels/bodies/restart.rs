//! `restart`.

use super::worlds::*;

#[test]
fn restart_agrees() {
    for (scene, model, envs) in scenes() {
        let mut worlds = Worlds::new(model, envs, 5);
        let starts = worlds.state.clone();
        worlds.solve();
        let positions = worlds.model.positions();
        let mask: Vec<u32> = (0..envs as u32)
            .map(|env| u32::from(env % 3 == 1))
            .collect();
        worlds.state[0] = f32::NAN;
        worlds.state[5 * envs + 4] = f32::NEG_INFINITY;
        worlds.state[(positions + 2) * envs + 3] = 2000.0;
        worlds.state[positions * envs + 6] = 900.0;
        let params = restart::Params {
            envs: envs as u32,
            fastest: 1000.0,
        };
        let gpu = gpu();
        let (state, warm) = (up(&gpu, &worlds.state), up(&gpu, &worlds.warm));
        let forces = up(&gpu, &worlds.forces);
        let tallies = up(&gpu, &worlds.tallies);
        restart::launch(
            &gpu,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &mask),
            &up(&gpu, &starts),
            &state,
            &warm,
            &up(&gpu, &worlds.watched),
            &forces,
            &tallies,
            &params,
        );
        let buffers: [&[u8]; 8] = [
            cast_slice(&worlds.tables),
            cast_slice(&mask),
            cast_slice(&starts),
            cast_slice(&worlds.state),
            cast_slice(&worlds.warm),
            cast_slice(&worlds.watched),
            cast_slice(&worlds.forces),
            cast_slice(&worlds.tallies),
        ];
        let outcome = checked::run(
            &shader::RESET_WORLDS,
            groups(&shader::RESET_WORLDS, envs),
            &buffers,
            &params,
        );
        restart::twin(
            &worlds.model.clone(),
            worlds.settings.slots,
            &mask,
            &starts,
            &mut worlds.state,
            &mut worlds.warm,
            &worlds.watched,
            &mut worlds.forces,
            &mut worlds.tallies,
            &params,
        );
        let broken = &worlds.tallies[blows::BROKEN * envs..][..envs];
        assert_eq!(broken.iter().sum::<u32>(), 3, "{scene}");
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let launched = (
            state.read(&gpu).unwrap(),
            warm.read(&gpu).unwrap(),
            forces.read(&gpu).unwrap(),
            tallies.read(&gpu).unwrap(),
        );
        let checked = (outcome.of(3), outcome.of(4), outcome.of(6), outcome.of(7));
        for (form, (state, warm, forces, tallies)) in [("launch", launched), ("checked", checked)] {
            assert_eq!(bits(&state), bits(&worlds.state), "{scene}, {form}");
            assert_eq!(warm, worlds.warm, "{scene}, {form}");
            assert_eq!(forces, worlds.forces, "{scene}, {form}");
            assert_eq!(tallies, worlds.tallies, "{scene}, {form}");
        }
    }
}
