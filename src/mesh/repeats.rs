//! Where a curve repeats: strokes that are whole pitches apart and see the same teeth have the same solution. [`curve`](super::curve)
//! solves one of them and moves what it found; nothing else knows of it.

use super::{Carrier, FlankSide, Kink, Mesh, MeshPoint, Sampler};
use crate::deviation::PinionTooth;

/// Teeth on either side that count besides those in reach: the pinion turns by 3/4 of a pitch at most, and the tooth that it
/// faces may be the next one.
const BESIDE: f64 = 4.0;
/// Teeth that are displaced by more than this share of a pitch may have their neighbours' places.
const DISPLACED: f64 = 0.25;
/// Tooth numbers up to this one are exact.
const LARGEST_TOOTH: f64 = 1e15;

impl Mesh {
    /// For each pitch of stroke from `from_mm` on the first one that sees the same teeth; of others itself.
    pub(super) fn repeats(&self, from_mm: f64, pitches: usize) -> Vec<usize> {
        let constants = Sampler::new(self).constants;
        let first = (from_mm / constants.pitch).floor();
        let reach = constants.window.0.abs().max(constants.window.1.abs()) / constants.angular_pitch + BESIDE;
        if first.abs() + reach + pitches as f64 > LARGEST_TOOTH {
            return (0..pitches).collect();
        }
        let (first, reach) = (first as i64, reach.ceil() as usize);
        // up to the tooth behind the one behind the last in reach
        let window = 2 * reach + 2;
        let teeth: Vec<_> =
            (0..pitches + window).map(|tooth| self.rack().tooth(first + tooth as i64 - reach as i64)).collect();
        let displaced = |index: usize| {
            let (left, right) = (teeth[index].left.along_x_mm, teeth[index].right.along_x_mm);
            left.abs().max(right.abs()) > DISPLACED * constants.pitch
        };
        let turn = self.pinion_period();
        let sees = |pitch: usize| &teeth[pitch..pitch + window];
        let mut kinds: Vec<usize> = Vec::new();
        let mut alike = |pitch: usize| {
            let is_alike = |kind: &usize| (pitch - kind).is_multiple_of(turn) && sees(*kind) == sees(pitch);
            if let Some(&kind) = kinds.iter().find(|kind| is_alike(kind)) {
                return kind;
            }
            if !(pitch..pitch + window).any(displaced) {
                kinds.push(pitch);
            }
            pitch
        };
        (0..pitches).map(&mut alike).collect()
    }

    /// After how many teeth the pinion is the same again.
    fn pinion_period(&self) -> usize {
        let teeth = self.pinion().teeth();
        let is_one = teeth.windows(2).all(|two: &[PinionTooth]| two[0] == two[1]) && self.eccentricity() == 0.0;
        if is_one { 1 } else { teeth.len() }
    }

    /// A solved point, so many whole pitches further on.
    pub(super) fn moved(&self, point: &MeshPoint, pitches: i64) -> MeshPoint {
        let (right, left) = self.moved_carriers((point.right, point.left), pitches);
        MeshPoint {
            stroke_mm: point.stroke_mm + pitches as f64 * self.pair().rack().pitch_mm,
            pinion_angle_rad: point.pinion_angle_rad + pitches as f64 * self.pair().pinion().angular_pitch_rad(),
            right,
            left,
            ..*point
        }
    }

    /// A kink, so many whole pitches further on.
    pub(super) fn moved_kink(&self, kink: &Kink, pitches: i64) -> Kink {
        Kink {
            stroke_mm: kink.stroke_mm + pitches as f64 * self.pair().rack().pitch_mm,
            before: self.moved_carriers(kink.before, pitches),
            after: self.moved_carriers(kink.after, pitches),
            ..*kink
        }
    }

    fn moved_carriers(&self, (right, left): (Carrier, Carrier), pitches: i64) -> (Carrier, Carrier) {
        let moved = |side: FlankSide, at: Carrier| {
            let rack_tooth = at.rack_tooth + pitches;
            let pinion_tooth = side.pinion_tooth(rack_tooth, self.pair().pinion().teeth);
            Carrier { rack_tooth, pinion_tooth, ..at }
        };
        (moved(FlankSide::Right, right), moved(FlankSide::Left, left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{
        PinionDeviation, PinionDeviationKind, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange,
    };
    use crate::gear::{Pair, example};
    use crate::mesh::{Support, TOLERANCE_MM};

    fn mesh(on_rack: &[(&str, RackDeviationKind)], on_pinion: &[PinionDeviation], support: Support) -> Mesh {
        let pair = Pair::new(&example(12, 0.1, 0.2)).expect("a valid pair");
        let deviation = |&(teeth, kind): &(&str, _)| RackDeviation { teeth: teeth.parse().expect("teeth"), kind };
        let rack = RackFlanks::new(&pair, &on_rack.iter().map(deviation).collect::<Vec<_>>()).expect("small");
        let pinion = PinionFlanks::new(&pair, on_pinion).expect("small");
        Mesh::new(pair, rack, pinion, support).expect("teeth in order")
    }

    fn tooth_of_pinion() -> [PinionDeviation; 1] {
        [PinionDeviation { teeth: ToothRange::single(3).expect("a tooth"), kind: PinionDeviationKind::Right(0.01) }]
    }

    /// What the first 40 pitches repeat.
    fn repeated(on_rack: &[(&str, RackDeviationKind)], on_pinion: &[PinionDeviation]) -> Vec<usize> {
        mesh(on_rack, on_pinion, Support::Fixed).repeats(0.3, 40)
    }

    #[test]
    fn pitches_repeat_where_the_teeth_in_reach_do() {
        assert_eq!(repeated(&[], &[]), vec![0; 40]);
        assert_eq!(repeated(&[("all", RackDeviationKind::Lead(0.002))], &[]), vec![0; 40]);
        // a tooth alone differs for all pitches that it is in reach of, and no others
        let one = repeated(&[("20", RackDeviationKind::Left(0.01))], &[]);
        let own: Vec<usize> = (1..40).filter(|&pitch| one[pitch] == pitch).collect();
        assert!(own.contains(&18) && own.contains(&21) && own.len() < 30, "{own:?}");
        assert!((0..40).all(|pitch| one[pitch] == if own.contains(&pitch) { pitch } else { 0 }), "{one:?}");
        // from a tooth on: two kinds, and those that see both
        let rest = repeated(&[("20..", RackDeviationKind::Shift(0.01))], &[]);
        assert!(rest[0] == 0 && rest[5] == 0 && rest[39] == rest[38] && rest[39] > 20, "{rest:?}");
        // steps of pitch add up, so that no two places are alike
        let steps: Vec<usize> = (0..40).collect();
        assert_eq!(repeated(&[("all", RackDeviationKind::Pitch(0.001))], &[]), steps);
        // a turn of the pinion
        let turned: Vec<usize> = (0..40).map(|pitch| pitch % 12).collect();
        assert_eq!(repeated(&[], &tooth_of_pinion()), turned);
        assert_eq!(repeated(&[], &[PinionDeviation::eccentricity(0.02, 3)]), turned);
        // where teeth are far from their places, none
        assert_eq!(repeated(&[("all", RackDeviationKind::Shift(9.0))], &[]), steps);
        assert_eq!(mesh(&[], &[], Support::Fixed).repeats(1e300, 3), [0, 1, 2]);
    }

    /// What is moved is what a solve of that stroke gives, and the names of the teeth are those that are there.
    #[test]
    fn curves_that_repeat_are_those_of_every_stroke() {
        let one = [("11", RackDeviationKind::Left(0.01)), ("4..", RackDeviationKind::Lead(0.001))];
        for (on_pinion, support, pitches) in [
            (&[][..], Support::Fixed, 25.3),
            (&tooth_of_pinion()[..], Support::Fixed, 45.5),
            (&[][..], Support::FreeRoll { axis_depth_mm: 6.0 }, 21.0),
        ] {
            let mesh = mesh(&one, on_pinion, support);
            let to = 0.3 + pitches * mesh.pair().rack().pitch_mm;
            let curve = mesh.curve(0.3, to, 100.0 * TOLERANCE_MM).expect("a mesh");
            let (first, last) = (curve.points[0].stroke_mm, curve.points[curve.points.len() - 1].stroke_mm);
            assert_eq!((first, last), (0.3, to));
            assert!(curve.points.windows(2).all(|two| two[0].stroke_mm < two[1].stroke_mm));
            for point in curve.points.iter().step_by(7) {
                let solved = mesh.at(point.stroke_mm).expect("a mesh");
                let off = [
                    solved.delta_cd_mm - point.delta_cd_mm,
                    solved.pinion_angle_rad - point.pinion_angle_rad,
                    solved.transmission_error_rad - point.transmission_error_rad,
                ];
                // the lowest ΔCD determines the roll, and with it the rotation, to the root of rounding only
                let angle = if support == Support::Fixed { 1e-11 } else { 1e-8 };
                let is_same = off[0].abs() < 1e-11 && off[1..].iter().all(|off| off.abs() < angle);
                assert!(is_same, "{off:?} {point:?} {solved:?}");
                // at kinks, and where lines of several teeth carry, others are as good
                let at = point.right;
                assert_eq!(at.pinion_tooth, FlankSide::Right.pinion_tooth(at.rack_tooth, 12));
                assert!((at.rack_tooth - solved.right.rack_tooth).abs() <= 2, "{point:?} {solved:?}");
            }
        }
    }
}
