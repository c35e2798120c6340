//! A permissible value with all that it follows from. Made by the files of the standards, shown by the reports of classes.

use std::fmt;

use super::range::SizeRange;
use super::{Deviation, Size, Standard};
use crate::quantity::{Length, LengthUnit};

/// How a formula or table took a size.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeUse {
    /// The size.
    pub size: Size,
    /// Its value, in mm, degrees or teeth.
    pub value: f64,
    /// The range that it lies in, where the standard has ranges.
    pub range: Option<SizeRange>,
    /// The number that the formula takes: the geometric mean of the range, the value itself, or k of z.
    pub taken: f64,
}

/// A remark on a permissible value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Remark {
    /// The size lies outside the tabulated ranges; the formula takes the size itself, as gear programs do.
    ActualSizeOutsideRanges(Size),
    /// The standard gives the value for information only.
    Informative,
    /// The standard's scope and rounding are not known here.
    ScopeAndRoundingUnknown,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ActualSizeOutsideRanges(size) => write!(
                f,
                "the {} lies outside the tabulated ranges; its actual value is used, as gear programs do in practice",
                size.name()
            ),
            Self::Informative => f.write_str("for information only in the standard"),
            Self::ScopeAndRoundingUnknown => f.write_str(
                "the scope and rounding of the standard are not known here: sizes not checked, value not rounded",
            ),
        }
    }
}

/// A permissible value of a deviation, by a grade of a standard.
#[derive(Debug, Clone, PartialEq)]
pub struct Permissible {
    /// The standard and edition.
    pub standard: Standard,
    /// The grade.
    pub grade: u8,
    /// The deviation.
    pub deviation: Deviation,
    /// The clause of the formula or table in the standard.
    pub clause: &'static str,
    /// The formula of grade 5 in symbols, or the table.
    pub formula: String,
    /// The sizes that the formula or table took.
    pub ranges: Vec<RangeUse>,
    /// Remarks on the value.
    pub remarks: Vec<Remark>,
    pub(super) unrounded: Length,
    pub(super) value: Length,
}

impl Permissible {
    /// The symbol, as the edition writes it.
    #[must_use]
    pub const fn symbol(&self) -> &'static str {
        self.standard.symbol(self.deviation)
    }

    /// Whether the standard's rounding is known; then [`value_um`](Self::value_um) is the number that the standard's tables
    /// print.
    #[must_use]
    pub fn is_rounded(&self) -> bool {
        !self.remarks.contains(&Remark::ScopeAndRoundingUnknown)
    }

    /// The permissible value, rounded as the standard rounds, µm.
    #[must_use]
    pub fn value_um(&self) -> f64 {
        self.value.in_unit(LengthUnit::Micrometre)
    }

    /// The value before rounding, µm.
    #[must_use]
    pub fn unrounded_um(&self) -> f64 {
        self.unrounded.in_unit(LengthUnit::Micrometre)
    }

    /// The permissible value as a length.
    #[must_use]
    pub const fn length(&self) -> Length {
        self.value
    }
}
