//! How fast centre distance and pinion move at a solved stroke, and how much slides there. Called for points of a curve;
//! solves no stroke.

use super::contact::{ContactKind, Motion, Normal, Pose};
use super::demand::Demand;
use super::sampler::Sampler;
use super::{FlankSide, MeshPoint, SOLVED_MM, Support};

/// The rates of the mesh at a solved stroke, for each mm of travel. At a kink each side has its own rates.
///
/// D_R and D_L are the centre distances that the right and the left carrier ask for, as functions of the pinion's rotation θ
/// and of the rack's place x along X (which falls as the stroke s rises). Both ask for the same all along:
///
/// ```text
/// dθ/ds   = (∂D_R/∂x − ∂D_L/∂x) / (∂D_R/∂θ − ∂D_L/∂θ)
/// dΔCD/ds = ∂D_R/∂θ dθ/ds − ∂D_R/∂x
/// ```
///
/// A force F that presses the rack on presses the carriers with F_R + F_L = F along Z. A rack without a load along X has
/// F_R ∂D_R/∂x + F_L ∂D_L/∂x = 0, and N = F √(1 + (∂D/∂x)² + (∂D/∂y)²) is the force along a carrier's own normal. While both
/// sides carry by lines N_R + N_L = F / sin α_n. Forces are those of rigid teeth without friction; where several lines of one
/// side ask for the same the force is spread evenly over their length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// dΔCD/ds.
    pub delta_cd: f64,
    /// dθ/ds, rad/mm.
    pub pinion_angle: f64,
    /// Σ N_i v_i / (F v_rack) over the contacts, v_i their sliding speeds: friction at the teeth resists with μ F times this at
    /// the rack.
    pub sliding: f64,
}

/// The right and the left carrier.
struct Carried {
    demands: [Demand; 2],
    normals: [Normal; 2],
    /// dΔCD/ds.
    delta_cd: f64,
    /// dθ/ds, rad/mm.
    pinion_angle: f64,
}

impl Sampler<'_> {
    /// The rates at a point that was solved for this mesh; `None` if the rack may roll, or the point is not solved.
    pub fn rates(&mut self, point: &MeshPoint) -> Option<Rates> {
        let Carried { demands: [right, left], normals: [r, l], delta_cd, pinion_angle } = self.carried(point)?;
        let share = l.along / (l.along - r.along);
        let mut sliding = |side: FlankSide, demand: &Demand, normal: Normal, share: f64| {
            let motion = Motion { sign: side.sign(), delta_cd, pinion_angle };
            share * normal.length() * self.slip(side, demand, &motion)
        };
        let sliding = sliding(FlankSide::Right, &right, r, share) + sliding(FlankSide::Left, &left, l, 1.0 - share);
        sliding.is_finite().then_some(Rates { delta_cd, pinion_angle, sliding })
    }

    /// dΔCD/ds alone, as in the rates.
    pub fn slope(&mut self, point: &MeshPoint) -> Option<f64> {
        self.carried(point).map(|carried| carried.delta_cd)
    }

    /// What carries at a solved point, and how fast it moves.
    fn carried(&mut self, point: &MeshPoint) -> Option<Carried> {
        if self.mesh.support() != Support::Fixed || !point.is_solved() {
            return None;
        }
        let position = self.locate(point.stroke_mm).ok()?;
        self.carries(FlankSide::Right, point.right.rack_tooth);
        self.carries(FlankSide::Left, point.left.rack_tooth);
        let [right, left] = self.demands(&position, -point.transmission_error_rad).ok()?;
        let normals = [self.normal(FlankSide::Right, &right), self.normal(FlankSide::Left, &left)];
        let [r, l] = normals;
        let pinion_angle = (r.along - l.along) / (left.rate - right.rate);
        let delta_cd = -r.along - right.rate * pinion_angle;
        let is_known = delta_cd.is_finite() && pinion_angle.is_finite() && pinion_angle > 0.0;
        is_known.then_some(Carried { demands: [right, left], normals, delta_cd, pinion_angle })
    }

    /// The normal of a carrier.
    fn normal(&mut self, side: FlankSide, demand: &Demand) -> Normal {
        let normal = self.slot(side, demand.tooth).prepared.contact.normal(&demand.pose, &demand.touch);
        Normal { along: side.sign() * normal.along, ..normal }
    }

    /// Sliding speed of one side for each mm of stroke: the mean over all lines that ask for the same.
    fn slip(&mut self, side: FlankSide, demand: &Demand, motion: &Motion) -> f64 {
        let (pitch, angular_pitch) = (self.constants.pitch, self.constants.angular_pitch);
        let own = &self.slot(side, demand.tooth).prepared;
        let (start, alone) = (own.start, own.contact.slip(&demand.pose, &demand.touch, motion));
        let reach = if demand.touch.kind == ContactKind::Line { self.mesh.pair().contact_ratio().total } else { 0.0 };
        let reach = reach.ceil().clamp(0.0, 64.0) as i64;
        let (mut length, mut sum) = (0.0, 0.0);
        for step in -reach..=reach {
            let prepared = &self.slot(side, demand.tooth + step).prepared;
            let steps = step as f64;
            let pose = Pose {
                c: demand.pose.c + side.sign() * steps * angular_pitch + (prepared.start - start),
                shift: prepared.per_shift * (demand.place + steps * pitch),
                ..demand.pose
            };
            let line = prepared.contact.line_slip(&pose, motion);
            if let Some((_, long, speed)) = line.filter(|line| (line.0 - demand.value).abs() <= SOLVED_MM) {
                length += long;
                sum += long * speed;
            }
        }
        if length > 0.0 { sum / length } else { alone }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{
        PinionDeviation, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, RackForm, ToothRange,
    };
    use crate::gear::{Pair, example};
    use crate::mesh::Mesh;

    /// Racks with a step, a lead error or crowning against a pinion off its axis, at shaft angles of all kinds.
    fn meshes() -> Vec<Mesh> {
        let mut meshes = Vec::new();
        for (beta_r, beta_p) in [(0.0, 0.0), (0.0, 0.35), (-0.3, 0.3), (0.2, 0.3), (0.2, -0.5)] {
            let pair = Pair::new(&example(20, beta_r, beta_p)).unwrap();
            let on = |kind| RackDeviation { teeth: ToothRange::new(Some(2), Some(3)).unwrap(), kind };
            let step = [on(RackDeviationKind::Shift(0.02))];
            let lead = [RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(0.003) }];
            for (errors, crowning_mm) in [(&step, 0.0), (&lead, 0.0), (&step, 0.01)] {
                let form = RackForm { crowning_mm, ..RackForm::default() };
                let rack = RackFlanks::new(&pair, errors).unwrap().with_form(&pair, form).unwrap();
                let pinion = PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(0.03, 3)]).unwrap();
                meshes.push(Mesh::new(pair, rack, pinion, Support::Fixed).unwrap());
            }
        }
        meshes
    }

    /// Rates are the differences of neighbouring strokes, and flanks that touch neither separate nor penetrate.
    #[test]
    fn rates_are_those_of_neighbouring_strokes_and_contacts_only_slide() {
        const H: f64 = 1e-4;
        let (mut compared, mut edges) = (0, 0);
        for mesh in meshes() {
            let mut sampler = Sampler::new(&mesh);
            for step in 0..80 {
                let stroke = 0.31 * f64::from(step);
                let points = [stroke - H, stroke, stroke + H].map(|stroke| sampler.at(stroke).unwrap());
                let [before, point, after] = points;
                let rates = sampler.rates(&point).unwrap();
                let sliding = rates.sliding;
                let position = sampler.locate(stroke).unwrap();
                let demands = sampler.demands(&position, -point.transmission_error_rad).unwrap();
                for (side, demand) in [FlankSide::Right, FlankSide::Left].into_iter().zip(&demands) {
                    let Rates { delta_cd, pinion_angle, .. } = rates;
                    let motion = Motion { sign: side.sign(), delta_cd, pinion_angle };
                    let contact = &sampler.slot(side, demand.tooth).prepared.contact;
                    let approach = contact.approach(&demand.pose, &demand.touch, &motion);
                    let slack = if mesh.has_form() { 1e-5 } else { 1e-7 };
                    assert!(approach.abs() < slack, "{step} {side}: {approach} {:?}", demand.touch);
                    assert!(sliding > 0.0 && sliding < 10.0, "{step}: {sliding}");
                }
                if points.iter().any(|other| (other.right, other.left) != (point.right, point.left)) {
                    continue;
                }
                compared += 1;
                edges += usize::from(point.right.contact != ContactKind::Line);
                let difference = (after.delta_cd_mm - before.delta_cd_mm) / (2.0 * H);
                assert!((rates.delta_cd - difference).abs() < 2e-7, "{step} {rates:?} {difference} {point:?}");
                let turned = (after.pinion_angle_rad - before.pinion_angle_rad) / (2.0 * H);
                assert!((rates.pinion_angle - turned).abs() < 2e-8, "{step} {rates:?} {turned} {point:?}");
            }
        }
        assert!(compared > 800 && edges > 300, "{compared} {edges}");
    }

    /// Flank on flank: N_R + N_L = F / sin α_n, and flanks slide lengthwise with |sin Σ| / cos β_p at the pitch point.
    #[test]
    fn lines_slide_as_the_pitch_point_does_and_a_little_more() {
        for (beta_r, beta_p) in [(0.0, 0.35), (0.2, 0.3), (0.2, -0.5)] {
            let pair = Pair::new(&example(20, beta_r, beta_p)).unwrap();
            let lengthwise = crate::trig::sin(pair.shaft_angle_rad()).abs() / crate::trig::cos(beta_p);
            let least = lengthwise / crate::trig::sin(pair.normal_pressure_angle_rad());
            let mesh = Mesh::nominal(pair).unwrap();
            let mut sampler = Sampler::new(&mesh);
            for step in 0..20 {
                let point = sampler.at(0.31 * f64::from(step)).unwrap();
                let Rates { delta_cd, pinion_angle, sliding } = sampler.rates(&point).unwrap();
                assert!(delta_cd.abs() < 1e-14, "{delta_cd}");
                assert!((pinion_angle - pair.rotation_per_stroke_rad()).abs() < 1e-15);
                assert!((0.99 * least..1.3 * least).contains(&sliding), "{sliding} {least}");
            }
        }
    }
}
