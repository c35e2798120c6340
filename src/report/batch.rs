//! The summary of a batch: counts, statistics of each result, the worst parts.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::basis::Basis;
use super::function::{lot_json, lot_table};
use super::grounds::assumed;
use super::number::{counted, grouped, millimetres, unsigned};
use super::parts::judged;
use super::rows::result_in_words;
use super::uncertainty::{micrometres, rule_words};
use super::{Block, Report, Table, fact, judged_without, titled};
use crate::batch::{Capability, MOST_TESTED, Outcome, Part, QUANTILES, Quantity};
use crate::evaluation::JudgedBy;
use crate::judge::{LimitTarget, Stack, Verdict};
use crate::statistics::capability::{FEWEST_PARTS, Gauge, Index, PRELIMINARY_PARTS};

/// A batch's outcome with its basis.
#[derive(Debug)]
pub struct BatchReport<'a> {
    title: Option<&'a str>,
    basis: &'a Basis,
    outcome: &'a Outcome,
    results: Vec<ResultFact<'a>>,
}

/// One result over all parts, and the capability of the process.
#[derive(Debug, Serialize)]
struct ResultFact<'a> {
    name: &'a str,
    count: u64,
    mean_mm: Option<f64>,
    standard_deviation_mm: Option<f64>,
    min_mm: Option<f64>,
    max_mm: Option<f64>,
    quantiles: [QuantileFact; QUANTILES.len()],
    limit_lower_mm: Option<f64>,
    limit_upper_mm: Option<f64>,
    /// The capability of the end of a range against the limit on its side.
    #[serde(flatten)]
    capability: Capability,
    #[serde(skip)]
    quantity: &'a Quantity,
}

/// The capability for both limits on all errors together: the least index of the two ends, each against its side.
#[derive(Debug, Clone, Copy, Default, Serialize)]
struct WholeCapability {
    cpk: Option<Index>,
    ppk: Option<Index>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct QuantileFact {
    share: f64,
    value_mm: Option<f64>,
}

impl ResultFact<'_> {
    fn quantile_mm(&self, share: f64) -> Option<f64> {
        self.quantiles.iter().find(|quantile| quantile.share == share)?.value_mm
    }

    fn is_limited(&self) -> bool {
        self.quantity.is_limited()
    }

    /// Its name for people.
    fn shown(&self) -> String {
        result_in_words(self.name)
    }

    fn indices(&self) -> [(&'static str, Option<Index>); 4] {
        let Capability { cp, cpk, pp, ppk, .. } = self.capability;
        [("Cp", cp), ("Cpk", cpk), ("Pp", pp), ("Ppk", ppk)]
    }
}

impl<'a> BatchReport<'a> {
    /// The report of a batch that was run with statistics.
    #[must_use]
    pub fn new(title: Option<&'a str>, basis: &'a Basis, outcome: &'a Outcome) -> Self {
        Self { title, basis, outcome, results: outcome.quantities.iter().map(ResultFact::from).collect() }
    }

    /// The number of parts, and of each outcome.
    #[must_use]
    pub fn counts_table(&self) -> Block {
        let rows = self.outcome.counts.rows;
        // one failing part in a million is not 0 %, and one passing part is not 100 %
        let share = |count: u64| match 100.0 * count as f64 / rows.max(1) as f64 {
            share if count > 0 && share < 0.01 => "< 0.01 %".to_owned(),
            share if count < rows && share > 99.99 => "> 99.99 %".to_owned(),
            share => format!("{share:.2} %"),
        };
        let is_shown = |(name, count): &(&str, u64)| *count > 0 || matches!(*name, "rows" | "pass" | "fail");
        Table::of(self.outcome.counts.named().into_iter().filter(is_shown))
            .text("parts", |(name, _)| match *name {
                "rows" => format!("{}s", self.basis.row_or_part()),
                "unjudged" => "without a verdict".to_owned(),
                name => name.to_owned(),
            })
            .number("count", |(_, count)| grouped(*count))
            .number("share", |(_, count)| share(*count))
            .block()
    }

    fn statistics_table(&self) -> Block {
        let mm = |value: Option<f64>| value.map(millimetres);
        // without scatter a statistical sum has no value
        Table::of(self.results.iter().filter(|result| result.mean_mm.is_some()))
            .text("ΔCD", |result| result.shown())
            .number("mean\n[mm]", |result| mm(result.mean_mm))
            .number("s\n[mm]", |result| result.standard_deviation_mm.map(unsigned))
            .number("min\n[mm]", |result| mm(result.min_mm))
            .number("median\n[mm]", |result| mm(result.quantile_mm(0.5)))
            .number("99.865 %\n[mm]", |result| mm(result.quantile_mm(0.99865)))
            .number("max\n[mm]", |result| mm(result.max_mm))
            .block()
    }

    fn whole_capability(&self) -> WholeCapability {
        let is_whole = |result: &&ResultFact<'_>| result.quantity.on == Some(LimitTarget::CenterDistance);
        let least = |of: fn(&Capability) -> Option<Index>| {
            let ends = self.results.iter().filter(is_whole).filter_map(|result| of(&result.capability));
            ends.min_by(|one, other| one.value.total_cmp(&other.value))
        };
        WholeCapability { cpk: least(|of| of.cpk), ppk: least(|of| of.ppk) }
    }

    /// The indices of the results that have limits: one of both ends together, and those of each error; `None` where there
    /// are none.
    fn capability_table(&self) -> Option<Block> {
        let WholeCapability { cpk, ppk } = self.whole_capability();
        let whole = [("Cpk", cpk), ("Ppk", ppk)].map(|(name, index)| ("all errors".to_owned(), name, index));
        let is_error = |result: &&ResultFact<'_>| matches!(result.quantity.on, Some(LimitTarget::Error(_)));
        let limited = self.results.iter().filter(is_error);
        let each = limited.flat_map(|result| result.indices().map(|(name, index)| (result.shown(), name, index)));
        let known = |(result, name, index): (String, &'static str, Option<Index>)| Some((result, name, index?));
        Table::of(whole.into_iter().chain(each).filter_map(known))
            .text("capability of ΔCD", |(result, ..)| result.clone())
            .text("index", |(_, name, _)| *name)
            .number("value", |(.., index)| format!("{:.2}", index.value))
            .number("95 % confidence", |(.., index)| format!("{:.2} … {:.2}", index.lower, index.upper))
            .block_if_any()
    }

    /// The share of measuring in the spread; `None` without uncertainties.
    fn gauge_table(&self) -> Option<Block> {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        Table::of(self.results.iter().filter_map(|result| Some((result.shown(), result.capability.gauge?))))
            .text("gauge share", |(name, _)| name.clone())
            .number("u\n[µm]", |(_, gauge)| micrometres(gauge.uncertainty_mm))
            .number("of the variance\nu²/s²", |(_, gauge)| percent(gauge.variance_share))
            .number("of the limits\n6 u/(U − L)", |(_, gauge)| gauge.tolerance_share.map(percent))
            .number("Ppk of the\nparts alone", |(_, gauge)| gauge.part_ppk.map(|ppk| format!("{ppk:.2}")))
            .block_if_any()
    }

    /// One position of the plug for all parts, where their settings are known.
    #[must_use]
    pub fn plug_table(&self) -> Option<Block> {
        lot_table(&self.basis.yoke.as_ref()?.yoke, &self.outcome.settings)
    }

    fn worst_table(&self) -> Block {
        let worst = &self.outcome.worst;
        let table =
            Table::of(worst).text("worst parts", |part| part.id.clone()).text("where", |part| part.place.to_string());
        judged(table, worst).block()
    }

    /// The spread of the parts for a page.
    #[must_use]
    pub fn spread(&self) -> Vec<Block> {
        let mut blocks = vec![self.statistics_table()];
        blocks.extend(self.capability_table());
        blocks.extend(self.gauge_table());
        blocks.extend(self.plug_table());
        blocks.extend(self.notes().into_iter().map(Block::Note));
        blocks
    }

    fn capability_notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let limited: Vec<_> = self.results.iter().filter(|result| result.is_limited()).collect();
        let Some(first) = limited.first() else { return notes };
        let parts = first.count;
        if parts < FEWEST_PARTS as u64 {
            let parts = if parts == 1 { "1 part is".to_owned() } else { format!("{parts} parts are") };
            notes.push(format!(
                "{parts} too few for capability indices: at least {FEWEST_PARTS} are needed, {PRELIMINARY_PARTS} or more are customary."
            ));
            return notes;
        }
        notes.push(
            "All errors: the least index of the two ends, each against the limit on its side. Pp and Ppk: s of all parts. Cp and Cpk: the mean moving range of successive rows / 1.128, so the rows must stand in the order of production. Confidence: χ², and Bissell's approximation for Cpk and Ppk."
                .to_owned(),
        );
        if parts < PRELIMINARY_PARTS as u64 {
            notes.push(format!(
                "{parts} parts make the indices preliminary: {PRELIMINARY_PARTS} or more are customary."
            ));
        }
        for result in limited {
            if result.capability.ppk.is_none() && result.standard_deviation_mm.is_some() {
                notes.push(format!("{}: no indices, because all values are the same.", result.shown()));
            }
            match result.capability.normality {
                Some(normality) if normality.rejected() => notes.push(format!(
                    "{}: not normally distributed (Anderson-Darling A² {:.2}, p {}; skewness {:+.2}, excess kurtosis {:+.2}), so the indices do not give the share outside: see the quantiles.",
                    result.shown(),
                    normality.anderson_darling,
                    if normality.p_value < 1e-4 { "below 0.0001".to_owned() } else { format!("{:.4}", normality.p_value) },
                    normality.skewness,
                    normality.excess_kurtosis,
                )),
                Some(normality) => notes.push(format!(
                    "{}: a normal distribution is not contradicted (Anderson-Darling A² {:.2}, p {:.2}).",
                    result.shown(),
                    normality.anderson_darling,
                    normality.p_value
                )),
                None if result.capability.ppk.is_some() => notes.push(format!(
                    "{}: not tested whether it is normally distributed: that needs at most {MOST_TESTED} values.",
                    result.shown()
                )),
                None => {}
            }
        }
        notes
    }

    /// The method that judges all parts, or those that the mesh need not judge.
    const fn sum_judged_by(&self) -> JudgedBy {
        match self.basis.stack {
            None => JudgedBy::Mesh,
            Some(Stack::Rss) => JudgedBy::Statistical,
            Some(_) => JudgedBy::Bound,
        }
    }

    /// The verdict on all parts.
    #[must_use]
    pub fn verdict(&self) -> Block {
        let counts = &self.outcome.counts;
        let rejected = if counts.rejected > 0 {
            let are = match (self.basis.row_or_part(), counts.rejected) {
                ("row", 1) => "makes no part",
                ("row", _) => "make no part",
                (_, 1) => "is rejected",
                _ => "are rejected",
            };
            format!("; {} of {} {are}", grouped(counts.rejected), counted(counts.rows, self.basis.row_or_part()))
        } else {
            String::new()
        };
        let parts = counts.parts();
        let by = format!("{}{}{}", self.sum_judged_by(), self.basis.and_mesh(), rule_words(&self.basis.rule));
        let judged_by = format!("(judged by {by}){}", judged_without(&self.basis.without));
        let unfit = |count: u64, how: &str| {
            let are = if count == 1 { "is" } else { "are" };
            format!("{} of {} {are} {how} a limit {judged_by}{rejected}", grouped(count), counted(parts, "part"))
        };
        let unjudged = self.basis.unjudged_sentence(self.outcome);
        let is_incomplete = self.outcome.interrupted || self.outcome.is_cut;
        let is_open = counts.unjudged > 0 || counts.rejected > 0 || unjudged.is_some();
        let by_status = |count: u64| {
            let are = if count == 1 { "fails by its" } else { "fail by their" };
            format!("{} of {} {are} status", grouped(count), counted(parts, "part"))
        };
        let (verdict, sentence) = if counts.fail > 0 {
            let outside = counts.fail - counts.fail_by_status;
            let said = match (outside, counts.fail_by_status) {
                (outside, 0) => unfit(outside, "outside"),
                (0, rejected_parts) => format!("{}{rejected}", by_status(rejected_parts)),
                (outside, rejected_parts) => format!("{}; {}", by_status(rejected_parts), unfit(outside, "outside")),
            };
            (Some(Verdict::Fail), said)
        } else if counts.indeterminate > 0 {
            (Some(Verdict::Indeterminate), unfit(counts.indeterminate, "too near"))
        } else if is_open || is_incomplete || parts == 0 {
            let why = match (counts.rows, unjudged) {
                _ if is_incomplete => "the run is incomplete".to_owned(),
                (0, _) => "the table has no rows".to_owned(),
                (_, Some(why)) => why,
                _ if !self.basis.has_limits() => "there is no limit".to_owned(),
                _ => format!("not every {} could be judged", self.basis.row_or_part()),
            };
            (None, format!("{why}{rejected}"))
        } else {
            let parts = match parts {
                1 => "the part is".to_owned(),
                parts => format!("all {} parts are", grouped(parts)),
            };
            (Some(Verdict::Pass), format!("{parts} inside the limits{} {judged_by}", assumed(&self.basis.assumes)))
        };
        Block::Verdict(verdict, sentence)
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = vec![format!(
            "Model {}. Mean, s, min and max are exact to the digits shown; quantiles are within 0.05 % of the value.",
            self.basis.model
        )];
        notes.extend(self.capability_notes());
        if self.results.iter().any(|result| result.capability.gauge.is_some()) {
            notes.push(
                "Gauge share: of the uncertainties of the measured errors alone; what is uncertain about the gear is the same for all parts."
                    .to_owned(),
            );
        }
        let is_overstated = |gauge: Gauge| gauge.part_deviation_mm.is_none();
        if self.results.iter().any(|result| result.capability.gauge.is_some_and(is_overstated)) {
            notes.push("The given uncertainty exceeds the spread of some values: it is overstated there.".to_owned());
        }
        for ResultFact { name, count, standard_deviation_mm, .. } in &self.results {
            if *count > 1 && standard_deviation_mm.is_none() {
                notes.push(format!("{name}: no standard deviation, because the sum of the squares is too large"));
            }
        }
        notes.extend(self.outcome.why_incomplete().map(|why| format!("The run is incomplete: {why}.")));
        notes
    }
}

impl<'a> From<&'a Quantity> for ResultFact<'a> {
    fn from(quantity: &'a Quantity) -> Self {
        let Quantity { name, limits, statistics, .. } = quantity;
        let quantile = |share| QuantileFact { share, value_mm: statistics.quantile_mm(share) };
        Self {
            name,
            count: statistics.count(),
            mean_mm: statistics.mean_mm(),
            standard_deviation_mm: statistics.standard_deviation_mm(),
            min_mm: statistics.min_mm(),
            max_mm: statistics.max_mm(),
            quantiles: QUANTILES.map(quantile),
            limit_lower_mm: limits.0,
            limit_upper_mm: limits.1,
            capability: Capability::of(statistics, quantity.own_limits(), *limits),
            quantity,
        }
    }
}

/// One of the worst parts, for programs.
fn part_fact(part: &Part) -> Value {
    json!({
        "part_id": part.id,
        "file": *part.place.file,
        "line": part.place.line,
        "record": part.place.record,
        "place": part.place.in_words,
        "limit_on": part.on.map(LimitTarget::key),
        "result_lower_mm": part.result_mm.0,
        "result_upper_mm": part.result_mm.1,
        "margin_mm": part.on.map(|_| part.margin_mm),
        "verdict": part.verdict.map(Verdict::name),
    })
}

impl Report for BatchReport<'_> {
    fn json(&self) -> Value {
        let judged_by = if self.outcome.counts.meshed > 0 { JudgedBy::Mesh } else { self.sum_judged_by() };
        let Outcome { counts, worst, interrupted, is_cut, .. } = self.outcome;
        let named = counts.named().into_iter().map(|(name, count)| (name.to_owned(), count.into()));
        let mut json = json!({
            "title": self.title,
            "model": self.basis.model,
            "stack": self.basis.stack.map(Stack::name),
            "judged_by": judged_by.name(),
            "rule": self.basis.rule.to_string(),
            "assumes": self.basis.assumes,
            "counts": named.collect::<Map<_, Value>>(),
            "results": self.results,
            "capability": self.whole_capability(),
            "worst": worst.iter().map(part_fact).collect::<Vec<_>>(),
            "unjudged_limits": self.basis.unjudged.iter().map(|on| on.key()).collect::<Vec<_>>(),
            "interrupted": interrupted,
            "complete": !interrupted && !is_cut,
            "notes": self.notes(),
        });
        if let Some(judge) = &self.basis.yoke {
            json["yoke"] = lot_json(&judge.yoke, &self.outcome.settings);
        }
        if self.basis.is_all_placed {
            json["judged_by_mesh"] = counts.meshed.into();
        }
        json
    }

    /// One row per result.
    fn rows(&self) -> Vec<Vec<String>> {
        let quantile = |(place, share): (usize, f64)| format!(" q{share}_mm=quantiles/{place}/value_mm");
        let quantiles: String = QUANTILES.into_iter().enumerate().map(quantile).collect();
        let counts = self.outcome.counts.named().map(|(name, _)| format!("{name}=counts/{name} ")).concat();
        let names = format!(
            "name count mean_mm standard_deviation_mm min_mm max_mm {quantiles} limit_lower_mm limit_upper_mm \
             pp=pp/value ppk=ppk/value {counts} cp=cp/value cpk=cpk/value normality_p=normality/p_value \
             gauge_variance_share=gauge/variance_share"
        );
        fact::rows(&self.json(), "results", &names)
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = titled(self.title);
        blocks.push(self.counts_table());
        if self.outcome.counts.rows > self.outcome.counts.rejected {
            blocks.push(self.statistics_table());
            blocks.extend(self.capability_table());
            blocks.extend(self.gauge_table());
            blocks.extend(self.plug_table());
            blocks.push(self.worst_table());
        }
        blocks.extend(self.notes().into_iter().map(Block::Note));
        blocks.push(self.verdict());
        blocks
    }
}
