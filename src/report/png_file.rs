//! PNG files that are written whole or not at all.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{fs, io, process};

/// Writes an 8-bit RGB picture, `width` by `height` pixels, rows from the top.
///
/// The file appears under its name only when it is complete: a reader never sees half
/// a picture, and a failure leaves the previous one in place and nothing else behind.
///
/// # Errors
///
/// If `rgb` does not hold `3 * width * height` bytes, or the file cannot be written.
/// The message names the file.
pub fn save(path: &Path, width: u32, height: u32, rgb: &[u8]) -> io::Result<()> {
    encode(width, height, rgb)
        .and_then(|bytes| replace(path, &bytes))
        .map_err(|error| {
            io::Error::new(
                error.kind(),
                format!("cannot write the picture {}: {error}", path.display()),
            )
        })
}

fn encode(width: u32, height: u32, rgb: &[u8]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(bytes)
}

/// Renaming within a folder is atomic, writing is not: so write beside, then rename.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let part = beside(path);
    fs::write(&part, bytes)
        .and_then(|()| fs::rename(&part, path))
        .inspect_err(|_| {
            // The first failure is the one to report, not that of tidying up after it.
            let _ = fs::remove_file(&part);
        })
}

/// A name in the same folder that no other process uses.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().map(OsString::from).unwrap_or_default();
    name.push(format!(".{}.part", process::id()));
    path.with_file_name(name)
}
