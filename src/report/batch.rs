//! The summary of a batch: counts, statistics of each result, the worst parts.

use serde_json::{Value, json};

use super::number::{millimetres, plain};
use super::{Block, Column, Report, Table};
use crate::batch::{Outcome, Part, Plan, QUANTILES, Statistics};
use crate::decision::Verdict;
use crate::decision::capability::{Index, performance};

/// A batch's outcome with what it was held against.
#[derive(Debug)]
pub struct BatchReport<'a> {
    title: Option<&'a str>,
    plan: &'a Plan,
    outcome: &'a Outcome,
    quantities: Vec<Quantity<'a>>,
}

/// One result over all parts.
#[derive(Debug)]
struct Quantity<'a> {
    name: &'a str,
    statistics: &'a Statistics,
    limits: (Option<f64>, Option<f64>),
    pp: Option<Index>,
    ppk: Option<Index>,
}

impl<'a> BatchReport<'a> {
    /// The report of a batch that was run with statistics.
    #[must_use]
    pub fn new(title: Option<&'a str>, plan: &'a Plan, outcome: &'a Outcome) -> Self {
        let limits = plan.quantity_limits();
        let quantities =
            outcome.quantities.iter().zip(&outcome.statistics).zip(limits).map(|((name, statistics), limits)| {
                let moments = statistics.mean_mm().zip(statistics.standard_deviation_mm());
                let (pp, ppk) = moments.map_or((None, None), |(mean, deviation)| {
                    performance(statistics.count(), mean, deviation, limits.0, limits.1)
                });
                Quantity { name, statistics, limits, pp, ppk }
            });
        Self { title, plan, outcome, quantities: quantities.collect() }
    }

    fn counts(&self) -> [(&'static str, u64); 6] {
        let counts = &self.outcome.counts;
        [
            ("rows", counts.rows),
            ("pass", counts.pass),
            ("fail", counts.fail),
            ("indeterminate", counts.indeterminate),
            ("unjudged", counts.unjudged),
            ("rejected", counts.rejected),
        ]
    }

    fn counts_table(&self) -> Table {
        let rows = self.outcome.counts.rows;
        let shown =
            self.counts().into_iter().filter(|(name, count)| *count > 0 || matches!(*name, "rows" | "pass" | "fail"));
        let shown = shown.map(|(name, count)| {
            #[expect(clippy::cast_precision_loss, reason = "a share for people")]
            let share = if rows == 0 { 0.0 } else { 100.0 * count as f64 / rows as f64 };
            let name = if name == "unjudged" { "without a verdict" } else { name };
            // a part in a million that fails is not 0 %, and one that does not is not 100 %
            let share = if count > 0 && share < 0.01 {
                "< 0.01 %".to_owned()
            } else if count < rows && share > 99.99 {
                "> 99.99 %".to_owned()
            } else {
                format!("{share:.2} %")
            };
            vec![name.to_owned(), grouped(count), share]
        });
        Table {
            rows: shown.collect(),
            columns: vec![Column::text("parts"), Column::number("count"), Column::number("share")],
        }
    }

    fn statistics_table(&self) -> Table {
        let mm = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), millimetres);
        let index = |index: &Option<Index>| index.map_or_else(|| "-".to_owned(), |index| format!("{:.2}", index.value));
        let rows = self.quantities.iter().map(|quantity| {
            let statistics = quantity.statistics;
            let deviation = statistics.standard_deviation_mm();
            vec![
                quantity.name.trim_start_matches("delta_cd_").trim_end_matches("_mm").replace('_', " "),
                mm(statistics.mean_mm()),
                deviation.map_or_else(|| "-".to_owned(), |s| millimetres(s).trim_start_matches('+').to_owned()),
                mm(statistics.min_mm()),
                mm(statistics.quantile_mm(0.5)),
                mm(statistics.quantile_mm(0.99865)),
                mm(statistics.max_mm()),
                index(&quantity.pp),
                index(&quantity.ppk),
            ]
        });
        let columns =
            ["mean\n[mm]", "s\n[mm]", "min\n[mm]", "median\n[mm]", "99.865 %\n[mm]", "max\n[mm]", "Pp", "Ppk"];
        Table {
            rows: rows.collect(),
            columns: std::iter::once(Column::text("ΔCD")).chain(columns.map(Column::number)).collect(),
        }
    }

    fn worst_table(&self) -> Table {
        let rows = self.outcome.worst.iter().map(|part| {
            let (lower, upper) = part.result_mm;
            let result = if lower == upper {
                millimetres(upper)
            } else {
                format!("{} … {}", millimetres(lower), millimetres(upper))
            };
            vec![
                part.id.clone(),
                whereabouts(part),
                part.on.map_or_else(|| "-".to_owned(), |on| on.to_string()),
                result,
                if part.on.is_some() { millimetres(part.margin_mm) } else { "-".to_owned() },
                part.verdict.map_or("-", Verdict::name).to_owned(),
            ]
        });
        Table {
            rows: rows.collect(),
            columns: vec![
                Column::text("worst parts"),
                Column::text("where"),
                Column::text("limit on ΔCD"),
                Column::number("result\n[mm]"),
                Column::number("margin\n[mm]"),
                Column::text("verdict"),
            ],
        }
    }

    fn verdict(&self) -> Block {
        let counts = &self.outcome.counts;
        let rejected = if counts.rejected > 0 {
            format!("; {} of {} rows make no part", grouped(counts.rejected), grouped(counts.rows))
        } else {
            String::new()
        };
        let parts = counts.rows - counts.rejected;
        let judged_by = format!("(judged by {})", self.plan.stack());
        if counts.fail > 0 {
            let sentence = format!(
                "{} of {} parts are outside a limit {judged_by}{rejected}",
                grouped(counts.fail),
                grouped(parts)
            );
            return Block::Verdict(Verdict::Fail, sentence);
        }
        if counts.indeterminate > 0 {
            let sentence =
                format!("{} of {} parts are too near a limit{rejected}", grouped(counts.indeterminate), grouped(parts));
            return Block::Verdict(Verdict::Indeterminate, sentence);
        }
        if counts.unjudged > 0 || parts == 0 || counts.rejected > 0 {
            let why = if self.plan.limits().is_empty() { "there is no limit" } else { "not every row could be judged" };
            return Block::Note(format!("No verdict: {why}{rejected}."));
        }
        Block::Verdict(Verdict::Pass, format!("all {} parts are inside the limits {judged_by}", grouped(parts)))
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = vec![format!(
            "Model {}. Mean, s, min and max are exact to the digits shown; quantiles are within 0.05 % of the value. Pp and Ppk are of all parts, whatever their order.",
            self.plan.model()
        )];
        let quantities = self.quantities.iter();
        for quantity in
            quantities.filter(|quantity| quantity.statistics.count() > 0 && quantity.statistics.mean_mm().is_none())
        {
            notes.push(format!("{}: no statistics, because a value is beyond a metre", quantity.name));
        }
        if self.outcome.interrupted {
            notes.push("The run was interrupted: this is of the rows up to there.".to_owned());
        }
        notes
    }
}

/// Where a part's row is: file and line, or as the table calls it.
pub(super) fn whereabouts(part: &Part) -> String {
    match &part.place {
        Some(place) => format!("{}, {place}", part.file),
        None => format!("{}:{}", part.file, part.line),
    }
}

/// A count with its thousands apart.
pub(super) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn index_json(index: Option<Index>) -> Value {
    index.map_or(Value::Null, |index| json!({ "value": index.value, "lower_95": index.lower, "upper_95": index.upper }))
}

impl Report for BatchReport<'_> {
    fn json(&self) -> Value {
        let counts: serde_json::Map<_, _> =
            self.counts().into_iter().map(|(name, count)| (name.to_owned(), count.into())).collect();
        let results: Vec<_> = self
            .quantities
            .iter()
            .map(|quantity| {
                let statistics = quantity.statistics;
                let quantiles: Vec<_> =
                    QUANTILES.iter().map(|q| json!({ "share": q, "value_mm": statistics.quantile_mm(*q) })).collect();
                json!({
                    "name": quantity.name,
                    "count": statistics.count(),
                    "mean_mm": statistics.mean_mm(),
                    "standard_deviation_mm": statistics.standard_deviation_mm(),
                    "min_mm": statistics.min_mm(),
                    "max_mm": statistics.max_mm(),
                    "quantiles": quantiles,
                    "limit_lower_mm": quantity.limits.0,
                    "limit_upper_mm": quantity.limits.1,
                    "pp": index_json(quantity.pp),
                    "ppk": index_json(quantity.ppk),
                })
            })
            .collect();
        let worst: Vec<_> = self
            .outcome
            .worst
            .iter()
            .map(|part| {
                json!({
                    "part_id": part.id,
                    "file": &*part.file,
                    "line": part.line,
                    "record": part.record,
                    "place": part.place,
                    "limit_on": part.on.map(crate::decision::LimitTarget::key),
                    "result_lower_mm": part.result_mm.0,
                    "result_upper_mm": part.result_mm.1,
                    "margin_mm": part.on.map(|_| part.margin_mm),
                    "verdict": part.verdict.map(Verdict::name),
                })
            })
            .collect();
        json!({
            "title": self.title,
            "model": self.plan.model().name(),
            "stack": self.plan.stack().name(),
            "counts": counts,
            "results": results,
            "worst": worst,
            "interrupted": self.outcome.interrupted,
            "notes": self.notes(),
        })
    }

    /// One row per result.
    fn rows(&self) -> Vec<Vec<String>> {
        let mut header: Vec<String> =
            ["name", "count", "mean_mm", "standard_deviation_mm", "min_mm", "max_mm"].map(str::to_owned).to_vec();
        header.extend(QUANTILES.iter().map(|q| format!("q{q}_mm")));
        header.extend(["limit_lower_mm", "limit_upper_mm", "pp", "ppk"].map(str::to_owned));
        header.extend(self.counts().map(|(name, _)| name.to_owned()));
        let number = |value: Option<f64>| value.map(plain).unwrap_or_default();
        let mut rows = vec![header];
        for quantity in &self.quantities {
            let statistics = quantity.statistics;
            let mut row = vec![
                quantity.name.to_owned(),
                statistics.count().to_string(),
                number(statistics.mean_mm()),
                number(statistics.standard_deviation_mm()),
                number(statistics.min_mm()),
                number(statistics.max_mm()),
            ];
            row.extend(QUANTILES.iter().map(|q| number(statistics.quantile_mm(*q))));
            row.extend([number(quantity.limits.0), number(quantity.limits.1)]);
            row.extend([quantity.pp, quantity.ppk].map(|index| number(index.map(|index| index.value))));
            row.extend(self.counts().map(|(_, count)| count.to_string()));
            rows.push(row);
        }
        rows
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        blocks.extend(self.title.map(|title| Block::Title(title.to_owned())));
        blocks.push(Block::Table(self.counts_table()));
        if self.outcome.counts.rows > self.outcome.counts.rejected {
            blocks.push(Block::Table(self.statistics_table()));
            blocks.push(Block::Table(self.worst_table()));
        }
        blocks.extend(self.notes().into_iter().map(Block::Note));
        blocks.push(self.verdict());
        blocks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        for (count, text) in [(0, "0"), (999, "999"), (1000, "1,000"), (1_234_567, "1,234,567")] {
            assert_eq!(grouped(count), text);
        }
    }
}
