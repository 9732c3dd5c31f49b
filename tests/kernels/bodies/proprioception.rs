//! `proprioception`.

use super::worlds::*;

#[test]
fn proprioception_agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 6);
        let model = &worlds.model;
        // Every humanoid of the scene knows where its first and its last body are.
        let width = |tree| proprioception::width(model, tree, 2);
        let humanoids = (0..model.trees.len()).filter(|&tree| width(tree) == width(0));
        let lists = humanoids.flat_map(|tree| {
            let bodies = &model.trees[tree].bodies;
            [tree, bodies.start, bodies.end - 1].map(|n| n as u32)
        });
        let characters: Vec<u32> = [2].into_iter().chain(lists).collect();
        let params = proprioception::Params {
            envs: envs as u32,
            characters: characters.len() as u32 / 3,
            width: proprioception::width(model, 0, 2) as u32,
        };
        let len = (params.characters * params.envs * params.width) as usize;
        let mut wanted = vec![POISON; len];
        let blank = wanted.clone();
        proprioception::twin(
            model,
            &worlds.state,
            &worlds.poses,
            &worlds.dynamics,
            &characters,
            &mut wanted,
            &params,
        );
        let gpu = gpu();
        let felt = up(&gpu, &blank);
        proprioception::launch(
            &gpu,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.state),
            &up(&gpu, &worlds.poses),
            &up(&gpu, &worlds.dynamics),
            &up(&gpu, &characters),
            &felt,
            &params,
        );
        let buffers: [&[u8]; 6] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.state),
            cast_slice(&worlds.poses),
            cast_slice(&worlds.dynamics),
            cast_slice(&characters),
            cast_slice(&blank),
        ];
        let invocations = (params.characters * params.envs) as usize;
        let groups = groups(&shader::PROPRIOCEPTION, invocations);
        let outcome = checked::run(&shader::PROPRIOCEPTION, groups, &buffers, &params);
        for (form, felt) in [
            ("launch", felt.read(&gpu).unwrap()),
            ("checked", outcome.of(5)),
        ] {
            near(&format!("{scene}, {form}"), &felt, &wanted, 1, 0..len, 1e-5);
        }
    }
}
