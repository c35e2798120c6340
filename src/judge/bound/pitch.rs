//! What steps between teeth do: how many of them act at once. Read by the bound; knows no other error.

use super::counts::{Counts, StepDirection};
use super::known::KnownPair;
use super::levels::SLACK;
use super::{ErrorRange, Extent};
use crate::deviation::Part;

/// Steps of ΔCD `step` each, of a pair.
pub(super) fn of_pair(part: Part, extent: Extent, grows: bool, step: f64, known: &KnownPair) -> ErrorRange {
    let range = match (part, extent) {
        (Part::Rack, Extent::One | Extent::Part | Extent::All) => {
            let (way, other) = if grows {
                (StepDirection::RackGrows, StepDirection::RackShrinks)
            } else {
                (StepDirection::RackShrinks, StepDirection::RackGrows)
            };
            let counts = known.counts(way);
            let raw_lower_mm = -known.counts(other).least_raw(step);
            let on_lines = (counts.on_lines - 1.0) * step;
            let lower_mm = if known.carries_lines() { on_lines.max(raw_lower_mm) } else { raw_lower_mm };
            ErrorRange {
                raw_lower_mm,
                lower_mm,
                upper_mm: counts.most(step),
                raw_upper_mm: counts.most_raw(step),
                ..ErrorRange::either_way(0.0)
            }
        }
        (Part::Rack, _) => {
            let keeps = known.carries_lines() && known.line.has_both_flanks_of_a_rack_tooth();
            either_sign(known, [StepDirection::RackGrows, StepDirection::RackShrinks], step, keeps)
        }
        (Part::Pinion, _) => {
            let keeps = known.carries_lines() && known.line.has_both_flanks_of_a_pinion_tooth();
            either_sign(known, [StepDirection::PinionGrows, StepDirection::PinionShrinks], step, keeps)
        }
    };
    let range = match extent {
        // one step only, or a run that need not be where the teeth are in contact
        Extent::One => range.or_nothing().limited(step),
        Extent::Part => range.or_nothing(),
        Extent::All | Extent::Each | Extent::Total => range,
    };
    let in_contact = if step > 0.0 { (range.upper_mm / step - SLACK).ceil().clamp(0.0, 1e6) as u32 } else { 0 };
    ErrorRange { in_contact, ..range }
}

/// One step, of any pair.
pub(super) fn one_of_any_pair(step: f64, both_flanks: bool) -> ErrorRange {
    let lower_mm = if both_flanks { 0.0 } else { -step };
    ErrorRange { lower_mm, ..ErrorRange::either_way(step) }
}

fn either_sign(known: &KnownPair, ways: [StepDirection; 2], step: f64, keeps: bool) -> ErrorRange {
    let largest =
        |of: fn(&Counts, f64) -> f64| ways.map(|way| of(known.counts(way), step)).into_iter().fold(0.0, f64::max);
    let raw = largest(Counts::least_raw);
    ErrorRange {
        raw_lower_mm: -raw,
        lower_mm: if keeps { 0.0 } else { -raw },
        upper_mm: largest(Counts::most),
        raw_upper_mm: largest(Counts::most_raw),
        ..ErrorRange::either_way(0.0)
    }
}
