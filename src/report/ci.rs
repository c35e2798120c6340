//! A batch as pipelines show it: a JUnit report, and annotations of GitHub Actions.

use std::fmt::Write as _;

use super::batch::{Basis, whereabouts};
use super::escape;
use super::number::{ends, grouped, unsigned};
use super::reading::remarks;
use crate::batch::{Outcome, Part};
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
    let (failures, problems) = (&outcome.failures, &outcome.problems);
    let unlisted_failures = (counts.fail + counts.indeterminate).saturating_sub(failures.len() as u64);
    let unlisted_problems = counts.rejected.saturating_sub(problems.len() as u64);
    let rest = counts.pass + counts.unjudged;
    let doubts = doubts(basis, outcome);
    let unlisted = usize::from(unlisted_failures > 0) + usize::from(unlisted_problems > 0);
    let cases = failures.len() + problems.len() + 1 + unlisted + doubts.len();
    let failed = failures.len() + usize::from(unlisted_failures > 0);
    let errors = problems.len() + usize::from(unlisted_problems > 0) + doubts.len();
    let name = escaped(title.unwrap_or("rackmesh batch"));
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <testsuites name=\"rackmesh\" tests=\"{cases}\" failures=\"{failed}\" errors=\"{errors}\">\n\
         <testsuite name=\"{name}\" tests=\"{cases}\" failures=\"{failed}\" errors=\"{errors}\" skipped=\"0\">\n\
         <properties>\n"
    );
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
    let all = match (counts.unjudged > 0, rest == 1) {
        (true, true) => "part was checked and has no verdict or passes",
        (true, false) => "parts were checked and have no verdict or pass",
        (false, true) => "part was checked and passes",
        (false, false) => "parts were checked and pass",
    };
    let _ = writeln!(xml, "<testcase classname=\"parts\" name=\"{} {all}\"/>", grouped(rest));
    for Doubt { of, kind, why } in doubts {
        let _ = writeln!(
            xml,
            "<testcase classname=\"run\" name=\"{of}\">\n<error type=\"{kind}\" message=\"{}\"/>\n</testcase>",
            escaped(&why)
        );
    }
    for part in failures {
        let place = escaped(&whereabouts(part));
        let message = escaped(&sentence(part));
        let kind = part.verdict.map_or("fail", Verdict::name);
        let _ = writeln!(
            xml,
            "<testcase classname=\"{}\" name=\"{}\">\n\
             <failure type=\"{kind}\" message=\"{message}\">{place}: {message}</failure>\n</testcase>",
            escaped(&part.file),
            escaped(&part.id)
        );
    }
    if unlisted_failures > 0 {
        let _ = writeln!(
            xml,
            "<testcase classname=\"parts\" name=\"other parts\">\n<failure type=\"fail\" message=\"{} more parts do not pass\"/>\n</testcase>",
            grouped(unlisted_failures)
        );
    }
    for problem in problems {
        let message = escaped(&problem.what());
        let _ = writeln!(
            xml,
            "<testcase classname=\"{}\" name=\"record {}\">\n\
             <error type=\"bad-row\" message=\"{message}\">{}: {message}</error>\n</testcase>",
            escaped(&problem.file),
            problem.record,
            escaped(&problem.whereabouts())
        );
    }
    if unlisted_problems > 0 {
        let _ = writeln!(
            xml,
            "<testcase classname=\"rows\" name=\"other rows\">\n<error type=\"bad-row\" message=\"{} more rows are rejected\"/>\n</testcase>",
            grouped(unlisted_problems)
        );
    }
    let mut said: Vec<String> = outcome.readings.iter().map(ToString::to_string).collect();
    said.extend(remarks(&outcome.readings, &outcome.notes));
    if !said.is_empty() {
        let _ = writeln!(xml, "<system-out>{}</system-out>", escaped(&said.join("\n")));
    }
    xml.push_str("</testsuite>\n</testsuites>\n");
    xml
}

/// What keeps a run from speaking for all parts.
struct Doubt {
    of: &'static str,
    kind: &'static str,
    why: String,
}

fn doubts(basis: &Basis, outcome: &Outcome) -> Vec<Doubt> {
    let mut doubts = Vec::new();
    let incomplete = if outcome.interrupted {
        Some("the run was interrupted: later parts were not checked")
    } else if outcome.is_cut {
        Some("a table was not read to its end: not all parts were checked")
    } else if outcome.counts.rows == 0 {
        Some("there were no parts to check")
    } else {
        None
    };
    let complete = |why: &str| Doubt { of: "the run is complete", kind: "incomplete", why: why.to_owned() };
    doubts.extend(incomplete.map(complete));
    doubts.extend(basis.unjudged_sentence(&outcome.counts).map(|why| Doubt {
        of: "every limit is judged",
        kind: "unjudged",
        why,
    }));
    doubts
}

/// Text in an attribute of XML, which would lose its line breaks.
fn escaped(text: &str) -> String {
    escape(text).replace('\n', "&#10;").replace('\r', "&#13;").replace('\t', "&#9;")
}

/// The batch as workflow commands of GitHub Actions: what keeps it from speaking for all parts, the first parts that did
/// not pass, the first rejected rows, and the counts.
#[must_use]
pub fn github_annotations(basis: &Basis, outcome: &Outcome) -> String {
    let mut text = String::new();
    for doubt in doubts(basis, outcome) {
        let _ = writeln!(text, "::error title=rackmesh batch::{}", doubt.why);
    }
    for part in outcome.failures.iter().take(ANNOTATIONS_SHOWN) {
        let level = if part.verdict == Some(Verdict::Indeterminate) { "warning" } else { "error" };
        let title = format!("part {}", part.id);
        command(&mut text, level, &part.file, part.line, &title, &sentence(part));
    }
    for problem in outcome.problems.iter().take(ANNOTATIONS_SHOWN) {
        let title = format!("record {} rejected", problem.record);
        command(&mut text, "error", &problem.file, problem.line, &title, &problem.what());
    }
    let counts = &outcome.counts;
    let _ = writeln!(
        text,
        "::notice title=rackmesh batch::{} rows: {} pass, {} fail, {} indeterminate, {} without a verdict, {} rejected",
        counts.rows, counts.pass, counts.fail, counts.indeterminate, counts.unjudged, counts.rejected
    );
    text
}

fn command(text: &mut String, level: &str, file: &str, line: u64, title: &str, message: &str) {
    // the characters that end a value, as the runner's own toolkit writes them
    let data = |text: &str| text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    let value = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    let _ = writeln!(text, "::{level} file={},line={line},title={}::{}", value(file), value(title), data(message));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("a<\"b\">&\u{1}\n"), "a&lt;&quot;b&quot;&gt;&amp;\u{fffd}&#10;");
        let mut text = String::new();
        command(&mut text, "error", "a,b.csv", 7, "part 1:2", "50 %\nout: of");
        assert_eq!(text, "::error file=a%2Cb.csv,line=7,title=part 1%3A2::50 %25%0Aout: of\n");
    }
}
