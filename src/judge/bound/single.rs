//! The range of one error alone, from the files on steps and leads; adds nothing up.

use super::error::{ErrorEffect, RackLines};
use super::known::{KnownPair, flanks_apart};
use super::lead::{self, Leads, undercut};
use super::pitch;
use super::{AssumedHeight, ErrorRange, ExtendedError, Extent, HeightFrom, Knowledge, NoBound};
use crate::deviation::Part;
use crate::mesh::LARGEST_ROLL_RAD;
use crate::trig;

/// Without geometry flanks are taken to touch within this many modules of the reference plane, or within this share of
/// the face width, or up to the tips of a rack that is higher.
const MODULES_HIGH: f64 = 1.5;
const SHARE_OF_WIDTH_HIGH: f64 = 0.25;

/// The range of one error alone.
#[inline]
pub(super) fn range_of(error: &ExtendedError, knowledge: &Knowledge) -> Result<ErrorRange, NoBound> {
    let Some([one, other]) = error.signs() else { return range_of_signed(error, knowledge) };
    let ends = range_of_signed(&one, knowledge)?.or(range_of_signed(&other, knowledge)?);
    // an error on some teeth leaves others without it
    Ok(if error.may_be_nothing() { ends.or_nothing() } else { ends })
}

/// The range of an error with a sign.
#[inline]
fn range_of_signed(error: &ExtendedError, knowledge: &Knowledge) -> Result<ErrorRange, NoBound> {
    let range = match knowledge.pair {
        None => of_any_pair(error, knowledge)?,
        Some(known) => of_pair(error, known),
    };
    Ok(supported(range, knowledge).ordered())
}

/// The range of an error whose pair is not known.
#[inline]
fn of_any_pair(error: &ExtendedError, knowledge: &Knowledge) -> Result<ErrorRange, NoBound> {
    let ExtendedError { value, extent, .. } = *error;
    Ok(match error.effect {
        ErrorEffect::Size => size(error),
        ErrorEffect::Pitch { gain, cap } => {
            let limit = cap.map_or(f64::INFINITY, |cap| total(gain, cap, None));
            let range = match extent {
                Extent::Total => ErrorRange::either_way(total(gain, value.abs(), None)),
                Extent::One => pitch::one_of_any_pair(gain * value.abs(), knowledge.has_both_flanks()),
                _ if cap.is_some() => ErrorRange::either_way(limit),
                _ => return Err(NoBound::TeethInContactUnknown),
            };
            range.limited(limit)
        }
        ErrorEffect::RackLead(lines) => {
            lead::of_any_pair(lead::values_of(error, 1.0), Some(&lines), assumed_height(&lines, knowledge).mm)
        }
        ErrorEffect::PinionLead { gain } => lead::of_any_pair(lead::values_of(error, gain), None, 0.0),
    })
}

/// The range of an error in a known pair.
fn of_pair(error: &ExtendedError, known: &KnownPair) -> ErrorRange {
    let ExtendedError { part, extent, .. } = *error;
    match error.effect {
        ErrorEffect::Size if extent == Extent::One => one_space(error, known),
        ErrorEffect::Size => size(error),
        ErrorEffect::Pitch { gain, cap } => pitch_range(error, gain, cap, known),
        ErrorEffect::RackLead(_) | ErrorEffect::PinionLead { .. } => Leads::none(part).with(error).of_pair(known),
    }
}

/// The range of a space that sits higher by e: both its flanks carry for a while, or never.
#[inline]
fn size(error: &ExtendedError) -> ErrorRange {
    let ExtendedError { value, extent, .. } = *error;
    match extent {
        Extent::All => ErrorRange::signed(value),
        Extent::Each | Extent::Total => {
            let [lower, upper] = error.ends();
            ErrorRange::within(lower, upper)
        }
        Extent::Part | Extent::One => ErrorRange::within(value.min(0.0), value.max(0.0)),
    }
}

fn one_space(error: &ExtendedError, known: &KnownPair) -> ErrorRange {
    let ExtendedError { part, value, .. } = *error;
    let sometimes = size(error);
    if value > 0.0 {
        let with_undercut = undercut(known).map(|table| table.with_one_space(part, value));
        return ErrorRange {
            upper_mm: (value - known.space_stands_back(part)).max(0.5 * value),
            upper_with_undercut_mm: with_undercut.unwrap_or(f64::INFINITY),
            ..sometimes
        };
    }
    if !known.carries_lines() {
        return sometimes;
    }
    let path = &known.line;
    let alone = if path.ratio + flanks_apart(part, path) < 2.0 {
        1.0
    } else if path.ratio < 2.0 {
        0.5
    } else {
        0.0
    };
    ErrorRange { lower_mm: alone * value, ..sometimes }
}

/// The range of a total cumulative deviation of the flank sides, which may deviate apart. A pinion's is measured from the mean
/// of the turn.
#[inline]
fn total(gain: f64, deviation: f64, pinion_teeth: Option<u32>) -> f64 {
    2.0 * gain * deviation * (1.0 - pinion_teeth.map_or(0.0, |teeth| 1.0 / f64::from(teeth)))
}

fn pitch_range(error: &ExtendedError, gain: f64, cap: Option<f64>, known: &KnownPair) -> ErrorRange {
    let ExtendedError { part, value, extent, .. } = *error;
    let teeth = (part == Part::Pinion).then_some(known.given.pair.pinion().teeth);
    let limit = cap.map_or(f64::INFINITY, |cap| total(gain, cap, teeth));
    let range = match extent {
        Extent::Total => ErrorRange::either_way(total(gain, value.abs(), teeth)),
        _ => pitch::of_pair(part, extent, steps_of(error, gain), known),
    };
    ErrorRange { upper_with_undercut_mm: with_undercut(error, gain, limit, known), ..range.limited(limit) }
}

/// The range by which each step of an error moves ΔCD, mm. The steps of a pinion close over a turn, and those within a total
/// turn back: not all of them go one way.
fn steps_of(error: &ExtendedError, gain: f64) -> [f64; 2] {
    let ExtendedError { part, value, extent, effect, .. } = *error;
    let is_within_total = matches!(effect, ErrorEffect::Pitch { cap: Some(_), .. });
    let [least, most] = match (extent, part) {
        (Extent::Each, Part::Rack) if !is_within_total => error.ends(),
        (Extent::Each, _) => {
            let [lower, upper] = error.ends();
            [lower.min(0.0), upper.max(0.0)]
        }
        (_, Part::Rack) => [value; 2],
        (_, Part::Pinion) => [-value.abs(), value.abs()],
    };
    [gain * least, gain * most]
}

/// How far steps lift together with undercut, up to a limit of the steps.
fn with_undercut(error: &ExtendedError, gain: f64, limit: f64, known: &KnownPair) -> f64 {
    let ExtendedError { part, value, extent, .. } = *error;
    let Some(table) = undercut(known).filter(|_| extent != Extent::Total) else { return f64::INFINITY };
    let [least, most] = steps_of(error, gain);
    table.with_steps(part, |steps| {
        let lifted = (steps * least).max(steps * most);
        match extent {
            // a step one way is taken back elsewhere on the turn
            Extent::One => lifted.clamp(0.0, gain * value.abs()),
            Extent::Part => lifted.max(0.0),
            Extent::All | Extent::Each | Extent::Total => lifted,
        }
        .min(limit)
    })
}

/// The range of the leads of a part.
#[inline]
pub(super) fn of_leads(leads: &Leads, knowledge: &Knowledge) -> ErrorRange {
    match leads.signs() {
        None => of_signed_leads(leads, knowledge),
        Some([one, other]) => of_signed_leads(&one, knowledge).or(of_signed_leads(&other, knowledge)).or_nothing(),
    }
}

#[inline]
fn of_signed_leads(leads: &Leads, knowledge: &Knowledge) -> ErrorRange {
    let range = match knowledge.pair {
        Some(known) => leads.of_pair(known),
        None => leads.of_any_pair(leads.lines.as_ref().map_or(0.0, |lines| assumed_height(lines, knowledge).mm)),
    };
    supported(range, knowledge).ordered()
}

pub(super) fn assumed_height(lines: &RackLines, knowledge: &Knowledge) -> AssumedHeight {
    let assumed = match knowledge.basis.normal_module_mm {
        Some(module) => AssumedHeight { mm: MODULES_HIGH * module, from: HeightFrom::Module },
        None => AssumedHeight { mm: SHARE_OF_WIDTH_HIGH * lines.face_width, from: HeightFrom::FaceWidth },
    };
    let higher = knowledge.basis.addendum_mm.filter(|addendum| *addendum > assumed.mm);
    higher.map_or(assumed, |mm| AssumedHeight { mm, from: HeightFrom::Addendum })
}

/// The lower end for a rack that may roll: it sinks further than one that may not, so its raw lower end counts.
#[inline]
fn supported(range: ErrorRange, knowledge: &Knowledge) -> ErrorRange {
    if !knowledge.rolls() {
        return range;
    }
    let cos = trig::cos(LARGEST_ROLL_RAD);
    let raw = range.raw_lower_mm;
    let raw_lower_mm = if raw < 0.0 { raw / cos } else { raw * cos };
    ErrorRange { raw_lower_mm, lower_mm: raw_lower_mm, ..range }
}
