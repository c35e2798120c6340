//! Which parts of a pinion's flank provably cannot touch a rack's flank, by a bound. Both contact models call it before they
//! compute any gap; it adds no force.
//!
//! # Why that changes nothing
//! Written for spheres; strips are spheres of the radius 0.
//!
//! Let D be the height of a sphere's lowest point over the rack flank's plane. The distance of its centre from the
//! patch is at least its height over the plane ([`super::closest`]; form only removes material), so D ≥ 0 is clear.
//! With the roll angle τ_* at which a row crosses the contact line, δ = τ − τ_*, and N_t the normal's part in
//! the pinion's transverse plane, a row has
//!
//! ```text
//! D = const + |N_t| r_b [τ (1 − cos δ) + sin δ − δ] − R(τ) |N_t| cos β_b (1 − cos δ) − R(τ) ε + removed(τ),
//! ```
//!
//! ε = 1 − sin β_b N_w − cos β_b |N_t| ≥ 0 a constant (0 if the lead fits). Let H be D without its last two terms.
//! - δ < 0: H falls with τ, because |sin δ| (r_b τ − R cos β_b) ≥ 0 (R ≤ C τ², C cos β_b τ ≤ r_b) and R' ≥ 0.
//! - δ > 0: dH/dτ = |N_t| [sin δ (r_b τ − R cos β_b) − R' cos β_b (1 − cos δ)]. Where R = R_0 the last term is 0 and
//!   the first not negative; where R = C τ² it is |N_t| τ sin δ [r_b − C cos β_b (τ + 2 tan(δ/2))] ≥ 0 by the choice of
//!   C, as long as δ ≤ τ_a + ½, that is τ_* ≥ −½.
//!
//! So H grows to both sides of τ_*. A walk outwards may stop at the first D ≥ R_0 ε + (max − min of removed), since
//! then every later D ≥ 0. Rows with τ_* < τ_0 − ½ are not walked but gone through.
//!
//! Whole rows and flanks: on the contact line H is L = const, linear in w. Where τ_* ≥ 0 nothing of a row lies lower,
//! so L ≥ R_0 ε + … (the bound above) clears it. For −½ ≤ τ_* < 0 the lowest H is at τ = 0 or later, where the bracket
//! is at least r_b ∫ τ sin(τ − τ_*) dτ from τ_* to 0, which is r_b (sin x − x) ≥ −r_b x³/6 with x = −τ_*; L less
//! |N_t| r_b x³/6 must then reach the bound. That function is concave in w, so a flank is clear if it is at both its
//! ends. A row whose line lies beyond the tip, τ_a < τ_*, has at its lowest node H ≥ L + |N_t| (r_b τ_a − R cos β_b)
//! (1 − cos δ), and 1 − cos δ ≥ (1 − cos 1) min(δ², 1).
//!
//! Rows whose line lies before the profile's start meet the rack above its tip, if at all. A sphere with the lowest
//! point D < 0 touches only if the foot of its centre lies less than m = √(|D| (|D| + 2R)) beyond the patch. That foot
//! is not lower than the flank's point itself, less R (|N_t| − cos β_b) if that is positive, as long as ν ≤ γ ≤ π − ν;
//! and from its height at the start, z_s, the flank falls by at most r_b cos γ_s (τ² − τ_0²)/2. So spheres below the τ
//! at which that reaches the tip's height plus m are clear, with |D| bounded as above; from there H grows. On a rack
//! that is rolled by φ about an axis at the depth d a foot within the face width plus m and at z ≤ z_tip + m lies at
//! most (k/2 + m) |sin φ| + |z_tip + m + d| (1 − cos φ) higher than on one that is not, which is taken off.
//!
//! A pinion point at the polar angle χ from straight down lies at Z ≥ a − e − r_a cos χ, e the eccentricity, and
//! no point of the rack is higher than its tip edge; a sphere whose flank point lies 2 R_0 higher than that is clear,
//! because its centre is within R_0 of that point.
//!
//! Where spheres below a small height over the face count although they do not touch, that height is added to the bounds, and
//! clear means that much higher, or with the foot not on the patch.

use super::flank::FlankPosition;
use super::template::{EARLY, Template};

/// The scene's constants for all flanks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    pub(super) cull: bool,
    /// Whether the rack's roll is a coordinate.
    pub(super) rolls: bool,
    /// Polar angle beyond which no pinion point meets the rack.
    pub(super) polar: f64,
    /// Height below which a sphere on a plane face is remembered although it does not touch, mm.
    pub(super) margin: f64,
}

/// Added to the bound at which a walk stops, mm: rounding of D is a hundredth of it.
pub(super) const SLACK: f64 = 1e-11;

/// 1 − cos 1, rounded down.
pub(super) const BEND: f64 = 0.459_697;

/// Constants of the bound that clears whole rows of a flank.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bound {
    /// Height at which a sphere's lowest point is clear of the plane in every case.
    pub(super) stop: f64,
    /// L = level + slope w and τ_* = line + κ w.
    level: f64,
    slope: f64,
    line: f64,
    kappa: f64,
    /// |N_t| r_b / 6 and |N_t| (r_b τ_a − R cos β_b) (1 − cos 1).
    pub(super) early: f64,
    late: f64,
    tip: f64,
}

impl Bound {
    /// `margin`: how much higher a sphere must be to be passed over.
    pub(super) fn new(template: &Template, placed: &FlankPosition, margin: f64) -> Self {
        let FlankPosition { n_w, length, .. } = *placed;
        let misfit = (1.0 - template.sin_base * n_w - template.cos_base * length).max(0.0);
        let line = placed.nu - placed.c;
        let per_roll = length * template.base_radius;
        Self {
            stop: template.widest * misfit + template.form.profile_slope_mm.abs() + SLACK + margin,
            level: placed.base - per_roll * line,
            slope: n_w - per_roll * template.kappa,
            line,
            kappa: template.kappa,
            early: per_roll / 6.0,
            late: length * template.last_reach.max(0.0) * BEND,
            tip: template.tip_roll,
        }
    }

    /// Whether nothing of a flank touches; the part beyond the tip is convex, so it is judged without it.
    pub(super) fn clears_flank(&self, half_face: f64) -> bool {
        let whole = Self { late: 0.0, ..*self };
        whole.clears(-half_face) && whole.clears(half_face)
    }

    /// Height of the section at w over the rack's plane on its contact line.
    pub(super) fn height(&self, w: f64) -> f64 {
        self.level + self.slope * w
    }

    /// Whether no sphere of the section at w touches, if its contact line is not too early to say.
    pub(super) fn clears(&self, w: f64) -> bool {
        let crossing = self.line + self.kappa * w;
        let mut height = self.height(w);
        if crossing > self.tip {
            let beyond = crossing - self.tip;
            height += self.late * (beyond * beyond).min(1.0);
        } else if crossing < 0.0 {
            if crossing < -EARLY {
                return false;
            }
            height += self.early * crossing * crossing * crossing;
        }
        height >= self.stop
    }
}

/// Rows that reach down to the rack's tip.
pub(super) fn row_range(template: &Template, placed: &FlankPosition, polar: f64) -> std::ops::Range<usize> {
    // a row's centre line lies at the polar angle tooth_angle − sign κ w
    let (rows, angle) = (&template.rows, placed.tooth_angle * placed.sign);
    let widest = polar + template.tooth_reach;
    if template.kappa == 0.0 {
        return if angle.abs() <= widest { 0..rows.len() } else { 0..0 };
    }
    let (one, other) = ((angle - widest) / template.kappa, (angle + widest) / template.kappa);
    let (low, high) = (one.min(other), one.max(other));
    let (first, step) = (rows[0].w, template.row_step());
    // rows before and after, counted with one to spare; casts cut off at both ends
    let before = |w: f64| if step > 0.0 { ((w - first) / step) as usize } else { 0 };
    let to = if high < first { 0 } else { before(high).saturating_add(2).min(rows.len()) };
    before(low).min(to)..to
}
