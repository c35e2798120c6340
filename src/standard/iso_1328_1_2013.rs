//! ISO 1328-1:2013, the same as DIN ISO 1328-1:2018: pitch, profile and helix tolerances (clause 5.3) and, for
//! information, runout (annex E).
//!
//! The formulas of class 5 take the actual m_n, d and b; classes 1 to 11. F_αT and F_βT are the root sum
//! square of the unrounded slope and form tolerances; F_rT = 0.9 F_pT of the unrounded F_pT. The standard
//! forbids extrapolation beyond its scope (clause 1).

use super::formula::{Formula, Reading, Readings, Shape, SizeTerm, Term, out_of_scope};
use super::range::Ranges;
use super::{Deviation, Size, Standard, StandardError, Wheel};

const READINGS: Readings = Readings {
    module: Reading::Actual(Ranges(&["0.5", "70"])),
    diameter: Reading::Actual(Ranges(&["5", "15000"])),
    face_width: Reading::Actual(Ranges(&["4", "1200"])),
};

const TEETH: Ranges = Ranges(&["5", "1000"]);
const HELIX_ANGLES: Ranges = Ranges(&["-45", "45"]);

/// Checks the sizes that no formula takes, where they are given.
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
    Formula { deviation, clause: "clause 5.3", shape, readings: &READINGS, informative: false }
}

const TOTAL_PITCH: &[Term] =
    &[Term("0.002", SizeTerm::D), Term("0.55", SizeTerm::RootD), Term("0.7", SizeTerm::M), Term("12", SizeTerm::One)];
const PROFILE_FORM: &[Term] = &[Term("0.55", SizeTerm::M), Term("5", SizeTerm::One)];
const PROFILE_SLOPE: &[Term] = &[Term("0.4", SizeTerm::M), Term("0.001", SizeTerm::D), Term("4", SizeTerm::One)];
const HELIX_FORM: &[Term] = &[Term("0.07", SizeTerm::RootD), Term("0.45", SizeTerm::RootB), Term("4", SizeTerm::One)];
const HELIX_SLOPE: &[Term] = &[Term("0.05", SizeTerm::RootD), Term("0.35", SizeTerm::RootB), Term("4", SizeTerm::One)];

pub(super) const FORMULAS: &[Formula] = &[
    formula(
        Deviation::SinglePitch,
        Shape::Sum(&[Term("0.001", SizeTerm::D), Term("0.4", SizeTerm::M), Term("5", SizeTerm::One)]),
    ),
    formula(Deviation::TotalPitch, Shape::Sum(TOTAL_PITCH)),
    formula(Deviation::ProfileForm, Shape::Sum(PROFILE_FORM)),
    formula(Deviation::ProfileSlope, Shape::Sum(PROFILE_SLOPE)),
    formula(Deviation::TotalProfile, Shape::RootSumSquare(PROFILE_SLOPE, PROFILE_FORM)),
    formula(Deviation::HelixForm, Shape::Sum(HELIX_FORM)),
    formula(Deviation::HelixSlope, Shape::Sum(HELIX_SLOPE)),
    formula(Deviation::TotalHelix, Shape::RootSumSquare(HELIX_SLOPE, HELIX_FORM)),
    Formula {
        deviation: Deviation::Runout,
        clause: "annex E",
        shape: Shape::Part("0.9", TOTAL_PITCH),
        readings: &READINGS,
        informative: true,
    },
];
