//! Where the levels of a curriculum begin, as in the paper's figure 5.

use crate::report::ReportError;
use crate::report::canvas::{Anchor, Canvas, Pixel, text_width};
use crate::report::chart::{self, Plot};

/// The beginning of a curriculum's level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// Environment steps taken by then.
    pub steps: u64,
    /// Its number.
    pub level: usize,
}

/// A dashed line where each level begins.
pub fn draw_lines(
    canvas: &mut Canvas<'_>,
    plot: &Plot,
    levels: &[Level],
) -> Result<(), ReportError> {
    for level in levels {
        if level.steps as f64 <= plot.x.max {
            let (x, _) = plot.at(level.steps as f64, plot.y.min);
            let (top, bottom) = (plot.frame.top, plot.frame.bottom);
            canvas.dashes((x, top), (x, bottom), chart::FRAME, 1.6)?;
        }
    }
    Ok(())
}

/// The numbers of levels that begin so close together that they share a label.
pub struct Numbers {
    /// The first number, and the position of its line, in pixels from the left.
    first: (usize, f64),
    last: (usize, f64),
}

impl Numbers {
    fn text(&self) -> String {
        let (first, last) = (self.first.0, self.last.0);
        if first == last {
            format!("{first}")
        } else {
            format!("{first}\u{2013}{last}")
        }
    }

    fn middle(&self) -> f64 {
        f64::midpoint(self.first.1, self.last.1)
    }

    /// The left and the right end of the text, in pixels.
    fn ends(&self) -> Result<(f64, f64), ReportError> {
        let half = text_width(&self.text(), chart::SMALL)? / 2.0;
        Ok((self.middle() - half, self.middle() + half))
    }

    fn crowds(&self, next: &Self) -> Result<bool, ReportError> {
        const ROOM: f64 = 10.0;
        Ok(next.ends()?.0 < self.ends()?.1 + ROOM)
    }
}

/// Puts each level's number above its line, `end` steps from the left to the right pixel; neighbours
/// without room for two become one.
pub fn place_numbers(
    levels: &[Level],
    end: f64,
    [left, right]: [f64; 2],
) -> Result<Vec<Numbers>, ReportError> {
    let mut sorted: Vec<&Level> = levels.iter().collect();
    sorted.retain(|level| level.steps as f64 <= end);
    sorted.sort_by_key(|level| (level.steps, level.level));
    let mut placed: Vec<Numbers> = Vec::with_capacity(sorted.len());
    for level in sorted {
        let x = left + (right - left) * level.steps as f64 / end;
        let mut next = Numbers {
            first: (level.level, x),
            last: (level.level, x),
        };
        // A shared label is wider than either number and may crowd the one before.
        while let Some(before) = placed.pop() {
            if !before.crowds(&next)? {
                placed.push(before);
                break;
            }
            next.first = before.first;
        }
        placed.push(next);
    }
    Ok(placed)
}

/// Writes the numbers at height `y`, and what they are to the left of `left`.
pub fn draw_numbers(
    canvas: &mut Canvas<'_>,
    numbers: &[Numbers],
    (left, y): Pixel,
) -> Result<(), ReportError> {
    if numbers.is_empty() {
        return Ok(());
    }
    let at = (left - 32.0, y);
    canvas.text("level", at, Anchor::Right, chart::SMALL, chart::MUTED)?;
    numbers.iter().try_for_each(|numbers| {
        let at = (numbers.middle(), y);
        let text = numbers.text();
        canvas.text(&text, at, Anchor::Centre, chart::SMALL, chart::MUTED)
    })
}
