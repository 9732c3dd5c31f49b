//! Motion: import, files, features as NumPy's arrays, search.

use crate::arrays::{column, rows, table};
use crate::errors::raised;
use crate::pool;
use anyhow::anyhow;
use footwork::kernels::search::search_exact::squared;
use footwork::matching::MotionMatcher;
use footwork::motion::database::Database as Motion;
use footwork::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};
use footwork::motion::import::ImportOptions;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use footwork::motion::up::UpAxis;
use footwork::train::data;
use numpy::ndarray::{ArrayView2, s};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Clips joined, one row a frame at 30 Hz, with the index of what can be matched.
#[pyclass(frozen, module = "footwork._footwork")]
pub struct Database {
    motion: Arc<Motion>,
    /// Where it was read from.
    path: Option<PathBuf>,
    /// Built when somebody first needs it.
    matcher: OnceLock<MotionMatcher>,
    notes: Vec<String>,
}

/// Frames and squared distances, a row each for every query.
type Found<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f32>>);

impl Database {
    fn new(motion: Motion, path: Option<PathBuf>, notes: Vec<String>) -> Database {
        Database {
            motion: Arc::new(motion),
            path,
            matcher: OnceLock::new(),
            notes,
        }
    }

    fn matcher(&self) -> &MotionMatcher {
        self.matcher.get_or_init(|| {
            let motion = self.motion.clone();
            pool::install(|| match &self.path {
                Some(path) => MotionMatcher::open(motion, path),
                None => MotionMatcher::new(motion),
            })
        })
    }

    /// Queries by the poses of `frames` and by `trajectories`, `[n][TRAJECTORY_DIM]`.
    fn queries(&self, frames: &[u32], trajectories: &[f32]) -> Vec<[f32; ROW_STRIDE]> {
        let trajectories = trajectories.chunks_exact(TRAJECTORY_DIM);
        let query = |(&frame, trajectory): (&u32, &[f32])| {
            let mut query = self.motion.features[frame as usize];
            query[POSE_DIM..FEATURE_DIM].copy_from_slice(trajectory);
            query[FEATURE_DIM] = 1.0;
            query
        };
        frames.iter().zip(trajectories).map(query).collect()
    }

    /// The frames of candidates, and how far they are from the queries.
    fn found<'py>(
        &self,
        py: Python<'py>,
        nearest: &[u32],
        queries: &[[f32; ROW_STRIDE]],
    ) -> Found<'py> {
        let frames: Vec<u32> = nearest
            .iter()
            .map(|&at| self.motion.candidates[at as usize])
            .collect();
        let rows = frames
            .iter()
            .map(|&frame| &self.motion.features[frame as usize]);
        let distances = rows.zip(queries).map(|(row, query)| squared(row, query));
        let distances = distances.collect();
        let frames = frames.into_iter().map(i64::from).collect();
        (
            PyArray1::from_vec(py, frames),
            PyArray1::from_vec(py, distances),
        )
    }
}

/// Imports BVH files; see the package's `import_bvh`.
#[pyfunction]
#[pyo3(signature = (path, *, unit=None, up=None, roles=None, trim=false, recursive=false, skip_bad=false,
    mirror=false, weights="paper"))]
pub fn import_bvh(
    py: Python<'_>,
    path: PathBuf,
    unit: Option<f32>,
    up: Option<&str>,
    roles: Option<PathBuf>,
    trim: bool,
    recursive: bool,
    skip_bad: bool,
    mirror: bool,
    weights: &str,
) -> PyResult<Database> {
    let options = ImportOptions {
        unit_m: unit,
        up: up.map(up_axis).transpose()?,
        roles,
        trim,
        recursive,
        skip_bad,
        mirror,
    };
    let weights = weights_of(weights)?;
    let imported = py.detach(|| pool::install(|| data::from_bvh(&path, &options, weights)));
    let (motion, notes) = imported.map_err(raised)?;
    Ok(Database::new(motion, None, notes))
}

fn up_axis(name: &str) -> PyResult<UpAxis> {
    let axis = UpAxis::ALL.into_iter().find(|axis| axis.name() == name);
    axis.ok_or_else(|| {
        PyValueError::new_err(format!("up must be x, y, z, -x, -y or -z, not {name:?}"))
    })
}

fn weights_of(name: &str) -> PyResult<Weights> {
    match name {
        "paper" => Ok(Weights::PAPER),
        "holden" => Ok(Weights::HOLDEN),
        other => Err(PyValueError::new_err(format!(
            "weights must be \"paper\" or \"holden\", not {other:?}"
        ))),
    }
}

#[pymethods]
impl Database {
    /// Reads a database file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Database> {
        let motion = py.detach(|| Motion::load(&path));
        let motion = motion.map_err(|error| raised(error.into()))?;
        Ok(Database::new(motion, Some(path), Vec::new()))
    }

    /// Makes synthetic motion of so many minutes.
    #[staticmethod]
    #[pyo3(signature = (minutes=synthetic::MINUTES, seed=data::SYNTHETIC_SEED, weights="paper"))]
    fn synthetic(py: Python<'_>, minutes: f32, seed: u64, weights: &str) -> PyResult<Database> {
        if !(0.1..=1000.0).contains(&minutes) {
            let why = format!("minutes must be from 0.1 to 1000, not {minutes}");
            return Err(PyValueError::new_err(why));
        }
        let weights = weights_of(weights)?;
        let motion = py.detach(|| {
            pool::install(|| {
                let (clips, roles) = synthetic::perform(seed, minutes);
                Motion::build(&clips, roles, weights)
            })
        });
        let motion = motion.map_err(|error| raised(error.into()))?;
        Ok(Database::new(motion, None, Vec::new()))
    }

    /// Writes a database file, and the search's index beside it.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| {
            self.motion.save(&path)?;
            self.matcher().save_index(&path)
        })
        .map_err(|error| raised(error.into()))
    }

    /// The nearest frames to features `[n][27]`, among those that can be matched: all of them are compared.
    fn search<'py>(&self, py: Python<'py>, queries: &Bound<PyAny>) -> PyResult<Found<'py>> {
        let numbers = rows("queries", queries, [None, Some(FEATURE_DIM)])?;
        let queries: Vec<[f32; ROW_STRIDE]> = numbers
            .chunks_exact(FEATURE_DIM)
            .map(|row| std::array::from_fn(|at| row.get(at).copied().unwrap_or(1.0)))
            .collect();
        let motion = &self.motion;
        let nearest: Vec<u32> = py.detach(|| {
            let distance = |at: u32, query| {
                let frame = motion.candidates[at as usize] as usize;
                squared(&motion.features[frame], query)
            };
            let nearest = |query| {
                let all = 0..motion.candidates.len() as u32;
                let all = all.map(|at| (distance(at, query), at));
                all.reduce(|best, other| if other.0 < best.0 { other } else { best })
            };
            let nearest = |query| nearest(query).map_or(0, |(_, at)| at);
            pool::install(|| queries.par_iter().map(nearest).collect())
        });
        Ok(self.found(py, &nearest, &queries))
    }

    /// The frames to go on with from `frames` along trajectories `[n][12]`: motion matching, by the index.
    #[pyo3(name = "match")]
    fn match_<'py>(
        &self,
        py: Python<'py>,
        frames: &Bound<PyAny>,
        trajectories: &Bound<PyAny>,
    ) -> PyResult<Found<'py>> {
        let frames = column::<i64>("frames", frames, None)?;
        let shape = [Some(frames.len()), Some(TRAJECTORY_DIM)];
        let trajectories = rows("trajectories", trajectories, shape)?;
        let count = self.motion.frames();
        let number = |(at, &frame): (usize, &i64)| {
            let number = usize::try_from(frame).ok().filter(|&frame| frame < count);
            number.map(|frame| frame as u32).ok_or_else(|| {
                PyValueError::new_err(format!(
                    "frames[{at}] is {frame}, of a database of {count} frames"
                ))
            })
        };
        let frames = frames
            .iter()
            .enumerate()
            .map(number)
            .collect::<PyResult<Vec<u32>>>()?;
        let queries = self.queries(&frames, &trajectories);
        let mut nearest = vec![0; frames.len()];
        py.detach(|| {
            let matcher = self.matcher();
            pool::install(|| matcher.nearest_all(&frames, &queries, &mut nearest));
        });
        Ok(self.found(py, &nearest, &queries))
    }

    #[getter]
    fn frames(&self) -> usize {
        self.motion.frames()
    }

    #[getter]
    fn minutes(&self) -> f32 {
        self.motion.minutes()
    }

    #[getter]
    fn fingerprint(&self) -> u32 {
        self.motion.fingerprint
    }

    /// What the user should know of an import.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.motion.skeleton.names.clone()
    }

    /// The parent of every joint; -1 of the root.
    #[getter]
    fn parents(&self) -> Vec<i64> {
        let parents = self.motion.skeleton.parents.iter();
        parents
            .map(|parent| parent.map_or(-1, |parent| parent as i64))
            .collect()
    }

    #[getter]
    fn clips<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let clip = |clip: &footwork::motion::database::ClipRecord| {
            let about = PyDict::new(py);
            about.set_item("name", &clip.name)?;
            about.set_item("first", clip.first)?;
            about.set_item("frames", clip.frames)?;
            about.set_item("source", &clip.source)?;
            about.set_item("licence", &clip.licence)?;
            Ok(about)
        };
        self.motion.clips.iter().map(clip).collect()
    }

    /// Frames that can be matched, ascending.
    #[getter]
    fn candidates<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.motion.candidates)
    }

    /// Mean and scale of the features: `normalised = (feature - mean) * scale`.
    #[getter]
    fn normalisation<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<f32>>) {
        let normal = &self.motion.normalisation;
        (
            PyArray1::from_slice(py, &normal.mean),
            PyArray1::from_slice(py, &normal.scale),
        )
    }

    /// Position of each joint relative to its parent, m.
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let offsets: &[f32] = bytemuck::cast_slice(&self.motion.skeleton.offsets);
        table(py, offsets.to_vec(), 3)
    }

    #[getter]
    fn features<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        view(
            this,
            this.get().motion.features.as_flattened(),
            ROW_STRIDE,
            FEATURE_DIM,
        )
    }

    /// The character's path in its clip: x, z, heading x, heading z.
    #[getter]
    fn path<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        view(this, this.get().motion.path.as_flattened(), 4, 4)
    }

    /// World positions of the hips, m.
    #[getter]
    fn hips<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        view(this, bytemuck::cast_slice(&this.get().motion.hips), 3, 3)
    }

    /// Local rotations `[frame][joint][x, y, z, w]`.
    #[getter]
    fn rotations<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let motion = &this.get().motion;
        let flat = view(this, bytemuck::cast_slice(&motion.rotations), 4, 4)?;
        let shape = [motion.frames(), motion.skeleton.joints(), 4];
        flat.call_method1("reshape", (shape,))
    }
}

/// A view of the first `columns` of rows of `stride` numbers, which `owner` keeps; nobody may write to it.
fn view<'py>(
    owner: &Bound<'py, Database>,
    numbers: &[f32],
    stride: usize,
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let rows = numbers.len() / stride;
    let all =
        ArrayView2::from_shape((rows, stride), numbers).map_err(|error| raised(anyhow!(error)))?;
    let shown = all.slice(s![.., ..columns]);
    // A frozen owner never moves its motion, and lives as long as the view.
    let shown = unsafe { PyArray2::borrow_from_array(&shown, owner.clone().into_any()) };
    shown.getattr("flags")?.setattr("writeable", false)?;
    Ok(shown)
}
