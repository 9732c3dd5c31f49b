//! Contacts of pairs of shapes against those MuJoCo finds (`tests/reference/collide.py`), and of worlds
//! against all pairs one by one.

use crate::golden;
use footwork::physics::collision::{
    ContactManifold, ContactPoint, DetectedContacts, MAX_POINTS, WorldGeom, collide,
    detect_contacts,
};
use footwork::physics::model::{Geom, GeomShape, Model};
use footwork::physics::pose::Pose;
use glam::{Mat3, Quat, Vec3};
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
struct Case {
    pair: String,
    way: String,
    sizes: [Vec<f32>; 2],
    places: [Vec3; 2],
    /// w, x, y, z
    turns: [[f32; 4]; 2],
    /// Ten numbers each: place, normal, tangent, distance.
    contacts: Vec<f32>,
}

impl Case {
    fn placed(&self) -> [WorldGeom; 2] {
        let kinds: Vec<&str> = self.pair.split(' ').collect();
        std::array::from_fn(|i| {
            let [w, x, y, z] = self.turns[i];
            WorldGeom {
                shape: shape(kinds[i], &self.sizes[i]),
                position: self.places[i],
                rotation: Mat3::from_quat(Quat::from_xyzw(x, y, z, w).normalize()),
            }
        })
    }

    fn wanted(&self) -> Vec<ContactPoint> {
        let contacts = self.contacts.chunks_exact(10);
        let touch = |c: &[f32]| ContactPoint {
            position: Vec3::from_slice(c),
            normal: Vec3::from_slice(&c[3..]),
            tangent: Vec3::from_slice(&c[6..]),
            distance: c[9],
        };
        contacts.map(touch).collect()
    }
}

fn shape(kind: &str, size: &[f32]) -> GeomShape {
    match kind {
        "plane" => GeomShape::Plane,
        "sphere" => GeomShape::Sphere { radius: size[0] },
        "capsule" => GeomShape::Capsule {
            radius: size[0],
            half: size[1],
        },
        "box" => GeomShape::Box {
            half: Vec3::from_slice(size),
        },
        _ => panic!("{kind}"),
    }
}

fn radius(shape: GeomShape) -> f32 {
    match shape {
        GeomShape::Sphere { radius } | GeomShape::Capsule { radius, .. } => radius,
        _ => 0.0,
    }
}

/// How far from MuJoCo's a touch is: place, normal, tangent, distance, each as a part of its bar.
///
/// The bar is 1e-5, m or of a unit vector, and what the rounding of the input to single precision
/// changes besides. A direction from one point to another has few digits where these all but meet:
/// 1e-6 m of rounding turn it by that over their distance. The place along all but parallel axes of
/// capsules is known to 3e-7 m over their angle. The tangent along a capsule all but upright on a
/// plane turns by 1e-6 over its tilt.
fn parts(
    [first, second]: &[WorldGeom; 2],
    found: &ContactPoint,
    wanted: &ContactPoint,
) -> [f32; 4] {
    const BAR: f32 = 1e-5;
    const TURNING: f32 = 1e-6;
    const SHIFTING: f32 = 3e-7;
    let plane = first.shape == GeomShape::Plane;
    let gap = wanted.distance + radius(first.shape) + radius(second.shape);
    let round = !plane && radius(first.shape) > 0.0;
    let blur = if round { TURNING / gap.abs() } else { 0.0 };
    let mut off = found.position - wanted.position;
    let capsule = |placed: &WorldGeom| matches!(placed.shape, GeomShape::Capsule { .. });
    if capsule(first) && capsule(second) {
        let axis = first.rotation.z_axis;
        let angle = axis.cross(second.rotation.z_axis).length();
        let along = axis.dot(off);
        let known = if angle < 0.02 { SHIFTING / angle } else { 0.0 };
        off -= axis * (along.signum() * along.abs().min(known));
    }
    let tilt = match plane && capsule(second) {
        true => first.rotation.z_axis.cross(second.rotation.z_axis).length(),
        false => 1.0,
    };
    [
        off.length() / (BAR + blur),
        (found.normal - wanted.normal).length() / (BAR + blur),
        (found.tangent - wanted.tangent).length() / (BAR + blur + TURNING / tilt),
        (found.distance - wanted.distance).abs() / BAR,
    ]
}

/// The largest parts, of touches paired with MuJoCo's whatever their order.
fn compare(case: &Case, found: &[ContactPoint]) -> [f32; 4] {
    let (placed, mut rest) = (case.placed(), found.to_vec());
    let what = format!("{}, {}: {:?} {:?}", case.pair, case.way, placed, found);
    let wanted = case.wanted();
    assert_eq!(found.len(), wanted.len(), "{what} instead of {wanted:?}");
    let mut most = [0.0f32; 4];
    for wanted in &wanted {
        let far = |touch: &ContactPoint| touch.position.distance_squared(wanted.position);
        let nearest = (0..rest.len()).min_by(|&a, &b| far(&rest[a]).total_cmp(&far(&rest[b])));
        let touch = rest.swap_remove(nearest.expect("as many"));
        let parts = parts(&placed, &touch, wanted);
        assert!(
            parts.iter().all(|part| *part <= 1.0),
            "{what}: {parts:?} of what may be off"
        );
        most = std::array::from_fn(|i| most[i].max(parts[i]));
    }
    most
}

fn touches(first: &WorldGeom, second: &WorldGeom) -> ContactManifold {
    let mut touches = ContactManifold::default();
    collide(first, second, &mut touches);
    touches
}

#[test]
fn touches_as_in_mujoco() {
    let cases: Vec<Case> = golden::json("collide.json");
    let mut most = BTreeMap::<&str, [f32; 4]>::new();
    for case in &cases {
        let [first, second] = case.placed();
        let parts = compare(case, touches(&first, &second).as_slice());
        let most = most.entry(&case.pair).or_default();
        *most = std::array::from_fn(|i| most[i].max(parts[i]));
    }
    assert_eq!(most.len(), 9);
    for (pair, [position, normal, tangent, distance]) in most {
        println!(
            "{pair}: position {position:.2}, normal {normal:.2}, tangent {tangent:.2}, distance {distance:.2} of the bar"
        );
    }
}

/// Geoms of all shapes, half of them on one body each, and all their pairs.
fn crowd(count: usize) -> Model {
    let geom = |index: usize| Geom {
        name: String::new(),
        body: (index > count / 2).then(|| index - count / 2 - 1),
        shape: match index * 4 / count {
            0 => GeomShape::Plane,
            1 => shape("sphere", &[0.2]),
            2 => shape("capsule", &[0.1, 0.2]),
            _ => shape("box", &[0.1, 0.2, 0.15]),
        },
        position: wave(index, 0.3),
        rotation: Quat::from_scaled_axis(wave(index + 7, 2.0)),
        friction: 1.0,
        frictionless: false,
        solver_params: Default::default(),
    };
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    Model {
        geoms: (0..count).map(geom).collect(),
        pairs: pairs.collect(),
        ..Model::default()
    }
}

/// Numbers like random ones.
fn wave(index: usize, size: f32) -> Vec3 {
    let angle = index as f32;
    size * Vec3::new(
        (angle * 12.9).sin(),
        (angle * 78.2).sin(),
        (angle * 37.7).sin(),
    )
}

fn poses(count: usize) -> Vec<Pose> {
    let pose = |index| Pose {
        position: wave(index + 100, 0.8),
        rotation: Quat::from_scaled_axis(wave(index + 200, 3.0)),
    };
    (0..count).map(pose).collect()
}

fn contacts(model: &Model, poses: &[Pose], max_contacts: usize) -> DetectedContacts {
    let mut contacts = DetectedContacts::default();
    detect_contacts(model, poses, max_contacts, &mut contacts);
    contacts
}

#[test]
fn finds_what_all_pairs_have_one_by_one() {
    let (model, poses) = (crowd(32), poses(15));
    let placed: Vec<WorldGeom> = model
        .geoms
        .iter()
        .map(|geom| position(geom, &poses))
        .collect();
    let (mut wanted, mut keys) = (Vec::new(), Vec::new());
    for (pair, &[first, second]) in model.pairs.iter().enumerate() {
        let touches = touches(&placed[first], &placed[second]);
        wanted.extend_from_slice(touches.as_slice());
        keys.extend(
            touches
                .numbers()
                .iter()
                .map(|number| (pair * MAX_POINTS) as u32 + number),
        );
    }
    let found = contacts(&model, &poses, usize::MAX);
    assert!(wanted.len() > 100, "{}", wanted.len());
    assert_eq!(found.points, wanted);
    assert_eq!(found.ids, keys);
    assert!(keys.is_sorted_by(|a, b| a < b), "keys tell contacts apart");
}

fn position(geom: &Geom, poses: &[Pose]) -> WorldGeom {
    let pose = geom.pose(poses);
    WorldGeom {
        shape: geom.shape,
        position: pose.position,
        rotation: Mat3::from_quat(pose.rotation),
    }
}

#[test]
fn keeps_the_deepest_and_counts_what_finds_no_slot() {
    let (model, poses) = (crowd(32), poses(15));
    let all = contacts(&model, &poses, usize::MAX);
    for max_contacts in [0, 1, 7, all.points.len() - 1, all.points.len()] {
        let some = contacts(&model, &poses, max_contacts);
        let mut deepest: Vec<usize> = (0..all.points.len()).collect();
        deepest.sort_by(|&a, &b| all.points[a].distance.total_cmp(&all.points[b].distance));
        let mut wanted: Vec<u32> = (deepest[..max_contacts].iter())
            .map(|&index| all.ids[index])
            .collect();
        wanted.sort_unstable();
        let mut found = some.ids.clone();
        found.sort_unstable();
        assert_eq!(found, wanted);
        for (point, id) in some.points.iter().zip(&some.ids) {
            let index = all.ids.iter().position(|other| other == id).unwrap();
            assert_eq!(*point, all.points[index]);
        }
        assert_eq!(some.overflow as usize, all.points.len() - max_contacts);
    }
}
