//! A command's answer for a program: what it would print, as facts. Called by bindings of other languages; nothing is
//! printed, and the answer is the command's to the last digit.

use std::ffi::OsString;

use serde_json::Value;

use super::output::{Failure, Output, Status};
use super::teeth::with_known_teeth;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::spec::Spec;

/// A spec that a program holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeldSpec {
    /// What messages call it, and what the tables that it names are beside.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// What a command says of a spec.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The result, as `--format json` writes it.
    pub json: Value,
    /// The result for people, in Markdown.
    pub markdown: String,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
    /// Remarks on the result.
    pub remarks: Vec<String>,
    /// The exit status: 0 to 3 as the command documents, or what belongs to the signal that ended it.
    pub status: u8,
}

/// What a command is asked, and what it said so far.
#[derive(Debug, Default)]
pub(super) struct Held {
    pub(super) spec: Option<HeldSpec>,
    pub(super) json: Value,
    pub(super) markdown: String,
    pub(super) warnings: Vec<Diagnostic>,
    pub(super) remarks: Vec<String>,
}

/// Asks a command about a spec: `eval`, `mesh`, `simulate`, `monte-carlo` or `budget`, with its options behind.
///
/// # Errors
/// What the command would say in place of a result.
///
/// # Example
/// ```
/// use rackmesh::cli::{HeldSpec, answer};
///
/// let spec = HeldSpec { name: "rack.toml".into(), text: "[errors]\nrack_over_roller = \"13 um\"".into() };
/// let answer = answer("eval", &["--model", "paper"], spec)?;
/// assert_eq!(answer.json["combined"]["worst_case_mm"]["upper"], 0.013);
/// # Ok::<(), rackmesh::diagnostic::Diagnostics>(())
/// ```
pub fn answer(command: &str, options: &[&str], spec: HeldSpec) -> Result<Answer, Diagnostics> {
    const KNOWN: [&str; 5] = ["eval", "mesh", "simulate", "monte-carlo", "budget"];
    if !KNOWN.contains(&command) {
        return Err(usage(format!("`{command}` is no command with an answer: these are {}", KNOWN.join(", "))));
    }
    let arguments = ["rackmesh", command, &spec.name].into_iter().chain(options.iter().copied());
    let matches = super::command().try_get_matches_from(arguments.map(OsString::from));
    let matches = matches.map_err(|error| usage(error.to_string()))?;
    let mut output = Output::held(spec);
    let Some(called) = super::called(&matches, &mut output) else {
        return Err(usage("there is no such command".to_owned()));
    };
    let status = called.map_err(diagnostics)?;
    let Held { json, markdown, warnings, remarks, .. } = output.into_held();
    Ok(Answer { json, markdown, warnings, remarks, status: Status::code(status) })
}

/// The spec with these settings (`errors.rack_pitch=12um`), and what its teeth do if it knows them one by one, as `batch`
/// judges parts by it.
///
/// # Errors
/// What is wrong with the spec, its settings, or the tables that it names.
pub fn judged_spec(spec: &HeldSpec, settings: &[String]) -> Result<Spec, Diagnostics> {
    let read = Spec::parse_with(&spec.name, &spec.text, settings)?;
    with_known_teeth(read, &spec.name).map_err(diagnostics)
}

fn usage(message: String) -> Diagnostics {
    Diagnostic::error(Code::Usage, message).into()
}

fn diagnostics(failure: Failure) -> Diagnostics {
    match failure {
        Failure::Diagnostics(diagnostics) => Diagnostics(diagnostics),
        Failure::Usage(error) => usage(error.to_string()),
        Failure::Write(error) => Diagnostic::error(Code::FileAccess, error.to_string()).into(),
    }
}
