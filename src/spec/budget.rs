//! `[budget]`: which tolerances are fixed, which are sought, and how they add up. Resolved for `rackmesh budget`;
//! allocates nothing.

use toml::de::{DeTable, DeValue};

use super::errors::{of_each, read_error_value, read_extent};
use super::keys;
use super::reader::SectionReader;
use super::resolve::Problems;
use super::{Located, Spec, WrittenError, said_of};
use crate::budget::{Entry, Free, Freedom};
use crate::deviation::{DeviationKind, Extent};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::{PartDeviation, ToleranceEnds};
use crate::judge::LimitTarget;
use crate::judge::class::ErrorClass;

/// `[budget]`.
#[derive(Debug, Clone, Default)]
pub struct BudgetSection {
    /// The errors.
    pub errors: Vec<(DeviationKind, Located<WrittenTolerance>)>,
    /// On which teeth errors may be, where it says so.
    pub extents: Vec<(DeviationKind, Located<Extent>)>,
}

/// One error of `[budget]`.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum WrittenTolerance {
    /// A given tolerance.
    Fixed(ToleranceEnds),
    /// A grade of the standard in `[tolerance]`.
    Class(u8),
    /// To be found.
    Free(Freedom),
}

impl BudgetSection {
    /// On which teeth an error may be: by default on each, with different values.
    #[must_use]
    pub fn extent(&self, kind: DeviationKind) -> Extent {
        said_of(&self.extents, kind).map_or(Extent::Each, |extent| extent.value)
    }
}

/// Reads `[budget]`.
pub(super) fn read(reader: &mut SectionReader<'_>) -> BudgetSection {
    BudgetSection {
        errors: of_each(|kind| tolerance(reader, kind)),
        extents: of_each(|kind| read_extent(reader, kind)),
    }
}

fn tolerance(reader: &mut SectionReader<'_>, kind: DeviationKind) -> Option<Located<WrittenTolerance>> {
    let name = kind.key();
    let value = reader.table.get(name)?;
    let span = value.span();
    let free = |freedom| Some(Located { value: WrittenTolerance::Free(freedom), span: span.clone() });
    match value.get_ref() {
        DeValue::String(text) if text.trim() == "free" => return free(Freedom::Weight(1.0)),
        DeValue::Table(table) if table.len() == 1 && has_extent(table) => return free(Freedom::Weight(1.0)),
        DeValue::Table(table) if table.len() == 1 + usize::from(has_extent(table)) => {
            for (key, freedom) in [("weight", Freedom::Weight as fn(f64) -> Freedom), ("cost", Freedom::Cost)] {
                if let Some(number) = table.get(key) {
                    let number = reader.plain_number(key, number)?;
                    if number <= 0.0 {
                        let message = format!("`{key}` is {number}; it must be above 0");
                        return reader.refuse(Diagnostic::error(Code::OutOfDomain, message), span);
                    }
                    return free(freedom(number));
                }
            }
        }
        _ => {}
    }
    // a measured value is not a tolerance
    let is_tolerance = |key: &str| matches!(key, "value" | "class" | "f_h_beta" | "length" | keys::EXTENT);
    if let DeValue::Table(table) = value.get_ref()
        && !table.iter().all(|(key, _)| is_tolerance(key.get_ref()))
    {
        let message = format!("`{name}` of a budget is a table that makes no tolerance");
        let help = "write \"12 um\", { value = { lower = \"-1 um\", upper = \"5 um\" } }, { class = 7 }, { weight = 2 }, { cost = 3 } or \"free\"; \
                    with an extent { value = \"12 um\", extent = \"one\" } or { weight = 2, extent = \"one\" }";
        return reader.refuse(Diagnostic::error(Code::BadErrorEntry, message).help(help), span);
    }
    let value = match read_error_value(reader, kind, value)?.value? {
        WrittenError::Value(value) => WrittenTolerance::Fixed(ToleranceEnds { farther: value.abs(), nearer: None }),
        WrittenError::Tolerance(ends) => WrittenTolerance::Fixed(ends),
        WrittenError::Class(grade) => WrittenTolerance::Class(grade),
        // a measured value, refused above
        WrittenError::OverRoller { .. } => return None,
    };
    Some(Located { value, span })
}

fn has_extent(table: &DeTable<'_>) -> bool {
    table.contains_key(keys::EXTENT)
}

impl Spec {
    /// The errors of the budget: those in `[budget]`, or all of the paper's, free, if it names none; and the permissible values
    /// of its classes.
    ///
    /// # Errors
    /// Diagnostics for gear data that a formula needs, and classes that have no value.
    pub fn budget_entries(&self) -> Result<(Vec<Entry>, Vec<ErrorClass>), Diagnostics> {
        if self.budget.errors.is_empty() {
            let free = |kind| {
                let law = self.law(kind, "a budget")?;
                Ok(Entry::Free(Free { law, freedom: Freedom::Weight(1.0), extent: Extent::Each }))
            };
            let entries = DeviationKind::OF_PAPER.into_iter().map(free).collect::<Result<_, Diagnostics>>()?;
            return Ok((entries, Vec::new()));
        }
        let (mut entries, mut classes, mut refused) = (Vec::new(), Vec::new(), Vec::new());
        for (kind, written) in &self.budget.errors {
            match self.budget_entry(*kind, written, &mut classes) {
                Ok(entry) => entries.push(entry),
                Err(Diagnostics(problems)) => {
                    for problem in problems {
                        if !refused.contains(&problem) {
                            refused.push(problem);
                        }
                    }
                }
            }
        }
        if refused.is_empty() { Ok((entries, classes)) } else { Err(Diagnostics(refused)) }
    }

    /// Resolves an entry; a class is added to `classes`.
    fn budget_entry(
        &self,
        kind: DeviationKind,
        written: &Located<WrittenTolerance>,
        classes: &mut Vec<ErrorClass>,
    ) -> Result<Entry, Diagnostics> {
        let law = self.law(kind, &format!("the budget of {kind}"))?;
        let extent = self.budget.extent(kind);
        Ok(match written.value {
            WrittenTolerance::Free(freedom) => Entry::Free(Free { law, freedom, extent }),
            WrittenTolerance::Fixed(ends) => Entry::Fixed(PartDeviation::between(law, ends).with_extent(extent)),
            WrittenTolerance::Class(grade) => {
                let mut problems = Problems::default();
                let class = self.class(kind, grade, &written.span, &mut problems);
                let class = problems.answer(class, &self.source)?;
                let tolerance = class.tolerance(law);
                classes.push(class);
                Entry::Fixed(tolerance)
            }
        })
    }

    /// The limits of single errors' ΔCD.
    #[must_use]
    pub fn own_limits(&self) -> Vec<(DeviationKind, crate::judge::Limit)> {
        self.limits
            .iter()
            .filter_map(|(target, limit)| match target {
                LimitTarget::Error(kind) => Some((*kind, limit.value)),
                LimitTarget::CenterDistance => None,
            })
            .collect()
    }
}
