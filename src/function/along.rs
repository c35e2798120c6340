//! A yoke along a solved curve: the extremes of its play and of its forces. Solves further strokes where a force is largest
//! between points of the curve, and at the stroke at which the play is set.

use super::play::{Setting, Window};
use super::torque::{AtStroke, ForcesAt, N_MM, SetYoke, lift_off_per_newton};
use super::{SetAt, Yoke};
use crate::judge::Verdict;
use crate::mesh::{Curve, Mesh, MeshError, MeshPoint, Rates, Sampler, largest_swing};
use crate::multibody::Extent;
use crate::parallel;

/// A torque of the pinion along the stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torque {
    /// Mean and extremes, N m; the mean is the work over the angle, ∫ T dθ / θ.
    pub extent: Extent,
    /// Largest less smallest within any one turn of the pinion, N m.
    pub fluctuation_in_a_turn_n_m: f64,
}

impl Torque {
    /// Largest less smallest over the stroke, N m.
    #[must_use]
    pub fn fluctuation_n_m(&self) -> f64 {
        self.extent.largest - self.extent.smallest
    }
}

/// Forces along the stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forces {
    /// Force F of the yoke, N.
    pub yoke_n: Extent,
    /// The pinion's torque as s rises.
    pub rising: Torque,
    /// The pinion's torque as s falls.
    pub falling: Torque,
    /// The part of the torque that lifts the yoke as s rises, N m; it has the other sign as s falls.
    pub lifting_n_m: Extent,
    /// The part of the torque for friction of the yoke on the rack, N m.
    pub yoke_friction_n_m: Extent,
    /// The part of the torque for friction at the teeth, N m.
    pub tooth_friction_n_m: Extent,
    /// Force along the rack at which one side of the teeth unloads, N.
    pub lift_off_n: Extent,
}

/// The play and the forces of a yoke over a range of strokes.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// First and last stroke, mm.
    pub strokes_mm: (f64, f64),
    /// Stroke s_0 at which the play is set, mm.
    pub set_at_mm: f64,
    /// The point with the smallest ΔCD, where the play is largest.
    pub lowest: MeshPoint,
    /// The point with the largest ΔCD, where the play is smallest.
    pub highest: MeshPoint,
    /// The settings that keep the window; `None` without a window, or if no setting keeps it.
    pub setting: Option<Setting>,
    /// Play J_0 at s_0, mm: as given, or else the middle of the settings; `None` without either.
    pub play_mm: Option<f64>,
    /// Forces; `None` without a preload, or if some point of the curve has no rates.
    pub forces: Option<Forces>,
    /// Play and forces at each point of the curve.
    pub along: Vec<AtStroke>,
    /// Whether the curve is resolved, and each of its points and s_0 is solved; otherwise play and torque are uncertain.
    pub is_solved: bool,
    set: SetYoke,
}

/// Values of ΔCD that differ by less than this are equal, mm.
const TIE_MM: f64 = 1e-11;

/// The number of points whose rates one sampler computes in turn.
const BLOCK: usize = 256;

impl Function {
    /// The yoke along a curve of the mesh; `None` if the curve has no points.
    ///
    /// # Errors
    /// [`MeshError`] if there is no mesh where the play is set.
    pub fn of(mesh: &Mesh, curve: &Curve, yoke: &Yoke, window: Option<&Window>) -> Result<Option<Self>, MeshError> {
        let points = &curve.points;
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return Ok(None) };
        let [lowest, highest] = [-1.0, 1.0].map(|sign: f64| first_peak(points, |point| sign * point.delta_cd_mm));
        let set_at = match yoke.set_at {
            SetAt::Tightest => highest,
            SetAt::Stroke(stroke_mm) => mesh.at(stroke_mm)?,
        };
        let at_mm = set_at.delta_cd_mm;
        let setting = window.and_then(|window| window.settings(lowest.delta_cd_mm, highest.delta_cd_mm, at_mm));
        let play_mm = yoke.play_mm.or_else(|| setting.and_then(|setting| setting.middle_mm()));
        let lift_off = lift_off_per_newton(mesh.pair(), yoke.tooth_friction.unwrap_or(0.0));
        let set = SetYoke { yoke: *yoke, at_mm, play_mm, lift_off };
        let along = along(mesh, points, &set);
        Ok(Some(Self {
            strokes_mm: (first.stroke_mm, last.stroke_mm),
            set_at_mm: set_at.stroke_mm,
            lowest,
            highest,
            setting,
            play_mm,
            forces: Along { mesh, points, at: &along, set: &set }.forces(),
            along,
            is_solved: curve.resolved && points.iter().chain([&set_at]).all(MeshPoint::is_solved),
            set,
        }))
    }

    /// V = max ΔCD − min ΔCD, mm.
    #[must_use]
    pub fn variation_mm(&self) -> f64 {
        self.highest.delta_cd_mm - self.lowest.delta_cd_mm
    }

    /// ΔCD(s_0), mm.
    #[must_use]
    pub const fn at_mm(&self) -> f64 {
        self.set.at_mm
    }

    /// Smallest and largest play, mm; `None` if no play is set.
    #[must_use]
    pub fn plays_mm(&self) -> Option<(f64, f64)> {
        let play = |point: &MeshPoint| Some(self.play_mm? - (point.delta_cd_mm - self.set.at_mm));
        Some((play(&self.highest)?, play(&self.lowest)?))
    }

    /// Whether the play that is set is one of the settings.
    pub(super) fn keeps_window(&self) -> Verdict {
        let is_kept = self.setting.zip(self.play_mm).is_some_and(|(setting, play)| setting.contains(play));
        if is_kept { Verdict::Pass } else { Verdict::Fail }
    }

    /// Play and forces at another stroke of the same mesh.
    #[must_use]
    pub fn at(&self, point: &MeshPoint, rates: Option<Rates>) -> AtStroke {
        self.set.at(point, rates)
    }
}

/// The first point at which a value is largest, up to rounding.
fn first_peak(points: &[MeshPoint], of: impl Fn(&MeshPoint) -> f64) -> MeshPoint {
    let largest = points.iter().map(&of).fold(f64::NEG_INFINITY, f64::max);
    *points.iter().find(|point| of(point) >= largest - TIE_MM).unwrap_or(&points[0])
}

/// Play and forces at each point, on all cores.
fn along(mesh: &Mesh, points: &[MeshPoint], set: &SetYoke) -> Vec<AtStroke> {
    let block = |(): &mut (), index: usize| -> Vec<AtStroke> {
        let mut sampler = Sampler::new(mesh);
        let points = &points[index * BLOCK..points.len().min((index + 1) * BLOCK)];
        points.iter().map(|point| set.at(point, sampler.rates(point))).collect()
    };
    parallel::map(parallel::cores(), points.len().div_ceil(BLOCK), || (), block).0.concat()
}

/// Solved points with their values.
struct Along<'a> {
    mesh: &'a Mesh,
    points: &'a [MeshPoint],
    at: &'a [AtStroke],
    set: &'a SetYoke,
}

/// A force at a stroke.
type Of = fn(&ForcesAt) -> f64;

/// Largest values that differ by less than this share are equal.
const TIE: f64 = 1e-9;

/// Steps of the search for a largest value between points; each shortens the interval to 0.62.
const STEPS: u32 = 40;

impl Along<'_> {
    /// The forces along the stroke, if they are known at each point.
    fn forces(&self) -> Option<Forces> {
        let forces: Option<Vec<ForcesAt>> = self.at.iter().map(|at| at.forces).collect();
        let forces = forces?;
        let extent = |of: Of, mean: f64| self.extent(&forces, of, mean);
        let by_stroke = |of: Of| extent(of, self.mean(&forces, of, |point| point.stroke_mm));
        let by_angle = |of: Of| extent(of, self.mean(&forces, of, |point| point.pinion_angle_rad));
        let [yoke_friction_n_m, tooth_friction_n_m] =
            [by_angle(|at| at.yoke_friction_n_m), by_angle(|at| at.tooth_friction_n_m)];
        // exact, because the yoke's force is linear in ΔCD
        let lifting = self.work(&forces, |at| at.yoke_n, |point| point.delta_cd_mm) / self.turned() / N_MM;
        let lifting_n_m =
            extent(|at| at.lifting_n_m, if lifting.is_finite() { lifting } else { forces[0].lifting_n_m });
        let resting =
            yoke_friction_n_m.mean + tooth_friction_n_m.mean + self.set.yoke.bearing_torque_n_m.unwrap_or(0.0);
        Some(Forces {
            yoke_n: by_stroke(|at| at.yoke_n),
            rising: self.torque(&forces, |at| at.rising_n_m, resting + lifting_n_m.mean),
            falling: self.torque(&forces, |at| at.falling_n_m, resting - lifting_n_m.mean),
            lifting_n_m,
            yoke_friction_n_m,
            tooth_friction_n_m,
            lift_off_n: by_stroke(|at| at.lift_off_n),
        })
    }

    fn torque(&self, forces: &[ForcesAt], of: Of, mean: f64) -> Torque {
        let extent = self.extent(forces, of, mean);
        let pair = self.mesh.pair();
        let turn = pair.rack().pitch_mm * f64::from(pair.pinion().teeth);
        let values = self.points.iter().zip(forces).map(|(point, at)| (point.stroke_mm, of(at)));
        let is_short = self.points.last().is_some_and(|last| last.stroke_mm - self.points[0].stroke_mm <= turn);
        let all = extent.largest - extent.smallest;
        Torque { extent, fluctuation_in_a_turn_n_m: if is_short { all } else { largest_swing(values, turn).min(all) } }
    }

    /// The angle by which the pinion turns, rad.
    fn turned(&self) -> f64 {
        self.points.last().map_or(0.0, |last| last.pinion_angle_rad) - self.points[0].pinion_angle_rad
    }

    /// The integral of a force over a quantity that changes along the stroke.
    fn work(&self, forces: &[ForcesAt], of: impl Fn(&ForcesAt) -> f64, way: impl Fn(&MeshPoint) -> f64) -> f64 {
        let ways = self.points.windows(2).map(|two| way(&two[1]) - way(&two[0]));
        let means = forces.windows(2).map(|two| 0.5 * (of(&two[0]) + of(&two[1])));
        ways.zip(means).map(|(way, mean)| way * mean).sum()
    }

    /// The mean of a force over a way; its value for a way of 0.
    fn mean(&self, forces: &[ForcesAt], of: Of, way: fn(&MeshPoint) -> f64) -> f64 {
        let all = self.points.last().map_or(0.0, way) - way(&self.points[0]);
        if all > 0.0 { self.work(forces, of, way) / all } else { of(&forces[0]) }
    }

    fn extent(&self, forces: &[ForcesAt], of: Of, mean: f64) -> Extent {
        let [(smallest_stroke_mm, smallest), (largest_stroke_mm, largest)] =
            [-1.0, 1.0].map(|sign| self.peak(forces, of, sign));
        Extent { mean, smallest, smallest_stroke_mm, largest, largest_stroke_mm }
    }

    /// The stroke at which a force is largest (smallest for `sign` −1), and the force: at a point of the curve, on either side
    /// of a kink, or between points with the same carriers.
    fn peak(&self, forces: &[ForcesAt], of: Of, sign: f64) -> (f64, f64) {
        let value = |index: usize| sign * of(&forces[index]);
        let largest = (0..forces.len()).reduce(|a, b| if value(b) > value(a) { b } else { a }).unwrap_or(0);
        let tie = TIE * value(largest).abs();
        let first = (0..largest).find(|index| value(*index) >= value(largest) - tie).unwrap_or(largest);
        let found = self.between(largest, |at| sign * of(at));
        let (stroke_mm, best) = found
            .filter(|found| found.1 > value(largest) + tie)
            .unwrap_or((self.points[first].stroke_mm, value(largest)));
        (stroke_mm, sign * best)
    }

    /// The largest value between a point and its neighbours with the same carriers, by the golden section.
    fn between(&self, index: usize, of: impl Fn(&ForcesAt) -> f64) -> Option<(f64, f64)> {
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let here = &self.points[index];
        let alike = |other: usize| {
            let other = self.points.get(other).filter(|other| (other.right, other.left) == (here.right, here.left));
            other.unwrap_or(here).stroke_mm
        };
        let (mut low, mut high) = (alike(index.wrapping_sub(1)), alike(index + 1));
        let mut sampler = Sampler::new(self.mesh);
        let mut at = |stroke_mm: f64| {
            let point = sampler.at(stroke_mm).ok()?;
            let rates = sampler.rates(&point);
            Some((stroke_mm, of(&self.set.at(&point, rates).forces?)))
        };
        let inner = |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let [mut a, mut b] = [at(inner(low, high)[0])?, at(inner(low, high)[1])?];
        for _ in 0..if low < high { STEPS } else { 0 } {
            if a.1 >= b.1 {
                (high, b) = (b.0, a);
                a = at(inner(low, high)[0])?;
            } else {
                (low, a) = (a.0, b);
                b = at(inner(low, high)[1])?;
            }
        }
        Some(if a.1 >= b.1 { a } else { b })
    }
}
