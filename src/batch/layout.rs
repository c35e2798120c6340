//! Where a table has the columns that the plan needs. Made once per table; reads no row.

use super::output::Output;
use super::plan::Plan;
use super::source::{Source, missing, nominal_of};
use crate::deviation::plausible::{DoubtedColumn, Reach};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::table::{Nominal, Table, Wanted};

/// The places of the plan's columns in one table.
#[derive(Debug, Clone)]
pub struct Layout {
    /// The column of each source of the plan; `None` for an error that every part has from the spec.
    pub(super) columns: Vec<Option<usize>>,
    /// The titles of the table's columns, for messages.
    pub(super) titles: Vec<String>,
    /// The nominal value of each source, where every part has one.
    pub(super) nominals: Vec<Option<DeviationValue>>,
    /// The fields that outputs copy, in the outputs' order.
    copied: Vec<usize>,
}

impl Layout {
    /// Finds the plan's columns in a table.
    ///
    /// # Errors
    /// A diagnostic for each column that the plan needs and the table lacks, or that the plan does not know.
    pub fn new(plan: &Plan, table: &Table) -> Result<Self, Diagnostics> {
        let mut diagnostics = Vec::new();
        let bad = |message: String| Diagnostic::error(Code::BadTable, message);
        if table.is_teeth {
            let message = format!("{}: each row is a tooth or a space, and not a part", table.name);
            return Err(bad(message).help("put the exact mesh to work: --teeth").into());
        }
        let mut columns = Vec::new();
        for source in &plan.sources {
            if source.of_every_part.is_some() {
                columns.push(None);
                continue;
            }
            let kind = source.law.kind();
            let found = table.columns.iter().position(|column| column.kind == Some(kind));
            let Some(found) = found else {
                diagnostics.push(missing(&plan.spec, table, kind));
                continue;
            };
            let column = &table.columns[found];
            if nominal_of(column) != source.nominal {
                diagnostics.push(bad(format!(
                    "{}, column `{}`: of measured values and deviations it does not hold what the first table's holds",
                    table.name, column.title
                )));
            }
            columns.push(Some(found));
        }
        let known = |kind| plan.present.contains(&kind);
        for column in table.columns.iter().filter(|column| column.kind.is_some_and(|kind| !known(kind))) {
            let message = format!("{}: the first table has no column like `{}`", table.name, column.title);
            diagnostics.push(bad(message).help("give tables with the same columns, or evaluate them one by one"));
        }
        let mut copied = Vec::new();
        for output in &plan.outputs {
            let Output::Copied(name) = output else { continue };
            match table.titles.iter().position(|title| title == name) {
                Some(field) => copied.push(field),
                // a place without a cell
                None if plan.request.copied.contains(name) => copied.push(usize::MAX),
                None => diagnostics.push(bad(format!("{} has no column `{name}`, which is to be written", table.name))),
            }
        }
        if !diagnostics.is_empty() {
            return Err(Diagnostics(diagnostics));
        }
        let titles = table.columns.iter().map(|column| column.title.clone()).collect();
        let nominal = |column: &Option<usize>| {
            let column = &table.columns[(*column)?];
            nominal_of(column).or(column.stated.filter(|_| column.nominal == Nominal::Beside))
        };
        Ok(Self { nominals: columns.iter().map(nominal).collect(), columns, titles, copied })
    }

    /// A sentence for each column that has suspicious values, of which `counts` has one number per source of the plan.
    pub(super) fn doubts(&self, plan: &Plan, table: &str, counts: &[u64]) -> Vec<String> {
        let usual = Reach::usual(plan.spec.module());
        let sources = plan.sources.iter().zip(&self.columns).zip(counts).filter(|(_, count)| **count > 0);
        let sentence = |((source, column), count): ((&Source, &Option<usize>), &u64)| {
            let title = self.titles.get((*column)?)?;
            let is_lead = source.law.kind() == DeviationKind::RackLead;
            Some(format!("{table}: `{title}`: {}", DoubtedColumn { usual, is_lead, count: *count }))
        };
        sources.filter_map(sentence).collect()
    }

    /// The columns to read from the table's rows.
    pub(super) fn wanted(&self, keeps_raw: bool) -> Wanted {
        Wanted { copied: self.copied.clone(), keeps_raw }
    }
}
