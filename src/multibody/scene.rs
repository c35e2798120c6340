//! The bodies, their contact and the closing force, made from a pair, its deviations and parameters. The runs ask it for
//! forces.

use super::ParameterName;
use super::bound::Reach;
use super::error::SimulationError;
use super::flank::{Bounds, FlankPair, Patch, Pose, SceneGeometry, transverse};
use super::law::Law;
use super::load::{Load, Work};
use super::meeting::Meeting;
use super::outcome::YokeSample;
use super::parameters::{ContactModel, Parameters, Support};
use super::spheres;
use super::state::{Coordinates, Forces};
use super::strips;
use super::template::Template;
use crate::deviation::{PinionFlanks, RackFlanks, RackTooth};
use crate::gear::Pair;
use crate::mesh::{self, FlankSide, MatingFlanks, Mesh};
use crate::trig;

/// Contacts may sink between elements by this share of the normal module at most.
const COARSE: f64 = 5e-3;
/// Density of steel, kg/mm³.
const STEEL: f64 = 7.85e-6;

/// A checked simulation, ready to run any number of times.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(super) mesh: Mesh,
    pub(super) parameters: Parameters,
    pub(super) law: Law,
    pub(super) templates: Vec<Template>,
    pub(super) right: Vec<FlankPair>,
    pub(super) left: Vec<FlankPair>,
    /// Rack tooth of the first right flank.
    pub(super) first_tooth: i64,
    pub(super) deviating: Vec<bool>,
    pub(super) shared: SceneGeometry,
    pub(super) rolls: bool,
    /// Inertias of ψ, a, φ in N s²/mm and N mm s².
    pub(super) inertia: [f64; 3],
}

impl Scene {
    /// Checks the parameters and prepares every flank of the stroke.
    ///
    /// # Errors
    /// [`SimulationError::OutOfDomain`] for a parameter outside its domain, [`SimulationError::TooCoarse`] for too few
    /// spheres or strips, [`SimulationError::Mesh`] for flanks that
    /// cannot mesh.
    pub fn new(
        pair: Pair,
        rack: RackFlanks,
        pinion: PinionFlanks,
        parameters: Parameters,
    ) -> Result<Self, SimulationError> {
        parameters.check()?;
        let (sin_shaft, cos_shaft) = trig::sin_cos(pair.shaft_angle_rad());
        let shared = SceneGeometry {
            pitch: pair.rack().pitch_mm,
            angular_pitch: pair.pinion().angular_pitch_rad(),
            sin_shaft,
            cos_shaft,
            depth: if let Support::FreeRoll { axis_depth_mm } = parameters.support { axis_depth_mm } else { 0.0 },
            eccentricity: pinion.eccentricity_mm(),
        };
        let around = i64::from(pair.pinion().teeth) / 2 + 3;
        let end = parameters.start_mm + parameters.stroke_mm;
        if (parameters.stroke_mm / shared.pitch) > 1e5 || (end.abs() / shared.pitch) > 1e9 {
            let (value, max) = (parameters.stroke_mm, 1e5 * shared.pitch);
            return Err(SimulationError::OutOfDomain { name: ParameterName::Stroke, value, min: 1e-6, max });
        }
        let nearest = |stroke: f64| (stroke / shared.pitch).round() as i64;
        let (first, last) = (nearest(parameters.start_mm) - around, nearest(end) + around);
        let teeth: Vec<RackTooth> = (first..=last).map(|index| rack.tooth(index)).collect();
        let leads = teeth.iter().map(|tooth| [tooth.left.lead_rad, tooth.right.lead_rad]);
        let leads = leads.chain(pinion.teeth().iter().map(|tooth| [tooth.left.lead_rad, tooth.right.lead_rad]));
        let led = leads.flatten().any(|lead| lead != 0.0);
        let helical = pair.rack().helix_angle_rad != 0.0 || pair.pinion().helix_angle_rad != 0.0;
        let inertia = inertia(&pair, &parameters);
        let rolls = matches!(parameters.support, Support::FreeRoll { .. }) && (led || helical);
        let rigid = if rolls { mesh::Support::FreeRoll { axis_depth_mm: shared.depth } } else { mesh::Support::Fixed };
        let mut scene = Self {
            mesh: Mesh::new(pair, rack, pinion, rigid)?,
            parameters,
            law: Law::new(&parameters),
            templates: Vec::new(),
            right: Vec::new(),
            left: Vec::new(),
            first_tooth: first,
            deviating: teeth.iter().map(|tooth| *tooth != RackTooth::default()).collect(),
            shared,
            rolls,
            inertia,
        };
        for tooth in first..=last {
            let (right, left) = (scene.flank(FlankSide::Right, tooth)?, scene.flank(FlankSide::Left, tooth)?);
            scene.right.push(right);
            scene.left.push(left);
        }
        let (resolution_mm, limit_mm) = (scene.resolution_mm(), COARSE * pair.normal_module_mm());
        if resolution_mm > limit_mm {
            return Err(SimulationError::TooCoarse { resolution_mm, limit_mm });
        }
        Ok(scene)
    }

    fn flank(&mut self, side: FlankSide, rack_tooth: i64) -> Result<FlankPair, SimulationError> {
        let pair = *self.mesh.pair();
        let (rack, p) = (pair.rack(), pair.pinion());
        let MatingFlanks { normal, offset, pinion_tooth, pinion_lead_rad, start, .. } =
            self.mesh.mating_flanks(side, rack_tooth);
        let sign = side.sign();
        let template = self.template(sign, pinion_lead_rad)?;
        let bounds = Bounds {
            half_width: 0.5 * rack.face_width_mm,
            tip: rack.addendum_mm,
            bottom: (pair.nominal_center_distance_mm() - p.tip_radius_mm).min(rack.addendum_mm)
                - 2.0 * pair.normal_module_mm(),
            reach: self.deepest(),
        };
        let SceneGeometry { sin_shaft, cos_shaft, .. } = self.shared;
        let corner = |y: f64, z: f64| [(offset - normal[1] * y - normal[2] * z) / normal[0], y, z];
        let Bounds { half_width, tip, bottom, .. } = bounds;
        let mut made = FlankPair {
            right: side == FlankSide::Right,
            sign,
            rack_tooth,
            pinion_tooth,
            normal,
            offset,
            start,
            level: transverse(normal[0] * cos_shaft - normal[1] * sign * sin_shaft, normal[2]),
            template,
            bounds,
            corners: [
                corner(-half_width, bottom),
                corner(half_width, bottom),
                corner(half_width, tip),
                corner(-half_width, tip),
            ],
            patch: Patch::Plane,
        };
        if let ContactModel::Spheres(grid) = self.parameters.contact {
            made.shape(self.mesh.rack().form(), grid.patch_cells);
        }
        Ok(made)
    }

    /// The template of a pinion flank with this lead, made if there is none yet.
    fn template(&mut self, sign: f64, lead: f64) -> Result<usize, SimulationError> {
        if let Some(found) = self.templates.iter().position(|known| known.sign == sign && known.lead == lead) {
            return Ok(found);
        }
        let pinion = self.mesh.pinion();
        let p = self.mesh.pair().pinion();
        let shift = pinion.teeth().iter().flat_map(|tooth| [tooth.left, tooth.right]);
        let shift = shift.map(|flank| flank.arc_mm.abs()).fold(0.0, f64::max) / p.reference_radius_mm;
        let mut made = Template::new(self.mesh.pair(), sign, lead, *pinion.form(), &self.parameters.contact)?;
        made.tooth_reach = p.base_half_angle_rad + shift;
        self.templates.push(made);
        Ok(self.templates.len() - 1)
    }

    /// Counts the teeth from this one on as the rack's second part, whether they deviate or not.
    #[must_use]
    pub fn with_second_part(mut self, tooth: i64) -> Self {
        for (index, deviating) in (self.first_tooth..).zip(&mut self.deviating) {
            *deviating = index >= tooth;
        }
        self
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The rigid mesh of the same pair and deviations; its rack rolls if this one's does and its flanks are plane.
    #[must_use]
    pub const fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Whether the rack's roll is a coordinate: the support leaves it free, and a helix or a lead deviation loads it.
    #[must_use]
    pub const fn rolls(&self) -> bool {
        self.rolls
    }

    /// Inertias of ψ (N mm s²), a (N s²/mm) and φ (N mm s²).
    #[must_use]
    pub const fn inertias(&self) -> [f64; 3] {
        self.inertia
    }

    /// The resolution of the discretisation, mm: how far a contact may sink between two spheres of a row, a corner between two rows
    /// (or strips), and an end of the face width of a flank with a lead deviation.
    #[must_use]
    pub fn resolution_mm(&self) -> f64 {
        let sag = self.templates.iter().map(|t| t.sag().max(t.corner_sag())).fold(0.0, f64::max);
        let between = self.right.iter().chain(&self.left).map(|flank| {
            let template = &self.templates[flank.template];
            let n_w = flank.normal[0] * flank.sign * self.shared.sin_shaft + flank.normal[1] * self.shared.cos_shaft;
            0.5 * template.row_step() * (n_w - flank.level.1 * template.base_radius * template.kappa).abs()
        });
        sag.max(between.fold(0.0, f64::max))
    }

    /// How far ΔCD, the indentation added back, may be from that of the exact mesh because contacts fall between
    /// spheres or strips, mm; the rack not rolled.
    ///
    /// A tooth that stands proud of its neighbour by e (along the normal, at the end of the face width where a lead
    /// deviation puts it) carries before its path of contact begins, where the pinion's tip edge has turned by δ past
    /// it: e = r_b τ_a δ²/2. There the gap grows along the face width by κ r_b τ_a δ = κ √(2 r_b τ_a e) per mm, and the
    /// corner lies up to a row beyond the last one that meets the flank. With twice [`Scene::resolution_mm`], which
    /// counts half a row, that is what one flank may sink; one on each side lowers ΔCD by the sum of both over 2
    /// sin α_n. Spheres of the radius R stand out by R δ²/2 beyond the tip edge, which raises it by e R/(r_b τ_a −
    /// R) over sin α_n.
    #[must_use]
    pub fn sinking_mm(&self) -> f64 {
        let pair = self.mesh.pair();
        // where a flank pair stands along the rack's normal at the ends of the face width
        let across = |flank: &FlankPair| {
            let turned = flank.sign * flank.start * pair.pinion().base_radius_mm * flank.level.1;
            let tilt = flank.normal[1] * flank.bounds.half_width;
            [flank.offset - turned - tilt, flank.offset - turned + tilt]
        };
        let apart = |two: &[FlankPair]| {
            let ([a, b], [c, d]) = (across(&two[0]), across(&two[1]));
            (a - c).abs().max((b - d).abs())
        };
        let proud = [&self.right, &self.left].into_iter().flat_map(|side| side.windows(2));
        let proud = proud.map(apart).fold(0.0, f64::max);
        let radius = match self.parameters.contact {
            ContactModel::Spheres(grid) => grid.radius_mm,
            ContactModel::Analytic(_) => 0.0,
        };
        let edges = self.templates.iter().map(|t| {
            let curvature = t.base_radius * t.tip_roll;
            let rounded = radius.min(0.5 * curvature);
            t.row_step() * t.kappa.abs() * (2.0 * curvature * proud).sqrt() + proud * rounded / (curvature - rounded)
        });
        (2.0 * self.resolution_mm() + edges.fold(0.0, f64::max)) / trig::sin(pair.normal_pressure_angle_rad())
    }

    /// Penetration beyond which a run gives up, mm: a tenth of the normal module.
    #[must_use]
    pub fn deepest(&self) -> f64 {
        0.1 * self.mesh.pair().normal_module_mm()
    }

    /// The contact forces in a position, with their tangents.
    #[must_use]
    pub fn forces(&self, at: &Coordinates, rates: &Coordinates) -> Forces {
        self.contact(&self.law, at, rates, &mut Work::default())
    }

    pub(super) fn contact(&self, law: &Law, at: &Coordinates, rates: &Coordinates, work: &mut Work) -> Forces {
        work.counters.evaluations += 1;
        work.touching.0.iter_mut().for_each(Vec::clear);
        work.near.clear();
        let pose = Pose::new(*at, self.shared);
        let reach = self.reach(&pose, work.margin);
        let mut load = Load { law, rates: rates.all(), sum: Forces::default(), work };
        // each pinion tooth once: those whose angle from straight down is at most half a turn
        let half = 0.5 * f64::from(self.mesh.pair().pinion().teeth);
        let middle = at.pinion_angle / self.shared.angular_pitch - 0.5;
        let (low, high) = ((middle - half).ceil() as i64, (middle + half).floor() as i64);
        let mut most = [0.0; 2];
        for pinion_tooth in low..=high {
            let sides = [(&self.right, pinion_tooth), (&self.left, pinion_tooth + 1)];
            for (side, (flanks, rack_tooth)) in sides.into_iter().enumerate() {
                let index = usize::try_from(rack_tooth - self.first_tooth).ok();
                let Some(flank) = index.and_then(|index| flanks.get(index)) else { continue };
                let Some(meeting) = Meeting::new(flank, &self.templates[flank.template], &pose, &reach) else {
                    continue;
                };
                let before = load.sum.normal_forces()[side];
                match self.parameters.contact {
                    ContactModel::Spheres(_) => spheres::touch(&meeting, &mut load),
                    ContactModel::Analytic(_) => strips::touch(&meeting, self.mesh.rack().form(), &mut load),
                }
                let carried = load.sum.normal_forces()[side] - before;
                if carried > most[side] {
                    most[side] = carried;
                    load.sum.carrying[side] = Some(rack_tooth);
                }
            }
        }
        load.sum
    }

    /// The parts of the pinion that may be near the rack in a position.
    fn reach(&self, pose: &Pose, margin: f64) -> Reach {
        let (rack, p) = (self.mesh.pair().rack(), self.mesh.pair().pinion());
        // strips are spheres of the radius 0, and none is remembered that does not touch
        let (radius, kept) = match self.parameters.contact {
            ContactModel::Spheres(grid) => (grid.radius_mm, margin),
            ContactModel::Analytic(_) => (0.0, 0.0),
        };
        // no point of the rack lies higher, rolled or not
        let top = rack.addendum_mm
            + 0.5 * rack.face_width_mm * pose.sin_roll.abs()
            + (self.shared.depth + rack.addendum_mm).abs() * (1.0 - pose.cos_roll);
        let (along, across) = self.shared.eccentricity;
        let off = (along * along + across * across).sqrt();
        let cosine = (pose.at.center_distance - off - top - 2.0 * radius - margin) / p.tip_radius_mm;
        let polar = if cosine <= -1.0 { std::f64::consts::PI } else { trig::acos(cosine.min(1.0)) };
        Reach { cull: self.parameters.cull, rolls: self.rolls, polar, margin: kept }
    }

    /// The yoke at a centre distance.
    pub(super) fn yoke(&self, center_distance: f64) -> Option<YokeSample> {
        let yoke = self.parameters.yoke()?;
        let travel_mm = center_distance - self.mesh.pair().nominal_center_distance_mm();
        let spring = (yoke.preload_n + yoke.rate_n_per_mm * travel_mm).max(0.0);
        let stop = yoke.stop_n_per_mm * (travel_mm - yoke.clearance_mm).max(0.0);
        Some(YokeSample { travel_mm, force_n: spring + stop, bush_force_n: yoke.bush_n_per_mm * travel_mm })
    }

    /// Force that presses the parts together at a centre distance, and its rate, N and N/mm.
    pub(super) fn closing(&self, center_distance: f64) -> (f64, f64) {
        let Some((yoke, at)) = self.parameters.yoke().zip(self.yoke(center_distance)) else {
            return (self.parameters.preload_n, 0.0);
        };
        let spring = if yoke.preload_n + yoke.rate_n_per_mm * at.travel_mm > 0.0 { yoke.rate_n_per_mm } else { 0.0 };
        let stop = if at.travel_mm > yoke.clearance_mm { yoke.stop_n_per_mm } else { 0.0 };
        (at.force_n + at.bush_force_n, spring + stop + yoke.bush_n_per_mm)
    }

    /// Forces on ψ, a and φ, the closing force included.
    pub(super) fn unbalanced(&self, q: &[f64; 3], contact: &Forces) -> [f64; 3] {
        let [angle, height, roll, _] = contact.generalized;
        [angle, height - self.closing(q[1]).0, roll]
    }

    /// How these forces fall with ψ, a and φ.
    pub(super) fn tangent(&self, q: &[f64; 3], contact: &Forces) -> [[f64; 3]; 3] {
        let mut tangent = contact.stiffness;
        tangent[1][1] += self.closing(q[1]).1;
        tangent
    }

    /// Potential energy of the closing force against a_0, N mm.
    pub(super) fn closing_energy(&self, center_distance: f64) -> f64 {
        let travel = center_distance - self.mesh.pair().nominal_center_distance_mm();
        let Some(yoke) = self.parameters.yoke() else { return self.parameters.preload_n * travel };
        let floor = if yoke.rate_n_per_mm > 0.0 { travel.max(-yoke.preload_n / yoke.rate_n_per_mm) } else { travel };
        let beyond = (travel - yoke.clearance_mm).max(0.0);
        yoke.preload_n * floor
            + 0.5 * yoke.rate_n_per_mm * floor * floor
            + 0.5 * yoke.bush_n_per_mm * travel * travel
            + 0.5 * yoke.stop_n_per_mm * beyond * beyond
    }

    /// Nominal closing force: the measure of all force tolerances.
    pub(super) fn load_n(&self) -> f64 {
        self.parameters.yoke().map_or(self.parameters.preload_n, |yoke| yoke.preload_n)
    }

    pub(super) fn is_deviating(&self, tooth: i64) -> bool {
        usize::try_from(tooth - self.first_tooth).ok().and_then(|index| self.deviating.get(index)) == Some(&true)
    }
}

/// Inertias of ψ, a, φ: steel cylinders unless given; kg to N s²/mm.
fn inertia(pair: &Pair, parameters: &Parameters) -> [f64; 3] {
    let masses = parameters.masses;
    let (p, rack) = (pair.pinion(), pair.rack());
    let cylinder = |radius: f64, length: f64| {
        let mass = STEEL * std::f64::consts::PI * radius * radius * length;
        (mass, 0.5 * mass * radius * radius)
    };
    let (pinion, pinion_turning) = cylinder(p.reference_radius_mm, p.face_width_mm);
    let (bar, bar_turning) = cylinder(0.5 * rack.face_width_mm, parameters.stroke_mm + 10.0 * rack.face_width_mm);
    let moving = match parameters.support {
        Support::Yoke(_) => masses.rack_kg.unwrap_or(bar),
        _ => masses.pinion_kg.unwrap_or(pinion),
    };
    [masses.pinion_kg_mm2.unwrap_or(pinion_turning), moving, masses.rack_kg_mm2.unwrap_or(bar_turning)]
        .map(|value| 1e-3 * value)
}
