//! `rackmesh report`: everything about a spec or the parts of tables on one page.

mod kept;

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bytes::Bytes;
use kept::{Detail, Listed, Lot, Shown, details, measured_blocks};

use super::decision::JudgeArgs;
use super::eval::evaluated;
use super::output::{Failure, Output, Status};
use super::page::{hashed, reading_section, spec_sections};
use super::set::SetArgs;
use super::signals::{self, Interruption};
use super::stream;
use super::tables::{self, Files, Opener, ReadArgs};
use super::target::{self, Target, is_dash, shown};
use super::teeth::{WorstTeeth, mesh_of, with_known_teeth};
use super::{batch, function, mesh, monte_carlo, spec_files};
use crate::batch::{
    Batch, Layout, Part, PartSink, Plan, Request, RowFormat, RowSink, Rows, Sinks, Teeth, TeethRequest,
};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::evaluation::Evaluation;
use crate::judge::{LimitTarget, Stack};
use crate::mesh::TOLERANCE_MM;
use crate::report::html::{Headline, InputFile, Page, Section};
use crate::report::{
    Basis, BatchReport, Block, EvaluationReport, Histograms, MeshReport, Report as _, RunChart, YokeSection,
    contributions, counted, parts_blocks, yokes_block,
};
use crate::spec::{Spec, keys};

const BY_FORMULA: &str = "Deviations and ΔCD by formula";

pub(super) const ABOUT: &str = "Write one page: spec, ΔCD, mesh curve, parts, hashes of inputs";

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The page needs no network and no script. The batch, if tables are given, comes with a histogram and a run chart.

Examples:
  rackmesh report examples/steering.toml -o report.html
  rackmesh report rack.toml lot7.csv -o lot7.html --set report.inspector=Frey --all-parts
  rackmesh report rack.toml spaces.csv --teeth -o racks.html

Exit status: 0 all verdicts are pass or there are none, 1 a fail, 2 something could not be judged or\nread, 3 indeterminate, 129, 130 or 143 interrupted."
)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// Tables: what `rackmesh batch` and `rackmesh paste` read; `-` reads standard input.
    files: Vec<PathBuf>,
    /// The file to write; the ending of its name tells the format.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// List every part, and not the worst ten.
    #[arg(long)]
    all_parts: bool,
    /// One row per tooth or space: each part through the exact mesh.
    #[arg(long)]
    teeth: bool,
    #[command(flatten)]
    stroke: mesh::Stroke,
    /// Say which scatter makes which share of the spread: Sobol indices, by as many samples as racks.
    #[arg(long)]
    contributions: bool,
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
        if self.output.is_none() && output.screen().width.is_some() {
            return Err(Diagnostic::usage("a terminal does not show a page")
                .help("write it to a file: -o page.html")
                .into());
        }
        let spec = self.reading.laid_out(self.set.read_spec(&self.spec, output)?)?;
        let files: Vec<PathBuf> = self.reading.layout_file().into_iter().chain(&self.files).cloned().collect();
        let inputs = spec_files::inputs(&spec, &self.spec, &files);
        let target = self.output.as_ref().map(|path| {
            target::known_ending(path, path, &["html", "htm"])?;
            Target::create(path, &inputs)
        });
        let target = target.transpose()?;
        let mut page = Page::default();
        for path in &inputs {
            // the bytes of a file keep its byte order mark and line ends; standard input may be the spec, or a table that is read with the
            // others
            if !is_dash(path) {
                page.inputs.push(hashed(path)?);
            } else if is_dash(&self.spec) {
                page.inputs.push(InputFile::of("-", spec.source.text.as_bytes())?);
            }
        }
        let mut status = if self.files.is_empty() {
            self.of_spec(&spec, &mut page, output)?
        } else {
            self.of_tables(&spec, &mut page, output)?
        };
        if self.contributions {
            const HEADING: &str = "Where the spread of random racks comes from";
            let (strokes, interruption) = (self.stroke.ends(&spec)?, signals::interrupted(output));
            let found = monte_carlo::contributions_of((&spec, &self.spec), strokes, &interruption, output)?;
            let charts = vec![contributions::chart(&found, HEADING)];
            let blocks = [contributions::blocks(&found), contributions::inside(&found).into_iter().collect()].concat();
            page.sections.push(Section { charts, ..Section::new(HEADING, blocks) });
            status = status.max(interruption.status().unwrap_or(status));
        }
        if !output.readings().is_empty() {
            page.sections.push(reading_section(output.readings(), &[]));
        }
        page.sections.push(self.assumptions());
        page.sections.extend(spec_sections(&spec));
        page.lift_verdicts();
        let html = page.html();
        let Some(mut target) = target else {
            output.text(&html)?;
            return Ok(status);
        };
        let is_complete = !matches!(status, Status::Interrupted(_));
        target.write_all(html.as_bytes())?;
        target.end(is_complete, output)?;
        if let Some(headline) = page.verdicts.first() {
            output.text(&format!("{headline}\n"))?;
        }
        Ok(status)
    }

    /// The part of the spec itself.
    fn of_spec(&self, spec: &Spec, page: &mut Page, output: &mut Output) -> Result<Status, Failure> {
        page.title = spec.title.clone().unwrap_or_else(|| shown(&self.spec));
        page.facts = details(spec, &[], false);
        if self.contributions && spec.errors.is_empty() && !spec.has_deviations() {
            if spec.limits.is_empty() && spec.function_limits.is_empty() {
                return Ok(Status::Pass);
            }
            let why = "no limit is judged here: `rackmesh monte-carlo` counts the random racks inside the limits";
            page.verdicts.push(Headline { verdict: None, sentence: why.to_owned() });
            return Ok(Status::Undecided);
        }
        let known = with_known_teeth(spec.clone(), &self.spec, output)?;
        let worst = WorstTeeth::of(known.part_errors_or_none()?, &known.basis()?)?;
        let report = EvaluationReport { title: None, ..evaluated(&known, &self.judge, worst.as_ref(), output)? };
        let status = Status::of(report.evaluation.verdict, &report.evaluation.limits);
        let mut blocks = report.blocks();
        if worst.is_some() && spec.has_yoke() {
            // the mesh below shows one placement
            let tables = spec_files::measured_tables(&known, &self.spec, output)?;
            let yoke = function::evaluated(&known, &tables, &report.evaluation, worst.as_ref())?;
            let bounded = yoke.iter().filter(|yoke| yoke.known().is_none()).flat_map(YokeSection::blocks);
            blocks.extend(bounded.filter(|block| !matches!(block, Block::Verdict(..))));
        }
        page.sections.push(Section::new(BY_FORMULA, blocks));
        if !spec.errors.is_empty() || spec.has_deviations() {
            let (section, of_yoke) = self.mesh(&known, report.evaluation, worst.as_ref(), output)?;
            page.sections.push(section);
            return Ok(status.max(of_yoke));
        }
        function::leave_open(spec, output);
        Ok(status)
    }

    /// The content of standard input, if it is a table.
    fn stdin(&self, stop: &Arc<AtomicBool>) -> Result<Option<Bytes>, Failure> {
        self.files.iter().any(is_dash).then(|| stream::whole(stop)).transpose()
    }

    /// The errors of one part of a table in detail; the verdict on it is the table's.
    fn part(&self, plan: &Plan, part: &Part, page: &mut Page, output: &mut Output) -> Result<(), Failure> {
        let (spec, evaluation, uncertainty) = self.judge.of_part(plan, part, output)?;
        let report = EvaluationReport::new(None, evaluation, &spec.missing_geometry());
        let report = EvaluationReport { uncertainty, ..report };
        let by_status = report.evaluation.rejection().map(|why| format!("{why}, not by ΔCD"));
        let blocks = report.blocks().into_iter().chain(by_status.map(Block::Remark)).collect();
        let by_formula = Section::new(BY_FORMULA, blocks);
        let worst = WorstTeeth::of(spec.part_errors_or_none()?, &spec.basis()?)?;
        for mut section in [by_formula, self.mesh(&spec, report.evaluation, worst.as_ref(), output)?.0] {
            section.heading = format!("{}: part {}", section.heading, part.id);
            section.blocks.retain(|block| !matches!(block, Block::Verdict(..)));
            page.sections.push(section);
        }
        Ok(())
    }

    /// The exact mesh, if the spec has the geometry, beside the judged errors, and the outcome of the limits on a yoke.
    fn mesh(
        &self,
        spec: &Spec,
        judged: Evaluation,
        worst: Option<&WorstTeeth>,
        output: &mut Output,
    ) -> Result<(Section, Status), Failure> {
        const HEADING: &str = "Exact mesh along the stroke";
        let of_yoke = if spec.function_limits.is_empty() { Status::Pass } else { Status::Undecided };
        let unsolved = |why: String| {
            let open = (of_yoke == Status::Undecided)
                .then(|| Block::Verdict(None, format!("the limits on the yoke are not judged: {why}")));
            Ok((Section::new(HEADING, [Block::Note(why)].into_iter().chain(open).collect()), of_yoke))
        };
        let tables = spec_files::measured_tables(spec, &self.spec, output)?;
        let mut input = match mesh_of(spec, &tables) {
            Ok(input) => input,
            Err(Diagnostics(problems)) if problems.iter().all(|problem| problem.code == Code::MissingKey) => {
                let missing = spec.missing_geometry().into_iter().map(|key| format!("`{key}`")).collect::<Vec<_>>();
                return unsolved(format!("The mesh is not solved: it needs {}.", missing.join(", ")));
            }
            Err(problems) => return Err(problems.into()),
        };
        if let Some(worst) = worst {
            worst.place(&mut input, spec.limit_on(LimitTarget::CenterDistance))?;
        }
        let (from, to) = self.stroke.ends(spec)?;
        let curve = match input.mesh.curve(from, to, TOLERANCE_MM) {
            Ok(curve) => curve,
            Err(error) => {
                output.diagnostic(&Diagnostic::warning(Code::NoMesh, error.to_string()));
                return unsolved(format!("The mesh has no solution: {error}."));
            }
        };
        let function = function::part(spec, &input, &curve, self.stroke.travel(spec)?, &judged)?;
        let yoke = function.map(|part| YokeSection::Known(Box::new(part)));
        // its verdicts are the page's already
        let judged = Evaluation { limits: Vec::new(), ..judged };
        let report = MeshReport { yoke, ..mesh::solved(spec, &input, curve, judged)? };
        let section = Section::new(HEADING, report.blocks());
        let section = match report.level() {
            Some(level) => Section { blocks: [vec![Block::Note(level)], section.blocks].concat(), ..section },
            None => Section { charts: vec![report.chart()], ..section },
        };
        let Some(part) = report.function() else { return Ok((section, of_yoke)) };
        let charts = section.charts.into_iter().chain(part.charts(&report.curve.points)).collect();
        Ok((Section { charts, ..section }, function::status(&part.checks)))
    }

    /// The parts of the tables.
    fn of_tables(&self, spec: &Spec, page: &mut Page, output: &mut Output) -> Result<Status, Failure> {
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
        let Lot { spec, plan, mut outcome, basis, parts, charts, small_charts, level, facts } = done;
        outcome.notes.extend(spec.suspicions_in_words());
        outcome.tell_duplicates();
        for problem in &outcome.problems {
            output.diagnostic(&Diagnostic::error(Code::BadRow, problem_text(problem)));
        }
        tables::say(&outcome.readings, &outcome.notes, output);
        let names = self.files.iter().map(|path| stream::name(path)).collect::<Vec<_>>().join(", ");
        let report = BatchReport::new(None, &basis, &outcome);
        let path = shown(&self.spec);
        let titled = spec.title.as_ref().map_or_else(|| path.clone(), |title| format!("{title} ({path})"));
        page.facts = facts;
        page.facts.extend([("table".to_owned(), names.clone()), ("spec".to_owned(), titled)]);
        let unread = outcome.problems.iter().map(|problem| Block::Note(format!("not read: {}", problem_text(problem))));
        let detailed = outcome.worst.first().filter(|part| !part.errors.is_empty() && !interruption.came());
        if let ([part], 1) = (outcome.worst.as_slice(), outcome.counts.rows) {
            let named = page.facts.iter().find(|(key, _)| key == keys::REPORT_PART.any.name());
            page.title = format!("Part {}", named.map_or(&part.id, |(_, part)| part));
            let blocks = measured_blocks(part).into_iter().chain([report.verdict()]).collect();
            page.sections.push(Section::new("Measured values", blocks));
        } else {
            page.title = format!("{}: {names}", counted(outcome.counts.parts(), "part"));
            let (heading, listed) = match (parts.len(), outcome.worst.len()) {
                (1.., _) => ("All parts".to_owned(), &parts),
                (_, 0) => ("Parts".to_owned(), &parts),
                (_, worst) => (format!("The worst {worst} parts"), &outcome.worst),
            };
            let blocks = parts_blocks(listed, "part").into_iter().chain(yokes_block(listed, "yoke of part"));
            let blocks = blocks.chain([report.counts_table(), report.verdict()]).chain(unread);
            page.sections.push(Section::new(heading, blocks.collect()));
            let level = level.into_iter().map(Block::Note);
            let blocks = level.chain(report.spread()).collect();
            page.sections.push(Section { charts, small_charts, ..Section::new("How the parts are spread", blocks) });
        }
        if let Some((plan, part)) = plan.as_ref().zip(detailed) {
            self.part(plan, part, page, output)?;
        }
        page.sections.push(reading_section(&outcome.readings, &outcome.notes));
        Ok(interruption.status().unwrap_or_else(|| batch::status(&outcome, &basis, false)))
    }

    /// The request for parts, by formulas or by the mesh.
    fn request(&self, spec: &Spec) -> Request {
        let rule = self.judge.rule(spec);
        let (partial, lists_parts) = (self.partial, self.all_parts);
        Request { rule, statistics: true, problems_kept: 10, partial, lists_parts, ..Request::default() }
    }

    /// Parts by the formulas.
    fn parts(&self, found: &mut Files<'_>, interruption: &Interruption, output: &mut Output) -> Result<Lot, Failure> {
        let no_table = || Diagnostic::error(Code::BadTable, "there is no table that can be read");
        let first = found.first.as_ref().ok_or_else(no_table)?;
        let request = Request {
            model: self.judge.model,
            stack: self.judge.stack,
            monte_carlo: self.judge.settings()?,
            rows: Rows::Every,
            format: RowFormat::Columns,
            copied: first.spec.table.layout.details.iter().map(|(_, heading)| heading.clone()).collect(),
            ..self.request(&first.spec)
        };
        Plan::refuse(&first.spec, &first.table, &request)?;
        let spec = Arc::new(with_known_teeth((*first.spec).clone(), &self.spec, output)?);
        let plan = Plan::new(&spec, &first.table, request)?;
        let mut notes = [first.notes.clone(), batch::notes(&spec, &plan)].concat();
        notes.extend(batch::without_names(&plan));
        let mut shown = Shown { run: RunChart::of(&plan), details: Detail::of(&plan, &first.spec) };
        let mut parts = Listed::default();
        let sinks = Sinks {
            rows: Some(RowSink::Columns(&mut shown)),
            parts: self.all_parts.then_some(&mut parts as &mut dyn PartSink),
            ..Sinks::default()
        };
        let mut lot = Batch::new(&plan, sinks, None);
        let mut bar = batch::Bar::new(&found.paths, "rows", output);
        for path in found.paths.clone() {
            let opened = found.next(&path)?;
            let layout = Layout::new(&plan, &opened.table)?;
            let ran = lot.run(opened.table, &layout, interruption.stop(), &mut |progress| bar.show(progress));
            bar.next();
            if let Some(problem) = batch::unfinished(&path, ran)? {
                return Err(problem.into());
            }
        }
        bar.finish();
        let (mut outcome, written) = lot.finish();
        written?;
        outcome.notes.extend(notes);
        let basis = Basis::of(&plan);
        let Histograms { judged, errors, level } = Histograms::of(&outcome);
        let charts = judged.into_iter().chain(shown.run.chart(&basis.limits)).collect();
        let facts = details(&spec, &shown.details, plan.has_id);
        let plan = Some(plan);
        Ok(Lot { spec, plan, outcome, basis, parts: parts.0, charts, small_charts: errors, level, facts })
    }

    /// Parts with their teeth, by the exact mesh.
    fn toothed(
        &self,
        spec: &Arc<Spec>,
        found: &mut Files<'_>,
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<Lot, Failure> {
        let request = TeethRequest {
            stroke_mm: self.stroke.ends(spec)?,
            tolerance_mm: TOLERANCE_MM,
            travel_mm: self.stroke.travel(spec)?,
            rows: self.request(spec),
        };
        let basis = Basis::of_teeth(spec, &request.rows.rule);
        let has_names = found.first.as_ref().is_some_and(|first| first.table.has_id);
        let measured = spec_files::measured_tables(spec, &self.spec, output)?;
        let mut parts = Listed::default();
        let sinks = Sinks { parts: self.all_parts.then_some(&mut parts as &mut dyn PartSink), ..Sinks::default() };
        let mut teeth = Teeth::new(spec, &measured, request, sinks, crate::parallel::cores())?;
        let mut bar = batch::Bar::new(&found.paths, "parts", output);
        for path in found.paths.clone() {
            let ran = teeth.take(found.next(&path)?.table)?;
            bar.next();
            if let Some(problem) = batch::unfinished(&path, ran)? {
                return Err(problem.into());
            }
        }
        let (outcome, written) = teeth.finish(interruption.stop(), &mut |progress| bar.show(progress));
        bar.finish();
        written?;
        let facts = details(spec, &Detail::of_teeth(spec, &outcome.readings), has_names);
        let Histograms { judged, level, .. } = Histograms::of(&outcome);
        Ok(Lot {
            spec: Arc::clone(spec),
            plan: None,
            outcome,
            basis,
            parts: parts.0,
            charts: judged.into_iter().collect(),
            small_charts: Vec::new(),
            level,
            facts,
        })
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
