//! One column of values: turns the content of a cell into a deviation. Made once per table, called for every cell.

mod beside;
mod declared;
mod nominal;
mod unit;

pub(crate) use declared::Declared;
pub(crate) use unit::{UnitFrom, UnitSaid};

use super::cell::{Cell, Content};
use super::companions::Companions;
use super::field::{Beside as Role, Field, ValueKind};
use super::grid::unit_of;
use super::number::{DecimalMark, normalise, quantity};
use super::want::Want;
use crate::deviation::plausible::{self, Reach, WrittenIn};
use crate::deviation::{DeviationKind, DeviationValue, DeviationValues};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::law::lead_slope;
use crate::quantity::{Angle, Decimal, Length, LengthUnit, PlainSteps, Unit, shown};

/// Where a quantity that belongs to a value comes from: its nominal value, or its evaluation length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stated<T> {
    /// There is none.
    None,
    /// It is the same for every part.
    Fixed(T),
    /// It stands beside the value.
    Beside,
}

/// The nominal value that is subtracted from a measured value; none where the column holds deviations.
pub(crate) type Nominal = Stated<DeviationValue>;

/// The largest difference that contradicts nothing, mm: a tenth of a micrometre.
pub(crate) const SMALLEST_DIGIT: f64 = 1e-4;

/// One column of values.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub(crate) field: Field,
    /// The error that the column holds, where each row is a part.
    pub(crate) kind: Option<DeviationKind>,
    pub(crate) title: String,
    /// The place of its cell in a record.
    pub(crate) place: usize,
    pub(crate) unit: Unit,
    pub(crate) unit_from: UnitFrom,
    pub(crate) holds: Option<ValueKind>,
    pub(crate) nominal: Nominal,
    /// The evaluation length, in a column of f_Hβ.
    pub(crate) evaluated: Stated<Length>,
    /// The nominal value of the spec, where the table has nominal values too.
    pub(crate) stated: Option<DeviationValue>,
    /// How far a measured value may be from its nominal one, and a deviation from 0.
    farthest: Reach,
    /// The normal module, if it is known.
    module: Option<Length>,
    /// The tolerance that the file gives for all values, mm or degrees.
    pub(crate) tolerance: Option<f64>,
    pub(crate) mark: DecimalMark,
    /// Whether the decimal mark is open, because no number so far has decimals.
    pub(crate) mark_is_open: bool,
    /// The companions of its values.
    pub(crate) beside: Companions<Companion>,
}

/// A column beside the values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Companion {
    /// The place of its cell in a record.
    pub(crate) place: usize,
    /// The unit of its numbers: that of its heading, or else the value's.
    unit: Unit,
}

/// How a plain number, without a unit or a companion, becomes a deviation, and how large that may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlainNumbers {
    unit: Unit,
    nominal: DeviationValue,
    farthest: Reach,
    /// The evaluation length of f_Hβ.
    over: Option<Length>,
    /// The same numbers as steps of their grid, without an evaluation length.
    steps: Option<PlainSteps>,
}

impl PlainNumbers {
    fn new(unit: Unit, nominal: DeviationValue, farthest: Reach, over: Option<Length>) -> Self {
        let steps = match (unit, nominal) {
            (Unit::Length(unit), DeviationValue::Length(nominal)) => {
                Some(PlainSteps::new(unit.scale(), nominal.fm(), farthest.length.fm()))
            }
            (Unit::Angle(unit), DeviationValue::Angle(nominal)) => {
                Some(PlainSteps::new(unit.scale(), nominal.nas(), farthest.angle.nas()))
            }
            _ => None,
        };
        Self { unit, nominal, farthest, over, steps: steps.filter(|_| over.is_none()) }
    }

    /// The deviation of a number; `None` if it is too large to be one.
    #[expect(clippy::inline_always, reason = "taken apart where it is made: a twentieth of the time of a table")]
    #[inline(always)]
    pub(crate) fn deviation(&self, number: Decimal) -> Option<DeviationValue> {
        match (self.steps.as_ref().and_then(|steps| steps.of(number)), self.unit) {
            (Some(fm), Unit::Length(_)) => Some(DeviationValue::Length(Length::from_fm(fm))),
            (Some(nas), Unit::Angle(_)) => Some(DeviationValue::Angle(Angle::from_nas(nas))),
            (None, _) => self.any_deviation(number),
        }
    }

    /// The deviation of a number of any kind.
    #[inline(never)]
    fn any_deviation(&self, number: Decimal) -> Option<DeviationValue> {
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

    /// The deviations of doubles, each taken as its shortest decimal; `None` if one needs a closer look.
    pub(crate) fn deviations(&self, doubles: &[f64]) -> Option<DeviationValues> {
        Some(match (self.unit, self.nominal, self.over) {
            (Unit::Length(unit), DeviationValue::Length(nominal), None) => {
                DeviationValues::Lengths(Length::of_doubles(doubles, unit, nominal, self.farthest.length)?)
            }
            (Unit::Angle(unit), DeviationValue::Angle(nominal), None) => {
                DeviationValues::Angles(Angle::of_doubles(doubles, unit, nominal, self.farthest.angle)?)
            }
            _ => return None,
        })
    }
}

/// Why a cell gives no value: it is no number, it contradicts what stands beside it, or it is far too large.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Problem {
    /// What is wrong, and what to do.
    pub(crate) message: String,
    /// Whether the value is larger than any deviation.
    pub(crate) is_too_large: bool,
}

impl Problem {
    pub(crate) fn new(message: String) -> Self {
        Self { message, is_too_large: false }
    }

    fn too_large(what: &str) -> Self {
        let message = format!("{what}: check the unit, or give the nominal value if this is a measured value");
        Self { message, is_too_large: true }
    }
}

impl Column {
    /// Whether a table of spaces holds measured values of it, unless the heading or the spec says otherwise. A table of parts holds
    /// deviations where no nominal value is known.
    pub(crate) fn is_of_space(&self) -> bool {
        matches!(self.field, Field::OverPin | Field::Position | Field::Error(DeviationKind::RackOverRoller))
    }

    /// A deviation of 0, as a length, an angle or a slope.
    pub(crate) const fn nothing(&self) -> DeviationValue {
        match (self.unit, self.evaluated) {
            (Unit::Length(_), Stated::None) => DeviationValue::Length(Length::ZERO),
            (Unit::Length(_), _) => DeviationValue::Slope(0.0),
            (Unit::Angle(_), _) => DeviationValue::Angle(Angle::ZERO),
        }
    }

    /// How plain numbers of this column are read; `None` if a value depends on other cells of its row, or must have a unit.
    pub(crate) fn plain(&self) -> Option<PlainNumbers> {
        let nominal = self.nominal_of_every_part()?;
        let over = match self.evaluated {
            Stated::None => None,
            Stated::Fixed(over) => Some(over),
            Stated::Beside => return None,
        };
        let is_plain =
            self.tolerance.is_none() && self.beside.iter().next().is_none() && self.unit_from != UnitFrom::Cells;
        is_plain.then(|| PlainNumbers::new(self.unit, nominal, self.farthest, over))
    }

    /// The deviation that a cell means; `None` if the cell says that there is no value.
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

    /// The value, if a deviation can be so large.
    fn possible(&self, value: DeviationValue) -> Result<DeviationValue, Problem> {
        match plausible::deviation(value, self.module).filter(|doubt| doubt.is_impossible) {
            Some(doubt) => Err(Problem::too_large(&doubt.to_string())),
            None => Ok(value),
        }
    }

    fn quantity_in(&self, cell: &Cell, unit: Unit) -> Result<DeviationValue, Problem> {
        match &cell.content {
            Content::Number(number) => quantity(*number, unit).map_err(|error| Problem::new(error.to_string())),
            Content::Measured(measured) if unit_of(&measured.1, self.field.is_angle()) == Some(unit) => {
                quantity(measured.0, unit).map_err(|error| Problem::new(error.to_string()))
            }
            Content::Text(text) => self.quantity_of_text(text, unit),
            Content::Measured(_) => {
                let message =
                    format!("the cell shows `{}`, and the column is in {}", shown(&cell.text()), unit.symbol());
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

    /// f_Hβ divided by its evaluation length.
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

    /// Whether the values that are read in a table of spaces or teeth are deviations.
    pub(crate) fn deviates(&self) -> bool {
        self.holds == Some(ValueKind::Deviation) || self.nominal != Nominal::None
    }
}

/// Whether columns of spaces or teeth are of a rack: none is of a pinion's teeth.
pub(crate) fn is_rack(columns: &[Column], index: Option<Field>) -> bool {
    !columns.iter().map(|column| column.field).chain(index).any(Field::is_of_tooth)
}

/// A text with `in` in place of the quotes that mean inches.
fn with_inches(text: &str, unit: Unit) -> std::borrow::Cow<'_, str> {
    let inches = text.strip_suffix('"').or_else(|| text.strip_suffix("''")).or_else(|| text.strip_suffix('\u{201d}'));
    match (unit, inches) {
        (Unit::Length(_), Some(number)) => format!("{number} in").into(),
        _ => text.into(),
    }
}

/// The evaluation length of f_Hβ where no column gives it: the spec's length, or else the face width.
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

/// A value as text; lengths below 0.1 mm in µm.
pub(crate) fn in_words(value: DeviationValue) -> String {
    match value {
        DeviationValue::Length(length) if !length.is_zero() && length.abs().mm() < 0.1 => {
            format!("{} µm", length.in_unit(LengthUnit::Micrometre))
        }
        value => value.to_string(),
    }
}
