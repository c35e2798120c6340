//! The bound of each error and of their sum. Reads what the errors do from the rooms beside it; solves no mesh.

use super::error::{Effect, PitchEffect, RackLines};
use super::field::thickness_offset;
use super::known::flanks_apart;
use super::lead::Leads;
use super::moments::{Moments, moments};
use super::pitch;
use super::{
    ContactPath, ErrorRange, ExtendedError, Extent, Geometry, Knowledge, KnownPair, KnownTeeth, Note, Open, Range,
    Reach,
};
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
    /// No bound: mean ± 3 standard deviations of ΔCD at one stroke, see [`moments`](super::moments()).
    pub statistical: Result<Range, Open>,
    /// What it rests on.
    pub notes: Vec<Note>,
}

/// Without geometry flanks are taken to touch within this many modules of the reference plane, or within this share of
/// the face width.
const MODULES_HIGH: f64 = 1.5;
const SHARE_OF_WIDTH_HIGH: f64 = 0.25;
/// Errors move points of contact over the known teeth, whose own leads and steps they then meet elsewhere: by this share
/// of what both do together. Found by trials, not proven.
const MOVED: f64 = 2e-3;
const NOTHING: Range = Range { lower: 0.0, upper: 0.0 };
/// A statistical sum reaches so many standard deviations to either side of its mean.
const DEVIATIONS: f64 = 3.0;
/// Pairs are prepared for so much more than errors need.
const SPARE_MM: f64 = 1e-6;

/// The bound of some errors: whatever teeth they are on, as their extents allow, the exact mesh stays inside it.
#[must_use]
pub fn bound(errors: &[ExtendedError], knowledge: &Knowledge) -> Bound {
    let each: Vec<_> = errors.iter().map(|error| range_of(error, knowledge)).collect();
    Bound {
        total: total(errors, knowledge),
        statistical: statistical(errors, knowledge),
        notes: notes(errors, knowledge),
        errors: each,
    }
}

/// What one error can do alone.
pub(super) fn range_of(error: &ExtendedError, knowledge: &Knowledge) -> Result<ErrorRange, Open> {
    if let Some([one, other]) = error.signs() {
        return Ok(range_of(&one, knowledge)?.or(range_of(&other, knowledge)?));
    }
    let range = match error.effect {
        Effect::Size { part, value } => size(part, value, error.extent, knowledge),
        Effect::Pitch(pitch) => pitch_range(&pitch, error.extent, knowledge)?,
        Effect::RackLead { rack, .. } => leads(&Leads::none(Part::Rack).with_error(error), Some(&rack), knowledge),
        Effect::PinionLead { .. } => leads(&Leads::none(Part::Pinion).with_error(error), None, knowledge),
    };
    Ok(supported(range, knowledge))
}

const fn known<'a>(knowledge: &Knowledge<'a>) -> Option<&'a KnownPair> {
    match knowledge.geometry {
        Geometry::Known(known) => Some(known),
        Geometry::Unknown | Geometry::BothFlanks => None,
    }
}

/// A space that sits higher by e: both its flanks carry for a while, or never.
fn size(part: Part, value: f64, extent: Extent, knowledge: &Knowledge) -> ErrorRange {
    let sometimes = ErrorRange::within(value.min(0.0), value.max(0.0));
    match (extent, known(knowledge)) {
        (Extent::All, _) => ErrorRange::signed(value),
        (Extent::Each | Extent::Total, _) => ErrorRange::either_way(value.abs()),
        (Extent::One, Some(known)) if value > 0.0 => {
            ErrorRange { upper_mm: (value - known.space_stands_back(part)).max(0.5 * value), ..sometimes }
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

fn pitch_range(pitch: &PitchEffect, extent: Extent, knowledge: &Knowledge) -> Result<ErrorRange, Open> {
    let PitchEffect { part, value, gain, teeth, cap } = *pitch;
    let known = known(knowledge);
    let teeth = teeth.or_else(|| known.map(|known| known.given.pair.pinion().teeth));
    // a pinion's deviations are measured from the mean of the turn
    let mean = if part == Part::Pinion { teeth.map_or(0.0, |teeth| 1.0 / f64::from(teeth)) } else { 0.0 };
    let total = |deviation: f64| 2.0 * gain * deviation * (1.0 - mean);
    // F_p limits either flank side, which may deviate apart
    let limit = cap.map_or(f64::INFINITY, total);
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
        raw_upper_mm: range.raw_upper_mm.min(limit),
        ..range
    })
}

fn leads(leads: &Leads, lines: Option<&RackLines>, knowledge: &Knowledge) -> ErrorRange {
    if let Some([one, other]) = leads.signs() {
        return self::leads(&one, lines, knowledge).or(self::leads(&other, lines, knowledge));
    }
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

/// What errors of both parts add up to, mm.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sum {
    raw_lower: f64,
    raw_upper: f64,
    /// The raw ends of those that sink, and of those that lift.
    sinks: f64,
    lifts: f64,
    /// How much better the lower end of one error is than its raw one, at most, and how much lower its upper end.
    better: f64,
    spared: f64,
    /// Of the pinion's errors, either way.
    of_pinion: f64,
}

impl Sum {
    /// Sizes and pitches one by one, leads one for each part.
    fn of(errors: &[ExtendedError], knowledge: &Knowledge) -> Result<Self, Open> {
        let mut sum = Self::default();
        let (mut of_rack, mut of_pinion, mut lines) = (Leads::none(Part::Rack), Leads::none(Part::Pinion), None);
        for error in errors {
            match error.effect {
                Effect::Size { .. } | Effect::Pitch(_) => sum.add(error.part(), range_of(error, knowledge)?),
                Effect::RackLead { rack, .. } => {
                    lines = Some(rack);
                    of_rack = of_rack.with_error(error);
                }
                Effect::PinionLead { .. } => of_pinion = of_pinion.with_error(error),
            }
        }
        for (part, all) in [(Part::Rack, &of_rack), (Part::Pinion, &of_pinion)] {
            sum.add(part, supported(leads(all, lines.as_ref(), knowledge), knowledge));
        }
        Ok(sum)
    }

    pub(super) fn add(&mut self, part: Part, range: ErrorRange) {
        self.sinks += range.raw_lower_mm.min(0.0);
        self.lifts += range.raw_upper_mm.max(0.0);
        self.raw_lower += range.raw_lower_mm;
        self.raw_upper += range.raw_upper_mm;
        self.better = self.better.max(range.lower_mm - range.raw_lower_mm);
        self.spared = self.spared.max(range.raw_upper_mm - range.upper_mm);
        if part == Part::Pinion {
            self.of_pinion += range.raw_upper_mm.max(-range.raw_lower_mm);
        }
    }

    fn reach(&self) -> Reach {
        let range = Range { lower: self.raw_lower, upper: self.raw_upper };
        Reach { range, of_pinion_mm: self.of_pinion }
    }

    /// Beside teeth that are known one by one, which may carry with edges anywhere: a flank that is raised by e asks for
    /// no less there, but for no more either, because its tip plane stays. So what lifts raises no lower end, what
    /// lowers no upper one. Every end is raw, and what undercut and gaps do counts once more: errors may shift them
    /// against what the known teeth do.
    fn beside(&self, teeth: KnownTeeth, knowledge: &Knowledge) -> Result<Range, Open> {
        let own = own(self, knowledge)?;
        let offset = known(knowledge).map_or(0.0, |known| thickness_offset(&known.given.pair));
        let moved = MOVED * self.reach().with(Some(teeth)).largest();
        Ok(Range {
            lower: teeth.range.lower + self.sinks + (own.lower - offset).min(0.0) - moved,
            upper: teeth.range.upper + self.lifts + (own.upper - offset).max(0.0) + moved,
        })
    }

    /// Of the lower ends one is taken, all others are raw; likewise of the upper ends.
    pub(super) fn with_own(&self, own: Range) -> Range {
        Range { lower: own.lower + self.raw_lower + self.better, upper: own.upper + self.raw_upper - self.spared }
    }
}

/// The pair's own range, if these errors are within what the pair is known for.
fn own(sum: &Sum, knowledge: &Knowledge) -> Result<Range, Open> {
    match known(knowledge) {
        Some(known) if !known.reach.holds(&sum.reach().with(knowledge.known_teeth)) => Err(Open::BeyondReach),
        Some(known) => Ok(known.own),
        None => Ok(NOTHING),
    }
}

/// What errors can do together: [`Bound::total`] alone.
pub(super) fn total(errors: &[ExtendedError], knowledge: &Knowledge) -> Result<Range, Open> {
    match knowledge.known_teeth {
        Some(teeth) if errors.is_empty() => Ok(teeth.range),
        Some(teeth) => Sum::of(errors, knowledge)?.beside(teeth, knowledge),
        None => {
            let sum = Sum::of(errors, knowledge)?;
            Ok(sum.with_own(own(&sum, knowledge)?))
        }
    }
}

/// Where ΔCD lies at one stroke for all but a few parts: [`Bound::statistical`] alone.
pub(super) fn statistical(errors: &[ExtendedError], knowledge: &Knowledge) -> Result<Range, Open> {
    let own = match knowledge.geometry {
        _ if knowledge.known_teeth.is_some() => knowledge.known_teeth.map_or(NOTHING, |teeth| teeth.range),
        Geometry::Known(_) => own(&Sum::of(errors, knowledge)?, knowledge)?,
        Geometry::Unknown | Geometry::BothFlanks => NOTHING,
    };
    let (mut mean, mut variance) = (0.0, 0.0);
    for error in errors {
        let Moments { mean_mm, deviation_mm } = moments(error, knowledge)?;
        mean += mean_mm;
        variance += deviation_mm * deviation_mm;
    }
    let spread = DEVIATIONS * variance.sqrt();
    let range = Range { lower: own.lower + mean - spread, upper: own.upper + mean + spread };
    // nothing goes beyond the worst case
    Ok(total(errors, knowledge).map_or(range, |total| Range {
        lower: range.lower.max(total.lower).min(total.upper),
        upper: range.upper.min(total.upper).max(total.lower),
    }))
}

impl KnownPair {
    /// How far these errors move ΔCD by what is known of this pair, and a little more.
    pub(super) fn reached(&self, errors: &[ExtendedError]) -> Reach {
        let knowledge = Knowledge { geometry: Geometry::Known(self), ..Knowledge::default() };
        // nothing is open where the geometry is known
        let Reach { range, of_pinion_mm } = Sum::of(errors, &knowledge).map_or(self.reach, |sum| sum.reach());
        let Range { lower, upper } = range;
        Reach {
            range: Range { lower: lower - SPARE_MM, upper: upper + SPARE_MM },
            of_pinion_mm: of_pinion_mm + SPARE_MM,
        }
    }
}

/// How far errors move ΔCD at least, whatever the pair, mm: no need to ask what is known of a pair for smaller ones.
pub(super) fn reached_at_least(errors: &[ExtendedError]) -> f64 {
    let least = |error: &ExtendedError| match error.effect {
        Effect::Size { value, .. } => value.abs(),
        Effect::Pitch(PitchEffect { value, gain, .. }) | Effect::PinionLead { value, gain } => gain * value.abs(),
        Effect::RackLead { .. } => Leads::none(Part::Rack).with_error(error).of_any_pair(0.0).upper_mm,
    };
    errors.iter().map(least).sum()
}

impl Bound {
    /// Of errors that have none.
    pub(super) fn open(errors: usize, open: Open) -> Self {
        Self { errors: vec![Err(open); errors], total: Err(open), statistical: Err(open), notes: Vec::new() }
    }
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

impl Reach {
    /// How far errors may move ΔCD: too much at any rate.
    #[must_use]
    pub fn estimated(errors: &[ExtendedError], pair: &Pair) -> Self {
        /// Edges may lengthen the path of contact by this, in pitches.
        const EDGES: f64 = 2.0;
        let path = ContactPath::nominal(pair);
        let most = (path.ratio + (2.0 * path.offset).abs() + 1.0 + EDGES).floor();
        let height = pair.rack().addendum_mm.abs() + pair.pinion().tip_radius_mm;
        let mut leads = Leads::none(Part::Rack);
        let (mut of_rack, mut of_pinion) = (0.0, 0.0);
        for error in errors {
            let either_way = match error.effect {
                Effect::Size { value, .. } => value.abs(),
                Effect::PinionLead { value, gain } => gain * value.abs(),
                Effect::Pitch(PitchEffect { value, gain, .. }) => {
                    gain * value.abs() * if error.extent == Extent::Total { 2.0 } else { most }
                }
                Effect::RackLead { .. } => {
                    leads = leads.with_error(error);
                    0.0
                }
            };
            *(if error.part() == Part::Rack { &mut of_rack } else { &mut of_pinion }) += either_way;
        }
        let all = 1.01 * (of_rack + of_pinion + leads.of_any_pair(height).upper_mm) + SPARE_MM;
        Self { range: Range { lower: -all, upper: all }, of_pinion_mm: 1.01 * of_pinion + SPARE_MM }
    }
}
