//! `[batch]`: what the columns of a table with a row per part hold, and what that means. Called by the batch's plan and
//! the reader of pasted blocks; reads no table.

use super::keys::{self, Section};
use super::reader::SectionReader;
use super::resolve::MissingKeys;
use super::{Located, Spec, WrittenError};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::law::page_of;
use crate::formula::{Law, Model};
use crate::quantity::Length;
use std::ops::Range;

/// `[batch]`.
#[derive(Debug, Clone, Default)]
pub struct BatchSection {
    /// The column that names the part.
    pub part_id: Option<String>,
    /// `[batch.columns]`, in the paper's order.
    pub columns: Vec<(ErrorKind, Located<BatchColumn>)>,
}

/// One entry of `[batch.columns]`.
#[derive(Debug, Clone, Default)]
pub struct BatchColumn {
    /// The column's name in the header.
    pub name: Option<String>,
    /// The unit of its numbers.
    pub unit: Option<Located<&'static str>>,
    /// The nominal value.
    pub nominal: Option<Located<ErrorValue>>,
    /// `measured` or `deviation`.
    pub kind: Option<Located<&'static str>>,
}

/// What the numbers of a column are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Reading {
    /// The error itself.
    Deviation,
    /// A measured value, from which this nominal value is taken.
    Measured(ErrorValue),
}

/// Reads `[batch]`.
pub(super) fn read(reader: &mut SectionReader<'_>) -> BatchSection {
    let columns = reader.table("columns", &keys::BATCH_COLUMNS, |reader| BatchSection {
        part_id: reader.text("part_id"),
        columns: ErrorKind::ALL.into_iter().filter_map(|kind| Some((kind, column(reader, kind)?))).collect(),
    });
    columns.map(|columns| columns.value).unwrap_or_default()
}

fn column(reader: &mut SectionReader<'_>, kind: ErrorKind) -> Option<Located<BatchColumn>> {
    let section: &'static Section =
        if kind == ErrorKind::RackLead { &keys::ANGLE_COLUMN } else { &keys::LENGTH_COLUMN };
    reader.table(kind.key(), section, |reader| BatchColumn {
        name: reader.text("name"),
        unit: reader.word("unit"),
        nominal: if kind == ErrorKind::RackLead {
            let angle = reader.angle("nominal");
            angle.map(|angle| Located { value: ErrorValue::Angle(angle.value), span: angle.span })
        } else {
            let length = reader.length("nominal");
            length.map(|length| Located { value: ErrorValue::Length(length.value), span: length.span })
        },
        kind: reader.word("kind"),
    })
}

impl Spec {
    /// The entry of `[batch.columns]` for an error.
    #[must_use]
    pub fn batch_column(&self, kind: ErrorKind) -> Option<&Located<BatchColumn>> {
        self.batch.columns.iter().find(|(column, _)| *column == kind).map(|(_, column)| column)
    }

    /// Whether the spec says that a batch has a column for this error: `[batch.columns]` has it, or
    /// `[errors]` gives its nominal value or its uncertainty alone.
    #[must_use]
    pub fn expects_column(&self, kind: ErrorKind) -> bool {
        let alone = self.nominals.iter().any(|(nominal, _)| *nominal == kind)
            && self.errors.iter().all(|(error, _)| *error != kind);
        alone || self.unmeasured.iter().any(|(error, _)| *error == kind) || self.batch_column(kind).is_some()
    }

    /// Whether the spec says anything about this error.
    #[must_use]
    pub fn speaks_of(&self, kind: ErrorKind) -> bool {
        self.errors.iter().any(|(error, _)| *error == kind) || self.expects_column(kind)
    }

    /// What the column of an error holds: measured values if `[batch.columns]` or `[errors]` gives a nominal
    /// value (or the roller from which it follows), deviations otherwise.
    ///
    /// # Errors
    /// Diagnostics for gear data that a computed nominal value needs, or a kind of column that contradicts
    /// its nominal value.
    pub fn reading(&self, kind: ErrorKind) -> Result<Reading, Diagnostics> {
        let column = self.batch_column(kind);
        let stated = column.and_then(|column| column.value.kind.as_ref());
        let in_column = column.and_then(|column| column.value.nominal.as_ref());
        let in_errors = self.nominals.iter().find(|(nominal, _)| *nominal == kind).map(|(_, nominal)| nominal);
        let roller = self.errors.iter().find_map(|(error, written)| match &written.value {
            WrittenError::OverRoller { roller, .. } if *error == kind => Some((roller, written)),
            _ => None,
        });
        match stated {
            Some(stated) if stated.value == "deviation" => match in_column {
                Some(nominal) => {
                    let message =
                        format!("the column of `{}` holds deviations, which have no nominal value", kind.key());
                    Err(Diagnostic::error(Code::BadErrorEntry, message)
                        .at(&self.source, nominal.span.clone(), "")
                        .help("remove `nominal`, or write kind = \"measured\"")
                        .into())
                }
                None => Ok(Reading::Deviation),
            },
            Some(stated) if in_column.is_none() && in_errors.is_none() && roller.is_none() => {
                let message =
                    format!("the column of `{}` holds measured values, and there is no nominal value", kind.key());
                Err(Diagnostic::error(Code::MissingKey, message)
                    .at(&self.source, stated.span.clone(), "")
                    .help("add `nominal = …` beside it")
                    .into())
            }
            _ => match (in_column.or(in_errors), roller) {
                (Some(nominal), _) => Ok(Reading::Measured(nominal.value)),
                (None, Some((roller, written))) => self.over_roller(*roller, written).map(Reading::Measured),
                (None, None) => Ok(Reading::Deviation),
            },
        }
    }

    /// The nominal measure over a roller.
    fn over_roller(&self, roller: Length, written: &Located<WrittenError>) -> Result<ErrorValue, Diagnostics> {
        let mut missing = MissingKeys::default();
        let place = Some((written.span.clone(), "its nominal value is to be computed".to_owned()));
        let need = || ("the nominal measure over the roller".to_owned(), place.clone());
        let Some(over_pin) = self.over_pin_of(roller, &mut missing, &need) else {
            return Err(Diagnostics(missing.diagnostics(&self.source).collect()));
        };
        over_pin.measure().map(ErrorValue::Length).map_err(|error| {
            let diagnostic = Diagnostic::error(Code::OutOfDomain, error.to_string());
            diagnostic.at(&self.source, written.span.clone(), "").into()
        })
    }

    /// The law of a kind of error for this gear; `what` needs it.
    ///
    /// # Errors
    /// A diagnostic for each key that the law needs and the spec does not have.
    pub fn law(&self, kind: ErrorKind, what: &str) -> Result<Law, Diagnostics> {
        let mut missing = MissingKeys::default();
        let place = self.place_of(kind);
        let label = page_of(kind).equation(Model::Exact);
        let need = || (what.to_owned(), place.clone().map(|span| (span, label.to_owned())));
        match self.law_of(kind, &mut missing, &need) {
            Some(Ok(law)) => Ok(law),
            Some(Err(error)) => Err(Diagnostic::error(Code::OutOfDomain, error.to_string()).into()),
            None => Err(Diagnostics(missing.diagnostics(&self.source).collect())),
        }
    }

    /// Where the spec speaks of an error.
    fn place_of(&self, kind: ErrorKind) -> Option<Range<usize>> {
        let column = self.batch_column(kind).map(|column| column.span.clone());
        let error = || self.errors.iter().find(|(error, _)| *error == kind).map(|(_, error)| error.span.clone());
        let nominal =
            || self.nominals.iter().find(|(nominal, _)| *nominal == kind).map(|(_, found)| found.span.clone());
        column.or_else(error).or_else(nominal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(text: &str) -> Spec {
        Spec::parse("spec.toml", text).expect(text)
    }

    fn measured(mm: &str) -> Reading {
        Reading::Measured(ErrorValue::Length(mm.parse().unwrap()))
    }

    #[test]
    fn a_nominal_value_makes_a_column_measured() {
        let reading = |text: &str| spec(text).reading(ErrorKind::RackOverRoller).unwrap();
        assert_eq!(reading(""), Reading::Deviation);
        assert_eq!(reading("[errors]\nrack_over_roller = 0.01"), Reading::Deviation);
        assert_eq!(reading("[errors]\nrack_over_roller = { nominal = 25.0 }"), measured("25"));
        assert_eq!(reading("[errors]\nrack_over_roller = { nominal = 25, measured = 25.1 }"), measured("25"));
        assert_eq!(reading("[batch.columns]\nrack_over_roller = { nominal = \"1 in\" }"), measured("25.4"));
        let both = "[errors]\nrack_over_roller = { nominal = 25 }\n[batch.columns]\nrack_over_roller = { kind = \"deviation\" }";
        assert_eq!(reading(both), Reading::Deviation);
        let roller = "[pair]\nnormal_module = 2.5\nnormal_pressure_angle = 20\n[rack]\ndatum = 21.5\n\
                      [errors]\nrack_over_roller = { roller = 5, measured = 26 }";
        let Reading::Measured(ErrorValue::Length(nominal)) = reading(roller) else { panic!() };
        assert_eq!(format!("{:.3}", nominal.mm()), "25.915");
    }

    #[test]
    fn contradictions_are_refused_with_their_place() {
        let problem = |text: &str| spec(text).reading(ErrorKind::RackPitch).unwrap_err().to_string();
        assert_eq!(
            problem("[batch.columns]\nrack_pitch = { kind = \"measured\" }"),
            "spec.toml:2:23: error[missing-key]: the column of `rack_pitch` holds measured values, and there is no nominal value"
        );
        assert!(
            problem("[batch.columns]\nrack_pitch = { kind = \"deviation\", nominal = 6.28 }")
                .contains("error[bad-error-entry]: the column of `rack_pitch` holds deviations")
        );
        let unknown = Spec::parse("spec.toml", "[batch.columns]\nrack_pitch = { unit = \"m\", nme = \"dp\" }");
        let unknown = unknown.unwrap_err().to_string();
        assert!(unknown.contains("`unit` must be \"mm\" or \"um\""), "{unknown}");
        assert!(unknown.contains("no key `nme`"), "{unknown}");
    }

    #[test]
    fn only_what_a_column_needs_is_required() {
        let spec = spec("[errors]\nrack_lead = 0.1");
        assert!(spec.law(ErrorKind::PinionRadial, "the column").is_ok());
        let missing = spec.law(ErrorKind::RackLead, "column `lead`").unwrap_err().to_string();
        assert!(missing.contains("`pair.normal_pressure_angle` is missing; column `lead` needs it"), "{missing}");
        assert!(missing.contains("`rack.face_width` is missing"), "{missing}");
    }
}
