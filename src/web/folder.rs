//! The folder of a page: written by `footwork web`, served by any server of static files.

use super::locomotion_run::part_name;
use super::motion_parts::MotionHeader;
use super::run_file::{self, Played, Recordings, RunFile};
use crate::gpu::shader;
use crate::matching::MotionMatcher;
use crate::nn::Policy;
use crate::playback::player::Feet;
use crate::train::body_episodes::BodyEpisodes;
use crate::train::config::Config;
use crate::train::locomotion::Locomotion;
use crate::train::rendered_frames::rendered_frames;
use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::path::Path;

/// What the page's scripts are told of the folder.
const MANIFEST: &str = "page.json";
/// The page itself.
const PAGE: [(&str, &str); 7] = [
    ("canvas.js", include_str!("../../web/page/canvas.js")),
    ("index.html", include_str!("../../web/page/index.html")),
    ("main.js", include_str!("../../web/page/main.js")),
    ("module.js", include_str!("../../web/page/module.js")),
    ("search.js", include_str!("../../web/page/search.js")),
    ("webgl.js", include_str!("../../web/page/webgl.js")),
    ("webgpu.js", include_str!("../../web/page/webgpu.js")),
];
/// Name of the WebAssembly.
const MODULE: &str = "footwork.wasm";
/// Episodes in which it is seen which motion a policy uses.
const LOOKED_AT: usize = 64;

/// All files of a page but those that are the same for every run.
pub struct RunFiles {
    task: String,
    steps: u64,
    run: Vec<u8>,
    parts: Vec<Vec<u8>>,
}

#[derive(Serialize)]
struct Manifest<'a> {
    version: &'static str,
    task: &'a str,
    steps: u64,
    module: FileEntry,
    run: FileEntry,
    parts: Vec<FileEntry>,
}

/// Name and bytes of a file.
#[derive(Serialize)]
struct FileEntry {
    file: String,
    bytes: usize,
}

impl RunFiles {
    /// The files of a run of motion matching.
    ///
    /// # Errors
    /// None: all of it is in host memory.
    pub fn of_locomotion(
        task: &str,
        steps: u64,
        policy: &Policy,
        locomotion: &Locomotion,
    ) -> Result<RunFiles> {
        let matcher = &locomotion.matcher;
        let feet = Feet::of(&matcher.database);
        let order = by_use(policy, locomotion)?;
        let (motion, parts) = MotionHeader::cut(&matcher.database, &feet, &order)?;
        let played = Played::Locomotion {
            task: locomotion.task,
            motion: Box::new(motion),
        };
        RunFiles::new(task, steps, policy, played, parts)
    }

    /// The files of a run of a simulated body, which acts itself.
    ///
    /// # Errors
    /// None: all of it is in host memory.
    pub fn of_body(
        task: &str,
        steps: u64,
        policy: &Policy,
        config: &Config,
        episodes: &BodyEpisodes,
    ) -> Result<RunFiles> {
        let recordings = episodes.recordings.as_ref();
        let played = Played::Body {
            config: Box::new(config.clone()),
            recordings: recordings.map(|library| Recordings::of(library)),
        };
        RunFiles::new(task, steps, policy, played, Vec::new())
    }

    fn new(
        task: &str,
        steps: u64,
        policy: &Policy,
        played: Played,
        parts: Vec<Vec<u8>>,
    ) -> Result<RunFiles> {
        let file = RunFile {
            task: task.to_string(),
            steps,
            policy: policy.clone(),
            played,
        };
        Ok(RunFiles {
            run: file.to_bytes()?,
            task: file.task,
            steps,
            parts,
        })
    }

    /// The contents of the run's file.
    pub fn run(&self) -> &[u8] {
        &self.run
    }

    /// Bytes that a page reads before the first step, but for the WebAssembly.
    pub fn first_bytes(&self) -> usize {
        let page: usize = PAGE.iter().map(|(_, text)| text.len()).sum();
        page + self.run.len() + self.parts.first().map_or(0, Vec::len)
    }

    /// The contents of the parts of its motion.
    pub fn parts(&self) -> &[Vec<u8>] {
        &self.parts
    }

    /// Writes the folder, whole or not at all; `module` is the WebAssembly. Another page that is there is replaced if
    /// that is `forced`. Returns its bytes.
    ///
    /// # Errors
    /// Something is there, or the folder cannot be written.
    pub fn write(&self, folder: &Path, module: &[u8], forced: bool) -> Result<usize> {
        check_place(folder, forced)?;
        let absolute = std::path::absolute(folder)?;
        let parent = absolute.parent().context("the folder has no name")?;
        std::fs::create_dir_all(parent)
            .with_context(|| format!("cannot make {}", parent.display()))?;
        let cannot = || format!("cannot write {}", folder.display());
        let unfinished = tempfile::Builder::new()
            .prefix(crate::container::UNFINISHED)
            .tempdir_in(parent)
            .with_context(cannot)?;
        let mut bytes = 0;
        for (name, contents) in self.files(module)? {
            let path = unfinished.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap_or(parent)).with_context(cannot)?;
            std::fs::write(path, &contents).with_context(cannot)?;
            bytes += contents.len();
        }
        if absolute.exists() {
            std::fs::remove_dir_all(&absolute).with_context(cannot)?;
        }
        let finished = unfinished.keep();
        make_public(&finished).with_context(cannot)?;
        std::fs::rename(finished, &absolute).with_context(cannot)?;
        Ok(bytes)
    }

    fn files(&self, module: &[u8]) -> Result<Vec<(String, Vec<u8>)>> {
        let entry = |file: &str, bytes: &[u8]| FileEntry {
            file: file.to_string(),
            bytes: bytes.len(),
        };
        let parts = self.parts.iter().enumerate();
        let parts = parts.map(|(number, part)| entry(&part_name(number), part));
        let manifest = Manifest {
            version: crate::train::config::VERSION,
            task: &self.task,
            steps: self.steps,
            module: entry(MODULE, module),
            run: entry(run_file::NAME, &self.run),
            parts: parts.collect(),
        };
        let mut files = vec![
            (MODULE.to_string(), module.to_vec()),
            (run_file::NAME.to_string(), self.run.clone()),
            (MANIFEST.to_string(), serde_json::to_vec_pretty(&manifest)?),
            ("shaders.json".to_string(), shaders()?),
        ];
        let page = PAGE.map(|(name, text)| (name.to_string(), text.as_bytes().to_vec()));
        files.extend(page);
        let parts = self.parts.iter().enumerate();
        files.extend(parts.map(|(number, part)| (part_name(number), part.clone())));
        Ok(files)
    }
}

/// The texts of the shaders that the page uses, by name.
fn shaders() -> Result<Vec<u8>> {
    let shaders = serde_json::json!({
        "capsule": shader::DRAW_CAPSULE,
        "cuboid": shader::DRAW_CUBOID,
        "ground": shader::DRAW_GROUND,
        "glsl": {
            "capsule": shader::GLSL_CAPSULE,
            "cuboid": shader::GLSL_CUBOID,
            "ground": shader::GLSL_GROUND,
        },
        "search": shader::SEARCH_ONE.source,
    });
    Ok(serde_json::to_vec(&shaders)?)
}

/// Refuses to replace what is no page, or a page unless that is forced.
fn check_place(folder: &Path, forced: bool) -> Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    let shown = folder.display();
    if !folder.is_dir() {
        bail!("{shown} is no folder: choose another --out");
    }
    if std::fs::read_dir(folder)?.next().is_none() {
        return Ok(());
    }
    if !folder.join(MANIFEST).exists() {
        bail!("{shown} holds other things than a page: choose another --out");
    }
    if !forced {
        bail!("{shown} holds a page already: replace it by --force, or choose another --out");
    }
    Ok(())
}

/// Lets others read the folder, as the umask allows: a temporary one is private.
#[cfg(unix)]
fn make_public(folder: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    // The files in it were made under the umask. Whoever may read them may look into the folder.
    let files = std::fs::metadata(folder.join(MANIFEST))?
        .permissions()
        .mode()
        & 0o777;
    let mode = files | (files & 0o444) >> 2 | 0o100;
    std::fs::set_permissions(folder, std::fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn make_public(_: &Path) -> std::io::Result<()> {
    Ok(())
}

/// The clips of a database, those first of which the policy's characters show the largest part.
fn by_use(policy: &Policy, locomotion: &Locomotion) -> Result<Vec<usize>> {
    let MotionMatcher { database, .. } = &*locomotion.matcher;
    let mut shown = vec![0usize; database.clips.len()];
    let episodes = rendered_frames(policy, &locomotion.matcher, locomotion.task, LOOKED_AT)?;
    for placed in episodes.iter().flatten() {
        let after = database
            .clips
            .partition_point(|clip| clip.first <= placed.frame);
        shown[after - 1] += 1;
    }
    let part = |clip: usize| shown[clip] as f64 / database.clips[clip].frames as f64;
    let mut order: Vec<usize> = (0..database.clips.len()).collect();
    order.sort_by(|&a, &b| part(b).total_cmp(&part(a)));
    Ok(order)
}
