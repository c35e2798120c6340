//! ISO 1328-1:1995, the same as ANSI/AGMA ISO 1328-1: pitch, profile and helix deviations.
//!
//! m_n, d and b are the geometric means of the limits of their range. The formulas of clause 6 and annex B
//! (form and slope) give grade 5; grades 0 to 12. F_pk is f_pt + 1.6 √((k − 1) m_n) *at grade 5*: both terms
//! take the factor of the grade once.

use super::Deviation;
use super::formula::{Formula, Reading, Readings, Shape, SizeTerm, Term};
use super::range::Ranges;

/// Ranges of the normal module, mm.
pub(super) const MODULES: Ranges = Ranges(&["0.5", "2", "3.5", "6", "10", "16", "25", "40", "70"]);
/// Ranges of the reference diameter, mm.
pub(super) const DIAMETERS: Ranges =
    Ranges(&["5", "20", "50", "125", "280", "560", "1000", "1600", "2500", "4000", "6000", "8000", "10000"]);
/// Ranges of the face width, mm.
const FACE_WIDTHS: Ranges = Ranges(&["4", "10", "20", "40", "80", "160", "250", "400", "650", "1000"]);

pub(super) const READINGS: Readings = Readings {
    module: Reading::Mean(MODULES),
    diameter: Reading::Mean(DIAMETERS),
    face_width: Reading::Mean(FACE_WIDTHS),
};

const fn formula(deviation: Deviation, clause: &'static str, terms: &'static [Term]) -> Formula {
    Formula { deviation, clause, shape: Shape::Sum(terms), readings: &READINGS, informative: false }
}

const GRADE_5: &str = "formulae for grade 5";
const ANNEX_B: &str = "annex B";

pub(super) const FORMULAS: &[Formula] = &[
    // f_pt = 0.3 (m_n + 0.4 √d) + 4
    formula(
        Deviation::SinglePitch,
        GRADE_5,
        &[Term("0.3", SizeTerm::M), Term("0.12", SizeTerm::RootD), Term("4", SizeTerm::One)],
    ),
    // F_pk = f_pt + 1.6 √((k − 1) m_n)
    formula(
        Deviation::SectorPitch,
        GRADE_5,
        &[
            Term("0.3", SizeTerm::M),
            Term("0.12", SizeTerm::RootD),
            Term("4", SizeTerm::One),
            Term("1.6", SizeTerm::RootSector),
        ],
    ),
    formula(
        Deviation::TotalPitch,
        GRADE_5,
        &[Term("0.3", SizeTerm::M), Term("1.25", SizeTerm::RootD), Term("7", SizeTerm::One)],
    ),
    formula(
        Deviation::ProfileForm,
        ANNEX_B,
        &[Term("2.5", SizeTerm::RootM), Term("0.17", SizeTerm::RootD), Term("0.5", SizeTerm::One)],
    ),
    formula(
        Deviation::ProfileSlope,
        ANNEX_B,
        &[Term("2", SizeTerm::RootM), Term("0.14", SizeTerm::RootD), Term("0.5", SizeTerm::One)],
    ),
    formula(
        Deviation::TotalProfile,
        GRADE_5,
        &[Term("3.2", SizeTerm::RootM), Term("0.22", SizeTerm::RootD), Term("0.7", SizeTerm::One)],
    ),
    formula(Deviation::HelixForm, ANNEX_B, HELIX_FORM_AND_SLOPE),
    formula(Deviation::HelixSlope, ANNEX_B, HELIX_FORM_AND_SLOPE),
    formula(
        Deviation::TotalHelix,
        GRADE_5,
        &[Term("0.1", SizeTerm::RootD), Term("0.63", SizeTerm::RootB), Term("4.2", SizeTerm::One)],
    ),
];

/// f_fβ = f_Hβ
const HELIX_FORM_AND_SLOPE: &[Term] =
    &[Term("0.07", SizeTerm::RootD), Term("0.45", SizeTerm::RootB), Term("3", SizeTerm::One)];
