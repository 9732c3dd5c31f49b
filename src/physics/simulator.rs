//! One world, step by step: what [`step`](Physics::step) computes is what the shaders compute for
//! thousands of worlds, and its parts are their twins.

use super::collision::{Contacts, find};
use super::constraints::{Contact, Lane, Limit, Rows, contacts, limits};
use super::drive::{Effort, efforts, limit};
use super::dynamics::{bias, inertias, mass_matrix};
use super::factor::{LANES, columns, factor, unweigh, weigh};
use super::integrate::integrate;
use super::kinematics::{kinematics, origin};
use super::model::Model;
use super::pose::Pose;
use super::spatial::{Inertia, Spatial};
use super::pgs::{Block, along, sweep};
use glam::Vec3;
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Seconds of a step.
    pub dt: f32,
    /// Rounds of projected Gauss-Seidel.
    pub sweeps: u32,
    /// Contacts a world has room for.
    pub slots: usize,
}

/// Steps a second of the simulation.
pub const STEP_RATE: f32 = 120.0;
/// Steps for one action.
pub const SUBSTEPS: usize = 4;
/// Contacts for each articulated character, and for a world at least.
pub const SLOTS: usize = 16;

impl Settings {
    /// Enough rounds to train.
    pub fn training(model: &Model) -> Settings {
        Settings {
            dt: 1.0 / STEP_RATE,
            sweeps: 20,
            slots: SLOTS * model.trees.len().clamp(1, 2),
        }
    }

    /// Enough rounds to be compared with a solver that converges.
    pub fn parity(model: &Model) -> Settings {
        Settings {
            sweeps: 100,
            ..Settings::training(model)
        }
    }
}

/// What a world carries from one step to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// `[positions]`
    pub q: Vec<f32>,
    /// `[dofs]`
    pub v: Vec<f32>,
    /// Contacts of the last step and the forces of their edges.
    pub keys: Vec<u32>,
    pub forces: Vec<[f32; 4]>,
    /// `[joints]`, forces at the ends of ranges.
    pub limits: Vec<f32>,
}

impl State {
    pub fn new(model: &Model) -> State {
        State {
            q: model.start.clone(),
            v: vec![0.0; model.velocities()],
            limits: vec![0.0; model.joints.len()],
            ..State::default()
        }
    }

    /// Forces of a contact's edges in the step before.
    pub fn remembered(&self, key: u32) -> [f32; 4] {
        let place = self.keys.iter().position(|&before| before == key);
        place.map_or([0.0; 4], |place| self.forces[place])
    }

    /// Forgets the forces, so that the next step begins without a guess.
    pub fn cool(&mut self) {
        self.keys.clear();
        self.forces.clear();
        self.limits.fill(0.0);
    }
}

/// A world's workspace: everything a step computes on the way, for whoever wants to see it.
#[derive(Clone, Debug)]
pub struct Physics {
    pub model: Arc<Model>,
    pub settings: Settings,
    columns: Vec<usize>,
    /// `[bodies]`
    pub poses: Vec<Pose>,
    /// `[dofs]`, about each tree's origin.
    pub axes: Vec<Spatial>,
    /// `[bodies]`, about each tree's origin.
    pub velocities: Vec<Spatial>,
    inertias: Vec<Inertia>,
    carried: Vec<Spatial>,
    /// `[dofs]`
    pub bias: Vec<f32>,
    /// Packed, with armature.
    pub matrix: Vec<f32>,
    pub factors: Vec<f32>,
    efforts: Vec<Effort>,
    /// Accelerations, `[dofs]`, were there no constraints, and the same mass-weighted.
    pub smooth: Vec<f32>,
    pub weighted: Vec<f32>,
    pub found: Contacts,
    pub rows: Rows,
    pub limits: Vec<Limit>,
    pub contacts: Vec<Contact>,
    block: Vec<[f32; LANES]>,
    blocks: Vec<Block>,
    acceleration: Vec<Lane>,
}

impl Physics {
    pub fn new(model: Arc<Model>, settings: Settings) -> Physics {
        let (bodies, dofs) = (model.bodies.len(), model.dofs.len());
        let rows = Rows::new(dofs);
        Physics {
            columns: columns(&model),
            poses: vec![Pose::default(); bodies],
            axes: vec![Spatial::ZERO; dofs],
            velocities: vec![Spatial::ZERO; bodies],
            inertias: vec![Inertia::default(); bodies],
            carried: vec![Spatial::ZERO; bodies],
            bias: vec![0.0; dofs],
            matrix: vec![0.0; model.packed()],
            factors: vec![0.0; model.packed()],
            efforts: vec![Effort::default(); dofs],
            smooth: vec![0.0; dofs],
            weighted: vec![0.0; dofs],
            found: Contacts::default(),
            limits: Vec::new(),
            contacts: Vec::new(),
            block: vec![[0.0; LANES]; dofs],
            blocks: Vec::new(),
            acceleration: vec![[0.0; 8]; rows.stride],
            rows,
            settings,
            model,
        }
    }

    /// Moves a world on by one step. `targets` are the drives' (see
    /// [`efforts`]); `pushes`, `[bodies]`, are
    /// torques and forces at the centres of mass, in the world's frame.
    pub fn step(&mut self, state: &mut State, targets: &[f32], pushes: &[Spatial]) {
        self.forward(state, targets, pushes);
        self.advance(state);
    }

    /// Moves a state on with the accelerations found, and has it remember the forces.
    pub fn advance(&self, state: &mut State) {
        let acceleration = self.acceleration.as_flattened();
        integrate(
            &self.model,
            acceleration,
            self.settings.dt,
            &mut state.q,
            &mut state.v,
        );
        state.keys.clone_from(&self.found.keys);
        state.forces.clear();
        state
            .forces
            .extend(self.contacts.iter().map(|contact| contact.forces));
        state.limits.fill(0.0);
        for limit in &self.limits {
            state.limits[limit.joint] = limit.force;
        }
    }

    /// Accelerations of the degrees of freedom, `[dofs]`.
    pub fn acceleration(&self) -> &[f32] {
        &self.acceleration.as_flattened()[..self.smooth.len()]
    }

    /// All that leads to the accelerations of a state.
    pub fn forward(&mut self, state: &State, targets: &[f32], pushes: &[Spatial]) {
        self.articulate(&state.q, &state.v);
        self.accelerate(state, targets, pushes);
        find(
            &self.model,
            &self.poses,
            self.settings.slots,
            &mut self.found,
        );
        self.constrain(state);
        self.relax();
    }

    /// Accelerations under constraints.
    pub fn relax(&mut self) {
        let acceleration = self.acceleration.as_flattened_mut();
        acceleration.fill(0.0);
        acceleration[..self.weighted.len()].copy_from_slice(&self.weighted);
        sweep(
            &self.rows,
            self.settings.sweeps,
            &mut self.limits,
            &mut self.contacts,
            &mut self.acceleration,
            &mut self.blocks,
        );
        let acceleration = self.acceleration.as_flattened_mut();
        unweigh(&self.model, &self.columns, &self.factors, acceleration);
    }

    /// Poses, velocities, bias forces, mass matrix.
    pub fn articulate(&mut self, q: &[f32], v: &[f32]) {
        let model = &self.model;
        kinematics(model, q, &mut self.poses, &mut self.axes);
        inertias(model, q, &self.poses, &mut self.inertias);
        bias(
            model,
            v,
            &self.axes,
            &self.inertias,
            &mut self.velocities,
            &mut self.carried,
            &mut self.bias,
        );
        mass_matrix(model, &self.axes, &mut self.inertias, &mut self.matrix);
        for dof in &model.dofs {
            self.matrix[dof.row] += dof.armature;
        }
    }

    /// Accelerations without constraints: drives, their limits, pushes.
    pub fn accelerate(&mut self, state: &State, targets: &[f32], pushes: &[Spatial]) {
        let (q, v, dt) = (&state.q, &state.v, self.settings.dt);
        efforts(&self.model, q, v, targets, dt, &mut self.efforts);
        self.push(q, pushes);
        self.solve_smooth();
        if limit(&self.model, &self.smooth, &mut self.efforts) {
            self.solve_smooth();
        }
    }

    /// Takes what pushes the bodies from the bias.
    fn push(&mut self, q: &[f32], pushes: &[Spatial]) {
        let bodies = self.model.bodies.iter().zip(pushes).enumerate();
        for (index, (body, push)) in bodies {
            if *push == Spatial::ZERO {
                continue;
            }
            let arm = self.poses[index].at(body.centre) - origin(&self.model, body.tree, q);
            let force = Spatial {
                angular: push.angular + arm.cross(push.linear),
                linear: push.linear,
            };
            for dof in self.model.way(body.last_dof) {
                self.bias[dof] -= self.axes[dof].dot(force);
            }
        }
    }

    fn solve_smooth(&mut self) {
        self.factors.copy_from_slice(&self.matrix);
        for (index, (dof, effort)) in self.model.dofs.iter().zip(&self.efforts).enumerate() {
            self.factors[dof.row] += effort.armature;
            self.weighted[index] = effort.force - self.bias[index];
        }
        let (model, columns) = (&self.model, &self.columns);
        factor(model, columns, &mut self.factors);
        weigh(model, columns, &self.factors, &mut self.weighted);
        self.smooth.copy_from_slice(&self.weighted);
        unweigh(model, columns, &self.factors, &mut self.smooth);
    }

    /// How limits, contacts found and degrees of freedom move each other; `rows` end up mass-weighted.
    pub fn constrain(&mut self, state: &State) {
        let (model, dt) = (&self.model, self.settings.dt);
        self.rows.clear();
        self.limits.clear();
        self.contacts.clear();
        limits(
            model,
            &state.q,
            &state.v,
            &state.limits,
            dt,
            &mut self.rows,
            &mut self.limits,
        );
        contacts(
            model,
            &state.q,
            &state.v,
            &self.axes,
            &self.found,
            |key| state.remembered(key),
            dt,
            &mut self.rows,
            &mut self.contacts,
        );
        self.rows
            .weigh(model, &self.columns, &self.factors, &mut self.block);
    }

    /// Force with which each contact pushes its second geom, N, in the world's frame.
    pub fn contact_forces(&self) -> impl Iterator<Item = Vec3> {
        self.found
            .touches
            .iter()
            .zip(&self.contacts)
            .map(|(touch, contact)| {
                let [normal, tangent, side] = along(contact.friction, &contact.forces);
                touch.normal * normal
                    + touch.tangent * tangent
                    + touch.normal.cross(touch.tangent) * side
            })
    }

    /// Net contact force on every body, N.
    pub fn body_forces(&self) -> Vec<Vec3> {
        let mut net = vec![Vec3::ZERO; self.model.bodies.len()];
        for (force, &key) in self.contact_forces().zip(&self.found.keys) {
            let [first, second] = self.model.pairs[(key / 8) as usize];
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
