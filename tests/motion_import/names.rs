//! Joints told by their names: roles and sides.

use super::{PERSON, skeleton};
use footwork::motion::mirror::pairs;
use footwork::motion::roles::Roles;
use footwork::motion::skeleton::Skeleton;
use glam::Vec3;

#[test]
fn sides_are_told_by_word_or_letter() {
    let sided = [
        ["LeftArm", "RightArm"],
        ["mixamorig:LeftArm", "mixamorig:RightArm"],
        ["simLeftFoot", "simRightFoot"],
        ["LHipJoint", "RHipJoint"],
        ["lShldr", "rShldr"],
        ["leftEye", "rightEye"],
        ["L_Hip", "R_Hip"],
        ["thigh_l", "thigh_r"],
        ["hand.L", "hand.R"],
        ["Bip01 L Foot", "Bip01 R Foot"],
    ];
    for [left, right] in sided {
        let names = [
            ("Hips", 0, Vec3::ZERO),
            (left, 0, Vec3::X),
            (right, 0, -Vec3::X),
        ];
        assert_eq!(pairs(&skeleton(&names)).unwrap(), [0, 2, 1], "{left}");
    }
    for middle in [
        "LowerBack",
        "lowerback",
        "Root",
        "Head",
        "rootJoint",
        "Spine1",
        "L5",
    ] {
        let names = [("Hips", 0, Vec3::ZERO), (middle, 0, Vec3::Y)];
        assert_eq!(pairs(&skeleton(&names)).unwrap(), [0, 1], "{middle}");
    }
}

/// Left leg, right leg, left arm, right arm, from the body outwards.
type Chains<'a> = [&'a [&'a str]; 4];

/// A skeleton of these joints: hips, then both legs and both arms as chains.
fn named(hips: &str, chains: Chains) -> Skeleton {
    let mut joints = vec![(hips, 0, Vec3::ZERO)];
    for chain in chains {
        for (depth, name) in chain.iter().enumerate() {
            let parent = if depth == 0 { 0 } else { joints.len() - 1 };
            joints.push((name, parent, Vec3::Y));
        }
    }
    skeleton(&joints)
}

#[test]
fn roles_of_every_convention() {
    // Per convention: hips, then thigh, foot, toe (if any) and upper arm of the left side.
    let cases: [(&str, Chains, [&str; 4]); 7] = [
        (
            "Hips",
            [
                &["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe"],
                &["RightUpLeg", "RightLeg", "RightFoot", "RightToe"],
                &["LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"],
                &["RightShoulder", "RightArm", "RightForeArm", "RightHand"],
            ],
            ["LeftUpLeg", "LeftFoot", "LeftToe", "LeftArm"],
        ),
        (
            "Hips",
            [
                &[
                    "LHipJoint",
                    "LeftUpLeg",
                    "LeftLeg",
                    "LeftFoot",
                    "LeftToeBase",
                ],
                &[
                    "RHipJoint",
                    "RightUpLeg",
                    "RightLeg",
                    "RightFoot",
                    "RightToeBase",
                ],
                &["LeftShoulder", "LeftArm", "LThumb"],
                &["RightShoulder", "RightArm", "RThumb"],
            ],
            ["LeftUpLeg", "LeftFoot", "LeftToeBase", "LeftArm"],
        ),
        (
            "hip",
            [
                &["lButtock", "lThigh", "lShin", "lFoot"],
                &["rButtock", "rThigh", "rShin", "rFoot"],
                &["lCollar", "lShldr", "lForeArm"],
                &["rCollar", "rShldr", "rForeArm"],
            ],
            ["lThigh", "lFoot", "lFoot", "lShldr"],
        ),
        (
            "mixamorig:Hips",
            [
                &[
                    "mixamorig:LeftUpLeg",
                    "mixamorig:LeftFoot",
                    "mixamorig:LeftToeBase",
                ],
                &[
                    "mixamorig:RightUpLeg",
                    "mixamorig:RightFoot",
                    "mixamorig:RightToeBase",
                ],
                &["mixamorig:LeftShoulder", "mixamorig:LeftArm"],
                &["mixamorig:RightShoulder", "mixamorig:RightArm"],
            ],
            [
                "mixamorig:LeftUpLeg",
                "mixamorig:LeftFoot",
                "mixamorig:LeftToeBase",
                "mixamorig:LeftArm",
            ],
        ),
        (
            "simHips",
            [
                &["simLeftUpLeg", "simLeftLeg", "simLeftFoot"],
                &["simRightUpLeg", "simRightLeg", "simRightFoot"],
                &["simLeftArm", "simLeftForeArm"],
                &["simRightArm", "simRightForeArm"],
            ],
            ["simLeftUpLeg", "simLeftFoot", "simLeftFoot", "simLeftArm"],
        ),
        (
            "mixamorig1_Hips",
            [
                &["L_Hip", "L_Knee", "L_Ankle", "L_Foot"],
                &["R_Hip", "R_Knee", "R_Ankle", "R_Foot"],
                &["L_Collar", "L_Shoulder", "L_Elbow"],
                &["R_Collar", "R_Shoulder", "R_Elbow"],
            ],
            ["L_Hip", "L_Ankle", "L_Foot", "L_Shoulder"],
        ),
        (
            "pelvis",
            [
                &["thigh_l", "calf_l", "foot_l", "ball_l"],
                &["thigh_r", "calf_r", "foot_r", "ball_r"],
                &["clavicle_l", "upperarm_l", "lowerarm_l"],
                &["clavicle_r", "upperarm_r", "lowerarm_r"],
            ],
            ["thigh_l", "foot_l", "ball_l", "upperarm_l"],
        ),
    ];
    for (hips, chains, expected) in cases {
        let skeleton = named(hips, chains);
        let roles = Roles::find(&skeleton).unwrap();
        let name = |joint: usize| skeleton.names[joint].as_str();
        assert_eq!(name(roles.hips), hips);
        let left = [
            roles.left_hip,
            roles.left_foot,
            roles.left_toe,
            roles.left_shoulder,
        ];
        assert_eq!(left.map(name), expected);
        // The right side is built alike.
        let pairs = pairs(&skeleton).unwrap();
        let right = [
            roles.right_hip,
            roles.right_foot,
            roles.right_toe,
            roles.right_shoulder,
        ];
        assert_eq!(left.map(|joint| pairs[joint]), right);
    }
}

#[test]
fn unknown_skeletons_and_roles_files() {
    let mut skeleton = skeleton(&PERSON);
    skeleton.names[3] = "Paw1".to_string();
    skeleton.names[6] = "Paw2".to_string();
    let message = Roles::find(&skeleton).unwrap_err().to_string();
    assert!(message.contains("no joint found for left_foot, right_foot, left_toe, right_toe;"));
    assert!(message.contains("LeftLeg, Paw1, RightUpLeg"), "{message}");
    assert!(message.contains("roles file"), "{message}");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("roles.toml");
    let with = |text: &str| {
        std::fs::write(&path, text).unwrap();
        Roles::read(&path, &skeleton).map_err(|error| error.to_string())
    };
    let roles = with("left_foot = \"Paw1\"\nright_foot = \"Paw2\"\n").unwrap();
    assert_eq!(
        (roles.left_foot, roles.left_toe, roles.right_foot),
        (3, 3, 6)
    );
    for (text, expected) in [
        (
            "left_feet = \"Paw1\"",
            "unknown role 'left_feet', did you mean 'left_foot'?",
        ),
        (
            "left_foot = \"Paw3\"",
            "no joint is called 'Paw3', did you mean 'Paw1'?",
        ),
        (
            "left_foot = 3",
            "left_foot must be a joint's name in quotes, not 3",
        ),
        ("left_foot = Paw1", "line 1"),
        (
            "left_foot = \"Paw1\"",
            "no joint found for right_foot, right_toe",
        ),
        (
            "left_foot = \"Paw1\"\nright_foot = \"Paw1\"",
            "does not hang below right_hip",
        ),
        (
            "left_foot = \"Spine\"\nright_foot = \"Paw2\"",
            "left_foot ('Spine') does not hang",
        ),
    ] {
        let message = with(text).unwrap_err();
        assert!(message.contains(expected), "{expected} / {message}");
        assert!(message.contains("roles.toml"), "{message}");
    }
}
