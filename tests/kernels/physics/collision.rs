//! Oracle: the twin, which `tests/physics/collide.rs` holds against MuJoCo.
//! Bar: the same contacts by the same ids; distances within 1e-5 m, positions within 1e-4 m and directions within
//! 1e-3, as few digits decide them where an axis all but meets another, or an edge. Rounding may decide for one
//! world in a hundred whether, or with which edge, two shapes touch.

use crate::checked;
use crate::inputs::{Draw, POISON, POISON_WHOLE, SIZES, gpu};
use bytemuck::cast_slice;
use footwork::gpu::{Buffer, groups, shader};
use footwork::kernels::physics::collision::{self, geoms};
use footwork::kernels::physics::make_constraints::CONTACT_DIM;
use footwork::kernels::physics::model_table::model_table;
use footwork::kernels::physics::smooth_dynamics::POSE_DIM;
use footwork::physics::mjcf::ordered;
use footwork::physics::model::{Body, Geom, GeomShape, Model};
use footwork::physics::simulator::SolverOptions;
use glam::{Quat, Vec3};

struct Case {
    model: Model,
    poses: Vec<f32>,
    params: collision::Params,
}

#[derive(Debug, PartialEq)]
struct Found {
    contacts: Vec<f32>,
    contact_ids: Vec<u32>,
    counts: Vec<u32>,
}

/// Geoms that the shader has room for.
const GEOMS_MOST: usize = shader::collision::constants::GEOM_BOUND as usize;

impl Case {
    fn table(&self) -> Vec<u32> {
        model_table(&self.model, &SolverOptions::fast(&self.model)).expect("it fits")
    }

    /// Every geom on a body of its own, but for the first, which stands still.
    fn new(
        geoms: Vec<(GeomShape, Vec3, Quat)>,
        max_contacts: usize,
        envs: usize,
        pose: &mut impl FnMut() -> (Vec3, Quat),
    ) -> Self {
        let count = geoms.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
        let mut model = Model {
            bodies: vec![Body::default(); count - 1],
            geoms: geoms.into_iter().enumerate().map(geom).collect(),
            ..Model::default()
        };
        model.pairs = ordered(&model.geoms, pairs.collect());
        let bodies = count - 1;
        let mut poses = vec![0.0; bodies * POSE_DIM * envs];
        for env in 0..envs {
            for body in 0..bodies {
                let (position, rotation) = pose();
                let numbers = position.to_array().into_iter().chain(rotation.to_array());
                for (field, number) in numbers.enumerate() {
                    poses[(body * POSE_DIM + field) * envs + env] = number;
                }
            }
        }
        Case {
            params: collision::Params {
                envs: envs as u32,
                max_contacts: max_contacts as u32,
            },
            model,
            poses,
        }
    }

    fn poisoned(&self) -> Found {
        let (envs, max_contacts) = (self.params.envs as usize, self.params.max_contacts as usize);
        Found {
            contacts: vec![POISON; max_contacts * CONTACT_DIM * envs],
            contact_ids: vec![POISON_WHOLE; max_contacts * envs],
            counts: vec![POISON_WHOLE; 2 * envs],
        }
    }

    fn twin(&self) -> Found {
        let mut found = self.poisoned();
        let Found {
            contacts,
            contact_ids,
            counts,
        } = &mut found;
        collision::twin(
            &self.model,
            &self.poses,
            contacts,
            contact_ids,
            counts,
            &self.params,
        );
        found
    }

    fn launch(&self) -> Found {
        let (gpu, empty) = (gpu(), self.poisoned());
        let geoms = Buffer::from_slice(&gpu, &geoms(&self.model));
        let pairs = Buffer::from_slice(&gpu, &self.table());
        let poses = Buffer::from_slice(&gpu, &self.poses);
        let contacts = Buffer::from_slice(&gpu, &empty.contacts);
        let contact_ids = Buffer::from_slice(&gpu, &empty.contact_ids);
        let counts = Buffer::from_slice(&gpu, &empty.counts);
        collision::launch(
            &gpu,
            &geoms,
            &pairs,
            &poses,
            &contacts,
            &contact_ids,
            &counts,
            &self.params,
        );
        Found {
            contacts: contacts.read(&gpu).expect("contacts"),
            contact_ids: contact_ids.read(&gpu).expect("contact_ids"),
            counts: counts.read(&gpu).expect("counts"),
        }
    }

    fn checked(&self) -> Found {
        let (empty, geoms, pairs) = (self.poisoned(), geoms(&self.model), self.table());
        let buffers: [&[u8]; 6] = [
            cast_slice(&geoms),
            cast_slice(&pairs),
            cast_slice(&self.poses),
            cast_slice(&empty.contacts),
            cast_slice(&empty.contact_ids),
            cast_slice(&empty.counts),
        ];
        let groups = groups(&shader::COLLISION, self.params.envs as usize);
        let outcome = checked::run(&shader::COLLISION, groups, &buffers, &self.params);
        Found {
            contacts: outcome.of(3),
            contact_ids: outcome.of(4),
            counts: outcome.of(5),
        }
    }

    /// How many contacts all worlds have. In at most `differing` rounding may have decided.
    fn agrees(&self, differing: usize) -> usize {
        let twin = self.twin();
        for (form, found) in [("launched", self.launch()), ("checked", self.checked())] {
            let worlds = 0..self.params.envs as usize;
            let off = worlds
                .filter(|&env| !self.same_keys(env, &found, &twin))
                .count();
            assert!(off <= differing, "{form}: contacts differ in {off} worlds");
            for env in 0..self.params.envs as usize {
                if self.same_keys(env, &found, &twin) {
                    self.compare(&format!("{form}, world {env}"), env, &found, &twin);
                }
            }
        }
        let kept = &twin.counts[..self.params.envs as usize];
        kept.iter().map(|&count| count as usize).sum()
    }

    fn same_keys(&self, env: usize, found: &Found, twin: &Found) -> bool {
        let envs = self.params.envs as usize;
        let column = |all: &[u32]| {
            all.iter()
                .skip(env)
                .step_by(envs)
                .copied()
                .collect::<Vec<_>>()
        };
        column(&found.contact_ids) == column(&twin.contact_ids)
            && column(&found.counts) == column(&twin.counts)
    }

    fn compare(&self, what: &str, env: usize, found: &Found, twin: &Found) {
        let envs = self.params.envs as usize;
        for slot in 0..self.params.max_contacts as usize {
            for field in 0..CONTACT_DIM {
                let at = (slot * CONTACT_DIM + field) * envs + env;
                let bar = match field {
                    0..3 => 1e-4,
                    3..9 => 1e-3,
                    _ => 1e-5,
                };
                let (found, wanted) = (found.contacts[at], twin.contacts[at]);
                let off = (found - wanted).abs();
                assert!(
                    off <= bar,
                    "{what}, slot {slot}, field {field}: {found} instead of {wanted}"
                );
            }
        }
    }
}

fn geom((index, (shape, position, rotation)): (usize, (GeomShape, Vec3, Quat))) -> Geom {
    Geom {
        name: String::new(),
        body: index.checked_sub(1),
        shape,
        position,
        rotation,
        friction: 1.0,
        frictionless: false,
        solver_params: Default::default(),
    }
}

fn rotation(draw: &mut Draw) -> Quat {
    let [x, y, z, w] = std::array::from_fn(|_| draw.normal());
    Quat::from_xyzw(x, y, z, w).normalize()
}

fn vector(draw: &mut Draw, half: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| draw.within(half)))
}

/// From 0.05 to 0.25 m.
fn size(draw: &mut Draw) -> f32 {
    0.15 + draw.within(0.1)
}

/// A plane, then as many of each other shape.
fn shapes(draw: &mut Draw, each: usize) -> Vec<(GeomShape, Vec3, Quat)> {
    let mut geoms = vec![(
        GeomShape::Plane,
        Vec3::NEG_Z * 0.5,
        Quat::from_rotation_x(0.3),
    )];
    for index in 0..3 * each {
        let shape = match index / each {
            0 => GeomShape::Sphere { radius: size(draw) },
            1 => GeomShape::Capsule {
                radius: 0.5 * size(draw),
                half: size(draw),
            },
            _ => GeomShape::Box {
                half: Vec3::from_array(std::array::from_fn(|_| size(draw))),
            },
        };
        geoms.push((shape, vector(draw, 0.2), rotation(draw)));
    }
    geoms
}

fn agrees_anywhere(envs: usize, max_contacts: usize) {
    let mut draw = Draw::new((envs + max_contacts) as u32);
    let geoms = shapes(&mut draw, 5);
    let mut pose = || (vector(&mut draw, 0.6), rotation(&mut draw));
    let found = Case::new(geoms, max_contacts, envs, &mut pose).agrees(envs / 100);
    assert!(found > envs, "{found} contacts in {envs} worlds");
}

#[test]
fn agrees_with_the_twin_anywhere() {
    for envs in SIZES {
        agrees_anywhere(envs, 32);
    }
}

#[test]
fn agrees_with_the_twin_with_few_slots_and_many() {
    for max_contacts in [2, 200] {
        agrees_anywhere(65, max_contacts);
    }
}

/// Faces on faces, axes side by side; in sixteenths of a metre, which no sum rounds.
#[test]
fn agrees_with_the_twin_where_all_is_aligned() {
    let geoms = [
        (GeomShape::Plane, Vec3::NEG_Z, Quat::IDENTITY),
        (
            GeomShape::Sphere { radius: 0.3125 },
            Vec3::ZERO,
            Quat::IDENTITY,
        ),
        (
            GeomShape::Sphere { radius: 0.1875 },
            Vec3::ZERO,
            Quat::IDENTITY,
        ),
        (
            GeomShape::Capsule {
                radius: 0.3125,
                half: 0.5,
            },
            Vec3::ZERO,
            Quat::IDENTITY,
        ),
        (
            GeomShape::Capsule {
                radius: 0.1875,
                half: 0.25,
            },
            Vec3::ZERO,
            Quat::IDENTITY,
        ),
        (
            GeomShape::Box {
                half: Vec3::new(0.5, 0.3125, 0.375),
            },
            Vec3::ZERO,
            Quat::IDENTITY,
        ),
        (
            GeomShape::Box {
                half: Vec3::splat(0.375),
            },
            Vec3::ZERO,
            Quat::IDENTITY,
        ),
    ];
    let mut draw = Draw::new(5);
    let mut position = || std::array::from_fn(|_| draw.below(7) as f32 * 0.25 - 0.75);
    let mut pose = || (Vec3::from_array(position()), Quat::IDENTITY);
    let found = Case::new(geoms.to_vec(), 64, 1000, &mut pose).agrees(0);
    assert!(found > 5000, "{found} contacts");
}

#[test]
fn what_is_apart_does_not_touch() {
    let geoms = shapes(&mut Draw::new(1), 1)[..2].to_vec();
    let case = Case::new(geoms, 4, 3, &mut || (Vec3::Z * 9.0, Quat::IDENTITY));
    assert_eq!(case.agrees(0), 0);
    assert_eq!(case.twin().counts, [0; 6]);
}

#[test]
fn as_many_geoms_as_there_is_room_for() {
    let mut draw = Draw::new(2);
    let geoms = shapes(&mut draw, GEOMS_MOST / 3);
    assert_eq!(geoms.len(), GEOMS_MOST);
    let mut pose = || (vector(&mut draw, 1.5), rotation(&mut draw));
    assert!(Case::new(geoms, 200, 5, &mut pose).agrees(0) > 100);
}
