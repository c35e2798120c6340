//! Where a heading ends and its unit begins.

use super::letters::plain_widths;
use super::vocabulary::is_japanese;
use super::words::Words;
use crate::quantity::Unit;

/// Units of what is no length and no angle.
const OTHER: &str = "°C|°F|℃|N|kN|mN|Nm|N·m|Ncm|g|kg|mg|s|ms|h|%|‰|HRC|HV|HB|bar|mbar|Pa|kPa|MPa|V|mV|A|mA|W|kW|Hz|kHz|\
                     rpm|1/min|min-1|min⁻¹|mm/s|mm/min|m/min|m/s|mm/U|mm/rev|mm/tr|pcs|ppm|K|dB";

/// A heading's name and its unit: `Teilung [µm]`, `pitch_mm`, `Teilung in µm`, `Teilung/µm`, `Teilung µm`. What stands
/// in square brackets is a unit, known or not; what stands in round ones is one unless it is a word of another meaning.
pub(crate) fn split_unit(text: &str) -> (String, Option<String>) {
    let text = plain_widths(text);
    bracketed(&text, &[('[', ']'), ('【', '】'), ('〔', '〕')], |_, _| true)
        .or_else(|| bracketed(&text, &[('(', ')')], is_unit_in_round))
        .or_else(|| behind(&text))
        .or_else(|| attached(&text))
        .or_else(|| behind_limit(&text))
        .unwrap_or((text, None))
}

/// What is wanted of values, behind their name.
pub(crate) struct Wanted<'t> {
    pub(crate) name: &'t str,
    /// The nominal value, if it is no limit alone.
    pub(crate) nominal: Option<&'t str>,
}

/// A name and the nominal value with a tolerance, or the limit, that stands behind it: `Rollenmaß 25±0,03`,
/// `Rollenmaß 25 +0,03/-0,02`, `Teilung max. 10`.
pub(crate) fn split_wanted(name: &str) -> Option<Wanted<'_>> {
    let (name, nominal) =
        split_size(name).or_else(|| Some((split_limits(name).or_else(|| split_limit(name))?, None)))?;
    name.contains(char::is_alphabetic).then(|| Wanted { name: name.trim_end_matches([' ', '(']), nominal })
}

fn split_size(name: &str) -> Option<(&str, Option<&str>)> {
    let (sized, tolerance) = name.split_at(name.find(['±', '+'])?);
    let (name, size) = sized.trim_end_matches([' ', '(']).rsplit_once([' ', '('])?;
    let mut allowances = tolerance.split(['±', '+', '-', '−', '/', ' ', ')']).filter(|text| !text.is_empty());
    let is_size =
        is_plain_number(size) && allowances.next().is_some_and(is_plain_number) && allowances.all(is_plain_number);
    is_size.then_some((name, Some(size)))
}

/// A name without the two limits behind it: `Rollenmaß 24,95 - 25,05`.
fn split_limits(name: &str) -> Option<&str> {
    let name = name.trim_end_matches([' ', ')']);
    if name.matches(['.', ',']).count() < 2 {
        return None;
    }
    BETWEEN_LIMITS.iter().find_map(|mark| {
        let (before, upper) = name.rsplit_once(mark)?;
        let (name, lower) = before.rsplit_once([' ', '('])?;
        [lower, upper].into_iter().all(|limit| is_plain_number(limit) && limit.contains(['.', ','])).then_some(name)
    })
}

/// A name without the limit behind it: `fp ≤ 10`, `Rollenmaß ±0,05`, `Teilung (max. 10`.
fn split_limit(name: &str) -> Option<&str> {
    let name = name.trim_end_matches([' ', ')']);
    let before = name.trim_end_matches(|c: char| c.is_ascii_digit() || matches!(c, '.' | ','));
    let name = is_plain_number(&name[before.len()..]).then(|| without_limit_mark(before.trim_end())).flatten()?;
    // Tol. ±10
    Some(without_limit_mark(name.trim_end()).unwrap_or(name))
}

/// A text without the mark of a limit at its end.
fn without_limit_mark(text: &str) -> Option<&str> {
    let before = |mark: &&str| {
        let at = text.len().checked_sub(mark.len())?;
        let is_mark = text.get(at..)?.eq_ignore_ascii_case(mark);
        let is_apart = !mark.starts_with(char::is_alphabetic) || !text[..at].ends_with(char::is_alphanumeric);
        (is_mark && is_apart).then(|| &text[..at])
    };
    LIMIT_MARKS.iter().find_map(before)
}

/// What stands between two limits.
pub(crate) const BETWEEN_LIMITS: [&str; 11] = [" - ", " – ", " … ", " / ", " bis ", " to ", "-", "–", "…", "～", "~"];

/// What stands before a limit.
pub(crate) const LIMIT_MARKS: [&str; 20] = [
    "max.", "max", "maximum", "maximal", "≤", "≦", "<=", "<", "±", "+/-", "tol.", "tol", "toleranz", "zul.", "zul",
    "within", "or less", "maxi", "以下", "以内",
];

fn is_plain_number(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit()) && text.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | ','))
}

/// The last bracket whose inside is a unit, as told by `accept` of what stands before it and in it.
fn bracketed(text: &str, pairs: &[(char, char)], accept: fn(&str, &str) -> bool) -> Option<(String, Option<String>)> {
    let openings = text.char_indices().rev();
    let mut openings = openings.filter_map(|(at, c)| Some((at, *pairs.iter().find(|(open, _)| *open == c)?)));
    openings.find_map(|(at, (open, close))| {
        let (before, rest) = (&text[..at], &text[at + open.len_utf8()..]);
        let end = rest.find(close).unwrap_or(rest.len());
        let after = rest[end..].strip_prefix(close).unwrap_or("");
        let inside = without_preposition(rest[..end].trim());
        accept(before, inside).then(|| {
            let unit = (!inside.is_empty()).then(|| inside.to_owned());
            (format!("{} {}", before.trim_end(), after.trim()).trim().to_owned(), unit)
        })
    })
}

/// `in µm` is µm.
fn without_preposition(unit: &str) -> &str {
    let rest = ["in ", "en "].iter().find_map(|word| unit.strip_prefix(word));
    rest.map_or(unit, str::trim).trim_start_matches('/').trim_start()
}

/// Whether what stands in round brackets is a unit: a known one, or what looks like one and is no word.
fn is_unit_in_round(before: &str, inside: &str) -> bool {
    // roller(s)
    let plural = matches!(inside, "s" | "n" | "en") && before.ends_with(char::is_alphabetic);
    if plural {
        return false;
    }
    let looks = inside.chars().count() <= 12
        && inside.chars().any(|c| c.is_alphabetic() || "°′″'\"%".contains(c))
        && !inside.starts_with(|c: char| c.is_ascii_digit())
        && !inside.contains([' ', '=', ':', ',', '.', ';', '#']);
    is_known(inside) || (looks && Words::of(inside).known().is_none())
}

/// Whether it is a unit of anything: also N/mm, and MM where all is written in capitals.
fn is_known(unit: &str) -> bool {
    let simple = |unit: &str| {
        let capitals = unit.chars().count() > 1 && !unit.contains(char::is_lowercase);
        Unit::from_symbol(unit).is_some()
            || OTHER.split('|').any(|other| other == unit)
            || (capitals && Unit::from_symbol(&unit.to_lowercase()).is_some())
    };
    simple(unit) || unit.split_once('/').is_some_and(|(above, below)| simple(above) && simple(below))
}

/// The unit of a size or a limit in round brackets: `Teilung (max. 10 µm)`.
fn behind_limit(text: &str) -> Option<(String, Option<String>)> {
    let found = behind(text.trim_end().strip_suffix(')').filter(|text| text.contains('('))?)?;
    split_wanted(&found.0).is_some().then_some(found)
}

/// A unit after a blank, a slash, `in`, `_` or `-`.
fn behind(text: &str) -> Option<(String, Option<String>)> {
    let text = text.trim();
    // a unit may have a blank inside: 1/1000 mm
    let starts = text.char_indices().rev().filter(|(_, c)| c.is_whitespace() || matches!(c, '/' | '_' | '-'));
    let starts: Vec<(usize, char)> = starts.take(3).collect();
    starts.into_iter().rev().find_map(|(at, mark)| {
        let (before, unit) = (&text[..at], text[at + mark.len_utf8()..].trim());
        let before = before.trim_end();
        let slash = mark == '/' || before.ends_with('/');
        let said = slash || before.ends_with(" in") || before.ends_with(" en");
        let stem = before.strip_suffix(" in").or_else(|| before.strip_suffix(" en")).unwrap_or(before);
        let stem = stem.trim_end().trim_end_matches([',', '/', ';', ':', '-']).trim_end();
        // no name ends in a sign: ° and ㎛ are no letters
        let is_word = unit.chars().all(char::is_alphabetic);
        // `P/N` and `S/N` are names
        let is_name = || Words::of(text).known().is_some();
        let clear = if said { !slash || !is_word || !is_name() } else { is_clear(unit, mark) };
        (clear && is_known(unit)).then(|| (stem.to_owned(), Some(unit.to_owned())))
    })
}

/// Whether it is a unit although nothing around it says so: `in` may be the word, `min` the least, `m` a name.
fn is_clear(unit: &str, mark: char) -> bool {
    let word = match unit {
        "in" | "IN" => mark != '_',
        "min" | "MIN" | "'" | "\"" => true,
        _ => unit.chars().count() == 1 && unit.chars().all(char::is_alphabetic),
    };
    !word
}

/// A unit without a blank before it, where it cannot be part of a word: `Winkel°`, `ピッチ誤差μm`.
fn attached(text: &str) -> Option<(String, Option<String>)> {
    let start = text.char_indices().rev().take_while(|(_, c)| !is_japanese(*c)).last().map(|(at, _)| at)?;
    let degree = text
        .strip_suffix(['°', '㎛', '㎜', '″', '′'])
        .filter(|name| !matches!(name.rsplit(' ').next(), Some("N" | "n")));
    let at = if start > 0 { start } else { degree.filter(|name| name.ends_with(char::is_alphabetic))?.len() };
    let (name, unit) = (text[..at].trim(), text[at..].trim());
    (!name.is_empty() && is_known(unit) && unit.chars().count() + usize::from(start == 0) > 1)
        .then(|| (name.to_owned(), Some(unit.to_owned())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_wherever_they_stand() {
        for (text, name, unit) in [
            ("Teilung [µm]", "Teilung", Some("µm")),
            ("Teilung (µm)", "Teilung", Some("µm")),
            ("Teilung max. 10 µm", "Teilung max. 10", Some("µm")),
            ("Teilung (max. 10 µm)", "Teilung (max. 10", Some("µm")),
            ("Rollenmaß (Rolle 4 mm)", "Rollenmaß (Rolle 4 mm)", None),
            ("Teilung（µm）", "Teilung", Some("µm")),
            ("ピッチ誤差［µm］", "ピッチ誤差", Some("µm")),
            ("ﾋﾟｯﾁ誤差 µm", "ピッチ誤差", Some("µm")),
            ("ピッチ誤差【mm】", "ピッチ誤差", Some("mm")),
            ("ピッチ誤差μm", "ピッチ誤差", Some("μm")),
            ("pitch_um", "pitch", Some("um")),
            ("pitch-um", "pitch", Some("um")),
            ("PITCH UM", "PITCH", Some("UM")),
            ("Teilung µm", "Teilung", Some("µm")),
            ("Teilung, µm", "Teilung", Some("µm")),
            ("Rollenmaß/µm", "Rollenmaß", Some("µm")),
            ("Rollenmaß / µm", "Rollenmaß", Some("µm")),
            ("/µm", "", Some("µm")),
            ("fp in µm", "fp", Some("µm")),
            ("pas en µm", "pas", Some("µm")),
            ("fp [in µm]", "fp", Some("µm")),
            ("pitch in in", "pitch", Some("in")),
            ("pitch_in", "pitch", Some("in")),
            ("check in", "check in", None),
            ("lead (deg)", "lead", Some("deg")),
            ("lead °", "lead", Some("°")),
            ("lead°", "lead", Some("°")),
            ("lead [']", "lead", Some("'")),
            ("lead '", "lead '", None),
            ("lead_min", "lead_min", None),
            ("lead [min]", "lead", Some("min")),
            ("pitch [nm]", "pitch", Some("nm")),
            ("pitch [1/1000 mm]", "pitch", Some("1/1000 mm")),
            ("pitch [furlong long]", "pitch", Some("furlong long")),
            ("pitch [㎛]", "pitch", Some("㎛")),
            ("pitch []", "pitch", None),
            ("Ｍ（ｍｍ）", "M", Some("mm")),
            ("pitch [mm", "pitch", Some("mm")),
            ("pitch (micron)", "pitch", Some("micron")),
            ("pitch (Ist)", "pitch (Ist)", None),
            ("pitch (k=2)", "pitch (k=2)", None),
            ("pitch (rack)", "pitch (rack)", None),
            ("pitch (max.)", "pitch (max.)", None),
            ("pitch (rack) (um)", "pitch (rack)", Some("um")),
            ("pitch (um) rack", "pitch rack", Some("um")),
            ("pitch (Ist) [mm]", "pitch (Ist)", Some("mm")),
            ("over roller(s)", "over roller(s)", None),
            ("over roller(s) (mm)", "over roller(s)", Some("mm")),
            ("pitch (measured by Zeiss)", "pitch (measured by Zeiss)", None),
            ("Temp. [°C]", "Temp.", Some("°C")),
            ("Temp. °C", "Temp.", Some("°C")),
            ("Kraft (N)", "Kraft", Some("N")),
            ("Kraft/N", "Kraft", Some("N")),
            ("Steifigkeit N/mm", "Steifigkeit", Some("N/mm")),
            ("Härte HRC", "Härte", Some("HRC")),
            ("P/N", "P/N", None),
            ("S/N", "S/N", None),
            ("N° dent", "N° dent", None),
            ("N°", "N°", None),
            ("Machine n°", "Machine n°", None),
            ("M", "M", None),
            ("mm", "mm", None),
            ("Soll/Ist", "Soll/Ist", None),
            ("", "", None),
        ] {
            assert_eq!(split_unit(text), (name.to_owned(), unit.map(str::to_owned)), "{text}");
        }
    }

    #[test]
    fn what_is_wanted_stands_behind_the_name() {
        for (text, name, nominal) in [
            ("Rollenmaß 25±0,03", "Rollenmaß", Some("25")),
            ("Rollenmaß (25 +0,03/-0,02)", "Rollenmaß", Some("25")),
            ("Teilung max. 10", "Teilung", None),
            ("Teilung (max. 10", "Teilung", None),
            ("fp ≤ 10", "fp", None),
            ("fp ≤10", "fp", None),
            ("Rollenmaß ±0,05", "Rollenmaß", None),
            ("Teilung Tol. ±10", "Teilung", None),
            ("Rollenmaß 24,95 - 25,05", "Rollenmaß", None),
            ("Rollenmaß (24,95-25,05)", "Rollenmaß", None),
        ] {
            let wanted = split_wanted(text).map(|wanted| (wanted.name, wanted.nominal));
            assert_eq!(wanted, Some((name, nominal)), "{text}");
        }
        for text in ["fp max", "Teil 10", "max 10", "Climax 10", "fp 1.5", "M 25+", "Zahn 1-28", "fp 1 - 28"] {
            assert!(split_wanted(text).is_none(), "{text}");
        }
    }
}
