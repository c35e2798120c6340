//! The values of a characteristic and the names of parts, kept in little memory: files have millions of them.

use crate::quantity::Decimal;
use crate::table::number::DecimalMark;

/// One value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value {
    digits: u64,
    pub(super) line: u32,
    exponent: i16,
    negative: bool,
    written: Written,
}

/// How a number is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Written {
    /// There is no value, or its attribute (K0002) says that it does not count.
    Nothing,
    Whole,
    With(DecimalMark),
}

impl Value {
    /// The value of a text, blank or a number with a point or a comma; `None` if it is neither.
    pub(super) fn parse(text: &str, line: u32) -> Option<Self> {
        if text.is_empty() {
            return Some(Self { digits: 0, line, exponent: 0, negative: false, written: Written::Nothing });
        }
        let Decimal { negative, digits, exponent } = Decimal::parse(&text.replace(',', ".")).ok()?;
        let mark = DecimalMark::ALL.into_iter().find(|mark| text.contains(char::from(mark.byte())));
        let written = mark.map_or(Written::Whole, Written::With);
        Some(Self { digits, line, exponent: i16::try_from(exponent).ok()?, negative, written })
    }

    pub(super) fn number(&self) -> Option<Decimal> {
        let Self { negative, digits, exponent, .. } = *self;
        (self.written != Written::Nothing).then(|| Decimal { negative, digits, exponent: exponent.into() })
    }

    /// The decimal mark of a value that counts.
    pub(super) fn mark(&self) -> Option<DecimalMark> {
        if let Written::With(mark) = self.written { Some(mark) } else { None }
    }

    /// Takes the number of a value that does not count.
    pub(super) fn take(&mut self) -> Option<Decimal> {
        let number = self.number();
        self.written = Written::Nothing;
        number
    }
}

/// The values of a characteristic, each of a sample: values of the same measured part have the same one.
#[derive(Debug, Clone, Default)]
pub(super) struct Values {
    all: Vec<Value>,
    /// The number of each value's part name (K0014), or 0; shorter than the values if the last ones have none.
    names: Vec<u32>,
    /// Where samples do not follow each other: the first sample of each run, and its index.
    runs: Vec<(u32, usize)>,
}

impl Values {
    /// Adds the value of a sample behind all others.
    pub(super) fn push(&mut self, sample: u32, value: Value) {
        if self.next_sample() != Some(sample) {
            self.runs.reserve_exact(usize::from(self.runs.is_empty()));
            self.runs.push((sample, self.all.len()));
        }
        if self.all.len() == self.all.capacity() {
            // most characteristics have many values, and some files have many characteristics
            self.all.reserve_exact(1 + self.all.len() / 4);
        }
        self.all.push(value);
    }

    /// The sample behind the last one; `None` if there is no value.
    pub(super) fn next_sample(&self) -> Option<u32> {
        let (sample, index) = self.runs.last()?;
        u32::try_from(self.all.len() - index).ok()?.checked_add(*sample)
    }

    pub(super) fn last_mut(&mut self) -> Option<&mut Value> {
        self.all.last_mut()
    }

    /// Gives the last value the name of its part.
    pub(super) fn name_last(&mut self, name: u32) {
        self.names.resize(self.all.len(), 0);
        if let Some(last) = self.names.last_mut() {
            *last = name;
        }
    }

    /// The value of a sample, and the number of its part's name.
    pub(super) fn get(&self, sample: u32) -> Option<(&Value, u32)> {
        let run = self.runs.partition_point(|(first, _)| *first <= sample).checked_sub(1)?;
        let (first, start) = self.runs[run];
        let index = start + usize::try_from(sample - first).ok()?;
        let end = self.runs.get(run + 1).map_or(self.all.len(), |(_, start)| *start);
        let value = self.all.get(index).filter(|_| index < end)?;
        Some((value, self.names.get(index).copied().unwrap_or(0)))
    }

    /// The first and the last sample of each run of samples.
    pub(super) fn runs(&self) -> impl Iterator<Item = (u32, u32)> {
        let ends = self.runs.iter().skip(1).map(|(_, start)| *start).chain([self.all.len()]);
        self.runs.iter().zip(ends).map(|((first, start), end)| (*first, *first + (end - start - 1) as u32))
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Value> {
        self.all.iter()
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Value> {
        self.all.iter_mut()
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }
}

/// The names of parts (K0014), numbered from 1.
#[derive(Debug, Clone, Default)]
pub(super) struct Names {
    text: String,
    /// Where each name ends.
    ends: Vec<u32>,
}

impl Names {
    /// Adds a name, unless it is the last one. Returns its number.
    pub(super) fn add(&mut self, name: &str) -> u32 {
        if self.ends.is_empty() || self.get(self.len()) != name {
            self.text.push_str(name);
            self.ends.push(self.text.len() as u32);
        }
        self.len()
    }

    /// How many there are.
    pub(super) fn len(&self) -> u32 {
        self.ends.len() as u32
    }

    /// The name of that number.
    pub(super) fn get(&self, number: u32) -> &str {
        let end = |number: u32| {
            number.checked_sub(1).and_then(|at| self.ends.get(at as usize)).map_or(0, |end| *end as usize)
        };
        self.text.get(end(number.saturating_sub(1))..end(number)).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_takes_16_bytes() {
        assert_eq!(size_of::<Value>(), 16);
        let mut value = Value::parse("-25,0130", 7).unwrap();
        assert_eq!((value.number(), value.mark()), (Decimal::parse("-25.0130").ok(), Some(DecimalMark::Comma)));
        assert!(value.take().is_some() && value.number().is_none() && value.mark().is_none());
        assert!(Value::parse("", 1).unwrap().number().is_none());
        assert!(Value::parse("x", 1).is_none() && Value::parse("1e99999", 1).is_none());
    }

    #[test]
    fn samples_that_are_not_there_have_no_value() {
        let mut values = Values::default();
        for sample in [3, 4, 7, 8, 9, 20] {
            values.push(sample, Value::parse(&sample.to_string(), sample).unwrap());
            if sample == 8 {
                values.name_last(5);
            }
        }
        assert_eq!(values.runs().collect::<Vec<_>>(), [(3, 4), (7, 9), (20, 20)]);
        assert_eq!((values.len(), values.next_sample(), Values::default().next_sample()), (6, Some(21), None));
        for sample in 0..30 {
            let found = values.get(sample).map(|(value, name)| (value.line, name));
            let is_there = [3, 4, 7, 8, 9, 20].contains(&sample);
            assert_eq!(found, is_there.then_some((sample, if sample == 8 { 5 } else { 0 })), "{sample}");
        }
        let mut names = Names::default();
        assert_eq!([names.add("A"), names.add("A"), names.add("Bc"), names.add("A")], [1, 1, 2, 3]);
        assert_eq!([1, 2, 3, 4].map(|number| names.get(number)), ["A", "Bc", "A", ""]);
    }
}
