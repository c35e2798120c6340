//! A command's answer for a program: the facts that it would print, to the last digit. Bindings of other languages call it;
//! nothing is printed.

use std::ffi::OsString;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::held::{Answer, HeldSpec};
use super::output::{Failure, Output};
use super::tables;
use super::teeth::with_known_teeth;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::spec::Spec;

/// Asks a command about a spec: `eval`, `mesh`, `simulate`, `monte-carlo`, `budget` or `sweep`, with its options behind. Once
/// `stop` is set, a long run ends with what it has so far; no signal is taken over.
///
/// # Errors
/// What the command would say in place of a result.
///
/// # Example
/// ```
/// use rackmesh::cli::{HeldSpec, answer};
///
/// let spec = HeldSpec { name: "rack.toml".into(), text: "[errors]\nrack_over_roller = \"13 um\"".into() };
/// let answer = answer("eval", &["--model", "paper"], spec, &Default::default())?;
/// assert_eq!(answer.json["combined"]["range_mm"]["upper"], 0.013);
/// # Ok::<(), rackmesh::diagnostic::Diagnostics>(())
/// ```
pub fn answer(command: &str, options: &[&str], spec: HeldSpec, stop: &Arc<AtomicBool>) -> Result<Answer, Diagnostics> {
    const KNOWN: [&str; 6] = ["eval", "mesh", "simulate", "monte-carlo", "budget", "sweep"];
    if !KNOWN.contains(&command) {
        return Err(Diagnostic::usage(format!(
            "`{command}` is no command with an answer: these are {}",
            KNOWN.join(", ")
        ))
        .into());
    }
    answer_about(command, options, vec![(spec, Vec::new())], stop)
}

/// Compares specs, each with its settings (`errors.rack_pitch=12um`): what `compare` says of them, with its options behind.
///
/// # Errors
/// What the command would say in place of a result.
pub fn compare(
    options: &[&str],
    specs: Vec<(HeldSpec, Vec<String>)>,
    stop: &Arc<AtomicBool>,
) -> Result<Answer, Diagnostics> {
    answer_about("compare", options, specs, stop)
}

fn answer_about(
    command: &str,
    options: &[&str],
    specs: Vec<(HeldSpec, Vec<String>)>,
    stop: &Arc<AtomicBool>,
) -> Result<Answer, Diagnostics> {
    let names = specs.iter().map(|(spec, _)| spec.name.as_str());
    let arguments = ["rackmesh", command].into_iter().chain(names).chain(options.iter().copied());
    let matches = super::command().try_get_matches_from(arguments.map(OsString::from));
    let matches = matches.map_err(|error| Diagnostic::usage(error.to_string()))?;
    let mut output = Output::held(specs, Arc::clone(stop));
    let Some(called) = super::called(&matches, &mut output) else {
        return Err(Diagnostic::usage("there is no such command").into());
    };
    let status = output.ended(called.map_err(diagnostics)?);
    Ok(Answer { status: status.code(), ..output.into_answer() })
}

/// The spec with these settings (`errors.rack_pitch=12um`), with the effect of teeth that it gives one by one, as `batch` uses
/// it.
///
/// # Errors
/// What is wrong with the spec, its settings, or the tables that it names.
pub fn judged_spec(spec: &HeldSpec, settings: &[String]) -> Result<Spec, Diagnostics> {
    let read = Spec::parse_with(&spec.name, &spec.text, settings)?;
    let mut output = Output::held([(spec.clone(), Vec::new())], Arc::default());
    with_known_teeth(read, spec.name.as_ref(), &mut output).map_err(diagnostics)
}

fn diagnostics(failure: Failure) -> Diagnostics {
    Diagnostics(tables::diagnostics(failure))
}
