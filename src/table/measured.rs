//! The values of a table, by which a number beside it is told to be one more: it is near a nominal value, or within the
//! values of a column. Asked about what is not understood.

use super::cell::Cell;
use super::column::{Column, Extent, Nominal};
use super::grid::is_unit;
use super::names::{Role, WordList, is_apart, is_of_parts, is_statistic, is_tolerance, role};
use super::number::DecimalMark;
use super::understand::Understood;
use super::unknown::Unknown;
use super::want::Orientation;
use crate::deviation::DeviationValue;

/// What is known of the measured values of a table.
#[derive(Debug, Default)]
pub(crate) struct MeasuredValues {
    orientation: Orientation,
    columns: Vec<ColumnValues>,
}

/// The values of a column.
#[derive(Debug)]
struct ColumnValues {
    column: Column,
    nominals: Vec<DeviationValue>,
    extent: Extent,
}

impl MeasuredValues {
    pub(crate) fn of(understood: &Understood) -> Self {
        let ids = understood.shape.ids.iter().flat_map(|ids| &ids.cells);
        let of_parts: Vec<bool> = ids.map(|name| is_of_parts(&name.text())).collect();
        let of_column = |(measurement, column): (&super::shape::Measurement, &Column)| {
            let beside = measurement.beside.get(Role::Nominal).into_iter().flat_map(|series| &series.cells);
            let stated = if let Nominal::Fixed(nominal) = column.nominal { Some(nominal) } else { None };
            let values = measurement.value.cells.iter().enumerate();
            let values = values.filter(|(row, _)| of_parts.get(*row) != Some(&true));
            let extent = values.fold(Extent::NONE, |extent, (_, cell)| {
                column.quantity(cell).map_or(extent, |value| extent.with(value, cell, column))
            });
            let nominals = stated.into_iter().chain(beside.filter_map(|cell| column.quantity(cell).ok()));
            let nominals = nominals.filter(|nominal| nominal.base() != 0.0).collect();
            ColumnValues { column: column.clone(), nominals, extent }
        };
        Self {
            orientation: understood.shape.orientation,
            columns: understood.shape.measurements.iter().zip(&understood.columns).map(of_column).collect(),
        }
    }

    /// Whether a column, or a line where others are, may hold the values of a known one once more. The nominal value of all parts,
    /// a tolerance and a spread are none.
    pub(crate) fn are_repeated_by(&self, unknown: &Unknown) -> bool {
        let title = &unknown.title;
        let is_fixed = || unknown.cells.windows(2).all(|pair| pair[0].text() == pair[1].text());
        let is_other = is_statistic(title) && !WordList::Mean.has(title)
            || role(title).is_some_and(Role::is_beside_value) && is_fixed();
        let is_of_rows = self.orientation == Orientation::Rows;
        // an extreme that is another for each part is measured; one beside the first part alone may be that of all
        let has_numbers = || unknown.cells.iter().any(Cell::is_number);
        if unknown.column.is_some() && is_of_rows && WordList::Mean.has(title) && has_numbers() && !is_fixed() {
            return !self.have_statistic(&unknown.cells);
        }
        // a column beside columns of parts is a statistic of them
        unknown.column.is_some() == is_of_rows
            && !is_other
            && self.columns.iter().any(|column| column.may_be_repeated(&unknown.cells))
    }

    /// Whether a column holds one number, beside the first of several parts, that lies among the values.
    fn have_statistic(&self, cells: &[Cell]) -> bool {
        let is_alone = cells.len() > 1 && cells.iter().skip(1).all(Cell::is_missing);
        is_alone && self.columns.iter().any(|column| column.encloses(&cells[0]))
    }

    /// Whether a number has decimals and is near a nominal value, and is none.
    pub(crate) fn may_have(&self, cell: &Cell) -> bool {
        self.columns.iter().any(|column| column.may_have(cell, |_| true))
    }

    /// Whether a line says what is wanted of the values or made of them, and nothing but numbers stands behind its name: a
    /// tolerance or a probe far from nominal, a mean among the values, a spread that is no larger than they are apart.
    pub(crate) fn are_described_by(&self, unknown: &Unknown, behind: &str) -> bool {
        let title = &unknown.title;
        let is_given = is_tolerance(title) || WordList::Probe.has(title);
        let is_so = |cell: &Cell| {
            let text = cell.text();
            let number = Cell::of_text(text.trim_start_matches('±'), 0..0);
            let is_number = || match is_given {
                true => !self.may_have(&number) && !self.columns.iter().any(|column| column.is_near_nominal(&number)),
                false if WordList::Mean.has(title) => self.columns.iter().any(|column| column.encloses(&number)),
                false => !self.are_narrower_than(&number),
            };
            cell.is_missing() || is_unit(&text) || number.is_number() && is_number()
        };
        let mut words = behind.split(|c: char| !c.is_alphanumeric() && c != '°').filter(|word| !word.is_empty());
        unknown.column.is_none()
            && (is_given || is_statistic(title))
            && words.all(|word| word.bytes().all(|byte| byte.is_ascii_digit()) || is_unit(word))
            && unknown.cells.iter().all(is_so)
    }

    /// Whether no number among some cells is the mean, the extreme or the spread of a column that they are called.
    pub(crate) fn contradict(&self, title: &str, cells: &[Cell]) -> bool {
        let encloses = |cell: &Cell| self.columns.iter().any(|column| column.encloses(cell));
        WordList::Mean.has(title) && !cells.iter().any(encloses)
            || WordList::Spread.has(title) && cells.iter().all(|cell| self.are_narrower_than(cell))
    }

    /// Whether a number of a list beside the parts is none of what it is called there: a statistic or nominal value of these values.
    pub(crate) fn are_denied_by(&self, title: &str, number: &Cell) -> bool {
        let is_other = |column: &ColumnValues| {
            let is_nominal = column.column.quantity(number).is_ok_and(|value| column.nominals.contains(&value));
            column.is_near_nominal(number) && !is_nominal
        };
        self.contradict(title, std::slice::from_ref(number))
            || WordList::Mean.has(title) && self.is_beyond_all(number)
            || is_apart(title) && self.may_have(number)
            || role(title) == Some(Role::Nominal) && self.columns.iter().any(is_other)
    }

    /// Whether a number is larger than the range of every column's values, so that it is no spread of them.
    pub(crate) fn are_narrower_than(&self, cell: &Cell) -> bool {
        self.columns.iter().all(|values| values.column.is_wider(cell, &values.extent))
    }

    /// Whether it also is larger or smaller than every value of the table.
    pub(crate) fn is_beyond_all(&self, cell: &Cell) -> bool {
        self.columns
            .iter()
            .any(|column| column.may_have(cell, |value| value < column.extent.least || value > column.extent.most))
    }
}

impl ColumnValues {
    /// Whether a number may be one of its values, whose nominal one is known.
    fn is_near_nominal(&self, cell: &Cell) -> bool {
        matches!(self.column.nominal, Nominal::Fixed(_)) && self.column.may_hold(cell)
    }

    /// Whether a number lies among its values.
    fn encloses(&self, cell: &Cell) -> bool {
        self.column.quantity(cell).is_ok_and(|value| self.extent.encloses(value.base()))
    }

    /// Whether cells may be its values once more: with decimals, and each near the nominal one, or else within its values and
    /// half their range.
    fn may_be_repeated(&self, cells: &[Cell]) -> bool {
        let numbers: Vec<&Cell> = cells.iter().filter(|cell| cell.is_number()).collect();
        if !numbers.iter().all(|cell| cell.is_measure()) || !numbers.iter().any(|cell| cell.has_decimals()) {
            return false;
        }
        if matches!(self.column.nominal, Nominal::Fixed(_)) {
            return numbers.iter().all(|cell| self.column.may_hold(cell));
        }
        let Extent { least, most, .. } = self.extent;
        let half = if most > least { (most - least) / 2.0 } else { most.abs() / 2.0 };
        let is_among = |value: DeviationValue| (least - half..=most + half).contains(&value.base());
        numbers.iter().all(|cell| self.column.quantity(cell).is_ok_and(is_among))
    }

    fn may_have(&self, cell: &Cell, is_meant: impl Fn(f64) -> bool) -> bool {
        let is_value = |mark: DecimalMark| {
            let value = self.column.with_mark(mark).quantity(cell).ok();
            value.is_some_and(|value| {
                let is_near = |nominal: &DeviationValue| self.column.is_near(value, *nominal);
                !self.nominals.contains(&value) && self.nominals.iter().any(is_near) && is_meant(value.base())
            })
        };
        cell.has_two_decimals() && DecimalMark::ALL.into_iter().any(is_value)
    }
}
