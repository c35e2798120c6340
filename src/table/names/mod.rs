//! What headings, labels and names of characteristics mean, in English, German, French and Japanese. Called by the
//! readers of tables; it knows words only, no values.
//!
//! [`heading`] understands names, [`role`] the columns of a table with a row per characteristic. Of a name that is not
//! understood, [`near`] tells what it may have meant, and [`is_context`] whether it is known to be something else.

mod letters;
mod near;
mod role;
mod title;
mod unit;
mod vocabulary;
mod words;

pub(crate) use letters::{plain_widths, says_more};
pub(crate) use near::{
    is_context, is_gear_size, is_other_of_flank, is_tolerance, is_total, near, part_said, says_deviation, says_largest,
};
pub(crate) use role::{
    is_again, is_apart, is_called_spread, is_known_word, is_of_parts, is_statistic, may_be_of_parts, names_page,
    repeats_value, role, says_which, statistic_word,
};
pub(crate) use title::part_in_title;
pub(crate) use unit::{BETWEEN_LIMITS, LIMIT_MARKS, split_unit, split_wanted};

use crate::deviation::{DeviationKind, Part};
use vocabulary::{Entry, Sense};
pub(crate) use vocabulary::{Role, WordList};
use words::Words;

/// What a column or a row of a block holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// The part's name or number.
    PartId,
    /// One value per part.
    Error(DeviationKind),
    /// Number of a rack's space.
    Space,
    /// Measure over the pin in one space.
    OverPin,
    /// Position of the pin in one space.
    Position,
    /// Number of a pinion's tooth.
    Tooth,
    /// Radial deviation of the space after a tooth.
    Radial,
    /// Single pitch deviation of a left flank.
    LeftPitch,
    /// Single pitch deviation of a right flank.
    RightPitch,
    /// Helix angle deviation of a space or tooth.
    Lead,
}

impl Field {
    /// The name by which `--as` asks for it and the account of a block calls it.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::PartId => "part_id",
            Self::Error(kind) => kind.key(),
            Self::Space => "space",
            Self::OverPin => "over_pin",
            Self::Position => "position",
            Self::Tooth => "tooth",
            Self::Radial => "radial",
            Self::LeftPitch => "left_pitch",
            Self::RightPitch => "right_pitch",
            Self::Lead => "lead",
        }
    }

    /// Every field that can be asked for.
    pub const ALL: [Self; 15] = [
        Self::PartId,
        Self::Error(DeviationKind::RackOverRoller),
        Self::Error(DeviationKind::RackPitch),
        Self::Error(DeviationKind::RackLead),
        Self::Error(DeviationKind::PinionRadial),
        Self::Error(DeviationKind::PinionPitch),
        Self::Error(DeviationKind::PinionLead),
        Self::Space,
        Self::OverPin,
        Self::Position,
        Self::Tooth,
        Self::Radial,
        Self::LeftPitch,
        Self::RightPitch,
        Self::Lead,
    ];

    /// Whether the column holds whole numbers or names rather than measured values.
    #[must_use]
    pub const fn is_index(self) -> bool {
        matches!(self, Self::PartId | Self::Space | Self::Tooth)
    }

    /// Whether it is one of a pinion's teeth, and of no rack's spaces.
    pub(crate) const fn is_of_tooth(self) -> bool {
        matches!(
            self,
            Self::Tooth | Self::LeftPitch | Self::RightPitch | Self::Radial | Self::Error(DeviationKind::PinionRadial)
        )
    }

    /// Whether it is a size or an angle of a space or tooth.
    pub(crate) const fn is_of_space_or_tooth(self) -> bool {
        matches!(self, Self::OverPin | Self::Position | Self::Radial | Self::LeftPitch | Self::RightPitch | Self::Lead)
    }

    /// Whether its values are deviations, whatever it is called.
    pub(crate) const fn is_deviation(self) -> bool {
        matches!(self, Self::Radial | Self::LeftPitch | Self::RightPitch | Self::Lead)
    }

    /// Whether its values are angles.
    #[must_use]
    pub const fn is_angle(self) -> bool {
        matches!(self, Self::Lead | Self::Error(DeviationKind::RackLead))
    }

    /// The error that it is, in a table with a row per part.
    pub(crate) const fn kind(self) -> Option<DeviationKind> {
        match self {
            Self::Error(kind) => Some(kind),
            Self::OverPin => Some(DeviationKind::RackOverRoller),
            Self::Lead => Some(DeviationKind::RackLead),
            Self::Radial => Some(DeviationKind::PinionRadial),
            Self::PartId | Self::Space | Self::Position | Self::Tooth | Self::LeftPitch | Self::RightPitch => None,
        }
    }
}

impl From<DeviationKind> for Field {
    fn from(kind: DeviationKind) -> Self {
        Self::Error(kind)
    }
}

/// A name that is that of no field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it is none of {}", Field::ALL.map(Field::key).join(", "))]
pub struct UnknownField;

impl std::str::FromStr for Field {
    type Err = UnknownField;

    fn from_str(text: &str) -> Result<Self, UnknownField> {
        Self::ALL.into_iter().find(|field| field.key() == text).ok_or(UnknownField)
    }
}

/// Whether a column holds the measured value itself or its deviation from nominal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValueKind {
    /// The value.
    Measured,
    /// Measured minus nominal.
    Deviation,
}

/// What a heading says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Heading {
    /// What the column is about; several where the heading leaves it open.
    pub(crate) fields: Vec<Field>,
    /// What it says of that; `Measured` where it holds values, or the deviations that they are.
    pub(crate) aspect: Role,
    /// Whether values are measured values or deviations, if the heading says so.
    pub(crate) holds: Option<ValueKind>,
    /// The unit as it is written, known or not.
    pub(crate) unit: Option<String>,
}

impl Heading {
    /// Whether it names parts, spaces or teeth, and no value of them.
    pub(crate) fn is_index(&self) -> bool {
        self.fields.iter().all(|field| field.is_index())
    }
}

/// Understands a heading or label; `None` if it names nothing that is known. `own` are names that the spec gives to its
/// columns, which mean what it says whatever else they could mean.
pub(crate) fn heading(text: &str, own: &[(String, Field)]) -> Option<Heading> {
    let text = bare(text);
    let (name, unit) = split_unit(text);
    if let Some(field) = own_field(text, &name, own) {
        return Some(Heading { fields: vec![field], aspect: Role::Measured, holds: None, unit });
    }
    if let Some(beside) = beside_own(&name, unit.as_ref(), own) {
        return Some(beside);
    }
    let name = split_wanted(&name).map_or(name.as_str(), |wanted| wanted.name);
    let whole = without_roller(without_temperature(without_ordinal(name)));
    let name = without_count(whole);
    // a bound is no value, nor is a mean
    if has_total_pitch(name)
        || text.contains('\u{304}')
        || plain_widths(name).contains(['<', '>', '|'])
        || is_signed(text)
    {
        return None;
    }
    let known = Words::of(name).known()?;
    let senses = senses(&known)?;
    let aspect = aspect(&senses)?;
    let fields = fields(&senses)?;
    // a pitch of one tooth is no pitch of a part
    if name.len() < whole.len() && fields != [Field::Error(DeviationKind::RackOverRoller)] {
        return None;
    }
    let said = senses.iter().any(|sense| matches!(sense, Sense::Deviation | Sense::Measured));
    let heading = Heading { fields, aspect, holds: holds(&senses), unit };
    let is_value = said || aspect != Role::Measured;
    Some(heading).filter(|heading| !(heading.is_index() && is_value))
}

/// Whether a sign stands before a name, so that its values are the other way round: `-ΔM`, `(-) ΔM`.
fn is_signed(text: &str) -> bool {
    ["-Δ", "–Δ", "−Δ", "(-)", "(–)", "(−)"].into_iter().any(|sign| text.starts_with(sign))
}

/// A text without the blanks and marks around it.
fn bare(text: &str) -> &str {
    text.trim().trim_end_matches([':', '=', '.', '：', '…']).trim()
}

fn same(a: &str, b: &str) -> bool {
    a.trim().to_lowercase() == b.trim().to_lowercase()
}

/// Whether a title is a name that the spec gives, with its unit or without.
pub(crate) fn is_called(title: &str, own: &str) -> bool {
    let name = split_unit(bare(title)).0;
    same(own, title) || same(own, bare(title)) || same(own, &name) || same(&split_unit(own).0, &name)
}

/// The field of a name that the spec gives, with its unit or without.
fn own_field(text: &str, name: &str, own: &[(String, Field)]) -> Option<Field> {
    let with = |matches: &dyn Fn(&str) -> bool| own.iter().find(|(own, _)| matches(own)).map(|(_, field)| *field);
    with(&|own| same(own, text))
        .or_else(|| with(&|own| same(own, name)))
        .or_else(|| with(&|own| same(&split_unit(own).0, name)))
}

/// What stands beside a column that the spec names, by a word behind or before the name: `M1 Soll`.
fn beside_own(name: &str, unit: Option<&String>, own: &[(String, Field)]) -> Option<Heading> {
    let name = name.trim().to_lowercase();
    own.iter().find_map(|(own, field)| {
        let own = split_unit(own).0.trim().to_lowercase();
        let said = name.strip_prefix(&own).or_else(|| name.strip_suffix(&own))?;
        let aspect = role(said).filter(|role| role.is_beside_value() && !own.is_empty())?;
        Some(Heading { fields: vec![*field], aspect, holds: None, unit: unit.cloned() })
    })
}

/// A text without its unit and its number in a list.
fn name_of(text: &str) -> String {
    let (name, _) = split_unit(bare(text));
    without_ordinal(&name).to_owned()
}

/// A name without its number in a list: `003 Pitch error`, `12. Rollenmaß`, `#4 fp`, `Pos. 3 Rollenmaß`.
fn without_ordinal(name: &str) -> &str {
    let name = name.trim();
    let word = name.find(|c: char| !c.is_alphabetic()).unwrap_or(name.len());
    let counts = matches!(name[..word].to_lowercase().as_str(), "pos" | "nr" | "no" | "item" | "merkmal" | "char");
    let number = if counts { name[word..].trim_start_matches(['.', ' ']) } else { name };
    let number = number.trim_start_matches(['#', '(']).trim_start();
    let rest = number.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
    let after = rest.trim_start_matches([')', ':', ' ', '_', '\u{a0}', '\t']);
    let counted = number.starts_with(|c: char| c.is_ascii_digit());
    let apart = after.len() < rest.len() || number[..number.len() - rest.len()].ends_with('.');
    if counted && apart && after.starts_with(char::is_alphabetic) { after } else { name }
}

/// A name without the number of the first measurement behind it: `Rollenmaß 1`. A second one may be another measure.
fn without_count(name: &str) -> &str {
    name.strip_suffix(" 1").unwrap_or(name)
}

/// A name without the temperature at which all sizes are meant: `Rollenmaß bei 20 °C`.
fn without_temperature(name: &str) -> &str {
    let bare = name.trim_end_matches(')');
    let blanks = [' ', '(', '\u{a0}'];
    let before = bare.strip_suffix("20 °C").or_else(|| bare.strip_suffix("20°C"));
    let before = before.filter(|before| before.ends_with(blanks));
    before.map_or(name, |before| before.trim_end_matches(blanks))
}

/// A name without the size of the roller behind it, or the symbol of what is measured over it: `Rollenmaß D4`,
/// `Rollenmaß (Rolle 4 mm)`, `Dimension over roller MdR`.
fn without_roller(name: &str) -> &str {
    let Some((before, behind)) = name.rsplit_once('(').or_else(|| name.rsplit_once(' ')) else { return name };
    let behind = behind.trim_end_matches(')').to_lowercase();
    let size = behind
        .trim_end_matches("mm")
        .trim_end_matches(|c: char| c.is_ascii_digit() || matches!(c, ' ' | '.' | ',' | '='));
    let is_size = size.len() < behind.trim_end_matches("mm").trim_end().len()
        && matches!(size, "d" | "ø" | "dm" | "rolle" | "roller" | "kugel" | "ball" | "rouleau" | "bille");
    if is_size || behind == "mdr" { before.trim_end() } else { name }
}

/// Whether it speaks of F_p, which adds up what f_p is of a single tooth; in capitals, it may be either, and its index may stand
/// apart, as where a text is copied: `F p`, `F_{p}`.
fn has_total_pitch(name: &str) -> bool {
    let name = plain_widths(name);
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    words.iter().any(|word| matches!(*word, "Fp" | "FP"))
        || words.windows(2).any(|pair| matches!(pair, ["F", "p" | "P"]))
}

/// What each word means beside the others; `None` if one has no meaning in a heading. `M` beside a name is one, too: of
/// another field, it makes the heading one that is not understood.
fn senses(known: &[&'static Entry]) -> Option<Vec<Sense>> {
    let names = |sense: &Sense| matches!(sense, Sense::Name(_) | Sense::Error(_));
    let named = known.iter().flat_map(|word| &word.senses).any(names);
    let alone = |sense: &Sense| matches!(sense, Sense::Alone(_));
    let sense = |word: &Entry| {
        let usable = word.senses.iter().copied().filter(|sense| !sense.is_foreign());
        let first = usable.clone().find(|sense| alone(sense) != named);
        first.or_else(|| usable.clone().next())
    };
    known.iter().map(|word| sense(word)).collect()
}

/// What the column says of its field; `None` where the words contradict each other or do not tell.
fn aspect(senses: &[Sense]) -> Option<Role> {
    let has = |sense: Sense| senses.contains(&sense);
    let tolerance = has(Sense::Tolerance) || has(Sense::Limit);
    let upper = has(Sense::Upper) || (has(Sense::Plus) && tolerance);
    let lower = has(Sense::Lower) || (has(Sense::Minus) && tolerance);
    let deviation = has(Sense::Deviation) || senses.iter().any(|sense| matches!(sense, Sense::Error(_)));
    if (upper && lower)
        || (has(Sense::Plus) && !upper)
        || (senses.iter().skip(1).any(|sense| *sense == Sense::Minus) && !lower)
        || (has(Sense::Limit) && !upper && !lower)
        || (has(Sense::Nominal) && has(Sense::Measured))
        || ((has(Sense::Greatest) || has(Sense::Largest)) && !deviation)
    {
        return None;
    }
    Some(if has(Sense::Uncertainty) && !has(Sense::Tolerance) {
        Role::Uncertainty
    } else if upper {
        Role::Upper
    } else if lower {
        Role::Lower
    } else if tolerance {
        Role::Upper
    } else if has(Sense::Nominal) {
        Role::Nominal
    } else {
        Role::Measured
    })
}

fn holds(senses: &[Sense]) -> Option<ValueKind> {
    if senses.iter().any(|sense| matches!(sense, Sense::Deviation | Sense::Error(_))) {
        return Some(ValueKind::Deviation);
    }
    senses.contains(&Sense::Measured).then_some(ValueKind::Measured)
}

/// The fields that all names among the words can mean, of the part and the flank that they say; `None` if there is none.
fn fields(senses: &[Sense]) -> Option<Vec<Field>> {
    let mut fields: Option<Vec<Field>> = None;
    for sense in senses {
        if let Sense::Name(named) | Sense::Error(named) | Sense::Alone(named) = sense {
            let both = |so_far: Vec<Field>| so_far.into_iter().filter(|field| named.contains(field)).collect();
            fields = Some(fields.map_or_else(|| named.to_vec(), both));
        }
    }
    let has = |sense: Sense| senses.contains(&sense);
    let fields = fields?;
    let (left, right) = (has(Sense::Left), has(Sense::Right));
    if left || right {
        let pitch = fields.contains(&Field::Error(DeviationKind::PinionPitch)) && left != right && !has(Sense::Rack);
        return pitch.then(|| vec![if left { Field::LeftPitch } else { Field::RightPitch }]);
    }
    let fits = |field: &Field| {
        let of_said = (!has(Sense::Pinion) || !of_rack(*field)) && (!has(Sense::Rack) || !of_pinion(*field));
        let is_open = has(Sense::Pinion) || !needs_part(*field);
        of_said && (is_open || has(Sense::Rack) && of_rack(*field))
    };
    let fields: Vec<Field> = fields.into_iter().filter(fits).collect();
    (!fields.is_empty()).then_some(fields)
}

fn of_rack(field: Field) -> bool {
    match field {
        Field::Error(kind) => kind.part() == Part::Rack,
        // an over-pin measure of the pinion is nothing that a formula here takes
        field => matches!(field, Field::Space | Field::OverPin | Field::Position),
    }
}

fn of_pinion(field: Field) -> bool {
    match field {
        Field::Error(kind) => kind.part() == Part::Pinion,
        field => matches!(field, Field::Tooth | Field::Radial),
    }
}

/// Whether a name means it only where its part is said: a lead is the rack's otherwise.
fn needs_part(field: Field) -> bool {
    field == Field::Error(DeviationKind::PinionLead)
}

/// Whether a heading names a value or what belongs to one, and not only a part. `own` are names that the spec gives.
pub(crate) fn names_value(text: &str, own: &[(String, Field)]) -> bool {
    heading(text, own).is_some_and(|heading| !heading.is_index())
}

/// Whether a heading names measured values, and not only places. `own` are names that the spec gives to its columns.
pub(crate) fn is_value_heading(text: &str, own: &[(String, Field)]) -> bool {
    let is_value = |field: &Field| !field.is_index() && *field != Field::Position;
    let names_value = |heading: &Heading| heading.aspect == Role::Measured && heading.fields.iter().any(is_value);
    heading(text, own).is_some_and(|heading| names_value(&heading))
}

#[cfg(test)]
mod tests;
