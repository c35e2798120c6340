//! The columns that can be written for a part, and those that are asked for. The plan calls it; it names columns and computes
//! nothing.

use super::request::Request;
use crate::chance::Simulation;
use crate::deviation::DeviationKind;
use crate::diagnostic::{Diagnostic, nearest_or};
use crate::function::{FIGURES, Target};
use crate::judge::{Interval, LimitTarget, Stack};
use crate::quantity::Length;
use crate::table::Table;

/// One column of the output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Output {
    /// The part's name.
    Id,
    /// ΔCD of an error.
    Error(DeviationKind),
    /// An end of a combination.
    Combined(Stack, End),
    /// An end of the range that the limit on all errors together judges.
    Judged(End),
    /// How far the part is inside the nearest limit.
    Margin,
    /// The nearest end of a limit, by the spec's key.
    NearestLimit,
    /// An end of the range that the exact mesh reaches with the errors on the worst teeth found.
    Reached(End),
    /// Standard uncertainty of a result.
    Standard(UncertainOutput),
    /// Expanded uncertainty of a result.
    Expanded(UncertainOutput),
    /// Whether the linear uncertainties of the part describe it.
    Linear,
    /// The probability that a limit is met.
    Conformance(LimitTarget),
    /// A statistic of the simulated distribution of a result, by its place among them.
    Simulated(UncertainOutput, usize),
    /// Whether the simulation confirms the linear uncertainties of the combination.
    Validated,
    Verdict,
    /// Why a row has no results, or its part does not pass.
    Reason,
    /// A figure of the yoke, by its place among them.
    Yoke(usize),
    /// The verdict on a limit of the yoke.
    OnYoke(Target),
    /// The errors without which the parts are judged.
    Without,
    /// The input's column of that name, as it is.
    Copied(String),
}

/// What a spec gives of a yoke.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SaidOfYoke {
    /// Keys of a yoke, or limits on it.
    pub(super) is_given: bool,
    /// Limits on a yoke.
    pub(super) is_limited: bool,
}

/// An end of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Lower,
    Upper,
}

impl End {
    pub(super) const BOTH: [Self; 2] = [Self::Lower, Self::Upper];

    const fn name(self) -> &'static str {
        match self {
            Self::Lower => "lower",
            Self::Upper => "upper",
        }
    }

    /// This end of a range.
    #[inline]
    pub(super) const fn of(self, range: Interval) -> Length {
        match self {
            Self::Lower => range.lower,
            Self::Upper => range.upper,
        }
    }
}

/// A result that has an uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum UncertainOutput {
    /// ΔCD of an error.
    Error(DeviationKind),
    /// An end of the combination that is judged.
    Combined(End),
}

impl UncertainOutput {
    /// The name of the result, without its unit.
    fn name(self, stack: Stack) -> String {
        match self {
            Self::Error(kind) => format!("delta_cd_{}", kind.key()),
            Self::Combined(end) => format!("{}_{}", stack.name(), end.name()),
        }
    }
}

/// A statistic of a simulated distribution.
type SimulatedStatistic = (&'static str, fn(&Simulation) -> f64);

/// The statistics that are columns, with their names.
const SIMULATED: [SimulatedStatistic; 4] = [
    ("mean", |simulation| simulation.mean),
    ("standard", |simulation| simulation.standard),
    ("lower", |simulation| simulation.symmetric.0),
    ("upper", |simulation| simulation.symmetric.1),
];

/// A statistic of a simulated distribution.
pub(super) fn simulated(simulation: &Simulation, statistic: usize) -> f64 {
    SIMULATED[statistic].1(simulation)
}

impl Output {
    /// The outputs for parts with errors of these kinds and limits on these.
    fn all(
        request: &Request,
        kinds: &[DeviationKind],
        limits: &[LimitTarget],
        is_uncertain: bool,
        yoke: SaidOfYoke,
    ) -> Vec<Self> {
        let errors = kinds.iter().copied().map(UncertainOutput::Error);
        let results = || errors.clone().chain(End::BOTH.map(UncertainOutput::Combined));
        let mut all = vec![Self::Id];
        all.extend(kinds.iter().copied().map(Self::Error));
        all.extend(Stack::ALL.into_iter().flat_map(Self::ends));
        if request.mesh {
            all.extend(End::BOTH.map(Self::Reached));
        }
        if is_uncertain {
            all.extend(results().flat_map(|of| [Self::Standard(of), Self::Expanded(of)]));
            all.push(Self::Linear);
            if request.monte_carlo.is_some() {
                let statistic = |statistic| results().map(move |of| Self::Simulated(of, statistic));
                all.extend((0..SIMULATED.len()).flat_map(statistic));
                all.push(Self::Validated);
            }
            let is_known = |on: &LimitTarget| match on {
                LimitTarget::CenterDistance => true,
                LimitTarget::Error(kind) => kinds.contains(kind),
            };
            all.extend(limits.iter().copied().filter(is_known).map(Self::Conformance));
        }
        if yoke.is_given {
            all.extend((0..FIGURES.len()).map(Self::Yoke).chain(Target::ALL.map(Self::OnYoke)));
        }
        all.extend((!limits.is_empty()).then_some(Self::Margin));
        all.push(Self::Verdict);
        all.extend((!limits.is_empty() || yoke.is_limited).then_some(Self::Reason));
        all
    }

    /// Outputs that are written only where they are asked for.
    fn others() -> [Self; 4] {
        let [lower, upper] = End::BOTH.map(Self::Judged);
        [lower, upper, Self::Margin, Self::NearestLimit]
    }

    /// Both ends of a combination.
    pub(super) fn ends(stack: Stack) -> [Self; 2] {
        End::BOTH.map(|end| Self::Combined(stack, end))
    }

    /// The outputs that are asked for, else all.
    pub(super) fn asked(
        table: &Table,
        request: &Request,
        kinds: &[DeviationKind],
        limits: &[LimitTarget],
        is_uncertain: bool,
        yoke: SaidOfYoke,
    ) -> Result<Vec<Self>, Diagnostic> {
        let mut all = Self::all(request, kinds, limits, is_uncertain, yoke);
        let Some(names) = &request.columns else {
            let copied = request.copied.iter().filter(|name| table.titles.contains(name));
            all.splice(1..1, copied.cloned().map(Self::Copied));
            return Ok(all);
        };
        let output = |name: &String| {
            let others = Self::others();
            let known = |output: &&Self| output.name(request.stack) == *name;
            if let Some(output) = all.iter().find(known).or_else(|| others.iter().find(known)) {
                return Ok(output.clone());
            }
            if table.titles.contains(name) {
                return Ok(Self::Copied(name.clone()));
            }
            if !is_uncertain && Self::would_be_uncertain(name) {
                let message = format!("there is no column `{name}` to write: the spec gives no uncertainty");
                return Err(Diagnostic::usage(message)
                    .help("give the errors one, such as `rack_pitch = { u = \"0.8 um\" }` in [errors]"));
            }
            let mut known: Vec<String> = Vec::new();
            for name in all.iter().chain(&others).map(|output| output.name(request.stack)) {
                if !known.contains(&name) {
                    known.push(name);
                }
            }
            let all = || {
                let titles = table.titles_in_words();
                format!("the results are {}; {} also has {titles}", known.join(", "), table.name)
            };
            Err(Diagnostic::usage(format!("there is no column `{name}` to write")).help(nearest_or(
                name,
                known.iter().chain(&table.titles),
                all,
            )))
        };
        names.iter().map(output).collect()
    }

    /// Whether a name is that of an output which takes uncertainties.
    fn would_be_uncertain(name: &str) -> bool {
        let limits = DeviationKind::ALL.map(LimitTarget::Error);
        let limits = [&limits[..], &[LimitTarget::CenterDistance]].concat();
        let all = Self::all(&Request::default(), &DeviationKind::ALL, &limits, true, SaidOfYoke::default());
        all.iter().any(|output| output.is_uncertain() && Stack::ALL.iter().any(|stack| output.name(*stack) == name))
    }

    /// The name of its column, where parts are judged by this combination.
    pub(super) fn name(&self, stack: Stack) -> String {
        match self {
            Self::Id => "part_id".to_owned(),
            Self::Error(kind) => format!("{}_mm", UncertainOutput::Error(*kind).name(stack)),
            Self::Combined(stack, end) => format!("{}_{}_mm", stack.name(), end.name()),
            Self::Judged(end) => format!("{}_mm", end.name()),
            Self::Margin => "margin_mm".to_owned(),
            Self::NearestLimit => "nearest_limit".to_owned(),
            Self::Reached(end) => format!("reached_{}_mm", end.name()),
            Self::Standard(of) => format!("{}_standard_uncertainty_mm", of.name(stack)),
            Self::Expanded(of) => format!("{}_expanded_uncertainty_mm", of.name(stack)),
            Self::Linear => "linear".to_owned(),
            Self::Simulated(of, statistic) => format!("{}_monte_carlo_{}_mm", of.name(stack), SIMULATED[*statistic].0),
            Self::Validated => "linear_validated".to_owned(),
            Self::Conformance(LimitTarget::CenterDistance) => "conformance_probability".to_owned(),
            Self::Conformance(LimitTarget::Error(kind)) => {
                format!("{}_conformance_probability", UncertainOutput::Error(*kind).name(stack))
            }
            Self::Verdict => "verdict".to_owned(),
            Self::Reason => "reason".to_owned(),
            Self::Yoke(figure) => FIGURES[*figure].0.to_owned(),
            Self::OnYoke(on) => format!("{}_verdict", on.name()),
            Self::Without => "judged_without".to_owned(),
            Self::Copied(name) => name.clone(),
        }
    }

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

    /// The error of this output, if it has one.
    fn error(&self) -> Option<DeviationKind> {
        match self {
            Self::Error(kind)
            | Self::Standard(UncertainOutput::Error(kind))
            | Self::Expanded(UncertainOutput::Error(kind))
            | Self::Simulated(UncertainOutput::Error(kind), _)
            | Self::Conformance(LimitTarget::Error(kind)) => Some(*kind),
            _ => None,
        }
    }

    /// Whether it follows from an error.
    pub(super) fn needs(&self, kind: DeviationKind) -> bool {
        let follows_from_none = matches!(self, Self::Id | Self::Copied(_));
        self.error().map_or(!follows_from_none, |of| of == kind)
    }
}
