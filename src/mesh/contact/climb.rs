//! The maximum over generators of a flank pair: a bracketed climb on the derivative. Called by
//! [`FlankContact::touch`], with flank form for each peak by itself; bounded in its evaluations, and ends with the best
//! generator seen.
//!
//! The demand is smooth except where the bound on w changes from one edge to another; there its derivative jumps. Where
//! both ends of the bracket lie on one edge the secant of the derivative is taken, where they lie on different edges
//! the intersection of both tangents, which meets such a corner quadratically. For a concave function that
//! intersection also is an upper bound, which ends the climb once it is as low as the best value.

use super::{ContactKind, DEMAND, FlankContact, Generator, Hint, MAX_EVALUATIONS, Pose, Spot, Touch};

/// First step off the start of the flank, rad.
const INSIDE: f64 = 1e-3;

/// Roll angle (rad) up to which the derivative, which goes with it, tells nothing.
const SILENT: f64 = 1e-9;

/// A meeting point nearer to one end than this share of the way to the other says little of the other end's side.
const UNEVEN: f64 = 0.1;

/// Brackets this short (rad) let tangents speak for the function: its square times any curvature is below rounding.
const NARROW: f64 = 1e-7;

/// A generator, and what it asks for.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    pub(super) x: f64,
    pub(super) generator: Generator,
}

impl Sample {
    /// Derivative of the demand, or, off the flank, of the way to it.
    pub(super) fn slope(&self) -> f64 {
        match self.generator {
            Generator::Some { slope, .. } | Generator::None { slope, .. } => slope,
        }
    }

    /// Makes it the best if it asks for more.
    fn raise(&self, best: &mut Option<Touch>) {
        if let Generator::Some { demand, rate, w, kind, surface, .. } = self.generator
            && best.is_none_or(|best| demand > best.demand)
        {
            let spot = Spot { delta: self.x, w, kind, surface };
            let (other, vertex, at_rack_edge) = (None, None, false);
            *best = Some(Touch { demand, rate, kind, spot, other, vertex, at_rack_edge });
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

/// What to do after an evaluation.
enum Next {
    Try(f64),
    Done,
    Nothing,
}

/// Shortest step after `run` steps the same way: where the derivative tells little of the distance the steps must grow.
fn stride(run: i32) -> f64 {
    match run {
        ..=2 => 0.0,
        3..=12 => INSIDE * f64::from(1 << (2 * (run - 3))),
        _ => std::f64::consts::PI,
    }
}

/// Longest step after `run` steps the same way from a hint that is good to `spread`.
fn reach(spread: f64, run: i32) -> f64 {
    spread * f64::from(1_u32 << (3 * run.clamp(0, 8)))
}

impl FlankContact {
    /// Largest demand for δ in `lo..=hi`, all or part of the flank that ends at `ends`; of `known` ends nothing is asked
    /// again.
    pub(super) fn climb(
        &self,
        pose: &Pose,
        (lo, hi): (f64, f64),
        ends: (f64, f64),
        (floor, hint): (f64, Option<Hint>),
        known: Option<(Sample, Sample)>,
    ) -> Option<Touch> {
        let scale = self.scale;
        let tolerance = DEMAND * scale;
        let (mut below, mut above) = known.map_or((None, None), |(low, high)| (Some(low), Some(high)));
        let mut best: Option<Touch> = None;
        for end in [below, above].into_iter().flatten() {
            end.raise(&mut best);
        }
        // where the involute starts at its base circle the derivative vanishes whichever way it goes: look beside it
        let (mut x, spread) = match hint {
            Some(Hint { delta, spread, .. }) if delta > lo && delta < hi => (delta, spread.max(NARROW)),
            _ => (0.0_f64.clamp(lo + INSIDE.min(0.25 * (hi - lo)), hi), f64::INFINITY),
        };
        let mut width = f64::INFINITY;
        let mut stalls = 0;
        // evaluations in a row that moved the same end of the bracket, negative for the upper one
        let mut run = 0_i32;
        let mut looked_beside = false;
        for _ in 0..MAX_EVALUATIONS {
            let sample = Sample { x, generator: self.demand(pose, x) };
            let mut silent = false;
            sample.raise(&mut best);
            if let Generator::Some { w, slope, .. } = sample.generator {
                let roll = (self.nu - pose.c) + x + self.kappa * w;
                // flank form may bend it less
                if self.form.is_none() && roll > 1e-3 && slope * slope <= 2.0 * tolerance * scale * roll {
                    break;
                }
                silent = self.form.is_none() && roll < SILENT && !looked_beside;
            }
            // on the base circle itself the derivative is rounding: the flank lies at greater δ, so look there once
            looked_beside |= silent;
            let slope = match (sample.generator, best) {
                // off the flank the way leads to where it was met, though the nearest edge may be another one
                (Generator::None { .. }, Some(best)) => best.spot.delta - x,
                _ if silent => f64::MIN_POSITIVE,
                _ => sample.slope(),
            };
            if slope > 0.0 && x < hi {
                below = Some(sample);
                run = run.max(0) + 1;
            } else if slope < 0.0 && x > lo {
                above = Some(sample);
                run = run.min(0) - 1;
            } else {
                // at an end of the flank that still leads outward: the end is a vertex, which moves with the flank
                if slope > 0.0 {
                    below = Some(sample);
                } else if slope < 0.0 {
                    above = Some(sample);
                }
                break;
            }
            let (a, b) = (below.map_or(lo, |s| s.x), above.map_or(hi, |s| s.x));
            if b - a <= 2.0 * f64::EPSILON * (a.abs() + b.abs()) {
                break;
            }
            stalls = if b - a > 0.5 * width { stalls + 1 } else { 0 };
            width = b - a;
            if let Some(bound) = self.bound(scale, below, above)
                && bound < floor
            {
                // kept as an upper bound, which never carries
                return best.map(|touch| Touch { demand: bound, ..touch });
            }
            let next = self.propose(
                pose,
                (scale, tolerance),
                (a, b, hi),
                (below, above),
                best.map(|best| best.demand),
                (run, spread),
            );
            x = match next {
                Next::Done => break,
                // a step that gains nothing
                Next::Try(x)
                    if self.form.is_some()
                        && (slope * (x - sample.x)).abs() <= tolerance
                        && below.is_some_and(|low| above.is_some_and(|high| low.is_as(&high))) =>
                {
                    break;
                }
                Next::Nothing => return None,
                // three steps that did not halve the bracket: halve it
                Next::Try(_) if stalls >= 3 && below.is_some() && above.is_some() => {
                    stalls = 0;
                    0.5 * (a + b)
                }
                Next::Try(x) => x,
            };
            if !(x > a && x < b)
                && (x != lo && x != hi || below.is_some_and(|s| s.x == x) || above.is_some_and(|s| s.x == x))
            {
                x = 0.5 * (a + b);
                if x <= a || x >= b {
                    break;
                }
            }
        }
        best.map(|touch| self.settle(touch, ends, below, above))
    }

    /// An upper bound of the demand between two samples: their tangents' intersection, and what any curvature can add.
    fn bound(&self, scale: f64, below: Option<Sample>, above: Option<Sample>) -> Option<f64> {
        let (Some(l), Some(h)) = (below, above) else { return None };
        let (Generator::Some { demand: fl, slope: sl, .. }, Generator::Some { demand: fh, slope: sh, .. }) =
            (l.generator, h.generator)
        else {
            return None;
        };
        let width = h.x - l.x;
        let meet = ((fh - fl) - sh * width) / (sl - sh);
        Some((fl + sl * meet).max(fl).max(fh) + (scale + self.base_radius) * width * width)
    }

    fn propose(
        &self,
        pose: &Pose,
        (scale, tolerance): (f64, f64),
        (a, b, hi): (f64, f64, f64),
        ends: (Option<Sample>, Option<Sample>),
        best: Option<f64>,
        (run, spread): (i32, f64),
    ) -> Next {
        match ends {
            (Some(l), Some(h)) => match (l.generator, h.generator) {
                (Generator::Some { demand: fl, slope: sl, .. }, Generator::Some { demand: fh, slope: sh, .. }) => {
                    let meet = ((fh - fl) + sl * a - sh * b) / (sl - sh);
                    let bound = fl + sl * (meet - a);
                    // the tangents bound a concave function; on a short bracket any smooth one, up to its square
                    if b - a <= NARROW && best.is_some_and(|best| bound - best <= tolerance) {
                        return Next::Done;
                    }
                    if l.is_as(&h) {
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
                    let bound = gl + sl * (meet - a) + 0.5 * self.gap_bend() * (b - a) * (b - a);
                    if bound < -super::VERTEX * self.half_face { Next::Nothing } else { Next::Try(meet) }
                }
                (Generator::None { gap, slope, .. }, _) => self.vertex((a, b), gap, slope),
                (_, Generator::None { gap, slope, .. }) => self.vertex((b, a), gap, slope),
            },
            (Some(l), None) => match l.generator {
                Generator::Some { slope, w, .. } => {
                    let roll = ((self.nu - pose.c) + a + self.kappa * w).max(0.1);
                    let step = (1.2 * slope / (scale * roll)).max(stride(run));
                    Next::Try((a + step.min(reach(spread, run))).min(b))
                }
                Generator::None { gap, slope, .. } => Next::Try((a - gap / slope).min(b)),
            },
            (None, Some(h)) => match h.generator {
                Generator::Some { slope, w, .. } => {
                    let roll = ((self.nu - pose.c) + b + self.kappa * w).max(0.1);
                    let inside = a + INSIDE.min(0.25 * (hi - a));
                    let step = (1.2 * slope / (scale * roll)).min(-stride(-run));
                    Next::Try((b + step.max(-reach(spread, -run))).max(if b > inside { inside } else { a }))
                }
                Generator::None { gap, slope, .. } => Next::Try((b - gap / slope).max(a)),
            },
            (None, None) => Next::Done,
        }
    }

    /// How far the gap between bounds on w may bend up over δ: bounds at the rack's end faces go with the flank's points,
    /// which turn about the pinion's axis, and how steeply they cross the rack divides that.
    fn gap_bend(&self) -> f64 {
        let turned = (self.across.t.abs() + self.across.z.abs()) * self.base_radius;
        let crossing = self.across.w.abs() - self.kappa.abs() * turned;
        if crossing > 0.0 { 4.0 * turned * (1.0 + self.tip_roll) / crossing } else { f64::INFINITY }
    }

    /// Between a generator off the flank and one on it that both lead towards its vertex: Newton's step on the gap
    /// says where the vertex is, to the step's square. That far inside it, and then outside it, both ends come close.
    fn vertex(&self, (off, on): (f64, f64), gap: f64, slope: f64) -> Next {
        let step = -gap / slope;
        let (vertex, inward) = (off + step, (on - off).signum());
        // this near the vertex a generator off the flank counts as on it
        let fuzz = (super::VERTEX * self.half_face / slope).abs();
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
    fn settle(&self, mut touch: Touch, (lo, hi): (f64, f64), below: Option<Sample>, above: Option<Sample>) -> Touch {
        if self.kappa == 0.0 && (touch.spot.delta == lo || touch.spot.delta == hi) {
            // the generators end at the involute's ends, which turn with it; on them the bound on w makes a corner
            // unless it is free
            let ends = [below, above].into_iter().flatten();
            for Sample { x, generator } in ends {
                if let Generator::Some { slope, .. } = generator
                    && x == touch.spot.delta
                {
                    touch.rate += slope;
                }
            }
            touch.kind = if self.fits || matches!(touch.kind, ContactKind::Line | ContactKind::Point) {
                if touch.spot.delta == hi { ContactKind::TipEdge } else { ContactKind::RootEdge }
            } else {
                ContactKind::Corner
            };
            return touch;
        }
        if let (Some(l), Some(h)) = (below, above)
            && let (
                Generator::Some { slope: sl, rate: rl, kind: kl, w: wl, surface: on_low, .. },
                Generator::Some { slope: sh, rate: rh, kind: kh, w: wh, surface: on_high, .. },
            ) = (l.generator, h.generator)
            && let share = -sh / (sl - sh)
            && if l.is_as(&h) {
                // flank form may bend the derivative so much that the best generator's is not the peak's
                self.form.is_some() && (0.0..=1.0).contains(&share)
            } else {
                // a higher place may have been met on the way, which none lies higher near: it is named as it was met
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
        // where the flank itself ends in a vertex, the vertex moves with c
        let vertex = match (below, above) {
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
