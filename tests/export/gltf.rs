//! Motion as glTF files.

use super::motion::KINDS;
use footwork::export::character::MovingCharacter;
use footwork::motion::clip::Clip;
use glam::{Mat4, Quat, Vec3};
use gltf::Gltf;
use gltf::animation::util::ReadOutputs;
use gltf::mesh::util::{ReadIndices, ReadJoints};
use std::path::Path;
use std::process::Command;

/// A file with its numbers.
struct Read {
    file: Gltf,
    numbers: Vec<u8>,
}

impl Read {
    fn new(bytes: &[u8]) -> Read {
        let mut file = Gltf::from_slice(bytes).unwrap();
        let numbers = file.blob.take().unwrap();
        Read { file, numbers }
    }

    fn buffer(&self, buffer: gltf::Buffer) -> Option<&[u8]> {
        (buffer.index() == 0).then_some(&self.numbers)
    }

    /// World transforms of all nodes at a frame, by the animation alone.
    fn worlds(&self, frame: usize) -> Vec<Mat4> {
        let mut local: Vec<(Vec3, Quat)> = (self.file.nodes())
            .map(|node| {
                let (at, rotation, _) = node.transform().decomposed();
                (Vec3::from(at), Quat::from_array(rotation))
            })
            .collect();
        let animation = self.file.animations().next().unwrap();
        for channel in animation.channels() {
            let node = channel.target().node().index();
            let reader = channel.reader(|buffer| self.buffer(buffer));
            match reader.read_outputs().unwrap() {
                ReadOutputs::Translations(mut all) => {
                    local[node].0 = all.nth(frame).unwrap().into()
                }
                ReadOutputs::Rotations(all) => {
                    local[node].1 = Quat::from_array(all.into_f32().nth(frame).unwrap());
                }
                _ => panic!("nothing else is animated"),
            }
        }
        let mut worlds = vec![Mat4::IDENTITY; local.len()];
        let scene = self.file.default_scene().unwrap();
        let mut open: Vec<(gltf::Node, Mat4)> =
            scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
        while let Some((node, above)) = open.pop() {
            let (at, rotation) = local[node.index()];
            let world = above * Mat4::from_rotation_translation(rotation, at);
            worlds[node.index()] = world;
            open.extend(node.children().map(|child| (child, world)));
        }
        worlds
    }

    fn times(&self) -> Vec<f32> {
        let animation = self.file.animations().next().unwrap();
        let channel = animation.channels().next().unwrap();
        let reader = channel.reader(|buffer| self.buffer(buffer));
        reader.read_inputs().unwrap().collect()
    }

    /// Corners of a skin's mesh at a frame, as a renderer would have them.
    fn skinned(&self, skin: &gltf::Skin, worlds: &[Mat4]) -> Vec<Vec3> {
        let reader = skin.reader(|buffer| self.buffer(buffer));
        let inverse_bind = reader.read_inverse_bind_matrices().unwrap();
        let joints: Vec<Mat4> = (skin.joints().zip(inverse_bind))
            .map(|(joint, inverse)| worlds[joint.index()] * Mat4::from_cols_array_2d(&inverse))
            .collect();
        let mut nodes = self.file.nodes();
        let own = nodes.find(|node| {
            node.skin()
                .is_some_and(|other| other.index() == skin.index())
        });
        let mesh = own.unwrap().mesh().unwrap();
        let mut corners = Vec::new();
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|buffer| self.buffer(buffer));
            let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
            let Some(ReadJoints::U16(held)) = reader.read_joints(0) else {
                panic!("joints of 16 bits");
            };
            let moved = positions.iter().zip(held);
            let moved: Vec<Vec3> = moved
                .map(|(&at, [joint, ..])| joints[joint as usize].transform_point3(at.into()))
                .collect();
            assert!(
                reader
                    .read_weights(0)
                    .unwrap()
                    .into_f32()
                    .all(|weights| weights == [1.0, 0.0, 0.0, 0.0])
            );
            let Some(ReadIndices::U32(indices)) = reader.read_indices() else {
                panic!("indices of 32 bits");
            };
            let indices: Vec<u32> = indices.collect();
            assert!(indices.iter().all(|&index| (index as usize) < moved.len()));
            corners.extend(indices.iter().map(|&index| moved[index as usize]));
        }
        corners
    }
}

fn joints(read: &Read) -> Vec<Vec<usize>> {
    let skins = read.file.skins();
    skins
        .map(|skin| skin.joints().map(|joint| joint.index()).collect())
        .collect()
}

fn compare(told: &str, clip: &Clip, frame: usize, worlds: &[Mat4], joints: &[usize]) {
    let (positions, rotations) = clip.world(frame);
    assert_eq!(joints.len(), positions.len());
    for (joint, &node) in joints.iter().enumerate() {
        let (_, rotation, at) = worlds[node].to_scale_rotation_translation();
        let away = at.distance(positions[joint]);
        let turned = (rotations[joint].inverse() * rotation).xyz().length();
        assert!(
            away < 1e-4 && turned < 2e-4,
            "{told}, frame {frame}, joint {joint}: {away} {turned}"
        );
    }
}

#[test]
fn an_episode_is_read_back_to_the_same_poses() {
    for run in KINDS.iter() {
        let kind = &run.name;
        let read = Read::new(&run.exported("gltf"));
        let characters = run.characters();
        let joints = joints(&read);
        assert_eq!(joints.len(), characters.len(), "{kind}");
        let times = read.times();
        assert_eq!(times.len(), characters[0].clip.frames(), "{kind}");
        assert!((times[times.len() - 1] * 30.0 - (times.len() - 1) as f32).abs() < 1e-3);
        for frame in [0, 1, times.len() / 2, times.len() - 1] {
            let worlds = read.worlds(frame);
            for (character, joints) in characters.iter().zip(&joints) {
                compare(kind, &character.clip, frame, &worlds, joints);
            }
        }
    }
}

/// The surface stays around its joints, on the ground, and faces outwards.
#[test]
fn the_surface_moves_with_its_joints() {
    for run in KINDS.iter() {
        let kind = &run.name;
        let read = Read::new(&run.exported("gltf"));
        for (skin, character) in read.file.skins().zip(run.characters()) {
            for frame in [0, character.clip.frames() - 1] {
                let corners = read.skinned(&skin, &read.worlds(frame));
                let (positions, _) = character.clip.world(frame);
                for corner in &corners {
                    let nearest = positions.iter().map(|at| at.distance(*corner));
                    let nearest = nearest.fold(f32::MAX, f32::min);
                    // The box's only joint is in its middle.
                    assert!(nearest < 1.0, "{kind}, frame {frame}: {nearest} m");
                    assert!(corner.y > -0.1, "{kind}, frame {frame}: {corner}");
                }
                let volume: f32 = corners
                    .chunks_exact(3)
                    .map(|t| t[0].dot(t[1].cross(t[2])) / 6.0)
                    .sum();
                let wanted = volume_of(&character);
                assert!(
                    (0.8..1.3).contains(&(volume / wanted)),
                    "{kind}: {volume} m^3, {wanted}"
                );
            }
        }
    }
}

/// Of all shapes together, m^3.
fn volume_of(character: &MovingCharacter) -> f32 {
    use std::f32::consts::PI;
    let (positions, rotations) = character.clip.world(0);
    let capsule = |bone: &footwork::playback::capsule_rig::Bone| {
        let [a, b] = bone.ends.map(|spot| spot.position(&positions, &rotations));
        let [r, s] = bone.ends.map(|spot| spot.radius);
        let cone = PI / 3.0 * a.distance(b) * (r * r + r * s + s * s);
        cone + 2.0 / 3.0 * PI * (r.powi(3) + s.powi(3))
    };
    let bones: f32 = character.bones.iter().map(capsule).sum();
    let boxes = character
        .cuboids
        .iter()
        .map(|cuboid| 8.0 * cuboid.half.element_product());
    bones + boxes.sum::<f32>()
}

/// The Khronos validator has nothing against the files. `FOOTWORK_GLTF_VALIDATOR` is a folder in which
/// `npm install gltf-validator` was run, as `tests/run` does.
#[test]
fn the_validator_finds_nothing_wrong() {
    let folder = std::env::var_os("FOOTWORK_GLTF_VALIDATOR").expect(
        "FOOTWORK_GLTF_VALIDATOR is not set: run tests/run, or `npm install gltf-validator` in a folder and name it there",
    );
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/validate.js");
    let modules = Path::new(&folder).join("node_modules");
    for run in KINDS.iter() {
        let path = run.kept("gltf", "glb");
        let mut node = Command::new("node");
        node.arg(script).arg(&path).env("NODE_PATH", &modules);
        let found = node.output().expect("node, which the validator needs");
        let told = [found.stdout, found.stderr].map(|text| String::from_utf8(text).unwrap());
        assert!(
            found.status.success(),
            "{}: {}{}",
            path.display(),
            told[0],
            told[1]
        );
    }
}
