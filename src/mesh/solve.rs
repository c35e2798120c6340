//! The solve at one stroke: which rotation makes both sides ask for the same centre distance. Called for a rack that
//! cannot roll, and at each roll of one that can; allocates nothing per stroke once a sampler is warm.

use super::contact::PoseRates;
use super::demand::{Demand, Position};
use super::prepare::Roll;
use super::sampler::{Constants, Contact, Looks, Rolling, Sampler};
use super::{Carrier, Ending, FlankSide, MeshError, MeshPoint, Support};

/// Rotations tried at most; Newton needs two or three, a bisection of the whole range 60.
const MAX_ITERATIONS: u32 = 120;

/// Rotations after which the bracket is only halved: the rest of [`MAX_ITERATIONS`] halves it down to rounding.
const PATIENCE: u32 = 50;

/// Rotations after which the end of the bracket that Newton's steps lead to is tried; mostly three find the solution.
const UNTIL_END: u32 = 8;

/// Newton's step and the secant's are taken where what both sides ask for approaches by at least this share of
/// r_b / sin α_t per rad.
const LEAST_SLOPE: f64 = 1e-3;

/// How often the known peaks of flanks with form are balanced and checked, before the whole flank is searched at each
/// rotation.
const MOST_CHECKED: u32 = 4;

/// Known peaks are the highest of the flank if their demand is that of the whole flank within this share of r_b / sin α_t.
const CHECKED: f64 = 1e-13;

/// Both sides at the last rotation tried.
struct Balance {
    right: Demand,
    left: Demand,
    offset: f64,
    /// The step to where the tangents of both sides cross; 0 where they say nothing.
    step: f64,
    iterations: u32,
    ending: Ending,
}

impl Sampler<'_> {
    /// The zero-backlash position at the present roll.
    pub(super) fn solve(&mut self, stroke_mm: f64) -> Result<MeshPoint, MeshError> {
        let position = self.locate(stroke_mm)?;
        let displacement = self.slot(FlankSide::Right, position.tooth).prepared.center;
        let balance = self.balanced(&position, displacement)?;
        let Balance { right, left, offset, step, .. } = balance;
        if right.touch.is_on_tip() && left.touch.is_on_tip() {
            return Err(MeshError::TipOnTip { stroke_mm, right: right.tooth, left: left.tooth });
        }
        // where both tangents cross; without a step the larger demand, at which no flank penetrates
        let a = if step == 0.0 { right.value.max(left.value) } else { right.value + right.rate * step };
        self.last = Some((offset, displacement));
        if self.mesh.support() != Support::Fixed {
            self.rolling = self.rolling(&right, &left);
        }
        Ok(self.point(stroke_mm, a, &balance))
    }

    fn point(&self, stroke_mm: f64, center_distance_mm: f64, balance: &Balance) -> MeshPoint {
        let Balance { right, left, offset, step, iterations, ending } = balance;
        let Constants { angle_per_mm, nominal, .. } = self.constants;
        let error = -(offset + step);
        MeshPoint {
            stroke_mm,
            center_distance_mm,
            delta_cd_mm: center_distance_mm - nominal,
            pinion_angle_rad: stroke_mm * angle_per_mm + error,
            transmission_error_rad: error,
            roll_rad: self.roll.angle,
            right: self.carrier(FlankSide::Right, right),
            left: self.carrier(FlankSide::Left, left),
            residual_mm: right.value - left.value,
            iterations: *iterations,
            ending: *ending,
        }
    }

    /// One rotation at the present roll, `turned` against where the rack's nearest tooth has the pinion; where the tangents
    /// of both sides meet, and how far in rotation and centre distance that is. `None` where they tell nothing.
    pub(super) fn glimpse(&mut self, stroke_mm: f64, turned: f64) -> Result<Option<(MeshPoint, [f64; 2])>, MeshError> {
        let position = self.locate(stroke_mm)?;
        let displacement = self.slot(FlankSide::Right, position.tooth).prepared.center;
        let offset = turned + displacement * self.constants.angle_per_mm;
        let [right, left] = self.demands(&position, offset)?;
        let least = LEAST_SLOPE * self.constants.default_rate;
        if right.touch.is_on_tip() && left.touch.is_on_tip() || !(right.rate < -least && left.rate > least) {
            return Ok(None);
        }
        self.rolling = self.rolling(&right, &left);
        let share = left.rate / (left.rate - right.rate);
        let moved = (share * right.value + (1.0 - share) * left.value - self.assumed) / self.rolling.remaining();
        let step = (left.value - right.value) / (right.rate - left.rate) + self.rolling.turn[1] * moved;
        let balance = Balance { right, left, offset, step, iterations: 1, ending: Ending::Converged };
        self.last = Some((offset + step, displacement));
        Ok(Some((self.point(stroke_mm, self.assumed + moved, &balance), [step, moved])))
    }

    /// The rotation at which both sides ask for the same. With flank form, and with a rack that may roll, that is where the
    /// known peaks and teeth ask for the same, if no other place asks for more there. Where peaks come and go with the rotation
    /// they do not balance, and everything is searched from the start.
    fn balanced(&mut self, position: &Position, displacement: f64) -> Result<Balance, MeshError> {
        let is_at_peaks = match self.mesh.support() {
            Support::Fixed => self.mesh.has_form(),
            Support::FreeRoll { .. } => self.last.is_some(),
        };
        let start = self.last;
        for _ in 0..if is_at_peaks { MOST_CHECKED } else { 0 } {
            self.looks = Looks::AtPeaks;
            let at_peaks = self.balance(position, displacement);
            self.looks = Looks::Everywhere;
            let Some(at_peaks) = at_peaks.ok().filter(|found| found.ending == Ending::Converged) else { break };
            let [right, left] = self.demands(position, at_peaks.offset)?;
            let [r, l] = [right.value - at_peaks.right.value, left.value - at_peaks.left.value];
            if r.abs().max(l.abs()) <= CHECKED * self.constants.default_rate {
                return Ok(Balance { right, left, iterations: at_peaks.iterations + 1, ..at_peaks });
            }
            self.last = Some((at_peaks.offset, displacement));
        }
        self.last = start;
        self.balance(position, displacement)
    }

    /// The balance of both sides by Newton's method in a bracket; the rack's nearest tooth is displaced by `displacement`.
    fn balance(&mut self, position: &Position, displacement: f64) -> Result<Balance, MeshError> {
        let Constants { tolerance, angle_per_mm, angular_pitch, default_rate, .. } = self.constants;
        let guess = displacement * angle_per_mm;
        let range = (guess - 0.75 * angular_pitch, guess + 0.75 * angular_pitch);
        let (mut low, mut high) = range;
        let near = |&(offset, at): &(f64, f64)| (offset - at * angle_per_mm).abs() < 0.5 * angular_pitch;
        let from_last = |(offset, at): (f64, f64)| offset + (displacement - at) * angle_per_mm;
        let mut offset = self.last.filter(near).map_or(guess, from_last);
        let mut before: Option<(f64, f64)> = None;
        let mut iterations = 0;
        loop {
            iterations += 1;
            let [right, left] = self.demands(position, offset)?;
            let excess = right.value - left.value;
            let mut slope = right.rate - left.rate;
            if !slope.is_finite() || slope >= -LEAST_SLOPE * default_rate {
                slope = -2.0 * default_rate;
            }
            // where edges meet the derivative may belong to one of them only: take the secant
            if let Some((at, value)) = before.filter(|_| iterations > 3) {
                let secant: f64 = (excess - value) / (offset - at);
                if secant < -LEAST_SLOPE * default_rate && secant.is_finite() {
                    slope = secant;
                }
            }
            before = Some((offset, excess));
            let step = -excess / slope;
            if excess.abs() <= tolerance {
                return Ok(Balance { right, left, offset, step, iterations, ending: Ending::Converged });
            }
            let given_up = |ending| Balance { right, left, offset, step: 0.0, iterations, ending };
            let end = if excess > 0.0 { high } else { low };
            if excess > 0.0 {
                low = offset;
            } else {
                high = offset;
            }
            if iterations >= if self.looks == Looks::AtPeaks { UNTIL_END } else { MAX_ITERATIONS } {
                return Ok(given_up(Ending::IterationLimit));
            }
            if iterations == UNTIL_END
                && (end == range.0 || end == range.1)
                && let Some([right, left]) = self.glance(position, end)
                && (right.value > left.value) == (excess > 0.0)
            {
                let (iterations, ending) = (iterations + 1, Ending::Unbalanced);
                return Ok(Balance { right, left, offset: end, step: 0.0, iterations, ending });
            }
            let mut next = offset + step;
            // Newton's step, unless it leaves the bracket or was tried too often
            if next <= low || next >= high || iterations % 8 == 0 || iterations > PATIENCE {
                next = 0.5 * (low + high);
            }
            if next == offset || high - low <= f64::EPSILON * offset.abs().max(1e-4 * angular_pitch) {
                return Ok(given_up(Ending::BracketExhausted));
            }
            offset = next;
        }
    }

    /// The demands of both sides at a rotation that is no step of the solution.
    fn glance(&mut self, position: &Position, offset: f64) -> Option<[Demand; 2]> {
        let carried = self.carried;
        let demands = self.demands(position, offset);
        self.carried = carried;
        demands.ok()
    }

    /// At the balance of both sides their shares in the centre distance are those that cancel the rotation.
    fn rolling(&mut self, right: &Demand, left: &Demand) -> Rolling {
        let Roll { sin, cos, depth, .. } = self.roll;
        let across = [cos * (depth + self.assumed), sin];
        let mut rate = |side, demand: &Demand| {
            let prepared = &self.slot(side, demand.tooth).prepared;
            let moved = PoseRates { shift: prepared.rates.per_shift * demand.place, across };
            prepared.contact.roll_rate(&demand.pose, &demand.touch, &prepared.rates, &moved)
        };
        let (r, l) = (rate(FlankSide::Right, right), rate(FlankSide::Left, left));
        let share = left.rate / (left.rate - right.rate);
        let share = if share.is_finite() { share } else { 0.5 };
        let at = |demand: &Demand| {
            let spot = &demand.touch.spot;
            let at_high_end = spot.w.is_sign_positive();
            let edges = [Some(spot.kind), demand.touch.other.map(|(spot, _)| spot.kind)];
            Contact { tooth: demand.tooth, kind: demand.touch.kind, edges, at_high_end, surface: spot.surface }
        };
        let apart = right.rate - left.rate;
        Rolling {
            rate: [0, 1].map(|i| share * r[i] + (1.0 - share) * l[i]),
            turn: [0, 1].map(|i| (l[i] - r[i]) / apart),
            at: Some([at(right), at(left)]),
        }
    }

    fn carrier(&self, side: FlankSide, demand: &Demand) -> Carrier {
        Carrier {
            rack_tooth: demand.tooth,
            pinion_tooth: side.pinion_tooth(demand.tooth, self.mesh.pair().pinion().teeth),
            contact: demand.touch.kind,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{PinionDeviation, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange};
    use crate::gear::{Pair, PairData, PinionData, RackData};
    use crate::mesh::Mesh;

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
        let pinion = PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(0.05, 3)]);
        let rack = RackFlanks::new(&pair, list).expect("small");
        Mesh::new(pair, rack, pinion.expect("small"), Support::Fixed).expect("teeth in order")
    }

    fn all(kind: RackDeviationKind) -> RackDeviation {
        RackDeviation { teeth: ToothRange::ALL, kind }
    }

    /// The search for the rotation ends at the same place soon, wherever it starts, within the bracket or beyond.
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
                // the pinion has turned further by the share of the shift
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
        let limit = Sampler::new(&mesh).constants.stroke_limit;
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
                sampler.roll = Roll::new(angle, 14.0);
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
                    let [right, left] = sampler.glance(&position, at).expect("contact");
                    let excess = right.value - left.value;
                    assert!(excess * point.residual_mm > 0.0, "{excess} at {at}: {point:?}");
                }
            }
        }
        println!("{given_up} given up");
        assert!(given_up > 10, "{given_up}");
    }

    /// The bound of a pair from another stroke, rotation, roll or place of the end faces never hides that the pair carries
    /// here. With steep tooth lines on a large pinion a demand changes faster than its base circle turns.
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
                    sampler.roll = Roll::new(angle, 8.0);
                    sampler.assumed = pair.nominal_center_distance_mm() + further;
                    let position = sampler.locate(stroke).expect("in order");
                    let before = sampler.work.searched;
                    let sides = [FlankSide::Right, FlankSide::Left];
                    let demands = sides.map(|side| sampler.demand(side, &position, offset).ok());
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
