//! A part's formulas as a model to simulate: errors and gear data in, ΔCD of each error and both ends of the
//! combination out. In plain `f64`, a few operations per error: a draw needs no exact decimals.

use super::{Band, MonteCarloError, Outcome, Settings, Simulated, Simulation, Variables, Watch, simulate_watched};
use crate::deviation::DeviationKind;
use crate::formula::over_pin::OverPin;
use crate::formula::{Law, Model, PartDeviation};
use crate::judge::bound::{Basis, ExtendedError, GivenGeometry, Range};
use crate::judge::{Limit, LimitTarget, Limits, Stack};
use crate::quantity::{DomainError, Length};
use crate::uncertainty::gear::{Gear, NO_RANGE, OF_LAWS, VariedError, VariedPair, ends, range_alone};
use crate::uncertainty::{Distribution, Influence, TeethSensitivity, UncertainPart, Uncertainties, UncertaintyError};

/// The simulated distributions of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartSimulation {
    /// Seed, draws, digits, and the results in this order: each error, the lower and the upper end of the combination, then both
    /// ends of each error alone that has a limit.
    pub outcome: Outcome,
    /// The kinds of the errors, in order.
    pub kinds: Vec<DeviationKind>,
}

impl PartSimulation {
    /// Of each error's ΔCD.
    pub fn errors(&self) -> impl Iterator<Item = (DeviationKind, &Simulation)> {
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
    part: &UncertainPart<'_>,
    uncertainties: &Uncertainties,
    limits: &Limits,
    settings: &Settings,
) -> Result<PartSimulation, MonteCarloError> {
    simulate_part_watched(part, uncertainties, limits, settings, &|_| {})
}

/// The same, with a look at how much is done.
pub(crate) fn simulate_part_watched(
    part: &UncertainPart<'_>,
    uncertainties: &Uncertainties,
    limits: &Limits,
    settings: &Settings,
    watch: &Watch<'_>,
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
    let kinds: Vec<_> = part.errors.iter().map(PartDeviation::kind).collect();
    let is_limited = |&index: &usize| limits.iter().any(|(on, _)| *on == LimitTarget::Error(kinds[index]));
    let limited = (0..kinds.len()).filter(is_limited).collect();
    let model = PartModel::new(part, uncertainties, limited).map_err(UncertaintyError::from)?;
    let variables = uncertainties.inputs().iter().map(|(source, u)| (model.best_estimate(*source), *u)).collect();
    let variables = Variables { variables, factor: uncertainties.correlation_factor().map(<[f64]>::to_vec) };
    let bands: Vec<_> = limits.iter().map(|(on, limit)| model.band(*on, limit)).collect();
    let known: Vec<_> = bands.iter().flatten().copied().collect();
    let mut outcome = simulate_watched(&model, &variables, &known, settings, watch)?;
    let mut inside = std::mem::take(&mut outcome.inside).into_iter();
    outcome.inside = bands.iter().map(|band| band.and_then(|_| inside.next()).unwrap_or(f64::NAN)).collect();
    Ok(PartSimulation { outcome, kinds })
}

/// An error's best estimate, mm or degrees.
#[derive(Debug, Clone, Copy)]
struct PartValue {
    law: Law,
    value: f64,
    /// The error for the bound; `None` if it is too large for one.
    varied: Option<VariedError>,
}

struct PartModel {
    errors: Vec<PartValue>,
    gear: Gear,
    /// The nominal measure over the roller, if it is computed, mm.
    nominal_mm: Option<f64>,
    model: Model,
    stack: Stack,
    basis: Basis,
    /// Pairs of known geometry with sizes that are off.
    pairs: Vec<VariedPair>,
    /// The errors, by index, that have a limit of their own.
    limited: Vec<usize>,
    /// The derivatives of both ends by uncertain values of teeth that are known one by one: linear.
    teeth: Vec<TeethSensitivity>,
    /// The columns that vary, by source.
    columns: Vec<Influence>,
}

impl PartModel {
    fn new(part: &UncertainPart<'_>, uncertainties: &Uncertainties, limited: Vec<usize>) -> Result<Self, DomainError> {
        let value = |error: &PartDeviation| PartValue {
            law: error.law(),
            value: error.value().base(),
            varied: VariedError::new(error),
        };
        let errors = part.errors.iter().map(value).collect();
        Ok(Self {
            errors,
            gear: Gear::new(part.errors, part.over_pin, part.basis),
            nominal_mm: part.over_pin.map(OverPin::measure).transpose()?.map(Length::mm),
            model: part.model,
            stack: part.stack,
            basis: part.basis.clone(),
            pairs: VariedPair::all(part.basis, uncertainties),
            limited,
            teeth: part.teeth.to_vec(),
            columns: uncertainties.inputs().iter().map(|(source, _)| *source).collect(),
        })
    }

    /// The results that a limit judges.
    fn band(&self, on: LimitTarget, limit: &Limit) -> Option<Band> {
        let both_ends = self.errors.len();
        let low = match on {
            LimitTarget::CenterDistance => both_ends,
            LimitTarget::Error(kind) => {
                let of_kind = |&index: &usize| self.errors[index].law.kind() == kind;
                both_ends + 2 + 2 * self.limited.iter().position(of_kind)?
            }
        };
        let lower = limit.lower.map_or(f64::NEG_INFINITY, Length::mm);
        let upper = limit.upper.map_or(f64::INFINITY, Length::mm);
        Some(Band { low, high: low + 1, lower, upper })
    }

    fn best_estimate(&self, source: Influence) -> f64 {
        match source {
            Influence::Error(kind) => {
                self.errors.iter().find(|error| error.law.kind() == kind).map_or(0.0, |error| error.value)
            }
            of_gear => { self.gear }.of_source(of_gear).map_or(0.0, |value| *value),
        }
    }

    fn varies(&self, sources: &[Influence]) -> bool {
        self.columns.iter().any(|source| sources.contains(source))
    }

    fn column<'a>(&self, source: Influence, inputs: &'a [Vec<f64>]) -> Option<&'a [f64]> {
        self.columns.iter().position(|other| *other == source).map(|index| inputs[index].as_slice())
    }

    /// The gear data of one draw.
    fn gear_at(&self, inputs: &[Vec<f64>], draw: usize) -> Gear {
        let mut gear = self.gear;
        for (source, column) in self.columns.iter().zip(inputs) {
            if let Some(value) = gear.of_source(*source) {
                *value = column[draw];
            }
        }
        gear
    }
}

impl Simulated for PartModel {
    fn outputs(&self) -> usize {
        self.errors.len() + 2 + 2 * self.limited.len()
    }

    fn evaluate(&self, inputs: &[Vec<f64>], outputs: &mut [Vec<f64>]) {
        const NOMINAL: [Influence; 5] = [
            Influence::NormalPressureAngle,
            Influence::NormalModule,
            Influence::ToothThickness,
            Influence::Datum,
            Influence::Roller,
        ];
        let laws_vary = self.varies(&OF_LAWS);
        let nominal = self.nominal_mm.filter(|_| self.varies(&NOMINAL));
        let own = nominal.filter(|_| !matches!(self.basis.geometry, GivenGeometry::Known(_)));
        let own = own.map(|_| self.gear.own_delta_cd_mm());
        let (errors, ends) = outputs.split_at_mut(self.errors.len());
        for (PartValue { law, value, .. }, out) in self.errors.iter().zip(errors.iter_mut()) {
            match self.column(Influence::Error(law.kind()), inputs) {
                Some(column) => out.copy_from_slice(column),
                None => out.fill(*value),
            }
            if let Some(nominal) = nominal.filter(|_| law.kind() == DeviationKind::RackOverRoller) {
                for (draw, x) in out.iter_mut().enumerate() {
                    *x -= self.gear_at(inputs, draw).measure() - nominal;
                }
            }
        }
        // the outputs still hold the errors' values
        for draw in 0..ends[0].len() {
            let gear = if laws_vary || own.is_some() { self.gear_at(inputs, draw) } else { self.gear };
            let drawn = self.drawn(errors, draw, laws_vary.then_some(&gear));
            let both = self.in_drawn_pair(inputs, draw, |basis| self.ends_of(&drawn, basis));
            let teeth = self.teeth_at(inputs, draw);
            let own = own.map_or(0.0, |own| gear.own_delta_cd_mm() - own);
            (ends[0][draw], ends[1][draw]) = (both.lower + teeth.lower + own, both.upper + teeth.upper + own);
            for (&index, alone) in self.limited.iter().zip(ends[2..].chunks_exact_mut(2)) {
                let of = |basis: &Basis| drawn[index].map_or(NO_RANGE, |error| range_alone(&error, basis));
                let both = self.in_drawn_pair(inputs, draw, of);
                (alone[0][draw], alone[1][draw]) = (both.lower, both.upper);
            }
            for (PartValue { law, .. }, out) in self.errors.iter().zip(errors.iter_mut()) {
                let law = if laws_vary { gear.law(*law) } else { *law };
                out[draw] = law.delta_cd_mm(out[draw], self.model);
            }
        }
    }
}

impl PartModel {
    /// How far one draw moves both extremes of known teeth.
    fn teeth_at(&self, inputs: &[Vec<f64>], draw: usize) -> Range {
        let mut off = Range::default();
        for TeethSensitivity { source, slope, .. } in &self.teeth {
            let Some(column) = self.column(*source, inputs) else { continue };
            let by = column[draw] - self.best_estimate(*source);
            off = off.with(*slope, |off, slope| off + slope * by);
        }
        off
    }

    /// The errors of one draw, with the part's own gear unless another is given. `None` for errors without a bound.
    fn drawn(&self, values: &[Vec<f64>], draw: usize, gear: Option<&Gear>) -> DrawnErrors {
        let mut errors = [None; DeviationKind::ALL.len()];
        for ((error, part), column) in errors.iter_mut().zip(&self.errors).zip(values) {
            *error = part.varied.as_ref().map(|varied| match gear {
                Some(gear) => varied.at(column[draw], gear),
                None => varied.with_value(column[draw]),
            });
        }
        errors
    }

    /// Both ends of the combination of errors.
    fn ends_of(&self, drawn: &DrawnErrors, basis: &Basis) -> Range {
        let mut errors = [ExtendedError::NONE; DeviationKind::ALL.len()];
        for (error, drawn) in errors.iter_mut().zip(drawn).take(self.errors.len()) {
            let Some(drawn) = drawn else { return NO_RANGE };
            *error = *drawn;
        }
        ends(self.stack, &errors[..self.errors.len()], basis)
    }

    /// The results of the pair of one draw, in proportion to how far each of its sizes is off.
    fn in_drawn_pair(&self, inputs: &[Vec<f64>], draw: usize, of: impl Fn(&Basis) -> Range) -> Range {
        let nominal = of(&self.basis);
        let mut range = nominal;
        for pair in &self.pairs {
            let Some(column) = self.column(pair.source, inputs) else { continue };
            let by = column[draw] - self.best_estimate(pair.source);
            let slope = pair.slope(by > 0.0, nominal, &of);
            range = range.with(slope, |end, slope| end + by * slope);
        }
        range
    }
}

type DrawnErrors = [Option<ExtendedError>; DeviationKind::ALL.len()];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uncertainty::Uncertainty;
    use crate::uncertainty::tests::{SOURCES, Scene};

    /// Each draw has the result of the formulas for a part with the drawn values.
    #[test]
    fn every_draw_is_a_part() {
        // all quantities, those of no formula's geometry, one helix angle, and errors alone
        for sources in [&SOURCES[..], &SOURCES[9..], &SOURCES[6..7], &SOURCES[..5]] {
            for scene in Scene::all() {
                let uncertain = sources.iter().map(|source| (*source, Uncertainty::standard(1.0))).collect();
                let uncertainties = Uncertainties::new(uncertain, &[]).unwrap();
                let (errors, over_pin, basis) = (scene.errors(), scene.over_pin(), scene.basis());
                let part = UncertainPart {
                    errors: &errors,
                    over_pin: Some(&over_pin),
                    model: scene.model,
                    stack: scene.stack,
                    basis: &basis,
                    teeth: &[],
                };
                let model = PartModel::new(&part, &uncertainties, Vec::new()).unwrap();
                assert_eq!(model.outputs(), DeviationKind::ALL.len() + 2);
                let mut inputs: Vec<Vec<f64>> = vec![Vec::new(); sources.len()];
                let mut expected = Vec::new();
                for draw in 0..8_u8 {
                    let mut drawn = scene;
                    for (value, source) in drawn.values.iter_mut().zip(SOURCES) {
                        let Some(column) = sources.iter().position(|other| *other == source) else { continue };
                        // a lead error of up to 1.5°
                        let far = if source == Influence::Error(DeviationKind::RackLead) { 60.0 } else { 0.05 };
                        let absent = source == Influence::ToothThickness && !scene.thickness;
                        assert!(absent || model.best_estimate(source) == *value, "{source:?}");
                        *value *= 1.0
                            + far
                                * (f64::from(draw) / 4.0 - 1.0)
                                * (1.0 - 0.05 * f64::from(u8::try_from(column).unwrap()));
                        inputs[column].push(*value);
                    }
                    expected.push(drawn.delta_cd());
                }
                let mut outputs = vec![vec![0.0; expected.len()]; model.outputs()];
                model.evaluate(&inputs, &mut outputs);
                for (draw, expected) in expected.iter().enumerate() {
                    for (which, expected) in expected.iter().enumerate() {
                        let found = outputs[which][draw];
                        let (stack, model) = (scene.stack, scene.model);
                        // the parts lie on the grid of lengths
                        assert!((found - expected).abs() < 4e-12, "{stack:?} {model:?} {which}: {found} {expected}");
                    }
                }
            }
        }
    }
}
