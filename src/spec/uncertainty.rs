//! Uncertainties as written beside the values they belong to, and `[[correlation]]`.
//!
//! A measured error or a size of the gear may be a table: `{ value = "20 deg", u = "0.02 deg" }`, or with the measured
//! and nominal values of an error. The reader calls this for the keys that follow the value.

use std::borrow::Cow;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::keys::{self, READINGS, UNCERTAINTY_KEYS};
use super::reader::SectionReader;
use super::resolve::Problems;
use super::{Located, Spec, WrittenError, said_of};
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, nearest_or};
use crate::formula::over_pin::OverPin;
use crate::judge::Rule;
use crate::uncertainty::{Distribution, Influence, Uncertainties, Uncertainty, UncertaintyError, Unstated};

const HELP: &str = "write u = …, or U = … with k = …, or half_width = … with distribution = \"rectangular\", \
                    \"triangular\", \"arcsine\" or \"normal\"";

/// Repeated readings of one quantity.
pub(super) struct Readings {
    /// The mean of the readings, as if it were written in their place.
    pub(super) mean: Spanned<DeValue<'static>>,
    /// Standard uncertainty of the mean, mm or degrees.
    uncertainty: Uncertainty,
}

/// A correlation as written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrittenCorrelation {
    /// The two values.
    pub between: (Influence, Influence),
    /// The correlation coefficient.
    pub coefficient: f64,
}

impl SectionReader<'_> {
    /// The value of a key that may have an uncertainty. For a table it is `value` or the mean of the readings; the uncertainty is
    /// noted.
    pub(super) fn uncertain<'v, 't>(
        &mut self,
        name: &str,
        value: &'v Spanned<DeValue<'t>>,
        source: Option<Influence>,
    ) -> Option<Cow<'v, Spanned<DeValue<'t>>>> {
        let (DeValue::Table(table), Some(source)) = (value.get_ref(), source) else {
            return Some(Cow::Borrowed(value));
        };
        let known = UNCERTAINTY_KEYS.into_iter().chain(["value", READINGS]);
        self.knows_keys(name, table, &known, &format!("write {name} = {{ value = …, u = … }}"))?;
        if let Some(values) = table.get(READINGS) {
            let readings = self.readings(name, table, values, source.is_angle())?;
            self.note_readings(&readings, source, None);
            return Some(Cow::Owned(readings.mean));
        }
        let Some(inner) = table.get("value") else {
            let diagnostic = Diagnostic::error(Code::BadUncertainty, format!("`{name}` is a table without a value"))
                .help(format!("write {name} = {{ value = …, u = … }}"));
            return self.refuse(diagnostic, value.span());
        };
        self.note_uncertainty(name, table, value.span(), source, None);
        Some(Cow::Borrowed(inner))
    }

    /// Reads repeated readings under a key of a table: their mean with s/√n and n − 1 degrees of freedom (JCGM 100, 4.2).
    pub(super) fn readings(
        &mut self,
        name: &str,
        table: &DeTable<'_>,
        values: &Spanned<DeValue<'_>>,
        is_angle: bool,
    ) -> Option<Readings> {
        let bad = |problem: &str, help: &str| {
            Diagnostic::error(Code::BadUncertainty, format!("`{READINGS}` of `{name}`: {problem}")).help(help)
        };
        let DeValue::Array(written) = values.get_ref() else {
            return self.wrong_type(READINGS, values, "a list of readings");
        };
        if let Some(key) =
            ["value", "measured", "f_h_beta"].into_iter().chain(UNCERTAINTY_KEYS).find(|key| table.contains_key(*key))
        {
            let problem = format!("`{key}` stands beside readings, whose mean and spread say the same");
            return self.refuse(bad(&problem, "leave one of both out"), values.span());
        }
        let read = |reader: &mut Self| -> Option<Vec<f64>> {
            written.iter().map(|value| reader.base_value(READINGS, value, is_angle)).collect()
        };
        let readings = read(self)?;
        let n = readings.len() as f64;
        let [first, _, ..] = readings[..] else {
            let help = "give two readings or more, or `value = …` with `u = …`";
            return self.refuse(bad("one reading says nothing of its uncertainty", help), values.span());
        };
        // differences from the first reading, so that no digit is lost
        let off = readings.iter().map(|reading| reading - first).sum::<f64>() / n;
        let squares: f64 = readings.iter().map(|reading| (reading - first - off) * (reading - first - off)).sum();
        if squares == 0.0 {
            let help = "they are as uncertain as their last digit at least: give `value = …` with `u = …`";
            return self.refuse(bad("all readings are the same", help), values.span());
        }
        let mean = Spanned::new(values.span(), DeValue::String((first + off).to_string().into()));
        let standard = (squares / (n - 1.0) / n).sqrt();
        Some(Readings { mean, uncertainty: Uncertainty { dof: n - 1.0, ..Uncertainty::standard(standard) } })
    }

    /// Notes the uncertainty of readings; for an angle that is written as a length, `degrees_per_mm` converts it.
    pub(super) fn note_readings(&mut self, readings: &Readings, source: Influence, degrees_per_mm: Option<f64>) {
        let standard = readings.uncertainty.standard * degrees_per_mm.unwrap_or(1.0);
        let value = Uncertainty { standard, ..readings.uncertainty };
        self.uncertainties.push((source, Located { value, span: readings.mean.span() }));
    }

    /// Reads the uncertainty in a table, if it has one; for an angle that is written as a length, `degrees_per_mm` converts it.
    pub(super) fn note_uncertainty(
        &mut self,
        name: &str,
        table: &DeTable<'_>,
        span: Range<usize>,
        source: Influence,
        degrees_per_mm: Option<f64>,
    ) -> Option<()> {
        let (is_angle, scale) = (source.is_angle() && degrees_per_mm.is_none(), degrees_per_mm.unwrap_or(1.0));
        UNCERTAINTY_KEYS.iter().find(|key| table.contains_key(**key))?;
        let has = |key: &str| table.contains_key(key);
        let bad = |message: String| Diagnostic::error(Code::BadUncertainty, message).help(HELP);
        if let Some(problem) = contradiction(name, table) {
            return self.refuse(bad(problem), span);
        }
        let magnitude = |reader: &mut Self, key: &str| {
            let value = table.get(key)?;
            let number = reader.base_value(key, value, is_angle)?;
            if number < 0.0 {
                return reader.refuse(bad(format!("`{key}` of `{name}` is negative")), value.span());
            }
            Some(number * scale)
        };
        let distribution = table.get("distribution").map(|value| self.distribution(value));
        let distribution = distribution.unwrap_or(Some(Distribution::Normal))?;
        let mut uncertainty = if has("u") {
            Uncertainty { distribution, ..Uncertainty::standard(magnitude(self, "u")?) }
        } else if has("U") {
            let (expanded, k) = (magnitude(self, "U"), table.get("k").and_then(|value| self.positive("k", value)));
            Uncertainty { distribution, ..Uncertainty::expanded(expanded?, k?) }
        } else {
            Uncertainty::half_width(magnitude(self, "half_width")?, distribution)
        };
        uncertainty.is_dof_stated = has("dof") || has("half_width") || distribution != Distribution::Normal;
        if let Some(value) = table.get("dof") {
            uncertainty.dof = if is_infinite(value) { f64::INFINITY } else { self.positive("dof", value)? };
            if uncertainty.dof < 1.0 || distribution != Distribution::Normal {
                let dof = uncertainty.dof;
                let what = if dof < 1.0 { "at least 1 is needed" } else { "only a normal distribution has them" };
                return self.refuse(bad(format!("`{name}` has {dof} degrees of freedom: {what}")), value.span());
            }
        }
        self.uncertainties.push((source, Located { value: uncertainty, span }));
        Some(())
    }

    pub(super) fn distribution(&mut self, value: &Spanned<DeValue<'_>>) -> Option<Distribution> {
        let all = [Distribution::Normal, Distribution::Rectangular, Distribution::Triangular, Distribution::Arcsine];
        let text = self.text_value("distribution", value, "a word in quotes")?;
        let found = all.into_iter().find(|distribution| distribution.name() == text);
        if found.is_none() {
            let message = format!("\"{text}\" is no distribution: write normal, rectangular, triangular or arcsine");
            self.report(Diagnostic::error(Code::BadUncertainty, message), value.span());
        }
        found
    }

    /// A number above 0.
    fn positive(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<f64> {
        let number = self.plain_number(name, value)?;
        if number > 0.0 {
            return Some(number);
        }
        let message = format!("`{name}` is {number}; it must be above 0");
        self.refuse(Diagnostic::error(Code::OutOfDomain, message), value.span())
    }
}

/// Whether a number is written as `inf`.
fn is_infinite(value: &Spanned<DeValue<'_>>) -> bool {
    matches!(value.get_ref(), DeValue::Float(float) if matches!(float.as_str(), "inf" | "+inf"))
}

/// Why the keys of a table make no uncertainty; `None` if they do.
fn contradiction(name: &str, table: &DeTable<'_>) -> Option<String> {
    let has = |key: &str| table.contains_key(key);
    let ways = [has("u"), has("U"), has("half_width")];
    match ways.iter().filter(|way| **way).count() {
        0 => Some(format!("`{name}` has {} but no uncertainty that it is of", first_of(table))),
        1 if has("U") != has("k") => Some(format!(
            "`{name}`: an expanded uncertainty U and its coverage factor k belong together: {} is missing",
            if has("U") { "k" } else { "U" }
        )),
        1 if has("half_width") && !has("distribution") => {
            Some(format!("`{name}`: a half-width says nothing without its distribution"))
        }
        1 if has("half_width") && has("dof") => {
            Some(format!("`{name}`: a half-width has no degrees of freedom: its distribution is known"))
        }
        1 => None,
        _ => Some(format!("`{name}` has more than one uncertainty")),
    }
}

/// The first of the keys that belong to an uncertainty.
fn first_of(table: &DeTable<'_>) -> &'static str {
    UNCERTAINTY_KEYS.into_iter().find(|key| table.contains_key(*key)).unwrap_or("keys")
}

/// Reads every `[[correlation]]`.
pub(super) fn correlations(reader: &mut SectionReader<'_>) -> Vec<Located<WrittenCorrelation>> {
    let Some(value) = reader.table.get("correlation") else { return Vec::new() };
    let DeValue::Array(entries) = value.get_ref() else {
        reader.wrong_type::<()>("correlation", value, "tables, each under a line `[[correlation]]`,");
        return Vec::new();
    };
    entries.iter().filter_map(|entry| correlation(reader, entry)).collect()
}

fn correlation(reader: &mut SectionReader<'_>, entry: &Spanned<DeValue<'_>>) -> Option<Located<WrittenCorrelation>> {
    const HELP: &str = "write between = [\"rack_pitch\", \"pinion_pitch\"] and coefficient = 0.5";
    let DeValue::Table(table) = entry.get_ref() else {
        return reader.wrong_type("correlation", entry, "a table under a line `[[correlation]]`");
    };
    reader.inner(&keys::CORRELATION, table, |reader| {
        let bad = |message: &str| Diagnostic::error(Code::BadUncertainty, message).help(HELP);
        let Some(between) = table.get("between") else {
            return reader.refuse(bad("this correlation does not say between what"), entry.span());
        };
        let names = match between.get_ref() {
            DeValue::Array(names) if names.len() == 2 => names,
            _ => return reader.refuse(bad("`between` is not a list of two names"), between.span()),
        };
        let [a, b] = [0, 1].map(|index| names.get(index).and_then(|name| source_named(reader, name)));
        let Some(value) = table.get("coefficient") else {
            return reader.refuse(bad("this correlation has no coefficient"), entry.span());
        };
        let coefficient = reader.plain_number("coefficient", value)?;
        let between = (a?, b?);
        if !(-1.0..=1.0).contains(&coefficient) || between.0 == between.1 {
            let problem = UncertaintyError::Coefficient { of: between, coefficient };
            return reader.refuse(bad(&problem.to_string()), value.span());
        }
        Some(Located { value: WrittenCorrelation { between, coefficient }, span: entry.span() })
    })
}

/// The source of a name: its whole key, or the part behind the section if only one key has it.
fn source_named(reader: &mut SectionReader<'_>, name: &Spanned<DeValue<'_>>) -> Option<Influence> {
    let text = reader.text_value("between", name, "the name of a value in quotes")?;
    let short = |source: &Influence| source.key().split_once('.').map_or(source.key(), |(_, name)| name);
    if let Some(source) = Influence::ALL.into_iter().find(|source| source.key() == text) {
        return Some(source);
    }
    let mut matching = Influence::ALL.into_iter().filter(|source| short(source) == text);
    if let (Some(source), None) = (matching.next(), matching.next()) {
        return Some(source);
    }
    let message = format!("\"{text}\" names no value that may be uncertain");
    let names = Influence::ALL.iter().flat_map(|source| [source.key(), short(source)]);
    let help = format!("the names are {}", Influence::ALL.map(Influence::key).join(", "));
    reader.refuse(Diagnostic::error(Code::UnknownKey, message).help(nearest_or(text, names, || help)), name.span())
}

impl Spec {
    /// The inputs of the over-roller nominal, if the spec has it computed.
    #[must_use]
    pub fn over_pin(&self) -> Option<OverPin> {
        let written = said_of(&self.errors, DeviationKind::RackOverRoller)?;
        let WrittenError::OverRoller { roller, .. } = &written.value else { return None };
        self.over_pin_of(*roller, &mut Problems::default(), &|| (String::new(), None))
    }

    /// The uncertainties of the values that ΔCD of the given errors follows from.
    ///
    /// # Errors
    /// A diagnostic for correlations of values without an uncertainty, or that contradict each other.
    pub fn uncertainties(&self) -> Result<Uncertainties, Diagnostics> {
        self.uncertainties_of(&self.kinds())
    }

    /// The uncertainties of the values that ΔCD of errors of these kinds follows from, wherever their values stand.
    ///
    /// # Errors
    /// As [`uncertainties`](Self::uncertainties).
    pub fn uncertainties_of(&self, kinds: &[DeviationKind]) -> Result<Uncertainties, Diagnostics> {
        let follows = self.followed_by(kinds);
        let of_known_teeth = |source: Influence| self.teeth_sensitivities.iter().any(|teeth| teeth.source == source);
        let counts = |source: Influence| of_known_teeth(source) || follows(source);
        let inputs: Vec<_> = self
            .uncertainties
            .iter()
            .filter(|(source, _)| counts(*source))
            .map(|(source, written)| (*source, written.value))
            .collect();
        let mut correlations = Vec::new();
        for written in &self.correlations {
            let WrittenCorrelation { between: (a, b), coefficient } = written.value;
            for source in [a, b] {
                if said_of(&self.uncertainties, source).is_none() {
                    let problem = UncertaintyError::Unknown(source).to_string();
                    return Err(Diagnostic::error(Code::BadUncertainty, problem)
                        .at(&self.source, written.span.clone(), "")
                        .help(format!("give `{}` an uncertainty: {{ value = …, u = … }}", source.key()))
                        .into());
                }
            }
            if counts(a) && counts(b) {
                correlations.push((a, b, coefficient));
            }
        }
        Uncertainties::new(inputs, &correlations).map_err(|problem| {
            let place = self.correlations.first().map(|written| written.span.clone());
            Diagnostic::error(Code::BadUncertainty, problem.to_string()).at(&self.source, place, "").into()
        })
    }

    /// The inputs of ΔCD for errors of these kinds.
    fn followed_by(&self, kinds: &[DeviationKind]) -> impl Fn(Influence) -> bool {
        let given = DeviationKind::ALL.map(|kind| kinds.contains(&kind));
        let given = move |kind: DeviationKind| given[kind as usize];
        let pitch = given(DeviationKind::RackPitch) || given(DeviationKind::RackLead);
        let of_pinion = given(DeviationKind::PinionPitch) || given(DeviationKind::PinionLead);
        let nominal = given(DeviationKind::RackOverRoller) && self.over_pin().is_some();
        // the path of contact follows from these
        let of_pair = !kinds.is_empty() && self.missing_geometry().is_empty();
        move |source: Influence| match source {
            Influence::Error(kind) => given(kind),
            Influence::NormalPressureAngle => of_pair || pitch || of_pinion || nominal,
            Influence::RackHelixAngle => of_pair || pitch,
            Influence::FaceWidth => of_pair || given(DeviationKind::RackLead),
            Influence::PinionHelixAngle => of_pair || of_pinion,
            Influence::NormalModule | Influence::ToothThickness => of_pair || nominal,
            Influence::Datum | Influence::Roller => nominal,
        }
    }

    /// What a verdict by `rule` on errors of these kinds, and on teeth that are known one by one, assumes of uncertainties. No
    /// correlation can be stated for the values of such teeth.
    #[must_use]
    pub fn unstated(&self, kinds: &[DeviationKind], has_teeth: bool, rule: &Rule) -> Vec<Unstated> {
        let is_involute = self.get(keys::PINION_ROOT_FORM_DIAMETER).is_none() && self.is_undercut() == Some(true);
        let root_form = is_involute.then_some(Unstated::RootForm);
        let is_written = |kind: &DeviationKind| self.extents.iter().any(|(of, _)| of == kind);
        let extent = (!kinds.iter().all(is_written)).then_some(Unstated::Extent);
        let of_gear = root_form.into_iter().chain(self.left_out()).chain(extent);
        if !rule.needs_uncertainty() {
            return of_gear.collect();
        }
        let follows = self.followed_by(kinds);
        let of_teeth = |source| has_teeth && !matches!(source, Influence::Datum | Influence::Roller);
        let counts = |source: Influence| of_teeth(source) || follows(source);
        let uncertain: Vec<_> = self
            .uncertainties
            .iter()
            .filter(|(source, written)| counts(*source) && written.value.standard > 0.0)
            .collect();
        let is_correlated = |a: Influence, b: Influence| {
            self.correlations.iter().any(|written| [(a, b), (b, a)].contains(&written.value.between))
        };
        let pairs = uncertain
            .iter()
            .enumerate()
            .flat_map(|(index, of)| uncertain[..index].iter().map(move |other| (of, other)));
        let is_exact = |source: &Influence| {
            !matches!(source, Influence::Error(_)) && counts(*source) && said_of(&self.uncertainties, *source).is_none()
        };
        [
            (Unstated::Freedom, uncertain.iter().any(|(_, written)| !written.value.is_dof_stated)),
            (Unstated::Correlation, has_teeth || { pairs }.any(|(of, other)| !is_correlated(of.0, other.0))),
            (Unstated::Size, Influence::ALL.iter().any(is_exact)),
        ]
        .into_iter()
        .filter_map(|(what, is_unstated)| is_unstated.then_some(what))
        .chain(of_gear)
        .collect()
    }

    /// The defaults of gear keys that the spec leaves out.
    fn left_out(&self) -> impl Iterator<Item = Unstated> {
        let lacks_helix = self.get(keys::RACK_HELIX_ANGLE).is_none() && self.get(keys::PAIR_SHAFT_ANGLE).is_none();
        let lacks_shift = self.get(keys::PINION_PROFILE_SHIFT).is_none();
        let thickness = [keys::RACK_TOOTH_THICKNESS, keys::PINION_TOOTH_THICKNESS_DEVIATION];
        let form = [keys::RACK_CROWNING, keys::PINION_CROWNING, keys::PINION_PROFILE_SLOPE];
        let lacks_form =
            form.into_iter().any(|key| self.get(key).is_none()) || self.place(keys::RACK_TIP_RELIEF).is_none();
        let left_out = [
            (Unstated::Zero, lacks_helix || lacks_shift || self.get(keys::PINION_HELIX_ANGLE).is_none()),
            (Unstated::FixedRack, self.place(keys::SUPPORT_ROLL).is_none()),
            (Unstated::Thickness, thickness.into_iter().any(|key| self.get(key).is_none())),
            (Unstated::Form, lacks_form),
        ];
        left_out.into_iter().filter_map(|(what, is_left_out)| is_left_out.then_some(what))
    }

    /// Whether values of this kind of error have an uncertainty.
    #[must_use]
    pub fn is_uncertain(&self, kind: DeviationKind) -> bool {
        said_of(&self.uncertainties, Influence::Error(kind)).is_some()
    }

    /// The note on values without an uncertainty where others have one: they are taken as exact, or a rule refuses them.
    #[must_use]
    pub fn note_of_exact(&self, kinds: &[DeviationKind], refused_by: Option<&Rule>) -> Option<String> {
        if self.uncertainties.is_empty() || kinds.is_empty() {
            return None;
        }
        let keys = DeviationKind::keys(kinds.iter().copied());
        Some(match refused_by {
            None => format!("taken as exact, because no uncertainty is given: {keys}"),
            Some(rule) => {
                format!(
                    "no uncertainty is given, and the rule {rule} needs one: {keys}; u = 0 in [errors] says that a value is \
                     exact, --partial of tables takes these so"
                )
            }
        })
    }

    /// The measured errors, which are uncertain in reality, without an uncertainty in the spec.
    #[must_use]
    pub fn taken_as_exact(&self) -> Vec<DeviationKind> {
        let measured = self.errors.iter().filter(|(_, written)| !written.value.is_permitted());
        let single = measured.map(|(kind, _)| *kind).filter(|kind| !self.is_uncertain(*kind));
        single.chain(self.teeth_taken_as_exact.iter().copied()).collect()
    }
}

#[cfg(test)]
mod tests;
