//! Formulas as the standards print them: a sum of terms in module, diameter and face width, a part of such a sum, or the
//! root of the sum of squares of two.
//!
//! The files of the standards hold the sums as text, and this file evaluates the text. Reports show the same text, so they
//! show what is computed.

use super::permissible::{Permissible, RangeUse, Remark};
use super::range::Ranges;
use super::{Deviation, Size, Standard, StandardError, Wheel, rounding};

/// A sum of terms such as `0.3 m_n + 0.12 √d + 4`, in µm. A term is a coefficient alone, or before `m_n`, `√m_n`, `d`, `√d`,
/// `√b` or `√((k - 1) m_n)` with k = max(2, ⌊z/8⌋); sizes are in mm.
pub(super) type Sum = &'static str;

/// The shape of a formula.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    /// A sum of terms.
    Sum(Sum),
    /// A factor times another deviation's sum.
    Part(f64, Sum),
    /// The root of the sum of squares of two unrounded sums.
    RootSumSquare(Sum, Sum),
}

/// How a size enters a formula.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reading {
    /// The geometric mean of its range; outside the ranges there is no value.
    Mean(Ranges),
    /// The geometric mean of its range; outside the ranges the size itself, as gear programs do.
    MeanOrActual(Ranges),
    /// The size itself, between two limits.
    Actual(Ranges),
}

/// How module, diameter and face width enter a formula.
#[derive(Debug, Clone, Copy)]
pub(super) struct Readings {
    pub(super) module: Reading,
    pub(super) diameter: Reading,
    pub(super) face_width: Reading,
}

/// The permissible value of one deviation at grade 5, µm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Formula {
    pub(super) deviation: Deviation,
    pub(super) clause: &'static str,
    pub(super) shape: Shape,
    pub(super) readings: &'static Readings,
    pub(super) informative: bool,
}

impl Formula {
    /// A binding formula.
    pub(super) const fn new(
        deviation: Deviation,
        clause: &'static str,
        shape: Shape,
        readings: &'static Readings,
    ) -> Self {
        Self { deviation, clause, shape, readings, informative: false }
    }

    /// The same formula, for information only.
    pub(super) const fn informative(self) -> Self {
        Self { informative: true, ..self }
    }
}

/// The grade for which the formulas hold.
const BASE_GRADE: i32 = 5;

/// The permissible value of `deviation` by one of `formulas`.
pub(super) fn permissible(
    standard: Standard,
    formulas: &'static [Formula],
    deviation: Deviation,
    grade: u8,
    wheel: &Wheel,
) -> Result<Permissible, StandardError> {
    let formula = formulas
        .iter()
        .find(|formula| formula.deviation == deviation)
        .ok_or(StandardError::NoSuchDeviation { standard, deviation })?;
    let mut inputs = Inputs { standard, formula, wheel, ranges: Vec::new(), remarks: Vec::new() };
    let steps = i32::from(grade) - BASE_GRADE;
    let unrounded = rounding::micrometres(match formula.shape {
        Shape::Sum(terms) => grade_step(inputs.sum(terms)?, steps),
        Shape::Part(factor, terms) => grade_step(factor * inputs.sum(terms)?, steps),
        Shape::RootSumSquare(a, b) => {
            let (a, b) = (inputs.sum(a)?, inputs.sum(b)?);
            grade_step((a * a + b * b).sqrt(), steps)
        }
    });
    let mut remarks = inputs.remarks;
    if formula.informative {
        remarks.push(Remark::Informative);
    }
    Ok(Permissible {
        standard,
        grade,
        deviation,
        clause: formula.clause,
        formula: text(formula.shape),
        ranges: inputs.ranges,
        remarks,
        value: rounding::iso(unrounded),
        unrounded,
    })
}

/// The value of a grade that is `steps` coarser: each step is a factor of √2, two steps exactly 2.
fn grade_step(value: f64, steps: i32) -> f64 {
    let doubled = libm::ldexp(value, steps.div_euclid(2));
    if steps % 2 == 0 { doubled } else { doubled * std::f64::consts::SQRT_2 }
}

/// The numbers for one formula, and a record of those that it takes.
struct Inputs<'a> {
    standard: Standard,
    formula: &'a Formula,
    wheel: &'a Wheel,
    ranges: Vec<RangeUse>,
    remarks: Vec<Remark>,
}

impl Inputs<'_> {
    /// The value of a sum, µm.
    ///
    /// # Panics
    /// If a term is malformed: the sums stand in the source code, and the tests evaluate all of them.
    fn sum(&mut self, terms: Sum) -> Result<f64, StandardError> {
        let mut sum = 0.0;
        for term in terms.split(" + ") {
            let (coefficient, of) = term.split_once(' ').unwrap_or((term, ""));
            let number = match of {
                "" => 1.0,
                "m_n" => self.take(Size::NormalModule)?,
                "√m_n" => self.take(Size::NormalModule)?.sqrt(),
                "d" => self.take(Size::Diameter)?,
                "√d" => self.take(Size::Diameter)?.sqrt(),
                "√b" => self.take(Size::FaceWidth)?.sqrt(),
                "√((k - 1) m_n)" => {
                    let pitches = self.sector_pitches()?;
                    (f64::from(pitches - 1) * self.take(Size::NormalModule)?).sqrt()
                }
                _ => panic!("{of} is a size of a standard's formula"),
            };
            let coefficient: f64 = coefficient.parse().unwrap_or_else(|_| panic!("{coefficient} is a decimal number"));
            sum += coefficient * number;
        }
        Ok(sum)
    }

    fn missing(&self, size: Size) -> StandardError {
        StandardError::Missing { standard: self.standard, deviation: self.formula.deviation, size }
    }

    /// The number of pitches in an eighth of the teeth, k = max(2, ⌊z/8⌋).
    fn sector_pitches(&mut self) -> Result<u32, StandardError> {
        let teeth = self.wheel.teeth.ok_or_else(|| self.missing(Size::Teeth))?;
        let pitches = (teeth / 8).max(2);
        self.record(RangeUse { size: Size::Teeth, value: f64::from(teeth), range: None, taken: f64::from(pitches) });
        Ok(pitches)
    }

    /// The number that the formula takes for a size.
    fn take(&mut self, size: Size) -> Result<f64, StandardError> {
        let value = self.wheel.size(size).ok_or_else(|| self.missing(size))?;
        let reading = match size {
            Size::NormalModule => self.formula.readings.module,
            Size::Diameter => self.formula.readings.diameter,
            _ => self.formula.readings.face_width,
        };
        let ranges = match reading {
            Reading::Mean(ranges) | Reading::MeanOrActual(ranges) | Reading::Actual(ranges) => ranges,
        };
        let range = ranges.of(value);
        let (range, taken) = match (reading, range) {
            (Reading::Mean(_) | Reading::MeanOrActual(_), Some(range)) => {
                let mean = range.geometric_mean();
                (Some(range), mean)
            }
            (Reading::Actual(_), Some(_)) => (None, value),
            (Reading::MeanOrActual(_), None) if value > 0.0 => {
                let remark = Remark::ActualSizeOutsideRanges(size);
                if !self.remarks.contains(&remark) {
                    self.remarks.push(remark);
                }
                (None, value)
            }
            (_, None) => return Err(out_of_scope(self.standard, size, value, ranges.bound())),
        };
        self.record(RangeUse { size, value, range, taken });
        Ok(taken)
    }

    fn record(&mut self, used: RangeUse) {
        if !self.ranges.contains(&used) {
            self.ranges.push(used);
        }
    }
}

pub(super) fn out_of_scope(standard: Standard, size: Size, value: f64, bound: String) -> StandardError {
    StandardError::OutOfScope { standard, size, value: value.to_string(), bound }
}

/// The formula as text: `0.3 m_n + 0.12 √d + 4`.
fn text(shape: Shape) -> String {
    match shape {
        Shape::Sum(terms) => terms.to_owned(),
        Shape::Part(factor, terms) => format!("{factor} ({terms})"),
        Shape::RootSumSquare(a, b) => format!("√(({a})² + ({b})²)"),
    }
}
