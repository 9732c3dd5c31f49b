//! A checksummed file of a JSON header and plain arrays: the form of databases and checkpoints.
//!
//! Layout, little-endian: the 8 bytes `footwork`, the kind (8 bytes, zero-padded), version
//! (u32), CRC-32 of the rest (u32), length of the header (u64), header, arrays. Files are
//! written beside their place and renamed: whole or not at all.

use crate::input_file;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What went wrong with a file.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file that cannot be read.
    #[error("cannot read {path}: {error}; check that it exists and may be read")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's error.
        error: std::io::Error,
    },
    /// A file that cannot be written; what was in its place is still there.
    #[error(
        "cannot write {path}: {error}; nothing was written: check the folder, its rights and the free space"
    )]
    Write {
        /// Where it should be.
        path: PathBuf,
        /// The cause.
        error: String,
    },
    /// A file that does not begin as those of footwork do.
    #[error("{path} is not a footwork {}", spelled(.kind))]
    Foreign {
        /// The file.
        path: PathBuf,
        /// The kind asked for, see [`Format::kind`].
        kind: &'static str,
    },
    /// A file of footwork, but of another kind.
    #[error("{path} is a footwork {}, not a {}", spelled(.found), spelled(.wanted))]
    OtherKind {
        /// The file.
        path: PathBuf,
        /// Its kind.
        found: String,
        /// The kind asked for.
        wanted: &'static str,
    },
    /// A file of a later format version.
    #[error(
        "{path} has format version {found}; this program reads up to {known}: use a newer footwork"
    )]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// The version that this program reads.
        known: u32,
    },
    /// A file of an earlier format version.
    #[error(
        "{path} has format version {found}, which this program no longer reads ({known} is its own): make it again, or use the footwork that wrote it"
    )]
    Older {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// The version that this program reads.
        known: u32,
    },
    /// A file whose checksum or structure is wrong.
    #[error("{path} is damaged ({why}): make it again or take another copy")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

/// Kind and version of a file.
#[derive(Clone, Copy)]
pub struct Format {
    /// Name of the kind, at most eight bytes.
    pub kind: &'static str,
    /// Version of what header and arrays hold; readers take no other.
    pub version: u32,
}

/// A kind in full; files have only eight bytes for it.
fn spelled(kind: &str) -> &str {
    match kind {
        "checkpt" => "checkpoint",
        other => other,
    }
}

const MAGIC: &[u8; 8] = b"footwork";
const PREFIX: usize = 32;

#[derive(Serialize, Deserialize)]
struct Contents<H> {
    header: H,
    /// Name and number of four-byte values.
    arrays: Vec<(String, u64)>,
}

/// Named arrays of four-byte values (f32, u32), as raw bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrays(Vec<(String, Vec<u8>)>);

impl Arrays {
    /// Adds an array under a name; its size must be a multiple of four bytes.
    pub fn put<T: bytemuck::Pod>(&mut self, name: &str, values: &[T]) {
        self.0
            .push((name.to_string(), bytemuck::cast_slice(values).to_vec()));
    }

    /// Takes an array out by name; `None` if the file has no such array or it has another shape.
    pub fn take<T: bytemuck::Pod>(&mut self, name: &str) -> Option<Vec<T>> {
        let at = self.0.iter().position(|(other, _)| other == name)?;
        let (_, bytes) = self.0.swap_remove(at);
        bytes
            .len()
            .is_multiple_of(size_of::<T>())
            .then(|| bytemuck::pod_collect_to_vec(&bytes))
    }
}

/// What one part of a program saves into a file that many parts share: values by name, and arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    values: serde_json::Map<String, serde_json::Value>,
    arrays: Arrays,
}

/// A section that does not hold what it should.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct SectionError(pub String);

impl Section {
    /// Saves a value under a name. Floats of 64 bits belong into arrays: JSON may round them.
    pub fn put(&mut self, name: &str, value: impl Serialize) {
        // Numbers, text and plain structs always have a JSON form.
        let value = serde_json::to_value(value).unwrap_or_default();
        self.values.insert(name.to_string(), value);
    }

    /// Saves an array under a name.
    pub fn put_array<T: bytemuck::Pod>(&mut self, name: &str, values: &[T]) {
        self.arrays.put(name, values);
    }

    /// The value of a name.
    ///
    /// # Errors
    /// There is none, or it is of another type.
    pub fn get<T: DeserializeOwned>(&self, name: &str) -> Result<T, SectionError> {
        let value = self.values.get(name).cloned();
        let value = value.ok_or_else(|| SectionError(format!("it has no `{name}`")))?;
        serde_json::from_value(value).map_err(|error| SectionError(format!("`{name}`: {error}")))
    }

    /// Number of four-byte values in the array of a name; 0 if there is none.
    pub fn array_len(&self, name: &str) -> usize {
        let array = self.arrays.0.iter().find(|(other, _)| other == name);
        array.map_or(0, |(_, bytes)| bytes.len() / 4)
    }

    /// Takes out the array of a name, which must have `len` elements.
    ///
    /// # Errors
    /// There is none, or it has another length.
    pub fn take_array<T: bytemuck::Pod>(
        &mut self,
        name: &str,
        len: usize,
    ) -> Result<Vec<T>, SectionError> {
        let values: Vec<T> = self
            .arrays
            .take(name)
            .ok_or_else(|| SectionError(format!("it has no array `{name}`")))?;
        if values.len() != len {
            let found = values.len();
            return Err(SectionError(format!(
                "its array `{name}` has {found} numbers, not {len}"
            )));
        }
        Ok(values)
    }
}

impl Section {
    /// Saves all that another section holds, under its names behind `name`.
    pub fn put_section(&mut self, name: &str, section: Section) {
        for (own, value) in section.values {
            self.values.insert(format!("{name}.{own}"), value);
        }
        for (own, bytes) in section.arrays.0 {
            self.arrays.0.push((format!("{name}.{own}"), bytes));
        }
    }

    /// Takes out what [`Section::put_section`] saved.
    pub fn take_section(&mut self, name: &str) -> Section {
        let own = |full: &str| full.strip_prefix(name)?.strip_prefix('.').map(String::from);
        let mut section = Section::default();
        for (full, value) in &self.values {
            if let Some(own) = own(full) {
                section.values.insert(own, value.clone());
            }
        }
        let (inner, rest) = std::mem::take(&mut self.arrays.0)
            .into_iter()
            .partition(|(full, _)| own(full).is_some());
        self.arrays.0 = rest;
        let inner: Vec<(String, Vec<u8>)> = inner;
        let inner = inner
            .into_iter()
            .filter_map(|(full, bytes)| Some((own(&full)?, bytes)));
        section.arrays.0 = inner.collect();
        section
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty() && self.arrays.0.is_empty()
    }

    /// [`Section::take_array`] of floats that must be finite.
    ///
    /// # Errors
    /// As there; or a number is not finite.
    pub fn take_finite(&mut self, name: &str, len: usize) -> Result<Vec<f32>, SectionError> {
        let values = self.take_array::<f32>(name, len)?;
        match values.iter().all(|value| value.is_finite()) {
            true => Ok(values),
            false => Err(SectionError(format!(
                "its array `{name}` has numbers that are not finite"
            ))),
        }
    }
}

/// The sections of a file, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sections(BTreeMap<String, Section>);

impl Sections {
    /// Puts a section in under a name without `/`.
    pub fn put(&mut self, name: &str, section: Section) {
        self.0.insert(name.to_string(), section);
    }

    /// The names of all sections.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Puts all sections of others in.
    pub fn extend(&mut self, others: Sections) {
        self.0.extend(others.0);
    }

    /// A section by name.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn get(&self, name: &str) -> Result<&Section, SectionError> {
        let section = self.0.get(name);
        section.ok_or_else(|| SectionError(format!("it has no section `{name}`")))
    }

    /// Takes a section out.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn take(&mut self, name: &str) -> Result<Section, SectionError> {
        let section = self.0.remove(name);
        section.ok_or_else(|| SectionError(format!("it has no section `{name}`")))
    }

    /// Writes all sections into one file; an array is called `section/array` there.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save(&self, path: &Path, format: Format) -> Result<(), StoreError> {
        write_whole(path, &self.to_bytes(path, format)?)
    }

    /// What [`Sections::save`] writes into the file at `path`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn to_bytes(&self, path: &Path, format: Format) -> Result<Vec<u8>, StoreError> {
        let mut arrays = Arrays::default();
        for (name, section) in &self.0 {
            let named = section.arrays.0.iter();
            let named = named.map(|(array, bytes)| (format!("{name}/{array}"), bytes.clone()));
            arrays.0.extend(named);
        }
        let values = self.0.iter().map(|(name, section)| (name, &section.values));
        encode(path, format, &values.collect::<BTreeMap<_, _>>(), &arrays)
    }

    /// Reads all sections of a file.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn load(path: &Path, format: Format) -> Result<Self, StoreError> {
        Self::from_bytes(path, &read(path)?, format)
    }

    /// Reads the contents of the file at `path`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn from_bytes(path: &Path, bytes: &[u8], format: Format) -> Result<Self, StoreError> {
        let (values, arrays) = decode::<BTreeMap<String, _>>(path, bytes, format)?;
        let sections = values.into_iter().map(|(name, values)| {
            let arrays = Arrays::default();
            (name, Section { values, arrays })
        });
        let mut sections = Sections(sections.collect());
        for (name, bytes) in arrays.0 {
            let (section, array) = name.split_once('/').unwrap_or_default();
            let Some(section) = sections.0.get_mut(section) else {
                return Err(StoreError::Damaged {
                    path: path.to_path_buf(),
                    why: format!("array `{name}` belongs to no section"),
                });
            };
            section.arrays.0.push((array.to_string(), bytes));
        }
        Ok(sections)
    }
}

/// Writes a file whole or not at all.
///
/// # Errors
/// [`StoreError::Write`], with what was there before left as it was.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    replace(path, bytes).map_err(|error| {
        // Without tempfile's "at path ...": where the temporary file was helps nobody.
        let error = error.to_string();
        let cause = error.split(" at path ").next().unwrap_or_default();
        StoreError::Write {
            path: path.to_path_buf(),
            error: cause.to_string(),
        }
    })
}

/// Bytes of the largest file: hours of motion, millions of parameters.
const MAX_BYTES: u64 = 1 << 36;

/// How names of files begin that are being written.
pub const UNFINISHED: &str = ".footwork-";

/// Writes beside the place and renames.
fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // Renaming would put a plain file in the place of a device or a pipe.
    if path.metadata().is_ok_and(|there| !there.is_file()) {
        return Err(std::io::Error::other(
            "something is there that is no regular file",
        ));
    }
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED);
    // A temporary file is private; this one will be as public as the umask makes files.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

/// Writes header and arrays.
///
/// # Errors
/// [`StoreError::Write`].
pub fn save<H: Serialize>(
    path: &Path,
    format: Format,
    header: &H,
    arrays: &Arrays,
) -> Result<(), StoreError> {
    write_whole(path, &encode(path, format, header, arrays)?)
}

fn encode<H: Serialize>(
    path: &Path,
    format: Format,
    header: &H,
    arrays: &Arrays,
) -> Result<Vec<u8>, StoreError> {
    let names = arrays
        .0
        .iter()
        .map(|(name, bytes)| (name.clone(), bytes.len() as u64 / 4))
        .collect();
    let json = serde_json::to_vec(&Contents {
        header,
        arrays: names,
    })
    .map_err(|error| StoreError::Write {
        path: path.to_path_buf(),
        error: error.to_string(),
    })?;
    let mut rest = (json.len() as u64).to_le_bytes().to_vec();
    rest.extend(json);
    for (_, bytes) in &arrays.0 {
        rest.extend(bytes);
    }
    let mut kind = [0; 8];
    kind[..format.kind.len()].copy_from_slice(format.kind.as_bytes());
    let mut bytes = MAGIC.to_vec();
    bytes.extend(kind);
    bytes.extend(format.version.to_le_bytes());
    bytes.extend(crc32fast::hash(&rest).to_le_bytes());
    bytes.extend(rest);
    Ok(bytes)
}

/// Reads header and arrays back.
///
/// # Errors
/// See [`StoreError`].
pub fn load<H: DeserializeOwned>(path: &Path, format: Format) -> Result<(H, Arrays), StoreError> {
    decode(path, &read(path)?, format)
}

fn read(path: &Path) -> Result<Vec<u8>, StoreError> {
    input_file::bytes(path, MAX_BYTES).map_err(|error| StoreError::Read {
        path: path.to_path_buf(),
        error,
    })
}

fn decode<H: DeserializeOwned>(
    path: &Path,
    bytes: &[u8],
    format: Format,
) -> Result<(H, Arrays), StoreError> {
    let damaged = |why: &str| StoreError::Damaged {
        path: path.to_path_buf(),
        why: why.to_string(),
    };
    if !bytes.starts_with(MAGIC) {
        return Err(StoreError::Foreign {
            path: path.to_path_buf(),
            kind: format.kind,
        });
    }
    if bytes.len() < PREFIX {
        return Err(damaged("it ends within its first 32 bytes"));
    }
    let kind = String::from_utf8_lossy(&bytes[8..16])
        .trim_end_matches('\0')
        .to_string();
    if kind != format.kind {
        return Err(StoreError::OtherKind {
            path: path.to_path_buf(),
            found: kind,
            wanted: format.kind,
        });
    }
    let word =
        |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    if word(16) < format.version {
        return Err(StoreError::Older {
            path: path.to_path_buf(),
            found: word(16),
            known: format.version,
        });
    }
    if word(16) > format.version {
        return Err(StoreError::Newer {
            path: path.to_path_buf(),
            found: word(16),
            known: format.version,
        });
    }
    let rest = &bytes[24..];
    if crc32fast::hash(rest) != word(20) {
        return Err(damaged("its checksum does not match its contents"));
    }
    let length = u64::from(word(24)) | u64::from(word(28)) << 32;
    let json = usize::try_from(length)
        .ok()
        .and_then(|length| rest.get(8..8usize.checked_add(length)?));
    let json = json.ok_or_else(|| damaged("its header is longer than the file"))?;
    let contents: Contents<H> =
        serde_json::from_slice(json).map_err(|error| damaged(&error.to_string()))?;
    let mut data = &rest[8 + json.len()..];
    let mut arrays = Arrays::default();
    for (name, words) in contents.arrays {
        let length = usize::try_from(words)
            .ok()
            .and_then(|words| words.checked_mul(4));
        let (array, after) = length
            .and_then(|length| data.split_at_checked(length))
            .ok_or_else(|| damaged(&format!("array `{name}` is cut off")))?;
        arrays.0.push((name, array.to_vec()));
        data = after;
    }
    if !data.is_empty() {
        return Err(damaged("it is longer than its contents"));
    }
    Ok((contents.header, arrays))
}
