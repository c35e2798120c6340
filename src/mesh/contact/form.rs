//! Flanks with form: crowning, relief and slope. Called by [`FlankContact::touch`], [`FlankContact::demand`] and
//! [`FlankContact::roll_rate`] where a pair has any; plain flanks never come here.
//!
//! Along a generator each surface asks for a polynomial of second degree in w, so that the largest of the least is at an
//! end, at the top of one or where two cross: the demand and its derivatives still are closed forms. Over the generators
//! it may have several peaks; those that show between the lines of a grid are climbed as those of plain flanks are. The
//! grid is narrowed where the demand is not seen to be concave. That does not show every peak: the long form of this
//! module's tests counts the random contacts that have a higher one.
//!
//! All of a flank is looked at once for each position that is told, and on the way there only its known [`Peaks`]: what any
//! place asks for is what the flank asks for at least, so that a position that is balanced for some places, and at which no
//! other place asks for more, is that of all.
//! The same flank without form bounds from above what it asks for ([`Form::most_added`]); most others than the carrier end
//! there.

use std::iter::once;
use std::ops::{Add, Mul, Sub};

use super::climb::{Sample, Search};
use super::{
    Bound, ContactKind, Coordinates, DEMAND, FlankContact, Generator, Line, Plane, Pose, PoseRates, Range, RollRates,
    Surface, Touch,
};
use crate::deviation::{PinionForm, RackForm};

/// Flank form of both parts: how far the material stands back along the normal, mm, and how that acts on what a point
/// asks for. It is a property of each part: of the rolled rack, places are those in the rack itself.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mesh) struct Form {
    pub(in crate::mesh) rack: RackForm,
    pub(in crate::mesh) pinion: PinionForm,
    pub(in crate::mesh) tip: f64,
    /// Centre distance per amount, over the flank and, of the pinion's, over the rack's tip plane.
    pub(in crate::mesh) per_normal: f64,
    pub(in crate::mesh) per_normal_on_tip: f64,
    /// How the flank's height in the rack falls along the teeth.
    pub(in crate::mesh) fall: f64,
    /// The rack's roll, and how deep below its reference plane its axis lies.
    pub(in crate::mesh) roll: (f64, f64),
    pub(in crate::mesh) depth: f64,
}

impl Form {
    /// By how much a flank asks for more than without form at most: crowning and relief only remove, a negative slope of the
    /// profile adds up to its amount along the normal.
    pub(in crate::mesh) fn most_added(&self) -> f64 {
        (-self.pinion.profile_slope_mm).max(0.0) * self.per_normal.max(self.per_normal_on_tip)
    }

    fn has_relief(&self) -> bool {
        self.rack.tip_relief_mm > 0.0
    }
}

/// How [`Form`] changes with the rack's roll.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mesh) struct FormRates {
    pub(in crate::mesh) per_normal: f64,
    pub(in crate::mesh) per_normal_on_tip: f64,
}

/// The least of what these ask for counts.
const SURFACES: [Surface; 3] = [Surface::Flank, Surface::Relieved, Surface::Tip];

/// Parts that each half of a flank is divided into to see its peaks, and the finer ones where no generator has points over the rack.
const GRIDS: [u32; 2] = [6, 32];

/// How often such a part is halved where its ends do not tell whether a peak lies between.
const DIVISIONS: u32 = 4;

/// The search for others goes on at these distances on either side of a peak, rad. Peaks at both ends of a generator may be
/// that near to each other.
const BESIDE: [f64; 6] = [1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.03];

/// Places on neighbouring generators that are this share of half the face apart may be those of two peaks, one at each end.
const FAR: f64 = 0.1;

/// Peaks of a flank that are kept for the next position.
const KEPT: usize = 3;

/// Peaks nearer to each other (rad) are one.
const ONE_PEAK: f64 = 1e-9;

/// The generators where a flank's peaks were when they were looked for last, the highest first.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mesh) struct Peaks {
    at: [Option<f64>; KEPT],
    /// Whether all of the flank was looked at: without, no peaks say nothing.
    pub(in crate::mesh) are_known: bool,
}

impl Peaks {
    /// The highest of these.
    fn of(mut found: Vec<Touch>) -> Self {
        found.sort_by(|a, b| b.demand.total_cmp(&a.demand));
        let mut peaks = Self { are_known: true, ..Self::default() };
        for Touch { spot, .. } in found {
            peaks.add(spot.delta);
        }
        peaks
    }

    /// Keeps one more; whether it is another one, and there is room.
    fn add(&mut self, delta: f64) -> bool {
        let is_known = self.at.iter().flatten().any(|known| (known - delta).abs() <= ONE_PEAK);
        match self.at.iter_mut().find(|peak| peak.is_none()) {
            Some(free) if !is_known => {
                *free = Some(delta);
                true
            }
            _ => false,
        }
    }
}

/// Bounds on w nearer to each other than this share of the face width are a vertex.
const SMALLEST: f64 = 1e-9;

/// a x² + b x + c, of a product no higher power: along a generator in w, or near a place a value c with its rate b.
#[derive(Debug, Clone, Copy)]
struct Polynomial {
    a: f64,
    b: f64,
    c: f64,
}

/// What decides on the demands of the surfaces at a point of the pinion, and all that the rack's roll changes.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// What the planes of flank and tip ask for.
    flank: Polynomial,
    tip: Polynomial,
    /// The coordinates across the rack and along the axis, and the roll angle.
    across: Polynomial,
    w: Polynomial,
    roll: Polynomial,
    /// Of the rack's roll.
    sin: Polynomial,
    cos: Polynomial,
    /// Constant part of the coordinate across the rack.
    shift: Polynomial,
    per_normal: Polynomial,
    per_normal_on_tip: Polynomial,
}

impl Place {
    /// Where nothing of the rack changes.
    fn new(form: &Form, pose: &Pose, [flank, tip, across]: [Polynomial; 3], w: Polynomial, roll: Polynomial) -> Self {
        Self {
            flank,
            tip,
            across,
            w,
            roll,
            sin: form.roll.0.into(),
            cos: form.roll.1.into(),
            shift: pose.across.into(),
            per_normal: form.per_normal.into(),
            per_normal_on_tip: form.per_normal_on_tip.into(),
        }
    }
}

/// A generator with flank form.
pub(super) struct OnGenerator<'a> {
    pub(super) form: &'a Form,
    pub(super) pose: &'a Pose,
    pub(super) at: &'a Coordinates,
    /// What the planes of flank and tip ask for along it, and its way across the rack.
    pub(super) lines: [Line; 3],
    pub(super) lo: Bound,
    pub(super) hi: Bound,
}

/// How those lines and the roll angle change at a place.
#[derive(Default)]
struct Rates {
    lines: [f64; 3],
    roll: f64,
}

/// What holds the place of the largest demand on a generator.
#[derive(Debug, Clone, Copy)]
enum PeakHeldBy {
    /// Nothing along it: the surfaces ask for the same all along.
    Level,
    Low,
    High,
    /// The top of what one surface asks for.
    Top,
    Crossing(usize, usize),
}

/// The largest demand on a generator.
struct Peak {
    demand: f64,
    w: f64,
    held: PeakHeldBy,
    surfaces: [Polynomial; 3],
    /// The one of them that asks for the least there, of two that cross the first.
    least: usize,
}

impl FlankContact {
    /// What the surfaces ask for; without relief the relieved one is the flank.
    fn surfaces(&self, form: &Form, at: &Place) -> [Polynomial; 3] {
        let plain = self.surface(form, at, Surface::Flank);
        let relieved = if form.has_relief() { self.surface(form, at, Surface::Relieved) } else { plain };
        [plain, relieved, self.surface(form, at, Surface::Tip)]
    }

    /// What one of them asks for.
    fn surface(&self, form: &Form, at: &Place, surface: Surface) -> Polynomial {
        let axial = at.w * (1.0 / self.half_face);
        let profile = (at.roll - Polynomial::from(self.start_roll)) * (1.0 / (self.tip_roll - self.start_roll));
        let pinion = axial * axial * form.pinion.crowning_mm + profile * form.pinion.profile_slope_mm;
        if surface == Surface::Tip {
            return at.tip - at.per_normal_on_tip * pinion;
        }
        let across = at.across * (1.0 / self.across.half_width);
        let mut back = pinion + across * across * form.rack.crowning_mm;
        if surface == Surface::Relieved {
            // how high in the rack the flank's plane is where the point is, above where the relief starts
            let deep = at.sin * (at.flank + Polynomial::from(form.depth)) - at.shift;
            let high = Polynomial::from(form.tip - form.rack.tip_relief_start_mm) - at.cos * (at.tip - at.flank)
                + deep * form.fall;
            back = back + high * (form.rack.tip_relief_mm / (form.tip - form.rack.tip_relief_start_mm));
        }
        at.flank - at.per_normal * back
    }

    /// What the planes of flank and tip ask for along a generator, and its way across the rack.
    fn lines(&self, pose: &Pose, at: &Coordinates) -> [Line; 3] {
        [Self::plane(&self.flank, pose.shift, at), Self::plane(&self.tip, 0.0, at), self.across_line(pose, at)]
    }

    /// A generator's places.
    fn along(&self, form: &Form, pose: &Pose, at: &Coordinates, lines: &[Line; 3]) -> Place {
        let line = Polynomial::line;
        Place::new(form, pose, lines.map(|of| line(of.q, of.p)), line(1.0, 0.0), line(self.kappa, at.t0))
    }

    /// A place on a generator where all changes as told.
    fn changing(&self, on: &OnGenerator<'_>, w: f64, rates: &Rates) -> Place {
        let values = [0, 1, 2].map(|i| Polynomial::line(rates.lines[i], on.lines[i].at(w)));
        let roll = Polynomial::line(rates.roll, on.at.t0 + self.kappa * w);
        Place::new(on.form, on.pose, values, w.into(), roll)
    }

    /// The largest demand on a generator.
    fn peak(&self, on: &OnGenerator<'_>) -> Peak {
        let OnGenerator { form, pose, at, lines, lo, hi } = on;
        let surfaces = self.surfaces(form, &self.along(form, pose, at, lines));
        let demand = |w: f64| surfaces.iter().map(|surface| surface.at(w)).fold(f64::INFINITY, f64::min);
        // what asks for no more than rounding beyond the middle is as good: flanks without crowning touch along a line
        let middle = lo.w + 0.5 * (hi.w - lo.w);
        let tie = DEMAND * self.scale;
        let at_middle = demand(middle);
        let level = [lo.w, hi.w].into_iter().all(|w| (demand(w) - at_middle).abs() <= tie);
        let least = |w: f64| {
            let demands = surfaces.map(|surface| surface.at(w));
            (0..SURFACES.len()).min_by(|&i, &j| demands[i].total_cmp(&demands[j])).unwrap_or(0)
        };
        let mut best = if hi.w - lo.w <= SMALLEST * self.half_face {
            // at a vertex the bound that counts is the one towards which the demand rises
            if surfaces[least(middle)].slope_at(middle) > 0.0 {
                (demand(hi.w), hi.w, PeakHeldBy::High)
            } else {
                (demand(lo.w), lo.w, PeakHeldBy::Low)
            }
        } else {
            (at_middle, middle, if level { PeakHeldBy::Level } else { PeakHeldBy::Top })
        };
        let mut consider = |w: f64, held: PeakHeldBy| {
            if w >= lo.w && w <= hi.w {
                let value = demand(w);
                if value > best.0 + tie {
                    best = (value, w, held);
                }
            }
        };
        consider(lo.w, PeakHeldBy::Low);
        consider(hi.w, PeakHeldBy::High);
        let is_another = |surface: Surface| surface != Surface::Relieved || form.has_relief();
        for (index, surface) in surfaces.iter().enumerate().filter(|&(index, _)| is_another(SURFACES[index])) {
            consider(-surface.b / (2.0 * surface.a), PeakHeldBy::Top);
            for (before, crossed) in surfaces[..index].iter().enumerate() {
                for w in (*crossed - *surface).roots() {
                    consider(w, PeakHeldBy::Crossing(before, index));
                }
            }
        }
        let (demand, w, held) = best;
        let least = if let PeakHeldBy::Crossing(first, _) = held { first } else { least(w) };
        Peak { demand, w, held, surfaces, least }
    }

    /// How the largest demand on a generator changes where its place does, and its ends as told.
    fn rate(&self, form: &Form, peak: &Peak, place: &Place, ends: [f64; 2]) -> f64 {
        let rate = |index: usize| self.surface(form, place, SURFACES[index]).b;
        let along = |index: usize| peak.surfaces[index].slope_at(peak.w);
        let [lo, hi] = ends;
        match peak.held {
            PeakHeldBy::Level | PeakHeldBy::Top => rate(peak.least),
            PeakHeldBy::Low => rate(peak.least) + along(peak.least) * lo,
            PeakHeldBy::High => rate(peak.least) + along(peak.least) * hi,
            PeakHeldBy::Crossing(i, j) => {
                let [one, other] = [i, j].map(rate);
                one + along(i) * (one - other) / (along(j) - along(i))
            }
        }
    }

    /// The demand of a generator with flank form.
    pub(super) fn demand_with_form(&self, on: &OnGenerator<'_>) -> Generator {
        let OnGenerator { form, lines, lo, hi, .. } = on;
        let peak = self.peak(on);
        let w = peak.w;
        let rate = |rates: &Rates, ends: [f64; 2]| self.rate(form, &peak, &self.changing(on, w, rates), ends);
        Generator::Some {
            demand: peak.demand,
            slope: rate(&Rates { lines: lines.map(|line| line.slope_at(w)), roll: 1.0 }, [lo.slope, hi.slope]),
            rate: rate(&Rates { lines: lines.map(|line| line.p_rate), roll: -1.0 }, [lo.rate, hi.rate]),
            w,
            kind: match peak.held {
                PeakHeldBy::Low => lo.kind,
                PeakHeldBy::High => hi.kind,
                PeakHeldBy::Crossing(_, other) if SURFACES[other] == Surface::Tip => ContactKind::RackEdge,
                PeakHeldBy::Level => ContactKind::Line,
                PeakHeldBy::Top | PeakHeldBy::Crossing(..) => ContactKind::Point,
            },
            surface: SURFACES[peak.least],
        }
    }

    /// The derivatives of the demand at a generator by the rack's roll and by the centre distance that is assumed.
    pub(super) fn formed_roll_rate(
        &self,
        form: &Form,
        pose: &Pose,
        delta: f64,
        rates: &RollRates,
        moved: &PoseRates,
    ) -> [f64; 2] {
        let at = self.coordinates(pose, delta);
        let (lo, hi) = self.interval(pose, &at);
        let on = OnGenerator { form, pose, at: &at, lines: self.lines(pose, &at), lo, hi };
        let [.., across] = on.lines;
        let peak = self.peak(&on);
        let w = peak.w;
        let sweep = Self::sweep(&at, w, rates, moved);
        let xi = at.xi.at(w);
        let by_roll = |plane: &Plane| plane.d - plane.t * xi - plane.w * w;
        let still = self.changing(&on, w, &Rates::default());
        let changing = |quantity: Polynomial, rate: f64| Polynomial { b: rate, ..quantity };
        let (sin, cos) = form.roll;
        let rolled = Place {
            flank: changing(still.flank, by_roll(&rates.flank) + moved.shift),
            tip: changing(still.tip, by_roll(&rates.tip)),
            across: changing(still.across, sweep[0]),
            sin: changing(still.sin, cos),
            cos: changing(still.cos, -sin),
            shift: changing(still.shift, moved.across[0]),
            per_normal: changing(still.per_normal, rates.form.per_normal),
            per_normal_on_tip: changing(still.per_normal_on_tip, rates.form.per_normal_on_tip),
            ..still
        };
        let raised =
            Place { across: changing(still.across, sweep[1]), shift: changing(still.shift, moved.across[1]), ..still };
        [(rolled, sweep[0]), (raised, sweep[1])].map(|(place, sweep)| {
            let end = |bound: &Bound| if bound.kind == ContactKind::RackEndEdge { -sweep / across.q } else { 0.0 };
            self.rate(form, &peak, &place, [end(&lo), end(&hi)])
        })
    }

    /// The largest demand over the generators of the flank, and its peaks.
    pub(in crate::mesh) fn touch_with_form(&self, pose: &Pose, peaks: &mut Peaks) -> Option<Touch> {
        peaks.are_known = true;
        let flank = self.generators(pose)?;
        let known = self.climbed(pose, flank, f64::NEG_INFINITY, peaks);
        GRIDS.into_iter().find_map(|cells| self.highest(pose, flank, cells, known, peaks))
    }

    /// The largest demand at the peaks that are known, wherever they are now: what the flank asks for at least. `None` if
    /// none is known or left.
    pub(in crate::mesh) fn touch_at_peaks(&self, pose: &Pose, floor: f64, peaks: &mut Peaks) -> Option<Touch> {
        self.climbed(pose, self.generators(pose)?, floor, peaks)
    }

    /// The highest of the known peaks, which move to where they are now; one that is now no other than one before it is kept
    /// where it was.
    fn climbed(&self, pose: &Pose, flank: Range, mut floor: f64, peaks: &mut Peaks) -> Option<Touch> {
        let (mut best, mut moved) = (None::<Touch>, Peaks { at: [None; KEPT], ..*peaks });
        for start in peaks.at.into_iter().flatten() {
            let touch = self.climb(pose, &Search { range: flank, flank, floor, start: Some(start), known: None });
            if !touch.is_some_and(|touch| moved.add(touch.spot.delta)) {
                moved.add(start);
            }
            let Some(touch) = touch else { continue };
            if best.is_none_or(|best| touch.demand > best.demand) {
                floor = floor.max(touch.demand);
                best = Some(touch);
            }
        }
        *peaks = moved;
        best
    }

    /// The highest of the known peaks and of those that show on a grid.
    fn highest(&self, pose: &Pose, flank: Range, cells: u32, known: Option<Touch>, peaks: &mut Peaks) -> Option<Touch> {
        let Range { lo, hi } = flank;
        let sample = |x: f64| Sample { x, generator: self.demand(pose, x) };
        let (mut best, mut found) = (None::<Touch>, Vec::new());
        let mut consider = |range: Range, start, known| {
            let touch = self.climb(pose, &Search { range, flank, floor: f64::NEG_INFINITY, start, known });
            if let Some(touch) = touch {
                found.push(touch);
                if best.is_none_or(|best| touch.demand > best.demand) {
                    best = Some(touch);
                }
            }
            touch.map(|touch| touch.spot.delta)
        };
        // narrower near the contact line of plain flanks, where most peaks are
        let middle = 0.0_f64.clamp(lo, hi);
        let place = |end: f64, i: u32| {
            if i == cells { end } else { middle + (end - middle) * f64::from(i * i) / f64::from(cells * cells) }
        };
        let before = (1..=cells).rev().map(|i| place(lo, i));
        let after = (1..=cells).map(|i| place(hi, i));
        let places = before.filter(|&x| x < middle).chain([middle]).chain(after.filter(|&x| x > middle));
        let samples: Vec<Sample> = places.map(sample).collect();
        let floor = samples.iter().map(Sample::demand).fold(f64::NEG_INFINITY, f64::max);
        if samples[0].slope() < 0.0 {
            consider(Range { lo, hi: lo }, None, None);
        }
        if samples[samples.len() - 1].slope() > 0.0 {
            consider(Range { lo: hi, hi }, None, None);
        }
        let mut between: Vec<(Sample, Sample, u32)> = samples.windows(2).map(|ends| (ends[0], ends[1], 0)).collect();
        while let Some((low, high, depth)) = between.pop() {
            if let Some(delta) = low.peak_before(&high) {
                let peak = consider(Range { lo: low.x, hi: high.x }, Some(delta), Some([low, high]));
                // there may be another one on either side
                if let Some(peak) = peak.filter(|_| depth < DIVISIONS) {
                    let before = BESIDE.iter().rev().map(|beside| peak - beside);
                    let places = before.chain(BESIDE.iter().map(|beside| peak + beside));
                    let within = places.filter(|&x| low.x < x && x < high.x).map(sample);
                    let row: Vec<Sample> = once(low).chain(within).chain(once(high)).collect();
                    let cells = row.windows(2).map(|ends| (ends[0], ends[1], depth + 1));
                    between.extend(cells.filter(|(low, high, _)| !(low.x < peak && peak < high.x)));
                }
            } else if depth < DIVISIONS && low.hides(&high, floor, FAR * self.half_face) {
                let middle = sample(low.x + 0.5 * (high.x - low.x));
                between.extend([(low, middle, depth + 1), (middle, high, depth + 1)]);
            }
        }
        let best = match known {
            Some(known) if best.is_none_or(|best| known.demand > best.demand) => Some(known),
            _ => best,
        };
        found.extend(known);
        *peaks = Peaks::of(found);
        best
    }
}

impl Sample {
    fn demand(&self) -> f64 {
        match self.generator {
            Generator::Some { demand, .. } => demand,
            Generator::None { .. } => f64::NEG_INFINITY,
        }
    }

    /// Where to look first for a peak between this generator and the next one; `None` if none shows.
    fn peak_before(&self, next: &Self) -> Option<f64> {
        let middle = self.x + 0.5 * (next.x - self.x);
        match (self.generator, next.generator) {
            (Generator::Some { slope: before, .. }, Generator::Some { slope: after, .. }) => {
                let share = before / (before - after);
                (before >= 0.0 && after <= 0.0)
                    .then(|| if share.is_nan() { middle } else { self.x + share * (next.x - self.x) })
            }
            // where the flank begins
            (Generator::None { .. }, Generator::Some { slope, .. }) => (slope <= 0.0).then_some(middle),
            (Generator::Some { slope, .. }, Generator::None { .. }) => (slope >= 0.0).then_some(middle),
            (Generator::None { slope: before, .. }, Generator::None { slope: after, .. }) => {
                (before >= 0.0 && after <= 0.0).then_some(middle)
            }
        }
    }

    /// Whether a peak higher than `floor` may lie between this generator and the next one though none shows: where
    /// another edge or surface takes over, or the flank begins or ends, or where the tangents do not bound what lies
    /// between as those of a concave function do.
    fn hides(&self, next: &Self, floor: f64, far: f64) -> bool {
        let width = next.x - self.x;
        match (self.generator, next.generator) {
            (
                Generator::Some { demand: here, slope: before, w, .. },
                Generator::Some { demand: there, slope: after, w: next_w, .. },
            ) => {
                let is_one = self.is_as(next) && (next_w - w).abs() <= far;
                let mean = (there - here) / width;
                let steepest = before.abs().max(after.abs());
                here.max(there) + steepest * width > floor && !(is_one && before >= mean && mean >= after)
            }
            (Generator::None { .. }, Generator::None { .. }) => false,
            _ => true,
        }
    }
}

impl Polynomial {
    fn line(b: f64, c: f64) -> Self {
        Self { a: 0.0, b, c }
    }

    fn at(&self, w: f64) -> f64 {
        (self.a * w + self.b) * w + self.c
    }

    fn slope_at(&self, w: f64) -> f64 {
        2.0 * self.a * w + self.b
    }

    /// Where it is zero; what is not finite is no such place.
    fn roots(&self) -> [f64; 2] {
        let root = (self.b * self.b - 4.0 * self.a * self.c).sqrt();
        let far = -0.5 * (self.b + root.copysign(self.b));
        [far / self.a, self.c / far]
    }
}

impl From<f64> for Polynomial {
    fn from(c: f64) -> Self {
        Self::line(0.0, c)
    }
}

impl Add for Polynomial {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }
}

impl Sub for Polynomial {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { a: self.a - other.a, b: self.b - other.b, c: self.c - other.c }
    }
}

impl Mul for Polynomial {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            a: self.a * other.c + self.b * other.b + self.c * other.a,
            b: self.b * other.c + self.c * other.b,
            c: self.c * other.c,
        }
    }
}

impl Mul<f64> for Polynomial {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { a: self.a * factor, b: self.b * factor, c: self.c * factor }
    }
}

#[cfg(test)]
mod tests;
