//! `footwork sim`.

use super::Place;
use serde_json::Value;

fn figures(place: &Place, words: &str) -> Value {
    let told = place.done(&format!("sim --json {words}"));
    serde_json::from_str(&told.out).unwrap_or_else(|error| panic!("{error}: {told:?}"))
}

#[test]
fn random_actions_are_told_in_figures() {
    let place = Place::new();
    for device in ["cpu", "lavapipe"] {
        let told = figures(&place, &format!("--envs 16 --seconds 1 --device {device}"));
        assert_eq!(told["envs"], 16);
        assert_eq!(told["control_steps"], 16 * 30);
        assert_eq!(told["diverged_envs"], 0);
        assert_eq!(told["overflow"], 0);
        assert!(told["control_steps_per_s"].as_f64().unwrap() > 0.0);
        // Within a second it falls.
        let mean = told["contacts_mean"].as_f64().unwrap();
        let most = told["contacts_max"].as_u64().unwrap();
        assert!(
            (0.5..10.0).contains(&mean) && (4..=16).contains(&most),
            "{told}"
        );
    }
}

#[test]
fn equal_runs_end_in_equal_states() {
    let place = Place::new();
    let hash = |words: &str| {
        let words = format!("--envs 8 --seconds 0.5 --device cpu {words}");
        figures(&place, &words)["state_hash"].clone()
    };
    assert_eq!(hash("--seed 7"), hash("--seed 7"));
    assert_ne!(hash("--seed 7"), hash("--seed 8"));
    assert_ne!(hash("--scene humanoid"), hash("--scene boxing"));
}

#[test]
fn a_model_of_ones_own_is_simulated() {
    let place = Place::new();
    place.write("ball.xml", BALL);
    let told = figures(&place, "--model ball.xml --envs 3 --seconds 2 --device cpu");
    // It falls 0.1 m, and then lies.
    let mean = told["contacts_mean"].as_f64().unwrap();
    assert!((0.8..1.0).contains(&mean), "{told}");
    assert_eq!(told["contacts_max"], 1);
}

#[test]
fn a_motor_is_a_torque_unless_it_is_to_be_a_drive() {
    let place = Place::new();
    let (gains, motor) = (
        r#"stiffness="5" damping=".2""#,
        r#"motor gear="40" ctrlrange="-1 1""#,
    );
    place.write("motor.xml", pendulum(gains, motor));
    place.write(
        "position.xml",
        pendulum("", r#"position kp="5" kv=".2" forcerange="-40 40""#),
    );
    let run = |words: &str| {
        let told = place.done(&format!(
            "sim --json --envs 4 --seconds 1 --device cpu {words}"
        ));
        let figures: Value = serde_json::from_str(&told.out).unwrap();
        (figures["state_hash"].clone(), told.err)
    };
    let (position, _) = run("--model position.xml");
    let (torque, said) = run("--model motor.xml");
    assert_ne!(torque, position);
    assert!(
        said.contains("note: motor.xml: ") && said.contains("--pd-motors"),
        "{said}"
    );
    let (drive, said) = run("--model motor.xml --pd-motors");
    assert_eq!(drive, position);
    assert!(!said.contains("note"), "{said}");
}

fn pendulum(joint: &str, actuator: &str) -> String {
    format!(
        r#"<mujoco><worldbody><body pos="0 0 1"><joint name="j" axis="0 1 0" {joint}/>
        <geom type="capsule" fromto="0 0 0 0 0 -.5" size=".04"/></body></worldbody>
        <actuator><{actuator} joint="j"/></actuator></mujoco>"#
    )
}

/// Defaults reach a free joint that is written as a joint, and not a `freejoint`.
#[test]
fn defaults_of_joints_reach_the_root() {
    let place = Place::new();
    let hash = |default: &str, root: &str| {
        let body = r#"<geom size=".1"/></body></worldbody></mujoco>"#;
        let text =
            format!("<mujoco><default><joint {default}/></default><worldbody><body>{root}{body}");
        place.write("root.xml", text);
        let words = "--model root.xml --envs 1 --seconds 0.5 --device cpu";
        figures(&place, words)["state_hash"].clone()
    };
    let heavy = r#"armature="4""#;
    let joint = r#"<joint type="free"/>"#;
    assert_eq!(
        hash(heavy, joint),
        hash("", r#"<joint type="free" armature="4"/>"#)
    );
    assert_ne!(hash(heavy, joint), hash(heavy, "<freejoint/>"));
    assert_eq!(hash(heavy, "<freejoint/>"), hash("", "<freejoint/>"));
    assert_ne!(hash(r#"damping="1""#, joint), hash("", joint));
}

#[test]
fn the_cpu_has_room_for_all_contacts() {
    let place = Place::new();
    for boxes in [1, 8, 9, 24] {
        place.write("boxes.xml", boxes_on_the_ground(boxes));
        let told = figures(
            &place,
            "--model boxes.xml --envs 2 --seconds 1 --device cpu",
        );
        assert_eq!(told["contacts_max"], 4 * boxes, "{told}");
        assert_eq!(told["overflow"], 0, "{told}");
    }
}

#[test]
fn a_gpu_without_room_says_so() {
    let place = Place::new();
    place.write("boxes.xml", boxes_on_the_ground(9));
    let run = |words: &str| {
        let words =
            format!("sim --json --model boxes.xml --envs 2 --seconds 1 --device lavapipe {words}");
        let told = place.done(&words);
        let figures: Value = serde_json::from_str(&told.out).unwrap();
        (figures, told.err)
    };
    let (told, said) = run("");
    assert_eq!(told["contacts_max"], 32, "{told}");
    let lost = told["overflow"].as_u64().unwrap();
    // At rest four of each step.
    assert!(lost > 200, "{told}");
    let warning = format!("warning: {lost} contacts found no room");
    assert!(
        said.contains(&warning) && said.contains("--contacts"),
        "{said}"
    );
    let (few, _) = run("--contacts 8");
    assert_eq!(few["contacts_max"], 8, "{few}");
    place.write("boxes.xml", boxes_on_the_ground(8));
    let (enough, said) = run("");
    assert_eq!(enough["overflow"], 0, "{enough}");
    assert!(!said.contains("warning"), "{said}");
}

/// Boxes side by side, a little above the ground.
fn boxes_on_the_ground(count: usize) -> String {
    let boxes = (0..count).map(|index| {
        format!(
            r#"<body pos="{} {} .11"><freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body>"#,
            0.3 * (index % 6) as f32,
            0.3 * (index / 6) as f32
        )
    });
    format!(
        r#"<mujoco><worldbody><geom type="plane" size="5 5 .1"/>{}</worldbody></mujoco>"#,
        boxes.collect::<String>()
    )
}

#[test]
fn clips_become_film_strips() {
    let place = Place::new();
    place.done("data synth --minutes 0.1 --out small.footwork --bvh clips");
    let told = place.done("sim --clip clips --out strips");
    let files: Vec<&str> = told.out.lines().collect();
    assert!(
        !files.is_empty() && files.len().is_multiple_of(2),
        "{told:?}"
    );
    for file in files {
        let picture = place.path(file);
        assert!(
            std::fs::metadata(&picture).unwrap().len() > 50_000,
            "{file}"
        );
    }
}

#[test]
fn what_cannot_be_simulated_is_said() {
    let place = Place::new();
    place.write("heavy.xml", BALL.replace(r#"mass="1""#, r#"mass="0""#));
    place.write("ball.xml", BALL);
    place.write("still.xml", STILL);
    for (words, code, part) in [
        ("--envs 0", 2, "--envs must be from 1 to 1048576"),
        ("--envs -1", 2, "invalid value '-1'"),
        ("--envs 99999999999999999999", 2, "invalid value"),
        ("--seed -1", 2, "invalid value '-1'"),
        ("--seconds -1", 2, "--seconds must be above zero"),
        ("--seconds 0", 2, "--seconds must be above zero"),
        ("--seconds nan", 2, "--seconds must be above zero"),
        ("--seconds 1e9", 2, "--seconds must be above zero"),
        ("--action-std -1", 2, "--action-std must lie between"),
        ("--action-std inf", 2, "--action-std must lie between"),
        ("--contacts 0", 2, "--contacts must be from 1 to 32"),
        ("--contacts 33", 2, "--contacts must be from 1 to 32"),
        (
            "--scene three",
            2,
            "possible values: humanoid, boxing, punching-box",
        ),
        ("--device gpux", 2, "similar value exists: 'gpu'"),
        ("--envs 18446744073709551615", 2, "from 1 to 1048576"),
        (
            "--envs 1000000 --device lavapipe",
            1,
            "constraints of all environments",
        ),
        (
            "--model still.xml",
            1,
            "nothing in the model 'still' can move",
        ),
        ("--model gone.xml", 1, "cannot read gone.xml"),
        ("--model .", 1, "cannot read ."),
        ("--model heavy.xml", 1, "heavy.xml, line 4"),
        ("--pd-motors", 2, "  --model <FILE>\n"),
        ("--model ball.xml --scene boxing", 2, "cannot be used with"),
        ("--clip gone.bvh", 2, "  --out <FOLDER>\n"),
        ("--out strips", 2, "  --clip <PATH>\n"),
        ("--clip gone.bvh --out strips", 1, "gone.bvh"),
        (
            "--clip gone.bvh --out strips --envs 2",
            2,
            "cannot be used with",
        ),
        ("--clip heavy.xml --out strips", 1, "heavy.xml"),
    ] {
        place.refused(&format!("sim {words}"), code, &[part]);
    }
}

const BALL: &str = r#"<mujoco model="ball">
  <worldbody>
    <geom name="ground" type="plane" size="1 1 1"/>
    <body name="ball" pos="0 0 .2">
      <freejoint name="root"/>
      <geom name="ball" size=".1" mass="1"/>
    </body>
  </worldbody>
</mujoco>
"#;

const STILL: &str = r#"<mujoco model="still">
  <worldbody>
    <geom name="ground" type="plane" size="1 1 1"/>
  </worldbody>
</mujoco>
"#;
