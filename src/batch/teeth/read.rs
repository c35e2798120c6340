//! Part by part from a table with a row per tooth or space. Called by the run; it knows which rows belong together, and
//! nothing of what they mean.

use std::io;
use std::ops::Range;

use crate::batch::chunk::Holds;
use crate::batch::input::{Input, text};
use crate::batch::split::next_record;

/// One part's rows.
#[derive(Debug, Default)]
pub(super) struct Rowset {
    pub(super) id: String,
    /// Its table, without the column that names the part.
    pub(super) table: Vec<u8>,
    pub(super) raw: Vec<u8>,
    /// The line of each row.
    pub(super) lines: Vec<u64>,
    /// The record of its first row.
    pub(super) record: u64,
    /// What is wrong with a row of it, and on which line.
    pub(super) bad: Option<(u64, String)>,
}

/// Reads part by part.
pub(super) struct Reader {
    pub(super) input: Input,
    id: usize,
    /// The separator of the parts' own tables.
    separator: u8,
    chunk: Vec<u8>,
    at: usize,
    lines: u64,
    records: u64,
    /// The header of the parts' own tables.
    head: Vec<u8>,
    /// The part whose rows are being read.
    open: Option<Rowset>,
}

impl Reader {
    /// Reads the rows below a header, of which `columns` are the names that tables of one part have and `id` is the
    /// place of the part's name.
    pub(super) fn new(mut input: Input, columns: &[String], id: usize) -> Self {
        input.chunks.set_separator(input.header.separator);
        let separator = if input.header.separator == b'|' { b'\t' } else { input.header.separator };
        let lines = input.lines;
        let chunk = Vec::new();
        let mut reader = Self { input, id, separator, chunk, at: 0, lines, records: 0, head: Vec::new(), open: None };
        reader.head = reader.line(columns);
        reader
    }

    /// A line of the part's own table.
    fn line(&self, cells: &[String]) -> Vec<u8> {
        let mut line = Vec::new();
        let others = cells.iter().enumerate().filter(|(index, _)| *index != self.id);
        for (index, (_, cell)) in others.enumerate() {
            if index > 0 {
                line.push(self.separator);
            }
            let quoted = cell.contains([char::from(self.separator), '"', '\n', '\r']);
            line.extend(if quoted { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }.bytes());
        }
        line.push(b'\n');
        line
    }

    /// The next part; `None` at the end of the table.
    pub(super) fn next(&mut self) -> io::Result<Option<Rowset>> {
        let (mut fields, mut scratch, mut blank) = (Vec::new(), Vec::new(), 0);
        loop {
            let record = next_record(&self.chunk, self.at, self.input.header.separator, &mut fields, &mut blank);
            let Some(record) = record else {
                self.lines += blank;
                self.at = 0;
                // what was read is done with, at the end of the table too
                self.chunk.clear();
                match self.input.chunks.next(&mut self.chunk)? {
                    None => return Ok(self.open.take()),
                    Some(Holds::Records { .. }) => {}
                    Some(Holds::Piece { first, .. }) => {
                        // the part with a row that is too long is bad, and the row's pieces are its rows
                        let line = self.lines + 1;
                        let part = self.open.get_or_insert_with(Rowset::default);
                        if first {
                            part.bad = Some((line, "a row is longer than 256 KiB".to_owned()));
                        }
                        part.raw.extend_from_slice(&self.chunk);
                        self.lines += memchr::memchr_iter(b'\n', &self.chunk).count() as u64;
                        self.chunk.clear();
                    }
                }
                continue;
            };
            let line = self.lines + record.lines_before + 1;
            let cells: Vec<String> =
                fields.iter().map(|field| text(field.content(&self.chunk, &mut scratch)).into_owned()).collect();
            let columns = self.input.header.columns.len();
            let id = cells.get(self.id).map(|id| id.trim().to_owned()).unwrap_or_default();
            let whole = cells.len() == columns && !record.open;
            // a row that is too short to name its part belongs to the one it stands in
            let continues = self.open.as_ref().is_some_and(|part| part.id == id || (!whole && id.is_empty()));
            if !continues && self.open.is_some() {
                return Ok(self.open.take());
            }
            self.records += 1;
            self.lines += record.lines;
            self.at = record.next;
            let row = self.line(&cells);
            let raw: Range<usize> = record.start..record.next;
            let records = self.records;
            let part = self.open.get_or_insert_with(|| Rowset { id, record: records, ..Rowset::default() });
            if part.table.is_empty() {
                part.table.clone_from(&self.head);
            }
            if !whole && part.bad.is_none() {
                let found = format!("the row has {} fields and the header has {columns}", cells.len());
                let message = if record.open { "a quote is not closed".to_owned() } else { found };
                part.bad = Some((line, message));
            }
            part.table.extend(row);
            part.raw.extend_from_slice(&self.chunk[raw]);
            part.lines.push(line);
        }
    }
}
