//! `[table]`: what the columns of a table with a row per part hold, and what that means. The plan of a batch and the reader of
//! pasted blocks call it; it reads no table.

use crate::table::{GivenColumn, Layout, ValueKind, Want};
use std::ops::Range;
use std::sync::Arc;

use toml::de::DeValue;

use super::keys;
use super::reader::SectionReader;
use super::resolve::Problems;
use super::{Located, Spec, WrittenError, said_of};
use crate::deviation::{DeviationKind, DeviationValue, Extent};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};
use crate::formula::law::page_of;
use crate::formula::{Law, Model, PartDeviation};
use crate::quantity::{Length, LengthUnit, QuantityError, Unit};
use crate::uncertainty::Influence;

/// `[table]`.
#[derive(Debug, Clone, Default)]
pub struct TableSection {
    /// `[table.columns]`, in the paper's order.
    pub columns: Vec<(DeviationKind, Located<BatchColumn>)>,
    /// The contract for the reader of tables.
    pub layout: Arc<Layout>,
    /// The file of the contract, if it is not the spec.
    pub source: Option<Arc<Source>>,
    /// Where the contract stands in the spec; `None` if it does not.
    pub place: Option<Range<usize>>,
    /// Whether the spec uses the section's old name `[batch]`.
    pub is_called_batch: bool,
}

/// One entry of `[table.columns]`.
#[derive(Debug, Clone, Default)]
pub struct BatchColumn {
    /// The column's name in the header.
    pub name: Option<String>,
    /// The unit of its numbers. For a lead error, a unit of length means the helix slope deviation f_Hβ.
    pub unit: Option<Located<Unit>>,
    /// The evaluation length of f_Hβ, in the entry of a lead error only.
    pub length: Option<Located<Length>>,
    /// The nominal value.
    pub nominal: Option<Located<DeviationValue>>,
    /// `measured` or `deviation`.
    pub kind: Option<Located<&'static str>>,
    /// On which teeth each of its values is.
    pub extent: Option<Located<Extent>>,
    /// The diameter of the circle on which its values were measured, of the pinion's pitch.
    pub measured_at: Option<Located<Length>>,
}

pub(super) fn nominal(reader: &mut SectionReader<'_>, kind: DeviationKind) -> Option<Located<DeviationValue>> {
    match kind {
        DeviationKind::RackLead => reader.get(keys::ANGLE_NOMINAL).map(|nominal| nominal.map(DeviationValue::Angle)),
        _ => reader.get(keys::LENGTH_NOMINAL).map(|nominal| nominal.map(DeviationValue::Length)),
    }
}

impl SectionReader<'_> {
    /// The unit of a column.
    pub(super) fn column_unit(&mut self, name: &str, of_lead: bool) -> Option<Located<Unit>> {
        let value = self.table.get(name)?;
        let symbol = self.text_value(name, value, "a unit in quotes, such as \"um\",")?;
        // ″ is an arcsecond on a lead error, and an inch on any other
        let angle = if of_lead { Unit::of_angle(symbol) } else { None };
        let unit = angle.or_else(|| Unit::of_length(symbol));
        if unit.is_none() {
            let problem = if of_lead {
                format!("{}; or, of f_Hβ, {}", QuantityError::no_unit_of_angle(symbol), LengthUnit::NAMES)
            } else {
                QuantityError::no_unit_of_length(symbol).to_string()
            };
            let message = format!("`{name}`: {problem}");
            self.report(Diagnostic::error(Code::BadQuantity, message), value.span());
        }
        Some(Located { value: unit?, span: value.span() })
    }

    /// The texts of a list; empty if there is no list.
    pub(super) fn texts(&mut self, name: &str) -> Vec<Located<String>> {
        let Some(value) = self.table.get(name) else { return Vec::new() };
        let DeValue::Array(list) = value.get_ref() else {
            self.wrong_type::<()>(name, value, "a list of texts in quotes, such as [\"Temperature*\"],");
            return Vec::new();
        };
        let text = |entry| {
            let text = self.text_value(name, entry, "text in quotes for each entry of its list")?;
            Some(Located { value: text.to_owned(), span: entry.span() })
        };
        list.iter().filter_map(text).collect()
    }
}

impl Spec {
    /// Columns to whose values `[errors]` gives another extent. Beside a value in `[errors]` an extent belongs to that value.
    pub(super) fn other_extents(&self) -> Vec<Diagnostic> {
        let of_tables = self.extents.iter().filter(|(kind, _)| said_of(&self.errors, *kind).is_none());
        let contradicted = of_tables.filter_map(|(kind, in_errors)| {
            let column = self.batch_column(*kind)?;
            let in_column = column.value.extent.as_ref().filter(|extent| extent.value != in_errors.value)?;
            let key = format!("{}.{}", kind.key(), keys::EXTENT);
            let message = format!(
                "`errors.{key}` is \"{}\" and `table.columns.{key}` is \"{}\", and both are of the values of a table",
                in_errors.value, in_column.value
            );
            let diagnostic = Diagnostic::error(Code::BadErrorEntry, message).help("leave one of them out");
            Some(diagnostic.at(self.source_of_columns(), in_column.span.clone(), ""))
        });
        contradicted.collect()
    }

    /// The spec with the `[table]` of a file of its own.
    ///
    /// # Errors
    /// Every problem in that file; or that the spec has a `[table]`, too.
    pub fn with_layout(&self, name: &str, text: &str) -> Result<Self, Diagnostics> {
        let table = super::table::file(name, text)?;
        if self.table.place.is_some() {
            let message = format!("{name} has a [table], and {} has one, too", self.source.name);
            return Err(Diagnostic::usage(message).help("leave one of them out").into());
        }
        let mut spec = Self { table, ..self.clone() };
        let problems = spec.other_extents();
        if !problems.is_empty() {
            return Err(Diagnostics(problems));
        }
        if spec.pitch_circle.is_none() {
            spec.scale_to_reference_circle()?;
        }
        Ok(spec)
    }

    /// The spec by another text of the file that has its `[table]`.
    ///
    /// # Errors
    /// Every problem in that text.
    pub fn with_contract(&self, text: &str) -> Result<Self, Diagnostics> {
        let table = match &self.table.source {
            Some(source) => super::table::file(&source.name, text)?,
            None => Self::parse_with(&self.source.name, text, &self.settings)?.table,
        };
        Ok(Self { table, ..self.clone() })
    }

    /// The file that says what columns are.
    #[must_use]
    pub fn source_of_columns(&self) -> &Arc<Source> {
        self.table.source.as_ref().unwrap_or(&self.source)
    }

    /// The entry of `[table.columns]` for an error.
    #[must_use]
    pub fn batch_column(&self, kind: DeviationKind) -> Option<&Located<BatchColumn>> {
        said_of(&self.table.columns, kind)
    }

    /// The spec's layout of a table, before the table is read; the user's options are added to it.
    #[must_use]
    pub fn want(&self) -> Want {
        Want {
            expected: self.asked_errors(),
            given: DeviationKind::ALL.into_iter().map(|kind| self.given(kind)).collect(),
            module: self.get(keys::PAIR_NORMAL_MODULE),
            face_width: self.get(keys::RACK_FACE_WIDTH),
            pinion_face_width: self.get(keys::PINION_FACE_WIDTH),
            pinion_teeth: self.get(keys::PINION_TEETH).map(i64::from),
            over_pin: self.nominal_over_pin().ok(),
            layout: Arc::clone(&self.table.layout),
            ..Want::default()
        }
    }

    /// The spec's layout of the column of an error.
    fn given(&self, kind: DeviationKind) -> GivenColumn {
        let column = self.batch_column(kind).map(|column| &column.value);
        let stated = column.and_then(|column| column.kind.as_ref()).map(|stated| stated.value);
        let holds = stated.map(|stated| if stated == "deviation" { ValueKind::Deviation } else { ValueKind::Measured });
        GivenColumn {
            kind,
            unit: column.and_then(|column| column.unit.as_ref()).map(|unit| unit.value),
            holds,
            nominal: self.nominal_of_column(kind).transpose(),
            length: column
                .and_then(|column| column.length.as_ref())
                .map(|length| length.value)
                .or(self.evaluation_length.filter(|_| kind == DeviationKind::RackLead)),
        }
    }

    /// The spec for tables that have columns of these errors: with the extents of `[table.columns]`, where it gives them.
    #[must_use]
    pub fn for_columns(&self, in_table: &[DeviationKind]) -> Self {
        let mut spec = self.clone();
        for kind in in_table {
            if let Some(extent) = self.batch_column(*kind).and_then(|column| column.value.extent.clone()) {
                spec.extents.retain(|(other, _)| other != kind);
                spec.extents.push((*kind, extent));
            }
        }
        let is_replaced = |kind: &DeviationKind| in_table.contains(kind) && self.of_readings.contains(kind);
        spec.uncertainties.retain(|(source, _)| !matches!(source, Influence::Error(kind) if is_replaced(kind)));
        spec
    }

    /// The extents of errors in words, where the spec gives them: `rack_pitch each (every pitch, any sign)`.
    #[must_use]
    pub fn extents_in_words(&self, errors: &[DeviationKind]) -> Option<String> {
        let stated = errors.iter().filter_map(|kind| {
            let extent = said_of(&self.extents, *kind)?;
            Some(format!("{} {} ({})", kind.key(), extent.value, extent.value.words(kind.counts(), None)))
        });
        let stated: Vec<_> = stated.collect();
        (!stated.is_empty()).then(|| format!("extent: {}", stated.join("; ")))
    }

    /// Whether `[errors]` or `[table.columns]` names an error.
    pub(super) fn speaks_of(&self, kind: DeviationKind) -> bool {
        self.every_part.contains(&kind) || self.asked_errors().contains(&kind)
    }

    /// The errors that the spec asks for of each part: first those with columns, each group in its order.
    fn asked_errors(&self) -> Vec<DeviationKind> {
        let columns = self.table.columns.iter().map(|(kind, column)| (column.span.start, *kind));
        let errors = self.errors.iter().map(|(kind, error)| (error.span.start, *kind));
        let nominals = self.nominals.iter().map(|(kind, nominal)| (nominal.span.start, *kind));
        let unmeasured = self.unmeasured.iter().map(|(kind, place)| (place.start, *kind));
        let mut asked: Vec<DeviationKind> = Vec::new();
        for mut written in [columns.collect::<Vec<_>>(), errors.chain(nominals).chain(unmeasured).collect()] {
            written.sort_unstable();
            for (_, kind) in written {
                if !asked.contains(&kind) && !self.every_part.contains(&kind) {
                    asked.push(kind);
                }
            }
        }
        asked
    }

    /// The errors whose value in `[errors]` holds for every part, without those that a table has.
    ///
    /// # Errors
    /// Diagnostics for gear data that a formula needs, or a value that it does not take.
    pub fn errors_of_every_part(&self, in_table: &[DeviationKind]) -> Result<Vec<PartDeviation>, Diagnostics> {
        let is_so = |kind: &DeviationKind| self.every_part.contains(kind) && !in_table.contains(kind);
        let errors = self.errors.iter().filter(|(kind, _)| is_so(kind)).cloned().collect::<Vec<_>>();
        if errors.is_empty() {
            return Ok(Vec::new());
        }
        Self { errors, nominals: Vec::new(), unmeasured: Vec::new(), ..self.clone() }.part_deviations()
    }

    /// The errors that the spec asks for and a table lacks: without them there is no sum for a part.
    #[must_use]
    pub fn lacking(&self, in_table: &[DeviationKind]) -> Vec<DeviationKind> {
        self.asked_errors().into_iter().filter(|kind| !in_table.contains(kind)).collect()
    }

    /// The nominal value to subtract from the numbers of an error's column, if they are measured values: that is, if
    /// `[table.columns]` or `[errors]` gives a nominal value, or the roller from which it follows. Otherwise they are deviations.
    ///
    /// # Errors
    /// Diagnostics for gear data that a computed nominal value needs, or a kind of column that contradicts
    /// its nominal value.
    pub fn nominal_of_column(&self, kind: DeviationKind) -> Result<Option<DeviationValue>, Diagnostics> {
        let column = self.batch_column(kind).map(|column| &column.value);
        let stated = column.and_then(|column| column.kind.as_ref());
        let in_column = column.and_then(|column| column.nominal.as_ref());
        let nominal = in_column.or(said_of(&self.nominals, kind));
        let refused = |code, holds, span: &Range<usize>, help| {
            let message = format!("the column of `{}` holds {holds}", kind.key());
            Err(Diagnostic::error(code, message).at(self.source_of_columns(), span.clone(), "").help(help).into())
        };
        match (stated, nominal, self.roller_of(kind)) {
            (Some(stated), ..) if stated.value == "deviation" => in_column.map_or(Ok(None), |nominal| {
                let help = "remove `nominal`, or write kind = \"measured\"";
                refused(Code::BadErrorEntry, "deviations, which have no nominal value", &nominal.span, help)
            }),
            (Some(stated), None, None) => {
                let holds = "measured values, and there is no nominal value";
                refused(Code::MissingKey, holds, &stated.span, "add `nominal = …` beside it")
            }
            (_, Some(nominal), _)
                if said_of(&self.nominals, kind).is_some_and(|other| other.value != nominal.value) =>
            {
                let holds = "values less the nominal one, and [errors] gives another nominal value";
                refused(Code::BadErrorEntry, holds, &nominal.span, "give one nominal value")
            }
            (_, Some(nominal), _) => Ok(Some(nominal.value)),
            (_, None, Some((roller, written))) => self.over_roller(roller, written).map(Some),
            (None, None, None) => Ok(None),
        }
    }

    /// The roller from which a nominal measure is to be computed, and where it is written.
    fn roller_of(&self, kind: DeviationKind) -> Option<(Length, &Located<WrittenError>)> {
        let written = said_of(&self.errors, kind)?;
        if let WrittenError::OverRoller { roller, .. } = written.value { Some((roller, written)) } else { None }
    }

    /// The nominal measure over a roller.
    fn over_roller(&self, roller: Length, written: &Located<WrittenError>) -> Result<DeviationValue, Diagnostics> {
        let mut problems = Problems::default();
        let place = Some((written.span.clone(), "its nominal value is to be computed".to_owned()));
        let need = || ("the nominal measure over the roller".to_owned(), place.clone());
        let over_pin = self.over_pin_of(roller, &mut problems, &need);
        problems.answer(over_pin, &self.source)?.measure().map(DeviationValue::Length).map_err(|error| {
            let diagnostic = Diagnostic::error(Code::OutOfDomain, error.to_string());
            diagnostic.at(&self.source, written.span.clone(), "").into()
        })
    }

    /// The law of a kind of error for this gear; `what` needs it.
    ///
    /// # Errors
    /// A diagnostic for each key that the law needs and the spec does not have.
    pub fn law(&self, kind: DeviationKind, what: &str) -> Result<Law, Diagnostics> {
        let mut problems = Problems::default();
        let place = self.place_of(kind);
        let label = page_of(kind).equation(Model::Exact);
        let need = || (what.to_owned(), place.clone().map(|span| (span, label.to_owned())));
        let law = self.law_of(kind, &mut problems, &need);
        let law = problems.answer(law, &self.source)?;
        law.map_err(|error| Diagnostic::error(Code::OutOfDomain, error.to_string()).into())
    }

    /// Where the spec mentions an error.
    fn place_of(&self, kind: DeviationKind) -> Option<Range<usize>> {
        let column = self.batch_column(kind).filter(|_| self.table.source.is_none()).map(|column| column.span.clone());
        let error = || said_of(&self.errors, kind).map(|error| error.span.clone());
        let nominal = || said_of(&self.nominals, kind).map(|nominal| nominal.span.clone());
        column.or_else(error).or_else(nominal)
    }
}

#[cfg(test)]
mod tests;
