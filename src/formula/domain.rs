//! The quantities that the formulas take, and the values that each may have. Checked by the formulas, shown by the JSON
//! Schema and the command line; each bound stands here only.

use crate::quantity::{Bound, Domain, DomainError, Length, Rational};

/// Normal pressure angle α_n: above 0° and at most 45°.
pub const NORMAL_PRESSURE_ANGLE: Domain =
    Domain { name: "normal pressure angle", symbol: "α_n", lower: Bound::Exclusive(0), upper: Bound::Inclusive(45) };

/// Helix angle of the rack β_r: right hand positive.
pub const RACK_HELIX_ANGLE: Domain = helix_angle("helix angle of the rack", "β_r");

/// Helix angle of the pinion β_p: right hand positive.
pub const PINION_HELIX_ANGLE: Domain = helix_angle("helix angle of the pinion", "β_p");

/// Face width of the rack k.
pub const FACE_WIDTH: Domain = Domain::positive("face width of the rack", "k");

/// Normal module m_n.
pub const NORMAL_MODULE: Domain = Domain::positive("normal module", "m_n");

/// Tooth thickness of the rack s_n, measured in the normal plane at the reference plane.
pub const TOOTH_THICKNESS: Domain = Domain::positive("tooth thickness", "s_n");

/// Diameter of a measuring pin, roller or ball.
pub const PIN_DIAMETER: Domain = Domain::positive("pin diameter", "d_p");

/// Distance K from the measuring datum to the rack's reference plane.
pub const DATUM: Domain = Domain {
    name: "distance from the datum to the reference plane",
    symbol: "K",
    lower: Bound::Inclusive(0),
    upper: Bound::None,
};

/// Lead angle error of the rack Δβ.
pub const LEAD_ERROR: Domain =
    Domain { name: "lead angle error", symbol: "Δβ", lower: Bound::Exclusive(-90), upper: Bound::Exclusive(90) };

/// Evaluation length L of a helix slope deviation f_Hβ.
pub const EVALUATION_LENGTH: Domain = Domain::positive("evaluation length", "L");

/// ΔCD of an error that can only push the pinion away.
pub const PUSHING_DELTA_CD: Domain = Domain {
    name: "centre distance deviation of a pitch or lead error",
    symbol: "ΔCD",
    lower: Bound::Inclusive(0),
    upper: Bound::None,
};

const fn helix_angle(name: &'static str, symbol: &'static str) -> Domain {
    Domain { name, symbol, lower: Bound::Exclusive(-90), upper: Bound::Exclusive(90) }
}

/// The normal pitch π m_n in mm. It may be beyond the range of `f64` where the formula's result is not.
pub(crate) fn normal_pitch(normal_module: &Length) -> Result<Rational, DomainError> {
    NORMAL_MODULE.check_length(normal_module)?;
    Ok(normal_module.exact_mm() * Rational::pi())
}

/// The tooth thickness s_n in mm, or π m_n / 2 where none is given; it must leave a space in the pitch.
pub(crate) fn tooth_thickness(normal_module: &Length, given: Option<&Length>) -> Result<Rational, DomainError> {
    let pitch = normal_pitch(normal_module)?;
    let Some(thickness) = given else {
        return Ok(&pitch / &Rational::integer(2));
    };
    TOOTH_THICKNESS.check_length(thickness)?;
    if *thickness.exact_mm() >= pitch {
        let pitch = Length::from_exact_mm(pitch, "the normal pitch")?;
        return Err(DomainError::NoSpace { thickness: thickness.clone(), pitch });
    }
    Ok(thickness.exact_mm().clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn helix_and_lead_angles_are_less_than_a_right_angle_either_way() {
        for domain in [RACK_HELIX_ANGLE, PINION_HELIX_ANGLE, LEAD_ERROR] {
            for (degrees, inside) in [("-89.9", true), ("0", true), ("89.9", true), ("-90", false), ("90", false)] {
                assert_eq!(
                    domain.check_angle(&degrees.parse().unwrap()).is_ok(),
                    inside,
                    "{} {degrees}",
                    domain.symbol
                );
            }
        }
    }
}
