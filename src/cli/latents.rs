//! What `footwork render` can show of latents.

use super::Usage;
use anyhow::Result;
use clap::Args;
use footwork::train::body_episodes::BodyEpisodes;
use footwork::train::task::Unsupported;
use footwork::view::latent_path::LatentPath;
use footwork::view::latent_strips::{ShownLatent, shown_latents};

/// Most strips of a picture.
const MOST: usize = 16;

/// Under which latents a body is shown.
pub enum ChosenLatents {
    /// They change as in training, if there are any.
    AsTrained,
    /// A strip each.
    Strips(Vec<ShownLatent>),
    /// From one to another.
    Path(LatentPath),
}

#[derive(Args)]
pub struct LatentOptions {
    /// Draw film strips of so many latents of a run of `skills` (8, say), one under another, each held from the same
    /// start on; those of clips, the most frequent first
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    latents: Option<usize>,
    /// Draw the way from the latent of this number in that picture to another, along the great circle
    #[arg(long, value_name = "A,B", value_parser = pair, allow_hyphen_values = true, conflicts_with = "latents")]
    interpolate: Option<[usize; 2]>,
}

fn pair(text: &str) -> Result<[usize; 2], String> {
    let numbers = text.split_once(',');
    let numbers = numbers.and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    numbers.ok_or_else(|| "two numbers of strips that --latents draws, like 1,3".into())
}

impl LatentOptions {
    /// Refuses impossible options before anything is opened.
    pub fn check(&self, is_png: bool) -> Result<()> {
        let usage = |why: String| Err(Usage(why).into());
        match (self.latents, self.interpolate) {
            (Some(count), _) if !(1..=MOST).contains(&count) => {
                usage(format!("--latents must be from 1 to {MOST}"))
            }
            (Some(_), _) if !is_png => {
                usage("--latents draws one picture: --out must end in .png".into())
            }
            (_, Some([a, b])) if a == b => {
                usage("--interpolate goes from one latent to another: give two numbers".into())
            }
            _ => Ok(()),
        }
    }

    /// What is asked for of a run of `task`. A way between latents begins at a step of the episode and takes so many.
    pub fn choose(
        &self,
        task: &str,
        episodes: Option<&BodyEpisodes>,
        [begin, steps]: [usize; 2],
    ) -> Result<ChosenLatents> {
        if self.latents.is_none() && self.interpolate.is_none() {
            return Ok(ChosenLatents::AsTrained);
        }
        let mut shown = episodes.map_or_else(Vec::new, shown_latents);
        let most = shown.len();
        if most == 0 {
            let why = "--latents and --interpolate show runs of the task `skills`";
            return Err(Unsupported(format!("{why}: `{task}` has no latents")).into());
        }
        if let Some(ends) = self.interpolate {
            let [from, to] = ends.map(|number| shown.get(number.wrapping_sub(1)));
            let (Some(from), Some(to)) = (from, to) else {
                let why = format!("--interpolate takes the numbers of --latents, from 1 to {most}");
                return Err(Usage(why).into());
            };
            let (from, to) = (from.latent.clone(), to.latent.clone());
            return Ok(ChosenLatents::Path(LatentPath::new(from, to, begin, steps)));
        }
        let count = self.latents.unwrap_or(most);
        if count > most {
            let why = format!("--latents must be from 1 to {most}, the number of the run's clips");
            return Err(Usage(why).into());
        }
        shown.truncate(count);
        Ok(ChosenLatents::Strips(shown))
    }
}
