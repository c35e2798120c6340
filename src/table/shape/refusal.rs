//! Why records are no table, as data and for people.

use std::ops::Range;
use std::sync::Arc;

use crate::diagnostic::{Code, Diagnostic, Source};
use crate::quantity::shown;
use crate::table::cell::{Cell, Record};
use crate::table::names::Field;
use crate::table::want::{Want, ignore_option};

/// Why records are no table.
#[derive(Debug, Clone)]
pub(crate) enum NoShape {
    /// No line with a number.
    NoNumbers,
    /// Names, and no numbers below them.
    NoRows { names: String },
    /// A quote that is not closed.
    OpenQuote { line: u64 },
    /// A heading that could be two things.
    TwoMeanings { heading: Cell, fields: Vec<Field> },
    /// A list of names and values beside the table, in the line of its names.
    ListBeside { heading: Cell },
    /// A row that has more or fewer cells than the header.
    Ragged { record: Record, expected: usize },
    /// The same name twice, and the columns that may tell of which parts they are.
    Twice { heading: Cell, field: Field, may_tell: Vec<String> },
    /// Values of one part by its name, and of two batches.
    TwoBatches { what: String, help: String, record: Record },
    /// Numbers without names, and a count that does not fit what is expected.
    Count { columns: usize, rows: usize, span: Range<usize> },
    /// Values that have different units in different places.
    Units { record: Record },
    /// A column of nominal values or tolerances, and none of which it is clear that it holds a part's values.
    NoPart { heading: Cell },
    /// Two columns of actual values, or of another role that a table of characteristics has once.
    TwoColumns { first: Cell, second: Cell },
    /// Names in the table, and others told by the user.
    HasNames { record: Record },
    /// Numbers without known names, and a line that may say what they are.
    OtherNames { record: Record },
    /// A line of words that begins with a value behind its name and says more.
    Sentence { record: Record },
    /// A name with a number in one cell, and no column that is called one of values.
    InOneCell { cell: Cell },
    /// As many rows as columns, and no names: two ways to read it.
    Square,
}

impl NoShape {
    /// The same name twice, and nothing tells which counts.
    pub(super) fn twice(heading: &Cell, field: Field) -> Self {
        Self::Twice { heading: heading.clone(), field, may_tell: Vec::new() }
    }

    /// A row of a part that says another batch than a row before it.
    pub(super) fn two_batches(title: &str, [first, second]: [&Cell; 2], record: &Record) -> Self {
        let [first, second, named] = [&first.text(), &second.text(), title].map(shown);
        let what = format!(
            "`{named}` is `{second}`, and `{first}` in another row of the part: they may be two parts of one name"
        );
        let help = format!(
            "give each part a name of its own; or leave the column out, if it is one: {}",
            ignore_option(title)
        );
        Self::TwoBatches { what, help, record: record.clone() }
    }

    /// What is wrong, where, and what to do.
    pub(crate) fn explain(self, source: &Arc<Source>, want: &Want) -> Diagnostic {
        let at = |code: Code, span: Range<usize>, message: String| {
            located(Diagnostic::error(code, message), source, span, "")
        };
        let error = |span: Range<usize>, message: String| at(Code::BadTable, span, message);
        let ambiguous = |span: Range<usize>, message: String| at(Code::AmbiguousBlock, span, message);
        let of_line = |record: &Record, what: String| error(record.span(), format!("line {}: {what}", record.line));
        // where the message names the file
        let of_file = |message: String| Diagnostic::error(Code::BadTable, format!("{}{message}", source.name));
        match self {
            Self::NoNumbers => of_file(" holds no table of numbers".to_owned())
                .help(
                    "a table has a header row and rows of numbers; a line of a mail has a name, a value and its unit, `over roller: 25.012 mm`; numbers without names take --as rack_over_roller",
                ),
            Self::TwoBatches { what, help, record } => of_line(&record, what).help(help),
            Self::OpenQuote { line } => of_file(format!(
                ", line {line}: a quote is not closed, or lines later, so rows of the table are in one cell"
            ))
            .help("close it, or write it twice where it is meant"),
            Self::NoRows { names } => of_file(format!(" has names ({names}) and no row of numbers below them"))
                .help("no part was measured, so none can pass"),
            Self::TwoMeanings { heading, fields } => {
                let (title, first) = (heading.text(), fields[0].key());
                let each: Vec<_> = fields.iter().map(|field| field.key()).collect();
                ambiguous(heading.span.clone(), format!("`{title}` could be {}", each.join(" or "))).help(format!(
                    "say which it is: [batch.columns] {first} = {{ name = \"{title}\" }}, or name it `{first}`"
                ))
            }
            Self::Ragged { record, expected } => {
                let cells = many(record.filled().len(), "cell");
                let what = format!("the row has {cells}, and the table has {expected}");
                of_line(&record, what).help(if source.text.is_empty() {
                    // a sheet has cells of its own
                    "give the row a heading for each of its cells; take merged headings apart, or say which cells are the table: --range"
                } else if record.filled().len() < expected {
                    "where a cell is empty, write - in it; or put semicolons between cells"
                } else {
                    "a number with a blank or comma inside may have been cut in two; put semicolons between cells"
                })
            }
            Self::Units { record } => {
                of_line(&record, format!("nothing tells one unit for all numbers of `{}`", record.in_words())).help(
                    "write the same unit in the heading, below it, beside it and in every row, and one value for each part",
                )
            }
            Self::Twice { heading, field: Field::PartId, .. } => {
                let title = heading.text();
                let message = format!("`{title}` names the part a second time: another table begins there");
                error(heading.span.clone(), message)
                    .help("put its rows below those of the first; or give one after the other, of a workbook with --range")
            }
            Self::ListBeside { heading } => {
                let title = heading.text();
                let message = format!("`{title}` begins a list beside the table: names of other values stand below it");
                error(heading.span.clone(), message)
                    .help("say which cells of the workbook are the table: --range; take the list out of a text")
            }
            Self::Twice { heading, field, may_tell } => {
                let message = format!("`{}` names {} a second time", heading.text(), field.key());
                error(heading.span, message).help(twice_help(&may_tell))
            }
            Self::NoPart { heading } => {
                let message = format!("`{}` is no part's value, and nothing tells which column is", heading.text());
                error(heading.span, message)
                    .help("name the column of values: actual, measured, Ist; or the columns of parts")
            }
            Self::TwoColumns { first, second } => {
                let [first, title] = [first.text(), second.text()];
                let message = format!("`{first}` and `{title}` hold the same of each characteristic");
                error(second.span.clone(), message)
                    .help(format!("leave one of the columns out: {}", ignore_option(&title)))
            }
            Self::HasNames { record } => {
                of_line(&record, format!("the table has names of its own: {}", record.in_words()))
                    .help("leave out --as, which is for numbers without names, or say in the spec what the columns are")
            }
            Self::OtherNames { record } => {
                let what = format!("`{}` may say what the numbers are, and is not understood", record.in_words());
                of_line(&record, what)
                    .help("name the columns as the spec does, `rack_over_roller [mm]`; say what they hold: --as rack_over_roller; or leave the line out of the table")
            }
            Self::Sentence { record } => {
                let words = shown(&record.in_words());
                of_line(&record, format!("`{words}` says more than a value behind its name"))
                    .help("write each value into a line of its own, with its name, its unit and nothing else: `over roller: 25.012 mm`")
            }
            Self::InOneCell { cell } => {
                let title = shown(&cell.text());
                let is_both = format!("`{title}` is a name and a number in one cell");
                error(cell.span, format!("{is_both}, and nothing tells which column has the values"))
                    .help("put names, nominal values, units and values into columns called Characteristic, Nominal, Unit and Actual")
            }
            Self::Square => ambiguous(
                0..0,
                "the numbers have no names, and there are as many rows as columns: a part may be a row or a column"
                    .to_owned(),
            )
            .help("say which: --parts rows or --parts columns"),
            Self::Count { columns, rows, span } => error(span, count_does_not_fit(columns, rows, want))
                .help("say what the columns hold: --as rack_over_roller,rack_pitch, or give the header row too"),
        }
    }
}

/// What to do about a second one of a name, in columns that may tell of which part it is.
fn twice_help(may_tell: &[String]) -> String {
    let columns: Vec<_> = may_tell.iter().map(|title| format!("--id '{title}'")).collect();
    if columns.is_empty() {
        return "leave out the one that does not count: --ignore with its name, or in the spec [batch] ignore = [\"…\"]; two of one name, out of the table; if several parts have one each, name the column that tells which with --id".to_owned();
    }
    format!(
        "if several parts have one each, say which column tells them apart: {}; or leave out the one that does not count",
        columns.join(" or ")
    )
}

/// So many of something: `1 cell`, `2 cells`.
pub(crate) fn many(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Numbers without names of which nobody knows what they are.
fn count_does_not_fit(columns: usize, rows: usize, want: &Want) -> String {
    let (who, names) = if want.fields.is_empty() {
        let names: Vec<_> = want.expected.iter().map(|kind| kind.key()).collect();
        ("the spec's errors", if names.is_empty() { "it names none".to_owned() } else { names.join(", ") })
    } else {
        ("--as", want.fields.iter().map(|field| field.key()).collect::<Vec<_>>().join(", "))
    };
    format!(
        "the numbers have no names: {} by {}, which do not fit {who} ({names})",
        many(rows, "row"),
        many(columns, "column"),
    )
}

/// Points into the source, or names it where there is no text to point at.
pub(crate) fn located(diagnostic: Diagnostic, source: &Arc<Source>, span: Range<usize>, label: &str) -> Diagnostic {
    if span.is_empty() || source.text.len() < span.end {
        Diagnostic { message: format!("{}: {}", source.name, diagnostic.message), ..diagnostic }
    } else {
        diagnostic.at(source, span, label.to_owned())
    }
}
