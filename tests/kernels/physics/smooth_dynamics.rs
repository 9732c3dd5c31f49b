use super::worlds::*;

#[test]
fn agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 1);
        let at = DynamicsLayout::new(&worlds.model);
        let params = worlds.smooth_dynamics_params();
        let forms = forms!(
            smooth_dynamics, SMOOTH_DYNAMICS, [envs.div_ceil(64) as u32, params.trees, 1], params;
            &mut worlds.simulator() => worlds.model_table, worlds.state, worlds.targets,
            worlds.external_forces, out worlds.poses.len(), out worlds.dynamics.len()
        );
        let twin: &(Vec<f32>, Vec<f32>) = &forms.twin;
        for (form, (poses, dynamics)) in forms.shaders() {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            let fields = 0..POSE_DIM * worlds.model.bodies.len();
            near(&what("poses"), poses, &twin.0, envs, fields, 1e-5);
            for (section, range, bar) in [
                ("axes", 0..at.factors, 1e-5),
                ("factors", at.factors..at.qacc_whitened, 1e-4),
                ("qacc_whitened", at.qacc_whitened..at.velocities, 1e-4),
                ("velocities", at.velocities..at.len, 1e-5),
            ] {
                near(&what(section), dynamics, &twin.1, envs, range, bar);
            }
        }
    }
}

#[test]
fn kinematics_alone_agrees_and_leaves_the_rest() {
    let worlds = Worlds::new(scenes::boxing_match(), 65, 1);
    let at = DynamicsLayout::new(&worlds.model);
    let params = smooth_dynamics::Params {
        kinematics_only: 1,
        ..worlds.smooth_dynamics_params()
    };
    let forms = forms!(
        smooth_dynamics, SMOOTH_DYNAMICS, [2, params.trees, 1], params;
        &mut worlds.simulator() => worlds.model_table, worlds.state, worlds.targets,
        worlds.external_forces, out worlds.poses.len(), out worlds.dynamics.len()
    );
    let twin: &(Vec<f32>, Vec<f32>) = &forms.twin;
    for (form, (poses, dynamics)) in forms.all() {
        near(form, poses, &worlds.poses, 65, 0..POSE_DIM * 30, 1e-5);
        near(form, dynamics, &twin.1, 65, at.velocities..at.len, 1e-5);
        let rest = &dynamics[..at.velocities * 65];
        assert!(rest.iter().all(|&value| value == POISON), "{form}");
    }
    near(
        "velocities",
        &twin.1,
        &worlds.dynamics,
        65,
        at.velocities..at.len,
        1e-6,
    );
}
