//! The reports of `paste`: several parts, or the spaces or teeth of one.

use serde_json::{Map, Value, json};

use super::number::{millimetres, signed};
use super::uncertainty::micrometres;
use super::{Block, Column, Report, Table, UncertaintyPart, fact, judged_without, titled};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::evaluation::Evaluation;
use crate::formula::law::equation;
use crate::judge::{Interval, MeasuredPart, Stack, Verdict};
use crate::quantity::{Length, LengthUnit};

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
                let mut part = Map::new();
                part.insert("part_id".to_owned(), row.name.as_str().into());
                part.insert("line".to_owned(), row.line.into());
                let evaluation = row.evaluation.as_ref();
                for kind in &kinds {
                    let value = evaluation.and_then(|evaluation| delta_cd(evaluation, *kind)).map(Length::mm);
                    part.insert(format!("delta_cd_{}_mm", kind.key()), value.into());
                }
                for (name, end) in ENDS.into_iter().zip(ends(evaluation)) {
                    part.insert(name.to_owned(), end.map(Length::mm).into());
                }
                let verdict = evaluation.and_then(|evaluation| evaluation.verdict).map(Verdict::name);
                part.insert("verdict".to_owned(), verdict.into());
                part.insert("judged_by".to_owned(), evaluation.map(|evaluation| evaluation.judged_by.name()).into());
                if let Some(uncertainty) = &row.uncertainty {
                    part.insert("uncertainty".to_owned(), uncertainty.json());
                }
                Value::Object(part)
            })
            .collect();
        json!({ "title": self.title, "parts": parts })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let kinds = self.kinds();
        let own = |kind: &DeviationKind| format!("delta_cd_{}", kind.key());
        let mut names = vec!["part_id".to_owned()];
        names.extend(kinds.iter().map(|kind| own(kind) + "_mm"));
        names.extend(ENDS.into_iter().chain(["verdict"]).map(str::to_owned));
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
            let results = part.pointer_mut("/uncertainty/results").map(Value::take);
            for result in results.iter().filter_map(Value::as_array).flatten() {
                part[result["of"].as_str().unwrap_or_default()] = result.clone();
            }
        }
        fact::rows(&json, "parts", &names)
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = titled(self.title);
        let kinds = self.kinds();
        let judged = self.rows.iter().filter_map(|row| row.evaluation.as_ref()).any(|e| !e.limits.is_empty());
        let mut columns = vec![Column::text("part")];
        columns.extend(kinds.iter().map(|kind| Column::number(format!("{}\n[mm]", kind.name()))));
        columns.push(Column::number("ΔCD from\n[mm]"));
        columns.extend(self.is_uncertain().then(|| Column::number("± U\n[µm]")));
        columns.push(Column::number("to\n[mm]"));
        columns.extend(self.is_uncertain().then(|| Column::number("± U\n[µm]")));
        if judged {
            columns.push(Column::text("verdict"));
        }
        let width = columns.len();
        let rows = self.rows.iter().map(|part| {
            let mut row = vec![part.name.clone()];
            if let Some(evaluation) = &part.evaluation {
                let mm = |length: Length| millimetres(length.mm());
                row.extend(kinds.iter().map(|kind| delta_cd(evaluation, *kind).map_or_else(|| "-".to_owned(), mm)));
                let interval = evaluation.combined.interval(evaluation.stack).ok();
                let (from, to) = (interval.map(|ends| ends.lower), interval.map(|ends| ends.upper));
                let propagation = part.uncertainty.as_ref().map(|part| &part.propagation);
                for (end, linear) in [(from, propagation.map(|p| &p.lower)), (to, propagation.map(|p| &p.upper))] {
                    row.push(end.map_or_else(|| "open".to_owned(), mm));
                    if self.is_uncertain() {
                        row.push(linear.map_or_else(|| "-".to_owned(), |linear| micrometres(linear.expanded_mm())));
                    }
                }
                if judged {
                    row.push(evaluation.verdict.map_or("open", Verdict::name).to_owned());
                }
            } else {
                row.resize(width - usize::from(judged), "-".to_owned());
                if judged {
                    row.push("not judged".to_owned());
                }
            }
            row
        });
        blocks.push(Block::Table(Table { rows: rows.collect(), columns }));
        if let Some(evaluation) = self.rows.iter().find_map(|row| row.evaluation.as_ref()) {
            let stack = match evaluation.stack {
                Stack::Range => "from … to: the worst case, wherever on the teeth the errors are",
                Stack::Rss => "from … to: statistical, mean ± 3 standard deviations",
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
            let mut sentence = format!("{pass} of {} parts are within the limits", self.rows.len());
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
}

impl SpacesReport<'_> {
    const fn place(&self) -> &'static str {
        if self.measured.is_rack { "space" } else { "tooth" }
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
                let mut object = Map::new();
                object.insert(self.place().to_owned(), row.number.into());
                for (feature, effect) in measured.features.iter().zip(&row.effects) {
                    let key = feature.key();
                    let name = if feature.error() == DeviationKind::RackLead { "deg" } else { "mm" };
                    let deviation = effect.map(|effect| effect.deviation.base());
                    object.insert(format!("{key}_deviation_{name}"), deviation.into());
                    object.insert(
                        format!("delta_cd_{key}_mm"),
                        effect.as_ref().map(|effect| effect.delta_cd.mm()).into(),
                    );
                }
                Value::Object(object)
            })
            .collect();
        let (low, high) = measured.range();
        json!({
            "title": self.title,
            "part": if measured.is_rack { "rack" } else { "pinion" },
            "model": measured.model.name(),
            "rows": rows,
            "formula_range_mm": { "lower": low.mm(), "upper": high.mm() },
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let mut header = vec![self.place().to_owned()];
        for feature in &self.measured.features {
            let unit = if feature.error() == DeviationKind::RackLead { "deg" } else { "mm" };
            header.push(format!("{}_deviation_{unit}", feature.key()));
            header.push(format!("delta_cd_{}_mm", feature.key()));
        }
        fact::rows(&self.json(), "rows", &header)
    }

    fn blocks(&self) -> Vec<Block> {
        let measured = self.measured;
        let mut blocks = titled(self.title);
        let mut columns = vec![Column::number(self.place())];
        for feature in &measured.features {
            let unit = if feature.error() == DeviationKind::RackLead { "°" } else { "µm" };
            columns.push(Column::number(format!("{}\n[{unit}]", feature.name())));
            columns.push(Column::number("ΔCD\n[mm]"));
        }
        let rows = measured.rows.iter().map(|row| {
            let mut cells = vec![row.number.to_string()];
            for effect in &row.effects {
                match effect {
                    Some(effect) => {
                        cells.extend([deviation_text(effect.deviation), millimetres(effect.delta_cd.mm())]);
                    }
                    None => cells.extend(["-".to_owned(), "-".to_owned()]),
                }
            }
            cells
        });
        blocks.push(Block::Table(Table { rows: rows.collect(), columns }));
        let mut rows: Vec<Vec<String>> = Vec::new();
        for (index, feature) in measured.features.iter().enumerate() {
            let (Some((number, largest)), Some((low, high))) = (measured.largest(index), measured.range_of(index))
            else {
                continue;
            };
            let unit = if feature.error() == DeviationKind::RackLead { "°" } else { " µm" };
            rows.push(vec![
                feature.name().to_owned(),
                format!("{}{unit}, {} {number}", deviation_text(largest.deviation), self.place()),
                millimetres(low.mm()),
                millimetres(high.mm()),
                equation(feature.error(), measured.model).to_owned(),
            ]);
        }
        let (low, high) = measured.range();
        rows.push(vec![
            "together".to_owned(),
            String::new(),
            millimetres(low.mm()),
            millimetres(high.mm()),
            String::new(),
        ]);
        blocks.push(Block::Table(Table {
            columns: vec![
                Column::text("by formula"),
                Column::text("largest"),
                Column::number("ΔCD from\n[mm]"),
                Column::number("to\n[mm]"),
                Column::text(format!("formula ({})", measured.model)),
            ],
            rows,
        }));
        blocks
    }
}

/// Two reports as one: what the formulas say, and the exact mesh.
pub struct FormulaAndMesh<'a> {
    /// By formula.
    pub formula: &'a dyn Report,
    /// By the exact mesh.
    pub mesh: &'a dyn Report,
}

impl Report for FormulaAndMesh<'_> {
    fn json(&self) -> Value {
        json!({ "formula": self.formula.json(), "mesh": self.mesh.json() })
    }

    /// The rows of the formulas' report: the curve is a table of its own, which `rackmesh mesh` writes.
    fn rows(&self) -> Vec<Vec<String>> {
        self.formula.rows()
    }

    fn blocks(&self) -> Vec<Block> {
        // one verdict is enough: that of the mesh, which counts
        let formula = self.formula.blocks().into_iter().filter(|block| !matches!(block, Block::Verdict(..)));
        formula.chain(self.mesh.blocks()).collect()
    }
}
