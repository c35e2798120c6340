//! A batch as pipelines show it: a JUnit report, and annotations of GitHub Actions.

use std::fmt::Write as _;

use super::batch::Basis;
use super::escape;
use super::number::{ends, grouped, unsigned};
use super::reading::remarks;
use crate::batch::{Outcome, Part, Problem, RowPlace};
use crate::judge::Verdict;

/// Annotations that a page shows of one step.
pub const ANNOTATIONS_SHOWN: usize = 10;

/// What is wrong with a part, in a sentence.
fn sentence(part: &Part) -> String {
    let result = ends(part.result_mm.0, part.result_mm.1);
    let on = part.on.map(|on| on.to_string()).unwrap_or_default();
    if part.verdict == Some(Verdict::Indeterminate) {
        return format!("ΔCD ({on}) {result} mm is too near its limit to be judged");
    }
    format!("ΔCD ({on}) {result} mm is {} mm outside its limit", unsigned(part.margin_mm.abs()))
}

/// The batch as a JUnit report. The parts that did not pass and the rejected rows are test cases of their own,
/// as far as the outcome lists them; one more stands for all others, so that a pipeline has something to show
/// where everything passes. What keeps the run from speaking for all parts is an error. File and line stand in the class
/// name and the text: pipelines that check the form (Jenkins, xUnit plugin) refuse attributes for them.
#[must_use]
pub fn junit(title: Option<&str>, basis: &Basis, outcome: &Outcome) -> String {
    let counts = &outcome.counts;
    let cases = cases(basis, outcome);
    let count = |tag: &str| cases.iter().filter(|case| case.tag == tag).count();
    let (all, failed, errors) = (1 + cases.len(), count("failure"), count("error"));
    let mut xml = begun(title.unwrap_or(BATCH), [all, failed, errors]);
    xml.push_str("<properties>\n");
    let property = |xml: &mut String, name: &str, value: &str| {
        let _ = writeln!(xml, "<property name=\"{name}\" value=\"{}\"/>", escaped(value));
    };
    for (name, count) in counts.named() {
        property(&mut xml, name, &count.to_string());
    }
    property(&mut xml, "judged by", &basis.judged_by());
    for (on, limit) in &basis.limits {
        property(&mut xml, &format!("limit {}", on.key()), &limit.to_string());
    }
    xml.push_str("</properties>\n");
    let rest = counts.pass + counts.unjudged;
    let others = match (counts.unjudged > 0, rest == 1) {
        (true, true) => "part was checked and has no verdict or passes",
        (true, false) => "parts were checked and have no verdict or pass",
        (false, true) => "part was checked and passes",
        (false, false) => "parts were checked and pass",
    };
    let _ = writeln!(xml, "<testcase classname=\"parts\" name=\"{} {others}\"/>", grouped(rest));
    xml.extend(cases.iter().map(Case::xml));
    let mut said: Vec<String> = outcome.readings.iter().map(ToString::to_string).collect();
    said.extend(remarks(&outcome.readings, &outcome.notes));
    if !said.is_empty() {
        let _ = writeln!(xml, "<system-out>{}</system-out>", escaped(&said.join("\n")));
    }
    xml + ENDED
}

/// What a suite is called that has no title.
const BATCH: &str = "rackmesh batch";
/// The end of every report.
const ENDED: &str = "</testsuite>\n</testsuites>\n";

/// The start of a report with so many test cases, failures and errors.
fn begun(name: &str, [all, failed, errors]: [usize; 3]) -> String {
    let name = escaped(name);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <testsuites name=\"rackmesh\" tests=\"{all}\" failures=\"{failed}\" errors=\"{errors}\">\n\
         <testsuite name=\"{name}\" tests=\"{all}\" failures=\"{failed}\" errors=\"{errors}\" skipped=\"0\">\n"
    )
}

/// The JUnit report of a batch that has no outcome, and why it has none: an error.
#[must_use]
pub fn junit_of_failure(why: &str) -> String {
    let case = case(["run", COMPLETE], "error", "incomplete", why.to_owned());
    begun(BATCH, [1, 0, 1]) + &case.xml() + ENDED
}

/// The test case that every part was looked at.
const COMPLETE: &str = "the run is complete";

/// A test case that is none of those that pass.
struct Case {
    class: String,
    name: String,
    /// `failure`, or `error` where something was not checked.
    tag: &'static str,
    kind: &'static str,
    message: String,
    /// Where that is, of a single part or row.
    place: Option<String>,
}

impl Case {
    fn xml(&self) -> String {
        let Self { tag, kind, .. } = self;
        let [class, name, message] = [&self.class, &self.name, &self.message].map(|text| escaped(text));
        let end = match &self.place {
            Some(place) => format!(">{}: {message}</{tag}>", escaped(place)),
            None => "/>".to_owned(),
        };
        format!(
            "<testcase classname=\"{class}\" name=\"{name}\">\n<{tag} type=\"{kind}\" message=\"{message}\"{end}\n</testcase>\n"
        )
    }
}

/// What keeps the run from speaking for all parts, the parts that did not pass, and the rejected rows.
fn cases(basis: &Basis, outcome: &Outcome) -> Vec<Case> {
    let Outcome { counts, failures, problems, .. } = outcome;
    let failure = |part: &Part| Case {
        class: part.place.file.to_string(),
        name: part.id.clone(),
        tag: "failure",
        kind: part.verdict.map_or("fail", Verdict::name),
        message: sentence(part),
        place: Some(part.place.to_string()),
    };
    let error = |problem: &Problem| Case {
        class: problem.place.file.to_string(),
        name: format!("record {}", problem.place.record),
        tag: "error",
        kind: "bad-row",
        message: problem.what(),
        place: Some(problem.place.to_string()),
    };
    let unlisted = |all: u64, listed: usize, case: Case| {
        let count = all.saturating_sub(listed as u64);
        (count > 0).then(|| Case { message: format!("{} more {}", grouped(count), case.message), ..case })
    };
    let other_parts = case(["parts", "other parts"], "failure", "fail", "parts do not pass".to_owned());
    let other_rows = case(["rows", "other rows"], "error", "bad-row", "rows are rejected".to_owned());
    doubts(basis, outcome)
        .into_iter()
        .chain(failures.iter().map(failure))
        .chain(unlisted(counts.fail + counts.indeterminate, failures.len(), other_parts))
        .chain(problems.iter().map(error))
        .chain(unlisted(counts.rejected, problems.len(), other_rows))
        .collect()
}

/// A case that is of no single part or row.
fn case([class, name]: [&str; 2], tag: &'static str, kind: &'static str, message: String) -> Case {
    Case { class: class.to_owned(), name: name.to_owned(), tag, kind, message, place: None }
}

/// What keeps a run from speaking for all parts.
fn doubts(basis: &Basis, outcome: &Outcome) -> Vec<Case> {
    let incomplete = if outcome.interrupted {
        Some("the run was interrupted: later parts were not checked")
    } else if outcome.is_cut {
        Some("a table was not read to its end: not all parts were checked")
    } else if outcome.counts.rows == 0 {
        Some("there were no parts to check")
    } else {
        None
    };
    let incomplete = incomplete.map(|why| case(["run", COMPLETE], "error", "incomplete", why.to_owned()));
    let unjudged = basis.unjudged_sentence(&outcome.counts);
    let unjudged = unjudged.map(|why| case(["run", "every limit is judged"], "error", "unjudged", why));
    incomplete.into_iter().chain(unjudged).collect()
}

/// Text in an attribute of XML, which would lose its line breaks.
fn escaped(text: &str) -> String {
    escape(text).replace('\n', "&#10;")
}

/// The batch as workflow commands of GitHub Actions: what keeps it from speaking for all parts, the first parts that did
/// not pass, the first rejected rows, and the counts.
#[must_use]
pub fn github_annotations(basis: &Basis, outcome: &Outcome) -> String {
    let mut text = String::new();
    for doubt in doubts(basis, outcome) {
        let _ = writeln!(text, "::error title=rackmesh batch::{}", doubt.message);
    }
    for part in outcome.failures.iter().take(ANNOTATIONS_SHOWN) {
        let level = if part.verdict == Some(Verdict::Indeterminate) { "warning" } else { "error" };
        let title = format!("part {}", part.id);
        command(&mut text, level, &part.place, &title, &sentence(part));
    }
    for problem in outcome.problems.iter().take(ANNOTATIONS_SHOWN) {
        let title = format!("record {} rejected", problem.place.record);
        command(&mut text, "error", &problem.place, &title, &problem.what());
    }
    let counts = &outcome.counts;
    let _ = writeln!(
        text,
        "::notice title=rackmesh batch::{} rows: {} pass, {} fail, {} indeterminate, {} without a verdict, {} rejected",
        counts.rows, counts.pass, counts.fail, counts.indeterminate, counts.unjudged, counts.rejected
    );
    text
}

fn command(text: &mut String, level: &str, place: &RowPlace, title: &str, message: &str) {
    // the characters that end a value, as the runner's own toolkit writes them
    let data = |text: &str| text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    let value = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    let (file, line) = (value(&place.file), place.line);
    let _ = writeln!(text, "::{level} file={file},line={line},title={}::{}", value(title), data(message));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("a<\"b\">&\u{1}\n"), "a&lt;&quot;b&quot;&gt;&amp;\\u0001&#10;");
        let mut text = String::new();
        let place = RowPlace { file: "a,b.csv".into(), line: 7, record: 1, in_words: None };
        command(&mut text, "error", &place, "part 1:2", "50 %\nout: of");
        assert_eq!(text, "::error file=a%2Cb.csv,line=7,title=part 1%3A2::50 %25%0Aout: of\n");
    }
}
