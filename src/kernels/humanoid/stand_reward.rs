//! Reward and end of a step of the task `stand`. Shader: `shaders/humanoid/stand_reward.wgsl`.

use crate::gpu::shader::stand_reward::constants as at;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::reset_worlds::has_diverged;
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::termination::{FAILED, RUNNING, TRUNCATED};
use crate::physics::pose::Pose;
use glam::Quat;

crate::shader_params! {
    pub struct Params for stand_reward {
        /// Environments of the batch.
        pub envs: u32,
        /// Index of the step's first reward and termination.
        pub at: u32,
        /// Positions of a world.
        pub nq: u32,
        /// Velocities of a world.
        pub nv: u32,
        /// Bodies of a world.
        pub bodies: u32,
        /// Index of the head.
        pub head: u32,
        /// Index of the pelvis.
        pub pelvis: u32,
        /// Index of the torso.
        pub torso: u32,
        /// Index of the right foot.
        pub right_foot: u32,
        /// Index of the left foot.
        pub left_foot: u32,
        /// Steps of an episode.
        pub max_steps: u32,
        /// Height of the head below which the character has fallen, m.
        pub min_head: f32,
        /// Height of the pelvis below which the character has fallen, m.
        pub min_pelvis: f32,
        /// Height of any body but the feet below which the character has fallen, m.
        pub min_body: f32,
        /// m/s and rad/s; what is faster has diverged.
        pub max_speed: f32,
        /// Reward of every step that has not diverged.
        pub alive_reward: f32,
        /// Weight of [`uprightness`] in the reward.
        pub upright_reward: f32,
        /// Weight of [`stillness`] in the reward.
        pub stillness_reward: f32,
    }
}

/// Numbers of an environment's episode: the running one, then sums over those that have ended.
pub const FIELDS: usize = at::FIELDS as usize;
/// Steps after which the running episode is truncated.
pub const LIMIT: usize = at::LIMIT as usize;
/// First of the sums.
pub const SUMS: usize = at::SUMS as usize;
/// Index of the number of ended episodes.
pub const EPISODES: usize = at::EPISODES as usize;
/// Index of the summed steps of ended episodes.
pub const STEPS: usize = at::STEPS as usize;
/// Index of [`uprightness`], summed over the steps of ended episodes.
pub const UPRIGHTNESS: usize = at::UPRIGHTNESS as usize;

/// Names of the sums, in order.
pub const STATS: [&str; FIELDS - SUMS] = [
    "episodes",
    "successes",
    "steps",
    "returns",
    "fall",
    "uprightness",
];

/// The numbers of an environment's episode.
pub type Episode = [f32; FIELDS];

/// Queues the shader on `gpu`.
///
/// `state` is `[nq + nv][envs]`, `poses` `[bodies * 7][envs]` of that state, `episode`
/// `[FIELDS][envs]`; `reward` and `termination` take `[envs]` from `params.at` on, `ended` `[envs]`.
pub fn launch(
    gpu: &Gpu,
    state: &Buffer<f32>,
    poses: &Buffer<f32>,
    episode: &Buffer<f32>,
    reward: &Buffer<f32>,
    termination: &Buffer<u32>,
    ended: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::STAND_REWARD,
        groups(&shader::STAND_REWARD, params.envs as usize),
        &[state, poses, episode, reward, termination, ended],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    state: &[f32],
    poses: &[f32],
    episode: &mut [f32],
    reward: &mut [f32],
    termination: &mut [u32],
    ended: &mut [u32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let (mut q, mut v) = (vec![0.0; params.nq as usize], vec![0.0; params.nv as usize]);
    let mut own = [0.0; FIELDS];
    for env in 0..envs {
        gather(state, envs, env, 0, &mut q);
        gather(state, envs, env, q.len(), &mut v);
        gather(episode, envs, env, 0, &mut own);
        let (gain, end) = step(&q, &v, &poses_of(poses, envs, env), &mut own, params);
        scatter(episode, envs, env, 0, &own);
        reward[params.at as usize + env] = gain;
        termination[params.at as usize + env] = end;
        ended[env] = end;
    }
}

/// Reward and termination of a step that led to positions `q`, velocities `v` and `poses`.
pub fn step(
    q: &[f32],
    v: &[f32],
    poses: &[Pose],
    episode: &mut Episode,
    params: &Params,
) -> (f32, u32) {
    let diverged = has_diverged(q, v, params.max_speed);
    let (mut gain, mut upright) = (0.0, 0.0);
    if !diverged {
        upright = uprightness(poses[params.torso as usize].rotation);
        gain = params.alive_reward
            + params.upright_reward * upright
            + params.stillness_reward * stillness(v);
    }
    let [step, limit, ret, sum] =
        [at::STEP, at::LIMIT, at::RETURN, at::UPRIGHT].map(|k| k as usize);
    episode[step] += 1.0;
    episode[ret] += gain;
    episode[sum] += upright;
    let end = if diverged || has_fallen(poses, params) {
        FAILED
    } else if episode[step] >= episode[limit] {
        TRUNCATED
    } else {
        RUNNING
    };
    if end != RUNNING {
        finish(end, episode, params);
    }
    (gain, end)
}

/// How far the torso's up axis points up: 1 upright, -1 upside down.
pub fn uprightness(torso: Quat) -> f32 {
    1.0 - 2.0 * (torso.x * torso.x + torso.y * torso.y)
}

/// How little the joints move: 1 for those that stand still, falling with their mean square speed.
/// `v` is `[nv]`, the root's first.
pub fn stillness(v: &[f32]) -> f32 {
    let sum: f32 = v[6..].iter().map(|speed| speed * speed).sum();
    (-0.1 * sum / (v.len() - 6) as f32).exp()
}

/// Whether a part of the body is lower than it is when standing.
pub fn has_fallen(poses: &[Pose], params: &Params) -> bool {
    let height = |body: u32| poses[body as usize].position.z;
    let feet = [params.right_foot, params.left_foot];
    height(params.head) < params.min_head
        || height(params.pelvis) < params.min_pelvis
        || (0..params.bodies).any(|body| !feet.contains(&body) && height(body) < params.min_body)
}

/// Adds the episode to the sums and begins the next.
fn finish(end: u32, episode: &mut Episode, params: &Params) {
    let (running, sums) = episode.split_at_mut(SUMS);
    let ends = |by: u32| f32::from(u8::from(end == by));
    let own = [
        1.0,
        ends(TRUNCATED),
        running[at::STEP as usize],
        running[at::RETURN as usize],
        ends(FAILED),
        running[at::UPRIGHT as usize],
    ];
    for (sum, own) in sums.iter_mut().zip(own) {
        *sum += own;
    }
    running.copy_from_slice(&[0.0, params.max_steps as f32, 0.0, 0.0]);
}
