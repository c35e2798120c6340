#![doc = include_str!("bound.md")]
//!
//! Called by whoever judges errors whose teeth are not known. [`ExtendedError`] is an error with its [`Extent`],
//! [`Basis`] what is known of the pair, and [`Basis::bound`] gives a [`Bound`]. It must not
//! know files, limits or reports.

mod basis;
mod counts;
pub(in crate::judge) mod error;
pub(in crate::judge) mod field;
mod known;
pub(in crate::judge) mod lead;
mod lead_tables;
mod levels;
mod moments;
mod pitch;
pub(in crate::judge) mod profile;
mod proportion;
mod scales;
mod single;
mod sum;
#[cfg(test)]
pub(in crate::judge) mod tests;
mod undercut;

pub use basis::{Basis, GivenGeometry, KnownPairs};
pub use error::{ExtendedError, HelixOfPinion, pinion_helix_slope_mm, pinion_lead_angle_rad};
pub use field::ContactPath;
pub use known::{GivenPair, KnownPair, KnownTeeth, Reach};
pub use proportion::ChangingErrors;
pub use scales::Scales;
pub use sum::{Bound, Combined};

use crate::deviation::Extent;
use crate::formula::Influence;

/// A range of ΔCD in mm, computed in f64: whoever holds it against decimal limits takes the nearest decimals.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Range {
    /// The lower end.
    pub lower: f64,
    /// The upper end.
    pub upper: f64,
}

impl Range {
    /// A rule applied to each end, with the same end of another range.
    pub(crate) fn with(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        Self { lower: of(self.lower, other.lower), upper: of(self.upper, other.upper) }
    }
}

/// What one error can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorRange {
    /// The lowest ΔCD that it can add to other errors.
    pub raw_lower_mm: f64,
    /// The lowest ΔCD of this error alone.
    pub lower_mm: f64,
    /// The highest ΔCD of this error alone.
    pub upper_mm: f64,
    /// The highest ΔCD that it can add to other errors.
    pub raw_upper_mm: f64,
    /// The highest ΔCD of this error and what undercut lifts at the same stroke; infinite where that is not looked at.
    pub upper_with_undercut_mm: f64,
    /// How many steps between teeth add up in it, at most; 0 where none are counted.
    pub in_contact: u32,
}

impl ErrorRange {
    #[inline]
    fn either_way(upper_mm: f64) -> Self {
        Self::within(-upper_mm, upper_mm)
    }

    #[inline]
    fn within(lower: f64, upper: f64) -> Self {
        let upper_with_undercut_mm = f64::INFINITY;
        Self {
            raw_lower_mm: lower,
            lower_mm: lower,
            upper_mm: upper,
            raw_upper_mm: upper,
            upper_with_undercut_mm,
            in_contact: 0,
        }
    }

    fn signed(value: f64) -> Self {
        Self::within(value, value)
    }

    /// What one error does, or none.
    fn or_nothing(self) -> Self {
        self.or(Self { upper_with_undercut_mm: f64::NEG_INFINITY, ..Self::either_way(0.0) })
    }

    /// What one error or another one does.
    fn or(self, other: Self) -> Self {
        Self {
            raw_lower_mm: self.raw_lower_mm.min(other.raw_lower_mm),
            lower_mm: self.lower_mm.min(other.lower_mm),
            upper_mm: self.upper_mm.max(other.upper_mm),
            raw_upper_mm: self.raw_upper_mm.max(other.raw_upper_mm),
            upper_with_undercut_mm: self.upper_with_undercut_mm.max(other.upper_with_undercut_mm),
            in_contact: self.in_contact.max(other.in_contact),
        }
    }

    /// With no end farther from 0 than this.
    fn limited(self, limit: f64) -> Self {
        Self {
            raw_lower_mm: self.raw_lower_mm.max(-limit),
            lower_mm: self.lower_mm.max(-limit),
            upper_mm: self.upper_mm.min(limit),
            raw_upper_mm: self.raw_upper_mm.min(limit),
            ..self
        }
    }

    /// With its ends in order: where contact is rare, what carries on lines and what edges stand back can cross.
    #[inline]
    fn ordered(self) -> Self {
        Self { lower_mm: self.lower_mm.min(self.upper_mm), upper_mm: self.upper_mm.max(self.lower_mm), ..self }
    }

    /// What it can do alone.
    #[must_use]
    pub const fn alone(self) -> Range {
        Range { lower: self.lower_mm, upper: self.upper_mm }
    }
}

/// What a pair without errors does whose geometry is not all known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OwnCurve {
    /// ΔCD stays at this, mm: its teeth are no more than thicker than the standard ones, or thinner.
    At(f64),
    /// It moves: flanks have form, or are undercut, and how far that goes only the whole geometry tells.
    Unknown,
}

impl Default for OwnCurve {
    fn default() -> Self {
        Self::At(0.0)
    }
}

/// What is known beside the errors, for errors of some size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Knowledge<'a> {
    basis: &'a Basis,
    /// The pair, if its geometry is known.
    pair: Option<&'a KnownPair>,
}

impl Knowledge<'_> {
    fn rolls(&self) -> bool {
        self.pair.map_or(self.basis.rolls, |known| known.given.rolls())
    }

    /// Whether a tooth of either part is stated to carry with both flanks always.
    fn has_both_flanks(&self) -> bool {
        matches!(self.basis.geometry, GivenGeometry::BothFlanks) && !self.rolls()
    }
}

/// Why there is no finite bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum NoBound {
    /// Pitches add up over the teeth in contact, and how many those are is not known.
    #[error("errors of many pitches add up over the teeth in contact: the pair's geometry is missing")]
    TeethInContactUnknown,
    /// The pair without errors moves ΔCD by itself, and how far is not known.
    #[error(
        "the pair without errors is not at ΔCD = 0, for its flanks have form or are undercut, or are thicker by an \
         unknown amount: its geometry is missing"
    )]
    OwnCurveUnknown,
    /// The errors are larger than those that the known pair was made for.
    #[error("the errors are larger than what the pair's geometry was prepared for")]
    BeyondReach,
    /// An error is no deviation that a bound can be given for: a lead of 45° and more.
    #[error("an error is too large for a bound: it is no deviation of teeth that mesh")]
    TooLarge,
    /// An error is not of the dimension that its formula takes, or is in total what does not accumulate.
    #[error("an error has a value or an extent that its formula does not take")]
    NotOfItsKind,
    /// Errors as large leave nothing of the pair's flanks.
    #[error("errors as large as these leave no flanks that mesh")]
    NoFlanks,
    /// The exact mesh that a bound starts from is not certain.
    #[error(
        "the mesh is not solved at every stroke that is judged, as `mesh` shows: check the tip diameter and the addendum"
    )]
    NotSolved,
    /// A statistical sum has nothing that scatters: every error was measured.
    #[error("nothing scatters: a measured error enters with its bound, and only tolerances spread")]
    NothingScatters,
    /// Edges alone carry, of which no bound is known.
    #[error("the flanks of this pair touch nowhere but at their edges: check the addendum and the tip diameter")]
    EdgesOnly,
}

/// What the height is from within which flanks are taken to touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeightFrom {
    /// A quarter of the face width: the module is not known.
    FaceWidth,
    /// 1.5 normal modules.
    Module,
    /// The rack's addendum, which is higher than either.
    Addendum,
}

/// How far over and under the reference plane flanks are taken to touch, where their height is not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssumedHeight {
    /// The height, mm.
    pub mm: f64,
    /// What it is from.
    pub from: HeightFrom,
}

/// What a bound rests on, and what would narrow it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// The pair's geometry would narrow the range.
    GeometryNarrows,
    /// So would the statement that both flanks of a tooth always carry.
    BothFlanksNarrows,
    /// The pair without errors is taken to stay at this ΔCD, mm: undercut or a contact ratio below 1 are not known.
    OwnCurveAt(f64),
    /// The known pair without errors is in this range, which the sum counts.
    OwnRange(Range),
    /// The sum counts what the teeth do that are known one by one: ΔCD in this range.
    KnownTeeth(Range),
    /// Where this is off by its uncertainty there is no range, so that nothing tells how uncertain the range is.
    OpenWithin(Influence),
    /// There is no range without the pair's geometry.
    GeometryNeeded,
    /// Flanks are taken to touch within this height over and under the reference plane.
    AssumedHeight(AssumedHeight),
    /// A statistical sum was asked for, and nothing scatters: the worst case is judged.
    NothingScatters,
    /// Pitch errors of every tooth are taken as shifts of whole teeth, whose thickness stays.
    WholeTeeth,
}
