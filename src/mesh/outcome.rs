//! The result of a solve at one stroke, or why there is none. The solver makes it, every user of the mesh reads it.

use super::ContactKind;
use crate::quantity::Rounded;

named! {
    /// Which flank of the rack.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum FlankSide {
        /// The flanks that face +X.
        Right = "right",
        /// The flanks that face −X.
        Left = "left",
    }
}

display_by_name!(FlankSide);

impl FlankSide {
    /// The pinion tooth, 0 to z − 1, that touches the flank of a rack tooth on this side.
    #[must_use]
    pub fn pinion_tooth(self, rack_tooth: i64, teeth: u32) -> u32 {
        let partner = if self == Self::Right { rack_tooth } else { rack_tooth - 1 };
        u32::try_from(partner.rem_euclid(i64::from(teeth))).unwrap_or(0)
    }
}

/// The flank pair that carries on one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carrier {
    /// Tooth of the rack.
    pub rack_tooth: i64,
    /// Tooth of the pinion, 0 to z − 1.
    pub pinion_tooth: u32,
    /// Where on the flanks.
    pub contact: ContactKind,
}

/// Residual below which a stroke is solved, mm.
pub const SOLVED_MM: f64 = 1e-9;

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Ending {
    /// Both sides ask for the same centre distance within rounding.
    Converged,
    /// The bracket of the rotation shrank to neighbouring numbers first; the residual says how far both sides are
    /// apart.
    BracketExhausted,
    /// The same side asks for more at every rotation tried, the last one three quarters of a pitch from where the teeth
    /// face each other; the residual says how much more there.
    Unbalanced,
    /// The iteration limit was reached; the residual says how far both sides are apart.
    IterationLimit,
    /// Both sides are balanced, but the rack's roll is not known to be the one with the smallest centre distance: the
    /// search was given up, or its lowest roll is at the end of what is searched. The residual is that of both sides.
    RollNotFound,
}

/// The mesh at one stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshPoint {
    /// Stroke s, mm.
    pub stroke_mm: f64,
    /// Centre distance a at zero backlash, mm.
    pub center_distance_mm: f64,
    /// ΔCD = a − a_0, mm.
    pub delta_cd_mm: f64,
    /// Rotation of the pinion since s = 0, positive as the stroke rises, rad; nominally 2π s / (z p_x).
    pub pinion_angle_rad: f64,
    /// The rotation's difference from nominal, rad: the transmission error.
    pub transmission_error_rad: f64,
    /// Roll of the rack about its own axis, rad; 0 with a fixed support.
    pub roll_rad: f64,
    /// The pair that carries on right rack flanks.
    pub right: Carrier,
    /// The pair that carries on left rack flanks.
    pub left: Carrier,
    /// Difference of the centre distances that both sides ask for at the last rotation tried, mm; the
    /// result is corrected for it to first order.
    pub residual_mm: f64,
    /// Rotations tried.
    pub iterations: u32,
    /// How the solve ended.
    pub ending: Ending,
}

impl MeshPoint {
    /// Whether the solve converged.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.ending == Ending::Converged
    }

    /// Whether ΔCD is certain: both sides ask for the same within [`SOLVED_MM`], and no other roll of the rack can be lower.
    #[must_use]
    pub fn is_solved(&self) -> bool {
        matches!(self.ending, Ending::Converged | Ending::BracketExhausted) && self.residual_mm.abs() < SOLVED_MM
    }
}

/// The work of a sampler since it was made, in counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Strokes solved, or found to have no solution.
    pub strokes: u64,
    /// Rotations of the pinion tried, over all rolls of the rack.
    pub rotations: u64,
    /// Flank pairs whose constants were made.
    pub prepared: u64,
    /// Flank pairs in reach, counted at each rotation.
    pub in_reach: u64,
    /// Of those, the ones that could be the highest and were searched.
    pub searched: u64,
}

/// Why there is no mesh at a stroke, or none at all.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The stroke is not finite, or so large that tooth numbers are no longer exact.
    #[error("stroke {} mm is outside ±{} mm", Rounded(*.stroke_mm), Rounded(*.limit_mm))]
    StrokeOutOfDomain {
        /// The stroke.
        stroke_mm: f64,
        /// The largest one, mm.
        limit_mm: f64,
    },
    /// No pinion flank reaches any rack flank of one side.
    #[error("stroke {} mm: no pinion flank reaches a {side} rack flank", Rounded(*.stroke_mm))]
    NoContact {
        /// The stroke.
        stroke_mm: f64,
        /// The side without contact.
        side: FlankSide,
    },
    /// On both sides the pinion stands on the rack's tip plane: its teeth do not enter the spaces, and nothing holds
    /// its rotation.
    #[error(
        "stroke {} mm: the pinion stands on the tips of rack teeth {right} and {left}, its teeth do not enter the spaces",
        Rounded(*.stroke_mm)
    )]
    TipOnTip {
        /// The stroke.
        stroke_mm: f64,
        /// The tooth that carries right flanks.
        right: i64,
        /// The tooth that carries left flanks.
        left: i64,
    },
    /// Deviations are so large that a rack tooth has passed its neighbour, or its own flanks have.
    #[error("stroke {} mm: rack tooth {tooth} is displaced beyond its neighbour or has no thickness", Rounded(*.stroke_mm))]
    RackToothOrder {
        /// The stroke.
        stroke_mm: f64,
        /// The tooth.
        tooth: i64,
    },
    /// Deviations are so large that a pinion tooth has passed its neighbour, or its own flanks have.
    #[error("pinion tooth {tooth} is displaced beyond its neighbour or has no thickness")]
    PinionToothOrder {
        /// The tooth.
        tooth: u32,
    },
    /// The support's roll axis depth is not finite or beyond 1 km.
    #[error("roll axis depth {depth_mm} mm is outside ±1e6 mm")]
    RollAxis {
        /// The depth.
        depth_mm: f64,
    },
    /// A range of strokes that is empty or not finite.
    #[error("strokes {from_mm} .. {to_mm} mm are not a range")]
    EmptyRange {
        /// Its start.
        from_mm: f64,
        /// Its end.
        to_mm: f64,
    },
    /// A tolerance or a pin that is not a positive finite length.
    #[error("a {what} of {value_mm} mm: give a positive length")]
    NotPositive {
        /// What it is: `tolerance`.
        what: &'static str,
        /// The value.
        value_mm: f64,
    },
}
