//! `rackmesh explain`: the documentation of a formula, a method or a diagnostic.

use std::fmt::Write as _;

use clap::builder::PossibleValue;

use super::completions::Suggested;
use super::output::{Failure, Output, Status};
use crate::diagnostic::{Code, Diagnostic, nearest_or, wrap};
use crate::formula::{CATALOGUE, FormulaPage as Page};
use crate::report::{Column, Table, table_text};
use crate::spec::{self, KeyEntry};

pub(super) const ABOUT: &str = "Print the page of a formula, a method or a diagnostic code";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh explain                lists every topic
  rackmesh explain rack-lead      a formula: equation, symbols, domain, source
  rackmesh explain cpk            a method: how the number is made, by which standard
  rackmesh explain missing-key    a diagnostic: what is wrong and what to do
  rackmesh explain keys           every key of the spec; also one of them, such as rack.face_width")]
pub(super) struct Args {
    /// A formula, a method, a diagnostic code or a key of the spec; without one, all are listed.
    #[arg(value_parser = Suggested(topics), hide_possible_values = true)]
    topic: Option<String>,
}

/// The topic that lists the keys of the spec.
const KEYS: &str = "keys";

/// The methods; each page is the documentation of its module.
const METHODS: &[Page] = &[
    Page::new("precision", &["accuracy", "rounding", "digits"], include_str!("../formula/precision.md")),
    Page::new("combination", &["range", "worst-case", "worst", "rss", "stack"], include_str!("../judge/stack.md")),
    Page::new("uncertainty", &["gum", "u", "k"], include_str!("../uncertainty/method.md")),
    Page::new("rule", &["iso14253", "guard", "simple", "conformance", "risk"], include_str!("../judge/rule.md")),
    Page::new("monte-carlo", &["simulation-of-errors"], include_str!("../chance/method.md")),
    Page::new("capability", &["cp", "cpk", "pp", "ppk"], include_str!("../statistics/capability/method.md")),
    Page::new("budget", &["tolerance"], include_str!("../budget/method.md")),
    Page::new(
        "permissible",
        &["standard", "iso1328", "din3962", "jisb1702", "f-p", "f-pt", "f-r", "f-beta"],
        include_str!("../standard/method.md"),
    ),
    Page::new("class", &["grade"], include_str!("../judge/class.md")),
    Page::new("mesh", &["exact-mesh"], include_str!("../mesh/method.md")),
    Page::new(
        "curve",
        &["composite", "f-i", "f-i''", "fi''", "transmission-error"],
        include_str!("../mesh/summary.md"),
    ),
    Page::new("yoke", &["function", "play", "torque", "lift-off"], include_str!("../function/method.md")),
    Page::new("simulate", &["multibody", "simulation"], include_str!("../multibody/method.md")),
];

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let text = match &self.topic {
            None => list(output.screen().width),
            Some(topic) => for_screen(
                &page_of(topic).or_else(|| keys(topic)).ok_or_else(|| unknown(topic))?,
                output.screen().width,
            ),
        };
        output.text(&text)?;
        Ok(Status::Pass)
    }
}

/// The page of a topic; underscores serve as hyphens, so that the keys of a spec are topics too.
fn page_of(topic: &str) -> Option<String> {
    let topic = topic.trim().to_lowercase().replace('_', "-");
    let mut pages = CATALOGUE.iter().chain(METHODS);
    if let Some(page) = pages.find(|page| page.name == topic || page.aliases.contains(&topic.as_str())) {
        return Some(format!("# {}\n\n{}", page.name, page.text));
    }
    Code::ALL.iter().find(|code| code.name() == topic).map(|code| code.page().to_owned())
}

/// Every key of the spec, or the keys named `topic` or within it.
fn keys(topic: &str) -> Option<String> {
    let topic = topic.trim();
    let is_within = |key: &KeyEntry| {
        topic == KEYS || key.path.strip_prefix(topic).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    let mut rows = String::new();
    for KeyEntry { path, holds, doc, .. } in spec::keys().into_iter().filter(is_within) {
        // writing to a string cannot fail
        let _ = writeln!(rows, "| {path} | {holds} | {} |", doc.replace('|', "\\|"));
    }
    (!rows.is_empty()).then(|| format!("# {topic}\n\n| key | holds | what it means |\n|---|---|---|\n{rows}"))
}

/// The width of a page where no screen says one.
const FILE_WIDTH: u16 = 80;

/// Markdown for a screen: code indented instead of fenced; with a width, tables are drawn and lines broken to fit it. Without one,
/// for a file, only sentences are broken.
pub(super) fn for_screen(text: &str, width: Option<u16>) -> String {
    /// Longer lines are tiring to read.
    const WIDEST: u16 = 100;
    let width = width.map(|width| width.min(WIDEST));
    let mut out = String::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let shown = if line.starts_with("```") {
            let code = lines.by_ref().take_while(|line| !line.starts_with("```"));
            code.map(|line| wrap(format!("    {line}").trim_end(), width)).collect::<Vec<_>>().join("\n")
        } else if width.is_some() && line.starts_with('|') {
            let mut table = vec![line];
            while let Some(line) = lines.next_if(|line| line.starts_with('|')) {
                table.push(line);
            }
            table_text(&table_of(&table), width)
        } else if !line.is_empty() && !line.starts_with(['#', '|']) {
            let mut paragraph = line.to_owned();
            while let Some(line) = lines.next_if(|line| {
                !(line.is_empty() || line.starts_with(['|', '#', '-', '`']) || line.starts_with("    "))
            }) {
                paragraph.push(' ');
                paragraph.push_str(line.trim_start());
            }
            wrap(&paragraph, width.or(Some(FILE_WIDTH)))
        } else {
            line.to_owned()
        };
        out.push_str(&shown);
        out.push('\n');
    }
    out
}

/// The lines of a Markdown table: a header, a rule, rows. `\|` does not end a cell.
fn table_of(lines: &[&str]) -> Table {
    let cells = |line: &str| -> Vec<String> {
        let line = line.replace("\\|", "\u{0}");
        let inner = line.trim().trim_matches('|');
        inner.split('|').map(|cell| cell.trim().replace('\u{0}', "|")).collect()
    };
    Table {
        columns: lines.first().map_or_else(Vec::new, |line| cells(line).into_iter().map(Column::text).collect()),
        rows: lines.iter().skip(2).map(|line| cells(line)).collect(),
    }
}

fn list(width: Option<u16>) -> String {
    const NAMES: u16 = 20;
    let row = |name: &str, what: &str| {
        let what = wrap(what, width.map(|width| width.saturating_sub(NAMES)));
        format!("  {name:<18}{}\n", what.replace('\n', &format!("\n{:20}", "")))
    };
    let mut text = String::new();
    for (heading, pages) in [("Formulas:", &CATALOGUE[..]), ("\nMethods:", METHODS)] {
        text.push_str(heading);
        text.push('\n');
        for page in pages {
            text += &row(page.name, &first_sentence(page.text));
        }
    }
    text.push_str("\nThe spec:\n  keys              every key, what it holds and what it means\n\nDiagnostics:\n");
    for code in Code::ALL {
        let body = code.page().split_once("## What is wrong\n").map_or("", |(_, body)| body);
        text += &row(code.name(), &first_sentence(body));
    }
    text
}

/// The first sentence, or clause, on one line.
fn first_sentence(text: &str) -> String {
    let end = text.find([';', ':']).into_iter().chain(text.find(". ")).chain(text.find(".\n")).min();
    text[..end.unwrap_or(text.len())].replace('\n', " ")
}

/// The names of all topics but keys.
fn names() -> impl Iterator<Item = &'static str> {
    CATALOGUE.iter().chain(METHODS).map(|page| page.name).chain(Code::ALL.iter().map(|code| code.name()))
}

/// The topics that shells complete.
fn topics() -> Vec<PossibleValue> {
    let keys = spec::keys().into_iter().map(|key| PossibleValue::new(key.path).help(key.doc));
    names().chain([KEYS]).map(PossibleValue::new).chain(keys).collect()
}

fn unknown(topic: &str) -> Diagnostic {
    let aliases = CATALOGUE.iter().chain(METHODS).flat_map(|page| page.aliases).copied();
    let all = names().chain(aliases).map(str::to_owned).chain(spec::keys().into_iter().map(|key| key.path));
    let message = format!("there is no formula, method or diagnostic `{topic}`");
    Diagnostic::error(Code::UnknownTopic, message)
        .help(nearest_or(topic, all, || "`rackmesh explain` lists them all".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_page_fits_a_narrow_screen() {
        for topic in names() {
            let page = page_of(topic).expect("a topic has a page");
            let text = for_screen(&page, Some(72));
            let wide = text.lines().find(|line| line.chars().count() > 72);
            assert_eq!(wide, None, "{topic}:\n{text}");
            let words = |text: &str| text.chars().filter(|c| c.is_alphanumeric()).count();
            let fences = page.matches("```text").count() * "text".len();
            assert_eq!(words(&text) + fences, words(&page), "{topic}:\n{text}");
        }
    }

    #[test]
    fn no_name_or_alias_has_two_pages() {
        let aliases = CATALOGUE.iter().chain(METHODS).flat_map(|page| page.aliases.iter().copied());
        let mut all: Vec<_> = names().chain(aliases).collect();
        all.sort_unstable();
        assert!(all.windows(2).all(|two| two[0] != two[1]), "{all:?}");
    }

    #[test]
    fn a_page_for_a_file_stays_markdown() {
        assert_eq!(
            for_screen("a\nb\n```text\nx = 1\n```\n| a |\n|---|\n| \\|b\\| |\n", None),
            "a b\n    x = 1\n| a |\n|---|\n| \\|b\\| |\n"
        );
        let cells = table_of(&["| a | b |", "|---|---|", "| \\|x\\| | 1 |"]);
        assert_eq!(cells.rows, [["|x|", "1"]]);
    }
}
