//! The surface of a character: triangles, each corner held by one joint.

use crate::export::character::MovingCharacter;
use crate::motion::skeleton::Skeleton;
use crate::playback::capsule_rig::{Bone, Spot};
use crate::playback::colours::Colour;
use crate::playback::meshes::{cube, sphere};
use glam::{Quat, Vec3};
use std::collections::HashMap;

/// Corners around a capsule, and rings from its equator to a pole.
const AROUND: usize = 16;
const UP: usize = 4;

/// What has one colour.
pub struct SkinnedMesh {
    pub colour: Colour,
    /// Corners where they are in the first frame, m.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// The joint that holds each corner.
    pub joints: Vec<u16>,
    /// Corners of the triangles, counterclockwise.
    pub indices: Vec<u32>,
    /// Corners by all that they are.
    known: HashMap<[u32; 7], u32>,
}

/// The meshes of a character, one for each of its colours.
pub fn meshes(character: &MovingCharacter) -> Vec<SkinnedMesh> {
    let skeleton = &character.clip.skeleton;
    let (positions, rotations) = character.clip.world(0);
    let mut meshes = Vec::new();
    let sphere = sphere(AROUND, UP);
    for bone in &character.bones {
        let mesh = mesh_of(&mut meshes, bone.colour);
        let held = held(skeleton, bone);
        let centres = held.map(|spot| spot.position(&positions, &rotations));
        let along = (centres[1] - centres[0]).normalize_or(Vec3::Z);
        let turned = Quat::from_rotation_arc(Vec3::Z, along);
        let corner = |&[x, y, z, end]: &[f32; 4]| {
            let (spot, centre) = (held[end as usize], centres[end as usize]);
            let normal = turned * Vec3::new(x, y, z);
            (centre + spot.radius * normal, normal, spot.joint)
        };
        mesh.add(sphere.iter().map(corner));
    }
    for cuboid in &character.cuboids {
        let mesh = mesh_of(&mut meshes, cuboid.colour);
        let (at, turned) = (positions[cuboid.joint], rotations[cuboid.joint]);
        let corner = |[corner, normal]: [[f32; 3]; 2]| {
            let corner = cuboid.rotation * (cuboid.half * Vec3::from(corner)) + cuboid.position;
            let normal = turned * cuboid.rotation * Vec3::from(normal);
            (at + turned * corner, normal, cuboid.joint)
        };
        mesh.add(cube().into_iter().map(corner));
    }
    meshes
}

fn mesh_of(meshes: &mut Vec<SkinnedMesh>, colour: Colour) -> &mut SkinnedMesh {
    let known = meshes.iter().position(|mesh| mesh.colour == colour);
    let index = known.unwrap_or(meshes.len());
    if known.is_none() {
        meshes.push(SkinnedMesh {
            colour,
            positions: Vec::new(),
            normals: Vec::new(),
            joints: Vec::new(),
            indices: Vec::new(),
            known: HashMap::new(),
        });
    }
    &mut meshes[index]
}

impl SkinnedMesh {
    /// Adds triangles: of each corner position, normal and joint. Those at a pole that are none are left out.
    fn add(&mut self, corners: impl Iterator<Item = (Vec3, Vec3, usize)>) {
        let corners: Vec<u32> = corners.map(|corner| self.corner(corner)).collect();
        for triangle in corners.chunks_exact(3) {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
            if a != b && b != c && c != a {
                self.indices.extend([a, b, c]);
            }
        }
    }

    /// The index of a corner.
    fn corner(&mut self, (position, normal, joint): (Vec3, Vec3, usize)) -> u32 {
        let normal = normal.normalize();
        let [x, y, z] = position.to_array().map(f32::to_bits);
        let [a, b, c] = normal.to_array().map(f32::to_bits);
        let next = self.positions.len() as u32;
        let index = *(self.known.entry([x, y, z, a, b, c, joint as u32])).or_insert(next);
        if index == next {
            self.positions.push(position.to_array());
            self.normals.push(normal.to_array());
            self.joints.push(joint as u16);
        }
        index
    }
}

/// The ends of a bone, each by the joint that holds it. Where a joint itself is moves with the joint's parent: so a
/// bone between the two moves with the upper one, and one between two limbs with what they hang on.
fn held(skeleton: &Skeleton, bone: &Bone) -> [Spot; 2] {
    let [a, b] = bone.ends;
    let above = |spot: Spot| match skeleton.parents[spot.joint] {
        Some(parent) if spot.offset == Vec3::ZERO => Spot {
            joint: parent,
            offset: skeleton.offsets[spot.joint],
            ..spot
        },
        _ => spot,
    };
    match [above(a), above(b)] {
        _ if a.joint == b.joint => [a, b],
        [_, upper] if upper.joint == a.joint => [a, upper],
        [upper, _] if upper.joint == b.joint => [upper, b],
        both => both,
    }
}
