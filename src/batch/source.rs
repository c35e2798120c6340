//! The errors of each part that the plan needs, and their columns. The plan makes it; it reads no row.

use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::{Law, PartDeviation, ToleranceEnds};
use crate::judge::bound::ExtendedError;
use crate::judge::{LimitTarget, Limits};
use crate::spec::Spec;
use crate::table::{Column, Nominal, Table};

/// How many kinds of error there are.
pub(super) const KINDS: usize = DeviationKind::ALL.len();

/// One error of each part.
#[derive(Debug, Clone)]
pub(super) struct Source {
    pub(super) law: Law,
    /// The error on its teeth, for the bound.
    pub(super) extended: ExtendedError,
    /// Whether the error is a tolerance, so that it may scatter.
    pub(super) scatters: bool,
    /// Whether it has a limit of its own.
    pub(super) is_limited: bool,
    /// The nominal value to subtract from the numbers of its column, if these are measured values.
    pub(super) nominal: Option<DeviationValue>,
    /// The value that every part has; `None` if it is read from the table.
    pub(super) of_every_part: Option<DeviationValue>,
    /// The tolerance of every part, if the spec gives one in place of a value.
    pub(super) tolerance: Option<ToleranceEnds>,
}

impl Source {
    /// A source for an error of any value.
    fn new(error: &PartDeviation, nominal: Option<DeviationValue>, limits: &Limits) -> Result<Self, Diagnostic> {
        let kind = error.kind();
        // zero is in every domain: only an extent may not fit; a tolerance of two ends is no column's
        let of_any_value =
            if error.tolerance().nearer.is_some() { *error } else { error.with_value(DeviationValue::zero(kind)) };
        let extended = ExtendedError::of(&of_any_value)
            .map_err(|error| Diagnostic::error(Code::BadErrorEntry, format!("{}: {error}", kind.key())))?;
        let is_limited = limits.iter().any(|(on, _)| *on == LimitTarget::Error(kind));
        let (law, scatters) = (error.law(), extended.is_tolerance());
        Ok(Self { law, extended, scatters, is_limited, nominal, of_every_part: None, tolerance: None })
    }
}

/// The place of an error among those that are read.
pub(super) fn index_of(sources: &[Source], kind: DeviationKind) -> Option<usize> {
    sources.iter().position(|source| source.law.kind() == kind)
}

/// The columns of errors that the table has, in the paper's order.
pub(super) fn error_columns(table: &Table) -> Result<Vec<&Column>, Diagnostic> {
    if table.is_teeth {
        let message = format!("{}: each row is a tooth or a space, and not a part", table.name);
        return Err(Diagnostic::error(Code::BadTable, message).help("put the exact mesh to work: --teeth"));
    }
    let of_kind = |kind| table.columns.iter().find(|column| column.kind == Some(kind));
    let found: Vec<&Column> = DeviationKind::ALL.into_iter().filter_map(of_kind).collect();
    if found.is_empty() { Err(no_column(table)) } else { Ok(found) }
}

/// The errors that are needed, each of a column or with the value that every part has.
pub(super) fn sources(
    spec: &Spec,
    needed: &[DeviationKind],
    columns: &[&Column],
    of_every_part: &[PartDeviation],
    limits: &Limits,
) -> Result<Vec<Source>, Diagnostics> {
    let (mut sources, mut diagnostics) = (Vec::new(), Vec::new());
    for kind in needed {
        let of_every_part = of_every_part.iter().find(|error| error.kind() == *kind);
        let (error, nominal) = if let Some(error) = of_every_part {
            (*error, None)
        } else {
            let Some(column) = columns.iter().find(|column| column.kind == Some(*kind)) else { continue };
            match spec.law(*kind, &format!("the column of `{}`", kind.key())) {
                Ok(law) => (spec.extended(PartDeviation::new(law, DeviationValue::zero(*kind))), nominal_of(column)),
                Err(problems) => {
                    diagnostics.extend(problems.0);
                    continue;
                }
            }
        };
        match Source::new(&error, nominal, limits) {
            Ok(source) => sources.push(Source {
                scatters: of_every_part.map_or(source.scatters, scatters),
                of_every_part: of_every_part.map(PartDeviation::value),
                tolerance: of_every_part.filter(|error| error.is_tolerance()).map(PartDeviation::tolerance),
                ..source
            }),
            Err(problem) => diagnostics.push(problem),
        }
    }
    if diagnostics.is_empty() {
        return Ok(sources);
    }
    diagnostics.dedup();
    Err(Diagnostics(diagnostics))
}

/// Whether an error that every part has scatters.
fn scatters(error: &PartDeviation) -> bool {
    ExtendedError::of(error).is_ok_and(|error| error.scatters())
}

/// The nominal value of all numbers of a column.
pub(super) fn nominal_of(column: &Column) -> Option<DeviationValue> {
    if let Nominal::Fixed(nominal) = column.nominal { Some(nominal) } else { None }
}

fn no_column(table: &Table) -> Diagnostic {
    let message = format!("{} has no column of an error that is known", table.name);
    let help = format!(
        "it has {}; name its columns {}, or say what they are: [table.columns] rack_pitch = {{ name = \"…\" }}",
        table.titles_in_words(),
        DeviationKind::keys(DeviationKind::ALL)
    );
    Diagnostic::error(Code::BadTable, message).help(help)
}

/// A column that the spec promises or the run needs is not there.
pub(super) fn missing(spec: &Spec, table: &Table, kind: DeviationKind) -> Diagnostic {
    let column = spec.batch_column(kind);
    let name = column.and_then(|column| column.value.name.as_deref()).unwrap_or(kind.key());
    let diagnostic = Diagnostic::error(Code::BadTable, format!("{} has no column `{name}`", table.name)).help(format!(
        "it has {}; name another: [table.columns] {} = {{ name = \"…\" }}",
        table.titles_in_words(),
        kind.key()
    ));
    match column {
        Some(column) => diagnostic.at(spec.source_of_columns(), column.span.clone(), "promised here"),
        None => diagnostic,
    }
}
