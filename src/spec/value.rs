//! The values of the keys that hold one value each, by the key's path. The reader of a section fills them; a request names the
//! key and gets the type that the key is declared with.

use std::collections::BTreeMap;
use std::ops::Range;

use super::keys::Key;
use super::{Located, Spec};
use crate::deviation::ToothRange;
use crate::function::SetAt;
use crate::judge::Rule;
use crate::judge::class::RackDiameter;
use crate::quantity::{Angle, Length};
use crate::standard::Standard;

macro_rules! values {
    ($($kind:ident($type:ty), $doc:literal;)*) => {
        /// The value of a key.
        #[derive(Debug, Clone)]
        #[non_exhaustive]
        pub enum Value {
            $(#[doc = $doc] $kind($type),)*
        }

        $(impl KeyType for $type {
            fn of(value: &Value) -> Option<Self> {
                if let Value::$kind(value) = value { Some(value.clone()) } else { None }
            }
        })*
    };
}

/// The types of such values.
pub trait KeyType: Sized {
    /// The value, if it has this type.
    fn of(value: &Value) -> Option<Self>;
}

values! {
    Text(String), "Text, or the name of a file.";
    Length(Length), "A length.";
    Angle(Angle), "An angle.";
    Number(f64), "A number in the key's unit.";
    Count(u32), "A whole number.";
    Word(&'static str), "One of the key's words.";
    Flag(bool), "True or false.";
    Standard(Standard), "An accuracy standard.";
    RackDiameter(RackDiameter), "Which diameter stands for a rack.";
    Rule(Rule), "A decision rule.";
    Teeth(ToothRange), "Which teeth.";
    SetAt(SetAt), "Where the play of the yoke is set.";
    Table(()), "A table, whose keys have values of their own.";
}

/// The values of a spec, with their places.
#[derive(Debug, Clone, Default)]
pub struct Values(BTreeMap<&'static str, Located<Value>>);

impl Values {
    /// The value under a path.
    #[must_use]
    pub fn at(&self, path: &str) -> Option<&Located<Value>> {
        self.0.get(path)
    }

    /// The value under a path, to be changed.
    pub fn at_mut(&mut self, path: &str) -> Option<&mut Value> {
        self.0.get_mut(path).map(|located| &mut located.value)
    }

    /// Whether there is any value whose path begins so.
    #[must_use]
    pub fn has_any_within(&self, path: &str) -> bool {
        self.0.keys().any(|key| key.starts_with(path))
    }

    /// Puts a value under a path.
    pub fn insert(&mut self, path: &'static str, value: Located<Value>) {
        self.0.insert(path, value);
    }

    /// Removes the value of a key.
    pub fn remove<T>(&mut self, key: Key<T>) {
        self.0.remove(key.any.path);
    }

    /// The value of a key and where it stands.
    #[must_use]
    pub fn located<T: KeyType>(&self, key: Key<T>) -> Option<Located<T>> {
        let Located { value, span } = self.at(key.any.path)?;
        Some(Located { value: T::of(value)?, span: span.clone() })
    }
}

impl Spec {
    /// The value of a key, if the spec gives it.
    #[must_use]
    pub fn get<T: KeyType>(&self, key: Key<T>) -> Option<T> {
        self.values.at(key.any.path).and_then(|located| T::of(&located.value))
    }

    /// Whether a setting gives the key, and not the spec's own text.
    #[must_use]
    pub fn is_set<T>(&self, key: Key<T>) -> bool {
        self.place(key).is_some_and(|place| place.start >= self.source.text.len())
    }

    /// The value of a key whose default is zero.
    #[must_use]
    pub fn or_zero<T: KeyType + Default>(&self, key: Key<T>) -> T {
        self.get(key).unwrap_or_default()
    }

    /// Where the value of a key stands.
    #[must_use]
    pub fn place<T>(&self, key: Key<T>) -> Option<Range<usize>> {
        self.values.at(key.any.path).map(|located| located.span.clone())
    }
}
