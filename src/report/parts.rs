//! Parts of a batch for people: the measured values of each, and how far they are inside their limits.

use super::number::{deviation_number, deviation_text, ends, millimetres};
use super::table::Rows;
use super::{Block, Column, Table};
use crate::batch::{Part, PartError};
use crate::deviation::DeviationValue;
use crate::formula::ToleranceEnds;
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

/// The deviation, or both ends of its tolerance.
fn deviation(error: &PartError) -> String {
    deviation_text(error.deviation, error.tolerance.map(ToleranceEnds::base))
}

/// Whether an error has a limit that is not the one its part is nearest to, whose margin stands with the part.
fn has_margin_of_its_own(part: &Part, error: &PartError) -> bool {
    error.margin.is_some() && part.on != Some(LimitTarget::Error(error.kind))
}

/// The unit of a deviation in a column of its own.
fn unit(value: DeviationValue) -> &'static str {
    if matches!(value, DeviationValue::Length(_)) { "µm" } else { "°" }
}

/// The measured values of one part, an error a row; `None` for a part with measured teeth.
#[must_use]
pub fn part_block(part: &Part) -> Option<Block> {
    let has_nominal = part.errors.iter().any(|error| error.nominal.is_some());
    let in_unit = |size: String| if size.ends_with('°') { size } else { format!("{size} mm") };
    let measured = |error: &PartError| match measured(error) {
        _ if error.of_every_part => "not, from the spec".to_owned(),
        Some(size) => in_unit(size),
        None => deviation(error),
    };
    let has_margin = part.errors.iter().any(|error| has_margin_of_its_own(part, error));
    Table::of(&part.errors)
        .text("error", |error| error.kind.to_string())
        .number("measured", |error| measured(error))
        .column_if(has_nominal, Column::number("nominal"), |error| {
            error.nominal.map(|nominal| in_unit(size(nominal.base(), nominal)))
        })
        .number("deviation", |error| deviation(error))
        .number("ΔCD\n[mm]", |error| millimetres(error.delta_cd.mm()))
        .column_if(has_margin, Column::number("margin of ΔCD\n[mm]"), |error| margin(error))
        .block_if_any()
}

/// The measured values of parts, a part a row; `name` is above their names. What is the same for all of them is a line.
#[must_use]
pub fn parts_blocks(parts: &[Part], name: &str) -> Vec<Block> {
    let errors = parts.iter().map(|part| part.errors.as_slice()).max_by_key(|errors| errors.len()).unwrap_or_default();
    let mut table = judged(Table::of(parts).text(name, |part| part.id.clone()), parts);
    let (mut nominals, mut same) = (Vec::new(), Vec::new());
    for (index, first) in errors.iter().enumerate() {
        let error = |part: &&Part| part.errors.get(index).copied();
        let kind = first.kind.name();
        let has_margin = parts.iter().any(|part| error(&part).is_some_and(|error| has_margin_of_its_own(part, &error)));
        if parts.len() > 1 && parts.iter().all(|part| error(&part) == Some(*first)) {
            same.push(in_words(first));
            continue;
        }
        let nominal = first
            .nominal
            .filter(|_| parts.iter().all(|part| error(&part).is_none_or(|error| error.nominal == first.nominal)));
        nominals.extend(nominal.map(|nominal| format!("{kind} {nominal}")));
        table = table
            .column_if(first.nominal.is_some(), Column::number(format!("{kind}\nmeasured")), |part| {
                error(part).as_ref().and_then(measured)
            })
            .column_if(
                first.nominal.is_some() && nominal.is_none(),
                Column::number(format!("{kind}\nnominal")),
                |part| error(part)?.nominal.map(|nominal| size(nominal.base(), nominal)),
            )
            .number(format!("{kind}\ndeviation [{}]", unit(first.deviation)), |part| {
                error(part).map(|error| deviation_number(error.deviation))
            })
            .column_if(has_margin, Column::number(format!("{kind}\nmargin [mm]")), |part| {
                error(part).as_ref().and_then(margin)
            });
    }
    let line =
        |what: &str, all: Vec<String>| (!all.is_empty()).then(|| Block::Note(format!("{what}: {}.", all.join("; "))));
    let rejected = parts.iter().filter(|part| part.is_rejected).map(|part| part.id.clone()).collect();
    let lines = [
        line("Fail by their status", rejected),
        line("Nominal values", nominals),
        line("The same for each of these parts", same),
    ];
    table.block_if_any().into_iter().chain(lines.into_iter().flatten()).collect()
}

/// An error that is the same for all parts of a table.
fn in_words(error: &PartError) -> String {
    let measured = measured(error).zip(error.nominal);
    let measured = measured.map(|(size, nominal)| format!("{size}, nominal {nominal}, "));
    let margin = margin(error).map(|margin| format!(", margin {margin} mm")).unwrap_or_default();
    let (deviation, delta_cd) = (deviation(error), millimetres(error.delta_cd.mm()));
    format!("{} {}{deviation} (ΔCD {delta_cd} mm{margin})", error.kind, measured.unwrap_or_default())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::RowPlace;
    use crate::deviation::DeviationKind;
    use crate::evaluation::JudgedBy;
    use crate::quantity::Length;

    fn length(mm: f64) -> Length {
        Length::from_mm(mm).unwrap()
    }

    fn error(kind: DeviationKind, um: f64, margin_mm: Option<f64>) -> PartError {
        let nominal = margin_mm.map(|_| length(25.0).into());
        let (deviation, delta_cd) = (length(0.001 * um).into(), length(0.001 * um));
        PartError {
            kind,
            deviation,
            tolerance: None,
            of_every_part: false,
            nominal,
            delta_cd,
            margin: margin_mm.map(length),
        }
    }

    fn part(id: &str, on: LimitTarget, errors: Vec<PartError>) -> Part {
        let place = RowPlace { file: "lot.csv".into(), line: 2, record: 1, in_words: None };
        let (verdict, judged_by) = (Some(Verdict::Pass), JudgedBy::Bound);
        let (id, on, reason, yoke) = (id.to_owned(), Some(on), None, None);
        Part {
            id,
            place,
            verdict,
            margin_mm: 0.01,
            on,
            result_mm: (0.0, 0.01),
            reason,
            judged_by,
            errors,
            yoke,
            is_rejected: false,
            fails_otherwise: false,
        }
    }

    fn shown(parts: &[Part]) -> (Vec<String>, Vec<String>) {
        let (mut headings, mut lines) = (Vec::new(), Vec::new());
        for block in parts_blocks(parts, "part") {
            match block {
                Block::Table(table) => headings.extend(table.columns.into_iter().map(|column| column.heading)),
                Block::Note(line) => lines.push(line),
                other => panic!("{other:?}"),
            }
        }
        (headings, lines)
    }

    #[test]
    fn what_is_the_same_for_all_parts_is_a_line() {
        const OVER_ROLLER: DeviationKind = DeviationKind::RackOverRoller;
        let fixed = error(DeviationKind::RackPitch, 3.0, None);
        let two = |on, second| {
            let parts = [("A", 1.0), ("B", second)];
            parts.map(|(id, um)| part(id, on, vec![error(OVER_ROLLER, um, Some(0.02)), fixed]))
        };
        let (headings, lines) = shown(&two(LimitTarget::CenterDistance, 2.0));
        let of_error =
            ["rack over-roller\nmeasured", "rack over-roller\ndeviation [µm]", "rack over-roller\nmargin [mm]"];
        assert_eq!(headings[headings.len() - 3..], of_error);
        assert_eq!(
            lines,
            [
                "Nominal values: rack over-roller 25 mm.",
                "The same for each of these parts: rack pitch +3.0 µm (ΔCD +0.0030 mm)."
            ]
        );
        // the nearest limit's margin stands once
        let (headings, _) = shown(&two(LimitTarget::Error(OVER_ROLLER), 2.0));
        assert!(headings.iter().filter(|heading| heading.contains("margin")).eq(["margin\n[mm]"]), "{headings:?}");
        // one part has all its columns
        let [alone, _] = two(LimitTarget::CenterDistance, 2.0);
        assert!(shown(&[alone]).0.contains(&"rack pitch\ndeviation [µm]".to_owned()));
    }
}
