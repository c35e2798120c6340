//! Parts of a batch for people: the measured values of each, and how far they are inside their limits.

use super::number::{deviation_text, ends, millimetres};
use super::table::Rows;
use super::{Block, Column, Table};
use crate::batch::{Part, PartError};
use crate::deviation::DeviationValue;
use crate::judge::{LimitTarget, Verdict};

/// A size in mm or degrees, by the kind of another value.
fn size(base: f64, like: DeviationValue) -> String {
    let unit = if matches!(like, DeviationValue::Length(_)) { "" } else { "°" };
    format!("{base:.4}{unit}")
}

fn measured(error: &PartError) -> Option<String> {
    error.nominal.map(|nominal| size(nominal.base() + error.deviation.base(), nominal))
}

fn margin(error: &PartError) -> Option<String> {
    error.margin.map(|margin| millimetres(margin.mm()))
}

/// The measured values of one part, an error a row; `None` for a part with measured teeth.
#[must_use]
pub fn part_block(part: &Part) -> Option<Block> {
    let has_nominal = part.errors.iter().any(|error| error.nominal.is_some());
    let has_margin = part.errors.iter().any(|error| error.margin.is_some());
    Table::of(&part.errors)
        .text("error", |error| error.kind.to_string())
        .column_if(has_nominal, Column::number("measured\n[mm]"), |error| measured(error))
        .column_if(has_nominal, Column::number("nominal\n[mm]"), |error| {
            error.nominal.map(|nominal| size(nominal.base(), nominal))
        })
        .number("deviation", |error| deviation_text(error.deviation, None))
        .number("ΔCD\n[mm]", |error| millimetres(error.delta_cd.mm()))
        .column_if(has_margin, Column::number("margin of ΔCD\n[mm]"), |error| margin(error))
        .block_if_any()
}

/// The measured values of parts, a part a row; `name` is above their names.
#[must_use]
pub fn parts_block(parts: &[Part], name: &str) -> Option<Block> {
    let errors = parts.iter().map(|part| part.errors.as_slice()).max_by_key(|errors| errors.len()).unwrap_or_default();
    let mut table = judged(Table::of(parts).text(name, |part| part.id.clone()), parts);
    for (index, first) in errors.iter().enumerate() {
        let error = |part: &&Part| part.errors.get(index).copied();
        let (kind, nominal) = (first.kind.name(), first.nominal.map(|nominal| nominal.to_string()));
        let has_margin = parts.iter().any(|part| error(&part).is_some_and(|error| error.margin.is_some()));
        let heading = format!("{kind}\nmeasured, nominal {}", nominal.as_deref().unwrap_or_default());
        table = table
            .column_if(nominal.is_some(), Column::number(heading), |part| error(part).as_ref().and_then(measured))
            .number(format!("{kind}\ndeviation"), |part| error(part).map(|error| deviation_text(error.deviation, None)))
            .column_if(has_margin, Column::number("its margin\n[mm]"), |part| error(part).as_ref().and_then(margin));
    }
    table.block_if_any()
}

/// Adds the limits of parts, their results, and the verdict.
pub(super) fn judged<'p>(table: Rows<&'p Part>, parts: &[Part]) -> Rows<&'p Part> {
    let has_others = parts.iter().any(|part| part.on.is_some_and(|on| on != LimitTarget::CenterDistance));
    let result = |part: &&Part| {
        let (lower, upper) = part.result_mm;
        (lower.is_finite() && upper.is_finite()).then(|| ends(lower, upper))
    };
    table
        .column_if(has_others, Column::text("limit on ΔCD"), |part| part.on.map(|on| on.to_string()))
        .number("ΔCD\n[mm]", result)
        .number("margin\n[mm]", |part| part.on.map(|_| millimetres(part.margin_mm)))
        .text("verdict", |part| part.verdict.map(Verdict::name))
}
