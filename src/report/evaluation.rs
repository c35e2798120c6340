//! The report of `eval`.

use serde_json::{Value, json};

use super::chart::{Axis, Bar, Chart, Layer, Scale, Shape};
use super::class::class_fact;
use super::grounds::{assumed, assumptions_of, beyond_bound, beyond_reach, bound_remarks, why_ends_differ};
use super::number::{deviation_text, ends, interval_text, millimetres, plain, tidy};
use super::uncertainty::{self, UncertaintyPart, decision_fact, rule_words};
use super::{
    Block, Column, Report, Table, WITHOUT, YokeSection, fact, function, judged_without, keys_of, titled, worst_last,
};
use crate::deviation::{DeviationKind, DeviationValue, Extent};
use crate::evaluation::{Contribution, Evaluation, JudgedBy, LimitCheck, Unjudged, subject};
use crate::formula::law::equation;
use crate::function::Check;
use crate::judge::class::ErrorClass;
use crate::judge::{Interval, LimitTarget, Stack, Verdict};
use crate::mesh::Summary;
use crate::quantity::Length;

/// An evaluation with its title.
#[derive(Debug)]
pub struct EvaluationReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// The results.
    pub evaluation: Evaluation,
    /// What the bound assumes.
    pub rests_on: Vec<String>,
    /// Further remarks on the results' validity.
    pub notes: Vec<String>,
    /// The exact mesh over a stroke, where it was asked for.
    pub mesh: Option<MeshPart>,
    /// The results for the yoke, if the spec has one.
    pub yoke: Option<YokeSection>,
    /// The permissible values of errors given as classes.
    pub classes: Vec<ErrorClass>,
    /// The uncertainty of the results, where uncertainties are given.
    pub uncertainty: Option<UncertaintyPart>,
    /// Errors that the spec asks for and without which the part was judged.
    pub without: Vec<DeviationKind>,
}

/// The exact mesh of the same parts, in short.
#[derive(Debug)]
pub struct MeshPart {
    /// The stroke, mm.
    pub stroke_mm: (f64, f64),
    /// Its summary.
    pub summary: Summary,
    /// What the reader should know.
    pub notes: Vec<String>,
}

impl<'a> EvaluationReport<'a> {
    /// The report, with the remarks that the results call for; the keys of the pair's geometry that are `missing` are named
    /// where they would narrow a range.
    #[must_use]
    pub fn new(title: Option<&'a str>, evaluation: Evaluation, missing: &[&str]) -> Self {
        let alone: Vec<_> = evaluation.contributions.iter().map(|error| error.range.ok()).collect();
        let why = why_ends_differ(&alone, evaluation.combined.range.ok(), &evaluation.notes);
        let mut rests_on = bound_remarks(&evaluation.notes, missing);
        // what is missing comes first
        rests_on.splice(rests_on.len().min(1)..rests_on.len().min(1), why);
        rests_on.extend(evaluation.contributions.iter().filter_map(|error| beyond_bound(error, evaluation.model)));
        Self {
            title,
            rests_on,
            evaluation,
            notes: Vec::new(),
            mesh: None,
            yoke: None,
            classes: Vec::new(),
            uncertainty: None,
            without: Vec::new(),
        }
    }

    /// The outcome of the limits on a yoke.
    fn checks(&self) -> &[Check] {
        self.yoke.as_ref().map_or(&[], YokeSection::checks)
    }

    /// The verdict on all limits.
    fn verdict(&self) -> Option<&'static str> {
        self.evaluation.verdict_with(self.checks()).map(Verdict::name)
    }

    /// Why the verdict is open, that the part is rejected, or that the errors do not reach the limit.
    fn reason(&self) -> Option<String> {
        let beyond = || self.evaluation.limits.iter().find_map(|check| beyond_reach(check, &self.evaluation));
        self.evaluation.reason_with(self.checks()).or_else(beyond)
    }

    fn class(&self, kind: DeviationKind) -> Option<&ErrorClass> {
        self.classes.iter().find(|class| class.kind == kind)
    }

    /// The permissible values of errors given as classes, in words.
    fn class_notes(&self) -> impl Iterator<Item = String> + '_ {
        self.classes.iter().map(|class| format!("class: {}", class.in_words()))
    }

    fn all_notes(&self) -> Vec<String> {
        let unsolved = self.evaluation.note_of_unsolved();
        let notes = self.rests_on.iter().cloned().chain(unsolved).chain(self.class_notes());
        notes.chain(self.notes.iter().cloned()).collect()
    }

    /// Each error, for programs.
    fn contributions(&self) -> impl Iterator<Item = Value> + '_ {
        let model = self.evaluation.model;
        self.evaluation.contributions.iter().map(move |c| {
            let deviation = if let DeviationValue::Length(_) = c.value { "deviation_mm" } else { "deviation_deg" };
            let mut fact = json!({
                "error": c.kind.key(),
                deviation: c.value.base(),
                "extent": c.extent.name(),
                "range_mm": c.range.ok(),
                "delta_cd_mm": c.delta_cd(model),
                "delta_cd_exact_mm": c.exact,
                "delta_cd_paper_mm": c.paper,
                "model": model.name(),
                "formula": equation(c.kind, model),
                "share": c.share,
            });
            if let Some([lower, upper]) = c.two_ends() {
                fact[deviation.replace('_', "_lower_")] = lower.into();
                fact[deviation.replace('_', "_upper_")] = upper.into();
            }
            if let Some(class) = self.class(c.kind) {
                fact["class"] = class_fact(class);
            }
            fact
        })
    }

    fn contribution_table(&self) -> Option<Block> {
        let evaluation = &self.evaluation;
        let (model, other) = (evaluation.model, evaluation.model.other());
        // a permissible deviation has no sign, and its ΔCD has one only where it can push one way only
        let either_way = |text: String, is: bool| if is { text.replacen('+', "±", 1) } else { text };
        let is_unsigned = |c: &Contribution| {
            c.two_ends().is_none() && (c.tolerance.is_some() || matches!(c.extent, Extent::Each | Extent::Total))
        };
        let deviation = |c: &Contribution| deviation_text(c.value, c.two_ends());
        let delta_cd = |c: &Contribution, model| {
            either_way(millimetres(c.delta_cd(model).mm()), is_unsigned(c) && c.kind.always_acts())
        };
        Table::of(&evaluation.contributions)
            .text("error", |c| c.kind.to_string())
            .number("deviation", |c| either_way(deviation(c), is_unsigned(c)))
            .number(format!("ΔCD {model}\n[mm]"), |c| delta_cd(c, model))
            .column_if(evaluation.models_differ(), Column::number(format!("ΔCD {other}\n[mm]")).unless_narrow(), |c| {
                delta_cd(c, other)
            })
            .number("worst case\n[mm]", |c| c.range.map_or_else(|_| "open".to_owned(), |range| interval_text(&range)))
            .text("on", |c| c.extent_in_words())
            .column_if(true, Column::text(format!("formula ({model})")).unless_narrow(), |c| equation(c.kind, model))
            .block_if_any()
    }

    /// The exact mesh of errors of which nothing is left to place.
    fn beside_the_bound(&self) -> Option<Interval> {
        let Evaluation { judged, judged_by, contributions, .. } = &self.evaluation;
        judged.ok().filter(|_| *judged_by == JudgedBy::Mesh && !contributions.is_empty())
    }

    fn combination_table(&self) -> Block {
        let combined = &self.evaluation.combined;
        // without errors only known teeth count
        let by_mesh = self.evaluation.judged_by == JudgedBy::Mesh;
        let is_mesh_alone = by_mesh && self.evaluation.contributions.is_empty();
        let ends = |interval: &Interval| [interval.lower, interval.upper].map(|end| millimetres(end.mm()));
        let open = || ["open"; 2].map(str::to_owned);
        // known teeth do not scatter
        let shown = Stack::ALL
            .into_iter()
            .filter(|stack| !by_mesh && combined.judged(*stack) == *stack || *stack == Stack::Range);
        let judged = self.beside_the_bound();
        let judged = judged.map(|judged| ("exact mesh".to_owned(), ends(&judged), OF_KNOWN_TEETH.to_owned()));
        let combinations = shown.map(|stack| {
            let assumes = match stack {
                Stack::Range if is_mesh_alone => OF_KNOWN_TEETH,
                Stack::Range => "wherever on the teeth the errors are",
                Stack::Rss => "at one stroke; tolerances independent, normal, 3σ; what was measured with its bound",
            };
            let interval = combined.interval(stack);
            (stack.to_string(), interval.as_ref().map_or_else(|_| open(), ends), assumes.to_owned())
        });
        let reached = self.evaluation.reached.as_ref();
        let reached = reached.map(|reached| ("reached".to_owned(), ends(reached), ON_WORST_TEETH.to_owned()));
        let mesh = self.mesh.iter().map(|MeshPart { stroke_mm: (from, to), summary, .. }| {
            let ends = [summary.min_mm, summary.max_mm].map(|end| millimetres(tidy(end)));
            ("exact mesh".to_owned(), ends, format!("stroke {} … {} mm", plain(*from), plain(*to)))
        });
        Table::of(combinations.chain(judged).chain(reached).chain(mesh))
            .text("combination", |(name, ..)| name.clone())
            .number("from\n[mm]", |(_, [from, _], _)| from.clone())
            .number("to\n[mm]", |(_, [_, to], _)| to.clone())
            .text("assumes", |(.., assumes)| assumes.clone())
            .block()
    }

    /// The stack: the range of each error, their combination, and its limits.
    #[must_use]
    pub fn chart(&self) -> Chart {
        let Evaluation { contributions, combined, reached, limits, .. } = &self.evaluation;
        let errors = contributions.iter().map(|c| (c.kind.to_string(), c.range.ok(), true));
        let together = [
            (Stack::Range.to_string(), combined.range.ok()),
            (Stack::Rss.to_string(), combined.rss.ok()),
            ("reached".to_owned(), *reached),
            ("exact mesh".to_owned(), self.beside_the_bound()),
        ];
        let together = together.into_iter().filter(|(_, interval)| interval.is_some());
        let rows: Vec<_> = errors.chain(together.map(|(name, interval)| (name, interval, false))).collect();
        let bars = |of_errors: bool| {
            let own = rows.iter().enumerate().filter(move |(_, (.., is_error))| *is_error == of_errors);
            let bar = |(row, (_, interval, _)): (usize, &(String, Option<Interval>, bool))| {
                let [left, right] = [interval.as_ref()?.lower, interval.as_ref()?.upper].map(Length::mm);
                let (low, high) = (row as f64 + 0.15, row as f64 + 0.85);
                Some(Bar { left, right, low, high, text: ends(left, right) })
            };
            Shape::Bars(own.filter_map(bar).collect())
        };
        let limits = limits.iter().filter(|check| check.on == LimitTarget::CenterDistance);
        let limits = limits.flat_map(|check| check.limit.ends()).map(Length::mm).collect();
        let name = |(name, interval, _): &(String, Option<Interval>, bool)| match interval {
            Some(_) => name.clone(),
            None => format!("{name}: open"),
        };
        Chart {
            title: self.title.unwrap_or("ΔCD of the errors").to_owned(),
            x: Axis { label: "ΔCD [mm]".to_owned(), scale: Scale::Airy },
            y: Axis { label: "error".to_owned(), scale: Scale::Names(rows.iter().map(name).collect()) },
            layers: vec![
                Layer::new("each error, wherever it is", bars(true)),
                Layer::new("together", bars(false)),
                Layer::new("limits", Shape::LimitsOnX(limits)),
            ],
            height: 150.0 + 44.0 * rows.len() as f64,
            ..Chart::default()
        }
    }

    fn limit_table(&self) -> Option<Block> {
        let end = |end: Option<Length>| end.map(|end| millimetres(end.mm()));
        let result = |check: &LimitCheck| check.result.map(|result| interval_text(&result));
        Table::of(&self.evaluation.limits)
            .text("limit on ΔCD", |check| check.on.to_string())
            .number("lower\n[mm]", |check| end(check.limit.lower))
            .number("upper\n[mm]", |check| end(check.limit.upper))
            .number("result\n[mm]", |check| result(check).unwrap_or_else(|unjudged| unjudged_text(unjudged).to_owned()))
            .text("verdict", |check| check.verdict.map_or("open", Verdict::name))
            .block_if_any()
    }

    fn verdict_block(&self) -> Option<Block> {
        let evaluation = &self.evaluation;
        let without = judged_without(&self.without);
        let failed = evaluation.limits.iter().filter(|check| check.verdict == Some(Verdict::Fail));
        let said = |check| [Some(failure_sentence(check, evaluation.judged_by)), beyond_reach(check, evaluation)];
        let failed: Vec<_> = failed.flat_map(said).flatten().chain(evaluation.rejection()).collect();
        if !failed.is_empty() {
            return Some(Block::Verdict(Some(Verdict::Fail), format!("{}{without}", failed.join("; "))));
        }
        if let Some(why) = evaluation.open_because() {
            return Some(Block::Verdict(evaluation.verdict, format!("{why}{without}")));
        }
        let count = match evaluation.limits.len() {
            0 => return None,
            1 => "the limit on ΔCD is met".to_owned(),
            count => format!("all {count} limits on ΔCD are met"),
        };
        let by = format!("{}{}", evaluation.judged_by, rule_words(&self.evaluation.rule));
        let assumed = assumed(&assumptions_of(evaluation));
        Some(Block::Verdict(Some(Verdict::Pass), format!("{count}{assumed} (judged by {by}){without}")))
    }
}

/// The assumption where the exact mesh judges.
const OF_KNOWN_TEETH: &str = "the exact mesh of the known teeth, all strokes at which they can carry";
/// The places of errors for the range that they reach.
pub(super) const ON_WORST_TEETH: &str = "exact mesh, errors on the worst teeth that a search finds";

fn unjudged_text(unjudged: Unjudged) -> &'static str {
    match unjudged {
        Unjudged::NotGiven => "not given",
        Unjudged::Lacking(_) | Unjudged::NoUncertainty(_) => "not complete",
        Unjudged::NoBound(_) => "open",
    }
}

/// Which end of the limit is broken and by how much.
pub(super) fn failure_sentence(check: &LimitCheck, judged_by: JudgedBy) -> String {
    let what = subject(check.on, judged_by);
    let Ok(result) = check.result else { return what };
    let broken = check.limit.distances(result).filter(|end| end.inside_by.is_negative());
    let parts: Vec<_> = broken.map(|end| format!("{} mm {end}", millimetres(end.result.mm()))).collect();
    format!("{what}: {}", parts.join(", and "))
}

/// The outcome of a limit, for programs.
fn limit_fact(check: &LimitCheck, evaluation: &Evaluation) -> Value {
    let result = check.result.ok();
    json!({
        "on": check.on.key(),
        "lower_mm": check.limit.lower,
        "upper_mm": check.limit.upper,
        "result_lower_mm": result.map(|result| result.lower),
        "result_upper_mm": result.map(|result| result.upper),
        "verdict": check.verdict.map(Verdict::name),
        "reason": check.open_because(evaluation.judged_by, &evaluation.rule).or_else(|| beyond_reach(check, evaluation)),
        "decision": check.decision.as_ref().map(decision_fact),
    })
}

/// The columns of CSV, of an error, a combination, a limit, an assumption or an uncertainty.
const COLUMNS: &str = "kind name extent deviation_mm deviation_deg delta_cd_mm delta_cd_exact_mm delta_cd_paper_mm \
                       model formula share lower_mm=range_mm/lower upper_mm=range_mm/upper \
                       limit_lower_mm=limit/lower_mm limit_upper_mm=limit/upper_mm verdict=limit/verdict \
                       standard=class/standard grade=class/grade diameter_mm=class/diameter_mm reason=limit/reason";

/// The content of a row of CSV, with its kind.
fn record(kind: &str, name: impl Into<Value>, mut fact: Value) -> Value {
    fact["kind"] = kind.into();
    fact["name"] = name.into();
    fact
}

impl Report for EvaluationReport<'_> {
    fn json(&self) -> Value {
        let evaluation = &self.evaluation;
        let combined = &evaluation.combined;
        let mut json = json!({
            "title": self.title,
            "model": evaluation.model.name(),
            "contributions": self.contributions().collect::<Vec<_>>(),
            "combined": {
                "range_mm": combined.range.ok(),
                "worst_case_mm": combined.range.ok(),
                "rss_mm": combined.rss.ok(),
            },
            "stack": evaluation.stack.name(),
            "judged_by": evaluation.judged_by.name(),
            "judged_mm": evaluation.judged.ok(),
            "reached_mm": evaluation.reached,
            "rule": evaluation.rule.to_string(),
            "limits": evaluation.limits.iter().map(|check| limit_fact(check, evaluation)).collect::<Vec<_>>(),
            "verdict": self.verdict(),
            "reason": self.reason(),
            "assumes": assumptions_of(evaluation),
            "uncertainty": self.uncertainty.as_ref().map(UncertaintyPart::json),
            "mesh": self.mesh.as_ref().map(|MeshPart { stroke_mm: (from, to), summary, notes }| json!({
                "from_mm": from,
                "to_mm": to,
                "min_mm": tidy(summary.min_mm),
                "max_mm": tidy(summary.max_mm),
                "mean_mm": tidy(summary.mean_mm),
                "notes": notes,
            })),
            "notes": self.all_notes(),
        });
        if let Some(yoke) = &self.yoke {
            json["yoke"] = yoke.json();
        }
        json
    }

    fn brief(&self) -> Value {
        let Evaluation { model, contributions, combined, judged, reached, .. } = &self.evaluation;
        let each = |c: &Contribution| json!({ "error": c.kind.key(), "delta_cd_mm": c.delta_cd(*model) });
        json!({
            "contributions": contributions.iter().map(each).collect::<Vec<_>>(),
            "combined": { "range_mm": combined.range.ok(), "rss_mm": combined.rss.ok() },
            "judged_mm": judged.ok(),
            "reached_mm": reached,
            "verdict": self.verdict(),
            "reason": self.reason(),
            "yoke": self.yoke.as_ref().map(YokeSection::json),
        })
    }

    /// One row per error, then one per combination, then one per limit, per assumption of a pass and per uncertainty.
    fn rows(&self) -> Vec<Vec<String>> {
        let evaluation = &self.evaluation;
        let ends = |kind, name, range: Value| {
            record(kind, name, json!({ "model": evaluation.model.name(), "range_mm": range }))
        };
        let mut records: Vec<_> =
            self.contributions().map(|fact| record("error", fact["error"].clone(), fact)).collect();
        records.extend(Stack::ALL.map(|stack| {
            let combined = evaluation.combined.interval(stack);
            let mut row = ends("combined", stack.name(), json!(combined.as_ref().ok()));
            row["limit"]["reason"] = json!(combined.err().map(|open| open.to_string()));
            row
        }));
        let by_mesh = self.beside_the_bound();
        records.extend(by_mesh.map(|judged| ends("combined", JudgedBy::Mesh.name(), json!(judged))));
        records.extend(evaluation.reached.map(|reached| ends("combined", "reached", json!(reached))));
        records.extend(self.mesh.as_ref().map(|MeshPart { summary, .. }| {
            let range = json!({ "lower": tidy(summary.min_mm), "upper": tidy(summary.max_mm) });
            ends("mesh", "mesh", range)
        }));
        records.extend(evaluation.limits.iter().map(|check| {
            let mut row = ends("limit", check.on.key(), json!(check.result.ok()));
            row["limit"] = limit_fact(check, evaluation);
            row[WITHOUT] = keys_of(&self.without).into();
            row
        }));
        let why = json!({ "limit": { "verdict": Verdict::Fail.name(), "reason": evaluation.rejection() } });
        records.extend(evaluation.is_rejected.then(|| record("status", "part", why)));
        let of_yoke = self.checks().iter().map(|check| json!({ "limit": function::check_json(check) }));
        records.extend(of_yoke.map(|row| record("limit", row["limit"]["on"].clone(), row)));
        records.extend(assumptions_of(evaluation).iter().map(|of| record("assumes", json!(of), json!({}))));
        let mut names = COLUMNS.to_owned();
        if !self.without.is_empty() {
            names = format!("{names} {WITHOUT}");
        }
        if let Some(part) = &self.uncertainty {
            names = format!("{names} {}", uncertainty::COLUMNS);
            records.extend(part.facts().map(|fact| record("uncertainty", fact["of"].clone(), fact)));
        }
        fact::rows(&json!({ "records": records }), "records", &names)
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = titled(self.title);
        blocks.extend(self.contribution_table());
        blocks.push(self.combination_table());
        blocks.extend(self.limit_table());
        // what the result rests on comes before the rules of the decision are said
        blocks.extend(self.rests_on.iter().cloned().chain(self.evaluation.note_of_unsolved()).map(Block::Remark));
        blocks.extend(self.uncertainty.iter().flat_map(UncertaintyPart::blocks));
        let (rule, is_uncertain) = (&self.evaluation.rule, self.uncertainty.is_some());
        blocks.extend(UncertaintyPart::decision_blocks(rule, &self.evaluation.limits, is_uncertain));
        blocks.extend(self.class_notes().map(Block::Note));
        let mesh_notes = self.mesh.iter().flat_map(|mesh| &mesh.notes);
        blocks.extend(self.notes.iter().chain(mesh_notes).cloned().map(Block::Remark));
        blocks.extend(self.yoke.iter().flat_map(YokeSection::blocks));
        blocks.extend(self.verdict_block());
        worst_last(blocks)
    }
}
