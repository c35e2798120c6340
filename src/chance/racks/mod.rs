//! Monte Carlo through the exact mesh: racks and pinions whose teeth deviate at random, and what ΔCD does along the
//! stroke. Called by `rackmesh monte-carlo`; draws deviations and summarises curves, the mesh solves them.
//!
//! # What is drawn
//! Every tooth is drawn by itself. A pitch deviation is the step from one tooth to the next: teeth are placed independently,
//! such that the difference of neighbours has the given standard deviation or stays within the given half-width, and errors
//! do not add up along the rack. Thickness, lead and over-roller deviations are drawn per tooth. A pinion's runout is twice
//! its eccentricity, in a random direction.
//!
//! # How a curve is followed
//! It is solved at equal steps, [`STEPS_PER_PITCH`] to a pitch. While the flanks are not tilted, ΔCD of a set of carrying
//! flanks is constant, and a change of the set takes a few hundredths of a pitch; so extremes are met unless a set carries for
//! less than one step. The tests compare means and extremes with the adaptive curve. Where the spec has a yoke, every rack
//! is solved by the adaptive curve itself, because a torque is largest at a kink.
//!
//! Rack number i is drawn from a generator of its own: the result depends neither on the number of threads nor on the
//! range of racks that it is solved with.

mod contributions;
mod counts;
mod quantiles;
mod range;
mod study;
mod summary;
mod yoke;

pub use contributions::{Contribution, Contributions};
pub use counts::{Bin, MOST_BINS};
pub use quantiles::{CONFIDENCE, Quantile, share};
pub use range::{RackRange, StudyError};
pub use study::{RacksStudy, StudyOf};
pub use summary::{Inside, RackStatistics, RacksSummary, SharedPlug, YokeSummary};
pub use yoke::{RackYoke, RacksYoke};

use std::collections::BTreeMap;
use std::f64::consts::{SQRT_2, TAU};
use std::sync::atomic::{AtomicBool, Ordering};

use thiserror::Error;

use super::random::{Random, Ziggurat};
use crate::deviation::{DeviationError, PinionFlank, PinionTooth, RackFlank, RackTooth};
use crate::function::SetAt;
use crate::judge::Limit;
use crate::judge::bound::pinion_lead_angle_rad;
use crate::mesh::{Mesh, MeshError, MeshPoint, Sampler, TOLERANCE_MM};
use crate::uncertainty::{Distribution, Uncertainty};
use crate::{parallel, trig};

/// Strokes solved per rack pitch.
pub const STEPS_PER_PITCH: f64 = 32.0;
/// Teeth beyond both ends of the stroke that get deviations: more than any path of contact reaches.
const MARGIN: i64 = 12;
/// Racks that a thread solves before it takes the next ones.
const BLOCK: u64 = 16;
/// The most strokes per rack.
const MOST_STROKES: f64 = 1e6;

/// How the teeth deviate: the spread of each kind of deviation, mm and rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scatter {
    /// Single pitch deviation of the rack, along X.
    pub rack_pitch: Option<Uncertainty>,
    /// Normal tooth thickness of the rack.
    pub rack_thickness: Option<Uncertainty>,
    /// Lead deviation of each rack tooth, rad.
    pub rack_lead: Option<Uncertainty>,
    /// Pitch-line shift of each rack tooth, along Z.
    pub rack_over_roller: Option<Uncertainty>,
    /// Single pitch deviation of the pinion, an arc at the reference circle.
    pub pinion_pitch: Option<Uncertainty>,
    /// Transverse tooth thickness of the pinion, an arc at the reference circle.
    pub pinion_thickness: Option<Uncertainty>,
    /// Helix slope deviation f_Hβ of each pinion tooth over its face width, along the transverse base tangent.
    pub pinion_lead: Option<Uncertainty>,
    /// Runout of the pinion, twice its eccentricity.
    pub pinion_runout: Option<Uncertainty>,
}

impl Scatter {
    /// Whether nothing scatters.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Each spread under its key of `[scatter]`.
    #[must_use]
    pub const fn spreads(&self) -> [(&'static str, Option<Uncertainty>); 8] {
        [
            ("rack_pitch", self.rack_pitch),
            ("rack_thickness", self.rack_thickness),
            ("rack_lead", self.rack_lead),
            ("rack_over_roller", self.rack_over_roller),
            ("pinion_pitch", self.pinion_pitch),
            ("pinion_thickness", self.pinion_thickness),
            ("pinion_lead", self.pinion_lead),
            ("pinion_runout", self.pinion_runout),
        ]
    }
}

/// What to draw and solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RackSettings {
    /// The seed; the same one gives the same result.
    pub seed: u64,
    /// Which racks.
    pub range: RackRange,
    /// First stroke, mm.
    pub from_mm: f64,
    /// Last stroke, mm.
    pub to_mm: f64,
    /// Threads; `None` for one per core. Does not change the result.
    pub threads: Option<usize>,
}

/// ΔCD of one rack along the stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RackResult {
    /// Mean, mm.
    pub mean_mm: f64,
    /// Smallest, mm.
    pub min_mm: f64,
    /// Largest, mm.
    pub max_mm: f64,
    /// The figures of a yoke, if there is one.
    pub yoke: Option<RackYoke>,
}

impl RackResult {
    /// Largest less smallest ΔCD, mm.
    #[must_use]
    pub fn peak_to_peak_mm(&self) -> f64 {
        self.max_mm - self.min_mm
    }
}

/// Why there is no result.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RacksError {
    /// Nothing scatters.
    #[error("nothing scatters, so every rack is the same")]
    NothingScatters,
    /// No racks, or some with numbers that do not fit 64 bits.
    #[error(
        "the racks cannot be {racks} from number {first_rack} on: ask for one at least, and for numbers that do not end beyond 1.8e19"
    )]
    Count {
        /// The first one.
        first_rack: u64,
        /// How many were asked for.
        racks: u64,
    },
    /// A stroke that is no range, or too long.
    #[error("strokes {from_mm} .. {to_mm} mm are not a range, or have more than a million steps")]
    Stroke {
        /// Its start.
        from_mm: f64,
        /// Its end.
        to_mm: f64,
    },
    /// A drawn rack that cannot be solved.
    #[error("rack {rack}: {error}")]
    Mesh {
        /// Which one, from 0.
        rack: u64,
        /// Why.
        error: MeshError,
    },
    /// A stroke of a drawn rack at which ΔCD is not certain.
    #[error("rack {rack}: the mesh is not solved at a stroke of {stroke_mm} mm")]
    NotSolved {
        /// Which one, from 0.
        rack: u64,
        /// The stroke.
        stroke_mm: f64,
    },
    /// A drawn rack whose curve is not resolved.
    #[error("rack {rack}: the curve of its mesh is not resolved, which a yoke needs")]
    Unresolved {
        /// Which one, from 0.
        rack: u64,
    },
    /// A drawn deviation that cannot be applied.
    #[error("rack {rack}: {error}")]
    Deviation {
        /// Which one, from 0.
        rack: u64,
        /// Why.
        error: DeviationError,
    },
    /// Results that cannot be counted.
    #[error(transparent)]
    Study(#[from] StudyError),
}

/// What racks are drawn from, and how they are judged.
#[derive(Debug, Clone, Copy)]
pub struct Racks<'a> {
    /// The pair with its own deviations.
    pub base: &'a Mesh,
    /// The scatter that is added.
    pub scatter: &'a Scatter,
    /// The limit on ΔCD, if there is one.
    pub limit: Option<&'a Limit>,
    /// The yoke, if there is one.
    pub yoke: Option<RacksYoke<'a>>,
}

impl Racks<'_> {
    /// The identity of a study with these settings.
    #[must_use]
    pub fn study_of(&self, settings: &RackSettings) -> StudyOf {
        StudyOf::new(self, settings)
    }

    /// Draws and solves racks, and counts them. `each` gets the results in order, with the number of the first one; they are not
    /// kept. Once `stop` is set, the study has the first racks only; with an error it has those before it.
    ///
    /// # Errors
    /// [`RacksError`] if nothing scatters, the settings make no sense, or a rack cannot be solved; then the first such
    /// rack. What `each` says.
    pub fn study<E: From<RacksError>>(
        &self,
        settings: &RackSettings,
        stop: &AtomicBool,
        mut each: impl FnMut(u64, &[RackResult]) -> Result<(), E>,
    ) -> (RacksStudy, Result<(), E>) {
        let of = self.study_of(settings);
        let mut study = RacksStudy::new(of.clone(), settings.range, self.limit.is_some(), self.yoke.is_some());
        let ended = self.simulate(settings, stop, |first_rack, results| {
            let block = RacksStudy::of(of.clone(), first_rack, results, self.limit).map_err(RacksError::from)?;
            study.merge(&block).map_err(RacksError::from)?;
            each(first_rack, results)
        });
        (study, ended)
    }

    /// Draws and solves racks: the base with its own deviations, plus those of the scatter. `take` gets the results block by block
    /// in order, with the number of the first rack; memory does not depend on the number of racks. Once `stop` is set, only the
    /// first racks are solved.
    ///
    /// # Errors
    /// [`RacksError`] if nothing scatters, the settings make no sense, or a rack cannot be solved; then the first such
    /// rack. The first one of `take`.
    pub fn simulate<E: From<RacksError>>(
        &self,
        settings: &RackSettings,
        stop: &AtomicBool,
        mut take: impl FnMut(u64, &[RackResult]) -> Result<(), E>,
    ) -> Result<(), E> {
        if self.scatter.is_empty() {
            return Err(RacksError::NothingScatters.into());
        }
        let RackRange { first_rack, racks } = settings.range;
        if racks == 0 || first_rack.checked_add(racks).is_none() {
            return Err(RacksError::Count { first_rack, racks }.into());
        }
        let draw = Draw::new(self, settings)?;
        let of_block = |block: u64| {
            let skipped = block * BLOCK;
            RackRange { first_rack: first_rack + skipped, racks: BLOCK.min(racks - skipped) }
        };
        let ended = parallel::in_order(
            settings.threads.unwrap_or_else(parallel::cores),
            racks.div_ceil(BLOCK),
            |block| draw.block(of_block(block), stop),
            |Block { range, results, error }| {
                if !results.is_empty() {
                    take(range.first_rack, &results).map_err(Some)?;
                }
                match error {
                    Some(error) => Err(Some(error.into())),
                    None if (results.len() as u64) < range.racks => Err(None),
                    None => Ok(()),
                }
            },
        );
        // a run that is stopped ends without an error
        ended.or_else(|error| error.map_or(Ok(()), Err))
    }
}

/// The outcome of successive racks.
struct Block {
    range: RackRange,
    /// The results of the first racks, up to an error or the stop.
    results: Vec<RackResult>,
    error: Option<RacksError>,
}

/// The spread of a tooth's place for which the difference of two teeth has the given spread.
fn place_of(pitch: &Uncertainty) -> Uncertainty {
    let share = if pitch.distribution == Distribution::Normal { SQRT_2 } else { 2.0 };
    Uncertainty { standard: pitch.standard / share, ..*pitch }
}

/// The base of every rack, and the strokes at which it is solved.
struct Draw<'a> {
    racks: &'a Racks<'a>,
    seed: u64,
    from: f64,
    to: f64,
    step: f64,
    steps: u32,
    /// The rack's teeth that deviate.
    teeth: std::ops::RangeInclusive<i64>,
    ziggurat: Ziggurat,
}

impl<'a> Draw<'a> {
    fn new(racks: &'a Racks<'a>, settings: &RackSettings) -> Result<Self, RacksError> {
        let RackSettings { seed, from_mm, to_mm, .. } = *settings;
        let pitch = racks.base.pair().rack().pitch_mm;
        let steps = |from: f64, to: f64| ((to - from) / pitch * STEPS_PER_PITCH).ceil();
        // the teeth that carry where the plug is set deviate, too
        let (first, last) = match racks.yoke.map(|yoke| yoke.judge.yoke.set_at) {
            Some(SetAt::Stroke(at)) => (from_mm.min(at), to_mm.max(at)),
            _ => (from_mm, to_mm),
        };
        if !(to_mm > from_mm && steps(first, last) <= MOST_STROKES && first.abs() <= 1e9) {
            return Err(RacksError::Stroke { from_mm, to_mm });
        }
        let steps = steps(from_mm, to_mm).max(1.0);
        let teeth = (first / pitch).floor() as i64 - MARGIN..=(last / pitch).ceil() as i64 + MARGIN;
        let (step, steps) = ((to_mm - from_mm) / steps, steps as u32);
        Ok(Self { racks, seed, from: from_mm, to: to_mm, step, steps, teeth, ziggurat: Ziggurat::new() })
    }

    /// A mesh whose teeth are drawn: all from one generator, or each scatter from its own, in the order of [`Scatter::spreads`].
    fn mesh(&self, randoms: &mut [Random]) -> Result<Result<Mesh, MeshError>, DeviationError> {
        let Racks { base, scatter, .. } = *self.racks;
        let pair = base.pair();
        let half_to_x = 0.5 / trig::cos(pair.rack().helix_angle_rad);
        let [
            rack_pitch,
            rack_thickness,
            rack_lead,
            rack_over_roller,
            pinion_pitch,
            pinion_thickness,
            pinion_lead,
            runout,
        ] = std::array::from_fn(|kind| (kind % randoms.len(), scatter.spreads()[kind].1));
        let placed = |(own, pitch): (usize, Option<Uncertainty>)| (own, pitch.as_ref().map(place_of));
        let mut draw = |(own, spread): &(usize, Option<Uncertainty>)| {
            spread.as_ref().map_or(0.0, |spread| randoms[*own].spread(spread, &self.ziggurat))
        };
        let mut drawn = BTreeMap::new();
        let place = placed(rack_pitch);
        for tooth in self.teeth.clone() {
            let (place, thickness) = (draw(&place), draw(&rack_thickness) * half_to_x);
            let (lead_rad, along_z_mm) = (draw(&rack_lead), draw(&rack_over_roller));
            let flank = |along_x_mm| RackFlank { along_x_mm, along_z_mm, lead_rad };
            drawn.insert(tooth, RackTooth { left: flank(place - thickness), right: flank(place + thickness) });
        }
        let rack = base.rack().clone().with_measured(&drawn)?;
        let mut pinion = base.pinion().clone();
        if [pinion_pitch, pinion_thickness, pinion_lead].iter().any(|(_, spread)| spread.is_some()) {
            let place = placed(pinion_pitch);
            let teeth: Vec<_> = (0..pair.pinion().teeth)
                .map(|_| {
                    let (place, half) = (draw(&place), 0.5 * draw(&pinion_thickness));
                    let lead_rad = pinion_lead_angle_rad(pair, draw(&pinion_lead));
                    let flank = |arc_mm| PinionFlank { arc_mm, lead_rad };
                    PinionTooth { left: flank(place - half), right: flank(place + half) }
                })
                .collect();
            pinion = pinion.with_measured(&teeth)?;
        }
        if let (own, Some(spread)) = runout {
            let amount = 0.5 * draw(&runout);
            let offset = if spread.distribution == Distribution::Normal {
                (amount, 0.5 * draw(&runout))
            } else {
                let (sin, cos) = trig::sin_cos(TAU * randoms[own].uniform());
                (amount.abs() * cos, amount.abs() * sin)
            };
            pinion = pinion.with_offset(offset)?;
        }
        Ok(Mesh::new(*pair, rack, pinion, base.support()))
    }

    fn block(&self, range: RackRange, stop: &AtomicBool) -> Block {
        let mut results = Vec::with_capacity(BLOCK as usize);
        for rack in range.first_rack..range.end() {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            match self.rack(rack) {
                Ok(result) => results.push(result),
                Err(error) => return Block { range, results, error: Some(error) },
            }
        }
        Block { range, results, error: None }
    }

    fn rack(&self, rack: u64) -> Result<RackResult, RacksError> {
        self.solved(&mut [Random::of_block(self.seed, rack)], rack)
    }

    /// A rack that is drawn from these, which messages call by that number.
    fn solved(&self, randoms: &mut [Random], rack: u64) -> Result<RackResult, RacksError> {
        let unmeshed = |error| RacksError::Mesh { rack, error };
        let mesh = self.mesh(randoms).map_err(|error| RacksError::Deviation { rack, error })?.map_err(unmeshed)?;
        if let Some(yoke) = self.racks.yoke {
            return self.with_yoke(rack, &mesh, yoke);
        }
        let mut sampler = Sampler::new(&mesh);
        let (mut sum, mut min, mut max) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..=self.steps {
            let stroke_mm = self.from + self.step * f64::from(i);
            let point = sampler.at(stroke_mm).map_err(unmeshed)?;
            if !point.is_solved() {
                return Err(RacksError::NotSolved { rack, stroke_mm });
            }
            let delta_cd = point.delta_cd_mm;
            sum += if i == 0 || i == self.steps { 0.5 * delta_cd } else { delta_cd };
            (min, max) = (min.min(delta_cd), max.max(delta_cd));
        }
        Ok(RackResult { mean_mm: sum / f64::from(self.steps), min_mm: min, max_mm: max, yoke: None })
    }

    /// A rack by its curve, with the figures of its yoke.
    fn with_yoke(&self, rack: u64, mesh: &Mesh, yoke: RacksYoke<'_>) -> Result<RackResult, RacksError> {
        let unmeshed = |error| RacksError::Mesh { rack, error };
        let curve = mesh.curve(self.from, self.to, TOLERANCE_MM).map_err(unmeshed)?;
        let function = yoke.judge.on(mesh, &curve).map_err(unmeshed)?.filter(|function| function.is_solved);
        let Some(function) = function else {
            let unsolved = curve.points.iter().find(|point| !point.is_solved()).map(|point| point.stroke_mm);
            return Err(match unsolved {
                Some(stroke_mm) => RacksError::NotSolved { rack, stroke_mm },
                None => RacksError::Unresolved { rack },
            });
        };
        let area = |ends: &[MeshPoint]| {
            0.5 * (ends[0].delta_cd_mm + ends[1].delta_cd_mm) * (ends[1].stroke_mm - ends[0].stroke_mm)
        };
        let mean_mm = curve.points.windows(2).map(area).sum::<f64>() / (self.to - self.from);
        let (min_mm, max_mm) = (function.lowest.delta_cd_mm, function.highest.delta_cd_mm);
        let yoke = RackYoke::from(&yoke.judge.known(function, yoke.is_measured));
        Ok(RackResult { mean_mm, min_mm, max_mm, yoke: Some(yoke) })
    }
}

#[cfg(test)]
mod tests;
