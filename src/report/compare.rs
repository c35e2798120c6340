//! Specs side by side: their differences, and the effect on the results, for `compare`.

use serde_json::{Value, json};

use super::chart::{Chart, Layer, Shape};
use super::number::{ends, millimetres, tidy};
use super::rows::{self, number_text};
use super::{Block, Report, Table, fact};
use crate::judge::Verdict;

/// A spec that is compared.
#[derive(Debug, Default)]
pub struct ComparedSpec {
    /// Its name.
    pub name: String,
    /// Its title.
    pub title: Option<String>,
    /// Its keys with their values, each in one unit.
    pub keys: Vec<(String, String)>,
    /// Its results.
    pub results: Vec<(String, Value)>,
    /// Stroke and ΔCD of its mesh, mm; empty without one.
    pub curve: Vec<(f64, f64)>,
    /// Its limits of ΔCD, mm.
    pub limits: Vec<f64>,
    /// The limits that it breaks, in words.
    pub outside: Vec<String>,
    /// The exit status by itself.
    pub exit_status: u8,
    /// Why it has no mesh.
    pub notes: Vec<String>,
    /// Why it has no results.
    pub no_result: Option<String>,
}

/// Specs, compared.
#[derive(Debug)]
pub struct CompareReport<'a>(pub &'a [ComparedSpec]);

/// The entry of each spec under a name; `None` if it has none.
type Line<'a, T> = (&'a str, Vec<Option<&'a T>>);

/// All names of the lists in their order, with the entry of each list.
fn merged<'a, T>(lists: &[&'a [(String, T)]]) -> Vec<Line<'a, T>> {
    let mut names: Vec<&str> = Vec::new();
    for list in lists {
        let mut after = 0;
        for (name, _) in *list {
            let known = names.iter().position(|known| known == name);
            if known.is_none() {
                names.insert(after, name);
            }
            after = known.unwrap_or(after) + 1;
        }
    }
    let under = |name: &str| {
        lists.iter().map(|list| list.iter().find(|(own, _)| own == name).map(|(_, value)| value)).collect()
    };
    names.into_iter().map(|name| (name, under(name))).collect()
}

/// The result less that of the first spec.
fn change(values: &[Option<&Value>], index: usize) -> Option<f64> {
    let number = |index: usize| values.get(index).copied().flatten().and_then(Value::as_f64);
    Some(tidy(number(index)? - number(0)?))
}

impl<'a> CompareReport<'a> {
    /// The keys that differ between the specs, without titles and `[report]`.
    fn differences(&self) -> Vec<Line<'a, String>> {
        let keys: Vec<_> = self.0.iter().map(|spec| spec.keys.as_slice()).collect();
        let mut differences = merged(&keys);
        differences.retain(|(key, values)| {
            *key != "title" && !key.starts_with("report.") && values.iter().any(|value| *value != values[0])
        });
        differences
    }

    /// The results that any spec has.
    fn results(&self) -> Vec<Line<'a, Value>> {
        let results: Vec<_> = self.0.iter().map(|spec| spec.results.as_slice()).collect();
        let mut results = merged(&results);
        results.retain(|(_, values)| values.iter().flatten().any(|value| !value.is_null()));
        results
    }

    /// The name of a spec in a heading: its file name, if that is unique.
    fn short_name(&self, spec: &'a ComparedSpec) -> &'a str {
        let file = |spec: &'a ComparedSpec| spec.name.rsplit(['/', '\\']).next().unwrap_or(&spec.name);
        let same = self.0.iter().filter(|other| file(other) == file(spec)).count();
        if same > 1 { &spec.name } else { file(spec) }
    }

    /// A table with a column for each spec.
    fn table<T>(
        &self,
        heading: &str,
        lines: &[Line<'a, T>],
        text: impl Fn(&Line<'a, T>, usize) -> String,
    ) -> super::table::Rows<usize> {
        let name = |line: &usize| {
            if heading == "result" { rows::heading(lines[*line].0, ' ') } else { lines[*line].0.to_owned() }
        };
        let table = Table::of(0..lines.len()).text(heading, name);
        self.0
            .iter()
            .enumerate()
            .fold(table, |table, (index, spec)| table.number(self.short_name(spec), |line| text(&lines[*line], index)))
    }

    /// The curves of the meshes, and all limits.
    #[must_use]
    pub fn chart(&self) -> Chart {
        // limits that all specs share have no name of a spec
        let mut limits: Vec<(String, &Vec<f64>)> = Vec::new();
        for spec in self.0.iter().filter(|spec| !spec.limits.is_empty()) {
            match limits.iter_mut().find(|(_, known)| **known == spec.limits) {
                Some((names, _)) => names.push_str(&format!(", {}", self.short_name(spec))),
                None => limits.push((self.short_name(spec).to_owned(), &spec.limits)),
            }
        }
        let is_one = limits.len() == 1 && self.0.iter().all(|spec| !spec.limits.is_empty());
        let name = |names: &str, ends: &[f64]| {
            let ends: Vec<_> = ends.iter().map(|mm| millimetres(tidy(*mm))).collect();
            format!("limits of {names}: {} mm", ends.join(", "))
        };
        let limits = limits.iter().map(|(names, ends)| {
            let label = if is_one { "limits".to_owned() } else { name(names, ends) };
            Layer::new(&label, Shape::Limits((*ends).clone()))
        });
        let curves = self.0.iter().filter(|spec| !spec.curve.is_empty());
        let curves = curves.map(|spec| Layer::new(self.short_name(spec), Shape::Line(spec.curve.clone())));
        let names: Vec<_> = self.0.iter().map(|spec| self.short_name(spec)).collect();
        let title = format!("ΔCD along the stroke: {}", names.join(", "));
        Chart::along_the_stroke(&title, limits.chain(curves).collect())
    }

    /// The outcome of a spec, in a sentence.
    fn verdict(&self, spec: &'a ComparedSpec) -> Block {
        let result = |name: &str| spec.results.iter().find(|(own, _)| own == name).map(|(_, value)| value);
        let verdict = result("verdict").and_then(Value::as_str);
        let verdict = [Verdict::Pass, Verdict::Fail, Verdict::Indeterminate]
            .into_iter()
            .find(|known| verdict == Some(known.name()));
        let end = |name: &str| result(name).and_then(Value::as_f64);
        let judged = end("lower_mm")
            .zip(end("upper_mm"))
            .map(|(lower, upper)| format!("ΔCD {} mm", ends(tidy(lower), tidy(upper))));
        let outside = (!spec.outside.is_empty()).then(|| format!("outside the limits of {}", spec.outside.join(", ")));
        let reason = result("reason").and_then(Value::as_str).or(spec.no_result.as_deref()).map(str::to_owned);
        let said: Vec<_> = judged.into_iter().chain(outside).chain(reason).collect();
        let said = if said.is_empty() { "no limit is given".to_owned() } else { said.join("; ") };
        Block::Verdict(verdict, format!("{}: {said}", self.short_name(spec)))
    }

    fn notes(&self) -> Vec<String> {
        self.0
            .iter()
            .flat_map(|spec| spec.notes.iter().map(|note| format!("{}: {note}", self.short_name(spec))))
            .collect()
    }
}

impl Report for CompareReport<'_> {
    fn json(&self) -> Value {
        let specs = self.0.iter().map(|spec| {
            let notes: Vec<_> = spec.no_result.iter().chain(&spec.notes).collect();
            json!({ "name": spec.name, "title": spec.title, "outside": spec.outside, "exit_status": spec.exit_status, "notes": notes })
        });
        let differences = self.differences().into_iter().map(|(key, values)| json!({ "key": key, "values": values }));
        let results = self.results().into_iter().map(|(name, values)| {
            let changes: Vec<_> = (0..values.len()).map(|index| change(&values, index)).collect();
            json!({ "name": name, "values": values, "changes": changes })
        });
        json!({
            "specs": specs.collect::<Vec<_>>(),
            "differences": differences.collect::<Vec<_>>(),
            "results": results.collect::<Vec<_>>(),
        })
    }

    /// A row for each difference and each result, with a column for each spec.
    fn rows(&self) -> Vec<Vec<String>> {
        let own = |values: Vec<Value>| self.0.iter().map(|spec| spec.name.clone()).zip(values);
        let record = |of: &str, name: &str, values: Vec<Value>| {
            let mut record = json!({ "of": of, "name": name });
            for (index, (_, value)) in own(values).enumerate() {
                record[index.to_string()] = value;
            }
            record
        };
        let differences = self.differences().into_iter();
        let differences = differences
            .map(|(key, values)| record("difference", key, values.into_iter().map(|value| json!(value)).collect()));
        let results = self.results().into_iter();
        let results = results
            .map(|(name, values)| record("result", name, values.into_iter().map(|value| json!(value)).collect()));
        let records = json!({ "records": differences.chain(results).collect::<Vec<_>>() });
        let columns: Vec<_> = (0..self.0.len()).map(|index| index.to_string()).collect();
        let mut rows = fact::rows(&records, "records", &format!("of name {}", columns.join(" ")));
        if let Some(header) = rows.first_mut() {
            header.truncate(2);
            header.extend(self.0.iter().map(|spec| spec.name.clone()));
        }
        rows
    }

    fn blocks(&self) -> Vec<Block> {
        let differences = self.differences();
        let results: Vec<_> = self
            .results()
            .into_iter()
            .filter(|(name, _)| !matches!(*name, "reason" | "lower_mm" | "upper_mm"))
            .collect();
        let value = |(_, values): &Line<'_, String>, index: usize| values[index].map_or("-", String::as_str).to_owned();
        let result = |(name, values): &Line<'_, Value>, index: usize| match values[index] {
            Some(Value::String(text)) => text.clone(),
            Some(value) => value.as_f64().map_or_else(|| "-".to_owned(), |number| number_text(name, number)),
            None => "-".to_owned(),
        };
        let mut table = self.table("result", &results, result);
        if self.0.len() == 2 {
            let text = |line: &usize| {
                let (name, values) = &results[*line];
                change(values, 1).map_or_else(String::new, |change| match number_text(name, change) {
                    unsigned if change > 0.0 && !unsigned.starts_with('+') => format!("+{unsigned}"),
                    text => text,
                })
            };
            table = table.number("change", text);
        }
        let differing = self.table("key", &differences, value).block_if_any();
        let same = || Block::Note("The specs say the same.".to_owned());
        let mut blocks = vec![differing.unwrap_or_else(same), table.block()];
        blocks.extend(self.notes().into_iter().map(Block::Remark));
        blocks.extend(self.0.iter().map(|spec| self.verdict(spec)));
        blocks
    }
}
