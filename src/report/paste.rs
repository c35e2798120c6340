//! The reports of `paste`: several parts, or the spaces or teeth of one.

use serde_json::{Value, json};

use super::number::{deviation_number, millimetres};
use super::{Basis, BatchReport, Block, MeshReport, Report, RowsReport, Table, YokeSection, fact, titled, yokes_block};
use crate::batch::{Outcome, Part as BatchPart, Problem};
use crate::deviation::{DeviationKind, Part};
use crate::evaluation::REJECTED;
use crate::formula::law::equation;
use crate::function::FIGURES;
use crate::judge::{MeasuredPart, Verdict};

/// Several parts, a row each, as a batch judged them.
#[derive(Debug)]
pub struct PartsReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// The batch's rows; the first has the names of the columns.
    pub rows: &'a [Vec<String>],
    /// The parts of the rows behind the first, in their order.
    pub parts: &'a [BatchPart],
    /// Rows that make no part.
    pub problems: &'a [Problem],
    /// How the parts are judged.
    pub basis: &'a Basis,
    /// Their outcome.
    pub outcome: &'a Outcome,
}

/// The ends of the judged range, which JSON has as one range.
const JUDGED: [&str; 2] = ["lower_mm", "upper_mm"];
/// The columns of a part for people, in this order.
const SHOWN: [&str; 7] = ["part_id", "lower_mm", "upper_mm", "margin_mm", "nearest_limit", "verdict", "reason"];
const STANDARD: &str = "_standard_uncertainty_mm";

/// Whether a column is a length, not an uncertainty.
fn is_result(name: &str) -> bool {
    name.ends_with("_mm")
        && !["uncertainty", "monte_carlo"].iter().any(|word| name.contains(word))
        && FIGURES.iter().all(|(figure, _)| *figure != name)
}

impl PartsReport<'_> {
    /// The columns of a batch that it needs besides those that are always written.
    pub const ASKED_FOR: [&'static str; 3] = ["lower_mm", "upper_mm", "nearest_limit"];

    fn names(&self) -> &[String] {
        self.rows.first().map_or(&[], Vec::as_slice)
    }

    /// The rows with the columns of these names, in this order.
    fn of_columns<'n>(&self, names: impl Iterator<Item = &'n str>) -> Vec<Vec<String>> {
        let places: Vec<_> = names.filter_map(|name| self.names().iter().position(|own| own == name)).collect();
        let row = |row: &Vec<String>| places.iter().filter_map(|place| row.get(*place).cloned()).collect();
        self.rows.iter().map(row).collect()
    }

    /// A part, or a row that makes no part.
    fn fact(&self, name: &str, line: u64, part: Option<(&BatchPart, &Vec<String>)>, reason: Option<&str>) -> Value {
        let number = |name: &str| -> Option<f64> {
            let place = self.names().iter().position(|own| own == name)?;
            part.and_then(|(_, row)| row.get(place)?.parse().ok())
        };
        let mut fact = json!({ "part_id": name, "line": line });
        for name in self.names().iter().filter(|name| is_result(name) && !JUDGED.contains(&name.as_str())) {
            fact[name] = json!(number(name));
        }
        fact["verdict"] = part.and_then(|(part, _)| part.verdict).map(Verdict::name).into();
        fact["reason"] = reason.into();
        fact["judged_by"] = part.map(|(part, _)| part.judged_by.name()).into();
        let [lower, upper] = JUDGED.map(number);
        fact["judged_mm"] = json!(lower.zip(upper).map(|(lower, upper)| json!({ "lower": lower, "upper": upper })));
        let yoke = part.and_then(|(part, _)| part.yoke.as_deref()).zip(self.basis.yoke.as_ref());
        if let Some((yoke, judge)) = yoke {
            fact["yoke"] = YokeSection::of_part(yoke, judge).json();
        }
        fact["assumes"] = json!(part.map(|_| &self.basis.assumes));
        let uncertain = self.names().iter().filter_map(|name| name.strip_suffix(STANDARD));
        let results = uncertain.map(|of| {
            let key = of.strip_prefix("delta_cd_").or(of.split_once('_').map(|(_, end)| end)).unwrap_or(of);
            let expanded = number(&format!("{of}_expanded_uncertainty_mm"));
            json!({ "of": key, "standard_uncertainty_mm": number(&format!("{of}{STANDARD}")), "expanded_uncertainty_mm": expanded })
        });
        let results: Vec<_> = results.collect();
        if part.is_some() && !results.is_empty() {
            fact["uncertainty"] = json!({ "coverage": "95.45 %", "results": results });
        }
        fact
    }
}

impl Report for PartsReport<'_> {
    fn json(&self) -> Value {
        let parts = self.parts.iter().zip(self.rows.iter().skip(1)).map(|(part, row)| {
            (part.place.record, self.fact(&part.id, part.place.line, Some((part, row)), part.reason.as_deref()))
        });
        let problems = self.problems.iter().map(|problem| {
            let name = problem.part.clone().unwrap_or_else(|| problem.place.record.to_string());
            (problem.place.record, self.fact(&name, problem.place.line, None, Some(&problem.message)))
        });
        let mut all: Vec<_> = parts.chain(problems).collect();
        all.sort_by_key(|(record, _)| *record);
        json!({ "title": self.title, "parts": all.into_iter().map(|(_, fact)| fact).collect::<Vec<_>>() })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let is_own = |name: &&str| !Self::ASKED_FOR.contains(name);
        self.of_columns(self.names().iter().map(String::as_str).filter(is_own))
    }

    fn blocks(&self) -> Vec<Block> {
        let rows = self.of_columns(SHOWN.into_iter());
        let mut blocks = titled(self.title);
        if rows.len() > 1 {
            blocks.extend(RowsReport { rows: &rows, as_written: false, copied: 0 }.blocks());
        }
        let report = BatchReport::new(None, self.basis, self.outcome);
        blocks.extend(yokes_block(self.parts, "yoke of part").into_iter().chain(report.plug_table()));
        if self.basis.has_limits() {
            blocks.push(report.verdict());
        }
        blocks
    }
}

/// The measured spaces of a rack or teeth of a pinion, by the formulas.
#[derive(Debug)]
pub struct SpacesReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// The measured values.
    pub measured: &'a MeasuredPart,
    /// The exact mesh, if it is solved.
    pub mesh: Option<MeshReport<'a>>,
    /// Whether the status of the part rejects it.
    pub is_rejected: bool,
}

impl SpacesReport<'_> {
    fn place(&self) -> &'static str {
        if self.measured.part == Part::Rack { "space" } else { "tooth" }
    }
}

impl Report for SpacesReport<'_> {
    fn json(&self) -> Value {
        let measured = self.measured;
        let rows: Vec<_> = measured
            .rows
            .iter()
            .map(|row| {
                let mut fact = json!({ self.place(): row.number });
                for (feature, effect) in measured.features.iter().zip(&row.effects) {
                    let key = feature.key();
                    let unit = if feature.error() == DeviationKind::RackLead { "deg" } else { "mm" };
                    fact[format!("{key}_deviation_{unit}")] = effect.map(|effect| effect.deviation.base()).into();
                    fact[format!("delta_cd_{key}_mm")] = effect.map(|effect| effect.delta_cd.mm()).into();
                }
                fact
            })
            .collect();
        let (low, high) = measured.range();
        let mut formula = json!({
            "title": self.title,
            "part": measured.part.name(),
            "model": measured.model.name(),
            "rows": rows,
            "formula_range_mm": { "lower": low.mm(), "upper": high.mm() },
        });
        if self.is_rejected {
            formula["verdict"] = Verdict::Fail.name().into();
            formula["reason"] = REJECTED.into();
        }
        match &self.mesh {
            Some(mesh) => json!({ "formula": formula, "mesh": mesh.json() }),
            None => formula,
        }
    }

    /// What the formulas say: the curve is a table of its own, which `rackmesh mesh` writes.
    fn rows(&self) -> Vec<Vec<String>> {
        let mut header = self.place().to_owned();
        for feature in &self.measured.features {
            let unit = if feature.error() == DeviationKind::RackLead { "deg" } else { "mm" };
            header.push_str(&format!(" {key}_deviation_{unit} delta_cd_{key}_mm", key = feature.key()));
        }
        let json = self.json();
        fact::rows(json.get("formula").unwrap_or(&json), "rows", &header)
    }

    fn blocks(&self) -> Vec<Block> {
        let measured = self.measured;
        let mut blocks = titled(self.title);
        let mut table = Table::of(&measured.rows).number(self.place(), |row| row.number.to_string());
        for (index, feature) in measured.features.iter().enumerate() {
            let unit = if feature.error() == DeviationKind::RackLead { "°" } else { "µm" };
            table = table
                .number(format!("{}\n[{unit}]", feature.name()), |row| {
                    row.effects[index].as_ref().map(|effect| deviation_number(effect.deviation))
                })
                .number("ΔCD\n[mm]", |row| {
                    row.effects[index].as_ref().map(|effect| millimetres(effect.delta_cd.mm()))
                });
        }
        blocks.push(table.block());
        let of_features = measured.features.iter().enumerate().filter_map(|(index, feature)| {
            let (number, largest) = measured.largest(index)?;
            let unit = if feature.error() == DeviationKind::RackLead { "°" } else { " µm" };
            let largest = format!("{}{unit}, {} {number}", deviation_number(largest.deviation), self.place());
            Some((feature.name(), largest, measured.range_of(index)?, equation(feature.error(), measured.model)))
        });
        let together = ("together", String::new(), measured.range(), "");
        let by_formula = Table::of(of_features.chain([together]))
            .text("by formula", |(name, ..)| *name)
            .text("largest", |(_, largest, ..)| largest.clone())
            .number("ΔCD from\n[mm]", |(_, _, (low, _), _)| millimetres(low.mm()))
            .number("to\n[mm]", |(_, _, (_, high), _)| millimetres(high.mm()))
            .text(format!("formula ({})", measured.model), |(.., equation)| *equation);
        blocks.push(by_formula.block());
        blocks.extend(self.mesh.iter().flat_map(MeshReport::blocks));
        // the mesh says its own verdict
        let is_told = self.mesh.is_some() || !self.is_rejected;
        blocks.extend((!is_told).then(|| Block::Verdict(Some(Verdict::Fail), REJECTED.to_owned())));
        blocks
    }
}
