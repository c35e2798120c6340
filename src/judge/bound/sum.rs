//! The bound of each error and of their sum, from the files beside it; solves no mesh.

use super::error::ErrorEffect;
use super::field::thickness_offset;
use super::known::Own;
use super::lead::Leads;
use super::moments::Scatter;
use super::single::{assumed_height, of_leads, range_of};
use super::{
    Basis, ErrorRange, ExtendedError, Extent, GivenGeometry, Knowledge, KnownPair, KnownTeeth, NoBound, Note, OwnCurve,
    Range, Reach,
};
use crate::deviation::Part;

/// The bound of errors whose teeth are not known.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// The range of each error alone, in the order given, without the pair's own curve.
    pub errors: Vec<Result<ErrorRange, NoBound>>,
    /// The joint range of all errors.
    pub combined: Combined<Range>,
    /// What the bound assumes.
    pub notes: Vec<Note>,
}

/// The combinations of several errors, as ranges or as the nearest decimals of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Combined<T> {
    /// The worst case: the joint range of all errors, with the pair's own curve.
    pub range: Result<T, NoBound>,
    /// The statistical combination, which is no bound: tolerances at one stroke, as three standard deviations of each, around the
    /// bound of what was measured.
    pub rss: Result<T, NoBound>,
}

/// Errors move points of contact over the known teeth and so change the effect of their leads and steps: by this share of the
/// joint effect. Found by trials, not proven.
const MOVED: f64 = 2e-3;
/// Pairs are prepared for so much more than the errors need.
const SPARE_MM: f64 = 1e-6;

/// The bound of some errors: on whatever teeth their extents allow, the exact mesh stays inside it.
pub(super) fn bound(errors: &[ExtendedError], knowledge: &Knowledge) -> Bound {
    let combined = together(errors, knowledge);
    let each = errors.iter().map(|error| range_of(error, knowledge)).collect();
    let needs_geometry = combined.range == Err(NoBound::TeethInContactUnknown);
    Bound { errors: each, combined, notes: notes(errors, knowledge, needs_geometry) }
}

/// The sums of errors of both parts, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sum {
    pub(super) raw_lower: f64,
    pub(super) raw_upper: f64,
    /// The raw ends of errors that sink, and of errors that lift.
    sinks: f64,
    lifts: f64,
    /// The most by which the lower end of one error is above its raw one, and its upper end below its raw one.
    pub(super) better: f64,
    spared: f64,
    /// The most by which the upper end of one error, with what undercut lifts at the same stroke, is below its raw end without
    /// undercut.
    spared_with_undercut: f64,
    /// How far the pinion's errors move ΔCD either way.
    of_pinion: f64,
    /// The raw upper end of the pinion's errors, without signs: how far these shift flanks that lift.
    pinion_lifts: f64,
}

impl Default for Sum {
    /// The sums of no errors.
    fn default() -> Self {
        Self {
            raw_lower: 0.0,
            raw_upper: 0.0,
            sinks: 0.0,
            lifts: 0.0,
            better: 0.0,
            spared: 0.0,
            spared_with_undercut: f64::NEG_INFINITY,
            of_pinion: 0.0,
            pinion_lifts: 0.0,
        }
    }
}

impl Sum {
    /// The sums of some errors. Several leads of a part are added as angles.
    #[inline]
    fn of(errors: &[ExtendedError], knowledge: &Knowledge) -> Result<Self, NoBound> {
        let several = parts_with_several_leads(errors);
        let (mut sum, mut is_open) = (Self::default(), Ok(()));
        for error in errors {
            match range_of(error, knowledge) {
                Ok(_) if error.effect.is_lead() && several[error.part as usize] => {}
                Ok(range) => sum.add(error.part, range),
                Err(open) => is_open = is_open.and(Err(open)),
            }
        }
        for part in [Part::Rack, Part::Pinion].into_iter().filter(|part| several[*part as usize]) {
            let of_part = errors.iter().filter(|error| error.part == part);
            sum.add(part, of_leads(&of_part.fold(Leads::none(part), Leads::with), knowledge));
        }
        is_open.map(|()| sum)
    }

    #[inline]
    pub(super) fn add(&mut self, part: Part, range: ErrorRange) {
        self.sinks += range.raw_lower_mm.min(0.0);
        self.lifts += range.raw_upper_mm.max(0.0);
        self.raw_lower += range.raw_lower_mm;
        self.raw_upper += range.raw_upper_mm;
        self.better = larger(self.better, range.lower_mm - range.raw_lower_mm);
        self.spared = larger(self.spared, range.raw_upper_mm - range.upper_mm);
        self.spared_with_undercut =
            larger(self.spared_with_undercut, range.raw_upper_mm - range.upper_with_undercut_mm);
        if part == Part::Pinion {
            self.of_pinion += range.raw_upper_mm.max(-range.raw_lower_mm);
            self.pinion_lifts += range.raw_upper_mm.abs();
        }
    }

    fn reach(&self) -> Reach {
        let range = Range { lower: self.raw_lower, upper: self.raw_upper };
        Reach { range, of_pinion_mm: self.of_pinion }
    }

    /// The range beside teeth that are known one by one, which may carry with edges anywhere. A flank that is raised by e asks
    /// for no less there, but perhaps for no more either, because its tip plane stays. So an error that lifts raises no lower
    /// end, and one that lowers lowers no upper end. Every end is raw, and undercut and gaps count once more, because errors
    /// may shift them against the known teeth.
    fn beside(&self, teeth: KnownTeeth, own: Own, knowledge: &Knowledge) -> Range {
        let offset = knowledge.pair.map_or(0.0, |known| thickness_offset(&known.given.pair));
        let moved = MOVED * self.reach().with(Some(teeth)).largest();
        Range {
            lower: teeth.range.lower + self.sinks + (own.range.lower - offset).min(0.0) - moved,
            upper: teeth.range.upper + self.lifts + (own.upper_of_sunk_flanks - offset).max(0.0) + moved,
        }
    }

    /// The range around the known teeth, or around the pair's own curve.
    fn around(&self, own: Own, knowledge: &Knowledge) -> Range {
        knowledge.basis.known_teeth.map_or_else(|| self.with_own(own), |teeth| self.beside(teeth, own, knowledge))
    }

    /// The range in which one lower end is not raw and all others are; likewise for the upper ends. Flanks that sink ask for no
    /// more than without errors, and for less only if the rack's tips, which stay, do not carry in their place.
    #[inline]
    pub(super) fn with_own(&self, own: Own) -> Range {
        let lifted = self.raw_upper - self.spared;
        let own_upper = if self.pinion_lifts == 0.0 { own.unshifted_upper } else { own.range.upper };
        let at_one_stroke = own.of_lines + self.raw_upper - self.spared_with_undercut;
        let lower = own.range.lower + self.raw_lower + self.better;
        let upper =
            (own_upper + lifted.max(0.0)).min(own.upper_of_sunk_flanks + lifted).min(own_upper.max(at_one_stroke));
        Range { lower: lower.min(upper), upper: upper.max(lower) }
    }
}

/// The larger of two numbers, neither of which is NaN.
#[inline]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The pair's own range, if these errors are within the reach of what is known.
pub(super) fn own(sum: &Sum, knowledge: &Knowledge) -> Result<Own, NoBound> {
    match knowledge.pair {
        Some(known) if !known.reach.holds(&sum.reach().with(knowledge.basis.known_teeth)) => Err(NoBound::BeyondReach),
        Some(known) => Ok(known.own),
        None => match knowledge.basis.own_curve {
            OwnCurve::At(delta_cd_mm) => Ok(Own::at(delta_cd_mm)),
            OwnCurve::Unknown => Err(NoBound::OwnCurveUnknown),
        },
    }
}

/// The joint range of errors.
pub(super) fn together(errors: &[ExtendedError], knowledge: &Knowledge) -> Combined<Range> {
    let sum = Sum::of(errors, knowledge);
    let own = sum.and_then(|sum| own(&sum, knowledge));
    let range = match knowledge.basis.known_teeth {
        Some(teeth) if !teeth.solved || errors.is_empty() => teeth.alone(),
        _ => sum.and_then(|sum| Ok(sum.around(own?, knowledge))),
    };
    let rss = if errors.iter().any(ExtendedError::scatters) {
        range.and_then(|range| statistical(errors, knowledge, own?, range))
    } else {
        Err(NoBound::NothingScatters)
    };
    Combined { range, rss }
}

/// The range of ΔCD at one stroke for all but a few parts: the scatter, around the bound of what was measured and the curve of
/// the pair. It never exceeds the worst case.
fn statistical(errors: &[ExtendedError], knowledge: &Knowledge, own: Own, worst: Range) -> Result<Range, NoBound> {
    let (mut scattered, mut measured): (Vec<_>, Vec<_>) = errors.iter().copied().partition(ExtendedError::scatters);
    for error in &mut scattered {
        if let Some([middle, half]) = error.split() {
            measured.push(middle);
            *error = half;
        }
    }
    let own = Own { unshifted_upper: own.range.upper, ..own };
    let measured = Sum::of(&measured, knowledge)?.around(own, knowledge);
    let scatter = scattered.iter().try_fold(Scatter::default(), |sum, error| sum.with(error, knowledge))?.range();
    Ok(Range {
        lower: (measured.lower + scatter.lower).max(worst.lower).min(worst.upper),
        upper: (measured.upper + scatter.upper).min(worst.upper).max(worst.lower),
    })
}

impl KnownPair {
    /// How far these errors move ΔCD by what is known of this pair, with a small reserve.
    pub(super) fn reached(&self, errors: &[ExtendedError]) -> Reach {
        let knowledge = Knowledge { basis: &Basis::default(), pair: Some(self) };
        // no range is open where the geometry is known
        let Reach { range, of_pinion_mm } = Sum::of(errors, &knowledge).map_or(self.reach, |sum| sum.reach());
        let Range { lower, upper } = range;
        Reach {
            range: Range { lower: lower - SPARE_MM, upper: upper + SPARE_MM },
            of_pinion_mm: of_pinion_mm + SPARE_MM,
        }
    }
}

/// The least by which errors move ΔCD whatever the pair, mm: a pair need not be prepared for less.
pub(super) fn reached_at_least(errors: &[ExtendedError]) -> f64 {
    let least = |error: &ExtendedError| match error.effect {
        ErrorEffect::Size => error.value.abs(),
        ErrorEffect::Pitch { gain, .. } | ErrorEffect::PinionLead { gain } => gain * error.value.abs(),
        ErrorEffect::RackLead(_) => Leads::none(Part::Rack).with(error).of_any_pair(0.0).upper_mm,
    };
    errors.iter().map(least).sum()
}

impl Bound {
    /// The range of known teeth without errors: the exact mesh itself, so nothing else of the pair need be known.
    pub(super) fn of_known(teeth: KnownTeeth) -> Self {
        let combined = Combined { range: teeth.alone(), rss: Err(NoBound::NothingScatters) };
        Self { errors: Vec::new(), combined, notes: Vec::new() }
    }

    /// The combination of errors without a bound.
    pub(super) fn open(errors: usize, open: NoBound) -> Self {
        let combined = Combined { range: Err(open), rss: Err(open) };
        Self { errors: vec![Err(open); errors], combined, notes: Vec::new() }
    }
}

/// Whether each part has more than one lead.
pub(super) fn parts_with_several_leads(errors: &[ExtendedError]) -> [bool; 2] {
    let mut leads = [0_usize; 2];
    for error in errors.iter().filter(|error| error.effect.is_lead()) {
        leads[error.part as usize] += 1;
    }
    leads.map(|count| count > 1)
}

fn is_pitch(error: &ExtendedError) -> bool {
    matches!(error.effect, ErrorEffect::Pitch { .. })
}

fn notes(errors: &[ExtendedError], knowledge: &Knowledge, needs_geometry: bool) -> Vec<Note> {
    let mut notes = Vec::new();
    if let Some(teeth) = knowledge.basis.known_teeth.filter(|teeth| teeth.solved && !errors.is_empty()) {
        notes.push(Note::KnownTeeth(teeth.range));
    }
    let whole_teeth =
        |error: &ExtendedError| is_pitch(error) && matches!(error.extent, Extent::Each | Extent::All | Extent::Part);
    if errors.iter().any(whole_teeth) {
        notes.push(Note::WholeTeeth);
    }
    if let Some(known) = knowledge.pair {
        let counts = knowledge.basis.known_teeth.is_none() && known.own.range != Range::default();
        notes.extend(counts.then_some(Note::OwnRange(known.own.range)));
        return notes;
    }
    match knowledge.basis.own_curve {
        OwnCurve::At(delta_cd_mm) => notes.push(Note::OwnCurveAt(delta_cd_mm)),
        OwnCurve::Unknown => {
            notes.push(Note::GeometryNeeded);
            return notes;
        }
    }
    // what moves all teeth alike has one ΔCD, whatever the pair
    let is_placed = |error: &ExtendedError| !matches!(error.effect, ErrorEffect::Size) || error.extent != Extent::All;
    if needs_geometry && !errors.is_empty() {
        notes.push(Note::GeometryNeeded);
    } else if errors.iter().any(is_placed) {
        notes.push(Note::GeometryNarrows);
    }
    if matches!(knowledge.basis.geometry, GivenGeometry::Unknown)
        && !knowledge.rolls()
        && errors.iter().any(|error| is_pitch(error) && error.extent == Extent::One)
    {
        notes.push(Note::BothFlanksNarrows);
    }
    notes.extend(errors.iter().find_map(|error| match &error.effect {
        ErrorEffect::RackLead(rack) => Some(Note::AssumedHeight(assumed_height(rack, knowledge))),
        _ => None,
    }));
    notes
}
