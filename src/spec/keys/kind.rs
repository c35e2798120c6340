//! What a key of the spec is, and what it may hold; [`section!`] declares those of a section.

use std::marker::PhantomData;
use std::ops::Bound;

use crate::deviation::{Countable, DeviationKind, ToothRange};
use crate::quantity::{Angle, Domain, Length};

/// What a key holds.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    /// Any text.
    Text,
    /// Any text, or a date or number as it is written.
    Label,
    /// A length, mm.
    Length(Domain),
    /// An angle, degrees.
    Angle(Domain),
    /// A number without a unit.
    Number(Domain),
    /// A whole number.
    Count(Domain),
    /// A number in a unit, or text that names one of its other units.
    Measure(Domain, MeasureUnit),
    /// A deviation, or a table from which one follows.
    Error(DeviationKind),
    /// Limits of ΔCD, or of a play.
    Limit,
    /// Limits of a quantity in this unit.
    MeasureLimit(MeasureUnit),
    /// A stroke, or `"tightest"`.
    SetAt,
    /// The name of a file, relative to the spec.
    File,
    /// A list of texts.
    Texts,
    /// A list of patterns for lines, some of which say how many lines they may leave out.
    LineRules,
    /// The heading of a column with the parts' names, or a pattern of lines that have them.
    PartId,
    /// A list of whole numbers.
    Starts,
    /// A nominal value, or the heading of a column of them.
    NominalOrHeading {
        /// Whether it is an angle.
        is_angle: bool,
    },
    /// The unit of a column of lengths; of a column of lead errors, a unit of angle or, of f_Hβ, of length.
    ColumnUnit {
        /// Whether the column holds lead errors.
        of_lead: bool,
    },
    /// On which teeth an error is that counts these.
    Extent(Countable),
    /// One of these words.
    Word(&'static [&'static str]),
    /// True or false.
    Flag,
    /// The name of an accuracy standard and its edition.
    Standard,
    /// Which diameter stands for a rack: `"pinion"`, `"developed"`, or a length.
    RackDiameter,
    /// A decision rule.
    Rule,
    /// The names of two values.
    Pair,
    /// A tolerance of a budget: fixed, or free with a weight or cost.
    Tolerance(DeviationKind),
    /// How a deviation scatters: a standard deviation, a half-width with its distribution, or a class where a
    /// standard limits it as that kind of error.
    Spread {
        /// Whether it is an angle.
        is_angle: bool,
        /// The kind of error whose class it may be.
        class: Option<DeviationKind>,
    },
    /// Which teeth: `"all"`, `5`, `"5"`, `"8.."`, `"8..=12"`.
    Teeth,
    /// A table with these keys.
    Table(&'static Section),
    /// A table with these keys, all of which it must have.
    Whole(&'static Section),
    /// Any number of such tables: `[[section.key]]`.
    Tables(&'static Section),
}

/// A unit that is neither a length nor an angle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasureUnit {
    /// The unit of bare numbers; empty for numbers without a unit.
    pub(crate) symbol: &'static str,
    /// The unit as written after a number, with the space between.
    pub(crate) after: &'static str,
    /// Other ways to write it, and other units: symbol, numerator and denominator of its size.
    pub(crate) others: &'static [(&'static str, f64, f64)],
}

impl MeasureUnit {
    pub(super) const NONE: Self = Self { symbol: "", after: "", others: &[] };
    pub(super) const SPEED: Self = Self { symbol: "mm/s", after: " mm/s", others: &[("m/s", 1000.0, 1.0)] };
    pub(super) const FORCE: Self = Self { symbol: "N", after: " N", others: &[("kN", 1000.0, 1.0)] };
    pub(super) const RATE: Self = Self {
        symbol: "N/mm",
        after: " N/mm",
        others: &[("kN/mm", 1000.0, 1.0), ("N/m", 1.0, 1000.0), ("N/um", 1000.0, 1.0)],
    };
    pub(super) const TORQUE: Self = Self {
        symbol: "N m",
        after: " N m",
        others: &[
            ("Nm", 1.0, 1.0),
            ("N·m", 1.0, 1.0),
            ("N mm", 1.0, 1000.0),
            ("Nmm", 1.0, 1000.0),
            ("N·mm", 1.0, 1000.0),
        ],
    };
    pub(super) const MASS: Self = Self { symbol: "kg", after: " kg", others: &[("g", 1.0, 1000.0)] };
    pub(super) const INERTIA: Self = Self {
        symbol: "kg mm²",
        after: " kg mm²",
        others: &[
            ("kg mm^2", 1.0, 1.0),
            ("kg m²", 1_000_000.0, 1.0),
            ("kg m^2", 1_000_000.0, 1.0),
            ("g mm²", 1.0, 1000.0),
        ],
    };
}

/// A key with any kind of value.
#[derive(Debug, Clone, Copy)]
pub struct AnyKey {
    /// The key with its sections, `rack.face_width`; for a key that several tables have, the name alone.
    pub path: &'static str,
    pub(crate) kind: Kind,
    /// The meaning of the key.
    pub doc: &'static str,
}

impl AnyKey {
    /// The key's name within its section.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }
}

/// A key that holds a `T`.
#[derive(Debug)]
pub struct Key<T> {
    /// The key.
    pub any: AnyKey,
    holds: PhantomData<fn() -> T>,
}

// also where `T` is not
impl<T> Copy for Key<T> {}

impl<T> Clone for Key<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Key<T> {
    pub(super) const fn new(kind: Kind) -> Self {
        Self { any: AnyKey { path: "", kind, doc: "" }, holds: PhantomData }
    }

    pub(super) const fn with(self, path: &'static str, doc: &'static str) -> Self {
        Self { any: AnyKey { path, doc, ..self.any }, ..self }
    }
}

/// One section; the one without a name holds the keys at the top.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section {
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) keys: &'static [AnyKey],
}

pub(super) const fn section(name: &'static str, doc: &'static str, keys: &'static [AnyKey]) -> Section {
    Section { name, doc, keys }
}

/// Declares a section with its keys. A key is declared once, here: what reads, describes, suggests and sets it follows.
/// Keys that are read by name have a constant with their type.
macro_rules! section {
    ($section:ident = $path:literal, $about:literal {
        $($($key:ident: $type:ty =)? $name:literal, $value:expr, $doc:literal;)*
    }) => {
        $($(
            #[doc = $doc]
            pub const $key: Key<$type> = $value.with(concat!($path, ".", $name), $doc);
        )?)*
        pub(crate) const $section: Section =
            section($path, $about, &[$($value.with(concat!($path, ".", $name), $doc).any),*]);
    };
}

pub(super) const fn text() -> Key<String> {
    Key::new(Kind::Text)
}

pub(super) const fn label() -> Key<String> {
    Key::new(Kind::Label)
}

pub(super) const fn file() -> Key<String> {
    Key::new(Kind::File)
}

pub(super) const fn length(domain: Domain) -> Key<Length> {
    Key::new(Kind::Length(domain))
}

pub(super) const fn angle(domain: Domain) -> Key<Angle> {
    Key::new(Kind::Angle(domain))
}

pub(super) const fn number(domain: Domain) -> Key<f64> {
    Key::new(Kind::Number(domain))
}

pub(super) const fn measure(domain: Domain, unit: MeasureUnit) -> Key<f64> {
    Key::new(Kind::Measure(domain, unit))
}

pub(super) const fn count(domain: Domain) -> Key<u32> {
    Key::new(Kind::Count(domain))
}

pub(super) const fn word(words: &'static [&'static str]) -> Key<&'static str> {
    Key::new(Kind::Word(words))
}

pub(super) const fn flag() -> Key<bool> {
    Key::new(Kind::Flag)
}

pub(super) const fn teeth() -> Key<ToothRange> {
    Key::new(Kind::Teeth)
}

/// A key that does not hold one value: the reader of its section reads it.
pub(super) const fn of(kind: Kind) -> Key<()> {
    Key::new(kind)
}

/// A key without a constant of its own in the program.
pub(super) const fn key(name: &'static str, kind: Kind, doc: &'static str) -> AnyKey {
    AnyKey { path: name, kind, doc }
}

pub(super) const fn between(name: &'static str, symbol: &'static str, lower: i64, upper: i64) -> Domain {
    Domain { name, symbol, lower: Bound::Included(lower), upper: Bound::Included(upper) }
}

pub(super) const fn from_zero(name: &'static str, symbol: &'static str) -> Domain {
    Domain { name, symbol, lower: Bound::Included(0), upper: Bound::Unbounded }
}
