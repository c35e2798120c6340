//! Why records are no table, as data and for people.

use std::sync::Arc;

use crate::diagnostic::{Code, Diagnostic, Source};
use crate::table::cell::{Cell, Record};
use crate::table::names::Field;
use crate::table::want::Want;

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
    /// A row that has more or fewer cells than the header.
    Ragged { record: Record, expected: usize },
    /// The same name twice.
    Twice { heading: Cell, field: Field },
    /// Numbers without names, and a count that does not fit what is expected.
    Count { columns: usize, rows: usize, span: std::ops::Range<usize> },
    /// A characteristic whose rows have different units.
    Units { record: Record },
    /// A column of nominal values or tolerances, and none of which it is clear that it holds a part's values.
    NoPart { heading: Cell },
    /// Two columns of actual values, or of another role that a table of characteristics has once.
    TwoColumns { first: Cell, second: Cell },
    /// Names in the table, and others told by the user.
    HasNames { record: Record },
    /// As many rows as columns, and no names: two ways to read it.
    Square,
}

impl NoShape {
    /// What is wrong, where, and what to do.
    pub(crate) fn explain(self, source: &Arc<Source>, want: &Want) -> Diagnostic {
        let error = |message: String| Diagnostic::error(Code::BadTable, message);
        match self {
            Self::NoNumbers => error(format!("{} holds no table of numbers", source.name))
                .help("a table has a header row and rows of numbers; numbers without names take --as rack_over_roller"),
            Self::OpenQuote { line } => error(format!(
                "{}, line {line}: a quote is not closed, or lines later, so rows of the table are in one cell",
                source.name
            ))
            .help("close it, or write it twice where it is meant"),
            Self::NoRows { names } => {
                error(format!("{} has names ({names}) and no row of numbers below them", source.name))
                    .help("no part was measured, so none can pass")
            }
            Self::TwoMeanings { heading, fields } => {
                let title = heading.text();
                let each: Vec<_> = fields.iter().map(|field| field.key()).collect();
                let diagnostic =
                    Diagnostic::error(Code::AmbiguousBlock, format!("`{title}` could be {}", each.join(" or ")));
                located(diagnostic, source, heading.span.clone(), "").help(format!(
                    "say which it is: [batch.columns] {} = {{ name = \"{title}\" }}, or name it `{}`",
                    each[0], each[0]
                ))
            }
            Self::Ragged { record, expected } => {
                let count = record.filled().len();
                let plural = if count == 1 { "" } else { "s" };
                let message =
                    format!("line {}: the row has {count} cell{plural}, and the table has {expected}", record.line);
                located(error(message), source, record.span(), "").help(
                    "a number with a blank or comma inside may have been cut in two; put semicolons between cells",
                )
            }
            Self::Units { record } => {
                let message = format!("line {}: the unit is another than in the rows of the same name", record.line);
                located(error(message), source, record.span(), "").help("write the same unit in all of them")
            }
            Self::Twice { heading, field } => {
                let message = format!("`{}` names {} a second time", heading.text(), field.key());
                located(error(message), source, heading.span, "")
                    .help(format!("say which of them counts: [batch.columns] {} = {{ name = \"…\" }}", field.key()))
            }
            Self::NoPart { heading } => {
                let message = format!("`{}` is no part's value, and nothing tells which column is", heading.text());
                located(error(message), source, heading.span, "")
                    .help("name the column of values: actual, measured, Ist; or the columns of parts")
            }
            Self::TwoColumns { first, second } => {
                let message =
                    format!("`{}` and `{}` hold the same of each characteristic", first.text(), second.text());
                located(error(message), source, second.span, "").help("leave one of the columns out of the table")
            }
            Self::HasNames { record } => {
                let message = format!("line {}: the table has names of its own: {}", record.line, record.in_words());
                located(error(message), source, record.span(), "")
                    .help("leave out --as, which is for numbers without names, or say in the spec what the columns are")
            }
            Self::Square => {
                let message =
                    "the numbers have no names, and there are as many rows as columns: a part may be a row or a column";
                located(Diagnostic::error(Code::AmbiguousBlock, message), source, 0..0, "")
                    .help("say which: --parts rows or --parts columns")
            }
            Self::Count { columns, rows, span } => located(count_does_not_fit(columns, rows, want), source, span, "")
                .help("say what the columns hold: --as rack_over_roller,rack_pitch, or give the header row too"),
        }
    }
}

/// Numbers without names of which nobody knows what they are.
fn count_does_not_fit(columns: usize, rows: usize, want: &Want) -> Diagnostic {
    let many = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let (who, names) = if want.fields.is_empty() {
        let names: Vec<_> = want.expected.iter().map(|kind| kind.key()).collect();
        ("the spec's errors", if names.is_empty() { "it names none".to_owned() } else { names.join(", ") })
    } else {
        ("--as", want.fields.iter().map(|field| field.key()).collect::<Vec<_>>().join(", "))
    };
    let message = format!(
        "the numbers have no names: {} by {}, which do not fit {who} ({names})",
        many(rows, "row"),
        many(columns, "column"),
    );
    Diagnostic::error(Code::BadTable, message)
}

/// Points into the source, or names it where there is no text to point at.
pub(crate) fn located(
    diagnostic: Diagnostic,
    source: &Arc<Source>,
    span: std::ops::Range<usize>,
    label: &str,
) -> Diagnostic {
    if span.is_empty() || source.text.len() < span.end {
        Diagnostic { message: format!("{}: {}", source.name, diagnostic.message), ..diagnostic }
    } else {
        diagnostic.at(source, span, label.to_owned())
    }
}
