//! How the parts of a batch are evaluated and judged, for its reports.

use super::grounds::{Assumption, assumptions};
use super::judged_without;
use super::number::grouped;
use super::uncertainty::rule_words;
use crate::batch::{Outcome, Plan};
use crate::deviation::DeviationKind;
use crate::function::YokeJudge;
use crate::judge::{LimitTarget, Limits, Rule, Stack};
use crate::spec::Spec;

/// How the parts of a batch were evaluated and judged.
#[derive(Debug, Default)]
pub struct Basis {
    /// The model.
    pub model: &'static str,
    /// The combination that is judged; `None` for the exact mesh, which combines nothing.
    pub stack: Option<Stack>,
    /// The decision rule.
    pub rule: Rule,
    /// The limits that are judged.
    pub limits: Limits,
    /// The limits that cannot be judged.
    pub unjudged: Vec<LimitTarget>,
    /// Errors that the spec asks for and the tables lack.
    pub lacking: Vec<DeviationKind>,
    /// Those of them without which the parts were judged.
    pub without: Vec<DeviationKind>,
    /// Whether every error is on all teeth, so that the exact mesh judges parts that the worst case does not pass.
    pub is_all_placed: bool,
    /// The limits on the yoke, if the spec has one.
    pub yoke: Option<YokeJudge>,
    /// What verdicts assume.
    pub assumes: Vec<Assumption>,
}

impl Basis {
    /// The basis of parts by the formulas.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        Self {
            model: plan.request.model.name(),
            stack: Some(plan.request.stack),
            rule: plan.request.rule.clone(),
            limits: plan.limits.clone(),
            unjudged: plan.unjudged.clone(),
            lacking: plan.lacking.clone(),
            without: if plan.is_partial() { plan.lacking.clone() } else { Vec::new() },
            is_all_placed: plan.is_all_placed,
            yoke: plan.yoke.clone(),
            assumes: assumptions(&plan.bound_notes(), plan.judges_the_sum(), &plan.unstated()),
        }
    }

    /// The basis of parts with their teeth, judged by a rule.
    #[must_use]
    pub fn of_teeth(spec: &Spec, rule: &Rule) -> Self {
        let is_judged = |on: LimitTarget| match on {
            LimitTarget::CenterDistance => true,
            LimitTarget::Error(kind) => spec.every_part.contains(&kind),
        };
        // deviations of single teeth are no single error
        let (limits, unjudged): (Limits, Limits) = spec.limits().into_iter().partition(|(on, _)| is_judged(*on));
        Self {
            model: "exact mesh",
            rule: rule.clone(),
            assumes: assumptions(&[], true, &spec.unstated(&spec.every_part, true, rule)),
            unjudged: unjudged.into_iter().map(|(on, _)| on).collect(),
            limits,
            yoke: spec.yoke_judge(None, rule).ok().flatten(),
            ..Self::default()
        }
    }

    /// A remark on limits that are not judged, or on how many parts they are not judged.
    pub(crate) fn unjudged_sentence(&self, outcome: &Outcome) -> Option<String> {
        let counts = &outcome.counts;
        let names: Vec<_> = self.unjudged.iter().map(ToString::to_string).collect();
        if !names.is_empty() {
            let missing = match DeviationKind::keys(self.lacking.iter().copied()) {
                keys if keys.is_empty() => "something that the spec asks for is missing".to_owned(),
                keys => format!("the table lacks {keys}, which the spec asks for"),
            };
            return Some(format!("the limit on {} is not judged: {missing}", names.join(", ")));
        }
        let has_open = counts.unjudged > 0 && self.has_limits();
        has_open.then(|| {
            let parts = if counts.unjudged == 1 { "part has" } else { "parts have" };
            let what = if self.is_yoke_limited() { "a limit that is open" } else { "no range to hold against a limit" };
            // one that is told stands for the others
            let mut told = outcome.worst.iter().filter(|part| part.verdict.is_none());
            let why = told.find_map(|part| part.reason.as_ref().map(|why| format!(": {}: {why}", part.id)));
            format!("{} {parts} {what}{}", grouped(counts.unjudged), why.unwrap_or_default())
        })
    }

    /// What is counted: rows, each of which may be a part, or parts, where a row is a tooth.
    pub(super) const fn row_or_part(&self) -> &'static str {
        if self.stack.is_some() { "row" } else { "part" }
    }

    /// Whether something is asked of a yoke.
    fn is_yoke_limited(&self) -> bool {
        self.yoke.as_ref().is_some_and(|yoke| !yoke.limits.is_empty())
    }

    /// Whether there is a limit, judged or not.
    pub(super) fn has_limits(&self) -> bool {
        !(self.limits.is_empty() && self.unjudged.is_empty()) || self.is_yoke_limited()
    }

    /// The model and combination in words.
    #[must_use]
    pub fn judged_by(&self) -> String {
        let by = self.stack.map_or_else(|| self.model.to_owned(), |stack| format!("{} model, {stack}", self.model));
        format!("{by}{}{}{}", self.and_mesh(), rule_words(&self.rule), judged_without(&self.without))
    }

    /// The method that judges besides the worst case.
    pub(super) const fn and_mesh(&self) -> &'static str {
        if self.is_all_placed { ", or the exact mesh where that does not pass" } else { "" }
    }
}
