//! The table of a text by its contract. The separator is declared, stated in the first line, or the only one under which the heading
//! has most roles.

use std::cmp::Ordering;
use std::sync::Arc;

use super::{LEAST_RECORDS, LONG_START, START, Text};
use crate::table::Table;
use crate::table::account::Unclosed;
use crate::table::cell::{Cell, MOST_CELLS, Record, cells_in, refuse_many};
use crate::table::contract::{File, Found, Open, found, is_in_rows, needs_all, score, with_headings};
use crate::table::encoding::text;
use crate::table::grid::{Separator, aligned_records, separated};
use crate::table::layout::Layout;
use crate::table::number::DecimalMark;
use crate::table::want::Want;

/// The first records of a text as a separator cuts it, and where each ends.
struct Head {
    separator: Separator,
    records: Vec<Record>,
    ends: Vec<usize>,
    /// How many roles its heading has.
    roles: usize,
}

impl Head {
    /// The separator of the whole text, where its start settles it.
    fn settled(&self) -> Option<Separator> {
        (self.roles > 1).then_some(self.separator)
    }

    /// How many records have as many cells, and more than one, as the record before them; how many of a hundred cells are numbers; and
    /// whether a record has more than one cell.
    fn evenness(&self) -> (usize, usize, bool) {
        let widths: Vec<usize> = self.records.iter().map(|record| record.filled().len()).collect();
        let even = widths.windows(2).filter(|pair| pair[0] > 1 && pair[0] == pair[1]).count();
        let numbers = self.plain_numbers();
        (even, 100 * numbers / widths.iter().sum::<usize>().max(1), widths.iter().any(|width| *width > 1))
    }

    /// How many cells are numbers and nothing else.
    fn plain_numbers(&self) -> usize {
        let is_plain =
            |cell: &&Cell| cell.is_number() && cell.text().chars().all(|c| c.is_ascii_digit() || "+-.,eE".contains(c));
        self.records.iter().flat_map(|record| &*record.cells).filter(is_plain).count()
    }

    /// The same records below a heading that the user gives.
    fn below(mut self, heading: Option<Record>) -> Self {
        if let Some(heading) = heading {
            self.records.insert(0, heading);
            self.ends.insert(0, 0);
        }
        self
    }
}

impl Text {
    /// The table of a text by its contract.
    ///
    /// # Errors
    /// Everything that has no owner.
    pub(super) fn by_contract(mut self, layout: &Arc<Layout>, want: &Want) -> Result<Table, Unclosed> {
        let (mut bytes, mut is_all) = self.start(START)?;
        let declared = layout.separator.or(self.stated).map(Separator::Character);
        let mut head = self.head(&bytes, is_all, declared, layout)?;
        if !is_all && head.records.len() < LEAST_RECORDS {
            // the records are long: there are thousands of columns
            (bytes, is_all) = self.start(LONG_START)?;
            if head.records.is_empty() {
                self.refuse_long_lines(&bytes)?;
            }
            head = self.head(&bytes, is_all, declared, layout)?;
        }
        let names = self.better_encodings(&bytes, (is_all, declared), layout, head.roles);
        if !names.is_empty() {
            return Err(Unclosed::of(&self.name, layout, Open::Encoding { names }));
        }
        let is_cut = matches!(head.separator, Separator::Character(_) | Separator::Lines);
        let is_streamed = is_cut && is_in_rows(&head.records, layout) && !needs_all(layout);
        if !is_streamed && !is_all {
            bytes = self.all()?;
            head = self.head(&bytes, true, declared.or(head.settled()), layout)?;
            refuse_many(&self.name, cells_in(&head.records))?;
            // a mail is shorter
            bytes.truncate(START);
            bytes.shrink_to_fit();
        }
        let byte = head.separator.byte();
        let separator = is_streamed.then_some(byte);
        let file = File { separator, ..File::new(&self.name, "text") };
        let found = found(&file, &head.records, layout, want).map_err(|unclosed| match unclosed {
            Unclosed::Open(proposal) => Unclosed::Open(Box::new(proposal.of_text(&text(&bytes)))),
            wrong @ Unclosed::Wrong(_) => wrong,
        })?;
        let Found { mut table, above, heading, turned } = found;
        table.encoding = self.encoding;
        table.reading.encoding = Some(self.encoding.name().to_owned()).filter(|name| name != "UTF-8");
        table.reading.separator = Some(head.separator.name());
        if !is_streamed {
            let rows = turned.unwrap_or(head.records);
            table.pieces.give_records(rows.into_iter().skip(above).map(Ok));
            return Ok(table);
        }
        let end = |record: usize| record.checked_sub(1).map_or(0, |before| head.ends[before]);
        table.header_raw = bytes[end(heading)..end(heading + 1)].to_vec();
        let lines = self.lines + lines_in(&bytes[..end(above)]);
        self.chunks.skip(end(above));
        table.pieces.give_chunks(self.chunks, lines);
        Ok(table)
    }

    /// The encodings under which more than `roles` headings are known.
    fn better_encodings(
        &self,
        bytes: &[u8],
        (is_all, declared): (bool, Option<Separator>),
        layout: &Arc<Layout>,
        roles: usize,
    ) -> Vec<&'static str> {
        let roles_in = |text: &str| self.head(text.as_bytes(), is_all, declared, layout).map_or(0, |head| head.roles);
        let others = self.encoding.others(bytes).filter(|_| layout.encoding.is_none());
        let found: Vec<_> = others.map(|(name, text)| (name, roles_in(&text))).collect();
        let most = found.iter().map(|(_, count)| *count).max().filter(|most| *most > roles);
        found.into_iter().filter(|(_, count)| Some(*count) == most).map(|(name, _)| name).collect()
    }

    /// The first records as the separator of the text cuts it.
    fn head(
        &self,
        bytes: &[u8],
        is_all: bool,
        declared: Option<Separator>,
        layout: &Arc<Layout>,
    ) -> Result<Head, Unclosed> {
        if !layout.starts.is_empty() {
            return Ok(self.at_starts(bytes, layout));
        }
        // the decimal mark separates cells only where numbers stand in quotes
        let is_mark = |byte: u8| byte == b',' && layout.decimal == Some(DecimalMark::Comma) && !bytes.contains(&b'"');
        let candidates = [b'\t', b';', b'|', b','].into_iter().filter(|byte| bytes.contains(byte) && !is_mark(*byte));
        let mut tried: Vec<Separator> = candidates.map(Separator::Character).collect();
        let written = text(bytes);
        if written.lines().any(|line| line.trim().contains("  ")) {
            tried.push(Separator::AlignedBlanks);
        }
        // lines with one value each are cut at tabs, of which there are none
        tried.extend(Some(Separator::Lines).filter(|_| !bytes.contains(&b'\t')));
        if let Some(separator) = declared {
            tried = vec![separator];
        }
        // of the heads with most roles all; where no heading is known, the one that makes most rows as wide as the row before them, by
        // which what has no owner is shown
        let mut heads: Vec<Head> = Vec::new();
        for separator in tried {
            let head = self.cut(bytes, is_all, separator).below(with_headings(layout));
            let head = Head { roles: score(&head.records, layout), ..head };
            let is_better = |best: &Head| match head.roles.cmp(&best.roles) {
                Ordering::Equal if head.roles == 0 => head.evenness().cmp(&best.evenness()).then(Ordering::Less),
                order => order,
            };
            let order = heads.first().map_or(Ordering::Greater, is_better);
            if order == Ordering::Greater {
                heads.clear();
            }
            heads.extend(Some(head).filter(|_| order != Ordering::Less));
        }
        let most = heads.first().map_or(0, |head| head.roles);
        if heads.len() > 1 {
            // a separator under which all records have one cell separates nothing
            let width = |head: &Head| head.records.iter().map(|record| record.filled().len()).max().unwrap_or(0);
            if heads.iter().any(|head| head.separator == Separator::Lines) && most == 1 {
                heads.retain(|head| head.separator == Separator::Lines);
            } else if heads.iter().filter(|head| width(head) > 1).count() == 1 {
                heads.retain(|head| width(head) > 1);
            }
        }
        if heads.len() > 1 && !layout.headings.is_empty() {
            // the separator under which most cells are numbers
            let most = heads.iter().map(Head::plain_numbers).max();
            heads.retain(|head| Some(head.plain_numbers()) == most);
        }
        if heads.len() > 1 {
            let able = heads.iter().map(|head| head.separator).collect();
            return Err(Unclosed::of(&self.name, layout, Open::Separator { able }));
        }
        Ok(heads.swap_remove(0))
    }

    /// The records of a text of fixed width whose columns start where the contract says. The text before the first start is a cell
    /// too.
    fn at_starts(&self, bytes: &[u8], layout: &Layout) -> Head {
        let text = text(bytes);
        let starts: Vec<usize> =
            std::iter::once(0).chain(layout.starts.iter().copied().filter(|start| *start > 0)).collect();
        let cells = |line: &str| {
            let bytes: Vec<usize> = line.char_indices().map(|(at, _)| at).chain([line.len()]).collect();
            let byte = |column: usize| bytes.get(column).copied().unwrap_or(line.len());
            let ends = starts.iter().skip(1).map(|start| byte(*start)).chain([line.len()]);
            let cells = starts.iter().zip(ends).map(|(start, end)| Cell::of_text(line[byte(*start)..end].trim()));
            cells.collect()
        };
        let lines = text.lines().zip(self.lines + 1..).take(MOST_CELLS / starts.len() + 1);
        let records = lines.map(|(line, number)| Record::new(cells(line), number)).collect();
        Head { separator: Separator::AlignedBlanks, records, ends: Vec::new(), roles: 0 }.below(with_headings(layout))
    }

    /// The complete records of the start as a separator cuts it.
    fn cut(&self, bytes: &[u8], is_all: bool, separator: Separator) -> Head {
        if separator == Separator::AlignedBlanks {
            let records = aligned_records(&text(bytes), self.lines);
            return Head { separator, records, ends: Vec::new(), roles: 0 };
        }
        let (records, ends) = separated(bytes, separator.byte(), is_all, self.lines);
        Head { separator, records, ends, roles: 0 }
    }
}

/// How many line ends there are.
fn lines_in(bytes: &[u8]) -> u64 {
    crate::table::split::count_line_ends(bytes)
}
