//! Flank form ground on purpose: crowning, tip relief, profile slope. Part of the flanks that the mesh takes.
//!
//! Every amount is material removed (positive), measured along the rack flank's normal at the point of contact:
//! where a rack point and a pinion point would touch with all forms zero, they are apart by the sum of both
//! parts' amounts there.

use super::DeviationError;
use super::error::{DeviationQuantity, length};

/// Form of the rack's flanks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RackForm {
    /// Lead crowning c: c (2y/k)² is removed at the distance y from mid-width, mm.
    pub crowning_mm: f64,
    /// Tip relief t: t (h − h_0)/(h_a − h_0) is removed at the height h > h_0 on the flank, mm.
    pub tip_relief_mm: f64,
    /// Height h_0 above the reference plane at which the tip relief starts, mm, below the addendum h_a.
    pub tip_relief_start_mm: f64,
}

/// Form of the pinion's flanks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PinionForm {
    /// Lead crowning c: c (2w/b)² is removed at the axial distance w from mid-width, mm.
    pub crowning_mm: f64,
    /// Profile slope f: f (τ − τ_0)/(τ_a − τ_0) is removed at the roll angle τ between the involute's start τ_0
    /// and the tip τ_a, mm.
    pub profile_slope_mm: f64,
}

impl RackForm {
    /// Whether the flanks are planes.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.crowning_mm == 0.0 && self.tip_relief_mm == 0.0
    }

    pub(super) fn checked(self, addendum_mm: f64) -> Result<Self, DeviationError> {
        length(DeviationQuantity::Form, self.tip_relief_start_mm)?;
        removed(self.crowning_mm)?;
        removed(self.tip_relief_mm)?;
        if self.tip_relief_mm != 0.0 && self.tip_relief_start_mm >= addendum_mm {
            return Err(DeviationError::ReliefStart { start_mm: self.tip_relief_start_mm, addendum_mm });
        }
        Ok(self)
    }
}

impl PinionForm {
    /// Whether the flanks are involute helicoids.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.crowning_mm == 0.0 && self.profile_slope_mm == 0.0
    }

    pub(super) fn checked(self) -> Result<Self, DeviationError> {
        length(DeviationQuantity::Form, self.profile_slope_mm)?;
        removed(self.crowning_mm)?;
        Ok(self)
    }
}

/// Checks an amount of material: a negative one would make the flank concave, and contact there is not unique.
fn removed(value_mm: f64) -> Result<(), DeviationError> {
    length(DeviationQuantity::Form, value_mm)?;
    if value_mm < 0.0 { Err(DeviationError::NegativeForm { value_mm }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relief_starts_below_the_tip() {
        let relief =
            |tip_relief_mm, tip_relief_start_mm| RackForm { tip_relief_mm, tip_relief_start_mm, crowning_mm: 0.0 };
        assert!(relief(0.01, 1.9_f64.next_down()).checked(1.9).is_ok());
        let start = Err(DeviationError::ReliefStart { start_mm: 1.9, addendum_mm: 1.9 });
        assert_eq!(relief(0.01, 1.9).checked(1.9), start);
        // without relief the start does not count, also on a rack that ends below its reference plane
        assert_eq!(RackForm::default().checked(-0.5), Ok(RackForm::default()));
        assert!(relief(0.0, 5.0).checked(1.9).is_ok());
    }

    #[test]
    fn only_material_removed_is_a_form() {
        let negative = Err(DeviationError::NegativeForm { value_mm: -0.01 });
        assert_eq!(RackForm { crowning_mm: -0.01, ..RackForm::default() }.checked(1.9), negative);
        assert_eq!(RackForm { tip_relief_mm: -0.01, ..RackForm::default() }.checked(1.9), negative);
        assert!(PinionForm { crowning_mm: -0.01, ..PinionForm::default() }.checked().is_err());
        let slope = PinionForm { profile_slope_mm: -0.01, ..PinionForm::default() };
        assert_eq!(slope.checked(), Ok(slope));
        assert!(!slope.is_plain() && PinionForm::default().is_plain());
        let crowned = RackForm { crowning_mm: 0.01, ..RackForm::default() };
        assert!(!crowned.is_plain() && RackForm::default().is_plain());
    }
}
