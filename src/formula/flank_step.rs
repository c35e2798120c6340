//! What the two pitch formulas share: flanks that stand apart by a step lift the pinion.
//!
//! Between a right flank displaced by e along the pitch line and a left flank that is not, the pinion
//! is wedged up by `|e| cos β / (2 tan α_n)`: `e cos β` is the displacement in the normal plane, and
//! each of the two flanks, inclined by α_n, takes half of it. β is the helix angle of the part whose
//! pitch was measured. The paper's formula is this with β = 0.

use super::{Input, Model, Sensitivity, domain, largest_within, per_degree, result_mm};
use crate::quantity::{Angle, Domain, DomainError, Length, Rational};
use crate::trig::precise;

#[derive(Debug, Clone)]
pub(super) struct FlankStep {
    /// mm of ΔCD per mm of step
    exact: Rational,
    paper: Rational,
    pressure_angle: Angle,
    helix_angle: Angle,
}

impl FlankStep {
    pub(super) fn new(pressure_angle: &Angle, helix_angle: &Angle, helix: &Domain) -> Result<Self, DomainError> {
        domain::NORMAL_PRESSURE_ANGLE.check_angle(pressure_angle)?;
        helix.check_angle(helix_angle)?;
        let tan = precise::tan(pressure_angle.exact_degrees());
        let paper = &Rational::fraction(1, 2) / &tan;
        let exact =
            if helix_angle.is_zero() { paper.clone() } else { &paper * &precise::cos(helix_angle.exact_degrees()) };
        Ok(Self { exact, paper, pressure_angle: pressure_angle.clone(), helix_angle: helix_angle.clone() })
    }

    pub(super) fn geometry(&self) -> (&Angle, &Angle, Option<&Length>) {
        (&self.pressure_angle, &self.helix_angle, None)
    }

    /// mm of ΔCD per mm of step.
    pub(super) fn gain(&self, model: Model) -> &Rational {
        match model {
            Model::Exact => &self.exact,
            Model::Paper => &self.paper,
        }
    }

    pub(super) fn delta_cd(&self, step: &Length, model: Model) -> Result<Length, DomainError> {
        result_mm(&(step.abs().exact_mm() * self.gain(model)), "ΔCD")
    }

    pub(super) fn largest_error(&self, delta_cd: &Length, model: Model) -> Result<Length, DomainError> {
        domain::PUSHING_DELTA_CD.check_length(delta_cd)?;
        let step = result_mm(&(delta_cd.exact_mm() / self.gain(model)), "the pitch error")?;
        let largest = largest_within(step.exact_mm().to_f64_toward_zero(), |mm| {
            let reached = Length::from_mm(mm).map(|step| self.delta_cd(&step, model));
            reached.is_ok_and(|reached| reached.is_ok_and(|reached| reached <= *delta_cd))
        });
        Ok(Length::from_mm(largest)?)
    }

    pub(super) fn sensitivities(&self, step: &Length, model: Model) -> Result<Vec<Sensitivity>, DomainError> {
        let magnitude = step.abs();
        let gain = self.gain(model);
        let alpha = self.pressure_angle.exact_degrees();
        // d(1/tan α)/dα = -1/sin² α = -(1/tan α) / (sin α cos α)
        let by_alpha = -&(&(magnitude.exact_mm() * gain) / &(&precise::sin(alpha) * &precise::cos(alpha)));
        let mut all = vec![
            Sensitivity::of_magnitude(step.exact_mm(), gain)?,
            Sensitivity::new(Input::NormalPressureAngle, &per_degree(&by_alpha))?,
        ];
        if model == Model::Exact {
            // d(cos β)/dβ = -sin β, with the paper's gain being the one without cos β
            let by_beta = -&(&(magnitude.exact_mm() * &self.paper) * &precise::sin(self.helix_angle.exact_degrees()));
            all.push(Sensitivity::new(Input::HelixAngle, &per_degree(&by_beta))?);
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(alpha: &str, beta: &str) -> FlankStep {
        FlankStep::new(&alpha.parse().unwrap(), &beta.parse().unwrap(), &domain::RACK_HELIX_ANGLE).unwrap()
    }

    /// cos 30°/(2 tan 30°) = 3/4: the error that reaches the limit exactly is allowed, the next `f64` is not.
    #[test]
    fn the_largest_error_may_reach_the_limit() {
        let mm = |value| Length::from_mm(value).unwrap();
        let step = step("30", "30");
        assert_eq!(step.largest_error(&mm(0.75), Model::Exact).unwrap(), mm(1.0));
        let largest = step.largest_error(&mm(0.03), Model::Exact).unwrap();
        assert!(step.delta_cd(&largest, Model::Exact).unwrap() <= mm(0.03), "0.04 rounded to an f64 would be above");
        assert_eq!(step.largest_error(&mm(0.0), Model::Exact).unwrap(), mm(0.0));
    }

    /// The paper's model knows no helix, so it has no derivative by it.
    #[test]
    fn the_helix_angle_counts_in_the_exact_model_only() {
        let inputs = |model| {
            let all = step("20", "15").sensitivities(&Length::from_mm(0.02).unwrap(), model).unwrap();
            all.iter().map(|sensitivity| sensitivity.input).collect::<Vec<_>>()
        };
        assert!(inputs(Model::Exact).contains(&Input::HelixAngle));
        assert!(!inputs(Model::Paper).contains(&Input::HelixAngle));
    }
}
