//! ISO 1328-2:1997: radial composite deviations (clause 7) and, for information, runout (annex B).
//!
//! m_n and d are the geometric means of the limits of their range; grades 4 to 12. F_r is 0.8 F_p of part 1,
//! with the ranges of part 1. Outside the ranges of F_i'' and f_i'', gear programs evaluate at the actual size,
//! and so does this one, with a remark: a public report of such a program prints F_i'' = 133 µm for m_n = 21.

use super::Deviation;
use super::formula::{Formula, Reading, Readings, Shape, SizeTerm, Term};
use super::iso_1328_1_1995;
use super::range::Ranges;

/// Ranges of the normal module for F_i'' and f_i'', mm.
const MODULES: Ranges = Ranges(&["0.2", "0.5", "0.8", "1", "1.5", "2.5", "4", "6", "10"]);
/// Ranges of the reference diameter for F_i'' and f_i'', mm.
const DIAMETERS: Ranges = Ranges(&["5", "20", "50", "125", "280", "560", "1000"]);

const READINGS: Readings = Readings {
    module: Reading::MeanOrActual(MODULES),
    diameter: Reading::MeanOrActual(DIAMETERS),
    face_width: iso_1328_1_1995::READINGS.face_width,
};

pub(super) const FORMULAS: &[Formula] = &[
    // F_r = 0.8 F_p = 0.24 m_n + 1.0 √d + 5.6
    Formula {
        deviation: Deviation::Runout,
        clause: "annex B",
        shape: Shape::Part("0.8", &[Term("0.3", SizeTerm::M), Term("1.25", SizeTerm::RootD), Term("7", SizeTerm::One)]),
        readings: &iso_1328_1_1995::READINGS,
        informative: true,
    },
    Formula {
        deviation: Deviation::RadialComposite,
        clause: "clause 7",
        shape: Shape::Sum(&[Term("3.2", SizeTerm::M), Term("1.01", SizeTerm::RootD), Term("6.4", SizeTerm::One)]),
        readings: &READINGS,
        informative: false,
    },
    Formula {
        deviation: Deviation::ToothRadialComposite,
        clause: "clause 7",
        shape: Shape::Sum(&[Term("2.96", SizeTerm::M), Term("0.01", SizeTerm::RootD), Term("0.8", SizeTerm::One)]),
        readings: &READINGS,
        informative: false,
    },
];
