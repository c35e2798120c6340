//! ISO 1328-1:1995, the same as ANSI/AGMA ISO 1328-1: pitch, profile and helix deviations.
//!
//! m_n, d and b are the geometric means of the limits of their range. The formulas of clause 6 and annex B
//! (form and slope) hold for grade 5; the grades are 0 to 12. F_pk is f_pt + 1.6 √((k − 1) m_n) *at grade 5*: the
//! factor of the grade multiplies the sum once.

use super::Deviation;
use super::formula::{Formula, Reading, Readings, Shape, Sum};
use super::range::Ranges;

/// Ranges of the normal module, mm.
pub(super) const MODULES: Ranges = Ranges(&[0.5, 2.0, 3.5, 6.0, 10.0, 16.0, 25.0, 40.0, 70.0]);
/// Ranges of the reference diameter, mm.
pub(super) const DIAMETERS: Ranges =
    Ranges(&[5.0, 20.0, 50.0, 125.0, 280.0, 560.0, 1000.0, 1600.0, 2500.0, 4000.0, 6000.0, 8000.0, 10_000.0]);
/// Ranges of the face width, mm.
const FACE_WIDTHS: Ranges = Ranges(&[4.0, 10.0, 20.0, 40.0, 80.0, 160.0, 250.0, 400.0, 650.0, 1000.0]);

pub(super) const READINGS: Readings = Readings {
    module: Reading::Mean(MODULES),
    diameter: Reading::Mean(DIAMETERS),
    face_width: Reading::Mean(FACE_WIDTHS),
};

const fn formula(deviation: Deviation, clause: &'static str, terms: Sum) -> Formula {
    Formula::new(deviation, clause, Shape::Sum(terms), &READINGS)
}

const GRADE_5: &str = "formulae for grade 5";
const ANNEX_B: &str = "annex B";

pub(super) const FORMULAS: &[Formula] = &[
    // f_pt = 0.3 (m_n + 0.4 √d) + 4
    formula(Deviation::SinglePitch, GRADE_5, "0.3 m_n + 0.12 √d + 4"),
    // F_pk = f_pt + 1.6 √((k − 1) m_n)
    formula(Deviation::SectorPitch, GRADE_5, "0.3 m_n + 0.12 √d + 4 + 1.6 √((k - 1) m_n)"),
    formula(Deviation::TotalPitch, GRADE_5, "0.3 m_n + 1.25 √d + 7"),
    formula(Deviation::ProfileForm, ANNEX_B, "2.5 √m_n + 0.17 √d + 0.5"),
    formula(Deviation::ProfileSlope, ANNEX_B, "2 √m_n + 0.14 √d + 0.5"),
    formula(Deviation::TotalProfile, GRADE_5, "3.2 √m_n + 0.22 √d + 0.7"),
    formula(Deviation::HelixForm, ANNEX_B, HELIX_FORM_AND_SLOPE),
    formula(Deviation::HelixSlope, ANNEX_B, HELIX_FORM_AND_SLOPE),
    formula(Deviation::TotalHelix, GRADE_5, "0.1 √d + 0.63 √b + 4.2"),
];

/// f_fβ = f_Hβ
const HELIX_FORM_AND_SLOPE: Sum = "0.07 √d + 0.45 √b + 3";
