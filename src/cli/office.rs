//! Rows of results in formats that need more than one row at a time: Excel workbooks and Q-DAS files of `paste` and `batch`, and
//! tables for people and arrays of JSON of `batch`.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use super::target;
use crate::judge::Limits;
use crate::report::xlsx::Book;
use crate::report::{self, Format, QdasRows, RowsReport, Screen};

/// Whether results for a file of that name are a workbook or a Q-DAS file.
pub(super) fn is_office(path: &str) -> bool {
    ["xlsx", "dfq"].contains(&target::ending(path).as_str())
}

/// Rows that become such a file. Its input is rows of CSV, a line each, header first; for an array, lines of JSON.
pub(super) struct FormedRows<W> {
    out: W,
    kind: Kind,
    /// The beginning of a line whose end is still to come.
    rest: Vec<u8>,
}

enum Kind {
    /// A workbook, written at the end; with its name.
    Book(Box<Book>, String),
    Qdas(QdasRows),
    /// Rows waiting for the next piece of the table, the header first.
    Table(Vec<Vec<String>>, Shown),
    /// Whether the array has rows so far.
    Array(bool),
}

/// How a table for people is shown.
#[derive(Clone, Copy)]
struct Shown {
    format: Format,
    screen: Screen,
    /// Whether numbers stay as written.
    as_written: bool,
    /// How many columns behind the first one are copied.
    copied: usize,
}

/// Rows of a table that are laid out together.
const ROWS_TOGETHER: usize = 1000;

impl<W: Write + Send> FormedRows<W> {
    /// Rows with these limits for a file of this name; a Q-DAS file calls them `part`.
    pub(super) fn new(path: &str, out: W, (part, limits): (&str, &Limits)) -> io::Result<Self> {
        let kind = match target::ending(path).as_str() {
            "dfq" => Kind::Qdas(QdasRows::new(part, limits)),
            _ => Kind::Book(Box::new(Book::new("rackmesh", target::temporary(path.as_ref())?)?), path.to_owned()),
        };
        Ok(Self { out, kind, rest: Vec::new() })
    }

    /// A table for people, in pieces with a heading each; numbers have four decimals, or stay as written.
    pub(super) fn table(out: W, format: Format, screen: Screen, as_written: bool) -> Self {
        let shown = Shown { format, screen, as_written, copied: 0 };
        Self { out, kind: Kind::Table(Vec::new(), shown), rest: Vec::new() }
    }

    /// An array of JSON objects.
    pub(super) fn array(out: W) -> Self {
        Self { out, kind: Kind::Array(false), rest: Vec::new() }
    }

    fn push(&mut self, row: &[&str]) -> io::Result<()> {
        match &mut self.kind {
            Kind::Book(book, name) => book.push(row).map_err(|error| target::named(name, &error)),
            Kind::Qdas(rows) => self.out.write_all(&rows.lines(row)),
            Kind::Table(rows, shown) => {
                rows.push(row.iter().map(|cell| (*cell).to_owned()).collect());
                if rows.len() > ROWS_TOGETHER { write_piece(rows, *shown, &mut self.out) } else { Ok(()) }
            }
            Kind::Array(_) => Ok(()),
        }
    }

    /// Says that so many columns behind the first one are those of the table.
    pub(super) fn with_copied(&mut self, count: usize) {
        match &mut self.kind {
            Kind::Book(book, _) => book.copied = count,
            Kind::Table(_, shown) => shown.copied = count,
            Kind::Qdas(_) | Kind::Array(_) => {}
        }
    }

    /// Writes the rest, except for a workbook in a run that is to `stop`; returns whether it is written. A workbook has a sheet of
    /// notes.
    pub(super) fn finish(mut self, notes: &[String], stop: &AtomicBool) -> io::Result<bool> {
        match self.kind {
            Kind::Book(book, _) => match book.save(notes, Stopped { out: &mut self.out, stop, has_failed: false }) {
                Err(_) if stop.load(Ordering::Relaxed) => return Ok(false),
                saved => saved?,
            },
            Kind::Table(mut rows, shown) => write_piece(&mut rows, shown, &mut self.out)?,
            Kind::Array(has_rows) => self.out.write_all(if has_rows { b"\n]\n" } else { b"[]\n" })?,
            Kind::Qdas(_) => {}
        }
        self.out.flush()?;
        Ok(true)
    }
}

/// Writes rows below the header as a table, and keeps the header.
fn write_piece(rows: &mut Vec<Vec<String>>, shown: Shown, out: &mut dyn Write) -> io::Result<()> {
    let Shown { format, screen, as_written, copied } = shown;
    if rows.len() > 1 {
        out.write_all(report::write(&RowsReport { rows, as_written, copied }, format, screen)?.as_bytes())?;
        rows.truncate(1);
    }
    Ok(())
}

impl<W: Write + Send> Write for FormedRows<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.rest.extend_from_slice(bytes);
        // a line break ends a row: those within a cell are escaped
        let end = self.rest.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        let rest = self.rest.split_off(end);
        let lines = std::mem::replace(&mut self.rest, rest);
        if let Kind::Array(has_rows) = &mut self.kind {
            for line in lines.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
                self.out.write_all(if std::mem::replace(has_rows, true) { b",\n" } else { b"[\n" })?;
                self.out.write_all(line)?;
            }
            return Ok(bytes.len());
        }
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(lines.as_slice());
        let mut row = csv::StringRecord::new();
        while reader.read_record(&mut row)? {
            self.push(&row.iter().collect::<Vec<_>>())?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A writer that takes no more once the run is to end. Bytes after an error are dropped: the library ends its archive in any case,
/// and would report a failure of that.
struct Stopped<'o, W> {
    out: &'o mut W,
    stop: &'o AtomicBool,
    has_failed: bool,
}

impl<W: Write> Write for Stopped<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.has_failed {
            return Ok(bytes.len());
        }
        let is_over = self.stop.load(Ordering::Relaxed);
        let written = if is_over { Err(io::Error::other("interrupted")) } else { self.out.write(bytes) };
        self.has_failed = written.as_ref().is_err_and(|error| error.kind() != io::ErrorKind::Interrupted);
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.has_failed { Ok(()) } else { self.out.flush() }
    }
}

/// Rows with a header as such a file.
pub(super) fn bytes(path: &str, rows: &[Vec<String>], named: (&str, &Limits), notes: &[String]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut office = FormedRows::new(path, &mut bytes, named)?;
    for row in rows {
        office.push(&row.iter().map(String::as_str).collect::<Vec<_>>())?;
    }
    office.finish(notes, &AtomicBool::new(false))?;
    Ok(bytes)
}
