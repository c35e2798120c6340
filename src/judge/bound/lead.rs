//! What turned tooth lines do: the leads of all errors of a part are added as angles first. Read by the bound; knows no
//! other error.

use super::error::RackLines;
use super::{ErrorRange, Extent, Range};
use crate::trig;

/// Where points of contact can be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Half the width that points of contact can have, mm.
    pub(super) half_width: f64,
    /// Half the width over which sections always carry; `None` if they do not.
    pub(super) carrying: Option<f64>,
    /// Heights of points of contact over the reference plane, mm.
    pub(super) heights: Range,
}

/// The values that a tooth's lead can have: what an error of this value and extent leaves on a tooth.
pub(super) fn values(value: f64, extent: Extent) -> Range {
    match extent {
        Extent::All => Range { lower: value, upper: value },
        Extent::Each => Range { lower: -value.abs(), upper: value.abs() },
        Extent::One | Extent::Part | Extent::Total => Range { lower: value.min(0.0), upper: value.max(0.0) },
    }
}

/// What tooth lines of the rack do that are turned by angles within `angles`, rad.
pub(super) fn rack(angles: Range, lines: &RackLines, place: &Place) -> ErrorRange {
    let mut range = ErrorRange { raw_lower_mm: f64::INFINITY, lower_mm: f64::INFINITY, upper_mm: f64::NEG_INFINITY };
    // the effect of a height has its extreme where a turned tooth line runs across the rack
    let across = (-lines.helix).clamp(angles.lower, angles.upper);
    let none = 0.0_f64.clamp(angles.lower, angles.upper);
    let one_hand = angles.lower * angles.upper > 0.0;
    for angle in [angles.lower, angles.upper, none, across] {
        let (sin, cos) = trig::sin_cos(angle);
        let (sin_turned, cos_turned) = trig::sin_cos(lines.helix + angle);
        let per_width = sin.abs() / (cos_turned * lines.tan_alpha);
        let fall = sin_turned / cos_turned * sin - (1.0 - cos);
        let by_height = [-place.heights.lower * fall, -place.heights.upper * fall];
        let (low, high) = (by_height[0].min(by_height[1]), by_height[0].max(by_height[1]));
        let raw = low - place.half_width * per_width;
        let kept = place.carrying.map_or(raw, |half| low + if one_hand { half * per_width } else { 0.0 });
        range.raw_lower_mm = range.raw_lower_mm.min(raw);
        range.lower_mm = range.lower_mm.min(kept);
        range.upper_mm = range.upper_mm.max(high + place.half_width * per_width);
    }
    range
}

/// What turned helices of the pinion do, whose ΔCD over the whole face is within `values`, mm. Widths are shares of the
/// pinion's face.
pub(super) fn pinion(values: Range, share: f64, carrying: Option<f64>) -> ErrorRange {
    let largest = values.lower.abs().max(values.upper.abs());
    let least = if values.lower * values.upper > 0.0 { values.lower.abs().min(values.upper.abs()) } else { 0.0 };
    let upper_mm = share * largest;
    ErrorRange { raw_lower_mm: -upper_mm, lower_mm: carrying.map_or(-upper_mm, |part| part * least), upper_mm }
}
