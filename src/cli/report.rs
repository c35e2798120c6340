//! `rackmesh report`: everything about a spec and its parts on one page.

use super::spec_files;
use std::io;
use std::sync::Arc;

use super::decision::JudgeArgs;
use super::eval::EvaluatedPart;
use super::long::{self, Interruption};
use super::output::{Failure, Output, Status};
use super::page::{hashed, reading_section, spec_sections, without_verdict};
use super::set::SetArgs;
use super::tables::{self, Files, Opener, ReadArgs};
use super::teeth::{Judged, WorstTeeth, with_known_teeth};
use super::{batch, mesh, target};
use crate::batch::{
    Batch, ColumnSink, Layout, Outcome, Plan, Request, ResultColumn, ResultColumns, ResultValues, RowFormat, RowSink,
    Rows, Sinks, Teeth, TeethRequest,
};
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::judge::{LimitTarget, Stack};
use crate::quantity::Length;
use crate::report::chart::{Axis, Bar, Chart, Layer, Scale, Shape, Span};
use crate::report::html::{Headline, InputFile, Page, Section};
use crate::report::{Basis, BatchReport, Block, MeshReport, Report as _};
use crate::spec::Spec;

pub(super) const ABOUT: &str = "Write one page: spec, ΔCD, mesh curve, parts, hashes of inputs";

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The page needs no network and no script. The batch, if tables are given, comes with a histogram and a run chart.

Examples:
  rackmesh report examples/steering.toml -o report.html
  rackmesh report rack.toml lot7.csv -o lot7.html
  rackmesh report rack.toml spaces.csv --teeth -o racks.html

Exit status: 0 all verdicts are pass or there are none, 1 a fail, 2 something could not be judged or\nread, 3 indeterminate, 130 or 143 interrupted."
)]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: String,
    /// Tables: what `rackmesh batch` and `rackmesh paste` read.
    files: Vec<String>,
    /// The file to write; the ending of its name tells the format.
    #[arg(long, short, value_name = "FILE")]
    output: Option<String>,
    /// One row per tooth or space: each part through the exact mesh.
    #[arg(long)]
    teeth: bool,
    #[command(flatten)]
    stroke: mesh::Stroke,
    #[command(flatten)]
    judge: JudgeArgs,
    /// Judge without errors that the spec asks for and the table lacks.
    #[arg(long)]
    partial: bool,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = self.set.read_spec(&self.spec, output)?;
        let inputs = spec_files::inputs(&spec, &self.spec, &self.files);
        let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
        if let Some(path) = &self.output {
            target::refuse_inputs(path, &inputs)?;
            target::known_ending(path, &["html", "htm"])?;
        }
        let mut page = Page { title: spec.title.clone().unwrap_or_else(|| self.spec.clone()), ..Page::default() };
        page.inputs.push(InputFile::of(&self.spec, spec.source.text.as_bytes()).map_err(Failure::Write)?);
        if self.spec != "-" {
            // the file's own bytes, with the mark and the line ends that it may have
            page.inputs[0] = hashed(&self.spec)?;
        }
        for path in inputs[1..].iter().filter(|path| **path != "-") {
            page.inputs.push(hashed(path)?);
        }
        let mut statuses = Vec::new();
        // of a lot, the spec may say no more than what its table's values are to be taken with
        let has_value = |kind: DeviationKind| spec.errors.iter().any(|(error, _)| *error == kind);
        let nominals = spec.nominals.iter().map(|(kind, _)| *kind);
        let mut promised = nominals.chain(spec.unmeasured.iter().map(|(kind, _)| *kind));
        let is_one_part = self.files.is_empty() || promised.all(has_value);
        let has_errors = !spec.errors.is_empty() && is_one_part;
        // a table of teeth takes the place of what the spec says of them
        let is_replaced = self.teeth && !self.files.is_empty();
        if !is_replaced && (has_errors || self.files.is_empty() || spec.has_deviations()) {
            let known = with_known_teeth(spec.clone(), &self.spec)?;
            let worst = WorstTeeth::of(known.part_errors_or_none()?, &known.basis()?)?;
            if has_errors || self.files.is_empty() {
                statuses.push(self.evaluation(&known, worst.as_ref(), &mut page, output)?);
            }
            if has_errors || spec.has_deviations() {
                self.mesh(&known, worst.as_ref(), &mut page, output)?;
            }
        }
        if !self.files.is_empty() {
            statuses.push(self.lot(&spec, &mut page, output)?);
        }
        page.sections.push(self.assumptions());
        page.sections.extend(spec_sections(&spec));
        let html = page.html();
        let status = statuses.into_iter().max_by_key(|status| status.severity()).unwrap_or(Status::Pass);
        let Some(path) = &self.output else {
            output.text(&html)?;
            return Ok(status);
        };
        let is_complete = !matches!(status, Status::Interrupted(_));
        target::written(path, &inputs, html.as_bytes())?.end(is_complete, output)?;
        let decides = |headline: &&Headline| headline.verdict.map_or(Status::Undecided, Status::from) == status;
        if let Some(headline) = page.verdicts.iter().find(decides) {
            output.text(&format!("{headline}\n"))?;
        }
        Ok(status)
    }

    /// The part of `[errors]`.
    fn evaluation(
        &self,
        spec: &Spec,
        worst: Option<&WorstTeeth>,
        page: &mut Page,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let mut part = EvaluatedPart::new(spec, &self.judge, worst, output)?;
        let status = Status::of(part.evaluation.verdict, &part.evaluation.limits);
        let blocks = without_verdict(part.report(None)?.blocks(), page, "this part");
        page.sections.push(Section {
            heading: "Deviations and ΔCD by formula".to_owned(),
            blocks,
            ..Section::default()
        });
        Ok(status)
    }

    /// The exact mesh, if the spec has the geometry.
    fn mesh(
        &self,
        spec: &Spec,
        worst: Option<&WorstTeeth>,
        page: &mut Page,
        output: &mut Output,
    ) -> Result<(), Failure> {
        const TOLERANCE_MM: f64 = 1e-6;
        let heading = "Exact mesh along the stroke".to_owned();
        let tables = spec_files::measured_tables(spec, &self.spec)?;
        let mut input = match spec.mesh(&tables) {
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
        if let Some(worst) = worst {
            worst.place(&mut input, spec.limit_on(LimitTarget::CenterDistance))?;
        }
        let curve = match input.mesh.curve(self.stroke.from.mm(), self.stroke.to.mm(), TOLERANCE_MM) {
            Ok(curve) => curve,
            Err(error) => {
                output.diagnostic(&Diagnostic::warning(Code::NoMesh, error.to_string()));
                let note = format!("The mesh has no solution: {error}.");
                page.sections.push(Section { heading, blocks: vec![Block::Note(note)], ..Section::default() });
                return Ok(());
            }
        };
        let judged = Judged::new(spec, &self.judge)?;
        let prediction = mesh::prediction(&input)?;
        let solved = mesh::solved(spec, &input.mesh, &curve, &prediction, &judged);
        let report = MeshReport { notes: mesh::notes(&input), ..solved };
        let chart = mesh::chart(&report);
        let blocks = without_verdict(report.blocks(), page, "the mesh");
        page.sections.push(Section { heading, charts: vec![chart], blocks, ..Section::default() });
        Ok(())
    }

    /// The parts of the tables.
    fn lot(&self, spec: &Spec, page: &mut Page, output: &mut Output) -> Result<Status, Failure> {
        if self.files.iter().any(|file| file == "-") {
            let message = "a report names its inputs and their hashes, and standard input has no name";
            return Err(Diagnostic::error(Code::Usage, message).help("give a file").into());
        }
        let interruption = long::interrupted(output);
        let spec = Arc::new(spec.clone());
        let files: Vec<&str> = self.files.iter().map(String::as_str).collect();
        let opener = Opener::new(&self.reading, &spec, self.judge.model, interruption.stop());
        let opener = Opener { teeth: self.teeth.then_some(true), ..opener };
        let mut found = interruption.while_waiting(|| opener.look(&files))?;
        if let Some(failed) = found.failed.pop() {
            return Err(failed.into());
        }
        let done = if found.first().is_some_and(|first| first.table.is_teeth) {
            self.toothed(&spec, &mut found, &interruption)?
        } else {
            self.parts(&mut found, &interruption)?
        };
        let Lot { mut outcome, basis, charts, small_charts } = done;
        outcome.notes.extend(spec.suspicions_in_words());
        outcome.notes.extend(outcome.duplicates.note());
        for problem in &outcome.problems {
            output.diagnostic(&Diagnostic::error(Code::BadRow, problem_text(problem)));
        }
        tables::say(&outcome.readings, &outcome.notes, output);
        let report = BatchReport::new(None, &basis, &outcome);
        let mut blocks = without_verdict(report.blocks(), page, "the batch");
        let unread = outcome.problems.iter().map(|problem| Block::Note(format!("not read: {}", problem_text(problem))));
        blocks.extend(unread);
        let heading = format!("Batch: {}", self.files.join(", "));
        page.sections.push(Section { heading, charts, small_charts, blocks, ..Section::default() });
        page.sections.push(reading_section(&outcome.readings, &outcome.notes));
        Ok(interruption.status().unwrap_or_else(|| batch::status(&outcome, &basis, false)))
    }

    /// Parts by the formulas.
    fn parts(&self, found: &mut Files<'_>, interruption: &Interruption) -> Result<Lot, Failure> {
        let Some(first) = found.first() else { return Err(no_table().into()) };
        let spec = Arc::new(with_known_teeth((*first.spec).clone(), &self.spec)?);
        let request = Request {
            model: self.judge.model,
            stack: self.judge.stack,
            rule: self.judge.decision.rule(&spec),
            monte_carlo: self.judge.decision.settings()?,
            rows: Rows::All,
            format: RowFormat::Columns,
            statistics: true,
            problems_kept: 10,
            partial: self.partial,
            ..Request::default()
        };
        let plan = Plan::new(&spec, &first.table, request)?;
        let notes = [first.notes.clone(), batch::notes(&spec, &plan)].concat();
        let mut run = RunChart::of(&plan);
        let sinks = Sinks { rows: Some(RowSink::Columns(&mut run)), rejects: None };
        let mut lot = Batch::new(&plan, sinks, None);
        for path in found.paths() {
            let opened = found.next(&path)?;
            let layout = Layout::new(&plan, &opened.table)?;
            let ran = lot.run(opened.table, &layout, interruption.stop(), &mut |_| {});
            if let Some(problem) = batch::unfinished(&path, ran)? {
                return Err(problem.into());
            }
        }
        let (mut outcome, written) = lot.finish();
        written?;
        outcome.notes.extend(notes);
        let (judged, small_charts) = histograms(&plan, &outcome);
        let charts = judged.into_iter().chain(run.chart(&plan)).collect();
        Ok(Lot { outcome, basis: Basis::of(&plan), charts, small_charts })
    }

    /// Parts with their teeth, by the exact mesh.
    fn toothed(&self, spec: &Arc<Spec>, found: &mut Files<'_>, interruption: &Interruption) -> Result<Lot, Failure> {
        const TOLERANCE_MM: f64 = 1e-6;
        let request = TeethRequest {
            stroke_mm: self.stroke.ends()?,
            tolerance_mm: TOLERANCE_MM,
            rows: Request {
                rule: self.judge.decision.rule(spec),
                statistics: true,
                problems_kept: 10,
                partial: self.partial,
                ..Request::default()
            },
        };
        let basis = batch::mesh_basis(spec, &request.rows.rule);
        let measured = spec_files::measured_tables(spec, &self.spec)?;
        let mut teeth = Teeth::new(spec, &measured, request, Sinks::default(), crate::parallel::cores())?;
        for path in found.paths() {
            let ran = teeth.take(found.next(&path)?.table)?;
            if let Some(problem) = batch::unfinished(&path, ran)? {
                return Err(problem.into());
            }
        }
        let (outcome, written) = teeth.finish(interruption.stop(), &mut |_| {});
        written?;
        Ok(Lot { outcome, basis, charts: Vec::new(), small_charts: Vec::new() })
    }

    fn assumptions(&self) -> Section {
        let JudgeArgs { stack, model, .. } = &self.judge;
        let notes = [
            format!("Formulas: the {model} model. Lengths and angles are exact decimals; a result is rounded once, and one that equals a limit is inside it."),
            format!("Verdicts judge the {stack}. The worst case is a bound: wherever on the teeth that their extents allow the errors are, the exact mesh of the same errors stays inside it."),
            "The statistical sum (RSS) is no bound: mean ± 3 standard deviations, errors independent, tolerances normal with 3 standard deviations.".to_owned(),
            "The exact mesh is free of backlash, of rigid teeth, minimised over the pinion's rotation; the curve is exact to 1e-6 mm between its points.".to_owned(),
        ];
        Section { heading: "Assumptions".to_owned(), blocks: notes.map(Block::Note).into(), ..Section::default() }
    }
}

fn problem_text(problem: &crate::batch::Problem) -> String {
    format!("{}: {}", problem.whereabouts(), problem.what())
}

/// What came of the parts of all tables.
struct Lot {
    outcome: Outcome,
    basis: Basis,
    charts: Vec<Chart>,
    small_charts: Vec<Chart>,
}

fn no_table() -> Diagnostic {
    Diagnostic::error(Code::BadTable, "there is no table that can be read")
}

/// The result that is judged: the names of its upper and its lower end.
fn judged_names(stack: Stack) -> (&'static str, &'static str) {
    match stack {
        Stack::Range => ("range_upper_mm", "range_lower_mm"),
        Stack::Rss => ("rss_upper_mm", "rss_lower_mm"),
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
        let counts = statistics.histogram(low, high, BINS);
        let edge = |bin: usize| low + (high - low) * bin as f64 / BINS as f64;
        let title = name.trim_end_matches("_mm").replace("delta_cd_", "ΔCD of ").replace('_', " ");
        let bars = counts.into_iter().enumerate().map(|(bin, count)| Bar {
            left: edge(bin),
            right: edge(bin + 1),
            low: 0.0,
            high: count as f64,
            text: String::new(),
        });
        let (width, height) = if is_error { (420.0, 300.0) } else { (800.0, 400.0) };
        let chart = Chart {
            title: format!("Histogram of {title}"),
            x: Axis { label: format!("{title} [mm]"), scale: Scale::Airy },
            y: Axis { label: "parts".to_owned(), scale: Scale::Whole },
            layers: vec![
                Layer::new("", Shape::Bars(bars.collect())),
                Layer::new("limits", Shape::LimitsOnX([limits.0, limits.1].into_iter().flatten().collect())),
            ],
            width,
            height,
        };
        if is_error {
            charts.push(chart);
        } else {
            judged = Some(chart);
        }
    }
    (judged, charts)
}

/// Takes the rows of a batch and keeps the lowest and highest result of each group of neighbours; groups grow with the
/// batch, so that memory does not.
#[derive(Debug, Default)]
struct RunChart {
    /// The columns of the lower and the upper end.
    ends: Option<(usize, usize)>,
    /// Parts per group.
    size: u64,
    /// In the last group.
    held: u64,
    groups: Vec<(f64, f64)>,
}

/// Groups at most: more than a picture shows.
const MOST_GROUPS: usize = 1024;

impl ColumnSink for RunChart {
    fn take(&mut self, rows: ResultColumns) -> io::Result<()> {
        let Some((lower, upper)) = self.ends else { return Ok(()) };
        let values = |column: usize| match &rows.columns[column] {
            ResultColumn { has_value, values: ResultValues::Numbers(values) } => {
                values.iter().zip(has_value).map(|(value, has_value)| has_value.then_some(*value)).collect()
            }
            _ => Vec::new(),
        };
        for (low, high) in values(lower).into_iter().zip(values(upper)) {
            if let (Some(low), Some(high)) = (low, high) {
                self.add(low, high);
            }
        }
        Ok(())
    }
}

impl RunChart {
    fn of(plan: &Plan) -> Self {
        let names = plan.column_names();
        let find = |name: &str| names.iter().position(|column| column == name);
        let ends = [("range_lower_mm", "range_upper_mm"), ("rss_lower_mm", "rss_upper_mm")];
        Self { ends: ends.iter().find_map(|(low, high)| Some((find(low)?, find(high)?))), ..Self::default() }
    }

    fn add(&mut self, low: f64, high: f64) {
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
        let at = |index: usize| (index as u64 * self.size + 1) as f64;
        let groups = self.groups.iter().enumerate();
        let spans: Vec<_> = groups.map(|(index, (low, high))| Span { x: at(index), low: *low, high: *high }).collect();
        let grouped = if self.size > 1 { format!("; each point holds {} parts", self.size) } else { String::new() };
        Some(Chart {
            title: format!("Run chart: ΔCD in the order of the rows{grouped}"),
            x: Axis { label: "part".to_owned(), scale: Scale::Whole },
            y: Axis { label: "ΔCD [mm]".to_owned(), scale: Scale::Airy },
            layers: vec![
                Layer::new("highest", Shape::Line(spans.iter().map(|span| (span.x, span.high)).collect())),
                Layer::new("lowest to highest", Shape::Band(spans)),
                Layer::new("limits", Shape::Limits(limits.collect())),
            ],
            ..Chart::default()
        })
    }
}

fn joined(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_chart_keeps_every_extreme_in_little_memory() {
        let mut run = RunChart::default();
        for part in 0..50_000 {
            run.add(-0.1, if part == 31_415 { 0.9 } else { 0.1 });
        }
        assert!(run.groups.len() <= MOST_GROUPS);
        assert_eq!(run.size, 64);
        let group = 31_415 / 64;
        assert_eq!(run.groups[group], (-0.1, 0.9));
        assert_eq!(run.groups.iter().filter(|group| group.1 > 0.5).count(), 1);
    }
}
