//! Small tables for the terminal.

/// A table as text: a line of headers, a rule, then the rows, each line ended.
///
/// Columns in which every cell is a number (a sign, digits, perhaps a unit) or a blank
/// are aligned to the right, the others to the left. Short rows are filled with blanks,
/// cells beyond the headers are left out.
pub fn table(headers: &[&str], rows: &[Vec<String>]) -> String {
    let columns: Vec<Column> = headers
        .iter()
        .enumerate()
        .map(|(index, header)| Column::new(header, rows.iter().map(|row| cell(row, index))))
        .collect();
    let rule = columns.iter().map(|column| "─".repeat(column.width));
    let mut text = line(columns.iter().zip(headers).map(|(c, header)| c.pad(header)));
    text += &line(rule);
    for row in rows {
        let cells = columns.iter().enumerate();
        text += &line(cells.map(|(index, column)| column.pad(cell(row, index))));
    }
    text
}

struct Column {
    width: usize,
    numbers: bool,
}

impl Column {
    fn new<'a>(header: &str, cells: impl Iterator<Item = &'a str> + Clone) -> Self {
        let widths = cells.clone().map(length);
        Self {
            width: widths.fold(length(header), usize::max),
            numbers: cells.clone().any(is_number)
                && cells
                    .into_iter()
                    .all(|cell| is_number(cell) || is_blank(cell)),
        }
    }

    fn pad(&self, cell: &str) -> String {
        if self.numbers {
            format!("{cell:>width$}", width = self.width)
        } else {
            format!("{cell:<width$}", width = self.width)
        }
    }
}

fn cell(row: &[String], index: usize) -> &str {
    row.get(index).map_or("", String::as_str)
}

fn length(text: &str) -> usize {
    text.chars().count()
}

fn is_number(cell: &str) -> bool {
    let unsigned = cell.trim_start_matches(['+', '-', '\u{2212}', '.']);
    unsigned.starts_with(|first: char| first.is_ascii_digit())
}

/// How a missing number is written.
fn is_blank(cell: &str) -> bool {
    matches!(cell, "" | "-" | "–" | "—" | "NaN")
}

fn line(cells: impl Iterator<Item = String>) -> String {
    let cells: Vec<String> = cells.collect();
    format!("{}\n", cells.join("  ").trim_end())
}
