//! `rackmesh paste`: measured values from the clipboard, a mail, a terminal.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::decision::JudgeArgs;
use super::output::{Failure, Output, Status};
use super::set::SetArgs;
use super::tables::{self, Opened, Opener, ReadArgs};
use super::target::{self, Target, is_dash};
use super::{batch, confirm, eval, mesh, office, page, signals, spec_files, teeth, terminal};
use crate::batch::{Duplicates, TeethJudge, refuse_without_uncertainty};
use crate::deviation::plausible::{DoubtedColumn, Reach};
use crate::deviation::{DeviationKind, DeviationValue, Part};
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluation::{Evaluation, Unjudged};
use crate::judge::bound::Basis;
use crate::judge::{LimitTarget, Verdict};
use crate::report::{
    self, EvaluationReport, Format, PartRow, PartsReport, Report, SpacesReport, UncertaintyPart, WithReading,
};
use crate::spec::Spec;
use crate::table::{Block, Fault, Gatherer, Reading, Table, Teeth, gather};

pub(super) const ABOUT: &str = "Evaluate pasted values: cells of a sheet, a CMM report, a mail";

#[derive(Debug, clap::Args)]
#[command(after_help = "Typed or pasted into a terminal, the block ends with Ctrl-D; blank lines belong to it.
How it was understood is said in one line; what could mean two things is refused.
--output writes .html, .xlsx, .dfq, .csv, .json, .md or .txt beside what is printed.

Examples:
  rackmesh paste examples/steering.toml examples/cmm-report.txt
  rackmesh paste rack.toml < values.txt
  rackmesh paste rack.toml --as rack_over_roller,rack_pitch
  rackmesh paste rack.toml --decimal comma --format csv < values.txt
  rackmesh paste examples/mesh.toml --mesh < spaces.txt

Exit status: 0 inside the limits or none given, 1 outside, 2 could not judge, 3 indeterminate by the
rule, 129, 130 or 143 interrupted.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// A file with the block, or any table that `rackmesh batch` reads; standard input unless given.
    file: Option<PathBuf>,
    /// The file to write; the ending of its name tells the format.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Add the exact mesh of the same parts, along a stroke of 50 mm.
    #[arg(long)]
    mesh: bool,
    #[command(flatten)]
    judge: JudgeArgs,
    /// Judge without errors that the spec asks for and the table lacks.
    #[arg(long)]
    partial: bool,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    reading: ReadArgs,
}

/// The largest block that is read from standard input: beyond what anybody pastes.
const LARGEST_BLOCK: u64 = 4 << 20;
/// Parts that are shown at most: `batch` is for more.
const MOST_PARTS: usize = 20_000;

/// What the name of the file that is written may end in.
const ENDINGS: [&str; 8] = ["html", "htm", "xlsx", "dfq", "csv", "json", "md", "txt"];

/// What is shown of a block.
struct Shown<'a> {
    /// What the part or the parts are called.
    title: &'a str,
    report: &'a dyn Report,
    /// The rows of a workbook or a Q-DAS file, header included: a part, a space or a tooth each.
    rows: Vec<Vec<String>>,
}

/// What was read, and what there is to say of it.
struct ReadBlock {
    spec: Arc<Spec>,
    reading: Reading,
    notes: Vec<String>,
    /// The file that is written, begun.
    target: Cell<Option<Target>>,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let (spec, target) = match self.begin(output) {
            Ok(begun) => begun,
            Err(failure) => {
                let status = output.finish(Err(failure));
                if self.path().is_none() {
                    terminal::discard_block(output);
                }
                return Ok(status);
            }
        };
        let opened = self.open(&spec, output);
        if let Some(status) = signals::signals(output).status() {
            output.message(signals::NOTHING_YET);
            return Ok(status);
        }
        let Opened { table, spec, notes } = opened?;
        let mut read = ReadBlock { spec, reading: table.reading.clone(), notes, target: Cell::new(target) };
        read.notes.extend(read.spec.suspicions_in_words());
        if table.is_teeth { self.teeth(read, table, output) } else { self.parts(read, table, output) }
    }

    /// The spec, and the file that is written, begun.
    fn begin(&self, output: &mut Output) -> Result<(Arc<Spec>, Option<Target>), Failure> {
        let spec = self.reading.laid_out(self.set.read_spec(&self.spec, output)?)?;
        super::function::leave_open(&spec, output);
        let target = self.output.as_ref().map(|path| {
            target::known_ending(path, path, &ENDINGS)?;
            Target::create(path, &self.inputs(&spec))
        });
        Ok((Arc::new(spec), target.transpose()?))
    }

    /// The file with the block; `None` where standard input has it.
    fn path(&self) -> Option<&Path> {
        self.file.as_deref().filter(|path| !is_dash(path))
    }

    /// What a part without a name of its own is called: the spec's title is of the pair, not of this part.
    fn block_name(&self) -> String {
        let file = self.path().and_then(Path::file_name);
        file.map_or_else(|| "pasted part".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// The files that are read.
    fn inputs(&self, spec: &Spec) -> Vec<PathBuf> {
        let block = self.file.clone().unwrap_or_else(|| "-".into());
        let files: Vec<PathBuf> = self.reading.layout_file().into_iter().cloned().chain([block]).collect();
        spec_files::inputs(spec, &self.spec, &files)
    }

    fn open(&self, spec: &Arc<Spec>, output: &mut Output) -> Result<Opened, Failure> {
        let interruption = signals::signals(output);
        let opener = Opener::new(&self.reading, spec, self.judge.model, interruption.stop());
        let mut rest = None;
        let (opener, opened, path) = if let Some(path) = self.path() {
            (opener.clone(), opener.open(path), path)
        } else {
            let bytes = terminal::read_block(output, LARGEST_BLOCK, &mut rest)?;
            let opened = opener.block(bytes.clone());
            (Opener { stdin: Some(bytes.into()), ..opener }, opened, Path::new("-"))
        };
        match opened {
            Err(failure) if confirm::can_ask() && !signals::signals(output).came() => {
                confirm::confirmed(&opener, (path, &self.spec), &mut rest, output)?.ok_or(failure)
            }
            opened => opened,
        }
    }

    /// Prints a report with how its table was read, and writes it to the file that was asked for.
    fn report(&self, shown: &Shown<'_>, read: &ReadBlock, output: &mut Output) -> Result<(), Failure> {
        let Shown { title, report, rows } = shown;
        let readings = std::slice::from_ref(&read.reading);
        let whole = WithReading { report: *report, readings, notes: &read.notes };
        if let Some((path, target)) = self.output.as_ref().zip(read.target.take()) {
            let text = |format| report::write(&whole, format, output.screen().of_file()).map(String::into_bytes);
            let bytes = match target::known_ending(path, path, &ENDINGS)? {
                Some("html" | "htm") => {
                    page::of_report(title, &read.spec, *report, readings, &read.notes, &self.inputs(&read.spec))?
                        .into_bytes()
                }
                Some("xlsx" | "dfq") => {
                    let notes = report::said(readings, &read.notes);
                    office::bytes(&target::shown(path), rows, (title, &read.spec.limits()), &notes)?
                }
                Some("csv") => text(Format::Csv)?,
                Some("json") => text(Format::Json)?,
                Some("md") => text(Format::Markdown)?,
                _ => text(Format::Table)?,
            };
            target.write_whole(&bytes)?;
        }
        if self.format == Format::Json {
            output.report(&whole, self.format)
        } else {
            output.report(*report, self.format)
        }
    }

    fn evaluate(
        &self,
        read: &ReadBlock,
        basis: &Basis,
        errors: &[(DeviationKind, DeviationValue)],
        is_alone: bool,
    ) -> Result<(Evaluation, Option<UncertaintyPart>), Failure> {
        let in_table: Vec<_> = errors.iter().map(|(kind, _)| *kind).collect();
        let of_every_part = read.spec.errors_of_every_part(&in_table)?;
        let all = errors.iter().copied().chain(of_every_part.iter().map(|error| (error.kind(), error.value())));
        let mut all: Vec<_> = all.collect();
        all.sort_by_key(|(kind, _)| *kind);
        let spec = read.spec.with_errors(&all);
        let deviations = spec.part_deviations()?;
        let (mut evaluation, uncertainty) = if is_alone {
            self.judge.judged(&spec, &deviations, basis)?
        } else {
            self.judge.judged_in_lot(&spec, &deviations, basis)?
        };
        if !self.partial && !read.spec.lacking(&in_table).is_empty() {
            evaluation.leave_open(LimitTarget::CenterDistance, Unjudged::Lacking);
        }
        let is_certain = |kind: &DeviationKind| !read.spec.is_uncertain(*kind);
        if !self.partial && self.judge.rule(&read.spec).needs_uncertainty() && in_table.iter().any(is_certain) {
            for on in read.spec.limits().into_iter().map(|(on, _)| on) {
                evaluation.leave_open(on, Unjudged::NoUncertainty);
            }
        }
        Ok((evaluation, uncertainty))
    }

    fn parts(&self, mut read: ReadBlock, table: Table, output: &mut Output) -> Result<Status, Failure> {
        if self.mesh {
            let message = "--mesh needs values of spaces or teeth; these are values of whole parts";
            return Err(Diagnostic::usage(message)
                .help("for a part's errors put on its teeth: rackmesh eval --mesh")
                .into());
        }
        let kinds: Vec<DeviationKind> = table.kinds().collect();
        if kinds.is_empty() {
            let message = format!("{} has no column of an error that is known", table.name);
            return Err(Diagnostic::error(Code::BadTable, message).help("`rackmesh read` shows how it is read").into());
        }
        read.spec = Arc::new(read.spec.for_columns(&kinds));
        if read.spec.uncertainties.is_empty() {
            let is_simulated = self.judge.settings()?.is_some();
            refuse_without_uncertainty(&self.judge.rule(&read.spec), is_simulated)?;
        }
        read.notes.extend(self.notes(&read.spec, &kinds));
        let mut rows = self.rows(&mut read, table, &kinds, output)?;
        let missing = read.spec.missing_geometry();
        if rows.len() > 1 {
            let bounds = rows.iter().filter_map(|row| row.evaluation.as_ref());
            let of_bounds = bounds.flat_map(|evaluation| report::bound_remarks(&evaluation.notes, &missing));
            report::add_new(&mut read.notes, of_bounds);
        }
        tables::say(std::slice::from_ref(&read.reading), &read.notes, output);
        if rows.is_empty() {
            let message = "there is no part in the block, so none was checked";
            output.diagnostic(&Diagnostic::warning(Code::BadTable, message));
            return Ok(Status::Undecided);
        }
        let lacks = |target: LimitTarget| matches!(target, LimitTarget::Error(kind) if !kinds.contains(&kind));
        for target in unjudged(&rows).into_iter().filter(|target| lacks(*target)) {
            output.diagnostic(&eval::unjudged(&read.spec, target));
        }
        let judged: Option<Vec<_>> = rows.iter().map(|row| row.evaluation.as_ref()).collect();
        // a part without values counts more than one that fails
        let status = judged.and_then(|parts| parts.iter().map(|part| Status::of(part.verdict, &part.limits)).max());
        let without = if self.partial { read.spec.lacking(&kinds) } else { Vec::new() };
        let of_all = PartsReport { title: read.spec.title.as_deref(), rows: &rows, without: &without };
        let cells = of_all.rows();
        if let [PartRow { evaluation, name, uncertainty, .. }] = rows.as_mut_slice() {
            if let Some(evaluation) = evaluation.take() {
                let is_named = read.reading.columns.iter().any(|column| column.role == "part_id");
                let title = if is_named { format!("part {name}") } else { self.block_name() };
                let mut report = EvaluationReport::new(Some(&title), evaluation, &missing);
                report.uncertainty = uncertainty.take();
                report.without.clone_from(&without);
                self.report(&Shown { title: &title, report: &report, rows: cells }, &read, output)?;
            }
        } else {
            let of_all = PartsReport { title: read.spec.title.as_deref(), rows: &rows, without: &without };
            let title = read.spec.title.clone().unwrap_or_else(|| self.block_name());
            self.report(&Shown { title: &title, report: &of_all, rows: cells }, &read, output)?;
        }
        Ok(status.unwrap_or(Status::Undecided))
    }

    /// What the block leaves to say: what it lacks, and what counts for every part.
    fn notes(&self, spec: &Spec, kinds: &[DeviationKind]) -> Vec<String> {
        let of_every: Vec<_> = spec.every_part.iter().copied().filter(|kind| !kinds.contains(kind)).collect();
        let lacking = batch::lacking("block lacks", spec, &spec.lacking(kinds), self.partial);
        let exact: Vec<_> = kinds.iter().copied().filter(|kind| !spec.is_uncertain(*kind)).collect();
        lacking
            .into_iter()
            .chain(batch::of_every_part(&of_every))
            .chain(spec.extents_in_words(&[kinds, &of_every].concat()))
            .chain(spec.circles_in_words(kinds))
            .chain(spec.note_of_exact(&exact, None))
            .collect()
    }

    /// Every part, evaluated; one whose values cannot be read has none.
    fn rows(
        &self,
        read: &mut ReadBlock,
        table: Table,
        kinds: &[DeviationKind],
        output: &mut Output,
    ) -> Result<Vec<PartRow>, Failure> {
        let name = Arc::clone(&table.name);
        let refuses_repeats = table.refuses_repeats;
        let titles: Vec<String> = table.columns.iter().map(|column| column.title.clone()).collect();
        read.spec.refuse_both_ways(kinds)?;
        read.spec = Arc::new(teeth::with_known_teeth((*read.spec).clone(), &self.spec, output)?);
        let basis = read.spec.basis()?;
        let usual = Reach::usual(read.spec.module());
        let mut doubted = vec![0; kinds.len()];
        let mut rows: Vec<PartRow> = Vec::new();
        let blocks = table.blocks().map_err(|error| Diagnostic::unreadable(&name, &error))?;
        let is_alone = blocks.iter().map(Block::rows).sum::<usize>() == 1;
        for block in blocks {
            if let Some(contradiction) = &block.contradiction {
                let message = format!("{name}, line {}: {}", contradiction.line, contradiction.message);
                return Err(Diagnostic::error(Code::BadTable, message).help(contradiction.help).into());
            }
            block.tell(&mut read.reading);
            for (column, doubted) in doubted.iter_mut().enumerate() {
                *doubted += usual.doubted(block.values(column));
            }
            for index in 0..block.rows() {
                if rows.len() == MOST_PARTS {
                    let message = format!("{name} has more than {MOST_PARTS} parts");
                    return Err(Diagnostic::error(Code::BadTable, message)
                        .help("`rackmesh batch` evaluates tables of any length")
                        .into());
                }
                let faults = block.faults().iter().filter(|fault| fault.row == index);
                let faults: Vec<_> = faults.map(|fault| unread_cell(&name, &titles, &block, fault)).collect();
                for fault in &faults {
                    output.diagnostic(fault);
                }
                let values = || errors_of(&read.spec, kinds, &block, index);
                let judged = faults.is_empty().then(|| self.evaluate(read, &basis, &values(), is_alone)).transpose()?;
                let (mut evaluation, uncertainty) = judged.unzip();
                if let Some(evaluation) = evaluation.as_mut().filter(|_| block.failed.contains(&index)) {
                    evaluation.verdict = Some(Verdict::Fail);
                }
                let part = block.name(index).filter(|name| !name.is_empty()).map(std::borrow::Cow::into_owned);
                rows.push(PartRow {
                    name: part.unwrap_or_else(|| (rows.len() + 1).to_string()),
                    line: usize::try_from(block.lines[index]).unwrap_or(usize::MAX),
                    evaluation,
                    uncertainty: uncertainty.flatten(),
                });
            }
        }
        tell_duplicates(&rows, refuses_repeats, &name, &mut read.reading)?;
        for ((kind, title), count) in kinds.iter().zip(&titles).zip(doubted).filter(|(_, count)| *count > 0) {
            let column = DoubtedColumn { usual, is_lead: *kind == DeviationKind::RackLead, count };
            read.reading.notes.push(format!("{name}: `{title}`: {column}"));
        }
        Ok(rows)
    }

    fn teeth(&self, mut read: ReadBlock, table: Table, output: &mut Output) -> Result<Status, Failure> {
        let name = Arc::clone(&table.name);
        let gatherer = Gatherer::new(&table)?;
        let blocks = table.blocks().map_err(|error| Diagnostic::unreadable(&name, &error))?;
        for block in &blocks {
            block.tell(&mut read.reading);
        }
        let mut parts = gather(gatherer, &blocks)?.into_iter();
        let (part, others) = (parts.next(), parts.next());
        let Some(part) = part else {
            return Err(Diagnostic::error(Code::BadTable, format!("{name} has no rows")).into());
        };
        if others.is_some() {
            let message = format!("{name} has teeth or spaces of several parts");
            return Err(Diagnostic::error(Code::BadTable, message)
                .help("`rackmesh batch --teeth` evaluates them")
                .into());
        }
        if let Some(fault) = part.fault {
            let message = format!("{name}, line {}: {}", fault.line, fault.message);
            return Err(Diagnostic::error(Code::BadRow, message).into());
        }
        if read.spec.has_other_deviations(part.teeth.part()) {
            read.notes.push("the table takes the place of the deviations in the spec".to_owned());
        }
        tables::say(std::slice::from_ref(&read.reading), &read.notes, output);
        self.spaces(read, part.teeth, output)
    }

    fn spaces(&self, mut read: ReadBlock, teeth: Teeth, output: &mut Output) -> Result<Status, Failure> {
        let spec = &Arc::clone(&read.spec);
        let measured = spec.measured(&teeth, self.judge.model)?;
        let title = self.block_name();
        let mut report = SpacesReport { title: Some(&title), measured: &measured, mesh: None };
        let missing = spec.missing_geometry();
        let rows = report.rows();
        if spec.limits.is_empty() && !self.mesh {
            self.report(&Shown { title: &title, report: &report, rows }, &read, output)?;
            return Ok(Status::Pass);
        }
        if !missing.is_empty() && !self.mesh {
            let unjudged = unjudged_teeth(&missing);
            read.notes.push(format!("no limit is judged: {}", unjudged.message));
            self.report(&Shown { title: &title, report: &report, rows }, &read, output)?;
            output.diagnostic(&unjudged);
            return Ok(Status::Undecided);
        }
        let judge = TeethJudge::new(spec, measured.part, self.judge.rule(spec), self.partial)?;
        let only = judge.measured_only();
        let all = spec_files::measured_tables(only, &self.spec, output)?.with(teeth);
        let input = only.mesh(&all)?;
        let judged = judge.judge(&input, &all)?;
        let covered = judged.strokes.clone();
        let curve = input.mesh.curve(covered.start, covered.end, mesh::TOLERANCE_MM)?;
        let mut solved = mesh::solved(spec, &input, curve, judged.evaluation)?;
        solved.screen = output.screen();
        solved.notes.extend(judge.notes().into_iter().chain(judged.notes));
        if measured.part == Part::Rack {
            solved.notes.push(format!(
                "the strokes whose contacts were measured are {:.3} to {:.3} mm: the others are not judged",
                covered.start, covered.end
            ));
        }
        let status = Status::of(solved.evaluation.verdict, &solved.evaluation.limits);
        report.mesh = Some(solved);
        self.report(&Shown { title: &title, report: &report, rows }, &read, output)?;
        Ok(status)
    }
}

/// Where a value cannot be read, and why.
fn unread_cell(name: &str, titles: &[String], block: &Block, fault: &Fault) -> Diagnostic {
    let column = fault.column.and_then(|column| titles.get(column));
    let place = column.map(|title| format!(", column `{title}`")).unwrap_or_default();
    let line = block.lines[fault.row];
    Diagnostic::error(Code::BadRow, format!("{name}, line {line}{place}: {}", fault.message))
}

/// Why measured teeth have no verdict.
fn unjudged_teeth(missing: &[&str]) -> Diagnostic {
    let missing = missing.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ");
    Diagnostic::warning(
        Code::UnjudgedLimit,
        format!("teeth are judged by their exact mesh, for which {missing} is missing"),
    )
    .help("what the formulas say of single teeth is no range of all together")
}

fn unjudged(rows: &[PartRow]) -> Vec<LimitTarget> {
    let mut targets = Vec::new();
    for target in rows.iter().filter_map(|row| row.evaluation.as_ref()).flat_map(Evaluation::not_given) {
        if !targets.contains(&target) {
            targets.push(target);
        }
    }
    targets
}

/// The errors of a part; a pitch of the pinion is on the reference circle.
fn errors_of(
    spec: &Spec,
    kinds: &[DeviationKind],
    block: &Block,
    index: usize,
) -> Vec<(DeviationKind, DeviationValue)> {
    let scaled = |kind, value| match (value, spec.pitch_circle) {
        (DeviationValue::Length(pitch), Some(circle)) if kind == DeviationKind::PinionPitch => {
            circle.scaled(pitch).into()
        }
        (value, _) => value,
    };
    kinds.iter().enumerate().map(|(column, kind)| (*kind, scaled(*kind, block.values(column).at(index)))).collect()
}

/// Says which parts have one name; a contract refuses them unless it says that a part may be there twice.
fn tell_duplicates(
    rows: &[PartRow],
    refuses_repeats: bool,
    name: &str,
    reading: &mut Reading,
) -> Result<(), Diagnostic> {
    let mut duplicates = Duplicates::default();
    duplicates.add(rows.iter().map(|row| row.name.as_bytes()));
    if let Some(twice) = duplicates.refusal().filter(|_| refuses_repeats) {
        return Err(Diagnostic::error(Code::BadTable, format!("{name}: {}", twice.message)).help(twice.help));
    }
    reading.notes.extend(duplicates.note().map(|note| format!("{name}: {note}")));
    Ok(())
}
