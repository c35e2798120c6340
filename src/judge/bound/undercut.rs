//! How far undercut lifts at the stroke at which an error lifts, because both need not come together. Made once for a pair
//! with undercut; knows no error's size.
//!
//! A right flank of tooth i and a left one of tooth j, n = i − j apart, lift together by ½(ν'(p) + ν'(−p − n)) at most beyond
//! their lines, over all places p on the path of the first, where lines carry at every stroke. Steps between both lift in
//! proportion to n.

use crate::deviation::Part;

/// Parts of a pitch into which the field of contact is divided.
pub(super) const CELLS: i32 = 96;

/// The most that a right flank asks for in one part of its path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    pub(super) index: i32,
    pub(super) most: f64,
}

/// How far two flanks lift together beyond their lines, by the teeth between them.
#[derive(Debug)]
pub(super) struct UndercutTable {
    /// The teeth from the left flank's to the right one's, and the most that both ask for, mm.
    apart: Vec<FlanksApart>,
}

/// Two flanks some teeth apart.
#[derive(Debug)]
struct FlanksApart {
    teeth: i32,
    most: f64,
}

impl UndercutTable {
    pub(super) fn new(cells: &[Cell]) -> Self {
        let at = |index: i32| cells.iter().find(|cell| cell.index == index).map(|cell| cell.most);
        let (Some(first), Some(last)) = (cells.first(), cells.last()) else { return Self { apart: Vec::new() } };
        // the left flank's place is −p − n: on the path for these n
        let teeth = -2 * last.index.div_euclid(CELLS) - 3..=-2 * first.index.div_euclid(CELLS) + 3;
        let most = |teeth: i32| {
            let sum = |cell: &Cell| Some(0.5 * (cell.most + at(-cell.index - teeth * CELLS - 1)?));
            cells.iter().filter_map(sum).reduce(f64::max).filter(|most| most.is_finite())
        };
        Self { apart: teeth.filter_map(|teeth| Some(FlanksApart { teeth, most: most(teeth)? })).collect() }
    }

    /// How far steps of a part lift together with undercut, mm: steps one way between two flanks (negative where they lower)
    /// lift by `gain` of their number.
    pub(super) fn with_steps(&self, part: Part, gain: impl Fn(f64) -> f64) -> f64 {
        let steps = |teeth: i32| match part {
            Part::Rack => f64::from(teeth),
            Part::Pinion => -f64::from(teeth + 1),
        };
        let of = |apart: &FlanksApart| apart.most + gain(steps(apart.teeth));
        self.apart.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// How far one or both flanks of a space that sits higher by `value` mm lift together with undercut.
    pub(super) fn with_one_space(&self, part: Part, value: f64) -> f64 {
        let teeth = match part {
            Part::Rack => -1,
            Part::Pinion => 0,
        };
        let of = |apart: &FlanksApart| apart.most + if apart.teeth == teeth { value } else { 0.5 * value };
        self.apart.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    }
}
