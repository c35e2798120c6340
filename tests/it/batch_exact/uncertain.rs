//! Uncertainties of a batch, guard bands and gauge shares.

use super::*;

/// Uncertainties of everything, with a correlation, few degrees of freedom and a nominal value that is given.
const UNCERTAIN: &str = "[pair]\nnormal_pressure_angle = { value = 20, u = 0.02 }\n\
    [rack]\nface_width = { value = 19.7, half_width = 0.1, distribution = \"rectangular\" }\nhelix_angle = { value = 12, u = 0.03 }\n\
    [pinion]\nhelix_angle = { value = 21, u = 0.03 }\n\
    [limits]\ncenter_distance = { lower = -0.03, upper = 0.04 }\nrack_lead = { upper = 0.012 }\n\
    [[correlation]]\nbetween = [\"rack_pitch\", \"pinion_pitch\"]\ncoefficient = -0.6\n[errors]\n";

/// The row of a part by the evaluation of single specs with its uncertainties, by column.
fn uncertain_by_eval(values: &[String; 5], stack: Stack, rule: &Rule) -> Vec<(String, String)> {
    let mut text = UNCERTAIN.to_owned();
    let _ = writeln!(text, "rack_over_roller = {{ measured = {}, nominal = 25.0, u = \"0.8 um\" }}", values[0]);
    let _ = writeln!(text, "rack_pitch = {{ value = \"{} um\", U = \"1.6 um\", k = 2 }}", values[1]);
    let _ = writeln!(text, "rack_lead = {{ value = {}, u = \"0.1 arcmin\", dof = 9 }}", values[2]);
    let _ = writeln!(text, "pinion_radial = {{ measured = {}, nominal = 8.5, u = \"0.9 um\" }}", values[3]);
    let _ = writeln!(text, "pinion_pitch = {{ value = {}, u = \"0.7 um\" }}", values[4]);
    let spec = Spec::parse("one.toml", &text).expect("the spec is valid");
    let errors = spec.part_deviations().expect("the errors are there");
    let basis = spec.basis().expect("nothing is known of the pair");
    let mut evaluation =
        evaluate(&errors, &spec.limits(), Model::Exact, stack, &basis).expect("the errors are in their domain");
    let uncertainties = spec.uncertainties().expect("they are consistent");
    let part = UncertainPart { errors: &errors, over_pin: None, model: Model::Exact, stack, basis: &basis, teeth: &[] };
    let propagation = propagate(&part, &uncertainties).expect("the formulas are smooth");
    evaluation.decide_by(rule, Some(&propagation), None).expect("numbers in range");
    let number = |value: f64| Length::from_mm(value).expect("finite").to_decimal_text(6);
    let mut row = Vec::new();
    let mut add = |name: &str, linear: &Linear| {
        row.push((format!("{name}_standard_uncertainty_mm"), number(linear.standard_mm)));
        row.push((format!("{name}_expanded_uncertainty_mm"), number(linear.expanded_mm().unwrap())));
    };
    for (kind, linear) in &propagation.errors {
        add(&format!("delta_cd_{}", kind.key()), linear);
    }
    // without anything that scatters the worst case is judged
    add(&format!("{}_lower", evaluation.stack.name()), &propagation.lower);
    add(&format!("{}_upper", evaluation.stack.name()), &propagation.upper);
    row.push(("linear".to_owned(), propagation.upper.folded.is_empty().to_string()));
    for check in &evaluation.limits {
        // unknown of correlated values near 0
        let conformance = check.decision.as_ref().expect("it is uncertain").conformance;
        let name = match check.on {
            LimitTarget::CenterDistance => "conformance_probability".to_owned(),
            LimitTarget::Error(kind) => format!("delta_cd_{}_conformance_probability", kind.key()),
        };
        row.push((name, conformance.map_or_else(String::new, |conformance| number(conformance.probability))));
    }
    row.push(("verdict".to_owned(), evaluation.verdict.map_or("", Verdict::name).to_owned()));
    row
}

pub(super) fn check_uncertain(parts: &[[String; 5]], stack: Stack, rule: &str) -> Outcome {
    let rule: Rule = rule.parse().expect("a rule");
    let spec = UNCERTAIN.to_owned()
        + "rack_over_roller = { nominal = 25, u = \"0.8 um\" }\nrack_pitch = { U = \"1.6 um\", k = 2 }\n\
           rack_lead = { u = \"0.1 arcmin\", dof = 9 }\npinion_radial = { nominal = 8.5, u = \"0.9 um\" }\n\
           pinion_pitch = { u = \"0.7 um\" }\n[table.columns]\nrack_pitch = { unit = \"um\" }\n";
    let mut table = format!("part_id,{}\n", COLUMNS.join(","));
    for (index, values) in parts.iter().enumerate() {
        let _ = writeln!(table, "P{index},{}", values.join(","));
    }
    let request = Request { stack, rule: rule.clone(), statistics: true, ..Request::default() };
    let (rows, outcome) = run_with_header(&spec, &table, request);
    assert_eq!(outcome.problems, [], "{table}");
    let header: Vec<_> = rows[0].split(',').collect();
    for (row, values) in rows[1..].iter().zip(parts) {
        let cells: Vec<_> = row.split(',').collect();
        for (name, expected) in uncertain_by_eval(values, stack, &rule) {
            let at = header.iter().position(|column| *column == name).unwrap_or_else(|| panic!("{name}: {header:?}"));
            assert_eq!(cells[at], expected, "{name}, {values:?}");
        }
    }
    outcome
}

#[test]
fn on_guard_bands_and_folds() {
    let part = |values: [&str; 5]| values.map(str::to_owned);
    // with u = 0.9 and 0.8 um: the guard band of both is 1.65 · 1.204… um; values about it, and about 3 u
    let mut parts = Vec::new();
    for (over, pitch) in
        [("25.0", "0"), ("24.97", "2.4"), ("25.0395", "-2.4"), ("25.03801313", "1e-9"), ("25.0419", "2.3999")]
    {
        parts.push(part([over, pitch, "0", "8.5", "0"]));
        parts.push(part([over, pitch, "0.005", "8.49", "0.0021"]));
    }
    for stack in Stack::ALL {
        for rule in ["iso14253", "simple", "guard=2um"] {
            let outcome = check_uncertain(&parts, stack, rule);
            let open = outcome.counts.indeterminate;
            assert_eq!(open > 0, rule != "simple", "{stack} {rule}");
        }
    }
}

#[test]
fn uncertainties_cost_nothing_where_nobody_asks() {
    let spec = "[errors]\nrack_over_roller = { nominal = 25, u = 0.001 }\n[limits]\ncenter_distance = \"±0.05\"\n";
    let table = "part_id,rack_over_roller\nP1,25.01\n";
    let columns = |names: &[&str]| Some(names.iter().map(|name| (*name).to_owned()).collect());
    let plan = |request: Request, spec: &str| {
        let spec = Arc::new(Spec::parse("spec.toml", spec).expect("the spec is valid"));
        let container = Container::open("parts.csv", Source::bytes(table.into()), &spec.want()).expect("it is text");
        let table = container.table("parts.csv", &spec.want()).expect("there is a header");
        Plan::new(&spec, &table, request)
    };
    let some = Request { columns: columns(&["part_id", "verdict"]), ..Request::default() };
    assert!(!plan(some.clone(), spec).expect("it fits").is_uncertain());
    let by_rule = Request { rule: Rule::Iso14253, ..some };
    assert!(plan(by_rule.clone(), spec).expect("it fits").is_uncertain());
    let without = spec.replace(", u = 0.001", "");
    assert!(!plan(Request::default(), &without).expect("it fits").is_uncertain());
    let refused = plan(by_rule, &without).unwrap_err().to_string();
    assert!(refused.contains("iso14253 needs an uncertainty above 0, and the spec gives none"), "{refused}");
}

#[test]
fn the_gauge_share_is_of_measuring_alone() {
    // the pressure angle is the same for all parts: it does not spread them
    let spec = "[pair]\nnormal_pressure_angle = { value = 20, u = 0.5 }\n[errors]\nrack_pitch = { u = 0.001 }\n\
                [limits]\nrack_pitch = { upper = 0.05 }\n";
    let mut table = "part_id,rack_pitch\n".to_owned();
    for part in 0..50 {
        let _ = writeln!(table, "P{part},0.0{}", 10 + part % 7);
    }
    let request = Request { statistics: true, ..Request::default() };
    let (_, outcome) = run(spec, &table, request);
    let gauge = outcome.quantities[0].statistics.gauge_mm().expect("it is uncertain");
    // 1/(2 tan 20°)
    assert!((gauge / 0.001 - 1.373_738_709_727_311).abs() < 1e-9, "{gauge}");
}

#[test]
fn a_guard_band_is_exact_to_the_decimal() {
    let spec = "[limits]\ncenter_distance = \"±0.05\"\n[errors]\nrack_over_roller = { nominal = 25 }\n";
    let mut table = "part_id,rack_over_roller\n".to_owned();
    let values = [
        ("25.04", "pass"),
        ("25.0400001", "indeterminate"),
        ("25.06", "indeterminate"),
        ("24.94", "indeterminate"),
        ("24.9399999", "fail"),
        // finer than the grid, and no plain number
        ("25.0600000000000000000001", "indeterminate"),
        ("2506e-2", "indeterminate"),
    ];
    for (value, _) in values {
        let _ = writeln!(table, "{value},{value}");
    }
    let request = Request { rule: "guard=10um".parse().unwrap(), ..Request::default() };
    let (rows, outcome) = run(spec, &table, request);
    for (row, (value, verdict)) in rows.iter().zip(values) {
        assert!(row.contains(&format!(",{verdict},")), "{value}: {row}");
    }
    assert_eq!(outcome.counts.indeterminate, 5);
}
