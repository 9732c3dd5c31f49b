//! Ends episodes, and sums them up. Shader: `shaders/humanoid/end_episode.wgsl`.

use super::fallen::{FallRules, has_fallen};
use crate::gpu::shader::end_episode::constants as at;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::reset_worlds::has_diverged;
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::termination::{FAILED, LEADS, RUNNING, TRUNCATED};
use crate::physics::pose::Pose;

crate::shader_params! {
    pub struct Params for end_episode {
        /// Environments of the batch.
        pub envs: u32,
        /// Agents of an environment.
        pub agents: u32,
        /// Index of the step's first reward and termination.
        pub at: u32,
        /// Positions of a world.
        pub nq: u32,
        /// Velocities of a world.
        pub nv: u32,
        /// Bodies of an agent; the agents' come first in a world.
        pub bodies: u32,
        /// Index of the first agent's head.
        pub head: u32,
        /// Index of the first agent's pelvis.
        pub pelvis: u32,
        /// Index of the first agent's right foot.
        pub right_foot: u32,
        /// Index of the first agent's left foot.
        pub left_foot: u32,
        /// Numbers that the task measures of a step.
        pub measures: u32,
        /// Steps of an episode.
        pub max_steps: u32,
        /// Ends that are successes, `1 << end`.
        pub successes: u32,
        /// 1 if a fall ends the episode, whatever the task says.
        pub falls_end: u32,
        /// Height of the head below which the character has fallen, m.
        pub min_head: f32,
        /// Height of the pelvis below which the character has fallen, m.
        pub min_pelvis: f32,
        /// Height of any body but the feet below which the character has fallen, m.
        pub min_body: f32,
        /// m/s and rad/s; what is faster has diverged.
        pub max_speed: f32,
    }
}

impl Params {
    fn fall_rules(&self) -> FallRules {
        FallRules {
            bodies: self.bodies,
            head: self.head,
            pelvis: self.pelvis,
            feet: [self.right_foot, self.left_foot],
            min_head: self.min_head,
            min_pelvis: self.min_pelvis,
            min_body: self.min_body,
        }
    }
}

/// Index of the steps of the running episode.
pub const STEP: usize = at::STEP as usize;
/// Index of the steps after which it is truncated.
pub const LIMIT: usize = at::LIMIT as usize;
/// Index of its return.
pub const RETURN: usize = at::RETURN as usize;
/// Fields of the running episode before its measures.
pub const RUNNING_FIELDS: usize = at::RUNNING_FIELDS as usize;
/// Sums before those of the measures.
pub const SUM_FIELDS: usize = at::SUM_FIELDS as usize;

/// Index of the first sum of a task with so many measures.
pub fn sums_at(measures: usize) -> usize {
    RUNNING_FIELDS + measures
}

/// Numbers of an agent's episode and its sums, of a task with so many measures.
pub fn fields(measures: usize) -> usize {
    RUNNING_FIELDS + SUM_FIELDS + 2 * measures
}

/// Queues the shader on `gpu`.
///
/// Rows are agents, those of an environment side by side. `state` is `[nq + nv][envs]`, `poses`
/// `[bodies * 7][envs]` of that state, `measures` `[measures][rows]`, `task_end` `[rows]`, `episode`
/// `[fields][rows]`, see [`fields`]; `reward` and `termination` are `[rows]` from `params.at` on, `ended` is
/// `[envs]`. An episode must end for all agents of an environment at once: a task of several sees to that.
pub fn launch(
    gpu: &Gpu,
    state: &Buffer<f32>,
    poses: &Buffer<f32>,
    measures: &Buffer<f32>,
    task_end: &Buffer<u32>,
    episode: &Buffer<f32>,
    reward: &Buffer<f32>,
    termination: &Buffer<u32>,
    ended: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::END_EPISODE,
        groups(&shader::END_EPISODE, params.envs as usize),
        &[
            state,
            poses,
            measures,
            task_end,
            episode,
            reward,
            termination,
            ended,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    state: &[f32],
    poses: &[f32],
    measures: &[f32],
    task_end: &[u32],
    episode: &mut [f32],
    reward: &mut [f32],
    termination: &mut [u32],
    ended: &mut [u32],
    params: &Params,
) {
    let (envs, agents) = (params.envs as usize, params.agents as usize);
    let (rows, count) = (envs * agents, params.measures as usize);
    let (mut q, mut v) = (vec![0.0; params.nq as usize], vec![0.0; params.nv as usize]);
    let (mut own, mut measured) = (vec![0.0; fields(count)], vec![0.0; count]);
    for (row, &task_end) in task_end.iter().enumerate().take(rows) {
        let (env, agent) = (row / agents, row % agents);
        gather(state, envs, env, 0, &mut q);
        gather(state, envs, env, q.len(), &mut v);
        gather(measures, rows, row, 0, &mut measured);
        gather(episode, rows, row, 0, &mut own);
        let at = params.at as usize + row;
        let step = EpisodeStep {
            q: &q,
            v: &v,
            poses: &poses_of(poses, envs, env)[agent * params.bodies as usize..],
            measures: &measured,
            task_end,
        };
        let end = end(&step, &mut reward[at], &mut own, params);
        scatter(episode, rows, row, 0, &own);
        (termination[at], ended[env]) = (end, end);
    }
}

/// A step of one agent.
pub struct EpisodeStep<'a> {
    /// Positions of its world after it.
    pub q: &'a [f32],
    /// Velocities of its world after it.
    pub v: &'a [f32],
    /// Poses after it, the agent's bodies first.
    pub poses: &'a [Pose],
    /// What the task measured of it.
    pub measures: &'a [f32],
    /// How it ends for the task, [`LEADS`] added if the agent does.
    pub task_end: u32,
}

/// How a step ends; `episode`, `[fields]`, takes it in.
pub fn end(step: &EpisodeStep, reward: &mut f32, episode: &mut [f32], params: &Params) -> u32 {
    let diverged = has_diverged(step.q, step.v, params.max_speed);
    episode[STEP] += 1.0;
    if diverged {
        *reward = 0.0;
    } else {
        episode[RETURN] += *reward;
        let sums = episode[RUNNING_FIELDS..].iter_mut();
        sums.zip(step.measures).for_each(|(sum, own)| *sum += own);
    }
    let (task_end, leads) = (step.task_end % LEADS, step.task_end >= LEADS);
    let falls = params.falls_end == 1 && has_fallen(step.poses, &params.fall_rules());
    let end = if diverged || falls {
        FAILED
    } else if task_end != RUNNING {
        task_end
    } else if episode[STEP] >= episode[LIMIT] {
        TRUNCATED
    } else {
        RUNNING
    };
    if end != RUNNING {
        // Who has failed has won nothing.
        let success = params.successes >> end & 1 == 1 || (leads && end != FAILED);
        finish(end, success, episode, params);
    }
    end
}

/// Begins an episode, of which nothing has been played.
pub fn begin(episode: &mut [f32], params: &Params) {
    episode[..sums_at(params.measures as usize)].fill(0.0);
    episode[LIMIT] = params.max_steps as f32;
}

/// Adds the episode to the sums and begins the next.
fn finish(end: u32, success: bool, episode: &mut [f32], params: &Params) {
    let (running, sums) = episode.split_at_mut(sums_at(params.measures as usize));
    let (step, episode_return) = (running[STEP], running[RETURN]);
    let own = [
        1.0,
        f32::from(u8::from(success)),
        step,
        episode_return,
        f32::from(u8::from(end == FAILED)),
    ];
    let own = own.iter().chain(&running[RUNNING_FIELDS..]);
    sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
    begin(episode, params);
}
