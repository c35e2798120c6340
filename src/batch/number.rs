//! Lengths as the text of a row, which is most of what a batch writes. The evaluator calls it.

use crate::quantity::Length;

/// How many decimals of a millimetre are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decimals {
    /// This number of decimals, rounded half away from zero.
    Places(u8),
    /// The shortest text that reads back as the same double, as `eval` prints it.
    Full,
}

impl Decimals {
    /// The largest number of decimals.
    pub const MOST: u8 = 30;

    /// The double that a length reads as when it is written.
    pub(super) fn value(self, length: Length) -> f64 {
        match self {
            Self::Places(places) => VALUES.get(usize::from(places)).map_or(length.mm(), |(value, _)| value(length)),
            Self::Full => length.mm(),
        }
    }

    /// Appends these doubles of several lengths.
    pub(super) fn extend(self, values: &mut Vec<f64>, lengths: &[Length]) {
        let several = match self {
            Self::Places(places) => VALUES.get(usize::from(places)).map(|(_, several)| several),
            Self::Full => None,
        };
        match several {
            Some(several) => several(values, lengths),
            None => values.extend(lengths.iter().map(|length| length.mm())),
        }
    }

    /// A number that is not a length of the grid: an uncertainty in mm, a probability.
    pub(super) fn text(self, value: f64) -> String {
        match (self, Length::from_mm(value)) {
            (Self::Places(places), Ok(length)) => length.to_decimal_text(places.into()),
            _ => crate::quantity::plain(value),
        }
    }
}

/// The double of one length, and those of several.
type Values = (fn(Length) -> f64, fn(&mut Vec<f64>, &[Length]));

/// A length in units of so many decimals; one branch for each number, so that each divides by a constant.
const VALUES: [Values; 12] = [
    (value::<0>, several::<0>),
    (value::<1>, several::<1>),
    (value::<2>, several::<2>),
    (value::<3>, several::<3>),
    (value::<4>, several::<4>),
    (value::<5>, several::<5>),
    (value::<6>, several::<6>),
    (value::<7>, several::<7>),
    (value::<8>, several::<8>),
    (value::<9>, several::<9>),
    (value::<10>, several::<10>),
    (value::<11>, several::<11>),
];

fn several<const DECIMALS: u32>(values: &mut Vec<f64>, lengths: &[Length]) {
    values.extend(lengths.iter().map(|length| value::<DECIMALS>(*length)));
}

#[inline]
fn value<const DECIMALS: u32>(length: Length) -> f64 {
    let cut = 10i64.pow(12 - DECIMALS);
    let rounded = (length.fm().abs() + cut / 2) / cut * cut;
    Length::from_fm(if length.is_negative() { -rounded } else { rounded }).mm()
}

impl Default for Decimals {
    /// A nanometre.
    fn default() -> Self {
        Self::Places(6)
    }
}

/// The text is not a number of decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("write a whole number up to {}, or `full`", Decimals::MOST)]
pub struct NoDecimals;

impl std::str::FromStr for Decimals {
    type Err = NoDecimals;

    fn from_str(text: &str) -> Result<Self, NoDecimals> {
        match text.parse() {
            _ if text == "full" => Ok(Self::Full),
            Ok(places) if places <= Self::MOST => Ok(Self::Places(places)),
            _ => Err(NoDecimals),
        }
    }
}
