//! `footwork data`.

mod figures;

use super::Usage;
use super::say::{say, show, tell};
use anyhow::{Context, Result};
use clap::{Args, Subcommand, ValueEnum};
use figures::{ClipFigures, DataFigures};
use footwork::matching::MotionMatcher;
use footwork::motion::clip::Clip;
use footwork::motion::database::Database;
use footwork::motion::import::ImportOptions;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic::{self, boxing};
use footwork::motion::up::UpAxis;
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

/// How BVH files are read.
#[derive(Args)]
struct ReadingArgs {
    /// Metres of one unit of the files [default: found from the length of the legs]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    unit: Option<f32>,
    /// The axis that is up in the files: x, y, z, -x, -y or -z [default: found from how the person stands]
    #[arg(long, value_name = "AXIS", value_parser = up_axis, allow_hyphen_values = true)]
    up: Option<UpAxis>,
    /// Cut recordings where they jump, and keep the longest piece of each
    #[arg(long)]
    trim: bool,
    /// Read the files of sub-folders too
    #[arg(long)]
    recursive: bool,
    /// Leave out files that cannot be used, instead of refusing all
    #[arg(long)]
    skip_bad: bool,
}

impl ReadingArgs {
    fn options(&self, roles: Option<&Path>) -> Result<ImportOptions> {
        if self.unit.is_some_and(|unit| !(1e-6..=1e3).contains(&unit)) {
            return Err(Usage("--unit must be from 0.000001 to 1000 metres".into()).into());
        }
        Ok(ImportOptions {
            unit_m: self.unit,
            up: self.up,
            roles: roles.map(Path::to_path_buf),
            trim: self.trim,
            recursive: self.recursive,
            skip_bad: self.skip_bad,
            mirror: false,
        })
    }
}

fn up_axis(text: &str) -> Result<UpAxis, String> {
    let axis = UpAxis::ALL.into_iter().find(|axis| axis.name() == text);
    axis.ok_or_else(|| "the axes are x, y, z, -x, -y and -z".to_string())
}

#[derive(Args)]
pub struct Import {
    /// A folder of BVH files, or one of them
    path: PathBuf,
    /// The database file to write
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// A TOML file that names the joints of roles that are not found
    #[arg(long, value_name = "FILE")]
    roles: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArgs,
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
    /// Print which joint plays which part, as a roles file; with a FILE, take what it names
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    roles: Option<Option<PathBuf>>,
    #[command(flatten)]
    reading: ReadingArgs,
    /// Print figures as JSON instead of tables
    #[arg(long, conflicts_with = "plot")]
    json: bool,
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
        let options = ImportOptions {
            mirror: self.mirror,
            ..self.reading.options(self.roles.as_deref())?
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
    let index_bytes = index.map_or(0, |index| index.bytes());
    say!(
        "{}: {} clips, {:.1} minutes, {} candidates, fingerprint {:08x}; beside it the search's index, {:.1} MB",
        path.display(),
        database.clips.len(),
        database.minutes(),
        database.candidates.len(),
        database.fingerprint,
        index_bytes as f64 / 1e6,
    );
    Ok(())
}

impl Info {
    fn run(self) -> Result<()> {
        let roles = self.roles.as_ref().and_then(Option::as_deref);
        let options = self.reading.options(roles)?;
        let (database, notes) = data::load_with(self.path.as_deref(), &options, Weights::PAPER)?;
        for note in &notes {
            tell!("note: {note}");
        }
        if self.json {
            let figures = DataFigures::of(&database);
            say!("{}", serde_json::to_string_pretty(&figures)?);
            return Ok(());
        }
        if self.roles.is_some() {
            show!("{}", database.roles.to_file(&database.skeleton));
            return Ok(());
        }
        show!("{}", clips(&database));
        if notes.is_empty() {
            show!("{}", findings(&database));
        }
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

/// What was found in the clips of a database when it was imported.
fn findings(database: &Database) -> String {
    let clips = database.clips.iter();
    let notes = clips.flat_map(|clip| clip.findings.notes.iter().map(move |note| (clip, note)));
    let lines = notes.map(|(clip, note)| format!("{}: {note}\n", clip.name));
    lines.collect()
}

/// A table of the clips.
fn clips(database: &Database) -> String {
    let rows: Vec<Vec<String>> = (0..database.clips.len())
        .map(|clip| {
            let figures = ClipFigures::of(database, clip);
            let unit = figures.unit_m.map(|unit| unit.to_string());
            vec![
                figures.name.clone(),
                format!("{:.1}", figures.seconds),
                figures.candidates.to_string(),
                format!("{:.2}", figures.mean_speed),
                format!("{:.2}", figures.max_speed),
                unit.unwrap_or_default(),
                figures.up.map_or("", UpAxis::name).to_string(),
                database.clips[clip].licence.clone(),
            ]
        })
        .collect();
    let headers = [
        "clip",
        "seconds",
        "candidates",
        "mean speed m/s",
        "max speed m/s",
        "unit m",
        "up",
        "licence",
    ];
    table(&headers, &rows)
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
