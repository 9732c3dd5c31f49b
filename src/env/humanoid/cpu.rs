//! Worlds on all cores, each stepped from beginning to end while it is in the cache.

use super::{FASTEST, Setup, Simulation, Tallies};
use crate::physics::simulator::{Physics, SUBSTEPS, State};
use crate::physics::spatial::Spatial;
use crate::kernels::physics::contact_forces::{self, shares};
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::physics::random_targets::drawn;
use crate::kernels::physics::{smooth_dynamics, reset_worlds};
use anyhow::Result;
use glam::Vec3;
use rayon::prelude::*;

/// Chunks of worlds for each core, so that none waits long for another.
const CHUNKS: usize = 4;

struct World {
    state: State,
    /// Positions and velocities to start anew from.
    start: Vec<f32>,
    targets: Vec<f32>,
    pushes: Vec<Spatial>,
    /// Sums over bodies, then over watched pairs.
    forces: Vec<Vec3>,
    tallies: [u32; contact_forces::TALLIES],
}

pub struct CpuSimulation {
    setup: Setup,
    worlds: Vec<World>,
    /// A workspace for each chunk of worlds.
    workspaces: Vec<Physics>,
    watched: Vec<u32>,
    /// Actions so far.
    clock: u32,
}

impl CpuSimulation {
    pub fn new(setup: &Setup) -> CpuSimulation {
        let model = &setup.model;
        let state = State::new(model);
        let world = || World {
            start: [&state.q[..], &state.v].concat(),
            state: state.clone(),
            targets: vec![0.0; model.driven()],
            pushes: vec![Spatial::ZERO; model.bodies.len()],
            forces: vec![Vec3::ZERO; model.bodies.len() + setup.watched.len()],
            tallies: [0; contact_forces::TALLIES],
        };
        let chunks = (CHUNKS * rayon::current_num_threads()).min(setup.envs);
        CpuSimulation {
            worlds: (0..setup.envs).map(|_| world()).collect(),
            workspaces: vec![Physics::new(model.clone(), setup.settings); chunks],
            watched: setup.watched()[1..].to_vec(),
            setup: setup.clone(),
            clock: 0,
        }
    }

    /// Worlds in chunks, with a workspace each.
    fn each(&mut self, work: impl Fn(&mut Physics, &mut World) + Sync) {
        let size = self
            .worlds
            .len()
            .div_ceil(self.workspaces.len().max(1))
            .max(1);
        let chunks = self.worlds.par_chunks_mut(size).zip(&mut self.workspaces);
        chunks.for_each(|(worlds, physics)| {
            for world in worlds {
                work(physics, world);
            }
        });
    }
}

impl World {
    fn act(&mut self, physics: &mut Physics, watched: &[u32]) {
        self.forces.fill(Vec3::ZERO);
        for _ in 0..SUBSTEPS {
            physics.step(&mut self.state, &self.targets, &self.pushes);
            self.feel(physics, watched);
        }
        let values = [&self.state.q[..], &self.state.v].concat();
        if reset_worlds::broken(&physics.model, &values, FASTEST) {
            self.tallies[contact_forces::BROKEN] += 1;
            self.begin();
        }
    }

    /// Forces and counts of a step.
    fn feel(&mut self, physics: &Physics, watched: &[u32]) {
        let model = &physics.model;
        for (force, &key) in physics.contact_forces().zip(&physics.found.keys) {
            let pair = model.pairs[(key / 8) as usize];
            let [first, second] = pair.map(|geom| model.geoms[geom].body);
            for (entry, sign) in shares(model, first, second, watched) {
                self.forces[entry] += force * (sign / SUBSTEPS as f32);
            }
        }
        let count = physics.found.keys.len() as u32;
        self.tallies[contact_forces::CONTACTS] += count;
        let most = &mut self.tallies[contact_forces::MOST_CONTACTS];
        *most = count.max(*most);
        self.tallies[contact_forces::OVERFLOW] += physics.found.overflow;
    }

    fn begin(&mut self) {
        let (q, v) = self.start.split_at(self.state.q.len());
        self.state.q.copy_from_slice(q);
        self.state.v.copy_from_slice(v);
        self.state.cool();
        self.forces.fill(Vec3::ZERO);
    }
}

impl Simulation for CpuSimulation {
    fn explore(&mut self, deviation: f32) {
        let params = self.setup.explore(deviation, self.clock);
        self.worlds
            .par_iter_mut()
            .enumerate()
            .for_each(|(env, world)| {
                for (index, target) in world.targets.iter_mut().enumerate() {
                    *target = drawn(&params, index, env);
                }
            });
    }

    fn set_targets(&mut self, targets: &[f32]) {
        self.setup.check_targets(targets);
        let envs = self.setup.envs;
        for (env, world) in self.worlds.iter_mut().enumerate() {
            gather(targets, envs, env, 0, &mut world.targets);
        }
    }

    fn set_pushes(&mut self, pushes: &[f32]) {
        self.setup.check_pushes(pushes);
        let envs = self.setup.envs;
        for (env, world) in self.worlds.iter_mut().enumerate() {
            let mut numbers = vec![0.0; 6 * world.pushes.len()];
            gather(pushes, envs, env, 0, &mut numbers);
            for (push, numbers) in world.pushes.iter_mut().zip(numbers.chunks_exact(6)) {
                *push = smooth_dynamics::spatial(numbers);
            }
        }
    }

    fn step(&mut self) {
        let watched = std::mem::take(&mut self.watched);
        self.each(|physics, world| world.act(physics, &watched));
        self.watched = watched;
        self.clock += 1;
    }

    fn restart(&mut self, mask: &[u32], starts: &[f32]) {
        self.setup.check_starts(mask, starts);
        let envs = self.setup.envs;
        for (env, world) in self.worlds.iter_mut().enumerate() {
            gather(starts, envs, env, 0, &mut world.start);
            if mask[env] != 0 {
                world.begin();
            }
        }
    }

    fn state(&self) -> Result<Vec<f32>> {
        let (envs, model) = (self.setup.envs, &self.setup.model);
        let mut state = vec![0.0; (model.positions() + model.velocities()) * envs];
        for (env, world) in self.worlds.iter().enumerate() {
            smooth_dynamics::write(model, &mut state, envs, env, &world.state);
        }
        Ok(state)
    }

    fn forces(&self) -> Result<Vec<f32>> {
        let envs = self.setup.envs;
        let entries = self.setup.model.bodies.len() + self.setup.watched.len();
        let mut forces = vec![0.0; 3 * entries * envs];
        for (env, world) in self.worlds.iter().enumerate() {
            for (entry, force) in world.forces.iter().enumerate() {
                scatter(&mut forces, envs, env, 3 * entry, &force.to_array());
            }
        }
        Ok(forces)
    }

    fn tallies(&self) -> Result<Tallies> {
        let envs = self.setup.envs;
        let mut tallies = vec![0; contact_forces::TALLIES * envs];
        for (env, world) in self.worlds.iter().enumerate() {
            scatter(&mut tallies, envs, env, 0, &world.tallies);
        }
        Ok(Tallies::of(&tallies, envs))
    }
}
