//! What can be written for a part, and what of it was asked for. Called by the plan; names columns and computes
//! nothing.

use super::request::Request;
use crate::chance::Simulation;
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::{LimitTarget, Limits, Stack};
use crate::table::Table;

/// One column of the output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Output {
    /// The part's name.
    Id,
    /// ΔCD of the source with that index.
    Error(usize),
    RangeLower,
    RangeUpper,
    RssLower,
    RssUpper,
    /// What the exact mesh reaches with the errors on the worst teeth found.
    ReachedLower,
    ReachedUpper,
    /// Standard uncertainty of a result.
    Standard(UncertainOutput),
    /// Expanded uncertainty of a result.
    Expanded(UncertainOutput),
    /// Whether the linear uncertainties of the part describe it.
    Linear,
    /// The probability that the limit with that index is met.
    Conformance(usize),
    /// A statistic of the simulated distribution of a result.
    Simulated(UncertainOutput, Simulated),
    /// Whether the simulation confirms the linear uncertainties of the combination.
    Validated,
    Verdict,
    /// Why a row has no results.
    Reason,
    /// What the parts are judged without.
    Without,
    /// The input's column of that name, as it is.
    Copied(String),
}

/// A result that has an uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum UncertainOutput {
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

    pub(super) fn name(self, of: &str) -> String {
        let statistic = Self::ALL.into_iter().find(|(_, statistic)| *statistic == self).map_or("", |(name, _)| name);
        format!("{of}_monte_carlo_{statistic}_mm")
    }
}

/// An output that was asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum RequestedOutput {
    Id,
    Own(DeviationKind),
    Standard(DeviationKind),
    Expanded(DeviationKind),
    Simulated(DeviationKind, Simulated),
    Conformance(LimitTarget),
    Result(Output),
    Copied(String),
}

impl RequestedOutput {
    /// The outputs that were asked for, or all of them.
    pub(super) fn all(
        table: &Table,
        request: &Request,
        present: &[DeviationKind],
        limits: &Limits,
        is_uncertain: bool,
    ) -> Result<Vec<Self>, Diagnostic> {
        let own = present.iter().map(|kind| (column_name(*kind), RequestedOutput::Own(*kind)));
        let results = [
            ("range_lower_mm", Output::RangeLower),
            ("range_upper_mm", Output::RangeUpper),
            ("rss_lower_mm", Output::RssLower),
            ("rss_upper_mm", Output::RssUpper),
        ];
        let results = results.map(|(name, output)| (name.to_owned(), RequestedOutput::Result(output)));
        let mut all: Vec<_> =
            std::iter::once(("part_id".to_owned(), RequestedOutput::Id)).chain(own).chain(results).collect();
        if request.mesh {
            let reached = [("reached_lower_mm", Output::ReachedLower), ("reached_upper_mm", Output::ReachedUpper)];
            all.extend(reached.map(|(name, output)| (name.to_owned(), RequestedOutput::Result(output))));
        }
        if is_uncertain {
            for kind in present {
                all.push((standard_name(&own_name(*kind)), RequestedOutput::Standard(*kind)));
                all.push((expanded_name(&own_name(*kind)), RequestedOutput::Expanded(*kind)));
            }
            for of in ENDS {
                let name = end_name(request.stack, of);
                all.push((standard_name(name), RequestedOutput::Result(Output::Standard(of))));
                all.push((expanded_name(name), RequestedOutput::Result(Output::Expanded(of))));
            }
            all.push(("linear".to_owned(), RequestedOutput::Result(Output::Linear)));
            if request.monte_carlo.is_some() {
                for (_, statistic) in Simulated::ALL {
                    for kind in present {
                        all.push((statistic.name(&own_name(*kind)), RequestedOutput::Simulated(*kind, statistic)));
                    }
                    for of in ENDS {
                        let name = statistic.name(end_name(request.stack, of));
                        all.push((name, RequestedOutput::Result(Output::Simulated(of, statistic))));
                    }
                }
                all.push(("linear_validated".to_owned(), RequestedOutput::Result(Output::Validated)));
            }
            let judged = limits.iter().map(|(on, _)| *on).filter(|on| match on {
                LimitTarget::CenterDistance => true,
                LimitTarget::Error(kind) => present.contains(kind),
            });
            all.extend(judged.map(|on| (conformance_name(on), RequestedOutput::Conformance(on))));
        }
        all.push(("verdict".to_owned(), RequestedOutput::Result(Output::Verdict)));
        let Some(names) = &request.columns else {
            return Ok(all.into_iter().map(|(_, asked)| asked).collect());
        };
        let mut asked = Vec::new();
        for name in names {
            if let Some((_, output)) = all.iter().find(|(known, _)| known == name) {
                asked.push(output.clone());
            } else if table.titles.contains(name) {
                asked.push(RequestedOutput::Copied(name.clone()));
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
                        table.name,
                        table.titles_in_words()
                    ),
                ));
            }
        }
        Ok(asked)
    }

    /// The output itself; `None` if what it is of is not there.
    pub(super) fn output(self, index: &dyn Fn(DeviationKind) -> Option<usize>, judged: &Limits) -> Option<Output> {
        Some(match self {
            Self::Id => Output::Id,
            Self::Own(kind) => Output::Error(index(kind)?),
            Self::Standard(kind) => Output::Standard(UncertainOutput::Source(index(kind)?)),
            Self::Expanded(kind) => Output::Expanded(UncertainOutput::Source(index(kind)?)),
            Self::Simulated(kind, statistic) => Output::Simulated(UncertainOutput::Source(index(kind)?), statistic),
            Self::Conformance(target) => Output::Conformance(judged.iter().position(|(on, _)| *on == target)?),
            Self::Result(output) => output,
            Self::Copied(name) => Output::Copied(name),
        })
    }

    /// The error that it is about, if it is about one.
    pub(super) fn error(&self) -> Option<DeviationKind> {
        match self {
            Self::Own(kind)
            | Self::Standard(kind)
            | Self::Expanded(kind)
            | Self::Simulated(kind, _)
            | Self::Conformance(LimitTarget::Error(kind)) => Some(*kind),
            Self::Conformance(_) | Self::Id | Self::Result(_) | Self::Copied(_) => None,
        }
    }
}

/// The name of the column with an error's ΔCD.
pub(super) fn column_name(kind: DeviationKind) -> String {
    format!("{}_mm", own_name(kind))
}

pub(super) fn own_name(kind: DeviationKind) -> String {
    format!("delta_cd_{}", kind.key())
}

/// The ends of a combination.
const ENDS: [UncertainOutput; 2] = [UncertainOutput::Lower, UncertainOutput::Upper];

pub(super) fn end_name(stack: Stack, of: UncertainOutput) -> &'static str {
    match (stack, of) {
        (Stack::Range, UncertainOutput::Lower) => "range_lower",
        (Stack::Range, _) => "range_upper",
        (Stack::Rss, UncertainOutput::Lower) => "rss_lower",
        (Stack::Rss, _) => "rss_upper",
    }
}

pub(super) fn standard_name(of: &str) -> String {
    format!("{of}_standard_uncertainty_mm")
}

pub(super) fn expanded_name(of: &str) -> String {
    format!("{of}_expanded_uncertainty_mm")
}

/// The name of the column with the probability that a limit is met.
pub(super) fn conformance_name(on: LimitTarget) -> String {
    match on {
        LimitTarget::CenterDistance => "conformance_probability".to_owned(),
        LimitTarget::Error(kind) => format!("{}_conformance_probability", own_name(kind)),
    }
}
