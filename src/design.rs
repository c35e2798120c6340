//! Designs: keys of a spec with the values that each is tried at, and the designs that follow, as a grid of all combinations or
//! as a Latin hypercube. Called by `sweep`. Values are texts as they stand in a spec.

use thiserror::Error;

use crate::chance::Random;
use crate::quantity::{parse_f64, plain, split_number};

/// Why keys and values give no designs.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct DesignError(String);

/// A key with the values that it is tried at.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The key, such as `pair.normal_pressure_angle`.
    pub key: String,
    /// The unit behind its numbers; empty if there is none.
    pub unit: String,
    values: Values,
}

#[derive(Debug, Clone, PartialEq)]
enum Values {
    /// The texts, and the numbers if all texts are numbers.
    List(Vec<String>, Option<Vec<f64>>),
    /// From one number to another, with a step if one is given.
    Range { from: f64, to: f64, step: Option<f64> },
}

/// The most designs of a grid.
const MOST: usize = 1_000_000_000;

impl Axis {
    /// Reads `KEY=VALUES`: a list with commas between (`pinion.teeth=6,7,8`), or a range with its step
    /// (`pair.normal_pressure_angle=18..25:0.5`, `errors.rack_pitch=0..30:5 um`). A whole number has a step of 1.
    ///
    /// # Errors
    /// [`DesignError`] if there is no key or no value, a range runs backwards, or its numbers have different units.
    pub fn parse(text: &str, is_whole: impl Fn(&str) -> bool) -> Result<Self, DesignError> {
        let (key, values) = text.split_once('=').map_or((text, ""), |(key, values)| (key.trim(), values.trim()));
        let refused = |why: &str| DesignError(format!("`{text}`: {why}"));
        if key.is_empty() || values.is_empty() {
            return Err(refused(
                "write KEY=VALUES, such as pinion.teeth=6,7,8 or pair.normal_pressure_angle=18..25:0.5",
            ));
        }
        let key = key.to_owned();
        if let Some((from, to, step)) = range(values) {
            let measures: Vec<_> = [Some(from), Some(to), step].into_iter().flatten().collect();
            let unit =
                shared_unit(&measures).ok_or_else(|| refused("the numbers of a range must have one unit"))?.to_owned();
            let step = step.map(|step| step.0).or_else(|| is_whole(&key).then_some(1.0));
            if from.0 > to.0 || step.is_some_and(|step| step <= 0.0) {
                return Err(refused("a range must rise, with a step above 0"));
            }
            return Ok(Self { key, unit, values: Values::Range { from: from.0, to: to.0, step } });
        }
        if let Some(range) = with_hyphen(values) {
            return Err(refused(&format!("write a range as {range}")));
        }
        let list: Vec<String> = split(values).into_iter().map(|value| value.trim().to_owned()).collect();
        if list.iter().any(String::is_empty) {
            return Err(refused("a value between two commas is missing"));
        }
        if let Some(part) = list.iter().find(|value| range(value).is_some()) {
            let why = format!("`{part}` is a range within a list: write all values, or one range such as 0..30:5 um");
            return Err(refused(&why));
        }
        let measures: Vec<Option<Measure<'_>>> = list.iter().map(|value| number(value)).collect();
        let known: Vec<Measure<'_>> = measures.iter().flatten().copied().collect();
        // a unit behind the last number counts for all numbers; 0 needs none
        let (unit, last) = (shared_unit(&known), measures.last().copied().flatten().map_or("", |last| last.1));
        if unit != Some(last) && known.iter().any(|(number, unit)| *number != 0.0 && unit.is_empty()) {
            return Err(refused("some of the numbers have a unit: write one behind each, or behind the last for all"));
        }
        let text = |(text, measure): (&String, &Option<Measure<'_>>)| match measure {
            Some((_, "")) if !last.is_empty() => format!("{text} {last}"),
            _ => text.clone(),
        };
        let texts = list.iter().zip(&measures).map(text).collect();
        let numbers = unit.filter(|_| known.len() == list.len()).map(|_| known.iter().map(|known| known.0).collect());
        let unit = if numbers.is_some() { unit.unwrap_or_default() } else { "" };
        Ok(Self { key, unit: unit.to_owned(), values: Values::List(texts, numbers) })
    }

    /// Whether its values are numbers in one unit.
    #[must_use]
    pub const fn is_numeric(&self) -> bool {
        matches!(self.values, Values::Range { .. } | Values::List(_, Some(_)))
    }

    /// The ends of a range, and whether any number between them may be tried.
    #[must_use]
    pub const fn ends(&self) -> Option<(f64, f64)> {
        if let Values::Range { from, to, .. } = self.values { Some((from, to)) } else { None }
    }

    /// The same range, with `count` steps if it has no step.
    #[must_use]
    pub fn in_steps(mut self, count: u32) -> Self {
        if let Values::Range { from, to, step: step @ None } = &mut self.values {
            *step = Some((*to - *from) / f64::from(count)).filter(|step| *step > 0.0);
        }
        self
    }

    /// The number of its values; `None` for a range without a step.
    #[must_use]
    pub fn count(&self) -> Option<usize> {
        match &self.values {
            Values::List(list, _) => Some(list.len()),
            // a last step that misses the end by a rounding error reaches it; the grid refuses too many values
            Values::Range { from, to, step } => (*step).map(|step| ((to - from) / step + 1e-9) as usize + 1),
        }
    }

    /// A number as it stands in the spec, with the unit.
    #[must_use]
    pub fn text(&self, number: f64) -> String {
        let number = plain(number);
        if self.unit.is_empty() { number } else { format!("{number} {}", self.unit) }
    }

    /// The value with that index.
    fn value(&self, index: usize) -> Trial {
        match &self.values {
            Values::List(list, numbers) => {
                Trial { text: list[index].clone(), number: numbers.as_ref().map(|numbers| numbers[index]) }
            }
            Values::Range { from, step, .. } => self.trial(rounded(from + step.unwrap_or_default() * index as f64, 15)),
        }
    }

    /// A number as a value that is tried, with twelve digits.
    #[must_use]
    pub fn at(&self, number: f64) -> Trial {
        self.trial(rounded(number, 12))
    }

    fn trial(&self, number: f64) -> Trial {
        Trial { text: self.text(number), number: Some(number) }
    }

    /// The value at a share of the range or of the list, from 0 to below 1.
    fn at_share(&self, share: f64) -> Trial {
        match (self.count(), &self.values) {
            (None, Values::Range { from, to, .. }) => self.trial(rounded(from + share * (to - from), 9)),
            (count, _) => self.value((share * count.unwrap_or(1) as f64) as usize),
        }
    }
}

/// A value that is tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Its text as it stands in the spec.
    pub text: String,
    /// Its number in the unit of the axis, if it is a number.
    pub number: Option<f64>,
}

/// A number rounded to `digits` digits.
fn rounded(number: f64, digits: usize) -> f64 {
    format!("{number:.*e}", digits - 1).parse().unwrap_or(number)
}

/// A number and its unit.
fn number(text: &str) -> Option<(f64, &str)> {
    let (written, unit) = split_number(text);
    parse_f64(written).ok().map(|number| (number, unit))
}

type Measure<'a> = (f64, &'a str);

/// The common unit of numbers, some of which may have none; `None` if they have several.
fn shared_unit<'a>(measures: &[Measure<'a>]) -> Option<&'a str> {
    let mut units = measures.iter().map(|measure| measure.1).filter(|unit| !unit.is_empty());
    let unit = units.next().unwrap_or_default();
    units.all(|other| other == unit).then_some(unit)
}

/// The ends and the step of a range.
fn range(text: &str) -> Option<(Measure<'_>, Measure<'_>, Option<Measure<'_>>)> {
    let (from, rest) = text.split_once("..")?;
    let (to, step) = rest.split_once(':').map_or((rest, None), |(to, step)| (to, Some(step)));
    let step = step.map(number);
    Some((number(from)?, number(to)?, if let Some(step) = step { Some(step?) } else { None }))
}

/// A range that is written with a hyphen, `18-24`, in the right form: `18..24:1`.
fn with_hyphen(text: &str) -> Option<String> {
    let at = text.char_indices().skip(1).find(|(_, c)| matches!(c, '-' | '–'))?.0;
    let (from, to) = (text[..at].trim(), text[at..].trim_start_matches(['-', '–']).trim());
    let width = number(to)?.0 - number(from)?.0;
    // a power of ten that gives at least 4 steps
    (width > 0.0).then(|| format!("{from}..{to}:{}", plain(libm::exp10(libm::floor(libm::log10(width / 4.0))))))
}

/// Splits at the commas that stand neither in brackets nor in quotes.
fn split(text: &str) -> Vec<&str> {
    let (mut depth, mut quoted) = (0_i32, None);
    let is_between = |c: char| {
        match (quoted, c) {
            (Some(quote), _) if quote == c => quoted = None,
            (None, '"' | '\'') => quoted = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            _ => {}
        }
        c == ',' && depth == 0 && quoted.is_none()
    };
    text.split(is_between).collect()
}

/// All designs.
#[derive(Debug, Clone)]
pub struct Designs {
    axes: Vec<Axis>,
    count: usize,
    /// For a Latin hypercube: the share of each axis in each design.
    shares: Option<Vec<Vec<f64>>>,
}

impl Designs {
    /// All combinations, those of the last key next to each other.
    ///
    /// # Errors
    /// [`DesignError`] if a range has no step, or there are more than 10⁹ designs.
    pub fn grid(axes: Vec<Axis>) -> Result<Self, DesignError> {
        let mut count: usize = 1;
        for axis in &axes {
            let values = axis.count().ok_or_else(|| {
                let key = &axis.key;
                DesignError(format!(
                    "`{key}` has a range without a step: write one, such as 18..25:0.5, or --samples N"
                ))
            })?;
            count = count.checked_mul(values).filter(|count| *count <= MOST).ok_or_else(|| {
                DesignError("these are more than 1,000,000,000 designs: take wider steps, or --samples N".to_owned())
            })?;
        }
        Ok(Self { axes, count, shares: None })
    }

    /// The designs of one key at these numbers.
    #[must_use]
    pub fn of_numbers(axis: Axis, numbers: Vec<f64>) -> Self {
        let texts = numbers.iter().map(|number| axis.text(*number)).collect();
        let count = numbers.len();
        Self { axes: vec![Axis { values: Values::List(texts, Some(numbers)), ..axis }], count, shares: None }
    }

    /// A Latin hypercube (McKay, Beckman and Conover 1979): each key's range is cut into `count` equal parts, and each part gives
    /// one design its value, at a random place and in random order. The same seed gives the same designs.
    #[must_use]
    pub fn latin_hypercube(axes: Vec<Axis>, count: u32, seed: u64) -> Self {
        let shares = |axis: u64| {
            let mut random = Random::of_block(seed, axis);
            let mut parts: Vec<f64> =
                (0..count).map(|part| (f64::from(part) + random.uniform()) / f64::from(count)).collect();
            for last in (1..parts.len()).rev() {
                parts.swap(last, (random.uniform() * (last + 1) as f64) as usize);
            }
            parts
        };
        let shares = (0..axes.len() as u64).map(shares).collect();
        Self { axes, count: count as usize, shares: Some(shares) }
    }

    /// The keys.
    #[must_use]
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The number of designs.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Whether they are a grid of all combinations.
    #[must_use]
    pub const fn is_grid(&self) -> bool {
        self.shares.is_none()
    }

    /// The value of each key in the design with that number.
    #[must_use]
    pub fn values(&self, mut number: usize) -> Vec<Trial> {
        if let Some(shares) = &self.shares {
            return self.axes.iter().zip(shares).map(|(axis, shares)| axis.at_share(shares[number])).collect();
        }
        let mut values: Vec<_> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let count = axis.count().unwrap_or(1);
                let value = axis.value(number % count);
                number /= count;
                value
            })
            .collect();
        values.reverse();
        values
    }

    /// The design with these values, as `--set` takes it.
    #[must_use]
    pub fn settings(&self, values: &[Trial]) -> Vec<String> {
        self.axes.iter().zip(values).map(|(axis, value)| format!("{}={}", axis.key, value.text)).collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn axis(text: &str) -> Axis {
        Axis::parse(text, |key| key == "pinion.teeth").unwrap()
    }

    fn texts(designs: &Designs) -> Vec<String> {
        (0..designs.count()).map(|number| designs.settings(&designs.values(number)).join(" ")).collect()
    }

    #[test]
    fn a_grid_is_every_combination() {
        let designs = Designs::grid(vec![axis("a.b=18..19:0.5"), axis("pinion.teeth=6..7")]).unwrap();
        let expected = ["18 6", "18 7", "18.5 6", "18.5 7", "19 6", "19 7"];
        let expected =
            expected.map(|pair| pair.split_once(' ').map(|(a, z)| format!("a.b={a} pinion.teeth={z}")).unwrap());
        assert_eq!(texts(&designs), expected);
    }

    #[test]
    fn values_are_those_that_are_written() {
        let values = |text: &str| texts(&Designs::grid(vec![axis(text)]).unwrap()).join("; ").replace("k=", "");
        for (text, expected) in [
            ("k=0..0.3:0.1", "0; 0.1; 0.2; 0.3"),
            ("k=-2..2:2 um", "-2 um; 0 um; 2 um"),
            ("k=0um..10um:4um", "0 um; 4 um; 8 um"),
            ("k=6,7.50,1e-3 mm", "6 mm; 7.50 mm; 1e-3 mm"),
            ("k=0,5um,2 mm", "0 mm; 5um; 2 mm"),
            ("k=20um,0", "20um; 0"),
            ("k=6.0,7", "6.0; 7"),
            ("k=\"a,b\",{ value = 1, u = 2 }", "\"a,b\"; { value = 1, u = 2 }"),
            ("k=8..=12", "8..=12"),
        ] {
            assert_eq!(values(text), expected, "{text}");
        }
        assert_eq!((axis("k=1 um,2 um").unit, axis("k=1 um,2 mm").is_numeric()), ("um".to_owned(), false));
        for text in [
            "k",
            "=1",
            "k=",
            "k=1,,2",
            "k=5..1:1",
            "k=1..5:0",
            "k=1mm..5um:1",
            "k=20um,0.01",
            "k=5,2um,7",
            "k=5,2um,1mm",
            "k=0,5..30um",
        ] {
            assert!(Axis::parse(text, |_| false).is_err(), "{text}");
        }
        let endless = Designs::grid(vec![axis("k=1..2")]);
        assert!(endless.unwrap_err().to_string().contains("without a step"));
        assert!(Designs::grid(vec![axis("k=0..1:1e-9"), axis("l=0..1:1e-9")]).is_err());
    }

    proptest! {
        #[test]
        fn each_part_of_each_key_is_sampled_once(count in 1_u32..200, seed: u64) {
            let axes = vec![axis("a=2..4"), axis("b=x,y,z"), axis("pinion.teeth=1..7")];
            let designs = Designs::latin_hypercube(axes, count, seed);
            let mut parts = Vec::new();
            let mut counts = [0_u32; 7];
            for number in 0..designs.count() {
                let values = designs.values(number);
                let share = (values[0].number.unwrap() - 2.0) / 2.0;
                // a value is rounded to nine digits
                prop_assert!((0.0..=1.0).contains(&share));
                parts.push(share);
                counts[values[2].number.unwrap() as usize - 1] += 1;
            }
            parts.sort_by(f64::total_cmp);
            for (part, share) in parts.iter().enumerate() {
                let at = share * f64::from(count) - part as f64;
                prop_assert!((-1e-6..=1.0 + 1e-6).contains(&at), "{part}: {share}");
            }
            // a seventh contains some whole parts, and a piece of one at each end
            let share = f64::from(count) / 7.0;
            prop_assert!(counts.iter().all(|&of_one| (f64::from(of_one) - share).abs() < 2.0), "{counts:?}");
        }
    }
}
