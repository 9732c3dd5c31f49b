//! Batches of worlds on the host, and what their kernels are compared by.

pub(super) use crate::inputs::{POISON, same};
pub(super) use footwork::kernels::physics::make_constraints::{self, CONSTRAINT_DIM, CONTACT_DIM};
pub(super) use footwork::kernels::physics::smooth_dynamics::{self, DynamicsLayout, POSE_DIM};
pub(super) use footwork::kernels::physics::solve_and_integrate::{self, warm_start_dim};
pub(super) use footwork::kernels::physics::{
    collision, contact_forces, proprioception, random_targets, reset_worlds,
};
pub(super) use footwork::physics::scenes;

use crate::inputs::{Draw, POISON_WHOLE};
use footwork::kernels::physics::model_table::model_table;
use footwork::kernels::physics::strided::gather;
use footwork::physics::mjcf;
use footwork::physics::model::{JointKind, Model};
use footwork::physics::simulator::{Simulator, SimulatorState, SolverOptions};
use glam::{Quat, Vec3};
use std::path::Path;
use std::sync::Arc;

/// All buffers of a batch, on the host.
#[derive(Clone)]
pub struct Worlds {
    pub model: Arc<Model>,
    pub options: SolverOptions,
    pub envs: usize,
    pub model_table: Vec<u32>,
    pub force_pairs: Vec<u32>,
    pub state: Vec<f32>,
    pub targets: Vec<f32>,
    pub external_forces: Vec<f32>,
    pub poses: Vec<f32>,
    pub dynamics: Vec<f32>,
    pub contacts: Vec<f32>,
    pub contact_ids: Vec<u32>,
    pub counts: Vec<u32>,
    pub rows: Vec<f32>,
    pub constraints: Vec<f32>,
    pub warm_start: Vec<u32>,
    pub forces: Vec<f32>,
    pub counters: Vec<u32>,
}

/// A random state: characters in any attitude near the ground, some joints past their ranges.
pub fn random_state(model: &Model, draw: &mut Draw) -> SimulatorState {
    let mut state = SimulatorState::new(model);
    let rotation = |draw: &mut Draw, most: f32| {
        let axis = Vec3::new(draw.normal(), draw.normal(), draw.normal()).normalize();
        let [x, y, z, w] = Quat::from_axis_angle(axis, draw.within(most)).to_array();
        [w, x, y, z]
    };
    for joint in &model.joints {
        let q = &mut state.q[joint.q..];
        match joint.kind {
            JointKind::Free => {
                q[0] += draw.within(0.3);
                q[1] += draw.within(0.3);
                q[2] = 0.5 + draw.within(0.4);
                q[3..7].copy_from_slice(&rotation(draw, 3.0));
            }
            JointKind::Ball => q[..4].copy_from_slice(&rotation(draw, 1.5)),
            JointKind::Hinge => {
                let [low, high] = joint.range.unwrap_or([-1.0, 1.0]);
                q[0] = 0.5 * (low + high) + draw.within(0.55 * (high - low));
            }
        }
    }
    for v in &mut state.v {
        *v = draw.normal();
    }
    state
}

impl Worlds {
    pub fn new(model: Model, envs: usize, seed: u32) -> Worlds {
        let model = Arc::new(model);
        let options = SolverOptions::fast(&model);
        let (max_contacts, joints) = (options.max_contacts, model.joints.len());
        let bodies = model.bodies.len();
        let quads = model.dofs.len().div_ceil(4);
        let mut draw = Draw::new(seed);
        let mut state = vec![0.0; (model.nq() + model.nv()) * envs];
        for env in 0..envs {
            smooth_dynamics::write(
                &model,
                &mut state,
                envs,
                env,
                &random_state(&model, &mut draw),
            );
        }
        let force_pairs: Vec<u32> = vec![2, 0, 1, 2, bodies as u32 - 1];
        let rows = make_constraints::rows(&model, max_contacts) * quads * 4;
        let poison = |fields: usize| vec![POISON; fields * envs];
        let targets = draw.normals(model.nu() * envs);
        let mut external_forces = vec![0.0; 6 * bodies * envs];
        for force in external_forces.iter_mut().step_by(7) {
            *force = draw.within(50.0);
        }
        let mut warm_start = vec![0; warm_start_dim(max_contacts, joints) * envs];
        warm_start[..max_contacts * envs].fill(solve_and_integrate::NO_CONTACT);
        let mut worlds = Worlds {
            model_table: model_table(&model, &options).expect("it fits"),
            forces: poison(3 * (bodies + force_pairs.len() / 2)),
            force_pairs,
            state,
            targets,
            external_forces,
            poses: poison(POSE_DIM * bodies),
            dynamics: poison(DynamicsLayout::new(&model).len),
            contacts: poison(CONTACT_DIM * max_contacts),
            contact_ids: vec![POISON_WHOLE; max_contacts * envs],
            counts: vec![POISON_WHOLE; 2 * envs],
            rows: poison(rows),
            constraints: poison((max_contacts + joints) * CONSTRAINT_DIM),
            warm_start,
            counters: vec![0; contact_forces::COUNTERS * envs],
            envs,
            options,
            model,
        };
        worlds.step();
        // Forces to remember.
        worlds.step();
        // What is not written from here on must be poison.
        worlds.contacts.fill(POISON);
        worlds.rows.fill(POISON);
        worlds.constraints.fill(POISON);
        worlds.smooth_dynamics();
        worlds.collision();
        worlds.make_constraints();
        worlds
    }

    pub fn simulator(&self) -> Simulator {
        Simulator::new(self.model.clone(), self.options)
    }

    pub fn smooth_dynamics_params(&self) -> smooth_dynamics::Params {
        smooth_dynamics::Params {
            envs: self.envs as u32,
            dt: self.options.dt,
            trees: self.model.trees.len() as u32,
            kinematics_only: 0,
        }
    }

    pub fn smooth_dynamics(&mut self) {
        let params = self.smooth_dynamics_params();
        smooth_dynamics::twin(
            &mut self.simulator(),
            &self.state,
            &self.targets,
            &self.external_forces,
            &mut self.poses,
            &mut self.dynamics,
            &params,
        );
    }

    pub fn collision(&mut self) {
        collision::twin(
            &self.model,
            &self.poses,
            &mut self.contacts,
            &mut self.contact_ids,
            &mut self.counts,
            &collision::Params {
                envs: self.envs as u32,
                max_contacts: self.options.max_contacts as u32,
            },
        );
    }

    pub fn make_constraints_params(&self) -> make_constraints::Params {
        make_constraints::Params {
            envs: self.envs as u32,
            dt: self.options.dt,
            row_groups: make_constraints::row_groups(&self.model, self.options.max_contacts),
        }
    }

    pub fn make_constraints(&mut self) {
        let params = self.make_constraints_params();
        make_constraints::twin(
            &mut self.simulator(),
            &self.state,
            &self.dynamics,
            &self.contacts,
            &self.contact_ids,
            &self.counts,
            &mut self.rows,
            &mut self.constraints,
            &params,
        );
    }

    pub fn solve_and_integrate_params(&self) -> solve_and_integrate::Params {
        solve_and_integrate::Params {
            envs: self.envs as u32,
            dt: self.options.dt,
        }
    }

    pub fn solve_and_integrate(&mut self) {
        let params = self.solve_and_integrate_params();
        solve_and_integrate::twin(
            &mut self.simulator(),
            &mut self.state,
            &self.dynamics,
            &self.rows,
            &self.constraints,
            &self.contact_ids,
            &self.counts,
            &mut self.warm_start,
            &params,
        );
    }

    pub fn step(&mut self) {
        self.smooth_dynamics();
        self.collision();
        self.make_constraints();
        self.solve_and_integrate();
    }
}

pub fn scenes() -> [(&'static str, Model, usize); 4] {
    [
        ("humanoid", scenes::humanoid(), 65),
        ("boxing", scenes::boxing_match(), 9),
        ("box", scenes::humanoid_and_box(), 9),
        ("odd", mjcf::parse(ODD, Path::new("odd.xml")).unwrap(), 9),
    ]
}

/// A tree that is fastened, two hinges in a body, bodies without drive or mass, springs, dampers and motors,
/// contacts without friction and with another rise of impedance.
pub const ODD: &str = r#"<mujoco model="odd">
  <worldbody>
    <geom name="ground" type="plane" size="0 0 1"/>
    <body name="mast" pos="0 0 .09">
      <joint name="yaw" axis="0 0 1" stiffness="6" damping=".3" springref="20"/>
      <joint name="pitch" axis="0 1 0" range="-60 60"/>
      <geom name="mast" type="capsule" fromto="0 0 0 .3 0 0" size=".1" condim="1"/>
      <body name="tip" pos=".3 0 0"/>
      <body name="arm" pos=".3 0 0">
        <joint name="arm" axis="0 0 1" range="-90 90"/>
        <geom name="arm" type="capsule" fromto="0 0 0 .3 0 0" size=".05" solimp=".8 .95 .01 .3 3"/>
      </body>
    </body>
    <body name="ball" pos=".2 0 .5">
      <joint name="ball" type="free" damping=".4"/>
      <geom name="ball" size=".15" condim="1"/>
      <body name="pendulum">
        <joint name="pendulum" type="ball" stiffness="2" damping=".1"/>
        <geom name="pendulum" type="box" size=".05 .05 .2" pos="0 0 -.2"/>
      </body>
    </body>
  </worldbody>
  <actuator><position name="arm" joint="arm" kp="50" kv="5" forcerange="-10 10"/>
    <motor joint="pitch" gear="-15" ctrlrange="-.3 .5"/><motor joint="pendulum" gear="0 0 4" forcerange="-.5 .5"/></actuator>
</mujoco>"#;

/// Compares fields `from..to` of `[fields][envs]`, an environment at a time.
#[track_caller]
pub fn near(
    what: &str,
    found: &[f32],
    wanted: &[f32],
    envs: usize,
    fields: std::ops::Range<usize>,
    bar: f32,
) {
    for env in 0..envs {
        let mut pair = [vec![0.0; fields.len()], vec![0.0; fields.len()]];
        gather(found, envs, env, fields.start, &mut pair[0]);
        gather(wanted, envs, env, fields.start, &mut pair[1]);
        let size = pair[1].iter().fold(1e-3f32, |most, v| most.max(v.abs()));
        for (field, (found, wanted)) in pair[0].iter().zip(&pair[1]).enumerate() {
            let off = (found - wanted).abs() / size;
            assert!(
                off <= bar,
                "{what}, environment {env}, field {field}: {found} instead of {wanted} (of {size})"
            );
        }
    }
}
