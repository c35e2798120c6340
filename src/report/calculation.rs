//! The report of `calc`: one formula, one number.

use serde_json::{Value, json};

use super::number::{padded, plain_padded, truncated};
use super::{Block, Report, Table, bound_note, fact};
use crate::deviation::{DeviationKind, DeviationValue, Extent};
use crate::formula::{FormulaPage, Model};
use crate::judge::Interval;
use crate::judge::bound::{AssumedHeight, NoBound, Note};
use crate::quantity::{Angle, Length, Unit, plain, tidy};

/// One formula evaluated once.
#[derive(Debug, Clone)]
pub struct Calculation {
    /// The formula, as `explain` knows it.
    pub formula: &'static FormulaPage,
    /// The result, by the chosen model if there is a choice.
    pub result: DeviationValue,
    /// The chosen model; `None` if both models agree.
    pub model: Option<Model>,
    /// The result of the other model.
    pub other: Option<DeviationValue>,
    /// The unit of the result.
    pub unit: ResultUnit,
    /// Printed decimals; `None` for all of them, and at least six.
    pub decimals: Option<usize>,
    /// Whether the result is the largest value allowed, so that it must not be rounded up.
    pub is_bound: bool,
    /// The worst case of the error, or the largest error by it.
    pub worst_case: Option<WorstCase>,
    /// Remarks on the result's validity.
    pub notes: Vec<String>,
}

/// The worst case of an error for a pair of which only the inputs of the formula are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstCase {
    /// The kind of error.
    pub kind: DeviationKind,
    /// On which teeth it is.
    pub extent: Extent,
    /// The result.
    pub result: Result<WorstCaseResult, NoBound>,
}

/// The question to a worst case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WorstCaseResult {
    /// The lowest and the highest ΔCD of an error.
    DeltaCd(Interval),
    /// The largest error of either sign within a ΔCD.
    Error(DeviationValue),
}

impl WorstCase {
    /// Its extent in words.
    fn on(&self) -> String {
        self.extent.words(self.kind.counts(), None)
    }
}

/// The unit of a result, in the spelling in which it was asked for.
#[derive(Debug, Clone)]
pub struct ResultUnit {
    /// The unit.
    pub unit: Unit,
    /// Its spelling.
    pub spelling: String,
}

impl ResultUnit {
    /// The fewest decimals that show a nanometre, or a millionth of a degree.
    #[must_use]
    pub fn decimals(&self) -> usize {
        let steps = match self.unit {
            Unit::Length(unit) => Length::from_fm(1_000_000).in_unit(unit),
            Unit::Angle(unit) => Angle::from_nas(3_600_000).in_unit(unit),
        };
        let finest = |decimal: f64| decimal <= steps * (1.0 + 1e-9);
        std::iter::successors(Some(1.0), |decimal| Some(decimal / 10.0)).take(12).position(finest).unwrap_or(12)
    }
}

/// What a bound of one formula assumes, in words; `None` for remarks that only apply to the spec of a pair.
#[must_use]
pub fn formula_note(note: &Note) -> Option<String> {
    Some(match note {
        Note::BothFlanksNarrows => return None,
        Note::GeometryNarrows => {
            "the pair's geometry would narrow the worst case: `rackmesh eval` takes a spec with it".to_owned()
        }
        Note::GeometryNeeded => {
            "there is no worst case without the pair's geometry: `rackmesh eval` takes a spec with it".to_owned()
        }
        Note::AssumedHeight(AssumedHeight { mm, .. }) => format!(
            "flanks are taken to touch within {} mm over and under the reference plane, a quarter of the face width: a module \
             above two thirds of that can leave the range",
            plain(tidy(*mm))
        ),
        Note::WholeTeeth => {
            "pitch deviations of several teeth are shifts of whole teeth; where flank sides deviate apart, \
                             compute F_p with --extent total"
                .to_owned()
        }
        other => bound_note(other, &[]),
    })
}

impl Calculation {
    /// The value in the unit asked for.
    fn number(&self, value: DeviationValue) -> f64 {
        match (value, self.unit.unit) {
            (DeviationValue::Length(length), Unit::Length(unit)) => length.in_unit(unit),
            (DeviationValue::Angle(angle), Unit::Angle(unit)) => angle.in_unit(unit),
            // the dimension of a result is that of its unit
            (value, _) => value.base(),
        }
    }

    fn value_text(&self, value: DeviationValue) -> String {
        let number = self.number(value);
        let text = match self.decimals {
            Some(decimals) => padded(number, decimals).unwrap_or_else(|| {
                if self.is_bound { truncated(number, decimals) } else { format!("{number:.decimals$}") }
            }),
            None => plain_padded(number, 6),
        };
        format!("{text} {}", self.unit.spelling)
    }

    /// Both ends in the unit of the result, or one if they are equal.
    fn range_text(&self, Interval { lower, upper }: Interval) -> String {
        let end = |end: Length| {
            let text = self.value_text(end.into());
            if end > Length::ZERO { format!("+{text}") } else { text }
        };
        let unit = format!(" {}", self.unit.spelling);
        if lower == upper { end(upper) } else { format!("{} … {}", end(lower).trim_end_matches(&unit), end(upper)) }
    }

    fn worst_case_text(&self, result: WorstCaseResult) -> String {
        match result {
            WorstCaseResult::DeltaCd(range) => self.range_text(range),
            WorstCaseResult::Error(error) => format!("at most {} of either sign", self.value_text(error)),
        }
    }

    /// The worst case of the error, or the largest error by it, and on which teeth; `None` for a formula without an error.
    #[must_use]
    pub fn worst_case_remark(&self) -> Option<String> {
        let worst_case = self.worst_case?;
        let on = worst_case.on();
        Some(match worst_case.result {
            Ok(result) => format!("worst case: {} ({on})", self.worst_case_text(result)),
            Err(open) => format!("worst case: open ({on}): {open}"),
        })
    }

    /// Whether the worst case is more than the value, or allows less than it.
    #[must_use]
    pub fn is_worse(&self) -> bool {
        let is_alone = |result| match result {
            WorstCaseResult::DeltaCd(Interval { lower, upper }) => {
                lower == upper && self.result == DeviationValue::Length(upper)
            }
            WorstCaseResult::Error(error) => error == self.result.abs(),
        };
        self.worst_case.is_some_and(|worst_case| !worst_case.result.is_ok_and(is_alone))
    }

    /// The number and its unit.
    #[must_use]
    pub fn line(&self) -> String {
        self.value_text(self.result)
    }

    /// The model of the number, and the other model's result; `None` if both models agree.
    #[must_use]
    pub fn model_remark(&self) -> Option<String> {
        let (model, other) = (self.model?, self.other?);
        let other_model = model.other();
        if !self.formula.is_of_paper() {
            return Some(format!("model: {model} (the paper has no formula of this error: both models take this one)"));
        }
        Some(if other == self.result {
            format!("model: {model} (the {other_model} model gives the same)")
        } else {
            format!("model: {model} (the {other_model} model gives {})", self.value_text(other))
        })
    }

    /// The value by each model.
    #[must_use]
    pub fn by_each_model(&self) -> String {
        let named = |model: Option<Model>| model.map(|model| format!("{model} model: ")).unwrap_or_default();
        let mut text = format!("{}{}\n", named(self.model), self.line());
        if let (Some(model), Some(other)) = (self.model, self.other) {
            text.push_str(&format!("{}{}\n", named(Some(model.other())), self.value_text(other)));
        }
        if self.is_bound {
            text.push_str("This is the largest error within the ΔCD.\n");
        }
        text
    }
}

fn base_value(value: DeviationValue) -> (&'static str, f64) {
    match value {
        DeviationValue::Length(length) => ("value_mm", length.mm()),
        angle => ("value_deg", angle.base()),
    }
}

impl Report for Calculation {
    fn json(&self) -> Value {
        let (key, base) = base_value(self.result);
        let mut json = json!({
            "formula": self.formula.name,
            "equation": self.formula.equation(self.model.unwrap_or_default()),
            "model": self.model.map(Model::name),
            key: base,
            "value": self.number(self.result),
            "unit": self.unit.spelling,
        });
        if let (Some(model), Some(other)) = (self.model, self.other) {
            json[format!("{}_{key}", model.other())] = base_value(other).1.into();
        }
        if let Some(worst_case) = self.worst_case {
            json["extent"] = worst_case.extent.name().into();
            match worst_case.result {
                Ok(WorstCaseResult::DeltaCd(range)) => json["range_mm"] = json!(range),
                Ok(WorstCaseResult::Error(error)) => json[format!("worst_case_{key}")] = base_value(error).1.into(),
                Err(_) if self.is_bound => json[format!("worst_case_{key}")] = Value::Null,
                Err(_) => json["range_mm"] = Value::Null,
            }
        }
        json["notes"] = self.notes.clone().into();
        json
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let value = base_value(self.result).0;
        let worst_case = match self.worst_case {
            None => String::new(),
            Some(_) if self.is_bound => format!("extent worst_case_{value}"),
            Some(_) => "extent lower_mm=range_mm/lower upper_mm=range_mm/upper".to_owned(),
        };
        let names = format!("formula model {value} value unit {worst_case}");
        fact::rows(&json!({ "calculations": [self.json()] }), "calculations", &names)
    }

    fn blocks(&self) -> Vec<Block> {
        let other = self.model.zip(self.other).map(|(model, other)| (Some(model.other()), other));
        let values = Table::of(std::iter::once((self.model, self.result)).chain(other))
            .text("formula", |(model, _)| self.formula.equation(model.unwrap_or_default()))
            .text("model", |(model, _)| model.map(Model::name))
            .number("value", |(_, value)| self.value_text(*value));
        let text = |result| self.worst_case_text(result);
        let worst_case = Table::of(self.worst_case)
            .number("worst case", |worst_case| worst_case.result.map_or_else(|_| "open".to_owned(), text))
            .text("on", WorstCase::on);
        let notes = self.notes.iter().cloned().map(Block::Remark);
        std::iter::once(values.block()).chain(worst_case.block_if_any()).chain(notes).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::Law;
    use crate::formula::law::lead_slope;
    use crate::quantity::{AngleUnit, LengthUnit};

    fn quantity<Q: std::str::FromStr>(text: &str) -> Q {
        text.parse().ok().expect(text)
    }

    #[test]
    fn a_nanometre_and_a_millionth_of_a_degree_are_shown() {
        let decimals = |unit| ResultUnit { unit, spelling: String::new() }.decimals();
        for (unit, expected) in [("nm", 0), ("um", 3), ("mm", 6), ("cm", 7), ("m", 9), ("in", 8), ("mil", 5)] {
            assert_eq!(decimals(Unit::Length(LengthUnit::from_symbol(unit).unwrap())), expected, "{unit}");
        }
        for (unit, expected) in [("deg", 6), ("arcmin", 5), ("arcsec", 3), ("rad", 8), ("mrad", 5)] {
            assert_eq!(decimals(Unit::Angle(AngleUnit::from_symbol(unit).unwrap())), expected, "{unit}");
        }
    }

    #[test]
    fn the_largest_slope_deviation_holds_when_it_is_read_back_as_printed() {
        let law =
            Law::rack_lead(quantity("19.9"), Angle::ZERO, quantity("19.7")).expect("the gear data are in their domain");
        let (delta_cd, over): (Length, Length) = (quantity("20 um"), quantity("18"));
        for model in [Model::Exact, Model::Paper] {
            let result = law.largest_slope_deviation(delta_cd, over, model).expect("some f_Hβ reaches it");
            for (unit, decimals) in
                LengthUnit::ALL.into_iter().flat_map(|unit| (0..12).map(Some).chain([None]).map(move |n| (unit, n)))
            {
                let calculation = Calculation {
                    formula: law.page(),
                    result: result.into(),
                    model: Some(model),
                    other: None,
                    unit: ResultUnit { unit: Unit::Length(unit), spelling: unit.symbol().to_owned() },
                    decimals,
                    is_bound: true,
                    worst_case: None,
                    notes: Vec::new(),
                };
                let printed: Length = quantity(&calculation.line());
                let reached = law.delta_cd(lead_slope(printed, over).expect("a length"), model).expect("in its domain");
                assert!(reached <= delta_cd, "{} reaches {reached}", calculation.line());
                assert!(decimals.is_some() || printed == result, "{}", calculation.line());
            }
        }
    }
}
