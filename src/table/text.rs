//! A table that is text. A short one is read as a whole. Of a long one with a row per part, the start gives the columns, and the
//! rows are streamed. Called by [`Container::table`](super::Container::table).

mod contract;

use std::io::Read;
use std::sync::Arc;

use super::Table;
use super::account::Unclosed;
use super::chunk::{Chunker, LONGEST_RECORD};
use super::contract::of_records;
use super::encoding::{Encoding, recoded, text};
use super::pieces::Place;
use super::report::{Report, is_report, report};
use super::want::Want;
use crate::diagnostic::{Code, Diagnostic};

/// Bytes at the start of a table from which its columns are found.
const START: usize = 1 << 16;
/// The same where that start has fewer records than these.
const LEAST_RECORDS: usize = 8;
const LONG_START: usize = 4 * LONGEST_RECORD;
/// The largest text that is read as a whole, bytes: one whose parts are not in rows.
const LARGEST_WHOLE: usize = 16 << 20;

/// A text whose columns are not found yet.
pub struct Text {
    name: String,
    chunks: Chunker,
    encoding: Encoding,
    /// The separator of a first line `sep=;`, as spreadsheets write it.
    stated: Option<u8>,
    /// Lines before the rest of the text: 1 if that line is skipped.
    lines: u64,
}

impl Text {
    pub(crate) fn open(name: &str, bytes: Box<dyn Read + Send>, told: Option<Encoding>) -> Result<Self, Diagnostic> {
        let (bytes, encoding) = recoded(bytes, told).map_err(|error| Diagnostic::unreadable(name, &error))?;
        let mut chunks = Chunker::new(bytes);
        let start = chunks.start(START).map_err(|error| Diagnostic::unreadable(name, &error))?;
        let bad = |what: &str, help: &str| Err(Diagnostic::error(Code::BadTable, format!("{name} {what}")).help(help));
        let odd = start.iter().filter(|byte| byte.is_ascii_control() && !b"\t\n\r\x0b\x0c\x0f\x14\x1a".contains(byte));
        // names may hold some: a short file is no binary one for that
        if start.contains(&0) || odd.count() > (start.len() / 20).max(16) {
            let help = "tables are text, Excel workbooks (.xlsx), Q-DAS files or Parquet";
            return bad("is no text: it holds bytes that no table has", help);
        }
        if start.iter().all(|byte| byte.is_ascii_whitespace() || b";,|".contains(byte)) {
            return bad("holds no table: there is nothing in it", "give the file that was exported");
        }
        let stated = stated_separator(start);
        if let Some((_, length)) = stated {
            chunks.skip(length);
        }
        let lines = u64::from(stated.is_some());
        Ok(Self { name: name.to_owned(), chunks, encoding, stated: stated.map(|(separator, _)| separator), lines })
    }

    /// The first bytes, and whether the text has no more.
    fn start(&mut self, count: usize) -> Result<(Vec<u8>, bool), Diagnostic> {
        let name = self.name.clone();
        let start = self.chunks.start(count).map_err(|error| Diagnostic::unreadable(&name, &error))?.to_vec();
        let is_all = start.len() < count;
        Ok((start, is_all))
    }

    /// Whether it starts like a Q-DAS file.
    pub(crate) fn is_qdas(&mut self) -> Result<bool, Diagnostic> {
        let (start, _) = self.start(START)?;
        let line = start.split(|byte| matches!(byte, b'\n' | b'\r')).find(|line| !line.trim_ascii().is_empty());
        Ok(matches!(line, Some([b'K' | b'k', a, b, c, d, b' ' | b'/' | b'\t', ..])
            if [a, b, c, d].into_iter().all(u8::is_ascii_digit)))
    }

    /// The text from its start, to be read in another way.
    pub(crate) fn into_reader(self) -> Box<dyn Read + Send> {
        self.chunks.into_reader()
    }

    pub(crate) fn table(mut self, want: &Want) -> Result<Table, Unclosed> {
        if is_report(&text(&self.start(START)?.0)) {
            return self.report(want);
        }
        self.by_contract(&want.contract(), want)
    }

    /// Refuses a line that is longer than a streamed row may be.
    fn refuse_long_lines(&self, bytes: &[u8]) -> Result<(), Diagnostic> {
        let mut start = 0;
        for (end, line) in memchr::memchr_iter(b'\n', bytes).chain([bytes.len()]).zip(self.lines + 1..) {
            if end - start > LONGEST_RECORD {
                let limit = LONGEST_RECORD >> 10;
                let message = format!("{}, line {line}: it is longer than {limit} KiB", self.name);
                return Err(Diagnostic::error(Code::BadTable, message).help("a line end or a quote may be missing"));
            }
            start = end;
        }
        Ok(())
    }

    /// All bytes, of a table that is read as a whole.
    fn all(&mut self) -> Result<Vec<u8>, Diagnostic> {
        let name = self.name.clone();
        let bytes = self.chunks.all(LARGEST_WHOLE).map_err(|error| Diagnostic::unreadable(&name, &error))?;
        if bytes.len() > LARGEST_WHOLE {
            let message =
                format!("{} is larger than {} MiB, and its parts are not in rows", self.name, LARGEST_WHOLE >> 20);
            return Err(Diagnostic::error(Code::BadTable, message).help("split it, or write a row per part"));
        }
        self.refuse_long_lines(&bytes)?;
        Ok(bytes)
    }

    /// The table of a report that a measuring program wrote.
    fn report(mut self, want: &Want) -> Result<Table, Unclosed> {
        let layout = want.contract();
        let bytes = self.all()?;
        let bytes = text(&bytes);
        let Some(Report { file, records, layout }) = report(&self.name, &bytes, &layout) else {
            return self.by_contract(&layout, want);
        };
        let mut table = of_records(&file, records, std::iter::empty(), &Arc::new(layout), want)?;
        table.reading.header_line = None;
        table.place = Place::Line;
        Ok(table)
    }
}

/// The separator of a first line `sep=;`, and the length of that line.
fn stated_separator(start: &[u8]) -> Option<(u8, usize)> {
    let rest = start.strip_prefix(b"sep=")?;
    match rest {
        [separator, b'\r', b'\n', ..] => Some((*separator, 7)),
        [separator, b'\n' | b'\r', ..] => Some((*separator, 6)),
        _ => None,
    }
}
