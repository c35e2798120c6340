//! A pasted block with cells without an owner, on a terminal: it is shown with the values as they would count, and used once a
//! person confirms it. Confirmed rules are read like those of a spec. Through a pipe nothing is asked.

use std::io::{self, IsTerminal as _};
use std::path::Path;
use std::sync::Arc;

use super::output::{Failure, Output};
use super::read;
use super::stream::{self, Stdin};
use super::tables::{Opened, Opener, Reopened};
use super::target::is_dash;
use super::{set, target, terminal, written};
use crate::deviation::DeviationKind;
use crate::diagnostic::Diagnostic;
use crate::quantity::shown;
use crate::table::{Guesses, Table, decode, in_words, table_in_sentences};

/// Parts whose values are shown at most.
const PARTS_SHOWN: usize = 10;

/// Whether a person can be asked.
pub(super) fn can_ask() -> bool {
    io::stdin().is_terminal() && io::stderr().is_terminal()
}

/// The table of a block as a person confirms it; `None` if the person refuses, or nothing closes the table.
pub(super) fn confirmed<'a>(
    opener: &Opener<'a>,
    (path, spec_path): (&Path, &Path),
    partial: bool,
    stdin: &mut Option<Stdin>,
    output: &mut Output,
) -> Result<Option<Reopened<'a>>, Failure> {
    let mut opener = opener.clone();
    let (mut path, mut sentences) = (path.to_owned(), None);
    let mut proposal = opener.proposal(&path, &[])?;
    if !proposal.closes {
        let bytes = match &opener.stdin {
            Some(bytes) if is_dash(&path) => bytes.to_vec(),
            _ => std::fs::read(&path).map_err(|error| Diagnostic::unreadable(&stream::name(&path), &error))?,
        };
        let Some(table) = table_in_sentences(&decode(&bytes)) else { return Ok(None) };
        opener.stdin = Some(table.clone().into_bytes().into());
        (path, sentences) = ("-".into(), Some(table));
        proposal = opener.proposal(&path, &[])?;
        if !proposal.closes {
            // says what is wrong with values that are named
            return opener.open(&path).map_or(Ok(()), |opened| values(opened.table, output)).map(|()| None);
        }
    }
    let block = proposal.block(Guesses::Filled);
    let spec = Arc::new(opener.with_block(&block)?);
    let by_rules = Opener { spec: Arc::clone(&spec), ..opener.clone() };
    // what may be an error that is missing is left out of this block, and in the spec is for a person to say
    let written_block = proposal.block(Guesses::Shown);
    read::show(&proposal, &written_block, output)?;
    let opened = by_rules.open(&path)?;
    let missing = missing(&opened, partial);
    values(opened.table, output)?;
    let can_write = sentences.is_none() && !is_dash(spec_path);
    let (also, answers): (_, &[&str]) =
        if can_write { (" (w writes it to the spec as well)", &["y", "n", "w"]) } else { ("", &["y", "n"]) };
    let question = format!("{missing}use these values, and leave out the rest?{also}");
    let answer = terminal::ask(&question, answers, stdin, output)?;
    match answer.as_deref() {
        Some("w") => {
            let old = set::text(spec_path)?;
            let name = stream::name(spec_path);
            let new = written::merged(&name, &old, &written_block, &written::stamp())?;
            target::write(spec_path, &[] as &[&Path], new.as_bytes())?;
            if written_block != block {
                output.remark(&written::not_all(&name));
            }
        }
        Some("y") => {}
        _ => return Ok(None),
    }
    let mut opened = by_rules.open(&path)?;
    let rules = sentences
        .as_ref()
        .unwrap_or(&block)
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    let what = if sentences.is_some() { "these values of sentences, and nothing else" } else { "these rules" };
    opened.notes.push(format!("confirmed on a terminal, {what}: {}", rules.map(shown).collect::<Vec<_>>().join(" · ")));
    Ok(Some(Reopened { opened, opener: by_rules, path }))
}

/// What is said before the question of the errors that the spec asks for and the table lacks.
fn missing(opened: &Opened, partial: bool) -> String {
    let Opened { table, spec, .. } = opened;
    let kinds = spec.lacking(&table.kinds().collect::<Vec<_>>());
    if table.is_teeth || kinds.is_empty() {
        return String::new();
    }
    let verb = if kinds.len() == 1 { "is" } else { "are" };
    let end = match () {
        () if partial => "y judges without",
        () if spec.limits.is_empty() && spec.function_limits.is_empty() => "y shows the sum without",
        () => "y ends without a verdict",
    };
    format!("{} {verb} missing, so {end}: ", DeviationKind::keys(kinds.iter().copied()))
}

/// Shows the values of parts as they would count.
fn values(table: Table, output: &mut Output) -> Result<(), Failure> {
    let name = Arc::clone(&table.name);
    let titles: Vec<_> = table.kinds().map(DeviationKind::key).collect();
    let blocks = table.blocks().map_err(|error| Diagnostic::unreadable(&name, &error))?;
    let mut count = 0;
    for block in &blocks {
        let fault = |row| block.faults().iter().find(|fault| fault.row == row);
        for row in 0..block.rows() {
            count += 1;
            if count > PARTS_SHOWN {
                continue;
            }
            let part = block.name(row).map_or_else(|| format!("part {count}"), |name| shown(&name));
            let each =
                titles.iter().enumerate().map(|(at, key)| format!("{key} {}", in_words(block.values(at).at(row))));
            let said = match fault(row) {
                Some(fault) => format!("rejected: {}", fault.message),
                None => each.collect::<Vec<_>>().join(", "),
            };
            output.message(&format!("{part}: {said}"));
        }
    }
    if count > PARTS_SHOWN {
        output.message(&format!("… and {} more parts", count - PARTS_SHOWN));
    }
    Ok(())
}
