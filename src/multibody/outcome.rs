//! The results of a run. The runs fill them, reports read them.

use std::ops::{ControlFlow, RangeInclusive};

use super::SimulationError;

/// Called with every sample as it is made; `Break` ends the run there, with everything made so far.
pub type Watch<'a> = dyn FnMut(&Sample) -> ControlFlow<()> + 'a;

/// One position of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the start, s; of a quasi-static run the time at constant speed.
    pub time_s: f64,
    /// Stroke s, mm.
    pub stroke_mm: f64,
    /// ΔCD = a − a_0, mm; the contact's elastic indentation included.
    pub delta_cd_mm: f64,
    /// Centre distance a, mm. With a yoke, how far it has moved back beyond a_0 is `delta_cd_mm`.
    pub center_distance_mm: f64,
    /// Pinion rotation since s = 0, rad.
    pub pinion_angle_rad: f64,
    /// Roll of the rack, rad.
    pub roll_rad: f64,
    /// Sum of the normal forces on right rack flanks, N.
    pub normal_force_right_n: f64,
    /// Sum of the normal forces on left rack flanks, N.
    pub normal_force_left_n: f64,
    /// Force of the drive on the rack along its axis, N; positive where it pushes the way the stroke rises.
    pub rack_force_n: f64,
    /// Torque at which a pinion that drives does the same work, N m: the drive's force times r_w = m_n z / (2 cos β_r).
    pub pinion_torque_n_m: f64,
    /// Work of the drive since the start, N mm.
    pub driven_n_mm: f64,
    /// The yoke, where there is one.
    pub yoke: Option<YokeSample>,
    /// Elements that touch.
    pub contacts: u32,
    /// Largest penetration, mm.
    pub penetration_mm: f64,
    /// How much further apart rigid parts would be, mm: the smallest rise of the centre distance at
    /// which, to first order and with the best rotation, no element penetrates. So ΔCD + indentation compares with
    /// the exact mesh.
    pub indentation_mm: f64,
    /// Lowest and highest rack tooth that touches.
    pub teeth: Option<(i64, i64)>,
    /// Rack teeth whose right and left flank carry most.
    pub carrying: [Option<i64>; 2],
}

/// A force over a run, in its unit.
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Mean over the stroke.
    pub mean: f64,
    /// Smallest value of a position, and the first stroke at which it is reached, mm.
    pub smallest: f64,
    /// See `smallest`.
    pub smallest_stroke_mm: f64,
    /// Largest value of a position, and the first stroke at which it is reached, mm.
    pub largest: f64,
    /// See `largest`.
    pub largest_stroke_mm: f64,
}

/// The forces of a run, from where the rack has its speed; of all positions where it never has.
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunForces {
    /// Stroke from which on they are taken, mm.
    pub from_mm: f64,
    /// Normal forces on right rack flanks, N.
    pub normal_right_n: Extent,
    /// Normal forces on left rack flanks, N.
    pub normal_left_n: Extent,
    /// [`Sample::rack_force_n`]; the mean is the drive's work over the travel.
    pub rack_n: Extent,
    /// [`Sample::pinion_torque_n_m`]; the mean is the drive's work over the pinion's rotation.
    pub pinion_torque_n_m: Extent,
}

/// The yoke at a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YokeSample {
    /// How far the rack has moved back from where it is at a_0, mm: ΔCD.
    pub travel_mm: f64,
    /// Force of the yoke on the rack: its spring, and its stop beyond the clearance, N.
    pub force_n: f64,
    /// Force of the bush, N.
    pub bush_force_n: f64,
}

/// The mean of a part of the rack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    /// Mean ΔCD, mm.
    pub delta_cd_mm: f64,
    /// Root mean square of the deviations from the mean, mm.
    pub ripple_mm: f64,
    /// Mean of the elastic indentation, mm.
    pub indentation_mm: f64,
    /// Where the mean is taken from, mm.
    pub from_mm: f64,
    /// Where it ends, mm.
    pub to_mm: f64,
    /// How many whole pitches that is; 0 if the part is shorter than one, and the mean then is of all of it.
    pub pitches: u32,
}

/// Where energy went during a run, N mm: driven = stored + dissipated + settling + drift.
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// Kinetic, elastic and closing force's energy at the end less at the start.
    pub stored: f64,
    /// Work that the rack's drive put in: what the contact stored, lost and passed on to the bodies.
    pub driven: f64,
    /// Lost to damping and friction in the contact, the settling left out.
    pub dissipated: f64,
    /// Lost to damping in the contact until the rack has reached its speed; 0 in a quasi-static run, where nothing settles.
    pub settling: f64,
    /// Passed through the contact: the work of each side's normal forces along the rack, without sign.
    pub exchanged: f64,
    /// driven − stored − dissipated − settling: the work done on the bodies less the energy that they and the closing
    /// force gained, so what the steps lost (positive) or made up.
    pub drift: f64,
    #[cfg_attr(feature = "report", serde(skip))]
    /// Impulse of all forces on the moving slider (with a yoke, on the rack) along Z since the start, N s.
    pub impulse: f64,
    #[cfg_attr(feature = "report", serde(skip))]
    /// Its momentum gained since the start, N s.
    pub momentum: f64,
}

impl Energy {
    /// The drift as a share of the largest of driven, stored and lost; `None` where all of them are 0.
    #[must_use]
    pub fn drift_share(&self) -> Option<f64> {
        let lost = self.dissipated + self.settling;
        let largest = self.driven.abs().max(self.stored.abs()).max(lost.abs());
        (largest > 0.0).then(|| self.drift.abs() / largest)
    }
}

/// Counts of the work of a run.
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Coordinates solved for: 2, or 3 with roll.
    pub coordinates: u32,
    /// Evaluations of all contacts.
    pub evaluations: u64,
    /// Spheres (or strips) whose gap was computed.
    #[cfg_attr(feature = "report", serde(rename = "elements_tested"))]
    pub spheres_tested: u64,
    /// Friction forces computed.
    pub friction_evaluations: u64,
    /// Newton iterations.
    #[cfg_attr(feature = "report", serde(rename = "newton_iterations"))]
    pub iterations: u64,
    /// Steps in time accepted; 0 in a quasi-static run.
    pub steps: u64,
    /// Steps in time rejected.
    #[cfg_attr(feature = "report", serde(rename = "rejected_steps"))]
    pub rejected: u64,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RunEnd {
    /// The whole stroke is there.
    Completed,
    /// It was stopped; the samples so far are valid.
    Interrupted,
    /// It could not go on; the samples so far are valid.
    Failed(SimulationError),
}

/// The result of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Positions in the order of the stroke.
    pub samples: Vec<Sample>,
    /// The part of the rack with nominal teeth only in contact.
    pub nominal: Option<Steady>,
    /// The part with deviating teeth only in contact.
    pub deviating: Option<Steady>,
    /// Energy; `None` if the run ended before its first position.
    pub energy: Option<Energy>,
    /// Work done.
    pub counters: Counters,
    /// How it ended.
    pub end: RunEnd,
    /// The number of positions on the way there; the others are on the way back.
    pub there: usize,
    /// Strokes at which the rack has its speed, mm.
    pub at_speed_mm: RangeInclusive<f64>,
}

impl Outcome {
    /// The positions with the smallest and the largest ΔCD, the first of equals; `None` without a position.
    #[must_use]
    pub fn extremes(&self) -> Option<[&Sample; 2]> {
        extremes(&self.samples, |sample| sample.delta_cd_mm)
    }

    /// The forces on the way there; `None` without a position.
    #[must_use]
    pub fn forces(&self) -> Option<RunForces> {
        self.forces_of(&self.samples[..self.there])
    }

    /// The forces on the way back; `None` without one.
    #[must_use]
    pub fn forces_back(&self) -> Option<RunForces> {
        let rising: Vec<Sample> = self.samples[self.there..].iter().rev().copied().collect();
        self.forces_of(&rising)
    }

    /// The forces of positions in the order of the stroke.
    fn forces_of(&self, samples: &[Sample]) -> Option<RunForces> {
        let from = samples.partition_point(|sample| sample.stroke_mm < *self.at_speed_mm.start());
        let to = samples.partition_point(|sample| sample.stroke_mm <= *self.at_speed_mm.end());
        let part = samples.get(from..to).filter(|part| !part.is_empty()).unwrap_or(samples);
        let (first, last) = (part.first()?, part.last()?);
        let extent = |of: fn(&Sample) -> f64| {
            let [low, high] = extremes(part, of)?;
            Some(Extent {
                mean: trapezoids(part, f64::MIN, of),
                smallest: of(low),
                smallest_stroke_mm: low.stroke_mm,
                largest: of(high),
                largest_stroke_mm: high.stroke_mm,
            })
        };
        let by_work = |of: fn(&Sample) -> f64, way: fn(&Sample) -> f64| {
            let extent = extent(of)?;
            let way = way(last) - way(first);
            let mean = if way == 0.0 { extent.mean } else { (last.driven_n_mm - first.driven_n_mm) / way };
            Some(Extent { mean, ..extent })
        };
        Some(RunForces {
            from_mm: first.stroke_mm,
            normal_right_n: extent(|sample| sample.normal_force_right_n)?,
            normal_left_n: extent(|sample| sample.normal_force_left_n)?,
            rack_n: by_work(|sample| sample.rack_force_n, |sample| sample.stroke_mm)?,
            pinion_torque_n_m: by_work(|sample| sample.pinion_torque_n_m, |sample| 1e3 * sample.pinion_angle_rad)?,
        })
    }

    /// ΔCD of the deviating teeth less that of the nominal ones, mm.
    #[must_use]
    pub fn difference_mm(&self) -> Option<f64> {
        Some(self.deviating?.delta_cd_mm - self.nominal?.delta_cd_mm)
    }

    /// That difference with the elastic indentation removed from both, mm, for comparison with the exact mesh.
    #[must_use]
    pub fn rigid_difference_mm(&self) -> Option<f64> {
        let rigid = |part: Steady| part.delta_cd_mm + part.indentation_mm;
        Some(rigid(self.deviating?) - rigid(self.nominal?))
    }

    /// Whether the whole stroke is there.
    #[must_use]
    pub fn completed(&self) -> bool {
        self.end == RunEnd::Completed
    }
}

/// Means over the longest run of samples that `belongs` accepts, over whole pitches at its end.
pub(super) fn steady(samples: &[Sample], pitch: f64, belongs: impl Fn(&Sample) -> bool) -> Option<Steady> {
    let (mut best, mut from) = (0..0, 0);
    for to in 0..=samples.len() {
        if to < samples.len() && belongs(&samples[to]) {
            continue;
        }
        let length = |range: &std::ops::Range<usize>| {
            if range.len() < 2 { 0.0 } else { samples[range.end - 1].stroke_mm - samples[range.start].stroke_mm }
        };
        if length(&(from..to)) > length(&best) {
            best = from..to;
        }
        from = to + 1;
    }
    let part = &samples[best];
    let (first, last) = (part.first()?.stroke_mm, part.last()?.stroke_mm);
    let pitches = ((last - first) / pitch * (1.0 + 1e-12)).floor();
    let from_mm = if pitches >= 1.0 { (last - pitches * pitch).max(first) } else { first };
    let mean = trapezoids(part, from_mm, |sample| sample.delta_cd_mm);
    let square = trapezoids(part, from_mm, |sample| (sample.delta_cd_mm - mean) * (sample.delta_cd_mm - mean));
    let pitches = pitches.clamp(0.0, 1e9) as u32;
    Some(Steady {
        delta_cd_mm: mean,
        ripple_mm: square.sqrt(),
        indentation_mm: trapezoids(part, from_mm, |sample| sample.indentation_mm),
        from_mm,
        to_mm: last,
        pitches,
    })
}

/// The positions at which a value is smallest and largest, the first of equals.
fn extremes(samples: &[Sample], of: impl Fn(&Sample) -> f64) -> Option<[&Sample; 2]> {
    let first = |sign: f64| samples.iter().min_by(|a, b| (sign * of(a)).total_cmp(&(sign * of(b))));
    Some([first(1.0)?, first(-1.0)?])
}

/// The mean of a value over the stroke from `from_mm` to the last sample.
fn trapezoids(part: &[Sample], from_mm: f64, of: impl Fn(&Sample) -> f64) -> f64 {
    let (mut sum, mut width) = (0.0, 0.0);
    for pair in part.windows(2) {
        let (a, b) = (pair[0].stroke_mm, pair[1].stroke_mm);
        if b <= from_mm {
            continue;
        }
        let left = a.max(from_mm);
        let (start, end) = (of(&pair[0]), of(&pair[1]));
        let at_left = start + (left - a) / (b - a) * (end - start);
        sum += 0.5 * (at_left + end) * (b - left);
        width += b - left;
    }
    if width > 0.0 { sum / width } else { part.last().map_or(0.0, of) }
}
