//! ISO 1328-1:2013, the same as DIN ISO 1328-1:2018: pitch, profile and helix tolerances (clause 5.3) and, for
//! information, runout (annex E).
//!
//! The formulas of class 5 take the actual m_n, d and b; the classes are 1 to 11. F_αT and F_βT are the root sum
//! square of the unrounded slope and form tolerances; F_rT is 0.9 times the unrounded F_pT. The standard
//! forbids extrapolation beyond its scope (clause 1).

use super::formula::{Formula, Reading, Readings, Shape, Sum, out_of_scope};
use super::range::Ranges;
use super::{Deviation, Size, Standard, StandardError, Wheel};

const READINGS: Readings = Readings {
    module: Reading::Actual(Ranges(&[0.5, 70.0])),
    diameter: Reading::Actual(Ranges(&[5.0, 15_000.0])),
    face_width: Reading::Actual(Ranges(&[4.0, 1200.0])),
};

const TEETH: Ranges = Ranges(&[5.0, 1000.0]);
const HELIX_ANGLES: Ranges = Ranges(&[-45.0, 45.0]);

/// Checks the sizes that no formula takes, if they are given.
pub(super) fn check_scope(wheel: &Wheel) -> Result<(), StandardError> {
    let standard = Standard::Iso1328Part1Of2013;
    for (size, ranges) in [(Size::Teeth, TEETH), (Size::HelixAngle, HELIX_ANGLES)] {
        if let Some(value) = wheel.size(size)
            && ranges.of(value).is_none()
        {
            return Err(out_of_scope(standard, size, value, ranges.bound()));
        }
    }
    Ok(())
}

const fn formula(deviation: Deviation, shape: Shape) -> Formula {
    Formula::new(deviation, "clause 5.3", shape, &READINGS)
}

const TOTAL_PITCH: Sum = "0.002 d + 0.55 √d + 0.7 m_n + 12";
const PROFILE_FORM: Sum = "0.55 m_n + 5";
const PROFILE_SLOPE: Sum = "0.4 m_n + 0.001 d + 4";
const HELIX_FORM: Sum = "0.07 √d + 0.45 √b + 4";
const HELIX_SLOPE: Sum = "0.05 √d + 0.35 √b + 4";

pub(super) const FORMULAS: &[Formula] = &[
    formula(Deviation::SinglePitch, Shape::Sum("0.001 d + 0.4 m_n + 5")),
    formula(Deviation::TotalPitch, Shape::Sum(TOTAL_PITCH)),
    formula(Deviation::ProfileForm, Shape::Sum(PROFILE_FORM)),
    formula(Deviation::ProfileSlope, Shape::Sum(PROFILE_SLOPE)),
    formula(Deviation::TotalProfile, Shape::RootSumSquare(PROFILE_SLOPE, PROFILE_FORM)),
    formula(Deviation::HelixForm, Shape::Sum(HELIX_FORM)),
    formula(Deviation::HelixSlope, Shape::Sum(HELIX_SLOPE)),
    formula(Deviation::TotalHelix, Shape::RootSumSquare(HELIX_SLOPE, HELIX_FORM)),
    Formula::new(Deviation::Runout, "annex E", Shape::Part(0.9, TOTAL_PITCH), &READINGS).informative(),
];
