//! Lengths and angles, known exactly.
//!
//! A [`Length`] is a rational number of millimetres and an [`Angle`] a rational number of degrees, so
//! that what came in as decimal text stays what was written: `25.0131 mm - 25.0000 mm` is `0.0131 mm`,
//! an inch is `25.4 mm`, and a comparison with a limit is decided in exact arithmetic. A value is
//! rounded once, to the nearest `f64`, where it leaves ([`Length::mm`], [`Angle::degrees`]).
//!
//! Every other module uses these types; this one knows nothing of gears.
//!
//! ```
//! use rackmesh::quantity::Length;
//!
//! let measured: Length = "25.0131".parse()?;
//! let nominal: Length = "25.0000 mm".parse()?;
//! assert_eq!((&measured - &nominal).mm(), 0.0131);
//! assert_ne!(25.0131 - 25.0000, 0.0131); // what binary subtraction makes of it
//! # Ok::<(), rackmesh::quantity::QuantityError>(())
//! ```

mod angle;
mod domain;
mod length;
mod parse;
mod rational;
mod rounded;

pub use angle::{Angle, AngleUnit};
pub use domain::{Bound, Domain, DomainError};
pub use length::{Length, LengthUnit};
#[cfg(feature = "batch")]
pub(crate) use parse::shown;
#[cfg(feature = "spec")]
pub(crate) use parse::split_number;
pub use parse::{NumberError, QuantityError};
pub use rational::Rational;
pub(crate) use rounded::{Degrees, Rounded};

/// The arithmetic that lengths and angles share: sums, differences, sign, order.
macro_rules! exact_arithmetic {
    ($quantity:ident, $field:ident) => {
        impl $quantity {
            /// The magnitude.
            #[must_use]
            pub fn abs(&self) -> Self {
                Self { $field: self.$field.abs() }
            }

            /// Whether the value is exactly zero.
            #[must_use]
            pub fn is_zero(&self) -> bool {
                self.$field.is_zero()
            }

            /// Whether the value is below zero.
            #[must_use]
            pub fn is_negative(&self) -> bool {
                self.$field.is_negative()
            }
        }

        impl std::ops::Add for &$quantity {
            type Output = $quantity;
            fn add(self, other: Self) -> $quantity {
                $quantity { $field: &self.$field + &other.$field }
            }
        }

        impl std::ops::Sub for &$quantity {
            type Output = $quantity;
            fn sub(self, other: Self) -> $quantity {
                $quantity { $field: &self.$field - &other.$field }
            }
        }

        impl std::ops::Neg for &$quantity {
            type Output = $quantity;
            fn neg(self) -> $quantity {
                $quantity { $field: -&self.$field }
            }
        }

        impl std::iter::Sum for $quantity {
            fn sum<I: Iterator<Item = Self>>(values: I) -> Self {
                values.fold(Self::ZERO, |sum, value| &sum + &value)
            }
        }

        impl std::fmt::Debug for $quantity {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, concat!(stringify!($quantity), "({})"), self)
            }
        }
    };
}
use exact_arithmetic;
