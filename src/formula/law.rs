//! The law of each kind of error: how ΔCD follows from the error, and the error from ΔCD.
//!
//! Only this file computes the gain of an error; `eval`, tables, budgets, uncertainties and random parts call it.
//!
//! | shape | ΔCD | errors |
//! |---|---|---|
//! | shift | e | over-roller, radial |
//! | step | g \|e\|, g = cos β / (2 tan α_n) | pitch of rack or pinion |
//! | step | g \|e\|, g = cos β_b / (2 sin α_n), sin β_b = sin β_p cos α_n | lead of the pinion |
//! | sine | G \|sin Δβ\|, G = k / (2 cos β_r tan α_n) | lead of the rack, exact model |
//! | tangent | G \|tan Δβ\|, G = k / (2 tan α_n) | lead of the rack, paper model |
//!
//! In the paper's model cos β is 1. The paper has no formula for the lead of the pinion, so both models take the exact one.
//! [`mesh::relations`](crate::mesh::relations) derives the shapes.

pub use super::catalogue::page_of;
use super::{FormulaPage, Influence, Model, Sensitivity, domain};
#[cfg(feature = "batch")]
use crate::deviation::DeviationValues;
use crate::deviation::{DeviationKind, DeviationValue, Part};
use crate::quantity::{Angle, DomainError, FM_PER_MM, Length};
use crate::trig;

/// How ΔCD depends on one error of a gear; see the [module](self).
///
/// # Example
/// Table 1 of the paper, with α_n = 19.9° (the paper does not print it):
/// ```
/// use rackmesh::formula::{Law, Model};
/// use rackmesh::quantity::{Angle, Length};
///
/// let law = Law::rack_pitch("19.9".parse()?, Angle::ZERO)?;
/// for (pitch_error, printed) in [("+0.01", "0.014"), ("-0.02", "0.028"), ("+0.03", "0.041")] {
///     let delta_cd = law.delta_cd(pitch_error.parse::<Length>()?, Model::Exact)?;
///     assert_eq!(format!("{:.3}", delta_cd.mm()), printed);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    kind: DeviationKind,
    /// The gear data that the gain follows from; `None` for a shift.
    geometry: Option<Geometry>,
    /// Gains of the exact and of the paper's model: per step, or in femtometres per unit of sine or tangent.
    gains: [f64; 2],
}

/// The gear data that a gain follows from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Geometry {
    /// Normal pressure angle α_n.
    pub pressure_angle: Angle,
    /// Helix angle β of the part that has the error.
    pub helix_angle: Angle,
    /// Face width k of the rack, for its lead error.
    pub face_width: Option<Length>,
}

/// How ΔCD depends on the error, up to the gain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shape {
    Shift,
    Step,
    Sine,
    Tangent,
}

pub(crate) const RADIANS_PER_DEGREE: f64 = std::f64::consts::PI / 180.0;

/// mm of ΔCD per mm of step, or per mm of face width and unit of sine or tangent: cos β / (2 tan α_n) for a pitch
/// error, 1 / (2 cos β tan α_n) for the rack's lead error; in the paper's model cos β is 1. For the pinion's lead both
/// models have 1 / (2 sin α_t), tan α_t = tan α_n / cos β, which equals cos β_b / (2 sin α_n).
#[must_use]
pub(crate) fn unit_gain(kind: DeviationKind, model: Model, tan_alpha: f64, cos_beta: f64) -> f64 {
    match (kind, model) {
        (DeviationKind::RackOverRoller | DeviationKind::PinionRadial, _) => 1.0,
        (DeviationKind::PinionLead, _) => (tan_alpha * tan_alpha + cos_beta * cos_beta).sqrt() / (2.0 * tan_alpha),
        (_, Model::Paper) => 0.5 / tan_alpha,
        (DeviationKind::RackPitch | DeviationKind::PinionPitch, Model::Exact) => cos_beta / (2.0 * tan_alpha),
        (DeviationKind::RackLead, Model::Exact) => 0.5 / (cos_beta * tan_alpha),
    }
}

impl Law {
    #[doc = include_str!("over_roller.md")]
    #[must_use]
    pub const fn rack_over_roller() -> Self {
        Self { kind: DeviationKind::RackOverRoller, geometry: None, gains: [1.0; 2] }
    }

    #[doc = include_str!("rack_pitch.md")]
    ///
    /// # Errors
    /// [`DomainError`] if an angle is outside its domain.
    pub fn rack_pitch(normal_pressure_angle: Angle, rack_helix_angle: Angle) -> Result<Self, DomainError> {
        Self::new(DeviationKind::RackPitch, normal_pressure_angle, rack_helix_angle, None)
    }

    #[doc = include_str!("rack_lead.md")]
    ///
    /// # Errors
    /// [`DomainError`] if an angle or the face width is outside its domain.
    pub fn rack_lead(
        normal_pressure_angle: Angle,
        rack_helix_angle: Angle,
        face_width: Length,
    ) -> Result<Self, DomainError> {
        domain::FACE_WIDTH.check_length(face_width)?;
        Self::new(DeviationKind::RackLead, normal_pressure_angle, rack_helix_angle, Some(face_width))
    }

    #[doc = include_str!("pinion_radial.md")]
    #[must_use]
    pub const fn pinion_radial() -> Self {
        Self { kind: DeviationKind::PinionRadial, geometry: None, gains: [1.0; 2] }
    }

    #[doc = include_str!("pinion_pitch.md")]
    ///
    /// # Errors
    /// [`DomainError`] if an angle is outside its domain.
    pub fn pinion_pitch(normal_pressure_angle: Angle, pinion_helix_angle: Angle) -> Result<Self, DomainError> {
        Self::new(DeviationKind::PinionPitch, normal_pressure_angle, pinion_helix_angle, None)
    }

    #[doc = include_str!("pinion_lead.md")]
    ///
    /// # Errors
    /// [`DomainError`] if an angle is outside its domain.
    pub fn pinion_lead(normal_pressure_angle: Angle, pinion_helix_angle: Angle) -> Result<Self, DomainError> {
        Self::new(DeviationKind::PinionLead, normal_pressure_angle, pinion_helix_angle, None)
    }

    fn new(
        kind: DeviationKind,
        pressure_angle: Angle,
        helix_angle: Angle,
        face_width: Option<Length>,
    ) -> Result<Self, DomainError> {
        domain::NORMAL_PRESSURE_ANGLE.check_angle(pressure_angle)?;
        match kind.part() {
            Part::Rack => domain::RACK_HELIX_ANGLE.check_angle(helix_angle)?,
            Part::Pinion => domain::PINION_HELIX_ANGLE.check_angle(helix_angle)?,
        }
        let tan_alpha = trig::tan_of(pressure_angle);
        let cos_beta = trig::sin_cos_of(helix_angle).1;
        let width = face_width.map_or(1.0, |width| width.fm() as f64);
        let geometry = Geometry { pressure_angle, helix_angle, face_width };
        let gains = [Model::Exact, Model::Paper].map(|model| width * unit_gain(kind, model, tan_alpha, cos_beta));
        Ok(Self { kind, geometry: Some(geometry), gains })
    }

    /// The law for randomly drawn gear data in degrees and mm, which lie on no grid; outside the domain ΔCD is NaN.
    #[must_use]
    pub(crate) fn drawn(self, pressure_angle: f64, helix_angle: f64, face_width_mm: f64) -> Self {
        let is_valid = domain::NORMAL_PRESSURE_ANGLE.contains(pressure_angle)
            && domain::RACK_HELIX_ANGLE.contains(helix_angle)
            && face_width_mm >= 0.0;
        let tan_alpha = trig::tan(pressure_angle * RADIANS_PER_DEGREE);
        let cos_beta = trig::cos(helix_angle * RADIANS_PER_DEGREE);
        let width = if self.kind == DeviationKind::RackLead { face_width_mm * FM_PER_MM } else { 1.0 };
        let gain = |model| {
            if is_valid { width * unit_gain(self.kind, model, tan_alpha, cos_beta) } else { f64::NAN }
        };
        Self { gains: [gain(Model::Exact), gain(Model::Paper)], ..self }
    }

    /// The kind of error.
    #[must_use]
    pub const fn kind(self) -> DeviationKind {
        self.kind
    }

    /// The gear data behind the law; `None` if it needs none.
    #[must_use]
    pub const fn geometry(self) -> Option<Geometry> {
        self.geometry
    }

    const fn gain(self, model: Model) -> f64 {
        match model {
            Model::Exact => self.gains[0],
            Model::Paper => self.gains[1],
        }
    }

    const fn shape(self, model: Model) -> Shape {
        match (self.kind, model) {
            (DeviationKind::RackOverRoller | DeviationKind::PinionRadial, _) => Shape::Shift,
            (DeviationKind::RackPitch | DeviationKind::PinionPitch | DeviationKind::PinionLead, _) => Shape::Step,
            (DeviationKind::RackLead, Model::Exact) => Shape::Sine,
            (DeviationKind::RackLead, Model::Paper) => Shape::Tangent,
        }
    }

    /// ΔCD of an error: within 1e-12 mm + 8 ulp of the true value (see `explain precision`).
    ///
    /// # Errors
    /// [`DomainError`] if the error is outside its domain, is a length where the law needs an angle or the reverse, or if the
    /// result is beyond the largest length.
    #[inline]
    pub fn delta_cd(self, error: impl Into<DeviationValue>, model: Model) -> Result<Length, DomainError> {
        let error = error.into();
        let of_length = match (self.shape(model), error) {
            (Shape::Shift, DeviationValue::Length(length)) => Some(length),
            (Shape::Step, DeviationValue::Length(length)) => {
                Length::near(self.gain(model) * (length.fm() as f64).abs())
            }
            _ => None,
        };
        match of_length {
            Some(delta_cd) => Ok(delta_cd),
            None => self.of_turn_or_too_large(error, model),
        }
    }

    /// ΔCD of errors that are lengths; `None` if one ΔCD is too large for the grid, or if the law takes no length.
    #[cfg(feature = "batch")]
    pub(crate) fn delta_cds(self, errors: &DeviationValues, model: Model) -> Option<Vec<Length>> {
        let DeviationValues::Lengths(lengths) = errors else { return None };
        let gain = self.gain(model);
        match self.shape(model) {
            Shape::Shift => Some(lengths.clone()),
            Shape::Step => lengths.iter().map(|length| Length::near(gain * (length.fm() as f64).abs())).collect(),
            Shape::Sine | Shape::Tangent => None,
        }
    }

    /// ΔCD of a pinion's or rack's lead error, or why it has none.
    fn of_turn_or_too_large(self, error: DeviationValue, model: Model) -> Result<Length, DomainError> {
        let function = match (self.shape(model), error) {
            (Shape::Step, DeviationValue::Length(length)) => (length.fm() as f64).abs(),
            (shape, error) => of_turn(self.kind, shape, error)?,
        };
        Ok(Length::nearest(self.gain(model) * function, "ΔCD")?)
    }

    /// ΔCD in mm of a randomly drawn error in mm or degrees, which lies on no grid. Does not check the domain.
    #[must_use]
    #[inline]
    pub fn delta_cd_mm(self, error: f64, model: Model) -> f64 {
        let gain = self.gain(model);
        match self.shape(model) {
            Shape::Shift => error,
            Shape::Step => gain * error.abs(),
            Shape::Sine => gain / FM_PER_MM * trig::sin(error.abs() * RADIANS_PER_DEGREE),
            Shape::Tangent => gain / FM_PER_MM * trig::tan(error.abs() * RADIANS_PER_DEGREE),
        }
    }

    /// ∂ΔCD/∂error in mm per mm or per degree, at an error in mm or degrees. It has the sign of the error; at the kink of
    /// a magnitude at 0 it is the derivative to the right, which is positive.
    #[must_use]
    pub fn slope(self, error: f64, model: Model) -> f64 {
        let per_degree = self.gain(model) / FM_PER_MM * RADIANS_PER_DEGREE;
        let magnitude = match self.shape(model) {
            Shape::Shift => return 1.0,
            Shape::Step => self.gain(model),
            Shape::Sine => per_degree * trig::cos(error * RADIANS_PER_DEGREE),
            Shape::Tangent => {
                let cos = trig::cos(error * RADIANS_PER_DEGREE);
                per_degree / (cos * cos)
            }
        };
        if error < 0.0 { -magnitude } else { magnitude }
    }

    /// ∂(ln ΔCD)/∂x for each quantity x of the gear that the gain follows from, per mm or degree. It is the same for every
    /// size of the error.
    #[must_use]
    pub fn relative_sensitivities(self, model: Model) -> Vec<(Influence, f64)> {
        let Some(Geometry { pressure_angle, helix_angle, face_width }) = self.geometry else { return Vec::new() };
        let (sin, cos) = trig::sin_cos_of(pressure_angle);
        let helix = Influence::helix_angle_of(self.kind.part());
        if self.kind == DeviationKind::PinionLead {
            let (sin_beta, cos_beta) = trig::sin_cos_of(helix_angle);
            // cos² β_b = sin² α + cos² β cos² α
            let base = sin * sin + cos_beta * cos_beta * cos * cos;
            let by_alpha = -RADIANS_PER_DEGREE * cos_beta * cos_beta * cos / (sin * base);
            let by_beta = 0.0 - RADIANS_PER_DEGREE * sin_beta * cos_beta * cos * cos / base;
            return vec![(Influence::NormalPressureAngle, by_alpha), (helix, by_beta)];
        }
        // d(ln cot α)/dα = -1 / (sin α cos α)
        let mut all = vec![(Influence::NormalPressureAngle, -RADIANS_PER_DEGREE / (sin * cos))];
        all.extend(face_width.map(|width| (Influence::FaceWidth, 1.0 / width.mm())));
        if model == Model::Exact {
            // d(ln cos β)/dβ = -tan β
            let by_beta = RADIANS_PER_DEGREE * trig::tan_of(helix_angle);
            all.push((helix, if self.kind == DeviationKind::RackLead { by_beta } else { 0.0 - by_beta }));
        }
        all
    }

    /// ∂ΔCD/∂input at this error, where the inputs are the error and the gear data that the gain follows from.
    ///
    /// # Errors
    /// [`DomainError`] as for [`delta_cd`](Self::delta_cd).
    pub fn sensitivities(
        self,
        error: impl Into<DeviationValue>,
        model: Model,
    ) -> Result<Vec<Sensitivity>, DomainError> {
        let error = error.into();
        let delta_cd_mm = self.delta_cd(error, model)?.mm();
        let at_kink = self.shape(model) != Shape::Shift && error.is_zero();
        let own = Sensitivity {
            input: Influence::Error(self.kind),
            value: (!at_kink).then(|| self.slope(error.base(), model)),
        };
        let of_gear = self.relative_sensitivities(model).into_iter();
        let of_gear = of_gear.map(|(input, relative)| Sensitivity { input, value: Some(delta_cd_mm * relative) });
        Ok(std::iter::once(own).chain(of_gear).collect())
    }

    /// The largest error whose ΔCD does not exceed `delta_cd`; where the sign does not matter, the positive one. It lies
    /// on the grid, an angle in decimals of a degree, so that it holds when it is read back as printed.
    ///
    /// # Errors
    /// [`DomainError`] if `delta_cd` is negative where the error can only push the pinion away, or if no error reaches
    /// it.
    pub fn largest_error(self, delta_cd: Length, model: Model) -> Result<DeviationValue, DomainError> {
        /// 1e-11° in nano-arcseconds, and how many of them are just below 90°.
        const DECIMAL: i64 = 36;
        const BELOW_RIGHT_ANGLE: i64 = 9_000_000_000_000 - 1;
        let (error, farthest): (fn(i64) -> DeviationValue, i64) = match self.shape(model) {
            Shape::Shift => return Ok(DeviationValue::Length(delta_cd)),
            Shape::Step => (|fm| DeviationValue::Length(Length::from_fm(fm)), Length::LARGEST.fm()),
            Shape::Sine | Shape::Tangent => {
                (|decimals| DeviationValue::Angle(Angle::from_nas(decimals * DECIMAL)), BELOW_RIGHT_ANGLE)
            }
        };
        let what = match self.kind {
            DeviationKind::RackLead => "lead angle error below 90°",
            DeviationKind::PinionLead => "helix slope deviation up to 1 km",
            _ => "pitch error up to 1 km",
        };
        largest_within(delta_cd, what, farthest, |steps| self.delta_cd(error(steps), model)).map(error)
    }

    /// The largest helix slope deviation f_Hβ over an evaluation length whose ΔCD does not exceed `delta_cd`. It is not
    /// negative, and lies on the grid, so that it holds when it is read back as printed.
    ///
    /// # Errors
    /// [`DomainError`] if this is not the law of the rack's lead error, the length is not above 0, `delta_cd` is negative, or no
    /// f_Hβ reaches it.
    pub fn largest_slope_deviation(
        self,
        delta_cd: Length,
        length: Length,
        model: Model,
    ) -> Result<Length, DomainError> {
        /// 1 m in femtometres: up to this length every unit shows each digit of the grid.
        const FARTHEST: i64 = 1_000_000_000_000_000;
        let reached = |fm: i64| self.delta_cd(lead_slope(Length::from_fm(fm), length)?, model);
        // an error at f_Hβ = 0 comes from the law or the length
        reached(0)?;
        largest_within(delta_cd, "helix slope deviation up to 1 m", FARTHEST, reached).map(Length::from_fm)
    }

    /// The law's page in the [`CATALOGUE`](super::CATALOGUE).
    #[must_use]
    pub fn page(self) -> &'static FormulaPage {
        page_of(self.kind)
    }
}

/// The last step whose ΔCD does not exceed `delta_cd`, where ΔCD grows with the steps; an error if ΔCD of the farthest
/// step does not exceed it either.
fn largest_within(
    delta_cd: Length,
    error: &'static str,
    farthest: i64,
    reached: impl Fn(i64) -> Result<Length, DomainError>,
) -> Result<i64, DomainError> {
    domain::PUSHING_DELTA_CD.check_length(delta_cd)?;
    if delta_cd.is_zero() {
        return Ok(0);
    }
    let is_within = |steps: i64| reached(steps).is_ok_and(|reached| reached <= delta_cd);
    if is_within(farthest) {
        return Err(DomainError::NeverReached { error, delta_cd, largest: reached(farthest)? });
    }
    let (mut inside, mut outside) = (0, farthest);
    while outside - inside > 1 {
        let middle = inside + (outside - inside) / 2;
        if is_within(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    Ok(inside)
}

/// The sine or tangent to which ΔCD is proportional.
fn of_turn(kind: DeviationKind, shape: Shape, error: DeviationValue) -> Result<f64, DomainError> {
    Ok(match (shape, error) {
        (Shape::Sine, DeviationValue::Angle(angle)) => {
            domain::LEAD_ERROR.check_angle(angle)?;
            trig::sin_of(angle.abs())
        }
        (Shape::Tangent, DeviationValue::Angle(angle)) => {
            domain::LEAD_ERROR.check_angle(angle)?;
            trig::tan_of(angle.abs())
        }
        // sin(atan t) = t / √(1 + t²)
        (Shape::Sine, DeviationValue::Slope(slope)) => slope.abs() / (1.0 + slope * slope).sqrt(),
        (Shape::Tangent, DeviationValue::Slope(slope)) => slope.abs(),
        (_, error) => {
            return Err(DomainError::WrongDimension { error: kind.name(), value: error.to_string() });
        }
    })
}

/// The right-hand side of a law's equation, as its page prints it: `|Δp| cos β_r / (2 tan α_n)`.
#[must_use]
pub fn equation(kind: DeviationKind, model: Model) -> &'static str {
    page_of(kind).equation(model).trim_start_matches("ΔCD = ")
}

/// tan Δβ of a helix slope deviation f_Hβ over the evaluation length L: f_Hβ / L.
///
/// # Errors
/// [`DomainError`] if the length is not above 0.
pub fn lead_slope(helix_slope_deviation: Length, length: Length) -> Result<DeviationValue, DomainError> {
    domain::EVALUATION_LENGTH.check_length(length)?;
    Ok(DeviationValue::Slope(helix_slope_deviation.mm() / length.mm()))
}

#[cfg(test)]
mod tests;
