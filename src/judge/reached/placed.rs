//! The flanks of both parts with errors on their teeth. The search fills them; they know no extent of an error.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use crate::deviation::{
    DeviationError, Part, PinionFlank, PinionFlanks, PinionTooth, RackFlank, RackFlanks, RackTooth,
};
use crate::gear::Pair;
use crate::judge::bound::{GivenPair, pinion_lead_angle_rad};
use crate::mesh::{FlankSide, Mesh, MeshError};
use crate::trig;

/// Why no placement is found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReachedError {
    /// Errors that no flanks can have.
    #[error(transparent)]
    Deviation(#[from] DeviationError),
    /// The pair does not mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// No stroke is solved.
    #[error("no stroke near {stroke_mm} mm is solved")]
    Unsolved {
        /// The stroke.
        stroke_mm: f64,
    },
}

/// Rack teeth that may have errors: all that carry within a few pitches of stroke 0, and many more.
pub const TEETH: RangeInclusive<i64> = -30..=36;

/// The flanks of both parts that errors have moved.
#[derive(Debug, Clone)]
pub(in crate::judge) struct Placed {
    pair: Pair,
    rack: Vec<MovedTooth>,
    pinion: Vec<MovedTooth>,
}

/// How far a flank is moved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct MovedFlank {
    /// Along X, or along the reference circle of the pinion, mm.
    shift: f64,
    /// For the rack, along Z, mm.
    lift: f64,
    /// Turn of the rack's flank, rad; slope deviation f_Hβ of the pinion's, mm.
    turn: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct MovedTooth {
    left: MovedFlank,
    right: MovedFlank,
}

/// A value for each flank of a tooth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::judge) struct BySide {
    pub(in crate::judge) left: f64,
    pub(in crate::judge) right: f64,
}

impl BySide {
    /// One value for both flanks.
    pub(in crate::judge) const fn both(value: f64) -> Self {
        Self { left: value, right: value }
    }
}

/// The demand of a flank of a rack tooth with the pinion flank that it meets.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct FlankDemand {
    /// Demand by the errors of both parts, mm of ΔCD.
    pub(super) by_mm: f64,
    /// Turn of the rack's flank, rad.
    pub(super) rack_turn_rad: f64,
    /// Slope deviation of the pinion's flank, mm.
    pub(super) pinion_slope_mm: f64,
}

impl FlankDemand {
    /// Whether a tooth line is turned.
    pub(super) const fn turns(&self) -> bool {
        self.rack_turn_rad != 0.0 || self.pinion_slope_mm != 0.0
    }

    pub(super) fn add(&mut self, other: &Self, times: f64) {
        self.by_mm += times * other.by_mm;
        self.rack_turn_rad += times * other.rack_turn_rad;
        self.pinion_slope_mm += times * other.pinion_slope_mm;
    }
}

impl Placed {
    /// Flanks without errors.
    pub(in crate::judge) fn new(pair: &Pair) -> Self {
        let none = MovedTooth::default();
        Self { pair: *pair, rack: vec![none; TEETH.count()], pinion: vec![none; pair.pinion().teeth as usize] }
    }

    /// The teeth of a part that have errors.
    pub(in crate::judge) fn teeth(&self, part: Part) -> RangeInclusive<i64> {
        match part {
            Part::Rack => TEETH,
            Part::Pinion => 0..=i64::from(self.pair.pinion().teeth) - 1,
        }
    }

    /// Raises the space after a tooth, mm.
    pub(in crate::judge) fn raise_space(&mut self, part: Part, space: i64, value: f64) {
        match part {
            Part::Rack => {
                if let Some(tooth) = self.tooth(part, space) {
                    tooth.right.lift += value;
                }
                if let Some(tooth) = self.tooth(part, space + 1) {
                    tooth.left.lift += value;
                }
            }
            Part::Pinion => {
                let arc = value * trig::tan(self.pair.pinion().transverse_pressure_angle_rad);
                self.shift(Part::Pinion, space, BySide { left: 0.0, right: arc });
                self.shift(Part::Pinion, space + 1, BySide { left: -arc, right: 0.0 });
            }
        }
    }

    /// Shifts the flanks of a tooth along X, or along the reference circle, mm.
    pub(in crate::judge) fn shift(&mut self, part: Part, tooth: i64, by: BySide) {
        if let Some(tooth) = self.tooth(part, tooth) {
            tooth.left.shift += by.left;
            tooth.right.shift += by.right;
        }
    }

    /// Turns the flanks of a tooth: by angles of the rack, rad; by slope deviations f_Hβ of the pinion, mm.
    pub(in crate::judge) fn turn(&mut self, part: Part, tooth: i64, by: BySide) {
        if let Some(tooth) = self.tooth(part, tooth) {
            tooth.left.turn += by.left;
            tooth.right.turn += by.right;
        }
    }

    /// The flanks, with the form that the pair has.
    pub(in crate::judge) fn flanks(&self, given: &GivenPair) -> Result<(RackFlanks, PinionFlanks), ReachedError> {
        let on_rack =
            |MovedFlank { shift, lift, turn }| RackFlank { along_x_mm: shift, along_z_mm: lift, lead_rad: turn };
        let on_pinion = |MovedFlank { shift, turn, .. }| PinionFlank {
            arc_mm: shift,
            lead_rad: pinion_lead_angle_rad(&self.pair, turn),
        };
        let rack = self.rack.iter().map(|tooth| RackTooth { left: on_rack(tooth.left), right: on_rack(tooth.right) });
        let rack: BTreeMap<_, _> = TEETH.zip(rack).collect();
        let pinion = self.pinion.iter();
        let pinion = pinion.map(|tooth| PinionTooth { left: on_pinion(tooth.left), right: on_pinion(tooth.right) });
        let pinion: Vec<_> = pinion.collect();
        let rack = RackFlanks::nominal(&self.pair).with_measured(&rack)?.with_form(&self.pair, given.rack_form)?;
        let pinion = PinionFlanks::nominal(&self.pair).with_measured(&pinion)?.with_form(given.pinion_form)?;
        Ok((rack, pinion))
    }

    /// The mesh of the flanks.
    pub(in crate::judge) fn mesh(&self, given: &GivenPair) -> Result<Mesh, ReachedError> {
        let (rack, pinion) = self.flanks(given)?;
        Ok(Mesh::new(self.pair, rack, pinion, given.support)?)
    }

    /// The demand of a flank of a rack tooth. The right flank meets the left flank of the pinion tooth with the same number, the
    /// left flank meets the right flank of the tooth before.
    pub(super) fn asked(&self, side: FlankSide, tooth: i64) -> FlankDemand {
        let of = |part, tooth| self.index(part, tooth).map_or(MovedTooth::default(), |index| self.moved(part)[index]);
        let (rack, pinion, sign) = match side {
            FlankSide::Right => (of(Part::Rack, tooth).right, of(Part::Pinion, tooth).left, 1.0),
            FlankSide::Left => (of(Part::Rack, tooth).left, of(Part::Pinion, tooth - 1).right, -1.0),
        };
        let cos_r = trig::cos(self.pair.rack().helix_angle_rad);
        let by_x = rack.shift * cos_r / trig::tan(self.pair.normal_pressure_angle_rad());
        let by_arc = pinion.shift / trig::tan(self.pair.pinion().transverse_pressure_angle_rad);
        let by_mm = sign * by_x + rack.lift - sign * by_arc;
        FlankDemand { by_mm, rack_turn_rad: rack.turn, pinion_slope_mm: pinion.turn }
    }

    fn index(&self, part: Part, tooth: i64) -> Option<usize> {
        let place = match part {
            Part::Rack => tooth - *TEETH.start(),
            Part::Pinion => tooth.rem_euclid(i64::from(self.pair.pinion().teeth)),
        };
        usize::try_from(place).ok().filter(|index| *index < self.moved(part).len())
    }

    fn moved(&self, part: Part) -> &[MovedTooth] {
        match part {
            Part::Rack => &self.rack,
            Part::Pinion => &self.pinion,
        }
    }

    fn tooth(&mut self, part: Part, tooth: i64) -> Option<&mut MovedTooth> {
        let index = self.index(part, tooth)?;
        Some(if part == Part::Rack { &mut self.rack[index] } else { &mut self.pinion[index] })
    }
}
