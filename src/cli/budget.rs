//! `rackmesh budget`: from a ΔCD tolerance to a tolerance for each error.

use std::path::PathBuf;

use clap::builder::PossibleValue;

use super::output::{Failure, Output, Status};
use super::picture::{PlotArgs, draw};
use super::set::SetArgs;
use super::spec_files::files_read;
use super::teeth::WorstTeeth;
use crate::budget::{self, Budget, BudgetError, RandomAssemblies, Request, Summation, ToleranceDistribution};
use crate::deviation::Extent;
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::Model;
use crate::judge::bound::{Basis, NoBound};
use crate::judge::class::{ErrorClass, deviation_of};
use crate::judge::{Interval, Limit, LimitTarget, Rule};
use crate::quantity::Length;
use crate::report::{BudgetReport, Format, bound_remarks};
use crate::spec::{Spec, keys};

pub(super) const ABOUT: &str = "Share a ΔCD tolerance out: which tolerance each error may have";

#[derive(Debug, clap::Args)]
#[command(after_help = "The spec's [budget] says which tolerances are fixed and which are sought:

  [budget]
  stack = \"rss\"                      # worst, rss or simulation
  rack_over_roller = \"10 um\"         # fixed
  rack_pitch = { class = 7 }         # fixed, by [tolerance]
  rack_lead = { weight = 2 }         # free: twice the ΔCD of a weight of 1
  pinion_pitch = \"free\"              # free, weight 1; { cost = 3 } instead makes the sum of costs smallest

Without entries there, the paper's five errors are free. --delta-cd stands in place of limits.center_distance.

Examples:
  rackmesh budget rack.toml
  rackmesh budget rack.toml --delta-cd 50um --stack worst-case
  rackmesh budget rack.toml --stack simulation --conforming 0.999 --plot tornado.svg

Exit status: 0 if the limit can be met, 1 if fixed tolerances break it, 2 if there is no result.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// The ΔCD to stay within, to either side.
    #[arg(long, value_name = "ΔCD", allow_hyphen_values = true)]
    delta_cd: Option<Length>,
    /// How errors add up.
    #[arg(long, value_parser = [
        PossibleValue::new("worst-case").alias("worst").help("The bound of all tolerances"),
        PossibleValue::new("rss").help("Tolerances as three standard deviations around the bound of what was measured; no bound"),
        PossibleValue::new("simulation").help("A fraction of random assemblies"),
    ])]
    stack: Option<String>,
    /// The fraction of random assemblies that must conform; 0.9973 unless given.
    #[arg(long, value_name = "FRACTION", value_parser = fraction)]
    conforming: Option<f64>,
    /// How errors spread within their tolerances; uniform unless given.
    #[arg(long, value_parser = ["uniform", "normal", "triangular"])]
    distribution: Option<String>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Formulas exact for rigid teeth, or as the paper prints them.
    #[arg(long, value_enum, default_value_t)]
    model: Model,
    /// Do not look for the worst teeth to put the errors on.
    #[arg(long, alias = "no-mesh")]
    no_worst_teeth: bool,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

fn fraction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 1.0 => Ok(value),
        _ => Err("a fraction above 0 and at most 1 is needed".to_owned()),
    }
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = self.set.read_spec(&self.spec, output)?;
        super::function::leave_open(&spec, output);
        let picture = self.plot.picture(&files_read(&spec, &self.spec))?;
        let (entries, classes) = spec.budget_entries()?;
        let decision = spec.or_zero(keys::DECISION_RULE);
        let own_limits = spec.own_limits().into_iter();
        let request = Request {
            entries,
            limit: decision.accepted(&self.limit(&spec)?),
            own_limits: own_limits.map(|(kind, limit)| (kind, decision.accepted(&limit))).collect(),
            rule: self.rule(&spec)?,
            model: self.model,
            basis: spec.pair_basis()?,
        };
        let budget = budget::allocate(&request).map_err(|error| no_budget(&error, &spec))?;
        let grades = grades(&spec, &budget, request.model);
        let report = BudgetReport {
            title: spec.title.as_deref(),
            budget: &budget,
            request: &request,
            classes: &classes,
            grades: &grades,
            reached: if self.no_worst_teeth { None } else { reached(&budget, &request.basis)? },
            notes: [remarks(&spec, &decision), bound_remarks(&budget.notes, &spec.missing_geometry())].concat(),
            screen: output.screen(),
        };
        draw(picture, || report.chart(), true, output)?;
        output.report(&report, self.format)?;
        Ok(if budget.is_feasible() { Status::Pass } else { Status::Fail })
    }

    fn limit(&self, spec: &Spec) -> Result<Limit, Failure> {
        if let Some(delta_cd) = self.delta_cd {
            return Ok(Limit::symmetric(delta_cd));
        }
        match spec.limit_on(LimitTarget::CenterDistance) {
            Some(limit) => Ok(*limit),
            None => Err(Diagnostic::error(Code::NoBudget, "there is no ΔCD to distribute")
                .help("give --delta-cd, or limits.center_distance in the spec")
                .into()),
        }
    }

    fn rule(&self, spec: &Spec) -> Result<Summation, Failure> {
        let stack = self.stack.as_deref().or(spec.get(keys::BUDGET_STACK));
        let only_simulated =
            [("--conforming", self.conforming.is_some()), ("--distribution", self.distribution.is_some())];
        if let Some((flag, _)) = only_simulated.iter().find(|(_, is_given)| *is_given && stack != Some("simulation")) {
            let message = format!("{flag} counts for random assemblies, and none are drawn");
            return Err(Diagnostic::usage(message).help("add --stack simulation").into());
        }
        Ok(match stack {
            Some("rss") => Summation::Rss,
            Some("simulation") => {
                let spread = self.distribution.as_deref().or(spec.get(keys::BUDGET_DISTRIBUTION));
                let conforming = self.conforming.or(spec.get(keys::BUDGET_CONFORMING));
                Summation::Simulation(RandomAssemblies {
                    conforming: conforming.unwrap_or(RandomAssemblies::CONFORMING),
                    spread: spread.map(ToleranceDistribution::of_name).unwrap_or_default(),
                    draws: RandomAssemblies::DRAWS,
                    seed: self.seed,
                })
            }
            _ => Summation::WorstCase,
        })
    }
}

/// Remarks on parts of the spec that a budget leaves out, and on how a decision rule counts.
fn remarks(spec: &Spec, decision: &Rule) -> Vec<String> {
    let left_out = [
        (spec.has_deviations(), "deviations of single teeth"),
        (!spec.errors.is_empty(), "the values of [errors]"),
        (!spec.uncertainties.is_empty(), "uncertainties"),
    ];
    let left_out: Vec<_> = left_out.into_iter().filter(|(is_given, _)| *is_given).map(|(_, what)| what).collect();
    let mut remarks = Vec::new();
    if !left_out.is_empty() {
        remarks.push(format!("no part of the budget: {}", left_out.join(", ")));
    }
    match decision {
        Rule::Simple => {}
        Rule::Guard(band) => remarks.push(format!("limits are narrowed by the guard band of {band}, as parts will be judged")),
        Rule::Iso14253 => remarks.push(
            "the decision rule iso14253 takes the uncertainty of measured values, which tolerances have not: parts near the \
             limit will be indeterminate"
                .to_owned(),
        ),
    }
    remarks
}

/// Why there is no budget; where the pair's geometry is missing, which of its keys.
fn no_budget(error: &BudgetError, spec: &Spec) -> Diagnostic {
    let diagnostic = Diagnostic::error(Code::NoBudget, error.to_string());
    let missing = spec.missing_geometry();
    match error {
        BudgetError::NoBound(NoBound::TeethInContactUnknown | NoBound::OwnCurveUnknown) if !missing.is_empty() => {
            diagnostic.help(format!("add {}", missing.join(", ")))
        }
        _ => diagnostic,
    }
}

/// The range that the granted tolerances reach in the exact mesh, if the limit can be met.
fn reached(budget: &Budget, basis: &Basis) -> Result<Option<Interval>, Failure> {
    if !budget.is_feasible() {
        return Ok(None);
    }
    let worst = WorstTeeth::of(budget.lines.iter().map(|line| line.error).collect(), basis)?;
    worst.map(|worst| worst.interval()).transpose()
}

/// For each free tolerance, the coarsest grade of the spec's standard that stays within it.
fn grades(spec: &Spec, budget: &Budget, model: Model) -> Vec<ErrorClass> {
    let Some(standard) = spec.get(keys::TOLERANCE_STANDARD) else { return Vec::new() };
    if !budget.is_feasible() {
        return Vec::new();
    }
    // a class applies to each tooth
    let free = budget.lines.iter().filter(|line| !line.is_fixed && line.error.extent() == Extent::Each);
    free.filter_map(|line| {
        let kind = line.error.kind();
        let limiting = standard.that_limits(deviation_of(kind)?)?;
        let within = |class: &ErrorClass| {
            line.error.law().delta_cd(class.value, model).is_ok_and(|delta_cd| delta_cd <= line.delta_cd)
        };
        limiting.grades().rev().filter_map(|grade| spec.class_of(kind, grade)).find(within)
    })
    .collect()
}
