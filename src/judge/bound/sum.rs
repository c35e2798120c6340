//! The bound of each error and of their sum. Reads what the errors do from the rooms beside it; solves no mesh.

use super::error::{Effect, RackLines};
use super::lead::{self, Place};
use super::pitch::Steps;
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
    Bound { total: total(errors, &each, knowledge), notes: notes(errors, knowledge), errors: each }
}

/// What one error can do alone.
fn range_of(error: &ExtendedError, knowledge: &Knowledge) -> Result<ErrorRange, Open> {
    let range = match error.effect {
        Effect::Size { part, value } => size(part, value, error.extent, knowledge),
        Effect::Pitch { part, value, gain, teeth, cap } => {
            let step = gain * value.abs();
            let teeth = teeth.or_else(|| known(knowledge).map(|known| known.given.pair.pinion().teeth));
            let mean = if part == Part::Pinion { teeth.map_or(0.0, |teeth| 1.0 / f64::from(teeth)) } else { 0.0 };
            let total = |deviation: f64| 2.0 * gain * deviation * (1.0 - mean);
            let capped = cap.map(total);
            match (error.extent, steps(part, value, step, error.extent, knowledge)) {
                (Extent::Total, _) => either_way(total(value.abs()).min(capped.unwrap_or(f64::INFINITY))),
                (_, Some(steps)) => {
                    let limit = capped.unwrap_or(f64::INFINITY);
                    let [raw_lower_mm, lower_mm, upper_mm] = [steps.raw, steps.lower, steps.upper]
                        .map(|count| (f64::from(count) * step).clamp(-limit, limit));
                    ErrorRange { raw_lower_mm, lower_mm, upper_mm }
                }
                (_, None) => either_way(capped.ok_or(Open::TeethInContactUnknown)?),
            }
        }
        Effect::RackLead { value, rack } => {
            lead::rack(lead::values(value, error.extent), &rack, &place(&rack, knowledge))
        }
        Effect::PinionLead { value } => pinion_lead(lead::values(value, error.extent), knowledge),
    };
    Ok(supported(range, knowledge))
}

const fn known<'a>(knowledge: &Knowledge<'a>) -> Option<&'a KnownPair> {
    match knowledge.geometry {
        Geometry::Known(known) => Some(known),
        Geometry::Unknown | Geometry::BothFlanks => None,
    }
}

/// The path on which lines always carry on both sides; `None` where there is none, or form or roll keeps flanks from it.
fn line_path<'a>(knowledge: &Knowledge<'a>) -> Option<&'a KnownPair> {
    known(knowledge).filter(|known| known.carries_lines())
}

fn either_way(upper_mm: f64) -> ErrorRange {
    ErrorRange { raw_lower_mm: -upper_mm, lower_mm: -upper_mm, upper_mm }
}

/// A space that sits higher by e: its right flank carries around the stroke c, its left one half a pitch or a whole one
/// further on, so that both do for a while, or never.
fn size(part: Part, value: f64, extent: Extent, knowledge: &Knowledge) -> ErrorRange {
    let apart = |offset: f64| match part {
        Part::Rack => (1.0 - 2.0 * offset).abs(),
        Part::Pinion => (2.0 * offset).abs(),
    };
    match extent {
        Extent::All => ErrorRange { raw_lower_mm: value, lower_mm: value, upper_mm: value },
        Extent::Each | Extent::Total => either_way(value.abs()),
        Extent::Part => ErrorRange { raw_lower_mm: value.min(0.0), lower_mm: value.min(0.0), upper_mm: value.max(0.0) },
        Extent::One if value > 0.0 => {
            let meets = known(knowledge).is_none_or(|known| {
                let path = known.lengthened(value);
                path.ratio > apart(path.offset)
            });
            ErrorRange { raw_lower_mm: 0.0, lower_mm: 0.0, upper_mm: if meets { value } else { 0.5 * value } }
        }
        Extent::One => {
            let alone = line_path(knowledge).map_or(1.0, |known| {
                let path = known.line;
                if path.ratio + apart(path.offset) < 2.0 {
                    1.0
                } else if path.ratio < 2.0 {
                    0.5
                } else {
                    0.0
                }
            });
            ErrorRange { raw_lower_mm: value, lower_mm: alone * value, upper_mm: 0.0 }
        }
    }
}

/// How often a step counts; `None` if that is not known.
fn steps(part: Part, value: f64, step: f64, extent: Extent, knowledge: &Knowledge) -> Option<Steps> {
    if let Some(known) = known(knowledge) {
        let line = line_path(knowledge).map(|known| &known.line);
        return Some(Steps::new(part, extent, value >= 0.0, line, &known.lengthened(2.0 * step)));
    }
    let both = knowledge.geometry == Geometry::BothFlanks && !knowledge.rolls;
    (extent == Extent::One).then(|| Steps::of_one(both))
}

/// Where the rack's flanks touch, as far as it is known.
fn place(rack: &RackLines, knowledge: &Knowledge) -> Place {
    if let Some(known) = known(knowledge) {
        let carrying = known.rack_sections;
        return Place { half_width: known.half_widths().rack, carrying, heights: known.heights() };
    }
    let height = assumed_height(rack, knowledge);
    Place { half_width: 0.5 * rack.face_width, carrying: None, heights: Range { lower: -height, upper: height } }
}

fn assumed_height(rack: &RackLines, knowledge: &Knowledge) -> f64 {
    knowledge.normal_module_mm.map_or(SHARE_OF_WIDTH_HIGH * rack.face_width, |module| MODULES_HIGH * module)
}

fn pinion_lead(values: Range, knowledge: &Knowledge) -> ErrorRange {
    let Some(known) = known(knowledge) else { return lead::pinion(values, 1.0, None) };
    let half_face = 0.5 * known.given.pair.pinion().face_width_mm;
    let carrying = known.pinion_sections.map(|half| half / half_face);
    lead::pinion(values, known.half_widths().pinion / half_face, carrying)
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

/// Upper ends add. Of the lower ends one is taken, all others are raw.
fn total(errors: &[ExtendedError], each: &[Result<ErrorRange, Open>], knowledge: &Knowledge) -> Result<Range, Open> {
    let mut ranges = Vec::with_capacity(errors.len());
    let (mut rack_leads, mut pinion_leads) = (Range { lower: 0.0, upper: 0.0 }, Range { lower: 0.0, upper: 0.0 });
    let mut lines = None;
    for (error, range) in errors.iter().zip(each) {
        let sum = match error.effect {
            Effect::RackLead { rack, .. } => {
                lines = Some(rack);
                &mut rack_leads
            }
            Effect::PinionLead { .. } => &mut pinion_leads,
            Effect::Size { .. } | Effect::Pitch { .. } => {
                ranges.push((*range)?);
                continue;
            }
        };
        let (Effect::RackLead { value, .. } | Effect::PinionLead { value }) = error.effect else { continue };
        let values = lead::values(value, error.extent);
        *sum = Range { lower: sum.lower + values.lower, upper: sum.upper + values.upper };
    }
    if let Some(lines) = lines {
        ranges.push(supported(lead::rack(rack_leads, &lines, &place(&lines, knowledge)), knowledge));
    }
    ranges.push(supported(pinion_lead(pinion_leads, knowledge), knowledge));
    let own = known(knowledge).map_or(Range { lower: 0.0, upper: 0.0 }, |known| known.own);
    let upper: f64 = ranges.iter().map(|range| range.upper_mm).sum();
    let raw: f64 = ranges.iter().map(|range| range.raw_lower_mm).sum();
    let better = ranges.iter().map(|range| range.lower_mm - range.raw_lower_mm).fold(0.0, f64::max);
    let magnitude: f64 = ranges.iter().map(|range| range.raw_lower_mm.abs().max(range.upper_mm.abs())).sum();
    if known(knowledge).is_some_and(|known| magnitude > known.reach) {
        return Err(Open::BeyondReach);
    }
    Ok(Range { lower: own.lower + raw + better - ROUNDING_MM, upper: own.upper + upper + ROUNDING_MM })
}

fn notes(errors: &[ExtendedError], knowledge: &Knowledge) -> Vec<Note> {
    let mut notes = Vec::new();
    let whole_teeth = |error: &ExtendedError| {
        matches!(error.effect, Effect::Pitch { .. }) && matches!(error.extent, Extent::Each | Extent::All | Extent::Part)
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
    let is_step = |error: &ExtendedError| matches!(error.effect, Effect::Pitch { .. }) && error.extent == Extent::One;
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
pub fn reach_mm(errors: &[ExtendedError], pair: &Pair) -> f64 {
    /// Edges may lengthen the path of contact by this, in pitches.
    const EDGES: f64 = 2.0;
    let path = ContactPath::nominal(pair);
    let most = (path.ratio + (2.0 * path.offset).abs() + 1.0 + EDGES).floor();
    let height = pair.rack().addendum_mm.abs() + pair.pinion().tip_radius_mm;
    let heights = Range { lower: -height, upper: height };
    let mut angles = Range { lower: 0.0, upper: 0.0 };
    let mut lines = None;
    let mut sum = 0.0;
    for error in errors {
        sum += match error.effect {
            Effect::Size { value, .. } | Effect::PinionLead { value } => value.abs(),
            Effect::Pitch { value, gain, .. } => {
                gain * value.abs() * if error.extent == Extent::Total { 2.0 } else { most }
            }
            Effect::RackLead { value, rack } => {
                let values = lead::values(value, error.extent);
                angles = Range { lower: angles.lower + values.lower, upper: angles.upper + values.upper };
                lines = Some(rack);
                0.0
            }
        };
    }
    if let Some(lines) = lines {
        let place = Place { half_width: 0.5 * pair.rack().face_width_mm, carrying: None, heights };
        let range = lead::rack(angles, &lines, &place);
        sum += range.upper_mm.max(-range.raw_lower_mm);
    }
    // a rack that rolls takes a little more
    sum / trig::cos(LARGEST_ROLL_RAD) + 1e-9
}
