//! The arguments for verdicts under uncertainty, shared by the subcommands that judge parts.

use std::borrow::Cow;
use std::ffi::{OsStr, OsString};

use super::bar::SharedBar;
use super::output::{Failure, Output};
use crate::batch::{Part, Plan};
use crate::chance::{self, DEFAULT_DIGITS, DEFAULT_SEED, MonteCarloError, Settings};
use crate::deviation::DeviationValue;
use crate::deviation::plausible::{self, WrittenIn};
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluation::{Evaluation, Unjudged, evaluate};
use crate::formula::{Model, PartDeviation};
use crate::judge::bound::{Basis, Note};
use crate::judge::rule::RuleError;
use crate::judge::{LimitTarget, Rule, Stack};
use crate::quantity::parse_f64;
use crate::report::UncertaintyPart;
use crate::spec::{SolvedTeeth, Spec, keys};
use crate::uncertainty::{self, UncertainPart, UncertaintyError};

/// How the errors of a part are judged, and how a verdict is reached under uncertainty.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct JudgeArgs {
    /// How errors add up.
    #[arg(long, value_enum, default_value_t)]
    pub(super) stack: Stack,
    /// Formulas exact for rigid teeth, or as the paper prints them.
    #[arg(long, value_enum, default_value_t)]
    pub(super) model: Model,
    /// Decision rule: simple, iso14253 or guard=VALUE; else the spec's.
    #[arg(long, value_name = "RULE", value_parser = rule)]
    rule: Option<Rule>,
    /// Uncertainty of ΔCD by simulation (JCGM 101) with N draws; without N as many as --digits needs, at most 1600000, of a table 100000 a part.
    #[arg(long, value_name = "N", num_args = 0..=1)]
    #[expect(clippy::option_option, reason = "not given, given without a number, given with one")]
    monte_carlo: Option<Option<OsString>>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "SEED", default_value_t = DEFAULT_SEED, requires = "monte_carlo")]
    seed: u64,
    /// Digits of the uncertainty that the simulation shall reach.
    #[arg(long, value_name = "DIGITS", default_value_t = DEFAULT_DIGITS, requires = "monte_carlo")]
    digits: u32,
}

/// Reads a decision rule. A guard band without a unit is in mm, and is refused where µm are more likely.
pub(super) fn rule(text: &str) -> Result<Rule, String> {
    let rule: Rule = text.parse().map_err(|error: RuleError| error.to_string())?;
    let is_bare = |(_, number): (&str, &str)| parse_f64(number.trim()).is_ok();
    let Rule::Guard(band) = &rule else { return Ok(rule) };
    let doubt = plausible::deviation(DeviationValue::Length(*band), None);
    match doubt.filter(|_| text.split_once('=').is_some_and(is_bare)) {
        Some(doubt) => {
            let doubt = doubt.of_no_size().of_no_part();
            let remedy = doubt.remedy(WrittenIn::Argument);
            Err(format!("{doubt}; {remedy}; if not, write the unit: guard={}mm", band.mm()))
        }
        None => Ok(rule),
    }
}

/// A number of draws as people write it: `1000000`, `1_000_000`, `1e6`.
fn draws(text: &OsStr) -> Option<u64> {
    let plain = text.to_str()?.replace('_', "");
    if let Ok(number) = plain.parse() {
        return Some(number);
    }
    let (mantissa, exponent) = plain.split_once(['e', 'E'])?;
    let (mantissa, exponent): (u64, u32) = (mantissa.parse().ok()?, exponent.trim_start_matches('+').parse().ok()?);
    mantissa.checked_mul(10_u64.checked_pow(exponent)?)
}

impl JudgeArgs {
    /// The defaults: the worst case by the spec's rule, without a simulation.
    pub(super) fn of_spec() -> Self {
        let (stack, model) = (Stack::Range, Model::Exact);
        Self { stack, model, rule: None, monte_carlo: None, seed: DEFAULT_SEED, digits: DEFAULT_DIGITS }
    }

    /// Corrects a word taken for the number of draws: in `--monte-carlo rack.toml` it is the spec.
    pub(super) fn spec_behind_monte_carlo(&mut self) -> Option<OsString> {
        let given = self.monte_carlo.as_mut()?;
        if given.as_deref().is_some_and(|text| draws(text).is_none()) { given.take() } else { None }
    }

    /// The rule: that of the command line, or of the spec, or simple.
    pub(super) fn rule(&self, spec: &Spec) -> Rule {
        let of_spec = || spec.get(keys::DECISION_RULE);
        self.rule.clone().or_else(of_spec).unwrap_or_default()
    }

    /// How to simulate; `None` for no simulation.
    pub(super) fn settings(&self) -> Result<Option<Settings>, Failure> {
        let Some(given) = &self.monte_carlo else { return Ok(None) };
        let draws = match given {
            None => None,
            Some(text) => Some(draws(text).ok_or_else(|| {
                Diagnostic::usage(format!("--monte-carlo {}: that is no number of draws", text.display()))
                    .help("write it as 1000000 or 1e6, or leave it out for as many as are needed")
            })?),
        };
        Ok(Some(Settings { seed: self.seed, draws, digits: self.digits, ..Settings::default() }))
    }

    /// Evaluates a part's errors and decides by the rule, with their uncertainties (`None` without any). Where nothing is left to
    /// place the exact mesh judges; a pass by the bound stands, because the bound is exact where the mesh is rounded. `bar` shows random
    /// draws.
    pub(super) fn judged(
        &self,
        spec: &Spec,
        errors: &[PartDeviation],
        basis: &Basis,
        bar: &SharedBar,
    ) -> Result<(Evaluation, Option<UncertaintyPart>), Failure> {
        let Some(solved) = solved(spec) else { return self.judged_by(None, spec, errors, basis, bar) };
        let by_mesh = self.judged_by(Some(solved), spec, errors, basis, bar)?;
        if by_mesh.0.passes() {
            return Ok(by_mesh);
        }
        let by_bound = self.judged_by(None, spec, errors, basis, bar)?;
        Ok(if by_bound.0.passes() { by_bound } else { by_mesh })
    }

    /// The errors of a listed part of a batch, with the spec that they are in.
    pub(super) fn of_part(
        &self,
        plan: &Plan,
        part: &Part,
        output: &Output,
    ) -> Result<(Spec, Evaluation, Option<UncertaintyPart>), Failure> {
        let (spec, bar) = (plan.spec_of(part), SharedBar::new(output));
        let (mut evaluation, uncertainty) = self.judged(&spec, &spec.part_deviations()?, &spec.basis()?, &bar)?;
        let lacking = &plan.lacking;
        let why = if lacking.is_empty() {
            Unjudged::without_uncertainty(&plan.taken_as_exact())
        } else {
            Unjudged::lacking(lacking)
        };
        plan.unjudged.iter().for_each(|on| evaluation.leave_open(*on, why));
        evaluation.reject_if(part.is_rejected);
        Ok((spec, evaluation, uncertainty))
    }

    fn judged_by(
        &self,
        solved: Option<Result<SolvedTeeth, String>>,
        spec: &Spec,
        errors: &[PartDeviation],
        basis: &Basis,
        bar: &SharedBar,
    ) -> Result<(Evaluation, Option<UncertaintyPart>), Failure> {
        let (mut unsolved, mut basis, mut spec) = (None, Cow::Borrowed(basis), Cow::Borrowed(spec));
        match solved {
            Some(Ok(SolvedTeeth { teeth, sensitivities })) => {
                basis.to_mut().all_placed = Some(teeth.range);
                spec.to_mut().teeth_sensitivities = sensitivities;
            }
            Some(Err(why)) => unsolved = Some(why),
            None => {}
        }
        let (basis, spec) = (&*basis, &*spec);
        let mut evaluation = evaluate(errors, &spec.limits(), self.model, self.stack, basis)
            .map_err(|failure| spec.explain_failure(&failure))?;
        let rule = self.rule(spec);
        evaluation.rule = rule.clone();
        evaluation.unsolved = unsolved;
        let kinds: Vec<_> = errors.iter().map(PartDeviation::kind).collect();
        evaluation.unstated = spec.unstated(&kinds, spec.known_teeth.is_some(), &rule);
        let open = evaluation.judged.err();
        let known = if open.is_some() { None } else { self.known((errors, basis), spec, &mut evaluation, bar)? };
        if rule.needs_uncertainty() && known.is_none() {
            // an open range has no uncertainty, without which some rules decide on no error either
            let why = open.map_or(Unjudged::without_uncertainty(&[]), Unjudged::NoBound);
            spec.limits().into_iter().for_each(|(on, _)| evaluation.leave_open(on, why));
        } else if known.is_some() || rule != Rule::Simple {
            let simulated = known.as_ref().and_then(|known| known.simulation.as_ref());
            let inside = simulated.map(|simulation| simulation.outcome.inside.as_slice());
            evaluation
                .decide_by(&rule, known.as_ref().map(|known| &known.propagation), inside)
                .map_err(Diagnostic::with_code(Code::NoResult))?;
        }
        Ok((evaluation, known))
    }

    /// Leaves the verdicts on a spec's errors open if the rule needs an uncertainty that a value lacks, with a note of the value.
    pub(super) fn leave_open_without_uncertainty(&self, spec: &Spec, evaluation: &mut Evaluation) -> Option<String> {
        let rule = self.rule(spec);
        let exact = spec.taken_as_exact();
        let note = spec.note_of_exact(&exact, Some(&rule)).filter(|_| rule.needs_uncertainty())?;
        let why = Unjudged::without_uncertainty(&exact);
        spec.limits().into_iter().for_each(|(on, _)| evaluation.leave_open(on, why));
        Some(note)
    }

    /// Propagates the uncertainties of the spec to what is judged; `None` if it gives none and none is needed, or if a bound is open within them,
    /// which is noted.
    fn known(
        &self,
        (errors, basis): (&[PartDeviation], &Basis),
        spec: &Spec,
        evaluation: &mut Evaluation,
        bar: &SharedBar,
    ) -> Result<Option<UncertaintyPart>, Failure> {
        let (settings, uncertainties) = (self.settings()?, spec.uncertainties()?);
        if uncertainties.is_empty() {
            if settings.is_some() {
                return Err(unsimulated(&MonteCarloError::NothingUncertain).into());
            }
            let rule = self.rule(spec);
            if rule.needs_uncertainty() {
                let message = format!("the rule {rule} needs an uncertainty above 0, and the spec gives none");
                return Err(Diagnostic::error(Code::BadRule, message).help(EXAMPLE).into());
            }
            return Ok(None);
        }
        let (over_pin, teeth) = (spec.over_pin(), &spec.teeth_sensitivities);
        let (model, stack) = (evaluation.model, evaluation.stack);
        let part = UncertainPart { errors, over_pin: over_pin.as_ref(), model, stack, basis, teeth };
        let propagation = match uncertainty::propagate(&part, &uncertainties) {
            Err(UncertaintyError::NoBound(source)) => {
                evaluation.notes.push(Note::OpenWithin(source));
                return Ok(None);
            }
            propagation => propagation.map_err(Diagnostic::with_code(Code::NoResult))?,
        };
        let watch = |share| bar.show(share, "random draws");
        let simulated =
            |settings| chance::simulate_part_watched(&part, &uncertainties, &spec.limits(), &settings, &watch);
        let simulation = settings.map(simulated).transpose().map_err(|error| unsimulated(&error))?;
        Ok(Some(UncertaintyPart {
            propagation,
            simulation,
            taken_as_exact: spec.taken_as_exact(),
            through_mesh: !spec.teeth_sensitivities.is_empty(),
        }))
    }
}

const EXAMPLE: &str = "give the errors one, such as `rack_pitch = { value = \"12 um\", u = \"0.8 um\" }`; see `rackmesh explain bad-uncertainty`";

fn unsimulated(error: &MonteCarloError) -> Diagnostic {
    let diagnostic = Diagnostic::error(Code::NoMonteCarlo, error.to_string());
    if *error == MonteCarloError::NothingUncertain { diagnostic.help(EXAMPLE) } else { diagnostic }
}

/// The range of the exact mesh, if the mesh judges.
fn solved(spec: &Spec) -> Option<Result<SolvedTeeth, String>> {
    spec.limit_on(LimitTarget::CenterDistance)?;
    spec.solved()
}

#[cfg(test)]
mod tests {
    use super::draws;

    #[test]
    fn numbers_of_draws_as_people_write_them() {
        for (text, number) in
            [("1000", Some(1000)), ("1_000_000", Some(1_000_000)), ("1e6", Some(1_000_000)), ("2E+3", Some(2000))]
        {
            assert_eq!(draws(text.as_ref()), number, "{text}");
        }
        for text in ["rack.toml", "1e99", "-5", "", "1.5e3"] {
            assert_eq!(draws(text.as_ref()), None, "{text}");
        }
    }
}
