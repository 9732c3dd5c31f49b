//! A simulated body under a policy, step by step, for somebody to watch and to push.

use super::latent_path::{LatentPath, SteeredDriver};
use super::own_fighter::OwnFighter;
use super::reference::Reference;
use crate::container::Section;
use crate::env::VecEnv;
use crate::env::humanoid::boxing::bout::{Bout, tally};
use crate::env::humanoid::boxing::command::FightCommand;
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::env::humanoid::task::CpuHumanoidEnv;
use crate::env::humanoid::task::play::DrivenStep;
use crate::gpu::Array;
use crate::kernels::humanoid::end_episode::LIMIT;
use crate::kernels::termination;
use crate::physics::collision::MAX_POINTS;
use crate::physics::model::Model;
use crate::physics::simulator::Simulator;
use crate::train::body_episodes::BodyEpisodes;
use crate::train::body_policy::BodyPolicy;
use anyhow::Result;
use glam::Vec3;

/// What all playthroughs of a task share.
pub struct BodyContext {
    episodes: BodyEpisodes,
    /// An environment of the episode `opened`; every moment puts its own state into it.
    env: CpuHumanoidEnv,
    opened: u32,
    /// Who obeys commands, if it is a bout.
    fighter: Option<OwnFighter>,
    /// What the body is to move like, if there are recordings.
    pub reference: Option<Reference>,
}

impl BodyContext {
    /// The context of a task's episodes.
    pub fn new(episodes: BodyEpisodes) -> BodyContext {
        BodyContext {
            env: episodes.open(0),
            opened: 0,
            fighter: episodes
                .bouts
                .is_some()
                .then(|| OwnFighter::new(episodes.open(0), None)),
            reference: episodes.recordings.as_ref().map(Reference::new),
            episodes,
        }
    }

    /// Lets somebody else obey commands.
    pub fn with_fighter(self, fighter: OwnFighter) -> BodyContext {
        BodyContext {
            fighter: Some(fighter),
            ..self
        }
    }

    /// Whose playthroughs they are.
    pub fn episodes(&self) -> &BodyEpisodes {
        &self.episodes
    }

    /// What is simulated.
    pub fn model(&self) -> &Model {
        self.env.task().model()
    }

    /// An environment of an episode, in whatever state.
    fn env(&mut self, episode: u32) -> &mut CpuHumanoidEnv {
        if self.opened != episode {
            self.env = self.episodes.open(episode);
            self.opened = episode;
        }
        &mut self.env
    }
}

/// A force on a body that lasts a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPush {
    /// Number of the body.
    pub body: usize,
    /// At its centre of mass, N.
    pub force: Vec3,
}

/// The force between two shapes that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchForce {
    /// Its centre, m.
    pub at: Vec3,
    /// Of the ground on a body, or of a body on another, N.
    pub force: Vec3,
}

/// A body at one moment, and all that decides the next ones. Coordinates are the simulation's.
#[derive(Clone)]
pub struct BodyPlaythrough {
    /// Number of the evaluation episode, the same for every policy.
    pub episode: u32,
    /// Steps of it so far.
    pub steps: usize,
    /// Positions, `[nq]`.
    pub q: Vec<f32>,
    /// Reward of the last step.
    pub reward: f32,
    /// Style reward of the last step, where there is a discriminator.
    pub style: Option<f32>,
    /// Forces at the end of the last step.
    pub touching: Vec<TouchForce>,
    /// Somebody's push in the last step.
    pub push: Option<BodyPush>,
    /// The frame of [`BodyContext::reference`] that it is nearest to.
    pub reference: Option<usize>,
    /// Positions at which it should be, if the task says so.
    pub wanted: Option<Vec<f32>>,
    /// How the bout stands, if it is one.
    pub bout: Option<Bout>,
    /// What somebody tells red to do in the next step; `None` where the policy fights for itself.
    pub command: Option<FightCommand>,
    /// The latents that somebody wants; `None` where they change as in training.
    pub path: Option<LatentPath>,
    /// `[rows][observation]`
    observation: Vec<f32>,
    state: Section,
    driver: DriverState,
    /// What the driver remembers of who obeys commands, if that has its own.
    own_driver: DriverState,
}

impl BodyPlaythrough {
    /// The start of an evaluation episode, which lasts until it ends otherwise than by its length.
    ///
    /// # Errors
    /// None: the environment is on the host.
    pub fn new(context: &mut BodyContext, episode: u32) -> Result<BodyPlaythrough> {
        context.env = context.episodes.open(episode);
        context.opened = episode;
        let agents = context.env.episodes.iter_mut();
        agents.for_each(|episode| episode[LIMIT] = f32::MAX);
        let rows = context.env.spec().rows();
        let mut first = BodyPlaythrough {
            episode,
            steps: 0,
            q: Vec::new(),
            reward: 0.0,
            style: None,
            touching: Vec::new(),
            push: None,
            reference: None,
            wanted: None,
            bout: context.episodes.bouts.as_ref().map(|_| Bout::default()),
            command: None,
            path: None,
            observation: vec![0.0; rows * context.env.spec().observation.dim()],
            state: Section::default(),
            driver: DriverState::default(),
            own_driver: DriverState::default(),
        };
        first.take(&mut context.env)?;
        first.follow(context);
        Ok(first)
    }

    /// The moment a step, a thirtieth of a second, later. After an episode's end that is the start of the
    /// next.
    ///
    /// # Errors
    /// None: the environment is on the host.
    pub fn next(
        &self,
        context: &mut BodyContext,
        policy: &BodyPolicy,
        push: Option<BodyPush>,
    ) -> Result<BodyPlaythrough> {
        let env = context.env(self.episode);
        env.load(&mut self.state.clone())?;
        if let Some(push) = push {
            env.batch.worlds[0].external_forces[push.body].linear += push.force;
        }
        let mut step = DrivenStep::new(env);
        let mut next = BodyPlaythrough {
            steps: self.steps + 1,
            push,
            ..self.clone()
        };
        next.act(context, &mut step, &*policy.driver);
        if step.ends.host()[0] != termination::RUNNING {
            return self.begin_next(context);
        }
        let BodyContext { env, episodes, .. } = context;
        next.reward = step.reward.host()[0];
        next.touching = touching(env);
        if let (Some(bout), Some(task)) = (&self.bout, &episodes.bouts) {
            next.bout = Some(bout.next(task, &env.batch.worlds[0], &env.task_states[0]));
        }
        next.take(env)?;
        let style = env.spec().style;
        let moments = [&self.observation[..style], &next.observation[..style]];
        let discriminator = policy.discriminator.as_ref();
        let latents = match next.obeys_own_driver(context) {
            true => &next.own_driver.latents,
            false => &next.driver.latents,
        };
        next.style = discriminator.map(|discriminator| discriminator.reward(moments, latents));
        next.follow(context);
        Ok(next)
    }

    /// Plays a step of the context's environment: under a command, on a way of latents, or under the driver alone.
    fn act(&mut self, context: &mut BodyContext, step: &mut DrivenStep, driver: &dyn BodyDriver) {
        let BodyContext { env, fighter, .. } = context;
        let state = &mut self.driver;
        match (&self.command, fighter, &self.path) {
            (Some(command), Some(fighter), _) => {
                let world = &env.batch.worlds[0].state;
                let (q, v) = (world.q.clone(), world.v.clone());
                let states = [state, &mut self.own_driver];
                step.play_by(env, |seen| {
                    fighter.act(command, [&q, &v], seen, driver, states)
                });
            }
            (_, _, Some(path)) => step.play(env, &SteeredDriver { driver, path }, state),
            (_, _, None) => step.play(env, driver, state),
        }
    }

    /// Tells red what to do, or, with `None`, lets the policy go on.
    pub fn obey(&mut self, command: Option<FightCommand>) {
        if self.command.is_none() {
            self.own_driver = DriverState::default();
        }
        self.command = command;
    }

    /// Whether red is moved by a driver of its own.
    fn obeys_own_driver(&self, context: &BodyContext) -> bool {
        let fighter = context.fighter.as_ref();
        self.command.is_some() && fighter.is_some_and(OwnFighter::has_driver)
    }

    /// The start of the next episode; what somebody wants stays.
    ///
    /// # Errors
    /// None: the environment is on the host.
    pub fn next_episode(&self, context: &mut BodyContext) -> Result<BodyPlaythrough> {
        let env = context.env(self.episode);
        env.load(&mut self.state.clone())?;
        self.begin_next(context)
    }

    /// The start of the next episode, after the step of the context's environment that may have ended one.
    fn begin_next(&self, context: &mut BodyContext) -> Result<BodyPlaythrough> {
        let path = self.path.as_ref();
        let over = |bout: &Bout| bout.over(&tally(&context.env));
        let bout = self.bout.as_ref().map(over);
        Ok(BodyPlaythrough {
            bout,
            command: self.command,
            path: path.map(|path| LatentPath::held(path.end().to_vec())),
            ..BodyPlaythrough::new(context, self.episode + 1)?
        })
    }

    /// The latent of the last step; empty before the first, or where there are none.
    pub fn latent(&self) -> &[f32] {
        &self.driver.latents
    }

    /// Goes to a latent in so many steps, and holds it.
    pub fn hold(&mut self, latent: Vec<f32>, steps: usize) {
        let present = &self.driver.latents;
        self.path = Some(match present.is_empty() {
            true => LatentPath::held(latent),
            false => LatentPath::new(present.clone(), latent, self.driver.steps, steps),
        });
    }

    /// Puts the target elsewhere on the ground, m, if the task has one.
    ///
    /// # Errors
    /// None: the environment is on the host.
    pub fn move_target(&mut self, context: &mut BodyContext, at: [f32; 2]) -> Result<()> {
        let env = context.env(self.episode);
        env.load(&mut self.state)?;
        env.move_target(0, at);
        self.take(env)
    }

    /// Takes over an environment's state.
    fn take(&mut self, env: &mut CpuHumanoidEnv) -> Result<()> {
        self.q.clone_from(&env.batch.worlds[0].state.q);
        let mut observation = Array::Host(std::mem::take(&mut self.observation));
        env.observe(&mut observation, 0);
        self.observation = observation.host().to_vec();
        let wanted = env.task().wanted(&env.task_states[0]);
        self.wanted = wanted.map(<[f32]>::to_vec);
        self.state = Section::default();
        env.save(&mut self.state)
    }

    fn follow(&mut self, context: &BodyContext) {
        let reference = context.reference.as_ref();
        self.reference =
            reference.map(|reference| reference.follow(self.reference, &self.observation));
    }
}

/// The forces of the last step of the physics, one for every two shapes that touch.
fn touching(env: &mut CpuHumanoidEnv) -> Vec<TouchForce> {
    let mut found = [Vec::new()];
    env.batch.each(&mut found, |_, simulator, _, found| {
        *found = touch_forces(simulator);
    });
    let [found] = found;
    found
}

fn touch_forces(simulator: &Simulator) -> Vec<TouchForce> {
    let contacts = &simulator.contacts;
    let points: Vec<(u32, Vec3, Vec3)> = (contacts.ids.iter().zip(&contacts.points))
        .zip(simulator.contact_forces())
        .map(|((id, point), force)| (id / MAX_POINTS as u32, point.position, force))
        .collect();
    let of_pair = |points: &[(u32, Vec3, Vec3)]| {
        let weight = |force: Vec3| force.length() + f32::MIN_POSITIVE;
        let total: f32 = points.iter().map(|(_, _, force)| weight(*force)).sum();
        let centre: Vec3 = points
            .iter()
            .map(|(_, at, force)| *at * weight(*force))
            .sum();
        TouchForce {
            at: centre / total,
            force: points.iter().map(|(_, _, force)| *force).sum(),
        }
    };
    let pairs = points.chunk_by(|a, b| a.0 == b.0);
    pairs.map(of_pair).collect()
}
