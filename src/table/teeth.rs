//! Rows that are spaces of a rack or teeth of a pinion, grouped into parts. Called by `batch --teeth`, `paste` and whoever reads the
//! tables that a spec names. It gives the values of the table; others compute deviations from them.

pub(crate) mod gather;

use std::collections::BTreeSet;

use crate::deviation::Part;
use crate::quantity::{Angle, Length};

/// A value as a table gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measured {
    /// The measured value. The nominal value gives its deviation.
    Absolute(Length),
    /// Measured minus nominal.
    Deviation(Length),
}

/// One space of a rack, between the teeth `space` and `space + 1`.
#[derive(Debug, Clone)]
pub struct RackSpace {
    /// The space's number.
    pub space: i64,
    /// Measure over the pin.
    pub over_pin: Option<Measured>,
    /// Position of the pin along the rack.
    pub position: Option<Measured>,
    /// Helix angle deviation.
    pub lead: Option<Angle>,
    /// How much of it was measured.
    pub extent: RowExtent,
    /// The line of the row.
    pub line: u64,
}

/// How many of the table's columns have a value in a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowExtent {
    /// All.
    Whole,
    /// Some.
    Part,
    /// None: the space or tooth was not measured.
    Nothing,
}

/// A rack's spaces.
#[derive(Debug, Clone, Default)]
pub struct RackSpaces {
    /// The table.
    pub name: String,
    /// One per row.
    pub rows: Vec<RackSpace>,
}

impl RackSpaces {
    /// The spaces with a value in every column of the table.
    #[must_use]
    pub fn measured_spaces(&self) -> BTreeSet<i64> {
        self.rows.iter().filter(|row| row.extent == RowExtent::Whole).map(|row| row.space).collect()
    }

    /// The spaces that have a row and no value.
    #[must_use]
    pub fn without_values(&self) -> Vec<i64> {
        self.rows.iter().filter(|row| row.extent == RowExtent::Nothing).map(|row| row.space).collect()
    }

    /// The first space between the first and the last measured one that lacks a value or its row, and the line that shows it: its own,
    /// or that of the next space.
    #[must_use]
    pub fn unmeasured(&self) -> Option<(i64, u64)> {
        let mut rows: Vec<_> = self.rows.iter().filter(|row| row.extent != RowExtent::Nothing).collect();
        rows.sort_by_key(|row| row.space);
        let mut rows = rows.into_iter();
        let mut before = None;
        rows.find_map(|row| {
            let wanted = before.map_or(row.space, |before: i64| before.saturating_add(1));
            before = Some(row.space);
            (row.space != wanted || row.extent != RowExtent::Whole).then_some((wanted, row.line))
        })
    }
}

/// One tooth of a pinion and the space after it.
#[derive(Debug, Clone)]
pub struct PinionTooth {
    /// The tooth's number.
    pub tooth: i64,
    /// Radial deviation of the space after it.
    pub radial: Option<Length>,
    /// Position of the pin in that space minus its nominal position, along the reference circle.
    pub position: Option<Length>,
    /// Single pitch deviation of its left flank.
    pub left_pitch: Option<Length>,
    /// Single pitch deviation of its right flank.
    pub right_pitch: Option<Length>,
    /// Helix angle deviation of its flanks.
    pub lead: Option<Angle>,
    /// How much of it was measured.
    pub extent: RowExtent,
    /// The line of the row.
    pub line: u64,
}

/// A pinion's teeth.
#[derive(Debug, Clone, Default)]
pub struct PinionTeeth {
    /// The table.
    pub name: String,
    /// One per row.
    pub rows: Vec<PinionTooth>,
}

impl PinionTeeth {
    /// The first of so many teeth that lacks a value or its row.
    #[must_use]
    pub fn unmeasured(&self, teeth: i64) -> Option<i64> {
        let whole = self.rows.iter().filter(|row| row.extent == RowExtent::Whole);
        let measured: BTreeSet<i64> = whole.map(|row| row.tooth).collect();
        (0..teeth).find(|tooth| !measured.contains(tooth))
    }

    /// The fault that the single pitch deviations of all teeth have the same sign, if they do: around a pinion they add up to 0.
    fn without_signs(&self) -> Option<LineFault> {
        let has_one_sign = |flank: fn(&PinionTooth) -> Option<Length>| {
            let first = self.rows.first().and_then(flank).filter(|first| !first.is_zero());
            first.is_some_and(|first| {
                let is_alike = |other: Length| !other.is_zero() && other.is_negative() == first.is_negative();
                self.rows.iter().all(|row| flank(row).is_some_and(is_alike))
            })
        };
        let (left, right) = (has_one_sign(|row| row.left_pitch), has_one_sign(|row| row.right_pitch));
        (left || right).then(|| LineFault {
            line: self.rows[0].line,
            message: format!(
                                 "the {} flanks' single pitch deviations all have the same sign, but around a pinion they add up to 0: write \
                                  each with its sign, minus their mean",
                if left { "left" } else { "right" }
            ),
        })
    }
}

/// A rack's spaces or a pinion's teeth.
#[derive(Debug, Clone)]
pub enum Teeth {
    /// The spaces of a rack.
    Rack(RackSpaces),
    /// The teeth of a pinion.
    Pinion(PinionTeeth),
}

impl Teeth {
    /// The part that has them.
    #[must_use]
    pub const fn part(&self) -> Part {
        match self {
            Self::Rack(_) => Part::Rack,
            Self::Pinion(_) => Part::Pinion,
        }
    }
}

/// The rows of one part.
#[derive(Debug, Clone)]
pub(crate) struct ToothedPart {
    /// Its name; empty if the table names no parts.
    pub(crate) name: String,
    /// The line of its first row, and that row's record.
    pub(crate) line: u64,
    pub(crate) record: u64,
    pub(crate) teeth: Teeth,
    /// The rows as they stand in the file.
    pub(crate) raw: Vec<u8>,
    /// What is wrong with a row, and on which line.
    pub(crate) fault: Option<LineFault>,
    /// The first line whose status rejects the part.
    pub(crate) rejected_on: Option<u64>,
    /// The numbers of its spaces or teeth so far.
    numbers: BTreeSet<i64>,
}

/// What is wrong with a row.
#[derive(Debug, Clone)]
pub(crate) struct LineFault {
    pub(crate) line: u64,
    pub(crate) message: String,
}
