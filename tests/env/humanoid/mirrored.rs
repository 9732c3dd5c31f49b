//! Left and right exchanged, in recordings, observations and actions alike.
//! Oracle: the mirrored recording. Bar: rounding.

use crate::support::inputs::Draw;
use footwork::env::humanoid::action::rest_action;
use footwork::env::humanoid::recorded::observe;
use footwork::env::humanoid::task::{KEY_BODIES, spec};
use footwork::motion::synthetic::perform_boxing;
use footwork::nn::Policy;
use footwork::nn::layer::Activation;
use footwork::nn::network::NetworkConfig;
use footwork::physics::mirror::mirrored;
use footwork::physics::model::{JointKind, Model};
use footwork::physics::motion_library::MotionLibrary;
use footwork::physics::scenes;
use std::sync::Arc;

/// Signs of a vector, and of an axis of rotation, reflected over y = 0.
const VECTOR: [f32; 3] = [1.0, -1.0, 1.0];
const AXIS: [f32; 3] = [-1.0, 1.0, -1.0];

/// From which number of an observation, and with which sign, each of the mirrored one comes.
type Exchange = Vec<(usize, f32)>;

fn other_side(model: &Model, body: usize) -> usize {
    let name = &model.bodies[body].name;
    let other = match name.strip_prefix("left_") {
        Some(part) => format!("right_{part}"),
        None => name.replace("right_", "left_"),
    };
    model.body(&other).expect("a humanoid has two sides")
}

fn push(exchange: &mut Exchange, from: usize, signs: &[f32]) {
    exchange.extend(signs.iter().enumerate().map(|(k, &sign)| (from + k, sign)));
}

/// The joints with the place of their counterpart's numbers, of so many a joint.
fn joints(model: &Model, from: usize, numbers: fn(JointKind) -> usize) -> Vec<(JointKind, usize)> {
    let own = model
        .joints
        .iter()
        .filter(|joint| joint.kind != JointKind::Free);
    let mut at = from;
    let starts: Vec<(usize, usize)> = own
        .clone()
        .map(|joint| {
            let start = (joint.body, at);
            at += numbers(joint.kind);
            start
        })
        .collect();
    own.map(|joint| {
        let other = other_side(model, joint.body);
        let start = starts.iter().find(|(body, _)| *body == other);
        (joint.kind, start.expect("a counterpart").1)
    })
    .collect()
}

fn observation_exchange(model: &Model) -> Exchange {
    let mut exchange = vec![(0, 1.0)];
    for signs in [VECTOR, VECTOR, VECTOR, AXIS] {
        let from = exchange.len();
        push(&mut exchange, from, &signs);
    }
    let from = exchange.len();
    let rotation = |kind| if kind == JointKind::Ball { 6 } else { 1 };
    for (kind, from) in joints(model, from, rotation) {
        match kind {
            JointKind::Ball => push(&mut exchange, from, &[VECTOR, VECTOR].concat()),
            _ => push(&mut exchange, from, &[1.0]),
        }
    }
    exchange.extend(velocity_exchange(model, exchange.len()));
    let from = exchange.len();
    for key in 0..KEY_BODIES.len() {
        // Right and left take turns.
        push(&mut exchange, from + 3 * (key ^ 1), &VECTOR);
    }
    exchange
}

/// Of the joints' velocities, and of the actions, which are rotation vectors, too.
fn velocity_exchange(model: &Model, from: usize) -> Exchange {
    let mut exchange = Vec::new();
    let dofs = |kind| if kind == JointKind::Ball { 3 } else { 1 };
    for (kind, from) in joints(model, from, dofs) {
        match kind {
            JointKind::Ball => push(&mut exchange, from, &AXIS),
            _ => push(&mut exchange, from, &[1.0]),
        }
    }
    exchange
}

fn exchanged(values: &[f32], exchange: &Exchange) -> Vec<f32> {
    exchange
        .iter()
        .map(|&(from, sign)| sign * values[from])
        .collect()
}

fn close(a: &[f32], b: &[f32], what: &str) {
    assert_eq!(a.len(), b.len());
    for (at, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(
            (a - b).abs() < 1e-4 * (1.0 + a.abs()),
            "{what}, {at}: {a} {b}"
        );
    }
}

#[test]
fn mirrored_data_through_a_mirrored_policy_gives_mirrored_actions() {
    let model = Arc::new(scenes::humanoid());
    let (clips, roles) = perform_boxing(1, 0.2);
    let library = MotionLibrary::of(&clips, &roles, &model).expect("the performer fits the body");
    let clip = &library.motions()[0];
    let mirror = mirrored(&model, clip).expect("a humanoid");
    let (seen, acted) = (observation_exchange(&model), velocity_exchange(&model, 0));
    let dims = spec(&model, 0, 1);
    let network = NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden: vec![32],
        activation: Activation::Relu,
    };
    let mut policy = Policy::new(&network, &dims.observation, dims.action, 1).unwrap();
    let mut draw = Draw::new(1);
    policy
        .parameters
        .iter_mut()
        .for_each(|weight| *weight = 0.1 * draw.normal());
    let mirrored_policy = |observation: &[f32]| {
        let mean = policy.mean(&exchanged(observation, &seen));
        exchanged(&mean, &acted)
    };
    for frame in (0..clip.frames).step_by(11) {
        let own = observe(&model, clip.q(frame), clip.v(frame));
        let other = observe(&model, mirror.q(frame), mirror.v(frame));
        close(&exchanged(&own, &seen), &other, "observations");
        let [a, b] = [clip, &mirror].map(|clip| rest_action(&model, clip.q(frame)));
        close(&exchanged(&a, &acted), &b, "actions at rest");
        let want = exchanged(&policy.mean(&own), &acted);
        close(&mirrored_policy(&other), &want, "actions");
    }
}
