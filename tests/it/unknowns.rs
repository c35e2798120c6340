//! What is not known enters a decision at its unfavourable end, or leaves it open: taking something away never turns fail or
//! indeterminate into pass.

use proptest::prelude::*;
use serde_json::Value;

use rackmesh::cli::{HeldSpec, answer};
use rackmesh::judge::rule::{Ends, Tail, decide};
use rackmesh::judge::{Interval, Limit, Rule, Verdict};
use rackmesh::quantity::Length;
use rackmesh::uncertainty::effective_dof;

use crate::common::random::Random;

/// What `eval` says of a spec; nothing of one that it refuses.
fn eval(spec: &str) -> Option<Value> {
    let spec = HeldSpec { name: "part.toml".to_owned(), text: spec.to_owned() };
    Some(answer("eval", &["--no-worst-teeth"], spec, &std::sync::Arc::default()).ok()?.json)
}

/// What stands for keys of the gear that a spec leaves out.
const DEFAULTS: [&str; 5] = [
    "β_r, β_p and x are 0 where they are not given",
    "the rack cannot roll",
    "teeth have their nominal thickness where none is given",
    "flanks have no form where none is given",
    "an error without an extent has the usual one of its kind",
];

/// What a verdict takes for granted besides defaults.
fn beside_defaults(answer: &Value) -> Vec<Value> {
    let assumes = answer["assumes"].as_array().expect("a list").iter();
    assumes.filter(|clause| !DEFAULTS.contains(&clause.as_str().expect("a text"))).cloned().collect()
}

/// Each size, the form and the support that a spec leaves out is named, and nothing that it has.
#[test]
fn the_defaults_of_what_is_left_out_are_named() {
    let parts = [
        ("[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 1.7\n", None),
        ("helix_angle = 10\n", Some(0)),
        ("tooth_thickness = 3.1\n", Some(2)),
        ("crowning = 0\n", Some(3)),
        ("tip_relief = { amount = \"2 um\", start = 1 }\n", Some(3)),
        ("[pinion]\nteeth = 16\ntip_diameter = 37\nface_width = 30\n", None),
        ("helix_angle = 10\n", Some(0)),
        ("profile_shift = 0.3\n", Some(0)),
        ("tooth_thickness_deviation = 0\n", Some(2)),
        ("crowning = 0\n", Some(3)),
        ("profile_slope = 0\n", Some(3)),
        ("[support]\nroll = \"fixed\"\n", Some(1)),
        ("[limits]\ncenter_distance = \"±5\"\n[errors.rack_lead]\nvalue = \"1 arcmin\"\n", None),
        ("extent = \"all\"\n", Some(4)),
    ];
    let assumed = |left_out: usize| {
        let kept = parts.iter().enumerate().filter(|(place, _)| *place != left_out);
        let answer = eval(&kept.map(|(_, (text, _))| *text).collect::<Vec<_>>().concat()).expect("a result");
        answer["assumes"].as_array().expect("a list").clone()
    };
    assert_eq!(assumed(parts.len()), Vec::<Value>::new());
    for (place, (text, default)) in parts.iter().enumerate() {
        if let Some(default) = default {
            assert_eq!(assumed(place), [Value::from(DEFAULTS[*default])], "{text}");
        }
    }
}

/// A measured error with its uncertainty.
struct Measured {
    key: &'static str,
    value_um: f64,
    u_um: f64,
    dof: Option<i64>,
    extent: &'static str,
}

/// Measured errors that are judged by ISO 14253-1.
struct Part {
    errors: Vec<Measured>,
    /// Of errors by their places.
    correlations: Vec<(usize, usize, f64)>,
    /// Whether the sizes of the gear have an uncertainty.
    sizes: bool,
    upper_mm: f64,
}

/// What is taken away, by its place.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Taken {
    Uncertainty(usize),
    Nominal(usize),
    Freedom(usize),
    Correlation(usize),
    Sizes,
}

impl Taken {
    /// What a pass assumes that lacks this; `None` of what nothing passes without.
    fn assumed(self) -> Option<&'static str> {
        match self {
            Self::Uncertainty(_) | Self::Nominal(_) => None,
            Self::Freedom(_) => Some("ν = ∞ where no dof is given"),
            Self::Correlation(_) => Some("r = 0 where no correlation is given"),
            Self::Sizes => Some("sizes without an uncertainty are exact"),
        }
    }
}

impl Part {
    fn some(random: &mut Random) -> Self {
        let keys = ["rack_over_roller", "pinion_radial", "rack_pitch", "pinion_pitch"];
        let first = random.int(0, 3) as usize;
        let count = random.int(1, 4) as usize;
        let errors: Vec<_> = (0..count)
            .map(|place| keys[(first + place) % 4])
            .map(|key| Measured {
                key,
                value_um: random.range(-10.0, 10.0).round(),
                u_um: random.int(2, 20) as f64 / 10.0,
                dof: random.chance(0.8).then(|| random.int(2, 9)),
                extent: if key.ends_with("pitch") { "one" } else { ["one", "part", "all"][random.int(0, 2) as usize] },
            })
            .collect();
        let pairs = (0..count).flat_map(|a| (0..a).map(move |b| (a, b)));
        let some = if random.chance(0.6) { 1.0 } else { 0.5 };
        // below a third a row of four is dominated by its diagonal, so that these can be at the same time
        let coefficients = [0.0, 0.001, -0.3, 0.3];
        let correlations = pairs
            .filter_map(|(a, b)| {
                let coefficient = coefficients[random.int(0, 3) as usize];
                random.chance(some).then_some((a, b, coefficient))
            })
            .collect();
        Self { errors, correlations, sizes: random.chance(0.6), upper_mm: random.range(0.0, 0.05) }
    }

    fn parts(&self) -> Vec<Taken> {
        let mut parts = Vec::new();
        for (place, error) in self.errors.iter().enumerate() {
            parts.extend([Taken::Uncertainty(place), Taken::Nominal(place)]);
            parts.extend(error.dof.map(|_| Taken::Freedom(place)));
        }
        parts.extend((0..self.correlations.len()).map(Taken::Correlation));
        parts.extend(self.has_sizes().then_some(Taken::Sizes).filter(|_| self.sizes));
        parts
    }

    /// Whether ΔCD follows from sizes of the gear.
    fn has_sizes(&self) -> bool {
        self.errors.iter().any(|error| error.key.ends_with("pitch"))
    }

    /// What is stated neither here nor, if it is taken away, there.
    fn assumed(&self) -> Vec<Value> {
        let (count, of_sizes) = (self.errors.len(), self.has_sizes());
        let unstated = [
            (Taken::Freedom(0), self.errors.iter().any(|error| error.dof.is_none())),
            // no size is correlated here
            (Taken::Correlation(0), of_sizes && self.sizes || self.correlations.len() < count * (count - 1) / 2),
            (Taken::Sizes, of_sizes && !self.sizes),
        ];
        let clauses = unstated.into_iter().filter(|(_, is)| *is).filter_map(|(taken, _)| taken.assumed());
        ["the error-free pair has ΔCD = 0"].into_iter().chain(clauses).map(Value::from).collect()
    }

    fn spec(&self, taken: Option<Taken>) -> String {
        let lacks = |part| taken == Some(part);
        let size = |value: f64| {
            let is_uncertain = self.sizes && !lacks(Taken::Sizes);
            if is_uncertain { format!("{{ value = {value}, u = 0.01, dof = inf }}") } else { value.to_string() }
        };
        let mut spec = format!(
            "[pair]\nnormal_pressure_angle = {}\n[rack]\nhelix_angle = {}\n[pinion]\nhelix_angle = {}\n[errors]\n",
            size(20.0),
            size(10.0),
            size(-10.0)
        );
        for (place, Measured { key, value_um, u_um, dof, extent }) in self.errors.iter().enumerate() {
            let dof = dof.filter(|_| !lacks(Taken::Freedom(place)));
            let dof = dof.map_or_else(String::new, |dof| format!(", dof = {dof}"));
            let u = if lacks(Taken::Uncertainty(place)) { String::new() } else { format!(", u = \"{u_um} um\"{dof}") };
            let nominal = if lacks(Taken::Nominal(place)) { "" } else { ", nominal = 25" };
            let measured = 25.0 + 0.001 * value_um;
            spec += &format!("{key} = {{ measured = {measured:.4}{nominal}{u}, extent = \"{extent}\" }}\n");
        }
        spec += &format!(
            "[limits]\ncenter_distance = {{ upper = {:.6} }}\n[decision]\nrule = \"iso14253\"\n",
            self.upper_mm
        );
        for (place, (a, b, coefficient)) in self.correlations.iter().enumerate() {
            if !lacks(Taken::Correlation(place)) {
                let [a, b] = [a, b].map(|place| self.errors[*place].key);
                spec += &format!("[[correlation]]\nbetween = [\"{a}\", \"{b}\"]\ncoefficient = {coefficient}\n");
            }
        }
        spec
    }
}

/// Limits from within the value to well outside it, so that all verdicts occur. A pass that something was taken from says what
/// it takes for granted instead.
#[test]
fn what_is_taken_from_a_file_makes_no_pass_that_does_not_say_so() {
    let mut random = Random(45);
    let (mut passed, mut assumed) = (0, 0);
    let cases = if crate::common::is_long() { 400 } else { 12 };
    for _ in 0..cases {
        let part = Part::some(&mut random);
        let Some(whole) = eval(&part.spec(None)) else { panic!("{}", part.spec(None)) };
        let is_pass = whole["verdict"] == "pass";
        passed += usize::from(is_pass);
        assert_eq!(beside_defaults(&whole), part.assumed(), "{}", part.spec(None));
        for taken in part.parts() {
            let less = eval(&part.spec(Some(taken)));
            let Some(less) = less.filter(|less| less["verdict"] == "pass") else { continue };
            let clause = taken.assumed().unwrap_or_else(|| panic!("{taken:?}: {}", part.spec(None)));
            let says = less["assumes"].as_array().is_some_and(|clauses| clauses.contains(&clause.into()));
            assert!(says, "{taken:?}: {}", part.spec(None));
            assumed += usize::from(!is_pass);
        }
    }
    assert!((cases / 8..cases).contains(&passed), "{passed}");
    assert!(assumed > 0 || cases < 100);
}

/// A pair whose own curve is 0, with errors of every kind, and what is left of it where its geometry is not known.
fn pair_spec(random: &mut Random, upper_mm: f64, is_known: bool) -> String {
    let (teeth, shift) = (random.int(14, 24), random.range(0.2, 0.5));
    let (addendum, width) = (random.range(1.6, 2.0), random.range(15.0, 25.0));
    let tip = 2.0 * (teeth as f64 + 2.0 * shift + addendum);
    let [beta_r, beta_p] = [0, 1].map(|_| [0.0, 12.0, -12.0][random.int(0, 2) as usize]);
    let mut errors = String::new();
    for key in ["rack_over_roller", "rack_pitch", "rack_lead", "pinion_radial", "pinion_pitch"] {
        let (of, extents) = match key {
            "rack_lead" => ("arcmin", ["one", "part", "all"]),
            "rack_pitch" | "pinion_pitch" => ("um", ["one", "part", "each"]),
            _ => ("um", ["one", "part", "all"]),
        };
        let (value, extent) = (random.int(-12, 12), extents[random.int(0, 2) as usize]);
        if random.chance(0.5) {
            errors += &format!("{key} = {{ value = \"{value} {of}\", extent = \"{extent}\" }}\n");
        }
    }
    let (known_rack, known_pinion) = if is_known {
        (
            format!("addendum = {addendum:.3}\n"),
            format!("teeth = {teeth}\nprofile_shift = {shift:.3}\ntip_diameter = {tip:.3}\nface_width = 30\n"),
        )
    } else {
        Default::default()
    };
    format!(
        "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nhelix_angle = {beta_r}\nface_width = {width:.2}\n{known_rack}\
         [pinion]\nhelix_angle = {beta_p}\n{known_pinion}[errors]\n{errors}[limits]\ncenter_distance = {{ lower = {:.6}, upper = {upper_mm:.6} }}\n",
        -upper_mm
    )
}

#[test]
fn without_the_geometry_nothing_passes_that_did_not() {
    let cases = if crate::common::is_long() { 400 } else { 16 };
    let (mut held, mut not_zero) = (0, 0);
    for seed in 0..cases {
        let upper_mm = Random(1000 + seed).range(0.005, 0.08);
        let spec = |is_known| pair_spec(&mut Random(seed), upper_mm, is_known);
        let Some(whole) = eval(&spec(true)) else { continue };
        let notes = whole["notes"].to_string();
        if notes.contains("share of form and geometry in the bound") {
            not_zero += 1;
            continue;
        }
        let Some(less) = eval(&spec(false)) else { continue };
        assert!(less["verdict"] != "pass" || whole["verdict"] == "pass", "{}", spec(true));
        assert!(less["verdict"] != "pass" || !beside_defaults(&less).is_empty());
        assert_eq!(beside_defaults(&whole), Vec::<Value>::new(), "{}", spec(true));
        held += usize::from(whole["verdict"] != "pass");
    }
    assert!(held > 2 && not_zero < cases / 2, "{held} of {cases}, {not_zero} not 0");
}

/// A pair whose rack has some teeth that are too high, judged by ISO 14253-1 where `u_um` is the uncertainty of each.
fn of_teeth(teeth: &[(usize, f64)], u_um: Option<f64>, upper_mm: f64) -> String {
    let mut spec =
        "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 1.7\n[pinion]\n\
        teeth = 8\nhelix_angle = 21\nprofile_shift = 0.4\nface_width = 30\ntip_diameter = 21.4\n"
            .to_owned();
    if let Some(u) = u_um {
        spec +=
            &format!("[errors]\nrack_over_roller = {{ u = \"{u} um\", dof = inf }}\n[decision]\nrule = \"iso14253\"\n");
    }
    spec += &format!("[limits]\ncenter_distance = {{ upper = {upper_mm:.9} }}\n");
    teeth.iter().fold(spec, |spec, (tooth, um)| {
        spec + &format!("[[rack.deviation]]\nteeth = {tooth}\nover_roller = \"{um:.6} um\"\n")
    })
}

fn highest_mm(eval: &Value) -> f64 {
    eval["judged_mm"]["upper"].as_f64().expect("it is judged")
}

/// Teeth far apart that are nearly as high raise the highest ΔCD each: what passes conforms for 95 % of what may be.
#[test]
fn what_is_uncertain_about_teeth_that_carry_elsewhere_counts() {
    let mut random = Random(11);
    let (mut passed, draws) = (0, 20);
    for _ in 0..5 {
        let teeth: Vec<_> = (0..4).map(|index| (4 + 6 * index, random.range(9.5, 10.0))).collect();
        let u_um = random.range(0.5, 3.0);
        let measured = highest_mm(&eval(&of_teeth(&teeth, None, 1.0)).expect("it is valid"));
        let upper_mm = measured + 1e-3 * u_um * random.range(1.65, 4.0);
        let judged = eval(&of_teeth(&teeth, Some(u_um), upper_mm)).expect("it is valid");
        let conforms = |_: &usize| {
            let drawn: Vec<_> = teeth
                .iter()
                .map(|(tooth, um)| (*tooth, um + u_um * ((0..12).map(|_| random.unit()).sum::<f64>() - 6.0)))
                .collect();
            highest_mm(&eval(&of_teeth(&drawn, None, 1.0)).expect("it is valid")) <= upper_mm
        };
        let conform = (0..draws).filter(conforms).count();
        passed += usize::from(judged["verdict"] == "pass");
        assert!(judged["verdict"] != "pass" || 10 * conform >= 8 * draws, "{conform} of {draws}: {teeth:?} {u_um}");
    }
    assert!(passed > 0, "nothing passes");
}

/// No tooth is exact without a word, whatever deviates.
#[test]
fn each_deviation_of_a_tooth_needs_an_uncertainty() {
    for (part, deviation) in [
        ("rack", "left = \"6 um\""),
        ("rack", "right = \"6 um\""),
        ("pinion", "thickness = \"6 um\""),
        ("pinion", "left = \"6 um\""),
        ("pinion", "right = \"6 um\""),
        ("pinion", "eccentricity = { amount = \"6 um\", tooth = 1 }"),
    ] {
        let mut spec = of_teeth(&[(4, 2.0)], Some(1.0), 0.05);
        let teeth = if deviation.starts_with("ecc") { "" } else { "teeth = 1\n" };
        spec += &format!("[[{part}.deviation]]\n{teeth}{deviation}\n");
        assert_eq!(eval(&spec).expect("it is valid")["verdict"], Value::Null, "{part} {deviation}");
    }
}

proptest! {
    /// Fewer degrees of freedom, an unknown number of them, an unknown sum of magnitudes and no uncertainty at all.
    #[test]
    fn what_is_not_known_of_an_uncertainty_makes_no_pass(
        value in -0.02..0.02_f64, u in 0.0..0.01_f64, dof in 1.0..40.0_f64, fewer in 0.0..1.0_f64, folds in 0_u8..3,
        correlation in -1.0..1.0_f64, simulated in prop::option::of(0.9..1.0_f64),
    ) {
        let limit = Limit::symmetric("0.02".parse().expect("a length"));
        let result = Interval::value(Length::from_mm(value).expect("a length"));
        let decided = |ends: Option<Ends>, simulated| {
            decide(&Rule::Iso14253, &limit, result, ends.as_ref(), simulated).expect("it is in range")
        };
        let ends = |dof: Option<f64>, folds: Option<u8>| {
            let tail = Tail { dof, folds, rivals: 0 };
            Some(Ends { correlation, lower_tail: tail, upper_tail: tail, ..Ends::value(value, u) })
        };
        let passes = |dof, folds| decided(ends(dof, folds), None).verdict == Verdict::Pass;
        let (with, normal) = (passes(Some(dof), Some(folds)), passes(Some(f64::INFINITY), Some(0)));
        prop_assert!(normal || !with);
        prop_assert!(with || !passes(Some(1.0 + (dof - 1.0) * fewer), Some(folds)));
        prop_assert!(with || !passes(Some(dof), Some(folds + 1)));
        for unknown in [ends(None, Some(folds)), ends(Some(dof), None)] {
            let open = decided(unknown, None);
            prop_assert_eq!((open.verdict, open.conformance), (Verdict::Indeterminate, None));
        }
        prop_assert_eq!(decided(ends(None, Some(0)), simulated).verdict, Verdict::Indeterminate);
        prop_assert_eq!(decided(None, None).verdict, Verdict::Indeterminate);
    }

    /// A bound on a probability that says nothing is none.
    #[test]
    fn no_conformance_of_zero_percent_at_least(value in -0.03..0.03_f64, u in 1e-5..0.1_f64, folds in 1_u8..6) {
        let limit = Limit::symmetric("0.02".parse().expect("a length"));
        let tail = Tail { dof: Some(f64::INFINITY), folds: Some(folds), rivals: 0 };
        let ends = Ends { lower_tail: tail, upper_tail: tail, ..Ends::value(value, u) };
        prop_assert!(ends.conformance(&limit).is_none_or(|probability| probability > 0.0));
    }

    /// Whatever the relative errors of estimates do together, their share-weighted sum varies no more than the bound on ν says.
    #[test]
    fn the_bound_on_degrees_of_freedom_holds_for_every_dependence(
        terms in prop::collection::vec((-2.0..2.0_f64, 1.0..50.0_f64, prop::array::uniform4(-1.0..1.0_f64)), 1..6),
    ) {
        let (shares, dofs): (Vec<_>, Vec<_>) = terms.iter().map(|(share, dof, _)| (*share, *dof)).unzip();
        let bound = effective_dof(&shares, &dofs, false);
        // estimates that follow from four independent causes: correlations are cosines between their directions
        let mut sum = [0.0; 4];
        for (share, dof, direction) in &terms {
            let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt().max(1e-9);
            sum.iter_mut().zip(direction).for_each(|(sum, d)| *sum += share * d / (length * dof.sqrt()));
        }
        let relative: f64 = sum.iter().map(|s| s * s).sum();
        prop_assert!(bound == 1.0 || bound <= (1.0 + 1e-9) / relative, "{} {}", bound, 1.0 / relative);
        prop_assert!(bound <= effective_dof(&shares, &dofs, true) * (1.0 + 1e-9));
    }
}
