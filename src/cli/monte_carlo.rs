//! `rackmesh monte-carlo`: racks whose teeth deviate at random, through the exact mesh.

use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::bar::Bar;
use super::output::{Failure, Output, Status};
use super::picture::{PlotArgs, draw};
use super::set::SetArgs;
use super::signals::{self, Interruption};
use super::target::{Target, is_dash, refuse_same};
use super::teeth::{WorstTeeth, mesh_of};
use super::{mesh, spec_files, stream};
use crate::chance::DEFAULT_SEED;
use crate::chance::racks::{
    Contributions, RackRange, RackSettings, Racks, RacksError, RacksStudy, RacksSummary, RacksYoke, StudyError,
};
use crate::diagnostic::{Code, Diagnostic};
use crate::function::{self, Check, YokeJudge};
use crate::judge::{LimitTarget, Rule, Verdict};
use crate::mesh::TOLERANCE_MM;
use crate::report::{Format, RacksReport, grouped, rack_columns, rack_lines, read_study, study_json};
use crate::spec::{MeshInput, Spec, keys};

pub(super) const ABOUT: &str = "Draw random racks, and solve each by the exact mesh";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh monte-carlo examples/scatter.toml
  rackmesh monte-carlo examples/scatter.toml --racks 20000 --format json
  rackmesh monte-carlo examples/scatter.toml --plot racks.svg
  rackmesh monte-carlo examples/scatter.toml --contributions
  rackmesh monte-carlo examples/scatter.toml --first-rack 2000 --racks 3000 --study b.json
  rackmesh monte-carlo examples/scatter.toml --merge a.json b.json

CSV lists every rack, of merged studies the quantiles, of contributions these. The same seed gives the same racks with any number of threads and
in any ranges: merged, they are the same bits as one run.
For the uncertainty of one part: rackmesh eval --monte-carlo.

Ctrl-C ends the run, and prints and keeps what was computed.

Exit status: 0 all racks inside limits.center_distance or none given, 1 some outside, 2 could not solve or racks are missing,
129, 130 or 143 if a signal ended it.")]
pub(super) struct Args {
    /// The gear spec (TOML) with a section [scatter]; `-` reads standard input.
    spec: PathBuf,
    /// How many racks; 2000 unless given, of merged studies all that were asked for.
    #[arg(long, value_name = "N")]
    racks: Option<u64>,
    /// Number of the first rack; 0 unless given, of merged studies the first that was asked for.
    #[arg(long, value_name = "N")]
    first_rack: Option<u64>,
    /// Keep the racks, counted, in this file, to be merged.
    #[arg(long, value_name = "FILE")]
    study: Option<PathBuf>,
    /// Merge the studies in these files, in place of drawing racks.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["seed", "from", "to", "threads"])]
    merge: Vec<PathBuf>,
    /// Say which scatter makes which share of the spread: Sobol indices, by as many samples as racks.
    #[arg(long, conflicts_with = "merge")]
    contributions: bool,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = DEFAULT_SEED, value_name = "SEED")]
    seed: u64,
    #[command(flatten)]
    stroke: mesh::Stroke,
    #[command(flatten)]
    plot: PlotArgs,
    /// Threads; one per core unless given.
    #[arg(long, short = 'j', alias = "jobs", value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

/// The default number of racks.
const DEFAULT_RACKS: u64 = 2000;
/// The largest study that is read: several times what the bins of one take.
const LARGEST_STUDY: u64 = 64 << 20;

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = self.set.read_spec(&self.spec, output)?;
        let (scatter, classes) = spec.scatter()?;
        let mut files = spec_files::files_read(&spec, &self.spec);
        files.extend(self.merge.iter().cloned());
        refuse_same(&[self.study.as_deref(), self.plot.path()].into_iter().flatten().collect::<Vec<_>>())?;
        let kept = self.kept(&files)?;
        let picture = self.plot.picture(&files)?;
        let (input, middles) = base(&spec, &self.spec, output)?;
        let limit = spec.limit_on(LimitTarget::CenterDistance);
        let strokes = self.stroke.ends(&spec)?;
        let judge = spec.yoke_judge(self.stroke.travel(&spec)?, &spec.or_zero(keys::DECISION_RULE))?;
        let (yoke, mut unjudged) = match &judge {
            Some(judge) => with_yoke(judge, &input, strokes)?,
            None => (None, Vec::new()),
        };
        let racks = Racks { base: &input.mesh, scatter: &scatter, limit, yoke };
        let range = RackRange { first_rack: self.first_rack.unwrap_or(0), racks: self.racks.unwrap_or(DEFAULT_RACKS) };
        let threads = self.threads.map(usize::from);
        let settings = RackSettings { seed: self.seed, range, threads, ..usual_settings(strokes) };
        let (study, ended) = if self.merge.is_empty() {
            self.drawn(&racks, &settings, &signals::interrupted(output), output)
        } else {
            (self.merged(&racks, signals::signals(output).stop())?, Ok(()))
        };
        let interruption = signals::interrupted(output);
        let Some(mut summary) = RacksSummary::of(&study) else {
            ended?;
            output.diagnostic(&Diagnostic::warning(Code::NoMonteCarlo, "interrupted before the first rack was solved"));
            return Ok(interruption.status().unwrap_or(Status::Undecided));
        };
        let ended_early = interruption.status().filter(|_| self.merge.is_empty() && !summary.missing.is_empty());
        if let Some(mut kept) = kept {
            kept.write_all(study_json(&study).map_err(std::io::Error::from)?.as_bytes())?;
            kept.end(ended_early.is_none(), output)?;
        }
        let is_asked = self.contributions && ended_early.is_none() && ended.is_ok();
        let contributions = is_asked.then(|| contributions(&racks, &settings, &interruption, output)).transpose()?;
        let ended_early = ended_early.or(interruption.status().filter(|_| is_asked));
        unjudged.extend(not_judged(&spec));
        unjudged.extend(partly_judged(&summary, study.racks()));
        let is_judged = unjudged.is_empty();
        summary.verdict = summary.verdict.filter(|verdict| *verdict == Verdict::Fail || is_judged);
        let report = RacksReport {
            title: spec.title.as_deref(),
            scatter: &scatter,
            classes: &classes,
            study: &study,
            summary: &summary,
            yoke: judge.as_ref(),
            contributions: contributions.as_ref(),
            notes: mesh::notes(&input).into_iter().chain(middles).collect(),
            unjudged,
        };
        draw(picture, || report.chart(limit), ended_early.is_none(), output)?;
        if !self.lists_racks() {
            output.report(&report, self.format)?;
        }
        if self.format == Format::Csv && !summary.missing.is_empty() {
            // the other formats report it themselves
            let message = format!("racks are missing: these are {} of {} racks", study.racks(), study.asked().racks);
            output.diagnostic(&Diagnostic::warning(Code::NoMonteCarlo, message));
        }
        // racks solved before an error are shown and kept
        ended?;
        Ok(ended_early.unwrap_or(status(&summary, is_judged)))
    }

    /// Whether racks are listed as they are solved.
    fn lists_racks(&self) -> bool {
        self.format == Format::Csv && self.merge.is_empty() && !self.contributions
    }

    /// The file that keeps the study, in a run that reads `files`.
    fn kept(&self, files: &[PathBuf]) -> Result<Option<Target>, Failure> {
        if self.study.as_ref().is_some_and(is_dash) {
            let message = "--study -: standard output has the result";
            return Err(Diagnostic::usage(message).help("name a file").into());
        }
        self.study.as_deref().map(|path| Target::create(path, files)).transpose()
    }

    fn drawn(
        &self,
        racks: &Racks<'_>,
        settings: &RackSettings,
        interruption: &Interruption,
        output: &mut Output,
    ) -> (RacksStudy, Result<(), Failure>) {
        let (mut bar, mut done, asked) = (Bar::new(output), 0, settings.range.racks);
        let drawn = racks.study(settings, interruption.stop(), |first_rack, results| {
            if self.lists_racks() {
                if done == 0 {
                    output.text(&rack_columns(racks.yoke.is_some()))?;
                }
                output.text(&rack_lines(first_rack, results))?;
            }
            done += results.len() as u64;
            bar.show(Some(done as f64 / asked as f64), || format!("{} racks", grouped(done)));
            Ok::<_, Failure>(())
        });
        bar.finish();
        drawn
    }

    fn merged(&self, racks: &Racks<'_>, stop: &Arc<AtomicBool>) -> Result<RacksStudy, Failure> {
        let mut merged: Option<RacksStudy> = None;
        for path in &self.merge {
            let study = kept_study(path, stop)?;
            let refused = |error: StudyError| {
                let message = format!("{} cannot be merged: {error}", stream::name(path));
                Failure::from(Diagnostic::usage(message))
            };
            if let Some(merged) = &mut merged {
                merged.merge(&study).map_err(refused)?;
            } else {
                study.refuse_other_racks(racks).map_err(refused)?;
                merged = Some(study);
            }
        }
        let mut merged = merged.ok_or_else(|| Diagnostic::usage("--merge names no file"))?;
        let RackRange { first_rack, .. } = merged.asked();
        let first_rack = self.first_rack.unwrap_or(first_rack);
        let racks = self.racks.unwrap_or(merged.asked().end().saturating_sub(first_rack));
        let asked = RackRange { first_rack, racks };
        merged.ask(asked).map_err(Diagnostic::with_code(Code::Usage))?;
        Ok(merged)
    }
}

/// The pair whose teeth scatter, with the middles of the scatter.
fn base(spec: &Spec, path: &Path, output: &mut Output) -> Result<(MeshInput, Vec<String>), Failure> {
    let mut input = mesh_of(spec, &spec_files::measured_tables(spec, path, output)?)?;
    let (middle, middles) = spec.with_scatter_middles(&input.mesh)?;
    input.mesh = middle;
    if !spec.has_deviations()
        && let Some(worst) = WorstTeeth::of(spec.part_errors_or_none()?, &spec.basis()?)?
    {
        worst.place(&mut input, spec.limit_on(LimitTarget::CenterDistance))?;
    }
    Ok((input, middles))
}

/// The default settings.
fn usual_settings((from_mm, to_mm): (f64, f64)) -> RackSettings {
    let range = RackRange { first_rack: 0, racks: DEFAULT_RACKS };
    RackSettings { seed: DEFAULT_SEED, range, from_mm, to_mm, threads: None }
}

/// The contribution of each scatter of a spec over these strokes.
pub(super) fn contributions_of(
    (spec, path): (&Spec, &Path),
    strokes: (f64, f64),
    interruption: &Interruption,
    output: &mut Output,
) -> Result<Contributions, Failure> {
    let (scatter, _) = spec.scatter()?;
    let (input, _) = base(spec, path, output)?;
    let limit = spec.limit_on(LimitTarget::CenterDistance);
    let racks = Racks { base: &input.mesh, scatter: &scatter, limit, yoke: None };
    contributions(&racks, &usual_settings(strokes), interruption, output)
}

/// The contribution of each scatter; for an interrupted run, from the samples that were solved.
fn contributions(
    racks: &Racks<'_>,
    settings: &RackSettings,
    interruption: &Interruption,
    output: &Output,
) -> Result<Contributions, Failure> {
    let (mut bar, asked) = (Bar::new(output), settings.range.racks);
    let found = racks.contributions(settings, interruption.stop(), |done| {
        bar.show(Some(done as f64 / asked as f64), || format!("{} samples for contributions", grouped(done)));
    });
    bar.finish();
    Ok(found?)
}

/// Reads the study in a file.
fn kept_study(path: &Path, stop: &Arc<AtomicBool>) -> Result<RacksStudy, Failure> {
    let unreadable = |reason: String| {
        let message = format!("cannot read the study in {}: {reason}", stream::name(path));
        Failure::from(Diagnostic::error(Code::FileAccess, message).help("`--study FILE` writes one"))
    };
    let mut text = String::new();
    let mut file = stream::open(path, stop)?.take(LARGEST_STUDY + 1);
    file.read_to_string(&mut text).map_err(|error| unreadable(error.to_string()))?;
    if text.len() as u64 > LARGEST_STUDY {
        return Err(unreadable("it is larger than 64 MiB, and none is".to_owned()));
    }
    read_study(&text).map_err(|error| unreadable(error.to_string()))
}

/// The yoke of the racks, and its limits that cannot be judged for any rack.
fn with_yoke<'a>(
    judge: &'a YokeJudge,
    input: &MeshInput,
    (from, to): (f64, f64),
) -> Result<(Option<RacksYoke<'a>>, Vec<String>), Failure> {
    let curve = input.mesh.curve(from, to, TOLERANCE_MM)?;
    let Some(function) = judge.on(&input.mesh, &curve)? else { return Ok((None, Vec::new())) };
    let is_measured = input.measures(&function);
    let open = judge.judge(&function, is_measured).iter().filter_map(Check::open_because).collect();
    Ok((Some(RacksYoke { judge, is_measured }), open))
}

/// A remark on limits of a yoke that are not judged for some racks.
fn partly_judged(summary: &RacksSummary, racks: u64) -> Vec<String> {
    let judged = summary.yoke.iter().flat_map(|yoke| function::Target::ALL.into_iter().zip(yoke.judged));
    let some = judged.filter(|(_, judged)| (1..racks).contains(judged));
    some.map(|(on, judged)| format!("{}: {judged} of {racks} racks are judged", on.words())).collect()
}

/// Limits of the spec that random racks are not judged by, so that no rack passes.
fn not_judged(spec: &Spec) -> Vec<String> {
    let limits = spec.limits();
    let rule = spec.or_zero(keys::DECISION_RULE);
    let of_errors: Vec<_> =
        limits.iter().filter(|(on, _)| *on != LimitTarget::CenterDistance).map(|(on, _)| on.to_string()).collect();
    let of_errors = (!of_errors.is_empty()).then(|| {
        format!("not judged: limits on single errors ({}), for the deviations of teeth are drawn", of_errors.join(", "))
    });
    let has_limit = limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance);
    let by_rule = (has_limit && rule != Rule::Simple).then(|| {
        format!("not judged: the decision rule {rule} is for the values of one part; racks are held against the limits themselves")
    });
    of_errors.into_iter().chain(by_rule).collect()
}

fn status(summary: &RacksSummary, is_judged: bool) -> Status {
    match summary.verdict {
        Some(Verdict::Fail) => Status::Fail,
        _ if !is_judged || !summary.missing.is_empty() => Status::Undecided,
        _ => Status::Pass,
    }
}

impl From<RacksError> for Failure {
    fn from(error: RacksError) -> Self {
        let diagnostic = |code| Diagnostic::error(code, error.to_string());
        match error {
            RacksError::Mesh { .. } => diagnostic(Code::NoMesh)
                .help("the deviations drawn are too large for these teeth: check the units in [scatter]"),
            RacksError::NotSolved { .. } | RacksError::Unresolved { .. } => diagnostic(Code::NoMesh).help(
                "`rackmesh mesh` shows why; check the tip diameter and the addendum, or study a shorter stroke with --from and --to",
            ),
            RacksError::Count { .. } | RacksError::Stroke { .. } => diagnostic(Code::Usage),
            _ => diagnostic(Code::NoMonteCarlo),
        }
        .into()
    }
}
