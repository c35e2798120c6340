//! Where results and messages go, and the exit status. Made once per run; every subcommand writes through it, and nothing else
//! prints.

use std::io::{self, IsTerminal as _, Write as _};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anstream::AutoStream;
use clap::ColorChoice;
use serde_json::Value;
use terminal_size::{Height, Width, terminal_size_of};

use super::held::{Answer, ColumnTable, Facts, Held, HeldSpec};
use super::line;
use super::target::named;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, harmless, harmless_lines, render, wrap};
use crate::evaluation::LimitCheck;
use crate::judge::Verdict;
use crate::report::chart::Chart;
use crate::report::{self, Format, Report, Screen, WithReading};
use crate::spec::Spec;
use crate::table::Reading;

/// The name of standard output in messages.
pub(super) const STDOUT: &str = "standard output";

/// The outcome of a command. Of several, the greatest counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Status {
    /// Inside the limits, or there was nothing to judge.
    Pass,
    /// The decision rule proves neither conformity nor non-conformity.
    Indeterminate,
    /// There is a result, but it could not be judged.
    Undecided,
    /// Outside the limits.
    Fail,
    /// A signal ended the run early, with the signal's exit code: the output is incomplete.
    Interrupted(u8),
}

impl Status {
    /// The outcome of a command that judged one part by these limits.
    pub(super) fn of(verdict: Option<Verdict>, limits: &[LimitCheck]) -> Self {
        match verdict {
            Some(verdict) => verdict.into(),
            None if limits.is_empty() => Self::Pass,
            None => Self::Undecided,
        }
    }

    /// The outcome with this exit status.
    pub(super) fn of_code(code: u8) -> Self {
        let known = [Self::Pass, Self::Fail, Self::Undecided, Self::Indeterminate];
        known.into_iter().find(|status| status.code() == code).unwrap_or(Self::Interrupted(code))
    }

    /// The exit status.
    pub(super) fn code(self) -> u8 {
        match self {
            Self::Pass => 0,
            Self::Fail => 1,
            Self::Undecided => 2,
            Self::Indeterminate => 3,
            Self::Interrupted(code) => code,
        }
    }
}

impl From<Verdict> for Status {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Pass => Self::Pass,
            Verdict::Fail => Self::Fail,
            Verdict::Indeterminate => Self::Indeterminate,
        }
    }
}

/// Why a command has no result.
#[derive(Debug)]
pub(super) enum Failure {
    /// Faults of the input.
    Diagnostics(Vec<Diagnostic>),
    /// A fault of the arguments.
    Usage(clap::Error),
    /// The output cannot be written.
    Write(io::Error),
}

impl Failure {
    /// Whether the reader of the output has closed it.
    pub(super) fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Write(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

impl From<Diagnostic> for Failure {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Diagnostics(vec![diagnostic])
    }
}

impl From<Diagnostics> for Failure {
    fn from(diagnostics: Diagnostics) -> Self {
        Self::Diagnostics(diagnostics.0)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

/// Whether the terminal states that it only prints text, like consoles inside editors.
pub(super) fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb")
}

/// The columns of a terminal; 80 if it does not tell its width.
fn width_of(is_terminal: bool, size: Option<(Width, Height)>) -> Option<u16> {
    is_terminal.then(|| size.map_or(80, |(width, _)| width.0))
}

fn width_of_stderr() -> Option<u16> {
    let stderr = io::stderr();
    width_of(stderr.is_terminal(), terminal_size_of(&stderr))
}

/// Standard output and standard error, each of which may be a screen.
pub(super) struct Output {
    stdout: io::Stdout,
    stderr: io::Stderr,
    screen: Screen,
    color_messages: bool,
    is_quiet: bool,
    /// How the tables that the spec names were read.
    readings: Vec<Reading>,
    /// Whether a limit of the spec is open, whatever else is judged.
    is_open: bool,
    kept: KeptErrors,
    /// The request of a program, in place of printing.
    held: Option<Held>,
}

/// Errors that pipelines show besides standard error.
#[derive(Default)]
struct KeptErrors {
    /// The errors so far, in words.
    texts: Vec<String>,
    /// Whether they are workflow commands of GitHub Actions, too.
    are_annotated: bool,
}

impl Output {
    pub(super) fn new(color: ColorChoice, is_quiet: bool, safe_csv: bool) -> Self {
        let choice = match color {
            ColorChoice::Auto => anstream::ColorChoice::Auto,
            ColorChoice::Always => anstream::ColorChoice::Always,
            ColorChoice::Never => anstream::ColorChoice::Never,
        };
        choice.write_global();
        let (stdout, stderr) = (io::stdout(), io::stderr());
        Self {
            screen: Screen {
                width: width_of(stdout.is_terminal(), terminal_size_of(&stdout)),
                color: AutoStream::choice(&stdout) != anstream::ColorChoice::Never,
                is_dumb: is_dumb(),
                is_quiet,
                safe_csv,
                shows_all_remarks: false,
            },
            color_messages: AutoStream::choice(&stderr) != anstream::ColorChoice::Never,
            is_quiet,
            stdout,
            stderr,
            readings: Vec::new(),
            is_open: false,
            kept: KeptErrors::default(),
            held: None,
        }
    }

    /// An output that keeps answers about specs, and prints nothing.
    pub(super) fn held(specs: impl IntoIterator<Item = (HeldSpec, Vec<String>)>, stop: Arc<AtomicBool>) -> Self {
        Self::holding(Held { specs: specs.into_iter().collect(), stop, ..Held::default() })
    }

    /// An output that keeps the facts about a spec that is read already.
    pub(super) fn of_facts(spec: Spec, facts: Facts, stop: Arc<AtomicBool>) -> Self {
        Self::holding(Held { read: Some(spec), facts, stop, ..Held::default() })
    }

    fn holding(held: Held) -> Self {
        Self {
            stdout: io::stdout(),
            stderr: io::stderr(),
            screen: Screen::default(),
            color_messages: false,
            is_quiet: true,
            readings: Vec::new(),
            is_open: false,
            kept: KeptErrors::default(),
            held: Some(held),
        }
    }

    /// The kept answer.
    pub(super) fn into_answer(self) -> Answer {
        self.held.unwrap_or_default().answer
    }

    /// Whether the result is wanted with what limits say of it.
    pub(super) fn needs_verdict(&self) -> bool {
        self.held.as_ref().is_none_or(|held| held.facts != Facts::Unjudged)
    }

    /// The flag that ends a long run from outside, where a program holds the answer.
    pub(super) fn stop(&self) -> Option<&Arc<AtomicBool>> {
        Some(&self.held.as_ref()?.stop)
    }

    /// Takes the picture of a result, where a program holds it.
    pub(super) fn picture(&mut self, chart: impl FnOnce() -> Chart) {
        if let Some(Held { answer, facts: Facts::WithText, .. }) = &mut self.held {
            answer.svg = chart().svg();
        }
    }

    /// Takes the facts and the rows of a result that is a table, where a program holds it.
    pub(super) fn facts(&mut self, facts: Value, table: impl FnOnce() -> ColumnTable) {
        if let Some(Held { answer, .. }) = &mut self.held {
            answer.json = report::document(facts);
            answer.table = Some(table());
        }
    }

    /// The next spec that a program holds, in place of a file, with its own settings.
    pub(super) fn held_spec(&mut self) -> Option<(HeldSpec, Vec<String>)> {
        self.held.as_mut()?.specs.pop_front()
    }

    /// The spec that a program has read, in place of a file.
    pub(super) fn read_spec(&mut self) -> Option<Spec> {
        self.held.as_mut()?.read.take()
    }

    /// Sets whether results come with every remark.
    pub(super) fn show_all_remarks(&mut self, all: bool) {
        self.screen.shows_all_remarks = all;
    }

    /// The screen of standard output.
    pub(super) fn screen(&self) -> Screen {
        self.screen
    }

    /// The screen that standard error is shown on.
    pub(super) fn screen_of_messages(&self) -> Screen {
        Screen { width: width_of_stderr(), ..self.screen.of_file() }
    }

    /// Keeps how a table of the spec was read; returns whether that is new.
    pub(super) fn keep_reading(&mut self, reading: &Reading) -> bool {
        let is_new = self.readings.iter().all(|known| known.file != reading.file);
        self.readings.extend(is_new.then(|| reading.clone()));
        is_new
    }

    /// How the tables that the spec names were read.
    pub(super) fn readings(&self) -> &[Reading] {
        &self.readings
    }

    /// Writes a report to standard output; in JSON with how the tables of the spec were read.
    pub(super) fn report(&mut self, report: &dyn Report, format: Format) -> Result<(), Failure> {
        let readings = self.readings.clone();
        let whole = WithReading { report, readings: &readings, notes: &[] };
        let is_whole = !readings.is_empty() && (format == Format::Json || self.held.is_some());
        let report: &dyn Report = if is_whole { &whole } else { report };
        if let Some(Held { answer, facts, .. }) = &mut self.held {
            let is_brief = matches!(facts, Facts::Brief | Facts::Unjudged);
            answer.json = report::document(if is_brief { report.brief() } else { report.json() });
            if *facts == Facts::WithText {
                answer.markdown = report::write(report, Format::Markdown, self.screen)?;
            }
            return Ok(());
        }
        let text = report::write(report, format, self.screen)?;
        unless_closed(self.write(&text))
    }

    /// Writes text to standard output; a closed pipe is no error.
    pub(super) fn text(&mut self, text: &str) -> Result<(), Failure> {
        unless_closed(self.piece(text))
    }

    /// Writes a piece of a long text to standard output; fails if the pipe is closed.
    pub(super) fn piece(&mut self, text: &str) -> Result<(), Failure> {
        self.write(&harmless_lines(text))
    }

    /// Writes text in which only the program's own colours control the terminal.
    fn write(&mut self, text: &str) -> Result<(), Failure> {
        if let Some(Held { answer, .. }) = &mut self.held {
            text.clone_into(&mut answer.markdown);
            return Ok(());
        }
        // a file leaves the line of a terminal as it is
        if self.stdout.is_terminal() {
            line::clear();
        }
        let mut stdout = self.stdout.lock();
        let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
        Ok(written.map_err(|error| named(STDOUT, &error))?)
    }

    /// Whether only warnings and errors are wanted on standard error.
    pub(super) fn is_quiet(&self) -> bool {
        self.is_quiet
    }

    /// Writes a remark on the result to standard error, so that standard output holds just the result.
    pub(super) fn remark(&mut self, text: &str) {
        if !self.is_quiet || self.held.is_some() {
            self.message(text);
        }
    }

    /// Writes a warning to standard error as one line, also with `--quiet`.
    pub(super) fn message(&mut self, text: &str) {
        if let Some(Held { answer, .. }) = &mut self.held {
            return answer.remarks.push(text.to_owned());
        }
        self.say(&wrap(&harmless(text), width_of_stderr()));
    }

    /// Writes lines that fit the screen, or are to be copied, to standard error as they are, also with `--quiet`.
    pub(super) fn lines(&mut self, text: &str) {
        if let Some(Held { answer, .. }) = &mut self.held {
            return answer.remarks.push(text.to_owned());
        }
        self.say(&harmless_lines(text));
    }

    /// Writes lines to standard error in which only the program's own colours control the terminal.
    fn say(&mut self, text: &str) {
        line::clear();
        // there is no place to report a failure of standard error itself
        let _ = writeln!(self.stderr.lock(), "{text}");
    }

    /// Shows a diagnostic on standard error.
    pub(super) fn diagnostic(&mut self, diagnostic: &Diagnostic) {
        if let Some(Held { answer, .. }) = &mut self.held {
            return answer.warnings.push(diagnostic.clone());
        }
        self.say(&render(diagnostic, self.color_messages, width_of_stderr()));
        self.keep_error(diagnostic);
    }

    /// Sets whether errors are workflow commands of GitHub Actions, too.
    pub(super) fn annotate(&mut self, annotates: bool) {
        self.kept.are_annotated = annotates;
    }

    /// The errors so far, in words.
    pub(super) fn errors(&self) -> String {
        self.kept.texts.join("\n")
    }

    /// Keeps an error for reports, and annotates it.
    fn keep_error(&mut self, diagnostic: &Diagnostic) {
        if diagnostic.severity == Severity::Error {
            self.kept.texts.push(diagnostic.to_string());
            if self.kept.are_annotated {
                self.message(&report::github_annotation(diagnostic));
            }
        }
    }

    /// Keeps an error of the arguments for reports, and annotates it.
    pub(super) fn keep_usage(&mut self, error: &clap::Error) {
        let text = error.render().to_string();
        let message = text.split("\n\n").next().unwrap_or_default();
        self.keep_error(&Diagnostic::usage(message.trim_start_matches("error: ")));
    }

    /// Says why a limit of the spec is open, and keeps that for the exit status.
    pub(super) fn leave_open(&mut self, why: &Diagnostic) {
        self.diagnostic(why);
        self.is_open = true;
    }

    /// The outcome of a command, with open limits counted.
    pub(super) fn ended(&self, status: Status) -> Status {
        if self.is_open { status.max(Status::Undecided) } else { status }
    }

    /// Shows why a command has no result, if it has none.
    pub(super) fn finish(&mut self, result: Result<Status, Failure>) -> Status {
        let status = result.unwrap_or_else(|failure| {
            match failure {
                // with a closed pipe nothing is printed, but the status is not success
                failure if failure.is_closed_pipe() => {}
                Failure::Diagnostics(diagnostics) => diagnostics.iter().for_each(|found| self.diagnostic(found)),
                Failure::Usage(error) => {
                    let _ = print_usage(&error);
                    self.keep_usage(&error);
                }
                Failure::Write(error) => {
                    self.diagnostic(&Diagnostic::error(Code::FileAccess, format!("cannot write {error}")));
                }
            }
            Status::Undecided
        });
        self.ended(status)
    }
}

/// Prints help, the version, or the error in the arguments, which may contain foreign file names.
pub(super) fn print_usage(error: &clap::Error) -> io::Result<()> {
    if error.use_stderr() {
        let text = wrap(&harmless_lines(&error.render().to_string()), width_of_stderr());
        write!(io::stderr().lock(), "{text}")
    } else {
        let text = wrap(
            &error.render().ansi().to_string(),
            width_of(io::stdout().is_terminal(), terminal_size_of(io::stdout())),
        );
        write!(anstream::stdout().lock(), "{text}")
    }
}

/// The result of writing, where a closed pipe is no error.
fn unless_closed(written: Result<(), Failure>) -> Result<(), Failure> {
    written.or_else(|failure| if failure.is_closed_pipe() { Ok(()) } else { Err(failure) })
}
