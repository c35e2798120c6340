//! What a spec says about its pair that a bound can rest on: all of its geometry, a statement, or nothing. Computes no
//! bound, and requires nothing.

use super::Spec;
use crate::deviation::{PinionForm, RackForm};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::judge::bound::{Basis, ContactPath, GivenGeometry, GivenPair, KnownPairs};
use crate::quantity::Length;

impl Spec {
    /// What bounds rest on: the pair's geometry if the spec gives all of it, else what it states.
    ///
    /// # Errors
    /// Diagnostics for geometry that cannot mesh, or that `[pair] contact` contradicts.
    pub fn basis(&self) -> Result<Basis, Diagnostics> {
        let rolls = self.support.roll.as_ref().is_some_and(|roll| roll.value != "fixed");
        let normal_module_mm = self.pair.normal_module.as_ref().map(|module| module.value.mm());
        let geometry = match (self.given_pair()?, &self.pair.both_flanks) {
            (Some(given), _) => GivenGeometry::Known(KnownPairs::new(given)),
            (None, Some(_)) => GivenGeometry::BothFlanks,
            (None, None) => GivenGeometry::Unknown,
        };
        Ok(Basis { geometry, known_teeth: None, rolls, normal_module_mm })
    }

    /// The keys that the pair's geometry still lacks.
    #[must_use]
    pub fn missing_geometry(&self) -> Vec<&'static str> {
        let (pair, rack, pinion) = (&self.pair, &self.rack, &self.pinion);
        let rolls = self.support.roll.as_ref().is_some_and(|roll| roll.value != "fixed");
        let keys = [
            ("pair.normal_module", pair.normal_module.is_some()),
            ("pair.normal_pressure_angle", pair.normal_pressure_angle.is_some()),
            ("rack.face_width", rack.face_width.is_some()),
            ("rack.addendum", rack.addendum.is_some()),
            ("pinion.teeth", pinion.teeth.is_some()),
            ("pinion.tip_diameter", pinion.tip_diameter.is_some()),
            ("pinion.face_width", pinion.face_width.is_some()),
            ("support.roll_axis_depth", !rolls || self.support.roll_axis_depth.is_some()),
        ];
        keys.into_iter().filter(|(_, is_given)| !is_given).map(|(key, _)| key).collect()
    }

    /// The pair with all that is given of it but its errors; `None` if a key is missing.
    ///
    /// # Errors
    /// Diagnostics for geometry that cannot mesh, or that `[pair] contact` contradicts.
    pub fn given_pair(&self) -> Result<Option<GivenPair>, Diagnostics> {
        if !self.missing_geometry().is_empty() {
            return Ok(None);
        }
        let pair = self.pair("the bound")?;
        let path = ContactPath::nominal(&pair);
        if let Some(stated) = &self.pair.both_flanks
            && !(path.has_both_flanks_of_a_rack_tooth() && path.has_both_flanks_of_a_pinion_tooth())
        {
            let message = format!(
                "`contact` states that a tooth always carries with both flanks, and the geometry says otherwise: its path of \
                 contact is {:.3} pitches long and {:.3} off",
                path.ratio, path.offset
            );
            let help = "leave `contact` out: the geometry is given";
            return Err(Diagnostic::error(Code::BadGeometry, message)
                .help(help)
                .at(&self.source, stated.clone(), "")
                .into());
        }
        let support = self.support()?;
        Ok(Some(GivenPair { pair, rack_form: self.rack_form(), pinion_form: self.pinion_form(), support }))
    }

    /// Form of the rack's flanks.
    pub(super) fn rack_form(&self) -> RackForm {
        let relief = self.rack.tip_relief.as_ref().map(|relief| &relief.value);
        RackForm {
            crowning_mm: self.rack.crowning.as_ref().map_or(0.0, |crowning| crowning.value.mm()),
            tip_relief_mm: relief.map_or(0.0, |relief| relief.amount.mm()),
            tip_relief_start_mm: relief.map_or(0.0, |relief| relief.start.mm()),
        }
    }

    /// Form of the pinion's flanks.
    pub(super) fn pinion_form(&self) -> PinionForm {
        let or_zero = |length: Option<Length>| length.map_or(0.0, Length::mm);
        PinionForm {
            crowning_mm: or_zero(self.pinion.crowning.as_ref().map(|crowning| crowning.value)),
            profile_slope_mm: or_zero(self.pinion.profile_slope.as_ref().map(|slope| slope.value)),
        }
    }
}
