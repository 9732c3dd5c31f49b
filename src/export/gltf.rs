//! Runs as binary glTF 2.0: skinned characters and one animation. Metres, y up; characters face +z.
//!
//! Nodes stand, and meshes are bound, in the pose of the first frame: programs that show no animation show a person.

mod document;
mod mesh;

use super::character::MovingCharacter;
use super::episode::characters;
use super::format::ExportFormat;
use crate::motion::clip::Clip;
use anyhow::Result;
use document::Document;
use glam::{Mat4, Quat, Vec3};
use gltf_json::accessor::Accessor;
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf_json::buffer::Target::{ArrayBuffer, ElementArrayBuffer};
use gltf_json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Animation, Index, Material, Mesh, Node, Scene, Skin};
use mesh::SkinnedMesh;
use std::collections::BTreeMap;

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "gltf",
    about: "One of the evaluation's episodes as an animated, skinned body",
    carries: |_| true,
    carried: "runs of every task",
    motion: true,
    write: |run| glb(&characters(run)?),
};

/// The file of characters whose clips have the same length and rate.
///
/// # Errors
/// It would be larger than 4 GiB.
pub fn glb(characters: &[MovingCharacter]) -> Result<Vec<u8>> {
    let mut document = Document::new();
    let clip = &characters[0].clip;
    let mut animation = Animation {
        channels: Vec::new(),
        samplers: Vec::new(),
        name: Some(clip.name.clone()),
        extensions: None,
        extras: Default::default(),
    };
    let times: Vec<f32> = (0..clip.frames())
        .map(|frame| frame as f32 / clip.rate)
        .collect();
    let times = document.bounded(&times, None);
    let mut nodes = Vec::new();
    for character in characters {
        let joints = add_joints(&mut document, &character.clip);
        animate(
            &mut document,
            &mut animation,
            &character.clip,
            &joints,
            times,
        );
        // A skinned mesh is where its joints are: its own node is nobody's child.
        nodes.extend([joints[0], add_skin(&mut document, character, joints)]);
    }
    document.root.push(animation);
    let scene = document.root.push(Scene {
        nodes,
        name: None,
        extensions: None,
        extras: Default::default(),
    });
    document.root.scene = Some(scene);
    document.into_glb()
}

/// A node for each joint, in the pose of the first frame.
fn add_joints(document: &mut Document, clip: &Clip) -> Vec<Index<Node>> {
    let skeleton = &clip.skeleton;
    let first = document.root.nodes.len() as u32;
    let index = |joint: usize| Index::new(first + joint as u32);
    for joint in 0..skeleton.joints() {
        let below = skeleton.parents.iter().enumerate();
        let children: Vec<Index<Node>> = below
            .filter(|(_, parent)| **parent == Some(joint))
            .map(|(child, _)| index(child))
            .collect();
        let translation = match joint {
            0 => clip.positions[0],
            _ => skeleton.offsets[joint],
        };
        document.root.push(Node {
            children: (!children.is_empty()).then_some(children),
            name: Some(skeleton.names[joint].clone()),
            rotation: Some(UnitQuaternion(clip.pose(0)[joint].normalize().to_array())),
            translation: Some(translation.to_array()),
            ..Node::default()
        });
    }
    (0..skeleton.joints()).map(index).collect()
}

/// Adds the movement of the root and the rotations of all joints.
fn animate(
    document: &mut Document,
    animation: &mut Animation,
    clip: &Clip,
    joints: &[Index<Node>],
    times: Index<Accessor>,
) {
    let mut channel = |node: Index<Node>, path: Property, output: Index<Accessor>| {
        let sampler = Index::push(
            &mut animation.samplers,
            Sampler {
                input: times,
                interpolation: Valid(Interpolation::Linear),
                output,
                extensions: None,
                extras: Default::default(),
            },
        );
        animation.channels.push(Channel {
            sampler,
            target: Target {
                node,
                path: Valid(path),
                extensions: None,
                extras: Default::default(),
            },
            extensions: None,
            extras: Default::default(),
        });
    };
    let positions: Vec<[f32; 3]> = clip.positions.iter().map(Vec3::to_array).collect();
    let output = document.accessor(&positions, None);
    channel(joints[0], Property::Translation, output);
    for (joint, &node) in joints.iter().enumerate() {
        let output = document.accessor(&rotations(clip, joint), None);
        channel(node, Property::Rotation, output);
    }
}

/// Rotations of a joint, each with the sign that is nearer to the one before: some programs interpolate numbers.
fn rotations(clip: &Clip, joint: usize) -> Vec<[f32; 4]> {
    let mut before = Quat::IDENTITY;
    let own = (0..clip.frames()).map(|frame| clip.pose(frame)[joint].normalize());
    own.map(|rotation| {
        before = match rotation.dot(before) < 0.0 {
            true => -rotation,
            false => rotation,
        };
        before.to_array()
    })
    .collect()
}

/// Adds the surface of a character; returns its node.
fn add_skin(
    document: &mut Document,
    character: &MovingCharacter,
    joints: Vec<Index<Node>>,
) -> Index<Node> {
    let name = &character.clip.skeleton.names[0];
    let (positions, rotations) = character.clip.world(0);
    let bound = positions.iter().zip(&rotations);
    let inverse_bind: Vec<[f32; 16]> = bound
        .map(|(&position, &rotation)| {
            let inverse = rotation.inverse();
            Mat4::from_rotation_translation(inverse, inverse * -position).to_cols_array()
        })
        .collect();
    let inverse_bind = document.accessor(&inverse_bind, None);
    let skin = document.root.push(Skin {
        inverse_bind_matrices: Some(inverse_bind),
        skeleton: Some(joints[0]),
        joints,
        name: Some(name.clone()),
        extensions: None,
        extras: Default::default(),
    });
    let meshes = mesh::meshes(character);
    let primitives = meshes
        .iter()
        .map(|mesh| primitive(document, mesh))
        .collect();
    let mesh = document.root.push(Mesh {
        primitives,
        weights: None,
        name: Some(name.clone()),
        extensions: None,
        extras: Default::default(),
    });
    document.root.push(Node {
        mesh: Some(mesh),
        skin: Some(skin),
        name: Some(format!("{name} skin")),
        ..Node::default()
    })
}

fn primitive(document: &mut Document, mesh: &SkinnedMesh) -> Primitive {
    let [r, g, b] = mesh.colour;
    let material = document.root.push(Material {
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, 1.0]),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(0.8),
            ..Default::default()
        },
        ..Default::default()
    });
    let joints: Vec<[u16; 4]> = mesh.joints.iter().map(|&joint| [joint, 0, 0, 0]).collect();
    let weights = vec![[1.0, 0.0, 0.0, 0.0]; joints.len()];
    let array = Some(ArrayBuffer);
    let attributes = [
        (
            Semantic::Positions,
            document.bounded(&mesh.positions, array),
        ),
        (Semantic::Normals, document.accessor(&mesh.normals, array)),
        (Semantic::Joints(0), document.accessor(&joints, array)),
        (
            Semantic::Weights(0),
            document.accessor::<[f32; 4]>(&weights, array),
        ),
    ];
    let attributes = attributes.into_iter().map(|(what, at)| (Valid(what), at));
    Primitive {
        attributes: attributes.collect::<BTreeMap<_, _>>(),
        indices: Some(document.accessor(&mesh.indices, Some(ElementArrayBuffer))),
        material: Some(material),
        mode: Valid(Mode::Triangles),
        targets: None,
        extensions: None,
        extras: Default::default(),
    }
}
