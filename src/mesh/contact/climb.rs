//! The maximum over generators of a flank pair: a bracketed climb on the derivative. [`FlankContact::touch`] calls it, with
//! flank form once for each peak. The number of evaluations is bounded; the result is the best generator found.
//!
//! The demand is smooth except where the bound on w changes from one edge to another; there its derivative jumps. Where
//! both ends of the bracket lie on one edge the secant of the derivative is taken, where they lie on different edges
//! the intersection of both tangents, which meets such a corner quadratically. For a concave function that
//! intersection also is an upper bound, which ends the climb once it is as low as the best value. With lead errors, halving
//! the bracket instead takes 3.3 times as long; so does leaving out both the step over a corner ([`UNEVEN`]) and the early
//! end below the floor.

use super::{ContactKind, DEMAND, FlankContact, Generator, MAX_EVALUATIONS, Pose, Range, Spot, Touch};

/// First step off the start of the flank, rad.
const INSIDE: f64 = 1e-3;

/// Up to this roll angle (rad) the derivative, which is proportional to it, says nothing.
const SILENT: f64 = 1e-9;

/// A meeting point nearer to one end than this share of the interval says little about the other end.
const UNEVEN: f64 = 0.1;

/// In brackets this short (rad) tangents stand for the function: their square times any curvature is below rounding.
const NARROW: f64 = 1e-7;

/// A generator and its demand.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    pub(super) x: f64,
    pub(super) generator: Generator,
}

impl Sample {
    /// Derivative of the demand; off the flank, of the way to the flank.
    pub(super) fn slope(&self) -> f64 {
        match self.generator {
            Generator::Some { slope, .. } | Generator::None { slope, .. } => slope,
        }
    }

    /// Keeps the generator as the best if it asks for more.
    fn raise(&self, best: &mut Option<Touch>) {
        if let Generator::Some { demand, rate, w, kind, surface, .. } = self.generator
            && best.is_none_or(|best| demand > best.demand)
        {
            *best = Some(Touch::at(demand, rate, Spot { delta: self.x, w, kind, surface }));
        }
    }

    /// Whether one smooth function gives the demand of both: the same kind of edge of the same surface.
    pub(super) fn is_as(&self, other: &Self) -> bool {
        match (self.generator, other.generator) {
            (
                Generator::Some { kind: ours, surface: on, .. },
                Generator::Some { kind: theirs, surface: other_on, .. },
            ) => ours == theirs && on == other_on,
            _ => false,
        }
    }
}

/// What to search, and what is known beforehand.
#[derive(Clone, Copy)]
pub(super) struct Search {
    /// All or part of the flank.
    pub(super) range: Range,
    pub(super) flank: Range,
    /// Demands below this need not be exact.
    pub(super) floor: f64,
    /// The generator to begin with.
    pub(super) start: Option<f64>,
    /// The ends of the range, if they were evaluated before.
    pub(super) known: Option<[Sample; 2]>,
}

/// What to do after an evaluation.
enum Next {
    Try(f64),
    Done,
    Nothing,
    /// Everything is below the floor; the value is an upper bound.
    Below(f64),
}

/// Shortest step after `run` steps the same way: where the derivative tells little of the distance the steps must grow.
fn stride(run: i32) -> f64 {
    match run {
        ..=2 => 0.0,
        3..=12 => INSIDE * f64::from(1 << (2 * (run - 3))),
        _ => std::f64::consts::PI,
    }
}

impl FlankContact {
    /// Largest demand for δ in a range.
    pub(super) fn climb(&self, pose: &Pose, search: &Search) -> Option<Touch> {
        let mut climb = Climb::new(self, pose, search);
        let mut x = climb.start();
        for _ in 0..MAX_EVALUATIONS {
            match climb.step(x) {
                Next::Try(next) => x = next,
                Next::Done => break,
                Next::Nothing => return None,
                // kept as an upper bound, which never carries
                Next::Below(bound) => return climb.best.map(|touch| Touch { demand: bound, ..touch }),
            }
        }
        climb.best.map(|touch| climb.settle(touch))
    }

    /// How far the gap between bounds on w may bend up over δ: bounds at the rack's end faces go with the flank's points,
    /// which turn about the pinion's axis, and how steeply they cross the rack divides that.
    fn gap_bend(&self) -> f64 {
        let turned = (self.across.t.abs() + self.across.z.abs()) * self.base_radius;
        let crossing = self.across.w.abs() - self.kappa.abs() * turned;
        if crossing > 0.0 { 4.0 * turned * (1.0 + self.tip_roll) / crossing } else { f64::INFINITY }
    }
}

/// A search under way: the bracket, and the best generator so far.
struct Climb<'a> {
    contact: &'a FlankContact,
    pose: &'a Pose,
    search: &'a Search,
    tolerance: f64,
    below: Option<Sample>,
    above: Option<Sample>,
    best: Option<Touch>,
    width: f64,
    /// Steps in a row that did not halve the bracket.
    stalls: u32,
    /// Evaluations in a row that moved the same end of the bracket, negative for the upper one.
    run: i32,
    looked_beside: bool,
}

impl<'a> Climb<'a> {
    fn new(contact: &'a FlankContact, pose: &'a Pose, search: &'a Search) -> Self {
        let [below, above] = search.known.map_or([None; 2], |ends| ends.map(Some));
        let mut best = None;
        for end in [below, above].into_iter().flatten() {
            end.raise(&mut best);
        }
        Self {
            contact,
            pose,
            search,
            tolerance: DEMAND * contact.scale,
            below,
            above,
            best,
            width: f64::INFINITY,
            stalls: 0,
            run: 0,
            looked_beside: false,
        }
    }

    /// The generator to begin with.
    fn start(&self) -> f64 {
        let Range { lo, hi } = self.search.range;
        // where the involute starts at its base circle the derivative vanishes whichever way it goes: look beside it
        let inside = || 0.0_f64.clamp(lo + INSIDE.min(0.25 * (hi - lo)), hi);
        self.search.start.filter(|&delta| delta > lo && delta < hi).unwrap_or_else(inside)
    }

    /// Looks at a generator.
    fn step(&mut self, x: f64) -> Next {
        let sample = Sample { x, generator: self.contact.demand(self.pose, x) };
        sample.raise(&mut self.best);
        if self.is_top(&sample) {
            return Next::Done;
        }
        let (slope, Range { lo, hi }) = (self.slope(&sample), self.search.range);
        if slope > 0.0 {
            self.below = Some(sample);
        } else if slope < 0.0 {
            self.above = Some(sample);
        }
        if slope > 0.0 && x < hi {
            self.run = self.run.max(0) + 1;
        } else if slope < 0.0 && x > lo {
            self.run = self.run.min(0) - 1;
        } else {
            // the derivative at an end of the flank still leads outward: the end is a vertex, which moves with the flank
            return Next::Done;
        }
        let bracket = Range { lo: self.below.map_or(lo, |s| s.x), hi: self.above.map_or(hi, |s| s.x) };
        let Range { lo: a, hi: b } = bracket;
        if b - a <= 2.0 * f64::EPSILON * (a.abs() + b.abs()) {
            return Next::Done;
        }
        self.stalls = if b - a > 0.5 * self.width { self.stalls + 1 } else { 0 };
        self.width = b - a;
        if let Some(bound) = self.bound()
            && bound < self.search.floor
        {
            return Next::Below(bound);
        }
        match self.propose(bracket) {
            Next::Try(next) => self.checked(next, &sample, slope, bracket),
            other => other,
        }
    }

    fn roll(&self, x: f64, w: f64) -> f64 {
        (self.contact.nu - self.pose.c) + x + self.contact.kappa * w
    }

    /// Whether no other generator asks for more by more than the tolerance; flank form may bend the demand less.
    fn is_top(&self, sample: &Sample) -> bool {
        let Generator::Some { w, slope, .. } = sample.generator else { return false };
        let roll = self.roll(sample.x, w);
        let bend = self.contact.scale * roll;
        self.contact.form.is_none() && roll > 1e-3 && slope * slope <= 2.0 * self.tolerance * bend
    }

    /// Which way the top lies.
    fn slope(&mut self, sample: &Sample) -> f64 {
        match (sample.generator, self.best) {
            // off the flank the way leads back to where the flank was met, though another edge may be nearer
            (Generator::None { .. }, Some(best)) => best.spot.delta - sample.x,
            // on the base circle itself the derivative is rounding: the flank lies at greater δ, so look there once
            (Generator::Some { w, .. }, _)
                if self.contact.form.is_none() && self.roll(sample.x, w) < SILENT && !self.looked_beside =>
            {
                self.looked_beside = true;
                f64::MIN_POSITIVE
            }
            _ => sample.slope(),
        }
    }

    /// A proposal, unless it gains nothing, or the bracket has to be halved instead.
    fn checked(&mut self, mut x: f64, sample: &Sample, slope: f64, Range { lo: a, hi: b }: Range) -> Next {
        let ends = self.below.zip(self.above);
        if self.contact.form.is_some()
            && (slope * (x - sample.x)).abs() <= self.tolerance
            && ends.is_some_and(|(low, high)| low.is_as(&high))
        {
            return Next::Done;
        }
        // three steps that did not halve the bracket: halve it
        if self.stalls >= 3 && ends.is_some() {
            self.stalls = 0;
            x = 0.5 * (a + b);
        }
        let Range { lo, hi } = self.search.range;
        let is_known = |end: Option<Sample>| end.is_some_and(|s| s.x == x);
        if !(x > a && x < b) && (x != lo && x != hi || is_known(self.below) || is_known(self.above)) {
            x = 0.5 * (a + b);
            if x <= a || x >= b {
                return Next::Done;
            }
        }
        Next::Try(x)
    }

    /// An upper bound of the demand between two samples: their tangents' intersection, and what any curvature can add.
    fn bound(&self) -> Option<f64> {
        let (l, h) = self.below.zip(self.above)?;
        let (Generator::Some { demand: fl, slope: sl, .. }, Generator::Some { demand: fh, slope: sh, .. }) =
            (l.generator, h.generator)
        else {
            return None;
        };
        let width = h.x - l.x;
        let meet = ((fh - fl) - sh * width) / (sl - sh);
        let bend = self.contact.scale + self.contact.base_radius;
        Some((fl + sl * meet).max(fl).max(fh) + bend * width * width)
    }

    fn propose(&self, bracket: Range) -> Next {
        let Range { lo: a, hi: b } = bracket;
        match (self.below, self.above) {
            (Some(l), Some(h)) => self.between(&l, &h),
            (Some(l), None) => match l.generator {
                Generator::Some { slope, w, .. } => {
                    let roll = self.roll(a, w).max(0.1);
                    Next::Try((a + (1.2 * slope / (self.contact.scale * roll)).max(stride(self.run))).min(b))
                }
                Generator::None { gap, slope, .. } => Next::Try((a - gap / slope).min(b)),
            },
            (None, Some(h)) => match h.generator {
                Generator::Some { slope, w, .. } => {
                    let roll = self.roll(b, w).max(0.1);
                    let inside = a + INSIDE.min(0.25 * (self.search.range.hi - a));
                    let step = (1.2 * slope / (self.contact.scale * roll)).min(-stride(-self.run));
                    Next::Try((b + step).max(if b > inside { inside } else { a }))
                }
                Generator::None { gap, slope, .. } => Next::Try((b - gap / slope).max(a)),
            },
            (None, None) => Next::Done,
        }
    }

    /// The next generator between a lower end and a higher one.
    fn between(&self, l: &Sample, h: &Sample) -> Next {
        let (a, b) = (l.x, h.x);
        match (l.generator, h.generator) {
            (Generator::Some { demand: fl, slope: sl, .. }, Generator::Some { demand: fh, slope: sh, .. }) => {
                let meet = ((fh - fl) + sl * a - sh * b) / (sl - sh);
                let bound = fl + sl * (meet - a);
                // the tangents bound a concave function; on a short bracket any smooth one, up to its square
                if b - a <= NARROW && self.best.is_some_and(|best| bound - best.demand <= self.tolerance) {
                    return Next::Done;
                }
                if l.is_as(h) {
                    return Next::Try(a + (b - a) * (sl / (sl - sh)));
                }
                // The meeting point is as good as the farther end's tangent. Where it falls next to one end, step
                // over the corner, so that the other end comes close too.
                let (before, after) = (meet - a, b - meet);
                Next::Try(if b - a <= NARROW {
                    meet
                } else if before < UNEVEN * after {
                    meet + (2.0 * before).max(0.4 * NARROW).min(0.5 * after)
                } else if after < UNEVEN * before {
                    meet - (2.0 * after).max(0.4 * NARROW).min(0.5 * before)
                } else {
                    meet
                })
            }
            (Generator::None { gap: gl, slope: sl, .. }, Generator::None { gap: gh, slope: sh, .. }) => {
                let meet = ((gh - gl) + sl * a - sh * b) / (sl - sh);
                let bound = gl + sl * (meet - a) + 0.5 * self.contact.gap_bend() * (b - a) * (b - a);
                if bound < -super::generator::VERTEX * self.contact.half_face { Next::Nothing } else { Next::Try(meet) }
            }
            (Generator::None { gap, slope, .. }, _) => self.vertex(a, b, -gap / slope, slope),
            (_, Generator::None { gap, slope, .. }) => self.vertex(b, a, -gap / slope, slope),
        }
    }

    /// Between a generator off the flank and one on it that both lead towards its vertex: Newton's step on the gap
    /// gives the vertex to the square of the step. Steps that far inside and then outside bring both ends close.
    fn vertex(&self, off: f64, on: f64, step: f64, slope: f64) -> Next {
        let (vertex, inward) = (off + step, (on - off).signum());
        // this near the vertex a generator off the flank counts as on it
        let fuzz = (super::generator::VERTEX * self.contact.half_face / slope).abs();
        let rounding = 4.0 * f64::EPSILON;
        let margin = 4.0 * step * step + rounding;
        let inside = vertex + inward * margin;
        if (on - inside) * inward > rounding {
            Next::Try(inside)
        } else if step.abs() <= 4.0 * fuzz + rounding {
            Next::Done
        } else {
            Next::Try(vertex - inward * (margin + 2.0 * fuzz))
        }
    }

    /// Names the contact and mixes the derivatives where two edges meet.
    fn settle(&self, touch: Touch) -> Touch {
        let Range { lo, hi } = self.search.flank;
        if self.contact.kappa == 0.0 && (touch.spot.delta == lo || touch.spot.delta == hi) {
            return self.at_end(touch);
        }
        self.at_vertex(self.at_corner(touch))
    }

    /// Without a helix the generators end at the involute's ends, which turn with it; on them the bound on w makes a
    /// corner unless it is free.
    fn at_end(&self, mut touch: Touch) -> Touch {
        for Sample { x, generator } in [self.below, self.above].into_iter().flatten() {
            if let Generator::Some { slope, .. } = generator
                && x == touch.spot.delta
            {
                touch.rate += slope;
            }
        }
        touch.kind = if self.contact.fits || matches!(touch.kind, ContactKind::Line | ContactKind::Point) {
            if touch.spot.delta == self.search.flank.hi { ContactKind::TipEdge } else { ContactKind::RootEdge }
        } else {
            ContactKind::Corner
        };
        touch
    }

    /// Where two edges meet both move the contact.
    fn at_corner(&self, mut touch: Touch) -> Touch {
        if let (Some(l), Some(h)) = (self.below, self.above)
            && let (
                Generator::Some { slope: sl, rate: rl, kind: kl, w: wl, surface: on_low, .. },
                Generator::Some { slope: sh, rate: rh, kind: kh, w: wh, surface: on_high, .. },
            ) = (l.generator, h.generator)
            && let share = -sh / (sl - sh)
            && if l.is_as(&h) {
                // flank form may bend the derivative so much that the best generator's is not the peak's
                self.contact.form.is_some() && (0.0..=1.0).contains(&share)
            } else {
                // a higher place may have been met on the way, and none near it is higher: name the contact as it was met
                h.x - l.x <= 1e-6 && (touch.spot.delta - l.x).abs() <= 1e-6
            }
        {
            touch.rate = share * rl + (1.0 - share) * rh;
            let low = Spot { delta: l.x, w: wl, kind: kl, surface: on_low };
            let high = Spot { delta: h.x, w: wh, kind: kh, surface: on_high };
            if l.is_as(&h) && touch.spot.delta == h.x {
                touch.other = Some((low, 1.0 - share));
            } else {
                touch.spot = low;
                touch.other = Some((high, share));
            }
            if !l.is_as(&h) {
                touch.kind = ContactKind::Corner;
            }
        }
        touch
    }

    /// Where the flank itself ends in a vertex, the vertex moves with c.
    fn at_vertex(&self, mut touch: Touch) -> Touch {
        let Range { lo, hi } = self.search.flank;
        let vertex = match (self.below, self.above) {
            (Some(Sample { generator: Generator::None { slope, rate, .. }, x }), Some(inner))
            | (Some(inner), Some(Sample { generator: Generator::None { slope, rate, .. }, x })) => {
                Some((-rate / slope, x, inner, Some(slope)))
            }
            (None, Some(inner)) => Some((1.0, lo, inner, None)),
            (Some(inner), None) => Some((1.0, hi, inner, None)),
            _ => None,
        };
        if let Some((speed, x, Sample { generator: Generator::Some { slope, .. }, .. }, gap_slope)) = vertex
            && (touch.spot.delta - x).abs() <= 1e-6
            && speed.is_finite()
        {
            touch.rate += slope * speed;
            touch.vertex = gap_slope.map(|gap_slope| (x, -slope / gap_slope));
            touch.kind = ContactKind::Corner;
        }
        touch
    }
}
