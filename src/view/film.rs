//! Something that goes on frame by frame before a camera.

use super::image_files::gif_file;
use anyhow::Result;

/// Frames of the motion a second.
pub const RATE: u32 = 30;

/// Something that goes on frame by frame before a camera.
pub trait Film {
    /// Goes on by so many frames.
    ///
    /// # Errors
    /// The controller's.
    fn skip(&mut self, frames: usize) -> Result<()>;

    /// The present frame, RGB.
    ///
    /// # Errors
    /// The GPU was lost.
    fn picture(&mut self) -> Result<Vec<u8>>;
}

/// The next seconds of a film as a GIF file of `rate` pictures a second, which divides [`RATE`].
///
/// # Errors
/// Those of the film, or its pictures are larger than a GIF holds.
pub fn gif(film: &mut dyn Film, seconds: f32, rate: u32, size: [u32; 2]) -> Result<Vec<u8>> {
    let count = ((seconds * rate as f32).round() as usize).max(1);
    let mut frames = Vec::with_capacity(count);
    for _ in 0..count {
        frames.push(film.picture()?);
        film.skip((RATE / rate) as usize)?;
    }
    gif_file(size, rate, &frames)
}
