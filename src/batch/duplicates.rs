//! Part names that appear more than once, with bounded memory.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hasher as _};

use crate::quantity::shown;
use crate::table::{Contradiction, cell_text};

/// Part names that appear more than once.
#[derive(Debug, Clone, Default)]
pub struct Duplicates {
    /// How many parts have the name of an earlier one.
    pub count: u64,
    /// The first such names.
    pub first: Vec<String>,
    /// Whether later names were not checked, because there are too many.
    pub is_cut: bool,
    /// Hashes of the names so far.
    seen: HashSet<u64>,
}

impl Duplicates {
    /// Names that are checked.
    const MOST: usize = 100_000;
    /// Names that are kept.
    const SHOWN: usize = 3;

    /// Whether more names are checked.
    pub(super) fn is_open(&self) -> bool {
        self.seen.len() < Self::MOST
    }

    /// Takes the names of more parts.
    pub(crate) fn add<'n>(&mut self, names: impl Iterator<Item = &'n [u8]>) {
        for name in names.filter(|name| !name.is_empty()) {
            if !self.is_open() {
                self.is_cut = true;
                return;
            }
            let mut hash = DefaultHasher::new();
            hash.write(name);
            if !self.seen.insert(hash.finish()) {
                self.count += 1;
                if self.first.len() < Self::SHOWN {
                    self.first.push(cell_text(name).into_owned());
                }
            }
        }
    }

    /// The refusal of a table in which no part may be there twice.
    pub(crate) fn refusal(&self) -> Option<Contradiction> {
        let name = self.first.first()?;
        Some(Contradiction {
            line: 0,
            column: "part_id".to_owned(),
            message: format!("part `{}` is there twice", shown(name)),
            help: "take one of them out; or say that each counts: [table] repeats = \"all\", or the last one: \"last\"",
        })
    }

    /// The warning, if a name appears more than once.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let cut = if self.is_cut { " among the first 100,000 parts; later ones are not checked" } else { "" };
        let names: Vec<_> = self.first.iter().map(|name| format!("`{}`", shown(name))).collect();
        match self.count {
            0 if self.is_cut => {
                Some("part names: not checked for duplicates beyond the first 100,000 parts".to_owned())
            }
            0 => None,
            1 => Some(format!("two parts have the name {}{cut}", names.join(", "))),
            count => Some(format!("{count} parts have the name of an earlier one, such as {}{cut}", names.join(", "))),
        }
    }
}
