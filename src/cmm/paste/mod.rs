//! Blocks that a person pastes: cells of a spreadsheet, a table of a CMM report, a mail.
//!
//! The command line calls [`understand`] with the text and with what the spec expects ([`Want`]). Every way in
//! which the text can be a table is tried: each separator, rows or columns, decimal comma or point. If all that
//! are possible give the same values, that is the reading; if they do not, and neither another cell nor a nominal
//! value of the spec settles it, the block is refused with the readings shown. The computer's locale is never asked,
//! and no line is passed over without being named in the [`Account`]. Nothing here knows gear geometry.

mod grid;
mod layout;
mod names;
mod read;

pub use grid::Separator;
pub(super) use names::heading_fields;
pub use names::{Field, Holds, Meaning, heading_of_teeth, is_value_heading, meaning};

use std::fmt;
use std::sync::Arc;

use super::written::{DecimalMark, Marks, marks};
use super::{PinionTeeth, RackSpaces};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::quantity::Length;
use grid::records;
use layout::{Layout, NoLayout, layout};

/// How parts stand in a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Orientation {
    /// A part, space or tooth in each row.
    Rows,
    /// A part, space or tooth in each column.
    Columns,
}

/// What is known about a block before it is read.
#[derive(Debug, Clone, Default)]
pub struct Want {
    /// What its columns hold, in order; empty to find out from its header or the spec's order.
    pub fields: Vec<Field>,
    /// The errors that the spec gives, in its order.
    pub expected: Vec<ErrorKind>,
    /// Names that the spec gives to columns.
    pub own: Vec<(String, Field)>,
    /// Nominal values: a column of such an error holds the measured value, unless its heading says otherwise.
    pub nominals: Vec<(ErrorKind, ErrorValue)>,
    /// The units of columns whose heading names none.
    pub units: Vec<(Field, String)>,
    /// The normal module: a measured value that is further from its nominal one is not meant.
    pub module: Option<Length>,
    /// The decimal mark, if it is given.
    pub decimal: Option<DecimalMark>,
    /// The orientation, if it is given.
    pub orientation: Option<Orientation>,
}

/// One part of a block.
#[derive(Debug, Clone)]
pub struct PastedPart {
    /// Its name, if the block gives one.
    pub id: Option<String>,
    /// The line where it stands.
    pub line: usize,
    /// Its deviations, in the paper's order.
    pub errors: Vec<(ErrorKind, ErrorValue)>,
    /// What of it cannot be read.
    pub problems: Vec<Diagnostic>,
}

/// What a block holds.
#[derive(Debug, Clone)]
pub enum Pasted {
    /// One value per error, for one part or several.
    Parts(Vec<PastedPart>),
    /// The spaces of one rack.
    Rack(RackSpaces),
    /// The teeth of one pinion.
    Pinion(PinionTeeth),
}

/// How a block was understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Account {
    /// The sheet or file that is no pasted text, if it was one.
    pub file: Option<String>,
    /// What stands between cells.
    pub separator: Separator,
    /// The decimal mark; `None` if no number has decimals.
    pub decimal: Option<DecimalMark>,
    /// What settled the decimal mark, if the numbers themselves left it open.
    pub settled_by: Option<String>,
    /// How parts stand.
    pub orientation: Orientation,
    /// Line of the header; `None` without one.
    pub header_line: Option<usize>,
    /// Each column: field, unit, what it holds.
    pub columns: Vec<String>,
    /// Columns that name nothing known.
    pub other_columns: Vec<String>,
    /// Lines that are no part of the table.
    pub ignored: Vec<(usize, String)>,
    /// Parts, spaces or teeth.
    pub count: usize,
    /// What is counted.
    pub unit: &'static str,
}

impl fmt::Display for Account {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.file {
            Some(file) => write!(f, "read from {file}")?,
            None => write!(f, "read as {}", self.separator.name())?,
        }
        match (self.decimal, &self.settled_by) {
            _ if self.file.is_some() => {}
            (None, _) => f.write_str(", no decimals")?,
            (Some(mark), None) => write!(f, ", {}", mark.name())?,
            (Some(mark), Some(by)) => write!(f, ", {} ({by})", mark.name())?,
        }
        match self.header_line {
            Some(line) => write!(f, ", names in line {line}")?,
            None if self.columns.iter().all(|column| !column.starts_with('"')) => f.write_str(", no names")?,
            None => f.write_str(", names in column 1")?,
        }
        let plural = if self.count == 1 { "" } else { "s" };
        let unit = match (self.unit, self.count) {
            ("tooth", count) if count != 1 => "teeth".to_owned(),
            (unit, _) => format!("{unit}{plural}"),
        };
        let across = if self.orientation == Orientation::Columns { " across" } else { "" };
        write!(f, ", {} {unit}{across}: {}", self.count, self.columns.join(", "))?;
        if !self.other_columns.is_empty() {
            write!(f, "; not used: {}", self.other_columns.join(", "))?;
        }
        if !self.ignored.is_empty() {
            const SHOWN: usize = 6;
            let lines: Vec<_> =
                self.ignored.iter().take(SHOWN).map(|(line, text)| format!("{line} \"{}\"", short(text))).collect();
            let more = self.ignored.len().saturating_sub(SHOWN);
            let more = if more == 0 { String::new() } else { format!(" and {more} more") };
            let plural = if self.ignored.len() == 1 { "" } else { "s" };
            write!(f, "; no part of the table: line{plural} {}{more}", lines.join(", "))?;
        }
        Ok(())
    }
}

fn short(text: &str) -> String {
    const LONGEST: usize = 32;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST - 1).chain(['…']).collect()
}

/// A block, understood.
#[derive(Debug, Clone)]
pub struct Understood {
    /// What it holds.
    pub pasted: Pasted,
    /// How it was read.
    pub account: Account,
}

/// One possible reading.
struct Candidate {
    understood: Understood,
    /// Values in words: what two readings are compared by, and shown as.
    values: Vec<String>,
    /// Why it cannot be meant, if it cannot.
    doubt: Option<String>,
}

/// Reads a pasted block; `name` is what messages call it.
///
/// # Errors
/// A diagnostic if the text holds no table, or can be read in more than one way; the readings are in its message.
pub fn understand(name: &str, text: &str, want: &Want) -> Result<Understood, Diagnostic> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // a zero-width blank, as some mail programs insert, is no blank for Unicode
    let text = text.replace(['\u{200b}', '\u{feff}'], "").replace("\r\n", "\n").replace('\r', "\n");
    let source = Arc::new(Source { name: name.to_owned(), text });
    let text = source.text.as_str();
    let mut candidates: Vec<Candidate> = Vec::new();
    // the reading that came furthest says best what is wrong
    let mut failure: Option<(u8, Diagnostic)> = None;
    let mut fail = |rank: u8, diagnostic: Diagnostic| {
        if failure.as_ref().is_none_or(|(known, _)| *known < rank) {
            failure = Some((rank, diagnostic));
        }
    };
    for separator in separators(text) {
        let records = records(text, separator);
        let strong = matches!(separator, Separator::Tab | Separator::Semicolon | Separator::Pipe);
        match layout(&records, separator, want) {
            Ok(found) => {
                if separator == Separator::Comma && !commas_separate(&found) {
                    continue;
                }
                let named = found.header_line.is_some() && found.columns.len() > 1;
                let wide =
                    found.columns.len() > 1 || found.places.len() > 1 && found.orientation == Orientation::Columns;
                // no other separator can do better
                let sure = strong && wide || named && separator == Separator::Comma;
                match readings(&source, separator, &found, want) {
                    Ok(read) => candidates.extend(read),
                    Err(diagnostic) if sure => return Err(diagnostic),
                    Err(diagnostic) => fail(2, diagnostic),
                }
                if sure {
                    break;
                }
            }
            Err(problem) => {
                let definite = !matches!(problem, NoLayout::NoNumbers | NoLayout::Count { .. });
                let diagnostic = explain(&source, problem, want);
                if definite && strong {
                    return Err(diagnostic);
                }
                fail(u8::from(definite), diagnostic);
            }
        }
    }
    if candidates.iter().any(|candidate| candidate.doubt.is_none()) {
        candidates.retain(|candidate| candidate.doubt.is_none());
    }
    let mut distinct: Vec<Candidate> = Vec::new();
    for candidate in candidates {
        if distinct.iter().all(|other| other.values != candidate.values) {
            distinct.push(candidate);
        }
    }
    match distinct.len() {
        0 => Err(failure.map_or_else(|| explain(&source, NoLayout::NoNumbers, want), |(_, diagnostic)| diagnostic)),
        1 => Ok(distinct.remove(0).understood),
        _ => Err(two_readings(&source, &distinct)),
    }
}

/// The separators that the text may have, the surest first.
fn separators(text: &str) -> Vec<Separator> {
    let mut found = Vec::new();
    for (mark, separator) in
        [('\t', Separator::Tab), (';', Separator::Semicolon), ('|', Separator::Pipe), (',', Separator::Comma)]
    {
        if text.contains(mark) {
            found.push(separator);
        }
    }
    if text.lines().any(|line| line.trim().contains("  ")) {
        found.push(Separator::AlignedBlanks);
    }
    found.extend([Separator::Lines, Separator::Blanks]);
    found
}

/// Whether commas may stand between these cells: not if the text after one would begin with a zero that no
/// number begins with, or hold a decimal comma.
fn commas_separate(layout: &Layout) -> bool {
    let mut cells = layout.columns.iter().flat_map(|column| &column.cells).flatten();
    let zero = |text: &str| {
        let digits = text.trim_start_matches(['+', '-']);
        digits.starts_with('0') && digits[1..].starts_with(|c: char| c.is_ascii_digit())
    };
    // 1,234 is no part 1 with the value 234
    let counted = layout.header_line.is_none()
        && layout
            .columns
            .iter()
            .any(|column| column.field == Field::PartId && column.cells.iter().flatten().any(grid::Cell::is_number));
    layout.columns.len() + layout.places.len() > 2 && !counted && !cells.any(|cell| zero(&cell.text))
}

/// The readings of a layout: one, or one for each decimal mark.
fn readings(
    source: &Arc<Source>,
    separator: Separator,
    layout: &Layout,
    want: &Want,
) -> Result<Vec<Candidate>, Diagnostic> {
    let cells = || {
        let values = layout.columns.iter().filter(|column| !column.field.is_index());
        values.flat_map(|column| column.cells.iter().flatten().chain(&column.nominal)).chain(&layout.others)
    };
    let only = |mark: DecimalMark| cells().find(|cell| marks(&cell.text) == Marks::Only(mark));
    let open = cells().find(|cell| marks(&cell.text) == Marks::Differ);
    let settled = |mark, by: Option<String>| vec![(mark, by)];
    let choices = match (want.decimal, only(DecimalMark::Point), only(DecimalMark::Comma), open) {
        (Some(mark), ..) => settled(mark, Some("as told by --decimal".to_owned())),
        (None, Some(point), Some(comma), _) => {
            let message = format!("the block has decimal points and commas: `{}` and `{}`", point.text, comma.text);
            return Err(Diagnostic::error(Code::BadTable, message)
                .at(source, comma.span.clone(), "")
                .help("write every number in the same way, or say which mark counts: --decimal comma"));
        }
        (None, Some(cell), None, open) => {
            settled(DecimalMark::Point, open.map(|_| format!("settled by `{}`", cell.text)))
        }
        (None, None, Some(cell), open) => {
            settled(DecimalMark::Comma, open.map(|_| format!("settled by `{}`", cell.text)))
        }
        (None, None, None, None) => settled(DecimalMark::Point, None),
        (None, None, None, Some(_)) => {
            // rackmesh itself writes points, so that 25.013 is doubted only where something else speaks for commas
            let comma = cells().any(|cell| cell.text.contains(','));
            if comma || layout.german {
                DecimalMark::ALL.map(|mark| (mark, None)).to_vec()
            } else {
                settled(DecimalMark::Point, None)
            }
        }
    };
    let several = choices.len() > 1;
    let has_decimals = cells().any(|cell| cell.text.contains(['.', ',']));
    let mut candidates = Vec::new();
    let mut failure = None;
    let mut mixed = None;
    for (mark, settled_by) in choices {
        if let Some(cell) = doubtful_thousands(layout, mark, want) {
            mixed = Some(cell);
            continue;
        }
        let read = match read::read(source, layout, mark, want) {
            Ok(read) => read,
            Err(diagnostic) => {
                failure = Some(diagnostic);
                continue;
            }
        };
        let account = Account {
            file: None,
            separator,
            decimal: has_decimals.then_some(mark),
            settled_by,
            orientation: layout.orientation,
            header_line: layout.header_line,
            columns: read.columns,
            other_columns: layout.other_columns.clone(),
            ignored: layout.ignored.clone(),
            count: layout.places.len(),
            unit: read.unit,
        };
        let understood = Understood { pasted: read.pasted, account };
        candidates.push(Candidate { understood, values: read.values, doubt: read.implausible });
    }
    if let Some(cell) = mixed.filter(|_| candidates.iter().all(|candidate| candidate.doubt.is_some())) {
        let message =
            format!("the block has decimal points and commas, so that `{}` can be read in two ways", cell.text);
        let label = format!("{} or {}?", cell.text.replace(',', "."), cell.text.replace([',', '.'], ""));
        return Err(Diagnostic::error(Code::AmbiguousBlock, message)
            .at(source, cell.span.clone(), label)
            .help("write every number in the same way, or say which mark counts: --decimal comma or --decimal point"));
    }
    if several {
        // what rules out one mark settles the other
        let doubt = candidates.iter().find_map(|candidate| candidate.doubt.clone());
        let doubt = doubt.or_else(|| failure.as_ref().map(|failure| failure.message.clone()));
        let by = doubt.map(|doubt| format!("otherwise {doubt}"));
        for candidate in candidates.iter_mut().filter(|candidate| candidate.doubt.is_none()) {
            candidate.understood.account.settled_by.clone_from(&by);
        }
    }
    match failure {
        Some(failure) if candidates.is_empty() => Err(failure),
        _ => Ok(candidates),
    }
}

/// A number that this decimal mark makes a thousandfold, because it has the other one, with nothing that speaks for
/// that: no number shows that the other mark groups thousands, and no nominal value is near.
fn doubtful_thousands<'a>(layout: &'a Layout, mark: DecimalMark, want: &Want) -> Option<&'a grid::Cell> {
    let told = want.decimal.is_some();
    let (decimal, other) = match mark {
        DecimalMark::Point => ('.', ','),
        DecimalMark::Comma => (',', '.'),
    };
    let values = || layout.columns.iter().filter(|column| !column.field.is_index());
    let cells =
        || values().flat_map(|column| column.cells.iter().flatten()).filter(|cell| marks(&cell.text) != Marks::None);
    let groups = |text: &str| text.contains(other) && (text.contains(decimal) || text.matches(other).count() > 1);
    if told || !cells().any(|cell| cell.text.contains(decimal)) || cells().any(|cell| groups(&cell.text)) {
        return None;
    }
    let nominal = |column: &layout::Column| {
        let given = || want.nominals.iter().any(|(kind, _)| column.field == Field::Error(*kind));
        column.holds != Some(Holds::Deviation) && (column.nominal.is_some() || given())
    };
    let unsure = values().filter(|column| !nominal(column)).flat_map(|column| column.cells.iter().flatten());
    let mut unsure = unsure.filter(|cell| cell.text.contains(other) && marks(&cell.text) == Marks::Differ);
    unsure.next()
}

/// The refusal of a block that can be read in more than one way.
fn two_readings(source: &Arc<Source>, candidates: &[Candidate]) -> Diagnostic {
    const SHOWN: usize = 4;
    let marks_only = candidates.windows(2).all(|pair| {
        let (a, b) = (&pair[0].understood.account, &pair[1].understood.account);
        a.separator == b.separator && a.orientation == b.orientation
    });
    let readings: Vec<_> = candidates
        .iter()
        .map(|candidate| {
            let account = &candidate.understood.account;
            let how = match (marks_only, account.decimal) {
                (true, Some(mark)) => mark.name().to_owned(),
                (_, mark) => {
                    let mark = mark.map_or_else(String::new, |mark| format!(", {}", mark.name()));
                    format!("{}{mark}", account.separator.name())
                }
            };
            let values: Vec<_> = candidate.values.iter().take(SHOWN).map(String::as_str).collect();
            let more = if candidate.values.len() > SHOWN { ", …" } else { "" };
            format!("with {how}: {}{more}", values.join(", "))
        })
        .collect();
    let open = candidates.iter().find_map(|candidate| first_open(&candidate.understood, source));
    let message = format!("the block can be read in {} ways", if candidates.len() == 2 { "two" } else { "several" });
    let help = format!(
        "{}; say which it is: --decimal comma or --decimal point{}",
        readings.join("; or "),
        if marks_only { "" } else { ", or put semicolons between the values" }
    );
    let diagnostic = Diagnostic::error(Code::AmbiguousBlock, message).help(help);
    match open {
        Some((span, text)) => {
            let label = format!("{} or {}?", text.replace(',', "."), text.replace([',', '.'], ""));
            diagnostic.at(source, span, label)
        }
        None => diagnostic,
    }
}

/// The first number that is another one with the other mark.
fn first_open(understood: &Understood, source: &Arc<Source>) -> Option<(std::ops::Range<usize>, String)> {
    let records = records(&source.text, understood.account.separator);
    let cell = records.into_iter().flat_map(|record| record.cells).find(|cell| marks(&cell.text) == Marks::Differ)?;
    let number = cell.text.trim_end_matches(|c: char| !c.is_ascii_digit()).to_owned();
    Some((cell.span, number))
}

/// Why a text is no table, for people.
fn explain(source: &Arc<Source>, problem: NoLayout, want: &Want) -> Diagnostic {
    let error = |message: String| Diagnostic::error(Code::BadTable, message);
    let order = || {
        let names: Vec<_> = want.expected.iter().map(|kind| kind.key()).collect();
        if names.is_empty() { "the spec's [errors] name none".to_owned() } else { names.join(", ") }
    };
    match problem {
        NoLayout::NoNumbers => error(format!("{} holds no table of numbers", source.name))
            .help("paste a header row and rows of numbers, or numbers with --as rack_over_roller"),
        NoLayout::TwoMeanings { heading, fields } => {
            let fields: Vec<_> = fields.iter().map(|field| field.key()).collect();
            Diagnostic::error(Code::AmbiguousBlock, format!("`{}` could be {}", heading.text, fields.join(" or ")))
                .at(source, heading.span, "")
                .help(format!("name it `{}`, or say what the columns are: --as {}", fields[0], fields[0]))
        }
        NoLayout::Ragged { record, expected } => {
            let count = record.cells.len();
            let plural = if count == 1 { "" } else { "s" };
            error(format!("this row has {count} cell{plural}, and the table has {expected}"))
                .at(source, record.span, "")
                .help("a number with a blank or comma inside may have been cut in two; put semicolons between cells")
        }
        NoLayout::Twice { heading, field } => {
            error(format!("`{}` names {} a second time", heading.text, field.key())).at(source, heading.span, "")
        }
        NoLayout::Square => Diagnostic::error(
            Code::AmbiguousBlock,
            "the numbers have no names, and there are as many rows as columns: a part may be a row or a column",
        )
        .help("say which: --parts rows or --parts columns"),
        NoLayout::Count { columns, rows, span } => {
            let many = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
            let message = format!(
                "the numbers have no names: {} by {}, which do not fit {} ({})",
                many(rows, "row"),
                many(columns, "column"),
                if want.fields.is_empty() { "the spec's errors" } else { "--as" },
                if want.fields.is_empty() {
                    order()
                } else {
                    want.fields.iter().map(|field| field.key()).collect::<Vec<_>>().join(", ")
                }
            );
            error(message)
                .at(source, span, "")
                .help("say what the columns hold: --as rack_over_roller,rack_pitch, or paste the header row too")
        }
    }
}

#[cfg(test)]
mod tests;
