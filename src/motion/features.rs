//! The features that motion matching compares: 15 numbers of pose and 12 of future trajectory a frame.

use super::character_frame::to_local;
use super::clip::Clip;
use super::roles::Roles;
use super::smooth::savitzky_golay;
use glam::Vec3;

/// Width of the pose feature c: left foot position, right foot position, left foot velocity,
/// right foot velocity, root velocity, 3 each, in the character frame (m, m/s).
pub const POSE_DIM: usize = 15;
/// Width of the trajectory feature t: for +10, +20 and +30 frames the root's ground position (2)
/// and heading (2), in the character frame.
pub const TRAJECTORY_DIM: usize = 12;
/// Width of a feature row, c then t (paper, section 3).
pub const FEATURE_DIM: usize = POSE_DIM + TRAJECTORY_DIM;
/// Length of a feature row padded to whole vectors of four, as shaders and SIMD read it.
pub const ROW_STRIDE: usize = 28;
/// The frames ahead that t looks at.
pub const TRAJECTORY_OFFSETS: [usize; 3] = [10, 20, 30];
/// Frames at a clip's end whose future is unknown: played, never matched.
pub const MIN_FUTURE_FRAMES: usize = TRAJECTORY_OFFSETS[2];
/// Frames played between two matches: one step of the policy, 0.2 s.
pub const FRAMES_PER_STEP: usize = 6;

const _: () = assert!(ROW_STRIDE >= FEATURE_DIM && ROW_STRIDE.is_multiple_of(4));

/// The character's path on the ground and the features of every frame of a clip.
pub struct FeatureTrack {
    /// `[x, z]` of the smoothed root, m.
    pub ground: Vec<[f32; 2]>,
    /// Unit forward direction `[x, z]`.
    pub heading: Vec<[f32; 2]>,
    /// In metres and m/s. In the last 30 frames the trajectory repeats the last frame: these
    /// frames are played but never matched.
    pub features: Vec<[f32; FEATURE_DIM]>,
}

/// Joint positions of one frame that features and the character frame need.
struct Points {
    root: Vec3,
    left_foot: Vec3,
    right_foot: Vec3,
    /// From the right side of hips and shoulders to their left side.
    leftwards: Vec3,
}

impl Points {
    fn of(clip: &Clip, roles: &Roles, frame: usize) -> Self {
        let (at, _) = clip.world(frame);
        Points {
            root: at[roles.hips],
            left_foot: at[roles.left_foot],
            right_foot: at[roles.right_foot],
            leftwards: at[roles.left_hip] - at[roles.right_hip] + at[roles.left_shoulder]
                - at[roles.right_shoulder],
        }
    }
}

/// Path and features of a clip of at least [`super::smooth::WINDOW`] frames.
pub fn extract(clip: &Clip, roles: &Roles) -> FeatureTrack {
    let points: Vec<Points> = (0..clip.frames())
        .map(|frame| Points::of(clip, roles, frame))
        .collect();
    let (ground, heading) = path(&points);
    let features = (0..points.len())
        .map(|frame| {
            let mut row = [0.0; FEATURE_DIM];
            pose(
                &points,
                &ground,
                &heading,
                frame,
                clip.rate,
                &mut row[..POSE_DIM],
            );
            trajectory(&ground, &heading, frame, &mut row[POSE_DIM..]);
            row
        })
        .collect();
    FeatureTrack {
        ground,
        heading,
        features,
    }
}

/// The smoothed ground path and heading. Forward is the leftward axis crossed with up.
fn path(points: &[Points]) -> (Vec<[f32; 2]>, Vec<[f32; 2]>) {
    let smooth = |value: &dyn Fn(&Points) -> f32| {
        savitzky_golay(&points.iter().map(value).collect::<Vec<_>>())
    };
    let forward = |p: &Points| p.leftwards.cross(Vec3::Y).normalize_or(Vec3::Z);
    let (x, z) = (smooth(&|p| p.root.x), smooth(&|p| p.root.z));
    let (hx, hz) = (smooth(&|p| forward(p).x), smooth(&|p| forward(p).z));
    let ground = x.into_iter().zip(z).map(|(x, z)| [x, z]).collect();
    let heading = hx
        .into_iter()
        .zip(hz)
        .map(|(x, z)| {
            let length = x.hypot(z);
            if length > 1e-6 {
                [x / length, z / length]
            } else {
                [0.0, 1.0]
            }
        })
        .collect();
    (ground, heading)
}

fn pose(
    points: &[Points],
    ground: &[[f32; 2]],
    heading: &[[f32; 2]],
    frame: usize,
    rate: f32,
    out: &mut [f32],
) {
    let here = &points[frame];
    let origin = Vec3::new(ground[frame][0], 0.0, ground[frame][1]);
    let local = |v: Vec3| {
        let [x, z] = to_local([v.x, v.z], heading[frame]);
        [x, v.y, z]
    };
    // Central differences; one-sided in the first and last frame.
    let (before, after) = (frame.saturating_sub(1), (frame + 1).min(points.len() - 1));
    let seconds = (after - before) as f32 / rate;
    let velocity =
        |of: &dyn Fn(&Points) -> Vec3| local((of(&points[after]) - of(&points[before])) / seconds);
    let groups = [
        local(here.left_foot - origin),
        local(here.right_foot - origin),
        velocity(&|p| p.left_foot),
        velocity(&|p| p.right_foot),
        velocity(&|p| p.root),
    ];
    out.copy_from_slice(groups.as_flattened());
}

fn trajectory(ground: &[[f32; 2]], heading: &[[f32; 2]], frame: usize, out: &mut [f32]) {
    for (part, ahead) in out.chunks_exact_mut(4).zip(TRAJECTORY_OFFSETS) {
        let then = (frame + ahead).min(ground.len() - 1);
        let moved = [
            ground[then][0] - ground[frame][0],
            ground[then][1] - ground[frame][1],
        ];
        part[..2].copy_from_slice(&to_local(moved, heading[frame]));
        part[2..].copy_from_slice(&to_local(heading[then], heading[frame]));
    }
}
