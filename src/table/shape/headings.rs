//! What the headings of a table mean: which of two meanings counts, which of two names of a part.

use super::{NoShape, Series, has_digit, twice};
use crate::deviation::{DeviationKind, Part};
use crate::table::cell::Cell;
use crate::table::names::{
    Field, Heading, Role, ValueKind, WordList, heading, is_again, is_context, is_of_parts, is_statistic, names_page,
    part_said, role, says_which,
};
use crate::table::number::is_missing;
use crate::table::want::Want;

/// A column with a known name.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    pub(crate) field: Field,
    pub(crate) aspect: Role,
    pub(crate) holds: Option<ValueKind>,
    pub(crate) series: Series,
}

/// What headings mean, one by one; `None` for those that are not known or that the user leaves out.
pub(crate) fn headings(cells: &[Cell], want: &Want) -> Result<Vec<Option<Named>>, NoShape> {
    let understood = |cell: &Cell| {
        let text = cell.text();
        if want.ignores(&text) { None } else { heading(&text, &want.own) }
    };
    // where the spec's column of an error is there, no other is that
    let is_own = |field: Field| {
        let own = cells.iter().map(Cell::text).filter(|text| want.is_own(text));
        own.filter_map(|text| heading(&text, &want.own)).any(|heading| heading.fields == [field])
    };
    let is_other = |cell: &Cell, heading: &Heading| {
        heading.aspect == Role::Measured
            && matches!(heading.fields[..], [field @ Field::Error(_)] if is_own(field))
            && !want.is_own(&cell.text())
    };
    let found = cells.iter().map(|cell| understood(cell).filter(|heading| !is_other(cell, heading)));
    let found: Vec<_> = found.collect();
    // in a table of a pinion's teeth, or in one that has values of one part only, `pitch` is that part's
    let of = |kinds: [DeviationKind; 2]| {
        found.iter().flatten().any(|heading| kinds.iter().any(|kind| heading.fields == [Field::Error(*kind)]))
    };
    let rack = of([DeviationKind::RackOverRoller, DeviationKind::RackLead]);
    let pinion = of([DeviationKind::PinionRadial, DeviationKind::PinionLead]);
    // beside errors of parts, `x` and `position` are where something was measured
    let fields = || found.iter().flatten().flat_map(|heading| &heading.fields);
    let has_numbers = fields().any(|field| matches!(field, Field::Space | Field::Tooth));
    let of_parts = want.teeth != Some(true) && fields().any(|field| matches!(field, Field::Error(_))) && !has_numbers;
    // in a table of one part, as a title or a column `Ritzel Nr.` says, a pitch is that part's; or else the one that the spec asks
    // for and no other column is
    let is_value = |heading: &&Heading| heading.aspect == Role::Measured && heading.fields.len() == 1;
    let has_own: Vec<Field> = found.iter().flatten().filter(is_value).map(|heading| heading.fields[0]).collect();
    let mut of_ids = cells.iter().map(Cell::text).filter(|text| is_part_name(text)).filter_map(|text| part_said(&text));
    let first = of_ids.next();
    let of_ids = first.filter(|first| of_ids.all(|other| other == *first));
    let is_all = |part: &Part| has_own.iter().filter_map(|field| field.kind()).all(|kind| kind.part() == *part);
    let part = want.part.or(of_ids).filter(is_all);
    let is_of_part = |field: &Field| field.kind().is_none_or(|kind| part.is_none_or(|part| kind.part() == part));
    let is_lacking =
        |field: &Field| !has_own.contains(field) && field.kind().is_some_and(|kind| want.expected.contains(&kind));
    let one = |(place, (cell, heading)): (usize, (&Cell, Option<Heading>))| {
        let Some(mut heading) = heading else { return Ok(None) };
        for may_be in [&is_of_part as &dyn Fn(&Field) -> bool, &is_lacking] {
            if heading.fields.len() > 1 && heading.fields.iter().any(may_be) {
                heading.fields.retain(may_be);
            }
        }
        if heading.fields.len() > 1 && rack != pinion && want.expected.is_empty() {
            let wanted = if rack { DeviationKind::RackPitch } else { DeviationKind::PinionPitch };
            heading.fields.retain(|field| *field == Field::Error(wanted));
        }
        let field = one_meaning(&heading.fields, want, cell)?;
        let series = Series { title: cell.text().into_owned(), place, unit: heading.unit, cells: Vec::new() };
        let named = Named { field, aspect: heading.aspect, holds: heading.holds, series };
        Ok(Some(named).filter(|_| !(of_parts && field == Field::Position)))
    };
    let mut named: Vec<_> = cells.iter().zip(found).enumerate().map(one).collect::<Result<_, _>>()?;
    drop_second_part_names(&mut named, want)?;
    Ok(named)
}

pub(super) fn one_meaning(found: &[Field], want: &Want, title: &Cell) -> Result<Field, NoShape> {
    if let [field] = found {
        return Ok(*field);
    }
    let mut expected = found.iter().filter(|field| want.expected.iter().any(|kind| Field::Error(*kind) == **field));
    match (expected.next(), expected.next()) {
        (Some(field), None) => Ok(*field),
        _ => Err(NoShape::TwoMeanings { heading: title.clone(), fields: found.to_vec() }),
    }
}

/// Of several columns that may name the part, the one that the spec names, the one that is called so, the serial number, or
/// else the first that does more than count rows; a second one is no error.
fn drop_second_part_names(named: &mut [Option<Named>], want: &Want) -> Result<(), NoShape> {
    let is_id = |found: &&mut Option<Named>| found.as_ref().is_some_and(|found| found.field == Field::PartId);
    let title = |found: &Option<Named>| found.as_ref().map_or_else(String::new, |found| found.series.title.clone());
    let rank = |found: &Option<Named>| match title(found) {
        own if want.is_own(&own) => 0,
        key if key.eq_ignore_ascii_case(Field::PartId.key()) => 1,
        serial if WordList::Serial.has(&serial) => 2,
        count if WordList::RowNumber.has(&count) => 4,
        _ => 3,
    };
    let mut ids: Vec<_> = named.iter_mut().filter(is_id).collect();
    ids.sort_by_key(|found| rank(found));
    let Some((kept, others)) = ids.split_first_mut() else { return Ok(()) };
    for second in others.iter_mut().filter_map(|other| other.take()) {
        // tables side by side have a row of two parts
        if second.series.title == title(kept) {
            return Err(twice(&second.series, Field::PartId));
        }
    }
    Ok(())
}

pub(super) fn known(cells: &[Cell], want: &Want) -> usize {
    let is_known = |text: &str| heading(text, &want.own).is_some() || WordList::EvaluationLength.has(text);
    cells.iter().filter(|cell| is_known(&cell.text())).count()
}

/// Whether a column is called nominal, a tolerance or a deviation, of whatever part, or a flank or a tooth: `P1 Soll`, `links`.
pub(super) fn says_no_part(text: &str) -> bool {
    let is_none = |text: &str| role(text).is_some_and(Role::is_beside_value);
    // Soll-Ist, |Abw.|
    let is_word = |word: &&str| word.chars().count() > 2;
    let is_index = |text: &str| {
        heading(text, &[])
            .is_some_and(|heading| heading.fields.iter().all(|field| matches!(field, Field::Space | Field::Tooth)))
    };
    is_none(text)
        || text.chars().count() > 1 && says_which(text)
        || has_digit(text) && is_index(text.trim_end_matches(|c: char| c.is_ascii_digit()))
        || text.split_whitespace().any(is_none)
        || heading(text, &[]).is_none() && text.split(['-', '/', '|', '[']).filter(is_word).any(is_none)
}

/// Whether a column holds what is wanted of parts, made of them, measured once more or known beside them, and is none of a part.
pub(super) fn is_of_no_part(title: &str) -> bool {
    says_no_part(title) || is_again(title) || is_statistic(title) || is_plain_context(title)
}

/// Whether a heading is that of the largest or the smallest value, or of a limit.
pub(super) fn is_extreme(title: &str) -> bool {
    WordList::Mean.has(title) && (says_which(title) || matches!(role(title), Some(Role::Upper | Role::Lower)))
}

/// What the names of a table's parts look like.
#[derive(Debug, Clone, Default)]
pub(crate) struct PartNames {
    /// Letters of the longest one with digits, and of the longest without.
    longest: [usize; 2],
    /// Whether a mean or an extreme of the parts stands among them.
    has_mean: bool,
    /// Whether one of them is called like a page: `Blatt 2`.
    has_page: bool,
}

impl PartNames {
    pub(crate) fn of<'c>(cells: impl Iterator<Item = &'c Cell>) -> Self {
        let mut names = Self::default();
        for name in cells.filter(|cell| !cell.is_missing()).map(Cell::text) {
            names.has_mean |= WordList::Mean.has(&name);
            names.has_page |= has_digit(&name) && names_page(&name);
            if is_of_parts(&name) || is_plain_context(&name) || is_spread(&name) {
                continue;
            }
            let longest = &mut names.longest[usize::from(has_digit(&name))];
            *longest = name.chars().count().max(*longest);
        }
        names
    }

    /// Whether a text may be one more of them, though nothing stands beside it.
    pub(crate) fn may_have(&self, name: &str) -> bool {
        self.are_like(name) && !name.contains(':') && !is_context(name) && !is_statistic(name) && !is_missing(name)
    }

    /// Whether a line begins with what may be one of them, or with a word for parts and such a name: `B liegt`, `Teil C`.
    pub(crate) fn begin(&self, line: &str) -> bool {
        let mut words = line.split_whitespace().peekable();
        if words.peek().is_some_and(|word| is_part_name(word)) {
            words.next();
        }
        words.next().is_some_and(|word| self.may_have(word))
    }

    /// Whether one of them is as long as a text, and has digits as it has them.
    fn are_like(&self, name: &str) -> bool {
        (1..=self.longest[usize::from(has_digit(name))]).contains(&name.chars().count())
    }

    /// Whether a row of that name is none of a part, though numbers stand beside it: a temperature or a count below the
    /// table, or `s` and `R` as a mean has them, where parts have other names.
    pub(crate) fn exclude(&self, name: &str) -> bool {
        self.longest != [0, 0] && !self.are_like(name) && (is_plain_context(name) || is_spread(name))
    }

    /// Whether a row of that name is a spread of the parts, as a mean beside it tells, unless its numbers may be a part's.
    pub(crate) fn have_spread(&self, name: &str) -> bool {
        self.has_mean && is_spread(name)
    }

    /// Whether a line of that name says where a page ends, and is no part's.
    pub(crate) fn have_no(&self, page: &str) -> bool {
        !self.has_page && names_page(page)
    }
}

/// Whether the name of a column beside parts is that of a statistic; one that may be a part's is where a mean stands beside it.
pub(super) fn is_statistic_among(name: &str, header: &[Cell]) -> bool {
    is_statistic(name) || is_spread(name) && header.iter().any(|cell| WordList::Mean.has(&cell.text()))
}

/// Whether it may be a standard deviation, a range or a count, and may be a part as well.
pub(crate) fn is_spread(name: &str) -> bool {
    matches!(name.trim(), "s" | "S" | "R" | "n" | "N")
}

/// Whether a text says what is known about a table, and names no part: `Temperatur`.
fn is_plain_context(text: &str) -> bool {
    !has_digit(text) && is_context(text) && !is_part_name(text)
}

/// Whether a text with digits may be the name of a part, and begins with no word of something else: `R17`.
pub(crate) fn is_numbered(text: &str) -> bool {
    let word = text.split_whitespace().next().unwrap_or_default();
    has_digit(text) && !text.contains(':') && !is_context(word) && role(word) != Some(Role::Uncertainty)
}

/// Whether a heading names the part and nothing else.
pub(crate) fn is_part_name(title: &str) -> bool {
    heading(title, &[]).is_some_and(|heading| heading.fields == [Field::PartId])
}
