//! `[[rack.deviation]]`, `[[pinion.deviation]]` and the flanks' form, as written. Called by the readers of `[rack]` and
//! `[pinion]`; puts nothing on a flank.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Located;
use super::keys::{self, AnyKey, Key, Section};
use super::reader::{SectionReader, type_in_words};
use crate::deviation::{PinionDeviation, PinionDeviationKind, RackDeviation, RackDeviationKind, ToothRange};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::{Angle, Length};

/// A key of a deviation of some teeth, and what it sets, in mm or rad.
type Displacement<T, Kind> = (Key<T>, fn(f64) -> Kind);

const RACK_DISPLACEMENTS: [Displacement<Length, RackDeviationKind>; 6] = [
    (keys::RACK_DEVIATION_OVER_ROLLER, RackDeviationKind::OverRoller),
    (keys::RACK_DEVIATION_PITCH, RackDeviationKind::Pitch),
    (keys::RACK_DEVIATION_SHIFT, RackDeviationKind::Shift),
    (keys::RACK_DEVIATION_THICKNESS, RackDeviationKind::Thickness),
    (keys::RACK_DEVIATION_LEFT, RackDeviationKind::Left),
    (keys::RACK_DEVIATION_RIGHT, RackDeviationKind::Right),
];

const PINION_DISPLACEMENTS: [Displacement<Length, PinionDeviationKind>; 5] = [
    (keys::PINION_DEVIATION_SHIFT, PinionDeviationKind::Shift),
    (keys::PINION_DEVIATION_THICKNESS, PinionDeviationKind::Thickness),
    (keys::PINION_DEVIATION_LEFT, PinionDeviationKind::Left),
    (keys::PINION_DEVIATION_RIGHT, PinionDeviationKind::Right),
    (keys::PINION_DEVIATION_RADIAL, PinionDeviationKind::Radial),
];

/// Reads every `[[rack.deviation]]`.
pub(super) fn rack(reader: &mut SectionReader<'_>) -> Vec<Located<RackDeviation>> {
    each_table(reader, &keys::RACK_DEVIATION, |entry, found| {
        let Some(teeth) = entry.teeth(keys::RACK_DEVIATION_TEETH) else { return };
        let lead = (keys::RACK_DEVIATION_LEAD, RackDeviationKind::Lead as fn(f64) -> _);
        let kinds = entry.displacements(&RACK_DISPLACEMENTS, lead);
        found.extend(kinds.into_iter().map(|kind| kind.map(|kind| RackDeviation { teeth, kind })));
    })
}

/// Reads every `[[pinion.deviation]]`.
pub(super) fn pinion(reader: &mut SectionReader<'_>) -> Vec<Located<PinionDeviation>> {
    each_table(reader, &keys::PINION_DEVIATION, |entry, found| {
        let Some(teeth) = entry.teeth(keys::PINION_DEVIATION_TEETH) else { return };
        let lead = (keys::PINION_DEVIATION_LEAD, PinionDeviationKind::Lead as fn(f64) -> _);
        let kinds = entry.displacements(&PINION_DISPLACEMENTS, lead);
        found.extend(kinds.into_iter().map(|kind| kind.map(|kind| PinionDeviation { teeth, kind })));
        let eccentricity = entry.table("eccentricity", &keys::ECCENTRICITY, |reader| {
            reader.refuse_missing_keys();
            let tooth = reader.get(keys::PINION_DEVIATION_ECCENTRICITY_TOOTH);
            (reader.get(keys::PINION_DEVIATION_ECCENTRICITY_AMOUNT), tooth)
        });
        if let Some(Located { value: (Some(amount), Some(tooth)), span }) = eccentricity {
            found.push(Located { value: PinionDeviation::eccentricity(amount.value.mm(), tooth.value), span });
        }
    })
}

/// The most tables of `[[….deviation]]`: each adds teeth that the mesh solves.
const MOST_DEVIATIONS: usize = 1000;

/// Reads each table of `[[….deviation]]`; a table with no key but `teeth` is a mistake.
fn each_table<T>(
    reader: &mut SectionReader<'_>,
    section: &'static Section,
    read: impl Fn(&mut SectionReader<'_>, &mut Vec<T>),
) -> Vec<T> {
    let mut found = Vec::new();
    let Some(value) = reader.table.get("deviation") else { return found };
    let entries: Vec<&Spanned<DeValue<'_>>> = match value.get_ref() {
        DeValue::Array(entries) => entries.iter().collect(),
        _ => vec![value],
    };
    if let Some(beyond) = entries.get(MOST_DEVIATIONS) {
        let message = format!("{} of `{}` are more than {MOST_DEVIATIONS}", entries.len(), section.name);
        let diagnostic = Diagnostic::error(Code::BadErrorEntry, message)
            .help("values of many teeth stand in a table: `measured = \"FILE\"`");
        reader.report(diagnostic, beyond.span());
        return found;
    }
    for entry in entries {
        let DeValue::Table(table) = entry.get_ref() else {
            let message =
                format!("an entry of `{}` is {}; it must be a table", section.name, type_in_words(entry.get_ref()));
            let diagnostic = Diagnostic::error(Code::WrongType, message)
                .help(format!("write its keys under a line `[[{}]]`", section.name));
            reader.report(diagnostic, entry.span());
            continue;
        };
        if !table.iter().any(|(key, _)| key.get_ref() != "teeth") {
            let names: Vec<_> = section.keys.iter().map(AnyKey::name).filter(|name| *name != "teeth").collect();
            let diagnostic = Diagnostic::error(Code::BadErrorEntry, format!("this `{}` changes nothing", section.name))
                .help(format!("give at least one of {}", names.join(", ")));
            reader.report(diagnostic, entry.span());
            continue;
        }
        reader.inner(section, table, |inner| read(inner, &mut found));
    }
    found
}

impl SectionReader<'_> {
    /// Reads a table below this one with the keys of `section`.
    pub(super) fn inner<T>(
        &mut self,
        section: &'static Section,
        table: &DeTable<'_>,
        read: impl FnOnce(&mut SectionReader<'_>) -> T,
    ) -> T {
        let mut inner = SectionReader {
            source: self.source,
            section,
            table,
            diagnostics: self.diagnostics,
            uncertainties: self.uncertainties,
        };
        inner.refuse_unknown_keys();
        read(&mut inner)
    }

    /// Reads the table under `name`.
    pub(super) fn table<T>(
        &mut self,
        name: &str,
        section: &'static Section,
        read: impl FnOnce(&mut SectionReader<'_>) -> T,
    ) -> Option<Located<T>> {
        let value = self.table.get(name)?;
        let DeValue::Table(table) = value.get_ref() else {
            let names: Vec<_> = section.keys.iter().map(|key| format!("{} = …", key.name())).collect();
            return self.wrong_type(name, value, &format!("a table {{ {} }}", names.join(", ")));
        };
        let before = self.diagnostics.len();
        let read = self.inner(section, table, read);
        (self.diagnostics.len() == before).then(|| Located { value: read, span: value.span() })
    }

    /// Reports keys without which the table means nothing.
    pub(super) fn refuse_missing_keys(&mut self) {
        // a table without keys has no place of its own, so the message names its section
        let span = self.table.iter().next().map_or(0..0, |(key, value)| key.span().start..value.span().end);
        for key in self.section.keys.iter().filter(|key| !self.table.contains_key(key.name())) {
            let message = format!("`{}` needs `{}`", self.section.name, key.name());
            self.report(Diagnostic::error(Code::MissingKey, message), span.clone());
        }
    }

    /// The displacements of some teeth, and their lead.
    fn displacements<Kind>(
        &mut self,
        lengths: &[Displacement<Length, Kind>],
        lead: Displacement<Angle, Kind>,
    ) -> Vec<Located<Kind>> {
        let mut found: Vec<_> =
            lengths.iter().filter_map(|(key, kind)| Some(self.get(*key)?.map(|length| kind(length.mm())))).collect();
        found.extend(self.get(lead.0).map(|angle| angle.map(|angle| lead.1(angle.radians()))));
        found
    }

    /// A range of teeth; every tooth if none is given.
    fn teeth(&mut self, key: Key<ToothRange>) -> Option<ToothRange> {
        if self.table.contains_key(key.any.name()) { Some(self.get(key)?.value) } else { Some(ToothRange::ALL) }
    }
}
