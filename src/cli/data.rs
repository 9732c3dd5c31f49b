//! `footwork data`.

use super::Usage;
use super::say::{say, show, tell};
use anyhow::{Context, Result};
use clap::{Args, Subcommand, ValueEnum};
use footwork::matching::MotionMatcher;
use footwork::motion::clip::Clip;
use footwork::motion::database::Database;
use footwork::motion::features::MIN_FUTURE_FRAMES;
use footwork::motion::import::ImportOptions;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic::{self, boxing};
use footwork::motion::{RATE, bvh};
use footwork::report::table::table;
use footwork::train::data;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Subcommand)]
pub enum Data {
    /// Make a database of BVH files
    Import(Import),
    /// Make a database of synthetic motion
    Synth(Synth),
    /// Say what a database or a folder of BVH files holds
    Info(Info),
}

/// Importance of the groups of features in the search.
#[derive(Clone, Copy, Default, ValueEnum)]
enum WeightPreset {
    /// All alike
    #[default]
    Paper,
    /// Daniel Holden's: positions of the feet count less, directions more
    Holden,
}

impl From<WeightPreset> for Weights {
    fn from(preset: WeightPreset) -> Self {
        match preset {
            WeightPreset::Paper => Weights::PAPER,
            WeightPreset::Holden => Weights::HOLDEN,
        }
    }
}

#[derive(Args)]
pub struct Import {
    /// A folder of BVH files, or one of them
    path: PathBuf,
    /// The database file to write
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// Metres of one unit of the files [default: found from the skeleton's height]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    unit: Option<f32>,
    /// A TOML file that names the joints of the roles that are not found by name
    #[arg(long, value_name = "FILE")]
    roles: Option<PathBuf>,
    /// Add the left/right mirrored copy of every clip
    #[arg(long)]
    mirror: bool,
    #[arg(long, value_enum, default_value = "paper")]
    weights: WeightPreset,
}

#[derive(Args)]
pub struct Synth {
    /// The database file to write
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    #[arg(long, default_value_t = synthetic::MINUTES, allow_negative_numbers = true)]
    minutes: f32,
    #[arg(long, default_value_t = data::SYNTHETIC_SEED, allow_negative_numbers = true)]
    seed: u64,
    /// Also write every clip as a BVH file to this folder
    #[arg(long, value_name = "DIR")]
    bvh: Option<PathBuf>,
    /// Also write clips of boxing (guard, steps, pivots, punches) as BVH files to this folder; they are no
    /// part of the database
    #[arg(long, value_name = "DIR")]
    boxing: Option<PathBuf>,
    /// Minutes of boxing
    #[arg(
        long,
        value_name = "MINUTES",
        default_value_t = boxing::MINUTES,
        requires = "boxing",
        allow_negative_numbers = true
    )]
    boxing_minutes: f32,
    #[arg(long, value_enum, default_value = "paper")]
    weights: WeightPreset,
}

#[derive(Args)]
pub struct Info {
    /// A database file, a BVH file or a folder of them [default: the synthetic motion]
    path: Option<PathBuf>,
    /// Also draw speed against turning, and the directions of movement
    #[cfg(feature = "report")]
    #[arg(long, value_name = "PNG")]
    plot: Option<PathBuf>,
}

impl Data {
    pub fn run(self) -> Result<()> {
        match self {
            Data::Import(import) => import.run(),
            Data::Synth(synth) => synth.run(),
            Data::Info(info) => info.run(),
        }
    }
}

impl Import {
    fn run(self) -> Result<()> {
        if self.unit.is_some_and(|unit| !(1e-6..=1e3).contains(&unit)) {
            return Err(Usage("--unit must be from 0.000001 to 1000 metres".into()).into());
        }
        let options = ImportOptions {
            unit_m: self.unit,
            roles: self.roles,
            mirror: self.mirror,
        };
        let (database, notes) = data::from_bvh(&self.path, &options, self.weights.into())?;
        for note in notes {
            tell!("note: {note}");
        }
        save(database, &self.out)
    }
}

impl Synth {
    fn run(self) -> Result<()> {
        for (name, minutes) in [
            ("--minutes", self.minutes),
            ("--boxing-minutes", self.boxing_minutes),
        ] {
            if !(0.1..=1000.0).contains(&minutes) {
                return Err(Usage(format!("{name} must be from 0.1 to 1000")).into());
            }
        }
        let (clips, roles) = synthetic::perform(self.seed, self.minutes);
        save(
            Database::build(&clips, roles, self.weights.into())?,
            &self.out,
        )?;
        if let Some(folder) = &self.bvh {
            write(folder, &clips)?;
        }
        if let Some(folder) = &self.boxing {
            let (clips, _) = synthetic::perform_boxing(self.seed, self.boxing_minutes);
            write(folder, &clips)?;
        }
        Ok(())
    }
}

/// Writes clips as BVH files into a folder.
fn write(folder: &Path, clips: &[Clip]) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for clip in clips {
        bvh::write(&folder.join(format!("{}.bvh", clip.name)), clip)?;
    }
    Ok(())
}

fn save(database: Database, path: &Path) -> Result<()> {
    database.save(path)?;
    let matcher = MotionMatcher::new(Arc::new(database));
    matcher.save_index(path).context(
        "the database was written, the index of the search beside it was not, and every training will build it anew",
    )?;
    let MotionMatcher { database, index } = matcher;
    say!(
        "{}: {} clips, {:.1} minutes, {} candidates, fingerprint {:08x}; beside it the search's index, {:.1} MB",
        path.display(),
        database.clips.len(),
        database.minutes(),
        database.candidates.len(),
        database.fingerprint,
        index.bytes() as f64 / 1e6,
    );
    Ok(())
}

impl Info {
    fn run(self) -> Result<()> {
        let (database, notes) = data::load(self.path.as_deref(), Weights::PAPER)?;
        for note in notes {
            tell!("note: {note}");
        }
        show!("{}", clips(&database));
        say!(
            "\n{} clips, {:.1} minutes, {} frames at {RATE} Hz, {} candidates, fingerprint {:08x}\n",
            database.clips.len(),
            database.minutes(),
            database.frames(),
            database.candidates.len(),
            database.fingerprint,
        );
        let motion = database.ground_motion();
        show!("{}", coverage_table(&motion));
        #[cfg(feature = "report")]
        if let Some(plot) = &self.plot {
            draw_coverage(plot, &motion)?;
            say!("\ncoverage drawn in {}", plot.display());
        }
        Ok(())
    }
}

/// Draws the velocities and turning rates of a motion.
#[cfg(feature = "report")]
fn draw_coverage(plot: &std::path::Path, motion: &[([f32; 2], f32)]) -> Result<()> {
    use footwork::report::coverage::{CoverageSamples, draw};

    let speed: Vec<f32> = motion
        .iter()
        .map(|(velocity, _)| velocity[0].hypot(velocity[1]))
        .collect();
    let turning: Vec<f32> = motion.iter().map(|&(_, turning)| turning).collect();
    // Seen from above, right is positive; the character frame's x is left.
    let velocity: Vec<[f32; 2]> = motion
        .iter()
        .map(|(velocity, _)| [-velocity[0], velocity[1]])
        .collect();
    let samples = CoverageSamples {
        rate_hz: RATE,
        speed: &speed,
        turning: &turning,
        velocity: &velocity,
    };
    Ok(draw(plot, &samples)?)
}

fn clips(database: &Database) -> String {
    let rows: Vec<Vec<String>> = database
        .clips
        .iter()
        .map(|clip| {
            let (first, last) = (clip.first, clip.first + clip.frames - 1);
            let walked: f32 = database.path[first..=last]
                .windows(2)
                .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
                .sum();
            let seconds = clip.frames as f32 / RATE;
            vec![
                clip.name.clone(),
                format!("{seconds:.1}"),
                (clip.frames - MIN_FUTURE_FRAMES).to_string(),
                format!("{:.2}", walked / seconds),
                clip.licence.clone(),
            ]
        })
        .collect();
    table(
        &["clip", "seconds", "candidates", "mean speed m/s", "licence"],
        &rows,
    )
}

/// Minutes by speed and by turning rate.
fn coverage_table(motion: &[([f32; 2], f32)]) -> String {
    const SPEEDS: [f32; 6] = [0.3, 1.0, 2.0, 3.0, 4.0, f32::INFINITY];
    const TURNS: [f32; 4] = [20.0, 60.0, 120.0, f32::INFINITY];
    let mut minutes = [[0.0f32; TURNS.len()]; SPEEDS.len()];
    for (velocity, turning) in motion {
        let speed = velocity[0].hypot(velocity[1]);
        let row = SPEEDS
            .iter()
            .position(|&edge| speed < edge)
            .unwrap_or(SPEEDS.len() - 1);
        let column = TURNS
            .iter()
            .position(|&edge| turning.abs() < edge)
            .unwrap_or(TURNS.len() - 1);
        minutes[row][column] += 1.0 / RATE / 60.0;
    }
    let names = [
        "standing < 0.3",
        "0.3 to 1",
        "1 to 2",
        "2 to 3",
        "3 to 4",
        "4 and more",
    ];
    let rows: Vec<Vec<String>> = names
        .iter()
        .zip(minutes)
        .map(|(name, row)| {
            let cells = row.iter().map(|minutes| format!("{minutes:.2}"));
            std::iter::once(name.to_string()).chain(cells).collect()
        })
        .collect();
    let headers = [
        "minutes at m/s",
        "turning < 20 deg/s",
        "20 to 60",
        "60 to 120",
        "120 and more",
    ];
    table(&headers, &rows)
}
