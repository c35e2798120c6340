//! The answer of a command about a design: the spec with the design's keys set, as if it stood in a file.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::parser::ValueSource;
use clap::{ArgMatches, ValueEnum as _};

use super::held::{Answer, Facts};
use super::output::{Failure, Output, Status};
use super::{called, command, tables};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};
use crate::spec::{SET, Spec};

/// The command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub(super) enum Of {
    #[default]
    Eval,
    Mesh,
    Simulate,
    Class,
    Budget,
}

impl Of {
    pub(super) fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}

/// A command about a spec.
pub(super) struct Question {
    matches: ArgMatches,
    source: Arc<Source>,
    /// The settings of every design.
    settings: Vec<String>,
    stop: Arc<AtomicBool>,
}

impl Question {
    /// The command with these options behind it, about the spec at `path`.
    pub(super) fn new(
        of: Of,
        options: &[String],
        (path, spec): (&Path, &Spec),
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        let name = of.name();
        let words = ["rackmesh".as_ref(), name.as_ref()].into_iter();
        let flag = (of == Of::Class).then(|| "--spec".as_ref());
        let words = words.chain(flag).chain([path.as_os_str()]).chain(options.iter().map(AsRef::as_ref));
        let matches = command().try_get_matches_from(words).map_err(Failure::Usage)?;
        let own = matches.subcommand().map(|(_, own)| own);
        let is_given = |id: &str| {
            own.is_some_and(|own| {
                own.try_contains_id(id).unwrap_or(false) && own.value_source(id) == Some(ValueSource::CommandLine)
            })
        };
        if let Some(id) = ["plot", "set", "format"].into_iter().find(|id| is_given(id)) {
            let message = format!("--{id} behind `--` is that of each design");
            return Err(Diagnostic::usage(message).help(format!("write --{id} before the `--`")).into());
        }
        Ok(Self { matches, source: Arc::clone(&spec.source), settings: spec.settings.clone(), stop: Arc::clone(stop) })
    }

    fn spec(&self, design: &[String]) -> Result<Spec, Diagnostics> {
        Spec::parse_with(&self.source.name, &self.source.text, &[&self.settings, design].concat())
    }

    /// Refuses a key that no spec has, whatever its value: `over` is how the option writes it, `design` one of its values.
    pub(super) fn refuse_unknown_key(&self, over: &str, design: &[String]) -> Result<(), Diagnostics> {
        let Err(Diagnostics(problems)) = self.spec(design) else { return Ok(()) };
        let is_of_key = |problem: &Diagnostic| matches!(problem.code, Code::UnknownKey | Code::Usage);
        let unknown: Vec<_> = problems.into_iter().filter(is_of_key).map(|problem| as_option(problem, over)).collect();
        if unknown.is_empty() { Ok(()) } else { Err(Diagnostics(unknown)) }
    }

    /// The command's answer about a design, or why there is none; `None` once the run is to stop.
    pub(super) fn answer(&self, design: &[String], facts: Facts) -> Option<Result<Answer, String>> {
        let answer = self.spec(design).map_err(|problems| problems.0).and_then(|spec| {
            let mut output = Output::of_facts(spec, facts, Arc::clone(&self.stop));
            let status =
                called(&self.matches, &mut output).unwrap_or(Ok(Status::Undecided)).map_err(tables::diagnostics)?;
            let status = output.ended(status).code();
            Ok(Answer { status, ..output.into_answer() })
        });
        // an answer begun before the stop is incomplete
        let is_whole = !self.stop.load(Ordering::Relaxed);
        is_whole.then(|| answer.map_err(|problems| in_words(&problems)))
    }
}

/// A problem of the last setting, reported for its option `--over`.
fn as_option(mut problem: Diagnostic, over: &str) -> Diagnostic {
    const OVER: &str = "--over ";
    if let Some(place) = &mut problem.place {
        let line = place.source.text.rfind('\n').map_or(0, |end| end + 1);
        let moved = |at: usize| (at + OVER.len()).saturating_sub(line + SET.len());
        place.span = moved(place.span.start)..moved(place.span.end);
        place.source = Arc::new(Source::new(place.source.name.clone(), format!("{OVER}{}", over.trim_start())));
    }
    if problem.code == Code::Usage {
        let help = "write --over KEY=VALUES with a key that --set does not set; `rackmesh explain keys` lists all keys. --over sets a key \
                    of an error that the spec has as a table, such as rack_pitch = { value = \"12um\", extent = \"each\" }";
        problem.help = Some(help.into());
    }
    problem
}

/// Problems in a line.
fn in_words(problems: &[Diagnostic]) -> String {
    let sentences: Vec<_> = problems.iter().map(|problem| problem.sentence().replace('\n', " ")).collect();
    sentences.join("; ")
}
