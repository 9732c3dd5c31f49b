//! One world, step by step: what [`step`](Simulator::step) computes is what the shaders compute for
//! thousands of worlds, and its parts are their twins.

use super::collision::{DetectedContacts, detect_contacts};
use super::constraints::{
    ConstraintRows, ContactConstraint, Lane, LimitConstraint, contact_constraints,
    limit_constraints,
};
use super::drive::{Effort, efforts, limit, spring_efforts};
use super::dynamics::{bias, inertias, mass_matrix};
use super::factor::{LANES, columns, factor, solve_l, solve_lt};
use super::integrate::integrate;
use super::kinematics::{kinematics, origin, velocities};
use super::model::Model;
use super::pgs::{ResponseBlock, along, pgs};
use super::pose::Pose;
use super::spatial::{Inertia, Spatial};
use glam::Vec3;
use std::sync::Arc;

/// Choices of the time step and the constraint solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverOptions {
    /// Length of a step, s.
    pub dt: f32,
    /// Iterations of projected Gauss-Seidel.
    pub iterations: u32,
    /// Contacts that a world on a GPU has room for. On the CPU it takes what it needs, up to
    /// [`MOST_CONTACTS`].
    pub max_contacts: usize,
}

/// Steps a second of the simulation.
pub const STEP_RATE: f32 = 120.0;
/// Steps of one action.
pub const SUBSTEPS: usize = 4;
/// Contacts that there is room for on a GPU, for each character and at least for a world.
pub const MAX_CONTACTS: usize = 16;
/// Contacts that a world on the CPU may have: more are a heap of shapes inside each other, and would take
/// all memory.
pub const MOST_CONTACTS: usize = 4096;

impl SolverOptions {
    /// Enough iterations for training.
    pub fn fast(model: &Model) -> SolverOptions {
        SolverOptions {
            dt: 1.0 / STEP_RATE,
            iterations: 20,
            max_contacts: MAX_CONTACTS * model.trees.len().clamp(1, 2),
        }
    }

    /// Enough iterations to be compared with a solver that converges.
    pub fn converged(model: &Model) -> SolverOptions {
        SolverOptions {
            iterations: 100,
            ..SolverOptions::fast(model)
        }
    }
}

/// What a world carries from one step to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimulatorState {
    /// Positions, `[nq]`.
    pub q: Vec<f32>,
    /// Velocities, `[nv]`.
    pub v: Vec<f32>,
    /// Ids of the contacts of the last step.
    pub contact_ids: Vec<u32>,
    /// Forces of the edges of those contacts, N.
    pub contact_forces: Vec<[f32; 4]>,
    /// Forces of the joints' limits in the last step, `[joints]`, N or Nm.
    pub limit_forces: Vec<f32>,
}

impl SimulatorState {
    /// The model's initial positions, at rest.
    pub fn new(model: &Model) -> SimulatorState {
        SimulatorState {
            q: model.qpos0.clone(),
            v: vec![0.0; model.nv()],
            limit_forces: vec![0.0; model.joints.len()],
            ..SimulatorState::default()
        }
    }

    /// Forces of a contact's edges in the last step, zero if there was no such contact.
    pub fn warm_start_forces(&self, id: u32) -> [f32; 4] {
        let index = self.contact_ids.iter().position(|&before| before == id);
        index.map_or([0.0; 4], |index| self.contact_forces[index])
    }

    /// Forgets the forces, so that the next step begins without a guess.
    pub fn clear_warm_start(&mut self) {
        self.contact_ids.clear();
        self.contact_forces.clear();
        self.limit_forces.fill(0.0);
    }
}

/// A world's workspace: everything a step computes on the way, for whoever wants to see it.
#[derive(Clone, Debug)]
pub struct Simulator {
    /// Model of the worlds, which are all alike.
    pub model: Arc<Model>,
    /// Time step, solver iterations and room for contacts.
    pub options: SolverOptions,
    columns: Vec<usize>,
    /// Poses of the bodies in the world, `[bodies]`.
    pub poses: Vec<Pose>,
    /// Motions of the degrees of freedom about their trees' origins, `[nv]`.
    pub axes: Vec<Spatial>,
    /// Velocities of the bodies about their trees' origins, `[bodies]`.
    pub velocities: Vec<Spatial>,
    inertias: Vec<Inertia>,
    body_forces: Vec<Spatial>,
    /// Bias forces, `[nv]`.
    pub bias: Vec<f32>,
    /// Packed mass matrix with armature, `[nm]`.
    pub mass_matrix: Vec<f32>,
    /// Its factor L, with what is implicit in the drives, `[nm]`.
    pub factors: Vec<f32>,
    efforts: Vec<Effort>,
    springs: Vec<Effort>,
    /// Accelerations without constraints, `[nv]`.
    pub qacc_smooth: Vec<f32>,
    /// Unconstrained acceleration, whitened by the factor of the mass matrix: L qacc.
    pub qacc_whitened: Vec<f32>,
    /// Contacts that the last step, or [`forward`](Self::forward), detected.
    pub contacts: DetectedContacts,
    /// Constraint rows: one for each limit, then three for each contact.
    pub rows: ConstraintRows,
    /// Joints past their limits, with the forces found.
    pub limit_constraints: Vec<LimitConstraint>,
    /// Contacts as constraints, in the order of `contacts.points`, with the forces found.
    pub contact_constraints: Vec<ContactConstraint>,
    block: Vec<[f32; LANES]>,
    blocks: Vec<ResponseBlock>,
    acceleration: Vec<Lane>,
}

impl Simulator {
    /// A workspace for worlds of a model.
    pub fn new(model: Arc<Model>, options: SolverOptions) -> Simulator {
        let (bodies, dofs) = (model.bodies.len(), model.dofs.len());
        let rows = ConstraintRows::new(dofs);
        Simulator {
            columns: columns(&model),
            poses: vec![Pose::default(); bodies],
            axes: vec![Spatial::ZERO; dofs],
            velocities: vec![Spatial::ZERO; bodies],
            inertias: vec![Inertia::default(); bodies],
            body_forces: vec![Spatial::ZERO; bodies],
            bias: vec![0.0; dofs],
            mass_matrix: vec![0.0; model.nm()],
            factors: vec![0.0; model.nm()],
            efforts: vec![Effort::default(); dofs],
            springs: vec![Effort::default(); dofs],
            qacc_smooth: vec![0.0; dofs],
            qacc_whitened: vec![0.0; dofs],
            contacts: DetectedContacts::default(),
            limit_constraints: Vec::new(),
            contact_constraints: Vec::new(),
            block: vec![[0.0; LANES]; dofs],
            blocks: Vec::new(),
            acceleration: vec![[0.0; 8]; rows.stride],
            rows,
            options,
            model,
        }
    }

    /// Advances a world by one step. `targets`, `[nu]`, are the drives' (see [`efforts`]);
    /// `external_forces`, `[bodies]`, are torques and forces at the centres of mass in the world's frame.
    ///
    /// ```
    /// use footwork::physics::scenes::humanoid;
    /// use footwork::physics::simulator::{Simulator, SimulatorState, SolverOptions};
    /// use footwork::physics::spatial::Spatial;
    /// use std::sync::Arc;
    ///
    /// let model = Arc::new(humanoid());
    /// let mut state = SimulatorState::new(&model);
    /// let mut simulator = Simulator::new(model.clone(), SolverOptions::fast(&model));
    /// let (targets, forces) = (vec![0.0; model.nu()], vec![Spatial::ZERO; model.bodies.len()]);
    /// for _ in 0..120 {
    ///     simulator.step(&mut state, &targets, &forces);
    /// }
    /// // A second later it has not sunk into the ground. Positions begin with the root's, m.
    /// assert!(state.q[2] > 0.0 && state.q.iter().all(|q| q.is_finite()));
    /// ```
    pub fn step(
        &mut self,
        state: &mut SimulatorState,
        targets: &[f32],
        external_forces: &[Spatial],
    ) {
        self.forward(state, targets, external_forces);
        self.advance(state);
    }

    /// Integrates a state with the accelerations found, and stores the forces in it.
    pub fn advance(&self, state: &mut SimulatorState) {
        let acceleration = self.acceleration.as_flattened();
        integrate(
            &self.model,
            acceleration,
            self.options.dt,
            &mut state.q,
            &mut state.v,
        );
        state.contact_ids.clone_from(&self.contacts.ids);
        state.contact_forces.clear();
        let forces = self
            .contact_constraints
            .iter()
            .map(|contact| contact.forces);
        state.contact_forces.extend(forces);
        state.limit_forces.fill(0.0);
        for limit in &self.limit_constraints {
            state.limit_forces[limit.joint] = limit.force;
        }
    }

    /// Accelerations of the degrees of freedom, `[nv]`.
    pub fn qacc(&self) -> &[f32] {
        &self.acceleration.as_flattened()[..self.qacc_smooth.len()]
    }

    /// Computes the accelerations of a state, and all that leads to them.
    pub fn forward(
        &mut self,
        state: &SimulatorState,
        targets: &[f32],
        external_forces: &[Spatial],
    ) {
        self.inertia_and_bias(&state.q, &state.v);
        self.smooth_acceleration(state, targets, external_forces);
        detect_contacts(&self.model, &self.poses, MOST_CONTACTS, &mut self.contacts);
        self.make_constraints(state);
        self.solve();
    }

    /// Computes the accelerations under constraints.
    pub fn solve(&mut self) {
        let acceleration = self.acceleration.as_flattened_mut();
        acceleration.fill(0.0);
        acceleration[..self.qacc_whitened.len()].copy_from_slice(&self.qacc_whitened);
        pgs(
            &self.rows,
            self.options.iterations,
            &mut self.limit_constraints,
            &mut self.contact_constraints,
            &mut self.acceleration,
            &mut self.blocks,
        );
        let acceleration = self.acceleration.as_flattened_mut();
        solve_l(&self.model, &self.columns, &self.factors, acceleration);
    }

    /// Computes poses and velocities of the bodies in a state.
    pub fn kinematics(&mut self, q: &[f32], v: &[f32]) {
        kinematics(&self.model, q, &mut self.poses, &mut self.axes);
        velocities(&self.model, v, &self.axes, &mut self.velocities);
    }

    /// Computes poses, velocities, bias forces and the mass matrix of a state.
    pub fn inertia_and_bias(&mut self, q: &[f32], v: &[f32]) {
        let model = &self.model;
        kinematics(model, q, &mut self.poses, &mut self.axes);
        inertias(model, q, &self.poses, &mut self.inertias);
        bias(
            model,
            v,
            &self.axes,
            &self.inertias,
            &mut self.velocities,
            &mut self.body_forces,
            &mut self.bias,
        );
        mass_matrix(model, &self.axes, &mut self.inertias, &mut self.mass_matrix);
        for dof in &model.dofs {
            self.mass_matrix[dof.row] += dof.armature;
        }
    }

    /// Computes accelerations without constraints: by springs, drives, their limits, external forces.
    pub fn smooth_acceleration(
        &mut self,
        state: &SimulatorState,
        targets: &[f32],
        external_forces: &[Spatial],
    ) {
        let (q, v, dt) = (&state.q, &state.v, self.options.dt);
        spring_efforts(&self.model, q, v, dt, &mut self.springs);
        efforts(&self.model, q, v, targets, dt, &mut self.efforts);
        self.apply_external_forces(q, external_forces);
        self.solve_smooth();
        if limit(&self.model, &self.qacc_smooth, &mut self.efforts) {
            self.solve_smooth();
        }
    }

    /// Subtracts external forces from the bias.
    fn apply_external_forces(&mut self, q: &[f32], external_forces: &[Spatial]) {
        let bodies = self.model.bodies.iter().zip(external_forces).enumerate();
        for (index, (body, applied)) in bodies {
            if *applied == Spatial::ZERO {
                continue;
            }
            let arm = self.poses[index].at(body.com) - origin(&self.model, body.tree, q);
            let force = Spatial {
                angular: applied.angular + arm.cross(applied.linear),
                linear: applied.linear,
            };
            for dof in self.model.dof_ancestors(body.last_dof) {
                self.bias[dof] -= self.axes[dof].dot(force);
            }
        }
    }

    fn solve_smooth(&mut self) {
        self.factors.copy_from_slice(&self.mass_matrix);
        let efforts = self.efforts.iter().zip(&self.springs);
        for (index, (dof, (drive, spring))) in self.model.dofs.iter().zip(efforts).enumerate() {
            self.factors[dof.row] += drive.armature + spring.armature;
            self.qacc_whitened[index] = drive.force + spring.force - self.bias[index];
        }
        let (model, columns) = (&self.model, &self.columns);
        factor(model, columns, &mut self.factors);
        solve_lt(model, columns, &self.factors, &mut self.qacc_whitened);
        self.qacc_smooth.copy_from_slice(&self.qacc_whitened);
        solve_l(model, columns, &self.factors, &mut self.qacc_smooth);
    }

    /// Builds the constraints of limits and contacts, with whitened rows.
    pub fn make_constraints(&mut self, state: &SimulatorState) {
        let (model, dt) = (&self.model, self.options.dt);
        self.rows.clear();
        self.limit_constraints.clear();
        self.contact_constraints.clear();
        limit_constraints(
            model,
            &state.q,
            &state.v,
            &state.limit_forces,
            dt,
            &mut self.rows,
            &mut self.limit_constraints,
        );
        contact_constraints(
            model,
            &state.q,
            &state.v,
            &self.axes,
            &self.contacts,
            |id| state.warm_start_forces(id),
            dt,
            &mut self.rows,
            &mut self.contact_constraints,
        );
        self.rows
            .whiten(model, &self.columns, &self.factors, &mut self.block);
    }

    /// Force of each contact on its second geom, N, in the world's frame.
    pub fn contact_forces(&self) -> impl Iterator<Item = Vec3> {
        self.contacts
            .points
            .iter()
            .zip(&self.contact_constraints)
            .map(|(point, contact)| {
                let [normal, tangent, side] = along(contact.friction, &contact.forces);
                point.normal * normal
                    + point.tangent * tangent
                    + point.normal.cross(point.tangent) * side
            })
    }

    /// Net contact force on every body, N.
    pub fn body_forces(&self) -> Vec<Vec3> {
        let mut net = vec![Vec3::ZERO; self.model.bodies.len()];
        for (force, &id) in self.contact_forces().zip(&self.contacts.ids) {
            let [first, second] = self.model.pairs[(id / 8) as usize];
            if let Some(body) = self.model.geoms[second].body {
                net[body] += force;
            }
            if let Some(body) = self.model.geoms[first].body {
                net[body] -= force;
            }
        }
        net
    }
}
