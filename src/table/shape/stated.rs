//! Units that a line beside a table states for all of it: `Alle Maße in µm`, `Units: mm`.

use super::{Shape, has_digit};
use crate::quantity::Unit;
use crate::table::names::{Role, has_stated_unit, role, stands_before_unit};
use crate::table::want::Want;

/// A unit in a line beside a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct StatedUnit {
    pub(crate) unit: Unit,
    /// Whether the line says of what: of units, values, dimensions.
    is_clear: bool,
}

/// The units that a line beside a table states for it: behind a word for units or values, or by themselves in a line
/// without numbers.
pub(crate) fn stated_units(text: &str) -> Vec<StatedUnit> {
    let words = text.split(|c: char| !c.is_alphanumeric() && !matches!(c, 'µ' | '°'));
    let words: Vec<String> = words.filter(|word| !word.is_empty()).map(str::to_lowercase).collect();
    let is_unit = |word: &String| Unit::from_symbol(word).is_some();
    let is_between = |word: &String| stands_before_unit(word);
    let unit_of = |at: usize| {
        let unit = Unit::from_symbol(&words[at])?;
        let mut before = words[..at].iter().rev().skip_while(|word| is_between(word) || is_unit(word));
        let is_subject = |word: &String| role(word) == Some(Role::Unit) || has_stated_unit(word);
        let is_clear = before.next().is_some_and(is_subject);
        let is_word = words[at].chars().count() > 1 && !matches!(words[at].as_str(), "in" | "min");
        // in mm: no inches
        let goes_on = is_between(&words[at]) && words[at + 1..].iter().any(is_unit);
        (!goes_on && (is_clear || is_word && !has_digit(text))).then_some(StatedUnit { unit, is_clear })
    };
    (0..words.len()).filter_map(unit_of).collect()
}

impl Shape {
    /// Gives values of which nothing else tells the unit the one that a line beside the table states, if no line states
    /// another.
    pub(super) fn take_stated_units(&mut self, want: &Want) {
        let asides = self.asides.iter().filter(|aside| !want.ignores(&aside.text));
        let stated: Vec<_> = asides.flat_map(|aside| stated_units(&aside.text)).collect();
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
    use crate::quantity::{AngleUnit, LengthUnit};

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
        assert_eq!(stated_units("Werte siehe unten, Taster 3 mm"), []);
    }
}
