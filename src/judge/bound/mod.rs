#![doc = include_str!("bound.md")]
//!
//! Used where errors are judged whose teeth are not known. [`ExtendedError`] is an error with its [`Extent`], [`Basis`] is
//! what is known of the pair, and [`Basis::bound`] gives a [`Bound`]. It must not know files, limits or reports.

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

/// A range of ΔCD in mm, computed in f64. Before a comparison with decimal limits, take the nearest decimals.
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

/// The range of ΔCD that one error can cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorRange {
    /// The lowest ΔCD that the error can add to other errors.
    pub raw_lower_mm: f64,
    /// The lowest ΔCD of this error alone.
    pub lower_mm: f64,
    /// The highest ΔCD of this error alone.
    pub upper_mm: f64,
    /// The highest ΔCD that the error can add to other errors.
    pub raw_upper_mm: f64,
    /// The highest ΔCD of this error and undercut at the same stroke; infinite where that is not computed.
    pub upper_with_undercut_mm: f64,
    /// The most steps between teeth that add up; 0 where none are counted.
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

    /// The range of one error, or of none.
    fn or_nothing(self) -> Self {
        self.or(Self { upper_with_undercut_mm: f64::NEG_INFINITY, ..Self::either_way(0.0) })
    }

    /// The range of either of two errors.
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

    /// The range with its ends clipped to at most this distance from 0.
    fn limited(self, limit: f64) -> Self {
        Self {
            raw_lower_mm: self.raw_lower_mm.max(-limit),
            lower_mm: self.lower_mm.max(-limit),
            upper_mm: self.upper_mm.min(limit),
            raw_upper_mm: self.raw_upper_mm.min(limit),
            ..self
        }
    }

    /// The range with its ends in order: where contact is rare, the share of lines and that of edges can cross.
    #[inline]
    fn ordered(self) -> Self {
        Self { lower_mm: self.lower_mm.min(self.upper_mm), upper_mm: self.upper_mm.max(self.lower_mm), ..self }
    }

    /// The range of the error alone.
    #[must_use]
    pub const fn alone(self) -> Range {
        Range { lower: self.lower_mm, upper: self.upper_mm }
    }
}

/// The curve of a pair without errors whose geometry is not completely known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OwnCurve {
    /// ΔCD stays at this value, mm: its teeth differ from standard ones in thickness only.
    At(f64),
    /// ΔCD moves: flanks have form or are undercut, and only the whole geometry tells how far.
    Unknown,
}

impl Default for OwnCurve {
    fn default() -> Self {
        Self::At(0.0)
    }
}

/// What is known besides the errors, for errors of some size.
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

    /// Whether the spec states that a tooth of either part always carries with both flanks.
    fn has_both_flanks(&self) -> bool {
        matches!(self.basis.geometry, GivenGeometry::BothFlanks) && !self.rolls()
    }
}

/// Why there is no finite bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum NoBound {
    /// Pitches add up over the teeth in contact, whose number is not known.
    #[error("errors of many pitches add up over the teeth in contact: the pair's geometry is missing")]
    TeethInContactUnknown,
    /// The pair without errors moves ΔCD by itself, by an unknown amount.
    #[error(
        "the pair without errors is not at ΔCD = 0, for its flanks have form or are undercut, or are thicker by an \
         unknown amount: its geometry is missing"
    )]
    OwnCurveUnknown,
    /// The errors are larger than those that the known pair was made for.
    #[error("the errors are larger than what the pair's geometry was prepared for")]
    BeyondReach,
    /// An error is too large for a bound, such as a lead of 45° and more.
    #[error("an error is too large for a bound: it is no deviation of teeth that mesh")]
    TooLarge,
    /// An error has another dimension than its formula takes, or the extent `total` for a kind that does not accumulate.
    #[error("an error has a value or an extent that its formula does not take")]
    NotOfItsKind,
    /// Errors of this size leave nothing of the pair's flanks.
    #[error("errors as large as these leave no flanks that mesh")]
    NoFlanks,
    /// The exact mesh that a bound starts from is not certain.
    #[error(
        "the mesh is not solved at every stroke that is judged, as `mesh` shows: check the tip diameter and the addendum"
    )]
    NotSolved,
    /// Nothing scatters in a statistical sum: every error was measured.
    #[error("nothing scatters: a measured error enters with its bound, and only tolerances spread")]
    NothingScatters,
    /// Only edges carry, for which no bound is known.
    #[error("the flanks of this pair touch nowhere but at their edges: check the addendum and the tip diameter")]
    EdgesOnly,
}

/// The source of the height within which flanks are taken to touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeightFrom {
    /// A quarter of the face width: the module is not known.
    FaceWidth,
    /// 1.5 normal modules.
    Module,
    /// The rack's addendum, where it is higher than either.
    Addendum,
}

/// How far over and under the reference plane flanks are taken to touch, where their height is not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssumedHeight {
    /// The height, mm.
    pub mm: f64,
    /// The source of the height.
    pub from: HeightFrom,
}

/// What a bound assumes, and what would narrow it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// The pair's geometry would narrow the range.
    GeometryNarrows,
    /// The statement that both flanks of a tooth always carry would narrow the range, too.
    BothFlanksNarrows,
    /// The pair without errors is taken to stay at this ΔCD, mm: undercut or a contact ratio below 1 are not known.
    OwnCurveAt(f64),
    /// The share of the known pair in the sum: its own ΔCD wherever errors of this size shift the contact, so it grows with them.
    OwnRange(Range),
    /// The sum counts the teeth that are known one by one: their ΔCD is in this range.
    KnownTeeth(Range),
    /// If this size is off by its uncertainty there is no range, so the uncertainty of the range is not known.
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
