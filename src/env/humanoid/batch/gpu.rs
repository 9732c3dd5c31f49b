//! Worlds on a GPU: five launches a step, nothing copied to the host.

use super::config::SimulatorBatchConfig;
use super::simulator_batch::{ContactCounters, SimulatorBatch};
use crate::gpu::{Buffer, Gpu};
use crate::kernels::physics::make_constraints::{self, CONSTRAINT_DIM, CONTACT_DIM};
use crate::kernels::physics::model_table::model_table;
use crate::kernels::physics::smooth_dynamics::{self, DynamicsLayout, POSE_DIM};
use crate::kernels::physics::solve_and_integrate::{NO_CONTACT, warm_start_dim};
use crate::kernels::physics::{
    collision, contact_forces, random_targets, reset_worlds, solve_and_integrate,
};
use crate::physics::simulator::SUBSTEPS;
use anyhow::Result;

/// A batch of worlds on a GPU. Arrays are as their kernels have them.
pub struct GpuSimulatorBatch {
    gpu: Gpu,
    config: SimulatorBatchConfig,
    /// Model and solver options in words, see [`mod@crate::kernels::physics::model_table`].
    pub model_table: Buffer<u32>,
    geoms: Buffer<f32>,
    force_pairs: Buffer<u32>,
    /// Positions and velocities, `[nq + nv][envs]`.
    pub state: Buffer<f32>,
    /// States to be reset to, `[nq + nv][envs]`.
    pub starts: Buffer<f32>,
    /// Targets of the drives, `[nu][envs]`, rad.
    pub targets: Buffer<f32>,
    /// Torques and forces at the bodies' centres of mass, in the world's frame, `[bodies * 6][envs]`, Nm
    /// and N.
    pub external_forces: Buffer<f32>,
    /// Poses of the bodies in the world, `[bodies * POSE_DIM][envs]`.
    pub poses: Buffer<f32>,
    /// What [`smooth_dynamics`] leaves for the kernels after it, `[len][envs]`: see
    /// [`DynamicsLayout`].
    pub dynamics: Buffer<f32>,
    contacts: Buffer<f32>,
    contact_ids: Buffer<u32>,
    counts: Buffer<u32>,
    rows: Buffer<f32>,
    constraints: Buffer<f32>,
    /// Contact ids and constraint forces of the last step, for the solver to start from,
    /// `[warm_start_dim][envs]`: see [`warm_start_dim`].
    pub warm_start: Buffer<u32>,
    /// Mean contact forces of the last action, `[(bodies + pairs) * 3][envs]`, N.
    pub forces: Buffer<f32>,
    counters: Buffer<u32>,
    /// All zero: no world is to be reset unless it has diverged.
    none: Buffer<u32>,
    /// Actions so far.
    step_counter: u32,
}

/// A launch of a step, told whether the step is the first of an action.
pub type StepLaunch = fn(&GpuSimulatorBatch, bool);

impl GpuSimulatorBatch {
    /// # Errors
    /// A model, or a number of contacts, too large for the shaders.
    pub fn new(config: &SimulatorBatchConfig, gpu: &Gpu) -> Result<GpuSimulatorBatch> {
        let (model, envs) = (&config.model, config.envs);
        let max_contacts = config.options.max_contacts;
        let (bodies, joints) = (model.bodies.len(), model.joints.len());
        let quads = model.dofs.len().div_ceil(4);
        let rows = make_constraints::rows(model, max_contacts);
        let zeros = |fields: usize| Buffer::zeroed(gpu, fields * envs);
        let starts = config.starts();
        let warm_start = cold_start(max_contacts, joints, envs);
        Ok(GpuSimulatorBatch {
            model_table: Buffer::from_slice(gpu, &model_table(model, &config.options)?),
            geoms: Buffer::from_slice(gpu, &collision::geoms(model)),
            force_pairs: Buffer::from_slice(gpu, &config.force_pairs()),
            state: Buffer::from_slice(gpu, &starts),
            starts: Buffer::from_slice(gpu, &starts),
            targets: zeros(model.nu().max(1)),
            external_forces: zeros(6 * bodies),
            poses: zeros(POSE_DIM * bodies),
            dynamics: zeros(DynamicsLayout::new(model).len),
            contacts: zeros(CONTACT_DIM * max_contacts),
            contact_ids: Buffer::zeroed(gpu, max_contacts * envs),
            counts: Buffer::zeroed(gpu, 2 * envs),
            rows: zeros(rows * quads * 4),
            constraints: zeros((max_contacts + joints) * CONSTRAINT_DIM),
            warm_start: Buffer::from_slice(gpu, &warm_start),
            forces: zeros(3 * (bodies + config.force_pairs.len())),
            counters: Buffer::zeroed(gpu, contact_forces::COUNTERS * envs),
            none: Buffer::zeroed(gpu, envs),
            config: config.clone(),
            gpu: gpu.clone(),
            step_counter: 0,
        })
    }

    /// The launches of a step, in order, by name: what a step is made of, and what a benchmark times.
    pub const LAUNCHES: [(&'static str, StepLaunch); 5] = [
        ("smooth_dynamics", Self::smooth_dynamics),
        ("collision", Self::collision),
        ("make_constraints", Self::make_constraints),
        ("solve_and_integrate", Self::solve_and_integrate),
        ("contact_forces", Self::contact_forces),
    ];

    /// Plays one action: all its steps. `targets` and `external_forces` are as they are.
    pub fn advance(&self) {
        for substep in 0..SUBSTEPS {
            for (_, launch) in Self::LAUNCHES {
                launch(self, substep == 0);
            }
        }
    }

    /// Computes `poses`, and the velocities in `dynamics`, of the state as it is.
    pub fn kinematics(&self) {
        self.launch_dynamics(true);
    }

    fn smooth_dynamics(&self, _: bool) {
        self.launch_dynamics(false);
    }

    fn launch_dynamics(&self, kinematics_only: bool) {
        smooth_dynamics::launch(
            &self.gpu,
            &self.model_table,
            &self.state,
            &self.targets,
            &self.external_forces,
            &self.poses,
            &self.dynamics,
            &smooth_dynamics::Params {
                envs: self.config.envs as u32,
                dt: self.config.options.dt,
                trees: self.config.model.trees.len() as u32,
                kinematics_only: u32::from(kinematics_only),
            },
        );
    }

    fn collision(&self, _: bool) {
        collision::launch(
            &self.gpu,
            &self.geoms,
            &self.model_table,
            &self.poses,
            &self.contacts,
            &self.contact_ids,
            &self.counts,
            &collision::Params {
                envs: self.config.envs as u32,
                max_contacts: self.config.options.max_contacts as u32,
            },
        );
    }

    fn make_constraints(&self, _: bool) {
        make_constraints::launch(
            &self.gpu,
            &self.model_table,
            &self.state,
            &self.dynamics,
            &self.contacts,
            &self.contact_ids,
            &self.counts,
            &self.rows,
            &self.constraints,
            &make_constraints::Params {
                envs: self.config.envs as u32,
                dt: self.config.options.dt,
                row_groups: make_constraints::row_groups(
                    &self.config.model,
                    self.config.options.max_contacts,
                ),
            },
        );
    }

    fn solve_and_integrate(&self, _: bool) {
        solve_and_integrate::launch(
            &self.gpu,
            &self.model_table,
            &self.state,
            &self.dynamics,
            &self.rows,
            &self.constraints,
            &self.contact_ids,
            &self.counts,
            &self.warm_start,
            &solve_and_integrate::Params {
                envs: self.config.envs as u32,
                dt: self.config.options.dt,
            },
        );
    }

    fn contact_forces(&self, first: bool) {
        contact_forces::launch(
            &self.gpu,
            &self.model_table,
            &self.contacts,
            &self.contact_ids,
            &self.counts,
            &self.warm_start,
            &self.force_pairs,
            &self.forces,
            &self.counters,
            &contact_forces::Params {
                envs: self.config.envs as u32,
                max_contacts: self.config.options.max_contacts as u32,
                first: u32::from(first),
                weight: 1.0 / SUBSTEPS as f32,
            },
        );
    }

    /// Resets the worlds whose `mask` is not 0, and those that have diverged, to `starts`.
    pub fn reset_where(&self, mask: &Buffer<u32>) {
        reset_worlds::launch(
            &self.gpu,
            &self.model_table,
            mask,
            &self.starts,
            &self.state,
            &self.warm_start,
            &self.force_pairs,
            &self.forces,
            &self.counters,
            &self.config.reset_worlds(),
        );
    }
}

/// The array `warm_start` of [`solve_and_integrate`] without any forces.
fn cold_start(max_contacts: usize, joints: usize, envs: usize) -> Vec<u32> {
    let mut warm_start = vec![0; warm_start_dim(max_contacts, joints) * envs];
    warm_start[..max_contacts * envs].fill(NO_CONTACT);
    warm_start
}

impl SimulatorBatch for GpuSimulatorBatch {
    fn draw_targets(&mut self, std: f32) {
        let params = self.config.random_targets(std, self.step_counter);
        random_targets::launch(&self.gpu, &self.targets, &params);
    }

    fn set_targets(&mut self, targets: &[f32]) {
        self.config.check_targets(targets);
        self.targets = Buffer::from_slice(&self.gpu, targets);
    }

    fn set_external_forces(&mut self, forces: &[f32]) {
        self.config.check_external_forces(forces);
        self.external_forces = Buffer::from_slice(&self.gpu, forces);
    }

    fn step(&mut self) {
        self.advance();
        self.reset_where(&self.none);
        self.step_counter += 1;
    }

    fn reset(&mut self, mask: &[u32], starts: &[f32]) {
        self.config.check_starts(mask, starts);
        self.starts = Buffer::from_slice(&self.gpu, starts);
        self.reset_where(&Buffer::from_slice(&self.gpu, mask));
    }

    fn state(&self) -> Result<Vec<f32>> {
        self.state.read(&self.gpu)
    }

    fn forces(&self) -> Result<Vec<f32>> {
        self.forces.read(&self.gpu)
    }

    fn counters(&self) -> Result<ContactCounters> {
        let counters = self.counters.read(&self.gpu)?;
        Ok(ContactCounters::sum(&counters, self.config.envs))
    }
}
