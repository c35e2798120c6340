//! Nominal values and limits from a Q-DAS file, where the spec has none. `paste` and `batch` call it; it never replaces a
//! value of the spec.

use super::{Located, Spec, keys, said_of};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::Model;
use crate::judge::{Limit, LimitTarget};
use crate::quantity::{Angle, Length};
use crate::table::qdas::{Characteristic, Qdas};
use crate::table::unit_of;
use crate::uncertainty::{Influence, Uncertainty};

/// What to do where parts have limits or uncertainties of their own.
const APART: &str = "evaluate them apart, or write in the spec what holds for all parts";

/// The spec's keys for the values of an error in a table.
#[derive(PartialEq)]
struct OfValues {
    nominal: Option<DeviationValue>,
    limit: Option<Limit>,
    uncertainty: Option<Uncertainty>,
}

impl OfValues {
    /// The first difference from another one, in words.
    fn difference(&self, other: &Self) -> Option<String> {
        let in_words = |of: &dyn Fn(&Self) -> Option<String>| {
            [self, other].map(|one| of(one).unwrap_or_else(|| "none".to_owned())).join(" and ")
        };
        if self.nominal != other.nominal {
            let nominal = |one: &Self| Some(one.nominal?.to_string());
            return Some(format!("nominal values {}", in_words(&nominal)));
        }
        if self.limit != other.limit {
            let limit = |one: &Self| Some(one.limit?.to_string());
            return Some(format!("limits of its ΔCD {}", in_words(&limit)));
        }
        let standard = |one: &Self| Some(one.uncertainty?.standard.to_string());
        (self != other).then(|| format!("standard uncertainties {}", in_words(&standard)))
    }
}

impl Spec {
    /// The spec with the values of a file's characteristics for its errors, and remarks on which were taken. The spec's own values
    /// stay.
    ///
    /// Limits of a characteristic are limits of its error. They become limits of its ΔCD: those of an over-roller or
    /// radial error as they are, those of a pitch or lead error by its formula if they lie as far above as below,
    /// because its ΔCD follows from its magnitude.
    ///
    /// # Errors
    /// If the file has contradicting values for an error on which the spec says nothing.
    pub fn completed_by(&self, qdas: &Qdas, model: Model) -> Result<(Self, Vec<String>), Diagnostic> {
        let layout = self.want().contract();
        let of_errors = qdas.characteristics.iter().map(|found| (Qdas::error_of(found, &layout), found));
        let of_errors: Vec<_> = of_errors.filter_map(|(kind, found)| Some((kind?, found))).collect();
        let mut spec = self.clone();
        let mut notes = Vec::new();
        for kind in DeviationKind::ALL {
            let mut all = of_errors.iter().filter(|(of, _)| *of == kind).map(|(_, found)| *found);
            let Some(first) = all.next() else { continue };
            spec.take(kind, first, model, &mut notes);
            let taken = spec.of_values(kind);
            let difference = all.filter(|other| !says_the_same(first, other)).find_map(|other| {
                let mut alone = self.clone();
                alone.take(kind, other, model, &mut Vec::new());
                taken.difference(&alone.of_values(kind))
            });
            if let Some(difference) = difference {
                let message = format!("{} says different things of {kind}: {difference}", qdas.name);
                return Err(Diagnostic::error(Code::BadTable, message).help(APART));
            }
        }
        Ok((spec, notes))
    }

    /// Refuses a further table `name` whose file differs in values that the spec leaves open.
    ///
    /// # Errors
    /// If parts of both cannot be judged by one spec.
    pub fn refuse_other(&self, name: &str, first: (&str, &Self)) -> Result<(), Diagnostic> {
        let of_kind = |kind: DeviationKind| Some((kind, first.1.of_values(kind).difference(&self.of_values(kind))?));
        let Some((kind, difference)) = DeviationKind::ALL.into_iter().find_map(of_kind) else { return Ok(()) };
        let message = format!("{} and {name} say different things of {kind}: {difference}", first.0);
        Err(Diagnostic::error(Code::BadTable, message).help(APART))
    }

    fn of_values(&self, kind: DeviationKind) -> OfValues {
        OfValues {
            nominal: said_of(&self.nominals, kind).map(|nominal| nominal.value),
            limit: self.limit_on(LimitTarget::Error(kind)).copied(),
            uncertainty: said_of(&self.uncertainties, Influence::Error(kind)).map(|uncertainty| uncertainty.value),
        }
    }

    /// Takes the values of a characteristic for its error.
    fn take(&mut self, kind: DeviationKind, found: &Characteristic, model: Model, notes: &mut Vec<String>) {
        self.take_nominal(kind, found, notes);
        notes.extend(found.unused.iter().map(|unused| format!("{kind}: {unused}")));
        self.take_limits(kind, found, model, notes);
        self.take_uncertainty(kind, found, notes);
    }

    fn take_nominal(&mut self, kind: DeviationKind, found: &Characteristic, notes: &mut Vec<String>) {
        let Some(nominal) = found.nominal.as_deref().and_then(|text| value(kind, text, found)) else { return };
        let stated = self.batch_column(kind).is_some_and(|column| {
            column.value.nominal.is_some() || column.value.kind.as_ref().is_some_and(|kind| kind.value == "deviation")
        });
        let is_size = nominal.is_size(self.get(keys::PAIR_NORMAL_MODULE));
        if !stated && is_size && said_of(&self.nominals, kind).is_none() {
            notes.push(format!("{kind}: nominal value {nominal} from the file (K2101)"));
            self.nominals.push((kind, Located { value: nominal, span: 0..0 }));
        }
    }

    /// The coverage factor of an expanded uncertainty, which the format does not have: 2, as is usual.
    fn take_uncertainty(&mut self, kind: DeviationKind, found: &Characteristic, notes: &mut Vec<String>) {
        const COVERAGE: f64 = 2.0;
        let source = Influence::Error(kind);
        let Some(text) = found.uncertainty.as_deref() else { return };
        if said_of(&self.uncertainties, source).is_some() {
            return;
        }
        let Some(expanded) = value(kind, text, found) else {
            let unit = found.unit.as_deref().unwrap_or_default();
            return notes.push(format!(
                "{kind}: the uncertainty of the file (K2106) is not taken: {text} {unit} is none of it"
            ));
        };
        let number = expanded.base();
        if number > 0.0 {
            notes.push(format!("{kind}: expanded uncertainty U = {expanded} (k = 2, assumed) from the file (K2106)"));
            let value = Uncertainty { is_dof_stated: false, ..Uncertainty::expanded(number, COVERAGE) };
            self.uncertainties.push((source, Located { value, span: 0..0 }));
        }
    }

    fn take_limits(&mut self, kind: DeviationKind, found: &Characteristic, model: Model, notes: &mut Vec<String>) {
        let target = LimitTarget::Error(kind);
        let end = |text: &Option<String>| text.as_deref().and_then(|text| value(kind, text, found));
        let (lower, upper) = (end(&found.lower), end(&found.upper));
        let is_read = lower.is_some() == found.lower.is_some() && upper.is_some() == found.upper.is_some();
        if found.lower.is_none() && found.upper.is_none() {
            return;
        }
        if self.limit_on(target).is_some() {
            return notes
                .push(format!("{kind}: the limits of the file (K2110, K2111) are not used: the spec has its own"));
        }
        if !is_read {
            let unit = found.unit.as_deref().unwrap_or_default();
            return notes.push(format!("{kind}: the limits of the file are not taken: `{unit}` is not its unit"));
        }
        let nominal = said_of(&self.nominals, kind).map_or(DeviationValue::zero(kind), |nominal| nominal.value);
        let (lower, upper) = (lower.map(|end| end.less(nominal)), upper.map(|end| end.less(nominal)));
        let limit = match (lower, upper) {
            _ if kind.always_acts() => Ok(Limit { lower: lower.and_then(length), upper: upper.and_then(length) }),
            (Some(lower), Some(upper)) if lower == DeviationValue::zero(kind).less(upper) => {
                self.effect(kind, upper, model)
            }
            (None, Some(upper)) => self.effect(kind, upper, model),
            _ => Err("they do not lie as far above as below, and ΔCD follows from the magnitude"),
        };
        match limit {
            Ok(limit) => {
                notes.push(format!("{kind}: limit of its ΔCD from the file (K2110, K2111): {limit}"));
                self.limits.push((target, Located { value: limit, span: 0..0 }));
            }
            Err(why) => notes.push(format!("{kind}: the limits of the file are not taken: {why}")),
        }
    }

    /// ΔCD of the largest permitted error.
    fn effect(&self, kind: DeviationKind, largest: DeviationValue, model: Model) -> Result<Limit, &'static str> {
        let errors = self.with_errors(&[(kind, largest)]).part_deviations();
        let errors = errors.map_err(|_| "the spec lacks what ΔCD of them follows from")?;
        let upper = errors.first().and_then(|error| error.delta_cd(model).ok());
        let upper = upper.ok_or("the formula has no ΔCD of errors as large")?;
        Ok(Limit { lower: None, upper: Some(upper) })
    }
}

/// Whether two characteristics agree in the values that a spec takes.
fn says_the_same(one: &Characteristic, other: &Characteristic) -> bool {
    fn said(found: &Characteristic) -> [&Option<String>; 5] {
        let Characteristic { nominal, lower, upper, unit, uncertainty, .. } = found;
        [nominal, lower, upper, unit, uncertainty]
    }
    said(one) == said(other)
}

fn value(kind: DeviationKind, text: &str, found: &Characteristic) -> Option<DeviationValue> {
    let is_angle = kind == DeviationKind::RackLead;
    let unit = found.unit.as_deref().map(|unit| unit_of(unit, is_angle).map_or(unit, |unit| unit.symbol()));
    let text = format!("{text} {}", unit.unwrap_or_default());
    match kind {
        DeviationKind::RackLead => text.parse::<Angle>().ok().map(DeviationValue::Angle),
        _ => text.parse::<Length>().ok().map(DeviationValue::Length),
    }
}

fn length(value: DeviationValue) -> Option<Length> {
    match value {
        DeviationValue::Length(length) => Some(length),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nominal_values_and_limits_where_the_spec_is_silent() {
        let file = "K0100 3\nK2002/1 rack_over_roller\nK2101/1 25\nK2112/1 -0.02\nK2113/1 0.03\nK2106/1 0.002\n\
                    K2002/2 rack_pitch\nK2110/2 -10\nK2111/2 10\nK2142/2 um\nK2002/3 pinion_pitch\nK2110/3 -1\nK2111/3 2\n1\n";
        let qdas = crate::table::qdas::read(&[("lot.dfq", file)]).unwrap();
        let spec = Spec::parse("rack.toml", "[pair]\nnormal_pressure_angle = 45").unwrap();
        let (completed, notes) = spec.completed_by(&qdas, Model::Exact).unwrap();
        let limits: Vec<_> = completed
            .limits()
            .into_iter()
            .map(|(on, limit)| (on.key(), limit.lower.map(Length::mm), limit.upper.map(Length::mm)))
            .collect();
        // 10 µm / (2 tan 45°)
        assert_eq!(limits, [("rack_over_roller", Some(-0.02), Some(0.03)), ("rack_pitch", None, Some(0.005))]);
        assert_eq!(completed.nominals[0].1.value, DeviationValue::Length("25".parse().unwrap()));
        assert_eq!(notes.len(), 5, "{notes:?}");
        let text = "[errors]\nrack_over_roller = { nominal = 24.99 }\n[limits]\nrack_over_roller = \"±1\"";
        let (completed, _) = Spec::parse("rack.toml", text).unwrap().completed_by(&qdas, Model::Exact).unwrap();
        // the reader of tables refuses what contradicts it
        assert_eq!(completed.nominals[0].1.value, DeviationValue::Length("24.99".parse().unwrap()));
        assert_eq!(completed.limits()[0].1.upper, Some("1".parse().unwrap()));
    }

    #[test]
    fn parts_with_limits_of_their_own_are_refused() {
        let part = |limit: &str, uncertainty: &str| {
            format!("K0100 1\nK2002/1 rack_pitch\nK2142/1 um\nK2111/1 {limit}\nK2106/1 {uncertainty}\n10\n")
        };
        let completed = |spec: &str, file: &str| {
            let qdas = crate::table::qdas::read(&[("lot.dfq", file)]).unwrap();
            Spec::parse("rack.toml", &format!("[pair]\nnormal_pressure_angle = 45\n{spec}"))
                .unwrap()
                .completed_by(&qdas, Model::Exact)
        };
        let refused = |one: &str, other: &str| {
            let in_one_file = completed("", &(one.to_owned() + other)).err().map(|problem| problem.message);
            let (first, second) = (completed("", one).unwrap().0, completed("", other).unwrap().0);
            let between = second.refuse_other("b.dfq", ("a.dfq", &first)).err().map(|problem| problem.message);
            assert_eq!(in_one_file.is_some(), between.is_some());
            between.unwrap_or_default()
        };
        assert_eq!(refused(&part("20", "1"), &part("20.0", "1")), "");
        let limits = "a.dfq and b.dfq say different things of rack pitch: limits of its ΔCD at most 0.01 mm and at most 0.0025 mm";
        assert_eq!(refused(&part("20", "1"), &part("5", "1")), limits);
        let uncertainties = refused(&part("20", "1"), &part("20", "10"));
        assert!(uncertainties.ends_with("standard uncertainties 0.0005 and 0.005"), "{uncertainties}");
        // what the spec says holds for all
        let both = part("20", "1") + &part("5", "1");
        assert!(completed("[limits]\nrack_pitch = \"±0.1\"", &both).is_ok());
    }
}
