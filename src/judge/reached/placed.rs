//! Both parts' flanks with errors put on. Filled by the search, which knows what an error's extent allows; knows no extent.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use crate::deviation::{DeviationError, Part, PinionFlanks, PinionTooth, RackFlanks, RackTooth};
use crate::gear::Pair;
use crate::judge::bound::{GivenPair, pinion_lead_angle_rad};
use crate::mesh::{FlankSide, Mesh, MeshError};
use crate::trig;

/// Why nothing is found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReachedError {
    /// Errors that no flanks can have.
    #[error(transparent)]
    Deviation(#[from] DeviationError),
    /// The pair does not mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// No stroke has a solution without residual.
    #[error("no stroke near {stroke_mm} mm is solved")]
    Unsolved {
        /// The stroke.
        stroke_mm: f64,
    },
}

/// Rack teeth that errors are put on: all that carry within a few pitches of stroke 0, and many more.
pub const TEETH: RangeInclusive<i64> = -30..=36;

/// The flanks of both parts that errors have moved.
#[derive(Debug, Clone)]
pub(in crate::judge) struct Placed {
    pair: Pair,
    rack: Vec<RackTooth>,
    pinion: Vec<PinionTooth>,
    /// Per pinion tooth.
    slopes: Vec<BySide>,
}

/// A value for each flank of a tooth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::judge) struct BySide {
    pub(in crate::judge) left: f64,
    pub(in crate::judge) right: f64,
}

impl BySide {
    /// The same for both.
    pub(in crate::judge) const fn both(value: f64) -> Self {
        Self { left: value, right: value }
    }
}

/// What a flank of a rack tooth asks for, with the pinion flank that it meets.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct FlankDemand {
    /// Of both sides, mm of ΔCD.
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
    /// Without errors.
    pub(in crate::judge) fn new(pair: &Pair) -> Self {
        let z = pair.pinion().teeth as usize;
        Self {
            pair: *pair,
            rack: vec![RackTooth::default(); TEETH.count()],
            pinion: vec![PinionTooth::default(); z],
            slopes: vec![BySide::default(); z],
        }
    }

    /// The teeth of a part that errors are put on.
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
                if let Some(tooth) = self.rack_tooth(space) {
                    tooth.right.along_z_mm += value;
                }
                if let Some(tooth) = self.rack_tooth(space + 1) {
                    tooth.left.along_z_mm += value;
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
        match part {
            Part::Rack => {
                if let Some(tooth) = self.rack_tooth(tooth) {
                    tooth.left.along_x_mm += by.left;
                    tooth.right.along_x_mm += by.right;
                }
            }
            Part::Pinion => {
                let index = self.pinion_index(tooth);
                self.pinion[index].left.arc_mm += by.left;
                self.pinion[index].right.arc_mm += by.right;
            }
        }
    }

    /// Turns the flanks of a tooth: by angles of the rack, rad; by slope deviations f_Hβ of the pinion, mm.
    pub(in crate::judge) fn turn(&mut self, part: Part, tooth: i64, by: BySide) {
        match part {
            Part::Rack => {
                if let Some(tooth) = self.rack_tooth(tooth) {
                    tooth.left.lead_rad += by.left;
                    tooth.right.lead_rad += by.right;
                }
            }
            Part::Pinion => {
                let index = self.pinion_index(tooth);
                self.slopes[index].left += by.left;
                self.slopes[index].right += by.right;
            }
        }
    }

    /// The flanks, with the form that the pair has.
    pub(in crate::judge) fn flanks(&self, given: &GivenPair) -> Result<(RackFlanks, PinionFlanks), ReachedError> {
        let turned = |(tooth, slopes): (&PinionTooth, &BySide)| {
            let mut tooth = *tooth;
            tooth.left.lead_rad = pinion_lead_angle_rad(&self.pair, slopes.left);
            tooth.right.lead_rad = pinion_lead_angle_rad(&self.pair, slopes.right);
            tooth
        };
        let pinion: Vec<PinionTooth> = self.pinion.iter().zip(&self.slopes).map(turned).collect();
        let rack: BTreeMap<i64, RackTooth> = TEETH.zip(self.rack.iter().copied()).collect();
        let rack = RackFlanks::nominal(&self.pair).with_measured(&rack)?.with_form(&self.pair, given.rack_form)?;
        let pinion = PinionFlanks::nominal(&self.pair).with_measured(&pinion)?.with_form(given.pinion_form)?;
        Ok((rack, pinion))
    }

    /// The mesh of the flanks.
    pub(in crate::judge) fn mesh(&self, given: &GivenPair) -> Result<Mesh, ReachedError> {
        let (rack, pinion) = self.flanks(given)?;
        Ok(Mesh::new(self.pair, rack, pinion, given.support)?)
    }

    /// What a flank of a rack tooth asks for. The right one meets the left flank of the pinion's tooth with the same number, the
    /// left one the right flank of the tooth before.
    pub(super) fn asked(&self, side: FlankSide, tooth: i64) -> FlankDemand {
        let rack = self.rack_or_nominal(tooth);
        let pinion = self.pinion_index(if side == FlankSide::Right { tooth } else { tooth - 1 });
        let (arcs, slopes) = (&self.pinion[pinion], &self.slopes[pinion]);
        let (rack, arc_mm, pinion_slope_mm, sign) = match side {
            FlankSide::Right => (rack.right, arcs.left.arc_mm, slopes.left, 1.0),
            FlankSide::Left => (rack.left, arcs.right.arc_mm, slopes.right, -1.0),
        };
        let cos_r = trig::cos(self.pair.rack().helix_angle_rad);
        let by_x = rack.along_x_mm * cos_r / trig::tan(self.pair.normal_pressure_angle_rad());
        let by_arc = arc_mm / trig::tan(self.pair.pinion().transverse_pressure_angle_rad);
        let by_mm = sign * by_x + rack.along_z_mm - sign * by_arc;
        FlankDemand { by_mm, rack_turn_rad: rack.lead_rad, pinion_slope_mm }
    }

    fn rack_tooth(&mut self, tooth: i64) -> Option<&mut RackTooth> {
        usize::try_from(tooth - *TEETH.start()).ok().and_then(|index| self.rack.get_mut(index))
    }

    fn rack_or_nominal(&self, tooth: i64) -> RackTooth {
        let index = usize::try_from(tooth - *TEETH.start()).ok();
        index.and_then(|index| self.rack.get(index)).copied().unwrap_or_default()
    }

    fn pinion_index(&self, tooth: i64) -> usize {
        let z = i64::from(self.pair.pinion().teeth);
        usize::try_from(tooth.rem_euclid(z)).unwrap_or(0)
    }
}
