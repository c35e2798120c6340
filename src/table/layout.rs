//! The contract of a table: what its columns and lines are, as a person wrote or confirmed it. Made by the spec's `[table]`, by a
//! layout of its own and by options; obeyed by the reader.

use super::dictionary::Role;
use super::names::{Field, Role as Beside};
use super::number::DecimalMark;
use super::pattern::Pattern;

/// Where the values of a part stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parts {
    /// In a row.
    Rows,
    /// In a column.
    Columns,
}

/// Lines that are no parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LineRule {
    /// What they look like.
    pub pattern: Pattern,
    /// How many of them there may be that could be parts.
    pub at_most: u64,
}

/// The columns of an error, by their headings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeclaredColumn {
    /// The error, or the size of a space or tooth.
    pub field: Field,
    /// What the column of its values is called; `None` if the dictionary finds it.
    pub name: Option<String>,
    /// What the columns beside it are called, with what they hold.
    pub(crate) beside: Vec<(Beside, String)>,
}

/// The contract of a table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Layout {
    /// Where the values of a part stand, if the contract says so.
    pub parts: Option<Parts>,
    /// What separates cells of a text, if the contract says so.
    pub separator: Option<u8>,
    /// The decimal mark, if the contract says so.
    pub decimal: Option<DecimalMark>,
    /// What the column with the parts' names is called; `None` if the dictionary finds it.
    pub part_id: Option<String>,
    /// What the columns of errors are called.
    pub columns: Vec<DeclaredColumn>,
    /// Columns that are not used.
    pub ignore: Vec<Pattern>,
    /// Lines that belong to no part.
    pub ignore_lines: Vec<LineRule>,
    /// Comments and text boxes of a workbook that are not used.
    pub comments: Vec<Pattern>,
    /// Whether every further column is left out.
    pub ignores_others: bool,
    /// Whether a part may be there twice, and each is judged.
    pub may_repeat: bool,
}

impl DeclaredColumn {
    /// The columns of an error; those beside that of its values by the keys of a spec.
    #[must_use]
    pub fn new(field: impl Into<Field>, name: Option<String>, beside: Vec<(&'static str, String)>) -> Self {
        let role = |key| if key == "units" { Beside::Unit } else { Beside::of_key(key).unwrap_or(Beside::Unit) };
        let beside = beside.into_iter().map(|(key, name)| (role(key), name)).collect();
        Self { field: field.into(), name, beside }
    }
}

impl Layout {
    /// The role that the contract gives to a heading, which is its whole text or that without the unit.
    pub(crate) fn declared(&self, title: &str, name: &str) -> Option<Role> {
        let is_called = |declared: &str| is_same(declared, title) || is_same(declared, name);
        if self.part_id.as_deref().is_some_and(is_called) {
            return Some(Role::PartId);
        }
        self.columns.iter().find_map(|column| {
            let own = column.name.as_deref().filter(|name| is_called(name)).map(|_| Role::Value(column.field));
            let beside = || column.beside.iter().find(|(_, name)| is_called(name));
            own.or_else(|| beside().map(|(beside, _)| Role::Beside(column.field, *beside)))
        })
    }

    /// Whether the contract names the heading of a role, so that the dictionary names no other.
    pub(crate) fn names(&self, role: Role) -> bool {
        match role {
            Role::PartId => self.part_id.is_some(),
            Role::Value(field) => self.columns.iter().any(|column| column.field == field && column.name.is_some()),
            Role::Beside(..) | Role::Index(_) | Role::Of(_) => false,
        }
    }

    /// The headings that the contract names and a table must have.
    pub(crate) fn promised(&self) -> impl Iterator<Item = (Role, &str)> {
        let columns = self.columns.iter().flat_map(|column| {
            let own = column.name.as_deref().map(|name| (Role::Value(column.field), name));
            own.into_iter()
                .chain(column.beside.iter().map(|(beside, name)| (Role::Beside(column.field, *beside), name.as_str())))
        });
        self.part_id.as_deref().map(|name| (Role::PartId, name)).into_iter().chain(columns)
    }

    /// The rule that leaves out a column: an exact one, or else a pattern.
    pub(crate) fn ignores(&self, title: &str, name: &str, place: usize, exactly: bool) -> Option<usize> {
        let by_place = format!("column {}", place + 1);
        let texts = [title, name, if title.is_empty() { &by_place } else { title }];
        self.ignore.iter().position(|rule| rule.is_exact() == exactly && texts.iter().any(|text| rule.fits(text)))
    }
}

/// Whether two headings are the same but for their blanks.
fn is_same(one: &str, other: &str) -> bool {
    one.split_whitespace().eq(other.split_whitespace())
}
