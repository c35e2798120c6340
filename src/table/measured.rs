//! The measured values of a table, by which a number beside it is told to be one more: it is near a nominal value. Asked about
//! what is not understood; deviations tell nothing.

use super::cell::Cell;
use super::column::{Column, Nominal};
use super::names::Role;
use super::number::DecimalMark;
use super::understand::Understood;
use crate::deviation::DeviationValue;

/// What is known of the measured values of a table.
#[derive(Debug, Default)]
pub(crate) struct MeasuredValues {
    columns: Vec<ColumnValues>,
}

/// The values of a column.
#[derive(Debug)]
struct ColumnValues {
    column: Column,
    nominals: Vec<DeviationValue>,
    /// The least and the largest value, mm or degrees.
    least: f64,
    most: f64,
}

impl MeasuredValues {
    pub(crate) fn of(understood: &Understood) -> Self {
        let of_column = |(measurement, column): (&super::shape::Measurement, &Column)| {
            let beside = measurement.beside.get(Role::Nominal).into_iter().flat_map(|series| &series.cells);
            let stated = if let Nominal::Fixed(nominal) = column.nominal { Some(nominal) } else { None };
            let values = measurement.value.cells.iter().filter_map(|cell| column.quantity(cell).ok());
            let values = values.map(DeviationValue::base);
            let (least, most) = values
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
            let nominals = stated.into_iter().chain(beside.filter_map(|cell| column.quantity(cell).ok()));
            let nominals = nominals.filter(|nominal| nominal.base() != 0.0).collect();
            ColumnValues { column: column.clone(), nominals, least, most }
        };
        Self { columns: understood.shape.measurements.iter().zip(&understood.columns).map(of_column).collect() }
    }

    /// Whether a number has decimals and is near a nominal value, and is none.
    pub(crate) fn may_have(&self, cell: &Cell) -> bool {
        self.columns.iter().any(|column| column.may_have(cell, |_| true))
    }

    /// Whether it also is larger or smaller than every value of the table.
    pub(crate) fn is_beyond_all(&self, cell: &Cell) -> bool {
        self.columns.iter().any(|column| column.may_have(cell, |value| value < column.least || value > column.most))
    }
}

impl ColumnValues {
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
