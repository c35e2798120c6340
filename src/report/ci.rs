//! A batch for pipelines: a JUnit report, and annotations of GitHub Actions.

use std::fmt::Write as _;
use std::io::{self, Read, Seek, Write};
use std::time::Instant;

use super::basis::Basis;
use super::escape;
use super::number::{ends, grouped};
use super::reading::said;
use crate::batch::{Outcome, Part, PartSink, Problem, RowPlace};
use crate::diagnostic::Diagnostic;
use crate::judge::Verdict;

/// Annotations that a page shows of one step.
pub const ANNOTATIONS_SHOWN: usize = 10;

/// Why a part does not pass, with its result.
fn sentence(part: &Part) -> String {
    let why = part.reason.clone().unwrap_or_default();
    let (lower, upper) = part.result_mm;
    let result = if lower.is_finite() && upper.is_finite() { ends(lower, upper) } else { return why };
    format!("{why}: {result} mm")
}

/// A JUnit report: a test case for each part and for each rejected row, written one by one, so that memory does not depend on
/// their number. A reason why the run does not cover all parts is a test case with an error. File and line stand in the class
/// name and the text: pipelines that check the form (Jenkins, xUnit plugin) refuse attributes for them.
pub struct Junit<F> {
    /// The test cases so far.
    cases: F,
    /// The name of the report where the test cases cannot be kept.
    name: String,
    counts: CaseCounts,
    begun: Instant,
    /// The time of the last cases.
    last: Instant,
}

/// How many test cases there are, and how many of each kind do not pass.
#[derive(Debug, Clone, Copy, Default)]
struct CaseCounts {
    tests: u64,
    failures: u64,
    errors: u64,
    skipped: u64,
}

impl CaseCounts {
    fn add(&mut self, tag: Option<&str>) {
        self.tests += 1;
        match tag {
            Some("failure") => self.failures += 1,
            Some("error") => self.errors += 1,
            Some(_) => self.skipped += 1,
            None => {}
        }
    }

    /// The start of a report that took so many seconds.
    fn begun(&self, name: &str, seconds: f64) -> String {
        let (name, Self { tests, failures, errors, skipped }) = (escaped(name), self);
        let counts = format!("tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\"");
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <testsuites name=\"rackmesh\" {counts} time=\"{seconds:.3}\">\n\
             <testsuite name=\"{name}\" {counts} skipped=\"{skipped}\" time=\"{seconds:.3}\">\n"
        )
    }
}

impl<F: Write + Send> PartSink for Junit<F> {
    fn take(&mut self, parts: &[Part], problems: &[Problem]) -> io::Result<()> {
        let all = parts.len() + problems.len();
        let seconds = self.last.elapsed().as_secs_f64() / all.max(1) as f64;
        self.last = Instant::now();
        let mut xml = String::new();
        for case in parts.iter().map(of_part).chain(problems.iter().map(of_problem)) {
            self.counts.add(case.tag);
            xml += &case.xml(seconds);
        }
        self.cases.write_all(xml.as_bytes()).map_err(|error| self.named(&error))
    }
}

impl<F> Junit<F> {
    fn named(&self, error: &io::Error) -> io::Error {
        io::Error::new(error.kind(), format!("{}: {error}", self.name))
    }
}

impl<F: Read + Write + Seek> Junit<F> {
    /// A report of this name whose test cases wait in this place, which is empty.
    pub fn new(name: String, cases: F) -> Self {
        Self { cases, name, counts: CaseCounts::default(), begun: Instant::now(), last: Instant::now() }
    }

    /// Writes the report of a run with this outcome; `failed` says why tables were not read to their end.
    ///
    /// # Errors
    /// If it cannot be written, or the test cases cannot be read back.
    pub fn write(
        mut self,
        out: &mut dyn Write,
        title: Option<&str>,
        basis: &Basis,
        outcome: &Outcome,
        failed: &[Diagnostic],
    ) -> io::Result<()> {
        let mut doubts = doubts(basis, outcome);
        doubts.extend(failed.iter().map(|fault| {
            let file = fault.file.as_deref().unwrap_or("a table");
            doubt(&format!("{file} is read to its end"), "unread", fault.sentence())
        }));
        for doubt in &doubts {
            self.counts.add(doubt.tag);
        }
        let mut xml = self.counts.begun(title.unwrap_or(BATCH), self.begun.elapsed().as_secs_f64());
        xml += "<properties>\n";
        let counts = outcome.counts.named().map(|(name, count)| (name.to_owned(), count.to_string()));
        let limits = basis.limits.iter().map(|(on, limit)| (format!("limit {}", on.key()), limit.to_string()));
        for (name, value) in counts.into_iter().chain([("judged by".to_owned(), basis.judged_by())]).chain(limits) {
            xml += &format!("<property name=\"{name}\" value=\"{}\"/>\n", escaped(&value));
        }
        xml += "</properties>\n";
        xml.extend(doubts.iter().map(|doubt| doubt.xml(0.0)));
        out.write_all(xml.as_bytes())?;
        self.cases.rewind().map_err(|error| self.named(&error))?;
        io::copy(&mut self.cases, out)?;
        let said = said(&outcome.readings, &outcome.notes);
        if !said.is_empty() {
            writeln!(out, "<system-out>{}</system-out>", escaped(&said.join("\n")))?;
        }
        out.write_all(ENDED.as_bytes())
    }
}

/// The name of a suite without a title.
const BATCH: &str = "rackmesh batch";
/// The end of every report.
const ENDED: &str = "</testsuite>\n</testsuites>\n";

/// The JUnit report of a batch without an outcome: an error with the reason.
#[must_use]
pub fn junit_of_failure(why: &str) -> String {
    let case = doubt(COMPLETE, "incomplete", why.to_owned());
    CaseCounts { tests: 1, errors: 1, ..CaseCounts::default() }.begun(BATCH, 0.0) + &case.xml(0.0) + ENDED
}

/// The test case that every part was checked.
const COMPLETE: &str = "the run is complete";

/// A test case.
struct Case {
    class: String,
    name: String,
    /// `failure`, `error` where something was not checked, `skipped` where there is no verdict; `None` of one that passes.
    tag: Option<&'static str>,
    kind: &'static str,
    message: String,
    /// Where that is, of a single part or row.
    place: Option<String>,
}

impl Case {
    /// The case as it stands in the report; it took so many seconds.
    fn xml(&self, seconds: f64) -> String {
        let [class, name, message] = [&self.class, &self.name, &self.message].map(|text| escaped(text));
        let start = format!("<testcase classname=\"{class}\" name=\"{name}\" time=\"{seconds:.6}\"");
        let Some(tag) = self.tag else { return start + "/>\n" };
        let kind = if tag == "skipped" { String::new() } else { format!(" type=\"{}\"", self.kind) };
        let end = match &self.place {
            Some(place) if tag != "skipped" => format!(">{}: {message}</{tag}>", escaped(place)),
            _ => "/>".to_owned(),
        };
        format!("{start}>\n<{tag}{kind} message=\"{message}\"{end}\n</testcase>\n")
    }
}

/// The test case of a part.
fn of_part(part: &Part) -> Case {
    let (tag, message) = match part.verdict {
        Some(Verdict::Pass) => (None, String::new()),
        Some(_) => (Some("failure"), sentence(part)),
        None => (Some("skipped"), part.reason.clone().unwrap_or_default()),
    };
    Case {
        class: part.place.file.to_string(),
        name: part.id.clone(),
        tag,
        kind: part.verdict.map_or("", Verdict::name),
        message,
        place: Some(part.place.to_string()),
    }
}

/// The test case of a row that makes no part.
fn of_problem(problem: &Problem) -> Case {
    Case {
        class: problem.place.file.to_string(),
        name: problem.part.clone().unwrap_or_else(|| format!("record {}", problem.place.record)),
        tag: Some("error"),
        kind: "bad-row",
        message: problem.what(),
        place: Some(problem.place.to_string()),
    }
}

/// A test case of the whole run that is an error.
fn doubt(name: &str, kind: &'static str, message: String) -> Case {
    Case { class: "run".to_owned(), name: name.to_owned(), tag: Some("error"), kind, message, place: None }
}

/// Why a run does not cover all parts.
fn doubts(basis: &Basis, outcome: &Outcome) -> Vec<Case> {
    let without_parts = || (outcome.counts.rows == 0).then_some("there were no parts to check");
    let incomplete = outcome.why_incomplete().or_else(without_parts);
    let incomplete = incomplete.map(|why| doubt(COMPLETE, "incomplete", why.to_owned()));
    let unjudged = basis.unjudged_sentence(outcome);
    let unjudged = unjudged.map(|why| doubt("every limit is judged", "unjudged", why));
    incomplete.into_iter().chain(unjudged).collect()
}

/// Text in an attribute of XML, which would lose its line breaks.
fn escaped(text: &str) -> String {
    escape(text).replace('\n', "&#10;")
}

/// The batch as workflow commands of GitHub Actions: why it does not cover all parts, the first parts that do not pass, the
/// first rejected rows, and the counts.
#[must_use]
pub fn github_annotations(basis: &Basis, outcome: &Outcome) -> String {
    let mut text = String::new();
    for doubt in doubts(basis, outcome) {
        let _ = writeln!(text, "::error title=rackmesh batch::{}", doubt.message);
    }
    for part in outcome.failures.iter().take(ANNOTATIONS_SHOWN) {
        let level = if part.verdict == Some(Verdict::Indeterminate) { "warning" } else { "error" };
        let title = format!("part {}", part.id);
        command(&mut text, level, Some(of_row(&part.place)), &title, &sentence(part));
    }
    for problem in outcome.problems.iter().take(ANNOTATIONS_SHOWN) {
        let title = format!("record {} rejected", problem.place.record);
        command(&mut text, "error", Some(of_row(&problem.place)), &title, &problem.what());
    }
    let counts = &outcome.counts;
    let left_out = |all: u64, what: &str| {
        let more = all.saturating_sub(ANNOTATIONS_SHOWN as u64);
        if more > 0 { format!("; {} more {what} without an annotation", grouped(more)) } else { String::new() }
    };
    let _ = writeln!(
        text,
        "::notice title=rackmesh batch::{} {}s: {} pass, {} fail, {} indeterminate, {} without a verdict, {} rejected{}{}",
        counts.rows,
        basis.row_or_part(),
        counts.pass,
        counts.fail,
        counts.indeterminate,
        counts.unjudged,
        counts.rejected,
        left_out(counts.fail + counts.indeterminate, "parts that do not pass"),
        left_out(counts.rejected, &format!("rejected {}s", basis.row_or_part()))
    );
    text
}

/// An error that belongs to no row as a workflow command of GitHub Actions, in its file and line if it has them.
#[must_use]
pub fn github_annotation(error: &Diagnostic) -> String {
    let mut text = String::new();
    let place = error.place.as_ref().map(|place| (&*place.source.name, Some(place.line_and_column().0 as u64)));
    let place = place.or_else(|| error.file.as_deref().map(|file| (file, None)));
    command(&mut text, "error", place, error.code.name(), &error.sentence());
    text.trim_end().to_owned()
}

fn of_row(place: &RowPlace) -> (&str, Option<u64>) {
    (&place.file, Some(place.line))
}

/// Adds a workflow command about a file and a line of it, as far as they are known.
fn command(text: &mut String, level: &str, place: Option<(&str, Option<u64>)>, title: &str, message: &str) {
    // the characters that end a value, as the runner's own toolkit writes them
    let data = |text: &str| text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    let value = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    let (file, line) = place.unzip();
    let file = file.map(|file| format!("file={},", value(file))).unwrap_or_default();
    let line = line.flatten().map(|line| format!("line={line},")).unwrap_or_default();
    let _ = writeln!(text, "::{level} {file}{line}title={}::{}", value(title), data(message));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("a<\"b\">&\u{1}\n"), "a&lt;&quot;b&quot;&gt;&amp;\\u0001&#10;");
        let mut text = String::new();
        let place = RowPlace { file: "a,b.csv".into(), line: 7, record: 1, in_words: None };
        command(&mut text, "error", Some(of_row(&place)), "part 1:2", "50 %\nout: of");
        assert_eq!(text, "::error file=a%2Cb.csv,line=7,title=part 1%3A2::50 %25%0Aout: of\n");
    }
}
