//! The uncertainty of a result, as a part of another report: tables, JSON and rows of `eval`.

use serde_json::{Value, json};

use super::number::{millimetres, percent, tidy};
use super::{Block, Column, Table};
use crate::chance::{BLOCK, Outcome, PartSimulation, Simulation, Validation, validate};
use crate::deviation::DeviationKind;
use crate::evaluation::LimitCheck;
use crate::judge::rule::{Conformance, Decision, ISO_14253_FACTOR, ISO_14253_PROBABILITY};
use crate::judge::{Rule, Verdict};
use crate::uncertainty::{FOLD, Linear, Propagation};

/// The uncertainty of an evaluation's results.
#[derive(Debug)]
pub struct UncertaintyPart {
    /// The linear result.
    pub propagation: Propagation,
    /// The simulated result, where it was asked for.
    pub simulation: Option<PartSimulation>,
    /// Measured errors without an uncertainty.
    pub taken_as_exact: Vec<DeviationKind>,
    /// Whether it includes teeth that are known one by one.
    pub through_mesh: bool,
}

/// One result of a part, with its uncertainty.
struct UncertainResult<'a> {
    /// Its name for programs.
    key: &'static str,
    /// Its name for people.
    name: String,
    linear: &'a Linear,
    simulated: Option<&'a Simulation>,
}

/// A length of an uncertainty in µm for people: two decimals, more for small ones.
pub(super) fn micrometres(mm: f64) -> String {
    let um = 1000.0 * mm;
    if um == 0.0 {
        "exact".to_owned()
    } else if um.abs() < 0.001 || um.abs() >= 1e6 {
        format!("{um:.1e}")
    } else if um.abs() < 0.095 {
        format!("{um:.4}")
    } else {
        format!("{um:.2}")
    }
}

/// A probability for people; only 0 and 1 themselves are printed as 0 and 100 %.
fn probability(p: f64) -> String {
    let text = format!("{:.2} %", 100.0 * p);
    match text.as_str() {
        "0.00 %" if p > 0.0 => "< 0.01 %".to_owned(),
        "100.00 %" if p < 1.0 => "> 99.99 %".to_owned(),
        _ => text,
    }
}

impl UncertaintyPart {
    fn end_names(&self) -> [String; 2] {
        let stack = self.propagation.stack;
        [format!("{stack}, lower end"), format!("{stack}, upper end")]
    }

    /// Every result: the errors, then both ends.
    fn results(&self) -> Vec<UncertainResult<'_>> {
        let [lower, upper] = self.end_names();
        let simulation = self.simulation.as_ref();
        let result = |key, name, linear, simulated| UncertainResult { key, name, linear, simulated };
        let errors = self.propagation.errors.iter().map(|(kind, linear)| {
            let simulated = simulation.and_then(|s| s.errors().find(|(other, _)| other == kind));
            result(kind.key(), kind.to_string(), linear, simulated.map(|(_, simulated)| simulated))
        });
        let ends = [
            result("lower", lower, &self.propagation.lower, simulation.map(PartSimulation::lower)),
            result("upper", upper, &self.propagation.upper, simulation.map(PartSimulation::upper)),
        ];
        errors.chain(ends).collect()
    }

    fn digits(&self) -> u32 {
        self.simulation.as_ref().map_or(2, |simulation| simulation.outcome.digits)
    }

    pub(super) fn blocks(&self) -> Vec<Block> {
        let mut blocks = vec![self.result_table()];
        // of one contribution there is nothing to share out
        blocks.extend((self.propagation.upper.contributions.len() > 1).then(|| self.budget_table()));
        blocks.extend(self.simulation.as_ref().map(|simulation| self.simulation_table(&simulation.outcome)));
        blocks.extend(self.notes().into_iter().map(Block::Remark));
        blocks
    }

    /// The results with an uncertainty, and both ends; a remark names what is taken as exact.
    fn result_table(&self) -> Block {
        let is_shown = |of: &UncertainResult<'_>| {
            matches!(of.key, "lower" | "upper") || of.linear.dof.is_none() || of.linear.standard_mm > 0.0
        };
        let results: Vec<_> = self.results().into_iter().filter(is_shown).collect();
        let with_dof = results.iter().any(|result| result.linear.dof.is_none_or(|dof| dof < PRACTICALLY_INFINITE));
        let known = |linear: &Linear| linear.dof.map(|_| linear.standard_mm);
        let factor = |linear: &Linear| linear.coverage_factor.filter(|_| linear.standard_mm > 0.0);
        Table::of(results)
            .text("uncertainty of", |of| of.name.clone())
            .number("ΔCD\n[mm]", |of| millimetres(of.linear.value_mm))
            .number("u\n[µm]", |of| known(of.linear).map_or_else(|| "not known".to_owned(), micrometres))
            .number("k", |of| factor(of.linear).map(|k| format!("{k:.2}")))
            .number("U = k u\n[µm]", |of| factor(of.linear).and(of.linear.expanded_mm()).map(micrometres))
            .column_if(with_dof, Column::number("ν_eff"), |of| match of.linear.dof {
                Some(dof) if dof < PRACTICALLY_INFINITE => format!("{dof:.1}"),
                Some(_) => "∞".to_owned(),
                None => "not known".to_owned(),
            })
            .text("linear", |of| if of.linear.folded.is_empty() { "yes" } else { "no: near 0" })
            .block()
    }

    fn budget_table(&self) -> Block {
        let [_, upper] = self.end_names();
        let Linear { contributions, standard_mm, .. } = &self.propagation.upper;
        let shares: f64 = contributions.iter().filter_map(|c| c.share).sum();
        // the rest beyond independent contributions has no source
        let is_correlated = *standard_mm > 0.0 && (shares - 1.0).abs() > 1e-9;
        let rows = contributions.iter().map(Some).chain(is_correlated.then_some(None));
        Table::of(rows)
            .text(format!("budget of {upper}"), |c| {
                c.map_or_else(|| "correlations".to_owned(), |c| c.source.to_string())
            })
            .number("u(x)", |c| match c {
                Some(c) if c.source.is_angle() => format!("{:.3}′", 60.0 * c.standard),
                Some(c) => format!("{} µm", micrometres(c.standard)),
                None => String::new(),
            })
            .number("∂ΔCD/∂x", |c| match c {
                Some(c) if c.source.is_angle() => format!("{:+.4} µm/′", 1000.0 * c.sensitivity / 60.0),
                Some(c) => format!("{:+.4} µm/µm", c.sensitivity),
                None => String::new(),
            })
            .number("contribution\n[µm]", |c| c.map(|c| micrometres(c.contribution_mm.abs())).unwrap_or_default())
            .number("share of\nvariance u²", |c| c.map_or(Some(1.0 - shares), |c| c.share).map(percent))
            .block()
    }

    fn simulation_table(&self, outcome: &Outcome) -> Block {
        let interval = |(low, high): (f64, f64)| format!("{} … {}", millimetres(low), millimetres(high));
        let simulated = self.results().into_iter().filter_map(|UncertainResult { name, linear, simulated, .. }| {
            let simulated = simulated.filter(|simulated| simulated.standard != 0.0)?;
            Some((name, simulated, validate(linear, simulated, self.digits()).by(outcome)))
        });
        Table::of(simulated)
            .text("Monte Carlo", |(name, ..)| name.clone())
            .number("mean\n[mm]", |(_, simulated, _)| millimetres(simulated.mean))
            .number("u\n[µm]", |(_, simulated, _)| micrometres(simulated.standard))
            .number("95 %, symmetric\n[mm]", |(_, simulated, _)| interval(simulated.symmetric))
            .number("95 %, shortest\n[mm]", |(_, simulated, _)| interval(simulated.shortest))
            .text("linear result", |(.., validated)| match validated {
                Some(true) => "validated",
                Some(false) => "not validated",
                None => "too few draws to say",
            })
            .block()
    }

    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let upper = &self.propagation.upper;
        if upper.dof.is_none() || self.propagation.lower.dof.is_none() {
            notes.push(
                "correlated contributions cancel: coefficients are not known to the digits that u would then have, and \
                 verdicts that need it are open"
                    .to_owned(),
            );
        }
        if !upper.folded.is_empty() {
            let names: Vec<_> = upper.folded.iter().map(ToString::to_string).collect();
            let remedy =
                if self.simulation.is_some() { "the Monte Carlo result holds" } else { "ask for --monte-carlo" };
            notes.push(format!(
                "{}: nearer to 0 than {FOLD:.0} u, where a magnitude is not linear; u is an upper bound there and the mean lies above the value: {remedy}",
                names.join(", ")
            ));
        }
        if !self.taken_as_exact.is_empty() {
            let names: Vec<_> = self.taken_as_exact.iter().map(|kind| kind.name()).collect();
            notes.push(format!("taken as exact, because no uncertainty is given: {}", names.join(", ")));
        }
        let spreads = &self.propagation.spreads;
        let rivals = spreads.lower.rivals.max(spreads.upper.rivals);
        if rivals > 0 {
            notes.push(format!(
                "strokes that may hold the lowest or highest ΔCD within their uncertainties, beside those that do: {rivals}; \
                 u is the largest of them, and the probability of conformance counts each"
            ));
        }
        if self.through_mesh {
            notes.push(
                "what is uncertain about the teeth that are known one by one counts by the derivatives of the exact mesh \
                 at its lowest and highest ΔCD, each measured value by itself"
                    .to_owned(),
            );
        }
        if let Some(simulation) = &self.simulation {
            let outcome = &simulation.outcome;
            let how = match outcome.reached() {
                None => format!("as many as asked for, in blocks of {BLOCK}"),
                Some(true) => format!("adaptive, {} digits of u reached", outcome.digits),
                Some(false) => format!("adaptive, ended at the most; {}", not_reached(outcome)),
            };
            let errors = upper_error(simulation);
            notes.push(format!(
                "Monte Carlo (JCGM 101): {} draws ({how}), seed {}; standard error of the interval's ends {} µm",
                outcome.draws,
                outcome.seed,
                micrometres(errors)
            ));
        }
        notes
    }

    /// The decision on each limit, for results with an uncertainty or without.
    pub(super) fn decision_blocks(rule: &Rule, checks: &[LimitCheck], is_uncertain: bool) -> Vec<Block> {
        let decided: Vec<_> = checks.iter().filter_map(|check| Some((check, check.decision.as_ref()?))).collect();
        if decided.is_empty() {
            return Vec::new();
        }
        let risk = |decision: &Decision, of: fn(&Conformance) -> f64, bound: &str| match &decision.conformance {
            Some(known) => format!("{}{}", if known.is_least { bound } else { "" }, probability(of(known))),
            None => "not known".to_owned(),
        };
        // of a part that is accepted the risk of rejecting it says nothing, nor the other way round
        let may_be = |verdict: Verdict| {
            decided.iter().any(|(_, decision)| [verdict, Verdict::Indeterminate].contains(&decision.verdict))
        };
        let table = Table::of(&decided)
            .text("decision on", |(check, _)| check.on.to_string())
            .number("guard band\n[µm]", |(_, decision)| guard_text(decision))
            .column_if(is_uncertain, Column::number("conforms"), |(_, decision)| {
                risk(decision, |c| c.probability, "≥ ")
            })
            .column_if(
                is_uncertain && may_be(Verdict::Pass),
                Column::number("consumer's risk\nif accepted"),
                |(_, of)| (of.verdict != Verdict::Fail).then(|| risk(of, Conformance::consumer_risk, "≤ ")),
            )
            .column_if(
                is_uncertain && may_be(Verdict::Fail),
                Column::number("producer's risk\nif rejected"),
                |(_, of)| (of.verdict != Verdict::Pass).then(|| risk(of, Conformance::producer_risk, "≥ ")),
            )
            .text(format!("by {}", rule.in_words()), |(_, decision)| decision.verdict.name());
        let mut blocks = vec![table.block()];
        blocks.extend(rule_notes(rule, &decided).into_iter().map(Block::Remark));
        if is_uncertain && decided.iter().any(|(_, decision)| decision.conformance.is_none()) {
            blocks.push(Block::Remark(NOT_KNOWN.to_owned()));
        }
        blocks
    }

    /// Each result, for programs.
    pub(super) fn facts(&self) -> impl Iterator<Item = Value> + '_ {
        self.results().into_iter().map(|UncertainResult { key, linear, simulated, .. }| {
            let contributions: Vec<_> = linear
                .contributions
                .iter()
                .map(|c| {
                    let angle = c.source.is_angle();
                    json!({
                        "input": c.source.key(),
                        "standard_uncertainty_mm": (!angle).then_some(c.standard),
                        "standard_uncertainty_deg": angle.then_some(c.standard),
                        // JSON has no infinity: it is null
                        "degrees_of_freedom": c.dof,
                        "sensitivity": c.sensitivity,
                        "sensitivity_unit": if angle { "mm/deg" } else { "mm/mm" },
                        "contribution_mm": tidy(c.contribution_mm),
                        "share": c.share,
                    })
                })
                .collect();
            json!({
                "of": key,
                "delta_cd_mm": tidy(linear.value_mm),
                "standard_uncertainty_mm": linear.dof.map(|_| tidy(linear.standard_mm)),
                "coverage_factor": linear.coverage_factor,
                "expanded_uncertainty_mm": linear.expanded_mm().map(tidy),
                "effective_degrees_of_freedom": linear.dof,
                "linear": linear.folded.is_empty(),
                "folded": linear.folded.iter().map(|kind| kind.key()).collect::<Vec<_>>(),
                "contributions": contributions,
                "monte_carlo": simulated.map(|simulated| {
                    simulation_json(simulated, &validate(linear, simulated, self.digits()))
                }),
            })
        })
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "stack": self.propagation.stack.name(),
            "coverage": "95.45 %",
            "results": self.facts().collect::<Vec<_>>(),
            "monte_carlo": self.simulation.as_ref().map(|simulation| {
                let outcome = &simulation.outcome;
                json!({
                    "seed": outcome.seed,
                    "draws": outcome.draws,
                    "digits": outcome.digits,
                    "digits_reached": outcome.reached(),
                })
            }),
            "taken_as_exact": self.taken_as_exact.iter().map(|kind| kind.key()).collect::<Vec<_>>(),
            "notes": self.notes(),
        })
    }
}

/// Why a probability of conformance is not known, and the remedy.
const NOT_KNOWN: &str = "not known: values near 0, few degrees of freedom or correlations leave no bound on the probability of \
                         conformance that says anything: --monte-carlo counts it, where inputs that go together are normal";

/// The columns of CSV that a result's uncertainty has.
pub(super) const COLUMNS: &str = "standard_uncertainty_mm expanded_uncertainty_mm coverage_factor \
                                  monte_carlo_mean_mm=monte_carlo/mean_mm \
                                  monte_carlo_standard_mm=monte_carlo/standard_uncertainty_mm \
                                  monte_carlo_lower_mm=monte_carlo/symmetric_95_mm/lower \
                                  monte_carlo_upper_mm=monte_carlo/symmetric_95_mm/upper \
                                  linear_validated=monte_carlo/linear_validated";

/// Degrees of freedom that are shown as ∞: Student's factor differs from the normal one by less than 3e-6.
const PRACTICALLY_INFINITE: f64 = 1e6;

/// What an adaptive simulation at its most draws lacks, and what to do.
fn not_reached(outcome: &Outcome) -> String {
    let (digits, stable) = (outcome.digits, outcome.stable_digits().unwrap_or(0));
    let lacks = if stable == digits {
        format!("u is stable to {digits} digits, but not to the fifth of their tolerance that a validation needs")
    } else {
        format!("u is stable to {stable} of {digits} digits")
    };
    let fewer = outcome.reachable_digits().filter(|digits| *digits > 0).map(|digits| format!("--digits {digits}"));
    let more = outcome.needed_draws().map(|draws| format!("--monte-carlo {draws}"));
    let remedies: Vec<_> = fewer.into_iter().chain(more).collect();
    if remedies.is_empty() { lacks } else { format!("{lacks}: ask for {}", remedies.join(" or ")) }
}

fn upper_error(simulation: &PartSimulation) -> f64 {
    let (low, high) = simulation.upper().end_errors;
    low.max(high)
}

fn simulation_json(simulated: &Simulation, validation: &Validation) -> Value {
    json!({
        "mean_mm": tidy(simulated.mean),
        "standard_uncertainty_mm": tidy(simulated.standard),
        "symmetric_95_mm": { "lower": tidy(simulated.symmetric.0), "upper": tidy(simulated.symmetric.1) },
        "shortest_95_mm": { "lower": tidy(simulated.shortest.0), "upper": tidy(simulated.shortest.1) },
        "end_standard_error_mm": { "lower": simulated.end_errors.0, "upper": simulated.end_errors.1 },
        "linear_half_width_mm": validation.linear_half_width,
        "distance_lower_mm": validation.distances.map(|(lower, _)| lower),
        "distance_upper_mm": validation.distances.map(|(_, upper)| upper),
        "tolerance_mm": validation.tolerance,
        "linear_validated": validation.validated,
    })
}

/// A decision, for programs.
pub(super) fn decision_fact(&Decision { guard, conformance, .. }: &Decision) -> Value {
    json!({
        "guard_lower_mm": guard.map(|(lower, _)| lower),
        "guard_upper_mm": guard.map(|(_, upper)| upper),
        "conformance_probability": conformance.map(|c| c.probability),
        "consumer_risk_if_accepted": conformance.map(|c| c.consumer_risk()),
        "producer_risk_if_rejected": conformance.map(|c| c.producer_risk()),
        "method": conformance.map(|c| if c.simulated {
            "monte carlo"
        } else if c.is_least {
            "linear, at least"
        } else {
            "linear, normal"
        }),
    })
}

fn guard_text(decision: &Decision) -> String {
    match decision.guard.map(|(lower, upper)| (lower.mm(), upper.mm())) {
        None => "-".to_owned(),
        Some((lower, upper)) if lower == upper => micrometres(upper),
        Some((lower, upper)) => format!("{} / {}", micrometres(lower), micrometres(upper)),
    }
}

fn rule_notes(rule: &Rule, decided: &[(&LimitCheck, &Decision)]) -> Vec<String> {
    let mut notes = Vec::new();
    let simulated = decided.iter().any(|(_, decision)| decision.conformance.is_some_and(|c| c.simulated));
    notes.extend(match rule {
        Rule::Simple => None,
        Rule::Iso14253 if simulated => Some(format!(
            "ISO 14253-1: pass if the simulated probability of conformance is at least {:.0} %, fail if that of non-conformance is, else indeterminate",
            100.0 * ISO_14253_PROBABILITY
        )),
        Rule::Iso14253 => Some(format!(
            "ISO 14253-1: guard band {ISO_14253_FACTOR} u_c (conformance probability 95 %, one-sided); inside the limits by it pass, outside by it fail, between or with less than 95 % indeterminate"
        )),
        Rule::Guard(_) => Some("inside the limits by the guard band pass, outside by it fail, between indeterminate".to_owned()),
    });
    if decided.iter().any(|(_, decision)| decision.conformance.is_some()) {
        let is_least = decided.iter().any(|(_, decision)| decision.conformance.is_some_and(|c| c.is_least));
        let how = match (simulated, is_least) {
            (true, _) => "counted in the simulation",
            (_, true) => {
                "linear; at least, where values are near 0 or u has few degrees of freedom: --monte-carlo counts it"
            }
            _ => "linear, normal distribution",
        };
        notes.push(format!(
            "conforms: probability that the true value lies inside the limits, given this measurement ({how}); consumer's risk: that the part, accepted, does not conform; producer's risk: that it, rejected, does (JCGM 106)"
        ));
    }
    let no_room = decided.iter().any(|(check, decision)| {
        let (Some(lower), Some(upper), Some(guard)) = (check.limit.lower, check.limit.upper, decision.guard) else {
            return false;
        };
        guard.0.mm() + guard.1.mm() > (upper - lower).mm()
    });
    if no_room {
        notes.push("the guard bands leave no room between the limits: nothing can pass".to_owned());
    }
    notes
}

/// The rule at the end of a verdict's method; empty for the simple one.
pub(super) fn rule_words(rule: &Rule) -> String {
    if *rule == Rule::Simple { String::new() } else { format!(", rule {}", rule.in_words()) }
}
