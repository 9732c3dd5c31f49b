//! What is refused, with the line and the element, and that no input panics.

use super::parse;
use footwork::physics::mjcf::{self, MjcfOptions};
use proptest::prelude::*;
use std::path::Path;

const SMALL: &str = r#"<mujoco model="small">
  <compiler angle="degree"/>
  <option timestep="0.01"/>
  <default>
    <default class="arm"><geom type="capsule" size=".1 .2"/><joint damping="0"/></default>
  </default>
  <worldbody>
    <geom name="ground" type="plane" size="1 1 1"/>
    <body name="trunk" pos="0 0 1">
      <freejoint name="root"/>
      <geom name="trunk" size=".2"/>
      <body name="arm" childclass="arm" euler="0 90 0">
        <joint name="shoulder" type="ball" range="0 90"/>
        <geom name="arm"/>
        <body name="hand" pos="0 0 .3">
          <joint name="wrist" axis="0 1 0" range="-30 40"/>
          <geom name="hand" type="box" size=".1 .1 .1" mass="1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <contact><exclude body1="trunk" body2="hand"/></contact>
  <actuator>
    <position name="p" joint="wrist" kp="10" kv="1" forcerange="-5 5"/>
    <position name="q" joint="shoulder" gear="0 1 0" kp="10"/>
  </actuator>
</mujoco>
"#;

/// What to change in the small model, and what the error then says behind its `m.xml, line`.
#[rustfmt::skip]
const CASES: [(&str, &str, &str); 117] = [
    ("</worldbody>", "", "27: this is no valid XML: expected 'worldbody' tag, not 'mujoco' at 27:1"),
    ("<contact>", "<deformable/><contact>", "22: <deformable> is not supported in <mujoco>; remove it if the model can do without"),
    ("<exclude ", "<pair ", "22: <pair> is not supported in <contact>; remove it if the model can do without"),
    (r#"angle="degree""#, r#"angle="turns""#, r#"2: <compiler> has angle="turns": it may be degree or radian"#),
    (r#"angle="degree""#, r#"eulerseq="zyx""#, r#"2: <compiler> has eulerseq="zyx": only xyz is supported"#),
    (r#"angle="degree""#, r#"coordinate="global""#, r#"2: <compiler> has coordinate="global": only local is supported"#),
    (r#"angle="degree""#, r#"settotalmass="5""#, r#"2: <compiler> has settotalmass="5": only -1 is supported"#),
    (r#"timestep="0.01""#, r#"gravity="0 0 -1.62""#, r#"3: <option> has gravity="0 0 -1.62": only 0 0 -9.81 is supported"#),
    (r#"timestep="0.01""#, r#"density="1.2""#, r#"3: <option> has density="1.2": only 0 is supported"#),
    (r#"timestep="0.01""#, r#"wind="1 0 0""#, r#"3: <option> has wind="1 0 0": only 0 0 0 is supported"#),
    (r#"timestep="0.01"/>"#, r#"><flag contact="disable"/></option>"#, r#"3: <flag> has contact="disable": only enable is supported"#),
    (r#"<default class="arm">"#, "<default>", "5: <default> needs a class: only the outermost has none"),
    (r#"<default class="arm">"#, r#"<default class="main">"#, r#"5: <default> has class="main": there is a class of this name already"#),
    (r#"<default class="arm">"#, r#"<default class="arm"/><default class="arm">"#, r#"5: <default> has class="arm": there is a class of this name already"#),
    (r#"childclass="arm""#, r#"childclass="leg""#, r#"12: <body> 'arm' has childclass="leg": there is no such class in <default>"#),
    (r#"<geom name="arm"/>"#, r#"<geom name="arm" class="leg"/>"#, r#"14: <geom> 'arm' has class="leg": there is no such class in <default>"#),
    (r#"<joint damping="0"/>"#, r#"<joint name="x"/>"#, r#"5: <joint> 'x' has name="x": a default cannot have it"#),
    (r#"size=".1 .2"/>"#, r#"size=".1 -.2"/>"#, r#"5: <geom> 'arm' has size=".1 -.2": a capsule has 2 positive numbers there"#),
    (r#"<freejoint name="root"/>"#, r#"<freejoint name="root" align="true"/>"#, r#"10: <freejoint> 'root' has align="true": only false or auto is supported"#),
    (r#"<joint name="wrist" axis="0 1 0" range="-30 40"/>"#, r#"<freejoint name="wrist"/>"#, "16: <freejoint> 'wrist' is free below another body; only bodies of <worldbody> itself can be"),
    (r#"<freejoint name="root"/>"#, r#"<freejoint name="root"/><joint name="more"/>"#, "10: <freejoint> 'root' is free; a body that has such a joint has no other"),
    (r#"<joint name="shoulder" type="ball" range="0 90"/>"#, r#"<joint name="shoulder" type="ball"/><joint name="more"/>"#, "13: <joint> 'more' comes after a ball joint of its body; that must be the last"),
    (r#"<geom name="ground""#, r#"<joint name="x"/><geom name="ground""#, "8: <joint> 'x' is not supported in <worldbody>; remove it if the model can do without"),
    (r#"name="hand" pos"#, r#"name="arm" pos"#, r#"15: <body> 'arm' has name="arm": another body has this name"#),
    (r#"name="hand" pos"#, r#"name="world" pos"#, r#"15: <body> 'world' has name="world": another body has this name"#),
    (r#"name="hand" pos"#, r#"name="hand" mocap="true" pos"#, r#"15: <body> 'hand' has mocap="true": only false is supported"#),
    (r#"<geom name="arm"/>"#, r#"<geom name="hand"/>"#, r#"17: <geom> 'hand' has name="hand": another geom has this name"#),
    (r#"joint name="wrist""#, r#"joint name="shoulder""#, r#"16: <joint> 'shoulder' has name="shoulder": another joint has this name"#),
    (r#"mass="1""#, r#"mass="0""#, "15: <body> 'hand' moves but has no mass; give it a geom, or <inertial>"),
    (r#"<geom name="trunk" size=".2"/>"#, "", "9: <body> 'trunk' moves but has no mass; give it a geom, or <inertial>"),
    (r#"euler="0 90 0""#, r#"euler="0 90 0" zaxis="1 0 0""#, r#"12: <body> 'arm' has euler="0 90 0": the orientation is given twice; keep one"#),
    (r#"euler="0 90 0""#, r#"quat="0 0 0 0""#, r#"12: <body> 'arm' has quat="0 0 0 0": this quaternion is zero"#),
    (r#"euler="0 90 0""#, r#"axisangle="0 0 0 1""#, r#"12: <body> 'arm' has axisangle="0 0 0 1": this points in no direction"#),
    (r#"euler="0 90 0""#, r#"xyaxes="1 0 0 2 0 0""#, r#"12: <body> 'arm' has xyaxes="1 0 0 2 0 0": this points in no direction"#),
    (r#"euler="0 90 0""#, r#"euler="0 90""#, r#"12: <body> 'arm' has euler="0 90": expected 3 numbers, found 2"#),
    (r#"euler="0 90 0""#, r#"euler="0 ninety 0""#, r#"12: <body> 'arm' has euler="0 ninety 0": 'ninety' is no number"#),
    (r#"pos="0 0 1""#, r#"pos="0 0 NaN""#, r#"9: <body> 'trunk' has pos="0 0 NaN": 'NaN' is no usable number"#),
    (r#"pos="0 0 1""#, r#"pos="0 inf 1""#, r#"9: <body> 'trunk' has pos="0 inf 1": 'inf' is no usable number"#),
    (r#"pos="0 0 1""#, r#"pos="0 0 1e30""#, r#"9: <body> 'trunk' has pos="0 0 1e30": '1e30' is no usable number"#),
    (r#"pos="0 0 1""#, r#"pos="0,0,1""#, r#"9: <body> 'trunk' has pos="0,0,1": '0,0,1' is no number"#),
    (r#"pos="0 0 1""#, r#"pos="""#, r#"9: <body> 'trunk' has pos="": expected 3 numbers, found 0"#),
    (r#"<geom name="arm"/>"#, r#"<inertial mass="1" diaginertia="1 1 1"/>"#, "14: <inertial> needs pos, the centre of mass"),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" diaginertia="1 1 1"/>"#, "14: <inertial> needs a mass"),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" mass="1"/>"#, "14: <inertial> needs either diaginertia or fullinertia"),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" mass="-1" diaginertia="1 1 1"/>"#, r#"14: <inertial> has mass="-1": it must not be negative"#),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" mass="1" diaginertia="1 1 3"/>"#, r#"14: <inertial> has diaginertia="1 1 3": no body has such moments: each must be positive, and none larger than the sum of the other two"#),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" mass="1" diaginertia="1 1 -1"/>"#, r#"14: <inertial> has diaginertia="1 1 -1": no body has such moments: each must be positive, and none larger than the sum of the other two"#),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" mass="1" fullinertia="1 1 1 2 0 0"/>"#, r#"14: <inertial> has fullinertia="1 1 1 2 0 0": no body has such moments: each must be positive, and none larger than the sum of the other two"#),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0 0 0" quat="1 0 0 0"/>"#, r#"14: <inertial> has fullinertia="1 1 1 0 0 0": it says how the inertia lies; remove the orientation"#),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" mass="0" diaginertia="1 1 1"/>"#, "12: <body> 'arm' moves but has no mass; give it a geom, or <inertial>"),
    (r#"<geom name="arm"/>"#, r#"<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#, "14: <inertial> is the second in its body; keep one"),
    (r#"<geom name="trunk" size=".2"/>"#, r#"<geom name="trunk" size="1e9" density="1e9"/>"#, "9: <body> 'trunk' is too heavy to be reckoned with; check its sizes and density"),
    (r#"<geom name="arm"/>"#, r#"<geom name="arm"><plugin/></geom>"#, "14: <plugin> is not supported in <geom>; remove it if the model can do without"),
    (r#"type="ball""#, r#"type="slide""#, r#"13: <joint> 'shoulder' has type="slide": it may be hinge or ball or free"#),
    (r#"range="0 90""#, r#"range="10 90""#, r#"13: <joint> 'shoulder' has range="10 90": that of a ball joint is 0 and its largest angle"#),
    (r#"range="-30 40""#, r#"range="40 -30""#, r#"16: <joint> 'wrist' has range="40 -30": the smaller number comes first"#),
    (r#"range="-30 40""#, r#"range="40 -30" limited="true""#, r#"16: <joint> 'wrist' has range="40 -30": the smaller number comes first"#),
    (r#"range="-30 40""#, r#"limited="true""#, "16: <joint> 'wrist' lacks range: limits need a range whose second number is larger"),
    (r#"range="-30 40""#, r#"range="-30 40" limited="yes""#, r#"16: <joint> 'wrist' has limited="yes": it may be false or true or auto"#),
    (r#"range="-30 40""#, r#"range="-30""#, r#"16: <joint> 'wrist' has range="-30": expected 2 numbers, found 1"#),
    (r#"axis="0 1 0""#, r#"axis="0 0 0""#, r#"16: <joint> 'wrist' has axis="0 0 0": this points in no direction"#),
    (r#"axis="0 1 0""#, r#"armature="-1""#, r#"16: <joint> 'wrist' has armature="-1": it must not be negative"#),
    (r#"axis="0 1 0""#, r#"frictionloss="1""#, r#"16: <joint> 'wrist' has frictionloss="1": only 0 is supported"#),
    (r#"axis="0 1 0""#, r#"solreflimit="-100 -1""#, r#"16: <joint> 'wrist' has solreflimit="-100 -1": only a time constant and a damping ratio, both positive, are supported"#),
    (r#"axis="0 1 0""#, r#"solimplimit=".9 .95 .001 .5 .5""#, r#"16: <joint> 'wrist' has solimplimit=".9 .95 .001 .5 .5": expected are two impedances from 0 to 1, a width, a midpoint from 0 to 1, and a power of at least 1"#),
    (r#"axis="0 1 0""#, r#"spin="1""#, r#"16: <joint> 'wrist' has spin="1": this attribute is not supported; remove it"#),
    (r#"size=".1 .1 .1""#, r#"size=".1 .1""#, r#"17: <geom> 'hand' has size=".1 .1": a box has 3 positive numbers there"#),
    (r#"size=".1 .1 .1""#, r#"size=".1 .1 .1 .1""#, r#"17: <geom> 'hand' has size=".1 .1 .1 .1": expected 1 to 3 numbers, found 4"#),
    (r#"size=".1 .1 .1""#, r#"size="0 .1 .1""#, r#"17: <geom> 'hand' has size="0 .1 .1": a box has 3 positive numbers there"#),
    (r#"size=".1 .1 .1""#, "", r#"5: <geom> 'hand' has size=".1 .2": a box has 3 positive numbers there"#),
    (r#"mass="1""#, r#"mass="-1""#, r#"17: <geom> 'hand' has mass="-1": it must not be negative"#),
    (r#"mass="1""#, r#"density="-1""#, r#"17: <geom> 'hand' has density="-1": it must not be negative"#),
    (r#"mass="1""#, r#"fromto="0 0 0 0 0 0""#, r#"17: <geom> 'hand' has fromto="0 0 0 0 0 0": the two ends are the same"#),
    (r#"mass="1""#, r#"fromto="0 0 0 0 0 1" pos="0 0 1""#, r#"17: <geom> 'hand' has fromto="0 0 0 0 0 1": it says where the geom is; remove pos and the orientation"#),
    (r#"<geom name="trunk" size=".2"/>"#, r#"<geom name="trunk" size=".2" fromto="0 0 0 0 0 1"/>"#, r#"11: <geom> 'trunk' has fromto="0 0 0 0 0 1": only capsules and boxes have two ends"#),
    (r#"mass="1""#, r#"condim="6""#, r#"17: <geom> 'hand' has condim="6": supported are 1 (no friction) and 3 (sliding friction)"#),
    (r#"mass="1""#, r#"condim="4""#, r#"17: <geom> 'hand' has condim="4": supported are 1 (no friction) and 3 (sliding friction)"#),
    (r#"mass="1""#, r#"friction="-1""#, r#"17: <geom> 'hand' has friction="-1": it must not be negative"#),
    (r#"mass="1""#, r#"contype="1.5""#, r#"17: <geom> 'hand' has contype="1.5": these are bits: a whole number that is not negative"#),
    (r#"mass="1""#, r#"margin=".01""#, r#"17: <geom> 'hand' has margin=".01": only 0 is supported"#),
    (r#"mass="1""#, r#"priority="1""#, r#"17: <geom> 'hand' has priority="1": only 0 is supported"#),
    (r#"mass="1""#, r#"solmix="2""#, r#"17: <geom> 'hand' has solmix="2": only 1 is supported"#),
    (r#"mass="1""#, r#"solref="0 1""#, r#"17: <geom> 'hand' has solref="0 1": only a time constant and a damping ratio, both positive, are supported"#),
    (r#"mass="1""#, r#"solimp=".9 1.5""#, r#"17: <geom> 'hand' has solimp=".9 1.5": expected are two impedances from 0 to 1, a width, a midpoint from 0 to 1, and a power of at least 1"#),
    (r#"type="box" size=".1 .1 .1""#, r#"type="plane" size="1 1 1""#, r#"17: <geom> 'hand' has type="plane": a plane cannot be in a body that moves"#),
    (r#"body1="trunk""#, r#"body1="leg""#, r#"22: <exclude> has body1="leg": there is no such body"#),
    (r#" body1="trunk""#, "", "22: <exclude> needs the attribute body1"),
    (r#"joint="wrist""#, r#"joint="elbow""#, r#"24: <position> 'p' has joint="elbow": there is no such joint"#),
    (r#"joint="wrist""#, r#"joint="root""#, r#"24: <position> 'p' has joint="root": this is free; only hinges and balls can be driven"#),
    (r#"joint="wrist" "#, "", "24: <position> 'p' needs the attribute joint"),
    (r#"joint="shoulder" gear="0 1 0""#, r#"joint="wrist""#, "25: <position> 'q' drives what another actuator drives already"),
    (r#"gear="0 1 0""#, r#"gear="1 1 0""#, r#"25: <position> 'q' has gear="1 1 0": for a ball joint it picks one of three axes, like "0 1 0""#),
    (r#"name="q""#, r#"name="p""#, r#"25: <position> 'p' has name="p": another actuator has this name"#),
    (r#"kp="10" kv="1""#, r#"kp="-10""#, r#"24: <position> 'p' has kp="-10": it must not be negative"#),
    (r#"kp="10" kv="1""#, r#"dampratio="1""#, r#"24: <position> 'p' has dampratio="1": only 0 is supported"#),
    (r#"forcerange="-5 5""#, r#"forcerange="-5 6""#, r#"24: <position> 'p' has forcerange="-5 6": supported are limits like "-5 5""#),
    (r#"forcerange="-5 5""#, r#"forcerange="5 -5""#, r#"24: <position> 'p' has forcerange="5 -5": the smaller number comes first"#),
    (r#"<position name="p" joint="wrist" kp="10" kv="1" forcerange="-5 5"/>"#, r#"<motor name="p" joint="wrist" kp="1"/>"#, r#"24: <motor> 'p' has kp="1": this attribute is not supported; remove it"#),
    ("<contact>", "<tendon><fixed stiffness='3'/></tendon><contact>", "22: <fixed> has stiffness=\"3\": only 0 is supported"),
    ("<contact>", "<tendon><fixed range='0 1'/></tendon><contact>", "22: <fixed> has range=\"0 1\": limited tendons are not supported; remove it, or set limited=\"false\""),
    ("<contact>", "<equality><weld body1='arm' body2='hand'/></equality><contact>", "22: <weld> is not supported; remove it, or switch it off with active=\"false\""),
    ("<contact>", "<include/><contact>", "22: <include> needs the attribute file"),
    ("<contact>", "<include file='m.xml'/><contact>", "22: <include> has file=\"m.xml\": it is there already; include it once"),
    (r#"<default class="arm">"#, r#"<default class="arm"><general dyntype="integrator"/>"#, r#"5: <general> has dyntype="integrator": only none is supported"#),
    (r#"<geom name="trunk" size=".2"/>"#, r#"<geom name="trunk" size=".2"/><frame euler="1"/>"#, r#"11: <frame> has euler="1": expected 3 numbers, found 1"#),
    (r#"<geom name="trunk" size=".2"/>"#, r#"<geom name="trunk" size=".2"/><frame><plugin/></frame>"#, "11: <plugin> is not supported in <frame>; remove it if the model can do without"),
    (r#"<freejoint name="root"/>"#, r#"<joint type="free" name="root" stiffness="2"/>"#, r#"10: <joint> 'root' has stiffness="2": a free joint has no stiffness here; remove it"#),
    (r#"axis="0 1 0""#, r#"margin="2""#, r#"16: <joint> 'wrist' has margin="2": nothing is left of the range"#),
    (r#"axis="0 1 0""#, r#"actuatorfrcrange="-1 2""#, r#"16: <joint> 'wrist' has actuatorfrcrange="-1 2": supported are limits like "-5 5""#),
    (r#"type="box""#, r#"type="mesh""#, r#"17: <geom> 'hand' is a mesh that touches; put spheres, capsules or boxes in its place, and have it touch nothing by contype="0" conaffinity="0""#),
    (r#"type="box""#, r#"type="mesh" contype="0" conaffinity="0""#, r#"17: <geom> 'hand' is a mesh that weighs, which is not supported; give it mass="0", or its body <inertial>"#),
    (r#"type="box""#, r#"type="ellipsoid""#, r#"17: <geom> 'hand' has type="ellipsoid": such a shape cannot touch here; use a capsule or a box, or have it touch nothing by contype="0" conaffinity="0""#),
    (r#"type="box""#, r#"type="sdf""#, r#"17: <geom> 'hand' has type="sdf": it may be plane or sphere or capsule or box or cylinder or ellipsoid or mesh"#),
    (r#"kp="10" kv="1""#, r#"inheritrange="-1""#, r#"24: <position> 'p' has inheritrange="-1": it needs a joint with a range, and a positive part of it"#),
    (r#"kp="10" kv="1""#, r#"ctrlrange="1 -1""#, r#"24: <position> 'p' has ctrlrange="1 -1": the smaller number comes first"#),
    (r#"<position name="p" joint="wrist" kp="10" kv="1" forcerange="-5 5"/>"#, r#"<general name="p" joint="wrist" biastype="affine" biasprm="1 -2 0"/>"#, r#"24: <general> 'p' has biasprm="1 -2 0": supported are "0 -kp -kv", kp and kv not negative"#),
    (r#"<position name="p" joint="wrist" kp="10" kv="1" forcerange="-5 5"/>"#, r#"<muscle name="p" joint="wrist"/>"#, "24: <muscle> 'p' is not supported in <actuator>; remove it if the model can do without"),
];

fn refusal(text: &str) -> String {
    match parse(text) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("accepted: {text}"),
    }
}

#[test]
fn wrong_models_are_refused_with_line_and_element() {
    assert!(parse(SMALL).is_ok());
    let mut wrong = Vec::new();
    for (old, new, expected) in CASES {
        assert!(SMALL.contains(old), "{old}");
        let message = refusal(&SMALL.replacen(old, new, 1));
        if message != format!("m.xml, line {expected}") {
            wrong.push(format!("{message}\ninstead of line {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn broken_xml_is_refused_with_the_line() {
    for text in [
        "",
        "no xml",
        "<mujoco>",
        "<mujoco></robot>",
        "<mujoco a='1' a='2'/>",
        "<a/><b/>",
    ] {
        let message = refusal(text);
        assert!(
            message.starts_with("m.xml, line 1: this is no valid XML: "),
            "{message}"
        );
    }
    let entities = "<!DOCTYPE m [<!ENTITY a 'aaaa'>]><mujoco model='&a;'/>";
    assert!(refusal(entities).contains("DTD"), "{}", refusal(entities));
    assert_eq!(
        refusal("<robot/>"),
        "m.xml, line 1: <robot> is not what MJCF begins with: <mujoco>"
    );
}

#[test]
fn what_cannot_change_the_dynamics_is_skipped() {
    let model = parse(SMALL).unwrap();
    let more = "<camera name='c'/><light/><site name='s' size='.1'/><geom name=\"arm\" rgba='1 0 0 1' material='grid' group='1'/>";
    let text = SMALL
        .replace("<geom name=\"arm\"/>", more)
        .replace("<contact>", "<visual/><asset><mesh file='x'/></asset><statistic extent='1'/><size/><sensor><touch/></sensor><custom/><keyframe><key/></keyframe><tendon><fixed><joint/></fixed></tendon><equality><weld active='false'/></equality><contact>")
        .replace("<default>", "<default><site/><camera/><tendon/>")
        .replace("timestep=\"0.01\"", "timestep='1' iterations='3' solver='CG' integrator='RK4' gravity='0 0 -9.810'");
    assert_eq!(parse(&text).unwrap(), model);
    // Frames only move, meshes that touch nothing and weigh nothing are only seen.
    let frames = SMALL
        .replace("<geom name=\"arm\"/>", "<frame><frame><geom name=\"arm\"/></frame><geom type='mesh' mesh='x' mass='0' contype='0' conaffinity='0'/></frame>")
        .replace("<body name=\"hand\" pos=\"0 0 .3\">", "<frame name='f' pos='0 0 .3'><body name=\"hand\">")
        .replace("        </body>\n", "        </body></frame>\n");
    assert_eq!(parse(&frames).unwrap(), model);
    // A geom that touches nothing only weighs.
    let ghost = SMALL.replace(
        "<geom name=\"arm\"/>",
        "<geom name=\"arm\" contype='0' conaffinity='0'/>",
    );
    let ghost = parse(&ghost).unwrap();
    assert_eq!(
        (ghost.bodies, ghost.geoms.len()),
        (model.bodies, model.geoms.len() - 1)
    );
}

#[test]
fn deep_nesting_and_many_elements_are_refused() {
    let nest = |open: &str, close: &str, count| {
        let (open, close) = (open.repeat(count), close.repeat(count));
        format!("<mujoco><worldbody>{open}{close}</worldbody></mujoco>")
    };
    let moving = "<body><joint/><geom size='.1'/>";
    assert!(parse(&nest(moving, "</body>", 200)).is_ok());
    assert!(refusal(&nest(moving, "</body>", 201)).contains("is one body too many: 200 may move"));
    assert!(refusal(&nest("<geom size='.1'/>", "", 201)).contains("is one geom too many"));
    let joints = nest("<joint/>", "", 201);
    let joints = joints.replace("<worldbody>", "<worldbody><body><geom size='1'/>");
    let joints = joints.replace("</worldbody>", "</body></worldbody>");
    assert!(refusal(&joints).contains("is one joint too many"));
    let classes = "<default class='a'>".repeat(20_000) + &"</default>".repeat(20_000);
    assert!(refusal(&format!("<mujoco>{classes}</mujoco>")).contains("class="));
    // Bodies that cannot move are part of the world. No nesting costs stack.
    assert!(parse(&nest("<body>", "</body>", 50_000)).is_ok());
    assert!(refusal(&nest("<a>", "", 300_000)).contains("no valid XML"));
}

#[test]
fn all_that_is_wrong_is_told_at_once() {
    let text = SMALL
        .replace(r#"childclass="arm""#, r#"childclass="leg""#)
        .replace(
            r#"axis="0 1 0" range="-30 40""#,
            r#"axis="0 0 0" frictionloss="1""#,
        )
        .replace(
            r#"type="box" size=".1 .1 .1""#,
            r#"type="box" size=".1" shade="3""#,
        )
        .replace(r#"body2="hand""#, r#"body2="foot""#)
        .replace(r#"kp="10" kv="1""#, r#"kp="-10" speed="1""#);
    let wanted = [
        r#"m.xml, line 12: <body> 'arm' has childclass="leg": there is no such class in <default>"#,
        r#"m.xml, line 16: <joint> 'wrist' has axis="0 0 0": this points in no direction"#,
        r#"m.xml, line 16: <joint> 'wrist' has frictionloss="1": only 0 is supported"#,
        r#"m.xml, line 17: <geom> 'hand' has size=".1": a box has 3 positive numbers there"#,
        r#"m.xml, line 17: <geom> 'hand' has shade="3": this attribute is not supported; remove it"#,
        r#"m.xml, line 22: <exclude> has body2="foot": there is no such body"#,
        r#"m.xml, line 24: <position> 'p' has kp="-10": it must not be negative"#,
        r#"m.xml, line 24: <position> 'p' has speed="1": this attribute is not supported; remove it"#,
    ];
    assert_eq!(refusal(&text).lines().collect::<Vec<_>>(), wanted);
    // Not one of thousands.
    let many = "<joint spin='1'/>".repeat(3000);
    let many = format!("<mujoco><default>{many}</default></mujoco>");
    assert_eq!(refusal(&many).lines().count(), 50);
}

#[test]
fn included_files_are_part_of_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    let read = |name: &str| {
        let read = mjcf::read(&folder.path().join(name), MjcfOptions::default());
        read.map(|read| read.model)
    };
    let (hand, rest) = (
        SMALL.find("        <body name=\"hand\"").unwrap(),
        SMALL.find("\n      </body>").unwrap() + 1,
    );
    write("whole.xml", SMALL);
    write(
        "hand.xml",
        &format!("<mujocoinclude>\n{}</mujocoinclude>", &SMALL[hand..rest]),
    );
    write(
        "looks.xml",
        "<mujoco model='other'><visual/><include file='more.xml'/></mujoco>",
    );
    write("more.xml", "<mujocoinclude/>");
    let parts = |hand_file: &str| {
        let include = format!("<include file='{hand_file}'/>\n");
        let text = [&SMALL[..hand], &include, &SMALL[rest..]].concat();
        text.replace("<contact>", "<include file=\"looks.xml\"/><contact>")
    };
    write("parts.xml", &parts("hand.xml"));
    assert_eq!(read("parts.xml").unwrap(), read("whole.xml").unwrap());
    write(
        "scene.xml",
        "<mujoco model='small'>\n<include file='parts.xml'/>\n<statistic/></mujoco>",
    );
    assert_eq!(read("scene.xml").unwrap(), read("whole.xml").unwrap());

    // Errors say in which file they are, and behind an include the lines are still right.
    write(
        "hand.xml",
        "<mujocoinclude>\n<body>\n<joint spin='1'/><geom size='1'/></body></mujocoinclude>",
    );
    let text = parts("hand.xml").replace("kp=\"10\" kv=\"1\"", "kp=\"-1\"");
    write(
        "parts.xml",
        &text.replace("joint=\"wrist\"", "joint=\"shoulder\" gear=\"1\""),
    );
    let message = read("parts.xml").unwrap_err().to_string();
    let told: Vec<&str> = message.lines().collect();
    assert!(
        told[0].contains("hand.xml, line 3: <joint> has spin=\"1\""),
        "{message}"
    );
    assert!(
        told[1].contains("parts.xml, line 19: <exclude> has body2=\"hand\""),
        "{message}"
    );
    assert!(
        told[2].contains("parts.xml, line 21: <position> 'p' has kp=\"-1\""),
        "{message}"
    );

    write("parts.xml", &parts("absent.xml"));
    let message = read("parts.xml").unwrap_err().to_string();
    assert!(
        message.contains("parts.xml, line 15: <include> has file=\"absent.xml\": cannot read"),
        "{message}"
    );
    write(
        "circle.xml",
        "<mujoco><include file='circle.xml'/></mujoco>",
    );
    let message = read("circle.xml").unwrap_err().to_string();
    assert!(message.contains("it is there already"), "{message}");
    write("parts.xml", &parts("broken.xml"));
    write("broken.xml", "<mujocoinclude>\n<body></mujocoinclude>");
    let message = read("parts.xml").unwrap_err().to_string();
    assert!(
        message.contains("broken.xml, line 2: this is no valid XML"),
        "{message}"
    );
}

fn unread(path: &Path) -> String {
    let read = mjcf::read(path, MjcfOptions::default());
    read.unwrap_err().to_string()
}

#[test]
fn files_that_are_no_text_or_too_large() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("binary.xml");
    std::fs::write(&path, b"<mujoco>\n\xff\xfe</mujoco>").unwrap();
    let message = unread(&path);
    assert!(
        message.ends_with("line 2: bytes that are not UTF-8; save the file as UTF-8"),
        "{message}"
    );

    // Sparse: it takes no room on the disk.
    let path = folder.path().join("giant.xml");
    std::fs::File::create(&path)
        .unwrap()
        .set_len(mjcf::MAX_BYTES + 1)
        .unwrap();
    let message = unread(&path);
    assert!(message.contains("more than 1048576 bytes"), "{message}");

    let message = unread(Path::new("absent.xml"));
    assert!(message.contains("cannot read absent.xml"), "{message}");
    let message = unread(folder.path());
    assert!(message.contains("cannot read"), "{message}");
}

const HUMANOID: &str = include_str!("../../../src/physics/humanoid.xml");

#[test]
fn no_truncation_panics() {
    for end in (0..HUMANOID.len()).filter(|&end| HUMANOID.is_char_boundary(end)) {
        assert!(parse(&HUMANOID[..end]).is_err() || HUMANOID[end..].trim().is_empty());
    }
}

#[test]
fn no_changed_byte_panics() {
    for index in 0..HUMANOID.len() {
        for byte in *b"9- \"" {
            let mut bytes = HUMANOID.as_bytes().to_vec();
            bytes[index] = byte;
            if let Ok(model) = parse(&String::from_utf8_lossy(&bytes)) {
                assert!(model.mass().is_finite() && model.bodies.len() < 16);
            }
        }
    }
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let text = String::from_utf8_lossy(&bytes);
        let _ = parse(&text);
        let _ = parse(&format!("<mujoco><worldbody><body><geom {text}"));
    }

    #[test]
    fn no_damage_panics(
        cuts in proptest::collection::vec((0_usize..1400, 0_usize..30, "[ 0-9a-z<>/=\"'.-]{0,6}"), 1..5),
    ) {
        let mut text = SMALL.to_string();
        for (start, length, patch) in cuts {
            let start = start.min(text.len());
            let end = (start + length).min(text.len());
            text.replace_range(start..end, &patch);
        }
        let _ = parse(&text);
    }
}
