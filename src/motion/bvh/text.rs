//! From the bytes of a file to text with one kind of line end.

use super::fault::problem;
use crate::motion::error::MotionResult;
use std::borrow::Cow;
use std::path::Path;

/// The text of a file in UTF-8, or in UTF-16 as some programs on Windows write it.
pub fn decode<'a>(bytes: &'a [u8], path: &Path) -> MotionResult<Cow<'a, str>> {
    match bytes {
        [0xff, 0xfe, ..] | [b'H' | b'h', 0, ..] => utf16(bytes, u16::from_le_bytes, path),
        [0xfe, 0xff, ..] | [0, b'H' | b'h', ..] => utf16(bytes, u16::from_be_bytes, path),
        _ => utf8(bytes, path),
    }
}

fn utf16<'a>(bytes: &[u8], unit: fn([u8; 2]) -> u16, path: &Path) -> MotionResult<Cow<'a, str>> {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    let mut text = String::with_capacity(bytes.len() / 2);
    for decoded in char::decode_utf16(units) {
        text.push(decoded.map_err(|_| {
            let line = 1 + text.matches('\n').count();
            problem(
                path,
                line,
                "broken UTF-16; save the file as plain text in UTF-8",
            )
        })?);
    }
    Ok(Cow::Owned(text))
}

fn utf8<'a>(bytes: &'a [u8], path: &Path) -> MotionResult<Cow<'a, str>> {
    let valid = match std::str::from_utf8(bytes) {
        Ok(text) => return Ok(Cow::Borrowed(text)),
        Err(error) => error.valid_up_to(),
    };
    let line = 1 + bytes[..valid].iter().filter(|&&b| b == b'\n').count();
    Err(problem(
        path,
        line,
        "bytes that are not UTF-8: a binary file, or joint names in another encoding; save a text as UTF-8, as `iconv -f ENCODING -t UTF-8` does",
    ))
}

/// The text without a byte order mark, without what old systems put behind the last line (NUL, Ctrl-Z),
/// and with every line end, a lone CR too, as LF.
pub fn clean(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let text = text.trim_end_matches(|c: char| c.is_whitespace() || matches!(c, '\0' | '\u{1a}'));
    match text.contains('\r') {
        true => Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n")),
        false => Cow::Borrowed(text),
    }
}

/// Whether a comment begins with this word: it goes on to the end of the line.
pub fn is_comment(word: &str) -> bool {
    word.starts_with('#') || word.starts_with("//")
}
