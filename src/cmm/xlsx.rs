//! Excel workbooks (`.xlsx`).
//!
//! The command line reads the file and calls [`Workbook::open`]; [`Workbook::rows`] streams one sheet, the first that
//! has the columns unless one is named. Numbers come out as the shortest decimal that is the same double, which is what
//! was typed into the cell. A workbook is unpacked once to count its bytes before anything is parsed, so that a small
//! file that unpacks to a huge one is refused.

use std::io::{Cursor, Read as _};
use std::sync::mpsc;

use calamine::{DataRef, Reader as _, Xlsx};

use crate::diagnostic::{Code, Diagnostic};

/// Bytes of a sheet at most: a full one, a million rows of twenty columns.
const LARGEST_SHEET: u64 = 768 << 20;
/// Bytes at most of what is kept in memory as a whole: texts, styles, names.
const LARGEST_OTHER: u64 = 96 << 20;
/// Rows in which a header is looked for.
const HEADER_ROWS: usize = 60;
/// Columns of a sheet, as Excel has them.
const MOST_COLUMNS: u32 = 16_384;

type Book = Xlsx<Cursor<Vec<u8>>>;

/// A part of a sheet: `A1:F200`, `B:F`, `3:90`; counted from 0, ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellRange {
    columns: (u32, u32),
    rows: (u32, u32),
}

impl Default for CellRange {
    fn default() -> Self {
        Self { columns: (0, MOST_COLUMNS - 1), rows: (0, u32::MAX) }
    }
}

impl std::str::FromStr for CellRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || format!("`{text}` is not a range of cells: write A1:F200, B:F or 3:90");
        let (from, to) = text.split_once(':').unwrap_or((text, text));
        let whole = Self::default();
        let (from, to) = (corner(from).ok_or_else(bad)?, corner(to).ok_or_else(bad)?);
        if from.0.is_some() != to.0.is_some() || from.1.is_some() != to.1.is_some() {
            return Err(bad());
        }
        let ordered = |a: Option<u32>, b: Option<u32>, whole: (u32, u32)| match (a, b) {
            (Some(a), Some(b)) => (a.min(b), a.max(b)),
            _ => whole,
        };
        Ok(Self { columns: ordered(from.0, to.0, whole.columns), rows: ordered(from.1, to.1, whole.rows) })
    }
}

/// Column and row of `B12`, `$B$12`, `B` or `12`, from 0.
fn corner(text: &str) -> Option<(Option<u32>, Option<u32>)> {
    let text = text.trim().replace('$', "").to_ascii_uppercase();
    let letters = text.bytes().take_while(u8::is_ascii_uppercase).count();
    let (column, row) = text.split_at(letters);
    if text.is_empty() || column.len() > 3 || row.len() > 7 {
        return None;
    }
    let number = column.bytes().fold(0, |number, letter| number * 26 + u32::from(letter - b'A') + 1);
    let column = (!column.is_empty()).then_some(number.saturating_sub(1).min(MOST_COLUMNS - 1));
    let row = if row.is_empty() { None } else { Some(row.parse::<u32>().ok()?.checked_sub(1)?) };
    Some((column, row))
}

/// A workbook that was checked and opened.
pub struct Workbook {
    name: String,
    book: Book,
}

/// The number of a row, from 1, and its cells; or why the sheet cannot be read further.
pub type SheetRow = Result<(u32, Vec<String>), String>;

/// A sheet with its header found.
pub struct SheetRows {
    /// File and sheet, for messages.
    pub name: String,
    /// The header.
    pub columns: Vec<String>,
    /// Row number (from 1) and cells of each row below the header that is not empty.
    pub rows: Box<dyn Iterator<Item = SheetRow> + Send>,
    /// The header's row number, from 1.
    pub header_row: u32,
}

impl Workbook {
    /// Opens a workbook from its bytes; `name` is what messages call it.
    ///
    /// # Errors
    /// If it is no workbook, or unpacks to more than any sheet holds.
    pub fn open(name: &str, bytes: Vec<u8>) -> Result<Self, Diagnostic> {
        check(name, &bytes)?;
        let book = Xlsx::new(Cursor::new(bytes))
            .map_err(|error| unreadable(name, &format!("it is no Excel workbook ({error})")))?;
        Ok(Self { name: name.to_owned(), book })
    }

    /// The names of its sheets.
    #[must_use]
    pub fn sheets(&self) -> Vec<String> {
        self.book.sheet_names()
    }

    /// The rows of a sheet: the one of that name, or the first with a row in which `known` finds a column. That row is
    /// the header; in a sheet that was named, the first row is if none is known.
    ///
    /// # Errors
    /// If there is no such sheet, or none that has the columns.
    pub fn rows(
        mut self,
        sheet: Option<&str>,
        range: CellRange,
        known: &dyn Fn(&str) -> bool,
    ) -> Result<SheetRows, Diagnostic> {
        let sheets = self.sheets();
        let listed = || sheets.iter().map(|sheet| format!("`{sheet}`")).collect::<Vec<_>>().join(", ");
        let candidates: Vec<String> = match sheet {
            Some(wanted) if sheets.iter().any(|name| name == wanted) => vec![wanted.to_owned()],
            Some(wanted) => {
                let message = format!("{} has no sheet `{wanted}`", self.name);
                return Err(Diagnostic::error(Code::BadTable, message).help(format!("its sheets are {}", listed())));
            }
            None => sheets.clone(),
        };
        let mut problem = None;
        for candidate in candidates {
            match self.header(&candidate, range, known, sheet.is_some()) {
                Ok(Some((row, columns))) => return Ok(self.stream(candidate, range, row, columns)),
                Ok(None) => {}
                Err(error) => problem = Some(unreadable(&self.name, &format!("sheet `{candidate}`: {error}"))),
            }
        }
        Err(problem.unwrap_or_else(|| {
            let message = format!("no sheet of {} has a column that is known", self.name);
            Diagnostic::error(Code::BadTable, message)
                .help(format!("its sheets are {}; say which with --sheet, and where with --range", listed()))
        }))
    }

    /// The header's row number and cells.
    fn header(
        &mut self,
        sheet: &str,
        range: CellRange,
        known: &dyn Fn(&str) -> bool,
        named: bool,
    ) -> Result<Option<(u32, Vec<String>)>, String> {
        let mut best: Option<(usize, u32, Vec<String>)> = None;
        let mut first: Option<(u32, Vec<String>)> = None;
        let mut seen = 0;
        each_row(&mut self.book, sheet, range, &mut |row, cells| {
            let count = cells.iter().filter(|cell| known(cell)).count();
            if best.as_ref().is_none_or(|(most, ..)| count > *most) && count > 0 {
                best = Some((count, row, cells.clone()));
            }
            first.get_or_insert((row, cells));
            seen += 1;
            seen < HEADER_ROWS
        })?;
        Ok(best.map(|(_, row, cells)| (row, cells)).or(first.filter(|_| named)))
    }

    /// Reads on a thread of its own, a few rows ahead: the workbook's reader cannot be kept beside the workbook.
    fn stream(mut self, sheet: String, range: CellRange, header: u32, columns: Vec<String>) -> SheetRows {
        const AHEAD: usize = 256;
        let (sender, receiver) = mpsc::sync_channel(AHEAD);
        let name = format!("{}, sheet `{sheet}`", self.name);
        let width = columns.len();
        std::thread::spawn(move || {
            let rows = CellRange { rows: (range.rows.0.max(header), range.rows.1), ..range };
            let read = each_row(&mut self.book, &sheet, rows, &mut |row, mut cells| {
                // shorter rows end with empty cells
                if cells.len() < width {
                    cells.resize(width, String::new());
                }
                // the other end hangs up when it has seen enough
                sender.send(Ok((row, cells))).is_ok()
            });
            if let Err(problem) = read {
                let _ = sender.send(Err(problem));
            }
        });
        SheetRows { name, columns, rows: Box::new(receiver.into_iter()), header_row: header }
    }
}

/// Calls `take` with the number (from 1) and the cells of each row that is not empty, until it returns false.
fn each_row(
    book: &mut Book,
    sheet: &str,
    range: CellRange,
    take: &mut dyn FnMut(u32, Vec<String>) -> bool,
) -> Result<(), String> {
    let mut reader = book.worksheet_cells_reader(sheet).map_err(|error| error.to_string())?;
    let (mut row, mut cells): (u32, Vec<String>) = (0, Vec::new());
    loop {
        let cell = reader.next_cell().map_err(|error| error.to_string())?;
        let Some(cell) = cell else { break };
        let (at, column) = cell.get_position();
        if at != row {
            if cells.iter().any(|cell| !cell.is_empty()) && !take(row + 1, std::mem::take(&mut cells)) {
                return Ok(());
            }
            cells.clear();
            row = at;
        }
        if at > range.rows.1 {
            break;
        }
        if at < range.rows.0 || !(range.columns.0..=range.columns.1).contains(&column) {
            continue;
        }
        let index = (column - range.columns.0) as usize;
        let text = text(cell.get_value());
        if text.is_empty() {
            continue;
        }
        if cells.len() <= index {
            cells.resize(index + 1, String::new());
        }
        cells[index] = text;
    }
    if cells.iter().any(|cell| !cell.is_empty()) {
        take(row + 1, cells);
    }
    Ok(())
}

fn text(value: &DataRef<'_>) -> String {
    match value {
        DataRef::Int(number) => number.to_string(),
        DataRef::Float(number) => number.to_string(),
        DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => text.trim().to_owned(),
        DataRef::SharedString(text) => text.trim().to_owned(),
        DataRef::Bool(value) => value.to_string(),
        DataRef::DateTime(date) => date.as_f64().to_string(),
        DataRef::Error(error) => error.to_string(),
        DataRef::Empty => String::new(),
    }
}

fn unreadable(name: &str, problem: &str) -> Diagnostic {
    Diagnostic::error(Code::FileAccess, format!("cannot read {name}: {problem}"))
}

/// Unpacks every part that will be read, counting bytes and keeping none.
fn check(name: &str, bytes: &[u8]) -> Result<(), Diagnostic> {
    let no_workbook = |error: &dyn std::fmt::Display| unreadable(name, &format!("it is no Excel workbook ({error})"));
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| no_workbook(&error))?;
    let mut other = 0;
    for index in 0..archive.len() {
        let file = archive.by_index(index).map_err(|error| no_workbook(&error))?;
        let part = file.name().map_err(|error| no_workbook(&error))?.to_ascii_lowercase();
        let is_read = |suffix: &str| part.strip_suffix(suffix).is_some();
        if !is_read(".xml") && !is_read(".rels") {
            continue;
        }
        let is_sheet = part.starts_with("xl/worksheets/");
        let most = if is_sheet { LARGEST_SHEET } else { LARGEST_OTHER - other };
        let size =
            std::io::copy(&mut file.take(most + 1), &mut std::io::sink()).map_err(|error| no_workbook(&error))?;
        if size > most {
            return Err(unreadable(name, &format!("its part {part} unpacks to more than {} MiB", most >> 20)));
        }
        if !is_sheet {
            other += size;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(bytes: &[u8], sheet: Option<&str>, range: &str) -> Result<Vec<String>, String> {
        let range = if range.is_empty() { CellRange::default() } else { range.parse()? };
        let book = Workbook::open("lot.xlsx", bytes.to_vec()).map_err(|error| error.to_string())?;
        let found = book
            .rows(sheet, range, &|cell| cell.starts_with("rack_"))
            .map_err(|error| format!("{error} | {}", error.help.clone().unwrap_or_default()))?;
        let mut all = vec![format!("{}: {}", found.name, found.columns.join("|"))];
        all.extend(found.rows.map(|row| {
            let (number, cells) = row.expect("a row");
            format!("{number}: {}", cells.join("|"))
        }));
        Ok(all)
    }

    fn workbook() -> Vec<u8> {
        let mut book = rust_xlsxwriter::Workbook::new();
        let cover = book.add_worksheet();
        cover.set_name("Deckblatt").expect("a name").write_string(0, 0, "Auftrag").expect("a cell");
        let lot = book.add_worksheet();
        lot.set_name("Lot 7").expect("a name");
        lot.write_string(1, 0, "gemessen am 3.4.").expect("a cell");
        for (column, name) in ["Teil", "rack_over_roller [mm]", "rack_pitch [um]"].iter().enumerate() {
            lot.write_string(3, u16::try_from(column).expect("few"), *name).expect("a cell");
        }
        for (row, (name, over_roller)) in [(4, ("a1", 25.0131)), (6, ("a2", 0.1 + 0.2))] {
            lot.write_string(row, 0, name).expect("a cell").write_number(row, 1, over_roller).expect("a cell");
        }
        lot.write_number(6, 2, 12).expect("a cell");
        book.save_to_buffer().expect("a workbook")
    }

    #[test]
    fn the_first_sheet_with_the_columns() {
        let book = workbook();
        let expected = [
            "lot.xlsx, sheet `Lot 7`: Teil|rack_over_roller [mm]|rack_pitch [um]",
            "5: a1|25.0131|",
            "7: a2|0.30000000000000004|12",
        ];
        assert_eq!(rows(&book, None, "").unwrap(), expected);
        assert_eq!(rows(&book, Some("Lot 7"), "").unwrap(), expected);
        let part = ["lot.xlsx, sheet `Lot 7`: rack_over_roller [mm]", "5: 25.0131"];
        assert_eq!(rows(&book, None, "$B$4:B5").unwrap(), part);
        assert_eq!(rows(&book, Some("Deckblatt"), "A:A").unwrap(), ["lot.xlsx, sheet `Deckblatt`: Auftrag"]);
        let none = rows(&book, Some("Lot 8"), "").unwrap_err();
        assert!(none.contains("no sheet `Lot 8` | its sheets are `Deckblatt`, `Lot 7`"), "{none}");
        assert!(rows(&book, None, "C1:C3").unwrap_err().contains("no sheet of lot.xlsx has a column that is known"));
    }

    #[test]
    fn ranges() {
        assert_eq!("b2:c9".parse(), Ok(CellRange { columns: (1, 2), rows: (1, 8) }));
        assert_eq!("AA:Z".parse(), Ok(CellRange { columns: (25, 26), rows: (0, u32::MAX) }));
        assert_eq!("9:3".parse(), Ok(CellRange { columns: (0, MOST_COLUMNS - 1), rows: (2, 8) }));
        for text in ["", "A0:B2", "A1:B", "1A", "ABCD1", "A1:B2:C3", "A99999999"] {
            assert!(text.parse::<CellRange>().is_err(), "{text}");
        }
    }

    #[test]
    fn what_is_no_workbook_or_unpacks_to_too_much_is_refused() {
        assert!(rows(b"PK\x03\x04", None, "").unwrap_err().contains("cannot read lot.xlsx: it is no Excel workbook"));
        assert!(rows(b"", None, "").is_err());
        let book = workbook();
        for cut in [10, book.len() / 2, book.len() - 30] {
            assert!(rows(&book[..cut], None, "").is_err());
        }
        let mut bomb = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
        bomb.start_file("xl/sharedStrings.xml", options).expect("a part");
        for _ in 0..97 {
            std::io::Write::write_all(&mut bomb, &vec![b' '; 1 << 20]).expect("written");
        }
        let bomb = bomb.finish().expect("an archive").into_inner();
        assert!(bomb.len() < 200_000);
        let refused = rows(&bomb, None, "").unwrap_err();
        assert!(refused.contains("unpacks to more than 96 MiB"), "{refused}");
    }
}
