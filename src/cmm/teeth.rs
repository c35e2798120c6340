//! Tables with a row per tooth or space of one part. Called for the files that a spec names and for each part of a
//! batch of teeth; makes rows of quantities, and no deviations of them.

use std::ops::Range;
use std::sync::Arc;

use super::table::{Column, Holds, Table};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::quantity::{Angle, Length};

/// A value as a table gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measured {
    /// What was measured; its deviation follows with the nominal value.
    Absolute(Length),
    /// Measured minus nominal.
    Deviation(Length),
}

/// One space of a rack, between the teeth `space` and `space + 1`.
#[derive(Debug, Clone)]
pub struct RackSpace {
    /// The space's number.
    pub space: i64,
    /// Measure over the pin.
    pub over_pin: Option<Measured>,
    /// Position of the pin along the rack.
    pub position: Option<Measured>,
    /// Helix angle deviation.
    pub lead: Option<Angle>,
    /// The bytes of the row.
    pub span: Range<usize>,
}

/// A rack's spaces, and the text they came from.
#[derive(Debug, Clone)]
pub struct RackSpaces {
    /// The text.
    pub source: Arc<Source>,
    /// One per row.
    pub rows: Vec<RackSpace>,
}

/// One tooth of a pinion and the space after it.
#[derive(Debug, Clone)]
pub struct PinionTooth {
    /// The tooth's number.
    pub tooth: i64,
    /// Radial deviation of the space after it.
    pub radial: Option<Length>,
    /// Position of the pin in that space less its nominal one, along the reference circle.
    pub position: Option<Length>,
    /// Single pitch deviation of its left flank.
    pub left_pitch: Option<Length>,
    /// Single pitch deviation of its right flank.
    pub right_pitch: Option<Length>,
    /// Helix angle deviation of its flanks.
    pub lead: Option<Angle>,
    /// The bytes of the row.
    pub span: Range<usize>,
}

/// A pinion's teeth, and the text they came from.
#[derive(Debug, Clone)]
pub struct PinionTeeth {
    /// The text.
    pub source: Arc<Source>,
    /// One per row.
    pub rows: Vec<PinionTooth>,
}

const RACK: &[Column] = &[
    Column { name: "space", holds: Holds::Index },
    Column { name: "over_pin", holds: Holds::Length },
    Column { name: "over_pin_deviation", holds: Holds::Length },
    Column { name: "position", holds: Holds::Length },
    Column { name: "position_deviation", holds: Holds::Length },
    Column { name: "lead_deviation", holds: Holds::Angle },
];

const PINION: &[Column] = &[
    Column { name: "tooth", holds: Holds::Index },
    Column { name: "radial_deviation", holds: Holds::Length },
    Column { name: "position_deviation", holds: Holds::Length },
    Column { name: "left_pitch_deviation", holds: Holds::Length },
    Column { name: "right_pitch_deviation", holds: Holds::Length },
    Column { name: "lead_deviation", holds: Holds::Angle },
];

/// Reads a table of a rack's spaces: `over_pin` or `over_pin_deviation`, `position` or
/// `position_deviation`, `lead_deviation`, and `space`, without which the rows count from 0. Where both the
/// value and its deviation are given, the deviation counts.
///
/// # Errors
/// What is wrong, with the row and column.
pub fn rack_spaces(name: &str, text: &str) -> Result<RackSpaces, Diagnostic> {
    let source = source(name, text);
    let table = Table::read(&source, RACK)?;
    let measured = |row, absolute, deviation| -> Result<Option<Measured>, Diagnostic> {
        Ok(match table.quantity(row, deviation)? {
            Some(length) => Some(Measured::Deviation(length)),
            None => table.quantity(row, absolute)?.map(Measured::Absolute),
        })
    };
    let mut rows = Vec::with_capacity(table.len());
    for row in 0..table.len() {
        rows.push(RackSpace {
            space: index(&table, row, "space")?,
            over_pin: measured(row, "over_pin", "over_pin_deviation")?,
            position: measured(row, "position", "position_deviation")?,
            lead: table.quantity(row, "lead_deviation")?,
            span: table.span(row),
        });
    }
    no_row_twice(&source, rows.iter().map(|row| (row.space, row.span.clone())), "space")?;
    Ok(RackSpaces { rows, source: Arc::clone(&source) })
}

/// Reads a table of a pinion's teeth: `radial_deviation`, `position_deviation`, `left_pitch_deviation`,
/// `right_pitch_deviation`, `lead_deviation`, and `tooth`, without which the rows count from 0.
///
/// # Errors
/// What is wrong, with the row and column.
pub fn pinion_teeth(name: &str, text: &str) -> Result<PinionTeeth, Diagnostic> {
    let source = source(name, text);
    let table = Table::read(&source, PINION)?;
    let mut rows = Vec::with_capacity(table.len());
    for row in 0..table.len() {
        rows.push(PinionTooth {
            tooth: index(&table, row, "tooth")?,
            radial: table.quantity(row, "radial_deviation")?,
            position: table.quantity(row, "position_deviation")?,
            left_pitch: table.quantity(row, "left_pitch_deviation")?,
            right_pitch: table.quantity(row, "right_pitch_deviation")?,
            lead: table.quantity(row, "lead_deviation")?,
            span: table.span(row),
        });
    }
    no_row_twice(&source, rows.iter().map(|row| (row.tooth, row.span.clone())), "tooth")?;
    Ok(PinionTeeth { rows, source: Arc::clone(&source) })
}

fn source(name: &str, text: &str) -> Arc<Source> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    Arc::new(Source { name: name.to_owned(), text: text.to_owned() })
}

/// The number in the index column, or the row's own where there is no such column.
fn index(table: &Table<'_>, row: usize, name: &'static str) -> Result<i64, Diagnostic> {
    match table.index(row, name)? {
        Some(index) => Ok(index),
        None if table.has(name) => Err(table.bad_cell(row, name, "the cell is empty")),
        None => Ok(i64::try_from(row).unwrap_or(i64::MAX)),
    }
}

fn no_row_twice(
    source: &Arc<Source>,
    rows: impl Iterator<Item = (i64, Range<usize>)>,
    name: &str,
) -> Result<(), Diagnostic> {
    let mut seen = std::collections::BTreeSet::new();
    for (index, span) in rows {
        if !seen.insert(index) {
            let message = format!("{name} {index} has two rows");
            return Err(Diagnostic::error(Code::BadTable, message).at(source, span, ""));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        rack_spaces("rack.csv", text).unwrap_err().to_string()
    }

    fn over_pin(text: &str) -> Vec<Option<Measured>> {
        rack_spaces("rack.csv", text).unwrap().rows.into_iter().map(|row| row.over_pin).collect()
    }

    fn deviation(text: &str) -> Measured {
        Measured::Deviation(text.parse().unwrap())
    }

    #[test]
    fn separators_units_and_decimal_marks() {
        let expected = [Some(deviation("0.0125")), Some(deviation("-0.003"))];
        for text in [
            "space,over_pin_deviation [um],note\n0,12.5,a\n1,-3,b\n",
            "over_pin_deviation_mm;space\r\n0,0125;0\r\n-0,003;1",
            "Over pin deviation (µm)\tspace\n12,5\t0\n-3\t1\n",
            "\u{feff}over_pin_deviation\n0.0125\n-3 um\n\n",
        ] {
            assert_eq!(over_pin(text), expected, "{text}");
        }
        let both = "over_pin,over_pin_deviation\n25.01,0.01\n25.02,\n";
        let absolute = Some(Measured::Absolute("25.02".parse().unwrap()));
        assert_eq!(over_pin(both), [Some(deviation("0.01")), absolute]);
    }

    #[test]
    fn what_is_ambiguous_or_wrong_is_refused_with_its_place() {
        for (text, expected) in [
            ("over_pin\n1;2", "rack.csv:2:1: error[bad-table]: column `over_pin`: `;2` is not a unit"),
            (
                "over_pin;space\n25,013;0\n",
                "rack.csv:2:1: error[bad-table]: `25,013` could be 25.013 or 25013, and nothing",
            ),
            ("over_pin;space\n25,01;0\n25.01;1\n", "rack.csv:3:1: error[bad-table]: the table has decimal points"),
            ("over_pin,space\n25.0,x\n", "rack.csv:2:1: error[bad-table]: column `space`: `x` is not a whole"),
            ("over_pin,space\n25.0,\n", "rack.csv:2:1: error[bad-table]: column `space`: the cell is empty"),
            ("over_pin,space\n25.0,4\n25.1,4\n", "rack.csv:3:1: error[bad-table]: space 4 has two rows"),
            ("over_pin [deg]\n25.0\n", "rack.csv:2:1: error[bad-table]: column `over_pin`: `deg` is a unit of angle"),
            ("over_pin,over_pin\n1,2\n", "rack.csv:1:1: error[bad-table]: the table has two columns `over_pin`"),
            ("height\n1\n", "rack.csv:1:1: error[bad-table]: the table's header names no column that is known"),
            ("", "error[bad-table]: rack.csv has no rows"),
        ] {
            assert!(message(text).starts_with(expected), "{}", message(text));
        }
    }
}
