//! What is computed for each part: from the spec, the first table's header and what was asked.
//!
//! The command line makes one [`Plan`] per run and one layout per table. A plan names the inputs that some
//! output or limit needs; nothing else is parsed, and no output that was not asked for is computed.

use std::sync::Arc;

use super::input::Header;
use super::layout::{find_column, find_id};
use super::number::{Decimals, Places};
use super::request::{Request, RowFormat};
use crate::decision::{Limit, LimitTarget, Limits, Rule, Stack};
use crate::deviation::ErrorKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::{Fixed, Model, Prepared};
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
    Verdict,
    /// The input's column of that name, as it is.
    Copied(String),
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
        if request.rule.needs_uncertainty() {
            let message = format!("a batch has no uncertainty of its own for the rule {}", request.rule);
            return Err(Diagnostic::error(Code::BadRule, message)
                .help("give the guard band, 1.65 u_c of one part as `rackmesh eval` prints it: --rule guard=VALUE")
                .into());
        }
        let mut present = Vec::new();
        let mut diagnostics = Vec::new();
        for kind in ErrorKind::ALL {
            match find_column(spec, header, kind) {
                Ok(Some(_)) => present.push(kind),
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
        let outputs = Self::asked(header, &request, &present)?;
        let judged_together = limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance);
        let combined = outputs.iter().any(|output| !matches!(output, Asked::Own(_) | Asked::Id | Asked::Copied(_)));
        let needed = |kind: ErrorKind| {
            let limited = limits.iter().any(|(on, _)| *on == LimitTarget::Error(kind));
            judged_together || combined || limited || outputs.contains(&Asked::Own(kind))
        };
        let mut sources = Vec::new();
        for kind in present.iter().copied().filter(|kind| needed(*kind)) {
            let source = spec.reading(kind).and_then(|reading| {
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
        let outputs: Vec<_> = outputs
            .into_iter()
            .filter_map(|asked| {
                Some(match asked {
                    Asked::Id => Output::Id,
                    Asked::Own(kind) => Output::Error(index(kind)?),
                    Asked::Result(output) => output,
                    Asked::Copied(name) => Output::Copied(name),
                })
            })
            .collect();
        let JudgedLimits { limits: judged, fixed: fixed_limits, unjudged } =
            JudgedLimits::new(limits, &request.rule, &index);
        let stack = request.stack;
        let needs = |output: &Output, by: Stack| outputs.contains(output) || (judged_together && stack == by);
        let needs_range = needs(&Output::RangeLower, Stack::Range) || outputs.contains(&Output::RangeUpper);
        let (needs_worst, needs_rss) = (needs(&Output::WorstCase, Stack::WorstCase), needs(&Output::Rss, Stack::Rss));
        let combinations = 2 * u64::from(needs_range) + u64::from(needs_worst) + u64::from(needs_rss);
        let mut plan = Self {
            needs_range,
            needs_worst,
            needs_rss,
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
        for (index, name) in plan.column_names().into_iter().enumerate() {
            let start = if index == 0 { '{' } else { ',' };
            let start = format!("{start}{}:", serde_json::Value::from(name));
            plan.names_length += start.len();
            plan.json_names.push(start.into_bytes());
        }
        Ok(plan)
    }

    /// The outputs that were asked for, or all of them.
    fn asked(header: &Header, request: &Request, present: &[ErrorKind]) -> Result<Vec<Asked>, Diagnostic> {
        let own = present.iter().map(|kind| (column_name(*kind), Asked::Own(*kind)));
        let results = [
            ("range_lower_mm", Output::RangeLower),
            ("range_upper_mm", Output::RangeUpper),
            ("worst_case_mm", Output::WorstCase),
            ("rss_mm", Output::Rss),
            ("verdict", Output::Verdict),
        ];
        let results = results.map(|(name, output)| (name.to_owned(), Asked::Result(output)));
        let all: Vec<_> = std::iter::once(("part_id".to_owned(), Asked::Id)).chain(own).chain(results).collect();
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

    /// The outputs that are numbers.
    pub(super) fn quantities(&self) -> impl Iterator<Item = &Output> {
        self.outputs.iter().filter(|output| !matches!(output, Output::Id | Output::Verdict | Output::Copied(_)))
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
            Output::Id | Output::Verdict | Output::Copied(_) => (None, None),
        });
        quantities.collect()
    }

    /// The names of the columns written, in order.
    #[must_use]
    pub fn column_names(&self) -> Vec<String> {
        self.outputs.iter().map(|output| self.output_name(output)).collect()
    }

    fn output_name(&self, output: &Output) -> String {
        match output {
            Output::Id => "part_id".to_owned(),
            Output::Error(source) => column_name(self.sources[*source].kind),
            Output::RangeLower => "range_lower_mm".to_owned(),
            Output::RangeUpper => "range_upper_mm".to_owned(),
            Output::WorstCase => "worst_case_mm".to_owned(),
            Output::Rss => "rss_mm".to_owned(),
            Output::Verdict => "verdict".to_owned(),
            Output::Copied(name) => name.clone(),
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
    Result(Output),
    Copied(String),
}

/// The name of the column with an error's ΔCD.
fn column_name(kind: ErrorKind) -> String {
    format!("delta_cd_{}_mm", kind.key())
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
            // `Plan::new` refuses the rule that needs an uncertainty
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
