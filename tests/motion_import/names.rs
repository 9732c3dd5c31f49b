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

/// A person whose feet no name tells, and whose legs have no form to go by.
fn with_paws() -> Skeleton {
    let mut skeleton = skeleton(&PERSON);
    skeleton.names[3] = "Paw1".to_string();
    skeleton.names[6] = "Paw2".to_string();
    skeleton.offsets[5] = Vec3::Y;
    skeleton
}

#[test]
fn unknown_skeletons_and_roles_files() {
    let skeleton = with_paws();
    let message = Roles::find(&skeleton).unwrap_err().to_string();
    assert!(message.contains("no joint found for left_foot, right_foot, left_toe, right_toe;"));
    assert!(message.contains("LeftLeg, Paw1, RightUpLeg"), "{message}");
    assert!(message.contains("roles file"), "{message}");
    // What was found, and lines to complete.
    let file =
        "hips = \"Hips\"\nleft_hip = \"LeftUpLeg\"\nright_hip = \"RightUpLeg\"\nleft_foot = \"\"\n";
    assert!(message.contains(file), "{message}");

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

/// Every role of a person without a telling name, in the order of the keys.
fn by_structure(skeleton: &Skeleton) -> Option<Vec<String>> {
    let roles = Roles::find(skeleton).ok()?;
    let names = roles.joints().map(|joint| skeleton.names[joint].clone());
    Some(names.to_vec())
}

/// The person with toes, every joint renamed.
fn renamed(name: impl Fn(usize) -> String) -> Skeleton {
    let mut joints = PERSON.to_vec();
    joints.insert(4, ("LeftToe", 3, Vec3::new(0.0, -0.05, 0.13)));
    for joint in &mut joints[5..] {
        joint.1 += usize::from(joint.1 > 3);
    }
    joints.insert(8, ("RightToe", 7, Vec3::new(0.0, -0.05, 0.13)));
    for joint in &mut joints[9..] {
        joint.1 += usize::from(joint.1 > 7);
    }
    let mut skeleton = skeleton(&joints);
    for joint in 0..skeleton.joints() {
        skeleton.names[joint] = name(joint);
    }
    skeleton
}

#[test]
fn prefixes_of_programs_are_no_part_of_a_name() {
    let plain = skeleton(&PERSON);
    let roles = Roles::find(&plain).unwrap();
    for prefix in [
        "Character1_",
        "CC_Base_",
        "DEF-",
        "Bip002 ",
        "mixamorig12:",
        "Actor 7|",
    ] {
        let mut prefixed = plain.clone();
        for name in &mut prefixed.names {
            *name = format!("{prefix}{name}");
        }
        assert_eq!(Roles::find(&prefixed).unwrap(), roles, "{prefix}");
        assert!(roles.unnamed(&prefixed).is_empty(), "{prefix}");
    }
}

#[test]
fn hips_are_where_legs_and_arms_meet() {
    let mut person = skeleton(&PERSON);
    for hips in ["root", "spine", "torso_1"] {
        person.names[0] = hips.to_string();
        let roles = Roles::find(&person).unwrap();
        assert_eq!(
            (roles.hips, roles.unnamed(&person)),
            (0, vec!["hips"]),
            "{hips}"
        );
    }
    // A joint called pelvis that carries the legs alone is not what carries the body.
    let joints = [
        &[("root", 0, Vec3::ZERO), ("pelvis", 0, Vec3::Y)][..],
        &PERSON[1..],
    ];
    let mut joints = joints.concat();
    for joint in &mut joints[2..] {
        joint.1 += usize::from(joint.1 > 0);
    }
    (joints[2].1, joints[5].1) = (1, 1);
    let roles = Roles::find(&skeleton(&joints)).unwrap();
    assert_eq!(roles.hips, 0);
}

#[test]
fn the_form_of_the_tree_tells_what_names_do_not() {
    let roles = [0, 1, 5, 3, 7, 4, 8, 10, 13];
    let expect = |skeleton: &Skeleton, what: &str| {
        let expected: Vec<String> = roles.iter().map(|&j| skeleton.names[j].clone()).collect();
        assert_eq!(by_structure(skeleton), Some(expected), "{what}");
    };
    // Sides by where the limbs lie: toes point forward.
    expect(&renamed(|joint| format!("bone{joint}")), "numbers");
    // Sides by the names, though these tell no parts and the rest pose nothing.
    let sided = |joint: usize| match joint {
        1..=4 | 10..=12 => format!("x{joint}_l"),
        5..=8 => format!("x{}_r", joint - 4),
        13..=15 => format!("x{}_r", joint - 3),
        _ => format!("x{joint}"),
    };
    let mut flat = renamed(sided);
    flat.offsets[4] = Vec3::new(0.13, 0.0, 0.0);
    expect(&flat, "letters");
    let initial = |joint: usize| match joint {
        1..=4 | 10..=12 => format!("lq{joint}"),
        5..=8 => format!("rq{}", joint - 4),
        13..=15 => format!("rq{}", joint - 3),
        _ => format!("q{joint}"),
    };
    expect(&renamed(initial), "initials");

    // Fingers, eyes and a tail are no limbs.
    let mut rich = renamed(|joint| format!("bone{joint}"));
    for (parent, offset) in [
        (12, Vec3::new(0.0, -0.1, 0.02)),
        (12, Vec3::new(0.0, -0.1, -0.02)),
        (15, Vec3::new(0.0, -0.1, 0.02)),
        (15, Vec3::new(0.0, -0.1, -0.02)),
        (9, Vec3::new(0.0, 0.3, 0.0)),
        (0, Vec3::new(0.0, 0.0, -0.1)),
    ] {
        rich.names.push(format!("bone{}", rich.joints()));
        rich.parents.push(Some(parent));
        rich.offsets.push(offset);
    }
    expect(&rich, "fingers");

    // Neither names nor the rest pose tell left from right.
    let mut flat = renamed(|joint| format!("bone{joint}"));
    (flat.offsets[4], flat.offsets[8]) = (Vec3::NEG_Y, Vec3::NEG_Y);
    assert_eq!(by_structure(&flat), None);
    // A snake.
    let chain: Vec<_> = (0..9)
        .map(|joint: usize| ("s", joint.saturating_sub(1), Vec3::Y))
        .collect();
    assert_eq!(by_structure(&skeleton(&chain)), None);
}

#[test]
fn no_tree_takes_long() {
    // A chain of which the last joints have two limbs each, and names that share all but the end.
    let mut skeleton = skeleton(&[]);
    let mut add = |parent: Option<usize>| {
        let name = format!("{}{}", "long".repeat(500), skeleton.joints());
        skeleton.names.push(name);
        skeleton.parents.push(parent);
        skeleton.offsets.push(Vec3::Y);
        skeleton.joints() - 1
    };
    let mut trunk = add(None);
    for depth in 0..3000 {
        trunk = add(Some(trunk));
        for _ in 0..if depth < 2850 { 0 } else { 2 } {
            let top = add(Some(trunk));
            let middle = add(Some(top));
            add(Some(middle));
        }
    }
    let start = std::time::Instant::now();
    let _ = Roles::find(&skeleton);
    let seconds = start.elapsed().as_secs_f32();
    assert!(seconds < 2.0, "{seconds} s");
}
