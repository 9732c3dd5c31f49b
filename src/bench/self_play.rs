//! Bouts of boxing against one policy and against several: a step of all environments, opponents and physics together.

use super::clock::{MAX_CALL_S, seconds};
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::BenchContext;
use crate::env::VecEnv;
use crate::env::humanoid::boxing::{Boxing, BoxingTask};
use crate::env::humanoid::task::{EpisodeRules, open};
use crate::gpu::Array;
use crate::motion::synthetic::perform_boxing;
use crate::nn::Policy;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::rl::rollout::Rollout;
use crate::rl::self_play::{Pool, SelfPlay, SelfPlayEnv};
use crate::train::config::Preset;
use crate::train::tasks::find;
use anyhow::Result;
use std::sync::Arc;

/// Environments of a batch: the constraints of more need buffers of over 128 MiB, which not every device has.
const ENVS: [usize; 2] = [128, 512];
/// Policies of a pool.
const POOLS: [(&str, usize); 2] = [("one opponent", 1), ("four opponents", 4)];
/// Length of a bout, s, and steps until every environment has met somebody of the pool.
const BOUT_S: f32 = 0.4;
const WARM_UP: usize = 13;

/// Measures rising numbers of environments.
pub fn measure(context: &BenchContext, record: &mut Recorder) -> Result<()> {
    if !context.plan.selects("self_play") {
        return Ok(());
    }
    let (clips, roles) = perform_boxing(1, 0.5);
    let model = Arc::new(scenes::humanoid());
    let library = Arc::new(MotionLibrary::of(&clips, &roles, &model)?);
    let boxing = Boxing {
        rules: EpisodeRules {
            episode_s: BOUT_S,
            ..EpisodeRules::default()
        },
        ..Boxing::default()
    };
    let task = Arc::new(BoxingTask::new(&boxing, &library, 1));
    let mut last = 0.0;
    for envs in ENVS {
        if 4.0 * last > MAX_CALL_S {
            break;
        }
        for (variant, policies) in POOLS {
            last = steps(context, &task, envs, (variant, policies), record)?;
        }
    }
    Ok(())
}

/// Measures steps against so many policies and returns the seconds of one.
fn steps(
    context: &BenchContext,
    task: &Arc<BoxingTask>,
    envs: usize,
    (variant, policies): (&str, usize),
    record: &mut Recorder,
) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *context;
    (record.tell)(&format!("{}: {envs} bouts, {variant}", on.name()));
    let device = &on.device;
    let time = on.install(|| -> Result<f64> {
        let inner = open(device, task.clone(), 0..envs, 1)?;
        let mut bouts = SelfPlayEnv::new(inner, device, 0, 1)?;
        bouts.set_opponents(&Arc::new(pool(&bouts, policies)?.opponents()))?;
        let mut played = Rollout::new(device, bouts.spec(), 1, 1);
        let rest = bouts.rest_action().repeat(envs);
        played.action = Array::from_slice(device, &rest);
        let mut step = || {
            played.observe(&mut bouts, 0);
            played.step(&mut bouts, 0);
        };
        for _ in 0..WARM_UP {
            step();
            device.pace()?;
        }
        seconds(on, || {
            step();
            Ok(())
        })
    })?;
    let workload = Workload {
        stage: "self_play",
        variant,
        frames: 0,
        envs,
        batch: envs,
        bytes: None,
        cost: ItemCost::default(),
    };
    record.add(on, roofline, workload, time);
    Ok(time)
}

/// A pool of untrained policies of the task's networks.
fn pool(bouts: &dyn VecEnv, policies: usize) -> Result<Pool> {
    let ppo = find("box")?.config(Preset::Fast).ppo;
    let spec = bouts.spec();
    let policy = |seed: u32| -> Result<Policy> {
        let (observation, action) = (&spec.observation, spec.action);
        let mut policy = Policy::new(&ppo.network, observation, action, 1)?;
        let networks = policy.networks();
        policy.parameters = networks.init(seed, ppo.init_log_std, &bouts.rest_action());
        Ok(policy)
    };
    let chosen = SelfPlay {
        pool: policies,
        ..SelfPlay::default()
    };
    let mut pool = Pool::new(&chosen, Vec::new(), policy(0)?);
    for seed in 1..policies as u32 {
        pool.admit(policy(seed)?);
    }
    Ok(pool)
}
