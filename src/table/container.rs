//! The kinds of files that hold tables, recognised by their bytes and not by their names. Called by the command line with every
//! file.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek as _};

use bytes::Bytes;

use super::Table;
use super::account::{Proposal, Unclosed};
use super::encoding::{decode, peek, recoded, unpacked};
use super::parquet::ParquetTable;
use super::qdas::{Qdas, qdas_table, read_all};
use super::report::is_numbered_report;
use super::text::Text;
use super::typed::{parquet_table, workbook_table};
use super::want::Want;
use super::workbook::{KnownWorkbook, Workbook};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};

/// Where the bytes of a table are.
pub enum Source {
    /// A file, of which no more is read than is needed.
    File(File),
    /// A file whose workbook was opened before.
    #[doc(hidden)]
    Known(File, KnownWorkbook),
    /// Bytes that come once.
    Stream(Box<dyn Read + Send>),
}

/// A file whose kind is known and whose table is not read yet.
pub enum Container {
    /// Text.
    #[doc(hidden)]
    Text(Text),
    /// An Excel workbook.
    Workbook(Box<Workbook>),
    /// A Q-DAS file, as measuring programs and statistics software exchange it.
    Qdas(Box<Qdas>),
    /// A Parquet file.
    #[doc(hidden)]
    Parquet(ParquetTable),
}

/// The largest file of a kind that is not streamed, bytes.
const LARGEST_FILE: usize = 64 << 20;
/// What a Parquet file starts with.
const PARQUET: &[u8; 4] = b"PAR1";
/// What a workbook starts with, as any archive of that kind.
const ARCHIVE: &[u8; 4] = b"PK\x03\x04";

impl Source {
    /// Bytes in memory.
    #[must_use]
    pub fn bytes(bytes: Vec<u8>) -> Self {
        Self::Stream(Box::new(Cursor::new(bytes)))
    }

    fn reader(self) -> Box<dyn Read + Send> {
        match self {
            Self::File(file) | Self::Known(file, _) => Box::new(file),
            Self::Stream(stream) => stream,
        }
    }
}

impl Container {
    /// Recognises a file by its first bytes; `name` is what messages call it.
    ///
    /// # Errors
    /// If it cannot be read, or is a file that holds no table.
    pub fn open(name: &str, source: Source, want: &Want) -> Result<Self, Diagnostics> {
        let failed = |error: io::Error| Diagnostic::unreadable(name, &error);
        let (source, known) = match source {
            Source::Known(file, known) => (Source::File(file), Some(known)),
            source => (source, None),
        };
        let source = match source {
            Source::File(file) if starts_with(&file, *PARQUET).map_err(failed)? => {
                return Ok(Self::Parquet(ParquetTable::open(name, file)?));
            }
            Source::File(file) if starts_with(&file, *ARCHIVE).map_err(failed)? => {
                refuse_large(name, file.metadata().map_err(failed)?.len())?;
                return Ok(Self::Workbook(Box::new(Workbook::open_file(name, file, known)?)));
            }
            source => source,
        };
        let peeked = unpacked(source.reader()).and_then(|bytes| peek(bytes, 512)).map_err(failed)?;
        match peeked.start.as_slice() {
            start if start.starts_with(ARCHIVE) => {
                Ok(Self::Workbook(Box::new(Workbook::open(name, Cursor::new(whole(name, peeked.bytes)?))?)))
            }
            start if start.starts_with(PARQUET) => {
                Ok(Self::Parquet(ParquetTable::open(name, Bytes::from(whole(name, peeked.bytes)?))?))
            }
            start => {
                refuse_foreign(name, start)?;
                let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default();
                if matches!(ending.as_str(), "xlsx" | "xlsm" | "parquet") {
                    let message = format!("{name} is not what its name says: it is no .{ending} file");
                    return Err(Diagnostic::error(Code::BadTable, message)
                        .help("give it the ending of what it is")
                        .into());
                }
                if want.layout.sheet.is_some() || want.layout.range != super::workbook::CellRange::default() {
                    let message = format!("a sheet and a range are of Excel workbooks, and {name} is none");
                    return Err(Diagnostic::error(Code::Usage, message)
                        .help("save it as .xlsx, or leave them out")
                        .into());
                }
                let mut text = Text::open(name, peeked.bytes, want.layout.encoding)?;
                if text.is_qdas()? {
                    let files = vec![(name.to_owned(), text.into_reader())];
                    return Ok(Self::Qdas(Box::new(read_all(files, &want.layout.comments)?)));
                }
                if start.contains(&0x0f) || start.contains(&0x14) {
                    let message = format!("{name} holds values of Q-DAS without their definitions");
                    let help = "put its file of definitions (.dfd) beside it, under the same name";
                    return Err(Diagnostic::error(Code::BadTable, message).help(help).into());
                }
                Ok(Self::Text(text))
            }
        }
    }

    /// A Q-DAS file of definitions (`.dfd`) with that of its values (`.dfx`).
    ///
    /// # Errors
    /// If one of them cannot be read, or makes no sense.
    pub fn qdas_pair(definitions: (&str, Source), values: (&str, Source), want: &Want) -> Result<Self, Diagnostics> {
        let mut files = Vec::new();
        for (name, source) in [definitions, values] {
            let (text, _) = recoded(source.reader(), None).map_err(|error| Diagnostic::unreadable(name, &error))?;
            files.push((name.to_owned(), text));
        }
        Ok(Self::Qdas(Box::new(read_all(files, &want.layout.comments)?)))
    }

    /// What the file says of its characteristics, if it is of a format that does.
    #[must_use]
    pub fn qdas(&self) -> Option<&Qdas> {
        match self {
            Self::Qdas(qdas) => Some(qdas),
            _ => None,
        }
    }

    /// What was found of a workbook in a file, with which the file is opened again at less cost.
    #[doc(hidden)]
    #[must_use]
    pub fn known(&self) -> Option<KnownWorkbook> {
        if let Self::Workbook(book) = self { book.known() } else { None }
    }

    /// The table, with its columns found and its rows not read yet.
    ///
    /// # Errors
    /// If there is no table, or something in it has no owner.
    pub fn table(self, name: &str, want: &Want) -> Result<Table, Diagnostics> {
        Ok(self.closed(name, want)?)
    }

    fn closed(self, name: &str, want: &Want) -> Result<Table, Unclosed> {
        match self {
            Self::Text(text) => text.table(want),
            Self::Workbook(book) => workbook_table(*book, want),
            Self::Qdas(qdas) => Ok(qdas_table(name, *qdas, want)?),
            Self::Parquet(table) => parquet_table(name, table, want),
        }
    }

    /// What would close the table. A table that is closed is read to its end.
    ///
    /// # Errors
    /// If there is no table, or it cannot be read to its end.
    pub fn proposal(self, name: &str, want: &Want) -> Result<Proposal, Diagnostics> {
        match self.closed(name, want) {
            Ok(table) => Proposal::of_table(table, want),
            Err(Unclosed::Open(proposal)) => Ok(*proposal),
            Err(Unclosed::Wrong(problems)) => Err(problems),
        }
    }
}

/// Whether a file starts with a mark. A pipe is not looked at here, because it cannot be read again from its start.
fn starts_with(mut file: &File, mark: [u8; 4]) -> io::Result<bool> {
    if file.stream_position().is_err() {
        return Ok(false);
    }
    let mut start = [0; 4];
    let count = file.read(&mut start)?;
    file.rewind()?;
    Ok(start[..count] == mark)
}

/// Refuses a file of that many bytes if it is too large for its kind.
fn refuse_large(name: &str, bytes: u64) -> Result<(), Diagnostic> {
    if bytes <= LARGEST_FILE as u64 {
        return Ok(());
    }
    let problem = Diagnostic::unreadable(name, &format!("it is larger than {} MiB", LARGEST_FILE >> 20));
    Err(problem.help("export the table as CSV, which is read at any size"))
}

/// Refuses kinds of files that are not read, by their first bytes.
fn refuse_foreign(name: &str, start: &[u8]) -> Result<(), Diagnostic> {
    let save = "save the table as .xlsx or .csv";
    let refused =
        |what: &str, help: &str| Err(Diagnostic::error(Code::BadTable, format!("{name} is {what}")).help(help));
    let lower = String::from_utf8_lossy(start).trim_start().to_lowercase();
    match start {
        [0xd0, 0xcf, 0x11, 0xe0, ..] => refused("a workbook of the old Excel format (.xls)", save),
        [b'%', b'P', b'D', b'F', ..] => refused("a PDF", "copy the table out of it, or export it as .csv"),
        _ if lower.starts_with("<html") || lower.starts_with("<!doctype") || lower.starts_with("<table") => {
            refused("a web page, whatever its name says", save)
        }
        _ if lower.starts_with("<?xml") => refused("XML", save),
        _ if is_numbered_report(&decode(start)) => refused(
            "a report of a gear measuring centre (.mka)",
            "export its deviations as a table, such as a row per tooth: tooth, left_pitch_deviation [um], \
             right_pitch_deviation [um]",
        ),
        _ if lower.trim_start_matches('[').trim_start().starts_with('{') => {
            refused("JSON", "save it as .csv or .parquet")
        }
        _ => Ok(()),
    }
}

/// All bytes of a file that is read as a whole.
fn whole(name: &str, bytes: Box<dyn Read + Send>) -> Result<Vec<u8>, Diagnostic> {
    let mut all = Vec::new();
    bytes.take(LARGEST_FILE as u64 + 1).read_to_end(&mut all).map_err(|error| Diagnostic::unreadable(name, &error))?;
    refuse_large(name, all.len() as u64)?;
    Ok(all)
}
