//! Event files that TensorBoard reads: one scalar or picture after another.
//!
//! A file is a sequence of records: the length of the data (u64), its checksum, the
//! data, its checksum, all little-endian; a checksum is a CRC-32C, rotated and offset.
//! The data of a record is one protobuf message `Event`; the few fields needed are
//! encoded here by hand.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// TensorBoard takes any file with "tfevents" in its name for an event file. One fixed
/// name lets a resumed run replace the file it began.
pub const FILE_NAME: &str = "events.out.tfevents.footwork";

/// An open event file.
///
/// Dropping it writes what is left but cannot tell of a failure: call
/// [`flush`](Self::flush) where that matters.
pub struct EventWriter {
    file: BufWriter<File>,
    name: String,
}

impl EventWriter {
    /// Starts the event file of the folder `dir`, which is made if missing. A previous
    /// event file is replaced. `wall_time_s` is the present time in seconds since 1970.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn create(dir: &Path, wall_time_s: f64) -> io::Result<Self> {
        let path = dir.join(FILE_NAME);
        let name = path.display().to_string();
        let file = fs::create_dir_all(dir)
            .and_then(|()| File::create(&path))
            .map_err(|error| failure(&name, &error))?;
        let mut writer = Self {
            file: BufWriter::new(file),
            name,
        };
        writer.record(&version(wall_time_s))?;
        writer.flush()?;
        Ok(writer)
    }

    /// Adds one value of the curve `tag`, such as "loss/value"; `wall_time_s` is its
    /// time in seconds since 1970.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn scalar(&mut self, tag: &str, step: u64, wall_time_s: f64, value: f64) -> io::Result<()> {
        self.record(&scalar(tag, step, wall_time_s, value))
    }

    /// Adds a picture, a whole PNG or GIF file, under `tag`, such as "episodes/film"; TensorBoard plays animations.
    ///
    /// # Errors
    ///
    /// If `file` is neither, or the event file cannot be written.
    pub fn image(&mut self, tag: &str, step: u64, wall_time_s: f64, file: &[u8]) -> io::Result<()> {
        let size = image_size(file).ok_or_else(|| {
            let problem = format!("picture {tag} is neither PNG nor GIF");
            failure(
                &self.name,
                &io::Error::new(io::ErrorKind::InvalidData, problem),
            )
        })?;
        self.record(&image(tag, step, wall_time_s, size, file))
    }

    /// Hands everything written so far to the operating system, so that TensorBoard
    /// sees it.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.file
            .flush()
            .map_err(|error| failure(&self.name, &error))
    }

    fn record(&mut self, data: &[u8]) -> io::Result<()> {
        let length = (data.len() as u64).to_le_bytes();
        let mut record = Vec::with_capacity(data.len() + 16);
        record.extend(length);
        record.extend(masked_crc(&length).to_le_bytes());
        record.extend(data);
        record.extend(masked_crc(data).to_le_bytes());
        self.file
            .write_all(&record)
            .map_err(|error| failure(&self.name, &error))
    }
}

fn failure(name: &str, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("event file {name}: {error}"))
}

/// TensorFlow's guard against checksums of data that contains checksums.
fn masked_crc(data: &[u8]) -> u32 {
    crc32c::crc32c(data)
        .rotate_right(15)
        .wrapping_add(0xa282_ead8)
}

/// `Event { wall_time = 1: double, file_version = 3: string }`
fn version(wall_time_s: f64) -> Vec<u8> {
    let mut event = Vec::new();
    fixed64(&mut event, 1, wall_time_s);
    bytes(&mut event, 3, b"brain.Event:2");
    event
}

/// `Value { tag = 1: string, simple_value = 2: float }`
fn scalar(tag: &str, step: u64, wall_time_s: f64, number: f64) -> Vec<u8> {
    let mut value = Vec::new();
    bytes(&mut value, 1, tag.as_bytes());
    fixed32(&mut value, 2, number as f32);
    event(step, wall_time_s, &value)
}

/// `Value { tag = 1: string, image = 4: Image }` with `Image { height = 1: int32, width = 2: int32,
/// colorspace = 3: int32, encoded_image_string = 4: bytes }`; the colour space 3 is RGB.
fn image(
    tag: &str,
    step: u64,
    wall_time_s: f64,
    [width, height]: [u64; 2],
    file: &[u8],
) -> Vec<u8> {
    let mut image = Vec::with_capacity(file.len() + 32);
    integer(&mut image, 1, height);
    integer(&mut image, 2, width);
    integer(&mut image, 3, 3);
    bytes(&mut image, 4, file);
    let mut value = Vec::with_capacity(image.len() + 64);
    bytes(&mut value, 1, tag.as_bytes());
    bytes(&mut value, 4, &image);
    event(step, wall_time_s, &value)
}

/// Width and height of a PNG or GIF file, pixels; `None` if it is neither.
fn image_size(file: &[u8]) -> Option<[u64; 2]> {
    if file.starts_with(b"\x89PNG\r\n\x1a\n") {
        let side = |at: usize| {
            file.get(at..at + 4)?
                .try_into()
                .ok()
                .map(u32::from_be_bytes)
        };
        return Some([side(16)?, side(20)?].map(u64::from));
    }
    if file.starts_with(b"GIF8") {
        let side = |at: usize| {
            file.get(at..at + 2)?
                .try_into()
                .ok()
                .map(u16::from_le_bytes)
        };
        return Some([side(6)?, side(8)?].map(u64::from));
    }
    None
}

/// `Event { wall_time = 1: double, step = 2: int64, summary = 5: Summary }` with `Summary { value = 1: Value }`
fn event(step: u64, wall_time_s: f64, value: &[u8]) -> Vec<u8> {
    let mut summary = Vec::with_capacity(value.len() + 16);
    bytes(&mut summary, 1, value);
    let mut event = Vec::new();
    fixed64(&mut event, 1, wall_time_s);
    integer(&mut event, 2, step);
    bytes(&mut event, 5, &summary);
    event
}

// The four kinds of protobuf fields used: a key (field number and wire type), then the
// value.

fn integer(message: &mut Vec<u8>, field: u8, value: u64) {
    message.push(field << 3);
    varint(message, value);
}

fn fixed64(message: &mut Vec<u8>, field: u8, value: f64) {
    message.push(field << 3 | 1);
    message.extend(value.to_le_bytes());
}

fn bytes(message: &mut Vec<u8>, field: u8, value: &[u8]) {
    message.push(field << 3 | 2);
    varint(message, value.len() as u64);
    message.extend(value);
}

fn fixed32(message: &mut Vec<u8>, field: u8, value: f32) {
    message.push(field << 3 | 5);
    message.extend(value.to_le_bytes());
}

fn varint(message: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        message.push(value as u8 | 0x80);
        value >>= 7;
    }
    message.push(value as u8);
}
