//! What is said of a table that is not closed: everything that has no owner, and the `[table]` that would close it.

use super::open::Open;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::table::dictionary::Heading;
use crate::table::layout::{DeclaredColumn, Layout, LineRule, PartNames, Repeats, StatusColumn};
use crate::table::names::{Field, Role as Beside};
use crate::table::pattern::Pattern;
use crate::table::want::quoted;

/// The refusal of a table that is not closed: what has no owner, and the lines of a contract that close it, as far as nothing has to
/// be guessed.
pub(crate) fn refused(name: &str, layout: &Layout, open: &[Open]) -> Diagnostics {
    const SHOWN: usize = 40;
    let mut list: Vec<String> = open.iter().take(SHOWN).map(Open::in_words).collect();
    if let more @ 1.. = open.len().saturating_sub(SHOWN) {
        list.push(format!("and {more} more"));
    }
    list.push("what closes the table, in the spec:".to_owned());
    list.extend(block(layout, open).lines().map(|line| format!("  {line}")));
    let things = if open.len() == 1 { "a cell or line has" } else { "cells or lines have" };
    let message = format!("{name}: {things} no owner, so nothing is judged:");
    let others =
        open.iter().filter_map(|open| if let Open::Wrong { help, .. } = open { Some(help.as_str()) } else { None });
    let helps = ["say what each is, or that it is not used"].into_iter().chain(others.filter(|help| !help.is_empty()));
    let help = helps.collect::<Vec<_>>().join("; ");
    let problem = Diagnostic { list: list.into(), ..Diagnostic::error(Code::NotUnderstood, message) };
    problem.help(help).into()
}

/// The lines of the contract that close the table; what only a person knows stands there as a comment.
pub(crate) fn block(layout: &Layout, open: &[Open]) -> String {
    let mut ignore: Vec<String> = layout.ignore.iter().map(|rule| rule.text().to_owned()).collect();
    let mut lines: Vec<LineRule> = layout.ignore_lines.clone();
    let (mut guesses, mut keys) = (Vec::new(), own_keys(layout));
    let mut comments: Vec<String> = layout.comments.iter().map(|rule| rule.text().to_owned()).collect();
    for open in open {
        match open {
            Open::Column { place, title, .. } if title.is_empty() => ignore.push(format!("column {}", place + 1)),
            Open::Column { title, .. } => ignore.push(title.clone()),
            Open::Line { text, .. } => add_line(&mut lines, &generalised(text), 0),
            Open::Row { pattern, could_be_part, .. } => add_line(&mut lines, pattern, u64::from(*could_be_part)),
            Open::Comment { text, .. } => comments.push(text.lines().collect::<Vec<_>>().join(" ")),
            Open::Unit { key, title, units } => {
                let name = quoted(&Heading::of(title).name);
                let units = if units.is_empty() { &["mm"][..] } else { units };
                guesses.extend(units.iter().map(|unit| format!("{key} = {{ name = {name}, unit = \"{unit}\" }}")));
            }
            Open::Mark { .. } => keys.push("# decimal = \"comma\"   # or \"point\"".to_owned()),
            Open::Separator { .. } => keys.push("# separator = \";\"".to_owned()),
            Open::NoValues { .. } => guesses.push("rack_pitch = { name = \"…\", unit = \"um\" }".to_owned()),
            Open::Twice { titles, .. } => guesses.push(format!("ignore = [{}]", quoted(&titles[1]))),
            Open::Sheets { .. } | Open::Pattern { .. } | Open::Missing { .. } | Open::Wrong { .. } => {}
        }
    }
    let declared: Vec<String> = own_columns(layout, &guesses);
    written(&keys, &ignore, &lines, &comments) + &of_columns(&declared, &guesses)
}

/// Adds a rule for lines, or to how many it may leave out.
fn add_line(lines: &mut Vec<LineRule>, pattern: &str, doubtful: u64) {
    let pattern = Pattern::of_line(pattern);
    match lines.iter_mut().find(|rule| rule.pattern == pattern) {
        Some(rule) => rule.at_most += doubtful,
        None => lines.push(LineRule { pattern, at_most: doubtful }),
    }
}

/// What the contract says of the table as a whole.
fn own_keys(layout: &Layout) -> Vec<String> {
    let parts = layout.parts.map(|parts| format!("parts = \"{}\"", parts.word()));
    let separator = layout.separator.map(|byte| match byte {
        b'\t' => "separator = \"tab\"".to_owned(),
        byte => format!("separator = {}", quoted(&char::from(byte).to_string())),
    });
    let starts = (!layout.starts.is_empty()).then(|| format!("starts = {:?}", layout.starts));
    let decimal = layout.decimal.map(|mark| format!("decimal = \"{}\"", mark.word()));
    let units = layout.units.map(|line| format!("units = \"line {line}\""));
    let repeats = match layout.repeats {
        Repeats::Refused => None,
        Repeats::All => Some("repeats = \"all\"".to_owned()),
        Repeats::Last => Some("repeats = \"last\"".to_owned()),
    };
    let others = layout.ignores_others.then(|| "others = \"ignore\"".to_owned());
    [parts, separator, starts, decimal, units, repeats, others].into_iter().flatten().collect()
}

/// What the contract says of columns, but for those of which a guess says more.
fn own_columns(layout: &Layout, guesses: &[String]) -> Vec<String> {
    let part = layout.part_id.as_ref().map(|names| match names {
        PartNames::Column(name) => format!("part_id = {}", quoted(name)),
        PartNames::Line(pattern) => format!("part_id = {{ line = {} }}", quoted(pattern.text())),
    });
    let list = |texts: &[String]| texts.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(", ");
    let status = layout.status.as_ref().map(|StatusColumn { name, accept, reject }| {
        format!("status = {{ name = {}, accept = [{}], reject = [{}] }}", quoted(name), list(accept), list(reject))
    });
    let column = |column: &DeclaredColumn| {
        let name = column.name.iter().map(|name| format!("name = {}", quoted(name)));
        let unit = column.unit.iter().map(|unit| format!("unit = \"{}\"", unit.symbol()));
        let beside = column.beside.iter().map(|(beside, name)| {
            let word = if *beside == Beside::Unit { "units" } else { beside.key() };
            format!("{word} = {}", quoted(name))
        });
        let all: Vec<String> = name.chain(unit).chain(beside).collect();
        (!all.is_empty()).then(|| format!("{} = {{ {} }}", column.field.key(), all.join(", ")))
    };
    let is_guessed = |field: Field| guesses.iter().any(|guess| guess.starts_with(&format!("{} = ", field.key())));
    let columns = layout.columns.iter().filter(|column| !is_guessed(column.field)).filter_map(column);
    part.into_iter().chain(status).chain(columns).collect()
}

fn written(keys: &[String], ignore: &[String], lines: &[LineRule], comments: &[String]) -> String {
    let list = |name: &str, texts: &[String]| {
        let quoted: Vec<_> = texts.iter().map(|text| quoted(text)).collect();
        if texts.is_empty() { String::new() } else { format!("{name} = [{}]\n", quoted.join(", ")) }
    };
    let mut text = "[table]\n".to_owned();
    text.extend(keys.iter().flat_map(|key| [key, "\n"]));
    text += &list("ignore", ignore);
    let rule = |rule: &LineRule| match rule.at_most {
        0 => quoted(rule.pattern.text()),
        most => format!("{{ like = {}, at_most = {most} }}", quoted(rule.pattern.text())),
    };
    if !lines.is_empty() {
        text += &format!("ignore_lines = [{}]\n", lines.iter().map(rule).collect::<Vec<_>>().join(", "));
    }
    text + &list("comments", comments)
}

fn of_columns(declared: &[String], guesses: &[String]) -> String {
    let declared = declared.iter().map(|line| format!("{line}\n"));
    let lines: Vec<_> = declared.chain(guesses.iter().map(|guess| format!("# {guess}   # a guess\n"))).collect();
    if lines.is_empty() { String::new() } else { format!("[table.columns]\n{}", lines.concat()) }
}

/// A line with `#` for each number; of one that may change, that is all that a rule should say.
pub(super) fn generalised(text: &str) -> String {
    let mut pattern = String::new();
    let mut rest = text.trim();
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        pattern += &rest[..start];
        // a number within a word is the word's
        let is_word = pattern.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let run = &rest[start..];
        let length = run.find(|c: char| !c.is_ascii_digit() && !".,:/-".contains(c)).unwrap_or(run.len());
        let digits = run[..length].trim_end_matches(|c: char| !c.is_ascii_digit());
        pattern += if is_word { digits } else { "#" };
        rest = &run[digits.len()..];
    }
    pattern + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_lines_are_left_open() {
        for (text, pattern) in [
            ("Prüfprotokoll 7", "Prüfprotokoll #"),
            ("Datum: 12.03.2026;9:12", "Datum: #;#"),
            ("CHR_017 ok", "CHR_017 ok"),
            ("Max;25,012", "Max;#"),
            ("", ""),
        ] {
            assert_eq!(generalised(text), pattern);
            assert!(Pattern::of_line(pattern).fits(text), "{text}");
        }
    }
}
