//! What a permissible deviation does in the exact mesh: one part with that deviation alone, the other perfect.
//!
//! `class` calls it where the spec describes the pair fully. Each deviation is put on the teeth so that its measurement would
//! find it.

use crate::deviation::{
    DeviationError, FIRST_ODD_TOOTH, Part, PinionDeviation, PinionDeviationKind, PinionFlanks, PinionForm,
    RackDeviation, RackDeviationKind, RackFlanks, ToothRange,
};
use crate::gear::Pair;
use crate::judge::bound::pinion_lead_angle_rad;
use crate::mesh::{Mesh, MeshPoint, Support};
use crate::standard::Deviation;
use crate::trig;

/// A deviation of one part that is put on its teeth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArrangedDeviation {
    /// The part that has it.
    pub part: Part,
    /// The kind of deviation.
    pub deviation: Deviation,
    /// Its size, mm.
    pub amount_mm: f64,
    /// The width over which a helix slope is taken, mm.
    pub face_width_mm: f64,
    /// The number of pitches k of a sector.
    pub pitches: i64,
}

impl ArrangedDeviation {
    /// The largest |ΔCD|, or the difference of the largest and the smallest where that is more, mm, along a stroke of 50 mm or a
    /// turn of the pinion and a few teeth, whichever is longer; and in words how the deviation is put on the teeth. `None` if
    /// no arrangement on the teeth stands for the deviation, or if the mesh is not solved at every stroke.
    #[must_use]
    pub fn largest_delta_cd_mm(&self, pair: &Pair) -> Option<(f64, &'static str)> {
        const TOLERANCE_MM: f64 = 1e-6;
        let (words, rack, pinion) = match self.part {
            Part::Rack => self.rack(pair).map(|(words, rack)| (words, rack, PinionFlanks::nominal(pair)))?,
            Part::Pinion => self.pinion(pair).map(|(words, pinion)| (words, RackFlanks::nominal(pair), pinion))?,
        };
        let mesh = Mesh::new(*pair, rack, pinion, Support::Fixed).ok()?;
        let turn = f64::from(pair.pinion().teeth + 6) * pair.rack().pitch_mm;
        let curve = mesh.curve(0.0, turn.max(50.0), TOLERANCE_MM).ok()?;
        if !curve.points.iter().all(MeshPoint::is_solved) {
            return None;
        }
        let summary = curve.summary(&mesh)?;
        let largest = summary.max_mm.abs().max(summary.min_mm.abs()).max(summary.max_mm - summary.min_mm);
        Some((largest, words))
    }

    fn sector(&self, pair: &Pair) -> i64 {
        self.pitches.clamp(1, i64::from(pair.pinion().teeth).max(1))
    }

    fn rack(&self, pair: &Pair) -> Option<(&'static str, RackFlanks)> {
        let later = ToothRange::starting_at(FIRST_ODD_TOOTH);
        let pitches = self.sector(pair);
        let (words, teeth, kind) = match self.deviation {
            Deviation::SinglePitch => ("one pitch step, at tooth 4", later, RackDeviationKind::Shift(self.amount_mm)),
            Deviation::SectorPitch => {
                let range = ToothRange::new(Some(FIRST_ODD_TOOTH), Some(FIRST_ODD_TOOTH + pitches - 1)).ok()?;
                let each = RackDeviationKind::Pitch(self.amount_mm / pitches as f64);
                ("spread evenly over its k pitches", range, each)
            }
            Deviation::HelixSlope => {
                let lead = RackDeviationKind::Lead(trig::atan(self.amount_mm / self.face_width_mm));
                ("on the teeth from 4 on", later, lead)
            }
            Deviation::Runout => {
                ("over-roller of the teeth from 4 on", later, RackDeviationKind::OverRoller(self.amount_mm))
            }
            _ => return None,
        };
        Some((words, RackFlanks::new(pair, &[RackDeviation { teeth, kind }]).ok()?))
    }

    fn pinion(&self, pair: &Pair) -> Option<(&'static str, PinionFlanks)> {
        let nominal = PinionFlanks::nominal(pair);
        let (teeth, pitches) = (i64::from(pair.pinion().teeth), self.sector(pair));
        let shares = |share: &dyn Fn(i64) -> f64| shifted(pair, &|tooth| self.amount_mm * share(tooth));
        let (words, flanks) = match self.deviation {
            Deviation::SinglePitch => {
                ("one pitch step, half way round", shares(&|tooth| if tooth >= teeth / 2 { 1.0 } else { 0.0 }))
            }
            Deviation::SectorPitch => {
                // a turn closes: the other pitches take back evenly what k pitches add up
                let others = (teeth - pitches).max(1) as f64;
                let share = |tooth: i64| (tooth as f64 / pitches as f64).min((teeth - tooth) as f64 / others);
                ("spread evenly over its k pitches, and back over the others", shares(&share))
            }
            Deviation::TotalPitch => (
                "rising over half a turn and falling over the other",
                shares(&|tooth| tooth.min(teeth - tooth) as f64 / (teeth as f64 / 2.0)),
            ),
            Deviation::ProfileSlope => {
                let form = PinionForm { profile_slope_mm: -self.amount_mm, ..PinionForm::default() };
                ("added at the tips of all flanks", nominal.with_form(form))
            }
            Deviation::HelixSlope => {
                // the same slope over the pinion's own width
                let over_face_mm = self.amount_mm * pair.pinion().face_width_mm / self.face_width_mm;
                let kind = PinionDeviationKind::Lead(pinion_lead_angle_rad(pair, over_face_mm));
                ("on all teeth", PinionFlanks::new(pair, &[PinionDeviation { teeth: ToothRange::ALL, kind }]))
            }
            Deviation::Runout => {
                let eccentricity = PinionDeviation::eccentricity(self.amount_mm / 2.0, 0);
                ("an eccentricity of half of it", PinionFlanks::new(pair, &[eccentricity]))
            }
            _ => return None,
        };
        Some((words, flanks.ok()?))
    }
}

/// A pinion whose teeth are displaced, so that a turn closes by itself.
fn shifted(pair: &Pair, shift_mm: &dyn Fn(i64) -> f64) -> Result<PinionFlanks, DeviationError> {
    let each: Vec<_> = (0..i64::from(pair.pinion().teeth))
        .filter_map(|tooth| {
            let kind = PinionDeviationKind::Shift(shift_mm(tooth));
            Some(PinionDeviation { teeth: ToothRange::single(tooth).ok()?, kind })
        })
        .collect();
    PinionFlanks::new(pair, &each)
}

#[cfg(test)]
mod tests {
    use super::super::prediction::tests::pair;
    use super::*;
    use crate::gear::example;

    const AMOUNT_MM: f64 = 0.02;

    fn solved(teeth: u32, part: Part, deviation: Deviation, pitches: i64) -> Option<f64> {
        of_pair(&pair(teeth, 0.0, 0.0), part, deviation, pitches)
    }

    fn of_pair(pair: &Pair, part: Part, deviation: Deviation, pitches: i64) -> Option<f64> {
        let arranged = ArrangedDeviation { part, deviation, amount_mm: AMOUNT_MM, face_width_mm: 20.0, pitches };
        Some(arranged.largest_delta_cd_mm(pair)?.0)
    }

    fn near(value: Option<f64>, expected: f64) {
        assert!(value.is_some_and(|value| (value - expected).abs() < 1e-4), "{value:?} {expected}");
    }

    /// Deviations that can be put on teeth are solved, the others are not.
    #[test]
    fn each_arrangement_is_solved() {
        let both = [Deviation::SinglePitch, Deviation::SectorPitch, Deviation::HelixSlope, Deviation::Runout];
        let of_pinion = [Deviation::TotalPitch, Deviation::ProfileSlope];
        for part in [Part::Rack, Part::Pinion] {
            for deviation in Deviation::ALL {
                let is_put = both.contains(&deviation) || part == Part::Pinion && of_pinion.contains(&deviation);
                assert_eq!(solved(12, part, deviation, 2).is_some(), is_put, "{deviation:?} {part:?}");
            }
        }
    }

    /// If k pitches add up to 20 µm, each has a k-th part, and with tan α_n = 1/2 that is its ΔCD. What the pinion's other pitches
    /// take back hardly matters.
    #[test]
    fn a_sector_is_as_bad_as_one_of_its_pitches() {
        for part in [Part::Rack, Part::Pinion] {
            for pitches in [1, 3] {
                near(solved(20, part, Deviation::SectorPitch, pitches), AMOUNT_MM / pitches as f64);
            }
        }
        // half a turn up, and half a turn down
        near(solved(20, Part::Pinion, Deviation::SectorPitch, 10), AMOUNT_MM / 10.0);
        near(solved(20, Part::Pinion, Deviation::TotalPitch, 1), AMOUNT_MM / 10.0);
        // an odd number of teeth closes as well
        near(solved(20, Part::Pinion, Deviation::SinglePitch, 1), AMOUNT_MM);
        near(solved(21, Part::Pinion, Deviation::SinglePitch, 1), AMOUNT_MM);
    }

    /// A helix slope over the whole face lifts by its own value on the rack, and by 1/(2 sin α_n), √5/2 times as much, on the
    /// pinion. With a profile slope the flank at the pinion's tip asks for that, and the flank on the other side for a part of it.
    #[test]
    fn slopes_of_flanks() {
        near(solved(12, Part::Rack, Deviation::HelixSlope, 1), AMOUNT_MM);
        near(solved(12, Part::Pinion, Deviation::HelixSlope, 1), AMOUNT_MM * f64::sqrt(5.0) / 2.0);
        let found = solved(12, Part::Pinion, Deviation::ProfileSlope, 1);
        assert!(found.is_some_and(|found| found > 0.03 && found < AMOUNT_MM * f64::sqrt(5.0)), "{found:?}");
    }

    /// A large pinion needs more than 50 mm for its turn.
    #[test]
    fn the_stroke_is_a_whole_turn() {
        near(solved(30, Part::Pinion, Deviation::Runout, 1), AMOUNT_MM);
    }

    /// A sector of one pitch is a single pitch deviation, also where three teeth carry at a time, on faces so wide that the left
    /// flank of the first and the right flank of the last carry.
    #[test]
    fn a_sector_ends_where_it_ends() {
        let mut data = example(20, -0.35, 0.35);
        (data.rack.face_width_mm, data.pinion.face_width_mm) = (50.0, 50.0);
        let pair = Pair::new(&data).unwrap();
        assert!(pair.contact_ratio().overlap > 2.0);
        let of = |deviation| of_pair(&pair, Part::Rack, deviation, 1);
        near(of(Deviation::SectorPitch), of(Deviation::SinglePitch).unwrap());
    }

    /// The rack's first tooth that is off lies 100 mm from the start.
    #[test]
    fn the_stroke_of_a_small_pinion_of_large_module_reaches_what_is_off() {
        let mut data = example(8, 0.0, 0.0);
        data.normal_module_mm = 8.0;
        data.rack.addendum_mm = 8.0;
        data.pinion.profile_shift = 0.6;
        data.pinion.tip_diameter_mm = 85.0;
        data.pinion.root_form_diameter_mm = None;
        let pair = Pair::new(&data).unwrap();
        let found = of_pair(&pair, Part::Rack, Deviation::Runout, 1);
        near(found, AMOUNT_MM);
    }
}
