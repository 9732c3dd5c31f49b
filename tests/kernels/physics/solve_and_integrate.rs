use super::worlds::*;
use footwork::kernels::physics::solve_and_integrate::{
    read_warm_start, warm_start_room, with_room, write_warm_start,
};
use footwork::physics::scenes::humanoid;
use footwork::physics::simulator::SimulatorState;

#[test]
fn agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 3);
        let params = worlds.solve_and_integrate_params();
        let forms = forms!(
            solve_and_integrate, SOLVE_AND_INTEGRATE, envs, params;
            &mut worlds.simulator() => worlds.model_table, mut worlds.state, worlds.dynamics,
            worlds.rows, worlds.constraints, worlds.contact_ids, worlds.counts,
            mut worlds.warm_start
        );
        let twin: &(Vec<f32>, Vec<u32>) = &forms.twin;
        let (max_contacts, joints) = (worlds.options.max_contacts, worlds.model.joints.len());
        let (nq, nv) = (worlds.model.nq(), worlds.model.nv());
        let dim = warm_start_dim(max_contacts, joints);
        for (form, (state, warm_start)) in forms.shaders() {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            near(&what("positions"), state, &twin.0, envs, 0..nq, 1e-4);
            near(&what("velocities"), state, &twin.0, envs, nq..nq + nv, 1e-3);
            let ids = max_contacts * envs;
            assert_eq!(warm_start[..ids], twin.1[..ids], "{}", what("ids"));
            let forces = |warm_start: &[u32]| -> Vec<f32> {
                let forces = warm_start[ids..].iter();
                forces.map(|&force| f32::from_bits(force)).collect()
            };
            let (found, wanted) = (forces(warm_start), forces(&twin.1));
            near(
                &what("forces"),
                &found,
                &wanted,
                envs,
                0..dim - max_contacts,
                1e-2,
            );
        }
    }
}

#[test]
fn warm_starts_move_to_another_room() {
    let (model, envs) = (humanoid(), 3);
    let joints = model.joints.len();
    let mut warm_start = vec![0; warm_start_dim(20, joints) * envs];
    for env in 0..envs {
        let count = 6 * env as u32;
        let world = SimulatorState {
            contact_ids: (0..count).collect(),
            contact_forces: (0..count).map(|id| [id as f32; 4]).collect(),
            limit_forces: (0..joints).map(|joint| joint as f32).collect(),
            ..SimulatorState::new(&model)
        };
        write_warm_start(&world, &mut warm_start, envs, env, 20);
    }
    assert_eq!(warm_start_room(warm_start.len() / envs, joints), 20);
    let larger = with_room(&model, &warm_start, envs, [20, 32]);
    assert_eq!(with_room(&model, &larger, envs, [32, 20]), warm_start);
    // Those beyond a smaller one are forgotten.
    let smaller = with_room(&model, &warm_start, envs, [20, 8]);
    let mut world = SimulatorState::new(&model);
    read_warm_start(&smaller, envs, 2, 8, &mut world);
    assert_eq!(world.contact_ids, (0..8).collect::<Vec<u32>>());
    assert_eq!(world.contact_forces[7], [7.0; 4]);
    assert_eq!(world.limit_forces[joints - 1], (joints - 1) as f32);
}
