//! The known headings: one list that a reviewer can read in five minutes (`dictionary.txt`), and the keys. Only a whole heading has
//! a meaning; parts of headings, similar headings and their order have none.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::LazyLock;

use super::field::{Beside, Field};
use crate::quantity::Unit;

/// What a column or a characteristic is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// The part's name.
    PartId,
    /// The decision of a measuring program.
    Status,
    /// The measured value or the deviation of an error, or of a space or tooth.
    Value(Field),
    /// What stands beside such a value in a column of its own.
    Beside(Field, Beside),
    /// The number of a space or tooth.
    Index(Field),
    /// A property of the characteristic that its row names.
    Of(Beside),
}

impl Role {
    /// Whether a contract that names it means tables of that form.
    pub(crate) fn is_of(self, form: Form) -> bool {
        match self {
            Self::PartId | Self::Status => form != Form::Trace,
            Self::Index(_) => matches!(form, Form::Parts | Form::Teeth),
            Self::Of(_) => form == Form::Characteristics,
            Self::Value(field) | Self::Beside(field, _) => {
                form != Form::Characteristics && field.is_of_trace() == (form == Form::Trace)
            }
        }
    }
}

/// What a heading means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Meaning {
    pub(crate) role: Role,
    /// Whether the heading says that the values are deviations.
    pub(crate) is_deviation: bool,
    /// Whether the heading is the role's key.
    pub(crate) is_key: bool,
}

/// A heading and the unit that is split off it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Heading {
    /// The name, as the table writes it.
    pub(crate) name: String,
    /// The unit, known or not.
    pub(crate) unit: Option<String>,
}

/// The form of the table whose headings are looked up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(crate) enum Form {
    /// Values of parts: headings of columns, or names of characteristics.
    #[default]
    Parts,
    /// Values of spaces or teeth.
    Teeth,
    /// The columns of a table with a row per characteristic.
    Characteristics,
    /// The points of a measured curve.
    Trace,
}

/// What a heading means in tables of each form.
static DICTIONARY: LazyLock<HashMap<String, [Option<Meaning>; 4]>> = LazyLock::new(|| {
    let mut found: HashMap<String, [Option<Meaning>; 4]> = HashMap::new();
    let mut add = |form: Form, name: String, meaning| found.entry(name).or_default()[form as usize] = Some(meaning);
    for (written, headings) in rows() {
        let Some((form, role, is_deviation)) = role_of(written) else { continue };
        headings.split(", ").for_each(|name| add(form, normal(name), meaning(role, is_deviation, false)));
    }
    keys().for_each(|((form, name), meaning)| add(form, name, meaning));
    found
});

/// The rows of the list: a role and its headings.
fn rows() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = include_str!("dictionary.txt").lines().filter(|line| !line.starts_with('#'));
    lines.filter_map(|line| line.split_once(';'))
}

/// The keys, each of which is a heading too.
fn keys() -> impl Iterator<Item = ((Form, String), Meaning)> {
    Field::ALL.into_iter().flat_map(|field| {
        let (form, role) = match field {
            Field::PartId => (Form::Parts, Role::PartId),
            Field::Error(_) => (Form::Parts, Role::Value(field)),
            _ if field.is_of_trace() => (Form::Trace, Role::Value(field)),
            _ if field.is_index() => (Form::Teeth, Role::Index(field)),
            _ => (Form::Teeth, Role::Value(field)),
        };
        let own = ((form, field.key().to_owned()), meaning(role, field.is_deviation(), true));
        let of_tooth = form == Form::Teeth && !field.is_index();
        let deviation = of_tooth.then(|| ((form, format!("{}_deviation", field.key())), meaning(role, true, true)));
        std::iter::once(own).chain(deviation)
    })
}

const fn meaning(role: Role, is_deviation: bool, is_key: bool) -> Meaning {
    Meaning { role, is_deviation, is_key }
}

/// The form of table, the role, and whether values are deviations, from the first column of the list.
fn role_of(written: &str) -> Option<(Form, Role, bool)> {
    if let Some(beside) = written.trim().strip_prefix("characteristic ") {
        return Some((Form::Characteristics, Role::Of(Beside::of_key(beside)?), false));
    }
    let (name, is_deviation) =
        written.trim().strip_suffix(" deviation").map_or((written.trim(), false), |name| (name, true));
    let field: Field = name.parse().ok()?;
    Some(match field {
        Field::PartId => (Form::Parts, Role::PartId, false),
        Field::Error(_) => (Form::Parts, Role::Value(field), is_deviation),
        _ if field.is_of_trace() => (Form::Trace, Role::Value(field), false),
        _ if field.is_index() => (Form::Teeth, Role::Index(field), false),
        _ => (Form::Teeth, Role::Value(field), is_deviation || field.is_deviation()),
    })
}

/// The longest name that is looked up, in bytes.
pub(crate) const LONGEST_KNOWN: usize = 100;

/// What a heading means in tables of each form, with an underscore and with a blank in its place; nothing if its whole name is neither in
/// the list nor a key.
pub(crate) struct Known([Option<&'static [Option<Meaning>; 4]>; 2]);

impl Known {
    pub(crate) fn of(name: &str) -> Self {
        // no heading of the list is half as long or has a digit, and most cells of a table have one
        if name.len() > LONGEST_KNOWN || name.bytes().any(|byte| byte.is_ascii_digit()) {
            return Self([None; 2]);
        }
        let normal = normal(name);
        let apart = normal.contains('_').then(|| normal.replace('_', " "));
        Self([Some(&normal), apart.as_ref()].map(|name| DICTIONARY.get(name?)))
    }

    /// The meaning in a table of that form. The names of parts and of their errors are known in tables of teeth too, the name of parts in
    /// tables of characteristics.
    pub(crate) fn meaning(&self, form: Form) -> Option<Meaning> {
        let of = |form: Form| self.0.iter().flatten().find_map(|meanings| meanings[form as usize]);
        let of_parts =
            || of(Form::Parts).filter(|meaning| form != Form::Characteristics || meaning.role == Role::PartId);
        // a measured curve has no errors of parts
        of(form).or_else(|| of_parts().filter(|_| form != Form::Trace))
    }
}

/// What a heading means in a table of that form.
pub(crate) fn lookup(form: Form, name: &str) -> Option<Meaning> {
    Known::of(name).meaning(form)
}

/// Whether a heading is known in tables of any form.
pub(crate) fn is_known(name: &str) -> bool {
    Known::of(name).0.iter().any(Option::is_some)
}

/// The known headings of a role, in the form in which headings are compared.
pub(crate) fn headings_of(role: Role) -> impl Iterator<Item = &'static str> {
    let has = move |meanings: &[Option<Meaning>; 4]| meanings.iter().flatten().any(|meaning| meaning.role == role);
    DICTIONARY.iter().filter(move |(_, meanings)| has(meanings)).map(|(heading, _)| heading.as_str())
}

/// Full-width letters as plain ones, half-width katakana as full ones, their marks joined to them.
pub(crate) fn plain_widths(text: &str) -> Cow<'_, str> {
    const KATAKANA: &str = "ヲァィゥェォャュョッーアイウエオカキクケコサシスセソタチツテトナニヌネノハヒフヘホマミムメモヤユヨラリルレロワン";
    // all of them are beyond U+3000
    if text.bytes().fold(0, u8::max) < 0xe3 {
        return text.into();
    }
    let katakana = |c: char| KATAKANA.chars().nth(c as usize - 0xff66);
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\u{ff9e}' | '\u{3099}' | '\u{ff9f}' | '\u{309a}' => {
                let step = if matches!(c, '\u{ff9e}' | '\u{3099}') { 1 } else { 2 };
                let last = out.chars().next_back().filter(|last| ('\u{3041}'..='\u{30ff}').contains(last));
                if let Some(joined) = last.and_then(|last| char::from_u32(last as u32 + step)) {
                    out.pop();
                    out.push(joined);
                }
            }
            '\u{ff01}'..='\u{ff5e}' => out.extend(char::from_u32(c as u32 - 0xfee0)),
            '\u{ff66}'..='\u{ff9d}' => out.extend(katakana(c)),
            '\u{3000}' => out.push(' '),
            c => out.push(c),
        }
    }
    out.into()
}

/// A heading in the form in which headings are compared: plain widths, small letters, single blanks, blanks for dots and for hyphens
/// between letters, no colon at its end.
pub(crate) fn normal(name: &str) -> String {
    // only their case tells Fp, the total deviation, from fp, the single one
    let is_total = |word: &str| matches!(word, "Fp" | "FP");
    if name.bytes().all(|byte| byte.is_ascii_alphabetic()) && !is_total(name) {
        return name.to_ascii_lowercase();
    }
    let word = |word: &str| if is_total(word) { "Fp".to_owned() } else { word.to_lowercase() };
    let words = plain_widths(name).split_whitespace().map(word).collect::<Vec<_>>().join(" ");
    if !words.contains(['-', '.']) {
        return words.trim_end_matches([':', ' ']).to_owned();
    }
    let plain: Vec<char> = words.chars().collect();
    let is_letter = |at: Option<usize>| at.and_then(|at| plain.get(at)).is_some_and(|c| c.is_alphabetic());
    let joins = |at: usize| plain[at] == '-' && is_letter(at.checked_sub(1)) && is_letter(Some(at + 1));
    let spaced = (0..plain.len()).map(|at| if joins(at) || plain[at] == '.' { ' ' } else { plain[at] });
    let text: String = spaced.collect();
    text.split_whitespace().collect::<Vec<_>>().join(" ").trim_end_matches([':', ' ']).to_owned()
}

/// Bytes of the longest heading that is read: longer ones are refused.
pub(crate) const LONGEST_HEADING: usize = 1000;

impl Heading {
    /// Splits the unit off a heading. What stands in square brackets at its end is the unit, known or not. What stands in round
    /// brackets, or behind a blank, a slash, a comma or an underscore, is the unit if it is known.
    pub(crate) fn of(title: &str) -> Self {
        if title.len() > LONGEST_HEADING {
            return Self { name: title.to_owned(), unit: None };
        }
        let text = plain_widths(title);
        let text = text.trim().trim_end_matches(':').trim_end();
        let within = |open: char, close: char| text.strip_suffix(close)?.rsplit_once(open);
        let is_known = |unit: &str| Unit::from_symbol(unit).is_some();
        let bracketed = within('[', ']').or_else(|| within('(', ')').filter(|(_, unit)| is_known(in_words(unit))));
        // `in` may be the word, `m` a name and `min` the minimum
        let is_clear =
            |unit: &str| is_known(unit) && !matches!(unit, "in" | "IN" | "m" | "M" | "min" | "\"" | "'" | "sec");
        let split =
            bracketed.or_else(|| text.rsplit_once([' ', '/', '_', ',']).filter(|(_, unit)| is_clear(unit.trim())));
        let Some((name, unit)) = split.filter(|(name, _)| !name.trim().is_empty()) else {
            return Self { name: text.to_owned(), unit: None };
        };
        let name = name.trim_end_matches([' ', ',', '/']);
        let name = name.strip_suffix(" in").unwrap_or(name).trim_end();
        Self { name: name.to_owned(), unit: Some(in_words(unit).to_owned()) }
    }
}

/// The unit without the word `in` before it: `in µm` is µm.
fn in_words(unit: &str) -> &str {
    let unit = unit.trim();
    unit.strip_prefix("in ").unwrap_or(unit).trim()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::DeviationKind;

    #[test]
    fn whole_headings_have_a_meaning_and_nothing_else() {
        let role = |name: &str| lookup(Form::Parts, name).map(|meaning| meaning.role);
        for (name, expected) in [
            ("part_id", Some(Role::PartId)),
            ("Teile-Nr.:", Some(Role::PartId)),
            ("Teil-Nr.", Some(Role::PartId)),
            ("SERIAL NO.", Some(Role::PartId)),
            ("Rollenmaß", Some(Role::Value(Field::Error(DeviationKind::RackOverRoller)))),
            ("Rack pitch error", Some(Role::Value(Field::Error(DeviationKind::RackPitch)))),
            ("ﾗｯｸﾋﾟｯﾁ", Some(Role::Value(Field::Error(DeviationKind::RackPitch)))),
            ("Istwert", None),
            ("pitch", None),
            ("fp", None),
            ("Fp links", None),
            ("Rollenmaß 2", None),
            ("Rollenmaß links", None),
            ("", None),
        ] {
            assert_eq!(role(name), expected, "{name}");
        }
        assert!(
            lookup(Form::Parts, "rack_pitch").unwrap().is_key
                && lookup(Form::Parts, "Rack pitch error").unwrap().is_deviation
        );
    }

    #[test]
    fn the_list_has_no_heading_twice_and_stays_short() {
        let rows: Vec<_> = rows().collect();
        let headings: Vec<_> = rows
            .iter()
            .flat_map(|(role, headings)| {
                let form = role_of(role).unwrap_or_else(|| panic!("{role}")).0;
                headings.split(", ").map(move |name| (form, normal(name)))
            })
            .collect();
        let distinct: std::collections::HashSet<_> = headings.iter().collect();
        assert_eq!(headings.len(), distinct.len());
        assert!(headings.iter().all(|(_, name)| name.len() < 50 && !name.contains(|c: char| c.is_ascii_digit())));
        assert!(rows.len() <= 60 && headings.len() <= 300, "{} rows, {} headings", rows.len(), headings.len());
    }

    #[test]
    fn units_of_headings() {
        for (title, name, unit) in [
            ("Teilung [µm]", "Teilung", Some("µm")),
            ("Teilung (µm)", "Teilung", Some("µm")),
            ("Teilung [in µm]", "Teilung", Some("µm")),
            ("Teilung in µm", "Teilung", Some("µm")),
            ("Teilung, µm:", "Teilung", Some("µm")),
            ("pitch_um", "pitch", Some("um")),
            ("rack_pitch", "rack_pitch", None),
            ("Temp. [°C]", "Temp.", Some("°C")),
            ("Kraft (N)", "Kraft (N)", None),
            ("check in", "check in", None),
            ("mm", "mm", None),
            ("[mm]", "[mm]", None),
            ("", "", None),
        ] {
            assert_eq!(Heading::of(title), Heading { name: name.to_owned(), unit: unit.map(str::to_owned) }, "{title}");
        }
    }
}
