//! What the header of a Q-DAS file says of one characteristic, key by key. Filled by the reader of lines; compares the keys with each
//! other once the header is complete.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::Characteristic;
use super::values::Values;
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::quantity::{Decimal, Length, parse_f64};

/// The keys that say what a characteristic is.
pub(super) const KEYS: [u16; 16] =
    [2001, 2002, 2004, 2101, 2106, 2110, 2111, 2112, 2113, 2114, 2115, 2116, 2117, 2120, 2121, 2142];
/// The keys among them whose texts are numbers.
pub(super) const NUMBERS: [u16; 6] = [2101, 2106, 2110, 2111, 2112, 2113];

/// What one key says, and where.
#[derive(Debug, Clone)]
pub(super) struct Said {
    pub(super) text: String,
    /// Whether it is about all characteristics (`/0`) that have no text of their own.
    pub(super) of_all: bool,
    pub(super) source: Arc<Source>,
    pub(super) span: Range<usize>,
}

impl Said {
    pub(super) fn bad(&self, message: String) -> Diagnostic {
        Diagnostic::error(Code::BadTable, message).at(&self.source, self.span.clone(), "")
    }
}

/// A characteristic of the header that is being read.
#[derive(Debug, Clone, Default)]
pub(super) struct Draft {
    said: BTreeMap<u16, Said>,
    /// The part of the first line that speaks of it.
    pub(super) part: Option<usize>,
    /// Its values so far.
    pub(super) values: Values,
}

impl Draft {
    /// Adds what a key says. Keys that are not read are passed over.
    ///
    /// # Errors
    /// If the header says something else already, or values before it would be read otherwise.
    pub(super) fn say(&mut self, key: u16, said: Said) -> Result<(), Diagnostic> {
        if !KEYS.contains(&key) || said.text.is_empty() {
            return Ok(());
        }
        let known = self.said.get(&key);
        let problem = match known {
            Some(known) if known.text == said.text => return Ok(()),
            _ if self.values.len() > 0 => {
                let before = known.map_or_else(|| "nothing".to_owned(), |known| format!("`{}`", known.text));
                format!("K{key:04} says `{}` behind values for which it said {before}", said.text)
            }
            Some(known) if !known.of_all => {
                format!("K{key:04} says `{}`, and `{}` before it in the same header", said.text, known.text)
            }
            _ => {
                self.said.insert(key, said);
                return Ok(());
            }
        };
        Err(said
            .bad(problem)
            .help("a header stands before its values; where another one follows, it starts with K0100"))
    }

    fn text(&self, key: u16) -> Option<String> {
        self.said.get(&key).map(|said| said.text.clone())
    }

    /// Removes the values of a characteristic that is no size (K2004): they count faults, or mean good or bad. Returns their lines and
    /// the values.
    pub(super) fn take_counts(&mut self) -> Vec<(u32, Decimal)> {
        if self.said.get(&2004).is_none_or(|said| said.text == "0") {
            return Vec::new();
        }
        let counted = self.values.iter_mut().filter_map(|value| Some((value.line, value.take()?)));
        counted.collect()
    }

    /// The characteristic, once the header and its values are complete.
    ///
    /// # Errors
    /// If its limits contradict each other.
    pub(super) fn characteristic(self) -> Result<Characteristic, Diagnostic> {
        let lower = self.limit([2110, 2112, 2120])?;
        let upper = self.limit([2111, 2113, 2121])?;
        if let (Some(lower), Some(upper)) = (&lower, &upper)
            && let Some(said) = self.said.get(&2110).or(self.said.get(&2112))
            && number(lower) > number(upper)
        {
            let problem = said.bad(format!("the lower limit {lower} is above the upper limit {upper}"));
            return Err(problem.help("correct K2110 and K2111, or the allowances K2112 and K2113"));
        }
        let unused = self.unused();
        Ok(Characteristic {
            number: self.text(2001).unwrap_or_default(),
            name: self.text(2002).unwrap_or_default(),
            nominal: self.text(2101),
            lower,
            upper,
            unit: self.text(2142),
            uncertainty: self.text(2106),
            part: self.part.unwrap_or(0),
            unused,
            values: self.values,
        })
    }

    /// A limit, as it is stated or as nominal value plus allowance; `None` if there is none, or if its kind says that it does not count.
    fn limit(&self, [limit, allowance, kind]: [u16; 3]) -> Result<Option<String>, Diagnostic> {
        let stated = self.text(limit);
        let Some(allowed) = self.said.get(&allowance).filter(|_| !self.is_off(kind)) else {
            return Ok(stated.filter(|_| !self.is_off(kind)));
        };
        let nominal = self.text(2101);
        let text = &allowed.text;
        match (stated, nominal) {
            (None, None) => {
                let message = format!("K{allowance} is an allowance of {text}, and there is no nominal value (K2101)");
                Err(allowed.bad(message).help(format!("give K2101, or the limit itself as K{limit}")))
            }
            (None, Some(nominal)) => match sum(&nominal, text) {
                Some(sum) => Ok(Some(sum)),
                None => Err(allowed.bad(format!("K{allowance}: {nominal} and {text} have no sum that is a size"))),
            },
            (Some(stated), nominal) => {
                let sum = number(nominal.as_deref().unwrap_or("0")) + number(text);
                if (number(&stated) - sum).abs() <= ROUNDING * sum.abs().max(1.0) {
                    return Ok(Some(stated));
                }
                let message = format!(
                    "K{limit} is {stated}, and the nominal value {} with K{allowance} {text} is another limit",
                    nominal.as_deref().unwrap_or("0")
                );
                Err(allowed.bad(message).help("correct the one that is wrong, or leave it out"))
            }
        }
    }

    /// Limits that the file has and that are not used, with the reason.
    fn unused(&self) -> Vec<String> {
        let off = [([2110, 2112], 2120), ([2111, 2113], 2121)].into_iter().filter(|(_, kind)| self.is_off(*kind));
        let off = off.flat_map(|(keys, kind)| keys.map(|key| (key, Some(kind))));
        let unused = off.chain([2114, 2115, 2116, 2117].map(|key| (key, None)));
        let in_words = |(key, kind): (u16, Option<u16>)| {
            let limit = self.text(key)?;
            let why = kind.map_or_else(String::new, |kind| format!(": K{kind} is 0"));
            Some(format!("the limit {limit} (K{key}) is not used{why}"))
        };
        unused.filter_map(in_words).collect()
    }

    /// Whether the limit of that side does not count (K2120, K2121).
    fn is_off(&self, kind: u16) -> bool {
        self.said.get(&kind).is_some_and(|said| said.text.parse() == Ok(0))
    }
}

/// How much sums of decimals may differ because they are computed in binary, relative to their size.
const ROUNDING: f64 = 1e-12;

/// The number that a text is known to be.
fn number(text: &str) -> f64 {
    parse_f64(text).unwrap_or(f64::NAN)
}

/// The nominal value and an allowance as one decimal number.
fn sum(nominal: &str, allowance: &str) -> Option<String> {
    let length = |text: &str| text.parse::<Length>().ok();
    Some((length(nominal)? + length(allowance)?).mm().to_string())
}
