//! What column headings mean, in English and German. Called by the layout; it knows words only, no values.

use crate::deviation::ErrorKind;
use crate::quantity::{AngleUnit, LengthUnit};

/// What a column or a row of a block holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// The part's name or number.
    PartId,
    /// One value per part.
    Error(ErrorKind),
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
    pub const ALL: [Self; 14] = [
        Self::PartId,
        Self::Error(ErrorKind::RackOverRoller),
        Self::Error(ErrorKind::RackPitch),
        Self::Error(ErrorKind::RackLead),
        Self::Error(ErrorKind::PinionRadial),
        Self::Error(ErrorKind::PinionPitch),
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

    /// Whether its values are angles.
    #[must_use]
    pub const fn is_angle(self) -> bool {
        matches!(self, Self::Lead | Self::Error(ErrorKind::RackLead))
    }
}

impl std::str::FromStr for Field {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|field| field.key() == text).ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|field| field.key()).collect();
            format!("it is none of {}", names.join(", "))
        })
    }
}

/// Whether a column holds the measured value itself or its deviation from nominal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// The value.
    Measured,
    /// Measured minus nominal.
    Deviation,
}

/// A column of a table with one row per characteristic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Name,
    Nominal,
    Measured,
    Deviation,
    Unit,
    /// Tolerances and verdicts, which the spec gives.
    Other,
}

/// What a heading says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Heading {
    pub(super) fields: Vec<Field>,
    pub(super) holds: Option<Holds>,
    pub(super) unit: Option<String>,
    pub(super) german: bool,
}

/// The words of a heading: lower case, umlauts and marks resolved.
fn words(text: &str) -> Vec<String> {
    let mut out = String::new();
    for c in text.chars().flat_map(char::to_lowercase) {
        match c {
            'ä' => out.push_str("ae"),
            'ö' => out.push_str("oe"),
            'ü' => out.push_str("ue"),
            'ß' => out.push_str("ss"),
            'δ' | '∆' => out.push_str("delta "),
            'β' => out.push_str("beta"),
            // f_p, F_pt
            '_' if out.ends_with(" f") || out == "f" => {}
            c if c.is_alphanumeric() || c == '#' => out.push(c),
            _ => out.push(' '),
        }
    }
    out.split_whitespace().map(str::to_owned).collect()
}

const GERMAN: &str = "zahn|ritzel|teil|schraeg|rollen|kugel|stift|mass|luecke|abweichung|abw|links|rechts|lage|ist|soll|nenn|\
                      merkmal|wert|flanken|mess|einheit|werkstueck|linke|rechte|fehler";
const DEVIATION: &str = "deviation|deviations|dev|error|errors|err|delta|diff|difference|abweichung|abw|fehler";
const MEASURED: &str = "measured|actual|act|ist|istwert|istmass|messwert|value|values|wert|gemessen";
const FILLING: &str = "of|the|der|des|an|am|in|at|per|flank|flanke|part|max";
/// Symbols that stand for a deviation by themselves.
const DEVIATION_SYMBOLS: &str = "dp|delta p|db|dbeta|delta beta|fp|fpt";

/// What headings call a value once the words for part, side and deviation are taken away, and what it is.
const NAMES: &[(&str, &[Field])] = &[
    (
        "over roller|over rollers|overroller|rollenmass|ueber rolle|ueber rollen|ueber kugel|mass ueber rolle|mass ueber rollen|measure over roller|\
         measurement over roller|dimension over roller|over ball|kugelmass|mass ueber kugel|einkugelmass|m|mor|roller",
        &[Field::Error(ErrorKind::RackOverRoller)],
    ),
    (
        "over pin|over pins|overpin|measure over pin|measurement over pin|ueber stift|mass ueber stift|stiftmass|pin|mop",
        &[Field::OverPin],
    ),
    (
        "pitch|teilung|teilungs|teilungseinzel|einzelteilung|einzelteilungs|single pitch|p",
        &[Field::Error(ErrorKind::RackPitch), Field::Error(ErrorKind::PinionPitch)],
    ),
    ("dp|delta p|axial pitch|axialteilung|axialteilungs", &[Field::Error(ErrorKind::RackPitch)]),
    ("fp|fpt", &[Field::Error(ErrorKind::PinionPitch)]),
    (
        "lead|lead angle|helix|helix angle|schraegung|schraegungs|schraegungswinkel|schraegungswinkels|\
         flankenlinienwinkel|flankenlinienwinkels|flankenlinien|dbeta|delta beta|db|beta",
        &[Field::Error(ErrorKind::RackLead)],
    ),
    ("radial|radius|radiale|radialer|radialmass|r|radial measure", &[Field::Error(ErrorKind::PinionRadial)]),
    ("position|pos|lage|x|x position|pin position|lueckenlage|zahnlage", &[Field::Position]),
    ("space|space no|space number|gap|luecke|luecken nr|luecke nr|luecken|zahnluecke|zahnluecke nr", &[Field::Space]),
    ("tooth|tooth no|tooth number|zahn|zahn nr|zahnnummer|zahnnr", &[Field::Tooth]),
    (
        "part id|part|part no|part number|partid|id|no|nr|#|serial|serial no|serial number|sn|teil|teil nr|teile nr|\
         teilenummer|teilenr|teilnummer|seriennummer|serien nr|werkstueck|werkstueck nr|bauteil|sample|probe|lfd nr|barcode",
        &[Field::PartId],
    ),
];

/// Whether `list` (words between bars) has `word`.
fn listed(list: &str, word: &str) -> bool {
    list.split('|').any(|entry| entry == word)
}

fn named(name: &str) -> Option<&'static [Field]> {
    NAMES.iter().find(|(names, _)| listed(names, name)).map(|(_, fields)| *fields)
}

/// Takes the words out that `list` has; whether there were any.
fn take(words: &mut Vec<String>, list: &str) -> bool {
    let before = words.len();
    words.retain(|word| !listed(list, word));
    words.len() < before
}

/// Takes the words for a deviation out, and off the ends of German compounds.
fn take_deviation(words: &mut Vec<String>) -> bool {
    let mut found = take(words, DEVIATION);
    for word in words.iter_mut() {
        let stem = ["abweichung", "fehler", "abw"].iter().find_map(|suffix| word.strip_suffix(suffix));
        if let Some(stem) = stem.filter(|stem| stem.len() > 2) {
            *word = stem.to_owned();
            found = true;
        }
    }
    found
}

/// Takes the words for a part out, and off the starts of German compounds.
fn take_part(words: &mut Vec<String>, list: &str, compound: &str) -> bool {
    let mut found = take(words, list);
    for word in words.iter_mut() {
        if let Some(rest) = word.strip_prefix(compound).filter(|rest| rest.len() > 2) {
            *word = rest.to_owned();
            found = true;
        }
    }
    found
}

/// A heading's name and its unit: `Teilung [µm]`, `pitch_mm`, `Teilung in µm`, `Teilung / µm`, `Teilung µm`.
pub(super) fn split_unit(text: &str) -> (String, Option<String>) {
    let bracketed = text.rfind(['[', '(']).and_then(|start| {
        let inside = &text[start + 1..];
        let end = inside.find([']', ')'])?;
        let name = format!("{} {}", &text[..start], &inside[end + 1..]);
        is_unit(&inside[..end]).then(|| (name, Some(inside[..end].trim().to_owned())))
    });
    if let Some(found) = bracketed {
        return found;
    }
    if let Some((stem, last)) = text.rsplit_once('_').filter(|(_, last)| is_unit(last)) {
        return (stem.to_owned(), Some(last.to_owned()));
    }
    match text.rsplit_once(char::is_whitespace) {
        Some((stem, last)) if is_unit(last) && !matches!(last, "in" | "'" | "\"") => {
            let stem = stem.trim_end();
            let name = stem.strip_suffix([',', '/']).or_else(|| stem.strip_suffix(" in")).unwrap_or(stem);
            (name.to_owned(), Some(last.to_owned()))
        }
        _ => (text.to_owned(), None),
    }
}

/// Understands a heading; `None` if it names nothing that is known. `own` are names that the spec gives
/// to its columns.
pub(super) fn heading(text: &str, own: &[(String, Field)]) -> Option<Heading> {
    let text = text.trim().trim_end_matches([':', '=']).trim();
    let (name, unit) = split_unit(text);
    let own_name = |candidate: &str| own.iter().find(|(name, _)| name.trim().eq_ignore_ascii_case(candidate.trim()));
    if let Some((_, field)) = own_name(text).or_else(|| own_name(&name)) {
        return Some(Heading { fields: vec![*field], holds: None, unit, german: false });
    }
    let mut words = words(&name);
    let german = words.iter().any(|word| GERMAN.split('|').any(|part| word.contains(part)));
    let whole = words.join(" ");
    let (mut rack, mut pinion, mut left, mut right) = (false, false, false, false);
    let (mut deviation, mut measured) = (listed(DEVIATION_SYMBOLS, &whole), false);
    let mut found = named(&whole);
    if found.is_none() {
        rack = take_part(&mut words, "rack|racks|zahnstange|zahnstangen|zst", "zahnstangen");
        pinion = take_part(&mut words, "pinion|pinions|ritzel|ritzels", "ritzel");
        left = take(&mut words, "left|lh|links|linke|linken|li");
        right = take(&mut words, "right|rh|rechts|rechte|rechten|re");
        let symbol = words.join(" ");
        deviation |= listed(DEVIATION_SYMBOLS, &symbol);
        found = named(&symbol);
    }
    if found.is_none() {
        deviation |= take_deviation(&mut words);
        measured = take(&mut words, MEASURED);
        take(&mut words, FILLING);
        found = named(&words.join(" "));
    }
    let fields = of_part(found?, (rack, pinion), (left, right))?;
    let holds = match (deviation, measured) {
        (true, _) => Some(Holds::Deviation),
        (false, true) => Some(Holds::Measured),
        (false, false) => None,
    };
    Some(Heading { fields, holds, unit, german })
}

/// Whether a heading names measured values. `own` are names that the spec gives to its columns.
#[must_use]
pub fn is_value_heading(text: &str, own: &[(String, Field)]) -> bool {
    heading(text, own).is_some_and(|heading| heading.fields.iter().any(|field| !field.is_index()))
}

/// What a heading of a table means, whoever wrote it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Meaning {
    /// What the column holds; several where the heading leaves it open.
    pub fields: Vec<Field>,
    /// Whether that is the value or its deviation, if the heading says so.
    pub holds: Option<Holds>,
    /// The unit, as it is written.
    pub unit: Option<String>,
}

/// What a heading means, in English or German; `None` if it names nothing that is known.
#[must_use]
pub fn meaning(text: &str) -> Option<Meaning> {
    heading(text, &[]).map(|Heading { fields, holds, unit, .. }| Meaning { fields, holds, unit })
}

/// The name and unit that a table of a rack's spaces or a pinion's teeth gives a column with that heading; `None` if it
/// names nothing of them, or leaves open which.
#[must_use]
pub fn heading_of_teeth(text: &str) -> Option<String> {
    let Meaning { fields, holds, unit } = meaning(text)?;
    let &[field] = fields.as_slice() else { return None };
    let deviation = holds == Some(Holds::Deviation);
    let name = match field {
        Field::Space => "space",
        Field::Tooth => "tooth",
        Field::OverPin | Field::Error(ErrorKind::RackOverRoller) if deviation => "over_pin_deviation",
        Field::OverPin | Field::Error(ErrorKind::RackOverRoller) => "over_pin",
        Field::Position if deviation => "position_deviation",
        Field::Position => "position",
        Field::Radial | Field::Error(ErrorKind::PinionRadial) => "radial_deviation",
        Field::LeftPitch => "left_pitch_deviation",
        Field::RightPitch => "right_pitch_deviation",
        Field::Lead | Field::Error(ErrorKind::RackLead) => "lead_deviation",
        Field::PartId | Field::Error(_) => return None,
    };
    Some(unit.map_or_else(|| name.to_owned(), |unit| format!("{name} [{unit}]")))
}

/// The fields that a heading can mean; none if it is not known.
pub(in crate::cmm) fn heading_fields(text: &str, own: &[(String, Field)]) -> Vec<Field> {
    heading(text, own).map_or_else(Vec::new, |heading| heading.fields)
}

/// The fields that a name leaves when it also says which part, or which flank.
fn of_part(fields: &[Field], (rack, pinion): (bool, bool), (left, right): (bool, bool)) -> Option<Vec<Field>> {
    if left || right {
        let pitch = fields.contains(&Field::Error(ErrorKind::PinionPitch)) && left != right && !rack;
        return pitch.then(|| vec![if left { Field::LeftPitch } else { Field::RightPitch }]);
    }
    let of_rack = |field: &Field| match field {
        Field::Error(kind) => {
            matches!(kind, ErrorKind::RackOverRoller | ErrorKind::RackPitch | ErrorKind::RackLead)
        }
        field => matches!(field, Field::Space | Field::OverPin | Field::Position),
    };
    let of_pinion = |field: &Field| match field {
        Field::Error(kind) => matches!(kind, ErrorKind::PinionRadial | ErrorKind::PinionPitch),
        field => matches!(field, Field::Tooth | Field::Radial),
    };
    // an over-pin measure of the pinion is nothing that a formula here takes
    let fits = |field: &&Field| (!pinion || !of_rack(field)) && (!rack || !of_pinion(field));
    let fields: Vec<Field> = fields.iter().filter(fits).copied().collect();
    (!fields.is_empty()).then_some(fields)
}

/// What a heading of a table with a row per characteristic says.
pub(super) fn role(text: &str) -> Option<Role> {
    let (name, _) = split_unit(text);
    Some(match words(&name).join(" ").as_str() {
        "characteristic" | "merkmal" | "feature" | "name" | "bezeichnung" | "element" | "parameter" | "item"
        | "description" | "dimension" | "groesse" | "pruefmerkmal" => Role::Name,
        "nominal" | "nom" | "nominal value" | "soll" | "sollwert" | "sollmass" | "nennmass" | "nennwert" | "nenn" => {
            Role::Nominal
        }
        "actual" | "act" | "measured" | "measurement" | "ist" | "istwert" | "istmass" | "messwert" | "result"
        | "measured value" | "value" | "wert" | "ergebnis" => Role::Measured,
        "deviation" | "dev" | "abweichung" | "abw" | "error" | "diff" | "difference" | "delta" => Role::Deviation,
        "unit" | "units" | "einheit" => Role::Unit,
        "upper" | "lower" | "usl" | "lsl" | "tol" | "tolerance" | "tol plus" | "tol minus" | "upper tol"
        | "lower tol" | "otol" | "utol" | "o tol" | "u tol" | "ogw" | "ugw" | "toleranz" | "oberes abmass"
        | "unteres abmass" | "status" | "out of tol" | "ok" | "bewertung" | "ausser tol" | "comment" | "bemerkung" => {
            Role::Other
        }
        _ => return None,
    })
}

/// Whether a text is a unit of length or angle.
pub(super) fn is_unit(text: &str) -> bool {
    let text = text.trim().trim_start_matches(['[', '(']).trim_end_matches([']', ')']);
    LengthUnit::from_symbol(text).is_some() || AngleUnit::from_symbol(text).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(text: &str) -> String {
        heading(text, &[]).map_or_else(String::new, |heading| {
            let keys: Vec<_> = heading.fields.iter().map(|field| field.key()).collect();
            let holds = match heading.holds {
                Some(Holds::Deviation) => " deviation",
                Some(Holds::Measured) => " measured",
                None => "",
            };
            let unit = heading.unit.map_or_else(String::new, |unit| format!(" {unit}"));
            format!("{}{holds}{unit}", keys.join("|"))
        })
    }

    #[test]
    fn headings_in_two_languages() {
        for (text, expected) in [
            ("rack_over_roller", "rack_over_roller"),
            ("Rack over roller [mm]", "rack_over_roller mm"),
            ("Rollenmaß [mm]", "rack_over_roller mm"),
            ("Maß über Rolle", "rack_over_roller"),
            ("Kugelmaß-Abweichung (µm)", "rack_over_roller deviation µm"),
            ("dp [µm]", "rack_pitch deviation µm"),
            ("Δp / µm", "rack_pitch deviation µm"),
            ("lead (deg)", "rack_lead deg"),
            ("Schrägungswinkelabweichung [°]", "rack_lead deviation °"),
            ("Pitch", "rack_pitch|pinion_pitch"),
            ("rack pitch error", "rack_pitch deviation"),
            ("Teilungsabweichung Ritzel in µm", "pinion_pitch deviation µm"),
            ("Ritzelteilung", "pinion_pitch"),
            ("f_p [um]", "pinion_pitch deviation um"),
            ("Radialmaß Ritzel", "pinion_radial"),
            ("pinion_radial_mm", "pinion_radial mm"),
            ("over_pin_deviation [um]", "over_pin deviation um"),
            ("Lücke", "space"),
            ("Abweichung über Stift [µm]", "over_pin deviation µm"),
            ("Zahn-Nr.", "tooth"),
            ("fp links [µm]", "left_pitch deviation µm"),
            ("left_pitch_deviation", "left_pitch deviation"),
            ("Teilung rechte Flanke", "right_pitch"),
            ("Teile-Nr.", "part_id"),
            ("Δβ:", "rack_lead deviation"),
            ("Position (Ist) [mm]", "position measured mm"),
            ("Hallo Herr Meier", ""),
            ("Temperatur [°C]", ""),
        ] {
            assert_eq!(fields(text), expected, "{text}");
        }
    }
}
