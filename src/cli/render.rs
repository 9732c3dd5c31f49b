//! `footwork render`.

use super::Usage;
use super::latents::{ChosenLatents, LatentOptions};
use super::run::{MovedFiles, Run};
use super::say::say;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use footwork::env::humanoid::driver::BodyDriver;
use footwork::gpu::Gpu;
use footwork::playback::player::Style;
use footwork::playback::stitch::Stitching;
use footwork::train::body_episodes::BodyEpisodes;
use footwork::train::playthrough::PlaythroughContext;
use footwork::view::Camera;
use footwork::view::body_film::BodyFilm;
use footwork::view::film::{Film, RATE};
use footwork::view::image_files::{self, Output};
use footwork::view::latent_path::SteeredDriver;
use footwork::view::latent_strips::latent_strips;
use footwork::view::locomotion_film::LocomotionFilm;
use footwork::view::recorded_bout::recorded_episode;
use footwork::view::strip::film_strip;
use indicatif::ProgressIterator;
use std::path::PathBuf;

#[derive(Args)]
pub struct Render {
    /// A run's folder, whose last checkpoint is shown, or one of its checkpoints
    run: PathBuf,
    /// FILE.png for one picture (of a simulated body: a film strip of --seconds), FILE.gif for an animation, a
    /// folder's name for PNG frames
    #[arg(short, long, value_name = "FILE|DIR")]
    out: PathBuf,
    /// Write over what is there
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    files: MovedFiles,
    /// Which of the evaluation's episodes
    #[arg(
        long,
        default_value_t = 0,
        value_name = "N",
        allow_negative_numbers = true
    )]
    episode: usize,
    /// Time of the first picture, s
    #[arg(
        long,
        default_value_t = 0.8,
        value_name = "SECONDS",
        allow_negative_numbers = true
    )]
    start: f32,
    /// Length of an animation, s
    #[arg(
        long,
        default_value_t = 6.0,
        value_name = "SECONDS",
        allow_negative_numbers = true
    )]
    seconds: f32,
    /// Pictures a second of an animation: 30 or a whole part of it
    #[arg(long, default_value_t = RATE, value_name = "N", allow_negative_numbers = true)]
    rate: u32,
    /// Pixels
    #[arg(long, default_value = "640x360", value_name = "WIDTHxHEIGHT", value_parser = size, allow_hyphen_values = true)]
    size: [u32; 2],
    /// Rotation of the camera around the character, degrees
    #[arg(
        long,
        default_value_t = 40.0,
        value_name = "DEGREES",
        allow_negative_numbers = true
    )]
    yaw: f32,
    /// Height of the camera, degrees above the ground
    #[arg(
        long,
        default_value_t = 16.0,
        value_name = "DEGREES",
        allow_negative_numbers = true
    )]
    pitch: f32,
    /// From the camera to the character, m
    #[arg(
        long,
        default_value_t = 5.5,
        value_name = "METRES",
        allow_negative_numbers = true
    )]
    distance: f32,
    /// How the motion is blended where a match jumps to another frame
    #[arg(long, value_enum, default_value_t = Blend::Inertialize)]
    blend: Blend,
    #[command(flatten)]
    latents: LatentOptions,
}

#[derive(Clone, Copy, ValueEnum)]
enum Blend {
    /// The pose jumps at every match
    None,
    /// The paper's simple stitching: a difference that vanishes linearly; feet locked
    Linear,
    /// Inertialization; feet locked
    Inertialize,
}

impl Blend {
    fn style(self) -> Style {
        match self {
            Blend::None => Style::RAW,
            Blend::Linear => Style {
                stitching: Stitching::Linear,
                ..Style::BEST
            },
            Blend::Inertialize => Style::BEST,
        }
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once('x');
    let numbers = numbers.and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    match numbers {
        Some(size) if size.iter().all(|side| (16..=8192).contains(side)) => Ok(size),
        _ => Err("two numbers of pixels from 16 to 8192, like 640x360".into()),
    }
}

impl Render {
    pub fn run(self) -> Result<()> {
        let output = self.check()?;
        let run = Run::open(&self.run, self.files.moved())?;
        let body = run.task.body();
        let task = &run.config.task.name;
        let times = [self.start, self.seconds].map(|time| (time * RATE as f32).round() as usize);
        let latents = self.latents.choose(task, body.as_ref(), times)?;
        let policy = run.checkpoint(&run.path)?.policy;
        let gpu = Gpu::drawing()?;
        if let Some(body) = &body {
            let driver = run.task.driver(&policy);
            return self.body(&gpu, body, &*driver, &latents, task, &output);
        }
        let locomotion = run.locomotion("render")?;
        let (matcher, task) = (locomotion.matcher.clone(), locomotion.task);
        let context = PlaythroughContext::new(matcher, task, self.blend.style());
        let camera = self.camera();
        let mut film = LocomotionFilm::new(&gpu, context, policy, self.episode, camera, self.size);
        self.write(&output, &mut film)
    }

    /// Draws an episode of a simulated body.
    fn body(
        &self,
        gpu: &Gpu,
        body: &BodyEpisodes,
        driver: &dyn BodyDriver,
        latents: &ChosenLatents,
        task: &str,
        output: &Output,
    ) -> Result<()> {
        let (episode, times) = (self.episode as u32, [self.start, self.seconds]);
        if let ChosenLatents::Strips(shown) = latents {
            latent_strips(gpu, body, driver, shown, episode, times, output.path())?;
            say!("{}", output.path().display());
            return Ok(());
        }
        let mut envs = body.open(episode);
        let model = envs.task().model().clone();
        let bouts = body.bouts.clone();
        let (motion, bout) = match latents {
            ChosenLatents::Path(path) => {
                recorded_episode(&mut envs, &SteeredDriver { driver, path }, task, bouts)
            }
            _ => recorded_episode(&mut envs, driver, task, bouts),
        };
        let bout = bout.as_ref();
        if let Output::Png(path) = output {
            film_strip(gpu, &model, &motion, bout, times, path)?;
            say!("{}", path.display());
            return Ok(());
        }
        let mut film = BodyFilm::new(gpu, &model, &motion, bout, self.camera(), self.size);
        self.write(output, &mut film)
    }

    fn camera(&self) -> Camera {
        Camera {
            yaw: self.yaw.to_radians(),
            pitch: self.pitch.to_radians(),
            distance: self.distance,
            ..Camera::default()
        }
    }

    /// Writes the film from its start on, for as long as it is to be.
    fn write(&self, output: &Output, film: &mut dyn Film) -> Result<()> {
        film.skip((self.start * RATE as f32).round() as usize)?;
        let count = ((self.seconds * self.rate as f32).round() as usize).max(1);
        let between = (RATE / self.rate) as usize;
        match output {
            Output::Png(path) => image_files::png(path, self.size, &film.picture()?)?,
            Output::Gif(path) => {
                let mut frames = Vec::with_capacity(count);
                for _ in (0..count).progress() {
                    frames.push(film.picture()?);
                    film.skip(between)?;
                }
                image_files::gif(path, self.size, self.rate, &frames)?;
            }
            Output::Folder(path) => {
                std::fs::create_dir_all(path)
                    .with_context(|| format!("cannot make the folder {}", path.display()))?;
                image_files::clear(path)?;
                for number in (0..count).progress() {
                    image_files::png(
                        &image_files::frame(path, number),
                        self.size,
                        &film.picture()?,
                    )?;
                    film.skip(between)?;
                }
            }
        }
        say!("{}", output.path().display());
        Ok(())
    }

    /// Refuses impossible options before anything is opened.
    fn check(&self) -> Result<Output> {
        let usage = |why: &str| Err(Usage(why.into()).into());
        let Some(output) = Output::of(&self.out) else {
            return usage(
                "--out must end in .png or .gif, or be a folder's name without an ending",
            );
        };
        if !(0.0..=3600.0).contains(&self.start) {
            return usage("--start must be from 0 to 3600 seconds");
        }
        if !(self.seconds > 0.0 && self.seconds <= 600.0) {
            return usage("--seconds must be over 0 and at most 600");
        }
        if self.rate == 0 || !RATE.is_multiple_of(self.rate) {
            return usage("--rate must be 30 or divide it: 15, 10, 6, 5, 3, 2 or 1");
        }
        if !(-360.0..=360.0).contains(&self.yaw) {
            return usage("--yaw must be from -360 to 360 degrees");
        }
        if !(1.0..=89.0).contains(&self.pitch) {
            return usage("--pitch must be from 1 to 89 degrees");
        }
        if !(0.5..=200.0).contains(&self.distance) {
            return usage("--distance must be from 0.5 to 200 metres");
        }
        if self.episode >= 1000 {
            return usage("--episode must be from 0 to 999");
        }
        self.latents.check(matches!(output, Output::Png(_)))?;
        let path = output.path();
        if path.exists() && !self.force {
            bail!("{} exists: give --force to write over it", path.display());
        }
        if path.exists() && path.is_dir() != matches!(output, Output::Folder(_)) {
            bail!("{} is in the way: choose another --out", path.display());
        }
        if let Some(folder) = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty())
            && !folder.is_dir()
        {
            bail!("there is no folder {}", folder.display());
        }
        Ok(output)
    }
}
