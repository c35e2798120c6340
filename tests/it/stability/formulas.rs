//! The formulas at the edges of their domains, scaled, and where they grow.

use super::*;

type DeltaCd = fn(alpha: f64, beta: f64, width: f64, error: f64, model: Model) -> Result<f64, DomainError>;

/// Every formula of an error as one function of plain numbers; what it does not need is ignored.
const FORMULAS: [(&str, DeltaCd); 5] = [
    ("over-roller", |_, _, _, error, model| Ok(Law::rack_over_roller().delta_cd(mm(error), model)?.mm())),
    ("rack pitch", |alpha, beta, _, error, model| {
        Ok(Law::rack_pitch(deg(alpha), deg(beta))?.delta_cd(mm(error), model)?.mm())
    }),
    ("pinion pitch", |alpha, beta, _, error, model| {
        Ok(Law::pinion_pitch(deg(alpha), deg(beta))?.delta_cd(mm(error), model)?.mm())
    }),
    ("pinion lead", |alpha, beta, _, error, model| {
        Ok(Law::pinion_lead(deg(alpha), deg(beta))?.delta_cd(mm(error), model)?.mm())
    }),
    ("rack lead", |alpha, beta, width, error, model| {
        // a length as an angle: any number below 90
        let angle = if error.abs() < 90.0 { error } else { 1.0 };
        Ok(Law::rack_lead(deg(alpha), deg(beta), mm(width))?.delta_cd(deg(angle), model)?.mm())
    }),
];

const MODELS: [Model; 2] = [Model::Exact, Model::Paper];

#[test]
fn formulas_at_the_edges_of_their_domains_are_finite_or_an_overflow() {
    const ALPHA: [f64; 7] = [1e-12, 1e-8, 0.001, 20.0, 30.0, 44.999_999_999_999, 45.0];
    const BETA: [f64; 7] = [0.0, 1e-300, -1e-12, 45.0, -45.0, 60.0, 89.999_999_999_999];
    const SIZE: [f64; 6] = [1e-300, 1e-12, 1e-3, 19.7, 1e4, 1e6];
    for (name, formula) in FORMULAS {
        for alpha in ALPHA {
            for beta in BETA {
                for width in [1e-12, 19.7, 1e6] {
                    for error in SIZE.into_iter().flat_map(|size| [size, -size]).chain([0.0, -0.0]) {
                        for model in MODELS {
                            match formula(alpha, beta, width, error, model) {
                                Ok(value) => {
                                    assert!(value.is_finite(), "{name} {alpha:e} {beta:e} {width:e} {error:e}")
                                }
                                Err(DomainError::Overflow(_)) => {}
                                Err(other) => panic!("{name} {alpha:e} {beta:e} {width:e} {error:e}: {other}"),
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Twice the error is twice ΔCD but for the grid on which both lie.
#[test]
fn formulas_scale() {
    for seed in cases(40) {
        let mut random = Random(seed);
        let (alpha, beta) = (random.range(0.01, 45.0), random.range(-80.0, 80.0));
        let error = random.range(1e-4, 1.0);
        let factor = 2.0_f64.powi(random.int(-10, 10) as i32);
        for (name, formula) in &FORMULAS[..4] {
            let at = |error| formula(alpha, beta, 1.0, error, Model::Exact).unwrap();
            let (one, scaled) = (at(error) * factor, at(error * factor));
            let grid = gain_of_a_step(alpha) * (1.0 + factor);
            assert!((one - scaled).abs() <= grid, "{name} {alpha} {beta} {error} {factor}");
        }
        let lead = |width| (FORMULAS[4].1)(alpha, beta, width, error, Model::Exact).unwrap();
        let off = (lead(3.0) * factor - lead(3.0 * factor)).abs();
        assert!(off <= 1e-12 * (1.0 + factor) + 2.0 * f64::EPSILON * lead(3.0 * factor), "{off}");
    }
}

/// What half a step of the grid does to ΔCD, and rounding of ΔCD to it, mm.
fn gain_of_a_step(alpha: f64) -> f64 {
    1e-12 * (1.0 + 0.5 / (alpha * std::f64::consts::PI / 180.0))
}

/// More error, a wider face, a steeper flank: never less ΔCD. Only over-roller errors have a direction.
#[test]
fn formulas_are_monotone_and_know_no_direction() {
    for seed in cases(40) {
        let mut random = Random(seed);
        let (alpha, beta) = (random.range(0.1, 44.0), random.range(0.0, 80.0));
        let (error, width) = (random.range(1e-6, 1.0), random.range(0.1, 100.0));
        let grow = 1.0 + 10.0_f64.powf(random.range(-12.0, 0.0));
        for (name, formula) in FORMULAS {
            for model in MODELS {
                let at = |alpha, beta, width, error| formula(alpha, beta, width, error, model).unwrap();
                let value = at(alpha, beta, width, error);
                let what = format!("{name} {model} {alpha} {beta} {width} {error} {grow}");
                assert!(at(alpha, beta, width, error * grow) >= value, "{what}: error");
                assert!(at(alpha, beta, width * grow, error) >= value, "{what}: width");
                assert!(at((alpha * grow).min(45.0), beta, width, error) <= value, "{what}: pressure angle");
                assert_eq!(at(alpha, -beta, width, error), value, "{what}: hand");
                let turned = at(alpha, beta, width, -error);
                assert_eq!(turned, if name == "over-roller" { -value } else { value }, "{what}: sign");
            }
        }
    }
}

/// An error given in two parts that add up exactly is the same error.
#[test]
fn formulas_take_an_error_in_parts() {
    for seed in cases(40) {
        let mut random = Random(seed);
        let formula = Law::rack_pitch(deg(random.range(1.0, 45.0)), deg(random.range(-60.0, 60.0))).unwrap();
        let (a, b) = (mm(random.range(0.0, 0.1)), mm(random.range(0.0, 0.1)));
        let at = |error: Length| formula.delta_cd(error, Model::Exact).unwrap();
        let off = (at(a + b) - (at(a) + at(b))).abs();
        assert!(off.fm() <= 1, "{off}");
    }
}

/// The sensitivity that is reported is what a small change does, also where it is large.
#[test]
fn formulas_report_their_conditioning() {
    for alpha in [0.01, 0.1, 1.0, 5.0, 20.0, 44.0] {
        let (error, step) = (mm(0.02), alpha * 1e-4);
        let at =
            |alpha: f64| Law::rack_pitch(deg(alpha), deg(12.0)).unwrap().delta_cd(error, Model::Exact).unwrap().mm();
        let reported = Law::rack_pitch(deg(alpha), deg(12.0)).unwrap().sensitivities(error, Model::Exact).unwrap();
        let reported =
            reported.iter().find(|s| s.input == Influence::NormalPressureAngle).and_then(|s| s.value).unwrap();
        let seen = (at(alpha + step) - at(alpha - step)) / (2.0 * step);
        assert!((reported / seen - 1.0).abs() < 1e-6, "α_n = {alpha}°: {reported} {seen}");
    }
}
