//! Bodies that a low level moves by a script.
//! Oracle: a low level of random numbers, whose latents say what was chosen; the performer's clips, of which it is
//! known what they are. Bar: equal.

use crate::support::low_level::{LATENT, checkpoint};
use footwork::env::humanoid::boxing::boxing_spec;
use footwork::env::humanoid::driver::{BodyDriver, DriverState};
use footwork::kernels::humanoid::boxing_observe::{DIM, OPPONENT};
use footwork::motion::synthetic::{perform_boxing, perform_walk};
use footwork::physics::motion_library::MotionLibrary;
use footwork::physics::scenes;
use footwork::rl::ase::{
    Ase, FrozenLowLevel, LatentDraw, LowLevel, STEPS_PER_DECISION, Script, ScriptedDriver,
};
use footwork::rl::strides::{Stride, Strides};
use footwork::train::{anchors, low_level};
use std::sync::Arc;

/// Numbers of a body's observation of itself.
const BODY: usize = 105;

fn some_low_level() -> Arc<FrozenLowLevel> {
    let spec = boxing_spec(1);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("low.ckpt");
    let rest = vec![0.0; spec.action];
    checkpoint(LowLevel::PerClip, BODY, &rest, 5)
        .save(&path)
        .unwrap();
    Arc::new(low_level::load(&path).unwrap())
}

/// Latents along an axis.
fn along(axis: usize) -> Vec<f32> {
    let mut latent = vec![0.0; LATENT];
    latent[axis] = 1.0;
    latent
}

/// Rows of fighters whose opponents are at these places of their heading frames.
fn opposed(places: &[[f32; 2]]) -> Vec<f32> {
    let row = |place: &[f32; 2]| {
        let mut row = vec![0.1; BODY + DIM];
        row[BODY + OPPONENT..][..2].copy_from_slice(place);
        row
    };
    places.iter().flat_map(row).collect()
}

#[test]
fn who_advances_turns_to_its_opponent_and_goes_there() {
    let low_level = some_low_level();
    let stride = |axis, forward, turn| Stride {
        action: along(axis),
        forward,
        turn,
    };
    let strides = vec![
        stride(0, 0.1, 0.0),
        stride(1, 1.2, 0.0),
        stride(2, 0.3, 1.5),
        stride(3, 0.3, -1.5),
        stride(4, -0.8, 0.0),
    ];
    let target = BODY + OPPONENT;
    let script = Script::Strides(Strides { target, strides });
    let driver = ScriptedDriver::new(&low_level, script, BODY + DIM);
    let mut state = DriverState::default();
    let places = [[3.0, 0.1], [0.1, 2.0], [-0.5, -2.0], [-3.0, 0.5]];
    let seen = opposed(&places);
    let action = driver.act(&seen, &mut state);
    let chosen = [1, 2, 3, 2].map(along).concat();
    assert_eq!(state.latents, chosen);
    assert_eq!(action, low_level.act(&seen, &chosen));
    // It goes on for a decision, whatever the opponent does.
    let others = opposed(&[[0.1, 2.0]; 4]);
    (1..STEPS_PER_DECISION).for_each(|_| {
        driver.act(&others, &mut state);
    });
    assert_eq!(state.latents, chosen);
    driver.act(&others, &mut state);
    assert_eq!(state.latents, along(2).repeat(4));
}

#[test]
fn latents_are_kept_or_change_as_in_training() {
    let low_level = some_low_level();
    let seen = opposed(&[[1.0, 0.0]; 3]);
    let mut state = DriverState::default();
    let keeps = ScriptedDriver::new(&low_level, Script::keep(along(5)), BODY + DIM);
    (0..40).for_each(|_| {
        keeps.act(&seen, &mut state);
    });
    assert_eq!(state.latents, along(5).repeat(3));
    assert_eq!(Script::unsteered(LATENT), Script::keep(along(0)));
    let ase = Ase {
        latent: LATENT,
        kept_steps: [4, 4],
        ..Ase::default()
    };
    let draw = LatentDraw::new(&ase, &[0.5, 0.5]);
    let changes = Script::Random(draw.clone(), 7);
    let changes = ScriptedDriver::new(&low_level, changes, BODY + DIM);
    let (mut state, mut wanted) = (DriverState::default(), DriverState::default());
    for step in 0..12 {
        let before = state.latents.clone();
        changes.act(&seen, &mut state);
        draw.advance(3, 7, &mut wanted);
        assert_eq!(state, wanted);
        assert_eq!(before == state.latents, step % 4 > 0, "{step}");
    }
}

#[test]
fn the_latents_of_clips_are_those_of_the_recordings_that_were_learned() {
    let low_level = some_low_level();
    // The checkpoint's fingerprint is 0.
    assert_eq!(low_level.latents(0, &[1.0]).unwrap().clips().count(), 1);
    assert!(low_level.latents(1, &[1.0]).is_none());
}

#[test]
fn anchors_are_found_among_the_clips() {
    let model = Arc::new(scenes::humanoid());
    let (mut clips, roles) = perform_walk(1, 6.0, 1.4);
    clips.extend(perform_boxing(1, 1.0).0);
    let library = MotionLibrary::of(&clips, &roles, &model).unwrap();
    let count = library.motions().len();
    let mut kinds = vec!["boxing".to_string(); count];
    kinds[0] = String::new();
    let library = library.with_kinds(kinds).unwrap();
    let shares = vec![1.0 / count as f32; count];
    let per_clip = LatentDraw::new(&Ase::default(), &shares);
    let scripts = anchors::scripts(&per_clip, &library, BODY);
    let names: Vec<&str> = scripts.iter().map(|(name, _)| *name).collect();
    assert_eq!(
        names,
        ["(stands)", "(jabs)", "(advances)", "(random latents)"]
    );
    let walk = per_clip.clips().next().unwrap().to_vec();
    // Who walks neither stands nor boxes.
    for (name, script) in &scripts[..2] {
        assert!(*script != Script::keep(walk.clone()), "{name}");
    }
    let Script::Strides(Strides { target, strides }) = &scripts[2].1 else {
        panic!("{:?}", scripts[2]);
    };
    assert_eq!((*target, strides.len()), (BODY + OPPONENT, count));
    let fastest = strides
        .iter()
        .max_by(|a, b| a.forward.total_cmp(&b.forward));
    assert_eq!(fastest.unwrap().action, walk);
    assert!(
        (strides[0].forward - 1.4).abs() < 0.1,
        "{}",
        strides[0].forward
    );
    // Of skills that are nobody's clips nothing is known but that they change.
    let ase = Ase {
        low_level: LowLevel::Ase,
        ..Ase::default()
    };
    let any = anchors::scripts(&LatentDraw::new(&ase, &shares), &library, BODY);
    let names: Vec<&str> = any.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["(does nothing)", "(random latents)"]);
}
