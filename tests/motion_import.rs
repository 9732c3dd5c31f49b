//! From BVH files to clips: the format, what is refused and how, and real recordings.

#[path = "motion_import/body.rs"]
mod body;
#[path = "motion_import/clips.rs"]
mod clips;
#[path = "motion_import/dialects.rs"]
mod dialects;
#[path = "motion_import/folders.rs"]
mod folders;
#[path = "motion_import/format.rs"]
mod format;
#[path = "motion_import/jumps.rs"]
mod jumps;
#[path = "support/mocap.rs"]
mod mocap;
#[path = "motion_import/names.rs"]
mod names;
#[path = "motion_import/real.rs"]
mod real;
#[path = "motion_import/refused.rs"]
mod refused;
#[path = "motion_import/standing.rs"]
mod standing;

use footwork::motion::bvh::{self, Recording};
use footwork::motion::clip::Clip;
use footwork::motion::error::MotionResult;
use footwork::motion::import::{ImportOptions, ImportedMotion, import};
use footwork::motion::skeleton::Skeleton;
use glam::{EulerRot, Quat, Vec3};
use std::path::Path;

/// Two joints, five channels, two frames.
const SMALL: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 4 Xposition Yposition Zposition Yrotation
  JOINT Spine
  {
    OFFSET 0 10 0
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 5 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
1 2 3 90 45
4 5 6 0 -45
";

fn parse(text: &str) -> Recording {
    bvh::parse(text, Path::new("test.bvh")).unwrap()
}

fn refusal(text: &str) -> String {
    let error = bvh::parse(text, Path::new("test.bvh")).unwrap_err();
    error.to_string()
}

/// A file of a whole person with `frames` frames that stand still, arms along the body.
fn person(names: &[(&str, usize, Vec3)], frames: usize, frame_time: &str) -> String {
    let clip = Clip {
        name: "person".to_string(),
        skeleton: skeleton(names),
        rate: 30.0,
        positions: vec![Vec3::new(0.0, 0.95, 0.0); frames],
        rotations: vec![Quat::IDENTITY; frames * names.len()],
        source: String::new(),
        licence: String::new(),
    };
    let text = bvh::to_text(&clip).unwrap();
    let (head, tail) = text.split_once("Frame Time: ").unwrap();
    let (_, values) = tail.split_once('\n').unwrap();
    format!("{head}Frame Time: {frame_time}\n{values}")
}

fn skeleton(joints: &[(&str, usize, Vec3)]) -> Skeleton {
    let parent = |(i, j): (usize, &(&str, usize, Vec3))| (i > 0).then_some(j.1);
    Skeleton {
        names: joints.iter().map(|j| j.0.to_string()).collect(),
        parents: joints.iter().enumerate().map(parent).collect(),
        offsets: joints.iter().map(|j| j.2).collect(),
        ends: Vec::new(),
    }
}

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Metres, arms hanging, in the order that a file gives them.
const PERSON: [(&str, usize, Vec3); 14] = [
    ("Hips", 0, v(0.0, 0.0, 0.0)),
    ("LeftUpLeg", 0, v(0.1, -0.05, 0.0)),
    ("LeftLeg", 1, v(0.0, -0.42, 0.0)),
    ("LeftFoot", 2, v(0.0, -0.40, 0.0)),
    ("RightUpLeg", 0, v(-0.1, -0.05, 0.0)),
    ("RightLeg", 4, v(0.0, -0.42, 0.0)),
    ("RightFoot", 5, v(0.0, -0.40, 0.0)),
    ("Spine", 0, v(0.0, 0.3, 0.0)),
    ("LeftArm", 7, v(0.15, 0.2, 0.0)),
    ("LeftForeArm", 8, v(0.0, -0.3, 0.0)),
    ("LeftHand", 9, v(0.0, -0.25, 0.0)),
    ("RightArm", 7, v(-0.15, 0.2, 0.0)),
    ("RightForeArm", 11, v(0.0, -0.3, 0.0)),
    ("RightHand", 12, v(0.0, -0.25, 0.0)),
];

/// A clip in which every joint swings in its own rhythm.
fn moving(joints: &[(&str, usize, Vec3)], frames: usize) -> Clip {
    let turn = |frame: usize, joint: usize| {
        let t = frame as f32 * 0.1 + joint as f32;
        Quat::from_euler(EulerRot::ZYX, t.sin(), 1.3 * (0.7 * t).cos(), 2.0 * t.sin())
    };
    let turns = (0..frames).flat_map(|f| (0..joints.len()).map(move |j| (f, j)));
    Clip {
        name: "moving".to_string(),
        skeleton: Skeleton {
            ends: vec![(3, v(0.0, -0.05, 0.1)), (6, v(0.0, -0.05, 0.1))],
            ..skeleton(joints)
        },
        rate: 30.0,
        positions: (0..frames).map(|f| v(f as f32 * 0.02, 0.9, 0.5)).collect(),
        rotations: turns.map(|(f, j)| turn(f, j)).collect(),
        source: "a test".to_string(),
        licence: "none".to_string(),
    }
}

/// Radians between two rotations. The arc cosine of `angle_between` knows nothing below 1e-3.
fn angle(a: Quat, b: Quat) -> f32 {
    2.0 * (a - b).length().min((a + b).length())
}

fn assert_same_motion(a: &Clip, b: &Clip) {
    assert!(a.skeleton.same_tree(&b.skeleton));
    assert_eq!(a.frames(), b.frames());
    assert!((a.rate / b.rate - 1.0).abs() < 1e-5);
    for frame in 0..a.frames() {
        let ((p, r), (q, s)) = (a.world(frame), b.world(frame));
        let apart = p.iter().zip(&q).map(|(p, q)| p.distance(*q));
        assert!(apart.fold(0.0, f32::max) < 1e-4, "frame {frame}");
        let turned = r.iter().zip(&s).map(|(r, s)| angle(*r, *s));
        assert!(turned.fold(0.0, f32::max) < 1e-3, "frame {frame}");
    }
}

/// Metres a second of [`walking`].
const SPEED: f32 = 1.2;

/// A person who walks along z at 30 Hz, arms and legs swinging.
fn walking(frames: usize) -> Clip {
    let swing = |frame: usize, joint: usize| {
        let angle = 0.5 * (frame as f32 * 0.2).sin();
        match joint {
            1 | 11 => Quat::from_rotation_x(angle),
            4 | 8 => Quat::from_rotation_x(-angle),
            _ => Quat::IDENTITY,
        }
    };
    let turns = (0..frames).flat_map(|f| (0..PERSON.len()).map(move |j| (f, j)));
    Clip {
        name: "walking".to_string(),
        skeleton: skeleton(&PERSON),
        rate: 30.0,
        positions: (0..frames)
            .map(|f| v(0.0, 0.87, f as f32 * SPEED / 30.0))
            .collect(),
        rotations: turns.map(|(f, j)| swing(f, j)).collect(),
        source: String::new(),
        licence: String::new(),
    }
}

/// Imports these files out of one folder.
fn import_all(files: &[(&str, &Clip)], options: &ImportOptions) -> MotionResult<ImportedMotion> {
    let folder = tempfile::tempdir().unwrap();
    for (name, clip) in files {
        bvh::write(&folder.path().join(format!("{name}.bvh")), clip).unwrap();
    }
    import(folder.path(), options)
}

fn import_one(clip: &Clip, options: &ImportOptions) -> MotionResult<ImportedMotion> {
    import_all(&[("walk", clip)], options)
}

/// Metres a second over the ground, on average and at most.
fn speeds(clip: &Clip) -> (f32, f32) {
    let steps = clip.positions.windows(2);
    let steps = steps.map(|pair| (pair[1] - pair[0]).with_y(0.0).length() * clip.rate);
    let total: f32 = steps.clone().sum();
    (
        total / (clip.frames() - 1) as f32,
        steps.fold(0.0, f32::max),
    )
}

/// Fails unless a clip walks upright at the speed of [`walking`].
fn assert_walks(clip: &Clip) {
    let (mean, max) = speeds(clip);
    assert!(
        (mean - SPEED).abs() < 0.02 && max < SPEED + 0.05,
        "{mean} {max}"
    );
    for frame in 0..clip.frames() {
        let (at, _) = clip.world(frame);
        assert!(
            (at[0].y - 0.87).abs() < 0.01 && at[3].y < 0.3 && at[8].y > 1.2,
            "{at:?}"
        );
    }
}
