//! One column of values: from what a cell holds to a deviation. Made once per table; asked for every cell.

mod beside;
mod declared;
mod nominal;
mod unit;

pub(crate) use declared::Declared;
pub(crate) use unit::{UnitFrom, behind_name, fitting};

use std::cmp::Ordering;

use super::cell::{Cell, Content};
use super::companions::Companions;
use super::grid::unit_in;
use super::names::{BETWEEN_LIMITS, Field, LIMIT_MARKS, Role, ValueKind, is_total, says_largest, split_unit};
use super::number::{DecimalMark, Marks, marks, normalise, quantity};
use super::shape::Measurement;
use super::want::{Want, quoted};
use crate::deviation::plausible::{self, Reach, WrittenIn};
use crate::deviation::{Countable, DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::law::lead_slope;
use crate::quantity::{Angle, Decimal, Length, LengthUnit, Unit, shown};
use beside::companions;
use unit::unit;
pub(crate) use unit::unit_of;

/// What a value is taken together with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stated<T> {
    /// Nothing.
    None,
    /// The same for every part.
    Fixed(T),
    /// What stands beside the value.
    Beside,
}

/// What is taken from a measured value; nothing from deviations.
pub(crate) type Nominal = Stated<DeviationValue>;

/// A tenth of a micrometre is no contradiction, mm.
pub(crate) const SMALLEST_DIGIT: f64 = 1e-4;

/// One column of values.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub(crate) field: Field,
    /// The error that it is, where each row is a part.
    pub(crate) kind: Option<DeviationKind>,
    pub(crate) title: String,
    /// The field of a record, where rows are parts.
    pub(crate) place: usize,
    pub(crate) unit: Unit,
    pub(crate) unit_from: UnitFrom,
    pub(crate) holds: Option<ValueKind>,
    pub(crate) nominal: Nominal,
    /// Over what f_Hβ is evaluated.
    pub(crate) evaluated: Stated<Length>,
    /// The nominal value that the spec gives, where the table has its own.
    stated: Option<DeviationValue>,
    /// How far a measured value may be from its nominal one, and a deviation from 0.
    farthest: Reach,
    /// The normal module, if it is known.
    module: Option<Length>,
    /// How far the file says that its values may be from nominal, mm or degrees.
    pub(crate) tolerance: Option<f64>,
    pub(crate) mark: DecimalMark,
    /// Whether the decimal mark is still open: no number so far has decimals.
    pub(crate) mark_is_open: bool,
    /// The companions of its values.
    pub(crate) beside: Companions<Companion>,
}

/// What stands beside a value in every record.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Companion {
    /// Where it stands.
    pub(crate) place: usize,
    /// The unit of its numbers: that of its heading, or else the value's.
    unit: Unit,
}

/// All that is asked of a plain number: what makes a deviation of it, and how large that may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlainNumbers {
    unit: Unit,
    nominal: DeviationValue,
    farthest: Reach,
    /// The evaluation length of f_Hβ.
    over: Option<Length>,
}

impl PlainNumbers {
    /// The deviation of a number; `None` where it is too large to be one.
    #[inline]
    pub(crate) fn deviation(&self, number: Decimal) -> Option<DeviationValue> {
        let deviation = match (self.unit, self.nominal, self.over) {
            (Unit::Length(unit), DeviationValue::Length(nominal), None) => {
                DeviationValue::Length(Length::of_plain(number, unit)? - nominal)
            }
            (Unit::Angle(unit), DeviationValue::Angle(nominal), None) => {
                DeviationValue::Angle(Angle::of_plain(number, unit)? - nominal)
            }
            (Unit::Length(unit), _, Some(over)) => lead_slope(Length::of_plain(number, unit)?, over).ok()?,
            _ => return None,
        };
        (!self.farthest.is_exceeded_by(deviation)).then_some(deviation)
    }

    /// The deviations of doubles, each of which is its shortest decimal, where all are lengths that the double alone tells;
    /// `None` where a number needs a closer look.
    pub(crate) fn lengths(&self, doubles: &[f64]) -> Option<Vec<Length>> {
        match (self.unit, self.nominal, self.over) {
            (Unit::Length(unit), DeviationValue::Length(nominal), None) => {
                Length::of_doubles(doubles, unit, nominal, self.farthest.length)
            }
            _ => None,
        }
    }
}

/// From where to where values reach, and one of the last digit that they are written with; mm or degrees.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    pub(crate) least: f64,
    pub(crate) most: f64,
    digit: f64,
    /// How many values.
    count: usize,
}

impl Extent {
    /// Of no values.
    pub(crate) const NONE: Self = Self { least: f64::INFINITY, most: f64::NEG_INFINITY, digit: 1.0, count: 0 };

    /// Of so many values from one to another, of whose last digit nothing else is known.
    pub(crate) fn between([least, most]: [DeviationValue; 2], count: usize) -> Self {
        Self { least: least.base(), most: most.base(), digit: 0.01, count }
    }

    /// As of values so many times as large.
    pub(crate) fn times(self, count: f64) -> Self {
        Self { least: count * self.least, most: count * self.most, ..self }
    }

    /// With one more value, that a cell of a column holds.
    pub(crate) fn with(self, value: DeviationValue, cell: &Cell, column: &Column) -> Self {
        let value = value.base();
        // of a value in a unit of its own, it is not known
        let digit = if unit_in(&cell.text()).is_none() { column.digit(cell, column.unit) } else { SMALLEST_DIGIT };
        let digit = self.digit.min(digit).max(SMALLEST_DIGIT);
        Self { least: self.least.min(value), most: self.most.max(value), digit, count: self.count + 1 }
    }

    /// Whether a value lies among them, but for their last digit.
    pub(crate) fn encloses(&self, value: f64) -> bool {
        (self.least - self.digit..=self.most + self.digit).contains(&value)
    }
}

/// Why a cell has no value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Problem {
    /// It is no value, or one that contradicts what stands beside it.
    Bad(String),
    /// It is far from its nominal value.
    Far(String),
    /// It is larger than any deviation.
    TooLarge(String),
    /// It has another decimal mark than the cells before it, or nothing tells which counts; and what to do.
    Mark { what: String, help: &'static str },
}

impl Problem {
    /// What is wrong, and what to do.
    pub(crate) fn message(&self) -> String {
        match self {
            Self::Bad(what) | Self::Mark { what, .. } => what.clone(),
            Self::Far(what) => format!("{what}: check the unit and the decimal mark, or whether it is a deviation"),
            Self::TooLarge(what) => format!("{what}: check the unit, or give the nominal value if it is a measure"),
        }
    }
}

impl Column {
    /// The column of a measurement. `kind` is the error that it is where each row is a part.
    pub(crate) fn new(
        measurement: &Measurement,
        kind: Option<DeviationKind>,
        want: &Want,
        mark: DecimalMark,
    ) -> Result<Self, Diagnostics> {
        let value = &measurement.value;
        let given = kind.and_then(|kind| want.given(kind));
        let (unit, unit_from) = unit(measurement, kind, want, mark)?;
        if let (Some(kind), false) = (kind, given.is_some_and(|given| given.has_extent)) {
            single(kind, &value.title, want)?;
        }
        let is_slope = measurement.field.is_angle() && matches!(unit, Unit::Length(_));
        let mut column = Self {
            field: measurement.field,
            kind,
            title: value.title.clone(),
            place: value.place,
            unit,
            unit_from,
            holds: given.and_then(|given| given.holds).or(measurement.holds),
            nominal: Nominal::None,
            evaluated: Stated::None,
            stated: None,
            farthest: Reach::possible(None),
            module: None,
            tolerance: None,
            mark,
            mark_is_open: false,
            beside: companions(measurement, unit, is_slope)?,
        };
        if !is_slope {
            column.take_nominal(measurement, want)?;
        } else if column.beside.get(Role::Length).is_some() {
            column.evaluated = Stated::Beside;
        } else {
            column.evaluated = evaluated(given.and_then(|given| given.length), want, &value.title)?;
        }
        column.has_size_of_title(want)?;
        column.has_clear_nominal(measurement)?;
        column.has_value_of_deviation(measurement)?;
        Ok(column)
    }

    /// Whether, without a word, a space has measures of it; a part has deviations where no nominal value is known.
    pub(crate) fn is_of_space(&self) -> bool {
        matches!(self.field, Field::OverPin | Field::Position | Field::Error(DeviationKind::RackOverRoller))
    }

    /// The one length over which f_Hβ is evaluated, in a column of it.
    pub(crate) fn evaluated_over(&self) -> Option<Length> {
        if let Stated::Fixed(over) = self.evaluated { Some(over) } else { None }
    }

    /// No deviation, in the dimension of this column's.
    pub(crate) const fn nothing(&self) -> DeviationValue {
        match (self.unit, self.evaluated) {
            (Unit::Length(_), Stated::None) => DeviationValue::Length(Length::ZERO),
            (Unit::Length(_), _) => DeviationValue::Slope(0.0),
            (Unit::Angle(_), _) => DeviationValue::Angle(Angle::ZERO),
        }
    }

    /// What a plain number of this column is; `None` if a row has more to say.
    pub(crate) fn plain(&self) -> Option<PlainNumbers> {
        let nominal = self.nominal_of_every_part()?;
        let over = match self.evaluated {
            Stated::None => None,
            Stated::Fixed(over) => Some(over),
            Stated::Beside => return None,
        };
        let is_plain = self.tolerance.is_none() && self.beside.iter().next().is_none();
        is_plain.then_some(PlainNumbers { unit: self.unit, nominal, farthest: self.farthest, over })
    }

    /// The deviation that a cell means; `None` if it says that there is none.
    pub(crate) fn read(&self, cell: &Cell, beside: Companions<&Cell>) -> Result<Option<DeviationValue>, Problem> {
        if cell.is_missing() {
            return Ok(None);
        }
        let value = self.quantity_in(cell, self.unit_of_row(beside.get(Role::Unit).copied())?)?;
        if self.evaluated != Stated::None {
            return self.slope(value, &beside).map(Some);
        }
        let deviation = match self.nominal {
            Nominal::None => {
                self.holds_from_nominal(&beside)?;
                self.possible(value)?
            }
            Nominal::Fixed(nominal) => self.less(value, nominal)?,
            Nominal::Beside => self.less(value, self.nominal_beside(&beside)?)?,
        };
        if deviation.base() == 0.0 && has_tolerance_behind(&cell.text()) {
            return Err(Problem::Bad("it is the nominal value with its tolerance, and no measured value".to_owned()));
        }
        self.checked(cell, deviation, &beside).map(Some)
    }

    /// Whether a number may be one of its values: its unit is none of others, and it is not far from nominal.
    pub(crate) fn may_hold(&self, cell: &Cell) -> bool {
        let unit = unit_in(&cell.text()).is_none_or(|unit| unit_of(&unit, self.field.is_angle()).is_some());
        let is_near = |mark: DecimalMark| {
            let problem = self.with_mark(mark).read(cell, Companions::default()).err();
            let is_read = normalise(&cell.text(), mark).is_some();
            is_read && !matches!(problem, Some(Problem::Far(_) | Problem::TooLarge(_)))
        };
        unit && DecimalMark::ALL.into_iter().any(is_near)
    }

    /// The same column of numbers with this decimal mark.
    pub(crate) fn with_mark(&self, mark: DecimalMark) -> Self {
        Self { mark, mark_is_open: false, ..self.clone() }
    }

    /// Whether a number may be a deviation of one of its values, where these are measured.
    pub(crate) fn may_deviate_by(&self, cell: &Cell) -> bool {
        let deviations = Self { nominal: Nominal::None, ..self.clone() };
        self.nominal != Nominal::None && deviations.may_hold(cell)
    }

    /// Whether a number is one by which measured values may differ among each other, and is far from nominal itself.
    pub(crate) fn may_spread_by(&self, cell: &Cell) -> bool {
        const PART_OF_NOMINAL: f64 = 0.02;
        let Nominal::Fixed(nominal) = self.nominal else { return false };
        let most = PART_OF_NOMINAL * nominal.base().abs();
        self.quantity(cell).is_ok_and(|value| value.base().abs() < most) && !self.may_hold(cell)
    }

    /// Beyond which end of the others, mm or degrees, a value lies; `None` if it is among them or cannot be read.
    pub(crate) fn beyond(&self, cell: &Cell, beside: Companions<&Cell>, others: &Extent) -> Option<Ordering> {
        // of deviations, it may be that without signs
        let largest = others.least.abs().max(others.most.abs());
        let [least, most] =
            if self.nominal == Nominal::None { [-largest, largest] } else { [others.least, others.most] };
        let value = self.read(cell, beside).ok()??.base();
        let digit = self.digit(cell, self.unit).max(SMALLEST_DIGIT);
        if value < least - digit { Some(Ordering::Less) } else { (value > most + digit).then_some(Ordering::Greater) }
    }

    /// Whether a number is no sum of the others, nor how many they are.
    pub(crate) fn is_no_sum(&self, cell: &Cell, beside: Companions<&Cell>, others: &Extent) -> bool {
        let sums = others.times(others.count as f64);
        let is_beyond = || self.read(cell, beside).is_err() || self.beyond(cell, beside, &sums).is_some();
        cell.is_number() && cell.text().parse() != Ok(others.count) && is_beyond()
    }

    /// Whether a number is larger than values are apart.
    pub(crate) fn is_wider(&self, cell: &Cell, values: &Extent) -> bool {
        let widest = values.most - values.least + values.digit;
        cell.is_number() && !self.quantity(cell).is_ok_and(|value| value.base().abs() <= widest)
    }

    /// The value, unless it is what no deviation can be.
    fn possible(&self, value: DeviationValue) -> Result<DeviationValue, Problem> {
        match plausible::deviation(value, self.module).filter(|doubt| doubt.is_impossible) {
            Some(doubt) => Err(Problem::TooLarge(doubt.to_string())),
            None => Ok(value),
        }
    }

    /// Whether a cell by itself holds a value of it.
    pub(crate) fn reads(&self, cell: &Cell) -> bool {
        matches!(self.read(cell, Companions::default()), Ok(Some(_)))
    }

    /// The quantity in a cell.
    pub(crate) fn quantity(&self, cell: &Cell) -> Result<DeviationValue, Problem> {
        self.quantity_in(cell, self.unit)
    }

    fn quantity_in(&self, cell: &Cell, unit: Unit) -> Result<DeviationValue, Problem> {
        match &cell.content {
            Content::Number(number) => quantity(*number, unit).map_err(|error| Problem::Bad(error.to_string())),
            Content::Text(text) => self.quantity_of_text(text, cell.is_measure(), unit),
            Content::Other(text) if text.starts_with('=') => Err(Problem::Bad(format!(
                "`{}` is a formula without a result: open the file in a spreadsheet program and save it",
                shown(text)
            ))),
            Content::Other(text) => Err(Problem::Bad(format!("`{}` is not a number", shown(text)))),
            Content::Empty => Err(Problem::Bad("the cell is empty".to_owned())),
        }
    }

    fn quantity_of_text(&self, text: &str, is_measure: bool, unit: Unit) -> Result<DeviationValue, Problem> {
        let reading = marks(text);
        let other = match self.mark {
            DecimalMark::Point => DecimalMark::Comma,
            DecimalMark::Comma => DecimalMark::Point,
        };
        // `12. Mai` is no number with a decimal point
        if is_measure && reading == Marks::Only(other) {
            let help = "write every number with the same decimal mark; if all have this one, say so: --decimal comma or --decimal point";
            let (text, other, mark) = (shown(text), other.word(), self.mark.word());
            let what = format!("`{text}` has a decimal {other}, and the table's numbers have a decimal {mark}");
            return Err(Problem::Mark { what, help });
        }
        if self.mark_is_open && reading == Marks::Differ {
            let help =
                "say which mark counts: --decimal comma or --decimal point, or in the spec [batch] decimal = \"comma\"";
            let [point, comma] = [text.replace(',', "."), text.replace([',', '.'], "")];
            let what = format!("`{}` could be {point} or {comma}, and nothing before it tells which", shown(text));
            return Err(Problem::Mark { what, help });
        }
        let whole = text;
        let text = measured(text, unit);
        if text.is_empty() {
            return Err(Problem::Bad(format!("`{}` is a tolerance, and no value", shown(whole))));
        }
        let text = text.as_ref();
        let not_a_number =
            || Problem::Bad(format!("`{}` is not a number with a decimal {}", shown(text), self.mark.word()));
        let number = normalise(text, self.mark).ok_or_else(not_a_number)?;
        let is_bare = number.ends_with(|c: char| c.is_ascii_digit() || c == '.');
        // a value near its nominal one tells its unit, a deviation does not
        let is_assumed = self.unit_from == UnitFrom::Key && self.nominal == Nominal::None;
        if !is_bare && is_assumed && self.is_in_other_unit(text) {
            return Err(Problem::Bad(format!(
                "`{}` has a unit of its own, and numbers without one are taken to be {}",
                shown(whole),
                self.unit.symbol()
            )));
        }
        let united = match unit {
            Unit::Length(LengthUnit::Hundredth) if is_bare => format!("{number}e-2 mm"),
            unit if is_bare => format!("{number} {}", unit.symbol()),
            _ => number,
        };
        let read = match unit {
            Unit::Length(_) => united.parse().map(DeviationValue::Length),
            Unit::Angle(_) => united.parse().map(DeviationValue::Angle),
        };
        read.map_err(|error| Problem::Bad(error.to_string()))
    }

    /// f_Hβ over its evaluation length.
    fn slope(&self, value: DeviationValue, beside: &Companions<&Cell>) -> Result<DeviationValue, Problem> {
        let DeviationValue::Length(deviation) = value else { return Ok(value) };
        let over = match self.evaluated {
            Stated::Fixed(over) => over,
            _ => match self.quantity_beside(beside, Role::Length)? {
                Some(DeviationValue::Length(over)) => over,
                _ => return Err(Problem::Bad("there is no evaluation length for this f_Hβ".to_owned())),
            },
        };
        if let Some(doubt) = plausible::evaluation_length(over) {
            return Err(Problem::TooLarge(doubt.to_string()));
        }
        let slope = lead_slope(deviation, over).map_err(|error| Problem::Bad(error.to_string()))?;
        self.possible(slope)
    }

    /// Whether what is read of a space or tooth are deviations.
    pub(crate) fn deviates(&self) -> bool {
        self.holds == Some(ValueKind::Deviation) || self.nominal != Nominal::None
    }
}

/// Whether columns of teeth or spaces are those of a rack.
pub(crate) fn is_rack(columns: &[Column], index: Option<Field>) -> bool {
    !columns.iter().map(|column| column.field).chain(index).any(Field::is_of_tooth)
}

/// What is measured in a text: without the uncertainty or the tolerance behind it, and with the inch for the quotes that stand
/// for it.
fn measured(text: &str, unit: Unit) -> std::borrow::Cow<'_, str> {
    let text = tolerance_behind(text).map_or(text, |at| text[..at].trim_end());
    let inches = text.strip_suffix('"').or_else(|| text.strip_suffix("''")).or_else(|| text.strip_suffix('\u{201d}'));
    match (unit, inches) {
        (Unit::Length(_), Some(number)) => format!("{number} in").into(),
        _ => text.into(),
    }
}

/// Where a tolerance or an uncertainty begins behind a number: `25 ±0,02`, `25 +0,03/-0,03`.
fn tolerance_behind(text: &str) -> Option<usize> {
    let of_both = || text.find(" +").filter(|at| ["/-", "/ -", " -"].iter().any(|minus| text[*at..].contains(minus)));
    ["±", "+/-", "+-"].iter().find_map(|sign| text.find(sign)).or_else(of_both)
}

/// Whether a tolerance or an uncertainty stands behind a number.
pub(crate) fn has_tolerance_behind(text: &str) -> bool {
    tolerance_behind(text).is_some()
}

/// Whether a text is a limit, or two of them, and no nominal value: `max. 10 µm`, `10 µm max`, `≤ 10`, `±10`, `24,95 - 25,05`.
pub(crate) fn is_limit(text: &str) -> bool {
    let is_number = |text: &str| Cell::of_text(text.trim(), 0..0).is_measure();
    let text = text.trim().trim_matches(['(', ')']).to_lowercase();
    let limit = |mark: &&str| text.strip_prefix(*mark).or_else(|| text.strip_suffix(*mark));
    let of_two = |mark: &&str| text.split_once(*mark).is_some_and(|(one, other)| is_number(one) && is_number(other));
    LIMIT_MARKS.iter().filter_map(limit).any(is_number) || BETWEEN_LIMITS.iter().any(of_two)
}

/// The name of a column that the spec maps to an error, and by which it is a total over the teeth: which it is has to be said.
fn single(kind: DeviationKind, title: &str, want: &Want) -> Result<(), Diagnostics> {
    let (name, key) = (quoted(split_unit(title).0.trim()), kind.key());
    // only steps between teeth have a total
    let (message, extent) = if says_largest(title) {
        (format!("`{title}` is the largest of several teeth's, and nothing says so of {key}"), "each")
    } else if want.is_own(title) && is_total(title) && kind.counts() != Countable::Tooth {
        (
            format!(
                "the spec maps `{title}`, the name of a total over the teeth, to {key}, and says not on which teeth its values are"
            ),
            if kind.counts() == Countable::Pitch { "total" } else { "each" },
        )
    } else {
        return Ok(());
    };
    let help = format!(
        "say it under [batch.columns]: {key} = {{ name = {name}, extent = \"{extent}\" }}, or \"one\" if each is of one tooth"
    );
    Err(Diagnostic::error(Code::BadTable, message).help(help).into())
}

/// Over what f_Hβ is evaluated without a column of lengths: the spec's length, or the face width.
fn evaluated(given: Option<Length>, want: &Want, title: &str) -> Result<Stated<Length>, Diagnostic> {
    if let Some(doubt) = given.and_then(plausible::evaluation_length) {
        let message = format!("the evaluation length of `{title}`: {doubt}");
        return Err(Diagnostic::error(Code::Implausible, message).help(doubt.remedy(WrittenIn::Spec)));
    }
    given.or(want.face_width).map(Stated::Fixed).ok_or_else(|| {
        let message = format!("`{title}` is f_Hβ in a unit of length, and nothing tells its evaluation length");
        Diagnostic::error(Code::MissingKey, message).help(
            "give a column of evaluation lengths, [batch.columns] rack_lead = { length = … }, or the rack's face width",
        )
    })
}
