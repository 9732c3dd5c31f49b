//! `manifest.csv`: what is known about the recordings of a folder.

use super::error::{MotionError, MotionResult};
use crate::input_file;
use std::collections::HashMap;
use std::path::Path;

/// Bytes of the longest manifest.
const MAX_BYTES: u64 = 1 << 26;

/// What a manifest says about one recording; absent or empty columns leave the default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entry {
    /// Frames of the file to drop at its head and tail.
    pub skip_head: usize,
    /// Frames to leave out at the end.
    pub skip_tail: usize,
    /// Metres per file unit.
    pub unit_m: Option<f32>,
    /// Terms of use.
    pub licence: String,
    /// Where the recording comes from.
    pub source: String,
}

/// Entries by the `file` column: a path relative to the manifest's folder, with slashes.
pub type Manifest = HashMap<String, Entry>;

/// What a file called `manifest.csv` is.
pub enum ManifestFile {
    /// There is none.
    Nothing,
    /// Something else: it has no column `file`.
    Stranger,
    /// A manifest.
    Ours(Manifest),
}

/// Reads a manifest.
///
/// A table with commas, or semicolons as spreadsheets write them where commas are decimal. Its first row
/// names the columns; only `file` must be there. Fields may be quoted, because descriptions have commas
/// in them.
///
/// # Errors
/// A file that cannot be read, and mistakes in a manifest, with the line.
pub fn read(path: &Path) -> MotionResult<ManifestFile> {
    match input_file::bytes(path, MAX_BYTES) {
        Ok(bytes) => match std::str::from_utf8(&bytes) {
            Ok(text) if is_manifest(text) => parse(text, path).map(ManifestFile::Ours),
            _ => Ok(ManifestFile::Stranger),
        },
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(ManifestFile::Nothing),
        Err(error) => Err(MotionError::Read {
            path: path.to_path_buf(),
            error,
        }),
    }
}

/// Whether the first row has a column `file`.
fn is_manifest(text: &str) -> bool {
    let header = text
        .trim_start_matches('\u{feff}')
        .trim_start()
        .lines()
        .next();
    let mut columns = header.unwrap_or_default().split([',', ';']);
    columns.any(|column| column.trim().trim_matches('"') == "file")
}

/// What separates the columns.
fn separator(text: &str) -> char {
    let header = text.trim_start().lines().next().unwrap_or_default();
    if header.contains(',') || !header.contains(';') {
        ','
    } else {
        ';'
    }
}

/// Reads the text of a manifest; `path` is only for messages.
pub fn parse(text: &str, path: &Path) -> MotionResult<Manifest> {
    let fault = |line, problem: String| MotionError::Manifest {
        path: path.to_path_buf(),
        line,
        problem,
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows = rows(text, separator(text))
        .map_err(|line| fault(line, "a quote that is never closed".to_string()))?
        .into_iter();
    let (line, header) = rows.next().unwrap_or_default();
    if !header.iter().any(|name| name == "file") {
        let what = "the first row names the columns, and 'file' must be among them";
        return Err(fault(line.max(1), what.to_string()));
    }
    let mut manifest = Manifest::new();
    for (line, fields) in rows {
        if fields.len() != header.len() {
            let (found, wanted) = (fields.len(), header.len());
            let what = format!("{found} fields where the first row names {wanted} columns");
            return Err(fault(line, what));
        }
        let row: HashMap<&str, &str> = header
            .iter()
            .map(String::as_str)
            .zip(fields.iter().map(String::as_str))
            .collect();
        let entry = entry(&row).map_err(|problem| fault(line, problem))?;
        if manifest.insert(row["file"].to_string(), entry).is_some() {
            return Err(fault(line, format!("a second row for '{}'", row["file"])));
        }
    }
    Ok(manifest)
}

fn entry(row: &HashMap<&str, &str>) -> Result<Entry, String> {
    let text = |column: &str| row.get(column).map_or("", |field| field.trim());
    let frames = |column: &str| match text(column) {
        "" => Ok(0),
        field => field
            .parse()
            .map_err(|_| format!("{column} is '{field}', not a number of frames")),
    };
    let unit_m = match text("unit_m") {
        "" => None,
        field => match field.replace(',', ".").parse::<f32>() {
            Ok(unit) if unit.is_finite() && unit > 0.0 => Some(unit),
            _ => return Err(format!("unit_m is '{field}', not a length in metres")),
        },
    };
    Ok(Entry {
        skip_head: frames("skip_head")?,
        skip_tail: frames("skip_tail")?,
        unit_m,
        licence: text("licence").to_string(),
        source: text("source").to_string(),
    })
}

/// Rows with the line each begins on (from 1); the error is the line of an open quote.
fn rows(text: &str, separator: char) -> Result<Vec<(usize, Vec<String>)>, usize> {
    let mut rows = Vec::new();
    let (mut row, mut field) = (Vec::new(), String::new());
    let (mut line, mut begin, mut quoted) = (1, 1, None);
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        line += usize::from(c == '\n');
        match c {
            '"' if quoted.is_some() && chars.next_if_eq(&'"').is_some() => field.push('"'),
            '"' if quoted.is_some() => quoted = None,
            '"' if field.is_empty() => quoted = Some(line),
            _ if c == separator && quoted.is_none() => row.push(std::mem::take(&mut field)),
            '\r' if quoted.is_none() => {}
            '\n' if quoted.is_none() => {
                row.push(std::mem::take(&mut field));
                rows.push((begin, std::mem::take(&mut row)));
                begin = line;
            }
            _ => field.push(c),
        }
    }
    if let Some(line) = quoted {
        return Err(line);
    }
    row.push(field);
    rows.push((begin, row));
    // Empty lines, the one after the last line end among them, are no rows.
    rows.retain(|(_, row)| row.iter().any(|field| !field.is_empty()));
    Ok(rows)
}
