//! The solve at one stroke: which rotation makes both sides ask for the same centre distance. Used through
//! [`Mesh::at`], [`Mesh::sample`] and [`Sampler`]; allocates nothing per stroke once a sampler is warm.

use super::contact::{ContactKind, PoseRates, Surface};
use super::demand::{Demand, NEARBY, Slot};
use super::prepare::Roll;
use super::roll::Valleys;
use super::trail::Trail;
use super::{Carrier, Ending, FlankSide, Mesh, MeshError, MeshPoint, Support, Work};
use crate::trig;

/// Solves one stroke after the other, each starting from the last one's solution.
#[derive(Debug, Clone)]
pub struct Sampler<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) constants: Constants,
    pub(super) cache: [Vec<Option<Slot>>; 2],
    pub(super) roll: Roll,
    /// Centre distance assumed where a rolled rack's end faces need one.
    pub(super) assumed: f64,
    /// Rotation offset and rack displacement of the last solution.
    last: Option<(f64, f64)>,
    trail: Option<Trail>,
    /// Rack teeth that carried last, right and left.
    pub(super) carried: [i64; 2],
    /// The pairs in reach at this stroke that may carry at a rotation near the first one tried.
    pub(super) near: [Vec<i64>; 2],
    /// For a rack that rolls: how the last solution changes with the roll, and what is known of its rolls.
    pub(super) rolling: Rolling,
    pub(super) valleys: Valleys,
    pub(super) work: Work,
}

/// How a solution changes with the rack's roll.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rolling {
    /// Derivatives of the centre distance by the roll, and by the one assumed.
    pub(super) rate: [f64; 2],
    /// Names the contacts of both sides, the ends of the face they are at and the surfaces they are on.
    pub(super) at: Option<[(i64, ContactKind, bool, Surface); 2]>,
}

impl Rolling {
    /// 1 less the share of a change of the assumed centre distance that the end faces feed back: that is small, and a
    /// share of [`MOST_FED_BACK`] and more is not believed.
    pub(super) fn remaining(&self) -> f64 {
        let fed_back = self.rate[1];
        if fed_back < MOST_FED_BACK { 1.0 - fed_back } else { 1.0 }
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Constants {
    pub(super) pitch: f64,
    pub(super) angular_pitch: f64,
    pub(super) angle_per_mm: f64,
    pub(super) nominal: f64,
    /// Range of the pinion tooth's angle within which its flank can touch, for a right rack flank.
    pub(super) window: (f64, f64),
    pub(super) eccentricity: (f64, f64),
    pub(super) stroke_limit: f64,
    pub(super) default_rate: f64,
    pub(super) tolerance: f64,
    /// No demand changes faster than this with the rack's roll, mm/rad.
    pub(super) roll_reach: f64,
}

/// A position of the pinion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Position {
    /// The rack tooth nearest to the pinion, and its nominal place.
    pub(super) tooth: i64,
    pub(super) place: f64,
    /// Angle of the pinion tooth of the same number at offset 0.
    pub(super) angle: f64,
    /// Angle of pinion tooth 0 less that.
    pub(super) to_first: f64,
}

/// Rotations tried at most; Newton needs two or three, a bisection of the whole range 60.
const MAX_ITERATIONS: u32 = 120;

/// Rotations after which the bracket is only halved: what is left of [`MAX_ITERATIONS`] takes it down to rounding.
const PATIENCE: u32 = 50;

/// Rotations after which the end of the bracket is tried that Newton's steps lead to: mostly three find the solution.
const UNTIL_END: u32 = 8;

/// Newton's step and the secant's are taken where what both sides ask for approaches by at least this share of
/// r_b / sin α_t per rad.
const LEAST_SLOPE: f64 = 1e-3;

/// See [`Rolling::remaining`].
const MOST_FED_BACK: f64 = 0.5;

/// Both sides agree if their demands differ by less than this share of r_a; rounding leaves 1e-15 of it.
const AGREEMENT: f64 = 1e-14;

impl Mesh {
    /// Solves one stroke.
    ///
    /// # Errors
    /// [`MeshError`] says why there is no mesh here.
    pub fn at(&self, stroke_mm: f64) -> Result<MeshPoint, MeshError> {
        Sampler::new(self).at(stroke_mm)
    }
}

impl<'a> Sampler<'a> {
    /// A sampler that has seen no stroke yet.
    #[must_use]
    pub fn new(mesh: &'a Mesh) -> Self {
        let constants = Constants::new(mesh);
        let teeth = (constants.window.1 - constants.window.0) / constants.angular_pitch + 4.0;
        let slots = (teeth.clamp(4.0, 4096.0) as usize).next_power_of_two();
        Self {
            mesh,
            constants,
            cache: [vec![None; slots], vec![None; slots]],
            roll: Roll::NONE,
            assumed: mesh.pair().nominal_center_distance_mm(),
            last: None,
            trail: None,
            carried: [0; 2],
            near: [Vec::with_capacity(slots), Vec::with_capacity(slots)],
            rolling: Rolling::default(),
            valleys: Valleys::default(),
            work: Work::default(),
        }
    }

    /// Solves one stroke. Near the last one it is faster; the result differs from a fresh start by rounding only.
    ///
    /// # Errors
    /// [`MeshError`] says why there is no mesh here.
    pub fn at(&mut self, stroke_mm: f64) -> Result<MeshPoint, MeshError> {
        self.work.strokes += 1;
        match self.mesh.support() {
            Support::Fixed => self.solve(stroke_mm),
            Support::FreeRoll { axis_depth_mm } => self.solve_rolling(stroke_mm, axis_depth_mm),
        }
    }

    /// What was done so far.
    #[must_use]
    pub const fn work(&self) -> Work {
        self.work
    }

    /// Rolls the rack: flank pairs are prepared anew when they are next asked.
    pub(super) fn set_roll(&mut self, roll: Roll) {
        self.roll = roll;
    }

    /// The zero-backlash position at the present roll.
    pub(super) fn solve(&mut self, stroke_mm: f64) -> Result<MeshPoint, MeshError> {
        let position = self.locate(stroke_mm)?;
        let Constants { tolerance, angle_per_mm, angular_pitch, default_rate, nominal, .. } = self.constants;
        let displacement = self.slot(FlankSide::Right, position.tooth).prepared.center;
        let guess = displacement * angle_per_mm;
        let mut offset = match self.last {
            Some((offset, at)) if (offset - at * angle_per_mm).abs() < 0.5 * angular_pitch => {
                offset + (displacement - at) * angle_per_mm
            }
            _ => guess,
        };
        let (mut low, mut high) = (guess - 0.75 * angular_pitch, guess + 0.75 * angular_pitch);
        if let Some(expected) = self.trail.and_then(|trail| trail.offset_at(stroke_mm))
            && expected > low
            && expected < high
        {
            offset = expected;
        }
        let mut iterations = 0;
        let mut before: Option<(f64, f64)> = None;
        let range = (low, high);
        let mut first = offset;
        let (right, left, step, ending) = loop {
            iterations += 1;
            self.work.rotations += 1;
            let again = iterations > 1 && (offset - first).abs() <= NEARBY;
            let right = self.demand(FlankSide::Right, &position, (offset, again), stroke_mm)?;
            let left = self.demand(FlankSide::Left, &position, (offset, again), stroke_mm)?;
            let excess = right.value - left.value;
            let mut slope = right.rate - left.rate;
            if !slope.is_finite() || slope >= -LEAST_SLOPE * default_rate {
                slope = -2.0 * default_rate;
            }
            // where edges meet the derivative may belong to one of them only: the secant knows better
            if let Some((at, value)) = before {
                let secant: f64 = (excess - value) / (offset - at);
                if iterations > 3 && secant < -LEAST_SLOPE * default_rate && secant.is_finite() {
                    slope = secant;
                }
            }
            before = Some((offset, excess));
            let step = -excess / slope;
            if excess.abs() <= tolerance {
                break (right, left, step, Ending::Converged);
            }
            if excess > 0.0 {
                low = offset;
            } else {
                high = offset;
            }
            if iterations >= MAX_ITERATIONS {
                break (right, left, 0.0, Ending::IterationLimit);
            }
            let (end, untried) = if excess > 0.0 { (high, high == range.1) } else { (low, low == range.0) };
            if iterations == UNTIL_END && untried {
                first = end;
                if let Some([right, left]) = self.glance(&position, end, stroke_mm)
                    && (right.value > left.value) == (excess > 0.0)
                {
                    offset = end;
                    iterations += 1;
                    break (right, left, 0.0, Ending::Unbalanced);
                }
            }
            let mut next = offset + step;
            // Newton's step, unless it leaves the bracket or has been given its chance
            if next <= low || next >= high || iterations % 8 == 0 || iterations > PATIENCE {
                next = 0.5 * (low + high);
            }
            if next == offset || high - low <= f64::EPSILON * offset.abs().max(1e-4 * angular_pitch) {
                break (right, left, 0.0, Ending::BracketExhausted);
            }
            offset = next;
        };
        if right.touch.is_on_tip() && left.touch.is_on_tip() {
            return Err(MeshError::TipOnTip { stroke_mm, right: right.tooth, left: left.tooth });
        }
        // where both tangents cross; without a step the larger demand, which certainly suffices
        let a = if step == 0.0 { right.value.max(left.value) } else { right.value + right.rate * step };
        self.last = Some((offset, displacement));
        let carriers = (self.carrier(FlankSide::Right, &right), self.carrier(FlankSide::Left, &left));
        if self.mesh.support() == Support::Fixed {
            self.trail = Some(Trail::extended(self.trail, stroke_mm, offset + step, carriers.0, carriers.1));
        } else {
            self.rolling = self.rolling(&right, &left);
        }
        let error = -(offset + step);
        Ok(MeshPoint {
            stroke_mm,
            center_distance_mm: a,
            delta_cd_mm: a - nominal,
            pinion_angle_rad: stroke_mm * angle_per_mm + error,
            transmission_error_rad: error,
            roll_rad: self.roll.angle,
            right: carriers.0,
            left: carriers.1,
            residual_mm: right.value - left.value,
            iterations,
            ending,
        })
    }

    /// What both sides ask for at a rotation that is not on the way to the solution.
    fn glance(&mut self, position: &Position, offset: f64, stroke_mm: f64) -> Option<[Demand; 2]> {
        self.work.rotations += 1;
        let carried = self.carried;
        let [right, left] = [FlankSide::Right, FlankSide::Left]
            .map(|side| self.demand(side, position, (offset, false), stroke_mm).ok());
        self.carried = carried;
        Some([right?, left?])
    }

    /// At the balance of both sides their shares in the centre distance are those that cancel the rotation.
    fn rolling(&mut self, right: &Demand, left: &Demand) -> Rolling {
        let Roll { sin, cos, depth, .. } = self.roll;
        let across = [cos * (depth + self.assumed), sin];
        let mut rate = |side, demand: &Demand| {
            let prepared = &self.slot(side, demand.tooth).prepared;
            let moved = PoseRates { shift: prepared.rates.per_shift * demand.place, across };
            prepared.contact.roll_rate(&demand.pose, &demand.touch, (&prepared.rates, &moved))
        };
        let (r, l) = (rate(FlankSide::Right, right), rate(FlankSide::Left, left));
        let share = left.rate / (left.rate - right.rate);
        let share = if share.is_finite() { share } else { 0.5 };
        let at = |demand: &Demand| {
            let spot = &demand.touch.spot;
            (demand.tooth, demand.touch.kind, spot.w.is_sign_positive(), spot.surface)
        };
        Rolling { rate: [0, 1].map(|i| share * r[i] + (1.0 - share) * l[i]), at: Some([at(right), at(left)]) }
    }

    fn carrier(&self, side: FlankSide, demand: &Demand) -> Carrier {
        let teeth = i64::from(self.mesh.pair().pinion().teeth);
        let partner = if side == FlankSide::Right { demand.tooth } else { demand.tooth - 1 };
        Carrier {
            rack_tooth: demand.tooth,
            pinion_tooth: u32::try_from(partner.rem_euclid(teeth)).unwrap_or(0),
            contact: demand.touch.kind,
        }
    }

    /// The rack tooth nearest to the pinion's axis, wherever its deviations have put it.
    fn locate(&mut self, stroke_mm: f64) -> Result<Position, MeshError> {
        let Constants { pitch, angular_pitch, angle_per_mm, stroke_limit, .. } = self.constants;
        if stroke_mm.abs() > stroke_limit || stroke_mm.is_nan() {
            return Err(MeshError::StrokeOutOfDomain { stroke_mm, limit_mm: stroke_limit });
        }
        let mut tooth = (stroke_mm / pitch).round() as i64;
        let mut place = reduced(tooth, pitch, stroke_mm);
        let mut away = place + self.slot(FlankSide::Right, tooth).prepared.center;
        for _ in 0..64 {
            let steps = (away / pitch).round().clamp(-1e15, 1e15) as i64;
            if steps == 0 {
                break;
            }
            // next to a gap so many steps lead too far: then one
            let nearer = [steps, steps.signum()].into_iter().find_map(|steps| {
                let tooth = (tooth - steps).clamp(-(1 << 52), 1 << 52);
                let place = reduced(tooth, pitch, stroke_mm);
                let there = place + self.slot(FlankSide::Right, tooth).prepared.center;
                (there.abs() < away.abs()).then_some((tooth, place, there))
            });
            let Some(next) = nearer else { break };
            (tooth, place, away) = next;
        }
        if away.abs() > pitch {
            return Err(MeshError::RackToothOrder { stroke_mm, tooth });
        }
        let teeth = i64::from(self.mesh.pair().pinion().teeth);
        let to_first = -(tooth.rem_euclid(teeth) as f64) * angular_pitch;
        Ok(Position { tooth, place, angle: 0.5 * angular_pitch + place * angle_per_mm, to_first })
    }
}

impl Constants {
    fn new(mesh: &Mesh) -> Self {
        let (rack, pinion) = (mesh.pair().rack(), mesh.pair().pinion());
        let angular_pitch = pinion.angular_pitch_rad();
        let alpha = pinion.transverse_pressure_angle_rad;
        let sin = trig::sin(alpha);
        let scale = pinion.base_radius_mm / sin;
        // beyond the involute's end by η a flank stays clear by (r_b/sin ν) τ η²/2; leave half a module of that
        let margin = (mesh.pair().normal_module_mm() / (scale * pinion.tip_roll_rad)).sqrt().min(1.0);
        let kappa = trig::tan(pinion.helix_angle_rad).abs() / pinion.reference_radius_mm;
        let contact = mesh.prepare(FlankSide::Right, 0, &Roll::NONE).contact;
        let reach = 1.1 * kappa * contact.w_extent + margin;
        let low = alpha - (pinion.tip_roll_rad + reach) + pinion.base_half_angle_rad;
        let high = alpha - (pinion.start_roll_rad - reach - margin) + pinion.base_half_angle_rad;
        Self {
            pitch: rack.pitch_mm,
            angular_pitch,
            angle_per_mm: angular_pitch / rack.pitch_mm,
            nominal: mesh.pair().nominal_center_distance_mm(),
            window: (low, high),
            eccentricity: mesh.pinion().eccentricity_mm(),
            // tooth numbers below 2⁵⁰
            stroke_limit: rack.pitch_mm * 1_125_899_906_842_624.0,
            default_rate: scale,
            roll_reach: 4.0
                * (rack.face_width_mm
                    + rack.addendum_mm
                    + pinion.tip_radius_mm
                    + match mesh.support() {
                        Support::Fixed => 0.0,
                        Support::FreeRoll { axis_depth_mm } => axis_depth_mm.abs(),
                    }),
            tolerance: AGREEMENT * (pinion.tip_radius_mm + mesh.eccentricity()),
        }
    }
}

/// `tooth · pitch − stroke` with one rounding of the result: the product is split exactly in two.
fn reduced(tooth: i64, pitch: f64, stroke: f64) -> f64 {
    let count = tooth as f64;
    let split = |x: f64| {
        let c = 134_217_729.0 * x; // 2²⁷ + 1
        let high = c - (c - x);
        (high, x - high)
    };
    let product = count * pitch;
    let ((a, b), (c, d)) = (split(count), split(pitch));
    let error = ((a * c - product) + a * d + b * c) + b * d;
    (product - stroke) + error
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{Eccentricity, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange};
    use crate::gear::{Pair, PairData, PinionData, RackData};

    fn pair() -> Pair {
        Pair::new(&PairData {
            normal_module_mm: 2.0,
            normal_pressure_angle_rad: 0.35,
            rack: RackData { helix_angle_rad: 0.1, face_width_mm: 20.0, addendum_mm: 1.9, tooth_thickness_mm: None },
            pinion: PinionData {
                teeth: 20,
                helix_angle_rad: 0.2,
                profile_shift: 0.2,
                tip_diameter_mm: 45.6,
                root_form_diameter_mm: Some(39.0),
                face_width_mm: 24.0,
                tooth_thickness_deviation_mm: 0.0,
            },
        })
        .expect("a valid pair")
    }

    fn mesh(list: &[RackDeviation]) -> Mesh {
        let pair = pair();
        let pinion = PinionFlanks::nominal(&pair).with_eccentricity(&[Eccentricity { amount_mm: 0.05, tooth: 3 }]);
        let rack = RackFlanks::new(&pair, list).expect("small");
        Mesh::new(pair, rack, pinion.expect("small"), Support::Fixed).expect("teeth in order")
    }

    fn all(kind: RackDeviationKind) -> RackDeviation {
        RackDeviation { teeth: ToothRange::ALL, kind }
    }

    /// Place and stroke are multiples of 2⁻⁴⁰, so that integers give the difference exactly.
    #[test]
    fn a_far_tooth_is_placed_with_one_rounding() {
        let unit = f64::from_bits(0x3d70_0000_0000_0000);
        let pitch = 6_908_617_345_679_i64;
        for tooth in [0, 1, -3, 1_000_003, -77_777_777_777, (1 << 50) - 1, -(1 << 50) + 12_345] {
            let product = i128::from(tooth) * i128::from(pitch);
            for apart in [0, 1, -7, 123_456_789_012, -987_654_321_098_765] {
                let stroke = ((product + apart) as f64) as i128;
                let expected = (product - stroke) as f64 * unit;
                let found = reduced(tooth, pitch as f64 * unit, stroke as f64 * unit);
                assert_eq!(found, expected, "{tooth} {apart}");
            }
        }
    }

    /// Wherever the search for the rotation starts, within the bracket or beyond, it ends at the same place soon.
    #[test]
    fn any_start_leads_to_the_same_rotation() {
        let (mut rotations, mut solved, mut most) = (0, 0, 0);
        for lead in [0.0, 0.004] {
            let mesh = mesh(&[all(RackDeviationKind::Lead(lead))]);
            let pitch = mesh.pair().pinion().angular_pitch_rad();
            for step in 0..8 {
                let stroke = 0.83 * f64::from(step);
                let fresh = mesh.at(stroke).expect("contact");
                for start in -24..=24 {
                    let start = 0.032 * f64::from(start) * pitch;
                    let mut sampler = Sampler::new(&mesh);
                    sampler.last = Some((start, 0.0));
                    let point = sampler.at(stroke).expect("contact");
                    assert!(point.converged(), "{start} {point:?}");
                    assert!((point.center_distance_mm - fresh.center_distance_mm).abs() < 1e-12, "{start} {point:?}");
                    assert!((point.transmission_error_rad - fresh.transmission_error_rad).abs() < 1e-13, "{start}");
                    rotations += point.iterations;
                    most = most.max(point.iterations);
                    solved += 1;
                }
            }
        }
        println!("{rotations} rotations for {solved} strokes, at most {most}");
        assert!(rotations <= 3280 && most <= 8, "{rotations} {most}");
    }

    /// Racks that are shifted by whole teeth and more are found under the pinion.
    #[test]
    fn a_displaced_rack_is_found_where_it_is() {
        let nominal = mesh(&[]);
        let p = nominal.pair().rack().pitch_mm;
        for shift in [-7.3, -2.0, -0.6, 0.4, 1.0, 3.49, 60.2] {
            let shifted = mesh(&[all(RackDeviationKind::Shift(shift * p))]);
            for step in -8..8 {
                let stroke = 0.91 * f64::from(step);
                let here = shifted.at(stroke + shift * p).expect("contact");
                // the pinion has turned by its part of the shift more
                let turned = stroke + shift * p;
                assert!(here.converged() && here.delta_cd_mm.abs() < 0.06, "{shift} {here:?}");
                let tooth = here.right.rack_tooth;
                assert!((f64::from(i32::try_from(tooth).expect("near")) * p + shift * p - turned).abs() < 3.0 * p);
            }
        }
    }

    #[test]
    fn strokes_at_the_limit_have_a_place_and_beyond_it_none() {
        let mesh = mesh(&[]);
        let limit = Constants::new(&mesh).stroke_limit;
        assert!(mesh.at(limit).is_ok() && mesh.at(-limit).is_ok());
        for stroke in [limit.next_up(), -limit.next_up(), f64::NAN, f64::INFINITY] {
            let error = mesh.at(stroke).expect_err("too far");
            assert!(matches!(error, MeshError::StrokeOutOfDomain { .. }), "{error}");
        }
    }

    /// Teeth too thick for the spaces stand on the tips of the rack's on both sides.
    #[test]
    fn teeth_that_do_not_enter_stand_on_tips() {
        let mut data = PairData {
            normal_module_mm: 2.0,
            normal_pressure_angle_rad: 0.35,
            rack: RackData { helix_angle_rad: 0.0, face_width_mm: 20.0, addendum_mm: 1.0, tooth_thickness_mm: None },
            pinion: PinionData {
                teeth: 20,
                helix_angle_rad: 0.0,
                profile_shift: 0.2,
                tip_diameter_mm: 44.8,
                root_form_diameter_mm: Some(38.2),
                face_width_mm: 24.0,
                tooth_thickness_deviation_mm: 0.0,
            },
        };
        let mut ends = |thickness: f64| {
            data.rack.tooth_thickness_mm = Some(thickness);
            let mesh = Mesh::nominal(Pair::new(&data).expect("a valid pair")).expect("teeth in order");
            [0, 1, 2, 3, 4, 5, 6, 7].map(|step| mesh.at(0.79 * f64::from(step)))
        };
        assert!(ends(3.1).iter().all(Result::is_ok));
        let tips = ends(5.6);
        assert!(matches!(tips[0], Err(MeshError::TipOnTip { .. })), "{tips:?}");
        // a little further one side catches the edges of tips
        assert!(tips[1].is_ok_and(|point| point.converged() && point.delta_cd_mm > 2.0), "{tips:?}");
    }

    /// Where both sides are not seen to balance, the same one asks for more at every rotation from the first one tried to the
    /// end of the range: of flanks that overhang when the rack rolls.
    #[test]
    fn what_is_given_up_has_no_balance_ahead() {
        let mut given_up = 0;
        for mesh in crate::mesh::roll::tests::odd::pairs() {
            let mut sampler = Sampler::new(&mesh);
            for (stroke, angle) in [0.0, 1.3, 5.7].into_iter().flat_map(|s| [-0.07, -0.04, 0.03, 0.06].map(|a| (s, a)))
            {
                sampler.set_roll(Roll::new(angle, 14.0));
                sampler.last = None;
                let before = sampler.work().rotations;
                let Ok(point) = sampler.solve(stroke) else { continue };
                if point.ending != Ending::Unbalanced {
                    continue;
                }
                given_up += 1;
                let rotations = sampler.work().rotations - before;
                assert!(rotations == u64::from(point.iterations) && point.iterations == UNTIL_END + 1, "{point:?}");
                let position = sampler.locate(stroke).expect("in order");
                let Constants { angle_per_mm, angular_pitch, .. } = sampler.constants;
                let start = sampler.slot(FlankSide::Right, position.tooth).prepared.center * angle_per_mm;
                let end = -point.transmission_error_rad;
                assert!(((end - start).abs() / angular_pitch - 0.75).abs() < 1e-9, "{start} {end}");
                for part in 0..=40 {
                    let at = start + (end - start) * f64::from(part) / 40.0;
                    let [right, left] = sampler.glance(&position, at, stroke).expect("contact");
                    let excess = right.value - left.value;
                    assert!(excess * point.residual_mm > 0.0, "{excess} at {at}: {point:?}");
                }
            }
        }
        println!("{given_up} given up");
        assert!(given_up > 10, "{given_up}");
    }

    /// What was seen of a pair elsewhere, at another stroke, rotation, roll or place of the end faces, never hides that
    /// it carries here. Steep tooth lines on a large pinion let a demand change faster than its base circle turns.
    #[test]
    fn what_was_asked_for_elsewhere_hides_nothing() {
        for (teeth, lead) in [(20, 0.006), (200, 0.05)] {
            let mut data = crate::gear::example(teeth, 0.1, 0.2);
            data.pinion.root_form_diameter_mm = None;
            let pair = Pair::new(&data).expect("a valid pair");
            let rack = RackFlanks::new(&pair, &[all(RackDeviationKind::Lead(lead))]).expect("small");
            let support = Support::FreeRoll { axis_depth_mm: 8.0 };
            let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), support).expect("teeth in order");
            let share = |index: u32, step: f64| (f64::from(index) * step).fract() - 0.5;
            let mut warm = Sampler::new(&mesh);
            let (mut stroke, mut offset, mut angle, mut further) = (0.0, 0.0, 0.0, 0.0);
            let (mut compared, mut spared) = (0, 0);
            for index in 0..5000 {
                if matches!(index % 5, 0 | 4) {
                    stroke = share(index, 0.618_034) * pair.rack().pitch_mm;
                }
                match index % 5 {
                    1 | 4 => offset = share(index, 0.414_214) * 0.5 * pair.pinion().angular_pitch_rad(),
                    2 => angle = share(index, 0.732_051) * 0.14,
                    3 => further = share(index, 0.236_068) * 6.0,
                    _ => {}
                }
                let ask = |sampler: &mut Sampler| {
                    sampler.set_roll(Roll::new(angle, 8.0));
                    sampler.assumed = pair.nominal_center_distance_mm() + further;
                    let position = sampler.locate(stroke).expect("in order");
                    let before = sampler.work.searched;
                    let sides = [FlankSide::Right, FlankSide::Left];
                    let demands = sides.map(|side| sampler.demand(side, &position, (offset, false), stroke).ok());
                    (demands.map(|demand| demand.map_or(0.0, |demand| demand.value)), sampler.work.searched - before)
                };
                let (fresh, searched) = ask(&mut Sampler::new(&mesh));
                let (found, again) = ask(&mut warm);
                spared += searched.saturating_sub(again);
                for (found, fresh) in found.into_iter().zip(fresh) {
                    compared += usize::from(fresh != 0.0);
                    assert!((found - fresh).abs() < 1e-10, "{teeth} {index}: {found} {fresh}");
                }
            }
            println!("{compared} compared, {spared} searches spared");
            assert!(compared > 9000 && spared > 0, "{compared} {spared}");
        }
    }
}
