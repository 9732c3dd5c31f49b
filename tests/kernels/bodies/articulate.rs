//! `articulate`.

use super::worlds::*;

#[test]
fn articulate_agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 1);
        let (params, at) = (worlds.articulate_params(), DynamicsLayout::of(&worlds.model));
        let trees = worlds.model.trees.len();
        let blank = (
            vec![POISON; worlds.poses.len()],
            vec![POISON; worlds.dynamics.len()],
        );
        let gpu = gpu();
        let (poses, dynamics) = (up(&gpu, &blank.0), up(&gpu, &blank.1));
        articulate::launch(
            &gpu,
            trees,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.state),
            &up(&gpu, &worlds.targets),
            &up(&gpu, &worlds.external_forces),
            &poses,
            &dynamics,
            &params,
        );
        let launched = (poses.read(&gpu).unwrap(), dynamics.read(&gpu).unwrap());
        let buffers: [&[u8]; 6] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.state),
            cast_slice(&worlds.targets),
            cast_slice(&worlds.external_forces),
            cast_slice(&blank.0),
            cast_slice(&blank.1),
        ];
        let groups = [envs.div_ceil(64) as u32, trees as u32, 1];
        let outcome = checked::run(&shader::SMOOTH_DYNAMICS, groups, &buffers, &params);
        let checked = (outcome.of(4), outcome.of(5));
        for (form, (poses, dynamics)) in [("launch", launched), ("checked", checked)] {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            near(
                &what("poses"),
                &poses,
                &worlds.poses,
                envs,
                0..POSE_DIM * worlds.model.bodies.len(),
                1e-5,
            );
            for (section, range, bar) in [
                ("axes", 0..at.factors, 1e-5),
                ("factors", at.factors..at.qacc_whitened, 1e-4),
                ("qacc_whitened", at.qacc_whitened..at.velocities, 1e-4),
                ("velocities", at.velocities..at.len, 1e-5),
            ] {
                near(
                    &what(section),
                    &dynamics,
                    &worlds.dynamics,
                    envs,
                    range,
                    bar,
                );
            }
        }
    }
}
