//! What is computed for each part: from the spec, the first table's header and the request.
//!
//! The command line makes one [`Plan`] per run and one layout per table. A plan names the inputs that some
//! output or limit needs; nothing else is parsed, and no output that was not asked for is computed.

use std::sync::Arc;

use super::asked::{Asked, asks_for_reached, refuse_unreached};
use super::columns::ColumnKind;
use super::number::Decimals;
use super::outcome::{Part, PartError, Quantity};
use super::output::{Output, UncertainOutput};
use super::request::Request;
use super::source::Source;
use super::uncertain::Uncertain;
use super::write;
use crate::deviation::DeviationKind;
use crate::diagnostic::Diagnostics;
use crate::evaluation::{JudgedBy, subject};
use crate::function::YokeJudge;
use crate::judge::bound::{Basis, GivenGeometry, NoBound, Note};
use crate::judge::{Limit, LimitTarget, Limits, Stack};
use crate::quantity::Places;
use crate::spec::{PitchCircle, Spec, WrittenError};
use crate::table::Table;
use crate::uncertainty::Unstated;

/// What is computed for each part.
#[expect(clippy::struct_excessive_bools, reason = "what is needed of each part")]
#[derive(Debug, Clone)]
pub struct Plan {
    pub(super) sources: Vec<Source>,
    /// The errors with a column in the first table, and those of every part.
    pub(super) present: Vec<DeviationKind>,
    pub(super) outputs: Vec<Output>,
    /// What is known of the pair.
    pub(super) basis: Basis,
    /// Whether the worst case, or the statistical sum, is written, judged or counted.
    pub(super) needs_range: bool,
    pub(super) needs_rss: bool,
    /// Whether the statistical sum is asked for but nothing scatters, so that the worst case is judged.
    nothing_scatters: bool,
    /// Whether the range that the mesh reaches is written.
    pub(super) needs_reached: bool,
    /// Whether no error is left to place: the exact mesh judges parts that the bound does not pass.
    pub(crate) is_all_placed: bool,
    /// How the parts' yoke is judged, if the spec has one.
    pub(crate) yoke: Option<YokeJudge>,
    /// Whether no error is left to place, so that the figures of the yoke come from the exact mesh.
    pub(super) knows_teeth: bool,
    /// The limits that can be judged.
    pub limits: Limits,
    /// The limits that cannot be judged: on errors that the table does not have, or on a sum that lacks one.
    pub unjudged: Vec<LimitTarget>,
    /// The errors that the spec asks for and the table lacks: without them there is no sum for a part.
    pub lacking: Vec<DeviationKind>,
    /// The errors without which the user has the parts judged.
    pub(super) without: String,
    /// Whether parts have a name of their own, or are called by the number of their row.
    pub has_id: bool,
    /// The request.
    pub request: Request,
    /// The results with a limit, by their place among the quantities, where statistics are kept.
    pub(super) followed: Vec<(usize, Output)>,
    /// The uncertainties, if some output, the rule or a statistic needs them.
    pub(super) uncertain: Option<Box<Uncertain>>,
    /// The text before each value of a JSON line.
    pub(super) json_names: Vec<Vec<u8>>,
    /// How lengths are written, unless in full.
    pub(super) places: Option<Places>,
    pub(super) spec: Arc<Spec>,
    /// The errors that the first table has, in its order.
    of_table: Vec<DeviationKind>,
    /// For each limit, the quantity that it is on, by what judges it, and the lower and the upper side of the limit, in words.
    pub(super) limits_in_words: Vec<([String; JudgedBy::ALL.len()], [String; 2])>,
    /// Why a part has no verdict, where that is written.
    pub(super) without_verdict: String,
}

impl Plan {
    /// The spec, with the errors of a listed part as they are evaluated.
    #[must_use]
    pub fn spec_of(&self, part: &Part) -> Spec {
        let written =
            |error: &PartError| error.tolerance.map_or_else(|| error.deviation.into(), WrittenError::Tolerance);
        let mut errors: Vec<_> = part.errors.iter().map(|error| (error.kind, written(error))).collect();
        errors.sort_by_key(|(kind, _)| *kind);
        self.spec.with_errors(&errors)
    }

    /// Plans a batch for the spec and the columns of its first table.
    ///
    /// # Errors
    /// Diagnostics for a table without a known column or without one that the spec promises, for gear data that a column's
    /// formula needs, and for unknown names of output columns.
    pub fn new(spec: &Arc<Spec>, table: &Table, mut request: Request) -> Result<Self, Diagnostics> {
        let asked = Asked::new(spec, table, &request)?;
        let Asked { spec, sources, present, outputs, limits: judged, unjudged, lacking, without, is_uncertain } = asked;
        let spec = &spec;
        let basis = spec.basis()?;
        let is_asked = request.statistics || request.monte_carlo.is_some() || request.rule.needs_uncertainty();
        let uncertain = is_uncertain && (is_asked || outputs.iter().any(Output::is_uncertain));
        let uncertain = uncertain.then(|| Uncertain::new(spec, &sources, &request, &basis)).transpose()?.map(Box::new);
        let nothing_scatters = request.stack == Stack::Rss && !sources.iter().any(|source| source.scatters);
        if nothing_scatters {
            request.stack = Stack::Range;
        }
        let stack = request.stack;
        let is_judged = |of: Stack| stack == of && judged.iter().any(|(on, _)| *on == LimitTarget::CenterDistance);
        let is_shown = outputs.iter().any(|output| matches!(output, Output::Judged(_)));
        let needs = |of: Stack| {
            is_judged(of) || (is_shown && stack == of) || Output::ends(of).iter().any(|end| outputs.contains(end))
        };
        let yoke = spec.yoke_judge(None, &request.rule)?;
        let knows_teeth = matches!(basis.geometry, GivenGeometry::Known(_))
            && sources.iter().all(|source| source.extended.is_on_all_teeth());
        let is_all_placed = knows_teeth && judged.iter().any(|(on, _)| *on == LimitTarget::CenterDistance);
        let is_bounded = !knows_teeth && !spec.function_limits.is_empty();
        let (needs_range, needs_rss) = (is_bounded || needs(Stack::Range), needs(Stack::Rss));
        let needs_reached = asks_for_reached(&outputs);
        if needs_reached {
            refuse_unreached(spec, &basis)?;
        }
        let mut plan = Self {
            basis,
            needs_range,
            needs_rss,
            nothing_scatters,
            needs_reached,
            is_all_placed,
            yoke,
            knows_teeth,
            followed: Vec::new(),
            uncertain,
            json_names: Vec::new(),
            places: if let Decimals::Places(count) = request.decimals { Some(Places::new(count.into())) } else { None },
            limits: judged,
            unjudged,
            lacking,
            without: without.join("; "),
            has_id: table.has_id,
            sources,
            present,
            outputs,
            request,
            spec: Arc::clone(spec),
            of_table: table.kinds().collect(),
            limits_in_words: Vec::new(),
            without_verdict: String::new(),
        };
        plan.follow();
        Ok(plan)
    }

    /// Refuses what [`Plan::new`] refuses before anything is computed, without solving the spec's single teeth.
    ///
    /// # Errors
    /// As those of [`Plan::new`].
    pub fn refuse(spec: &Arc<Spec>, table: &Table, request: &Request) -> Result<(), Diagnostics> {
        Asked::new(spec, table, request).map(drop)
    }

    /// The columns that a plan writes by default, found before anything is computed.
    ///
    /// # Errors
    /// As those of [`Plan::new`].
    pub fn usual_columns(spec: &Arc<Spec>, table: &Table, request: &Request) -> Result<Vec<String>, Diagnostics> {
        let asked = Asked::new(spec, table, request)?;
        let usual = asked.outputs.iter().filter(|output| **output != Output::Without);
        Ok(usual.map(|output| output.name(request.stack)).collect())
    }

    /// Completes the plan: the results with statistics, words for verdicts, how JSON lines begin.
    fn follow(&mut self) {
        let in_words = |(on, limit): &(LimitTarget, Limit)| {
            (JudgedBy::ALL.map(|judged_by| subject(*on, judged_by)), limit.sides_in_words())
        };
        self.limits_in_words = self.limits.iter().map(in_words).collect();
        if self.outputs.contains(&Output::Reason) {
            self.without_verdict = self.no_verdict();
        }
        if self.request.statistics {
            let quantities = self.quantities().cloned().enumerate().zip(self.quantities_kept());
            self.followed = quantities.filter(|(_, kept)| kept.is_limited()).map(|(output, _)| output).collect();
        }
        self.json_names = write::json_starts(self.column_names().iter().map(String::as_str));
    }

    /// The circle on which the values of an error's column were measured, if it is another than the reference circle.
    pub(super) fn circle_of(&self, source: &Source) -> Option<&PitchCircle> {
        self.spec.pitch_circle.as_ref().filter(|_| source.law.kind() == DeviationKind::PinionPitch)
    }

    /// The outputs with statistics: ΔCD and its combinations.
    pub(super) fn quantities(&self) -> impl Iterator<Item = &Output> {
        self.outputs.iter().filter(|output| matches!(output, Output::Error(_) | Output::Combined(..)))
    }

    /// The uncertainty that makes the variance of a result, if the uncertainties are known.
    pub(super) fn spread_of(&self, output: &Output) -> Option<UncertainOutput> {
        self.uncertain.as_ref()?;
        match output {
            Output::Error(kind) => Some(UncertainOutput::Error(*kind)),
            Output::Combined(stack, end) if *stack == self.request.stack => Some(UncertainOutput::Combined(*end)),
            _ => None,
        }
    }

    /// Measured errors without an uncertainty in a spec that gives one to others.
    #[must_use]
    pub fn taken_as_exact(&self) -> Vec<DeviationKind> {
        let Some(uncertain) = &self.uncertain else { return Vec::new() };
        let known = uncertain.propagator.uncertainties();
        let given = |kind: &DeviationKind| known.of(crate::uncertainty::Influence::Error(*kind)).is_some();
        self.errors().filter(|kind| !given(kind)).collect()
    }

    /// Whether the parts' uncertainties are computed.
    #[must_use]
    pub fn is_uncertain(&self) -> bool {
        self.uncertain.is_some()
    }

    /// The results that have statistics, without a value so far.
    pub(super) fn quantities_kept(&self) -> Vec<Quantity> {
        let quantities = self.quantities().map(|output| {
            let (on, end) = match output {
                Output::Error(kind) => (Some(LimitTarget::Error(*kind)), None),
                Output::Combined(stack, end) if *stack == self.request.stack => {
                    (Some(LimitTarget::CenterDistance), Some(*end))
                }
                _ => (None, None),
            };
            let limit = self.limits.iter().find(|(target, _)| on == Some(*target)).map(|(_, limit)| limit);
            Quantity::new(output.name(self.request.stack), on, limit, end)
        });
        quantities.collect()
    }

    /// The columns of the lower and the upper end of the worst case, if they are written.
    #[must_use]
    pub fn range_columns(&self) -> Option<[usize; 2]> {
        let [lower, upper] =
            Output::ends(Stack::Range).map(|end| self.outputs.iter().position(|output| *output == end));
        Some([lower?, upper?])
    }

    /// The names of the columns written, in order.
    #[must_use]
    pub fn column_names(&self) -> Vec<String> {
        self.outputs.iter().map(|output| output.name(self.request.stack)).collect()
    }

    /// The columns written, in order: their names, and what they hold.
    #[must_use]
    pub fn columns_written(&self) -> Vec<(String, ColumnKind)> {
        self.column_names().into_iter().zip(self.column_kinds()).collect()
    }

    /// The kind of each column written.
    pub(super) fn column_kinds(&self) -> Vec<ColumnKind> {
        let kind = |output: &Output| match output {
            Output::Id
            | Output::NearestLimit
            | Output::Verdict
            | Output::Reason
            | Output::Without
            | Output::OnYoke(_)
            | Output::Copied(_) => ColumnKind::Text,
            Output::Linear | Output::Validated => ColumnKind::Flag,
            _ => ColumnKind::Number,
        };
        self.outputs.iter().map(kind).collect()
    }

    /// On which teeth the errors are, as far as the spec says so.
    #[must_use]
    pub fn extents_in_words(&self) -> Option<String> {
        self.spec.extents_in_words(&self.errors().collect::<Vec<_>>())
    }

    /// What the bound of a part with these errors assumes.
    #[must_use]
    pub fn bound_notes(&self) -> Vec<Note> {
        if !self.needs_range {
            return Vec::new();
        }
        let errors: Vec<_> = self.sources.iter().map(|source| source.extended).collect();
        let nothing_scatters = self.nothing_scatters.then_some(Note::NothingScatters);
        self.basis.bound(&errors).notes.into_iter().chain(nothing_scatters).collect()
    }

    /// What the verdicts assume of uncertainties.
    #[must_use]
    pub fn unstated(&self) -> Vec<Unstated> {
        self.spec.unstated(&self.present, self.basis.known_teeth.is_some(), &self.request.rule)
    }

    /// Whether a limit on all errors together is judged.
    #[must_use]
    pub fn judges_the_sum(&self) -> bool {
        self.limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance)
    }

    /// Whether a yoke has limits.
    #[must_use]
    pub fn is_yoke_limited(&self) -> bool {
        self.yoke.as_ref().is_some_and(|yoke| !yoke.limits.is_empty())
    }

    /// Why no part has a range that is written or judged, whatever its values.
    #[must_use]
    pub fn open(&self) -> Option<NoBound> {
        let is_asked = self.needs_range || self.needs_rss || self.sources.iter().any(|source| source.is_limited);
        if !is_asked || matches!(self.basis.geometry, GivenGeometry::Known(_)) {
            return None;
        }
        let errors: Vec<_> = self.sources.iter().map(|source| source.extended).collect();
        self.basis.together(&errors).range.err()
    }

    /// The errors that are read.
    pub fn errors(&self) -> impl Iterator<Item = DeviationKind> + '_ {
        self.sources.iter().map(|source| source.law.kind())
    }

    /// Errors whose value in the spec is that of every part.
    pub fn of_every_part(&self) -> impl Iterator<Item = DeviationKind> + '_ {
        self.sources.iter().filter(|source| source.of_every_part.is_some()).map(|source| source.law.kind())
    }

    /// Whether a table has the errors of this plan, and names for its parts if the first table has.
    pub(super) fn is_for(&self, table: &Table) -> bool {
        self.has_id == table.has_id && table.kinds().eq(self.of_table.iter().copied())
    }

    /// Why a part has no verdict.
    fn no_verdict(&self) -> String {
        match self.open() {
            _ if self.limits.is_empty() && self.unjudged.is_empty() => "there are no limits".to_owned(),
            _ if !self.lacking.is_empty() && !self.is_partial() => {
                let lacking = DeviationKind::keys(self.lacking.iter().copied());
                format!("not judged: the spec asks for {lacking}, and the table has none")
            }
            Some(open) => format!("not judged: {open}"),
            None if !self.taken_as_exact().is_empty() && self.request.rule.needs_uncertainty() => {
                let lacking = self.taken_as_exact().into_iter();
                format!("not judged: {}", self.request.rule.lacks_uncertainty(lacking))
            }
            None => "not judged: a limit is on what the table does not have, or no bound is known, here or within the uncertainties".to_owned(),
        }
    }

    /// Whether parts are judged although the table lacks an error.
    #[must_use]
    pub fn is_partial(&self) -> bool {
        !self.without.is_empty()
    }
}
