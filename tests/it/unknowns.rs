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

fn passes(spec: &str) -> bool {
    eval(spec).is_some_and(|json| json["verdict"] == "pass")
}

/// A measured error with its uncertainty.
struct Measured {
    key: &'static str,
    value_um: f64,
    u_um: f64,
    dof: Option<i64>,
    extent: &'static str,
}

impl Measured {
    fn some(random: &mut Random) -> Vec<Self> {
        let keys = ["rack_over_roller", "pinion_radial", "rack_pitch", "pinion_pitch"];
        let mut errors: Vec<_> = keys
            .into_iter()
            .map(|key| Self {
                key,
                value_um: random.range(-10.0, 10.0).round(),
                u_um: random.int(2, 20) as f64 / 10.0,
                dof: random.chance(0.7).then(|| random.int(2, 9)),
                extent: if key.ends_with("pitch") { "one" } else { ["one", "part", "all"][random.int(0, 2) as usize] },
            })
            .collect();
        errors.truncate(random.int(1, 4) as usize);
        errors
    }

    /// The entry, without what is taken away.
    fn entry(&self, taken: Option<&str>) -> String {
        let Self { key, value_um, u_um, dof, extent } = self;
        let dof = dof.map_or_else(String::new, |dof| format!(", dof = {dof}"));
        let u = if taken == Some("u") { String::new() } else { format!(", u = \"{u_um} um\"{dof}") };
        let nominal = if taken == Some("nominal") { "" } else { ", nominal = 25" };
        format!("{key} = {{ measured = {:.4}{nominal}{u}, extent = \"{extent}\" }}\n", 25.0 + 0.001 * value_um)
    }
}

/// A spec of these errors that is judged by ISO 14253-1, where the error of an index lacks something.
fn measured_spec(errors: &[Measured], correlation: f64, upper_mm: f64, taken: Option<(usize, &str)>) -> String {
    let of =
        |(index, error): (usize, &Measured)| error.entry(taken.filter(|taken| taken.0 == index).map(|taken| taken.1));
    let entries: String = errors.iter().enumerate().map(of).collect();
    let mut spec = format!(
        "[pair]\nnormal_pressure_angle = 20\n[errors]\n{entries}[limits]\ncenter_distance = {{ upper = {upper_mm:.6} }}\n\
         [decision]\nrule = \"iso14253\"\n"
    );
    if let ([a, b, ..], true) = (errors, correlation != 0.0) {
        let (a, b) = (a.key, b.key);
        spec += &format!("[[correlation]]\nbetween = [\"{a}\", \"{b}\"]\ncoefficient = {correlation}\n");
    }
    spec
}

/// Limits from within the value to well outside it, so that all verdicts occur.
#[test]
fn without_an_uncertainty_or_a_nominal_value_nothing_passes() {
    let mut random = Random(45);
    let mut passed = 0;
    let cases = if crate::common::is_long() { 200 } else { 16 };
    for case in 0..cases {
        let errors = Measured::some(&mut random);
        let correlation = [0.0, 0.001, -0.4, 0.7][case % 4];
        let upper_mm = random.range(0.0, 0.05);
        let spec = |taken| measured_spec(&errors, correlation, upper_mm, taken);
        let whole = eval(&spec(None)).expect("it is a spec");
        passed += usize::from(whole["verdict"] == "pass");
        let assumed = whole["assumes"].as_array().expect("a list");
        assert_eq!(assumed, &[Value::from("the error-free pair has ΔCD = 0")]);
        for (index, what) in (0..errors.len()).flat_map(|index| [(index, "u"), (index, "nominal")]) {
            assert!(!passes(&spec(Some((index, what)))), "{what}: {}", spec(None));
        }
    }
    assert!((cases / 8..cases).contains(&passed), "{passed}");
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
        if notes.contains("what the pair does without errors") {
            not_zero += 1;
            continue;
        }
        let Some(less) = eval(&spec(false)) else { continue };
        assert!(less["verdict"] != "pass" || whole["verdict"] == "pass", "{}", spec(true));
        assert!(less["verdict"] != "pass" || !less["assumes"].as_array().expect("a list").is_empty());
        assert_eq!(whole["assumes"], Value::Array(Vec::new()), "{}", spec(true));
        held += usize::from(whole["verdict"] != "pass");
    }
    assert!(held > 2 && not_zero < cases / 2, "{held} of {cases}, {not_zero} not 0");
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
            let tail = Tail { dof, folds };
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
        let tail = Tail { dof: Some(f64::INFINITY), folds: Some(folds) };
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
