//! `rackmesh explain`: the documentation of a diagnostic or a formula.

use std::fmt::Write as _;

use super::output::{Failure, Output, Status};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::CATALOGUE;

pub(super) const ABOUT: &str = "Print the documentation of a diagnostic code or a formula";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh explain                lists every topic
  rackmesh explain rack-lead      a formula: equation, symbols, domain, source
  rackmesh explain missing-key    a diagnostic: what is wrong and what to do")]
pub(super) struct Args {
    /// A formula or a diagnostic code; without one, all are listed.
    topic: Option<String>,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let text = match &self.topic {
            None => list(),
            Some(topic) => page(topic).ok_or_else(|| unknown(topic))?,
        };
        output.text(&text)?;
        Ok(Status::Pass)
    }
}

/// The page of a topic; underscores serve as hyphens, so that the keys of a spec are topics too.
fn page(topic: &str) -> Option<String> {
    let topic = topic.trim().to_lowercase().replace('_', "-");
    let formula = CATALOGUE.iter().find(|page| page.name == topic || page.aliases.contains(&topic.as_str()));
    if let Some(page) = formula {
        return Some(format!("# {}\n\n{}", page.name, for_screen(page.text)));
    }
    Code::ALL.iter().find(|code| code.name() == topic).map(|code| code.page().to_owned())
}

/// Fenced code indented instead, as it reads on a screen.
fn for_screen(text: &str) -> String {
    let mut inside = false;
    let mut out = String::new();
    for line in text.lines() {
        if line.starts_with("```") {
            inside = !inside;
            continue;
        }
        if inside {
            out.push_str("    ");
        }
        out.push_str(line);
        out.push('\n');
    }
    out
}

fn list() -> String {
    let mut text = "Formulas:\n".to_owned();
    for page in CATALOGUE {
        // writing to a string cannot fail
        let _ = writeln!(text, "  {:<18}{}", page.name, first_sentence(page.text));
    }
    text.push_str("\nDiagnostics:\n");
    for code in Code::ALL {
        let body = code.page().split_once("## What is wrong\n").map_or("", |(_, body)| body);
        let _ = writeln!(text, "  {:<18}{}", code.name(), first_sentence(body));
    }
    text
}

/// The first sentence, or clause, on one line.
fn first_sentence(text: &str) -> String {
    let end = text.find([';', ':']).into_iter().chain(text.find(". ")).chain(text.find(".\n")).min();
    text[..end.unwrap_or(text.len())].replace('\n', " ")
}

fn unknown(topic: &str) -> Diagnostic {
    let names = CATALOGUE.iter().map(|page| page.name).chain(Code::ALL.iter().map(|code| code.name()));
    let similar = names
        .map(|name| (strsim::jaro_winkler(topic, name), name))
        .filter(|(likeness, _)| *likeness > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let message = format!("there is no formula or diagnostic `{topic}`");
    Diagnostic::error(Code::UnknownTopic, message).help(match similar {
        Some((_, name)) => format!("did you mean `{name}`?"),
        None => "`rackmesh explain` lists them all".to_owned(),
    })
}
