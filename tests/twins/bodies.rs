//! The kernels of the simulated body against their twins: what each makes of the same buffers, by its
//! own launch and through plain wgpu. Worlds of one humanoid, of two, of one with a box, and of what humanoids
//! do not have, in random states near the ground, drives at and below their limits.
//! Bar: rounding, as a part of the largest number of a section of an environment.

use crate::checked;
use crate::inputs::{Draw, POISON, POISON_WHOLE, gpu};
use bytemuck::{Pod, cast_slice};
use footwork::body::mjcf;
use footwork::body::model::{Kind, Model};
use footwork::body::physics::{Physics, Settings, State};
use footwork::body::scenes;
use footwork::body::tables::tables;
use footwork::gpu::kernel::groups;
use footwork::gpu::{Buffer, Gpu, shader};
use footwork::kernels::articulate::{self, POSE, Sections};
use footwork::kernels::columns::gather;
use footwork::kernels::constrain::{self, CONSTRAINT, TOUCH};
use footwork::kernels::{blows, contact, explore, proprioception, restart, solve};
use glam::{Quat, Vec3};
use std::path::Path;
use std::sync::Arc;

/// All buffers of a batch, on the host.
#[derive(Clone)]
struct Worlds {
    model: Arc<Model>,
    settings: Settings,
    envs: usize,
    tables: Vec<u32>,
    watched: Vec<u32>,
    state: Vec<f32>,
    targets: Vec<f32>,
    pushes: Vec<f32>,
    poses: Vec<f32>,
    dynamics: Vec<f32>,
    touches: Vec<f32>,
    keys: Vec<u32>,
    counts: Vec<u32>,
    rows: Vec<f32>,
    constraints: Vec<f32>,
    warm: Vec<u32>,
    forces: Vec<f32>,
    tallies: Vec<u32>,
}

/// A random state: characters in any attitude near the ground, some joints past their ranges.
fn random_state(model: &Model, draw: &mut Draw) -> State {
    let mut state = State::new(model);
    let turn = |draw: &mut Draw, most: f32| {
        let axis = Vec3::new(draw.normal(), draw.normal(), draw.normal()).normalize();
        let [x, y, z, w] = Quat::from_axis_angle(axis, draw.within(most)).to_array();
        [w, x, y, z]
    };
    for joint in &model.joints {
        let q = &mut state.q[joint.q..];
        match joint.kind {
            Kind::Free => {
                q[0] += draw.within(0.3);
                q[1] += draw.within(0.3);
                q[2] = 0.5 + draw.within(0.4);
                q[3..7].copy_from_slice(&turn(draw, 3.0));
            }
            Kind::Ball => q[..4].copy_from_slice(&turn(draw, 1.5)),
            Kind::Hinge => {
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
    fn new(model: Model, envs: usize, seed: u32) -> Worlds {
        let model = Arc::new(model);
        let settings = Settings::training(&model);
        let (slots, joints, bodies) = (settings.slots, model.joints.len(), model.bodies.len());
        let quads = model.dofs.len().div_ceil(4);
        let mut draw = Draw::new(seed);
        let mut state = vec![0.0; (model.positions() + model.velocities()) * envs];
        for env in 0..envs {
            articulate::write(
                &model,
                &mut state,
                envs,
                env,
                &random_state(&model, &mut draw),
            );
        }
        let watched: Vec<u32> = vec![2, 0, 1, 2, bodies as u32 - 1];
        let rows = constrain::rows(&model, slots) * quads * 4;
        let poison = |fields: usize| vec![POISON; fields * envs];
        let targets = draw.normals(model.driven() * envs);
        let mut pushes = vec![0.0; 6 * bodies * envs];
        for push in pushes.iter_mut().step_by(7) {
            *push = draw.within(50.0);
        }
        let mut warm = vec![0; solve::warm(slots, joints) * envs];
        warm[..slots * envs].fill(solve::NO_KEY);
        let mut worlds = Worlds {
            tables: tables(&model, &settings).expect("it fits"),
            forces: poison(3 * (bodies + watched.len() / 2)),
            watched,
            state,
            targets,
            pushes,
            poses: poison(POSE * bodies),
            dynamics: poison(Sections::of(&model).len),
            touches: poison(TOUCH * slots),
            keys: vec![POISON_WHOLE; slots * envs],
            counts: vec![POISON_WHOLE; 2 * envs],
            rows: poison(rows),
            constraints: poison((slots + joints) * CONSTRAINT),
            warm,
            tallies: vec![0; blows::TALLIES * envs],
            envs,
            settings,
            model,
        };
        worlds.step();
        // Forces to remember.
        worlds.step();
        // What is not written from here on must be poison.
        worlds.touches.fill(POISON);
        worlds.rows.fill(POISON);
        worlds.constraints.fill(POISON);
        worlds.articulate();
        worlds.contact();
        worlds.constrain();
        worlds
    }

    fn physics(&self) -> Physics {
        Physics::new(self.model.clone(), self.settings)
    }

    fn articulate_params(&self) -> articulate::Params {
        articulate::Params {
            envs: self.envs as u32,
            dt: self.settings.dt,
        }
    }

    fn articulate(&mut self) {
        let params = self.articulate_params();
        articulate::twin(
            &mut self.physics(),
            &self.state,
            &self.targets,
            &self.pushes,
            &mut self.poses,
            &mut self.dynamics,
            &params,
        );
    }

    fn contact(&mut self) {
        contact::twin(
            &self.model,
            &self.poses,
            &mut self.touches,
            &mut self.keys,
            &mut self.counts,
            &contact::Params {
                envs: self.envs as u32,
                slots: self.settings.slots as u32,
            },
        );
    }

    fn constrain_params(&self) -> constrain::Params {
        constrain::Params {
            envs: self.envs as u32,
            dt: self.settings.dt,
        }
    }

    fn constrain(&mut self) {
        let params = self.constrain_params();
        constrain::twin(
            &mut self.physics(),
            &self.state,
            &self.dynamics,
            &self.touches,
            &self.keys,
            &self.counts,
            &mut self.rows,
            &mut self.constraints,
            &params,
        );
    }

    fn solve_params(&self) -> solve::Params {
        solve::Params {
            envs: self.envs as u32,
            dt: self.settings.dt,
        }
    }

    fn solve(&mut self) {
        let params = self.solve_params();
        solve::twin(
            &mut self.physics(),
            &mut self.state,
            &self.dynamics,
            &self.rows,
            &self.constraints,
            &self.keys,
            &self.counts,
            &mut self.warm,
            &params,
        );
    }

    fn step(&mut self) {
        self.articulate();
        self.contact();
        self.constrain();
        self.solve();
    }
}

fn scenes() -> [(&'static str, Model, usize); 4] {
    [
        ("one", scenes::one(), 65),
        ("two", scenes::two(), 9),
        ("punching", scenes::punching(), 9),
        ("odd", mjcf::parse(ODD, Path::new("odd.xml")).unwrap(), 9),
    ]
}

/// A tree that is fastened, two hinges in a body, bodies without drive or mass, contacts without friction
/// and with another rise of impedance.
const ODD: &str = r#"<mujoco model="odd">
  <worldbody>
    <geom name="ground" type="plane" size="0 0 1"/>
    <body name="mast" pos="0 0 .09">
      <joint name="yaw" axis="0 0 1"/>
      <joint name="pitch" axis="0 1 0" range="-60 60"/>
      <geom name="mast" type="capsule" fromto="0 0 0 .3 0 0" size=".1" condim="1"/>
      <body name="tip" pos=".3 0 0"/>
      <body name="arm" pos=".3 0 0">
        <joint name="arm" axis="0 0 1" range="-90 90"/>
        <geom name="arm" type="capsule" fromto="0 0 0 .3 0 0" size=".05" solimp=".8 .95 .01 .3 3"/>
      </body>
    </body>
    <body name="ball" pos=".2 0 .5">
      <freejoint name="ball"/>
      <geom name="ball" size=".15" condim="1"/>
      <body name="pendulum">
        <joint name="pendulum" type="ball"/>
        <geom name="pendulum" type="box" size=".05 .05 .2" pos="0 0 -.2"/>
      </body>
    </body>
  </worldbody>
  <actuator><position name="arm" joint="arm" kp="50" kv="5" forcerange="-10 10"/></actuator>
</mujoco>"#;

fn up<T: Pod>(gpu: &Gpu, values: &[T]) -> Buffer<T> {
    Buffer::from_slice(gpu, values)
}

/// Compares fields `from..to` of `[fields][envs]`, an environment at a time.
#[track_caller]
fn near(
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

#[test]
fn articulate_agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 1);
        let (params, at) = (worlds.articulate_params(), Sections::of(&worlds.model));
        let trees = worlds.model.trees.len();
        let blank = (
            vec![POISON; worlds.poses.len()],
            vec![POISON; worlds.dynamics.len()],
        );
        let gpu = gpu();
        let (poses, dynamics) = (up(&gpu, &blank.0), up(&gpu, &blank.1));
        articulate::launch(
            &gpu,
            trees,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.state),
            &up(&gpu, &worlds.targets),
            &up(&gpu, &worlds.pushes),
            &poses,
            &dynamics,
            &params,
        );
        let launched = (poses.read(&gpu).unwrap(), dynamics.read(&gpu).unwrap());
        let buffers: [&[u8]; 6] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.state),
            cast_slice(&worlds.targets),
            cast_slice(&worlds.pushes),
            cast_slice(&blank.0),
            cast_slice(&blank.1),
        ];
        let groups = [envs.div_ceil(64) as u32, trees as u32, 1];
        let outcome = checked::run(&shader::ARTICULATE, groups, &buffers, &params);
        let checked = (outcome.of(4), outcome.of(5));
        for (form, (poses, dynamics)) in [("launch", launched), ("checked", checked)] {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            near(
                &what("poses"),
                &poses,
                &worlds.poses,
                envs,
                0..POSE * worlds.model.bodies.len(),
                1e-5,
            );
            for (section, range, bar) in [
                ("axes", 0..at.factors, 1e-5),
                ("factors", at.factors..at.weighted, 1e-4),
                ("weighted", at.weighted..at.velocities, 1e-4),
                ("velocities", at.velocities..at.len, 1e-5),
            ] {
                near(
                    &what(section),
                    &dynamics,
                    &worlds.dynamics,
                    envs,
                    range,
                    bar,
                );
            }
        }
    }
}

#[test]
fn constrain_agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 2);
        let (params, joints) = (worlds.constrain_params(), worlds.model.joints.len());
        let row_groups = constrain::row_groups(&worlds.model, worlds.settings.slots);
        let blank = (
            vec![POISON; worlds.rows.len()],
            vec![POISON; worlds.constraints.len()],
        );
        let gpu = gpu();
        let (rows, constraints) = (up(&gpu, &blank.0), up(&gpu, &blank.1));
        constrain::launch(
            &gpu,
            row_groups,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.state),
            &up(&gpu, &worlds.dynamics),
            &up(&gpu, &worlds.touches),
            &up(&gpu, &worlds.keys),
            &up(&gpu, &worlds.counts),
            &rows,
            &constraints,
            &params,
        );
        let launched = (rows.read(&gpu).unwrap(), constraints.read(&gpu).unwrap());
        let buffers: [&[u8]; 8] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.state),
            cast_slice(&worlds.dynamics),
            cast_slice(&worlds.touches),
            cast_slice(&worlds.keys),
            cast_slice(&worlds.counts),
            cast_slice(&blank.0),
            cast_slice(&blank.1),
        ];
        let groups = [envs.div_ceil(64) as u32, row_groups as u32, 1];
        let outcome = checked::run(&shader::CONSTRAIN, groups, &buffers, &params);
        let checked = (outcome.of(6), outcome.of(7));
        // What constraints that do not act are left with means nothing.
        let acting = |values: &[f32], wanted: &[f32]| -> Vec<f32> {
            let pairs = values.iter().zip(wanted);
            pairs
                .map(|(&v, &w)| if w == POISON { POISON } else { v })
                .collect()
        };
        let contacts: u32 = worlds.counts[..envs].iter().sum();
        assert!(contacts as usize > envs, "{scene}: {contacts} contacts");
        for (form, (rows, constraints)) in [("launch", launched), ("checked", checked)] {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            for slot in 0..worlds.settings.slots + joints {
                let fields = slot * CONSTRAINT..(slot + 1) * CONSTRAINT;
                let found = acting(&constraints, &worlds.constraints);
                near(
                    &what("constraints"),
                    &found,
                    &worlds.constraints,
                    envs,
                    fields,
                    1e-4,
                );
            }
            let real = worlds.rows.iter().filter(|&&w| w != POISON);
            let most = real.fold(0.0f32, |most, w| most.max(w.abs()));
            for (found, wanted) in acting(&rows, &worlds.rows).iter().zip(&worlds.rows) {
                let off = (found - wanted).abs() / most;
                assert!(off <= 1e-4, "{}: {found} instead of {wanted}", what("rows"));
            }
        }
    }
}

#[test]
fn solve_agrees() {
    for (scene, model, envs) in scenes() {
        let before = Worlds::new(model, envs, 3);
        let mut after = before.clone();
        after.solve();
        let params = before.solve_params();
        let gpu = gpu();
        let (state, warm) = (up(&gpu, &before.state), up(&gpu, &before.warm));
        solve::launch(
            &gpu,
            &up(&gpu, &before.tables),
            &state,
            &up(&gpu, &before.dynamics),
            &up(&gpu, &before.rows),
            &up(&gpu, &before.constraints),
            &up(&gpu, &before.keys),
            &up(&gpu, &before.counts),
            &warm,
            &params,
        );
        let launched = (state.read(&gpu).unwrap(), warm.read(&gpu).unwrap());
        let buffers: [&[u8]; 8] = [
            cast_slice(&before.tables),
            cast_slice(&before.state),
            cast_slice(&before.dynamics),
            cast_slice(&before.rows),
            cast_slice(&before.constraints),
            cast_slice(&before.keys),
            cast_slice(&before.counts),
            cast_slice(&before.warm),
        ];
        let outcome = checked::run(
            &shader::SOLVE,
            groups(&shader::SOLVE, envs),
            &buffers,
            &params,
        );
        let checked = (outcome.of(1), outcome.of(7));
        let (slots, joints) = (before.settings.slots, before.model.joints.len());
        let positions = before.model.positions();
        for (form, (state, warm)) in [("launch", launched), ("checked", checked)] {
            let what = |section: &str| format!("{scene}, {form}, {section}");
            let values = positions + before.model.velocities();
            near(
                &what("positions"),
                &state,
                &after.state,
                envs,
                0..positions,
                1e-4,
            );
            near(
                &what("velocities"),
                &state,
                &after.state,
                envs,
                positions..values,
                1e-3,
            );
            let (found, wanted) = (&warm[..slots * envs], &after.warm[..slots * envs]);
            assert_eq!(found, wanted, "{}", what("keys"));
            let forces = |warm: &[u32]| -> Vec<f32> {
                let forces = warm[slots * envs..].iter();
                forces.map(|&force| f32::from_bits(force)).collect()
            };
            near(
                &what("forces"),
                &forces(&warm),
                &forces(&after.warm),
                envs,
                0..solve::warm(slots, joints) - slots,
                1e-2,
            );
        }
    }
}

#[test]
fn blows_agree() {
    for (scene, model, envs) in scenes() {
        let mut worlds = Worlds::new(model, envs, 4);
        worlds.solve();
        let params = blows::Params {
            envs: envs as u32,
            slots: worlds.settings.slots as u32,
            first: 1,
            share: 0.25,
        };
        let gpu = gpu();
        let (forces, tallies) = (up(&gpu, &worlds.forces), up(&gpu, &worlds.tallies));
        blows::launch(
            &gpu,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.touches),
            &up(&gpu, &worlds.keys),
            &up(&gpu, &worlds.counts),
            &up(&gpu, &worlds.warm),
            &up(&gpu, &worlds.watched),
            &forces,
            &tallies,
            &params,
        );
        let buffers: [&[u8]; 8] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.touches),
            cast_slice(&worlds.keys),
            cast_slice(&worlds.counts),
            cast_slice(&worlds.warm),
            cast_slice(&worlds.watched),
            cast_slice(&worlds.forces),
            cast_slice(&worlds.tallies),
        ];
        let outcome = checked::run(
            &shader::BLOWS,
            groups(&shader::BLOWS, envs),
            &buffers,
            &params,
        );
        let model = worlds.model.clone();
        blows::twin(
            &model,
            &worlds.touches,
            &worlds.keys,
            &worlds.counts,
            &worlds.warm,
            &worlds.watched,
            &mut worlds.forces,
            &mut worlds.tallies,
            &params,
        );
        let fields = worlds.forces.len() / envs;
        for (form, forces, tallies) in [
            (
                "launch",
                forces.read(&gpu).unwrap(),
                tallies.read(&gpu).unwrap(),
            ),
            ("checked", outcome.of(6), outcome.of(7)),
        ] {
            near(
                &format!("{scene}, {form}"),
                &forces,
                &worlds.forces,
                envs,
                0..fields,
                1e-4,
            );
            assert_eq!(tallies, worlds.tallies, "{scene}, {form}");
        }
    }
}

#[test]
fn restart_agrees() {
    for (scene, model, envs) in scenes() {
        let mut worlds = Worlds::new(model, envs, 5);
        let starts = worlds.state.clone();
        worlds.solve();
        let positions = worlds.model.positions();
        let mask: Vec<u32> = (0..envs as u32)
            .map(|env| u32::from(env % 3 == 1))
            .collect();
        worlds.state[0] = f32::NAN;
        worlds.state[5 * envs + 4] = f32::NEG_INFINITY;
        worlds.state[(positions + 2) * envs + 3] = 2000.0;
        worlds.state[positions * envs + 6] = 900.0;
        let params = restart::Params {
            envs: envs as u32,
            fastest: 1000.0,
        };
        let gpu = gpu();
        let (state, warm) = (up(&gpu, &worlds.state), up(&gpu, &worlds.warm));
        let forces = up(&gpu, &worlds.forces);
        let tallies = up(&gpu, &worlds.tallies);
        restart::launch(
            &gpu,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &mask),
            &up(&gpu, &starts),
            &state,
            &warm,
            &up(&gpu, &worlds.watched),
            &forces,
            &tallies,
            &params,
        );
        let buffers: [&[u8]; 8] = [
            cast_slice(&worlds.tables),
            cast_slice(&mask),
            cast_slice(&starts),
            cast_slice(&worlds.state),
            cast_slice(&worlds.warm),
            cast_slice(&worlds.watched),
            cast_slice(&worlds.forces),
            cast_slice(&worlds.tallies),
        ];
        let outcome = checked::run(
            &shader::RESTART,
            groups(&shader::RESTART, envs),
            &buffers,
            &params,
        );
        restart::twin(
            &worlds.model.clone(),
            worlds.settings.slots,
            &mask,
            &starts,
            &mut worlds.state,
            &mut worlds.warm,
            &worlds.watched,
            &mut worlds.forces,
            &mut worlds.tallies,
            &params,
        );
        let broken = &worlds.tallies[blows::BROKEN * envs..][..envs];
        assert_eq!(broken.iter().sum::<u32>(), 3, "{scene}");
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let launched = (
            state.read(&gpu).unwrap(),
            warm.read(&gpu).unwrap(),
            forces.read(&gpu).unwrap(),
            tallies.read(&gpu).unwrap(),
        );
        let checked = (outcome.of(3), outcome.of(4), outcome.of(6), outcome.of(7));
        for (form, (state, warm, forces, tallies)) in [("launch", launched), ("checked", checked)] {
            assert_eq!(bits(&state), bits(&worlds.state), "{scene}, {form}");
            assert_eq!(warm, worlds.warm, "{scene}, {form}");
            assert_eq!(forces, worlds.forces, "{scene}, {form}");
            assert_eq!(tallies, worlds.tallies, "{scene}, {form}");
        }
    }
}

#[test]
fn proprioception_agrees() {
    for (scene, model, envs) in scenes() {
        let worlds = Worlds::new(model, envs, 6);
        let model = &worlds.model;
        // Every humanoid of the scene knows where its first and its last body are.
        let width = |tree| proprioception::width(model, tree, 2);
        let humanoids = (0..model.trees.len()).filter(|&tree| width(tree) == width(0));
        let lists = humanoids.flat_map(|tree| {
            let bodies = &model.trees[tree].bodies;
            [tree, bodies.start, bodies.end - 1].map(|n| n as u32)
        });
        let characters: Vec<u32> = [2].into_iter().chain(lists).collect();
        let params = proprioception::Params {
            envs: envs as u32,
            characters: characters.len() as u32 / 3,
            width: proprioception::width(model, 0, 2) as u32,
        };
        let len = (params.characters * params.envs * params.width) as usize;
        let mut wanted = vec![POISON; len];
        let blank = wanted.clone();
        proprioception::twin(
            model,
            &worlds.state,
            &worlds.poses,
            &worlds.dynamics,
            &characters,
            &mut wanted,
            &params,
        );
        let gpu = gpu();
        let felt = up(&gpu, &blank);
        proprioception::launch(
            &gpu,
            &up(&gpu, &worlds.tables),
            &up(&gpu, &worlds.state),
            &up(&gpu, &worlds.poses),
            &up(&gpu, &worlds.dynamics),
            &up(&gpu, &characters),
            &felt,
            &params,
        );
        let buffers: [&[u8]; 6] = [
            cast_slice(&worlds.tables),
            cast_slice(&worlds.state),
            cast_slice(&worlds.poses),
            cast_slice(&worlds.dynamics),
            cast_slice(&characters),
            cast_slice(&blank),
        ];
        let invocations = (params.characters * params.envs) as usize;
        let groups = groups(&shader::PROPRIOCEPTION, invocations);
        let outcome = checked::run(&shader::PROPRIOCEPTION, groups, &buffers, &params);
        for (form, felt) in [
            ("launch", felt.read(&gpu).unwrap()),
            ("checked", outcome.of(5)),
        ] {
            near(&format!("{scene}, {form}"), &felt, &wanted, 1, 0..len, 1e-5);
        }
    }
}

#[test]
fn explore_agrees_bit_for_bit() {
    let params = explore::Params {
        envs: 129,
        deviation: 0.5,
        seed: 7,
        clock: 3,
        stream: 11,
    };
    let mut wanted = vec![POISON; 129 * 28];
    let gpu = gpu();
    let targets = up(&gpu, &wanted);
    let blank = wanted.clone();
    explore::twin(&mut wanted, &params);
    explore::launch(&gpu, 28, &targets, &params);
    let groups = [3, 28, 1];
    let outcome = checked::run(&shader::EXPLORE, groups, &[cast_slice(&blank)], &params);
    assert_eq!(targets.read(&gpu).unwrap(), wanted);
    assert_eq!(outcome.of::<f32>(0), wanted);
}
