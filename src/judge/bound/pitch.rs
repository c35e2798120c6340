//! What steps between teeth do: how many of them act at once. Read by the bound; knows no other error.

use super::known::KnownPair;
use super::{ContactPath, ErrorRange, Extent};
use crate::deviation::Part;

/// Paths of contact this near to a whole number of pitches are taken for the worse.
const SLACK: f64 = 1e-9;

fn whole(pitches: f64) -> f64 {
    pitches.floor()
}

/// The path within which steps of one kind add up, in pitches, of a path of contact.
type Length = fn(&ContactPath) -> f64;

const RACK_GROWS: Length = |path| path.ratio - 2.0 * path.offset;
const RACK_SHRINKS: Length = |path| path.ratio + 2.0 * path.offset;
const PINION_GROWS: Length = |path| path.ratio + 2.0 * path.offset - 1.0;
const PINION_SHRINKS: Length = |path| path.ratio - 2.0 * path.offset + 1.0;

/// Steps of ΔCD `step` each, of a pair.
pub(super) fn of_pair(part: Part, extent: Extent, grows: bool, step: f64, known: &KnownPair) -> ErrorRange {
    let range = match (part, extent) {
        (Part::Rack, Extent::One | Extent::Part | Extent::All) => {
            let (length, other) = if grows { (RACK_GROWS, RACK_SHRINKS) } else { (RACK_SHRINKS, RACK_GROWS) };
            let raw_lower_mm = -least_raw(known, other, step);
            let on_lines = (whole(length(&known.line) - SLACK) - 1.0) * step;
            let lower_mm = if known.carries_lines() { on_lines.max(raw_lower_mm) } else { raw_lower_mm };
            ErrorRange {
                raw_lower_mm,
                lower_mm,
                upper_mm: most(known, length, step),
                raw_upper_mm: most_raw(known, length, step),
                in_contact: None,
            }
        }
        (Part::Rack, _) => {
            let keeps = known.carries_lines() && known.line.has_both_flanks_of_a_rack_tooth();
            either_sign(known, [RACK_GROWS, RACK_SHRINKS], step, keeps)
        }
        (Part::Pinion, _) => {
            let keeps = known.carries_lines() && known.line.has_both_flanks_of_a_pinion_tooth();
            either_sign(known, [PINION_GROWS, PINION_SHRINKS], step, keeps)
        }
    };
    limited(range, extent, step)
}

/// One step, of any pair.
pub(super) fn one_of_any_pair(step: f64, both_flanks: bool) -> ErrorRange {
    let lower_mm = if both_flanks { 0.0 } else { -step };
    ErrorRange { lower_mm, ..ErrorRange::either_way(step) }
}

fn either_sign(known: &KnownPair, lengths: [Length; 2], step: f64, keeps: bool) -> ErrorRange {
    let upper_mm = lengths.map(|length| most(known, length, step)).into_iter().fold(0.0, f64::max);
    let raw = lengths.map(|length| least_raw(known, length, step)).into_iter().fold(0.0, f64::max);
    let raw_upper_mm = lengths.map(|length| most_raw(known, length, step)).into_iter().fold(0.0, f64::max);
    let lower_mm = if keeps { 0.0 } else { -raw };
    ErrorRange { raw_lower_mm: -raw, lower_mm, upper_mm, raw_upper_mm, in_contact: None }
}

/// One step only, or a run that need not be where the teeth are in contact.
fn limited(range: ErrorRange, extent: Extent, step: f64) -> ErrorRange {
    let most = match extent {
        Extent::One => step,
        Extent::Part => f64::INFINITY,
        Extent::All | Extent::Each | Extent::Total => return range.counted(step),
    };
    let low = |value: f64| value.min(0.0).max(-most);
    let high = |value: f64| value.max(0.0).min(most);
    ErrorRange {
        raw_lower_mm: low(range.raw_lower_mm),
        lower_mm: low(range.lower_mm),
        upper_mm: high(range.upper_mm),
        raw_upper_mm: high(range.raw_upper_mm),
        in_contact: None,
    }
    .counted(step)
}

/// What steps in line lift at most. One more that only edges reach lifts less by what those stand back.
fn most(known: &KnownPair, length: Length, step: f64) -> f64 {
    let mut count = whole(length(&known.levels[0].path) + SLACK);
    let mut most = count * step;
    loop {
        count += 1.0;
        let stands_back = known.stands_back(length, count);
        // what is still farther out adds a step at most, and stands back by more
        if stands_back > step {
            return most.max(count * step - stands_back);
        }
        most = most.max(count * step - stands_back);
    }
}

/// What steps in line lift at most beside other errors, which may pay for what edges stand back.
fn most_raw(known: &KnownPair, length: Length, step: f64) -> f64 {
    let last = &known.levels[known.levels.len() - 1];
    (whole(length(&last.path) + SLACK) * step).max(most(known, length, step))
}

/// How far steps in line may lower, whichever flanks carry: those on edges, too, where lines leave gaps.
fn least_raw(known: &KnownPair, length: Length, step: f64) -> f64 {
    whole(length(&known.level(2.0 * known.gap()).path) + SLACK) * step
}

impl ErrorRange {
    /// With the number of steps that add up.
    fn counted(self, step: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few teeth")]
        let count = (self.upper_mm / step - SLACK).ceil().clamp(0.0, 1e6) as u32;
        Self { in_contact: (step > 0.0).then_some(count), ..self }
    }
}
