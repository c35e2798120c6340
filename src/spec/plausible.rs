//! Whether the values of a spec make sense, by the rule of [`plausible`](crate::deviation::plausible). [`Spec::parse`]
//! refuses impossible values by it, results show the doubtful ones; it changes no value.

use std::ops::Range;

use super::errors::WrittenError;
use super::found::Found;
use super::keys::{self, Key};
use super::resolve::Problems;
use super::value::KeyType;
use super::{Located, Spec, said_of};
use crate::deviation::plausible::{self, Doubt, Reach, WrittenIn};
use crate::deviation::{DeviationKind, DeviationValue, PinionDeviationKind, RackDeviationKind};
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::formula::over_pin::OverPin;
use crate::judge::{LimitTarget, Rule};
use crate::quantity::{Angle, Length, parse_f64};
use crate::uncertainty::{Influence, Uncertainty};

/// A doubt about the value of a key.
struct DoubtedKey {
    name: String,
    span: Range<usize>,
    doubt: Doubt,
}

impl DoubtedKey {
    fn new(name: impl Into<String>, span: &Range<usize>, doubt: Doubt) -> Self {
        Self { name: name.into(), span: span.clone(), doubt }
    }
}

impl Spec {
    /// The suspicious values, in the order of the spec: there is a result, but perhaps with a mistaken unit.
    #[must_use]
    pub fn suspicions(&self) -> Vec<Diagnostic> {
        let old = self.table.place.clone().filter(|_| self.table.is_called_batch).map(|place| {
            let message = "[batch] is called [table] now, and is read as that";
            let warning = Diagnostic::warning(Code::UnknownKey, message).at(&self.source, place, "");
            warning.help("write [table] and [table.columns]")
        });
        old.into_iter().chain(self.doubts(Severity::Warning)).chain(self.doubted_nominal()).collect()
    }

    /// The suspicious values as sentences, for the notes of a result.
    #[must_use]
    pub fn suspicions_in_words(&self) -> Vec<String> {
        self.suspicions().iter().map(Diagnostic::sentence).collect()
    }

    /// The impossible values.
    pub(super) fn impossibilities(&self) -> Vec<Diagnostic> {
        self.doubts(Severity::Error)
    }

    fn doubts(&self, severity: Severity) -> Vec<Diagnostic> {
        let mut found = self.doubted_sizes();
        found.extend(self.errors.iter().filter_map(|(kind, written)| self.doubted_error(*kind, written)));
        found.extend(self.errors.iter().filter_map(|(_, written)| self.doubted_roller(written)));
        found.extend(self.doubted_teeth());
        found.extend(self.doubted_limits());
        found.extend(self.doubted_uncertainties());
        found.retain(|doubted| doubted.doubt.is_impossible == (severity == Severity::Error));
        found.sort_by_key(|doubted| doubted.span.start);
        let mut diagnostics = Found::default();
        for doubted in &found {
            diagnostics.add(|| self.diagnostic(doubted));
        }
        diagnostics.sorted(|_| ())
    }

    fn diagnostic(&self, doubted: &DoubtedKey) -> Diagnostic {
        let DoubtedKey { name, span, doubt } = doubted;
        let message = format!("`{name}`: {doubt}");
        let diagnostic = if doubt.is_impossible {
            Diagnostic::error(Code::Implausible, message)
        } else {
            Diagnostic::warning(Code::Implausible, message)
        };
        let diagnostic = diagnostic.help(doubt.remedy(WrittenIn::Spec));
        if span.is_empty() { diagnostic } else { diagnostic.at(&self.source, span.clone(), "") }
    }

    /// The normal module, if it is given.
    pub(crate) fn module(&self) -> Option<Length> {
        self.get(keys::PAIR_NORMAL_MODULE)
    }

    /// The doubt about a pin in the rack's spaces, if these are known.
    pub(crate) fn doubted_pin(&self, pin_diameter: Length) -> Option<Doubt> {
        let over_pin = OverPin {
            normal_module: self.module()?,
            normal_pressure_angle: self.get(keys::PAIR_NORMAL_PRESSURE_ANGLE)?,
            tooth_thickness: self.get(keys::RACK_TOOTH_THICKNESS),
            pin_diameter,
            datum: Length::ZERO,
        };
        over_pin.doubted_pin(self.get(keys::RACK_ADDENDUM))
    }

    /// The doubts about gear data.
    fn doubted_sizes(&self) -> Vec<DoubtedKey> {
        fn of<T: KeyType>(spec: &Spec, key: Key<T>, rule: impl Fn(Located<T>) -> Option<Doubt>) -> Option<DoubtedKey> {
            let written = spec.values.located(key)?;
            Some(DoubtedKey::new(key.any.name(), &written.span.clone(), rule(written)?))
        }
        let module = self.module();
        let face_width = |width: Located<Length>| plausible::face_width(width.value, module);
        let addendum = |height: Located<Length>| plausible::addendum(height.value, module);
        let deviation = |length| Some(plausible::deviation(DeviationValue::Length(length), module)?.of_no_size());
        let form = |amount: Located<Length>| deviation(amount.value);
        let guard = |rule: Located<Rule>| match rule.value {
            Rule::Guard(band) => Some(deviation(band)?.of_no_part()),
            Rule::Simple | Rule::Iso14253 => None,
        };
        let helix_angle =
            |angle: Located<Angle>| plausible::helix_angle(angle.value).filter(|_| self.is_bare(&angle.span));
        [
            of(self, keys::PAIR_NORMAL_MODULE, |module| plausible::normal_module(module.value)),
            of(self, keys::PAIR_NORMAL_PRESSURE_ANGLE, |angle| plausible::pressure_angle(angle.value)),
            of(self, keys::RACK_HELIX_ANGLE, helix_angle),
            of(self, keys::RACK_FACE_WIDTH, face_width),
            of(self, keys::RACK_ADDENDUM, addendum),
            of(self, keys::PINION_HELIX_ANGLE, helix_angle),
            of(self, keys::PINION_FACE_WIDTH, face_width),
            of(self, keys::RACK_PIN, |pin| self.doubted_pin(pin.value)),
            of(self, keys::RACK_CROWNING, form),
            of(self, keys::PINION_CROWNING, form),
            of(self, keys::PINION_PROFILE_SLOPE, form),
            of(self, keys::PINION_TOOTH_THICKNESS_DEVIATION, form),
            of(self, keys::DECISION_RULE, guard),
            of(self, keys::RACK_TIP_RELIEF, |_| deviation(self.get(keys::RACK_TIP_RELIEF_AMOUNT)?)),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// The doubts about uncertainties of errors, which are smaller than any error.
    fn doubted_uncertainties(&self) -> impl Iterator<Item = DoubtedKey> {
        let doubted = |(source, written): &(Influence, Located<Uncertainty>)| {
            let Influence::Error(kind) = *source else { return None };
            let standard = written.value.standard;
            let value = match DeviationValue::zero(kind) {
                DeviationValue::Length(_) => DeviationValue::Length(Length::from_mm(standard).ok()?),
                _ => DeviationValue::Angle(Angle::from_degrees(standard).ok()?),
            };
            let doubt = plausible::deviation(value, self.module())?.of_no_size().of_no_part();
            Some(DoubtedKey::new(format!("uncertainty of {}", kind.key()), &written.span, doubt))
        };
        self.uncertainties.iter().filter_map(doubted)
    }

    /// The doubt about a nominal value of the measure over the pin that is not the one of the spec's pin and datum, by more than a
    /// hundredth of the module.
    fn doubted_nominal(&self) -> Option<Diagnostic> {
        let given = said_of(&self.nominals, DeviationKind::RackOverRoller).filter(|_| self.over_pin().is_none())?;
        let DeviationValue::Length(nominal) = given.value else { return None };
        let (computed, module) = (self.computed_over_pin()?, self.module()?);
        if (nominal.mm() - computed.mm()).abs() <= 0.01 * module.mm() {
            return None;
        }
        let message = format!(
            "`rack_over_roller`: the nominal value is {nominal}, but M over `rack.pin` from `rack.datum` is {:.4} mm",
            computed.mm()
        );
        let help = "check the nominal value, the pin's diameter, the datum and the rack's tooth thickness";
        Some(Diagnostic::warning(Code::Implausible, message).help(help).at(&self.source, given.span.clone(), ""))
    }

    /// Whether a value is written without a unit.
    fn is_bare(&self, span: &Range<usize>) -> bool {
        let (source, span) = self.source.holding(span.clone());
        let text = source.text.get(span).unwrap_or_default();
        parse_f64(text.trim_matches(['"', '\''])).is_ok()
    }

    /// The doubt about an entry of `[errors]`; a class has none.
    fn doubted_error(&self, kind: DeviationKind, written: &Located<WrittenError>) -> Option<DoubtedKey> {
        let (value, is_difference) = match written.value {
            WrittenError::Value(value) => (value, said_of(&self.nominals, kind).is_some()),
            WrittenError::Tolerance(ends) => (ends.farther, false),
            WrittenError::OverRoller { measured, roller } => {
                let need = || (kind.key().to_owned(), None);
                let over_pin = self.over_pin_of(roller, &mut Problems::default(), &need)?;
                (DeviationValue::Length(measured - over_pin.measure().ok()?), true)
            }
            WrittenError::Class(_) => return None,
        };
        let doubt = plausible::deviation(value, self.module())?;
        let doubt = if is_difference { doubt.of_difference() } else { doubt };
        Some(DoubtedKey::new(kind.key(), &written.span, doubt))
    }

    /// The doubt about the roller of an entry of `[errors]`.
    fn doubted_roller(&self, written: &Located<WrittenError>) -> Option<DoubtedKey> {
        let WrittenError::OverRoller { roller, .. } = written.value else { return None };
        Some(DoubtedKey::new("roller", &written.span, self.doubted_pin(roller)?))
    }

    /// The doubts about limits that no deviation comes near, so that every part would pass: µm in place of mm.
    fn doubted_limits(&self) -> Vec<DoubtedKey> {
        let doubted = |on: &LimitTarget, end: Option<Length>| {
            let module = self.module();
            let doubt = plausible::deviation(DeviationValue::Length(end?), module)?.of_no_part();
            let reach = if module.is_some() { Reach::possible(module) } else { Reach::usual(None) };
            let doubted = DoubtedKey::new(format!("limits.{}", on.key()), &(0..0), doubt);
            reach.is_exceeded_by(doubt.value).then_some(doubted)
        };
        self.limits()
            .iter()
            .flat_map(|(on, limit)| [limit.lower, limit.upper].map(|end| doubted(on, end)))
            .flatten()
            .collect()
    }

    /// The doubts about deviations of single teeth.
    fn doubted_teeth(&self) -> Vec<DoubtedKey> {
        let rack = self.rack_deviations.iter().map(|written| (of_rack(written.value.kind), &written.span));
        let pinion = self.pinion_deviations.iter().map(|written| (of_pinion(written.value.kind), &written.span));
        let doubted = |name: &'static str| {
            move |(value, span): (Option<DeviationValue>, &Range<usize>)| {
                Some(DoubtedKey::new(name, span, plausible::deviation(value?, self.module())?))
            }
        };
        rack.filter_map(doubted("rack.deviation")).chain(pinion.filter_map(doubted("pinion.deviation"))).collect()
    }
}

/// The value of a deviation of rack teeth.
fn of_rack(kind: RackDeviationKind) -> Option<DeviationValue> {
    use RackDeviationKind::{Lead, Left, OverRoller, Pitch, Right, Shift, Thickness};
    match kind {
        OverRoller(mm) | Pitch(mm) | Shift(mm) | Thickness(mm) | Left(mm) | Right(mm) => DeviationValue::from_mm(mm),
        Lead(rad) => DeviationValue::from_rad(rad),
    }
}

/// The value of a deviation of the pinion.
fn of_pinion(kind: PinionDeviationKind) -> Option<DeviationValue> {
    use PinionDeviationKind::{Eccentricity, Lead, Left, Radial, Right, Shift, Thickness};
    match kind {
        Shift(mm) | Thickness(mm) | Left(mm) | Right(mm) | Radial(mm) | Eccentricity(mm) => DeviationValue::from_mm(mm),
        Lead(rad) => DeviationValue::from_rad(rad),
    }
}

#[cfg(test)]
mod tests {
    use crate::spec::Spec;

    fn said(text: &str) -> Vec<String> {
        match Spec::parse("spec.toml", text) {
            Ok(spec) => spec
                .suspicions()
                .into_iter()
                .map(|found| format!("{found}; {}", found.help.clone().unwrap_or_default()))
                .collect(),
            Err(problems) => problems
                .0
                .into_iter()
                .map(|found| format!("{found}; {}", found.help.clone().unwrap_or_default()))
                .collect(),
        }
    }

    #[test]
    fn a_nominal_measure_is_that_of_pin_and_datum() {
        let spec = |nominal: &str| {
            let rack =
                "[pair]\nnormal_module = 1.8\nnormal_pressure_angle = 20\n[rack]\ndatum = 22\npin = 3\n[errors]\n";
            said(&format!("{rack}rack_over_roller = {{ measured = {nominal}, nominal = {nominal} }}"))
        };
        let [found] = &spec("25")[..] else { panic!("one doubt") };
        assert!(
            found.contains("the nominal value is 25 mm, but M over `rack.pin` from `rack.datum` is 24.0016 mm"),
            "{found}"
        );
        assert!(spec("24.019").is_empty() && spec("24.02").len() == 1);
    }

    #[test]
    fn each_mistake_is_said_where_it_stands_with_what_to_write() {
        for (text, expected) in [
            (
                "[errors]\nrack_pitch = 12",
                "spec.toml:2:14: warning[implausible]: `rack_pitch`: 12 mm is large for a deviation; if that is µm, write \"12 um\"",
            ),
            (
                "[pair]\nnormal_module = 1.83\n[errors]\nrack_pitch = 12",
                "spec.toml:4:14: error[implausible]: `rack_pitch`: 12 mm is too large for a deviation (the module is 1.83 mm); \
                 if that is µm, write \"12 um\"",
            ),
            (
                "[errors]\nrack_over_roller = 25.013",
                "spec.toml:2:20: warning[implausible]: `rack_over_roller`: 25.013 mm is large for a deviation; \
                 if that is a measured size, write { measured = 25.013, nominal = … }",
            ),
            (
                "[errors]\nrack_over_roller = { measured = 25.013, nominal = 22 }",
                "spec.toml:2:20: warning[implausible]: `rack_over_roller`: 3.013 mm is large for a deviation; \
                 check the unit and the decimal mark",
            ),
            (
                "[errors]\nrack_lead = 15",
                "spec.toml:2:13: warning[implausible]: `rack_lead`: 15° is large for a lead error; \
                 if that is arc minutes, write \"15 arcmin\"",
            ),
            (
                "[errors]\nrack_lead = { f_h_beta = 8, length = 18 }",
                "spec.toml:2:13: warning[implausible]: `rack_lead`: 23.96° is large for a lead error; \
                 check the units of f_Hβ and of its evaluation length: a number alone is mm",
            ),
            (
                "[errors]\nrack_lead = { f_h_beta = \"8 um\", length = 18000 }",
                "spec.toml:2:13: error[implausible]: `length` of rack_lead: 18000 mm is too large for a face width; \
                 if that is µm, write \"18000 um\"",
            ),
            (
                "[pair]\nnormal_pressure_angle = 0.349",
                "spec.toml:2:25: error[implausible]: `normal_pressure_angle`: 0.349° is too small for a pressure angle; \
                 if that is radians, write \"0.349 rad\"",
            ),
            (
                "[rack]\nhelix_angle = -0.436",
                "spec.toml:2:15: warning[implausible]: `helix_angle`: -0.436° is small for a helix angle; \
                 if that is radians, write \"-0.436 rad\"",
            ),
            (
                "[pair]\nnormal_module = 2\n[rack]\ncrowning = 5",
                "spec.toml:4:12: error[implausible]: `crowning`: 5 mm is too large for a deviation (the module is 2 mm); \
                 if that is µm, write \"5 um\"",
            ),
            (
                "[rack]\ntip_relief = { amount = 10, start = 1 }",
                "spec.toml:2:14: warning[implausible]: `tip_relief`: 10 mm is large for a deviation; if that is µm, write \"10 um\"",
            ),
            (
                "[errors]\nrack_pitch = { value = \"3 um\", u = 3.05 }",
                "spec.toml:2:14: warning[implausible]: `uncertainty of rack_pitch`: 3.05 mm is large for a deviation; \
                 if that is µm, write \"3.05 um\"",
            ),
            (
                "[decision]\nrule = \"guard=5\"",
                "spec.toml:2:8: warning[implausible]: `rule`: 5 mm is large for a deviation; if that is µm, write \"5 um\"",
            ),
            (
                "[pair]\nnormal_module = 1830",
                "spec.toml:2:17: warning[implausible]: `normal_module`: 1830 mm is large for a module; \
                 if that is µm, write \"1830 um\"",
            ),
            (
                "[pinion]\nface_width = 18000",
                "spec.toml:2:14: warning[implausible]: `face_width`: 18000 mm is large for a face width; \
                 if that is µm, write \"18000 um\"",
            ),
            (
                "[pair]\nnormal_module = 1.8\n[rack]\naddendum = 0.0017",
                "spec.toml:4:12: warning[implausible]: `addendum`: 0.0017 mm is small for an addendum; \
                 if that is metres, write \"0.0017 m\"",
            ),
            (
                "[pair]\nnormal_module = 1.8\n[rack]\nface_width = 0.0197",
                "spec.toml:4:14: warning[implausible]: `face_width`: 0.0197 mm is small for a face width; \
                 if that is metres, write \"0.0197 m\"",
            ),
            (
                "[[rack.deviation]]\nteeth = \"3\"\npitch = 12",
                "spec.toml:3:9: warning[implausible]: `rack.deviation`: 12 mm is large for a deviation; \
                 if that is µm, write \"12 um\"",
            ),
        ] {
            assert_eq!(said(text), [expected], "{text}");
        }
    }

    #[test]
    fn what_parts_have_and_what_is_said_with_its_unit_is_not_doubted() {
        for text in [
            "[pair]\nnormal_module = 1.83\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = 0.02\nrack_lead = 0.0017",
            "[rack]\nhelix_angle = \"0.5 deg\"",
            "[rack]\nhelix_angle = 0\nface_width = 20",
            "[errors]\nrack_over_roller = { measured = 25.013, nominal = 25 }",
            "[tolerance]\nstandard = \"iso1328-1-2013\"\n[errors]\nrack_pitch = { class = 7 }",
        ] {
            assert!(said(text).is_empty(), "{text}: {:?}", said(text));
        }
    }
}
