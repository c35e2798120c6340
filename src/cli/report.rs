//! `rackmesh report`: everything about a spec and its parts on one page.

use std::io::{Read as _, Write as _};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::decision::JudgeArgs;
use super::eval::evaluated;
use super::output::{Failure, Output, Status};
use super::page::{hashed, reading_section, spec_sections, without_verdict};
use super::set::SetArgs;
use super::signals::{self, Interruption};
use super::stream::{self, Stdin};
use super::tables::{self, Files, Opener, ReadArgs};
use super::target::{self, Target, is_dash, shown};
use super::teeth::{WorstTeeth, judged, mesh_of, with_known_teeth};
use super::{batch, mesh, spec_files};
use crate::batch::{Batch, Layout, Outcome, Plan, Request, RowFormat, RowSink, Rows, Sinks, Teeth, TeethRequest};
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::judge::{LimitTarget, Stack};
use crate::report::chart::Chart;
use crate::report::html::{Headline, InputFile, Page, Section};
use crate::report::{
    Basis, BatchReport, Block, EvaluationReport, Report as _, RunChart, error_histograms, judged_histogram,
};
use crate::spec::Spec;

pub(super) const ABOUT: &str = "Write one page: spec, ΔCD, mesh curve, parts, hashes of inputs";

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The page needs no network and no script. The batch, if tables are given, comes with a histogram and a run chart.

Examples:
  rackmesh report examples/steering.toml -o report.html
  rackmesh report rack.toml lot7.csv -o lot7.html
  rackmesh report rack.toml spaces.csv --teeth -o racks.html

Exit status: 0 all verdicts are pass or there are none, 1 a fail, 2 something could not be judged or\nread, 3 indeterminate, 129, 130 or 143 interrupted."
)]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// Tables: what `rackmesh batch` and `rackmesh paste` read; `-` reads standard input.
    files: Vec<PathBuf>,
    /// The file to write; the ending of its name tells the format.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
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
        spec_files::refuse_shared_input(&self.spec, &self.files)?;
        let spec = self.reading.laid_out(self.set.read_spec(&self.spec, output)?)?;
        let files: Vec<PathBuf> = self.reading.layout_file().into_iter().chain(&self.files).cloned().collect();
        let inputs = spec_files::inputs(&spec, &self.spec, &files);
        let target = self.output.as_ref().map(|path| {
            target::known_ending(path, path, &["html", "htm"])?;
            Target::create(path, &inputs)
        });
        let target = target.transpose()?;
        let mut page = Page { title: spec.title.clone().unwrap_or_else(|| shown(&self.spec)), ..Page::default() };
        for path in &inputs {
            // a file's own bytes have the mark and the line ends that it may have; of standard input it may be the spec, or
            // a table, which is read with the others
            if !is_dash(path) {
                page.inputs.push(hashed(path)?);
            } else if is_dash(&self.spec) {
                page.inputs.push(InputFile::of("-", spec.source.text.as_bytes())?);
            }
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
            let known = with_known_teeth(spec.clone(), &self.spec, output)?;
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
        if !output.readings().is_empty() {
            page.sections.push(reading_section(output.readings(), &[]));
        }
        page.sections.push(self.assumptions());
        page.sections.extend(spec_sections(&spec));
        let html = page.html();
        let status = statuses.into_iter().max().unwrap_or(Status::Pass);
        let Some(mut target) = target else {
            output.text(&html)?;
            return Ok(status);
        };
        let is_complete = !matches!(status, Status::Interrupted(_));
        target.write_all(html.as_bytes())?;
        target.end(is_complete, output)?;
        let decides = |headline: &&Headline| headline.verdict.map_or(Status::Undecided, Status::from) == status;
        if let Some(headline) = page.verdicts.iter().find(decides) {
            output.text(&format!("{headline}\n"))?;
        }
        Ok(status)
    }

    /// What standard input holds, if it is a table.
    fn stdin(&self, stop: &Arc<AtomicBool>) -> Result<Option<Arc<[u8]>>, Failure> {
        let Some(path) = self.files.iter().find(|path| is_dash(path)) else { return Ok(None) };
        let mut bytes = Vec::new();
        let read = Stdin::new(Arc::clone(stop)).read_to_end(&mut bytes);
        read.map_err(|error| Diagnostic::unreadable(&stream::name(path), &error))?;
        Ok(Some(bytes.into()))
    }

    /// The part of `[errors]`.
    fn evaluation(
        &self,
        spec: &Spec,
        worst: Option<&WorstTeeth>,
        page: &mut Page,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let report = EvaluationReport { title: None, ..evaluated(spec, &self.judge, worst, output)? };
        let status = Status::of(report.evaluation.verdict, &report.evaluation.limits);
        let blocks = without_verdict(report.blocks(), page, "this part");
        page.sections.push(Section::new("Deviations and ΔCD by formula", blocks));
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
        const HEADING: &str = "Exact mesh along the stroke";
        let unsolved = |why: String| Section::new(HEADING, vec![Block::Note(why)]);
        let tables = spec_files::measured_tables(spec, &self.spec, output)?;
        let mut input = match mesh_of(spec, &tables) {
            Ok(input) => input,
            Err(Diagnostics(problems)) if problems.iter().all(|problem| problem.code == Code::MissingKey) => {
                let missing: Vec<_> = problems.iter().map(|problem| problem.message.clone()).collect();
                page.sections.push(unsolved(format!("The mesh is not solved: {}.", missing.join("; "))));
                return Ok(());
            }
            Err(problems) => return Err(problems.into()),
        };
        if let Some(worst) = worst {
            worst.place(&mut input, spec.limit_on(LimitTarget::CenterDistance))?;
        }
        let curve = match input.mesh.curve(self.stroke.from.mm(), self.stroke.to.mm(), mesh::TOLERANCE_MM) {
            Ok(curve) => curve,
            Err(error) => {
                output.diagnostic(&Diagnostic::warning(Code::NoMesh, error.to_string()));
                page.sections.push(unsolved(format!("The mesh has no solution: {error}.")));
                return Ok(());
            }
        };
        let report = mesh::solved(spec, &input, curve, judged(spec, &self.judge)?)?;
        let blocks = without_verdict(report.blocks(), page, "the mesh");
        page.sections.push(Section { charts: vec![report.chart()], ..Section::new(HEADING, blocks) });
        Ok(())
    }

    /// The parts of the tables.
    fn lot(&self, spec: &Spec, page: &mut Page, output: &mut Output) -> Result<Status, Failure> {
        let waiting = signals::signals(output);
        let stdin = self.stdin(waiting.stop())?;
        if let Some(bytes) = &stdin {
            page.inputs.push(InputFile::of(&stream::name("-".as_ref()), &**bytes)?);
        }
        let spec = Arc::new(spec.clone());
        let opener = Opener::new(&self.reading, &spec, self.judge.model, waiting.stop());
        let opener = Opener { stdin, teeth: self.teeth.then_some(true), ..opener };
        let mut found = opener.look(&self.files)?;
        let interruption = signals::interrupted(output);
        if let Some(failed) = found.failed.pop() {
            return Err(failed.into());
        }
        let done = if found.first.as_ref().is_some_and(|first| first.table.is_teeth) {
            self.toothed(&spec, &mut found, &interruption, output)?
        } else {
            self.parts(&mut found, &interruption, output)?
        };
        let Lot { mut outcome, basis, charts, small_charts } = done;
        outcome.notes.extend(spec.suspicions_in_words());
        outcome.tell_duplicates();
        for problem in &outcome.problems {
            output.diagnostic(&Diagnostic::error(Code::BadRow, problem_text(problem)));
        }
        tables::say(&outcome.readings, &outcome.notes, output);
        let report = BatchReport::new(None, &basis, &outcome);
        let mut blocks = without_verdict(report.blocks(), page, "the batch");
        let unread = outcome.problems.iter().map(|problem| Block::Note(format!("not read: {}", problem_text(problem))));
        blocks.extend(unread);
        let heading =
            format!("Batch: {}", self.files.iter().map(|path| stream::name(path)).collect::<Vec<_>>().join(", "));
        page.sections.push(Section { charts, small_charts, ..Section::new(heading, blocks) });
        page.sections.push(reading_section(&outcome.readings, &outcome.notes));
        Ok(interruption.status().unwrap_or_else(|| batch::status(&outcome, &basis, false)))
    }

    /// What is asked of parts, whatever they are judged by.
    fn request(&self, spec: &Spec) -> Request {
        let rule = self.judge.rule(spec);
        Request { rule, statistics: true, problems_kept: 10, partial: self.partial, ..Request::default() }
    }

    /// Parts by the formulas.
    fn parts(&self, found: &mut Files<'_>, interruption: &Interruption, output: &mut Output) -> Result<Lot, Failure> {
        let no_table = || Diagnostic::error(Code::BadTable, "there is no table that can be read");
        let first = found.first.as_ref().ok_or_else(no_table)?;
        let request = Request {
            model: self.judge.model,
            stack: self.judge.stack,
            monte_carlo: self.judge.settings()?,
            rows: Rows::All,
            format: RowFormat::Columns,
            ..self.request(&first.spec)
        };
        Plan::refuse(&first.spec, &first.table, &request)?;
        let spec = Arc::new(with_known_teeth((*first.spec).clone(), &self.spec, output)?);
        let plan = Plan::new(&spec, &first.table, request)?;
        let notes = [first.notes.clone(), batch::notes(&spec, &plan)].concat();
        let mut run = RunChart::of(&plan);
        let sinks = Sinks { rows: Some(RowSink::Columns(&mut run)), ..Sinks::default() };
        let mut lot = Batch::new(&plan, sinks, None);
        for path in found.paths.clone() {
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
        let basis = Basis::of(&plan);
        let charts = judged_histogram(&outcome).into_iter().chain(run.chart(&basis.limits)).collect();
        let small_charts = error_histograms(&outcome);
        Ok(Lot { outcome, basis, charts, small_charts })
    }

    /// Parts with their teeth, by the exact mesh.
    fn toothed(
        &self,
        spec: &Arc<Spec>,
        found: &mut Files<'_>,
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<Lot, Failure> {
        let request =
            TeethRequest { stroke_mm: self.stroke.ends()?, tolerance_mm: mesh::TOLERANCE_MM, rows: self.request(spec) };
        let basis = batch::mesh_basis(spec, &request.rows.rule);
        let measured = spec_files::measured_tables(spec, &self.spec, output)?;
        let mut teeth = Teeth::new(spec, &measured, request, Sinks::default(), crate::parallel::cores())?;
        for path in found.paths.clone() {
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
        let judged = match stack {
            Stack::Range => "the worst case",
            Stack::Rss => "the statistical sum where tolerances scatter, and the worst case where nothing does",
        };
        let notes = [
            format!("Formulas: the {model} model. Lengths and angles are exact decimals; a result is rounded once, and one that equals a limit is inside it."),
            format!("Verdicts judge {judged}. The worst case is a bound: wherever on the teeth that their extents allow the errors are, the exact mesh of the same errors stays inside it."),
            "The statistical sum (RSS) is no bound: at one stroke, tolerances independent and normal with 3 standard deviations, what was measured with its bound.".to_owned(),
            "The exact mesh is free of backlash, of rigid teeth, minimised over the pinion's rotation; the curve is exact to 1e-6 mm between its points.".to_owned(),
        ];
        Section::new("Assumptions", notes.map(Block::Note).into())
    }
}

fn problem_text(problem: &crate::batch::Problem) -> String {
    format!("{}: {}", problem.place, problem.what())
}

/// What came of the parts of all tables.
struct Lot {
    outcome: Outcome,
    basis: Basis,
    charts: Vec<Chart>,
    small_charts: Vec<Chart>,
}
