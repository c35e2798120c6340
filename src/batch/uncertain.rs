//! The uncertainties of the parts of a batch. The plan makes it, the evaluator uses it; it decides nothing.

use super::output::{End, UncertainOutput};
use super::request::Request;
use super::source::{Source, index_of};
use crate::chance::{
    MOST_ADAPTIVE_OF_MANY, MonteCarloError, PartSimulation, Settings, Simulation, simulate_part, validate,
};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::PartDeviation;
use crate::formula::over_pin::OverPin;
use crate::judge::Limits;
use crate::judge::bound::Basis;
use crate::quantity::Length;
use crate::spec::Spec;
use crate::uncertainty::{Point, Propagator, Spreads, TeethSensitivity, UncertainPart};

/// The uncertainty of a part's results.
pub(super) struct RowUncertainty {
    pub(super) spreads: Spreads,
    simulation: Option<PartSimulation>,
    /// Whether the simulation confirms the linear result for both ends of the combination; `None` where it leaves that open.
    pub(super) validated: Option<bool>,
}

/// The uncertain inputs of the parts.
#[derive(Debug, Clone)]
pub(super) struct Uncertain {
    pub(super) propagator: Propagator,
    /// The inputs of the nominal measure over the roller, if it is computed.
    over_pin: Option<OverPin>,
    /// How to simulate; `None` for no simulation.
    monte_carlo: Option<Settings>,
    /// The model and the combination.
    request: Request,
    basis: Basis,
    /// The derivatives of the spec's single teeth by uncertain values.
    teeth: Vec<TeethSensitivity>,
}

impl RowUncertainty {
    /// The simulated probability that the limit with that index is met.
    pub(super) fn inside(&self, limit: usize) -> Option<f64> {
        let inside = &self.simulation.as_ref()?.outcome.inside;
        inside.get(limit).copied().filter(|probability| !probability.is_nan())
    }

    /// The simulated distribution of a result.
    pub(super) fn simulation_of(&self, sources: &[Source], of: UncertainOutput) -> Option<&Simulation> {
        let part = self.simulation.as_ref()?;
        Some(match of {
            UncertainOutput::Error(kind) => &part.outcome.results[index_of(sources, kind)?],
            UncertainOutput::Combined(End::Lower) => part.lower(),
            UncertainOutput::Combined(End::Upper) => part.upper(),
        })
    }
}

impl Uncertain {
    /// The uncertainties of parts with these errors.
    pub(super) fn new(spec: &Spec, sources: &[Source], request: &Request, basis: &Basis) -> Result<Self, Diagnostics> {
        let kinds: Vec<_> = sources.iter().map(|source| source.law.kind()).collect();
        let over_pin = spec.over_pin().filter(|over_pin| {
            // another nominal value may stand in the way
            let computed = over_pin.measure().map(DeviationValue::Length);
            computed.is_ok_and(|nominal| {
                let is_so = |source: &Source| {
                    source.law.kind() == DeviationKind::RackOverRoller && source.nominal == Some(nominal)
                };
                sources.iter().any(is_so)
            })
        });
        let uncertainties = spec.uncertainties_of(&kinds)?;
        let zero = |source: &Source| {
            PartDeviation::new(source.law, DeviationValue::zero(source.law.kind())).with_extent(source.extended.extent)
        };
        let errors: Vec<_> = sources.iter().map(zero).collect();
        let part = UncertainPart {
            errors: &errors,
            over_pin: over_pin.as_ref(),
            model: request.model,
            stack: request.stack,
            basis,
            teeth: &spec.teeth_sensitivities,
        };
        let propagator = Propagator::new(&part, uncertainties).map_err(Diagnostic::with_code(Code::NoResult))?;
        // every part has a core of its own
        let of_one = |settings| Settings { threads: Some(1), most_draws: MOST_ADAPTIVE_OF_MANY, ..settings };
        let monte_carlo = request.monte_carlo.map(of_one);
        let teeth = spec.teeth_sensitivities.clone();
        Ok(Self { propagator, over_pin, monte_carlo, request: request.clone(), basis: basis.clone(), teeth })
    }

    /// The uncertainties of one part.
    pub(super) fn of_row(
        &self,
        sources: &[Source],
        deviations: &[DeviationValue],
        delta_cd: impl Fn(DeviationKind) -> Length,
        limits: &Limits,
    ) -> Result<RowUncertainty, MonteCarloError> {
        let point = |(source, deviation): (&Source, &DeviationValue)| Point {
            error: deviation.base(),
            delta_cd_mm: delta_cd(source.law.kind()).mm(),
        };
        let points: Vec<_> = sources.iter().zip(deviations).map(point).collect();
        let spreads = self.propagator.spreads(&points);
        let Some(settings) = &self.monte_carlo else {
            return Ok(RowUncertainty { spreads, simulation: None, validated: None });
        };
        let error = |(source, value): (&Source, &DeviationValue)| {
            PartDeviation::new(source.law, *value).with_extent(source.extended.extent)
        };
        let errors: Vec<_> = sources.iter().zip(deviations).map(error).collect();
        let part = UncertainPart {
            errors: &errors,
            over_pin: self.over_pin.as_ref(),
            model: self.request.model,
            stack: self.request.stack,
            basis: &self.basis,
            teeth: &self.teeth,
        };
        let simulation = simulate_part(&part, self.propagator.uncertainties(), limits, settings)?;
        let propagation = self.propagator.propagation(&errors)?;
        let digits = simulation.outcome.digits;
        let ends = [(&propagation.lower, simulation.lower()), (&propagation.upper, simulation.upper())];
        let of_ends = ends.map(|(linear, simulated)| validate(linear, simulated, digits).by(&simulation.outcome));
        let validated = if of_ends.contains(&Some(false)) { Some(false) } else { of_ends[0].and(of_ends[1]) };
        Ok(RowUncertainty { spreads, simulation: Some(simulation), validated })
    }
}
