//! What is uncertain about the parts of a batch, and what that makes of one part in the exact way. Made by the plan,
//! asked by the row evaluator; decides nothing.

use super::plan::Source;
use super::request::Request;
use crate::decision::monte_carlo::{MonteCarloError, PartSimulation, Settings, simulate_part, validate};
use crate::decision::uncertainty::{Part, Propagation, Propagator, Spreads, propagate};
use crate::decision::{Limits, Stack};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::over_pin::OverPin;
use crate::formula::{Model, PartError};
use crate::spec::{Reading, Spec};

/// What is known of the uncertainty of a part's results.
pub(super) struct Known {
    pub(super) propagation: Propagation,
    pub(super) spreads: Spreads,
    pub(super) simulation: Option<PartSimulation>,
    /// Whether the simulation confirms the linear result for both ends of the combination.
    pub(super) validated: Option<bool>,
}

/// What is uncertain about the parts.
#[derive(Debug, Clone)]
pub(super) struct Uncertain {
    pub(super) propagator: Propagator,
    /// What the nominal measure over the roller is computed from, if it is.
    over_pin: Option<OverPin>,
    /// How to simulate, if that is asked for.
    pub(super) monte_carlo: Option<Settings>,
}

impl Uncertain {
    /// What is uncertain about parts of which these errors are read.
    pub(super) fn new(spec: &Spec, sources: &[Source], request: &Request) -> Result<Self, Diagnostics> {
        let kinds: Vec<_> = sources.iter().map(|source| source.kind).collect();
        let formulas: Vec<_> = sources.iter().map(|source| source.formula.clone()).collect();
        let over_pin = spec.over_pin().filter(|over_pin| {
            // another nominal value may stand in the way
            let computed = over_pin.measure().map(ErrorValue::Length);
            computed.is_ok_and(|nominal| {
                let nominal = Reading::Measured(nominal);
                sources.iter().any(|source| source.kind == ErrorKind::RackOverRoller && source.reading == nominal)
            })
        });
        let uncertainties = spec.uncertainties_of(&kinds)?;
        let propagator = Propagator::new(&formulas, over_pin.as_ref(), uncertainties, request.stack)
            .map_err(|error| Diagnostic::error(Code::NoResult, error.to_string()))?;
        // every part has a core of its own
        let monte_carlo = request.monte_carlo.map(|settings| Settings { threads: Some(1), ..settings });
        Ok(Self { propagator, over_pin, monte_carlo })
    }

    /// The uncertainties of one part as `eval` computes them.
    pub(super) fn exact(
        &self,
        errors: &[PartError],
        model: Model,
        stack: Stack,
        limits: &Limits,
    ) -> Result<Known, MonteCarloError> {
        let part = Part { errors, over_pin: self.over_pin.as_ref(), model, stack };
        let uncertainties = self.propagator.uncertainties();
        let propagation = propagate(&part, uncertainties)?;
        let spreads = self.propagator.exact(&part, &propagation)?;
        let simulate = |settings: &Settings| simulate_part(&part, uncertainties, limits, settings);
        let simulation = self.monte_carlo.as_ref().map(simulate).transpose()?;
        let validated = simulation.as_ref().map(|simulation| {
            let digits = simulation.outcome.digits;
            let ends = [(&propagation.lower, simulation.lower()), (&propagation.upper, simulation.upper())];
            ends.into_iter().all(|(linear, simulated)| validate(linear, simulated, digits).validated)
        });
        Ok(Known { propagation, spreads, simulation, validated })
    }
}
