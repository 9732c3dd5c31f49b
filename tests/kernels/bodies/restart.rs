//! `restart`.

use super::worlds::*;

#[test]
fn restart_agrees() {
    for (scene, model, envs) in scenes() {
        let mut worlds = Worlds::new(model, envs, 5);
        let starts = worlds.state.clone();
        worlds.solve();
        let positions = worlds.model.nq();
        let mask: Vec<u32> = (0..envs as u32)
            .map(|env| u32::from(env % 3 == 1))
            .collect();
        worlds.state[0] = f32::NAN;
        worlds.state[5 * envs + 4] = f32::NEG_INFINITY;
        worlds.state[(positions + 2) * envs + 3] = 2000.0;
        worlds.state[positions * envs + 6] = 900.0;
        let params = restart::Params {
            envs: envs as u32,
            max_speed: 1000.0,
        };
        let gpu = gpu();
        let (state, warm_start) = (up(&gpu, &worlds.state), up(&gpu, &worlds.warm_start));
        let forces = up(&gpu, &worlds.forces);
        let counters = up(&gpu, &worlds.counters);
        restart::launch(
            &gpu,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &mask),
            &up(&gpu, &starts),
            &state,
            &warm_start,
            &up(&gpu, &worlds.force_pairs),
            &forces,
            &counters,
            &params,
        );
        let buffers: [&[u8]; 8] = [
            cast_slice(&worlds.tables),
            cast_slice(&mask),
            cast_slice(&starts),
            cast_slice(&worlds.state),
            cast_slice(&worlds.warm_start),
            cast_slice(&worlds.force_pairs),
            cast_slice(&worlds.forces),
            cast_slice(&worlds.counters),
        ];
        let outcome = checked::run(
            &shader::RESET_WORLDS,
            groups(&shader::RESET_WORLDS, envs),
            &buffers,
            &params,
        );
        restart::twin(
            &worlds.model.clone(),
            worlds.settings.max_contacts,
            &mask,
            &starts,
            &mut worlds.state,
            &mut worlds.warm_start,
            &worlds.force_pairs,
            &mut worlds.forces,
            &mut worlds.counters,
            &params,
        );
        let diverged = &worlds.counters[blows::DIVERGED * envs..][..envs];
        assert_eq!(diverged.iter().sum::<u32>(), 3, "{scene}");
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let launched = (
            state.read(&gpu).unwrap(),
            warm_start.read(&gpu).unwrap(),
            forces.read(&gpu).unwrap(),
            counters.read(&gpu).unwrap(),
        );
        let checked = (outcome.of(3), outcome.of(4), outcome.of(6), outcome.of(7));
        for (form, (state, warm_start, forces, counters)) in [("launch", launched), ("checked", checked)] {
            assert_eq!(bits(&state), bits(&worlds.state), "{scene}, {form}");
            assert_eq!(warm_start, worlds.warm_start, "{scene}, {form}");
            assert_eq!(forces, worlds.forces, "{scene}, {form}");
            assert_eq!(counters, worlds.counters, "{scene}, {form}");
        }
    }
}
