//! The decimal mark of a table: what its numbers, its nominal values and the lines beside it say. A shape gives one reading, or
//! one for each mark that is possible.

use std::sync::Arc;

use super::super::cell::{Cell, Content};
use super::super::grid::Separator;
use super::super::number::{DecimalMark, Marks};
use super::super::shape::{Shape, located};
use super::super::unknown::Unknown;
use super::super::want::Want;
use super::{Understood, read};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};

/// A decimal mark, and what speaks for it.
struct Choice {
    mark: DecimalMark,
    settled_by: Option<String>,
}

/// The readings of a shape: one, or one for each decimal mark.
pub(super) fn readings(
    source: &Arc<Source>,
    separator: Option<Separator>,
    shape: &Arc<Shape>,
    want: &Want,
) -> Result<Vec<Understood>, Diagnostics> {
    let choices = choices(source, separator, shape, want)?;
    let several = choices.len() > 1;
    let has_mark = |cell: &Cell| matches!(&cell.content, Content::Text(text) if text.contains(['.', ',', '．', '，']));
    let has_decimals = shape.number_cells().any(has_mark);
    let mut candidates = Vec::new();
    let mut failure = None;
    for Choice { mark, settled_by } in choices {
        match read(source, shape, mark, want) {
            Ok(read) => {
                let mark = (has_decimals || want.decimal.is_some()).then_some(mark);
                candidates.push(Understood { separator, mark, settled_by, ..read });
            }
            Err(problem) => failure = Some(problem),
        }
    }
    if several {
        candidates.iter_mut().for_each(Understood::examine);
        settle_mark(&mut candidates);
        // a line beside the table tells the mark where no value does
        if candidates.len() > 1 && candidates.iter().any(|candidate| candidate.settled_by.is_some()) {
            candidates.retain(|candidate| candidate.settled_by.is_some());
        }
    }
    match failure {
        Some(failure) if candidates.is_empty() => Err(failure),
        _ => Ok(candidates),
    }
}

/// What the numbers of a table say about their decimal mark.
#[derive(Default)]
struct Evidence<'s> {
    /// The first cell that is a number with a decimal point only.
    point: Option<&'s Cell>,
    comma: Option<&'s Cell>,
    /// Whether a cell is a different number with each.
    is_open: bool,
    /// Whether such a cell has a comma: between commas, it is in quotes.
    has_open_comma: bool,
}

impl<'s> Evidence<'s> {
    fn of(cells: impl Iterator<Item = &'s Cell>) -> Self {
        let mut evidence = Self::default();
        for cell in cells {
            match cell.marks() {
                Marks::None | Marks::Same => {}
                _ if !cell.is_measure() => {}
                Marks::Differ => {
                    evidence.is_open = true;
                    evidence.has_open_comma |= cell.text().contains(',');
                }
                Marks::Only(DecimalMark::Point) => evidence.point = evidence.point.or(Some(cell)),
                Marks::Only(DecimalMark::Comma) => evidence.comma = evidence.comma.or(Some(cell)),
            }
        }
        evidence
    }
}

/// Of the readings with either mark, leaves those that can be meant: what rules out one mark settles the other.
fn settle_mark(candidates: &mut Vec<Understood>) {
    let reasons: [fn(&Understood) -> Option<&String>; 2] =
        [|candidate| candidate.ruled_out.as_ref(), |candidate| candidate.doubt.as_ref()];
    for why in reasons {
        let Some(reason) = candidates.iter().find_map(why).cloned() else { continue };
        if candidates.iter().any(|candidate| why(candidate).is_none()) {
            candidates.retain(|candidate| why(candidate).is_none());
            for candidate in candidates {
                candidate.settled_by = Some(format!("otherwise {reason}"));
            }
            return;
        }
    }
}

/// The decimal marks that a table may have.
fn choices<'s>(
    source: &Arc<Source>,
    separator: Option<Separator>,
    shape: &'s Shape,
    want: &Want,
) -> Result<Vec<Choice>, Diagnostic> {
    let evidence = Evidence::of(shape.number_cells());
    let open = evidence.is_open;
    let by = |cell: &Cell| format!("settled by `{}`", cell.text());
    let one = |mark, settled_by| Ok(vec![Choice { mark, settled_by }]);
    match (want.decimal, evidence.point, evidence.comma) {
        (Some(mark), ..) => one(mark, Some("as told".to_owned())),
        (None, Some(point), Some(comma)) => {
            let message = format!("the table has decimal points and commas: `{}` and `{}`", point.text(), comma.text());
            // of two values, either mark leaves one that is no number
            let values = Evidence::of(shape.measurements.iter().flat_map(|measurement| &measurement.value.cells));
            let help = match (values.point, values.comma) {
                (Some(_), Some(_)) => "write every number in the same way",
                _ => {
                    "write every number in the same way, or say which mark counts: --decimal comma, or in the spec [batch] decimal = \"comma\""
                }
            };
            let diagnostic = Diagnostic::error(Code::BadTable, message).help(help);
            Err(located(diagnostic, source, comma.span.clone(), ""))
        }
        (None, Some(cell), None) => one(DecimalMark::Point, open.then(|| by(cell))),
        (None, None, Some(cell)) => one(DecimalMark::Comma, open.then(|| by(cell))),
        (None, None, None) if !open => one(DecimalMark::Point, None),
        (None, None, None) if separator == Some(Separator::COMMA) && !evidence.has_open_comma => {
            one(DecimalMark::Point, Some("commas separate".to_owned()))
        }
        (None, None, None) => {
            // what is no measurement tells the mark where no nominal value does
            let cells = |unknown: &'s Unknown| {
                let is_line = unknown.column.is_none();
                unknown.cells.iter().filter(move |cell| !is_line || cell.has_decimals())
            };
            let others = Evidence::of(shape.unknown.iter().flat_map(cells));
            let choice = |mark, cell: Option<&Cell>, other: Option<&Cell>| Choice {
                mark,
                settled_by: cell.filter(|_| other.is_none()).map(by),
            };
            let (point, comma) = (others.point, others.comma);
            Ok(vec![choice(DecimalMark::Point, point, comma), choice(DecimalMark::Comma, comma, point)])
        }
    }
}
