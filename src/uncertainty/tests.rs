//! The linear propagation against differences, printed examples and closed forms.

use super::*;
use crate::deviation::{DeviationKind, Extent};
use crate::formula::over_pin::OverPin;
use crate::formula::{Law, Model, PartDeviation};
use crate::judge::bound::{Basis, GivenGeometry, OwnCurve};
use crate::judge::{Interval, Stack};
use crate::quantity::{Angle, Length};
use crate::statistics::student_quantile;
use crate::trig;

fn length(text: &str) -> Length {
    text.parse().unwrap()
}

fn angle(text: &str) -> Angle {
    text.parse().unwrap()
}

fn five(pitch: &str, lead: &str) -> Vec<PartDeviation> {
    let (alpha, rack, pinion) = (angle("20"), angle("12"), angle("21"));
    vec![
        PartDeviation::new(Law::rack_over_roller(), length("0.013")),
        PartDeviation::new(Law::rack_pitch(alpha, rack).unwrap(), length(pitch)),
        PartDeviation::new(Law::rack_lead(alpha, rack, length("19.7")).unwrap(), angle(lead)),
        PartDeviation::new(Law::pinion_radial(), length("-0.004")),
        PartDeviation::new(Law::pinion_pitch(alpha, pinion).unwrap(), length("0.009")),
    ]
}

/// A pair of unknown geometry.
pub(crate) static UNKNOWN: Basis = Basis {
    geometry: GivenGeometry::Unknown,
    own_curve: OwnCurve::At(0.0),
    known_teeth: None,
    all_placed: None,
    rolls: false,
    normal_module_mm: None,
    addendum_mm: None,
};

fn part(errors: &[PartDeviation]) -> UncertainPart<'_> {
    UncertainPart { errors, over_pin: None, model: Model::Exact, stack: Stack::Range, basis: &UNKNOWN, teeth: &[] }
}

/// Every quantity that can be uncertain, in the order of a [`Scene`]'s values.
pub(crate) const SOURCES: [Influence; 14] = [
    Influence::Error(DeviationKind::RackOverRoller),
    Influence::Error(DeviationKind::RackPitch),
    Influence::Error(DeviationKind::RackLead),
    Influence::Error(DeviationKind::PinionRadial),
    Influence::Error(DeviationKind::PinionPitch),
    Influence::NormalPressureAngle,
    Influence::RackHelixAngle,
    Influence::PinionHelixAngle,
    Influence::FaceWidth,
    Influence::NormalModule,
    Influence::Datum,
    Influence::Roller,
    Influence::ToothThickness,
    Influence::Error(DeviationKind::PinionLead),
];

/// A part whose quantities may all change; mm and degrees.
#[derive(Clone, Copy)]
pub(crate) struct Scene {
    pub(crate) values: [f64; 14],
    pub(crate) thickness: bool,
    pub(crate) tolerances: bool,
    pub(crate) model: Model,
    pub(crate) stack: Stack,
}

impl Scene {
    pub(crate) const VALUES: [f64; 14] =
        [-0.013, 0.012, 0.0255, 0.004, -0.009, 20.0, 12.0, 21.0, 19.7, 2.5, 21.5, 5.0, 3.9, 0.008];

    pub(crate) fn over_pin(&self) -> OverPin {
        let mm = |index: usize| Length::from_mm(self.values[index]).unwrap();
        OverPin {
            normal_module: mm(9),
            normal_pressure_angle: Angle::from_degrees(self.values[5]).unwrap(),
            tooth_thickness: self.thickness.then(|| mm(12)),
            pin_diameter: mm(11),
            datum: mm(10),
        }
    }

    /// Its errors; the measure over the roller does not change with its nominal value.
    pub(crate) fn errors(&self) -> Vec<PartDeviation> {
        let mm = |index: usize| Length::from_mm(self.values[index]).unwrap();
        let degrees = |index: usize| Angle::from_degrees(self.values[index]).unwrap();
        let (alpha, rack, pinion) = (degrees(5), degrees(6), degrees(7));
        let nominal = Self { values: Self::VALUES, ..*self }.over_pin().measure().unwrap();
        let shift = self.over_pin().measure().unwrap() - nominal;
        let errors = vec![
            PartDeviation::new(Law::rack_over_roller(), mm(0) - shift),
            PartDeviation::new(Law::rack_pitch(alpha, rack).unwrap(), mm(1)),
            PartDeviation::new(Law::rack_lead(alpha, rack, mm(8)).unwrap(), degrees(2)),
            PartDeviation::new(Law::pinion_radial(), mm(3)),
            PartDeviation::new(Law::pinion_pitch(alpha, pinion).unwrap(), mm(4)),
            PartDeviation::new(Law::pinion_lead(alpha, pinion).unwrap(), mm(13)),
        ];
        let within = |error: PartDeviation| {
            if self.tolerances && error.kind().always_acts() {
                PartDeviation::within(error.law(), error.value())
            } else {
                error
            }
        };
        errors.into_iter().map(within).collect()
    }

    /// Its pair, with the constant ΔCD of its tooth thickness.
    pub(crate) fn basis(&self) -> Basis {
        let thicker = self.values[12] - std::f64::consts::FRAC_PI_2 * self.values[9];
        let delta_cd_mm = 0.5 * thicker / trig::tan_of(Angle::from_degrees(self.values[5]).unwrap());
        Basis { own_curve: OwnCurve::At(if self.thickness { delta_cd_mm } else { 0.0 }), ..UNKNOWN.clone() }
    }

    /// ΔCD of each error, and the lower and upper end of all, mm.
    pub(crate) fn delta_cd(&self) -> Vec<f64> {
        let errors = self.errors();
        let combined = self.basis().bound_of(&errors).combined.nearest().unwrap();
        let Interval { lower, upper } = combined.interval(combined.judged(self.stack)).unwrap();
        let each = errors.iter().map(|error| error.delta_cd(self.model).unwrap().mm());
        each.chain([lower.mm(), upper.mm()]).collect()
    }

    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let models = [Model::Exact, Model::Paper].into_iter();
        let stacks = move |model| Stack::ALL.map(|stack| (model, stack));
        models.flat_map(stacks).flat_map(|(model, stack)| {
            let scene = |thickness| Self { values: Self::VALUES, thickness, tolerances: !thickness, model, stack };
            [scene(true), scene(false)]
        })
    }
}

/// Each sensitivity of each result against the difference of two parts.
#[test]
fn sensitivities_are_those_of_differences() {
    for scene in Scene::all() {
        let inputs = SOURCES.map(|source| (source, Uncertainty::standard(1e-7))).to_vec();
        let (errors, over_pin, basis) = (scene.errors(), scene.over_pin(), scene.basis());
        let part = UncertainPart {
            errors: &errors,
            over_pin: Some(&over_pin),
            model: scene.model,
            stack: scene.stack,
            basis: &basis,
            teeth: &[],
        };
        let linear = propagate(&part, &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
        let results: Vec<_> =
            linear.errors.iter().map(|(_, linear)| linear).chain([&linear.lower, &linear.upper]).collect();
        for (index, source) in SOURCES.into_iter().enumerate() {
            // far above the grid, and small enough that ΔCD is linear
            let step = 1e-6;
            let beside = |sign: f64| {
                let mut beside = scene;
                beside.values[index] += sign * step;
                (beside.values[index], beside.delta_cd())
            };
            let ((from, low), (to, high)) = (beside(-1.0), beside(1.0));
            for (which, result) in results.iter().enumerate() {
                let difference = (high[which] - low[which]) / (to - from);
                let found = result.contributions.iter().find(|of| of.source == source);
                let found = found.map_or(0.0, |of| of.sensitivity);
                assert!(
                    (found - difference).abs() < 2e-6 + 1e-5 * difference.abs(),
                    "{:?} {:?} {source:?} {which}: {found} {difference}",
                    scene.model,
                    scene.stack
                );
            }
        }
    }
}

/// A step of 0 moves both ends once it is off 0, so its uncertainty counts.
#[test]
fn the_ends_at_no_error() {
    let errors = five("0", "0.0255");
    let inputs = vec![(Influence::Error(DeviationKind::RackPitch), Uncertainty::standard(0.001))];
    let result = propagate(&part(&errors[1..2]), &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
    let expected = 0.001 * 1.343_719_222_954_923;
    assert!((result.upper.standard_mm - expected).abs() < 1e-12 && (result.lower.standard_mm - expected).abs() < 1e-12);
    assert!((result.spreads.end_correlation + 1.0).abs() < 1e-9);
}

/// A result of one input has the degrees of freedom of that input.
#[test]
fn a_result_of_one_input_has_its_degrees_of_freedom() {
    let errors = five("0.012", "0.0255");
    let (a, b) = (Influence::Error(DeviationKind::RackOverRoller), Influence::Error(DeviationKind::PinionRadial));
    let pitch = Influence::Error(DeviationKind::RackPitch);
    let few = |dof| Uncertainty { dof, ..Uncertainty::standard(0.001) };
    let inputs = vec![(a, few(5.0)), (b, Uncertainty::standard(0.002)), (pitch, few(7.0))];
    let result = propagate(&part(&errors), &Uncertainties::new(inputs, &[(a, b, 0.5)]).unwrap()).unwrap();
    let dof = |index: usize| result.errors[index].1.dof.unwrap();
    for (index, expected) in [(0, 5.0), (1, 7.0), (3, f64::INFINITY)] {
        assert!(dof(index) == expected || (dof(index) / expected - 1.0).abs() < 1e-12, "{index}");
    }
}

/// The degrees of freedom of the sum of two sizes of all teeth, with given u, ν and correlation.
fn dof_of_two([u_a, u_b]: [f64; 2], [dof_a, dof_b]: [f64; 2], r: f64) -> Option<f64> {
    let (a, b) = (Influence::Error(DeviationKind::RackOverRoller), Influence::Error(DeviationKind::PinionRadial));
    let errors = [Law::rack_over_roller(), Law::pinion_radial()]
        .map(|law| PartDeviation::new(law, length("0.05")).with_extent(Extent::All));
    let of = |standard, dof| Uncertainty { dof, ..Uncertainty::standard(standard) };
    let inputs = vec![(a, of(u_a, dof_a)), (b, of(u_b, dof_b))];
    let result = propagate(&part(&errors), &Uncertainties::new(inputs, &[(a, b, r)]).unwrap()).unwrap().upper;
    assert_eq!(result.coverage_factor, result.dof.map(coverage_factor));
    result.dof
}

#[test]
fn degrees_of_freedom_of_correlated_inputs() {
    let (same, never) = ([0.001; 2], f64::INFINITY);
    for (u, dofs, r, expected) in [
        (same, [5.0; 2], 1.0, 5.0),
        (same, [4.0; 2], 1.0, 4.0),
        (same, [4.0; 2], 1e-9, 4.0),
        (same, [4.0; 2], -0.5, 4.0),
        // independent: Welch-Satterthwaite
        (same, [4.0; 2], 0.0, 8.0),
        ([0.002, 0.001], [never, 4.0], 0.0, 4.0 * 25.0),
        // w = 2/7 by hand: (4 + 1 + 2), of which 1 + 1 is the second's
        ([0.002, 0.001], [never, 4.0], 0.5, 4.0 * 12.25),
        // terms of both signs, w = 2 and −1: 4/9 is below 1
        ([0.002, 0.001], [4.0; 2], -1.0, 1.0),
        ([0.002, 0.001], [90.0; 2], -1.0, 10.0),
        (same, [never; 2], 0.5, never),
    ] {
        let found = dof_of_two(u, dofs, r).unwrap();
        assert!(found == expected || (found / expected - 1.0).abs() < 1e-6, "{u:?} {dofs:?} {r}: {found}");
    }
    // contributions that cancel leave no known ν, whatever their degrees of freedom
    for dofs in [[4.0; 2], [never; 2]] {
        assert_eq!(dof_of_two(same, dofs, -1.0), None);
    }
}

/// An error exactly three standard uncertainties from zero does not fold, nor does an error without uncertainty.
#[test]
fn three_standard_uncertainties_are_far_enough() {
    let errors = [PartDeviation::new(Law::pinion_radial(), length("0.375"))];
    let with = |u| Uncertainties::new(vec![(SOURCES[3], Uncertainty::standard(u))], &[]).unwrap();
    assert!(propagate(&part(&errors), &with(0.125)).unwrap().upper.folded.is_empty());
    assert!(!propagate(&part(&errors), &with(0.126)).unwrap().upper.folded.is_empty());
    // the size of all spaces acts with its sign
    let all = [errors[0].with_extent(Extent::All)];
    assert!(propagate(&part(&all), &with(0.126)).unwrap().upper.folded.is_empty());
    let zero = five("0", "0");
    let size = Uncertainties::new(vec![(SOURCES[0], Uncertainty::standard(0.001))], &[]).unwrap();
    assert_eq!(propagate(&part(&zero), &size).unwrap().upper.folded, []);
}

/// Rounding errors of shares do not take a whole degree of freedom.
#[test]
fn a_whole_number_of_degrees_stays_whole() {
    let dof = effective_dof(&[1.0, 1e-13], &[3.0, 1.0], false);
    assert!(dof < 3.0);
    assert_eq!(coverage_factor(dof), coverage_factor(3.0));
    assert_eq!(coverage_factor(2.999), coverage_factor(2.0));
}

#[test]
fn the_end_gauge_of_jcgm_100_h1() {
    // JCGM 100:2008, H.1: contributions 25, 9.7, 2.9 and 16.6 nm with 18, 25.6, 50 and 2 degrees of freedom
    let (terms, dofs) = ([25.0, 9.7, 2.9, 16.6], [18.0, 25.6, 50.0, 2.0]);
    let u = terms.iter().map(|t| t * t).sum::<f64>().sqrt();
    assert_eq!(format!("{u:.0}"), "32");
    let shares = terms.map(|term| (term / u) * (term / u));
    let dof = effective_dof(&shares, &dofs, true);
    assert_eq!(format!("{:.0}", dof.floor()), "16");
    let k = student_quantile(0.995, dof.floor());
    assert_eq!(format!("{k:.2}"), "2.92");
    assert_eq!(format!("{:.0}", k * u), "93");
}

#[test]
fn contributions_add_up_in_squares() {
    let errors = five("0.012", "0.0255");
    let u = |standard| Uncertainty::standard(standard);
    let inputs = vec![
        (Influence::Error(DeviationKind::RackOverRoller), u(0.0008)),
        (Influence::Error(DeviationKind::RackPitch), u(0.0006)),
        (Influence::Error(DeviationKind::RackLead), u(0.001)),
        (Influence::NormalPressureAngle, u(0.05)),
        (Influence::FaceWidth, u(0.1)),
    ];
    let result = propagate(&part(&errors), &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
    let shares: f64 = result.upper.contributions.iter().filter_map(|c| c.share).sum();
    assert!((shares - 1.0).abs() < 1e-12);
    assert_eq!(result.upper.coverage_factor, Some(2.0));
    assert!(result.upper.folded.is_empty());
    // steps and leads move both ends, in opposite directions; the over-roller error does not
    let variance = |standard: f64| standard * standard;
    assert!((result.lower.standard_mm - result.upper.standard_mm).abs() < 1e-9);
    let expected = 2.0 * variance(0.0008) / variance(result.upper.standard_mm) - 1.0;
    assert!((result.spreads.end_correlation - expected).abs() < 1e-6);
    // the pitch error alone: cos 12° / (2 tan 20°) of its own, and its share of the pressure angle's
    let (_, pitch) = &result.errors[1];
    let gain = 0.978_147_600_733_805_6 / (2.0 * 0.363_970_234_266_202_4);
    let by_alpha = 0.012 * gain / (0.342_020_143_325_668_7 * 0.939_692_620_785_908_4) * 0.017_453_292_519_943_3;
    let (own, of_angle): (f64, f64) = (gain * 0.0006, by_alpha * 0.05);
    let expected = (own * own + of_angle * of_angle).sqrt();
    assert!((pitch.standard_mm / expected - 1.0).abs() < 1e-12);
}

#[test]
fn correlations_add_or_cancel() {
    let errors = five("0.012", "0.0255");
    let (a, b) = (Influence::Error(DeviationKind::RackOverRoller), Influence::Error(DeviationKind::PinionRadial));
    let inputs = vec![(a, Uncertainty::standard(0.001)), (b, Uncertainty::standard(0.001))];
    for (r, expected) in [(1.0, 0.002), (0.0, 0.001 * 2.0_f64.sqrt()), (-1.0, 0.0)] {
        let uncertainties = Uncertainties::new(inputs.clone(), &[(a, b, r)]).unwrap();
        let result = propagate(&part(&errors), &uncertainties).unwrap();
        assert!((result.lower.standard_mm - expected).abs() < 1e-12, "{r}");
        // one low space of the pinion, 4 u below zero, does not move the upper end
        assert!((result.upper.standard_mm - 0.001).abs() < 1e-12, "{r}");
    }
    assert!(matches!(
        Uncertainties::new(inputs, &[(a, b, 1.5)]),
        Err(UncertaintyError::Coefficient { coefficient: 1.5, .. })
    ));
}

#[test]
fn correlations_that_cannot_be_are_refused() {
    let sources =
        [DeviationKind::RackOverRoller, DeviationKind::PinionRadial, DeviationKind::RackPitch].map(Influence::Error);
    let inputs = sources.map(|source| (source, Uncertainty::standard(0.001))).to_vec();
    let [a, b, c] = sources;
    let contradiction = Uncertainties::new(inputs.clone(), &[(a, b, 0.9), (b, c, 0.9), (a, c, -0.9)]);
    assert_eq!(contradiction, Err(UncertaintyError::Contradiction(c)));
    assert!(Uncertainties::new(inputs, &[(a, b, 1.0), (b, c, 1.0), (a, c, 1.0)]).is_ok());
}

#[test]
fn near_zero_the_linear_result_says_that_it_is_none() {
    let u = 0.001;
    for (pitch, folded) in [("0", true), ("0.0029", true), ("-0.0029", true), ("0.0031", false), ("-0.0031", false)] {
        let errors = five(pitch, "0.0255");
        let inputs = vec![(Influence::Error(DeviationKind::RackPitch), Uncertainty::standard(u))];
        let result = propagate(&part(&errors), &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
        assert_eq!(result.upper.folded.contains(&DeviationKind::RackPitch), folded, "{pitch}");
        // u is an upper bound: the gain times u of the error
        assert!((result.errors[1].1.standard_mm - u * 1.343_719_222_954_923).abs() < 1e-12, "{pitch}");
    }
}

#[test]
fn degrees_of_freedom_widen_the_interval() {
    let errors = [PartDeviation::new(Law::rack_over_roller(), length("0.01"))];
    let four = Uncertainty { dof: 4.0, ..Uncertainty::standard(0.001) };
    let uncertainties = Uncertainties::new(vec![(Influence::Error(DeviationKind::RackOverRoller), four)], &[]).unwrap();
    let result = propagate(&part(&errors), &uncertainties).unwrap().upper;
    assert_eq!(result.dof, Some(4.0));
    // JCGM 100:2008, Table G.2: 2.87
    assert_eq!(format!("{:.2}", result.coverage_factor.unwrap()), "2.87");
}

#[test]
fn half_widths_and_expanded_uncertainties() {
    let near = |u: Uncertainty, expected: f64| assert!((u.standard - expected).abs() < 1e-15, "{u:?}");
    near(Uncertainty::half_width(0.003, Distribution::Rectangular), 0.003 / 3.0_f64.sqrt());
    near(Uncertainty::half_width(0.003, Distribution::Triangular), 0.003 / 6.0_f64.sqrt());
    near(Uncertainty::half_width(0.003, Distribution::Arcsine), 0.003 / 2.0_f64.sqrt());
    near(Uncertainty::expanded(0.003, 2.0), 0.0015);
}

#[test]
fn what_does_not_reach_a_result_leaves_it_certain() {
    let errors = [PartDeviation::new(Law::pinion_radial(), length("0.004"))];
    let inputs = vec![
        (Influence::PinionHelixAngle, Uncertainty::standard(0.04)),
        (Influence::Error(DeviationKind::PinionRadial), Uncertainty::standard(0.0)),
    ];
    let found = propagate(&part(&errors), &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
    assert_eq!((found.lower.standard_mm, found.upper.standard_mm, found.spreads.end_correlation), (0.0, 0.0, 0.0));
    assert_eq!(found.lower.folded, []);
    // the error has a derivative, but there is no variance to have a share of
    let [only] = &found.upper.contributions[..] else { panic!("{:?}", found.upper.contributions) };
    assert!((only.sensitivity - 1.0).abs() < 1e-9);
    assert_eq!((only.contribution_mm, only.share), (0.0, None));
}

/// A binary rounding error does not cost a whole degree of freedom.
#[test]
fn nine_degrees_of_freedom_less_an_ulp_are_nine() {
    let linear = |dof| Linear {
        value_mm: 0.0,
        standard_mm: 0.5,
        dof: Some(dof),
        coverage_factor: Some(coverage_factor(dof)),
        contributions: Vec::new(),
        folded: Vec::new(),
    };
    let (nine, below, eight) = (linear(9.0), linear(9.0_f64.next_down()), linear(8.9));
    assert_eq!((nine.expanded_mm(), nine.half_width_mm(0.99)), (below.expanded_mm(), below.half_width_mm(0.99)));
    assert!(eight.expanded_mm() > nine.expanded_mm() && eight.half_width_mm(0.99) > nine.half_width_mm(0.99));
    assert_eq!(nine.half_width_mm(COVERAGE), nine.expanded_mm());
    assert_eq!(linear(0.5).half_width_mm(0.9), linear(1.0).half_width_mm(0.9));
}
