//! Lengths and angles on a grid that holds every decimal of a measurement.
//!
//! A [`Length`] is a whole number of femtometres (1e-12 mm) and an [`Angle`] a whole number of nano-arcseconds. Decimal text
//! therefore keeps its value: `25.0131 mm - 25.0000 mm` is `0.0131 mm`, an inch is `25.4 mm`, and sums, differences and
//! comparisons with a limit are exact. The rounding errors that a spreadsheet leaves on a difference are finer than the
//! grid and vanish.
//!
//! Every other module uses these types; this one knows nothing of gears.
//!
//! ```
//! use rackmesh::quantity::Length;
//!
//! let measured: Length = "25.0131".parse()?;
//! let nominal: Length = "25.0000 mm".parse()?;
//! assert_eq!((measured - nominal).mm(), 0.0131);
//! assert_ne!(25.0131 - 25.0000, 0.0131); // what binary subtraction makes of it
//! # Ok::<(), rackmesh::quantity::QuantityError>(())
//! ```

mod angle;
mod decimals;
mod digits;
mod domain;
mod error;
mod length;
mod number;
mod plain;
mod rounded;
mod unit;

pub use angle::Angle;
#[cfg(feature = "batch")]
pub(crate) use decimals::{Places, write_whole};
#[cfg(feature = "table")]
pub(crate) use digits::PlainSteps;
pub use domain::{Domain, DomainError};
pub use error::QuantityError;
#[cfg(feature = "table")]
pub(crate) use error::{listed, shown};
pub use length::Length;
pub(crate) use number::Decimal;
pub use number::NumberError;
#[cfg(feature = "table")]
pub(crate) use number::parse_f64;
#[cfg(feature = "spec")]
pub(crate) use number::split_number;
pub(crate) use plain::{FM_PER_MM, femtometres, of_femtometres, plain, signed, tidy};
#[cfg(feature = "report")]
pub(crate) use plain::{padded, plain_padded};
pub(crate) use rounded::{Degrees, Rounded};
#[cfg(feature = "spec")]
pub(crate) use unit::spelling_pattern;
pub use unit::{AngleUnit, LengthUnit, Unit};

impl Decimal {
    /// Reads the number of a quantity; `expected` is what the error calls it, `text` the whole text.
    fn of_quantity(written: &str, text: &str, expected: &'static str) -> Result<Self, QuantityError> {
        Self::parse(written).map_err(|reason| QuantityError::Number {
            text: text.to_owned(),
            expected,
            // "abc" has no number at its start, but is not empty
            reason: if reason == NumberError::Empty && !text.trim().is_empty() {
                match Self::parse(text.trim()) {
                    Err(NumberError::NotFinite) => NumberError::NotFinite,
                    _ => NumberError::NotANumber,
                }
            } else {
                reason
            },
        })
    }
}

/// The largest magnitude that is read or computed, in steps of a grid; a sum of nine such fits an `i64`.
pub(crate) const LARGEST: i64 = 1_000_000_000_000_000_000;

/// What lengths and angles share: rounding to the grid, sums, differences, signs.
macro_rules! grid_quantity {
    ($quantity:ident, $steps:ident, $unit:ident, $what:literal, $largest:literal) => {
        impl $quantity {
            /// Zero.
            pub const ZERO: Self = Self { $steps: 0 };

            /// The largest value that is read or computed.
            pub const LARGEST: Self = Self { $steps: super::LARGEST };

            /// The magnitude.
            #[must_use]
            pub const fn abs(self) -> Self {
                // the signs of measured values are random, so a branch on the sign is slow
                let magnitude = self.$steps.unsigned_abs();
                Self { $steps: if magnitude > i64::MAX as u64 { i64::MAX } else { magnitude as i64 } }
            }

            /// Whether the value is exactly zero.
            #[must_use]
            pub const fn is_zero(self) -> bool {
                self.$steps == 0
            }

            /// Whether the value is below zero.
            #[must_use]
            pub const fn is_negative(self) -> bool {
                self.$steps < 0
            }

            /// The value of `steps` steps of the grid; `None` beyond the largest value.
            #[inline]
            fn within(steps: i64) -> Option<Self> {
                (steps.unsigned_abs() <= super::LARGEST.unsigned_abs()).then_some(Self { $steps: steps })
            }

            /// The value of `steps` steps of the grid; `None` is too many. `what` names the quantity in the error.
            fn of_steps(steps: Option<i64>, what: &'static str) -> Result<Self, QuantityError> {
                steps.and_then(Self::within).ok_or(QuantityError::Overflow { what, largest: $largest })
            }

            /// A double in `unit`, read as its shortest decimal.
            fn of_f64(value: f64, unit: $unit) -> Result<Self, QuantityError> {
                match Decimal::parse(&format!("{value:e}")) {
                    Ok(decimal) => Self::of_number(decimal, unit),
                    Err(_) => Err(QuantityError::NotFinite { what: $what, value: value.to_string() }),
                }
            }

            /// Doubles in `unit`, each read as its shortest decimal, less `less`; `None` if one has more than six decimals
            /// or a difference is larger than `largest`.
            #[cfg(feature = "table")]
            pub(crate) fn of_doubles(doubles: &[f64], unit: $unit, less: Self, largest: Self) -> Option<Vec<Self>> {
                let step = unit.scale().of_decimal(6)?;
                let most = Self::LARGEST.$steps / step;
                let mut are_plain = true;
                let values = doubles.iter().map(|value| {
                    let (millionths, is_shortest) = super::number::millionths(*value);
                    let $steps = millionths.wrapping_mul(step).wrapping_sub(less.$steps);
                    are_plain &= is_shortest
                        & (-most..=most).contains(&millionths)
                        & (-largest.$steps..=largest.$steps).contains(&$steps);
                    Self { $steps }
                });
                let values = values.collect();
                are_plain.then_some(values)
            }

            /// A number in `unit`.
            pub(crate) fn of_number(number: Decimal, unit: $unit) -> Result<Self, QuantityError> {
                Self::of_steps(number.steps(unit.scale()), $what)
            }

            /// A number in `unit`; `None` beyond the largest value.
            #[cfg(feature = "table")]
            #[inline]
            pub(crate) fn of_plain(number: Decimal, unit: $unit) -> Option<Self> {
                Self::within(number.steps(unit.scale())?)
            }
        }

        /// Exact: what is read or computed is far from where this saturates.
        impl std::ops::Add for $quantity {
            type Output = Self;
            #[inline]
            fn add(self, other: Self) -> Self {
                Self { $steps: self.$steps.saturating_add(other.$steps) }
            }
        }

        /// Exact: what is read or computed is far from where this saturates.
        impl std::ops::Sub for $quantity {
            type Output = Self;
            #[inline]
            fn sub(self, other: Self) -> Self {
                Self { $steps: self.$steps.saturating_sub(other.$steps) }
            }
        }

        impl std::ops::Neg for $quantity {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self { $steps: self.$steps.saturating_neg() }
            }
        }

        impl std::fmt::Debug for $quantity {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, concat!(stringify!($quantity), "({})"), self)
            }
        }
    };
}
use grid_quantity;
