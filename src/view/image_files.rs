//! Pictures into files: one PNG, an animated GIF, or a folder of PNG frames.

use crate::container::write_whole;
use crate::report::png_file;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// Where pictures go; which kind, the name says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// One picture.
    Png(PathBuf),
    /// An animation.
    Gif(PathBuf),
    /// A folder of PNG frames.
    Folder(PathBuf),
}

impl Output {
    /// `None` if the name's ending is no picture's.
    pub fn of(path: &Path) -> Option<Output> {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        match ending.as_ref().and_then(|ending| ending.to_str()) {
            None => Some(Output::Folder(path.to_path_buf())),
            Some("png") => Some(Output::Png(path.to_path_buf())),
            Some("gif") => Some(Output::Gif(path.to_path_buf())),
            Some(_) => None,
        }
    }

    /// The file or folder.
    pub fn path(&self) -> &Path {
        match self {
            Output::Png(path) | Output::Gif(path) | Output::Folder(path) => path,
        }
    }
}

/// A frame's name in a folder.
pub fn frame(folder: &Path, number: usize) -> PathBuf {
    folder.join(format!("frame-{number:05}.png"))
}

/// Takes an earlier film's frames out of a folder, lest they be taken for this one's.
///
/// # Errors
/// The folder cannot be read, or a frame cannot be removed.
pub fn clear(folder: &Path) -> Result<()> {
    let what = || format!("cannot clear the frames in {}", folder.display());
    for entry in std::fs::read_dir(folder).with_context(what)? {
        let path = entry.with_context(what)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("frame-") && name.ends_with(".png") {
            std::fs::remove_file(&path).with_context(what)?;
        }
    }
    Ok(())
}

/// Writes a PNG file.
///
/// # Errors
/// It cannot be written.
pub fn png(path: &Path, size: [u32; 2], rgb: &[u8]) -> Result<()> {
    Ok(png_file::save(path, size[0], size[1], rgb)?)
}

/// Most frames whose colours a palette is made from.
const SAMPLED: usize = 12;
/// Every so many pixels of them.
const STRIDE: usize = 7;

/// Writes an endless GIF of so many frames a second.
///
/// # Errors
/// The pictures are larger than a GIF holds, or the file cannot be written.
pub fn gif(path: &Path, size: [u32; 2], rate: u32, frames: &[Vec<u8>]) -> Result<()> {
    write_whole(path, &gif_file(size, rate, frames)?).context("the animation is lost")
}

/// The bytes of an endless GIF of so many frames a second: one palette for all frames, so that nothing
/// flickers, and of every frame only the pixels that change.
///
/// # Errors
/// The pictures are larger than a GIF holds.
pub fn gif_file(size: [u32; 2], rate: u32, frames: &[Vec<u8>]) -> Result<Vec<u8>> {
    let [width, height] = size.map(u16::try_from);
    let (width, height) = (width?, height?);
    let palette = Palette::of(frames);
    let mut bytes = Vec::new();
    let mut encoder = gif::Encoder::new(&mut bytes, width, height, &palette.colours())?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    let mut before: Option<Vec<u8>> = None;
    for (number, rgb) in frames.iter().enumerate() {
        let indices = palette.indices(rgb);
        let mut drawn = indices.clone();
        if let Some(before) = &before {
            for (index, before) in drawn.iter_mut().zip(before) {
                if index == before {
                    *index = CLEAR;
                }
            }
        }
        encoder.write_frame(&gif::Frame {
            width,
            height,
            delay: hundredths(number + 1, rate) - hundredths(number, rate),
            dispose: gif::DisposalMethod::Keep,
            transparent: Some(CLEAR),
            buffer: drawn.into(),
            ..Default::default()
        })?;
        before = Some(indices);
    }
    drop(encoder);
    Ok(bytes)
}

/// When a frame begins: GIFs count in hundredths of a second.
fn hundredths(number: usize, rate: u32) -> u16 {
    (number * 100 / rate as usize) as u16
}

/// The palette's last colour stands for what does not change.
const CLEAR: u8 = 255;

struct Palette(color_quant::NeuQuant);

impl Palette {
    fn of(frames: &[Vec<u8>]) -> Palette {
        let every = frames.len().div_ceil(SAMPLED).max(1);
        let pixels = frames.iter().step_by(every);
        let pixels = pixels.flat_map(|rgb| rgb.chunks_exact(3).step_by(STRIDE));
        let rgba: Vec<u8> = pixels.flat_map(|p| [p[0], p[1], p[2], 255]).collect();
        Palette(color_quant::NeuQuant::new(3, usize::from(CLEAR), &rgba))
    }

    fn colours(&self) -> Vec<u8> {
        let mut colours = self.0.color_map_rgb();
        colours.resize(3 * 256, 0);
        colours
    }

    fn indices(&self, rgb: &[u8]) -> Vec<u8> {
        let mut known = std::collections::HashMap::new();
        rgb.chunks_exact(3)
            .map(|p| {
                let colour = [p[0], p[1], p[2]];
                *known
                    .entry(colour)
                    .or_insert_with(|| self.0.index_of(&[p[0], p[1], p[2], 255]) as u8)
            })
            .collect()
    }
}
