#![doc = include_str!("class.md")]
//!
//! With this the spec resolves `{ class = 7 }` to an error, and `class` prints the ΔCD that a grade allows. It takes
//! permissible values ([`Permissible`]) and prepared formulas; it must not choose a standard or a rack's diameter.

use crate::deviation::{DeviationKind, DeviationValue, Part};
use crate::formula::law::lead_slope;
use crate::formula::{Law, Model, PartDeviation};
use crate::quantity::{Angle, DomainError, Length, LengthUnit};
use crate::standard::{Deviation, Permissible, Standard, StandardError, Wheel};
use crate::trig;

/// Which diameter stands for a rack in a standard for toothed wheels. There is no default.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum RackDiameter {
    /// The reference diameter of the mating pinion.
    Pinion,
    /// The diameter of a wheel whose circumference is the toothed length: L/π.
    Developed,
    /// A diameter that is given.
    Given(Length),
}

named! {
    /// Where a diameter comes from.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    #[non_exhaustive]
    pub enum DiameterSource {
        /// The pinion's own reference diameter m_n z / cos β.
        Own = "reference diameter",
        /// For a rack, the reference diameter of the mating pinion.
        MatingPinion = "reference diameter of the mating pinion",
        /// For a rack, L/π.
        Developed = "developed, L/π",
        /// Given as a number.
        Given = "given",
    }
}

/// An error that is given as a class, with the permissible value.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorClass {
    /// The kind of error.
    pub kind: DeviationKind,
    /// The permissible deviation.
    pub permissible: Permissible,
    /// The diameter that the standard was entered with, and where it comes from; `None` if it needs none.
    pub diameter: Option<(Length, DiameterSource)>,
    /// The permissible error: the deviation, for a lead error of the rack its angle over the face width, for a runout half
    /// of it.
    pub value: DeviationValue,
    /// For a pitch, the total cumulative deviation F_p that the same grade permits, if the standard gives it.
    pub total: Option<Permissible>,
}

impl ErrorClass {
    /// The permissible value in one line: `f_pt = 14 µm by ISO 1328-1:1995, grade 7, d = 14.675 mm (given)`.
    #[must_use]
    pub fn in_words(&self) -> String {
        let Permissible { standard, grade, .. } = self.permissible;
        let mut text = format!(
            "{}: {} = {} µm by {standard}, grade {grade}",
            self.kind,
            self.permissible.symbol(),
            self.permissible.value_um(),
        );
        if let Some((diameter, source)) = &self.diameter {
            text.push_str(&format!(", d = {:.3} mm ({})", diameter.mm(), source.name()));
        }
        if let Some(total) = &self.total {
            text.push_str(&format!("; {} = {} µm of either flank side caps it", total.symbol(), total.value_um()));
        }
        if let (DeviationKind::PinionRadial, DeviationValue::Length(amplitude)) = (self.kind, self.value) {
            text.push_str(&format!(
                "; peak to peak, an eccentricity of ±{} µm",
                amplitude.in_unit(LengthUnit::Micrometre)
            ));
        }
        text
    }

    /// The tolerance of an error with this law.
    #[must_use]
    pub fn tolerance(&self, law: Law) -> PartDeviation {
        within_total(PartDeviation::within(law, self.value), self.total.as_ref())
    }
}

/// The deviation that limits a kind of error; `None` for an over-roller measure, which is a size that no standard here
/// limits.
#[must_use]
pub const fn deviation_of(kind: DeviationKind) -> Option<Deviation> {
    match kind {
        DeviationKind::RackPitch | DeviationKind::PinionPitch => Some(Deviation::SinglePitch),
        DeviationKind::RackLead | DeviationKind::PinionLead => Some(Deviation::HelixSlope),
        DeviationKind::PinionRadial => Some(Deviation::Runout),
        DeviationKind::RackOverRoller => None,
    }
}

/// Why an over-roller measure has no class, and what to write.
pub const NO_OVER_ROLLER_CLASS: &str =
    "an over-roller measure is a size of the rack, and these standards limit none: give its tolerance by value";

/// The F_p of the same grade and wheel, which caps a pitch tolerance; `None` where the standard gives none, or for
/// another kind of error.
#[must_use]
pub fn total_of(kind: DeviationKind, standard: Standard, grade: u8, wheel: &Wheel) -> Option<Permissible> {
    (deviation_of(kind) == Some(Deviation::SinglePitch))
        .then(|| standard.permissible(Deviation::TotalPitch, grade, wheel).ok())
        .flatten()
}

fn within_total(tolerance: PartDeviation, total: Option<&Permissible>) -> PartDeviation {
    total.map_or(tolerance, |total| tolerance.within_total(total.length()))
}

/// The reference diameter d = m_n z / cos β.
///
/// # Errors
/// [`DomainError`] if an input is outside its domain, or the result is beyond the largest length.
pub fn reference_diameter(normal_module: Length, teeth: u32, helix_angle: Angle) -> Result<Length, DomainError> {
    crate::formula::domain::NORMAL_MODULE.check_length(normal_module)?;
    crate::formula::domain::PINION_HELIX_ANGLE.check_angle(helix_angle)?;
    let diameter_mm = normal_module.mm() * f64::from(teeth) / trig::sin_cos_of(helix_angle).1;
    Ok(Length::nearest(diameter_mm * 1e12, "the reference diameter d")?)
}

/// The reference diameter of a wheel, with β = 0 where that is not given; `None` if it is not known.
///
/// # Errors
/// As [`reference_diameter`].
pub fn own_diameter(wheel: &Wheel) -> Result<Option<Length>, DomainError> {
    let (Some(module), Some(teeth)) = (wheel.normal_module, wheel.teeth) else { return Ok(None) };
    reference_diameter(module, teeth, wheel.helix_angle.unwrap_or(Angle::ZERO)).map(Some)
}

/// The developed diameter L/π of a rack with the toothed length L.
///
/// # Errors
/// [`DomainError`] if the result is beyond the largest length.
pub fn developed_diameter(toothed_length: Length) -> Result<Length, DomainError> {
    Ok(Length::nearest(toothed_length.mm() / std::f64::consts::PI * 1e12, "the developed diameter L/π")?)
}

/// What the ΔCD of a deviation needs besides the deviation.
#[derive(Debug, Clone)]
pub struct Meshing {
    /// The part that deviates.
    pub part: Part,
    /// α_n
    pub pressure_angle: Option<Angle>,
    /// β of the part; 0 if not given
    pub helix_angle: Option<Angle>,
    /// b, for the deviations of the rack's helix
    pub face_width: Option<Length>,
}

impl Meshing {
    /// The law of a kind of error.
    fn law(&self, kind: DeviationKind) -> Result<Law, NoEffect> {
        let helix_angle = self.helix_angle.unwrap_or(Angle::ZERO);
        let pressure_angle = || self.pressure_angle.ok_or(NoEffect::Missing("normal pressure angle α_n"));
        Ok(match kind {
            DeviationKind::RackOverRoller => Law::rack_over_roller(),
            DeviationKind::PinionRadial => Law::pinion_radial(),
            DeviationKind::RackPitch => Law::rack_pitch(pressure_angle()?, helix_angle)?,
            DeviationKind::PinionPitch => Law::pinion_pitch(pressure_angle()?, helix_angle)?,
            DeviationKind::RackLead => {
                let face_width = self.face_width()?;
                Law::rack_lead(pressure_angle()?, helix_angle, face_width)?
            }
            DeviationKind::PinionLead => Law::pinion_lead(pressure_angle()?, helix_angle)?,
        })
    }

    fn face_width(&self) -> Result<Length, NoEffect> {
        self.face_width.ok_or(NoEffect::Missing("face width b"))
    }
}

/// A part with its size, and what its ΔCD needs.
#[derive(Debug, Clone)]
pub struct SizedPart {
    /// Its size.
    pub wheel: Wheel,
    /// Where its diameter comes from, if it is known.
    pub diameter_source: Option<DiameterSource>,
    /// What its ΔCD needs.
    pub meshing: Meshing,
}

impl SizedPart {
    /// Its diameter and where that comes from: `d = 14.6750 mm (given)`.
    #[must_use]
    pub fn diameter_in_words(&self) -> Option<String> {
        let (diameter, source) = (self.wheel.diameter?, self.diameter_source?);
        Some(format!("d = {:.4} mm ({})", diameter.mm(), source.name()))
    }

    /// The tolerance that a grade of a standard or its companion is of a kind of error, on this part.
    ///
    /// # Errors
    /// [`NoEffect`] if no deviation limits it, the standard has no value, or something that the law needs is missing or outside
    /// its domain.
    pub fn tolerance(&self, kind: DeviationKind, standard: Standard, grade: u8) -> Result<PartDeviation, NoEffect> {
        let deviation = deviation_of(kind).ok_or(NoEffect::NoFormula)?;
        let limiting = standard.that_limits(deviation);
        let limiting = limiting.ok_or(StandardError::NoSuchDeviation { standard, deviation })?;
        let permissible = limiting.permissible(deviation, grade, &self.wheel)?;
        tolerance(kind, &permissible, total_of(kind, limiting, grade, &self.wheel).as_ref(), &self.meshing)
    }

    /// Of a pinion whose diameter is given: why its module, teeth and helix angle contradict that by more than any measuring
    /// circle.
    ///
    /// # Errors
    /// As [`own_diameter`].
    pub fn doubted_diameter(&self) -> Result<Option<String>, DomainError> {
        let Wheel { normal_module, teeth, helix_angle, diameter, .. } = &self.wheel;
        let own = own_diameter(&self.wheel)?;
        let ((Some(given), Some(own)), (Some(module), Some(z), Some(helix))) =
            ((diameter, own), (normal_module, teeth, helix_angle))
        else {
            return Ok(None);
        };
        let is_near = (given.mm() - own.mm()).abs() <= 2.0 * module.mm();
        Ok((self.meshing.part == Part::Pinion && !is_near).then(|| {
            let own_mm = own.mm();
            format!(
                "the diameter is {given}, and m_n z / cos β of m_n = {module}, z = {z}, β = {helix} is {own_mm:.3} mm"
            )
        }))
    }
}

/// How ΔCD follows from a deviation: by the formula of an error of that size; by the formula as a bound, with the whole
/// deviation in the worst place; or as the deviation's own peak-to-peak value. `None` if no formula gives it.
#[must_use]
pub const fn effect(deviation: Deviation) -> Option<&'static str> {
    match deviation {
        Deviation::SinglePitch | Deviation::HelixSlope => Some("formula"),
        Deviation::SectorPitch | Deviation::TotalPitch | Deviation::TotalHelix => Some("bound"),
        Deviation::Runout | Deviation::RadialComposite | Deviation::ToothRadialComposite => Some("peak to peak"),
        Deviation::ProfileForm | Deviation::ProfileSlope | Deviation::TotalProfile | Deviation::HelixForm => None,
    }
}

/// Why a deviation's ΔCD is not known.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoEffect {
    /// No formula takes this deviation.
    #[error("no formula takes it")]
    NoFormula,
    /// Something that the formula needs is not given.
    #[error("it needs the {0}")]
    Missing(&'static str),
    /// A value is outside its domain.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// The standard has no value for this deviation.
    #[error(transparent)]
    Standard(#[from] StandardError),
}

impl NoEffect {
    /// Whether another grade may have an effect.
    #[must_use]
    pub const fn is_of_grade(&self) -> bool {
        matches!(self, Self::Standard(StandardError::Grade { .. } | StandardError::Unconfirmed { .. }))
    }
}

/// The ΔCD that a deviation of `amount` allows, by the formulas; see the [module](self).
///
/// # Errors
/// [`NoEffect`] if there is no formula, or something that it needs is missing or outside its domain.
pub fn delta_cd(deviation: Deviation, amount: Length, meshing: &Meshing, model: Model) -> Result<Length, NoEffect> {
    match deviation {
        Deviation::Runout | Deviation::RadialComposite | Deviation::ToothRadialComposite => Ok(amount),
        Deviation::SinglePitch => Ok(meshing.law(DeviationKind::RackPitch)?.delta_cd(amount, model)?),
        // each flank side deviates by itself
        Deviation::SectorPitch | Deviation::TotalPitch => {
            let of_one_side = meshing.law(DeviationKind::RackPitch)?.delta_cd(amount, model)?;
            Ok(of_one_side + of_one_side)
        }
        Deviation::HelixSlope | Deviation::TotalHelix if meshing.part == Part::Pinion => {
            Ok(meshing.law(DeviationKind::PinionLead)?.delta_cd(amount, model)?)
        }
        Deviation::HelixSlope | Deviation::TotalHelix => {
            let face_width = meshing.face_width()?;
            Ok(meshing.law(DeviationKind::RackLead)?.delta_cd(lead_slope(amount, face_width)?, model)?)
        }
        Deviation::ProfileForm | Deviation::ProfileSlope | Deviation::TotalProfile | Deviation::HelixForm => {
            Err(NoEffect::NoFormula)
        }
    }
}

/// The tolerance of a kind of error by a permissible deviation: on each tooth any value from minus to plus it, for a pitch
/// with F_p as the limit of the sum.
///
/// # Errors
/// [`NoEffect`] if something that the law needs is missing or outside its domain.
pub fn tolerance(
    kind: DeviationKind,
    permissible: &Permissible,
    total: Option<&Permissible>,
    meshing: &Meshing,
) -> Result<PartDeviation, NoEffect> {
    let value = error_value(kind, permissible, meshing.face_width);
    Ok(within_total(PartDeviation::within(meshing.law(kind)?, value?), total))
}

/// The error that a permissible deviation stands for.
///
/// # Errors
/// [`DomainError`] if the face width is not above 0.
pub fn error_value(
    kind: DeviationKind,
    permissible: &Permissible,
    face_width: Option<Length>,
) -> Result<DeviationValue, DomainError> {
    match (kind, face_width) {
        (DeviationKind::RackLead, Some(width)) => lead_slope(permissible.length(), width),
        // peak to peak of an eccentricity
        (DeviationKind::PinionRadial, _) => Ok(DeviationValue::Length(Length::from_fm(permissible.length().fm() / 2))),
        _ => Ok(DeviationValue::Length(permissible.length())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(text: &str) -> Length {
        text.parse().unwrap()
    }

    fn of_part_alone(part: Part) -> Meshing {
        Meshing { part, pressure_angle: None, helix_angle: None, face_width: None }
    }

    #[test]
    fn diameters() {
        let d = |m, z, beta: &str| reference_diameter(length(m), z, beta.parse().unwrap()).unwrap();
        assert_eq!(d("2.5", 20, "0"), length("50"));
        // on the limit of a range, exactly
        assert_eq!(d("1", 10, "60"), length("20"));
        assert_eq!(format!("{:.3}", d("1.9", 7, "25").mm()), "14.675");
        assert_eq!(format!("{:.6}", developed_diameter(length("100")).unwrap().mm()), "31.830989");
    }

    /// F_r = 43 µm, f_pt = 18 µm and F_p = 54 µm come from the printed report of a commercial program.
    #[test]
    fn tolerances_of_a_class() {
        let wheel = Wheel {
            normal_module: Some(length("21")),
            diameter: Some(length("378")),
            face_width: Some(length("550")),
            teeth: Some(18),
            helix_angle: None,
        };
        let meshing = Meshing { pressure_angle: Some("20".parse().unwrap()), ..of_part_alone(Part::Pinion) };
        let of = |kind, standard: Standard| {
            let permissible = standard.permissible(deviation_of(kind).unwrap(), 6, &wheel).unwrap();
            let total = total_of(kind, standard, 6, &wheel);
            tolerance(kind, &permissible, total.as_ref(), &meshing).unwrap()
        };
        let radial = of(DeviationKind::PinionRadial, Standard::Iso1328Part2Of1997);
        assert_eq!((radial.value(), radial.total()), (DeviationValue::Length(length("21.5 um")), None));
        let pitch = of(DeviationKind::PinionPitch, Standard::Iso1328Part1Of1995);
        assert_eq!((pitch.value(), pitch.total()), (DeviationValue::Length(length("18 um")), Some(length("54 um"))));
        assert_eq!(deviation_of(DeviationKind::RackOverRoller), None);
    }

    #[test]
    fn each_deviation_has_its_effect() {
        let meshing = |part| Meshing {
            pressure_angle: Some("45".parse().unwrap()),
            face_width: Some(length("20")),
            ..of_part_alone(part)
        };
        let of_part = |part, deviation| delta_cd(deviation, length("0.02"), &meshing(part), Model::Exact);
        let of_rack = |deviation| of_part(Part::Rack, deviation);
        // 1/(2 tan 45°) = 1/2
        assert_eq!(of_rack(Deviation::SinglePitch).unwrap(), length("0.01"));
        for deviation in [
            Deviation::SectorPitch,
            Deviation::TotalPitch,
            Deviation::Runout,
            Deviation::RadialComposite,
            Deviation::ToothRadialComposite,
        ] {
            assert_eq!(of_rack(deviation).unwrap(), length("0.02"));
        }
        // b sin(atan(f/b)) / 2
        for deviation in [Deviation::HelixSlope, Deviation::TotalHelix] {
            assert!((of_rack(deviation).unwrap().mm() - 0.01).abs() < 1e-8);
            // 1/(2 sin 45°) = 1/√2
            let of_pinion = of_part(Part::Pinion, deviation).unwrap().mm();
            assert!((of_pinion - 0.02 / 2.0_f64.sqrt()).abs() < 1e-12, "{of_pinion}");
        }
        for deviation in Deviation::ALL {
            assert_eq!(of_rack(deviation).is_ok(), effect(deviation).is_some(), "{deviation}");
        }
        let bare = of_part_alone(Part::Rack);
        assert_eq!(
            delta_cd(Deviation::SinglePitch, length("0.02"), &bare, Model::Exact).unwrap_err().to_string(),
            "it needs the normal pressure angle α_n"
        );
    }
}
