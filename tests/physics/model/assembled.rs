//! Several models in one world.

use super::parse;
use footwork::physics::assemble::{Part, assemble};
use footwork::physics::collision::PairKind;
use footwork::physics::humanoid::{humanoid, punching_box};
use footwork::physics::mjcf;
use footwork::physics::model::{GeomShape, JointKind, Model};
use footwork::physics::scenes::{boxing_match, humanoid_and_box};
use glam::{Quat, Vec3};
use std::collections::HashSet;
use std::f32::consts::FRAC_PI_2;

fn part<'a>(prefix: &'a str, model: &'a Model, x: f32) -> Part<'a> {
    Part {
        prefix,
        model,
        position: Vec3::X * x,
        yaw: 0.0,
    }
}

#[test]
fn a_model_alone_is_unchanged() {
    for model in [humanoid(), punching_box()] {
        assert_eq!(assemble(&[part("", &model, 0.0)]), model);
    }
}

#[test]
fn a_humanoid_and_a_box() {
    let (body, block) = (humanoid(), punching_box());
    let world = assemble(&[part("", &body, 0.0), part("", &block, 1.0)]);
    assert_eq!(world.bodies.len(), 16);
    assert_eq!(world.nv(), 40);
    assert_eq!(
        (world.trees[1].bodies.clone(), world.trees[1].dofs.clone()),
        (15..16, 34..40)
    );
    assert_eq!(world.qpos0[43..46], [1.0, 0.0, 0.9]);
    // One ground; the box touches it and each of the body's 18 geoms.
    let planes = world
        .geoms
        .iter()
        .filter(|geom| geom.shape == GeomShape::Plane);
    assert_eq!(planes.count(), 1);
    assert_eq!(world.pairs.len(), body.pairs.len() + 1 + 18);
    coherent(&world);
}

/// Names with prefixes, one ground, excluded and crossed pairs, where each part stands.
#[test]
fn worlds_are_written_and_read_again() {
    let scenes = [boxing_match(), humanoid_and_box()];
    for world in scenes {
        let text = mjcf::to_text(&world).unwrap();
        let again = parse(&text).unwrap();
        assert_eq!(again.name, world.name);
        let pairs = |model: &Model| HashSet::<[usize; 2]>::from_iter(model.pairs.iter().copied());
        assert_eq!(pairs(&again), pairs(&world));
        assert_eq!(again.trees, world.trees);
        for (again, body) in again.bodies.iter().zip(&world.bodies) {
            assert_eq!((&again.name, again.mass), (&body.name, body.mass));
            assert_eq!((again.position, again.com), (body.position, body.com));
            assert_eq!(again.inertia, body.inertia);
        }
        for (again, joint) in again.joints.iter().zip(&world.joints) {
            assert_eq!(again, joint);
        }
        for (again, dof) in again.dofs.iter().zip(&world.dofs) {
            assert_eq!((again.drive, again.armature), (dof.drive, dof.armature));
        }
        let away = |(a, b): (&f32, &f32)| (a - b).abs();
        let start = again.qpos0.iter().zip(&world.qpos0).map(away);
        assert!(start.fold(0.0, f32::max) < 1e-6);
    }
}

#[test]
fn shapes_of_which_some_touch_and_some_do_not_are_not_written() {
    let mut world = humanoid_and_box();
    let shape = |name: &str| {
        let mut geoms = world.geoms.iter();
        geoms.position(|geom| geom.name == name).unwrap()
    };
    let [head, chest, block] = ["head", "torso", "box"].map(shape);
    world
        .pairs
        .retain(|pair| !(pair.contains(&head) && pair.contains(&block)));
    assert!(
        mjcf::to_text(&world)
            .unwrap()
            .contains("<exclude body1=\"head\" body2=\"box\"/>")
    );
    world
        .pairs
        .retain(|pair| !(pair.contains(&chest) && pair.contains(&block)));
    let error = mjcf::to_text(&world).unwrap_err().to_string();
    assert!(error.contains("torso") && error.contains("box"), "{error}");
}

#[test]
fn two_humanoids() {
    let body = humanoid();
    let red = part("red/", &body, -1.0);
    let blue = Part {
        yaw: FRAC_PI_2,
        ..part("blue/", &body, 1.0)
    };
    let world = assemble(&[red, blue]);
    coherent(&world);
    assert_eq!(world.nu(), 56);
    let names: HashSet<&str> = world.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names.len(), 30);
    let [right, left] = ["red/left_hand", "blue/left_hand"].map(|name| world.body(name).unwrap());
    assert_eq!(right + 15, left);
    // All but names and places is the same of both.
    for index in 0..15 {
        let (one, other) = (&world.bodies[index], &world.bodies[index + 15]);
        assert_eq!((one.mass, one.invweight0), (other.mass, other.invweight0));
        assert_eq!(one.parent.map(|parent| parent + 15), other.parent);
    }
    for index in 0..34 {
        let (one, other) = (&world.dofs[index], &world.dofs[index + 34]);
        assert_eq!((one.drive, one.depth), (other.drive, other.depth));
        assert_eq!(one.row + body.nm(), other.row);
    }
    let position = Vec3::from_slice(&world.qpos0[43..]);
    assert!(position.abs_diff_eq(Vec3::new(1.0, 0.0, body.qpos0[2]), 1e-6));
    let rotation = Quat::from_rotation_z(FRAC_PI_2);
    assert_eq!(
        world.qpos0[46..50],
        [rotation.w, rotation.x, rotation.y, rotation.z]
    );
    // Twice a body's own, and each geom with each of the other's.
    assert_eq!(world.pairs.len(), 2 * body.pairs.len() + 18 * 18);
}

#[test]
fn a_fastened_model_is_moved_with_its_place() {
    let text = "<mujoco><worldbody><geom name='ground' type='plane' size='1 1 1'/>
        <body pos='1 0 2'><joint/><geom size='.1'/></body></worldbody></mujoco>";
    let model = parse(text).unwrap();
    let moved = Part {
        prefix: "a/",
        model: &model,
        position: Vec3::Y,
        yaw: FRAC_PI_2,
    };
    let world = assemble(&[moved]);
    assert!((world.bodies[0].position - Vec3::new(0.0, 2.0, 2.0)).length() < 1e-6);
    assert_eq!(
        (world.bodies[0].name.as_str(), world.geoms[0].name.as_str()),
        ("", "a/ground")
    );
}

/// All indices fit together.
fn coherent(world: &Model) {
    let (mut q, mut v) = (0, 0);
    for (index, joint) in world.joints.iter().enumerate() {
        assert_eq!((joint.q, joint.v), (q, v));
        q += joint.kind.nq();
        v += joint.kind.nv();
        assert!(world.bodies[joint.body].joints.contains(&index));
        assert!(world.dofs[joint.v..v].iter().all(|dof| dof.joint == index));
        assert_eq!(
            joint.kind == JointKind::Free,
            world.bodies[joint.body].parent.is_none()
        );
    }
    assert_eq!((q, v), (world.qpos0.len(), world.dofs.len()));
    let mut row = 0;
    for (index, dof) in world.dofs.iter().enumerate() {
        assert_eq!(dof.row, row);
        row += dof.depth;
        assert!(world.bodies[dof.body].dofs.contains(&index));
        assert_eq!(
            dof.depth,
            dof.parent.map_or(0, |parent| world.dofs[parent].depth) + 1
        );
    }
    for (index, tree) in world.trees.iter().enumerate() {
        assert!(
            world.bodies[tree.bodies.clone()]
                .iter()
                .all(|body| body.tree == index)
        );
    }
    let unique: HashSet<_> = world.pairs.iter().collect();
    assert_eq!(unique.len(), world.pairs.len());
    let shapes = |pair: &[usize; 2]| pair.map(|geom| world.geoms[geom].shape);
    assert!(
        world
            .pairs
            .is_sorted_by_key(|pair| PairKind::of(shapes(pair)))
    );
}
