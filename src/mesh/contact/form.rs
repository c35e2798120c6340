//! Flanks with form: crowning, relief and slope. Called by [`FlankContact::touch`], [`FlankContact::demand`] and
//! [`FlankContact::roll_rate`] where a pair has any; plain flanks never come here.
//!
//! Along a generator each surface asks for a [`Polynomial`] of second degree in w, so that the largest of the least is at an
//! end, at the top of one or where two cross: the demand and its derivatives still are closed forms. Over the generators
//! it may have several [`peaks`].
//!
//! The same flank without form bounds from above what it asks for ([`Form::most_added`]); most others than the carrier end
//! there.

mod peaks;
mod polynomial;

pub(in crate::mesh) use self::peaks::Peaks;
use self::polynomial::Polynomial;
use super::{
    Bound, ContactKind, Coordinates, DEMAND, FlankContact, Generator, Line, Plane, Pose, PoseRates, RollRates, Surface,
};
use crate::deviation::{PinionForm, RackForm};

/// Flank form of both parts: how far the material stands back along the normal, mm, and what that does to the demand of a
/// point. Form belongs to each part: for a rolled rack, places are those in the rack itself.
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
    /// By how much more than without form a flank may ask for at most: crowning and relief only remove, a negative profile
    /// slope adds up to its amount along the normal.
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

/// The smallest demand of these surfaces counts.
const SURFACES: [Surface; 3] = [Surface::Flank, Surface::Relieved, Surface::Tip];

/// Bounds on w nearer to each other than this share of the face width are a vertex.
const SMALLEST: f64 = 1e-9;

/// The quantities at a point of the pinion that give the demands of the surfaces, all of which the rack's roll changes.
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
    /// Rates where nothing of the rack changes.
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

/// What determines the place of the largest demand on a generator.
#[derive(Debug, Clone, Copy)]
enum PeakHeldBy {
    /// Nothing: the surfaces ask for the same along the whole generator.
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
    /// The surface that asks for the least there; of two that cross, the first.
    least: usize,
    /// What the end of the generator that is farther away asks for; nothing where all of it asks for the same.
    rival: f64,
}

impl FlankContact {
    /// The demand of each surface; without relief the relieved surface is the flank.
    fn surfaces(&self, form: &Form, at: &Place) -> [Polynomial; 3] {
        let plain = self.surface(form, at, Surface::Flank);
        let relieved = if form.has_relief() { self.surface(form, at, Surface::Relieved) } else { plain };
        [plain, relieved, self.surface(form, at, Surface::Tip)]
    }

    /// The demand of one surface.
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

    /// A place on a generator with the given rates.
    fn changing(&self, on: &OnGenerator<'_>, w: f64, rates: &Rates) -> Place {
        let values = [0, 1, 2].map(|i| Polynomial::line(rates.lines[i], on.lines[i].at(w)));
        let roll = Polynomial::line(rates.roll, on.at.t0 + self.kappa * w);
        Place::new(on.form, on.pose, values, w.into(), roll)
    }

    /// The largest demand on a generator.
    fn peak(&self, on: &OnGenerator<'_>) -> Peak {
        let OnGenerator { form, pose, at, lines, lo, hi } = on;
        let surfaces = self.surfaces(form, &self.along(form, pose, at, lines));
        let asked = |w: f64| surfaces.iter().map(|surface| surface.at(w)).fold(f64::INFINITY, f64::min);
        // if no point asks for more than the middle by more than rounding, take the middle: flanks without crowning touch along a line
        let middle = lo.w + 0.5 * (hi.w - lo.w);
        let tie = DEMAND * self.scale;
        let at_middle = asked(middle);
        let level = [lo.w, hi.w].into_iter().all(|w| (asked(w) - at_middle).abs() <= tie);
        let least = |w: f64| {
            let demands = surfaces.map(|surface| surface.at(w));
            (0..SURFACES.len()).min_by(|&i, &j| demands[i].total_cmp(&demands[j])).unwrap_or(0)
        };
        let mut best = if hi.w - lo.w <= SMALLEST * self.half_face {
            // at a vertex the bound that counts is the one towards which the demand rises
            if surfaces[least(middle)].slope_at(middle) > 0.0 {
                (asked(hi.w), hi.w, PeakHeldBy::High)
            } else {
                (asked(lo.w), lo.w, PeakHeldBy::Low)
            }
        } else {
            (at_middle, middle, if level { PeakHeldBy::Level } else { PeakHeldBy::Top })
        };
        let mut consider = |w: f64, held: PeakHeldBy| {
            if w >= lo.w && w <= hi.w {
                let value = asked(w);
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
        let rival = match held {
            PeakHeldBy::Level => f64::NEG_INFINITY,
            _ => asked(if w > middle { lo.w } else { hi.w }),
        };
        Peak { demand, w, held, surfaces, least, rival }
    }

    /// How the largest demand on a generator changes with the rates of its place and of its ends.
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
            rival: peak.rival,
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
}

#[cfg(test)]
mod tests;
