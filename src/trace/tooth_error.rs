//! An error of one tooth as an explanation of a measured curve, and the mesh with it.

use crate::deviation::{
    Part, PinionDeviation, PinionDeviationKind, PinionFlanks, RackDeviation, RackDeviationKind, ToothRange,
};
use crate::gear::Pair;
use crate::mesh::Mesh;
use crate::trig;

named! {
    /// The kind of a tooth's error, by its key in a spec.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum ToothErrorKind {
        /// Normal thickness at the rack's reference plane, or transverse thickness at the pinion's reference circle.
        Thickness = "thickness",
        /// The rack tooth's pitch line, shifted along the height.
        OverRoller = "over_roller",
        /// The radial position of the space after a pinion tooth.
        Radial = "radial",
        /// The tooth's position along the rack or the reference circle.
        Shift = "shift",
        /// Its right flank, outward positive.
        Right = "right",
        /// Its left flank, outward positive.
        Left = "left",
        /// The pitch before a rack tooth; it moves all later teeth.
        Pitch = "pitch",
        /// Its helix angle, as the helix slope deviation over the face width of its part.
        Lead = "lead",
    }
}

display_by_name!(ToothErrorKind);

/// An error of one tooth, without its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ToothError {
    /// The part.
    pub part: Part,
    /// The kind.
    pub kind: ToothErrorKind,
    /// The number of the tooth; on the pinion 0 to z − 1.
    pub tooth: i64,
}

impl ToothError {
    /// Every error of a tooth that can carry in a range of strokes, mm; those of the rack only if the pinion is a master.
    pub(super) fn all(pair: &Pair, (from_mm, to_mm): (f64, f64), is_master: bool) -> Vec<Self> {
        let (pitch, reach) = (pair.rack().pitch_mm, carrying_pitches(pair));
        let of_rack = (from_mm / pitch - reach).ceil() as i64..=(to_mm / pitch + reach).floor() as i64;
        let of_pinion = if is_master { 0..0 } else { 0..i64::from(pair.pinion().teeth) };
        let is_of = |part: Part, kind: ToothErrorKind| match part {
            Part::Rack => kind != ToothErrorKind::Radial,
            Part::Pinion => !matches!(kind, ToothErrorKind::OverRoller | ToothErrorKind::Pitch),
        };
        let of = |part: Part, tooth: i64| {
            let kinds = ToothErrorKind::ALL.into_iter().filter(move |kind| is_of(part, *kind));
            kinds.map(move |kind| Self { part, kind, tooth })
        };
        let rack = of_rack.flat_map(|tooth| of(Part::Rack, tooth));
        rack.chain(of_pinion.flat_map(|tooth| of(Part::Pinion, tooth))).collect()
    }

    /// Whether it can change ΔCD at a stroke, mm: where its flanks can carry, and half a pitch beyond, because errors lengthen
    /// the path of contact.
    pub(super) fn acts(self, pair: &Pair) -> impl Fn(f64) -> bool {
        const LONGER: f64 = 0.5;
        let (pitch, reach) = (pair.rack().pitch_mm, carrying_pitches(pair) + LONGER);
        let (tooth, turn) = (self.tooth as f64, f64::from(pair.pinion().teeth));
        move |stroke_mm| {
            let at = stroke_mm / pitch;
            match (self.part, self.kind) {
                (Part::Rack, ToothErrorKind::Pitch) => at >= tooth - 0.5 - reach,
                (Part::Rack, _) => (at - tooth).abs() <= reach,
                (Part::Pinion, kind) => {
                    // pinion tooth j sits half a pitch after rack tooth j; the space after it lies half a pitch further
                    let (place, reach) = if kind == ToothErrorKind::Radial { (1.0, reach) } else { (0.5, reach + 0.5) };
                    let apart = (at - tooth - place + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
                    apart.abs() <= reach
                }
            }
        }
    }

    /// Whether it changes the flank pair of these teeth.
    pub(super) fn is_of(&self, pair: &Pair, rack_tooth: i64, pinion_tooth: i64) -> bool {
        match (self.part, self.kind) {
            (Part::Rack, ToothErrorKind::Pitch) => rack_tooth >= self.tooth,
            (Part::Rack, _) => rack_tooth == self.tooth,
            // a space lies between flanks of two teeth
            (Part::Pinion, ToothErrorKind::Radial) => {
                let behind = (self.tooth + 1).rem_euclid(i64::from(pair.pinion().teeth));
                [self.tooth, behind].contains(&pinion_tooth)
            }
            (Part::Pinion, _) => pinion_tooth == self.tooth,
        }
    }

    /// The angle of a lead error of this size, rad; `None` for other errors.
    #[must_use]
    pub fn lead_rad(&self, pair: &Pair, size_mm: f64) -> Option<f64> {
        let face_mm = match self.part {
            Part::Rack => pair.rack().face_width_mm,
            Part::Pinion => pair.pinion().face_width_mm,
        };
        (self.kind == ToothErrorKind::Lead).then(|| trig::atan(size_mm / face_mm))
    }

    fn on_rack(&self, pair: &Pair, mm: f64) -> Option<RackDeviation> {
        use RackDeviationKind as Kind;
        let kind = match self.kind {
            _ if self.part == Part::Pinion => return None,
            ToothErrorKind::Thickness => Kind::Thickness(mm),
            ToothErrorKind::OverRoller => Kind::OverRoller(mm),
            ToothErrorKind::Shift => Kind::Shift(mm),
            ToothErrorKind::Right => Kind::Right(mm),
            ToothErrorKind::Left => Kind::Left(mm),
            ToothErrorKind::Pitch => Kind::Pitch(mm),
            ToothErrorKind::Lead => Kind::Lead(self.lead_rad(pair, mm)?),
            ToothErrorKind::Radial => return None,
        };
        Some(RackDeviation { teeth: ToothRange::new(Some(self.tooth), Some(self.tooth)).ok()?, kind })
    }

    fn on_pinion(&self, pair: &Pair, mm: f64) -> Option<PinionDeviation> {
        use PinionDeviationKind as Kind;
        let kind = match self.kind {
            _ if self.part == Part::Rack => return None,
            ToothErrorKind::Thickness => Kind::Thickness(mm),
            ToothErrorKind::Radial => Kind::Radial(mm),
            ToothErrorKind::Shift => Kind::Shift(mm),
            ToothErrorKind::Right => Kind::Right(mm),
            ToothErrorKind::Left => Kind::Left(mm),
            ToothErrorKind::Lead => Kind::Lead(self.lead_rad(pair, mm)?),
            ToothErrorKind::OverRoller | ToothErrorKind::Pitch => return None,
        };
        Some(PinionDeviation { teeth: ToothRange::of(u32::try_from(self.tooth).ok()?), kind })
    }
}

/// The largest distance of the stroke from a rack tooth's own place, in pitches, at which its nominal flanks carry.
fn carrying_pitches(pair: &Pair) -> f64 {
    let ratio = pair.contact_ratio();
    0.5 * ratio.total + ratio.offset.abs()
}

/// The largest error of a tooth, as a share of the normal module.
const LARGEST: f64 = 0.1;

/// A mesh with errors of single teeth added; `None` where they are larger than a tenth of the normal module, or too large for
/// teeth.
pub(super) fn with_errors(mesh: &Mesh, errors: &[(ToothError, f64)]) -> Option<Mesh> {
    let pair = mesh.pair();
    if errors.iter().any(|(_, mm)| mm.abs() > LARGEST * pair.normal_module_mm()) {
        return None;
    }
    let rack: Vec<_> = errors.iter().filter_map(|(error, mm)| error.on_rack(pair, *mm)).collect();
    let pinion: Vec<_> = errors.iter().filter_map(|(error, mm)| error.on_pinion(pair, *mm)).collect();
    let rack = mesh.rack().clone().with_deviations(pair, &rack).ok()?;
    let added = PinionFlanks::new(pair, &pinion).ok()?;
    let pinion = mesh.pinion().clone().with_measured(added.teeth()).ok()?;
    Mesh::new(*pair, rack, pinion, mesh.support()).ok()
}
