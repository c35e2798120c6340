//! The report of `calc`: one formula, one number.

use serde_json::{Value, json};

use super::number::{plain, plain_padded, truncated};
use super::{Block, Column, Report, Table};
use crate::deviation::ErrorValue;
use crate::formula::Model;
use crate::quantity::{AngleUnit, LengthUnit};

/// One formula evaluated once.
#[derive(Debug, Clone)]
pub struct Calculation {
    /// The formula's name, as `explain` knows it.
    pub formula: &'static str,
    /// What was computed, by the chosen model if there is a choice.
    pub result: Computed,
    /// The chosen model; `None` if the formula has one reading only.
    pub model: Option<Model>,
    /// What the other model gives.
    pub other: Option<Computed>,
    /// The unit of the result.
    pub unit: ResultUnit,
    /// Decimals of the result; `None` for all of them, and at least six.
    pub decimals: Option<usize>,
    /// Whether the result is the largest value allowed, so that it must not be rounded up.
    pub is_bound: bool,
}

/// A value and how it came about.
#[derive(Debug, Clone)]
pub struct Computed {
    /// The equation in symbols: `ΔCD = |Δp| / (2 tan α_n)`.
    pub equation: String,
    /// Its right-hand side with the numbers put in.
    pub with_numbers: String,
    /// The value.
    pub value: ErrorValue,
}

/// The unit of a result, in the spelling in which it was asked for.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum ResultUnit {
    /// A length.
    Length(LengthUnit, String),
    /// An angle.
    Angle(AngleUnit, String),
}

impl Calculation {
    /// The value in the unit asked for.
    fn number(&self, value: &ErrorValue) -> f64 {
        let base = match value {
            ErrorValue::Length(length) => length.exact_mm(),
            ErrorValue::Angle(angle) => angle.exact_degrees(),
        };
        let unit = match &self.unit {
            ResultUnit::Length(unit, _) => unit.in_mm(),
            ResultUnit::Angle(unit, _) => unit.in_degrees(),
        };
        let number = base / &unit;
        if self.is_bound { number.to_f64_toward_zero() } else { number.to_f64() }
    }

    fn unit_name(&self) -> &str {
        match &self.unit {
            ResultUnit::Length(_, name) | ResultUnit::Angle(_, name) => name,
        }
    }

    fn value_text(&self, value: &ErrorValue) -> String {
        let number = self.number(value);
        let text = match self.decimals {
            Some(decimals) if self.is_bound => truncated(number, decimals),
            Some(decimals) => format!("{number:.decimals$}"),
            None => plain_padded(number, 6),
        };
        format!("{text} {}", self.unit_name())
    }

    /// The number and its unit.
    #[must_use]
    pub fn line(&self) -> String {
        self.value_text(&self.result.value)
    }

    /// Which model the number is of, and what the other gives; `None` if there is one reading only.
    #[must_use]
    pub fn model_remark(&self) -> Option<String> {
        let (model, other) = (self.model?, self.other.as_ref()?);
        let other_model = if model == Model::Exact { Model::Paper } else { Model::Exact };
        Some(if other.value == self.result.value {
            format!("model: {model} (the {other_model} model gives the same)")
        } else {
            format!("model: {model} (the {other_model} model gives {})", self.value_text(&other.value))
        })
    }

    /// The formula, with the numbers put in, and its value.
    #[must_use]
    pub fn explanation(&self) -> String {
        let mut text = String::new();
        let mut model = self.model;
        for computed in std::iter::once(&self.result).chain(&self.other) {
            let left = computed.equation.split_once(" = ").map_or(0, |(left, _)| left.chars().count());
            if let Some(model) = model {
                text.push_str(&format!("{model} model\n"));
            }
            text.push_str(&format!(
                "  {}\n  {:left$} = {}\n  {:left$} = {}\n",
                computed.equation,
                "",
                computed.with_numbers,
                "",
                self.value_text(&computed.value)
            ));
            model = model.map(|model| if model == Model::Exact { Model::Paper } else { Model::Exact });
        }
        text.push_str(&format!("More: rackmesh explain {}\n", self.formula));
        text
    }
}

fn base_value(value: &ErrorValue) -> (&'static str, f64) {
    match value {
        ErrorValue::Length(length) => ("value_mm", length.mm()),
        ErrorValue::Angle(angle) => ("value_deg", angle.degrees()),
    }
}

impl Report for Calculation {
    fn json(&self) -> Value {
        let (key, base) = base_value(&self.result.value);
        let mut json = json!({
            "formula": self.formula,
            "equation": self.result.equation,
            "model": self.model.map(Model::name),
            key: base,
            "value": self.number(&self.result.value),
            "unit": self.unit_name(),
        });
        if let (Some(model), Some(other)) = (self.model, &self.other) {
            let name = if model == Model::Exact { "paper" } else { "exact" };
            json[format!("{name}_{key}")] = base_value(&other.value).1.into();
        }
        json
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let (key, base) = base_value(&self.result.value);
        let model = self.model.map(Model::name).unwrap_or_default();
        vec![
            ["formula", "model", key, "value", "unit"].map(str::to_owned).into(),
            [self.formula, model, &plain(base), &plain(self.number(&self.result.value)), self.unit_name()]
                .map(str::to_owned)
                .into(),
        ]
    }

    fn blocks(&self) -> Vec<Block> {
        let mut rows = vec![(self.model, &self.result)];
        if let (Some(model), Some(other)) = (self.model, &self.other) {
            let other_model = if model == Model::Exact { Model::Paper } else { Model::Exact };
            rows.push((Some(other_model), other));
        }
        let rows = rows.into_iter().map(|(model, computed)| {
            vec![computed.equation.clone(), model.map_or("-", Model::name).to_owned(), self.value_text(&computed.value)]
        });
        vec![Block::Table(Table {
            rows: rows.collect(),
            columns: vec![Column::text("formula"), Column::text("model"), Column::number("value")],
        })]
    }
}
