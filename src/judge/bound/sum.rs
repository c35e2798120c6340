//! The bound of each error and of their sum. Reads what the errors do from the rooms beside it; solves no mesh.

use super::error::{Effect, PitchEffect, RackLines};
use super::lead::Leads;
use super::pitch;
use super::{ContactPath, ErrorRange, Extent, Geometry, Knowledge, KnownPair, Note, Open, Range, ExtendedError};
use crate::deviation::Part;
use crate::gear::Pair;
use crate::mesh::LARGEST_ROLL_RAD;
use crate::trig;

/// The bound of errors whose teeth are not known.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// What each error can do alone, in the order given; the pair's own curve not counted.
    pub errors: Vec<Result<ErrorRange, Open>>,
    /// What all can do together, the pair's own curve counted.
    pub total: Result<Range, Open>,
    /// What it rests on.
    pub notes: Vec<Note>,
}

/// Without geometry flanks are taken to touch within this many modules of the reference plane, or within this share of
/// the face width.
const MODULES_HIGH: f64 = 1.5;
const SHARE_OF_WIDTH_HIGH: f64 = 0.25;
/// Lower ends are rounded by this much, mm: more than what sums and sines lose.
const ROUNDING_MM: f64 = 1e-12;

/// The bound of some errors: whatever teeth they are on, as their extents allow, the exact mesh stays inside it.
#[must_use]
pub fn bound(errors: &[ExtendedError], knowledge: &Knowledge) -> Bound {
    let each: Vec<_> = errors.iter().map(|error| range_of(error, knowledge)).collect();
    Bound { total: total(errors, knowledge), notes: notes(errors, knowledge), errors: each }
}

/// What one error can do alone.
fn range_of(error: &ExtendedError, knowledge: &Knowledge) -> Result<ErrorRange, Open> {
    let range = match error.effect {
        Effect::Size { part, value } => size(part, value, error.extent, knowledge),
        Effect::Pitch(pitch) => pitch_range(&pitch, error.extent, knowledge)?,
        Effect::RackLead { value, rack } => {
            leads(&Leads::none(Part::Rack).with(value, error.extent, Some(rack)), Some(&rack), knowledge)
        }
        Effect::PinionLead { value } => {
            leads(&Leads::none(Part::Pinion).with(value, error.extent, None), None, knowledge)
        }
    };
    Ok(supported(range, knowledge))
}

const fn known<'a>(knowledge: &Knowledge<'a>) -> Option<&'a KnownPair> {
    match knowledge.geometry {
        Geometry::Known(known) => Some(known),
        Geometry::Unknown | Geometry::BothFlanks => None,
    }
}

/// A space that sits higher by e. Its right flank carries around the stroke c, its left one a whole pitch (of a rack space)
/// or none (of a pinion space) after −c, so that both do for a while, or never.
fn size(part: Part, value: f64, extent: Extent, knowledge: &Knowledge) -> ErrorRange {
    let apart = |path: &ContactPath| match part {
        Part::Rack => (1.0 - 2.0 * path.offset).abs(),
        Part::Pinion => (2.0 * path.offset).abs(),
    };
    let sometimes = ErrorRange {
        raw_lower_mm: value.min(0.0),
        lower_mm: value.min(0.0),
        upper_mm: value.max(0.0),
        in_contact: None,
    };
    match (extent, known(knowledge)) {
        (Extent::All, _) => ErrorRange::signed(value),
        (Extent::Each | Extent::Total, _) => ErrorRange::either_way(value.abs()),
        (Extent::Part, _) | (Extent::One, None) => sometimes,
        (Extent::One, Some(known)) if value > 0.0 => {
            let stands_back = known.stands_back(|path| path.ratio - apart(path), 0.0);
            ErrorRange { upper_mm: (value - stands_back).max(0.5 * value), ..sometimes }
        }
        (Extent::One, Some(known)) if known.carries_lines() => {
            let path = &known.line;
            let alone = if path.ratio + apart(path) < 2.0 {
                1.0
            } else if path.ratio < 2.0 {
                0.5
            } else {
                0.0
            };
            ErrorRange { lower_mm: alone * value, ..sometimes }
        }
        (Extent::One, Some(_)) => sometimes,
    }
}

fn pitch_range(pitch: &PitchEffect, extent: Extent, knowledge: &Knowledge) -> Result<ErrorRange, Open> {
    let PitchEffect { part, value, gain, teeth, cap } = *pitch;
    let known = known(knowledge);
    let teeth = teeth.or_else(|| known.map(|known| known.given.pair.pinion().teeth));
    // a pinion's deviations are measured from the mean of the turn
    let mean = if part == Part::Pinion { teeth.map_or(0.0, |teeth| 1.0 / f64::from(teeth)) } else { 0.0 };
    let total = |deviation: f64| 2.0 * gain * deviation * (1.0 - mean);
    // whole teeth within a total deviation: no two are farther apart
    let limit = cap.map_or(f64::INFINITY, |cap| gain * cap);
    let step = gain * value.abs();
    let range = match (extent, known) {
        (Extent::Total, _) => ErrorRange::either_way(total(value.abs())),
        (_, Some(known)) => pitch::of_pair(part, extent, value >= 0.0, step, known),
        (Extent::One, None) => {
            pitch::one_of_any_pair(step, knowledge.geometry == Geometry::BothFlanks && !knowledge.rolls)
        }
        (_, None) if cap.is_some() => ErrorRange::either_way(limit),
        (_, None) => return Err(Open::TeethInContactUnknown),
    };
    Ok(ErrorRange {
        raw_lower_mm: range.raw_lower_mm.max(-limit),
        lower_mm: range.lower_mm.max(-limit),
        upper_mm: range.upper_mm.min(limit),
        ..range
    })
}

fn leads(leads: &Leads, lines: Option<&RackLines>, knowledge: &Knowledge) -> ErrorRange {
    match known(knowledge) {
        Some(known) => leads.of_pair(known),
        None => leads.of_any_pair(lines.map_or(0.0, |lines| assumed_height(lines, knowledge))),
    }
}

fn assumed_height(lines: &RackLines, knowledge: &Knowledge) -> f64 {
    knowledge.normal_module_mm.map_or(SHARE_OF_WIDTH_HIGH * lines.face_width, |module| MODULES_HIGH * module)
}

/// A rack that may roll sinks by more than one that may not, and nothing keeps it from its raw lower end.
fn supported(range: ErrorRange, knowledge: &Knowledge) -> ErrorRange {
    if !knowledge.rolls() {
        return range;
    }
    let cos = trig::cos(LARGEST_ROLL_RAD);
    let raw = range.raw_lower_mm;
    let raw_lower_mm = if raw < 0.0 { raw / cos } else { raw * cos };
    ErrorRange { raw_lower_mm, lower_mm: raw_lower_mm, ..range }
}

/// The ranges that add: of sizes and pitches one by one, of leads one for each part.
fn addends(errors: &[ExtendedError], knowledge: &Knowledge) -> Result<Vec<ErrorRange>, Open> {
    let mut ranges = Vec::with_capacity(errors.len() + 2);
    let (mut of_rack, mut of_pinion, mut lines) = (Leads::none(Part::Rack), Leads::none(Part::Pinion), None);
    for error in errors {
        match error.effect {
            Effect::Size { .. } | Effect::Pitch(_) => ranges.push(range_of(error, knowledge)?),
            Effect::RackLead { value, rack } => {
                lines = Some(rack);
                of_rack = of_rack.with(value, error.extent, lines);
            }
            Effect::PinionLead { value } => of_pinion = of_pinion.with(value, error.extent, None),
        }
    }
    ranges.push(supported(leads(&of_rack, lines.as_ref(), knowledge), knowledge));
    ranges.push(supported(leads(&of_pinion, None, knowledge), knowledge));
    Ok(ranges)
}

/// Upper ends add. Of the lower ends one is taken, all others are raw.
fn total(errors: &[ExtendedError], knowledge: &Knowledge) -> Result<Range, Open> {
    let ranges = addends(errors, knowledge)?;
    let upper: f64 = ranges.iter().map(|range| range.upper_mm).sum();
    let raw: f64 = ranges.iter().map(|range| range.raw_lower_mm).sum();
    let better = ranges.iter().map(|range| range.lower_mm - range.raw_lower_mm).fold(0.0, f64::max);
    if known(knowledge).is_some_and(|known| raw < known.reach.lower || upper > known.reach.upper) {
        return Err(Open::BeyondReach);
    }
    let own = known(knowledge).map_or(Range { lower: 0.0, upper: 0.0 }, |known| known.own);
    Ok(Range { lower: own.lower + raw + better - ROUNDING_MM, upper: own.upper + upper + ROUNDING_MM })
}

fn notes(errors: &[ExtendedError], knowledge: &Knowledge) -> Vec<Note> {
    let mut notes = Vec::new();
    let whole_teeth = |error: &ExtendedError| {
        matches!(error.effect, Effect::Pitch(_)) && matches!(error.extent, Extent::Each | Extent::All | Extent::Part)
    };
    if errors.iter().any(whole_teeth) {
        notes.push(Note::WholeTeeth);
    }
    if known(knowledge).is_some() {
        return notes;
    }
    notes.push(Note::OwnCurveUnknown);
    if !errors.is_empty() {
        notes.push(Note::GeometryNarrows);
    }
    let is_step = |error: &ExtendedError| matches!(error.effect, Effect::Pitch(_)) && error.extent == Extent::One;
    if knowledge.geometry == Geometry::Unknown && !knowledge.rolls && errors.iter().any(is_step) {
        notes.push(Note::BothFlanksNarrows);
    }
    notes.extend(errors.iter().find_map(|error| match &error.effect {
        Effect::RackLead { rack, .. } => Some(Note::AssumedHeight(assumed_height(rack, knowledge))),
        _ => None,
    }));
    notes
}

/// How far errors may move ΔCD altogether, to make a [`KnownPair`] for them: a little too much at any rate.
#[must_use]
pub fn reach(errors: &[ExtendedError], pair: &Pair) -> Range {
    /// Edges may lengthen the path of contact by this, in pitches.
    const EDGES: f64 = 2.0;
    let path = ContactPath::nominal(pair);
    let most = (path.ratio + (2.0 * path.offset).abs() + 1.0 + EDGES).floor();
    let height = pair.rack().addendum_mm.abs() + pair.pinion().tip_radius_mm;
    let mut leads = Leads::none(Part::Rack);
    let mut sum = Range { lower: 0.0, upper: 0.0 };
    for error in errors {
        let (lower, upper) = match error.effect {
            Effect::Size { value, .. } if error.extent != Extent::Each => (value.min(0.0), value.max(0.0)),
            Effect::Size { value, .. } | Effect::PinionLead { value } => (-value.abs(), value.abs()),
            Effect::Pitch(PitchEffect { value, gain, .. }) => {
                let count = if error.extent == Extent::Total { 2.0 } else { most };
                (-count * gain * value.abs(), count * gain * value.abs())
            }
            Effect::RackLead { value, rack } => {
                leads = leads.with(value, error.extent, Some(rack));
                (0.0, 0.0)
            }
        };
        sum = Range { lower: sum.lower + lower, upper: sum.upper + upper };
    }
    let lead = leads.of_any_pair(height).upper_mm;
    // a rack that rolls takes a little more
    Range { lower: (sum.lower - lead) * 1.01 - 1e-6, upper: (sum.upper + lead) * 1.01 + 1e-6 }
}
