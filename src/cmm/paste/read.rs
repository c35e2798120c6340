//! From columns to values: numbers with one decimal mark, units, nominal values. Called once per possible
//! decimal mark.

use std::sync::Arc;

use super::layout::{Column, Layout};
use super::{Field, Holds, Pasted, PastedPart, Want};
use crate::cmm::written::{DecimalMark, is_empty, normalise};
use crate::cmm::{Measured, PinionTeeth, PinionTooth, RackSpace, RackSpaces};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::formula::domain;
use crate::quantity::{Angle, Length, LengthUnit, QuantityError};

/// A layout, read with one decimal mark.
pub(super) struct Read {
    pub(super) pasted: Pasted,
    /// Each column in words.
    pub(super) columns: Vec<String>,
    /// Each value in words.
    pub(super) values: Vec<String>,
    /// What is counted: `part`, `space`, `tooth`.
    pub(super) unit: &'static str,
    /// Why the values cannot be meant, if they cannot.
    pub(super) implausible: Option<String>,
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    mark: DecimalMark,
    want: &'a Want,
}

pub(super) fn read(source: &Arc<Source>, layout: &Layout, mark: DecimalMark, want: &Want) -> Result<Read, Diagnostic> {
    let reader = Reader { source, mark, want };
    let has = |fields: &[Field]| layout.columns.iter().any(|column| fields.contains(&column.field));
    let rack = has(&[Field::Space, Field::Position]);
    let pinion = has(&[Field::Tooth, Field::LeftPitch, Field::RightPitch, Field::Radial]);
    if rack && pinion {
        return Err(Diagnostic::error(Code::BadTable, "the block mixes spaces of a rack with teeth of a pinion")
            .help("paste them one after the other"));
    }
    // a table of over-pin values alone is one rack's, unless it names parts or other values of parts
    let per_part = has(&[Field::PartId]) || layout.columns.iter().any(|column| matches!(column.field, Field::Error(_)));
    if pinion {
        reader.pinion(layout)
    } else if rack || (has(&[Field::OverPin, Field::Lead]) && !per_part) {
        reader.rack(layout)
    } else {
        reader.parts(layout)
    }
}

impl Reader<'_> {
    /// The quantity of a cell; `None` if there is none.
    fn quantity<Q: std::str::FromStr<Err = QuantityError>>(
        &self,
        column: &Column,
        index: usize,
    ) -> Result<Option<Q>, Diagnostic> {
        let Some(cell) = column.cells.get(index).and_then(Option::as_ref).filter(|cell| !is_empty(&cell.text)) else {
            return Ok(None);
        };
        self.value(column, &cell.text).map(Some).map_err(|problem| {
            let title = if column.title.is_empty() { column.field.key() } else { &column.title };
            let cell_text =
                if problem.contains(cell.text.as_str()) { String::new() } else { format!("`{}`: ", cell.text) };
            Diagnostic::error(Code::BadTable, format!("`{title}`: {cell_text}{problem}")).at(
                self.source,
                cell.span.clone(),
                "",
            )
        })
    }

    fn value<Q: std::str::FromStr<Err = QuantityError>>(&self, column: &Column, text: &str) -> Result<Q, String> {
        let Some(mut number) = normalise(text, self.mark) else {
            return Err(format!("`{text}` is not a number with a {}", self.mark.name()));
        };
        let given = self.want.units.iter().find(|(field, _)| *field == column.field).map(|(_, unit)| unit.as_str());
        if let Some(unit) = column.unit.as_deref().or(given).filter(|_| number.ends_with(|c: char| c.is_ascii_digit()))
        {
            number.push(' ');
            number.push_str(unit);
        }
        number.parse().map_err(|error: QuantityError| error.to_string())
    }

    fn index(&self, column: &Column, row: usize) -> Result<i64, Diagnostic> {
        let cell = column.cells.get(row).and_then(Option::as_ref);
        let text = cell.map_or("", |cell| cell.text.as_str());
        text.parse().map_err(|_| {
            let diagnostic =
                Diagnostic::error(Code::BadTable, format!("`{}`: `{text}` is not a whole number", column.title));
            match cell {
                Some(cell) => diagnostic.at(self.source, cell.span.clone(), ""),
                None => diagnostic,
            }
        })
    }

    fn describe(&self, column: &Column, holds: Option<&str>) -> String {
        let given = self.want.units.iter().find(|(field, _)| *field == column.field).map(|(_, unit)| unit.as_str());
        let default = if column.field.is_angle() { "deg" } else { "mm" };
        let carries = column.cells.iter().flatten().any(|cell| cell.text.ends_with(|c: char| !c.is_ascii_digit()));
        let unit = match column.unit.as_deref().or(given) {
            _ if column.field.is_index() => String::new(),
            Some(unit) => format!(" [{unit}]"),
            None if carries => " [units in cells]".to_owned(),
            None => format!(" [{default}, assumed]"),
        };
        let title = if column.title.is_empty() || column.title.starts_with(column.field.key()) {
            String::new()
        } else {
            format!("\"{}\" = ", column.title)
        };
        let holds = holds.map_or_else(String::new, |holds| format!(" {holds}"));
        format!("{title}{}{unit}{holds}", column.field.key())
    }

    fn parts(&self, layout: &Layout) -> Result<Read, Diagnostic> {
        let ids = layout.columns.iter().find(|column| column.field == Field::PartId);
        let columns: Vec<(ErrorKind, &Column)> = layout
            .columns
            .iter()
            .filter_map(|column| match column.field {
                Field::Error(kind) => Some((kind, column)),
                Field::OverPin => Some((ErrorKind::RackOverRoller, column)),
                Field::Lead => Some((ErrorKind::RackLead, column)),
                _ => None,
            })
            .collect();
        let mut described: Vec<String> = ids.map(|column| self.describe(column, None)).into_iter().collect();
        let mut nominals = Vec::new();
        for (kind, column) in &columns {
            let nominal = self.nominal(*kind, column)?;
            described.push(match &nominal {
                Some(nominal) => self.describe(column, Some(&format!("measured, nominal {}", in_words(*nominal)))),
                None => self.describe(column, Some("deviation")),
            });
            nominals.push(nominal);
        }
        let mut implausible = None;
        let (mut parts, mut values) = (Vec::new(), Vec::new());
        for (row, (line, span)) in layout.places.iter().enumerate() {
            let id = ids.and_then(|column| column.cells.get(row)?.as_ref()).map(|cell| cell.text.clone());
            let mut part = PastedPart { id, line: *line, errors: Vec::new(), problems: Vec::new() };
            for ((kind, column), nominal) in columns.iter().zip(&nominals) {
                match self.error(*kind, column, row, *nominal) {
                    Ok(Some((value, doubt))) => {
                        values.push(format!("{} {}", kind.key(), in_words(value)));
                        if let (Some(doubt), Some(Some(cell))) = (doubt, column.cells.get(row)) {
                            let diagnostic = Diagnostic::error(Code::OutOfDomain, format!("{kind}: {doubt}"))
                                .at(self.source, cell.span.clone(), "")
                                .help(
                                    "check the unit and the decimal mark; a column of deviations is named so: \
                                     `rack_over_roller deviation`",
                                );
                            implausible = Some(doubt);
                            part.problems.push(diagnostic);
                        }
                        part.errors.push((*kind, value));
                    }
                    Ok(None) => {
                        let message = format!("there is no value for {kind}");
                        let diagnostic = Diagnostic::error(Code::BadTable, message).at(self.source, span.clone(), "");
                        part.problems.push(
                            diagnostic.help("a part is judged by all its values; give it, or leave the column out"),
                        );
                    }
                    Err(diagnostic) => part.problems.push(diagnostic),
                }
            }
            part.errors.sort_by_key(|(kind, _)| *kind);
            parts.push(part);
        }
        Ok(Read { pasted: Pasted::Parts(parts), columns: described, values, unit: "part", implausible })
    }

    /// The nominal value of a column that holds measured values; `None` if it holds deviations.
    fn nominal(&self, kind: ErrorKind, column: &Column) -> Result<Option<ErrorValue>, Diagnostic> {
        if column.holds == Some(Holds::Deviation) {
            return Ok(None);
        }
        let in_block = match &column.nominal {
            Some(cell) => {
                let value = match kind {
                    ErrorKind::RackLead => self.value(column, &cell.text).map(ErrorValue::Angle),
                    _ => self.value(column, &cell.text).map(ErrorValue::Length),
                };
                Some(value.map_err(|problem| {
                    Diagnostic::error(Code::BadTable, format!("nominal value of {kind}: {problem}")).at(
                        self.source,
                        cell.span.clone(),
                        "",
                    )
                })?)
            }
            None => None,
        };
        let in_spec = self.want.nominals.iter().find(|(of, _)| *of == kind).map(|(_, value)| *value);
        match (in_block, in_spec, column.holds) {
            (Some(block), Some(spec), _) if block != spec => {
                let message = format!(
                    "the nominal value of {kind} is {} in the block and {} in the spec",
                    in_words(block),
                    in_words(spec)
                );
                let span = column.nominal.as_ref().map_or(0..0, |cell| cell.span.clone());
                Err(Diagnostic::error(Code::BadTable, message)
                    .at(self.source, span, "")
                    .help("correct the one that is wrong"))
            }
            (Some(nominal), ..) | (None, Some(nominal), _) => Ok(Some(nominal)),
            (None, None, Some(Holds::Measured)) => {
                let message =
                    format!("`{}` holds measured values, and nothing tells the nominal value of {kind}", column.title);
                let span = column.cells.iter().flatten().next().map_or(0..0, |cell| cell.span.clone());
                Err(Diagnostic::error(Code::BadTable, message).at(self.source, span, "").help(format!(
                    "write `{} = {{ measured = …, nominal = … }}` below [errors] of the spec, or paste the column of nominal values too",
                    kind.key()
                )))
            }
            (None, None, _) => Ok(None),
        }
    }

    /// A deviation, and why it cannot be meant, if it cannot.
    fn error(
        &self,
        kind: ErrorKind,
        column: &Column,
        row: usize,
        nominal: Option<ErrorValue>,
    ) -> Result<Option<(ErrorValue, Option<String>)>, Diagnostic> {
        if kind == ErrorKind::RackLead {
            let Some(mut angle) = self.quantity::<Angle>(column, row)? else { return Ok(None) };
            if let Some(ErrorValue::Angle(nominal)) = nominal {
                angle = angle - nominal;
            }
            let doubt = domain::LEAD_ERROR.check_angle(angle).err().map(|error| error.to_string());
            return Ok(Some((ErrorValue::Angle(angle), doubt)));
        }
        let Some(written) = self.quantity::<Length>(column, row)? else { return Ok(None) };
        let mut length = written;
        if let Some(ErrorValue::Length(nominal)) = nominal {
            length = written - nominal;
        }
        // a deviation without a nominal value may be any size: nobody knows better than who measured it
        let doubt = match nominal {
            Some(ErrorValue::Length(nominal)) => {
                let bound = self.want.module.unwrap_or_else(|| nominal.abs());
                (!bound.is_zero() && length.abs() > bound)
                    .then(|| format!("{written} is far from the nominal value {nominal}"))
            }
            _ => None,
        };
        Ok(Some((ErrorValue::Length(length), doubt)))
    }

    fn rack(&self, layout: &Layout) -> Result<Read, Diagnostic> {
        let find = |fields: &[Field]| layout.columns.iter().find(|column| fields.contains(&column.field));
        let number = find(&[Field::Space]).or_else(|| self.whole_numbers(find(&[Field::PartId])));
        let over_pin = find(&[Field::OverPin, Field::Error(ErrorKind::RackOverRoller)]);
        let position = find(&[Field::Position]);
        let lead = find(&[Field::Lead, Field::Error(ErrorKind::RackLead)]);
        let deviation = |column: Option<&Column>| column.is_some_and(|column| column.holds == Some(Holds::Deviation));
        let measured = |column: Option<&Column>, row| -> Result<Option<Measured>, Diagnostic> {
            let Some(found) = column else { return Ok(None) };
            let wrap = if deviation(column) { Measured::Deviation } else { Measured::Absolute };
            Ok(self.quantity::<Length>(found, row)?.map(wrap))
        };
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for (index, (_, span)) in layout.places.iter().enumerate() {
            let row = RackSpace {
                space: self.number(number, index)?,
                over_pin: measured(over_pin, index)?,
                position: measured(position, index)?,
                lead: lead.map_or(Ok(None), |column| self.quantity::<Angle>(column, index))?,
                span: span.clone(),
            };
            values.extend(row.over_pin.iter().chain(&row.position).map(|measured| match measured {
                Measured::Absolute(length) | Measured::Deviation(length) => length.to_string(),
            }));
            values.extend(row.lead.as_ref().map(ToString::to_string));
            rows.push(row);
        }
        self.unique(rows.iter().map(|row| (row.space, row.span.clone())), "space")?;
        let word = |column| if deviation(column) { "deviation" } else { "measured" };
        let columns = [
            (number, None),
            (over_pin, Some(word(over_pin))),
            (position, Some(word(position))),
            (lead, Some("deviation")),
        ];
        Ok(Read {
            columns: columns.iter().filter_map(|(column, holds)| Some(self.describe((*column)?, *holds))).collect(),
            pasted: Pasted::Rack(RackSpaces { source: Arc::clone(self.source), rows }),
            values,
            unit: "space",
            implausible: None,
        })
    }

    fn pinion(&self, layout: &Layout) -> Result<Read, Diagnostic> {
        let find = |fields: &[Field]| layout.columns.iter().find(|column| fields.contains(&column.field));
        let number = find(&[Field::Tooth]).or_else(|| self.whole_numbers(find(&[Field::PartId])));
        if let Some(pitch) = find(&[Field::Error(ErrorKind::PinionPitch), Field::Error(ErrorKind::RackPitch)]) {
            let message = format!("`{}` of a tooth could be that of its left or its right flank", pitch.title);
            return Err(Diagnostic::error(Code::AmbiguousBlock, message).help("name it left_pitch or right_pitch"));
        }
        let radial = find(&[Field::Radial, Field::Error(ErrorKind::PinionRadial)]);
        let (left, right) = (find(&[Field::LeftPitch]), find(&[Field::RightPitch]));
        let lead = find(&[Field::Lead, Field::Error(ErrorKind::RackLead)]);
        if let Some(column) = radial.filter(|column| column.holds == Some(Holds::Measured)) {
            let message = format!("`{}` holds measured radii; their deviations are needed", column.title);
            return Err(Diagnostic::error(Code::BadTable, message).help("paste the column of radial deviations"));
        }
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for (index, (_, span)) in layout.places.iter().enumerate() {
            let length =
                |column: Option<&Column>| column.map_or(Ok(None), |column| self.quantity::<Length>(column, index));
            let row = PinionTooth {
                tooth: self.number(number, index)?,
                radial: length(radial)?,
                position: None,
                left_pitch: length(left)?,
                right_pitch: length(right)?,
                lead: lead.map_or(Ok(None), |column| self.quantity::<Angle>(column, index))?,
                span: span.clone(),
            };
            let lengths = [&row.radial, &row.left_pitch, &row.right_pitch];
            values.extend(lengths.into_iter().flatten().map(ToString::to_string));
            values.extend(row.lead.as_ref().map(ToString::to_string));
            rows.push(row);
        }
        self.unique(rows.iter().map(|row| (row.tooth, row.span.clone())), "tooth")?;
        let columns = [number, radial, left, right, lead].into_iter().flatten();
        Ok(Read {
            columns: columns
                .map(|column| self.describe(column, (!column.field.is_index()).then_some("deviation")))
                .collect(),
            pasted: Pasted::Pinion(PinionTeeth { source: Arc::clone(self.source), rows }),
            values,
            unit: "tooth",
            implausible: None,
        })
    }

    /// A column named `nr` that counts.
    fn whole_numbers<'c>(&self, column: Option<&'c Column>) -> Option<&'c Column> {
        column.filter(|column| (0..column.cells.len()).all(|row| self.index(column, row).is_ok()))
    }

    fn number(&self, column: Option<&Column>, row: usize) -> Result<i64, Diagnostic> {
        match column {
            Some(column) => self.index(column, row),
            None => Ok(i64::try_from(row).unwrap_or(i64::MAX)),
        }
    }

    fn unique(&self, rows: impl Iterator<Item = (i64, std::ops::Range<usize>)>, what: &str) -> Result<(), Diagnostic> {
        let mut seen = std::collections::BTreeSet::new();
        for (number, span) in rows {
            if !seen.insert(number) {
                let message = format!("{what} {number} has two rows");
                return Err(Diagnostic::error(Code::BadTable, message).at(self.source, span, ""));
            }
        }
        Ok(())
    }
}

fn in_words(value: ErrorValue) -> String {
    match value {
        ErrorValue::Length(length) if !length.is_zero() && length.abs().mm() < 0.1 => {
            format!("{} µm", length.in_unit(LengthUnit::Micrometre))
        }
        value => value.to_string(),
    }
}
