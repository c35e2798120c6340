//! A pasted text cut into records and cells, once for each separator that it may have. Called by
//! [`understand`](super::understand); knows no names and no numbers.

use std::ops::Range;

use super::names::is_unit;
use crate::cmm::written::{Marks, marks};

/// What stands between the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// Tabs, as spreadsheets copy.
    Tab,
    /// `;`
    Semicolon,
    /// `|`, as in Markdown and printed reports.
    Pipe,
    /// `,`
    Comma,
    /// Two or more blanks.
    AlignedBlanks,
    /// Single blanks.
    Blanks,
    /// One value per line.
    Lines,
}

impl Separator {
    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tab => "tabs",
            Self::Semicolon => "semicolons",
            Self::Pipe => "vertical bars",
            Self::Comma => "commas",
            Self::AlignedBlanks => "aligned blanks",
            Self::Blanks => "blanks",
            Self::Lines => "one value per line",
        }
    }
}

/// A cell and where it stands in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Cell {
    pub(super) text: String,
    pub(super) span: Range<usize>,
}

impl Cell {
    pub(super) fn is_number(&self) -> bool {
        marks(&self.text) != Marks::None
    }
}

/// A row of cells; rows without any text are left out.
#[derive(Debug, Clone)]
pub(super) struct Record {
    pub(super) cells: Vec<Cell>,
    pub(super) span: Range<usize>,
    pub(super) line: usize,
}

impl Record {
    pub(super) fn numbers(&self) -> usize {
        self.cells.iter().filter(|cell| cell.is_number()).count()
    }
}

/// The records of `text` for one separator.
pub(super) fn records(text: &str, separator: Separator) -> Vec<Record> {
    let mut records = match separator {
        Separator::Tab => separated(text, '\t'),
        Separator::Semicolon => separated(text, ';'),
        Separator::Comma => separated(text, ','),
        Separator::Pipe => separated(text, '|'),
        Separator::AlignedBlanks | Separator::Blanks | Separator::Lines => by_line(text, separator),
    };
    for record in &mut records {
        if separator == Separator::Pipe {
            // | a | b | has a bar at both ends
            if record.cells.first().is_some_and(|cell| cell.text.is_empty()) {
                record.cells.remove(0);
            }
        }
        while record.cells.last().is_some_and(|cell| cell.text.is_empty()) {
            record.cells.pop();
        }
    }
    // also |---|---|
    records.retain(|record| record.cells.iter().any(|cell| cell.text.chars().any(|c| !matches!(c, '-' | ':' | '='))));
    records
}

fn trimmed(text: &str, span: Range<usize>) -> Cell {
    let cell = &text[span.clone()];
    let start = span.start + cell.len() - cell.trim_start().len();
    let trimmed = cell.trim();
    Cell { text: trimmed.to_owned(), span: start..start + trimmed.len() }
}

/// Cells between separators; a cell in quotes may hold separators and line breaks.
fn separated(text: &str, separator: char) -> Vec<Record> {
    let mut records = Vec::new();
    let (mut at, mut line) = (0, 1);
    while at < text.len() {
        let (start, first_line) = (at, line);
        let mut cells = Vec::new();
        loop {
            let (cell, end) = quoted(text, at, separator).unwrap_or_else(|| {
                let end = text[at..].find([separator, '\n']).map_or(text.len(), |length| at + length);
                (trimmed(text, at..end), end)
            });
            line += text[at..end].matches('\n').count();
            cells.push(cell);
            at = end + 1;
            if !text[end..].starts_with(separator) {
                break;
            }
        }
        line += 1;
        let end = (at - 1).min(text.len());
        records.push(Record { cells, span: trimmed(text, start..end).span, line: first_line });
    }
    records
}

/// A cell in quotes that starts at `at`, if it ends before a separator or the end of a line.
fn quoted(text: &str, at: usize, separator: char) -> Option<(Cell, usize)> {
    const LONGEST: usize = 4000;
    let blanks = text[at..].len() - text[at..].trim_start_matches(' ').len();
    let inside = at + blanks + 1;
    if !text[at + blanks..].starts_with('"') {
        return None;
    }
    let mut content = String::new();
    let mut rest = text[inside..].char_indices().peekable();
    while let Some((offset, c)) = rest.next() {
        if offset > LONGEST {
            return None;
        }
        if c != '"' {
            content.push(if c == '\n' || c == '\r' { ' ' } else { c });
        } else if rest.next_if(|(_, next)| *next == '"').is_some() {
            content.push('"');
        } else {
            let end = inside + offset + 1;
            let tail = &text[end..];
            let stop = tail.find([separator, '\n']).unwrap_or(tail.len());
            // 12° 30' 15" is no cell in quotes
            return tail[..stop].trim().is_empty().then(|| {
                let content = content.split_whitespace().collect::<Vec<_>>().join(" ");
                (Cell { text: content, span: at + blanks..end }, end + stop)
            });
        }
    }
    None
}

fn by_line(text: &str, separator: Separator) -> Vec<Record> {
    let mut records = Vec::new();
    let mut start = 0;
    for (index, whole) in text.split_inclusive('\n').enumerate() {
        let line = trimmed(text, start..start + whole.len());
        start += whole.len();
        if line.text.is_empty() {
            continue;
        }
        let cells = match separator {
            // one column of a table whose cells are in quotes
            Separator::Lines => match quoted(text, line.span.start, '\n') {
                Some((cell, _)) if cell.span == line.span => vec![cell],
                _ => vec![line.clone()],
            },
            Separator::AlignedBlanks => aligned(text, &line.span),
            _ => joined(text, tokens(text, &line.span)),
        };
        records.push(Record { cells, span: line.span, line: index + 1 });
    }
    records
}

/// Cells between runs of two or more blanks.
fn aligned(text: &str, span: &Range<usize>) -> Vec<Cell> {
    let mut cells = Vec::new();
    let mut start = span.start;
    while start < span.end {
        let end = text[start..span.end].find("  ").map_or(span.end, |length| start + length);
        cells.push(trimmed(text, start..end));
        start = span.end - text[end..span.end].trim_start().len();
    }
    cells
}

fn tokens(text: &str, span: &Range<usize>) -> Vec<Cell> {
    let mut cells = Vec::new();
    let mut start = None;
    // a name and its value may be joined by a mark: pitch=12
    let breaks = |at: usize, c: char| matches!(c, '=' | ':') && !text[..at].ends_with(|c: char| c.is_ascii_digit());
    for (offset, c) in text[span.clone()].char_indices() {
        let at = span.start + offset;
        // blanks other than the plain one and the tab stand inside numbers
        let blank = matches!(c, ' ' | '\t' | '\r') || breaks(at, c);
        match (blank, start) {
            (false, None) => start = Some(at),
            (true, Some(from)) => {
                cells.push(trimmed(text, from..at));
                start = None;
            }
            _ => {}
        }
    }
    if let Some(from) = start {
        cells.push(trimmed(text, from..span.end));
    }
    cells
}

/// Tokens put together again: a sign and its number, a number and its unit, words of a label.
fn joined(text: &str, tokens: Vec<Cell>) -> Vec<Cell> {
    let mut cells: Vec<Cell> = Vec::new();
    let has_number = tokens.iter().any(Cell::is_number);
    for token in tokens {
        let join = cells.last().is_some_and(|last| {
            let sign = matches!(last.text.as_str(), "+" | "-" | "\u{2212}" | "\u{2013}") && token.is_number();
            let unit = is_unit(&token.text) && (last.is_number() || token.text.starts_with(['[', '(']));
            let signs = matches!(token.text.as_str(), "+" | "-" | "\u{2212}" | "\u{2013}");
            let label = has_number && !last.is_number() && !token.is_number() && !signs && cells.len() == 1;
            sign || unit || label
        });
        match cells.last_mut() {
            Some(last) if join => {
                last.span.end = token.span.end;
                text[last.span.clone()].clone_into(&mut last.text);
            }
            _ => cells.push(token),
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(text: &str, separator: Separator) -> Vec<Vec<String>> {
        let records = records(text, separator);
        records.into_iter().map(|record| record.cells.into_iter().map(|cell| cell.text).collect()).collect()
    }

    #[test]
    fn cells_of_every_separator() {
        assert_eq!(cells("a\tb\r\n1,5\t\n", Separator::Tab), [vec!["a", "b"], vec!["1,5"]]);
        assert_eq!(
            cells("\"pitch\n[µm]\";\"1,5\"\n12° 30' 15\";2", Separator::Semicolon),
            [vec!["pitch [µm]", "1,5"], vec!["12° 30' 15\"", "2"]]
        );
        assert_eq!(cells("| a | b |\n|---|---|\n| 1 | 2 |", Separator::Pipe), [vec!["a", "b"], vec!["1", "2"]]);
        assert_eq!(cells("a b   c\n1     - 2 um", Separator::AlignedBlanks), [vec!["a b", "c"], vec!["1", "- 2 um"]]);
        assert_eq!(cells("rack pitch: - 12,5 µm 13 µm", Separator::Blanks), [vec!["rack pitch", "- 12,5 µm", "13 µm"]]);
        assert_eq!(cells("a \"b\" c\n\n", Separator::Lines), [vec!["a \"b\" c"]]);
        assert_eq!(cells("\"a\"\n \"25,013\"\r\n\"b\" c\n", Separator::Lines), [["a"], ["25,013"], ["\"b\" c"]]);
        assert_eq!(cells("\"open, 1\n2", Separator::Comma), [vec!["\"open", "1"], vec!["2"]]);
    }
}
