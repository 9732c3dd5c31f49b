//! Film strips of what a body does under different latents from the same start.

use super::latent_path::{LatentPath, SteeredDriver};
use super::strip::{PICTURES, Strip, times};
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::env::humanoid::fidelity::FidelityProbe;
use crate::env::humanoid::skills::settled_clip;
use crate::env::humanoid::task::DT;
use crate::env::humanoid::task::play::play_episodes;
use crate::gpu::Gpu;
use crate::kernels::termination::FAILED;
use crate::physics::motion_clip::MotionClip;
use crate::physics::motion_library::MotionLibrary;
use crate::report::ReportError;
use crate::report::canvas::{Anchor, Canvas, paint, text_width};
use crate::report::chart::{INK, MUTED};
use crate::train::body_episodes::BodyEpisodes;
use anyhow::{Context, Result, bail};
use std::path::Path;

/// Latents that are shown where clips have none.
const RANDOM: usize = 16;
/// Size of a picture, and the gap between two, pixels.
const SIZE: [u32; 2] = [150, 176];
const GAP: f64 = 3.0;
/// Height of the times above the pictures, and of letters, pixels.
const HEAD: f64 = 28.0;
const LETTERS: f64 = 17.0;
/// From the number of a strip to its words, and between their lines, pixels.
const INDENT: f64 = 30.0;
const LINE: f64 = 24.0;

/// A latent to be shown, and the clip whose latent it is, if it is one's.
pub struct ShownLatent {
    /// A vector of length 1.
    pub latent: Vec<f32>,
    /// The clip's name.
    pub clip: Option<String>,
}

/// The latents to be shown of a task: those of clips, the most frequent first, or random ones; none if it has none.
pub fn shown_latents(episodes: &BodyEpisodes) -> Vec<ShownLatent> {
    let (Some(draw), Some(library)) = (&episodes.latents, &episodes.recordings) else {
        return Vec::new();
    };
    let mut clips: Vec<(usize, &[f32])> = draw.clips().enumerate().collect();
    clips.sort_by(|(a, _), (b, _)| library.share(*b).total_cmp(&library.share(*a)));
    let own = clips.iter().map(|&(clip, latent)| ShownLatent {
        latent: latent.to_vec(),
        clip: Some(library.motions()[clip].name.clone()),
    });
    let any = |latent| ShownLatent { latent, clip: None };
    match clips.is_empty() {
        true => draw.any(RANDOM).into_iter().map(any).collect(),
        false => own.collect(),
    }
}

/// Draws a strip a latent, each from a time of the same episode on for so many seconds, with the name of the clip that
/// it is most like beside it.
///
/// # Errors
/// The file cannot be written, or the GPU was lost.
pub fn latent_strips(
    gpu: &Gpu,
    episodes: &BodyEpisodes,
    driver: &dyn BodyDriver,
    shown: &[ShownLatent],
    episode: u32,
    [start, seconds]: [f32; 2],
    path: &Path,
) -> Result<()> {
    let library = episodes.recordings.as_ref();
    let library = library.context("there are no recordings to compare with")?;
    let times: Vec<f32> = times([start, start + seconds]).collect();
    let mut rows = Vec::new();
    let mut strip = None;
    for (number, shown) in shown.iter().enumerate() {
        let played = PlayedLatent::new(episodes, library, driver, episode, &shown.latent);
        let first = || Strip::new(gpu, library.model(), played.motion.q(0), SIZE);
        let strip = strip.get_or_insert_with(first);
        let last = played.motion.seconds() + 0.5 * DT;
        let seen = times.iter().copied().filter(|time| *time <= last);
        let shots = strip.replayed(&played.motion, seen);
        let pictures: Result<Vec<_>> = shots.iter().map(|shot| strip.picture(shot)).collect();
        rows.push(StripRow {
            number: (number + 1).to_string(),
            words: played.words(shown),
            pictures: pictures?,
        });
    }
    if rows.iter().all(|row| row.pictures.is_empty()) {
        bail!("all episodes are over before {start} s: give an earlier --start");
    }
    Ok(draw(&rows, &times, path)?)
}

/// What a body does under one latent.
struct PlayedLatent<'a> {
    motion: MotionClip,
    /// The clip that it is most like; `None` if it falls at once.
    clip: Option<&'a str>,
    falls: bool,
}

impl<'a> PlayedLatent<'a> {
    fn new(
        episodes: &BodyEpisodes,
        library: &'a MotionLibrary,
        driver: &dyn BodyDriver,
        episode: u32,
        latent: &[f32],
    ) -> PlayedLatent<'a> {
        let mut envs = episodes.open(episode);
        let mut probe = FidelityProbe::new(library, &envs);
        let mut q = envs.batch.worlds[0].state.q.clone();
        let path = LatentPath::held(latent.to_vec());
        let steered = SteeredDriver {
            driver,
            path: &path,
        };
        let begin = DriverState::default();
        let found = play_episodes(&mut envs, &steered, begin, |envs, running, _| {
            probe.observe(envs, running);
            if running[0] {
                q.extend(&envs.batch.worlds[0].state.q);
            }
        });
        let clip = settled_clip(&probe.nearest_clips()[0]);
        PlayedLatent {
            motion: MotionClip::new("held", library.model(), 1.0 / DT, q),
            clip: clip.map(|clip| &*library.motions()[clip].name),
            falls: found.ends[0] == FAILED,
        }
    }

    /// What is written beside it.
    fn words(&self, shown: &ShownLatent) -> Vec<String> {
        let own = shown.clip.as_ref().map(|name| format!("latent of {name}"));
        let like = self.clip.map(|name| format!("moves like {name}"));
        let falls = self
            .falls
            .then(|| format!("falls after {:.1} s", self.motion.seconds()));
        own.into_iter().chain(like).chain(falls).collect()
    }
}

/// A strip with what is written beside it.
struct StripRow {
    number: String,
    words: Vec<String>,
    /// RGB.
    pictures: Vec<Vec<u8>>,
}

fn draw(rows: &[StripRow], times: &[f32], path: &Path) -> Result<(), ReportError> {
    let words = rows.iter().flat_map(|row| &row.words);
    let widths = words.map(|words| text_width(words, LETTERS));
    let widest = widths.collect::<Result<Vec<_>, _>>()?.into_iter();
    let left = widest.fold(0.0, f64::max) + 2.0 * INDENT;
    let [width, height] = SIZE.map(|side| f64::from(side) + GAP);
    let total = [
        left + width * PICTURES as f64,
        HEAD + height * rows.len() as f64,
    ];
    let [total_width, total_height] = total.map(|side| (side - GAP).ceil() as u32);
    paint(path, total_width, total_height, |canvas| {
        for (column, time) in times.iter().enumerate() {
            let at = (
                left + width * column as f64 + 0.5 * f64::from(SIZE[0]),
                0.5 * HEAD,
            );
            canvas.text(&format!("{time:.1} s"), at, Anchor::Centre, LETTERS, MUTED)?;
        }
        for (index, row) in rows.iter().enumerate() {
            let top = HEAD + height * index as f64;
            beside(canvas, row, top + 0.5 * height)?;
            for (column, picture) in row.pictures.iter().enumerate() {
                let corner = (left + width * column as f64, top);
                canvas.picture(corner, SIZE[0] as usize, picture)?;
            }
        }
        Ok(())
    })
}

/// Writes what is to be read beside a strip, about a height.
fn beside(canvas: &mut Canvas, row: &StripRow, middle: f64) -> Result<(), ReportError> {
    canvas.text(
        &row.number,
        (0.5 * INDENT, middle),
        Anchor::Centre,
        1.4 * LETTERS,
        INK,
    )?;
    let first = middle - 0.5 * LINE * row.words.len().saturating_sub(1) as f64;
    for (line, words) in row.words.iter().enumerate() {
        let at = (INDENT + 0.3 * INDENT, first + LINE * line as f64);
        canvas.text(
            words,
            at,
            Anchor::Left,
            LETTERS,
            if line == 0 { INK } else { MUTED },
        )?;
    }
    Ok(())
}
