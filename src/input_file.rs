//! Files that users name, read whole: nothing that is no file, and no more than its reader can mean.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Opens a file of at most so many bytes. A pipe or a device might never end.
///
/// # Errors
/// It cannot be opened, is no regular file, or is larger.
pub fn open(path: &Path, most: u64) -> io::Result<File> {
    let about = std::fs::metadata(path)?;
    if about.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    if !about.is_file() {
        return Err(io::Error::other("it is no regular file"));
    }
    if about.len() > most {
        let problem = format!(
            "it is larger than {} MiB, which no such file is",
            most >> 20
        );
        return Err(io::Error::other(problem));
    }
    File::open(path)
}

/// The contents of a file of at most so many bytes.
///
/// # Errors
/// See [`open`]; or it cannot be read.
pub fn bytes(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // It may have grown.
    open(path, most)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of a file of at most so many bytes.
///
/// # Errors
/// See [`bytes`]; or it is not UTF-8.
pub fn text(path: &Path, most: u64) -> io::Result<String> {
    let text = String::from_utf8(bytes(path, most)?);
    text.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))
}
