//! Results as Excel workbooks and Q-DAS files, for `paste` and `batch`.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use super::target;
use crate::judge::Limits;
use crate::report::QdasRows;
use crate::report::xlsx::Book;

/// Whether results for a file of that name are a workbook or a Q-DAS file.
pub(super) fn is_office(path: &str) -> bool {
    ["xlsx", "dfq"].contains(&target::ending(path).as_str())
}

/// Rows that become such a file. What is written to it are rows of CSV, a line each, header first.
pub(super) struct OfficeRows<W> {
    out: W,
    kind: Kind,
    /// The beginning of a line whose end is still to come.
    rest: Vec<u8>,
}

enum Kind {
    /// A workbook is written in one go, at the end.
    Book(Box<Book>),
    Qdas(QdasRows),
}

impl<W: Write + Send> OfficeRows<W> {
    /// Rows with these limits for a file of this name; `part` is what a Q-DAS file calls them.
    pub(super) fn new(path: &str, out: W, (part, limits): (&str, &Limits)) -> io::Result<Self> {
        let kind = match target::ending(path).as_str() {
            "dfq" => Kind::Qdas(QdasRows::new(part, limits)),
            _ => Kind::Book(Box::new(Book::new("rackmesh")?)),
        };
        Ok(Self { out, kind, rest: Vec::new() })
    }

    fn push(&mut self, row: &[&str]) -> io::Result<()> {
        match &mut self.kind {
            Kind::Book(book) => book.push(row),
            Kind::Qdas(rows) => self.out.write_all(&rows.lines(row)),
        }
    }

    /// Writes what is left, unless that is a workbook and the run is to `stop`; whether it is written.
    pub(super) fn finish(mut self, stop: &AtomicBool) -> io::Result<bool> {
        if let Kind::Book(book) = self.kind {
            match book.save(Stopped { out: &mut self.out, stop, has_failed: false }) {
                Err(_) if stop.load(Ordering::Relaxed) => return Ok(false),
                saved => saved?,
            }
        }
        self.out.flush()?;
        Ok(true)
    }
}

impl<W: Write + Send> Write for OfficeRows<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.rest.extend_from_slice(bytes);
        // a line break ends a row: those within a cell are escaped
        let end = self.rest.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        let rest = self.rest.split_off(end);
        let lines = std::mem::replace(&mut self.rest, rest);
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

/// A place that takes no more once the run is to end. What comes behind an error is dropped: the library ends its archive
/// whatever happened, and would say that this fails.
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
pub(super) fn bytes(path: &str, rows: &[Vec<String>], named: (&str, &Limits)) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut office = OfficeRows::new(path, &mut bytes, named)?;
    for row in rows {
        office.push(&row.iter().map(String::as_str).collect::<Vec<_>>())?;
    }
    office.finish(&AtomicBool::new(false))?;
    Ok(bytes)
}
