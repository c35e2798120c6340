//! `rackmesh paste`: measured values from the clipboard, a mail, a terminal.

use std::io::{BufRead as _, IsTerminal as _, Read as _};

use super::decision::DecisionArgs;
use super::eval::{ModelArg, StackArg};
use super::mesh;
use super::output::{Failure, Output, Status};
use crate::cmm::DecimalMark;
use crate::cmm::paste::{Field, Orientation, Pasted, PastedPart, Understood, Want, understand};
use crate::decision::{self, Evaluation, LimitTarget, Verdict};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::diagnostic::{Code, Diagnostic};
use crate::report::{
    EvaluationReport, Format, MeshReport, PartRow, PartsReport, SpacesReport, Together, UncertaintyPart,
};
use crate::spec::{MeasuredTables, Spec};

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
    /// A file with the block; standard input unless given.
    file: Option<String>,
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
            // empty lines before the block do not end it
            if count == 0 || (blank && !bytes.trim_ascii().is_empty()) {
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
    let mut written: Vec<(usize, ErrorKind)> =
        spec.errors.iter().map(|(kind, error)| (error.span.start, *kind)).collect();
    for (kind, nominal) in &spec.nominals {
        if written.iter().all(|(_, known)| known != kind) {
            written.push((nominal.span.start, *kind));
        }
    }
    written.sort_unstable();
    Want {
        expected: written.into_iter().map(|(_, kind)| kind).collect(),
        nominals: spec.nominals.iter().map(|(kind, nominal)| (*kind, nominal.value.clone())).collect(),
        module: spec.pair.normal_module.as_ref().map(|module| module.value.clone()),
        ..Want::default()
    }
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = super::read_spec(&self.spec)?;
        let text = read_block(self.file.as_deref(), output)?;
        let want = Want { fields: self.fields.clone(), decimal: self.decimal, orientation: self.parts, ..want(&spec) };
        let Understood { pasted, account } =
            understand(self.file.as_deref().filter(|file| *file != "-").unwrap_or("<block>"), &text, &want)?;
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

    fn evaluate(
        &self,
        spec: &Spec,
        errors: &[(ErrorKind, ErrorValue)],
    ) -> Result<(Evaluation, Option<UncertaintyPart>), Failure> {
        let spec = spec.with_errors(errors);
        let errors = spec.part_errors()?;
        let mut evaluation = decision::evaluate(&errors, &spec.limits(), self.model.into(), self.stack.into())
            .map_err(|failure| spec.explain_failure(&failure))?;
        let uncertainty = self.decision.judge(&spec, &errors, &mut evaluation)?;
        Ok((evaluation, uncertainty))
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
            output.diagnostic(&super::eval::unjudged(spec, target));
        }
        let status = rows.iter().map(|row| part_status(row.evaluation.as_ref())).max_by_key(|status| severity(*status));
        let helical = spec.rack.helix_angle.as_ref().is_some_and(|angle| !angle.value.is_zero());
        match rows.as_mut_slice() {
            [PartRow { evaluation: Some(evaluation), name, uncertainty, .. }] => {
                let title = parts[0].id.as_ref().map(|_| format!("part {name}"));
                let title = title.as_deref().or(spec.title.as_deref());
                let mut report = EvaluationReport::new(title, evaluation, helical);
                report.rule = self.decision.rule(spec);
                report.uncertainty = uncertainty.take();
                output.report(&report, self.format)?;
            }
            [_] => {}
            _ => output.report(&PartsReport { title: spec.title.as_deref(), rows: &rows }, self.format)?,
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
            output.report(&report, self.format)?;
            return Ok(status(by_formula));
        }
        let spec = spec.measured_only(is_rack);
        let mut all = mesh::measured_tables(&spec, &self.spec)?;
        if is_rack {
            all.rack = tables.rack;
        } else {
            all.pinion = tables.pinion;
        }
        let input = spec.mesh(&all)?;
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
        output.report(&Together { formula: &report, mesh: &solved }, self.format)?;
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
    match evaluation {
        Some(evaluation) if evaluation.verdict.is_none() && !evaluation.limits.is_empty() => Status::Undecided,
        Some(evaluation) => status(evaluation.verdict),
        None => Status::Undecided,
    }
}

/// A part that could not be judged counts most.
fn severity(status: Status) -> u8 {
    match status {
        Status::Pass => 0,
        Status::Indeterminate => 1,
        Status::Fail => 2,
        Status::Undecided => 3,
    }
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
