//! Units that a line beside a table states for all of it: `Alle Maße in µm`, `Units: mm`.

use super::words::speaker;
use super::{Shape, has_digit};
use crate::quantity::{LengthUnit, Unit};
use crate::table::grid::{bare_unit, is_unit, without_end};
use crate::table::names::{Role, WordList, role};
use crate::table::reading::AsideReading;
use crate::table::want::Want;

/// A unit in a line beside a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct StatedUnit {
    pub(crate) unit: Unit,
    /// Whether the line says of what: of units, values, dimensions.
    pub(crate) is_clear: bool,
}

/// The units that a line beside a table states for it: alone, behind a word for units or values, or by themselves in a
/// line without numbers.
pub(crate) fn stated_units(text: &str) -> Vec<StatedUnit> {
    let text = &text[speaker(text).len()..];
    let alone = match text.rsplit_once([':', '：']) {
        Some((subject, unit)) if WordList::UnitSubject.has(subject) => unit,
        _ => text,
    };
    // the end of a sentence
    if let Some(unit) = Unit::from_symbol(bare_unit(without_end(alone))) {
        return vec![StatedUnit { unit, is_clear: true }];
    }
    if WordList::Imperial.is_in(text) {
        return vec![StatedUnit { unit: Unit::Length(LengthUnit::Inch), is_clear: true }];
    }
    let words: Vec<String> = words(text).map(str::to_lowercase).collect();
    let is_symbol = |word: &String| Unit::from_symbol(word).is_some();
    let is_between = |word: &String| WordList::BeforeUnit.has(word);
    let is_subject = |word: &String| role(word) == Some(Role::Unit) || WordList::UnitSubject.has(word);
    let says_nothing_else = words.iter().all(|word| is_symbol(word) || is_between(word) || is_subject(word));
    let unit_of = |at: usize| {
        let unit = Unit::from_symbol(&words[at])?;
        let mut before = words[..at].iter().rev().skip_while(|word| is_between(word) || is_symbol(word));
        let is_clear = says_nothing_else || before.next().is_some_and(is_subject);
        let is_word = words[at].chars().count() > 1 && !matches!(words[at].as_str(), "in" | "min");
        if words[at] == "in" {
            return inch(&words, at);
        }
        (is_clear || is_word && !has_digit(text)).then_some(StatedUnit { unit, is_clear })
    };
    (0..words.len()).filter_map(unit_of).collect()
}

/// The words of a text, and its units of one letter or sign; Japanese has another script in place of blanks.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let script = |c: char| match c {
        '\u{3041}'..='\u{309f}' => 1,
        '\u{30a0}'..='\u{30ff}' => 2,
        '\u{4e00}'..='\u{9fff}' => 3,
        _ => 0,
    };
    let words = text.split(|c: char| !c.is_alphanumeric() && !matches!(c, 'µ' | '°'));
    words.flat_map(move |word| {
        let mut rest = word;
        std::iter::from_fn(move || {
            let of = script(rest.chars().next()?);
            let (word, behind) = rest.split_at(rest.find(|c| script(c) != of).unwrap_or(rest.len()));
            rest = behind;
            Some(word)
        })
    })
}

/// Inches behind a word for units, `Units: in`; before another unit of length `in` is none.
fn inch(words: &[String], at: usize) -> Option<StatedUnit> {
    let is_of_units = role(words[..at].last()?) == Some(Role::Unit);
    let behind = &words[at + 1..];
    let is_other = behind.iter().any(|word| word != "in" && Unit::of_length(word).is_some());
    let is_clear = behind.first().is_none_or(|word| Unit::of_angle(word).is_some());
    (is_of_units && !is_other).then_some(StatedUnit { unit: Unit::Length(LengthUnit::Inch), is_clear })
}

/// What a line beside a table calls a unit, and is none that is known: `Maßeinheit: Fuß`, `Werte in my`.
pub(crate) fn unknown_unit(text: &str) -> Option<&str> {
    const IN_ORDER: &str = "ordnung";
    let words: Vec<&str> = words(text).collect();
    let (last, before) = words.split_last()?;
    let (before, subject) = (before.last()?.to_lowercase(), before.iter().rev().map(|word| word.to_lowercase()));
    let is_of_units = role(&before) == Some(Role::Unit);
    let mut subject = subject.skip_while(|word| WordList::BeforeUnit.has(word));
    let is_of_values = before == "in" && subject.next().is_some_and(|word| WordList::UnitSubject.has(&word));
    let is_word = last.chars().all(char::is_alphabetic) && last.to_lowercase() != IN_ORDER;
    (is_word && (is_of_units || is_of_values) && stated_units(text).is_empty()).then_some(*last)
}

/// Whether a text is a unit, or states one.
fn speaks_of_units(text: &str) -> bool {
    is_unit(text) || stated_units(text).iter().any(|stated| stated.is_clear) || unknown_unit(text).is_some()
}

impl Shape {
    /// What lines beside the table, and headings that are those of no value, state of units.
    pub(crate) fn statements<'s>(&'s self, want: &'s Want) -> impl Iterator<Item = AsideReading> {
        let asides = self.asides.iter().filter(|aside| !want.ignores(&aside.text)).cloned();
        let is_value = |text: &str| self.measurements.iter().any(|measurement| measurement.value.title == text);
        let titles = self.header.iter().filter(move |cell| !is_value(&cell.text()) && !want.ignores(&cell.text()));
        let header = self.header_line.unwrap_or_default();
        let titles = titles.map(move |cell| (header, cell));
        let columns = self.unknown.iter().filter(|unknown| unknown.column.is_some() && !want.ignores(&unknown.title));
        let remarks = columns.flat_map(|unknown| unknown.cells.iter().enumerate());
        let remarks = remarks.filter(|(_, cell)| !cell.is_number() && cell.text().contains(' '));
        let remarks = remarks.map(move |(row, cell)| (self.lines.get(row).copied().unwrap_or(header), cell));
        let said = titles.chain(remarks).filter(|(_, cell)| speaks_of_units(&cell.text()));
        asides.chain(said.map(|(line, cell)| AsideReading { line, text: cell.text().into_owned() }))
    }

    /// Gives values of which nothing else tells the unit the one that a line beside the table states, if no line states
    /// another.
    pub(super) fn take_stated_units(&mut self, want: &Want) {
        let stated: Vec<_> = self.statements(want).flat_map(|statement| stated_units(&statement.text)).collect();
        for measurement in &mut self.measurements {
            let is_angle = measurement.field.is_angle();
            let mut fitting = stated.iter().filter(|stated| matches!(stated.unit, Unit::Angle(_)) == is_angle);
            let first = fitting.clone().find(|stated| stated.is_clear).map(|stated| stated.unit);
            measurement.stated_unit = first.filter(|unit| fitting.all(|stated| stated.unit == *unit));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::AngleUnit;

    #[test]
    fn a_line_states_a_unit() {
        let [mm, um, inch] = [LengthUnit::Millimetre, LengthUnit::Micrometre, LengthUnit::Inch].map(Unit::Length);
        for (text, unit) in [
            ("Alle Maße in µm", um),
            ("(alle Angaben in mm)", mm),
            ("Einheit: mm", mm),
            ("Units of measure: inches", inch),
            ("Units: in", inch),
            ("Units in mm", mm),
            ("All dimensions are in mm, page 3", mm),
            ("単位：mm", mm),
            ("Toutes les cotes sont en µm.", um),
        ] {
            assert_eq!(stated_units(text), [StatedUnit { unit, is_clear: true }], "{text}");
        }
        let both = stated_units("units: mm, deg");
        assert_eq!(both.iter().map(|stated| stated.unit).collect::<Vec<_>>(), [mm, Unit::Angle(AngleUnit::Degree)]);
        for text in ["Werte siehe unten, Taster 3 mm", "Werte in my", "Alle Werte in Tabelle 3 geprüft"] {
            assert_eq!(stated_units(text), [], "{text}");
        }
        let both = stated_units("UNITS=IN,DEG");
        assert_eq!(both.iter().map(|stated| stated.unit).collect::<Vec<_>>(), [inch, Unit::Angle(AngleUnit::Degree)]);
        assert_eq!(["Werte in my", "単位：尺", "Werte in Ordnung"].map(unknown_unit), [Some("my"), Some("尺"), None]);
    }
}
