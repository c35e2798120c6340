//! What a Q-DAS file says where the spec is silent: nominal values and limits. Called by `paste` and `batch`; what the
//! spec says is never replaced.

use super::{Located, Spec};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::formula::Model;
use crate::judge::{Limit, LimitTarget};
use crate::quantity::{Angle, Length};
use crate::table::qdas::{Characteristic, Qdas};
use crate::uncertainty::{Source, Uncertainty};

impl Spec {
    /// The spec with what a file says of the characteristics that are its errors, and remarks on what was taken and
    /// what was not. What the spec says itself stays.
    ///
    /// Limits of a characteristic are limits of its error. They become limits of its ΔCD: those of an over-roller or
    /// radial error as they are, those of a pitch or lead error by its formula if they lie as far above as below,
    /// because its ΔCD follows from its magnitude.
    #[must_use]
    pub fn completed_by(&self, qdas: &Qdas, model: Model) -> (Self, Vec<String>) {
        let mut spec = self.clone();
        let mut notes = Vec::new();
        let own = self.want().own;
        for kind in DeviationKind::ALL {
            let found = qdas.characteristics.iter().find(|found| Qdas::error_of(found, &own) == Some(kind));
            let Some(found) = found else { continue };
            spec.take_nominal(kind, found, &mut notes);
            spec.take_limits(kind, found, model, &mut notes);
            spec.take_uncertainty(kind, found, &mut notes);
        }
        (spec, notes)
    }

    fn take_nominal(&mut self, kind: DeviationKind, found: &Characteristic, notes: &mut Vec<String>) {
        let Some(nominal) = found.nominal.as_deref().and_then(|text| value(kind, text, found)) else { return };
        let stated = self.batch_column(kind).is_some_and(|column| {
            column.value.nominal.is_some() || column.value.kind.as_ref().is_some_and(|kind| kind.value == "deviation")
        });
        if !stated && !nominal.is_zero() && self.nominals.iter().all(|(of, _)| *of != kind) {
            notes.push(format!("{kind}: nominal value {nominal} from the file (K2101)"));
            self.nominals.push((kind, Located { value: nominal, span: 0..0 }));
        }
    }

    /// An expanded uncertainty, whose coverage factor the format does not tell: 2, as is usual.
    fn take_uncertainty(&mut self, kind: DeviationKind, found: &Characteristic, notes: &mut Vec<String>) {
        const COVERAGE: f64 = 2.0;
        let source = Source::Error(kind);
        let Some(expanded) = found.uncertainty.as_deref().and_then(|text| value(kind, text, found)) else { return };
        if self.uncertainties.iter().any(|(of, _)| *of == source) {
            return;
        }
        let number = expanded.base();
        if number > 0.0 {
            notes.push(format!("{kind}: expanded uncertainty U = {expanded} (k = 2, assumed) from the file (K2106)"));
            self.uncertainties.push((source, Located { value: Uncertainty::expanded(number, COVERAGE), span: 0..0 }));
        }
    }

    fn take_limits(&mut self, kind: DeviationKind, found: &Characteristic, model: Model, notes: &mut Vec<String>) {
        let target = LimitTarget::Error(kind);
        let end = |text: &Option<String>| text.as_deref().and_then(|text| value(kind, text, found));
        let (lower, upper) = (end(&found.lower), end(&found.upper));
        if (lower.is_none() && upper.is_none()) || self.limits.iter().any(|(on, _)| *on == target) {
            return;
        }
        let nominal = self.nominals.iter().find(|(of, _)| *of == kind).map(|(_, nominal)| nominal.value);
        let nominal = nominal.unwrap_or(DeviationValue::zero(kind));
        let (lower, upper) = (lower.map(|end| end.less(nominal)), upper.map(|end| end.less(nominal)));
        let limit = match (lower, upper) {
            _ if kind.always_acts() => Some(Limit { lower: lower.and_then(length), upper: upper.and_then(length) }),
            (Some(lower), Some(upper)) if lower == DeviationValue::zero(kind).less(upper) => {
                self.effect(kind, upper, model)
            }
            (None, Some(upper)) => self.effect(kind, upper, model),
            _ => None,
        };
        match limit {
            Some(limit) => {
                notes.push(format!("{kind}: limit of its ΔCD from the file (K2110, K2111): {limit}"));
                self.limits.push((target, Located { value: limit, span: 0..0 }));
            }
            None => notes.push(format!(
                "{kind}: the limits of the file are not taken: they do not lie as far above as below, and ΔCD follows \
                 from the magnitude"
            )),
        }
    }

    /// ΔCD of the largest permitted error.
    fn effect(&self, kind: DeviationKind, largest: DeviationValue, model: Model) -> Option<Limit> {
        let errors = self.with_errors(&[(kind, largest)]).part_deviations().ok()?;
        let upper = errors.first()?.delta_cd(model).ok()?;
        Some(Limit { lower: None, upper: Some(upper) })
    }
}

fn value(kind: DeviationKind, text: &str, found: &Characteristic) -> Option<DeviationValue> {
    let text = format!("{text} {}", found.unit.as_deref().unwrap_or(""));
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
        let (completed, notes) = spec.completed_by(&qdas, Model::Exact);
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
        let (completed, _) = Spec::parse("rack.toml", text).unwrap().completed_by(&qdas, Model::Exact);
        // the reader of tables refuses what contradicts it
        assert_eq!(completed.nominals[0].1.value, DeviationValue::Length("24.99".parse().unwrap()));
        assert_eq!(completed.limits()[0].1.upper, Some("1".parse().unwrap()));
    }
}
