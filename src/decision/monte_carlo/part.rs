//! A part's formulas as a model to simulate: errors and gear data in, ΔCD of each error and both ends of the
//! combination out. In plain `f64`, a few operations per error: a draw needs no exact decimals.

use super::{Band, MonteCarloError, Outcome, Settings, Simulated, Simulation, Variables, simulate};
use crate::decision::uncertainty::{Distribution, Part, Source, Uncertainties, UncertaintyError};
use crate::decision::{Limit, LimitTarget, Limits, Stack};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::formula::over_pin::OverPin;
use crate::formula::{Model, PartError};
use crate::quantity::{DomainError, Length};
use crate::trig;

/// The simulated distributions of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartSimulation {
    /// Seed, draws, digits; its results are those of the errors, the lower and the upper end, in this order.
    pub outcome: Outcome,
    /// The kinds of the errors, in order.
    pub kinds: Vec<ErrorKind>,
}

impl PartSimulation {
    /// Of each error's ΔCD.
    pub fn errors(&self) -> impl Iterator<Item = (ErrorKind, &Simulation)> {
        self.kinds.iter().copied().zip(&self.outcome.results)
    }

    /// Of the lower end of the combination.
    #[must_use]
    pub fn lower(&self) -> &Simulation {
        &self.outcome.results[self.kinds.len()]
    }

    /// Of the upper end of the combination.
    #[must_use]
    pub fn upper(&self) -> &Simulation {
        &self.outcome.results[self.kinds.len() + 1]
    }
}

/// Simulates a part; `inside` of the outcome holds the probability of conformance for each of `limits` whose error is
/// given, in their order, and NaN for the others.
///
/// # Errors
/// [`MonteCarloError`] if nothing is uncertain, the settings are out of range, or an uncertainty cannot be drawn from.
pub fn simulate_part(
    part: &Part<'_>,
    uncertainties: &Uncertainties,
    limits: &Limits,
    settings: &Settings,
) -> Result<PartSimulation, MonteCarloError> {
    if uncertainties.is_empty() {
        return Err(MonteCarloError::NothingUncertain);
    }
    if let Some(source) = uncertainties.correlated_sources().find(|source| {
        uncertainties.of(*source).is_some_and(|u| u.distribution != Distribution::Normal || u.dof.is_finite())
    }) {
        return Err(MonteCarloError::CorrelatedNotNormal(source));
    }
    if let Some((source, u)) =
        uncertainties.inputs().iter().find(|(_, u)| u.distribution == Distribution::Normal && u.dof < 3.0)
    {
        return Err(MonteCarloError::TooFewFreedom { source_of: *source, dof: u.dof });
    }
    let model = PartModel::new(part, uncertainties).map_err(UncertaintyError::from)?;
    let variables = uncertainties.inputs().iter().map(|(source, u)| (model.best_estimate(*source), *u)).collect();
    let variables = Variables { variables, factor: uncertainties.correlation_factor().map(<[f64]>::to_vec) };
    let kinds: Vec<_> = part.errors.iter().map(PartError::kind).collect();
    let bands: Vec<_> = limits.iter().map(|(on, limit)| band(*on, limit, &kinds)).collect();
    let known: Vec<_> = bands.iter().flatten().copied().collect();
    let mut outcome = simulate(&model, &variables, &known, settings)?;
    let mut inside = std::mem::take(&mut outcome.inside).into_iter();
    outcome.inside = bands.iter().map(|band| band.and_then(|_| inside.next()).unwrap_or(f64::NAN)).collect();
    Ok(PartSimulation { outcome, kinds })
}

fn band(on: LimitTarget, limit: &Limit, kinds: &[ErrorKind]) -> Option<Band> {
    let (low, high) = match on {
        LimitTarget::CenterDistance => (kinds.len(), kinds.len() + 1),
        LimitTarget::Error(kind) => {
            let index = kinds.iter().position(|other| *other == kind)?;
            (index, index)
        }
    };
    let lower = limit.lower.as_ref().map_or(f64::NEG_INFINITY, Length::mm);
    let upper = limit.upper.as_ref().map_or(f64::INFINITY, Length::mm);
    Some(Band { low, high, lower, upper })
}

/// The gear data of a part, mm and degrees; what no error needs is 0.
#[derive(Debug, Clone, Copy, Default)]
struct Gear {
    alpha: f64,
    rack_helix: f64,
    pinion_helix: f64,
    face_width: f64,
}

/// The inputs of an over-roller nominal, mm.
#[derive(Debug, Clone, Copy)]
struct Nominal {
    module: f64,
    /// s_n, or `None` for π m_n / 2.
    thickness: Option<f64>,
    pin: f64,
    datum: f64,
    /// The nominal measure.
    measure: f64,
}

/// An error's best estimate, mm or degrees.
#[derive(Debug, Clone, Copy)]
struct PartValue {
    kind: ErrorKind,
    value: f64,
    /// Whether it is a permissible deviation, which acts either way.
    is_tolerance: bool,
}

struct PartModel {
    errors: Vec<PartValue>,
    gear: Gear,
    nominal: Option<Nominal>,
    model: Model,
    stack: Stack,
    /// The columns that vary, by source.
    columns: Vec<Source>,
    /// mm of ΔCD per mm of step or of k sin Δβ, where no gear data vary.
    gains: Gains,
}

#[derive(Debug, Clone, Copy)]
struct Gains {
    rack_pitch: f64,
    pinion_pitch: f64,
    lead: f64,
}

/// What one draw may give an angle, degrees.
const ALPHA_DEG: (f64, f64) = (0.0, 45.0);

fn radians(degrees: f64) -> f64 {
    degrees * (std::f64::consts::PI / 180.0)
}

impl Gains {
    /// NaN outside the formulas' domain.
    fn new(gear: &Gear, model: Model) -> Self {
        let alpha_is_valid = gear.alpha > ALPHA_DEG.0 && gear.alpha <= ALPHA_DEG.1;
        let helix_is_valid = gear.rack_helix.abs() < 90.0 && gear.pinion_helix.abs() < 90.0;
        if !(alpha_is_valid && helix_is_valid && gear.face_width >= 0.0) {
            return Self { rack_pitch: f64::NAN, pinion_pitch: f64::NAN, lead: f64::NAN };
        }
        let half_cot = 0.5 / trig::tan(radians(gear.alpha));
        let (rack, pinion) = match model {
            Model::Exact => (trig::cos(radians(gear.rack_helix)), trig::cos(radians(gear.pinion_helix))),
            Model::Paper => (1.0, 1.0),
        };
        Self { rack_pitch: half_cot * rack, pinion_pitch: half_cot * pinion, lead: gear.face_width * half_cot / rack }
    }
}

impl Nominal {
    fn new(over_pin: &OverPin) -> Result<Self, DomainError> {
        Ok(Self {
            module: over_pin.normal_module.mm(),
            thickness: over_pin.tooth_thickness.as_ref().map(Length::mm),
            pin: over_pin.pin_diameter.mm(),
            datum: over_pin.datum.mm(),
            measure: over_pin.measure()?.mm(),
        })
    }

    /// M = K − (π m_n − s_n)/(2 tan α_n) + (d_p/2)(1 + 1/sin α_n)
    fn measure_at(&self, alpha: f64) -> f64 {
        let (sin, cos) = trig::sin_cos(radians(alpha));
        let pitch = std::f64::consts::PI * self.module;
        let space = pitch - self.thickness.unwrap_or(0.5 * pitch);
        self.datum - 0.5 * space * cos / sin + 0.5 * self.pin * (1.0 + 1.0 / sin)
    }
}

impl PartModel {
    fn new(part: &Part<'_>, uncertainties: &Uncertainties) -> Result<Self, DomainError> {
        // where no formula needs an angle its gain is not used: any valid one will do
        let mut gear = Gear { alpha: 20.0, ..Gear::default() };
        for error in part.errors {
            if let Some((alpha, helix, face_width)) = error.geometry() {
                gear.alpha = alpha.degrees();
                match error.kind() {
                    ErrorKind::PinionPitch => gear.pinion_helix = helix.degrees(),
                    _ => gear.rack_helix = helix.degrees(),
                }
                gear.face_width = face_width.map_or(gear.face_width, Length::mm);
            }
        }
        if let Some(over_pin) = part.over_pin {
            gear.alpha = over_pin.normal_pressure_angle.degrees();
        }
        let errors = part
            .errors
            .iter()
            .map(|error| {
                let value = match error.value() {
                    ErrorValue::Length(length) => length.mm(),
                    ErrorValue::Angle(angle) => angle.degrees(),
                };
                PartValue { kind: error.kind(), value, is_tolerance: error.is_tolerance() }
            })
            .collect();
        Ok(Self {
            errors,
            gear,
            nominal: part.over_pin.map(Nominal::new).transpose()?,
            model: part.model,
            stack: part.stack,
            columns: uncertainties.inputs().iter().map(|(source, _)| *source).collect(),
            gains: Gains::new(&gear, part.model),
        })
    }

    fn best_estimate(&self, source: Source) -> f64 {
        let nominal = |value: &dyn Fn(&Nominal) -> f64| self.nominal.as_ref().map_or(0.0, value);
        match source {
            Source::Error(kind) => self.errors.iter().find(|error| error.kind == kind).map_or(0.0, |error| error.value),
            Source::NormalPressureAngle => self.gear.alpha,
            Source::RackHelixAngle => self.gear.rack_helix,
            Source::PinionHelixAngle => self.gear.pinion_helix,
            Source::FaceWidth => self.gear.face_width,
            Source::NormalModule => nominal(&|nominal| nominal.module),
            Source::ToothThickness => nominal(&|nominal| nominal.thickness.unwrap_or(0.0)),
            Source::Datum => nominal(&|nominal| nominal.datum),
            Source::Roller => nominal(&|nominal| nominal.pin),
        }
    }

    fn varies(&self, sources: &[Source]) -> bool {
        self.columns.iter().any(|source| sources.contains(source))
    }

    fn column<'a>(&self, source: Source, inputs: &'a [Vec<f64>]) -> Option<&'a [f64]> {
        self.columns.iter().position(|other| *other == source).map(|index| inputs[index].as_slice())
    }

    /// The gear data of one draw.
    fn gear_at(&self, inputs: &[Vec<f64>], draw: usize) -> Gear {
        let mut gear = self.gear;
        for (source, column) in self.columns.iter().zip(inputs) {
            match source {
                Source::NormalPressureAngle => gear.alpha = column[draw],
                Source::RackHelixAngle => gear.rack_helix = column[draw],
                Source::PinionHelixAngle => gear.pinion_helix = column[draw],
                Source::FaceWidth => gear.face_width = column[draw],
                _ => {}
            }
        }
        gear
    }

    /// How far the over-roller nominal of one draw is off.
    fn nominal_shift(&self, nominal: &Nominal, inputs: &[Vec<f64>], draw: usize) -> f64 {
        let mut drawn = *nominal;
        let mut alpha = self.gear.alpha;
        for (source, column) in self.columns.iter().zip(inputs) {
            match source {
                Source::NormalPressureAngle => alpha = column[draw],
                Source::NormalModule => drawn.module = column[draw],
                Source::ToothThickness if drawn.thickness.is_some() => drawn.thickness = Some(column[draw]),
                Source::Datum => drawn.datum = column[draw],
                Source::Roller => drawn.pin = column[draw],
                _ => {}
            }
        }
        drawn.measure_at(alpha) - nominal.measure
    }
}

/// The sine of an angle; below 0.004 rad, a quarter of a degree, by the series, whose first term left out is below
/// 1e-18 of it.
#[inline]
fn sin(x: f64) -> f64 {
    if x.abs() < 0.004 {
        let square = x * x;
        x * (1.0 - square * (1.0 / 6.0) * (1.0 - square * (1.0 / 20.0)))
    } else {
        trig::sin(x)
    }
}

/// Maps a column in place.
fn each(column: &mut [f64], f: impl Fn(f64) -> f64) {
    for x in column {
        *x = f(*x);
    }
}

impl Simulated for PartModel {
    fn outputs(&self) -> usize {
        self.errors.len() + 2
    }

    fn evaluate(&self, inputs: &[Vec<f64>], outputs: &mut [Vec<f64>]) {
        const GEAR: [Source; 4] =
            [Source::NormalPressureAngle, Source::RackHelixAngle, Source::PinionHelixAngle, Source::FaceWidth];
        const NOMINAL: [Source; 5] =
            [Source::NormalPressureAngle, Source::NormalModule, Source::ToothThickness, Source::Datum, Source::Roller];
        let draws = outputs.first().map_or(0, Vec::len);
        let drawn_gains: Vec<Gains> = if self.varies(&GEAR) {
            (0..draws).map(|draw| Gains::new(&self.gear_at(inputs, draw), self.model)).collect()
        } else {
            Vec::new()
        };
        for (PartValue { kind, value, .. }, out) in self.errors.iter().zip(outputs.iter_mut()) {
            match self.column(Source::Error(*kind), inputs) {
                Some(column) => out.copy_from_slice(column),
                None => out.fill(*value),
            }
            match kind {
                ErrorKind::RackOverRoller => {
                    if let Some(nominal) = &self.nominal
                        && self.varies(&NOMINAL)
                    {
                        for (draw, x) in out.iter_mut().enumerate() {
                            *x -= self.nominal_shift(nominal, inputs, draw);
                        }
                    }
                }
                ErrorKind::PinionRadial => {}
                ErrorKind::RackPitch | ErrorKind::PinionPitch => each(out, f64::abs),
                ErrorKind::RackLead if self.model == Model::Exact => each(out, |x| sin(radians(x.abs()))),
                ErrorKind::RackLead => each(out, |x| trig::tan(radians(x.abs()))),
            }
            let gain = |gains: &Gains| match kind {
                ErrorKind::RackPitch => Some(gains.rack_pitch),
                ErrorKind::PinionPitch => Some(gains.pinion_pitch),
                ErrorKind::RackLead => Some(gains.lead),
                ErrorKind::RackOverRoller | ErrorKind::PinionRadial => None,
            };
            let Some(constant) = gain(&self.gains) else { continue };
            if drawn_gains.is_empty() {
                each(out, |x| x * constant);
            } else {
                for (x, gains) in out.iter_mut().zip(&drawn_gains) {
                    *x *= gain(gains).unwrap_or(1.0);
                }
            }
        }
        let (errors, ends) = outputs.split_at_mut(self.errors.len());
        let [lower, upper] = ends else { return };
        lower.fill(0.0);
        upper.fill(0.0);
        for (error, values) in self.errors.iter().zip(errors.iter()) {
            match self.stack {
                Stack::Range if error.is_tolerance && error.kind.always_acts() => {
                    upper.iter_mut().zip(values).for_each(|(sum, x)| *sum += x.abs());
                    lower.iter_mut().zip(values).for_each(|(sum, x)| *sum -= x.abs());
                }
                Stack::Range => {
                    upper.iter_mut().zip(values).for_each(|(sum, x)| *sum += x);
                    if error.kind.always_acts() {
                        lower.iter_mut().zip(values).for_each(|(sum, x)| *sum += x);
                    }
                }
                Stack::WorstCase => upper.iter_mut().zip(values).for_each(|(sum, x)| *sum += x.abs()),
                Stack::Rss => upper.iter_mut().zip(values).for_each(|(sum, x)| *sum += x * x),
            }
        }
        if self.stack == Stack::Rss {
            each(upper, f64::sqrt);
        }
        if self.stack != Stack::Range {
            lower.iter_mut().zip(upper.iter()).for_each(|(lower, upper)| *lower = -upper);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decision::uncertainty::Uncertainty;
    use crate::decision::uncertainty::tests::{SOURCES, Scene};

    /// Each draw gives what the formulas give for a part with the drawn values.
    #[test]
    fn every_draw_is_a_part() {
        // all quantities, those of no formula's geometry, one helix angle, and errors alone
        for sources in [&SOURCES[..], &SOURCES[9..], &SOURCES[6..7], &SOURCES[..5]] {
            for scene in Scene::all() {
                let uncertain = sources.iter().map(|source| (*source, Uncertainty::standard(1.0))).collect();
                let uncertainties = Uncertainties::new(uncertain, &[]).unwrap();
                let (errors, over_pin) = (scene.errors(), scene.over_pin());
                let part = Part { errors: &errors, over_pin: Some(&over_pin), model: scene.model, stack: scene.stack };
                let model = PartModel::new(&part, &uncertainties).unwrap();
                assert_eq!(model.outputs(), 7);
                let mut inputs: Vec<Vec<f64>> = vec![Vec::new(); sources.len()];
                let mut expected = Vec::new();
                for draw in 0..8_u8 {
                    let mut drawn = scene;
                    for (value, source) in drawn.values.iter_mut().zip(SOURCES) {
                        let Some(column) = sources.iter().position(|other| *other == source) else { continue };
                        // a lead error of up to 1.5°, either side of what the series is for
                        let far = if source == Source::Error(ErrorKind::RackLead) { 60.0 } else { 0.05 };
                        let absent = source == Source::ToothThickness && !scene.thickness;
                        assert!(absent || model.best_estimate(source) == *value, "{source:?}");
                        *value *= 1.0
                            + far
                                * (f64::from(draw) / 4.0 - 1.0)
                                * (1.0 - 0.05 * f64::from(u8::try_from(column).unwrap()));
                        inputs[column].push(*value);
                    }
                    expected.push(drawn.delta_cd());
                }
                let mut outputs = vec![vec![0.0; expected.len()]; 7];
                model.evaluate(&inputs, &mut outputs);
                for (draw, expected) in expected.iter().enumerate() {
                    for (which, expected) in expected.iter().enumerate() {
                        let found = outputs[which][draw];
                        let (stack, model) = (scene.stack, scene.model);
                        assert!((found - expected).abs() < 1e-13, "{stack:?} {model:?} {which}: {found} {expected}");
                    }
                }
            }
        }
    }

    /// Outside the formulas' domain there is no ΔCD.
    #[test]
    fn gear_data_outside_the_domain_have_no_gain() {
        let inside = Gear { alpha: 45.0, rack_helix: 12.0, pinion_helix: -89.9, face_width: 0.0 };
        assert!(Gains::new(&inside, Model::Exact).lead.is_finite());
        for outside in [
            Gear { alpha: 0.0, ..inside },
            Gear { alpha: 45.1, ..inside },
            Gear { rack_helix: -90.0, ..inside },
            Gear { pinion_helix: 90.0, ..inside },
            Gear { face_width: -0.1, ..inside },
        ] {
            assert!(Gains::new(&outside, Model::Exact).lead.is_nan(), "{outside:?}");
        }
    }

    /// The series and the function, next to each other or the same, on either side of where one takes over from the other.
    #[test]
    fn the_sine_of_small_and_large_angles() {
        for step in -2000..=2000 {
            let x = 4e-6 * f64::from(step);
            assert!((sin(x) - trig::sin(x)).abs() <= f64::EPSILON * x.abs(), "{x}");
        }
        for x in [-1.5, 0.5, 1.5] {
            assert_eq!(sin(x), trig::sin(x));
        }
    }
}
