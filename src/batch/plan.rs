//! What is computed for each part: from the spec, the first table's header and what was asked.
//!
//! The command line makes one [`Plan`] per run and one layout per table. A plan names the inputs that some
//! output or limit needs; nothing else is parsed, and no output that was not asked for is computed.

use std::sync::Arc;

use super::input::Header;
use super::layout::{Found, find_column, find_id};
use super::number::Decimals;
use super::output::{
    Asked, Of, Output, column_name, conformance_name, end_name, expanded_name, own_name, standard_name,
};
use super::request::{Request, RowFormat};
use super::uncertain::Uncertain;
use crate::decision::monte_carlo::MonteCarloError;
use crate::decision::{Limit, LimitTarget, Limits, Rule, Stack};
use crate::deviation::ErrorKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::{Law, Model};
use crate::quantity::Length;
use crate::spec::{Reading, Spec};

/// One error that is read from the table.
#[derive(Debug, Clone)]
pub(super) struct Source {
    pub(super) law: Law,
    pub(super) reading: Reading,
}

/// What is computed for each part.
#[derive(Debug, Clone)]
pub struct Plan {
    pub(super) sources: Vec<Source>,
    pub(super) outputs: Vec<Output>,
    pub(super) model: Model,
    pub(super) stack: Stack,
    /// The limits that can be judged.
    pub(super) limits: Limits,
    /// The limits on errors that the table does not have.
    pub(super) unjudged: Vec<LimitTarget>,
    pub(super) decimals: Decimals,
    pub(super) format: RowFormat,
    pub(super) request: Request,
    /// The results that are held against a limit, by their place among the quantities, where statistics are kept.
    pub(super) followed: Vec<(usize, Output)>,
    /// The uncertainties, if some output, the rule or a statistic needs them.
    pub(super) uncertain: Option<Box<Uncertain>>,
    /// What stands before each value of a JSON line.
    pub(super) json_names: Vec<Vec<u8>>,
    pub(super) names_length: usize,
    pub(super) spec: Arc<Spec>,
}

impl Plan {
    /// Plans a batch for the spec and the header of its first table.
    ///
    /// # Errors
    /// Diagnostics for a table without a column that is known or that the spec promises, for gear data that
    /// a column's formula needs, and for names of output columns that there are not.
    pub fn new(spec: &Arc<Spec>, header: &Header, request: Request) -> Result<Self, Diagnostics> {
        let (present, found) = Self::columns(spec, header)?;
        let limits = spec.limits();
        let is_uncertain = !spec.uncertainties_of(&present)?.is_empty();
        if !is_uncertain {
            refuse_without_uncertainty(&request)?;
        }
        let outputs = Asked::all(header, &request, &present, &limits, is_uncertain)?;
        let judged_together = limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance);
        let combined = outputs.iter().any(|output| matches!(output, Asked::Result(_)));
        let needed = |kind: ErrorKind| {
            let limited = limits.iter().any(|(on, _)| *on == LimitTarget::Error(kind));
            judged_together || combined || limited || outputs.iter().any(|asked| asked.error() == Some(kind))
        };
        let mut diagnostics = Vec::new();
        let mut sources = Vec::new();
        for (kind, column) in present.iter().copied().zip(found).filter(|(kind, _)| needed(*kind)) {
            let source = column.reading(spec, header, kind).and_then(|reading| {
                let what = format!("the column of `{}`", kind.key());
                Ok(Source { law: spec.law(kind, &what)?, reading })
            });
            match source {
                Ok(source) => sources.push(source),
                Err(problems) => diagnostics.extend(problems.0),
            }
        }
        if !diagnostics.is_empty() {
            diagnostics.dedup();
            return Err(Diagnostics(diagnostics));
        }
        let index = |kind: ErrorKind| sources.iter().position(|source| source.law.kind() == kind);
        let is_read = |on: LimitTarget| match on {
            LimitTarget::CenterDistance => true,
            LimitTarget::Error(kind) => index(kind).is_some(),
        };
        let (judged, unjudged): (Limits, Limits) = limits.into_iter().partition(|(on, _)| is_read(*on));
        let unjudged = unjudged.into_iter().map(|(on, _)| on).collect();
        let outputs: Vec<_> = outputs.into_iter().filter_map(|asked| asked.output(&index, &judged)).collect();
        let uncertain = is_uncertain
            && (request.statistics
                || request.monte_carlo.is_some()
                || request.rule.needs_uncertainty()
                || outputs.iter().any(Output::is_uncertain));
        let uncertain = if uncertain { Some(Box::new(Uncertain::new(spec, &sources, &request)?)) } else { None };
        let stack = request.stack;
        let mut plan = Self {
            followed: Vec::new(),
            uncertain,
            json_names: Vec::new(),
            names_length: 0,
            model: request.model,
            stack,
            limits: judged,
            unjudged,
            decimals: request.decimals,
            format: request.format,
            sources,
            outputs,
            request,
            spec: Arc::clone(spec),
        };
        if plan.request.statistics {
            let limited = plan.quantity_limits().into_iter().map(|limit| limit != (None, None));
            let quantities = plan.quantities().cloned().enumerate().zip(limited);
            plan.followed = quantities.filter(|(_, limited)| *limited).map(|(quantity, _)| quantity).collect();
        }
        for (index, name) in plan.column_names().into_iter().enumerate() {
            let start = if index == 0 { '{' } else { ',' };
            let start = format!("{start}{}:", serde_json::Value::from(name));
            plan.names_length += start.len();
            plan.json_names.push(start.into_bytes());
        }
        Ok(plan)
    }

    /// The errors that the table has columns of, and where these are.
    fn columns(spec: &Spec, header: &Header) -> Result<(Vec<ErrorKind>, Vec<Found>), Diagnostics> {
        let mut present = Vec::new();
        let mut found = Vec::new();
        let mut diagnostics = Vec::new();
        for kind in ErrorKind::ALL {
            match find_column(spec, header, kind) {
                Ok(Some(column)) => {
                    present.push(kind);
                    found.push(column);
                }
                Ok(None) => {}
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        if !diagnostics.is_empty() {
            return Err(Diagnostics(diagnostics));
        }
        if present.is_empty() {
            return Err(no_column(header).into());
        }
        Ok((present, found))
    }

    /// The outputs of which there are statistics: ΔCD and its combinations.
    pub(super) fn quantities(&self) -> impl Iterator<Item = &Output> {
        self.outputs.iter().filter(|output| {
            matches!(
                output,
                Output::Error(_) | Output::RangeLower | Output::RangeUpper | Output::WorstCase | Output::Rss
            )
        })
    }

    /// Of which uncertainty the variance of a result is made, if the uncertainties are known.
    pub(super) fn spread_of(&self, output: &Output) -> Option<Of> {
        self.uncertain.as_ref()?;
        match (output, self.stack) {
            (Output::Error(source), _) => Some(Of::Source(*source)),
            (Output::RangeLower, Stack::Range) => Some(Of::Lower),
            (Output::RangeUpper, Stack::Range) | (Output::WorstCase, Stack::WorstCase) | (Output::Rss, Stack::Rss) => {
                Some(Of::Upper)
            }
            _ => None,
        }
    }

    /// Errors that are measured and to which the spec gives no uncertainty, while it gives others one.
    #[must_use]
    pub fn taken_as_exact(&self) -> Vec<ErrorKind> {
        let Some(uncertain) = &self.uncertain else { return Vec::new() };
        let known = uncertain.propagator.uncertainties();
        let given = |kind: &ErrorKind| known.of(crate::decision::uncertainty::Source::Error(*kind)).is_some();
        self.errors().filter(|kind| !given(kind)).collect()
    }

    /// Whether the parts' uncertainties are computed.
    #[must_use]
    pub fn is_uncertain(&self) -> bool {
        self.uncertain.is_some()
    }

    /// How a verdict is reached.
    #[must_use]
    pub fn rule(&self) -> &Rule {
        &self.request.rule
    }

    /// The names of the results that are numbers.
    #[must_use]
    pub fn quantity_names(&self) -> Vec<String> {
        self.quantities().map(|output| self.output_name(output)).collect()
    }

    /// The limits (mm, lower and upper) that each result that is a number is held against, if it is.
    #[must_use]
    pub fn quantity_limits(&self) -> Vec<(Option<f64>, Option<f64>)> {
        let limit = |on: LimitTarget| self.limits.iter().find(|(target, _)| *target == on).map(|(_, limit)| limit);
        let ends = |limit: &Limit| (limit.lower.map(Length::mm), limit.upper.map(Length::mm));
        let combined = |stack: Stack| {
            limit(LimitTarget::CenterDistance).filter(|_| self.stack == stack).map_or((None, None), ends)
        };
        // a magnitude W stands for -W to W: it must not exceed the nearer end
        let magnitude = |stack: Stack| {
            let (lower, upper) = combined(stack);
            let nearer = lower.map(|lower| -lower).into_iter().chain(upper).reduce(f64::min);
            (None, nearer)
        };
        let quantities = self.quantities().map(|output| match output {
            Output::Error(source) => {
                limit(LimitTarget::Error(self.sources[*source].law.kind())).map_or((None, None), ends)
            }
            Output::RangeLower | Output::RangeUpper => combined(Stack::Range),
            Output::WorstCase => magnitude(Stack::WorstCase),
            Output::Rss => magnitude(Stack::Rss),
            _ => (None, None),
        });
        quantities.collect()
    }

    /// The names of the columns written, in order.
    #[must_use]
    pub fn column_names(&self) -> Vec<String> {
        self.outputs.iter().map(|output| self.output_name(output)).collect()
    }

    /// What each column written holds.
    #[must_use]
    pub fn column_kinds(&self) -> Vec<super::parquet::ColumnKind> {
        use super::parquet::ColumnKind;
        let kind = |output: &Output| match output {
            Output::Id | Output::Verdict | Output::Copied(_) => ColumnKind::Text,
            Output::Linear | Output::Validated => ColumnKind::Flag,
            _ => ColumnKind::Number,
        };
        self.outputs.iter().map(kind).collect()
    }

    fn output_name(&self, output: &Output) -> String {
        match output {
            Output::Id => "part_id".to_owned(),
            Output::Error(source) => column_name(self.sources[*source].law.kind()),
            Output::RangeLower => "range_lower_mm".to_owned(),
            Output::RangeUpper => "range_upper_mm".to_owned(),
            Output::WorstCase => "worst_case_mm".to_owned(),
            Output::Rss => "rss_mm".to_owned(),
            Output::Standard(of) => standard_name(&self.name_of(*of)),
            Output::Expanded(of) => expanded_name(&self.name_of(*of)),
            Output::Linear => "linear".to_owned(),
            Output::Simulated(of, statistic) => statistic.name(&self.name_of(*of)),
            Output::Validated => "linear_validated".to_owned(),
            Output::Conformance(limit) => conformance_name(self.limits[*limit].0),
            Output::Verdict => "verdict".to_owned(),
            Output::Copied(name) => name.clone(),
        }
    }

    fn name_of(&self, of: Of) -> String {
        match of {
            Of::Source(source) => own_name(self.sources[source].law.kind()),
            end => end_name(self.stack, end).to_owned(),
        }
    }

    /// Limits on errors that the table has no column of: they are not judged.
    #[must_use]
    pub fn unjudged(&self) -> &[LimitTarget] {
        &self.unjudged
    }

    /// The limits that are judged.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The errors that are read.
    pub fn errors(&self) -> impl Iterator<Item = ErrorKind> + '_ {
        self.sources.iter().map(|source| source.law.kind())
    }

    /// The model of the formulas.
    #[must_use]
    pub fn model(&self) -> Model {
        self.model
    }

    /// The combination that is judged.
    #[must_use]
    pub fn stack(&self) -> Stack {
        self.stack
    }

    /// Errors of which the spec gives one part's value while the table has no column of them: they are left
    /// out.
    #[must_use]
    pub fn left_out(&self, header: &Header) -> Vec<ErrorKind> {
        let given = self.spec.errors.iter().map(|(kind, _)| *kind);
        given.filter(|kind| matches!(find_column(&self.spec, header, *kind), Ok(None))).collect()
    }

    /// Whether parts have a name of their own, or are called by the number of their row.
    #[must_use]
    pub fn has_id(&self, header: &Header) -> bool {
        find_id(&self.spec, header, self.request.id.as_deref()).is_ok_and(|id| id.is_some())
    }
}

/// Refuses what needs uncertainties where the spec gives none.
fn refuse_without_uncertainty(request: &Request) -> Result<(), Diagnostic> {
    if request.monte_carlo.is_some() {
        return Err(Diagnostic::error(Code::NoMonteCarlo, MonteCarloError::NothingUncertain.to_string())
            .help("give the errors an uncertainty, such as `rack_pitch = { u = \"0.8 um\" }`"));
    }
    if request.rule.needs_uncertainty() {
        let message = format!("the rule {} needs uncertainties, and the spec gives none", request.rule);
        return Err(Diagnostic::error(Code::BadRule, message).help(
            "give the errors one, such as `rack_pitch = { u = \"0.8 um\" }`; or the guard band: --rule guard=VALUE",
        ));
    }
    Ok(())
}

fn no_column(header: &Header) -> Diagnostic {
    let message = format!("{} has no column of an error that is known", header.name);
    let known: Vec<_> = ErrorKind::ALL.into_iter().map(ErrorKind::key).collect();
    Diagnostic::error(Code::BadTable, message).help(format!(
        "it has {}; name its columns {}, or say what they are: [batch.columns] rack_pitch = {{ name = \"…\" }}",
        header.names(),
        known.join(", ")
    ))
}
