//! What one error can do alone. Reads what steps and leads do from the rooms beside it; adds nothing up.

use super::error::{ErrorEffect, RackLines};
use super::known::{KnownPair, flanks_apart};
use super::lead::{Leads, undercut};
use super::pitch;
use super::undercut::UndercutTable;
use super::{ErrorRange, ExtendedError, Extent, GivenGeometry, HeightFrom, Knowledge, NoBound};
use crate::deviation::Part;
use crate::mesh::LARGEST_ROLL_RAD;
use crate::trig;

/// Without geometry flanks are taken to touch within this many modules of the reference plane, or within this share of
/// the face width, or up to the tips of a rack that is higher.
const MODULES_HIGH: f64 = 1.5;
const SHARE_OF_WIDTH_HIGH: f64 = 0.25;

/// What one error can do alone.
#[inline]
pub(super) fn range_of(error: &ExtendedError, knowledge: &Knowledge) -> Result<ErrorRange, NoBound> {
    if let Some([one, other]) = error.signs() {
        return Ok(range_of(&one, knowledge)?.or(range_of(&other, knowledge)?));
    }
    let range = match error.effect {
        ErrorEffect::Size => size(error.part, error.value, error.extent, knowledge),
        ErrorEffect::Pitch { gain, cap } => pitch_range(error, gain, cap, knowledge)?,
        ErrorEffect::RackLead(_) | ErrorEffect::PinionLead { .. } => {
            of_leads(&Leads::none(error.part).with(error), knowledge)
        }
    };
    Ok(supported(range, knowledge).ordered())
}

/// A space that sits higher by e: both its flanks carry for a while, or never.
#[inline]
fn size(part: Part, value: f64, extent: Extent, knowledge: &Knowledge) -> ErrorRange {
    let sometimes = ErrorRange::within(value.min(0.0), value.max(0.0));
    match (extent, knowledge.pair) {
        (Extent::All, _) => ErrorRange::signed(value),
        (Extent::Each | Extent::Total, _) => ErrorRange::either_way(value.abs()),
        (Extent::One, Some(known)) if value > 0.0 => {
            let with_undercut = undercut(known).map(|table| table.with_one_space(part, value));
            ErrorRange {
                upper_mm: (value - known.space_stands_back(part)).max(0.5 * value),
                upper_with_undercut_mm: with_undercut.unwrap_or(f64::INFINITY),
                ..sometimes
            }
        }
        (Extent::One, Some(known)) if known.carries_lines() => {
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
        (Extent::Part | Extent::One, _) => sometimes,
    }
}

#[inline]
fn pitch_range(
    error: &ExtendedError,
    gain: f64,
    cap: Option<f64>,
    knowledge: &Knowledge,
) -> Result<ErrorRange, NoBound> {
    let ExtendedError { part, value, extent, .. } = *error;
    let known = knowledge.pair;
    let teeth = known.map(|known| known.given.pair.pinion().teeth);
    // a pinion's deviations are measured from the mean of the turn
    let mean = if part == Part::Pinion { teeth.map_or(0.0, |teeth| 1.0 / f64::from(teeth)) } else { 0.0 };
    let total = |deviation: f64| 2.0 * gain * deviation * (1.0 - mean);
    // F_p limits either flank side, which may deviate apart
    let limit = cap.map_or(f64::INFINITY, total);
    let step = gain * value.abs();
    let range = match (extent, known) {
        (Extent::Total, _) => ErrorRange::either_way(total(value.abs())),
        (_, Some(known)) => pitch::of_pair(part, extent, value >= 0.0, step, known),
        (Extent::One, None) => pitch::one_of_any_pair(
            step,
            matches!(knowledge.basis.geometry, GivenGeometry::BothFlanks) && !knowledge.rolls(),
        ),
        (_, None) if cap.is_some() => ErrorRange::either_way(limit),
        (_, None) => return Err(NoBound::TeethInContactUnknown),
    };
    let upper_with_undercut_mm = known.map_or(f64::INFINITY, |known| with_undercut(error, gain, limit, known));
    Ok(ErrorRange { upper_with_undercut_mm, ..range.limited(limit) })
}

/// What steps lift together with undercut, up to a limit of the steps.
fn with_undercut(error: &ExtendedError, gain: f64, limit: f64, known: &KnownPair) -> f64 {
    let ExtendedError { part, value, extent, .. } = *error;
    let Some(table) = undercut(known).filter(|_| extent != Extent::Total) else { return f64::INFINITY };
    table.with_steps(part, |steps| {
        let acting = match part {
            Part::Rack => UndercutTable::acting(extent, steps * value.signum()),
            // a step one way is taken back elsewhere on the turn
            Part::Pinion if extent == Extent::One => steps.abs().min(1.0),
            Part::Pinion => steps.abs(),
        };
        (acting * gain * value.abs()).min(limit)
    })
}

#[inline]
pub(super) fn of_leads(leads: &Leads, knowledge: &Knowledge) -> ErrorRange {
    if let Some([one, other]) = leads.signs() {
        return of_leads(&one, knowledge).or(of_leads(&other, knowledge));
    }
    match knowledge.pair {
        Some(known) => leads.of_pair(known),
        None => leads.of_any_pair(leads.lines.as_ref().map_or(0.0, |lines| assumed_height(lines, knowledge).0)),
    }
}

pub(super) fn assumed_height(lines: &RackLines, knowledge: &Knowledge) -> (f64, HeightFrom) {
    let by_width = (SHARE_OF_WIDTH_HIGH * lines.face_width, HeightFrom::FaceWidth);
    let module = knowledge.basis.normal_module_mm;
    let assumed = module.map_or(by_width, |module| (MODULES_HIGH * module, HeightFrom::Module));
    let higher = knowledge.basis.addendum_mm.filter(|addendum| *addendum > assumed.0);
    higher.map_or(assumed, |addendum| (addendum, HeightFrom::Addendum))
}

/// A rack that may roll sinks by more than one that may not, and nothing keeps it from its raw lower end.
#[inline]
pub(super) fn supported(range: ErrorRange, knowledge: &Knowledge) -> ErrorRange {
    if !knowledge.rolls() {
        return range;
    }
    let cos = trig::cos(LARGEST_ROLL_RAD);
    let raw = range.raw_lower_mm;
    let raw_lower_mm = if raw < 0.0 { raw / cos } else { raw * cos };
    ErrorRange { raw_lower_mm, lower_mm: raw_lower_mm, ..range }
}
