//! An entry of `[table.columns]`: its keys with their values as TOML.

use std::fmt;

use crate::table::want::quoted;

/// An entry of `[table.columns]`. A heading alone is a value without a key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Entry(Vec<(String, String)>);

impl Entry {
    /// The entry that is a heading alone.
    pub(crate) fn heading(title: &str) -> Self {
        Self(vec![(String::new(), quoted(title))])
    }

    pub(crate) fn of<'k>(keys: impl IntoIterator<Item = (&'k str, String)>) -> Self {
        Self(keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
    }

    /// The column of a heading, with the unit of its numbers.
    pub(crate) fn named(name: &str, unit: Option<&str>) -> Self {
        Self::of([("name", quoted(name))].into_iter().chain(unit.map(|unit| ("unit", quoted(unit)))))
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.0.iter().any(|(own, _)| own == key)
    }

    /// Whether the entry names the column of this heading.
    pub(crate) fn is_of(&self, name: &str) -> bool {
        let name = quoted(name);
        self.0.iter().any(|(_, value)| *value == name)
    }

    /// This entry with the keys of another one that it lacks. An entry that is a heading alone lacks none.
    pub(crate) fn and(&self, other: &Self) -> Self {
        let lacked = |(key, _): &&(String, String)| !self.has("") && !other.has("") && !self.has(key);
        Self(self.0.iter().chain(other.0.iter().filter(lacked)).cloned().collect())
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0[..] {
            [] => f.write_str("{}"),
            [(key, value)] if key.is_empty() => f.write_str(value),
            keys => {
                let keys: Vec<_> = keys.iter().map(|(key, value)| format!("{key} = {value}")).collect();
                write!(f, "{{ {} }}", keys.join(", "))
            }
        }
    }
}
