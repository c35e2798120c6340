//! `rackmesh report`: everything about a spec and its parts on one page.

use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::decision::DecisionArgs;
use super::eval::{self, ModelArg, StackArg};
use super::output::{Failure, Output, Status};
use super::{batch, mesh, office, stream};
use crate::batch::{Batch, Dialect, Input, Layout, Packing, Plan, Request, Rows, RunError, Sink, Sinks};
use crate::decision::{LimitTarget, Stack};
use crate::deviation::ErrorKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::quantity::Length;
use crate::report::html::{Chart, InputFile, Page, Section};
use crate::report::{Basis, BatchReport, Block, EvaluationReport, MeshReport, Report as _, Screen};
use crate::spec::Spec;

pub(super) const ABOUT: &str =
    "Write one self-contained page: spec, deviations, ΔCD, mesh curve, batch, hashes of the inputs";

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The page needs no network and no script. The batch, if tables are given, comes with a histogram and a run chart.

Examples:
  rackmesh report examples/steering.toml -o report.html
  rackmesh report rack.toml lot7.csv -o lot7.html

Exit status: 0 all verdicts are pass or there are none, 1 a fail, 2 something could not be judged, 3 indeterminate."
)]
pub(super) struct Args {
    /// The gear spec (TOML).
    spec: String,
    /// Tables with a row per part: what `rackmesh batch` reads.
    files: Vec<String>,
    #[command(flatten)]
    place: office::Place,
    /// The page to write; standard output unless given.
    #[arg(long, short, value_name = "FILE")]
    output: Option<String>,
    /// First stroke of the mesh curve.
    #[arg(long, default_value = "0", allow_hyphen_values = true, value_name = "LENGTH")]
    from: Length,
    /// Last stroke of the mesh curve.
    #[arg(long, default_value = "50", allow_hyphen_values = true, value_name = "LENGTH")]
    to: Length,
    /// The combination that the verdict judges.
    #[arg(long, value_enum, default_value_t)]
    stack: StackArg,
    /// Formulas exact for rigid teeth, or as the paper prints them.
    #[arg(long, value_enum, default_value_t)]
    model: ModelArg,
    #[command(flatten)]
    decision: DecisionArgs,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = super::read_spec(&self.spec)?;
        let mut page = Page { title: spec.title.clone().unwrap_or_else(|| self.spec.clone()), ..Page::default() };
        page.inputs.push(InputFile::of(&self.spec, spec.source.text.as_bytes()).map_err(Failure::Write)?);
        if self.spec != "-" {
            // the file's own bytes, with the mark and the line ends that it may have
            page.inputs[0] = hashed(&self.spec)?;
        }
        let mut statuses = Vec::new();
        // of a lot, the spec may say no more than what its table's values are to be taken with
        let has_value = |kind: ErrorKind| spec.errors.iter().any(|(error, _)| *error == kind);
        let nominals = spec.nominals.iter().map(|(kind, _)| *kind);
        let mut promised = nominals.chain(spec.unmeasured.iter().map(|(kind, _)| *kind));
        let is_one_part = self.files.is_empty() || promised.all(has_value);
        let has_errors = !spec.errors.is_empty() && is_one_part;
        if has_errors || self.files.is_empty() && !spec.has_deviations() {
            statuses.push(self.evaluation(&spec, &mut page, output)?);
        }
        self.mesh(&spec, &mut page, output)?;
        if !self.files.is_empty() {
            statuses.push(self.batch(&spec, &mut page, output)?);
        }
        page.sections.push(self.assumptions());
        page.sections.push(Section {
            heading: "Spec".to_owned(),
            source: Some(spec.source.text.clone()),
            ..Section::default()
        });
        let html = page.html();
        match &self.output {
            Some(path) => std::fs::write(path, html)
                .map_err(|error| Diagnostic::error(Code::FileAccess, format!("cannot write {path}: {error}")))?,
            None => output.text(&html)?,
        }
        Ok(statuses.into_iter().max_by_key(|status| status.severity()).unwrap_or(Status::Pass))
    }

    /// The part of `[errors]`.
    fn evaluation(&self, spec: &Spec, page: &mut Page, output: &mut Output) -> Result<Status, Failure> {
        let (evaluation, uncertainty) = eval::judged(spec, &self.decision, self.model.into(), self.stack.into())?;
        for target in evaluation.unjudged() {
            output.diagnostic(&eval::unjudged(spec, target));
        }
        let helical = spec.rack.helix_angle.as_ref().is_some_and(|angle| !angle.value.is_zero());
        let mut report = EvaluationReport::new(None, &evaluation, helical).with_classes(spec.classes()?);
        report.rule = self.decision.rule(spec);
        report.uncertainty = uncertainty;
        let blocks = without_verdict(report.blocks(), page, "this part");
        page.sections.push(Section {
            heading: "Deviations and ΔCD by formula".to_owned(),
            blocks,
            ..Section::default()
        });
        Ok(eval::status(&evaluation))
    }

    /// The exact mesh, if the spec has the geometry.
    fn mesh(&self, spec: &Spec, page: &mut Page, output: &mut Output) -> Result<(), Failure> {
        const TOLERANCE_MM: f64 = 1e-6;
        let heading = "Exact mesh along the stroke".to_owned();
        if spec.errors.is_empty() && !spec.has_deviations() {
            return Ok(());
        }
        let tables = mesh::measured_tables(spec, &self.spec)?;
        let input = match spec.mesh(&tables) {
            Ok(input) => input,
            Err(Diagnostics(problems)) => {
                let incomplete = problems.iter().all(|problem| problem.code == Code::MissingKey);
                if !incomplete {
                    return Err(Diagnostics(problems).into());
                }
                let missing: Vec<_> = problems.iter().map(|problem| problem.message.clone()).collect();
                let note = format!("The mesh is not solved: {}.", missing.join("; "));
                page.sections.push(Section { heading, blocks: vec![Block::Note(note)], ..Section::default() });
                return Ok(());
            }
        };
        for file in [&spec.rack.measured, &spec.pinion.measured].into_iter().flatten() {
            let folder = std::path::Path::new(&self.spec).parent().unwrap_or(std::path::Path::new(""));
            page.inputs.push(hashed(&folder.join(&file.value).display().to_string())?);
        }
        let curve = match input.mesh.curve(self.from.mm(), self.to.mm(), TOLERANCE_MM) {
            Ok(curve) => curve,
            Err(error) => {
                output.diagnostic(&Diagnostic::warning(Code::NoMesh, error.to_string()));
                let note = format!("The mesh has no solution: {error}.");
                page.sections.push(Section { heading, blocks: vec![Block::Note(note)], ..Section::default() });
                return Ok(());
            }
        };
        let prediction = mesh::prediction(&input);
        let limits = spec.limits();
        let limit = limits.iter().find(|(target, _)| *target == LimitTarget::CenterDistance).map(|(_, limit)| limit);
        let report = MeshReport {
            title: None,
            mesh: &input.mesh,
            curve: &curve,
            listed: &[],
            prediction: &prediction,
            limit,
            notes: mesh::notes(&input),
            screen: Screen::default(),
        };
        let line = curve.points.iter().map(|point| (point.stroke_mm, point.delta_cd_mm)).collect();
        let ends = limit.into_iter().flat_map(|limit| [limit.lower, limit.upper]).flatten().map(Length::mm);
        let chart = Chart {
            caption: "ΔCD along the stroke by the exact mesh (line), the range of the formulas (band), limits (dashed)"
                .to_owned(),
            axes: ("stroke [mm]".to_owned(), "ΔCD [mm]".to_owned()),
            lines: vec![line],
            band: Some(prediction.range_mm()),
            limits: ends.collect(),
            ..Chart::default()
        };
        let blocks = without_verdict(report.blocks(), page, "the mesh");
        page.sections.push(Section { heading, charts: vec![chart], blocks, ..Section::default() });
        Ok(())
    }

    /// The parts of the tables.
    fn batch(&self, spec: &Spec, page: &mut Page, output: &mut Output) -> Result<Status, Failure> {
        if self.files.iter().any(|file| file == "-") {
            let message = "a report names its inputs and their hashes, and standard input has no name";
            return Err(Diagnostic::error(Code::Usage, message).help("give a file").into());
        }
        let stop = Arc::new(AtomicBool::new(false));
        let request = Request {
            model: self.model.into(),
            stack: self.stack.into(),
            rule: self.decision.rule(spec),
            monte_carlo: self.decision.settings()?,
            rows: Rows::All,
            statistics: true,
            problems_kept: 10,
            ..Request::default()
        };
        let (first, spec) = self.table(&self.files[0], &Arc::new(spec.clone()), &stop, Some(output))?;
        let plan = Plan::new(&spec, &first.header, request)?;
        let mut run = RunChart::default();
        let sinks = Sinks { rows: Some(Sink { writer: &mut run, packing: Packing::None }), rejects: None };
        let mut batch = Batch::new(&plan, sinks, None);
        let mut first = Some(first);
        for file in &self.files {
            let input = match first.take() {
                Some(input) => input,
                None => self.table(file, &spec, &stop, None)?.0,
            };
            let layout = Layout::new(&plan, &input.header)?;
            if !layout.understood().is_empty() {
                output.remark(&format!("{}: {}", input.header.name, layout.understood().join(", ")));
            }
            batch.run(input, &layout, &stop, &mut |_| {}).map_err(|error| match error {
                RunError::Read(error) => {
                    Diagnostic::error(Code::FileAccess, format!("cannot read {file} to its end: {error}")).into()
                }
                RunError::Write(error) => Failure::Write(error),
            })?;
            page.inputs.push(hashed(file)?);
        }
        let (outcome, written) = batch.finish();
        written?;
        for problem in &outcome.problems {
            output.diagnostic(&Diagnostic::error(Code::BadRow, problem_text(problem)));
        }
        let basis = Basis::of(&plan);
        let report = BatchReport::new(None, &basis, &outcome);
        let mut blocks = without_verdict(report.blocks(), page, "the batch");
        if !outcome.problems.is_empty() {
            blocks.extend(
                outcome.problems.iter().map(|problem| Block::Note(format!("not read: {}", problem_text(problem)))),
            );
        }
        let (judged, small_charts) = histograms(&plan, &outcome);
        let charts = judged.into_iter().chain(run.chart(&plan)).collect();
        page.sections.push(Section {
            heading: format!("Batch: {}", self.files.join(", ")),
            charts,
            small_charts,
            blocks,
            ..Section::default()
        });
        Ok(batch::status(&outcome, false, !plan.unjudged().is_empty()))
    }

    fn table(
        &self,
        file: &str,
        spec: &Arc<Spec>,
        stop: &Arc<AtomicBool>,
        output: Option<&mut Output>,
    ) -> Result<(Input, Arc<Spec>), Failure> {
        let Some(found) = office::open(file, spec, &self.place)? else {
            return Ok((Input::open(file, stream::open(file, stop)?, Dialect::default())?, Arc::clone(spec)));
        };
        let (completed, notes) = found.completed(spec, self.model.into());
        if let Some(output) = output {
            for note in notes {
                output.remark(&note);
            }
        }
        Ok((found.input(file), Arc::new(completed)))
    }

    fn assumptions(&self) -> Section {
        let stack: Stack = self.stack.into();
        let model: crate::formula::Model = self.model.into();
        let notes = [
            format!("Formulas: the {model} model. Lengths and angles are exact decimals; a result is rounded once, and one that equals a limit is inside it."),
            format!("Verdicts judge the {stack}. The range is what the errors can do at some point of the stroke: over-roller and radial errors act always, with their sign; pitch and lead errors between 0 and their value."),
            "The worst case is the sum of magnitudes and RSS the root of the sum of squares, both to either side.".to_owned(),
            "The exact mesh is free of backlash, of rigid teeth, minimised over the pinion's rotation; the curve is exact to 1e-6 mm between its points.".to_owned(),
        ];
        Section { heading: "Assumptions".to_owned(), blocks: notes.map(Block::Note).into(), ..Section::default() }
    }
}

fn problem_text(problem: &crate::batch::Problem) -> String {
    format!("{}: {}", problem.whereabouts(), problem.what())
}

fn hashed(path: &str) -> Result<InputFile, Failure> {
    let file = File::open(path).and_then(|file| InputFile::of(path, file));
    Ok(file.map_err(|error| Diagnostic::error(Code::FileAccess, format!("cannot read {path}: {error}")))?)
}

/// The blocks without their verdicts, which go to the top of the page.
fn without_verdict(blocks: Vec<Block>, page: &mut Page, of: &str) -> Vec<Block> {
    let mut kept = Vec::new();
    for block in blocks {
        match block {
            Block::Verdict(verdict, sentence) => {
                page.verdicts.push((verdict, format!("{of}: {sentence}")));
                kept.push(Block::Verdict(verdict, sentence));
            }
            block => kept.push(block),
        }
    }
    kept
}

/// The result that is judged: the name of its upper and, for a range, of its lower end.
fn judged_names(stack: Stack) -> (&'static str, Option<&'static str>) {
    match stack {
        Stack::Range => ("range_upper_mm", Some("range_lower_mm")),
        Stack::WorstCase => ("worst_case_mm", None),
        Stack::Rss => ("rss_mm", None),
    }
}

/// How the results are distributed: the one that is judged first, then that of each error.
fn histograms(plan: &Plan, outcome: &crate::batch::Outcome) -> (Option<Chart>, Vec<Chart>) {
    const BINS: usize = 40;
    let (upper, _) = judged_names(plan.stack());
    let (mut judged, mut charts) = (None, Vec::new());
    for (index, name) in outcome.quantities.iter().enumerate() {
        let is_error = name.starts_with("delta_cd_");
        if name != upper && !is_error {
            continue;
        }
        let statistics = &outcome.statistics[index];
        let (Some(low), Some(high)) = (statistics.min_mm(), statistics.max_mm()) else { continue };
        let limits = plan.quantity_limits().get(index).copied().unwrap_or_default();
        let (low, high) = if high > low { (low, high.next_up()) } else { (low - 0.000_5, high + 0.000_5) };
        #[expect(clippy::cast_precision_loss, reason = "a picture")]
        let counts: Vec<f64> = statistics.histogram(low, high, BINS).into_iter().map(|count| count as f64).collect();
        #[expect(clippy::cast_precision_loss, reason = "a picture")]
        let edge = |bin: usize| low + (high - low) * bin as f64 / BINS as f64;
        let title = name.trim_end_matches("_mm").replace("delta_cd_", "ΔCD of ").replace('_', " ");
        let dashed = if limits == (None, None) { "" } else { "; limits dashed" };
        let chart = Chart {
            caption: format!("Histogram of {title}{dashed}"),
            axes: (format!("{title} [mm]"), "parts".to_owned()),
            bars: counts.into_iter().enumerate().map(|(bin, count)| (edge(bin), edge(bin + 1), count)).collect(),
            limits: [limits.0, limits.1].into_iter().flatten().collect(),
            ..Chart::default()
        };
        if is_error {
            charts.push(chart);
        } else {
            judged = Some(chart);
        }
    }
    (judged, charts)
}

/// Takes the rows of a batch as they are written and keeps the lowest and highest result of each group of
/// neighbours; groups grow with the batch, so that memory does not.
#[derive(Debug, Default)]
struct RunChart {
    partial: Vec<u8>,
    header: Option<Vec<String>>,
    /// Parts per group.
    size: u64,
    /// In the last group.
    held: u64,
    groups: Vec<(f64, f64)>,
    stack: Option<(usize, usize)>,
}

/// Groups at most: more than a picture shows.
const MOST_GROUPS: usize = 1024;

impl RunChart {
    fn line(&mut self, line: &[u8]) {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(line);
        let Some(Ok(record)) = reader.records().next() else { return };
        if self.header.is_none() {
            let header: Vec<String> = record.iter().map(str::to_owned).collect();
            let find = |name: &str| header.iter().position(|column| column == name);
            let names =
                [("range_lower_mm", "range_upper_mm"), ("worst_case_mm", "worst_case_mm"), ("rss_mm", "rss_mm")];
            self.stack = names.iter().find_map(|(low, high)| Some((find(low)?, find(high)?)));
            self.header = Some(header);
            return;
        }
        let Some((low, high)) = self.stack else { return };
        let value = |index: usize| record.get(index).and_then(|cell| cell.parse::<f64>().ok());
        let (Some(low), Some(high)) = (value(low), value(high)) else { return };
        self.size = self.size.max(1);
        if self.groups.is_empty() || self.held == self.size {
            if self.groups.len() == MOST_GROUPS {
                self.groups = self.groups.chunks(2).map(|pair| pair.iter().copied().fold(pair[0], joined)).collect();
                self.size *= 2;
            }
            self.groups.push((low, high));
            self.held = 1;
        } else if let Some(last) = self.groups.last_mut() {
            *last = joined(*last, (low, high));
            self.held += 1;
        }
    }

    fn chart(&self, plan: &Plan) -> Option<Chart> {
        if self.groups.is_empty() {
            return None;
        }
        let limit = plan.limits().iter().find(|(target, _)| *target == LimitTarget::CenterDistance);
        let limits = limit.into_iter().flat_map(|(_, limit)| [limit.lower, limit.upper]).flatten().map(Length::mm);
        #[expect(clippy::cast_precision_loss, reason = "a picture")]
        let at = |index: usize| (index as u64 * self.size + 1) as f64;
        let range: Vec<_> =
            self.groups.iter().enumerate().map(|(index, (low, high))| (at(index), *low, *high)).collect();
        let grouped = if self.size > 1 { format!("; each point holds {} parts", self.size) } else { String::new() };
        Some(Chart {
            caption: format!(
                "Run chart: ΔCD from its lowest to its highest value, in the order of the rows; limits dashed{grouped}"
            ),
            axes: ("part".to_owned(), "ΔCD [mm]".to_owned()),
            lines: vec![range.iter().map(|(at, _, high)| (*at, *high)).collect()],
            range,
            limits: limits.collect(),
            counts: true,
            ..Chart::default()
        })
    }
}

fn joined(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

impl Write for RunChart {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut rest = bytes;
        while let Some(end) = rest.iter().position(|byte| *byte == b'\n') {
            let (line, after) = rest.split_at(end + 1);
            if self.partial.is_empty() {
                self.line(line);
            } else {
                self.partial.extend_from_slice(line);
                let line = std::mem::take(&mut self.partial);
                self.line(&line);
            }
            rest = after;
        }
        self.partial.extend_from_slice(rest);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_chart_keeps_every_extreme_in_little_memory() {
        let mut run = RunChart::default();
        run.write_all(b"part_id,range_lower_mm,range_upper_mm,verdict\n").expect("memory");
        for part in 0..50_000 {
            let high = if part == 31_415 { 0.9 } else { 0.1 };
            let line = format!("P{part},-0.1,{high},pass\n");
            // in pieces, as writers hand them over
            let (a, b) = line.as_bytes().split_at(5);
            run.write_all(a).expect("memory");
            run.write_all(b).expect("memory");
        }
        assert!(run.groups.len() <= MOST_GROUPS);
        assert_eq!(run.size, 64);
        let group = 31_415 / 64;
        assert_eq!(run.groups[group], (-0.1, 0.9));
        assert_eq!(run.groups.iter().filter(|group| group.1 > 0.5).count(), 1);
    }
}
