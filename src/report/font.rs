//! The one font of all pictures, embedded in the program.
//!
//! Ubuntu Light (Ubuntu Font Licence 1.0) is part of the program, so a picture looks
//! the same on a machine that has no fonts at all.

use std::sync::OnceLock;

use ab_glyph::{Font, FontRef, Glyph, OutlinedGlyph, PxScale, ScaleFont, point};

use super::ReportError;

/// One line of text as shapes: the origin lies at the left end, at half the height of
/// a capital letter, with y downwards.
pub struct Line {
    /// Outlines of the glyphs.
    pub glyphs: Vec<OutlinedGlyph>,
    /// Pixels from the origin to where a next letter would start.
    pub width: f32,
}

/// Sets `text` in a font `size` pixels high.
///
/// # Errors
///
/// If the embedded font cannot be read.
pub fn line(text: &str, size: f32) -> Result<Line, ReportError> {
    let font = face()?.as_scaled(size);
    let baseline = font
        .outline_glyph(font.scaled_glyph('H'))
        .map_or(0.0, |capital| capital.px_bounds().height() / 2.0);
    let mut glyphs = Vec::with_capacity(text.len());
    let mut width = 0.0;
    let mut previous = None;
    for id in text.chars().map(|letter| font.glyph_id(letter)) {
        width += previous.map_or(0.0, |previous| font.kern(previous, id));
        glyphs.extend(font.outline_glyph(Glyph {
            id,
            scale: PxScale::from(size),
            position: point(width, baseline),
        }));
        width += font.h_advance(id);
        previous = Some(id);
    }
    Ok(Line { glyphs, width })
}

/// The font, read once.
fn face() -> Result<&'static FontRef<'static>, ReportError> {
    static FACE: OnceLock<Option<FontRef<'static>>> = OnceLock::new();
    FACE.get_or_init(|| FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).ok())
        .as_ref()
        .ok_or_else(|| ReportError::Draw("the embedded font is not readable".to_owned()))
}
