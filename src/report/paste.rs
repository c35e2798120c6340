//! The reports of `paste`: several parts, or the spaces or teeth of one.

use serde_json::{Value, json};

use super::evaluation::{assumed, assumptions_of};
use super::number::{millimetres, signed};
use super::uncertainty::micrometres;
use super::{
    Block, Column, MeshReport, Report, Table, UncertaintyPart, WITHOUT, add_new, fact, judged_without, keys_of, titled,
};
use crate::deviation::{DeviationKind, DeviationValue, Part};
use crate::evaluation::Evaluation;
use crate::formula::law::equation;
use crate::judge::{Interval, MeasuredPart, Stack, Verdict};
use crate::quantity::{Length, LengthUnit};
use crate::uncertainty::{Linear, Propagation};

/// One part of several.
#[derive(Debug)]
pub struct PartRow {
    /// Its name, or its number in the block.
    pub name: String,
    /// The line where it stands.
    pub line: usize,
    /// What was computed; `None` if its values cannot be read.
    pub evaluation: Option<Evaluation>,
    /// The uncertainty of its results, where uncertainties are given.
    pub uncertainty: Option<UncertaintyPart>,
}

/// Several parts, one row each.
#[derive(Debug)]
pub struct PartsReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// The parts.
    pub rows: &'a [PartRow],
    /// Errors that the spec asks for and the parts were judged without.
    pub without: &'a [DeviationKind],
}

impl PartsReport<'_> {
    fn kinds(&self) -> Vec<DeviationKind> {
        let present = |kind: &DeviationKind| {
            let mut evaluations = self.rows.iter().filter_map(|row| row.evaluation.as_ref());
            evaluations.any(|evaluation| evaluation.contributions.iter().any(|c| c.kind == *kind))
        };
        DeviationKind::ALL.into_iter().filter(present).collect()
    }

    fn is_uncertain(&self) -> bool {
        self.rows.iter().any(|row| row.uncertainty.is_some())
    }

    fn count(&self, verdict: Verdict) -> usize {
        let evaluations = self.rows.iter().filter_map(|row| row.evaluation.as_ref());
        evaluations.filter(|evaluation| evaluation.verdict == Some(verdict)).count()
    }
}

/// The ends of the combinations, by the names that `batch` gives them.
const ENDS: [&str; 4] = ["range_lower_mm", "range_upper_mm", "rss_lower_mm", "rss_upper_mm"];

fn ends(evaluation: Option<&Evaluation>) -> [Option<Length>; 4] {
    let interval = |stack| evaluation.and_then(|evaluation| evaluation.combined.interval(stack).ok());
    let (range, rss): (Option<Interval>, Option<Interval>) = (interval(Stack::Range), interval(Stack::Rss));
    [range.map(|r| r.lower), range.map(|r| r.upper), rss.map(|r| r.lower), rss.map(|r| r.upper)]
}

fn delta_cd(evaluation: &Evaluation, kind: DeviationKind) -> Option<Length> {
    let contribution = evaluation.contributions.iter().find(|contribution| contribution.kind == kind)?;
    Some(contribution.delta_cd(evaluation.model))
}

impl Report for PartsReport<'_> {
    fn json(&self) -> Value {
        let kinds = self.kinds();
        let parts: Vec<_> = self
            .rows
            .iter()
            .map(|row| {
                let mut part = json!({ "part_id": row.name, "line": row.line });
                let evaluation = row.evaluation.as_ref();
                for kind in &kinds {
                    let value = evaluation.and_then(|evaluation| delta_cd(evaluation, *kind));
                    part[format!("delta_cd_{}_mm", kind.key())] = json!(value);
                }
                for (name, end) in ENDS.into_iter().zip(ends(evaluation)) {
                    part[name] = json!(end);
                }
                part["verdict"] = evaluation.and_then(|evaluation| evaluation.verdict).map(Verdict::name).into();
                part["reason"] = match evaluation {
                    Some(evaluation) => evaluation.open_because().into(),
                    None => "a value cannot be read".into(),
                };
                part["judged_by"] = evaluation.map(|evaluation| evaluation.judged_by.name()).into();
                part["judged_mm"] = json!(evaluation.and_then(|evaluation| evaluation.judged.ok()));
                part["assumes"] = json!(evaluation.map(assumptions_of));
                if let Some(uncertainty) = &row.uncertainty {
                    part["uncertainty"] = uncertainty.json();
                }
                part
            })
            .collect();
        json!({ "title": self.title, "parts": parts })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let kinds = self.kinds();
        let own = |kind: &DeviationKind| format!("delta_cd_{}", kind.key());
        let mut names = vec!["part_id".to_owned()];
        names.extend(kinds.iter().map(|kind| own(kind) + "_mm"));
        names.extend(ENDS.into_iter().chain(["verdict", "reason"]).map(str::to_owned));
        if let Some(known) = self.rows.iter().find_map(|row| row.uncertainty.as_ref()) {
            let stack = known.propagation.stack.name();
            let ends = ["lower", "upper"].map(|end| (format!("{stack}_{end}"), end));
            for (name, of) in kinds.iter().map(|kind| (own(kind), kind.key())).chain(ends) {
                let cell = |u: &str| format!("{name}_{u}_uncertainty_mm={of}/{u}_uncertainty_mm");
                names.extend(["standard", "expanded"].map(cell));
            }
        }
        let mut json = self.json();
        for part in json["parts"].as_array_mut().into_iter().flatten() {
            part[WITHOUT] = keys_of(self.without).into();
            let results = part.pointer_mut("/uncertainty/results").map(Value::take);
            for result in results.iter().filter_map(Value::as_array).flatten() {
                part[result["of"].as_str().unwrap_or_default()] = result.clone();
            }
        }
        names.extend((!self.without.is_empty()).then(|| WITHOUT.to_owned()));
        fact::rows(&json, "parts", &names.join(" "))
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = titled(self.title);
        let kinds = self.kinds();
        let judged = self.rows.iter().filter_map(|row| row.evaluation.as_ref()).any(|e| !e.limits.is_empty());
        let end = |part: &PartRow, end: fn(Interval) -> Length| {
            let evaluation = part.evaluation.as_ref()?;
            let interval = evaluation.combined.interval(evaluation.stack);
            Some(interval.map_or_else(|_| "open".to_owned(), |interval| millimetres(end(interval).mm())))
        };
        let uncertainty = |part: &PartRow, end: fn(&Propagation) -> &Linear| {
            part.uncertainty.as_ref().and_then(|part| end(&part.propagation).expanded_mm()).map(micrometres)
        };
        let of_kind = |part: &PartRow, kind| {
            let delta_cd = part.evaluation.as_ref().and_then(|evaluation| delta_cd(evaluation, kind));
            delta_cd.map(|length| millimetres(length.mm()))
        };
        let table = kinds.iter().fold(Table::of(self.rows).text("part", |part| part.name.clone()), |table, kind| {
            table.number(format!("{}\n[mm]", kind.name()), |part| of_kind(part, *kind))
        });
        let table = table
            .number("ΔCD from\n[mm]", |part| end(part, |ends| ends.lower))
            .column_if(self.is_uncertain(), Column::number("± U\n[µm]"), |part| uncertainty(part, |of| &of.lower))
            .number("to\n[mm]", |part| end(part, |ends| ends.upper))
            .column_if(self.is_uncertain(), Column::number("± U\n[µm]"), |part| uncertainty(part, |of| &of.upper))
            .column_if(judged, Column::text("verdict"), |part| match &part.evaluation {
                Some(evaluation) => evaluation.verdict.map_or("open", Verdict::name),
                None => "not judged",
            });
        blocks.push(table.block());
        if let Some(evaluation) = self.rows.iter().find_map(|row| row.evaluation.as_ref()) {
            let stack = match evaluation.stack {
                Stack::Range => "from … to: the worst case, wherever on the teeth the errors are",
                Stack::Rss => "from … to: statistical, at one stroke",
            };
            blocks.push(Block::Note(format!("{stack}; formulas: {} model", evaluation.model)));
            if self.is_uncertain() {
                blocks.push(Block::Note("U: expanded uncertainty of that end, 95.45 %".to_owned()));
            }
        }
        let unread = self.rows.iter().filter(|row| row.evaluation.is_none()).count();
        if judged {
            let (pass, fail) = (self.count(Verdict::Pass), self.count(Verdict::Fail));
            let indeterminate = self.count(Verdict::Indeterminate);
            let open = self.rows.len() - unread - pass - fail - indeterminate;
            let passed = self.rows.iter().filter_map(|row| row.evaluation.as_ref());
            let passed = passed.filter(|evaluation| evaluation.verdict == Some(Verdict::Pass));
            let mut assumptions = Vec::new();
            add_new(&mut assumptions, passed.flat_map(assumptions_of));
            let assumed = assumed(&assumptions);
            let mut sentence = format!("{pass} of {} parts are within the limits{assumed}", self.rows.len());
            for (count, what) in
                [(indeterminate, "indeterminate"), (open, "without a verdict"), (unread, "could not be read")]
            {
                if count > 0 {
                    sentence.push_str(&format!(", {count} {what}"));
                }
            }
            sentence.push_str(&judged_without(self.without));
            let verdict = match self.rows.len() {
                _ if fail > 0 => Some(Verdict::Fail),
                all if pass == all => Some(Verdict::Pass),
                all if pass + indeterminate == all => Some(Verdict::Indeterminate),
                _ => None,
            };
            blocks.push(Block::Verdict(verdict, sentence));
        }
        blocks
    }
}

/// The measured spaces of a rack or teeth of a pinion, by the formulas.
#[derive(Debug)]
pub struct SpacesReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// What was measured.
    pub measured: &'a MeasuredPart,
    /// The exact mesh, if it is solved.
    pub mesh: Option<MeshReport<'a>>,
}

impl SpacesReport<'_> {
    fn place(&self) -> &'static str {
        if self.measured.part == Part::Rack { "space" } else { "tooth" }
    }
}

fn deviation_text(value: DeviationValue) -> String {
    match value {
        DeviationValue::Length(length) => signed(length.in_unit(LengthUnit::Micrometre), 1),
        angle => signed(angle.base(), 4),
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
        let formula = json!({
            "title": self.title,
            "part": measured.part.name(),
            "model": measured.model.name(),
            "rows": rows,
            "formula_range_mm": { "lower": low.mm(), "upper": high.mm() },
        });
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
                    row.effects[index].as_ref().map(|effect| deviation_text(effect.deviation))
                })
                .number("ΔCD\n[mm]", |row| {
                    row.effects[index].as_ref().map(|effect| millimetres(effect.delta_cd.mm()))
                });
        }
        blocks.push(table.block());
        let of_features = measured.features.iter().enumerate().filter_map(|(index, feature)| {
            let (number, largest) = measured.largest(index)?;
            let unit = if feature.error() == DeviationKind::RackLead { "°" } else { " µm" };
            let largest = format!("{}{unit}, {} {number}", deviation_text(largest.deviation), self.place());
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
        blocks
    }
}
