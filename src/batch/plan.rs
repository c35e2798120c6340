//! What is computed for each part: from the spec, the first table's header and what was asked.
//!
//! The command line makes one [`Plan`] per run and one layout per table. A plan names the inputs that some
//! output or limit needs; nothing else is parsed, and no output that was not asked for is computed.

use std::sync::Arc;

use super::input::Header;
use super::layout::{find_column, find_id};
use super::number::{Decimals, Places};
use super::request::{Request, RowFormat};
use crate::decision::monte_carlo::{MonteCarloError, PartSimulation, Settings, Simulation, simulate_part, validate};
use crate::decision::uncertainty::{Part, Propagation, Propagator, Spreads, propagate};
use crate::decision::{Limit, LimitTarget, Limits, Rule, Stack};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::over_pin::OverPin;
use crate::formula::{Fixed, Model, PartError, Prepared};
use crate::quantity::{Length, Rational};
use crate::spec::{Reading, Spec};

/// One error that is read from the table.
#[derive(Debug, Clone)]
pub(super) struct Source {
    pub(super) kind: ErrorKind,
    pub(super) formula: Prepared,
    pub(super) reading: Reading,
}

/// One column of the output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Output {
    /// The part's name.
    Id,
    /// ΔCD of the source with that index.
    Error(usize),
    RangeLower,
    RangeUpper,
    WorstCase,
    Rss,
    /// Standard uncertainty of a result.
    Standard(Of),
    /// Expanded uncertainty of a result.
    Expanded(Of),
    /// Whether the linear uncertainties of the part describe it.
    Linear,
    /// The probability that the limit with that index is met.
    Conformance(usize),
    /// A statistic of the simulated distribution of a result.
    Simulated(Of, Simulated),
    /// Whether the simulation confirms the linear uncertainties of the combination.
    Validated,
    Verdict,
    /// The input's column of that name, as it is.
    Copied(String),
}

/// A result that has an uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    /// ΔCD of the source with that index.
    Source(usize),
    /// The lower end of the combination that is judged.
    Lower,
    /// Its upper end.
    Upper,
}

impl Output {
    /// Whether it takes the uncertainties of the part.
    pub(super) fn is_uncertain(&self) -> bool {
        matches!(
            self,
            Self::Standard(_)
                | Self::Expanded(_)
                | Self::Linear
                | Self::Conformance(_)
                | Self::Simulated(..)
                | Self::Validated
        )
    }
}

/// A statistic of a simulated distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Simulated {
    Mean,
    Standard,
    Lower,
    Upper,
}

impl Simulated {
    const ALL: [(&'static str, Self); 4] =
        [("mean", Self::Mean), ("standard", Self::Standard), ("lower", Self::Lower), ("upper", Self::Upper)];

    pub(super) fn of(self, simulation: &Simulation) -> f64 {
        match self {
            Self::Mean => simulation.mean,
            Self::Standard => simulation.standard,
            Self::Lower => simulation.symmetric.0,
            Self::Upper => simulation.symmetric.1,
        }
    }

    fn name(self, of: &str) -> String {
        let statistic = Self::ALL.into_iter().find(|(_, statistic)| *statistic == self).map_or("", |(name, _)| name);
        format!("{of}_monte_carlo_{statistic}_mm")
    }
}

/// What is known of the uncertainty of a part's results.
pub(super) struct Known {
    pub(super) propagation: Propagation,
    pub(super) spreads: Spreads,
    pub(super) simulation: Option<PartSimulation>,
    /// Whether the simulation confirms the linear result for both ends of the combination.
    pub(super) validated: Option<bool>,
}

/// What is uncertain about the parts.
#[derive(Debug, Clone)]
pub(super) struct Uncertain {
    pub(super) propagator: Propagator,
    /// What the nominal measure over the roller is computed from, if it is.
    over_pin: Option<OverPin>,
    /// How to simulate, if that is asked for.
    pub(super) monte_carlo: Option<Settings>,
}

impl Uncertain {
    /// The uncertainties of one part as `eval` computes them.
    pub(super) fn exact(
        &self,
        errors: &[PartError],
        model: Model,
        stack: Stack,
        limits: &Limits,
    ) -> Result<Known, MonteCarloError> {
        let part = Part { errors, over_pin: self.over_pin.as_ref(), model, stack };
        let uncertainties = self.propagator.uncertainties();
        let propagation = propagate(&part, uncertainties)?;
        let spreads = self.propagator.exact(&part, &propagation)?;
        let simulate = |settings: &Settings| simulate_part(&part, uncertainties, limits, settings);
        let simulation = self.monte_carlo.as_ref().map(simulate).transpose()?;
        let validated = simulation.as_ref().map(|simulation| {
            let digits = simulation.outcome.digits;
            let ends = [(&propagation.lower, simulation.lower()), (&propagation.upper, simulation.upper())];
            ends.into_iter().all(|(linear, simulated)| validate(linear, simulated, digits).validated)
        });
        Ok(Known { propagation, spreads, simulation, validated })
    }
}

/// A limit on the fixed-point results.
#[derive(Debug, Clone)]
pub(super) struct FixedLimit {
    pub(super) on: Judged,
    /// The limit itself.
    pub(super) nominal: Zone,
    /// What is in here passes.
    pub(super) accepted: Zone,
    /// What is not in here fails; `None` if that is all that does not pass.
    pub(super) rejected: Option<Zone>,
}

/// An interval between integers of 1e-15 mm: the greatest that is not above an end, and the least that is not
/// below it; both are the end itself if it is such an integer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Zone {
    pub(super) lower: Option<(i64, i64)>,
    pub(super) upper: Option<(i64, i64)>,
}

/// Whether a zone holds a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holds {
    Yes,
    No,
    /// The bound on the result's error does not decide it.
    Unsure,
}

impl Zone {
    fn new(limit: &Limit, guard: &Length) -> Self {
        Self {
            lower: limit.lower.as_ref().map(|end| around(&(end + guard))),
            upper: limit.upper.as_ref().map(|end| around(&(end - guard))),
        }
    }

    /// Whether everything from `lower` to `upper` is inside.
    #[inline]
    pub(super) fn holds(&self, lower: Fixed, upper: Fixed) -> Holds {
        let mut holds = Holds::Yes;
        if let Some((below, _)) = self.upper
            && upper.units + upper.bound > below
        {
            if upper.units - upper.bound > below {
                return Holds::No;
            }
            holds = Holds::Unsure;
        }
        if let Some((_, above)) = self.lower
            && lower.units - lower.bound < above
        {
            if lower.units + lower.bound < above {
                return Holds::No;
            }
            holds = Holds::Unsure;
        }
        holds
    }
}

/// What a limit is held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Judged {
    /// The combination.
    Combined,
    /// The source with that index.
    Source(usize),
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
    pub(super) fixed_limits: Vec<FixedLimit>,
    /// The limits on errors that the table does not have.
    pub(super) unjudged: Vec<LimitTarget>,
    pub(super) decimals: Decimals,
    pub(super) places: Option<Places>,
    pub(super) format: RowFormat,
    pub(super) request: Request,
    /// Which combinations some output or limit needs.
    pub(super) needs_range: bool,
    pub(super) needs_worst: bool,
    pub(super) needs_rss: bool,
    /// The results that are held against a limit, by their place among the quantities, where statistics are kept.
    pub(super) followed: Vec<(usize, Output)>,
    /// The uncertainties, if some output, the rule or a statistic needs them.
    pub(super) uncertain: Option<Box<Uncertain>>,
    pub(super) results_per_part: u64,
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
        let limits = spec.limits();
        let is_uncertain = !spec.uncertainties_of(&present)?.is_empty();
        if request.monte_carlo.is_some() && !is_uncertain {
            return Err(Diagnostic::error(Code::NoMonteCarlo, MonteCarloError::NothingUncertain.to_string())
                .help("give the errors an uncertainty, such as `rack_pitch = { u = \"0.8 um\" }`")
                .into());
        }
        if request.rule.needs_uncertainty() && !is_uncertain {
            let message = format!("the rule {} needs uncertainties, and the spec gives none", request.rule);
            return Err(Diagnostic::error(Code::BadRule, message)
                .help("give the errors one, such as `rack_pitch = { u = \"0.8 um\" }`; or the guard band: --rule guard=VALUE")
                .into());
        }
        let outputs = Self::asked(header, &request, &present, &limits, is_uncertain)?;
        let judged_together = limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance);
        let combined = outputs.iter().any(|output| matches!(output, Asked::Result(_)));
        let needed = |kind: ErrorKind| {
            let limited = limits.iter().any(|(on, _)| *on == LimitTarget::Error(kind));
            judged_together || combined || limited || outputs.iter().any(|asked| asked.error() == Some(kind))
        };
        let mut sources = Vec::new();
        for (kind, column) in present.iter().copied().zip(found).filter(|(kind, _)| needed(*kind)) {
            let source = column.reading(spec, header, kind).and_then(|reading| {
                let what = format!("the column of `{}`", kind.key());
                let formula = spec.part_formula(kind, &what)?;
                Ok(Source { kind, formula: Prepared::new(&formula, request.model), reading })
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
        let index = |kind: ErrorKind| sources.iter().position(|source| source.kind == kind);
        let JudgedLimits { limits: judged, fixed: fixed_limits, unjudged } =
            JudgedLimits::new(limits, &request.rule, &index);
        let outputs: Vec<_> = outputs
            .into_iter()
            .filter_map(|asked| {
                Some(match asked {
                    Asked::Id => Output::Id,
                    Asked::Own(kind) => Output::Error(index(kind)?),
                    Asked::Standard(kind) => Output::Standard(Of::Source(index(kind)?)),
                    Asked::Expanded(kind) => Output::Expanded(Of::Source(index(kind)?)),
                    Asked::Simulated(kind, statistic) => Output::Simulated(Of::Source(index(kind)?), statistic),
                    Asked::Conformance(target) => Output::Conformance(judged.iter().position(|(on, _)| *on == target)?),
                    Asked::Result(output) => output,
                    Asked::Copied(name) => Output::Copied(name),
                })
            })
            .collect();
        let uncertain = is_uncertain
            && (request.statistics
                || request.monte_carlo.is_some()
                || request.rule.needs_uncertainty()
                || outputs.iter().any(Output::is_uncertain));
        let uncertain = if uncertain { Some(Self::uncertain(spec, &sources, &request)?) } else { None };
        let stack = request.stack;
        let needs = |output: &Output, by: Stack| outputs.contains(output) || (judged_together && stack == by);
        let needs_range = needs(&Output::RangeLower, Stack::Range) || outputs.contains(&Output::RangeUpper);
        let (needs_worst, needs_rss) = (needs(&Output::WorstCase, Stack::WorstCase), needs(&Output::Rss, Stack::Rss));
        let combinations = 2 * u64::from(needs_range) + u64::from(needs_worst) + u64::from(needs_rss);
        let mut plan = Self {
            needs_range,
            needs_worst,
            needs_rss,
            followed: Vec::new(),
            uncertain,
            results_per_part: sources.len() as u64 + combinations,
            json_names: Vec::new(),
            names_length: 0,
            model: request.model,
            stack,
            limits: judged,
            fixed_limits,
            unjudged,
            decimals: request.decimals,
            places: match request.decimals {
                Decimals::Places(places) => Places::new(places),
                Decimals::Full => None,
            },
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

    /// The outputs that were asked for, or all of them.
    fn asked(
        header: &Header,
        request: &Request,
        present: &[ErrorKind],
        limits: &Limits,
        is_uncertain: bool,
    ) -> Result<Vec<Asked>, Diagnostic> {
        let own = present.iter().map(|kind| (column_name(*kind), Asked::Own(*kind)));
        let results = [
            ("range_lower_mm", Output::RangeLower),
            ("range_upper_mm", Output::RangeUpper),
            ("worst_case_mm", Output::WorstCase),
            ("rss_mm", Output::Rss),
        ];
        let results = results.map(|(name, output)| (name.to_owned(), Asked::Result(output)));
        let mut all: Vec<_> = std::iter::once(("part_id".to_owned(), Asked::Id)).chain(own).chain(results).collect();
        if is_uncertain {
            for kind in present {
                all.push((standard_name(&own_name(*kind)), Asked::Standard(*kind)));
                all.push((expanded_name(&own_name(*kind)), Asked::Expanded(*kind)));
            }
            for of in ends(request.stack) {
                let name = end_name(request.stack, *of);
                all.push((standard_name(name), Asked::Result(Output::Standard(*of))));
                all.push((expanded_name(name), Asked::Result(Output::Expanded(*of))));
            }
            all.push(("linear".to_owned(), Asked::Result(Output::Linear)));
            if request.monte_carlo.is_some() {
                for (_, statistic) in Simulated::ALL {
                    for kind in present {
                        all.push((statistic.name(&own_name(*kind)), Asked::Simulated(*kind, statistic)));
                    }
                    for of in ends(request.stack) {
                        let name = statistic.name(end_name(request.stack, *of));
                        all.push((name, Asked::Result(Output::Simulated(*of, statistic))));
                    }
                }
                all.push(("linear_validated".to_owned(), Asked::Result(Output::Validated)));
            }
            let judged = limits.iter().map(|(on, _)| *on).filter(|on| match on {
                LimitTarget::CenterDistance => true,
                LimitTarget::Error(kind) => present.contains(kind),
            });
            all.extend(judged.map(|on| (conformance_name(on), Asked::Conformance(on))));
        }
        all.push(("verdict".to_owned(), Asked::Result(Output::Verdict)));
        let Some(names) = &request.columns else {
            return Ok(all.into_iter().map(|(_, asked)| asked).collect());
        };
        let mut asked = Vec::new();
        for name in names {
            if let Some((_, output)) = all.iter().find(|(known, _)| known == name) {
                asked.push(output.clone());
            } else if header.columns.contains(name) {
                asked.push(Asked::Copied(name.clone()));
            } else {
                let known: Vec<_> = all.iter().map(|(name, _)| name.as_str()).collect();
                let uncertain = name.contains("uncertainty") || name.contains("conformance") || name == "linear";
                if uncertain && !is_uncertain {
                    let message = format!("there is no column `{name}` to write: the spec gives no uncertainty");
                    return Err(Diagnostic::error(Code::Usage, message)
                        .help("give the errors one, such as `rack_pitch = { u = \"0.8 um\" }` in [errors]"));
                }
                return Err(Diagnostic::error(Code::Usage, format!("there is no column `{name}` to write")).help(
                    format!(
                        "the results are {}; {} also has {}",
                        known.join(", "),
                        header.name,
                        header.columns.join(", ")
                    ),
                ));
            }
        }
        Ok(asked)
    }

    /// What is uncertain about parts of which these errors are read.
    fn uncertain(spec: &Spec, sources: &[Source], request: &Request) -> Result<Box<Uncertain>, Diagnostics> {
        let kinds: Vec<_> = sources.iter().map(|source| source.kind).collect();
        let formulas: Vec<_> = sources.iter().map(|source| source.formula.clone()).collect();
        let over_pin = spec.over_pin().filter(|over_pin| {
            // another nominal value may stand in the way
            let computed = over_pin.measure().map(ErrorValue::Length);
            computed.is_ok_and(|nominal| {
                let nominal = Reading::Measured(nominal);
                sources.iter().any(|source| source.kind == ErrorKind::RackOverRoller && source.reading == nominal)
            })
        });
        let uncertainties = spec.uncertainties_of(&kinds)?;
        let propagator = Propagator::new(&formulas, over_pin.as_ref(), uncertainties, request.stack)
            .map_err(|error| Diagnostic::error(Code::NoResult, error.to_string()))?;
        // every part has a core of its own
        let monte_carlo = request.monte_carlo.map(|settings| Settings { threads: Some(1), ..settings });
        Ok(Box::new(Uncertain { propagator, over_pin, monte_carlo }))
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
        let ends = |limit: &Limit| (limit.lower.as_ref().map(Length::mm), limit.upper.as_ref().map(Length::mm));
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
            Output::Error(source) => limit(LimitTarget::Error(self.sources[*source].kind)).map_or((None, None), ends),
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
    #[cfg(feature = "parquet")]
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
            Output::Error(source) => column_name(self.sources[*source].kind),
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
            Of::Source(source) => own_name(self.sources[source].kind),
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
        self.sources.iter().map(|source| source.kind)
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

/// An output that was asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Asked {
    Id,
    Own(ErrorKind),
    Standard(ErrorKind),
    Expanded(ErrorKind),
    Simulated(ErrorKind, Simulated),
    Conformance(LimitTarget),
    Result(Output),
    Copied(String),
}

impl Asked {
    /// The error that it is about, if it is about one.
    fn error(&self) -> Option<ErrorKind> {
        match self {
            Self::Own(kind) | Self::Standard(kind) | Self::Expanded(kind) | Self::Simulated(kind, _) => Some(*kind),
            Self::Conformance(LimitTarget::Error(kind)) => Some(*kind),
            Self::Conformance(_) | Self::Id | Self::Result(_) | Self::Copied(_) => None,
        }
    }
}

/// The name of the column with an error's ΔCD.
fn column_name(kind: ErrorKind) -> String {
    format!("{}_mm", own_name(kind))
}

fn own_name(kind: ErrorKind) -> String {
    format!("delta_cd_{}", kind.key())
}

/// The ends of a combination that differ in their uncertainty.
fn ends(stack: Stack) -> &'static [Of] {
    if stack == Stack::Range { &[Of::Lower, Of::Upper] } else { &[Of::Upper] }
}

fn end_name(stack: Stack, of: Of) -> &'static str {
    match (stack, of) {
        (Stack::Range, Of::Lower) => "range_lower",
        (Stack::Range, _) => "range_upper",
        (Stack::WorstCase, _) => "worst_case",
        (Stack::Rss, _) => "rss",
    }
}

fn standard_name(of: &str) -> String {
    format!("{of}_standard_uncertainty_mm")
}

fn expanded_name(of: &str) -> String {
    format!("{of}_expanded_uncertainty_mm")
}

/// The name of the column with the probability that a limit is met.
fn conformance_name(on: LimitTarget) -> String {
    match on {
        LimitTarget::CenterDistance => "conformance_probability".to_owned(),
        LimitTarget::Error(kind) => format!("{}_conformance_probability", own_name(kind)),
    }
}

fn no_column(header: &Header) -> Diagnostic {
    let message = format!("{} has no column of an error that is known", header.name);
    let known: Vec<_> = ErrorKind::ALL.into_iter().map(ErrorKind::key).collect();
    Diagnostic::error(Code::BadTable, message).help(format!(
        "it has {}; name its columns {}, or say what they are: [batch.columns] rack_pitch = {{ name = \"…\" }}",
        header.columns.join(", "),
        known.join(", ")
    ))
}

/// The limits, as far as they can be judged.
#[derive(Default)]
struct JudgedLimits {
    limits: Limits,
    fixed: Vec<FixedLimit>,
    unjudged: Vec<LimitTarget>,
}

impl JudgedLimits {
    fn new(limits: Limits, rule: &Rule, index: &dyn Fn(ErrorKind) -> Option<usize>) -> Self {
        let mut sorted = Self::default();
        for (on, limit) in limits {
            let held = match on {
                LimitTarget::CenterDistance => Some(Judged::Combined),
                LimitTarget::Error(kind) => index(kind).map(Judged::Source),
            };
            if let Some(held) = held {
                sorted.fixed.push(FixedLimit::new(held, &limit, rule));
                sorted.limits.push((on, limit));
            } else {
                sorted.unjudged.push(on);
            }
        }
        sorted
    }
}

impl FixedLimit {
    fn new(on: Judged, limit: &Limit, rule: &Rule) -> Self {
        let nominal = Zone::new(limit, &Length::ZERO);
        match rule {
            Rule::Guard(guard) if !guard.is_zero() => {
                Self { on, nominal, accepted: Zone::new(limit, guard), rejected: Some(Zone::new(limit, &-guard)) }
            }
            // the guard band of ISO 14253-1 is each part's own
            Rule::Guard(_) | Rule::Simple | Rule::Iso14253 => Self { on, nominal, accepted: nominal, rejected: None },
        }
    }
}

/// The integers of 1e-15 mm next to a length, below and above; both are the length itself if it is one.
fn around(length: &Length) -> (i64, i64) {
    let scaled = length.exact_mm() * &Rational::integer(Fixed::PER_MM);
    // limits beyond the fixed-point results are met by all of them
    let whole = i64::try_from(scaled.to_fixed_point(0));
    let whole = whole.unwrap_or(if length.is_negative() { i64::MIN / 2 } else { i64::MAX / 2 });
    match scaled.partial_cmp(&whole) {
        Some(std::cmp::Ordering::Less) => (whole - 1, whole),
        Some(std::cmp::Ordering::Greater) => (whole, whole + 1),
        _ => (whole, whole),
    }
}
