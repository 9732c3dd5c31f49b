//! Fighters that nobody has trained, by which those are measured that were.

use crate::env::humanoid::punch::evaluate::BOXING;
use crate::env::humanoid::recorded::observe;
use crate::env::humanoid::task::{DT, KEY_BODIES};
use crate::kernels::humanoid::boxing_observe;
use crate::kernels::physics::proprioception::{ROOT_ANGULAR_VELOCITY, ROOT_VELOCITY};
use crate::physics::motion_library::MotionLibrary;
use crate::rl::ase::{LatentDraw, Script};
use crate::rl::strides::{Stride, Strides};
use glam::{Vec2, Vec3};

/// Seed of the latents that change.
const SEED: u32 = 0x414e_4348;

/// Scripts with names for tables: of whoever stands, jabs and advances where each clip has a latent in `draw`; and of
/// whose latents change.
pub fn scripts(
    draw: &LatentDraw,
    library: &MotionLibrary,
    style: usize,
) -> Vec<(&'static str, Script)> {
    let latents: Vec<Vec<f32>> = draw.clips().map(<[f32]>::to_vec).collect();
    let random = ("(random latents)", Script::Random(draw.clone(), SEED));
    if latents.is_empty() {
        return vec![unsteered(draw.dim), random];
    }
    let clips: Vec<ClipMotion> = (0..latents.len())
        .map(|clip| ClipMotion::new(library, clip))
        .collect();
    let mut boxing: Vec<usize> = (0..clips.len())
        .filter(|&clip| library.kind(clip) == BOXING)
        .collect();
    if boxing.is_empty() {
        boxing = (0..clips.len()).collect();
    }
    let quickest = least(boxing, |clip| -clips[clip].hands);
    let others = (0..clips.len()).filter(|&clip| clip != quickest || clips.len() == 1);
    // A step counts more than a gesture.
    let quietest = least(others, |clip| 3.0 * clips[clip].speed + clips[clip].hands);
    let strides = clips.iter().zip(&latents).map(|(clip, latent)| Stride {
        action: latent.clone(),
        forward: clip.forward,
        turn: clip.turn,
    });
    let approach = Script::Strides(Strides {
        target: style + boxing_observe::OPPONENT,
        strides: strides.collect(),
    });
    vec![
        ("(stands)", Script::keep(latents[quietest].clone())),
        ("(jabs)", Script::keep(latents[quickest].clone())),
        ("(advances)", approach),
        random,
    ]
}

/// The script of whoever keeps the latent that an action of zeros stands for.
pub fn unsteered(latent: usize) -> (&'static str, Script) {
    ("(does nothing)", Script::unsteered(latent))
}

fn least(clips: impl IntoIterator<Item = usize>, of: impl Fn(usize) -> f32) -> usize {
    let found = clips.into_iter().min_by(|&a, &b| of(a).total_cmp(&of(b)));
    found.expect("a library has clips")
}

/// How a body moves in a clip.
struct ClipMotion {
    /// Mean speed along the heading, m/s.
    forward: f32,
    /// Mean speed over the ground, m/s.
    speed: f32,
    /// Mean speed at which the heading turns to the left, rad/s.
    turn: f32,
    /// Speed of the quicker hand seen from the body that is exceeded in a twentieth of the steps, m/s.
    hands: f32,
}

impl ClipMotion {
    fn new(library: &MotionLibrary, clip: usize) -> ClipMotion {
        let steps = (library.motions()[clip].seconds() / DT) as usize;
        let moments = (0..=steps).map(|step| {
            let (q, v) = library.at(clip, step as f32 * DT);
            observe(library.model(), &q, &v)
        });
        let moments: Vec<Vec<f32>> = moments.collect();
        let mean = |of: &dyn Fn(&[f32]) -> f32| {
            moments.iter().map(|moment| of(moment)).sum::<f32>() / moments.len() as f32
        };
        let mut hands: Vec<f32> = moments
            .windows(2)
            .map(|pair| hands(&pair[0], &pair[1]))
            .collect();
        hands.sort_by(f32::total_cmp);
        ClipMotion {
            forward: mean(&|moment| moment[ROOT_VELOCITY]),
            speed: mean(&|moment| Vec2::from_slice(&moment[ROOT_VELOCITY..]).length()),
            turn: mean(&|moment| moment[ROOT_ANGULAR_VELOCITY + 2]),
            hands: hands.get(hands.len() * 19 / 20).copied().unwrap_or(0.0),
        }
    }
}

/// Speed of the quicker hand between two moments.
fn hands(before: &[f32], after: &[f32]) -> f32 {
    // Key bodies come last.
    let first = before.len() - 3 * KEY_BODIES.len();
    let at = |moment: &[f32], key: usize| Vec3::from_slice(&moment[first + 3 * key..]);
    let keys = (0..KEY_BODIES.len()).filter(|&key| KEY_BODIES[key].ends_with("hand"));
    keys.map(|hand| (at(after, hand) - at(before, hand)).length() / DT)
        .fold(0.0, f32::max)
}
