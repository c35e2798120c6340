//! `rackmesh monte-carlo`: racks whose teeth deviate at random, through the exact mesh.

use super::output::{Failure, Output, Status};
use super::set::SetArgs;
use super::{long, mesh};
use crate::chance::DEFAULT_SEED;
use crate::chance::racks::{RackSettings, RacksError, RacksSummary, simulate_racks};
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::{LimitTarget, Verdict};
use crate::report::{Format, RacksReport};

pub(super) const ABOUT: &str = "Draw random racks, and solve each by the exact mesh";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh monte-carlo examples/scatter.toml
  rackmesh monte-carlo examples/scatter.toml --racks 20000 --format json

CSV lists every rack. The same seed gives the same racks with any number of threads.
For the uncertainty of one part: rackmesh eval --monte-carlo.

Ctrl-C ends the run and prints what was computed.

Exit status: 0 all racks inside limits.center_distance or none given, 1 some outside, 2 could not solve,
130 or 143 if Ctrl-C or SIGTERM ended the run.")]
pub(super) struct Args {
    /// The gear spec (TOML) with a section [scatter]; `-` reads standard input.
    spec: String,
    /// How many racks.
    #[arg(long, default_value_t = 2000, value_name = "N")]
    racks: usize,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = DEFAULT_SEED, value_name = "SEED")]
    seed: u64,
    #[command(flatten)]
    stroke: mesh::Stroke,
    /// Threads; one per core unless given.
    #[arg(long, short = 'j', alias = "jobs", value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = self.set.read_spec(&self.spec, output)?;
        let (scatter, classes) = spec.scatter()?;
        let input = spec.mesh(&mesh::measured_tables(&spec, &self.spec)?)?;
        let settings = RackSettings {
            seed: self.seed,
            racks: self.racks,
            from_mm: self.stroke.from.mm(),
            to_mm: self.stroke.to.mm(),
            threads: self.threads.map(usize::from),
        };
        let interruption = long::interrupted();
        let results = simulate_racks(&input.mesh, &scatter, &settings, interruption.stop());
        let results = results.map_err(|error| unsolved(&error))?;
        if results.is_empty() {
            output.diagnostic(&Diagnostic::warning(Code::NoMonteCarlo, "interrupted before the first rack was solved"));
            return Ok(interruption.status().unwrap_or(Status::Undecided));
        }
        let limit = spec.limits.iter().find(|(on, _)| *on == LimitTarget::CenterDistance);
        let limit = limit.map(|(_, limit)| &limit.value);
        let summary = RacksSummary::of(&results, settings.racks, limit);
        let report = RacksReport {
            title: spec.title.as_deref(),
            scatter: &scatter,
            classes: &classes,
            settings: &settings,
            results: &results,
            summary: &summary,
            notes: mesh::notes(&input),
        };
        output.report(&report, self.format)?;
        if summary.is_interrupted {
            if self.format == Format::Csv {
                // the other formats say so themselves
                let message = format!("interrupted: these are the first {} of {} racks", results.len(), self.racks);
                output.diagnostic(&Diagnostic::warning(Code::NoMonteCarlo, message));
            }
            return Ok(interruption.status().unwrap_or(Status::Undecided));
        }
        Ok(match summary.verdict {
            Some(Verdict::Fail) => Status::Fail,
            _ => Status::Pass,
        })
    }
}

fn unsolved(error: &RacksError) -> Diagnostic {
    let code = match error {
        RacksError::Mesh { .. } => Code::NoMesh,
        RacksError::Count { .. } | RacksError::Stroke { .. } => Code::Usage,
        _ => Code::NoMonteCarlo,
    };
    let diagnostic = Diagnostic::error(code, error.to_string());
    match error {
        RacksError::Mesh { .. } => {
            diagnostic.help("the deviations drawn are too large for these teeth: check the units in [scatter]")
        }
        _ => diagnostic,
    }
}
