//! Worlds on a GPU: five launches a step, nothing copied to the host.

use super::{Setup, Simulation, Tallies};
use crate::physics::simulator::SUBSTEPS;
use crate::physics::model_table::tables;
use crate::gpu::{Buffer, Gpu};
use crate::kernels::physics::smooth_dynamics::{self, POSE, Sections};
use crate::kernels::physics::make_constraints::{self, CONSTRAINT, TOUCH};
use crate::kernels::physics::solve_and_integrate::NO_KEY;
use crate::kernels::physics::{contact_forces, collision, random_targets, reset_worlds, solve_and_integrate};
use anyhow::Result;

pub struct GpuSimulation {
    gpu: Gpu,
    setup: Setup,
    tables: Buffer<u32>,
    geoms: Buffer<f32>,
    watched: Buffer<u32>,
    state: Buffer<f32>,
    starts: Buffer<f32>,
    targets: Buffer<f32>,
    pushes: Buffer<f32>,
    poses: Buffer<f32>,
    dynamics: Buffer<f32>,
    touches: Buffer<f32>,
    keys: Buffer<u32>,
    counts: Buffer<u32>,
    rows: Buffer<f32>,
    constraints: Buffer<f32>,
    warm: Buffer<u32>,
    forces: Buffer<f32>,
    tallies: Buffer<u32>,
    /// All zero: no world asks to start anew.
    nobody: Buffer<u32>,
    /// Actions so far.
    clock: u32,
}

/// A launch, told whether its step is the first of an action.
pub type Launch = fn(&GpuSimulation, bool);

impl GpuSimulation {
    /// # Errors
    /// A model, or a number of contacts, too large for the shaders.
    pub fn new(setup: &Setup, gpu: &Gpu) -> Result<GpuSimulation> {
        let (model, envs, slots) = (&setup.model, setup.envs, setup.settings.slots);
        let (bodies, joints) = (model.bodies.len(), model.joints.len());
        let quads = model.dofs.len().div_ceil(4);
        let rows = make_constraints::rows(model, slots);
        let zeros = |fields: usize| Buffer::zeroed(gpu, fields * envs);
        let starts = setup.starts();
        let cold = cold(slots, joints, envs);
        Ok(GpuSimulation {
            tables: Buffer::from_slice(gpu, &tables(model, &setup.settings)?),
            geoms: Buffer::from_slice(gpu, &collision::geoms(model)),
            watched: Buffer::from_slice(gpu, &setup.watched()),
            state: Buffer::from_slice(gpu, &starts),
            starts: Buffer::from_slice(gpu, &starts),
            targets: zeros(model.driven().max(1)),
            pushes: zeros(6 * bodies),
            poses: zeros(POSE * bodies),
            dynamics: zeros(Sections::of(model).len),
            touches: zeros(TOUCH * slots),
            keys: Buffer::zeroed(gpu, slots * envs),
            counts: Buffer::zeroed(gpu, 2 * envs),
            rows: zeros(rows * quads * 4),
            constraints: zeros((slots + joints) * CONSTRAINT),
            warm: Buffer::from_slice(gpu, &cold),
            forces: zeros(3 * (bodies + setup.watched.len())),
            tallies: Buffer::zeroed(gpu, contact_forces::TALLIES * envs),
            nobody: Buffer::zeroed(gpu, envs),
            setup: setup.clone(),
            gpu: gpu.clone(),
            clock: 0,
        })
    }

    /// The launches of a step, in order, by name: what a step is made of, and what a benchmark times.
    pub const LAUNCHES: [(&'static str, Launch); 5] = [
        ("articulate", Self::articulate),
        ("contact", Self::contact),
        ("constrain", Self::constrain),
        ("solve", Self::solve),
        ("blows", Self::blows),
    ];

    fn articulate(&self, _: bool) {
        smooth_dynamics::launch(
            &self.gpu,
            self.setup.model.trees.len(),
            &self.tables,
            &self.state,
            &self.targets,
            &self.pushes,
            &self.poses,
            &self.dynamics,
            &smooth_dynamics::Params {
                envs: self.setup.envs as u32,
                dt: self.setup.settings.dt,
            },
        );
    }

    fn contact(&self, _: bool) {
        collision::launch(
            &self.gpu,
            &self.geoms,
            &self.tables,
            &self.poses,
            &self.touches,
            &self.keys,
            &self.counts,
            &collision::Params {
                envs: self.setup.envs as u32,
                slots: self.setup.settings.slots as u32,
            },
        );
    }

    fn constrain(&self, _: bool) {
        make_constraints::launch(
            &self.gpu,
            make_constraints::row_groups(&self.setup.model, self.setup.settings.slots),
            &self.tables,
            &self.state,
            &self.dynamics,
            &self.touches,
            &self.keys,
            &self.counts,
            &self.rows,
            &self.constraints,
            &make_constraints::Params {
                envs: self.setup.envs as u32,
                dt: self.setup.settings.dt,
            },
        );
    }

    fn solve(&self, _: bool) {
        solve_and_integrate::launch(
            &self.gpu,
            &self.tables,
            &self.state,
            &self.dynamics,
            &self.rows,
            &self.constraints,
            &self.keys,
            &self.counts,
            &self.warm,
            &solve_and_integrate::Params {
                envs: self.setup.envs as u32,
                dt: self.setup.settings.dt,
            },
        );
    }

    /// `first` of an action, of whose steps the forces are the mean.
    fn blows(&self, first: bool) {
        contact_forces::launch(
            &self.gpu,
            &self.tables,
            &self.touches,
            &self.keys,
            &self.counts,
            &self.warm,
            &self.watched,
            &self.forces,
            &self.tallies,
            &contact_forces::Params {
                envs: self.setup.envs as u32,
                slots: self.setup.settings.slots as u32,
                first: u32::from(first),
                share: 1.0 / SUBSTEPS as f32,
            },
        );
    }

    fn begin(&self, mask: &Buffer<u32>) {
        reset_worlds::launch(
            &self.gpu,
            &self.tables,
            mask,
            &self.starts,
            &self.state,
            &self.warm,
            &self.watched,
            &self.forces,
            &self.tallies,
            &self.setup.restart(),
        );
    }
}

/// Forces remembered of no step: `warm` of [`solve_and_integrate`].
fn cold(slots: usize, joints: usize, envs: usize) -> Vec<u32> {
    let mut warm = vec![0; solve_and_integrate::warm(slots, joints) * envs];
    warm[..slots * envs].fill(NO_KEY);
    warm
}

impl Simulation for GpuSimulation {
    fn explore(&mut self, deviation: f32) {
        let params = self.setup.explore(deviation, self.clock);
        random_targets::launch(&self.gpu, self.setup.model.driven(), &self.targets, &params);
    }

    fn set_targets(&mut self, targets: &[f32]) {
        self.setup.check_targets(targets);
        self.targets = Buffer::from_slice(&self.gpu, targets);
    }

    fn set_pushes(&mut self, pushes: &[f32]) {
        self.setup.check_pushes(pushes);
        self.pushes = Buffer::from_slice(&self.gpu, pushes);
    }

    fn step(&mut self) {
        for substep in 0..SUBSTEPS {
            for (_, launch) in Self::LAUNCHES {
                launch(self, substep == 0);
            }
        }
        self.begin(&self.nobody);
        self.clock += 1;
    }

    fn restart(&mut self, mask: &[u32], starts: &[f32]) {
        self.setup.check_starts(mask, starts);
        self.starts = Buffer::from_slice(&self.gpu, starts);
        self.begin(&Buffer::from_slice(&self.gpu, mask));
    }

    fn state(&self) -> Result<Vec<f32>> {
        self.state.read(&self.gpu)
    }

    fn forces(&self) -> Result<Vec<f32>> {
        self.forces.read(&self.gpu)
    }

    fn tallies(&self) -> Result<Tallies> {
        Ok(Tallies::of(&self.tallies.read(&self.gpu)?, self.setup.envs))
    }
}
