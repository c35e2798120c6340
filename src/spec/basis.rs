//! What a spec says about its pair for a bound: the whole geometry, a statement, or nothing. Computes no bound and requires
//! no key.

use std::f64::consts::FRAC_PI_2;

use super::{Spec, keys, said_of};
use crate::deviation::{DeviationKind, Part, PinionForm, RackForm};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::gear::{thickness_offset_mm, undercut_limit};
use crate::judge::bound::{Basis, ContactPath, GivenGeometry, GivenPair, KnownPairs, OwnCurve};
use crate::quantity::Length;
use crate::trig;
use crate::uncertainty::Influence;

/// The keys of a pair's geometry, without the support of its rack.
pub const GEOMETRY_KEYS: [&str; 7] = [
    keys::PAIR_NORMAL_MODULE.any.path,
    keys::PAIR_NORMAL_PRESSURE_ANGLE.any.path,
    keys::RACK_FACE_WIDTH.any.path,
    keys::RACK_ADDENDUM.any.path,
    keys::PINION_TEETH.any.path,
    keys::PINION_TIP_DIAMETER.any.path,
    keys::PINION_FACE_WIDTH.any.path,
];

impl Spec {
    /// What bounds rest on: the pair's geometry if the spec gives all of it, else what it states.
    ///
    /// # Errors
    /// Diagnostics for geometry that cannot mesh, or that `[pair] contact` contradicts.
    pub fn basis(&self) -> Result<Basis, Diagnostics> {
        // first report a part that is given in both ways
        self.refuse_both_ways(&self.kinds())?;
        if self.has_deviations() && self.known_teeth.is_none() {
            let message = "the spec knows teeth one by one: their mesh has to be solved before anything is judged";
            return Err(Diagnostic::error(Code::NoMesh, message).help("see `Spec::with_known_teeth`").into());
        }
        Ok(Basis { known_teeth: self.known_teeth, ..self.pair_basis()? })
    }

    /// The basis of the nominal pair, without its deviated teeth: for tolerances.
    ///
    /// # Errors
    /// Diagnostics for geometry that cannot mesh, or that `[pair] contact` contradicts.
    pub fn pair_basis(&self) -> Result<Basis, Diagnostics> {
        let mm = |key| self.get(key).map(Length::mm);
        let (normal_module_mm, addendum_mm) = (mm(keys::PAIR_NORMAL_MODULE), mm(keys::RACK_ADDENDUM));
        let geometry = match (self.given_pair()?, self.place(keys::PAIR_CONTACT)) {
            (Some(given), _) => GivenGeometry::Known(KnownPairs::new(given)),
            (None, Some(_)) => GivenGeometry::BothFlanks,
            (None, None) => GivenGeometry::Unknown,
        };
        let own_curve = self.own_curve();
        Ok(Basis {
            geometry,
            own_curve,
            known_teeth: None,
            all_placed: None,
            rolls: self.rolls(),
            normal_module_mm,
            addendum_mm,
        })
    }

    /// The curve of the spec's pair without errors, as far as single keys tell.
    fn own_curve(&self) -> OwnCurve {
        let has_form = !self.rack_form().is_plain() || !self.pinion_form().is_plain();
        // without the pair, only the nominal measure over a roller uses the thickness of the rack
        let thickness = [Influence::ToothThickness, Influence::NormalModule, Influence::NormalPressureAngle];
        let pinion_is_thicker = !self.or_zero(keys::PINION_TOOTH_THICKNESS_DEVIATION).is_zero();
        let is_thicker = pinion_is_thicker || self.get(keys::RACK_TOOTH_THICKNESS).is_some();
        let is_followed = self.over_pin().is_some() && !pinion_is_thicker;
        let is_uncertain =
            is_thicker && !is_followed && self.uncertainties.iter().any(|(source, _)| thickness.contains(source));
        if has_form || is_uncertain || self.is_undercut().unwrap_or(false) {
            return OwnCurve::Unknown;
        }
        self.thickness_offset_mm().map_or(OwnCurve::Unknown, OwnCurve::At)
    }

    /// ΔCD of teeth that are thicker than standard ones; `None` if a key for it is missing.
    fn thickness_offset_mm(&self) -> Option<f64> {
        let of_rack = match self.get(keys::RACK_TOOTH_THICKNESS) {
            Some(thickness) => thickness.mm() - FRAC_PI_2 * self.get(keys::PAIR_NORMAL_MODULE)?.mm(),
            None => 0.0,
        };
        let cos_p = trig::sin_cos_of(self.or_zero(keys::PINION_HELIX_ANGLE)).1;
        let thicker = of_rack + cos_p * self.or_zero(keys::PINION_TOOTH_THICKNESS_DEVIATION).mm();
        if thicker == 0.0 {
            return Some(0.0);
        }
        Some(thickness_offset_mm(thicker, trig::tan_of(self.get(keys::PAIR_NORMAL_PRESSURE_ANGLE)?)))
    }

    /// Whether the rack's tips reach below the pinion's involute; `None` if that is not known.
    pub(super) fn is_undercut(&self) -> Option<bool> {
        let module = self.get(keys::PAIR_NORMAL_MODULE)?.mm();
        let pressure_angle = self.get(keys::PAIR_NORMAL_PRESSURE_ANGLE)?;
        let cos_p = trig::sin_cos_of(self.or_zero(keys::PINION_HELIX_ANGLE)).1;
        let radius = 0.5 * module * f64::from(self.get(keys::PINION_TEETH)?) / cos_p;
        let transverse = trig::atan2(trig::tan_of(pressure_angle), cos_p);
        let addendum = self.get(keys::RACK_ADDENDUM)?.mm();
        Some(self.or_zero(keys::PINION_PROFILE_SHIFT) < undercut_limit(addendum, radius, transverse, module))
    }

    /// Whether the teeth of a part are known one by one.
    #[must_use]
    pub fn knows_teeth(&self, part: Part) -> bool {
        match part {
            Part::Rack => !self.rack_deviations.is_empty() || self.place(keys::RACK_MEASURED).is_some(),
            Part::Pinion => !self.pinion_deviations.is_empty() || self.place(keys::PINION_MEASURED).is_some(),
        }
    }

    /// Refuses errors of a part whose teeth are known one by one: the user has to say which of both counts.
    ///
    /// # Errors
    /// A diagnostic that names the error.
    pub fn refuse_both_ways(&self, errors: &[DeviationKind]) -> Result<(), Diagnostic> {
        let Some(kind) = errors.iter().find(|kind| self.knows_teeth(kind.part())) else { return Ok(()) };
        let part = kind.part().name();
        let message = format!("the {part} is given both ways: `{}` as one value, and its teeth one by one", kind.key());
        let help = format!("leave out the value, or [[{part}.deviation]] and `{part}.measured`");
        let place = said_of(&self.errors, *kind).map(|written| written.span.clone()).filter(|span| !span.is_empty());
        Err(Diagnostic::error(Code::BadErrorEntry, message).help(help).at(&self.source, place, ""))
    }

    /// The keys that the pair's geometry still lacks.
    #[must_use]
    pub fn missing_geometry(&self) -> Vec<&'static str> {
        let depth = self.rolls().then_some(keys::SUPPORT_ROLL_AXIS_DEPTH.any.path);
        GEOMETRY_KEYS.into_iter().chain(depth).filter(|path| self.values.at(path).is_none()).collect()
    }

    /// Why a roll axis is refused: no key says whether the rack may roll about it.
    pub(super) fn roll_axis_alone(&self) -> Option<Diagnostic> {
        let depth = self.place(keys::SUPPORT_ROLL_AXIS_DEPTH).filter(|_| self.place(keys::SUPPORT_ROLL).is_none())?;
        let message = "`roll_axis_depth` needs `roll`: nothing says whether the rack may roll";
        let help = "add `roll = \"free\"` or `roll = \"fixed\"` below [support]";
        Some(Diagnostic::error(Code::MissingKey, message).help(help).at(&self.source, depth, ""))
    }

    /// Whether the rack may roll.
    pub(super) fn rolls(&self) -> bool {
        self.get(keys::SUPPORT_ROLL).is_some_and(|roll| roll != "fixed")
    }

    /// The pair with everything that is given except its errors; `None` if a key is missing.
    ///
    /// # Errors
    /// Diagnostics for geometry that cannot mesh, or that `[pair] contact` contradicts.
    pub fn given_pair(&self) -> Result<Option<GivenPair>, Diagnostics> {
        if !self.missing_geometry().is_empty() {
            return Ok(None);
        }
        let pair = self.pair("the bound")?;
        let path = ContactPath::nominal(&pair);
        if let Some(stated) = self.place(keys::PAIR_CONTACT)
            && !(path.has_both_flanks_of_a_rack_tooth() && path.has_both_flanks_of_a_pinion_tooth())
        {
            let message = format!(
                "`contact` states that a tooth always carries with both flanks, and the geometry says otherwise: its path of \
                 contact is {:.3} pitches long and {:.3} off",
                path.ratio, path.offset
            );
            let help = "leave `contact` out: the geometry is given";
            return Err(Diagnostic::error(Code::BadGeometry, message).help(help).at(&self.source, stated, "").into());
        }
        let support = self.support()?;
        Ok(Some(GivenPair { pair, rack_form: self.rack_form(), pinion_form: self.pinion_form(), support }))
    }

    /// Form of the rack's flanks.
    pub(super) fn rack_form(&self) -> RackForm {
        RackForm {
            crowning_mm: self.or_zero(keys::RACK_CROWNING).mm(),
            tip_relief_mm: self.or_zero(keys::RACK_TIP_RELIEF_AMOUNT).mm(),
            tip_relief_start_mm: self.or_zero(keys::RACK_TIP_RELIEF_START).mm(),
        }
    }

    /// Form of the pinion's flanks.
    pub(super) fn pinion_form(&self) -> PinionForm {
        PinionForm {
            crowning_mm: self.or_zero(keys::PINION_CROWNING).mm(),
            profile_slope_mm: self.or_zero(keys::PINION_PROFILE_SLOPE).mm(),
        }
    }
}
