//! `rackmesh paste`: measured values from the clipboard, a mail, a terminal.

use std::io::{BufRead as _, IsTerminal as _, Read as _};

use super::decision::DecisionArgs;
use super::eval::{self, ModelArg, StackArg};
use super::output::{Failure, Output, Status};
use super::{mesh, office};
use crate::cmm::DecimalMark;
use crate::cmm::paste::{Field, Orientation, Pasted, PastedPart, Understood, Want, understand};
use crate::decision::{Evaluation, LimitTarget, Verdict};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::diagnostic::{Code, Diagnostic};
use crate::report::{
    EvaluationReport, Format, MeshReport, PartRow, PartsReport, Report, SpacesReport, Together, UncertaintyPart,
};
use crate::spec::{BatchColumn, Located, MeasuredTables, Reading, Spec};

pub(super) const ABOUT: &str =
    "Evaluate a pasted block of measured values: cells of a spreadsheet, a CMM report, a mail";

#[derive(Debug, clap::Args)]
#[command(after_help = "Typed or pasted into a terminal, the block ends with an empty line or Ctrl-D.
How it was understood is said in one line before the results; what could mean two things is refused.

Examples:
  rackmesh paste examples/steering.toml examples/cmm-report.txt
  rackmesh paste rack.toml < values.txt
  rackmesh paste rack.toml --as rack_over_roller,rack_pitch
  rackmesh paste rack.toml --decimal comma --format csv < values.txt
  rackmesh paste examples/mesh.toml --mesh < spaces.txt

Exit status: 0 inside the limits or none given, 1 outside, 2 could not judge, 3 indeterminate by the rule.")]
pub(super) struct Args {
    /// The gear spec (TOML).
    spec: String,
    /// A file with the block, an Excel workbook (.xlsx) or a Q-DAS file (.dfq, .dfd with .dfx); standard input unless
    /// given.
    file: Option<String>,
    #[command(flatten)]
    place: office::Place,
    /// Write the results to this file as well: .xlsx, .dfq, .csv, .json, .md or .txt.
    #[arg(long, short, value_name = "FILE")]
    output: Option<String>,
    /// What the columns hold, in their order, if the block has no header or its names do not count.
    #[arg(long = "as", value_delimiter = ',', value_name = "NAME,…")]
    fields: Vec<Field>,
    /// Whether decimals stand behind a comma or a point.
    #[arg(long, value_enum, value_name = "MARK")]
    decimal: Option<DecimalMark>,
    /// Whether each part is a row or a column, for numbers without names.
    #[arg(long, value_enum, value_name = "WHERE")]
    parts: Option<Orientation>,
    /// Solve the exact mesh of measured spaces or teeth along a stroke of 50 mm.
    #[arg(long)]
    mesh: bool,
    /// The combination that the verdict judges.
    #[arg(long, value_enum, default_value_t)]
    stack: StackArg,
    /// Formulas exact for rigid teeth, or as the paper prints them.
    #[arg(long, value_enum, default_value_t)]
    model: ModelArg,
    #[command(flatten)]
    decision: DecisionArgs,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// The largest block that is read: beyond what anybody pastes.
const LARGEST_BLOCK: u64 = 4 << 20;

/// Reads the block: all of a pipe, or what is typed until an empty line.
fn read_block(file: Option<&str>, output: &mut Output) -> Result<String, Failure> {
    let stdin = std::io::stdin();
    let mut bytes = Vec::new();
    let name = file.unwrap_or("the block");
    let unreadable = |reason: String| Diagnostic::error(Code::FileAccess, format!("cannot read {name}: {reason}"));
    if let Some(path) = file.filter(|path| *path != "-") {
        let read = std::fs::File::open(path).and_then(|file| file.take(LARGEST_BLOCK + 1).read_to_end(&mut bytes));
        read.map_err(|error| unreadable(error.to_string()))?;
    } else if stdin.is_terminal() {
        output.remark("Paste the values, then an empty line (or Ctrl-D):");
        let mut lines = stdin.lock().take(LARGEST_BLOCK + 1);
        loop {
            let start = bytes.len();
            let count = lines.read_until(b'\n', &mut bytes).map_err(|error| unreadable(error.to_string()))?;
            let blank = bytes[start..].trim_ascii().is_empty();
            // a line without its end is the last: Ctrl-D came behind it; empty lines before the block do not end it
            if count == 0 || !bytes.ends_with(b"\n") || (blank && !bytes.trim_ascii().is_empty()) {
                break;
            }
        }
    } else {
        let read = stdin.lock().take(LARGEST_BLOCK + 1).read_to_end(&mut bytes);
        read.map_err(|error| unreadable(error.to_string()))?;
    }
    if bytes.len() as u64 > LARGEST_BLOCK {
        let diagnostic = unreadable("it is larger than 4 MiB".to_owned());
        return Err(diagnostic.help("`rackmesh batch` reads files of any size").into());
    }
    Ok(crate::cmm::decode(&bytes).into_owned())
}

/// What the spec expects of a block.
fn want(spec: &Spec) -> Want {
    let columns = spec.batch.columns.iter().map(|(kind, column)| (column.span.start, *kind));
    let errors = spec.errors.iter().map(|(kind, error)| (error.span.start, *kind));
    let nominals = spec.nominals.iter().map(|(kind, nominal)| (nominal.span.start, *kind));
    let mut expected: Vec<ErrorKind> = Vec::new();
    let unmeasured = spec.unmeasured.iter().map(|(kind, place)| (place.start, *kind));
    for written in [columns.collect::<Vec<_>>(), errors.chain(nominals).chain(unmeasured).collect()] {
        let mut written = written;
        written.sort_unstable();
        expected.extend(written.into_iter().map(|(_, kind)| kind));
    }
    let mut seen = Vec::new();
    expected.retain(|kind| {
        !seen.contains(kind) && {
            seen.push(*kind);
            true
        }
    });
    let measured = |kind: ErrorKind| match spec.reading(kind) {
        Ok(Reading::Measured(nominal)) => Some((kind, nominal)),
        // a nominal value that cannot be computed is asked for once the block has such a column
        Ok(Reading::Deviation) | Err(_) => None,
    };
    let unit = |(kind, column): &(ErrorKind, Located<BatchColumn>)| {
        column.value.unit.as_ref().map(|unit| (Field::Error(*kind), unit.value.to_owned()))
    };
    Want {
        expected,
        own: spec.column_names(),
        nominals: ErrorKind::ALL.into_iter().filter_map(measured).collect(),
        units: spec.batch.columns.iter().filter_map(unit).collect(),
        module: spec.pair.normal_module.as_ref().map(|module| module.value),
        ..Want::default()
    }
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let mut spec = super::read_spec(&self.spec)?;
        let office = match self.file.as_deref() {
            Some(path) => office::open(path, &spec, &self.place)?,
            None => None,
        };
        let mut decimal = self.decimal;
        let (name, text) = if let Some(office) = office {
            let (completed, notes) = office.completed(&spec, self.model.into());
            for note in notes {
                output.remark(&note);
            }
            spec = completed;
            let sheet = office.sheet(self.file.as_deref().unwrap_or_default())?;
            // numbers come out of such files with points
            decimal = Some(DecimalMark::Point);
            (sheet.name.clone(), sheet.tabbed())
        } else {
            let name = self.file.clone().filter(|file| file != "-").unwrap_or_else(|| "<block>".to_owned());
            (name, read_block(self.file.as_deref(), output)?)
        };
        let want = Want { fields: self.fields.clone(), decimal, orientation: self.parts, ..want(&spec) };
        let Understood { pasted, mut account } = understand(&name, &text, &want)?;
        account.file = (decimal.is_some() && self.decimal.is_none()).then_some(name);
        output.remark(&account.to_string());
        match pasted {
            Pasted::Parts(parts) => {
                if self.mesh {
                    let message = "--mesh needs values of spaces or teeth; these are values of whole parts";
                    return Err(Diagnostic::error(Code::Usage, message)
                        .help("for a part's errors put on its teeth: rackmesh eval --mesh")
                        .into());
                }
                self.parts(&spec, &parts, output)
            }
            Pasted::Rack(rack) => self.spaces(&spec, MeasuredTables { rack: Some(rack), pinion: None }, output),
            Pasted::Pinion(pinion) => self.spaces(&spec, MeasuredTables { rack: None, pinion: Some(pinion) }, output),
        }
    }

    /// Prints a report, and writes it to the file that was asked for.
    fn report(&self, report: &dyn Report, spec: &Spec, output: &mut Output) -> Result<(), Failure> {
        if let Some(path) = &self.output {
            office::write(path, report, spec)?;
        }
        output.report(report, self.format)
    }

    fn evaluate(
        &self,
        spec: &Spec,
        errors: &[(ErrorKind, ErrorValue)],
    ) -> Result<(Evaluation, Option<UncertaintyPart>), Failure> {
        eval::judged(&spec.with_errors(errors), &self.decision, self.model.into(), self.stack.into())
    }

    fn parts(&self, spec: &Spec, parts: &[PastedPart], output: &mut Output) -> Result<Status, Failure> {
        let pasted = |kind: ErrorKind| parts.iter().any(|part| part.errors.iter().any(|(known, _)| *known == kind));
        let absent: Vec<_> =
            spec.errors.iter().map(|(kind, _)| *kind).filter(|kind| !pasted(*kind)).map(ErrorKind::key).collect();
        if !absent.is_empty() {
            output.remark(&format!("not in the block, and not counted: {} of the spec's [errors]", absent.join(", ")));
        }
        let mut rows = Vec::with_capacity(parts.len());
        for (index, part) in parts.iter().enumerate() {
            for problem in &part.problems {
                output.diagnostic(problem);
            }
            let judged = if part.problems.is_empty() { Some(self.evaluate(spec, &part.errors)?) } else { None };
            let (evaluation, uncertainty) =
                judged.map_or((None, None), |(evaluation, known)| (Some(evaluation), known));
            let name = part.id.clone().unwrap_or_else(|| (index + 1).to_string());
            rows.push(PartRow { name, line: part.line, evaluation, uncertainty });
        }
        for target in unjudged(&rows) {
            output.diagnostic(&eval::unjudged(spec, target));
        }
        let status = rows.iter().map(|row| part_status(row.evaluation.as_ref())).max_by_key(|status| status.severity());
        let helical = spec.rack.helix_angle.as_ref().is_some_and(|angle| !angle.value.is_zero());
        match rows.as_mut_slice() {
            [PartRow { evaluation: Some(evaluation), name, uncertainty, .. }] => {
                let title = parts[0].id.as_ref().map(|_| format!("part {name}"));
                let title = title.as_deref().or(spec.title.as_deref());
                let mut report = EvaluationReport::new(title, evaluation, helical);
                report.rule = self.decision.rule(spec);
                report.uncertainty = uncertainty.take();
                self.report(&report, spec, output)?;
            }
            [_] => {}
            _ => self.report(&PartsReport { title: spec.title.as_deref(), rows: &rows }, spec, output)?,
        }
        Ok(status.unwrap_or(Status::Undecided))
    }

    fn spaces(&self, spec: &Spec, tables: MeasuredTables, output: &mut Output) -> Result<Status, Failure> {
        let is_rack = tables.rack.is_some();
        let measured = spec.measured(&tables, self.model.into())?;
        let limits = spec.limits();
        let limit = limits.iter().find(|(target, _)| *target == LimitTarget::CenterDistance).map(|(_, limit)| limit);
        let report = SpacesReport { title: spec.title.as_deref(), measured: &measured, limit };
        let by_formula = report.verdict();
        if !self.mesh {
            self.report(&report, spec, output)?;
            return Ok(status(by_formula));
        }
        let only = spec.measured_only(is_rack);
        let mut all = mesh::measured_tables(&only, &self.spec)?;
        if is_rack {
            all.rack = tables.rack;
        } else {
            all.pinion = tables.pinion;
        }
        let input = only.mesh(&all)?;
        let curve = input.mesh.curve(0.0, 50.0, 1e-6).map_err(|error| mesh::unsolved(&error))?;
        let prediction = mesh::prediction(&input);
        let solved = MeshReport {
            title: None,
            mesh: &input.mesh,
            curve: &curve,
            listed: &[],
            prediction: &prediction,
            limit,
            notes: mesh::notes(&input),
            screen: output.screen(),
        };
        let verdict = solved.verdict();
        self.report(&Together { formula: &report, mesh: &solved }, spec, output)?;
        Ok(status(verdict))
    }
}

fn status(verdict: Option<Verdict>) -> Status {
    match verdict {
        Some(Verdict::Fail) => Status::Fail,
        Some(Verdict::Indeterminate) => Status::Indeterminate,
        Some(Verdict::Pass) | None => Status::Pass,
    }
}

fn part_status(evaluation: Option<&Evaluation>) -> Status {
    evaluation.map_or(Status::Undecided, eval::status)
}

fn unjudged(rows: &[PartRow]) -> Vec<LimitTarget> {
    let mut targets = Vec::new();
    for target in rows.iter().filter_map(|row| row.evaluation.as_ref()).flat_map(Evaluation::unjudged) {
        if !targets.contains(&target) {
            targets.push(target);
        }
    }
    targets
}
