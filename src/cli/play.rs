//! `footwork play`.

use super::Usage;
use super::run::{Moved, Run};
use super::say::tell;
use anyhow::Result;
use clap::Args;
use footwork::env::locomotion::{LocomotionTask, Plane};
use footwork::gpu::Gpu;
use footwork::motion::normalise::Weights;
use footwork::playback::player::Style;
use footwork::train::body_policy::BodyPolicy;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::controller::Controller;
use footwork::train::data;
use footwork::train::playthrough::PlaythroughContext;
use footwork::view::body_playthrough::BodyContext;
use footwork::view::own_fighter::OwnFighter;
use footwork::viewer::policies::PolicyEntry;
use footwork::viewer::window;
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Args)]
pub struct Play {
    /// A run's folder, or one of its checkpoints; without it, motion alone is looked at
    #[arg(required_unless_present = "data")]
    run: Option<PathBuf>,
    /// Motion to browse and to steer by hand; with RUN, where the run's motion is now
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
    /// Where the low level is now that the run steers, if it has been moved
    #[arg(long, value_name = "RUN", requires = "run")]
    skills: Option<PathBuf>,
    /// Whose policy moves you where you fight in a bout of RUN: a run of `punch`, `joystick` or `box` over the same low
    /// level; without it, RUN's own
    #[arg(long, value_name = "RUN", requires = "run")]
    fighter: Option<PathBuf>,
}

impl Play {
    pub fn run(self) -> Result<()> {
        match &self.run {
            Some(run) => self.policy(run),
            None => self.motion(),
        }
    }

    fn policy(&self, run: &std::path::Path) -> Result<()> {
        let moved = Moved {
            data: self.data.as_deref(),
            skills: self.skills.as_deref(),
        };
        let run = Arc::new(Run::open(run, moved)?);
        run.checkpoint(&run.path)?;
        let fighter = self.fighter.as_ref();
        let fighter = fighter.map(|own| fighter_for(&run, &Run::open(own, moved)?));
        let fighter = fighter.transpose()?;
        let title = format!("footwork: {}", run.folder.path().display());
        if let Some(body) = run.task.body() {
            let policies = policies(&run, |run, of| BodyPolicy::new(of, &run.config, &*run.task))?;
            let mut context = BodyContext::new(body);
            if let Some(fighter) = fighter {
                context = context.with_fighter(fighter);
            }
            return window::play_body(&Gpu::drawing()?, &title, context, policies);
        }
        let locomotion = run.locomotion("play")?;
        let (matcher, task) = (locomotion.matcher.clone(), locomotion.task);
        let policies = policies(&run, |_, of| Ok(Box::new(of.policy) as Box<dyn Controller>))?;
        let context = PlaythroughContext::new(matcher, task, Style::BEST);
        window::play(&Gpu::drawing()?, &title, context, policies)
    }

    fn motion(&self) -> Result<()> {
        let (matcher, notes) = data::load_matcher(self.data.as_deref(), Weights::PAPER)?;
        for note in notes {
            tell!("note: {note}");
        }
        // Steered by hand, the character never arrives.
        let task = LocomotionTask::Plane(Plane {
            success_radius: 0.0,
            ..Plane::default()
        });
        let context = PlaythroughContext::new(Arc::new(matcher), task, Style::BEST);
        window::play(&Gpu::drawing()?, "footwork", context, Vec::new())
    }
}

/// Who obeys commands in the bouts of a run, moved by the policy of another one.
fn fighter_for(run: &Run, own: &Run) -> Result<OwnFighter> {
    let refused = |why: String| Err(Usage(why).into());
    let [run_path, own_path] = [run, own].map(|run| run.folder.path().display());
    let [run_task, own_task] = [run, own].map(|run| &run.config.task.name);
    if run.task.bouts().is_none() {
        return refused(format!(
            "{run_path} is a run of `{run_task}`, in which nobody fights: --fighter is for runs of `box`"
        ));
    }
    let env = own.task.body().map(|body| body.open(0));
    let Some(env) = env.filter(|env| env.task().model().trees.len() > 1) else {
        return refused(format!(
            "{own_path} is a run of `{own_task}`, which has learned to go to nobody: --fighter takes a run of `punch`, \
             `joystick` or `box`"
        ));
    };
    if own.task.fingerprint().low_level != run.task.fingerprint().low_level {
        return refused(format!(
            "{own_path} moves by another low level than {run_path}: --fighter takes a run that was trained with the same \
             --skills"
        ));
    }
    let policy = own.checkpoint(&own.path)?.policy;
    let driver = own.task.driver(&policy);
    Ok(OwnFighter::new(env, Some(driver.into())))
}

/// A run's checkpoints, of each of which `load` makes a policy. The requested one is the last: it is shown
/// first.
fn policies<P: 'static>(
    run: &Arc<Run>,
    load: fn(&Run, Checkpoint) -> Result<P>,
) -> Result<Vec<PolicyEntry<P>>> {
    let mut paths = run.folder.checkpoint_files()?;
    paths.retain(|other| other.file_name() != run.path.file_name());
    paths.push(run.path.clone());
    let entry = |path: PathBuf| {
        let name = path.file_stem().unwrap_or_default();
        let (name, run) = (name.to_string_lossy().into(), run.clone());
        let load = move || load(&run, run.checkpoint(&path)?);
        PolicyEntry {
            name,
            load: Box::new(load) as Box<dyn Fn() -> Result<P>>,
        }
    };
    Ok(paths.into_iter().map(entry).collect())
}
