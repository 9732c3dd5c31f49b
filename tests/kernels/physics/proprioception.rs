use super::worlds::*;

#[test]
fn agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 6);
        let model = &worlds.model;
        // The first and the last body of every humanoid of the scene are its key bodies.
        let width = |tree| proprioception::width(model, tree, 2);
        let humanoids = (0..model.trees.len()).filter(|&tree| width(tree) == width(0));
        let lists = humanoids.flat_map(|tree| {
            let bodies = &model.trees[tree].bodies;
            [tree, bodies.start, bodies.end - 1].map(|n| n as u32)
        });
        let characters: Vec<u32> = [2].into_iter().chain(lists).collect();
        let termination: Vec<u32> = (0..envs as u32).map(|env| env % 4).collect();
        for only in [u32::MAX, 1 << 2] {
            let params = proprioception::Params {
                envs: envs as u32,
                characters: characters.len() as u32 / 3,
                width: width(0) as u32,
                at: 3,
                only,
            };
            let rows = (params.characters * params.envs) as usize;
            let len = 3 + rows * width(0);
            let forms = forms!(
                proprioception, PROPRIOCEPTION, rows, params;
                &worlds.model => worlds.model_table, worlds.state, worlds.poses, worlds.dynamics,
                characters, termination, out len
            );
            let twin: &Vec<f32> = &forms.twin;
            for (form, observation) in forms.shaders() {
                near(
                    &format!("{scene}, {form}"),
                    observation,
                    twin,
                    1,
                    0..len,
                    1e-5,
                );
            }
            for (row, observation) in twin[3..].chunks_exact(width(0)).enumerate() {
                let env = row / params.characters as usize;
                let observed = only >> termination[env] & 1 == 1;
                assert!(
                    observation
                        .iter()
                        .all(|&value| (value != POISON) == observed)
                );
            }
        }
    }
}
