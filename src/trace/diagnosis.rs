#![doc = include_str!("diagnosis.md")]

use super::search::{DiagnosisRequest, SAME_CURVE, Search, UNSEEN_MM, Watch, near};
use super::sight::{Effects, Explains, Sight};
use super::tooth_error::{ToothError, ToothErrorKind};
use super::{Overlay, TraceError};
use crate::deviation::Part;
use crate::mesh::Mesh;

/// Another error with the same curve within the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alternative {
    /// The error.
    pub error: ToothError,
    /// Its size, as that of a found error.
    pub value_mm: f64,
    /// The ends of the 95 % interval of its size, as those of a found error.
    pub interval_mm: [Option<f64>; 2],
    /// The stroke shift at which it has the same curve, mm, if that is another than the diagnosis'.
    pub shift_mm: Option<f64>,
}

/// An error that explains the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundError {
    /// The error.
    pub error: ToothError,
    /// Its size, mm; for a lead error the helix slope deviation over the face width. Where one end of the interval is open, the
    /// size nearest to the other end that explains the curve as well as any.
    pub value_mm: f64,
    /// The ends of the 95 % interval of its size, mm; `None` for an end that the curve does not determine.
    pub interval_mm: [Option<f64>; 2],
    /// The largest change of ΔCD that the error makes, mm.
    pub effect_mm: f64,
    /// Other errors with the same curve.
    pub alternatives: Vec<Alternative>,
}

/// Errors of one kind and sign that do not show in the curve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unseen {
    /// The part.
    pub part: Part,
    /// The kind.
    pub kind: ToothErrorKind,
    /// Whether the error is negative.
    pub is_negative: bool,
    /// The teeth.
    pub teeth: Vec<i64>,
    /// The number of teeth that were tried.
    pub of: usize,
}

/// The errors of single teeth that explain a measured curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// The errors, the one with the largest effect first; none if nothing stands out of the noise.
    pub errors: Vec<FoundError>,
    /// Standard deviation of the noise, mm.
    pub noise_mm: f64,
    /// Whether the noise was stated.
    pub noise_is_stated: bool,
    /// Root mean square of measured less explained, mm.
    pub rms_left_mm: f64,
    /// Whether that is clearly more than the noise.
    pub leaves_more: bool,
    /// The eccentricity of the pinion that explains the curve as well as the errors of several teeth, mm: it is the likelier cause.
    pub eccentricity_mm: Option<f64>,
    /// The explained curve: the computed curve with the errors, placed, at the measured points, mm.
    pub explained_mm: Vec<f64>,
    /// The offset added to the computed curve, mm.
    pub offset_mm: f64,
    /// The measured less the computed stroke of one and the same place, mm.
    pub shift_mm: f64,
    /// Whether the shift lies at an end of its range, ± half a pitch.
    pub at_an_end: bool,
    /// The number of errors that were tried.
    pub candidates: usize,
    /// The least by which an error must lower χ².
    pub threshold: f64,
    /// Errors of the size [`UNSEEN_MM`] that do not show in the curve.
    pub unseen: Vec<Unseen>,
}

/// The rise of χ² at the ends of the 95 % interval of a size.
const INTERVAL: f64 = 3.84;
/// The rise of χ² up to which a size explains the curve as well as the best one: one standard deviation of the size.
const AS_WELL: f64 = 1.0;
/// How much more an eccentricity may leave than errors of teeth in whose place it stands.
const AS_LITTLE: f64 = 1.1;
/// The most errors that a diagnosis finds.
const MOST_ERRORS: usize = 12;
/// The errors up to which a search goes on at every stroke shift at which it begins.
const FEW_ERRORS: usize = 4;
/// The stroke shifts at which it goes on if these do not explain the curve.
const MOST_LONG: usize = 2;

impl Diagnosis {
    /// Finds the smallest set of single-tooth errors that explains the differences of an overlay.
    ///
    /// # Errors
    /// [`TraceError`] if a stroke has no mesh, or `watch` ends the search.
    pub fn of(
        mesh: &Mesh,
        overlay: &Overlay,
        request: DiagnosisRequest,
        watch: &mut Watch<'_>,
    ) -> Result<Self, TraceError> {
        // an error distorts the shift that is fitted without it
        let search = Search::new(mesh, overlay, request);
        let mut answers = Vec::new();
        for shift_mm in search.starts(watch)? {
            let mut search = search.moved_to(shift_mm);
            let unseen = search.add_all(FEW_ERRORS, false, watch)?;
            answers.push((search.cost(), search, unseen));
        }
        answers.sort_by(|a, b| a.0.total_cmp(&b.0));
        // many errors take long, and a wrong shift needs many
        let is_explained =
            answers.first().is_some_and(|(_, best, _)| best.errors.len() < FEW_ERRORS && !best.leaves_more());
        for (cost, found, unseen) in answers.iter_mut().take(if is_explained { 0 } else { MOST_LONG }) {
            let mut anew = search.moved_to(found.shift_mm);
            let unseen_anew = anew.add_all(MOST_ERRORS, true, watch)?;
            if anew.cost() < *cost {
                (*found, *unseen) = (anew, unseen_anew);
            } else {
                *unseen = found.add_all(MOST_ERRORS, false, watch)?;
            }
            *cost = found.cost();
        }
        answers.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut answers = answers.into_iter();
        let (least, mut search, unseen) = answers.next().ok_or(TraceError::TooFewPoints)?;
        let mut found = search.explained(watch)?;
        for (cost, mut other, _) in answers {
            if cost < least + SAME_CURVE && other.is_elsewhere(&search) {
                add_elsewhere(&mut found, other.explained(watch)?, other.shift_mm);
            }
        }
        let sight = search.sight(&search.errors, &search.points, false)?;
        let points: Vec<f64> = overlay.points.iter().map(|point| point.delta_cd_mm).collect();
        let mean = |of: &mut dyn Iterator<Item = f64>| of.sum::<f64>() / points.len() as f64;
        let apart = || points.iter().zip(&sight.model_mm).map(|(measured, model)| measured - model);
        let offset_mm = if search.fits { mean(&mut apart()) } else { 0.0 };
        let square = mean(&mut apart().map(|apart| (apart - offset_mm) * (apart - offset_mm)));
        let rms_left_mm = square.sqrt();
        Ok(Self {
            eccentricity_mm: eccentricity_mm(mesh, overlay, rms_left_mm).filter(|_| found.len() > 1),
            errors: found,
            noise_mm: search.noise_mm,
            noise_is_stated: request.noise_mm.is_some(),
            rms_left_mm,
            leaves_more: search.leaves_more(),
            explained_mm: sight.model_mm.iter().map(|model| model + offset_mm).collect(),
            offset_mm,
            shift_mm: search.shift_mm,
            at_an_end: search.shift_mm.abs() >= 0.999 * search.half_mm(),
            candidates: search.candidates.len(),
            threshold: search.threshold,
            unseen,
        })
    }

    /// Whether the errors explain the curve, and nothing simpler does.
    #[must_use]
    pub fn is_likely(&self) -> bool {
        !self.leaves_more && self.eccentricity_mm.is_none()
    }
}

/// The eccentricity of the pinion that leaves hardly more than that.
fn eccentricity_mm(mesh: &Mesh, overlay: &Overlay, rms_left_mm: f64) -> Option<f64> {
    let turn_mm = mesh.pair().rack().pitch_mm * f64::from(mesh.pair().pinion().teeth);
    let [amount_mm, left_mm] = overlay.once_a_turn(turn_mm)?;
    (left_mm <= AS_LITTLE * rms_left_mm).then_some(amount_mm)
}

/// Adds the answer at another stroke shift to the alternatives; both list the errors with the largest effects first.
fn add_elsewhere(found: &mut [FoundError], elsewhere: Vec<FoundError>, shift_mm: f64) {
    if found.len() != elsewhere.len() {
        return;
    }
    for (one, other) in found.iter_mut().zip(elsewhere) {
        let FoundError { error, value_mm, interval_mm, .. } = other;
        let own = Alternative { error, value_mm, interval_mm, shift_mm: None };
        for alternative in std::iter::once(own).chain(other.alternatives) {
            let known = one.alternatives.iter().map(|known| known.error).chain([one.error]);
            if !known.into_iter().any(|known| known == alternative.error) {
                one.alternatives.push(Alternative { shift_mm: Some(shift_mm), ..alternative });
            }
        }
    }
}

impl Search<'_> {
    /// Adds errors as long as one stands out of the noise, then finds the errors that do not show in the curve.
    /// With `exchanges` the first ones may give way to others.
    fn add_all(&mut self, most: usize, exchanges: bool, watch: &mut Watch<'_>) -> Result<Vec<Unseen>, TraceError> {
        /// The share of the threshold that an error must explain at the first look.
        const LEAST: f64 = 0.5;
        loop {
            let before = self.clone();
            let errors = &before.errors;
            let sights = [&self.means, &self.points].map(|points| self.sight(errors, points, false));
            let [means, points] = sights;
            let (means, points) = (means?, points?);
            let screened = self.screened(errors, &means, |_| true, watch)?;
            let best = self.best(errors, (&means, &points), &screened, LEAST * self.threshold)?.into_iter().next();
            if let Some((error, explains)) = best.filter(|(_, best)| best.gain > self.threshold && errors.len() < most)
            {
                self.errors.push((error, explains.size_mm));
                self.refit()?;
                self.remove_needless()?;
                if exchanges && (2..FEW_ERRORS).contains(&self.errors.len()) && self.leaves_more() {
                    self.exchange(watch)?;
                }
            }
            if self.cost() >= before.cost() {
                *self = before.clone();
                // what does not explain the curve need not be the smallest
                if errors.len() <= FEW_ERRORS || !self.leaves_more() {
                    self.simplify(watch)?;
                }
                if self.cost() >= before.cost() {
                    return Ok(self.unseen(&means, &screened));
                }
            }
        }
    }

    /// Whether what the errors leave is clearly more than the noise.
    fn leaves_more(&self) -> bool {
        let freedom = (self.points.len() as f64 - self.errors.len() as f64 - 2.0).max(1.0);
        let square = self.chi_square(&self.errors, self.shift_mm).unwrap_or(f64::INFINITY);
        square / freedom > 1.0 + 5.0 * (2.0 / freedom).sqrt() + 0.1
    }

    /// Errors of the size [`UNSEEN_MM`] that do not show in the curve, by part, kind and sign.
    fn unseen(&self, sight: &Sight, screened: &[(ToothError, Effects)]) -> Vec<Unseen> {
        let mut all: Vec<Unseen> = Vec::new();
        for (ToothError { part, kind, tooth }, effects) in screened {
            for is_negative in [false, true] {
                let is_it = |of: &&mut Unseen| (of.part, of.kind, of.is_negative) == (*part, *kind, is_negative);
                let size_mm = if is_negative { -UNSEEN_MM } else { UNSEEN_MM };
                let is_seen = effects.at(size_mm).is_some_and(|effect| sight.visible(effect) > self.threshold);
                let teeth: Vec<i64> = if is_seen { Vec::new() } else { vec![*tooth] };
                match all.iter_mut().find(is_it) {
                    Some(of) => of.teeth.extend(teeth),
                    None => all.push(Unseen { part: *part, kind: *kind, is_negative, teeth, of: 0 }),
                }
            }
        }
        for of in &mut all {
            // those found are no candidates any more
            of.of = self.candidates.iter().filter(|one| (one.part, one.kind) == (of.part, of.kind)).count();
        }
        all.retain(|of| !of.teeth.is_empty());
        all
    }

    /// The errors with their intervals and alternatives, the one with the largest effect first. An alternative that explains the
    /// curve better replaces its error.
    fn explained(&mut self, watch: &mut Watch<'_>) -> Result<Vec<FoundError>, TraceError> {
        const MOST_SWAPS: usize = 4;
        let (mut found, mut swaps) = (Vec::new(), 0);
        let mut at = 0;
        while let Some(&(error, size_mm)) = self.errors.get(at) {
            let mut others = self.errors.clone();
            others.remove(at);
            let means = self.sight(&others, &self.means, true)?;
            let points = self.sight(&others, &self.points, true)?;
            let own = self.effect(&others, error, size_mm, points.curve()).unwrap_or_default();
            let is_alike = |other: &ToothError| self.acts_like(*other, &own, &points);
            let screened = self.screened(&others, &means, is_alike, watch)?;
            let mut best = self.best(&others, (&means, &points), &screened, 0.0)?;
            let (member, effects) = self.refined(&others, (error, &near(size_mm)), &points);
            best.retain(|(other, of)| *other != error || of.size_mm * member.size_mm < 0.0);
            if let Some((other, explains)) = best.first().filter(|(_, better)| better.gain > member.gain + SAME_CURVE)
                && swaps < MOST_SWAPS
            {
                if let Some(changed) = self.errors.get_mut(at) {
                    *changed = (*other, explains.size_mm);
                }
                self.refit()?;
                self.remove_needless()?;
                (found, swaps, at) = (Vec::new(), swaps + 1, 0);
                continue;
            }
            let most = best.first().map_or(member.gain, |(_, best)| best.gain.max(member.gain));
            let is_same = |(_, other): &&(ToothError, Explains)| other.gain > most - SAME_CURVE;
            let alternatives = best.iter().filter(is_same).map(|(error, other)| {
                let (explains, effects) = self.refined(&others, (*error, &[other.size_mm]), &points);
                let (value_mm, interval_mm) = self.sized(&others, (*error, explains), &points, effects);
                Alternative { error: *error, value_mm, interval_mm, shift_mm: None }
            });
            let (value_mm, interval_mm) = self.sized(&others, (error, member), &points, effects);
            found.push(FoundError {
                error,
                value_mm,
                interval_mm,
                effect_mm: own.iter().fold(0.0, |most, effect| f64::max(most, effect.abs())),
                alternatives: alternatives.collect(),
            });
            at += 1;
        }
        found.sort_by(|a, b| b.effect_mm.total_cmp(&a.effect_mm));
        Ok(found)
    }

    /// Whether an error can act at the strokes of an effect, all but a tenth of the effect's sum of squares.
    fn acts_like(&self, error: ToothError, effect: &[f64], sight: &Sight) -> bool {
        const MISSED: f64 = 0.1;
        let acts = error.acts(self.mesh.pair());
        let square = |is_missed: bool| {
            let there = effect.iter().zip(&sight.strokes_mm);
            let there = there.filter(|(_, stroke)| !is_missed || !acts(**stroke));
            there.map(|(effect, _)| effect * effect).sum::<f64>()
        };
        square(true) <= MISSED * square(false)
    }

    /// The size of an error and its 95 % interval; an end is `None` if the curve does not determine it. Where one end is open, the
    /// size is the one nearest to the other end.
    fn sized(
        &self,
        others: &[(ToothError, f64)],
        (error, best): (ToothError, Explains),
        sight: &Sight,
        mut effects: Effects,
    ) -> (f64, [Option<f64>; 2]) {
        let best = self.settled(others, (error, best), sight, &mut effects);
        let mut end = |way, rise| self.end(others, (error, best), (way, rise), sight, &mut effects);
        let interval = [-1.0, 1.0].map(|way| end(way, INTERVAL));
        let nearest = match interval {
            [None, Some(_)] => end(1.0, AS_WELL),
            [Some(_), None] => end(-1.0, AS_WELL),
            _ => None,
        };
        (nearest.unwrap_or(best.size_mm), interval)
    }

    /// The best size of an error, with what it explains when it is solved: where effects bend, their lines promise more.
    fn settled(
        &self,
        others: &[(ToothError, f64)],
        (error, mut best): (ToothError, Explains),
        sight: &Sight,
        effects: &mut Effects,
    ) -> Explains {
        const ROUNDS: usize = 12;
        for _ in 0..ROUNDS {
            let Some(solved) = self.solved_gain(others, (error, best.size_mm), sight, effects) else { break };
            if best.gain - solved < 0.1 * AS_WELL {
                return Explains { gain: solved, ..best };
            }
            if let Some(half) = effects.half_way_in(best.size_mm) {
                self.solved_gain(others, (error, half), sight, effects);
            }
            let [negative, positive] = effects.best_of_each_sign(sight);
            best = if best.size_mm < 0.0 { negative } else { positive };
        }
        best
    }

    /// The amount by which a size lowers χ², solved; `None` for impossible teeth.
    fn solved_gain(
        &self,
        others: &[(ToothError, f64)],
        (error, size_mm): (ToothError, f64),
        sight: &Sight,
        effects: &mut Effects,
    ) -> Option<f64> {
        if !effects.has(size_mm) {
            effects.insert(size_mm, self.effect(others, error, size_mm, sight.curve())?);
        }
        Some(effects.gain(sight, size_mm))
    }

    /// The size, from the best one on in one way, at which χ² has risen by so much; `None` if there is none.
    fn end(
        &self,
        others: &[(ToothError, f64)],
        (error, best): (ToothError, Explains),
        (way, rise): (f64, f64),
        sight: &Sight,
        effects: &mut Effects,
    ) -> Option<f64> {
        /// The first step; between sizes so near to each other effects are linear.
        const STEP_MM: f64 = 1e-3;
        let lacks = |effects: &Effects, size: f64| best.gain - effects.gain(sight, size);
        // an error that is too large for a tooth has no solution, and ends the search
        let solve = |effects: &mut Effects, size: f64| {
            self.solved_gain(others, (error, size), sight, effects).map(|gain| best.gain - gain)
        };
        let (mut inner, mut outer) = (best.size_mm, best.size_mm + way * STEP_MM);
        while solve(effects, outer)? <= rise {
            (inner, outer) = (outer, outer + 2.0 * (outer - best.size_mm));
        }
        while (outer - inner).abs() > STEP_MM {
            let middle = 0.5 * (inner + outer);
            if solve(effects, middle)? > rise { outer = middle } else { inner = middle }
        }
        for _ in 0..40 {
            let middle = 0.5 * (inner + outer);
            if lacks(effects, middle) > rise { outer = middle } else { inner = middle }
        }
        Some(outer)
    }
}
