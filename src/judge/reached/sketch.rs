//! The demand of one flank pair along its path of contact, from one exact mesh in which a single rack tooth stands out. It
//! tells the search which placements are worth an exact mesh of their own; no result comes from here.
//!
//! Let ν(p) be what the flank pair of tooth 0 asks for at the stroke p beyond its error. Then the flank pair of tooth i asks
//! for its error + ν(s − i) at the stroke s, and ΔCD is half the sum of the largest demands of right and of left flanks.

use super::placed::{BySide, FlankDemand, Placed, ReachedError};
use crate::deviation::{DeviationKind, Part};
use crate::formula::Model;
use crate::formula::law::unit_gain;
use crate::gear::Pair;
use crate::judge::bound::error::ErrorEffect;
use crate::judge::bound::field::{ContactPath, Field, mm_per_rad};
use crate::judge::bound::lead::Slopes;
use crate::judge::bound::{ExtendedError, GivenPair, Range};
use crate::mesh::{FlankSide, MeshPoint, Sampler};
use crate::trig;

/// Strokes in each pitch.
pub(super) const STEPS: i64 = 32;
/// The tooth stands out by so many times the effect of the errors, mm of ΔCD, so that its edges carry, too.
const TIMES: f64 = 2.0;
const LEAST_MM: f64 = 0.005;
/// A tooth that stands out by more modules has another path of contact.
const MOST_MODULES: f64 = 0.05;
/// How far beyond the path of contact edges may carry, and the largest distance of all, pitches.
const BEYOND: f64 = 1.0;
const FARTHEST: f64 = 12.0;
/// Width of the part of the field of contact that stands for a stroke, pitches.
const WIDTH: f64 = 1e-6;

#[derive(Debug)]
pub(super) struct Sketch {
    pair: Pair,
    /// The first stroke of the samples.
    first: i64,
    samples: Vec<Sample>,
}

/// At one stroke of a rack tooth's path.
#[derive(Debug)]
struct Sample {
    /// The demand of its flanks beyond their errors, mm; `None` where others carry.
    right: Option<f64>,
    left: Option<f64>,
    /// Where the right flank touches; left empty if no error turns tooth lines.
    spots: Option<Field>,
}

impl Sketch {
    /// The sketch of a pair for errors of this size.
    pub(super) fn new(given: &GivenPair, errors: &[ExtendedError]) -> Result<Self, ReachedError> {
        let pair = given.pair;
        let path = ContactPath::nominal(&pair);
        let turns = errors.iter().any(|error| error.effect.is_lead());
        let out_mm = (TIMES * size(errors)).max(LEAST_MM).min(MOST_MODULES * pair.normal_module_mm());
        let tan = trig::tan(pair.normal_pressure_angle_rad());
        let along_x = out_mm * tan / trig::cos(pair.rack().helix_angle_rad);
        let mut placed = Placed::new(&pair);
        placed.shift(Part::Rack, 0, BySide { left: -along_x, right: along_x });
        let mesh = placed.mesh(given)?;
        let mut sampler = Sampler::new(&mesh);
        let end = STEPS * (0.5 * path.ratio + path.offset.abs() + BEYOND).min(FARTHEST).ceil() as i64;
        let per_rad = mm_per_rad(&pair);
        let field = Field::nominal(&pair);
        let mut sample = |index: i64| {
            let point = sampler.at(stroke(index) * pair.rack().pitch_mm).ok().filter(MeshPoint::is_solved);
            // a right flank that stands out turns the pinion back
            let asked = |side: FlankSide, sign: f64| {
                let point = point.filter(|point| carrier(point, side) == 0)?;
                Some(point.delta_cd_mm + sign * per_rad * point.transmission_error_rad - out_mm)
            };
            let (right, left) = (asked(FlankSide::Right, -1.0), asked(FlankSide::Left, 1.0));
            Sample { right, left, spots: turns.then(|| spots(&field, &path, stroke(index))) }
        };
        let samples = (-end..=end).map(&mut sample).collect();
        Ok(Self { pair, first: -end, samples })
    }

    /// The teeth of the rack that can carry at strokes within the first pitch.
    pub(super) fn teeth(&self) -> std::ops::RangeInclusive<i64> {
        let carries = |sample: &Sample| sample.right.is_some() || sample.left.is_some();
        let index = |place: Option<usize>| place.map_or(0, |place| self.first + i64::try_from(place).unwrap_or(0));
        let (low, high) = (index(self.samples.iter().position(carries)), index(self.samples.iter().rposition(carries)));
        (-high).div_euclid(STEPS)..=(STEPS - low).div_euclid(STEPS)
    }

    /// The demand of a flank at a stroke, mm; `None` if it does not carry there. A left flank is a right one turned by half a
    /// turn about the vertical.
    pub(super) fn asked(&self, side: FlankSide, stroke: i64, tooth: i64, asked: &FlankDemand) -> Option<f64> {
        let place = stroke - STEPS * tooth;
        let sample = self.sample(place)?;
        let (beyond_error, place) = match side {
            FlankSide::Right => (sample.right?, place),
            FlankSide::Left => (sample.left?, -place),
        };
        Some(beyond_error + asked.by_mm + self.turned(place, asked))
    }

    fn sample(&self, place: i64) -> Option<&Sample> {
        usize::try_from(place - self.first).ok().and_then(|index| self.samples.get(index))
    }

    /// The most that a turned right flank asks for, mm.
    fn turned(&self, place: i64, asked: &FlankDemand) -> f64 {
        if !asked.turns() {
            return 0.0;
        }
        let Some(spots) = self.sample(place).and_then(|sample| sample.spots.as_ref()) else { return 0.0 };
        let tan = trig::tan(self.pair.normal_pressure_angle_rad());
        let rack = Slopes::of_rack(asked.rack_turn_rad, tan, self.pair.rack().helix_angle_rad);
        let pinion = self.pair.pinion();
        let gain = unit_gain(DeviationKind::PinionLead, Model::Exact, tan, trig::cos(pinion.helix_angle_rad));
        let slopes = rack.with(&Slopes::of_pinion(gain * asked.pinion_slope_mm, 0.5 * pinion.face_width_mm));
        spots.extremes(|spot| slopes.at(spot)).map_or(0.0, |range| range.upper)
    }
}

/// A stroke in pitches.
pub(super) fn stroke(index: i64) -> f64 {
    index as f64 / STEPS as f64
}

fn carrier(point: &MeshPoint, side: FlankSide) -> i64 {
    match side {
        FlankSide::Right => point.right.rack_tooth,
        FlankSide::Left => point.left.rack_tooth,
    }
}

/// The sum of what the errors raise if each acts once, mm.
fn size(errors: &[ExtendedError]) -> f64 {
    let of_one = |error: &ExtendedError| match error.effect {
        ErrorEffect::Size => error.value.abs(),
        ErrorEffect::PinionLead { gain } => (gain * error.value).abs(),
        ErrorEffect::Pitch { gain, .. } => 2.0 * gain * error.value.abs(),
        ErrorEffect::RackLead(rack) => 0.5 * rack.face_width * error.value.abs() / rack.tan_alpha,
    };
    errors.iter().map(of_one).sum()
}

/// Where a right flank touches at a stroke; the end of its path if an edge carries.
fn spots(field: &Field, path: &ContactPath, stroke: f64) -> Field {
    let half = (0.5 * path.ratio - WIDTH).max(0.0);
    let stroke = stroke.clamp(path.offset - half, path.offset + half);
    field.between(Range { lower: stroke - WIDTH, upper: stroke + WIDTH })
}
