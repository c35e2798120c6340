//! The effect of turned tooth lines. The leads of all errors of a part are first added as angles. A turn moves a flank at
//! each point by a linear function of the point's place; the field of contact says which points there are at a stroke. The
//! bound reads it; it knows no other error.

use super::error::{ErrorEffect, RackLines};
use super::field::{Field, Spot, line_distance, shift_rad};
use super::lead_tables::{LeadDemand, NODES_A_SIDE};
use super::levels::Level;
use super::profile::{Profile, Rolls};
use super::undercut::{CELLS, Cell, UndercutTable};
use super::{ErrorRange, ExtendedError, Extent, KnownPair, Range};
use crate::deviation::Part;
use crate::trig;

/// What a turned flank asks for, in mm of ΔCD: a share of the place across the rack, of the height, and of the place
/// along the pinion's axis.
#[derive(Debug, Clone, Copy)]
pub(in crate::judge) struct Slopes {
    across: f64,
    up: f64,
    along: f64,
}

/// The leads of all errors of one part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leads {
    pub(super) part: Part,
    /// Angles of the rack, or ΔCD of a pinion's lead over its whole face.
    values: Range,
    pub(super) lines: Option<RackLines>,
    /// Whether the leads are on one tooth only.
    one_tooth: bool,
    /// The extent, where there is only one lead.
    pub(super) extent: Option<Extent>,
    /// The only lead, if its sign is not known.
    unsigned: Option<ExtendedError>,
}

/// Cosines of turned tooth lines are not taken to be smaller.
const SMALLEST_COSINE: f64 = 0.1;
/// Parts of a cell's roll angles in which undercut is looked at.
const STRIPS: i32 = 8;

/// Which extreme of the flanks that carry is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LeadEnd {
    /// The most that they ask for.
    Upper,
    /// The most that they ask for, with what undercut lifts them beyond their lines.
    UpperWithUndercut,
    /// The most that they give way.
    Lower,
}

impl LeadEnd {
    fn sign(self) -> f64 {
        match self {
            Self::Upper | Self::UpperWithUndercut => 1.0,
            Self::Lower => -1.0,
        }
    }
}

impl Leads {
    /// A part without a lead.
    pub(super) fn none(part: Part) -> Self {
        Self {
            part,
            values: Range { lower: 0.0, upper: 0.0 },
            lines: None,
            one_tooth: true,
            extent: None,
            unsigned: None,
        }
    }

    /// Adds one more error of the part. An error that is no lead adds nothing; the rack's tooth lines are those of the last lead.
    /// Beside other leads, a lead whose sign is not known counts as if every tooth had its own.
    #[inline]
    pub(super) fn with(self, error: &ExtendedError) -> Self {
        let is_first = self.values.lower == 0.0 && self.values.upper == 0.0;
        let extent = if error.either_sign { Extent::Each } else { error.extent };
        let leads = match error.effect {
            ErrorEffect::RackLead(rack) => self.with_values(values_of(error, 1.0), extent, Some(rack)),
            ErrorEffect::PinionLead { gain } => self.with_values(values_of(error, gain), extent, None),
            ErrorEffect::Size | ErrorEffect::Pitch { .. } => return self,
        };
        // the table of leads has symmetric tolerances only
        let extent = leads.extent.filter(|_| error.nearer_end.is_none());
        Self { unsigned: (is_first && error.either_sign).then_some(*error), extent, ..leads }
    }

    /// The only lead with either sign, if its sign is not known.
    pub(super) fn signs(&self) -> Option<[Self; 2]> {
        Some(self.unsigned?.signs()?.map(|error| Self::none(self.part).with(&error)))
    }

    fn with_values(mut self, added: Range, extent: Extent, lines: Option<RackLines>) -> Self {
        let is_first = self.values.lower == 0.0 && self.values.upper == 0.0;
        self.one_tooth = is_first && extent == Extent::One;
        self.extent = is_first.then_some(extent);
        self.values = Range { lower: self.values.lower + added.lower, upper: self.values.upper + added.upper };
        self.lines = lines;
        self
    }

    fn candidates(&self) -> [f64; 4] {
        candidates(self.values, self.lines.as_ref())
    }

    /// What flanks turned by a value ask for; `half_face` is half the pinion's face width.
    fn turned(&self, value: f64, half_face: f64) -> Slopes {
        self.lines.map_or_else(
            || Slopes::of_pinion(value, half_face),
            |lines| Slopes::of_rack(value, lines.tan_alpha, lines.helix),
        )
    }

    /// The range of the leads for any pair whose flanks touch up to this height over and under the reference plane.
    pub(super) fn of_any_pair(&self, height: f64) -> ErrorRange {
        of_any_pair(self.values, self.lines.as_ref(), height)
    }

    /// The range of the leads for a pair.
    pub(super) fn of_pair(&self, known: &KnownPair) -> ErrorRange {
        if self.values.lower == 0.0 && self.values.upper == 0.0 {
            return ErrorRange::either_way(0.0);
        }
        let LeadDemand { most: upper_mm, with_undercut: upper_with_undercut_mm, gives_way, at_any_time } =
            self.asked(known);
        let raw_lower_mm = -if known.carries_lines() {
            gives_way
        } else if known.given.rolls() {
            at_any_time
        } else {
            self.at_any_time(known, known.levels.level(2.0 * known.gap()))
        };
        let lower_mm = self.kept(known).unwrap_or(raw_lower_mm).max(raw_lower_mm);
        let raw_upper_mm = at_any_time.max(upper_mm);
        ErrorRange { raw_lower_mm, lower_mm, upper_mm, raw_upper_mm, upper_with_undercut_mm, in_contact: 0 }
    }

    /// What a single lead asks for, from the nodes on either side of it. The bound is convex in the slopes of flanks, so its chord
    /// holds it; the curvature of the slopes between two nodes is added. Several leads are computed themselves.
    fn asked(&self, known: &KnownPair) -> LeadDemand {
        let Some(extent) = self.extent else { return self.asked_itself(known) };
        let value =
            if extent == Extent::Each || self.values.upper > 0.0 { self.values.upper } else { self.values.lower };
        // tooth lines that are drawn or varied differ from the pair's: take the lead with the same gain
        let of_pair = RackLines::of_pair(&known.given.pair).gain();
        let value = value * self.lines.map_or(1.0, |lines| lines.gain() / of_pair);
        let spacing = known.leads.spacing[self.part as usize];
        let place = value / spacing;
        if place.abs() >= f64::from(NODES_A_SIDE) {
            return self.asked_itself(known);
        }
        let below = place.floor() as i32;
        let share = place - f64::from(below);
        let (a, b) = (self.node(known, extent, below), self.node(known, extent, below + 1));
        let bend = self.bend(known, (f64::from(below) * spacing).abs().max((f64::from(below + 1) * spacing).abs()));
        let bent = bend * spacing * spacing / 8.0;
        let between = |a: f64, b: f64| a + share * (b - a) + bent;
        LeadDemand {
            most: between(a.most, b.most),
            with_undercut: if known.undercut.is_some() {
                between(a.with_undercut, b.with_undercut)
            } else {
                f64::INFINITY
            },
            gives_way: between(a.gives_way, b.gives_way),
            at_any_time: between(a.at_any_time, b.at_any_time),
        }
    }

    /// A node of the table, computed when it is first needed.
    fn node(&self, known: &KnownPair, extent: Extent, index: i32) -> LeadDemand {
        let value = f64::from(index) * known.leads.spacing[self.part as usize];
        let lines = self.lines.map(|_| RackLines::of_pair(&known.given.pair));
        *known
            .leads
            .node(self.part, extent, index)
            .get_or_init(|| Self::none(self.part).with_values(within(value, extent), extent, lines).asked_itself(known))
    }

    /// Upper bound of the curvature of the slopes of flanks turned by up to this angle, in mm of ΔCD per rad².
    fn bend(&self, known: &KnownPair, turned: f64) -> f64 {
        let Some(lines) = self.lines else { return 0.0 };
        // the second derivatives of sin D / (cos(β + D) t) and tan(β + D) sin D − (1 − cos D), with sines of at most 1
        let cos = trig::cos(lines.helix.abs() + turned).max(SMALLEST_COSINE);
        let (across, up) = (4.0 / (cos * cos * cos * lines.tan_alpha), 5.0 / (cos * cos * cos));
        let pair = &known.given.pair;
        let height = pair.rack().addendum_mm.abs() + pair.pinion().tip_radius_mm;
        across * 0.5 * pair.rack().face_width_mm + up * height
    }

    fn asked_itself(&self, known: &KnownPair) -> LeadDemand {
        let most = |sought| self.most(known, sought);
        LeadDemand {
            most: most(LeadEnd::Upper),
            with_undercut: if known.undercut.is_some() { most(LeadEnd::UpperWithUndercut) } else { f64::INFINITY },
            gives_way: if known.carries_lines() { most(LeadEnd::Lower) } else { 0.0 },
            at_any_time: self.at_any_time(known, known.levels.last()),
        }
    }

    /// The most that both sides ask for, or give way, at any one stroke.
    fn most(&self, known: &KnownPair, sought: LeadEnd) -> f64 {
        let cells = self.cells(known, sought);
        let same_time = at_same_time(&cells);
        // the demand of teeth that are not turned
        let of_others = match sought {
            LeadEnd::UpperWithUndercut if self.one_tooth => at_same_time(&Self::none(self.part).cells(known, sought)),
            _ => [0.0; CELLS as usize],
        };
        let at = |index: i32| {
            if self.one_tooth {
                let turned = cells.iter().find(|cell| cell.index == index);
                turned.map_or(f64::NEG_INFINITY, |cell| cell.most).max(of_others[time(index)])
            } else {
                same_time[time(index)]
            }
        };
        // a left flank is a right one turned half about: of the same rack tooth, or of the same pinion tooth a pitch further
        let turn = if self.one_tooth && self.part == Part::Pinion { CELLS } else { 0 };
        let sums = cells.iter().map(|cell| 0.5 * (at(cell.index) + at(turn - cell.index - 1)));
        let most = sums.fold(f64::NEG_INFINITY, f64::max);
        if most.is_finite() { most } else { self.at_any_time(known, known.levels.last()) }
    }

    /// The most that a right flank asks for in each part of its path.
    pub(super) fn cells(&self, known: &KnownPair, sought: LeadEnd) -> Vec<Cell> {
        let last = known.levels.last();
        let (start, end) = (last.path.offset - 0.5 * last.path.ratio, last.path.offset + 0.5 * last.path.ratio);
        let mut candidates = self.candidates().to_vec();
        candidates.dedup();
        let turns: Vec<_> = candidates.into_iter().map(|value| self.turned(value, half_face(known))).collect();
        let most = self.at_any_time(known, last);
        let cell = |index: i32| Range {
            lower: f64::from(index) / f64::from(CELLS),
            upper: f64::from(index + 1) / f64::from(CELLS),
        };
        let (first, last) = ((start * f64::from(CELLS)).floor() as i32, (end * f64::from(CELLS)).ceil() as i32);
        let cells = (first..last).map(|index| {
            let mut found = f64::NEG_INFINITY;
            // a point off the contact line asks for less by what it stands back
            let mut stands_back = 0.0;
            for level in known.levels.iter() {
                if most - stands_back < found {
                    break;
                }
                let field = level.field.between(cell(index));
                if sought == LeadEnd::UpperWithUndercut && stands_back == 0.0 {
                    found = turns.iter().map(|turned| turned.beyond_lines(known, &field)).fold(found, f64::max);
                    stands_back = level.error;
                    continue;
                }
                for turned in &turns {
                    let loose = turned.loose(known, level.off_line);
                    let range = field.extremes(|spot| sought.sign() * turned.at(spot));
                    let asked = range.map(|range| (range.upper + loose).min(turned.at_most(known, level)));
                    found = found.max(asked.map_or(f64::NEG_INFINITY, |asked| asked - stands_back));
                }
                stands_back = level.error;
            }
            Cell { index, most: found }
        });
        cells.collect()
    }

    /// The most that the leads ask for or give way anywhere on the flanks.
    fn at_any_time(&self, known: &KnownPair, level: &Level) -> f64 {
        let asked = self.candidates().map(|value| {
            let turned = self.turned(value, half_face(known));
            let loose = turned.loose(known, level.off_line);
            // the demand of an empty field is not known
            let range = level.field.extremes(|spot| turned.at(spot));
            range.map_or(f64::INFINITY, |range| {
                (range.upper.max(-range.lower) + loose).min(turned.at_most(known, level))
            })
        });
        asked.into_iter().fold(0.0, f64::max)
    }

    /// The least that the leads hold up: where sections always carry, both sides touch at the ends of the sections at every
    /// stroke.
    fn kept(&self, known: &KnownPair) -> Option<f64> {
        let half = match self.part {
            Part::Rack => known.rack_sections?,
            Part::Pinion => known.pinion_sections?,
        };
        let one_hand = self.values.lower * self.values.upper > 0.0;
        let heights = known.levels.last().field.extremes(|spot| spot.z)?;
        let kept = self.candidates().map(|value| {
            let turned = self.turned(value, half_face(known));
            let at_ends = if one_hand { half * (turned.across.abs() + turned.along.abs()) } else { 0.0 };
            let by_height = (turned.up * heights.lower).min(turned.up * heights.upper);
            at_ends + by_height - turned.up.abs() * known.reach.largest()
        });
        kept.into_iter().reduce(f64::min)
    }
}

/// The range of turns of a lead, so many times; 0 for teeth that it is not on.
#[inline]
pub(super) fn values_of(error: &ExtendedError, gain: f64) -> Range {
    if error.nearer_end.is_none() && !error.either_sign {
        return within(gain * error.value, error.extent);
    }
    let [lower, upper] = error.ends().map(|end| gain * end);
    match error.extent {
        Extent::One | Extent::Part => Range { lower: lower.min(0.0), upper: upper.max(0.0) },
        Extent::All | Extent::Each | Extent::Total => Range { lower, upper },
    }
}

/// The range of turns of a lead of this value and extent.
#[inline]
fn within(value: f64, extent: Extent) -> Range {
    match extent {
        Extent::All => Range { lower: value, upper: value },
        Extent::Each => Range { lower: -value.abs(), upper: value.abs() },
        Extent::One | Extent::Part | Extent::Total => Range { lower: value.min(0.0), upper: value.max(0.0) },
    }
}

/// The values at which a flank's demand can be extreme: both ends, 0, and the turn that brings a rack's tooth line across
/// the rack, where heights count least.
fn candidates(values: Range, lines: Option<&RackLines>) -> [f64; 4] {
    let Range { lower, upper } = values;
    let level = lines.map_or(lower, |lines| -lines.helix);
    [lower, upper, 0.0_f64.clamp(lower, upper), level.clamp(lower, upper)]
}

/// The effect of leads of these values on any pair whose flanks touch up to this height over and under the reference plane.
pub(super) fn of_any_pair(values: Range, lines: Option<&RackLines>, height: f64) -> ErrorRange {
    ErrorRange::either_way(most_of_any_pair(values, lines, height))
}

/// How far the leads move ΔCD either way, mm.
#[inline]
pub(super) fn most_of_any_pair(values: Range, lines: Option<&RackLines>, height: f64) -> f64 {
    let asked = |value: f64| match lines {
        None => value.abs(),
        Some(lines) => {
            let Slopes { across, up, .. } = Slopes::of_rack(value, lines.tan_alpha, lines.helix);
            across.abs() * 0.5 * lines.face_width + up.abs() * height
        }
    };
    // a lead of all teeth has one value
    if values.lower == values.upper {
        asked(values.lower)
    } else {
        candidates(values, lines).into_iter().map(asked).fold(0.0, f64::max)
    }
}

/// How far undercut lifts a pair.
pub(super) fn undercut(known: &KnownPair) -> Option<&UndercutTable> {
    let cells = || Leads::none(Part::Rack).cells(known, LeadEnd::UpperWithUndercut);
    known.undercut.as_ref().map(|table| table.get_or_init(|| UndercutTable::new(&cells())))
}

/// The place of a cell within its pitch.
fn time(index: i32) -> usize {
    index.rem_euclid(CELLS) as usize
}

/// The most that any right flank asks for in each part of a pitch.
fn at_same_time(cells: &[Cell]) -> [f64; CELLS as usize] {
    let mut most = [f64::NEG_INFINITY; CELLS as usize];
    for cell in cells {
        most[time(cell.index)] = most[time(cell.index)].max(cell.most);
    }
    most
}

impl Slopes {
    /// The demand of a rack flank whose tooth line turns by an angle, rad.
    pub(in crate::judge) fn of_rack(turn: f64, tan_alpha: f64, helix: f64) -> Self {
        let (sin, cos) = trig::sin_cos(turn);
        // straight teeth
        let (sin_turned, cos_turned) = if helix == 0.0 { (sin, cos) } else { trig::sin_cos(helix + turn) };
        let fall = sin_turned / cos_turned * sin - (1.0 - cos);
        Self { across: sin / (cos_turned * tan_alpha), up: -fall, along: 0.0 }
    }

    /// The demand of a pinion flank whose lead is this ΔCD over the whole face, mm; `half_face` is half the face width.
    pub(in crate::judge) fn of_pinion(value: f64, half_face: f64) -> Self {
        Self { across: 0.0, up: 0.0, along: value / half_face }
    }

    /// The demand of two turned flanks that meet.
    pub(in crate::judge) fn with(&self, other: &Self) -> Self {
        let Self { across, up, along } = *other;
        Self { across: self.across + across, up: self.up + up, along: self.along + along }
    }

    pub(in crate::judge) fn at(&self, spot: &Spot) -> f64 {
        self.across * spot.y + self.up * spot.z + self.along * spot.w
    }

    /// An upper bound for all points within the end faces; infinite for an empty field.
    fn at_most(&self, known: &KnownPair, level: &Level) -> f64 {
        let heights = level.field.extremes(|spot| spot.z.abs()).map_or(f64::INFINITY, |range| range.upper);
        let half_width = 0.5 * known.given.pair.rack().face_width_mm;
        self.across.abs() * half_width
            + self.up.abs() * (heights + known.reach.largest())
            + self.along.abs() * half_face(known)
    }

    /// The most that flanks of a part of the field ask for, with what undercut lifts them beyond their lines.
    fn beyond_lines(&self, known: &KnownPair, field: &Field) -> f64 {
        let Some(Range { lower, upper }) = field.extremes(|spot| spot.roll) else { return f64::NEG_INFINITY };
        let pair = &known.given.pair;
        let profile = Profile::new(pair, line_distance(pair), 0.0).beside_lines();
        let pinion = pair.pinion();
        let shift = shift_rad(pair, known.reach.largest());
        let strip = |index: i32| {
            let at = |index: i32| lower + (upper - lower) * f64::from(index) / f64::from(STRIPS);
            let rolls = Rolls { low: at(index), high: at(index + 1) };
            let asked = field.within(rolls).extremes(|spot| self.at(spot))?.upper;
            // below the start of the involute, this carries
            let off_line = pinion.base_radius_mm * (pinion.start_roll_rad - rolls.low + shift).max(0.0);
            let moved = Rolls { low: rolls.low - shift, high: rolls.high + shift };
            Some(asked + self.loose(known, off_line) + profile.most_beyond(moved))
        };
        (0..STRIPS).filter_map(strip).fold(f64::NEG_INFINITY, f64::max)
    }

    /// What a point off its contact line, or at another centre distance, may ask for in addition.
    fn loose(&self, known: &KnownPair, off_line: f64) -> f64 {
        let skew = trig::sin(known.given.pair.shaft_angle_rad()).abs() * off_line;
        self.across.abs() * skew + self.up.abs() * (off_line + known.reach.largest())
    }
}

fn half_face(known: &KnownPair) -> f64 {
    0.5 * known.given.pair.pinion().face_width_mm
}
