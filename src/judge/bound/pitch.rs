//! The effect of steps between teeth: how many of them act at once. The bound reads it; it knows no other error.

use super::counts::StepDirection;
use super::known::KnownPair;
use super::levels::SLACK;
use super::{ErrorRange, Extent};
use crate::deviation::Part;

/// The effect of steps that move ΔCD by `least` to `most` mm each, for a known pair.
pub(super) fn of_pair(part: Part, extent: Extent, [least, most]: [f64; 2], known: &KnownPair) -> ErrorRange {
    let of = |step| one_way(part, step, known);
    // the effect of steps is convex in them on either side of 0
    let ends = of(least).or(of(most));
    let range = if least < 0.0 && most > 0.0 {
        let range = ends.or_nothing();
        ErrorRange { lower_mm: if keeps_whole_teeth(part, known) { 0.0 } else { range.raw_lower_mm }, ..range }
    } else {
        ends
    };
    let step = most.max(-least);
    let range = match extent {
        // only one step, or a run that may lie outside the teeth in contact
        Extent::One => range.or_nothing().limited(step),
        Extent::Part => range.or_nothing(),
        Extent::All | Extent::Each | Extent::Total => range,
    };
    let in_contact = if step > 0.0 { (range.upper_mm / step - SLACK).ceil().clamp(0.0, 1e6) as u32 } else { 0 };
    ErrorRange { in_contact, ..range }
}

/// Steps of which each moves ΔCD by `step` mm.
fn one_way(part: Part, step: f64, known: &KnownPair) -> ErrorRange {
    let (grows, shrinks) = match part {
        Part::Rack => (StepDirection::RackGrows, StepDirection::RackShrinks),
        Part::Pinion => (StepDirection::PinionGrows, StepDirection::PinionShrinks),
    };
    let (way, other) = if step >= 0.0 { (grows, shrinks) } else { (shrinks, grows) };
    let (counts, step) = (known.counts(way), step.abs());
    let raw_lower_mm = -known.counts(other).least_raw(step);
    let on_lines = (counts.on_lines - 1.0) * step;
    ErrorRange {
        raw_lower_mm,
        lower_mm: if known.carries_lines() { on_lines.max(raw_lower_mm) } else { raw_lower_mm },
        upper_mm: counts.most(step),
        raw_upper_mm: counts.most_raw(step),
        ..ErrorRange::either_way(0.0)
    }
}

/// Whether a tooth of a part always carries with both its flanks: then steps between whole teeth cannot sink.
fn keeps_whole_teeth(part: Part, known: &KnownPair) -> bool {
    known.carries_lines()
        && match part {
            Part::Rack => known.line.has_both_flanks_of_a_rack_tooth(),
            Part::Pinion => known.line.has_both_flanks_of_a_pinion_tooth(),
        }
}

/// The effect of one step, for any pair.
pub(super) fn one_of_any_pair(step: f64, both_flanks: bool) -> ErrorRange {
    let lower_mm = if both_flanks { 0.0 } else { -step };
    ErrorRange { lower_mm, ..ErrorRange::either_way(step) }
}
