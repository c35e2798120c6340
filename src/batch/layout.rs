//! Where one table has what: columns found by name, with their units. Made once per table from the plan and the header;
//! reads no row.

use super::input::Header;
use super::output::Output;
use super::plan::Plan;
use crate::cmm::name_and_unit;
use crate::cmm::paste::{self, Holds};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::quantity::{Angle, AngleUnit, Decimal, Length, LengthUnit, NumberError, QuantityError};
use crate::spec::{Reading, Spec};

/// The unit of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Length(LengthUnit),
    Angle(AngleUnit),
}

/// Where an error stands in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) field: usize,
    pub(super) unit: Unit,
    /// What the heading says that the column holds; only asked of headings that are found by their meaning.
    holds: Option<Holds>,
    by_meaning: bool,
}

impl Found {
    /// What the column holds: as the spec says, unless it was found by its meaning and says so itself.
    pub(super) fn reading(&self, spec: &Spec, header: &Header, kind: ErrorKind) -> Result<Reading, Diagnostics> {
        let reading = spec.reading(kind)?;
        match (self.holds, &reading) {
            (Some(Holds::Deviation), _) => Ok(Reading::Deviation),
            (Some(Holds::Measured), Reading::Deviation) => {
                let message = format!(
                    "{}, column `{}`: it holds measured values, and there is no nominal value",
                    header.name, header.columns[self.field]
                );
                Err(Diagnostic::error(Code::MissingKey, message)
                    .help(format!("give it in the spec: [errors] {} = {{ nominal = … }}", kind.key()))
                    .into())
            }
            _ => Ok(reading),
        }
    }
}

/// One column that is read.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// Its place in the record.
    pub(super) field: usize,
    /// Its name in the header.
    pub(super) name: String,
    unit: Unit,
    /// What is taken from a value; nothing of a deviation.
    nominal: ErrorValue,
}

/// What a field is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Skipped,
    Id,
    /// The column with that index.
    Value(usize),
}

/// Where one table has what.
#[derive(Debug, Clone)]
pub struct Layout {
    /// One per source of the plan, in its order.
    pub(super) columns: Vec<Column>,
    /// One per field of a record.
    pub(super) roles: Vec<Role>,
    pub(super) id: Option<usize>,
    /// The fields that outputs copy, in the outputs' order.
    pub(super) copied: Vec<usize>,
    pub(super) separator: u8,
    /// The decimal mark.
    pub(super) mark: u8,
    /// How the columns were understood that the spec does not name.
    understood: Vec<String>,
}

impl Layout {
    /// Finds the plan's columns in a table.
    ///
    /// # Errors
    /// A diagnostic for each column that the plan needs and the table does not have, or has twice.
    pub fn new(plan: &Plan, header: &Header) -> Result<Self, Diagnostics> {
        let mut diagnostics = Vec::new();
        let mut columns = Vec::new();
        let mut understood = Vec::new();
        for source in &plan.sources {
            match find_column(&plan.spec, header, source.law.kind()) {
                Ok(Some(found)) => {
                    match found.reading(&plan.spec, header, source.law.kind()) {
                        Ok(reading) if reading == source.reading => {}
                        Ok(_) => diagnostics.push(Diagnostic::error(
                            Code::BadTable,
                            format!(
                                "{}, column `{}`: of measured values and deviations it does not hold what the first table's holds",
                                header.name, header.columns[found.field]
                            ),
                        )),
                        Err(problems) => diagnostics.extend(problems.0),
                    }
                    if found.by_meaning {
                        let holds = if source.reading == Reading::Deviation { "deviations" } else { "measured values" };
                        let unit = found.unit.symbol();
                        let name = &header.columns[found.field];
                        understood.push(format!("`{name}` is {} ({holds}, {unit})", source.law.kind().key()));
                    }
                    columns.push(Column::new(header, found.field, found.unit, &source.reading));
                }
                Ok(None) => diagnostics.push(missing(&plan.spec, header, source.law.kind())),
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        let id = find_id(&plan.spec, header, plan.request.id.as_deref()).unwrap_or_else(|diagnostic| {
            diagnostics.push(diagnostic);
            None
        });
        for (index, name) in header.columns.iter().enumerate() {
            // a column that somebody meant to be read is not passed over in silence
            let used = Some(index) == id || columns.iter().any(|column| column.field == index);
            let spare = used || !has_a_word(name) || plan.request.columns.is_some();
            let meaning = if spare { None } else { paste::meaning(name) };
            if meaning.is_some_and(|found| found.fields.iter().any(|field| !field.is_index())) {
                understood.push(format!("`{name}` is not used"));
            }
        }
        if let Some(id) = id.filter(|id| !is_named(&plan.spec, header, *id, plan.request.id.as_deref())) {
            understood.insert(0, format!("`{}` is part_id", header.columns[id]));
        }
        let mut copied = Vec::new();
        for output in &plan.outputs {
            let Output::Copied(name) = output else { continue };
            match header.columns.iter().position(|column| column == name) {
                Some(field) => copied.push(field),
                None => diagnostics.push(Diagnostic::error(
                    Code::BadTable,
                    format!("{} has no column `{name}`, which is to be written", header.name),
                )),
            }
        }
        if !diagnostics.is_empty() {
            return Err(Diagnostics(diagnostics));
        }
        let mut roles = vec![Role::Skipped; header.columns.len()];
        if let Some(id) = id {
            roles[id] = Role::Id;
        }
        for (index, column) in columns.iter().enumerate() {
            roles[column.field] = Role::Value(index);
        }
        let mark = if header.decimal_comma { b',' } else { b'.' };
        Ok(Self { columns, roles, id, copied, separator: header.separator, mark, understood })
    }

    /// How the columns were understood that were found by what their headings mean: `Rollenmaß [mm]` is …
    #[must_use]
    pub fn understood(&self) -> &[String] {
        &self.understood
    }
}

impl Unit {
    fn symbol(self) -> &'static str {
        match self {
            Self::Length(unit) => unit.symbol(),
            Self::Angle(unit) => unit.symbol(),
        }
    }
}

impl Column {
    fn new(header: &Header, field: usize, unit: Unit, reading: &Reading) -> Self {
        let nominal = match (reading, unit) {
            (Reading::Measured(nominal), _) => *nominal,
            (Reading::Deviation, Unit::Length(_)) => ErrorValue::Length(Length::ZERO),
            (Reading::Deviation, Unit::Angle(_)) => ErrorValue::Angle(Angle::ZERO),
        };
        Self { field, name: header.columns[field].clone(), unit, nominal }
    }

    /// The deviation of a plain number in the column's unit; `None` where it is too large.
    #[inline]
    pub(super) fn plain(&self, number: Decimal) -> Option<ErrorValue> {
        let value = match self.unit {
            Unit::Length(unit) => ErrorValue::Length(Length::of_number(number, unit).ok()?),
            Unit::Angle(unit) => ErrorValue::Angle(Angle::of_number(number, unit).ok()?),
        };
        Some(value.less(self.nominal))
    }

    /// The deviation that a field's text means.
    pub(super) fn read(&self, text: &str, mark: u8) -> Result<ErrorValue, String> {
        let text = text.trim();
        if let Some((number, end)) = Decimal::plain(text.as_bytes(), 0, mark)
            && end == text.len()
            && let Some(value) = self.plain(number)
        {
            return Ok(value);
        }
        let value = match self.unit {
            Unit::Length(unit) => ErrorValue::Length(quantity(text, unit.symbol(), mark)?),
            Unit::Angle(unit) => ErrorValue::Angle(quantity(text, unit.symbol(), mark)?),
        };
        Ok(value.less(self.nominal))
    }
}

/// A quantity from a cell; a number without a unit has that of the column.
fn quantity<Q: std::str::FromStr<Err = QuantityError>>(written: &str, unit: &str, mark: u8) -> Result<Q, String> {
    if written.is_empty() {
        return Err("the field is empty".to_owned());
    }
    let text = if mark == b',' { written.replacen(',', ".", 1) } else { written.to_owned() };
    let bare = text.ends_with(|c: char| c.is_ascii_digit() || c == '.');
    let read: Result<Q, QuantityError> = if bare { [&text, unit].concat().parse() } else { text.parse() };
    read.map_err(|error| match error {
        // the message shows the text as it was written
        QuantityError::Number { expected, reason, .. } => {
            let (reason, told) = match reason {
                NumberError::Comma if mark == b',' => (NumberError::NotANumber, ""),
                NumberError::Comma => (reason, ", or say --decimal-comma"),
                _ => (reason, ""),
            };
            let error = QuantityError::Number { text: written.to_owned(), expected, reason };
            format!("{error}{told}")
        }
        error => error.to_string(),
    })
}

/// The column of an error and its unit; `None` if the table has none.
pub(super) fn find_column(spec: &Spec, header: &Header, kind: ErrorKind) -> Result<Option<Found>, Diagnostic> {
    let column = spec.batch_column(kind).map(|column| &column.value);
    let wanted = column.and_then(|column| column.name.as_deref());
    let Some(field) = find_name(header, wanted.unwrap_or(kind.key()))? else {
        if wanted.is_none()
            && let Some(found) = find_meaning(spec, header, kind)?
        {
            return Ok(Some(found));
        }
        return if spec.expects_column(kind) { Err(missing(spec, header, kind)) } else { Ok(None) };
    };
    let name = &header.columns[field];
    let in_brackets = name.contains(['[', '(']);
    let (_, written) = name_and_unit(name);
    let stated = column.and_then(|column| column.unit.as_ref());
    let is_angle = kind == ErrorKind::RackLead;
    let unit_of = |symbol: &str| {
        if is_angle {
            AngleUnit::from_symbol(symbol).map(Unit::Angle)
        } else {
            LengthUnit::from_symbol(symbol).map(Unit::Length)
        }
    };
    let default = if is_angle { Unit::Angle(AngleUnit::Degree) } else { Unit::Length(LengthUnit::Millimetre) };
    let stated_unit = stated.and_then(|stated| unit_of(stated.value));
    let written_unit = match written.as_deref() {
        // a word at the end of a name is a unit if it can be one; what stands in brackets must be one
        Some(symbol) if in_brackets && unit_of(symbol).is_none() && stated_unit.is_none() => {
            let (what, units) = if is_angle { ("an angle", AngleUnit::NAMES) } else { ("a length", LengthUnit::NAMES) };
            return Err(Diagnostic::error(
                Code::BadTable,
                format!("{}, column `{name}`: `{symbol}` is not a unit of {what}", header.name),
            )
            .help(format!("write {units}; or say it in the spec: [batch.columns] {} = {{ unit = … }}", kind.key())));
        }
        Some(symbol) => unit_of(symbol),
        None => None,
    };
    match (stated_unit, written_unit) {
        (Some(stated_unit), Some(written_unit)) if in_brackets && stated_unit != written_unit => {
            let message = format!("{}, column `{name}`: the header and the spec name different units", header.name);
            let diagnostic = Diagnostic::error(Code::BadTable, message);
            Err(match stated {
                Some(stated) => diagnostic.at(&spec.source, stated.span.clone(), ""),
                None => diagnostic,
            })
        }
        (stated, written) => {
            let unit = stated.or(written).unwrap_or(default);
            Ok(Some(Found { field, unit, holds: None, by_meaning: false }))
        }
    }
}

/// The column whose heading means an error, in English or German: `Rollenmaß [mm]`, `rack pitch error (um)`. A heading
/// of one letter means nothing here: a table may have any columns.
fn find_meaning(spec: &Spec, header: &Header, kind: ErrorKind) -> Result<Option<Found>, Diagnostic> {
    let field = paste::Field::Error(kind);
    let mut found: Option<(Found, &String)> = None;
    for (index, name) in header.columns.iter().enumerate() {
        let named_otherwise = ErrorKind::ALL.iter().any(|other| {
            let own = spec.batch_column(*other).and_then(|column| column.value.name.as_deref());
            let (plain, _) = name_and_unit(name);
            *other != kind && (own == Some(name.as_str()) || own == Some(plain.as_str()) || plain == other.key())
        });
        if named_otherwise || !has_a_word(name) {
            continue;
        }
        let Some(meaning) = paste::meaning(name).filter(|meaning| meaning.fields.contains(&field)) else { continue };
        // a pitch may be that of the rack or of the pinion: what the spec speaks of decides
        let others = meaning.fields.iter().filter(|other| **other != field);
        let mut others =
            others.filter_map(|other| if let paste::Field::Error(kind) = other { Some(*kind) } else { None });
        if others.clone().next().is_some() && (!spec.speaks_of(kind) || others.any(|other| spec.speaks_of(other))) {
            if spec.speaks_of(kind) {
                let message = format!("{}: `{name}` may be of the rack or of the pinion", header.name);
                return Err(Diagnostic::error(Code::BadTable, message)
                    .help(format!("say which: [batch.columns] {} = {{ name = \"{name}\" }}", kind.key())));
            }
            continue;
        }
        let stated = spec.batch_column(kind).and_then(|column| column.value.unit.as_ref()).map(|unit| unit.value);
        let symbol = stated.or(meaning.unit.as_deref());
        let unit = if kind == ErrorKind::RackLead {
            symbol.map_or(Some(AngleUnit::Degree), AngleUnit::from_symbol).map(Unit::Angle)
        } else {
            symbol.map_or(Some(LengthUnit::Millimetre), LengthUnit::from_symbol).map(Unit::Length)
        };
        let Some(unit) = unit else { continue };
        if let Some((_, first)) = &found {
            let message = format!("{} has two columns for `{}`: `{first}` and `{name}`", header.name, kind.key());
            return Err(Diagnostic::error(Code::BadTable, message)
                .help(format!("say which: [batch.columns] {} = {{ name = \"{name}\" }}", kind.key())));
        }
        found = Some((Found { field: index, unit, holds: meaning.holds, by_meaning: true }, name));
    }
    Ok(found.map(|(found, _)| found))
}

/// Whether a heading has a word or symbol of at least two letters besides its unit.
fn has_a_word(name: &str) -> bool {
    let (plain, _) = name_and_unit(name);
    plain.split(|c: char| !c.is_alphabetic()).any(|word| word.chars().count() > 1)
}

/// Whether the column that names the part has the name that was asked for, or that it has by default.
fn is_named(spec: &Spec, header: &Header, id: usize, asked: Option<&str>) -> bool {
    let named = asked.or(spec.batch.part_id.as_deref());
    matches!(find_name(header, named.unwrap_or("part_id")), Ok(Some(field)) if field == id)
}

/// The column that names the part; `None` if there is none and none was asked for.
pub(super) fn find_id(spec: &Spec, header: &Header, asked: Option<&str>) -> Result<Option<usize>, Diagnostic> {
    let named = asked.or(spec.batch.part_id.as_deref());
    let field = find_name(header, named.unwrap_or("part_id"))?;
    match (field, named) {
        (None, Some(name)) => {
            let message = format!("{} has no column `{name}` that names the part", header.name);
            Err(Diagnostic::error(Code::BadTable, message).help(format!("it has {}", header.names())))
        }
        (Some(field), _) => Ok(Some(field)),
        (None, None) => {
            // a heading that means a part's name, if there is just one
            let meant =
                |name: &String| paste::meaning(name).is_some_and(|found| found.fields == [paste::Field::PartId]);
            let mut fields = header.columns.iter().enumerate().filter(|(_, name)| meant(name));
            Ok(match (fields.next(), fields.next()) {
                (Some((field, _)), None) => Some(field),
                _ => None,
            })
        }
    }
}

/// The column with that name: written so, or else so but for case, blanks and a unit.
fn find_name(header: &Header, wanted: &str) -> Result<Option<usize>, Diagnostic> {
    let twice = |message| Err(Diagnostic::error(Code::BadTable, message));
    let mut exact = header.columns.iter().enumerate().filter(|(_, name)| *name == wanted);
    if let Some((field, _)) = exact.next() {
        return match exact.next() {
            Some(_) => twice(format!("{} has two columns `{wanted}`", header.name)),
            None => Ok(Some(field)),
        };
    }
    let (plain, _) = name_and_unit(wanted);
    let whole = wanted.trim().to_lowercase();
    let mut alike = header.columns.iter().enumerate().filter(|(_, name)| {
        let (name, _) = name_and_unit(name);
        name == plain || name == whole
    });
    match (alike.next(), alike.next()) {
        (Some((_, first)), Some((_, second))) => {
            twice(format!("{} has two columns for `{wanted}`: `{first}` and `{second}`", header.name))
        }
        (found, _) => Ok(found.map(|(field, _)| field)),
    }
}

/// A column that the spec promises or the run needs is not there.
fn missing(spec: &Spec, header: &Header, kind: ErrorKind) -> Diagnostic {
    let column = spec.batch_column(kind);
    let name = column.and_then(|column| column.value.name.as_deref()).unwrap_or(kind.key());
    let diagnostic = Diagnostic::error(Code::BadTable, format!("{} has no column `{name}`", header.name))
        .help(format!("it has {}; name another: [batch.columns] {} = {{ name = \"…\" }}", header.names(), kind.key()));
    match column {
        Some(column) => diagnostic.at(&spec.source, column.span.clone(), "promised here"),
        None => diagnostic,
    }
}
