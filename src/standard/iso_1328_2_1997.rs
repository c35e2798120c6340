//! ISO 1328-2:1997: radial composite deviations (clause 7) and, for information, runout (annex B).
//!
//! m_n and d are the geometric means of the limits of their range; grades 4 to 12. F_r is 0.8 F_p of part 1,
//! with the ranges of part 1. Outside the ranges of F_i'' and f_i'', gear programs evaluate at the actual size,
//! and so does this one, with a remark: a public report of such a program prints F_i'' = 133 µm for m_n = 21.

use super::Deviation;
use super::formula::{Formula, Reading, Readings, Shape};
use super::iso_1328_1_1995;
use super::range::Ranges;

/// Ranges of the normal module for F_i'' and f_i'', mm.
const MODULES: Ranges = Ranges(&[0.2, 0.5, 0.8, 1.0, 1.5, 2.5, 4.0, 6.0, 10.0]);
/// Ranges of the reference diameter for F_i'' and f_i'', mm.
const DIAMETERS: Ranges = Ranges(&[5.0, 20.0, 50.0, 125.0, 280.0, 560.0, 1000.0]);

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
        shape: Shape::Part(0.8, "0.3 m_n + 1.25 √d + 7"),
        readings: &iso_1328_1_1995::READINGS,
        informative: true,
    },
    Formula {
        deviation: Deviation::RadialComposite,
        clause: "clause 7",
        shape: Shape::Sum("3.2 m_n + 1.01 √d + 6.4"),
        readings: &READINGS,
        informative: false,
    },
    Formula {
        deviation: Deviation::ToothRadialComposite,
        clause: "clause 7",
        shape: Shape::Sum("2.96 m_n + 0.01 √d + 0.8"),
        readings: &READINGS,
        informative: false,
    },
];
