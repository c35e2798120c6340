//! A text that is read by a contract: its separator is declared, stated in its first line, or the only one under which the heading
//! has most roles.

use std::sync::Arc;

use super::{LARGEST_WHOLE, START, Text};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::table::Table;
use crate::table::cell::Record;
use crate::table::contract::{File, Found, Open, found, is_in_rows, refused, score};
use crate::table::encoding::text;
use crate::table::grid::{Separator, records};
use crate::table::layout::Layout;
use crate::table::rows::cells;
use crate::table::split::next_record;
use crate::table::want::Want;

/// The first records of a text under a separator, and where each ends.
struct Head {
    separator: Separator,
    records: Vec<Record>,
    ends: Vec<usize>,
}

impl Text {
    /// The table of a text by its contract.
    ///
    /// # Errors
    /// Everything that has no owner.
    pub(super) fn by_contract(mut self, layout: &Arc<Layout>, want: &Want) -> Result<Table, Diagnostics> {
        let (mut bytes, mut is_all) = self.start(START)?;
        let declared = want.separator.or(layout.separator).or(self.stated);
        let mut head = self.head(&bytes, is_all, declared, layout)?;
        let is_cut = matches!(head.separator, Separator::Character(_) | Separator::Lines);
        let is_streamed = is_cut && is_in_rows(&head.records, layout);
        if !is_streamed && !is_all {
            (bytes, is_all) = self.start(LARGEST_WHOLE)?;
            if !is_all {
                let message =
                    format!("{} is larger than {} MiB, and its parts are not in rows", self.name, LARGEST_WHOLE >> 20);
                return Err(Diagnostic::error(Code::BadTable, message)
                    .help("split it, or write a row per part")
                    .into());
            }
            head = self.head(&bytes, is_all, declared, layout)?;
        }
        let byte = head.separator.byte();
        let separator = is_streamed.then_some(byte);
        let file = File { separator, ..File::new(&self.name, "text") };
        let Found { mut table, above, heading, turned } = found(&file, &head.records, layout, want)?;
        table.encoding = self.encoding;
        table.reading.encoding = Some(self.encoding.name().to_owned()).filter(|name| name != "UTF-8");
        table.reading.separator = Some(head.separator.name());
        if !is_streamed {
            let rows = turned.unwrap_or(head.records);
            if table.reading.parts_in == "columns" {
                table.titles = Vec::new();
            }
            table.pieces.give_records(rows.into_iter().skip(above).map(Ok), None);
            return Ok(table);
        }
        let end = |record: usize| record.checked_sub(1).map_or(0, |before| head.ends[before]);
        table.header_raw = bytes[end(heading)..end(heading + 1)].to_vec();
        let lines = self.lines + lines_in(&bytes[..end(above)]);
        self.chunks.skip(end(above));
        table.pieces.give_chunks(self.chunks, lines);
        Ok(table)
    }

    /// The first records under the separator that there is.
    fn head(&self, bytes: &[u8], is_all: bool, declared: Option<u8>, layout: &Layout) -> Result<Head, Diagnostics> {
        let candidates = [b'\t', b';', b'|', b','].into_iter().filter(|byte| bytes.contains(byte));
        let mut tried: Vec<Separator> = candidates.map(Separator::Character).collect();
        let written = text(bytes);
        if written.lines().any(|line| line.trim().contains("  ")) {
            tried.push(Separator::AlignedBlanks);
        }
        // one value per line is cut as tabs would be
        tried.extend(Some(Separator::Lines).filter(|_| !bytes.contains(&b'\t')));
        if let Some(byte) = declared {
            tried = vec![Separator::Character(byte)];
        }
        let heads = tried.into_iter().map(|separator| self.cut(bytes, is_all, separator));
        let mut heads: Vec<(usize, Head)> = heads.map(|head| (score(&head.records, layout), head)).collect();
        let most = heads.iter().map(|(score, _)| *score).max().unwrap_or(0);
        // where no heading is known, the separator that makes most cells shows what has no owner
        if most == 0 {
            heads.sort_by_key(|(_, head)| {
                std::cmp::Reverse(head.records.iter().map(|record| record.filled().len()).max())
            });
            heads.truncate(1);
        }
        heads.retain(|(score, _)| *score == most);
        if heads.len() > 1 {
            // a character that the heading does not have separates nothing there
            let width = |head: &Head| head.records.iter().map(|record| record.filled().len()).max().unwrap_or(0);
            if heads.iter().any(|(_, head)| head.separator == Separator::Lines) && most == 1 {
                heads.retain(|(_, head)| head.separator == Separator::Lines);
            } else if heads.iter().filter(|(_, head)| width(head) > 1).count() == 1 {
                heads.retain(|(_, head)| width(head) > 1);
            }
        }
        if heads.len() > 1 {
            let names = heads.iter().map(|(_, head)| head.separator.name()).collect();
            return Err(refused(&self.name, layout, &[Open::Separator { names }]));
        }
        Ok(heads.swap_remove(0).1)
    }

    /// The whole records at the start.
    fn cut(&self, bytes: &[u8], is_all: bool, separator: Separator) -> Head {
        let before = usize::try_from(self.lines).unwrap_or(0);
        let lines = "\n".repeat(before);
        if !matches!(separator, Separator::Character(_) | Separator::Lines) {
            let records = records(&(lines + &text(bytes)), separator).unwrap_or_default();
            return Head { separator, records, ends: Vec::new() };
        }
        let (mut found, mut ends, mut fields, mut at, mut blank, mut line) =
            (Vec::new(), Vec::new(), Vec::new(), 0, 0, self.lines);
        while let Some(record) = next_record(bytes, at, separator.byte(), &mut fields, &mut blank) {
            if !record.closed && !is_all {
                break;
            }
            found.push(Record {
                start: record.start,
                ..Record::new(cells(bytes, &fields), line + record.lines_before + 1)
            });
            (at, line) = (record.next, line + record.lines);
            ends.push(at);
        }
        Head { separator, records: found, ends }
    }
}

/// How many line ends there are.
fn lines_in(bytes: &[u8]) -> u64 {
    crate::table::split::count_line_ends(bytes)
}
