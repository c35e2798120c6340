//! JIS B 1702-1976, superseded in 1998 by the ISO system: single and total pitch of grades 0 to 8.
//!
//! The value of each grade is linear in the tolerance unit W = ∛d + 0.65 m_n. The coefficients come from a public table
//! (Stock Drive Products, *Elements of Metric Gear Technology*, table 15-1). The standard's scope and rounding are not
//! known here: sizes are not checked, values are not rounded, and every value says so.

use super::permissible::{Permissible, RangeUse, Remark};
use super::rounding::micrometres;
use super::{Deviation, Size, Standard, StandardError, Wheel};

const STANDARD: Standard = Standard::JisB1702Of1976;

pub(super) const DEVIATIONS: [Deviation; 2] = [Deviation::SinglePitch, Deviation::TotalPitch];

/// f_pt = a W + c, µm: a and c of grades 0 to 8.
const SINGLE_PITCH: [[f64; 9]; 2] =
    [[0.5, 0.71, 1.0, 1.4, 2.0, 2.8, 4.0, 8.0, 16.0], [1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.2, 22.4, 45.0]];

/// F_p = a W + c, µm: a and c of grades 0 to 8.
const TOTAL_PITCH: [[f64; 9]; 2] =
    [[2.0, 2.8, 4.0, 5.6, 8.0, 11.2, 16.0, 32.0, 64.0], [5.6, 8.0, 11.2, 16.0, 22.4, 31.5, 45.0, 90.0, 180.0]];

pub(super) fn permissible(deviation: Deviation, grade: u8, wheel: &Wheel) -> Result<Permissible, StandardError> {
    let [a, c] = match deviation {
        Deviation::SinglePitch => &SINGLE_PITCH,
        Deviation::TotalPitch => &TOTAL_PITCH,
        _ => return Err(StandardError::NoSuchDeviation { standard: STANDARD, deviation }),
    };
    let line = a.get(usize::from(grade)).zip(c.get(usize::from(grade)));
    let (a, c) = line.ok_or(StandardError::Grade { standard: STANDARD, grade })?;
    let mut ranges = Vec::new();
    let mut take = |size: Size| {
        let value = wheel.size(size).ok_or(StandardError::Missing { standard: STANDARD, deviation, size })?;
        if value <= 0.0 {
            return Err(super::formula::out_of_scope(STANDARD, size, value, "sizes above 0".to_owned()));
        }
        ranges.push(RangeUse { size, value, range: None, taken: value });
        Ok(value)
    };
    let (diameter, module) = (take(Size::Diameter)?, take(Size::NormalModule)?);
    let unit = libm::cbrt(diameter) + 0.65 * module;
    let value = micrometres(a * unit + c);
    Ok(Permissible {
        standard: STANDARD,
        grade,
        deviation,
        clause: "table of pitch errors",
        formula: format!("{a} W + {c}, W = ∛d + 0.65 m_n"),
        ranges,
        remarks: vec![Remark::ScopeAndRoundingUnknown],
        unrounded: value,
        value,
    })
}
