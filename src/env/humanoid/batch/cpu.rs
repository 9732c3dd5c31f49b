//! Worlds on all cores, each stepped from beginning to end while it is in the cache.

use super::config::{MAX_SPEED, SimulatorBatchConfig};
use super::simulator_batch::{ContactCounters, SimulatorBatch};
use crate::kernels::physics::contact_forces::{self, COUNTERS, entries};
use crate::kernels::physics::random_targets::target;
use crate::kernels::physics::reset_worlds::has_diverged;
use crate::kernels::physics::smooth_dynamics;
use crate::kernels::physics::strided::{gather, scatter};
use crate::physics::simulator::{SUBSTEPS, Simulator, SimulatorState};
use crate::physics::spatial::Spatial;
use anyhow::Result;
use glam::Vec3;
use rayon::prelude::*;

/// Chunks of worlds for each core, so that none waits long for another.
const CHUNKS: usize = 4;

/// One world of a batch.
pub struct SimulatedWorld {
    /// Positions and velocities, and the forces that the solver is warm-started with.
    pub state: SimulatorState,
    /// Positions and velocities to be reset to, `[nq + nv]`.
    pub start: Vec<f32>,
    /// Targets of the drives, `[nu]`, rad.
    pub targets: Vec<f32>,
    /// Torques and forces at the centres of mass, `[bodies]`, Nm and N.
    pub external_forces: Vec<Spatial>,
    /// Mean contact forces of the last action on bodies, then of pairs, N.
    forces: Vec<Vec3>,
    counters: [u32; COUNTERS],
}

/// A batch of worlds on the CPU.
pub struct CpuSimulatorBatch {
    config: SimulatorBatchConfig,
    /// All worlds, `[envs]`.
    pub worlds: Vec<SimulatedWorld>,
    /// A workspace for each chunk of worlds.
    workspaces: Vec<Simulator>,
    /// Actions so far.
    step_counter: u32,
}

impl CpuSimulatorBatch {
    /// Worlds at the model's initial positions, at rest, with all targets and external forces zero.
    pub fn new(config: &SimulatorBatchConfig) -> CpuSimulatorBatch {
        let model = &config.model;
        let state = SimulatorState::new(model);
        let forces = model.bodies.len() + config.force_pairs.len();
        let world = || SimulatedWorld {
            start: [&state.q[..], &state.v].concat(),
            state: state.clone(),
            targets: vec![0.0; model.nu()],
            external_forces: vec![Spatial::ZERO; model.bodies.len()],
            forces: vec![Vec3::ZERO; forces],
            counters: [0; COUNTERS],
        };
        let chunks = (CHUNKS * rayon::current_num_threads()).clamp(1, config.envs.max(1));
        CpuSimulatorBatch {
            worlds: (0..config.envs).map(|_| world()).collect(),
            workspaces: vec![Simulator::new(model.clone(), config.options); chunks],
            config: config.clone(),
            step_counter: 0,
        }
    }

    /// Works on all worlds, each with its number, a workspace and its row of `rows`.
    pub fn each<T: Send>(
        &mut self,
        rows: &mut [T],
        work: impl Fn(usize, &mut Simulator, &mut SimulatedWorld, &mut T) + Sync,
    ) {
        let size = self.worlds.len().div_ceil(self.workspaces.len()).max(1);
        let worlds = self.worlds.par_chunks_mut(size);
        let chunks = worlds.zip(rows.par_chunks_mut(size)).enumerate();
        chunks
            .zip(&mut self.workspaces)
            .for_each(|((chunk, (worlds, rows)), simulator)| {
                for (index, (world, row)) in worlds.iter_mut().zip(rows).enumerate() {
                    work(chunk * size + index, simulator, world, row);
                }
            });
    }
}

impl SimulatedWorld {
    /// Plays one action. `force_pairs` are pairs of bodies, one behind the other.
    pub fn advance(&mut self, simulator: &mut Simulator, force_pairs: &[u32]) {
        self.forces.fill(Vec3::ZERO);
        for _ in 0..SUBSTEPS {
            simulator.step(&mut self.state, &self.targets, &self.external_forces);
            self.count(simulator, force_pairs);
        }
    }

    /// Mean forces of the last action of the first on the second of every pair, N, in a world of so many
    /// bodies.
    pub fn pair_forces(&self, bodies: usize) -> &[Vec3] {
        &self.forces[bodies..]
    }

    /// Adds the forces and counts of a step.
    fn count(&mut self, simulator: &Simulator, force_pairs: &[u32]) {
        let model = &simulator.model;
        let contacts = &simulator.contacts;
        for (force, &id) in simulator.contact_forces().zip(&contacts.ids) {
            let pair = model.pairs[(id / 8) as usize];
            let [first, second] = pair.map(|geom| model.geoms[geom].body);
            for (entry, sign) in entries(model, first, second, force_pairs) {
                self.forces[entry] += force * (sign / SUBSTEPS as f32);
            }
        }
        let count = contacts.ids.len() as u32;
        self.counters[contact_forces::CONTACTS] += count;
        let peak = &mut self.counters[contact_forces::PEAK_CONTACTS];
        *peak = count.max(*peak);
        self.counters[contact_forces::OVERFLOW] += contacts.overflow;
    }

    /// Goes back to its start, without forces of a step before.
    pub fn reset(&mut self) {
        let (q, v) = self.start.split_at(self.state.q.len());
        self.state.q.copy_from_slice(q);
        self.state.v.copy_from_slice(v);
        self.state.clear_warm_start();
        self.forces.fill(Vec3::ZERO);
    }
}

impl SimulatorBatch for CpuSimulatorBatch {
    fn draw_targets(&mut self, std: f32) {
        let params = self.config.random_targets(std, self.step_counter);
        let worlds = self.worlds.par_iter_mut().enumerate();
        worlds.for_each(|(env, world)| {
            for (drive, wanted) in world.targets.iter_mut().enumerate() {
                *wanted = target(&params, drive, env);
            }
        });
    }

    fn set_targets(&mut self, targets: &[f32]) {
        self.config.check_targets(targets);
        let envs = self.config.envs;
        for (env, world) in self.worlds.iter_mut().enumerate() {
            gather(targets, envs, env, 0, &mut world.targets);
        }
    }

    fn set_external_forces(&mut self, forces: &[f32]) {
        self.config.check_external_forces(forces);
        let envs = self.config.envs;
        for (env, world) in self.worlds.iter_mut().enumerate() {
            let mut numbers = vec![0.0; 6 * world.external_forces.len()];
            gather(forces, envs, env, 0, &mut numbers);
            let bodies = world.external_forces.iter_mut();
            for (force, numbers) in bodies.zip(numbers.chunks_exact(6)) {
                *force = smooth_dynamics::spatial(numbers);
            }
        }
    }

    fn step(&mut self) {
        let pairs = self.config.force_pairs();
        let mut rows = vec![(); self.worlds.len()];
        self.each(&mut rows, |_, simulator, world, ()| {
            world.advance(simulator, &pairs[1..]);
            if has_diverged(&world.state.q, &world.state.v, MAX_SPEED) {
                world.counters[contact_forces::DIVERGED] += 1;
                world.reset();
            }
        });
        self.step_counter += 1;
    }

    fn reset(&mut self, mask: &[u32], starts: &[f32]) {
        self.config.check_starts(mask, starts);
        let envs = self.config.envs;
        for (env, world) in self.worlds.iter_mut().enumerate() {
            gather(starts, envs, env, 0, &mut world.start);
            if mask[env] != 0 {
                world.reset();
            }
        }
    }

    fn state(&self) -> Result<Vec<f32>> {
        let (envs, model) = (self.config.envs, &self.config.model);
        let mut state = vec![0.0; (model.nq() + model.nv()) * envs];
        for (env, world) in self.worlds.iter().enumerate() {
            smooth_dynamics::write(model, &mut state, envs, env, &world.state);
        }
        Ok(state)
    }

    fn forces(&self) -> Result<Vec<f32>> {
        let envs = self.config.envs;
        let entries = self.config.model.bodies.len() + self.config.force_pairs.len();
        let mut forces = vec![0.0; 3 * entries * envs];
        for (env, world) in self.worlds.iter().enumerate() {
            for (entry, force) in world.forces.iter().enumerate() {
                scatter(&mut forces, envs, env, 3 * entry, &force.to_array());
            }
        }
        Ok(forces)
    }

    fn counters(&self) -> Result<ContactCounters> {
        let envs = self.config.envs;
        let mut counters = vec![0; COUNTERS * envs];
        for (env, world) in self.worlds.iter().enumerate() {
            scatter(&mut counters, envs, env, 0, &world.counters);
        }
        Ok(ContactCounters::sum(&counters, envs))
    }
}
