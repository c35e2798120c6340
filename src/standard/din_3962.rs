//! DIN 3962-1 and DIN 3962-2, both of August 1978: single and total pitch, helix.
//!
//! The standard is a set of tables. This file holds only cells that public sources confirm: the helix deviations
//! of qualities 5 to 8 up to a face width of 100 mm (part 2), and the pitch deviations of qualities 1 to 6 for
//! modules over 1 to 2 mm (part 1). Every other cell is an error. The tables print rounded values; the unrounded
//! value is taken to be the same. DIN's own symbols are f_p for f_pt and f_βf for f_fβ.

use super::permissible::{Permissible, RangeUse};
use super::range::Ranges;
use super::rounding::micrometres;
use super::{Deviation, Size, Standard, StandardError, Wheel};

const STANDARD: Standard = Standard::Din3962;

pub(super) const DEVIATIONS: [Deviation; 5] =
    [Deviation::SinglePitch, Deviation::TotalPitch, Deviation::HelixForm, Deviation::HelixSlope, Deviation::TotalHelix];

/// Ranges of the face width in part 2, mm; the standard's lower bound is not known here.
const FACE_WIDTHS: Ranges = Ranges(&[0.0, 20.0, 40.0, 100.0]);
/// Qualities 5, 6, 7, 8 by range of face width: F_β, f_Hβ, f_βf in µm.
const HELIX: [[[f64; 3]; 4]; 3] = [
    [[7.0, 6.0, 4.5], [9.0, 8.0, 5.5], [13.0, 11.0, 7.0], [18.0, 16.0, 9.0]],
    [[8.0, 6.5, 6.0], [10.0, 9.0, 7.0], [15.0, 13.0, 9.0], [20.0, 18.0, 12.0]],
    [[10.0, 7.0, 7.0], [12.0, 10.0, 9.0], [18.0, 14.0, 12.0], [25.0, 20.0, 18.0]],
];
const CONFIRMED_HELIX: &str = "qualities 5 to 8 up to a face width of 100 mm are";

/// Range of the normal module in part 1, mm: over 1, up to 2.
const MODULES: Ranges = Ranges(&[1.0, 2.0]);
/// Ranges of the reference diameter in part 1, mm; the standard's lower bound is not known here.
const DIAMETERS: Ranges = Ranges(&[0.0, 10.0, 50.0, 125.0]);
/// Qualities 1 to 6 by range of diameter: f_p in µm.
const SINGLE_PITCH: [[f64; 6]; 3] =
    [[1.0, 1.5, 2.5, 3.0, 4.5, 6.0], [1.0, 1.5, 2.5, 3.5, 5.0, 7.0], [1.5, 2.0, 2.5, 4.0, 5.0, 7.0]];
/// Qualities 1 to 6 by range of diameter: F_p in µm.
const TOTAL_PITCH: [[f64; 6]; 2] = [[2.5, 4.0, 5.0, 7.0, 10.0, 14.0], [3.5, 5.0, 7.0, 10.0, 14.0, 18.0]];
const CONFIRMED_PITCH: &str =
    "qualities 1 to 6 are, for modules over 1 to 2 mm and diameters up to 125 mm (F_p: 50 mm)";

pub(super) fn permissible(deviation: Deviation, grade: u8, wheel: &Wheel) -> Result<Permissible, StandardError> {
    let (cell, clause, ranges) = match deviation {
        Deviation::SinglePitch | Deviation::TotalPitch => {
            let unconfirmed =
                StandardError::Unconfirmed { standard: STANDARD, deviation, grade, confirmed: CONFIRMED_PITCH };
            let module = entry(deviation, Size::NormalModule, MODULES, wheel, &unconfirmed)?;
            // "over 1": this range does not include its lower limit
            if module.1.value <= 1.0 {
                return Err(unconfirmed);
            }
            let diameter = entry(deviation, Size::Diameter, DIAMETERS, wheel, &unconfirmed)?;
            let rows: &[[f64; 6]] = if deviation == Deviation::SinglePitch { &SINGLE_PITCH } else { &TOTAL_PITCH };
            let column = usize::from(grade).checked_sub(1);
            let cell = column.and_then(|column| rows.get(diameter.0)?.get(column));
            (*cell.ok_or(unconfirmed)?, "part 1, table for modules over 1 to 2 mm", vec![module.1, diameter.1])
        }
        Deviation::TotalHelix | Deviation::HelixSlope | Deviation::HelixForm => {
            let unconfirmed =
                StandardError::Unconfirmed { standard: STANDARD, deviation, grade, confirmed: CONFIRMED_HELIX };
            let face_width = entry(deviation, Size::FaceWidth, FACE_WIDTHS, wheel, &unconfirmed)?;
            let column = usize::from(grade).checked_sub(5);
            let cells = column.and_then(|column| HELIX[face_width.0].get(column)).ok_or(unconfirmed)?;
            let cell = match deviation {
                Deviation::TotalHelix => cells[0],
                Deviation::HelixSlope => cells[1],
                _ => cells[2],
            };
            (cell, "part 2, table", vec![face_width.1])
        }
        _ => return Err(StandardError::NoSuchDeviation { standard: STANDARD, deviation }),
    };
    Ok(Permissible {
        standard: STANDARD,
        grade,
        deviation,
        clause,
        formula: "tabulated".to_owned(),
        ranges,
        remarks: Vec::new(),
        unrounded: micrometres(cell),
        value: micrometres(cell),
    })
}

/// The row of a table for a size.
fn entry(
    deviation: Deviation,
    size: Size,
    ranges: Ranges,
    wheel: &Wheel,
    unconfirmed: &StandardError,
) -> Result<(usize, RangeUse), StandardError> {
    let value = wheel.size(size).ok_or(StandardError::Missing { standard: STANDARD, deviation, size })?;
    let range = ranges.of(value).filter(|_| value > 0.0).ok_or_else(|| unconfirmed.clone())?;
    let row = ranges.0.iter().skip(1).position(|limit| *limit == range.up_to).unwrap_or(0);
    Ok((row, RangeUse { size, taken: value, value, range: Some(range) }))
}
