//! A table that is text. A short one is read as a whole, whatever its shape; a long one with a row per part is understood
//! from its start, and its rows are streamed. Called by [`Container::table`](super::Container::table).

mod contract;

use std::io::Read;
use std::sync::Arc;

use super::Table;
use super::chunk::{Chunker, LONGEST_RECORD};
use super::contract::{File, of_records};
use super::encoding::{Encoding, recoded, text};
use super::grid::{Separator, records};
use super::pieces::Place;
use super::propose::Unclosed;
use super::report::{Report, is_report, report};
use super::shape::has_digit;
use super::split::next_record;
use super::understand::{Understood, understand};
use super::want::Want;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};

/// Bytes from which a long table is understood.
const START: usize = 1 << 16;
/// Bytes that are read as a whole at most, where parts are no rows.
const LARGEST_WHOLE: usize = 16 << 20;

/// A text before it is understood.
pub struct Text {
    name: String,
    chunks: Chunker,
    encoding: Encoding,
    /// The separator in a line of its own at the start, as spreadsheets write it.
    stated: Option<u8>,
    /// Lines that were taken away.
    lines: u64,
}

impl Text {
    pub(crate) fn open(name: &str, bytes: Box<dyn Read + Send>, told: Option<Encoding>) -> Result<Self, Diagnostic> {
        let (bytes, encoding) = recoded(bytes, told).map_err(|error| Diagnostic::unreadable(name, &error))?;
        let mut chunks = Chunker::new(bytes);
        let start = chunks.start(START).map_err(|error| Diagnostic::unreadable(name, &error))?;
        if start.contains(&0) {
            let message = format!("{name} is no text: it holds bytes that no table has");
            return Err(Diagnostic::error(Code::BadTable, message)
                .help("tables are text, Excel workbooks (.xlsx), Q-DAS files or Parquet"));
        }
        let stated = stated_separator(start);
        if let Some((_, length)) = stated {
            chunks.skip(length);
        }
        let lines = u64::from(stated.is_some());
        Ok(Self { name: name.to_owned(), chunks, encoding, stated: stated.map(|(separator, _)| separator), lines })
    }

    /// The first bytes, and whether that is all.
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

    /// All of it, for files that are read as a whole.
    pub(crate) fn whole(mut self, most: usize) -> Result<String, Diagnostic> {
        let (bytes, is_all) = self.start(most + 1)?;
        if !is_all {
            return Err(Diagnostic::unreadable(&self.name, &format!("it is larger than {} MiB", most >> 20)));
        }
        Ok(text(&bytes).into_owned())
    }

    pub(crate) fn table(mut self, want: &Want) -> Result<Table, Unclosed> {
        if is_report(&text(&self.start(START)?.0)) {
            return self.report(want);
        }
        if let Some(layout) = want.only_contract() {
            return self.by_contract(&layout, want);
        }
        let mut want = want.clone();
        want.separator = want.separator.or(self.stated);
        let (mut bytes, mut is_all) = self.start(START)?;
        if !is_all {
            let source = self.source(&bytes, false);
            let problem = match understand(&source, &want) {
                Ok(understood) if can_stream(&understood) && plain(&text(&bytes)).is_none() => {
                    return Ok(self.streamed(&understood, &want)?);
                }
                understood => understood.err(),
            };
            (bytes, is_all) = self.start(LARGEST_WHOLE)?;
            if !is_all {
                let problem = problem.unwrap_or_else(|| {
                    let most = LARGEST_WHOLE >> 20;
                    let message = format!("{} is larger than {most} MiB, and its parts are not in rows", self.name);
                    Diagnostic::error(Code::BadTable, message).help("split it, or write a row per part").into()
                });
                return Err(problem.into());
            }
        }
        let source = self.source(&bytes, true);
        let understood = understand(&source, &want)?;
        if let Some(refused) = understood.false_statistic(&self.name) {
            return Err(refused.into());
        }
        Ok(self.whole_table(&source, &understood, &want))
    }

    /// Refuses a line that is longer than a row is where rows are streamed.
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

    /// The table of a report that a measuring program wrote.
    fn report(mut self, want: &Want) -> Result<Table, Unclosed> {
        let layout = want.contract();
        let (bytes, is_all) = self.start(LARGEST_WHOLE)?;
        self.refuse_long_lines(&bytes)?;
        let Some(report) = report(&text(&bytes), &layout).filter(|_| is_all) else {
            let message =
                format!("{} is larger than {} MiB, and its parts are not in rows", self.name, LARGEST_WHOLE >> 20);
            return Err(Diagnostic::error(Code::BadTable, message).help("split it, or write a row per part").into());
        };
        let Report { format, records, layout, said, left_out, open } = report;
        let file = File { said, left_out, open, ..File::new(&self.name, format) };
        let mut table = of_records(&file, records, std::iter::empty(), &Arc::new(layout), want)?;
        table.reading.header_line = None;
        table.place = Place::Line;
        Ok(table)
    }

    /// The text as messages point into it: whole lines, line ends of one kind where it is all there.
    fn source(&self, bytes: &[u8], is_all: bool) -> Arc<Source> {
        let end = if is_all { bytes.len() } else { memchr::memrchr(b'\n', bytes).map_or(bytes.len(), |end| end + 1) };
        // a zero-width blank, as some mail programs insert, is no blank for Unicode
        let mut text = text(&bytes[..end]).replace(['\u{200b}', '\u{feff}'], "");
        if !text.contains('\n') {
            text = text.replace('\r', "\n");
        }
        text = plain(&text).unwrap_or(text);
        // lines that were taken away keep their number
        text.insert_str(0, &"\n".repeat(usize::try_from(self.lines).unwrap_or(0)));
        Arc::new(Source::new(self.name.clone(), text))
    }

    /// A table that is all there.
    fn whole_table(self, source: &Arc<Source>, understood: &Understood, want: &Want) -> Table {
        let mut table = self.found(understood, want);
        table.reading.notes.extend(understood.other_count(&table.name));
        let (Some(separator), true) = (understood.separator, understood.has_row_per_part()) else { return table };
        let mut all = records(&source.text, separator).unwrap_or_default();
        let data = understood.shape.data.clone();
        let header = all[..data.start].iter().rfind(|record| Some(record.line) == understood.shape.header_line);
        table.header_raw = header.map_or_else(Vec::new, |record| record.line_in(&source.text));
        all.truncate(data.end);
        table.pieces.give_records(all.into_iter().skip(data.start).map(Ok), Some(Arc::clone(source)));
        table
    }

    /// A table of any length, with a row per part.
    fn streamed(mut self, understood: &Understood, want: &Want) -> Result<Table, Diagnostics> {
        let mut table = self.found(understood, want);
        let separator = understood.separator.map_or(b',', Separator::byte);
        let (start, _) = self.start(START)?;
        let (mut fields, mut at, mut blank) = (Vec::new(), 0, 0);
        for index in 0..understood.shape.data.start {
            let Some(record) = next_record(&start, at, separator, &mut fields, &mut blank) else { break };
            self.lines += record.lines;
            at = record.next;
            if index + 1 == understood.shape.data.start || Some(self.lines) == understood.shape.header_line {
                table.header_raw = start[record.start..record.next].to_vec();
            }
        }
        self.chunks.skip(at);
        table.pieces.give_chunks(self.chunks, self.lines);
        Ok(table)
    }

    /// The table that was found, without its rows.
    fn found(&self, understood: &Understood, want: &Want) -> Table {
        let mut table = Table::new(&self.name, "text", understood, want);
        table.encoding = self.encoding;
        table.reading.encoding = Some(self.encoding.name().to_owned()).filter(|name| name != "UTF-8");
        table
    }
}

/// A text without the marks of a quoted mail, and with the bars and lines of a box as Markdown has them; `None` if it has none.
fn plain(text: &str) -> Option<String> {
    let is_marked = |line: &&str| line.starts_with('>');
    let quoted = || text.lines().map(str::trim_start).filter(is_marked);
    let depth = quoted().map(|line| line.chars().take_while(|c| matches!(c, '>' | ' ')).filter(|c| *c == '>').count());
    let depth = depth.min().unwrap_or(0);
    let unquoted = |line: &str| match line.trim_start() {
        line if is_marked(&line) => {
            line.splitn(depth + 1, '>').last().unwrap_or_default().trim_start_matches(' ').to_owned()
        }
        _ => line.to_owned(),
    };
    // `>25,05` is a bound
    let is_name = |line: &str| !has_digit(unquoted(line).split_whitespace().next().unwrap_or_default());
    let is_quoted = quoted().find(|line| line.chars().any(|c| !matches!(c, '>' | ' '))).is_some_and(is_name);
    let is_drawn = |c: char| ('\u{2500}'..='\u{257f}').contains(&c);
    let bar = |c: char| match c {
        '─' | '━' | '═' | '┄' | '┅' | '┈' | '┉' | '╌' | '╍' => '-',
        c if is_drawn(c) => '|',
        c => c,
    };
    let lines = text.split_inclusive('\n').map(|line| if is_quoted { unquoted(line) } else { line.to_owned() });
    (is_quoted || text.contains(is_drawn)).then(|| lines.collect::<String>().chars().map(bar).collect())
}

/// Whether the rows of a table can be read one after the other: between a character, or in a single column whose name
/// is all that stands before them.
fn can_stream(understood: &Understood) -> bool {
    let is_cut = match understood.separator {
        Some(Separator::Character(_)) => true,
        Some(Separator::Lines) => understood.shape.data.start == 1,
        _ => false,
    };
    is_cut && understood.has_row_per_part()
}

/// `sep=;` on a line of its own, as spreadsheets write it: the separator, and the line's length.
fn stated_separator(start: &[u8]) -> Option<(u8, usize)> {
    let rest = start.strip_prefix(b"sep=")?;
    match rest {
        [separator, b'\r', b'\n', ..] => Some((*separator, 7)),
        [separator, b'\n' | b'\r', ..] => Some((*separator, 6)),
        _ => None,
    }
}
