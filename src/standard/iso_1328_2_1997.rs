//! ISO 1328-2:1997: radial composite deviations (clause 7) and, for information, runout (annex B).
//!
//! m_n and d are the geometric means of the limits of their range; the grades are 4 to 12. F_r is 0.8 F_p of part 1,
//! with the ranges of part 1. Outside the ranges of F_i'' and f_i'' the formula takes the actual size, with a remark, as
//! gear programs do: a public report of one prints F_i'' = 133 µm for m_n = 21.

use super::Deviation;
use super::formula::{Formula, Reading, Readings, Shape, Sum};
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

const fn composite(deviation: Deviation, terms: Sum) -> Formula {
    Formula::new(deviation, "clause 7", Shape::Sum(terms), &READINGS)
}

const fn runout(of_total_pitch: Sum) -> Formula {
    let shape = Shape::Part(0.8, of_total_pitch);
    Formula::new(Deviation::Runout, "annex B", shape, &iso_1328_1_1995::READINGS).informative()
}

pub(super) const FORMULAS: &[Formula] = &[
    // F_r = 0.8 F_p = 0.24 m_n + 1.0 √d + 5.6
    runout("0.3 m_n + 1.25 √d + 7"),
    composite(Deviation::RadialComposite, "3.2 m_n + 1.01 √d + 6.4"),
    composite(Deviation::ToothRadialComposite, "2.96 m_n + 0.01 √d + 0.8"),
];
