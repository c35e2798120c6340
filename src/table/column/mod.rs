//! One column of values: from the content of a cell to a deviation. Made once per table, called for every cell.

mod beside;
mod declared;
mod nominal;
mod unit;

pub(crate) use declared::Declared;
pub(crate) use unit::UnitFrom;

use super::cell::{Cell, Content};
use super::companions::Companions;
use super::field::{Beside as Role, Field, ValueKind};
use super::grid::unit_of;
use super::number::{DecimalMark, normalise, quantity};
use super::want::Want;
use crate::deviation::plausible::{self, Reach, WrittenIn};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::law::lead_slope;
use crate::quantity::{Angle, Decimal, Length, LengthUnit, Unit, shown};

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
    pub(crate) stated: Option<DeviationValue>,
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
    #[expect(clippy::inline_always, reason = "taken apart where it is made: a twentieth of the time of a table")]
    #[inline(always)]
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

/// Why a cell has no value: it is none, contradicts what stands beside it, or is far from what may be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Problem {
    /// What is wrong, and what to do.
    pub(crate) message: String,
    /// Whether it is larger than any deviation.
    pub(crate) is_too_large: bool,
}

impl Problem {
    pub(crate) fn new(message: String) -> Self {
        Self { message, is_too_large: false }
    }

    fn too_large(what: &str) -> Self {
        let message = format!("{what}: check the unit, or give the nominal value if it is a measure");
        Self { message, is_too_large: true }
    }
}

impl Column {
    /// Whether, without a word, a space has measures of it; a part has deviations where no nominal value is known.
    pub(crate) fn is_of_space(&self) -> bool {
        matches!(self.field, Field::OverPin | Field::Position | Field::Error(DeviationKind::RackOverRoller))
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
        let is_plain =
            self.tolerance.is_none() && self.beside.iter().next().is_none() && self.unit_from != UnitFrom::Cells;
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
        self.checked(cell, deviation, &beside).map(Some)
    }

    /// The value, unless it is what no deviation can be.
    fn possible(&self, value: DeviationValue) -> Result<DeviationValue, Problem> {
        match plausible::deviation(value, self.module).filter(|doubt| doubt.is_impossible) {
            Some(doubt) => Err(Problem::too_large(&doubt.to_string())),
            None => Ok(value),
        }
    }

    fn quantity_in(&self, cell: &Cell, unit: Unit) -> Result<DeviationValue, Problem> {
        match &cell.content {
            Content::Number(number) => quantity(*number, unit).map_err(|error| Problem::new(error.to_string())),
            Content::Measured { number, unit: own } if unit_of(own, self.field.is_angle()) == Some(unit) => {
                quantity(*number, unit).map_err(|error| Problem::new(error.to_string()))
            }
            Content::Text(text) => self.quantity_of_text(text, unit),
            Content::Measured { .. } => {
                let message = format!("`{}` is shown so, and the column is in {}", shown(&cell.text()), unit.symbol());
                Err(Problem::new(message))
            }
            Content::Other(text) if text.starts_with('=') => Err(Problem::new(format!(
                "`{}` is a formula without a result: open the file in a spreadsheet program and save it",
                shown(text)
            ))),
            Content::Other(text) | Content::Unlike(text) => {
                Err(Problem::new(format!("`{}` is not a number", shown(text))))
            }
            Content::Empty => Err(Problem::new("the cell is empty".to_owned())),
        }
    }

    fn quantity_of_text(&self, text: &str, unit: Unit) -> Result<DeviationValue, Problem> {
        if let Some((plain, end)) = Decimal::plain(text.as_bytes(), 0, self.mark.byte())
            && end == text.len()
        {
            return quantity(plain, unit).map_err(|error| Problem::new(error.to_string()));
        }
        let text = with_inches(text, unit);
        let not_a_number =
            || Problem::new(format!("`{}` is not a number with a decimal {}", shown(&text), self.mark.word()));
        let number = normalise(&text, self.mark).ok_or_else(not_a_number)?;
        let is_bare = number.ends_with(|c: char| c.is_ascii_digit() || c == '.');
        let united = match unit {
            Unit::Length(LengthUnit::Hundredth) if is_bare => format!("{number}e-2 mm"),
            unit if is_bare => format!("{number} {}", unit.symbol()),
            _ => number,
        };
        let read = match unit {
            Unit::Length(_) => united.parse().map(DeviationValue::Length),
            Unit::Angle(_) => united.parse().map(DeviationValue::Angle),
        };
        read.map_err(|error| Problem::new(error.to_string()))
    }

    /// f_Hβ over its evaluation length.
    fn slope(&self, value: DeviationValue, beside: &Companions<&Cell>) -> Result<DeviationValue, Problem> {
        let DeviationValue::Length(deviation) = value else { return Ok(value) };
        let over = match self.evaluated {
            Stated::Fixed(over) => over,
            _ => match self.quantity_beside(beside, Role::Length)? {
                Some(DeviationValue::Length(over)) => over,
                _ => return Err(Problem::new("there is no evaluation length for this f_Hβ".to_owned())),
            },
        };
        if let Some(doubt) = plausible::evaluation_length(over) {
            return Err(Problem::too_large(&doubt.to_string()));
        }
        let slope = lead_slope(deviation, over).map_err(|error| Problem::new(error.to_string()))?;
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

/// A text with the inch for the quotes that stand for it.
fn with_inches(text: &str, unit: Unit) -> std::borrow::Cow<'_, str> {
    let inches = text.strip_suffix('"').or_else(|| text.strip_suffix("''")).or_else(|| text.strip_suffix('\u{201d}'));
    match (unit, inches) {
        (Unit::Length(_), Some(number)) => format!("{number} in").into(),
        _ => text.into(),
    }
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
            "give a column of evaluation lengths, [table.columns] rack_lead = { length = … }, or the rack's face width",
        )
    })
}

/// A value for people: small lengths in µm.
pub(crate) fn in_words(value: DeviationValue) -> String {
    match value {
        DeviationValue::Length(length) if !length.is_zero() && length.abs().mm() < 0.1 => {
            format!("{} µm", length.in_unit(LengthUnit::Micrometre))
        }
        value => value.to_string(),
    }
}
