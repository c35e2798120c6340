//! The quantities that the formulas take, and the values that each may have. The formulas check these bounds, the JSON
//! Schema and the command line show them; each bound stands here only.

use std::ops::Bound;

use super::femtometres;
use crate::quantity::{Domain, DomainError, Length};

/// Normal pressure angle α_n: above 0° and at most 45°.
pub const NORMAL_PRESSURE_ANGLE: Domain =
    Domain { name: "normal pressure angle", symbol: "α_n", lower: Bound::Excluded(0), upper: Bound::Included(45) };

/// Helix angle of the rack β_r: right hand positive.
pub const RACK_HELIX_ANGLE: Domain = helix_angle("helix angle of the rack", "β_r");

/// Helix angle of the pinion β_p: right hand positive.
pub const PINION_HELIX_ANGLE: Domain = helix_angle("helix angle of the pinion", "β_p");

/// Face width of the rack k.
pub const FACE_WIDTH: Domain = Domain::positive("face width of the rack", "k");

/// Normal module m_n.
pub const NORMAL_MODULE: Domain = Domain::positive("normal module", "m_n");

/// Transverse module of the pinion m_t.
pub const TRANSVERSE_MODULE: Domain = Domain::positive("transverse module of the pinion", "m_t");

/// Magnitude of the shaft angle Σ.
pub const SHAFT_ANGLE: Domain =
    Domain { name: "shaft angle", symbol: "Σ", lower: Bound::Included(0), upper: Bound::Excluded(180) };

/// Tooth thickness of the rack s_n, measured in the normal plane at the reference plane.
pub const TOOTH_THICKNESS: Domain = Domain::positive("tooth thickness", "s_n");

/// Diameter of a measuring pin, roller or ball.
pub const PIN_DIAMETER: Domain = Domain::positive("pin diameter", "d_p");

/// Distance K from the measuring datum to the rack's reference plane.
pub const DATUM: Domain = Domain {
    name: "distance from the datum to the reference plane",
    symbol: "K",
    lower: Bound::Included(0),
    upper: Bound::Unbounded,
};

/// Lead angle error of the rack Δβ.
pub const LEAD_ERROR: Domain =
    Domain { name: "lead angle error", symbol: "Δβ", lower: Bound::Excluded(-90), upper: Bound::Excluded(90) };

/// Evaluation length L of a helix slope deviation f_Hβ.
pub const EVALUATION_LENGTH: Domain = Domain::positive("evaluation length", "L");

/// Diameter d_M of the circle on which the pinion's pitch was measured.
pub const MEASUREMENT_CIRCLE: Domain = Domain::positive("diameter of the measurement circle", "d_M");

/// ΔCD of an error that can only push the pinion away.
pub const PUSHING_DELTA_CD: Domain = Domain {
    name: "centre distance deviation of a pitch or lead error",
    symbol: "ΔCD",
    lower: Bound::Included(0),
    upper: Bound::Unbounded,
};

const fn helix_angle(name: &'static str, symbol: &'static str) -> Domain {
    Domain { name, symbol, lower: Bound::Excluded(-90), upper: Bound::Excluded(90) }
}

/// The normal pitch π m_n, in fm.
pub(crate) fn normal_pitch_fm(normal_module: Length) -> Result<f64, DomainError> {
    NORMAL_MODULE.check_length(normal_module)?;
    Ok(std::f64::consts::PI * femtometres(normal_module))
}

/// A tooth thickness s_n that leaves a space in the normal pitch.
pub(crate) fn checked_thickness(thickness: Length, normal_pitch_fm: f64) -> Result<Length, DomainError> {
    TOOTH_THICKNESS.check_length(thickness)?;
    if femtometres(thickness) >= normal_pitch_fm {
        let pitch = Length::nearest(normal_pitch_fm, "the normal pitch")?;
        return Err(DomainError::NoSpace { thickness, pitch });
    }
    Ok(thickness)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn helix_and_lead_angles_are_less_than_a_right_angle_either_way() {
        for domain in [RACK_HELIX_ANGLE, PINION_HELIX_ANGLE, LEAD_ERROR] {
            for (degrees, inside) in [("-89.9", true), ("0", true), ("89.9", true), ("-90", false), ("90", false)] {
                assert_eq!(domain.check_angle(degrees.parse().unwrap()).is_ok(), inside, "{} {degrees}", domain.symbol);
            }
        }
    }
}
