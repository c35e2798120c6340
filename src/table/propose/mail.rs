//! The sentences of a mail as a table: the numbers behind keys and known headings. The table is proposed to a person who pastes a mail
//! on a terminal, and is read like any other once that person confirms it.

use crate::quantity::Unit;
use crate::table::cell::Cell;
use crate::table::dictionary::{Form, Role, lookup};
use crate::table::field::Field;

/// Words of a heading at most.
const MOST_WORDS: usize = 5;

/// The numbers of one part behind known headings, as a table with their units; `None` if there are none, or an error is there twice.
#[must_use]
pub fn table_in_sentences(text: &str) -> Option<String> {
    let mut found: Vec<(Field, String, String)> = Vec::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().filter(|word| !matches!(*word, "=" | ":")).collect();
        for (at, word) in words.iter().enumerate() {
            let number = word.trim_end_matches([',', ';', '.']);
            let is_number = number.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-'));
            if !is_number || !Cell::of_text(number).is_number() {
                continue;
            }
            let Some((field, heading)) = heading(&words[at.saturating_sub(MOST_WORDS)..at]) else { continue };
            if found.iter().any(|(other, ..)| *other == field) {
                return None;
            }
            let unit = words.get(at + 1).map(|unit| unit.trim_end_matches([',', ';', '.']));
            let unit = unit.filter(|unit| Unit::from_symbol(unit).is_some());
            let heading = unit.map_or_else(|| heading.clone(), |unit| format!("{heading} [{unit}]"));
            found.push((field, heading, number.to_owned()));
        }
    }
    let line = |cells: Vec<&str>| cells.join(";") + "\n";
    let headings = found.iter().map(|(_, heading, _)| heading.as_str()).collect();
    let numbers = found.iter().map(|(.., number)| number.as_str()).collect();
    (!found.is_empty()).then(|| line(headings) + &line(numbers))
}

/// The longest heading of an error at the end of some words.
fn heading(words: &[&str]) -> Option<(Field, String)> {
    (0..words.len()).find_map(|from| {
        let name = words[from..].join(" ");
        let name = name.trim_end_matches([':', '=', ' ']);
        match lookup(Form::Parts, name)?.role {
            Role::Value(field @ Field::Error(_)) => Some((field, name.to_owned())),
            _ => None,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_behind_headings_are_a_table() {
        for (text, table) in [
            (
                "Hallo,\nTeil 7: Rollenmaß 25,011 mm, Teilungsabweichung Zahnstange = 3,1 µm.\nGruß",
                Some("Rollenmaß [mm];Teilungsabweichung Zahnstange [µm]\n25,011;3,1\n"),
            ),
            ("rack_pitch: 12\n", Some("rack_pitch\n12\n")),
            ("Rollenmaß 25,011 mm\nRollenmaß 25,013 mm", None),
            ("am 12.03. um 9:15 waren es 25", None),
            ("", None),
        ] {
            assert_eq!(table_in_sentences(text).as_deref(), table, "{text}");
        }
    }
}
