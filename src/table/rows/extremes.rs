//! Rows that are called by a statistic or a limit of the others, which are no part if the values of all rows allow that: this
//! is known when the last one is read.

use super::super::block::{Block, Contradiction};
use super::super::cell::Record;
use super::super::column::{Column, Extent};
use super::super::names::{Field, is_called_spread, names_value, near};
use super::super::understand::is_false_statistic;
use super::Rows;
use super::aside::{is_called_of_parts, is_of_teeth};
use super::contradiction::contradiction;
use crate::deviation::{DeviationKind, DeviationValue};

/// How far the values of a table reach, and the rows called by a statistic that contradict them so far.
#[derive(Debug, Default)]
pub(crate) struct Extremes {
    ends: Vec<Option<[DeviationValue; 2]>>,
    rows: usize,
    pub(crate) doubted: Vec<Record>,
    /// Lines that rules left out and that could be parts, by the number of the rule among those for lines.
    doubtful: Vec<(usize, u64)>,
}

impl Extremes {
    /// Takes the rows of one more block.
    pub(crate) fn add(&mut self, rows: &Rows, block: &Block) {
        self.ends.resize(block.ends.len().max(self.ends.len()), None);
        for (ends, more) in self.ends.iter_mut().zip(&block.ends) {
            let mut all: Vec<_> = ends.iter().chain(more).flatten().copied().collect();
            all.sort_by(|one, other| one.base().total_cmp(&other.base()));
            *ends = all.first().zip(all.last()).map(|(least, most)| [*least, *most]);
        }
        self.rows += block.lines.len();
        self.doubtful.extend(&block.doubtful);
        let doubted = std::mem::take(&mut self.doubted).into_iter().chain(block.statistics.iter().cloned());
        // more values contradict less
        self.doubted = doubted.filter(|record| rows.false_statistic(record, self).is_some()).collect();
    }

    /// What contradicts the values of all rows.
    pub(crate) fn contradiction(&self, rows: &Rows) -> Option<Contradiction> {
        if let Some(contract) = &rows.setup.contract {
            return contract.too_many(&self.doubtful);
        }
        self.doubted.first().and_then(|record| rows.false_statistic(record, self))
    }
}

impl Rows {
    /// What a record is called that is made of the others: by its name, or in place of the number of a tooth.
    pub(super) fn statistic<'r>(&self, record: &'r Record) -> Option<std::borrow::Cow<'r, str>> {
        let index = self.setup.index.map(|index| record.cell(index).text());
        let index = index.filter(|name| is_called_of_parts(name) || is_of_teeth(name) && is_of_pitches(name));
        let is_spread = |name: &str| self.setup.names.exclude(name) || self.setup.names.have_spread(name);
        self.label(record)
            .filter(|name| is_called_of_parts(name) || is_called_spread(name) && is_spread(name))
            .or(index)
    }

    /// Why a record cannot be the statistic that it is called.
    fn false_statistic(&self, record: &Record, extremes: &Extremes) -> Option<Contradiction> {
        let name = self.statistic(record)?;
        // f_u is the difference of two deviations, and what adds up over the teeth is no larger than the largest so many times
        let teeth = self.setup.want.pinion_teeth.and_then(|teeth| usize::try_from(teeth).ok());
        let count = match () {
            () if name.starts_with("fu") => 2,
            () if names_value(&name, &[]) || name.ends_with("max") => 1,
            () => teeth.map_or(extremes.rows, |teeth| teeth.min(extremes.rows)),
        };
        let is_false = |(column, ends): &(&Column, &Option<[DeviationValue; 2]>)| {
            let (Some(ends), cell) = (ends, record.cell(column.place)) else { return false };
            let (others, beside) = (Extent::between(*ends, extremes.rows), column.beside_in(record));
            if is_called_of_parts(&name) || is_called_spread(&name) {
                return is_false_statistic(&name, column, cell, beside, &others);
            }
            column.beyond(cell, beside, &others.times(count as f64)).is_some()
        };
        let (column, _) = self.setup.columns.iter().zip(&extremes.ends).find(is_false)?;
        let message = format!("the values of the other rows contradict this: {}", record.in_words());
        let help = "give the row the name of its part, or take it out of the table";
        Some(contradiction(record, Some(&column.title), message, help))
    }
}

/// Whether what stands below the teeth is made of their pitches: a runout is not.
fn is_of_pitches(name: &str) -> bool {
    let is_pitch = |field: &Field| {
        let kind = field.kind();
        matches!(field, Field::LeftPitch | Field::RightPitch)
            || matches!(kind, Some(DeviationKind::RackPitch | DeviationKind::PinionPitch))
    };
    name.ends_with("max") || near(name).iter().any(is_pitch)
}
