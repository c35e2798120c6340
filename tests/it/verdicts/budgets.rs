//! Budgets: the teeth that they are of, and what their tolerances reach.

use super::*;

/// A budget grants what `eval` passes on the same teeth, with either sign.
#[test]
fn a_budget_is_of_the_teeth_that_it_says() {
    let limits = "[limits]\ncenter_distance = \"±0.05\"\n";
    let budget = format!(
        "{PAPER}[budget]\nrack_over_roller = {{ value = \"10 um\", extent = \"all\" }}\nrack_pitch = {{ weight = 2, extent = \"one\" }}\n\
         pinion_pitch = {{ extent = \"part\" }}\n{limits}"
    );
    let ended = run(&["budget", "-", "--format", "json"], &budget);
    let json = ended.json();
    let upper = json["worst_case_mm"]["upper"].as_f64().expect("a number");
    assert!(ended.code == Some(0) && upper <= 0.05 && upper > 0.05 - 1e-7, "{}", ended.stdout);
    let lines = json["tolerances"].as_array().expect("a list");
    assert_eq!(lines.iter().map(|line| line["extent"].clone()).collect::<Vec<_>>(), ["all", "one", "part"]);
    for (sign, factor, code) in [("", 1.0, 0), ("-", 1.0, 0), ("", 1.02, 1)] {
        let errors: Vec<_> = lines
            .iter()
            .map(|line| {
                let value = factor * line["tolerance_mm"].as_f64().expect("a number");
                format!(
                    "{} = {{ value = {sign}{value}, extent = {} }}\n",
                    line["error"].as_str().expect("a text"),
                    line["extent"]
                )
            })
            .collect();
        let errors = errors.concat();
        assert_eq!(eval(&format!("{PAPER}[errors]\n{errors}{limits}")).code, Some(code), "{errors}");
    }
    let page = run(&["budget", "-"], &budget).stdout;
    assert!(page.contains("  a run of pitches\n") && page.contains("  one pitch\n"), "{page}");
    // where a single pitch is off there is a bound without the pair
    let unknown = "[pair]\nnormal_pressure_angle = 20\n[budget]\nrack_pitch = { extent = \"one\" }\n";
    assert_eq!(run(&["budget", "-"], &format!("{unknown}{limits}")).code, Some(0));
    let each = run(&["budget", "-"], &format!("{unknown}{limits}").replace("one", "each"));
    assert!(each.code == Some(2) && each.stderr.contains("pair.normal_module"), "{}", each.stderr);
}

/// What the mesh reaches with the tolerances that a budget grants is what it reaches with them in `eval`.
#[test]
fn a_budget_says_what_its_tolerances_reach() {
    let limits = "[limits]\ncenter_distance = \"±0.05\"\n";
    let entries = "[budget]\nrack_over_roller = \"10 um\"\nrack_pitch = \"free\"\npinion_radial = { weight = 2 }\n";
    let budget = format!("{PAPER}{entries}{limits}");
    let of = |arguments: &[&str], spec: &str| run(&[&["budget", "-"], arguments].concat(), spec);
    let ended = of(&["--format", "json"], &budget);
    let json = ended.json();
    let ends = |of: &Value| (of["lower"].as_f64().expect("a number"), of["upper"].as_f64().expect("a number"));
    let (reached, bound) = (ends(&json["reached_mm"]), ends(&json["worst_case_mm"]));
    assert!(bound.0 <= reached.0 && reached.0 < 0.0 && 0.0 < reached.1 && reached.1 <= bound.1, "{}", ended.stdout);
    let lines = json["tolerances"].as_array().expect("a list").iter();
    let errors: Vec<_> = lines
        .map(|line| {
            format!(
                "{} = {{ value = {}, extent = \"each\" }}\n",
                line["error"].as_str().expect("a key"),
                line["tolerance_mm"]
            )
        })
        .collect();
    let evaluated = eval(&format!("{PAPER}[errors]\n{}{limits}", errors.concat())).json();
    assert_eq!(json["reached_mm"], evaluated["reached_mm"]);
    assert_eq!(json["notes"], evaluated["notes"]);
    let page = of(&[], &budget).stdout;
    let line = format!("\nreached: {:.4} … +{:.4} mm, of the worst case's ", reached.0, reached.1);
    assert_eq!(page.matches(&line).count(), 1, "{line} {page}");

    let not_reached = |arguments: &[&str], spec: &str, code: i32| {
        let ended = of(&[&["--format", "json"], arguments].concat(), spec);
        assert_eq!((ended.code, &ended.json()["reached_mm"]), (Some(code), &Value::Null), "{}", ended.stdout);
        let page = of(arguments, spec).stdout;
        assert!(!page.contains("reached"), "{page}");
        page
    };
    not_reached(&["--no-mesh"], &budget, 0);
    not_reached(&[], &format!("{budget}[support]\nroll = \"free\"\nroll_axis_depth = 8\n"), 0);
    // what is not granted reaches nothing
    not_reached(&[], &budget.replace("10 um", "60 um"), 1);
    let unknown = budget.replace("tip_diameter = 19.738\n", "").replace("\"free\"", "{ extent = \"one\" }");
    let page = not_reached(&[], &unknown, 0);
    let missing = "note: Geometry incomplete, the bound is wider than it need be: add `pinion.tip_diameter`";
    assert_eq!(page.matches(missing).count(), 1, "{page}");
}

/// Tolerances that a budget grants pass by the rule that parts are judged by.
#[test]
fn a_budget_keeps_its_guard_band() {
    let spec = format!(
        "{PAPER}[budget]\nrack_over_roller = \"free\"\n[limits]\ncenter_distance = \"±0.03\"\n[decision]\nrule = \"guard=5um\"\n"
    );
    let ended = run(&["budget", "-", "--format", "json"], &spec);
    let granted = ended.json()["tolerances"][0]["tolerance_mm"].as_f64().unwrap_or_else(|| panic!("{}", ended.stdout));
    assert!((granted - 0.025).abs() < 1e-6, "{granted}");
    assert!(ended.stdout.contains("limits are narrowed by the guard band"), "{}", ended.stdout);
}
