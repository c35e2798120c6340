//! The search for errors of single teeth: the differences that a set of them leaves, how much one more explains, and the sizes
//! that together fit best.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::curves::{Curve, Curves};
use super::sight::{Effects, Explains, Sight};
use super::starts::SHIFTS;
use super::tooth_error::{ToothError, ToothErrorKind, with_errors};
use super::{Overlay, TraceError, TracePoint, sampled};
use crate::mesh::{Mesh, MeshPoint, PairLine, Sampler, Support};
use crate::parallel;

/// The size of the errors that are checked for not showing in the curve, mm.
pub const UNSEEN_MM: f64 = 0.02;
/// Errors whose χ² differs by less than this have the same curve.
pub(super) const SAME_CURVE: f64 = 9.0;
/// Magnitudes at which every error is tried first, with both signs, mm.
const SIZES_MM: [f64; 2] = [UNSEEN_MM, 0.07];
/// Largest probability that an error is found in a curve without one, by Bonferroni over all errors tried.
const FALSE_ALARM: f64 = 0.01;
/// Step of an error's size for slopes of the curve, mm.
const STEP_MM: f64 = 2e-4;
/// Strokes in a pitch for the first, coarse comparison.
pub(super) const FIRST_LOOK: u8 = 12;
/// The number of errors that are compared more closely.
const CLOSER: usize = 48;

/// The settings of a search for errors of single teeth.
#[derive(Debug, Clone, Copy, Default)]
pub struct DiagnosisRequest {
    /// Standard deviation of the measurement's noise, mm; estimated from the curve if not given.
    pub noise_mm: Option<f64>,
    /// Whether the pinion is a master, so that all errors are the rack's.
    pub is_master: bool,
}

/// Is called with the number of errors found and the share of candidates tried; may end the search.
pub type Watch<'w> = dyn FnMut(usize, f64) -> ControlFlow<()> + 'w;

/// Measured points, or means of neighbouring points: stroke, ΔCD, and the number of points in each.
pub(super) type Points = Vec<(f64, f64, f64)>;

/// The mesh with some errors: each point, and what every flank pair asks for there.
struct Lines {
    mesh: Mesh,
    at: Vec<(MeshPoint, Vec<PairLine>)>,
}

/// A search under way: the measured points, the candidates, and the errors found so far.
#[derive(Clone)]
pub(super) struct Search<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) points: Points,
    pub(super) means: Points,
    pub(super) noise_mm: f64,
    pub(super) fits: bool,
    pub(super) is_master: bool,
    pub(super) candidates: Vec<ToothError>,
    pub(super) threshold: f64,
    pub(super) errors: Vec<(ToothError, f64)>,
    pub(super) shift_mm: f64,
    /// The curves solved last.
    pub(super) curves: Curves,
}

/// The noise of a curve, mm, from the median of its second differences, which a few steps do not change.
fn estimated_noise_mm(overlay: &Overlay) -> f64 {
    /// The median of a normal distribution's magnitude, and the standard deviation of a − 2 b + c.
    const MEDIAN: f64 = 0.674_49;
    const OF_SECOND: f64 = 2.449_49;
    /// The finest resolution of a gauge, mm.
    const LEAST_MM: f64 = 1e-5;
    let differences: Vec<f64> = overlay.differences_mm().collect();
    let mut second: Vec<f64> = differences.windows(3).map(|of| (of[0] - 2.0 * of[1] + of[2]).abs()).collect();
    second.sort_by(f64::total_cmp);
    let median = second.get(second.len() / 2).copied().unwrap_or_default();
    (median / (MEDIAN * OF_SECOND)).max(LEAST_MM)
}

/// Sizes around one, at which the search for the best size begins.
pub(super) fn near(size_mm: f64) -> Vec<f64> {
    [0.9, 1.0, 1.1].map(|share| share * size_mm).into()
}

/// Means of points within a share of a pitch.
fn means(points: &Points, width_mm: f64) -> Points {
    let mut means: Points = Vec::new();
    let mut bin = i64::MIN;
    for (stroke, delta_cd, count) in points {
        let own = (stroke / width_mm).floor() as i64;
        match means.last_mut() {
            Some(mean) if own == bin => {
                *mean = (mean.0 + stroke, mean.1 + delta_cd, mean.2 + count);
            }
            _ => means.push((*stroke, *delta_cd, *count)),
        }
        bin = own;
    }
    means.into_iter().map(|(stroke, delta_cd, count)| (stroke / count, delta_cd / count, count)).collect()
}

impl<'a> Search<'a> {
    pub(super) fn new(mesh: &'a Mesh, overlay: &Overlay, request: DiagnosisRequest) -> Self {
        let shift_mm = overlay.placement.as_ref().map_or(0.0, super::Placement::shift_mm);
        let points: Points = overlay
            .points
            .iter()
            .map(|TracePoint { stroke_mm, delta_cd_mm }| (*stroke_mm, *delta_cd_mm, 1.0))
            .collect();
        let mut search = Self {
            mesh,
            means: means(&points, mesh.pair().rack().pitch_mm / f64::from(FIRST_LOOK)),
            points,
            noise_mm: request.noise_mm.unwrap_or_else(|| estimated_noise_mm(overlay)),
            fits: overlay.placement.is_some(),
            is_master: request.is_master,
            threshold: 0.0,
            candidates: Vec::new(),
            errors: Vec::new(),
            shift_mm,
            curves: Curves::default(),
        };
        search.candidates = search.within_reach([shift_mm; 2]);
        // the tail of χ² with one degree of freedom is below exp(−χ²/2)
        let tried = search.candidates.len().max(1) * if search.fits { SHIFTS } else { 1 };
        search.threshold = 2.0 * libm::log(2.0 * tried as f64 / FALSE_ALARM);
        search
    }

    /// The errors of the teeth that the strokes reach at shifts from one to another.
    pub(super) fn within_reach(&self, [from_mm, to_mm]: [f64; 2]) -> Vec<ToothError> {
        let [first, last] = [self.points.first(), self.points.last()].map(|end| end.map_or(0.0, |end| end.0));
        ToothError::all(self.mesh.pair(), (first - to_mm, last - from_mm), self.is_master)
    }

    /// The search at another stroke shift, among the teeth that its strokes reach.
    pub(super) fn moved_to(&self, shift_mm: f64) -> Self {
        Self { shift_mm, candidates: self.within_reach([shift_mm; 2]), ..self.clone() }
    }

    /// The differences that some errors leave at points; with `fits_sizes` their sizes are fitted together with another error's.
    pub(super) fn sight(
        &self,
        errors: &[(ToothError, f64)],
        points: &Points,
        fits_sizes: bool,
    ) -> Result<Sight, TraceError> {
        let curve = self.curve(errors, points, self.shift_mm)?;
        let measured: Vec<f64> = points.iter().map(|(_, delta_cd, _)| *delta_cd).collect();
        let weights: Vec<f64> = points.iter().map(|(.., count)| count / (self.noise_mm * self.noise_mm)).collect();
        let mut columns = self.placing(&curve, &weights);
        for (error, _) in errors.iter().filter(|_| fits_sizes) {
            let slopes = self.effect(errors, *error, STEP_MM, (&curve.strokes_mm, &curve.model_mm));
            columns.push(slopes.unwrap_or_default().iter().map(|mm| mm / STEP_MM).collect());
        }
        Ok(Sight::new((curve.strokes_mm.clone(), curve.model_mm.clone()), &measured, weights, &columns))
    }

    /// The computed curve with some errors below points, at a stroke shift.
    fn curve(&self, errors: &[(ToothError, f64)], points: &Points, shift_mm: f64) -> Result<Arc<Curve>, TraceError> {
        self.curves.of(self.mesh, errors, points.iter().map(|(stroke, ..)| stroke - shift_mm).collect())
    }

    /// The columns of offset and stroke shift, if they are fitted; that of the shift only if the curve determines it.
    fn placing(&self, curve: &Curve, weights: &[f64]) -> Vec<Vec<f64>> {
        const TOLD: f64 = 0.1;
        if !self.fits {
            return Vec::new();
        }
        let (ones, zeros) = (vec![1.0; weights.len()], || vec![0.0; weights.len()]);
        let alone = Sight::new((zeros(), zeros()), &zeros(), weights.to_vec(), std::slice::from_ref(&ones));
        let told_mm = TOLD * self.mesh.pair().rack().pitch_mm;
        let is_told = alone.visible(&curve.slopes) * told_mm * told_mm > 1.0;
        if is_told { vec![ones, curve.slopes.clone()] } else { vec![ones] }
    }

    /// The effect of an error of a size beside some errors. The computed curve with these is `model` at `strokes`. `None` for
    /// impossible teeth.
    pub(super) fn effect(
        &self,
        errors: &[(ToothError, f64)],
        error: ToothError,
        size_mm: f64,
        (strokes, model): (&[f64], &[f64]),
    ) -> Option<Vec<f64>> {
        let mesh = with_errors(self.mesh, &[errors, &[(error, size_mm)]].concat())?;
        let acts = error.acts(mesh.pair());
        let solved = sampled(&mesh, &strokes.iter().copied().filter(|mm| acts(*mm)).collect::<Vec<_>>()).ok()?;
        let mut solved = solved.into_iter();
        let at =
            |(stroke, model): (&f64, _)| if acts(*stroke) { solved.next().map(|mm| mm - model) } else { Some(0.0) };
        strokes.iter().zip(model).map(at).collect()
    }

    /// The mesh with some errors at strokes, for approximate effects; `None` if the rack may roll.
    fn lines(&self, errors: &[(ToothError, f64)], strokes_mm: &[f64]) -> Result<Option<Lines>, TraceError> {
        if self.mesh.support() != Support::Fixed {
            return Ok(None);
        }
        let mesh = with_errors(self.mesh, errors).ok_or(TraceError::NoSuchErrors)?;
        let mut sampler = Sampler::new(&mesh);
        let mut at = |stroke: &f64| -> Result<_, TraceError> {
            let point = sampler.at(*stroke)?;
            Ok((point, sampler.lines(&point, |_, _| true).ok_or(TraceError::NoSuchErrors)?))
        };
        let at = strokes_mm.iter().map(&mut at).collect::<Result<_, _>>()?;
        Ok(Some(Lines { mesh, at }))
    }

    /// The approximate effect of an error of a size at the points of these lines, which are straight over the rotation and the
    /// displacement of a flank; only flanks that are turned are solved. It takes a hundredth of the time of
    /// [`effect`](Self::effect), which takes its place where there are no lines.
    fn rough_effect(
        &self,
        errors: &[(ToothError, f64)],
        (error, size_mm): (ToothError, f64),
        (sight, lines): (&Sight, Option<&Lines>),
    ) -> Option<Vec<f64>> {
        let Some(lines) = lines else { return self.effect(errors, error, size_mm, sight.curve()) };
        let mesh = with_errors(self.mesh, &[errors, &[(error, size_mm)]].concat())?;
        let (pair, turns) = (self.mesh.pair(), error.kind == ToothErrorKind::Lead);
        let (acts, mut sampler) = (error.acts(pair), turns.then(|| Sampler::new(&mesh)));
        let mut at = |(point, all): &(MeshPoint, Vec<PairLine>)| {
            if !acts(point.stroke_mm) {
                return Some(0.0);
            }
            let is_its = |line: &&PairLine| error.is_of(pair, line.rack_tooth, line.pinion_tooth);
            let mut changed: Vec<PairLine> = match &mut sampler {
                Some(sampler) => sampler.lines(point, |rack, pinion| error.is_of(pair, rack, pinion))?,
                None => all.iter().filter(is_its).map(|line| line.displaced(&lines.mesh, &mesh)).collect(),
            };
            changed.extend(all.iter().filter(|line| !is_its(line)));
            Some(PairLine::crossing(&changed)? - point.center_distance_mm)
        };
        lines.at.iter().map(&mut at).collect()
    }

    /// The approximate effects of every candidate that `is_tried`, each at some sizes of both signs.
    pub(super) fn screened(
        &self,
        errors: &[(ToothError, f64)],
        sight: &Sight,
        is_tried: impl Fn(&ToothError) -> bool,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<(ToothError, Effects)>, TraceError> {
        let is_new = |error: &&ToothError| is_tried(error) && errors.iter().all(|(known, _)| known != *error);
        let tried: Vec<ToothError> = self.candidates.iter().filter(is_new).copied().collect();
        // the differences may be larger than the effect of the usual sizes
        let scale = (sight.largest_mm() / SIZES_MM[1]).ceil();
        let sizes: Vec<f64> = SIZES_MM.iter().copied().chain((scale > 1.0).then_some(scale * SIZES_MM[1])).collect();
        let lines = self.lines(errors, &sight.strokes_mm)?;
        let of = |at: u64| {
            let error = tried[at as usize];
            let mut effects = Effects::none(sight);
            for sign in [-1.0, 1.0] {
                for size in &sizes {
                    let one = (error, sign * size);
                    let Some(effect) = self.rough_effect(errors, one, (sight, lines.as_ref())) else { break };
                    effects.insert(sign * size, effect);
                }
            }
            (error, effects)
        };
        let mut found = Vec::with_capacity(tried.len());
        parallel::in_order(parallel::cores(), tried.len() as u64, of, |one| {
            found.push(one);
            match watch(self.errors.len(), found.len() as f64 / tried.len() as f64) {
                ControlFlow::Continue(()) => Ok(()),
                ControlFlow::Break(()) => Err(TraceError::Interrupted),
            }
        })?;
        Ok(found)
    }

    /// The size of an error that explains most, searched from a given size on.
    pub(super) fn refined(
        &self,
        errors: &[(ToothError, f64)],
        (error, sizes): (ToothError, &[f64]),
        sight: &Sight,
    ) -> (Explains, Effects) {
        self.refined_by(errors, (error, sizes), (sight, None))
    }

    /// The same by approximate effects, where there are lines.
    fn refined_by(
        &self,
        errors: &[(ToothError, f64)],
        (error, sizes): (ToothError, &[f64]),
        (sight, lines): (&Sight, Option<&Lines>),
    ) -> (Explains, Effects) {
        const ROUNDS: usize = 8;
        let mut effects = Effects::none(sight);
        let add = |effects: &mut Effects, size: f64| {
            let effect =
                if effects.has(size) { None } else { self.rough_effect(errors, (error, size), (sight, lines)) };
            effect.map(|effect| effects.insert(size, effect)).is_some()
        };
        for size in sizes {
            add(&mut effects, *size);
        }
        for _ in 0..ROUNDS {
            let best = effects.best(sight).size_mm;
            // the best size may lie beyond the outermost solved one
            let next = effects.beyond(best).unwrap_or(best);
            if !add(&mut effects, next) {
                break;
            }
        }
        (effects.best(sight), effects)
    }

    /// The errors of either sign that explain most beside some others, the best first. The second round has fewer candidates and
    /// more strokes, and is exact. Errors that explain less than `least` are left out.
    pub(super) fn best(
        &self,
        errors: &[(ToothError, f64)],
        (means, points): (&Sight, &Sight),
        screened: &[(ToothError, Effects)],
        least: f64,
    ) -> Result<Vec<(ToothError, Explains)>, TraceError> {
        /// The distance below the best candidate that is allowed in the first and in the second round, as a share of its gain.
        const COARSE: f64 = 0.25;
        const FINE: f64 = 0.02;
        // both signs of an error may have the same curve, as those of a lead do
        let first = |(error, effects): &(ToothError, Effects)| {
            effects.best_of_each_sign(means).map(|best| (*error, best, effects.around(best.size_mm)))
        };
        let mut found: Vec<(ToothError, Explains, Vec<f64>)> = screened.iter().flat_map(first).collect();
        let lines = self.lines(errors, &means.strokes_mm)?;
        for (sight, lines, margin) in [(means, lines.as_ref(), COARSE), (points, None, FINE)] {
            let most = found.iter().map(|(_, explains, _)| explains.gain).fold(0.0, f64::max);
            let least = least.max(most - margin * most - 3.0 * SAME_CURVE);
            found.retain(|(_, explains, _)| explains.gain > 0.0 && explains.gain >= least);
            found.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
            found.truncate(CLOSER);
            let closer = |(): &mut (), at: usize| {
                let (error, _, sizes) = &found[at];
                let (explains, _) = self.refined_by(errors, (*error, sizes), (sight, lines));
                (*error, explains, near(explains.size_mm))
            };
            found = parallel::map(parallel::cores(), found.len(), || (), closer).0;
        }
        found.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
        Ok(found.into_iter().map(|(error, explains, _)| (error, explains)).collect())
    }

    /// χ² of some errors at a stroke shift, with the best offset.
    pub(super) fn chi_square(&self, errors: &[(ToothError, f64)], shift_mm: f64) -> Option<f64> {
        let curve = self.curve(errors, &self.points, shift_mm).ok()?;
        let measured: Vec<f64> = self.points.iter().map(|(_, delta_cd, _)| *delta_cd).collect();
        let weights = vec![1.0 / (self.noise_mm * self.noise_mm); measured.len()];
        let beside = if self.fits { vec![vec![1.0; measured.len()]] } else { Vec::new() };
        let solved = (curve.strokes_mm.clone(), curve.model_mm.clone());
        Some(Sight::new(solved, &measured, weights, &beside).chi_square())
    }

    /// Fits all sizes and the stroke shift together, by the Gauss-Newton method.
    pub(super) fn refit(&mut self) -> Result<(), TraceError> {
        self.refit_below(f64::INFINITY)
    }

    /// Fits them for a cost below a given one. The fit ends early where further rounds that gain as much as the last do not reach it.
    pub(super) fn refit_below(&mut self, cost: f64) -> Result<(), TraceError> {
        const ROUNDS: u8 = 8;
        const ENOUGH: f64 = 0.1;
        let mut least = self.chi_square(&self.errors, self.shift_mm).unwrap_or(f64::INFINITY);
        let below = cost - self.threshold * self.errors.len() as f64;
        for left in (0..ROUNDS).rev() {
            let fitted = self.sight(&self.errors, &self.points, true)?;
            let placed = fitted.columns() - self.errors.len();
            let moved = |share: f64| {
                let shift = self.shift_mm - if placed > 1 { share * fitted.step(1) } else { 0.0 };
                let sizes = self.errors.iter().enumerate();
                let errors: Vec<_> =
                    sizes.map(|(at, (error, mm))| (*error, mm + share * fitted.step(placed + at))).collect();
                (errors, shift.clamp(-self.half_mm(), self.half_mm()))
            };
            let tried = [1.0, 0.5, 0.25, 0.1].into_iter().map(moved);
            let better = tried.map(|(errors, shift)| (self.chi_square(&errors, shift), errors, shift));
            let better = better.filter_map(|(square, errors, shift)| Some((square?, errors, shift)));
            let Some((square, errors, shift)) = better.into_iter().find(|(square, ..)| *square < least) else { break };
            (self.errors, self.shift_mm) = (errors, shift);
            let gained = least - square;
            least = square;
            if gained < ENOUGH || least - f64::from(left) * gained > below {
                break;
            }
        }
        Ok(())
    }
}
