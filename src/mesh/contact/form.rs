//! Flanks with form: crowning, relief and slope. Called by [`FlankContact::touch`], [`FlankContact::demand`] and
//! [`FlankContact::roll_rate`] where a pair has any; plain flanks never come here. The demand on a generator is still
//! found in closed form; over the generators it is searched without derivatives.

use super::{
    Bound, ContactKind, Coordinates, DEMAND, FlankContact, Generator, Line, Plane, Pose, PoseRates, RollRates, Spot,
    Touch,
};
use crate::linear;

/// Flank form of both parts: how far the material stands back along the normal, mm, and how that acts on what a point
/// asks for. It is a property of each part: of the rolled rack, places are those in the rack itself.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mesh) struct Form {
    pub(in crate::mesh) rack_crowning: f64,
    pub(in crate::mesh) pinion_crowning: f64,
    pub(in crate::mesh) profile_slope: f64,
    pub(in crate::mesh) tip_relief: f64,
    pub(in crate::mesh) relief_start: f64,
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

/// How [`Form`] changes with the rack's roll.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mesh) struct FormRates {
    pub(in crate::mesh) per_normal: f64,
    pub(in crate::mesh) per_normal_on_tip: f64,
}

/// What decides the form at a point of the pinion: the demands of the planes, the place across the rack, the roll angle
/// and the place along the axis; and the same for how they change.
#[derive(Debug, Clone, Copy, Default)]
struct Local {
    flank: f64,
    tip: f64,
    across: f64,
    roll: f64,
    w: f64,
}

/// How something else than the place changes: by the rack's roll, and by the centre distance that is assumed.
#[derive(Debug, Clone, Copy, Default)]
struct Moving {
    rates: FormRates,
    /// Of the sine and cosine of the rack's roll.
    roll: (f64, f64),
    /// Of the constant part of the coordinate across the rack.
    across: f64,
}

/// The flank, the flank where it has tip relief, and the tip: the least of what they ask for counts.
const SURFACES: usize = 3;

impl FlankContact {
    /// How high in the rack the flank's plane is where the pinion's point is, above where the relief starts; and its
    /// derivative where the place changes by `by`.
    fn height(form: &Form, pose: &Pose, at: &Local, (by, moving): (&Local, &Moving)) -> (f64, f64) {
        let (sin, cos) = form.roll;
        let deep = at.flank + form.depth;
        (
            form.tip - cos * (at.tip - at.flank) + form.fall * (sin * deep - pose.across) - form.relief_start,
            -cos * (by.tip - by.flank) - moving.roll.1 * (at.tip - at.flank)
                + form.fall * (sin * by.flank + moving.roll.0 * deep - moving.across),
        )
    }

    /// What the surfaces ask for at a place, and the derivatives of that where the place changes by `by` and the rack
    /// as `moving` says.
    fn formed(&self, form: &Form, pose: &Pose, at: &Local, change: (&Local, &Moving)) -> [(f64, f64); SURFACES] {
        let (by, moving) = change;
        let (half_width, half_face) = (self.across.half_width, self.half_face);
        let (across, axial) = (at.across / half_width, at.w / half_face);
        let profile = (at.roll - self.start_roll) / (self.tip_roll - self.start_roll);
        let pinion = form.pinion_crowning * axial * axial + form.profile_slope * profile;
        let pinion_rate = 2.0 * form.pinion_crowning * axial * by.w / half_face
            + form.profile_slope * by.roll / (self.tip_roll - self.start_roll);
        let both = pinion + form.rack_crowning * across * across;
        let both_rate = pinion_rate + 2.0 * form.rack_crowning * across * by.across / half_width;
        let flank = |back: f64, rate: f64| {
            (at.flank - form.per_normal * back, by.flank - form.per_normal * rate - moving.rates.per_normal * back)
        };
        let (high, high_rate) = Self::height(form, pose, at, change);
        let relief = form.tip_relief / (form.tip - form.relief_start);
        [
            flank(both, both_rate),
            if form.tip_relief > 0.0 {
                flank(both + relief * high, both_rate + relief * high_rate)
            } else {
                (f64::INFINITY, 0.0)
            },
            (
                at.tip - form.per_normal_on_tip * pinion,
                by.tip - form.per_normal_on_tip * pinion_rate - moving.rates.per_normal_on_tip * pinion,
            ),
        ]
    }

    /// The place w on a generator.
    fn local(&self, at: &Coordinates, [flank, tip, y]: &[Line; 3], w: f64) -> Local {
        Local { flank: flank.at(w), tip: tip.at(w), across: y.at(w), roll: at.t0 + self.kappa * w, w }
    }

    /// The demand with flank form. Along a generator every surface asks for a polynomial of second degree in w, so the
    /// largest of the least of them is at an end, at the vertex of one or where two cross.
    pub(super) fn demand_with_form(
        &self,
        form: &Form,
        pose: &Pose,
        at: &Coordinates,
        (flank, tip): (Line, Line),
        (lo, hi): (Bound, Bound),
    ) -> Generator {
        let surfaces = self.along(form, pose, at, (flank, tip));
        let least = |w: f64| surfaces.iter().map(|surface| surface.at(w)).fold(f64::INFINITY, f64::min);
        // what asks for no more than rounding beyond the middle is as good: flanks without crowning touch along a line
        let middle = lo.w + 0.5 * (hi.w - lo.w);
        let tie = DEMAND * self.scale;
        let mut best = (least(middle), middle);
        let level = [lo.w, hi.w].into_iter().all(|w| (least(w) - best.0).abs() <= tie);
        let mut consider = |w: f64| {
            let value = least(w);
            if w >= lo.w && w <= hi.w && value > best.0 + tie {
                best = (value, w);
            }
        };
        consider(lo.w);
        consider(hi.w);
        for (index, surface) in surfaces.iter().enumerate() {
            consider(-surface.b / (2.0 * surface.a));
            for other in &surfaces[index + 1..] {
                surface.minus(other).roots().into_iter().for_each(&mut consider);
            }
        }
        let (demand, w) = best;
        let near = 1e-6 * self.half_face;
        let same = 1e-9 * self.half_face;
        let [plain, relieved, at_tip] = surfaces.map(|surface| surface.at(w));
        let flank = plain.min(relieved);
        let (on_tip, on_edge) = (at_tip < flank - same, (at_tip - flank).abs() <= same);
        let kind = match (w - lo.w < near, hi.w - w < near) {
            (true, _) => lo.kind,
            (_, true) => hi.kind,
            _ if on_edge => ContactKind::RackEdge,
            _ if level && w == middle => ContactKind::Line,
            _ => ContactKind::Point,
        };
        Generator::Some { demand, slope: f64::NAN, rate: f64::NAN, w, kind, on_tip }
    }

    /// What the surfaces ask for along a generator.
    fn along(&self, form: &Form, pose: &Pose, at: &Coordinates, (flank, tip): (Line, Line)) -> [Polynomial; SURFACES] {
        let line = |p: f64, q: f64| Polynomial { a: 0.0, b: q, c: p };
        let y = self.across_line(pose, at);
        let half_width = self.across.half_width;
        let crowning = line(y.p / half_width, y.q / half_width).squared().times(form.rack_crowning);
        let profile = form.profile_slope / (self.tip_roll - self.start_roll);
        let slope = line(at.t0 - self.start_roll, self.kappa).times(profile);
        let axial = line(0.0, 1.0 / self.half_face).squared().times(form.pinion_crowning);
        let pinion = axial.plus(&slope);
        let both = pinion.plus(&crowning);
        let [flank, tip] = [flank, tip].map(|plane| line(plane.p, plane.q));
        let (sin, cos) = form.roll;
        let level = form.tip - form.relief_start + form.fall * (sin * form.depth - pose.across);
        let high = tip.minus(&flank).times(-cos).plus(&flank.times(form.fall * sin)).plus(&line(level, 0.0));
        let relief = both.plus(&high.times(form.tip_relief / (form.tip - form.relief_start)));
        let plain = flank.minus(&both.times(form.per_normal));
        [
            plain,
            if form.tip_relief > 0.0 { flank.minus(&relief.times(form.per_normal)) } else { plain },
            tip.minus(&pinion.times(form.per_normal_on_tip)),
        ]
    }

    /// The derivatives of the demand at a point of contact by the rack's roll and by the centre distance that is
    /// assumed.
    pub(super) fn formed_roll_rate(
        &self,
        form: &Form,
        pose: &Pose,
        spot: &Spot,
        (rates, moved): (&RollRates, &PoseRates),
    ) -> [f64; 2] {
        let held = Held::new(self, form, pose, spot);
        let sweep = Self::sweep(&held.at, spot.w, rates, moved);
        let xi = held.at.xi.at(spot.w);
        let by_roll = |plane: &Plane| plane.d - plane.t * xi - plane.w * spot.w;
        let (sin, cos) = form.roll;
        let rolled = Local {
            flank: by_roll(&rates.flank) + moved.shift,
            tip: by_roll(&rates.tip),
            across: sweep[0],
            ..Local::default()
        };
        let raised = Local { across: sweep[1], ..Local::default() };
        let moving = [
            Moving { rates: rates.form, roll: (cos, -sin), across: moved.across[0] },
            Moving { across: moved.across[1], ..Moving::default() },
        ];
        [(rolled, moving[0]), (raised, moving[1])].map(|(by, moving)| {
            let end = |bound: &Bound| {
                if bound.kind == ContactKind::RackEndEdge { -by.across / held.lines[2].q } else { 0.0 }
            };
            held.rate(&by, &moving, end)
        })
    }

    /// Derivative-free maximum over generators, for flank form.
    pub(super) fn search(&self, form: &Form, pose: &Pose, (lo, hi): (f64, f64)) -> Option<Touch> {
        let scale = self.base_radius;
        // generators off the flank rank below all others, the nearer ones higher
        let value = |delta: f64| match self.demand(pose, delta) {
            Generator::Some { demand, .. } => demand,
            Generator::None { gap, .. } => NOWHERE * scale + 1e3 * gap,
        };
        // what plain flanks ask for may have a peak on either side of where it turns, and form changes it little
        let turn = self.jump().unwrap_or(lo.abs().max(hi.abs()));
        let ranges = [(lo, -turn), (lo.max(-turn), hi.min(turn)), (turn, hi)].into_iter().filter(|(lo, hi)| lo < hi);
        let peaks = ranges.map(|(lo, hi)| golden(lo, hi, &value));
        let mut delta = peaks.max_by(|&a, &b| value(a).total_cmp(&value(b))).unwrap_or(lo);
        if value(delta) <= NOWHERE * scale {
            // only few generators have points over the rack: look for them
            let at = |i: u32| lo + (hi - lo) * f64::from(i) / f64::from(CELLS);
            let best = (0..=CELLS).max_by(|&i, &j| value(at(i)).total_cmp(&value(at(j)))).unwrap_or(0);
            delta = golden(at(best.saturating_sub(1)), at((best + 1).min(CELLS)), &value);
        }
        match self.demand(pose, delta) {
            Generator::Some { demand, kind, w, on_tip, .. } => {
                let spot = Spot { delta, w, kind, on_tip };
                let held = Held::new(self, form, pose, &spot);
                let [flank, tip, across] = held.lines.map(|line| line.p_rate);
                let rate = held
                    .rate(&Local { flank, tip, across, roll: -1.0, w: 0.0 }, &Moving::default(), |bound| bound.rate);
                Some(Touch { demand, rate, kind, spot, other: None, spread: 0.0, vertex: None, at_rack_edge: false })
            }
            Generator::None { .. } => None,
        }
    }
}

/// a w² + b w + c
#[derive(Debug, Clone, Copy)]
struct Polynomial {
    a: f64,
    b: f64,
    c: f64,
}

impl Polynomial {
    fn at(&self, w: f64) -> f64 {
        (self.a * w + self.b) * w + self.c
    }

    fn times(&self, factor: f64) -> Self {
        Self { a: self.a * factor, b: self.b * factor, c: self.c * factor }
    }

    fn plus(&self, other: &Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.times(-1.0))
    }

    /// The square of a line.
    fn squared(&self) -> Self {
        Self { a: self.b * self.b, b: 2.0 * self.b * self.c, c: self.c * self.c }
    }

    /// Where it is zero; what is not finite is no such place.
    fn roots(&self) -> [f64; 2] {
        let root = (self.b * self.b - 4.0 * self.a * self.c).sqrt();
        let far = -0.5 * (self.b + root.copysign(self.b));
        [far / self.a, self.c / far]
    }
}

/// A point of contact, and how what is asked for there changes.
struct Held<'a> {
    contact: &'a FlankContact,
    form: &'a Form,
    pose: &'a Pose,
    spot: &'a Spot,
    at: Coordinates,
    /// The demands of flank and tip, and the coordinate across the rack.
    lines: [Line; 3],
    local: Local,
}

impl<'a> Held<'a> {
    fn new(contact: &'a FlankContact, form: &'a Form, pose: &'a Pose, spot: &'a Spot) -> Self {
        let at = contact.coordinates(pose, spot.delta);
        let lines = [
            FlankContact::plane(&contact.flank, pose.shift, &at),
            FlankContact::plane(&contact.tip, 0.0, &at),
            contact.across_line(pose, &at),
        ];
        let local = contact.local(&at, &lines, spot.w);
        Self { contact, form, pose, spot, at, lines, local }
    }

    /// The derivative of the largest demand by something that changes the place on a generator by `by` and the bounds
    /// on w by `end`.
    ///
    /// At a maximum of the least of several functions f_i within bounds g_j ≥ 0 there are shares λ_i ≥ 0, together 1,
    /// and μ_j ≥ 0 with Σ λ_i ∇f_i + Σ μ_j ∇g_j = 0, and the maximum changes as Σ λ_i f_i + Σ μ_j g_j does where
    /// the place stays.
    fn rate(&self, by: &Local, moving: &Moving, end: impl Fn(&Bound) -> f64) -> f64 {
        let (contact, still) = (self.contact, Moving::default());
        let surfaces = |by: &Local, moving| contact.formed(self.form, self.pose, &self.local, (by, moving));
        let place = |lines: [f64; 3], roll, w| Local { flank: lines[0], tip: lines[1], across: lines[2], roll, w };
        let along = surfaces(&place(self.lines.map(|line| line.q), contact.kappa, 1.0), &still);
        let turned = surfaces(&place(self.lines.map(|line| line.slope_at(self.spot.w)), 1.0, 0.0), &still);
        let roll_rate = by.roll;
        let by = surfaces(by, moving);
        let least = by.iter().map(|(demand, _)| *demand).fold(f64::INFINITY, f64::min);
        // what may hold the point: share in the sum, derivatives by δ and w, and what it changes by
        let (mut holding, mut count) = ([[0.0; 4]; MOST], 0);
        let mut hold = |row| {
            holding[count] = row;
            count += 1;
        };
        for ((along, turned), by) in along.iter().zip(&turned).zip(&by) {
            if by.0 - least <= SAME * contact.half_face {
                hold([1.0, turned.1 / contact.base_radius, along.1, by.1]);
            }
        }
        let edges = contact.edges(self.pose, &self.at).into_iter().flatten().chain([contact.pinion_ends()]);
        for (bound, sign) in edges.flat_map(|(low, high)| [(low, 1.0), (high, -1.0)]) {
            if (self.spot.w - bound.w).abs() <= AT_END * contact.half_face {
                hold([0.0, -sign * bound.slope / contact.base_radius, sign, -sign * end(&bound)]);
            }
        }
        if contact.kappa == 0.0 {
            // without a helix the ends of the involute bound δ
            for (end, sign) in [(contact.start_roll, 1.0), (contact.tip_roll, -1.0)] {
                if (self.at.t0 - end).abs() <= AT_END {
                    hold([0.0, sign / contact.base_radius, 0.0, sign * roll_rate]);
                }
            }
        }
        balanced(&holding[..count])
    }
}

/// What generators ask for that have no point over the rack, in base radii: less than any other.
const NOWHERE: f64 = -1e3;
/// Generators looked at where a search found none with points over the rack.
const CELLS: u32 = 64;
/// The surfaces, and the edges of both parts.
const MOST: usize = SURFACES + 6;
/// Demands nearer to each other than this share of the face width are the same.
const SAME: f64 = 1e-10;
/// Places nearer to an end than this share of the face width are at it.
const AT_END: f64 = 1e-8;

/// The last column's sum with non-negative shares of which those in the first column make 1 and the others 0, or
/// nearest to that; at most three share.
fn balanced(holding: &[[f64; 4]]) -> f64 {
    let mut best = (f64::INFINITY, f64::NAN);
    for chosen in 1_u32..1 << holding.len() {
        if chosen.count_ones() > 3 {
            continue;
        }
        let (mut rows, mut count) = ([[0.0; 4]; 3], 0);
        for (_, row) in holding.iter().enumerate().filter(|(i, _)| chosen & (1 << i) != 0) {
            rows[count] = *row;
            count += 1;
        }
        let rows = &rows[..count];
        let Some(shares) = least_squares(rows) else { continue };
        let sum = |column: usize| rows.iter().zip(&shares).map(|(row, share)| row[column] * share).sum::<f64>();
        let negative = shares.iter().map(|share| share.min(0.0));
        let off = [sum(0) - 1.0, sum(1), sum(2)].into_iter().chain(negative);
        let miss = off.map(|off| off * off).sum::<f64>();
        // of several as good the one with the fewest
        if miss < 0.5 * best.0 - 1e-20 {
            best = (miss, sum(3));
        }
    }
    best.1
}

/// Shares x of at most three rows with the least squares of Σ x_i row_i − (1, 0, 0) in the first three columns; `None` if
/// they are not determined.
fn least_squares(rows: &[[f64; 4]]) -> Option<[f64; 3]> {
    let (mut products, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for ((line, target), row) in products.iter_mut().zip(&mut right).zip(rows) {
        for (entry, other) in line.iter_mut().zip(rows) {
            *entry = (0..3).map(|column| row[column] * other[column]).sum();
        }
        *target = row[0];
    }
    linear::solve(products, right, rows.len())
}

/// Maximum of a unimodal function by golden section. The value is good to rounding, the place to its root.
fn golden(lo: f64, hi: f64, value: &impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (lo, hi);
    let (mut x, mut y) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut fx, mut fy) = (value(x), value(y));
    // 0.618^75 = 2e-16
    for _ in 0..75 {
        if fx >= fy {
            b = y;
            (y, fy) = (x, fx);
            x = b - RATIO * (b - a);
            fx = value(x);
        } else {
            a = x;
            (x, fx) = (y, fy);
            y = a + RATIO * (b - a);
            fy = value(y);
        }
    }
    let middle = 0.5 * (a + b);
    let mut best = (middle, value(middle));
    for end in [lo, hi] {
        let at_end = value(end);
        if at_end > best.1 {
            best = (end, at_end);
        }
    }
    best.0
}
