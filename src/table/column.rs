//! One column of values: from what a cell holds to a deviation. Made once per table; asked for every cell.

use std::cmp::Ordering;
use std::mem::discriminant;

use super::cell::{Cell, Content};
use super::companions::Companions;
use super::grid::{bare_unit, unit_in};
use super::names::{Field, Role, ValueKind, WordList, is_total, says_deviation, says_largest, split_size, split_unit};
use super::number::{DecimalMark, Marks, marks, normalise, quantity};
use super::shape::{Measurement, Series};
use super::want::{Want, ignore_option, mapping, quoted};
use crate::deviation::plausible::{self, Reach, WrittenIn};
use crate::deviation::{Countable, DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::law::lead_slope;
use crate::quantity::{Angle, AngleUnit, Decimal, Length, LengthUnit, Unit, shown};

/// Where the unit of a column is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum UnitFrom {
    /// The table: a heading, a row of units, the cells.
    Table,
    /// A column of units beside the values.
    Beside,
    /// The spec.
    Spec,
    /// A column that is called by its key has that of a spec.
    Key,
}

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
}

impl Extent {
    /// Of no values.
    pub(crate) const NONE: Self = Self { least: f64::INFINITY, most: f64::NEG_INFINITY, digit: 1.0 };

    /// With one more value, that a cell of a column holds.
    pub(crate) fn with(self, value: DeviationValue, cell: &Cell, column: &Column) -> Self {
        let value = value.base();
        // of a value in a unit of its own, it is not known
        let digit = if unit_in(&cell.text()).is_none() { column.digit(cell, column.unit) } else { SMALLEST_DIGIT };
        let digit = self.digit.min(digit).max(SMALLEST_DIGIT);
        Self { least: self.least.min(value), most: self.most.max(value), digit }
    }

    /// Whether a value lies among them, but for their last digit.
    pub(crate) fn encloses(&self, value: f64) -> bool {
        (self.least - self.digit..=self.most + self.digit).contains(&value)
    }

    /// Whether a number is no larger than they are apart, but for their last digit.
    pub(crate) fn is_spread_by(&self, value: f64) -> bool {
        value.abs() <= self.most - self.least + self.digit
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
    /// It has the other decimal mark than the cells before it.
    OtherMark(String),
    /// It is another number with each decimal mark, and nothing before it tells which counts.
    OpenMark(String),
}

impl Problem {
    /// What is wrong, and what to do.
    pub(crate) fn message(&self) -> String {
        match self {
            Self::Bad(what) | Self::OtherMark(what) | Self::OpenMark(what) => what.clone(),
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
            column.take_nominal(want)?;
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

    /// A deviation beside a measured value whose nominal one nothing tells is that from 0, or from a size that parts have.
    fn has_value_of_deviation(&self, measurement: &Measurement) -> Result<(), Diagnostic> {
        let Some(measured) = measurement.beside.get(Role::Measured) else { return Ok(()) };
        let unit = measured.unit.as_deref().and_then(|symbol| unit_of(symbol, self.field.is_angle()));
        let unit = unit.unwrap_or(self.unit);
        let is_of = |value: &Cell, deviation: &Cell| {
            let rounding = 0.5 * (self.digit(value, unit) + self.digit(deviation, self.unit));
            let nominal = self.quantity_in(value, unit).and_then(|value| Ok(value.less(self.quantity(deviation)?)));
            nominal.is_ok_and(|nominal| nominal.abs().base() <= rounding || nominal.is_size(self.module))
        };
        let pairs = measured.cells.iter().zip(&measurement.value.cells);
        let mut both = pairs.filter(|(value, deviation)| !value.is_missing() && !deviation.is_missing());
        let Some((value, deviation)) = both.find(|(value, deviation)| !is_of(value, deviation)) else { return Ok(()) };
        let (value, deviation) = (value.text(), deviation.text());
        let message = format!(
            "`{}`: {value} is measured, {deviation} is its deviation, and no size of a part lies between them",
            self.title
        );
        Err(Diagnostic::error(Code::BadTable, message).help("correct the one that is wrong, or give the nominal value"))
    }

    /// What stands beside a value as wanted is its nominal one if it is 0 or the spec gives one that it is held against, or else
    /// if it is a size that parts have; a requirement needs a tolerance as well. Anything else may be a limit.
    fn has_clear_nominal(&self, measurement: &Measurement) -> Result<(), Diagnostic> {
        let wanted = measurement.beside.get(Role::Nominal).filter(|_| self.stated.is_none());
        let Some((wanted, kind)) = wanted.zip(self.kind) else { return Ok(()) };
        let is_requirement = WordList::Requirement.has(&wanted.title);
        let is_size = |cell: &Cell| {
            let size = self.quantity_in(cell, self.unit_beside(Role::Nominal)).ok();
            size.is_none_or(DeviationValue::is_zero)
                || size.is_some_and(|size| size.is_size(self.module)) && !says_deviation(&self.title) && !is_requirement
                || is_requirement && has_tolerance_behind(&cell.text())
        };
        let Some(open) = wanted.cells.iter().find(|cell| !cell.is_missing() && !is_size(cell)) else { return Ok(()) };
        let message =
            format!("`{}`: {} `{}` may be the nominal value or a limit", self.title, wanted.title, open.text());
        let help = format!(
            "call the column limit, or leave it out: {}; or give the nominal value in the spec: [errors] {} = {{ nominal = … }}",
            ignore_option(&wanted.title),
            kind.key()
        );
        Err(Diagnostic::error(Code::BadTable, message).help(help))
    }

    /// Holds the nominal value in a column's name against its own: `Rollenmaß 25±0,03`.
    fn has_size_of_title(&self, want: &Want) -> Result<(), Diagnostic> {
        let (name, _) = split_unit(&self.title);
        let Some((_, size)) = split_size(&name).filter(|_| !want.is_own(&self.title)) else { return Ok(()) };
        let said = self.quantity(&Cell::of_text(size, 0..0)).ok();
        if said.is_some() && said == self.nominal_of_every_part() {
            return Ok(());
        }
        let message = format!("`{}` says that the nominal value is {size}, and nothing else says so", self.title);
        Err(Diagnostic::error(Code::BadTable, message).help("give the same nominal value in the spec"))
    }

    /// Decides what is taken from a value: what stands beside it, or what the spec says. Of a space or tooth, the spec says
    /// it only where the deviation stands beside the value; any other is taken from its nominal place later.
    fn take_nominal(&mut self, want: &Want) -> Result<(), Diagnostics> {
        if self.kind.is_some() {
            self.module = want.module;
            self.farthest = Reach::possible(want.module);
        }
        if self.holds == Some(ValueKind::Deviation) {
            return Ok(());
        }
        let is_over_pin = self.kind.is_none() && self.field == Field::OverPin;
        let over_pin = want.over_pin.filter(|_| is_over_pin).map(DeviationValue::Length);
        let given = self.field.kind().and_then(|kind| want.given(kind)?.nominal.clone());
        if self.beside.get(Role::Nominal).is_some() {
            self.nominal = Nominal::Beside;
            self.stated = given.and_then(Result::ok).or(over_pin);
            return Ok(());
        }
        let in_spec = match self.kind {
            Some(_) => given.transpose()?,
            None if self.beside.get(Role::Deviation).is_some() => given.and_then(Result::ok).or(over_pin),
            None => None,
        };
        if let Some(nominal) = in_spec {
            self.farthest = near(nominal, self.farthest);
            self.nominal = Nominal::Fixed(nominal);
        } else if let Some(kind) = self.kind
            && self.holds == Some(ValueKind::Measured)
            && !want.only_shown
        {
            let message =
                format!("`{}` holds measured values, and nothing tells the nominal value of {kind}", self.title);
            return Err(Diagnostic::error(Code::MissingKey, message)
                .help(format!(
                    "give it in the spec: [errors] {} = {{ nominal = … }}; or a column of nominal values",
                    kind.key()
                ))
                .into());
        }
        Ok(())
    }

    /// Whether, without a word, a space has measures of it; a part has deviations where no nominal value is known.
    pub(crate) fn is_of_space(&self) -> bool {
        matches!(self.field, Field::OverPin | Field::Position | Field::Error(DeviationKind::RackOverRoller))
    }

    /// The nominal value that every part has; 0 of deviations.
    pub(crate) fn nominal_of_every_part(&self) -> Option<DeviationValue> {
        match (self.nominal, self.unit) {
            (Nominal::Fixed(nominal), _) => Some(nominal),
            (Nominal::None, Unit::Length(_)) => Some(DeviationValue::Length(Length::ZERO)),
            (Nominal::None, Unit::Angle(_)) => Some(DeviationValue::Angle(Angle::ZERO)),
            (Nominal::Beside, _) => None,
        }
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
            Nominal::None => self.possible(value)?,
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

    /// Whether a number is larger than values are apart.
    pub(crate) fn is_wider(&self, cell: &Cell, values: &Extent) -> bool {
        cell.is_number() && !self.quantity(cell).is_ok_and(|value| values.is_spread_by(value.base()))
    }

    /// Whether a measured value is near a nominal one.
    pub(crate) fn is_near(&self, value: DeviationValue, nominal: DeviationValue) -> bool {
        self.less(value, nominal).is_ok()
    }

    /// A measured value less its nominal one, if they are near each other.
    fn less(&self, value: DeviationValue, nominal: DeviationValue) -> Result<DeviationValue, Problem> {
        let deviation = value.less(nominal);
        if near(nominal, self.farthest).is_exceeded_by(deviation) {
            return Err(Problem::Far(format!("{value} is far from the nominal value {nominal}")));
        }
        Ok(deviation)
    }

    /// Whether a text is the unit of its numbers.
    pub(crate) fn has_unit(&self, text: &str) -> bool {
        unit_of(text, self.field.is_angle()) == Some(self.unit)
    }

    /// The unit of a row's value: the column's, or where only a column of units tells it and nothing else stands beside the
    /// value, what that says here.
    pub(crate) fn unit_of_row(&self, cell: Option<&Cell>) -> Result<Unit, Problem> {
        let Some(cell) = cell else { return Ok(self.unit) };
        let text = cell.text();
        if self.has_unit(&text) || cell.is_missing() && self.unit_from != UnitFrom::Beside {
            return Ok(self.unit);
        }
        let is_own = self.unit_from == UnitFrom::Beside && self.beside.iter().count() == 1;
        let own = unit_of(&text, self.field.is_angle()).filter(|unit| discriminant(unit) == discriminant(&self.unit));
        own.filter(|_| is_own).ok_or_else(|| {
            Problem::Bad(format!(
                "the unit beside it is `{}`, and the column's is {}",
                shown(&text),
                self.unit.symbol()
            ))
        })
    }

    /// The value, unless it is what no deviation can be.
    fn possible(&self, value: DeviationValue) -> Result<DeviationValue, Problem> {
        match plausible::deviation(value, self.module).filter(|doubt| doubt.is_impossible) {
            Some(doubt) => Err(Problem::TooLarge(doubt.to_string())),
            None => Ok(value),
        }
    }

    /// The quantity in a cell.
    pub(crate) fn quantity(&self, cell: &Cell) -> Result<DeviationValue, Problem> {
        self.quantity_in(cell, self.unit)
    }

    /// The quantity in a companion's cell; `None` if there is none.
    fn quantity_beside(&self, beside: &Companions<&Cell>, role: Role) -> Result<Option<DeviationValue>, Problem> {
        let cell = beside.get(role).filter(|cell| !cell.is_missing());
        cell.map(|cell| self.quantity_in(cell, self.unit_beside(role))).transpose()
    }

    /// The unit of a companion's numbers.
    fn unit_beside(&self, role: Role) -> Unit {
        self.beside.get(role).map_or(self.unit, |companion| companion.unit)
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
            let message = format!(
                "`{}` has a decimal {}, and the table's numbers have a decimal {}",
                shown(text),
                other.word(),
                self.mark.word()
            );
            return Err(Problem::OtherMark(message));
        }
        if self.mark_is_open && reading == Marks::Differ {
            let message = format!(
                "`{}` could be {} or {}, and nothing before it tells which",
                shown(text),
                text.replace(',', "."),
                text.replace([',', '.'], "")
            );
            return Err(Problem::OpenMark(message));
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

    /// Whether a length has another unit behind it than the column's.
    fn is_in_other_unit(&self, text: &str) -> bool {
        let unit = unit_in(text).and_then(|unit| unit_of(&unit, self.field.is_angle()));
        unit.is_some_and(|unit| matches!(unit, Unit::Length(_)) && unit != self.unit)
    }

    /// Whether every value is far below the tolerances beside it, as it is if it has another unit than they.
    pub(crate) fn is_far_below_tolerance(&self, measurement: &Measurement) -> bool {
        const TIMES: f64 = 500.0;
        let rows = || measurement.value.cells.iter().enumerate().map(|(row, cell)| (cell, measurement.beside_row(row)));
        let widest = rows().map(|(_, beside)| self.widest(&beside).unwrap_or(0.0)).fold(0.0, f64::max);
        if widest == 0.0 {
            return false;
        }
        let read = rows().filter_map(|(cell, beside)| self.read(cell, beside).ok().flatten());
        let largest = read.map(|value| value.base().abs()).fold(0.0, f64::max);
        largest > 0.0 && TIMES * largest < widest
    }

    /// The widest tolerance beside a value, mm or degrees: a limit of size, or an allowance from nominal.
    fn widest(&self, beside: &Companions<&Cell>) -> Result<f64, Problem> {
        let fixed = if let Nominal::Fixed(nominal) = self.nominal { Some(nominal) } else { None };
        let nominal = self.quantity_beside(beside, Role::Nominal)?.or(fixed).map_or(0.0, DeviationValue::base);
        let mut widest = self.tolerance.unwrap_or(0.0);
        for role in [Role::Upper, Role::Lower] {
            // tolerances judge nothing here: one that is no number says nothing of the value's unit
            let Ok(Some(tolerance)) = self.quantity_beside(beside, role) else { continue };
            let size = tolerance.base();
            let is_limit = nominal != 0.0 && size.abs() > nominal.abs() / 2.0;
            widest = widest.max(if is_limit { (size - nominal).abs() } else { size.abs() });
        }
        Ok(widest)
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

    fn nominal_beside(&self, beside: &Companions<&Cell>) -> Result<DeviationValue, Problem> {
        let Some(nominal) = self.quantity_beside(beside, Role::Nominal)? else {
            return self.stated.ok_or_else(|| Problem::Bad("there is no nominal value beside it".to_owned()));
        };
        match self.stated {
            Some(stated) if !self.agrees(stated, nominal, beside) => {
                Err(Problem::Bad(format!("the nominal value is {nominal} in the table and {stated} in the spec")))
            }
            Some(stated) => Ok(stated),
            None => Ok(nominal),
        }
    }

    /// Whether the nominal values of the spec and of a cell are the same but for the cell's last digit.
    fn agrees(&self, stated: DeviationValue, nominal: DeviationValue, beside: &Companions<&Cell>) -> bool {
        let half = self.digit_beside(beside, Role::Nominal).map_or(0.0, |digit| SMALLEST_DIGIT.min(digit / 2.0));
        stated == nominal || (stated.base() - nominal.base()).abs() <= half
    }

    /// Whether what is read of a space or tooth are deviations.
    pub(crate) fn deviates(&self) -> bool {
        self.holds == Some(ValueKind::Deviation) || self.nominal != Nominal::None
    }

    /// Whether a value is held against a deviation beside it: of a space, nothing need tell the nominal value.
    pub(crate) fn checks_deviation(&self) -> bool {
        self.deviates() || self.kind.is_some() || !self.is_of_space()
    }

    /// Holds a deviation against what stands beside the value: the deviation, and the tolerances.
    fn checked(
        &self,
        cell: &Cell,
        mut deviation: DeviationValue,
        beside: &Companions<&Cell>,
    ) -> Result<DeviationValue, Problem> {
        /// Values this much beyond a tolerance have another unit.
        const TIMES: f64 = 100.0;
        let stated = self.quantity_beside(beside, Role::Deviation)?;
        if let Some(stated) = stated.filter(|_| self.checks_deviation()) {
            let apart = (stated.base() - deviation.base()).abs();
            if apart > self.rounding(cell, beside) {
                return Err(Problem::Bad(format!("the deviation beside it is {stated}, and this one is {deviation}")));
            }
            let digit = self.digit_beside(beside, Role::Deviation);
            let is_finer =
                |digit: f64| digit < self.digit(cell, self.unit) && apart > (0.5 * digit).max(SMALLEST_DIGIT);
            if digit.is_some_and(is_finer) {
                // it has the digits that the value lost
                deviation = stated;
            }
        }
        let widest = self.widest(beside)?;
        if widest > 0.0 && deviation.base().abs() > TIMES * widest {
            return Err(Problem::Bad(format!(
                "a deviation of {deviation} is more than {TIMES} times the tolerance beside it: check the units"
            )));
        }
        Ok(deviation)
    }

    /// One of the last digit of a companion, mm or degrees.
    fn digit_beside(&self, beside: &Companions<&Cell>, role: Role) -> Option<f64> {
        Some(self.digit(beside.get(role)?, self.unit_beside(role)))
    }

    /// By how much a deviation may differ from measured less nominal, because each is rounded to its last digit, mm or
    /// degrees. What has far fewer digits than the others has lost its zeros, and is no rounder than they.
    fn rounding(&self, cell: &Cell, beside: &Companions<&Cell>) -> f64 {
        /// Finer digits of a deviation are those of a computation.
        const FINE: f64 = 1e-3;
        const FEWER: f64 = 15.0;
        let value = Some(self.digit(cell, self.unit));
        let nominal = self.digit_beside(beside, Role::Nominal);
        let deviation = self.digit_beside(beside, Role::Deviation);
        let all = [value, nominal, deviation.map(|digit| digit.max(FINE))].into_iter().flatten();
        let finest = all.fold(f64::INFINITY, f64::min);
        let each = [value, nominal, deviation].into_iter().flatten();
        each.map(|digit| 0.5 * if digit > FEWER * finest { finest } else { digit }).sum::<f64>().max(SMALLEST_DIGIT)
    }

    /// One of the last digit that is written, in mm or degrees.
    fn digit(&self, cell: &Cell, unit: Unit) -> f64 {
        const MOST: usize = 12;
        let own = unit_in(&cell.text()).and_then(|symbol| unit_of(&symbol, self.field.is_angle()));
        let exponent = match &cell.content {
            Content::Text(text) => normalise(text, self.mark).map_or(0, |number| {
                let fraction = number.split_once('.').map_or("", |(_, fraction)| fraction);
                let decimals = fraction.bytes().take_while(u8::is_ascii_digit).take(MOST).count();
                -i32::try_from(decimals).unwrap_or(0)
            }),
            Content::Number(number) => number.exponent.min(0),
            Content::Empty | Content::Other(_) => 0,
        };
        let digit = Decimal { negative: false, digits: 1, exponent };
        quantity(digit, own.unwrap_or(unit)).map_or(1.0, DeviationValue::base)
    }
}

/// What stands beside a value that counts; f_Hβ over a length is held against nothing.
fn companions(measurement: &Measurement, unit: Unit, is_slope: bool) -> Result<Companions<Companion>, Diagnostic> {
    let of_value = [Role::Deviation, Role::Nominal, Role::Upper, Role::Lower, Role::Unit];
    let roles = if is_slope { &[Role::Length, Role::Unit][..] } else { &of_value };
    let mut beside = Companions::default();
    for role in roles {
        let Some(series) = measurement.beside.get(*role) else { continue };
        let own = if *role == Role::Length { Unit::Length(LengthUnit::Millimetre) } else { unit };
        let is_angle = matches!(own, Unit::Angle(_));
        let named = |symbol: &str| if is_angle { Unit::of_angle(symbol) } else { unit_of(symbol, false) };
        let unit = match series.unit.as_deref().filter(|_| *role != Role::Unit) {
            None => own,
            Some(symbol) => named(symbol).ok_or_else(|| unknown_unit(&series.title, symbol, is_angle))?,
        };
        beside.set(*role, Some(Companion { place: series.place, unit }));
    }
    Ok(beside)
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

/// How far a measured value may be from its nominal one: a tenth of it, and no further than any deviation.
fn near(nominal: DeviationValue, possible: Reach) -> Reach {
    match nominal {
        DeviationValue::Length(nominal) if !nominal.is_zero() => {
            possible.within(Length::from_fm((nominal.abs().fm() / 10).max(1)))
        }
        _ => possible,
    }
}

/// Where a tolerance or an uncertainty begins behind a number: `25 ±0,02`, `25 +0,03/-0,03`.
fn tolerance_behind(text: &str) -> Option<usize> {
    let of_both = || text.find(" +").filter(|at| text[*at..].contains("/-") || text[*at..].contains("/ -"));
    ["±", "+/-", "+-"].iter().find_map(|sign| text.find(sign)).or_else(of_both)
}

/// Whether a tolerance or an uncertainty stands behind a number.
pub(crate) fn has_tolerance_behind(text: &str) -> bool {
    tolerance_behind(text).is_some()
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

/// The unit of a column: of its heading or cells, of the spec, or that of its key.
fn unit(
    measurement: &Measurement,
    kind: Option<DeviationKind>,
    want: &Want,
    mark: DecimalMark,
) -> Result<(Unit, UnitFrom), Diagnostic> {
    let value = &measurement.value;
    let is_angle = measurement.field.is_angle();
    let dimension = |symbol: &str| unit_of(symbol, is_angle);
    let beside =
        measurement.beside.get(Role::Unit).and_then(|units| units.cells.iter().find(|cell| !cell.is_missing()));
    let beside = beside.map(Cell::text);
    let unit_from = if value.unit.is_none() && beside.is_some() { UnitFrom::Beside } else { UnitFrom::Table };
    let stated = kind.and_then(|kind| want.stated_unit(kind, &value.title));
    let unknown = |symbol: &str| unknown_unit(&value.title, symbol, is_angle);
    let symbol = value.unit.as_deref().or(beside.as_deref());
    let written = symbol.map(|symbol| dimension(symbol).ok_or_else(|| unknown(symbol))).transpose()?;
    match (stated, written) {
        (Some(stated), Some(written)) if stated != written => {
            let message =
                format!("`{}`: the table says {} and the spec {}", value.title, written.symbol(), stated.symbol());
            return Err(Diagnostic::error(Code::BadTable, message).help("correct the one that is wrong"));
        }
        (_, Some(written)) => return Ok((written, unit_from)),
        (Some(stated), None) => return Ok((stated, UnitFrom::Spec)),
        (None, None) => {}
    }
    let default = if is_angle { Unit::Angle(AngleUnit::Degree) } else { Unit::Length(LengthUnit::Millimetre) };
    let numbers = value.cells.iter().filter(|cell| cell.is_number());
    let carries = |cell: &Cell| matches!(&cell.content, Content::Text(text) if !text.trim_end().ends_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | ',') || ('\u{ff10}'..='\u{ff19}').contains(&c)));
    // f_Hβ in µm: the cells tell that it is no angle
    let in_cells =
        || numbers.clone().next().and_then(|cell| unit_in(&cell.text())).and_then(|symbol| dimension(&symbol));
    let of_slope = in_cells().filter(|unit| is_angle && matches!(unit, Unit::Length(_)));
    // a cell that is no measure says nothing of the unit
    if numbers.clone().any(carries) && numbers.clone().all(|cell| carries(cell) || !cell.is_measure()) {
        return Ok((of_slope.unwrap_or(default), UnitFrom::Table));
    }
    let is_of_tooth = kind.is_none() && is_key(&value.title, of_tooth(measurement.field));
    let by_key =
        is_of_tooth || is_key(&value.title, measurement.field) || want.is_own(&value.title) || !want.fields.is_empty();
    if by_key {
        return Ok((default, UnitFrom::Key));
    }
    if let Some(stated) = measurement.stated_unit {
        return Ok((stated, UnitFrom::Table));
    }
    let message =
        format!("`{}` is {}, and nothing tells the unit of its numbers", value.title, measurement.field.key());
    let units = if is_angle { ["deg", "arcmin"] } else { ["mm", "um"] };
    let units = fitting(measurement, kind, want, mark, units);
    let in_spec = kind.map(|kind| {
        let column = mapping(kind.key(), Some(kind), &value.title, Some(units[0]));
        let other = units.get(1).map_or_else(String::new, |other| format!(", or unit = \"{other}\""));
        format!("; or say it in the spec: [batch.columns] {column}{other}")
    });
    let help = behind_name(&value.title, &units) + &in_spec.unwrap_or_default();
    Err(Diagnostic::error(Code::BadTable, message).help(help))
}

/// Of two units, those in which the numbers of a measurement may be its values; both if there is none.
pub(crate) fn fitting<'u>(
    measurement: &Measurement,
    kind: Option<DeviationKind>,
    want: &Want,
    mark: DecimalMark,
    units: [&'u str; 2],
) -> Vec<&'u str> {
    let numbers = || measurement.value.cells.iter().filter(|cell| cell.is_number());
    let fits = |symbol: &&str| {
        let value = Series { unit: Some((*symbol).to_owned()), ..measurement.value.clone() };
        let column = Column::new(&Measurement { value, ..measurement.clone() }, kind, want, mark);
        column.is_ok_and(|column| numbers().all(|cell| column.may_hold(cell)))
    };
    let fitting: Vec<&str> = units.into_iter().filter(fits).collect();
    if fitting.is_empty() { units.to_vec() } else { fitting }
}

/// The advice to write one of some units behind a name.
pub(crate) fn behind_name(title: &str, units: &[&str]) -> String {
    let headings: Vec<_> = units.iter().map(|unit| format!("`{title} [{unit}]`")).collect();
    format!("write the unit behind the name: {}", headings.join(" or "))
}

/// The unit that a symbol is of a length, or of an angle or the length that f_Hβ is.
fn unit_of(symbol: &str, is_angle: bool) -> Option<Unit> {
    // where a unit stands, `my` is the German name of µ
    let symbol = match bare_unit(symbol) {
        "my" | "µ m" | "0,001 mm" | "0.001 mm" | "0,001mm" | "0.001mm" => "µm",
        "0,01 mm" | "0.01 mm" => "1/100 mm",
        symbol => symbol,
    };
    if is_angle { Unit::of_angle(symbol).or_else(|| Unit::of_length(symbol)) } else { Unit::of_length(symbol) }
}

/// Whether a title is the key of a field, with nothing but case changed.
fn is_key(title: &str, field: Field) -> bool {
    let (name, _) = split_unit(title);
    let title = name.trim().to_lowercase();
    let key = field.key();
    title == key || title.strip_suffix("_deviation").is_some_and(|stem| stem == key)
}

/// What an error of a part is called in a table of its teeth or spaces.
fn of_tooth(field: Field) -> Field {
    match field {
        Field::Error(DeviationKind::PinionRadial) => Field::Radial,
        Field::Error(DeviationKind::RackLead) => Field::Lead,
        field => field,
    }
}

fn unknown_unit(title: &str, symbol: &str, is_angle: bool) -> Diagnostic {
    if symbol.is_empty() {
        let message = format!("`{title}` has no unit beside it, and others have");
        return Diagnostic::error(Code::BadTable, message).help("write the unit of every value");
    }
    let (what, units) = if is_angle { ("an angle", AngleUnit::NAMES) } else { ("a length", LengthUnit::NAMES) };
    let message = format!("`{title}`: `{}` is not a unit of {what}", shown(symbol));
    Diagnostic::error(Code::BadTable, message).help(format!("write {units}"))
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
