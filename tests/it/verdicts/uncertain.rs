//! Verdicts where values or sizes are uncertain, and rules that need uncertainties.

use super::*;

/// Near a face width at which one more step comes to carry, its uncertainty is that of the jump, and no pass is certain.
#[test]
fn uncertain_sizes_of_the_pair_count() {
    let spec = |width: &str| {
        let pair = PAPER.replace("face_width = 19.7", &format!("face_width = {{ value = {width}, u = 0.1 }}"));
        let pair = pair.replace("face_width = 23.5", "face_width = 30");
        format!(
            "{pair}[errors]\nrack_pitch = {{ value = \"10 um\", u = \"0.03 um\", extent = \"each\" }}\n\
             [limits]\ncenter_distance = {{ upper = 0.0285 }}\nrack_pitch = {{ upper = 0.0285 }}\n[decision]\nrule = \"iso14253\"\n"
        )
    };
    for draws in [&[][..], &["--monte-carlo", "2e4"]] {
        let of = |width| run(&[&["eval", "-", "--format", "json"], draws].concat(), &spec(width));
        assert_eq!(of("19.7").json()["verdict"], "pass", "{draws:?}");
        let near = of("23.75").json();
        assert_eq!(near["verdict"], "indeterminate", "{draws:?} {near}");
        assert!(near["limits"].as_array().is_some_and(|limits| limits.iter().all(|limit| limit["verdict"] != "pass")));
    }
}

/// A size on one space lifts the upper end where it stands out, and does nothing where it sinks: measured just below zero it
/// may be either.
#[test]
fn a_size_near_zero_is_uncertain_to_the_side_where_it_acts() {
    let limits = ["center_distance", "pinion_radial"].map(|on| format!("{on} = {{ upper = 0.002 }}\n"));
    for (pair, limit) in ["", PAPER].into_iter().flat_map(|pair| limits.iter().map(move |limit| (pair, limit))) {
        let spec = |value: &str| {
            format!(
                "{pair}[errors]\npinion_radial = {{ value = \"{value} um\", u = \"5 um\", extent = \"one\" }}\n\
                 [limits]\n{limit}[decision]\nrule = \"iso14253\"\n"
            )
        };
        for draws in [&[][..], &["--monte-carlo", "2e4"]] {
            let of = |value| run(&[&["eval", "-", "--format", "json"], draws].concat(), &spec(value)).json();
            assert_eq!(of("-1")["verdict"], "indeterminate", "{limit} {draws:?}");
            assert_eq!(of("-40")["verdict"], "pass", "{limit} {draws:?}");
        }
    }
}

/// Within the uncertainty of a step one more tooth comes to carry, so that the lower end jumps: the limit lies between, and a
/// quarter of 20,000 draws is beyond it.
#[test]
fn an_error_near_a_jump_of_the_bound_is_uncertain_by_the_jump() {
    let spec = "[pair]\nnormal_module = 1\nnormal_pressure_angle = 20\n[rack]\nhelix_angle = -7.355\nface_width = 6.59\n\
        addendum = 0.6281\n[pinion]\nteeth = 8\nhelix_angle = 0\nprofile_shift = 0.5\nface_width = 9.227\ntip_diameter = 10.7021\n\
        [errors]\nrack_over_roller = { value = \"-7.246 um\", extent = \"each\", u = 0 }\n\
        rack_pitch = { value = \"-19.772 um\", extent = \"one\", u = \"3.71 um\" }\n[decision]\nrule = \"iso14253\"\n[limits]\n";
    let of = |limit: &str, draws: &[&str]| {
        let spec = format!("{spec}center_distance = {{ lower = {limit} }}\n");
        run(&[&["eval", "-", "--format", "json"], draws].concat(), &spec).json()
    };
    let drawn = of("-0.022", &["--monte-carlo", "2e4"]);
    let conformance = drawn["limits"][0]["decision"]["conformance_probability"].as_f64().unwrap();
    assert!((0.7..0.85).contains(&conformance), "{conformance}");
    for draws in [&[][..], &["--monte-carlo", "2e4"]] {
        assert_eq!(of("-0.022", draws)["verdict"], "indeterminate", "{draws:?}");
        assert_eq!(of("-0.03", draws)["verdict"], "pass", "{draws:?}");
    }
}

/// An uncertain tooth thickness moves the whole curve; behind a computed nominal measure it moves nothing.
#[test]
fn an_uncertain_thickness_counts() {
    let spec = |error: &str| {
        format!(
            "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 1.7\n\
             tooth_thickness = {{ value = 3.1415927, u = \"10 um\" }}\ndatum = 21.9486\n\
             [pinion]\nteeth = 12\nhelix_angle = 20\nprofile_shift = 0.2\nface_width = 25\ntip_diameter = 30\n\
             [errors]\nrack_over_roller = {error}\n[limits]\ncenter_distance = \"±0.0065\"\n[decision]\nrule = \"iso14253\"\n"
        )
    };
    let standard_mm = |ended: &Ended| {
        let json = ended.json();
        let results = json["uncertainty"]["results"].as_array().unwrap_or_else(|| panic!("{}", ended.stdout));
        let upper = results.iter().find(|result| result["of"] == "upper").unwrap();
        upper["standard_uncertainty_mm"].as_f64().unwrap()
    };
    let stated = eval(&spec("{ value = \"5 um\", u = \"0.5 um\" }"));
    assert_eq!(stated.code, Some(3), "{}", stated.stdout);
    let expected = (0.01_f64 * GAIN_AT_20_DEG * 0.01 * GAIN_AT_20_DEG + 0.0005 * 0.0005).sqrt();
    assert!((standard_mm(&stated) / expected - 1.0).abs() < 1e-6, "{}", stated.stdout);
    for tip in ["", "tip_diameter = 30\n"] {
        let measured = spec("{ measured = 25.476, roller = 4 }").replace("tip_diameter = 30\n", tip);
        let measured = eval(&measured);
        assert!(standard_mm(&measured) < 1e-9, "{}", measured.stdout);
    }
}

/// An uncertainty of 0 widens no limit.
#[test]
fn a_rule_needs_an_uncertainty_above_zero() {
    let spec = "[errors]\nrack_over_roller = { value = \"20 um\", u = 0 }\n[limits]\ncenter_distance = \"±0.05\"\n";
    let ended = run(&["eval", "-", "--rule", "iso14253"], spec);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("needs an uncertainty above 0, and the spec gives none"), "{}", ended.stderr);
    // the values of a table stand in the table: the remedy puts none beside the uncertainty
    let spec = "[limits]\ncenter_distance = \"±0.05\"\n[decision]\nrule = \"iso14253\"\n";
    let folder = Folder::new("remedy");
    let path = folder.path("spec.toml");
    std::fs::write(&path, spec).expect("written");
    for command in ["batch", "paste"] {
        let ended = run(&[command, &path, "-"], "part_id,rack_over_roller [mm]\nA,0.01\n");
        assert_eq!(ended.code, Some(2), "{command}");
        assert!(ended.stderr.contains("such as `rack_pitch = { u = "), "{command}: {}", ended.stderr);
    }
}

/// A value without an uncertainty leaves the verdict of a rule that needs one open, wherever it is asked for; `u = 0` says that
/// it is exact.
#[test]
fn a_rule_needs_an_uncertainty_of_every_value() {
    let folder = Folder::new("every-uncertainty");
    let (path, table) = (folder.path("spec.toml"), folder.path("part.csv"));
    std::fs::write(&table, "part_id,rack_over_roller [um],rack_pitch [um]\nA,13,12\n").expect("written");
    for (pitch, code, reason) in [
        ("\"12 um\"", 2, "the rule iso14253 needs an uncertainty of every value, and none is given of rack_pitch"),
        ("{ value = \"12 um\", u = 0 }", 0, ""),
    ] {
        let spec = format!(
            "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_over_roller = {{ value = \"13 um\", u = \"2 um\" }}\n\
             rack_pitch = {pitch}\n[limits]\ncenter_distance = {{ lower = -0.03, upper = 0.034 }}\n[decision]\nrule = \"iso14253\"\n"
        );
        std::fs::write(&path, spec).expect("written");
        for command in [
            &["eval", &path, "--format", "csv"][..],
            &["batch", &path, &table],
            &["paste", &path, &table, "--format", "csv"],
        ] {
            let ended = run(command, "");
            assert_eq!(ended.code, Some(code), "{command:?}: {}", ended.stderr);
            assert!(ended.stdout.contains(reason), "{command:?}: {}", ended.stdout);
        }
        let page = run(&["report", &path], "");
        assert_eq!((page.code, page.stdout.contains(reason)), (Some(code), true), "{}", page.stderr);
    }
}

/// Where an uncertainty leads to teeth that do not mesh, the range has none: it is shown, and a rule that needs one leaves it open.
#[test]
fn a_bound_that_ends_within_an_uncertainty_has_none() {
    let spec = |values: [&str; 3]| {
        let [lead, radial, pitch] = values;
        format!(
            "[pair]\nnormal_module = 3\nnormal_pressure_angle = 20\n[rack]\nhelix_angle = -30\nface_width = 27\naddendum = 2.7\n\
             [pinion]\nteeth = 6\nhelix_angle = 25\nprofile_shift = -0.1\n\
             tip_diameter = 25.2608\nface_width = 12\n[errors]\npinion_lead = {{ {lead}extent = \"one\", u = \"2 um\" }}\n\
             pinion_radial = {{ {radial}extent = \"all\", u = \"0.5 mm\" }}\n\
             pinion_pitch = {{ {pitch}extent = \"all\", u = \"1 um\" }}\n[limits]\ncenter_distance = \"±0.5\"\n"
        )
    };
    let folder = Folder::new("open-within");
    let (path, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&path, spec([""; 3])).expect("written");
    let rows = "part_id,pinion_lead [um],pinion_radial [um],pinion_pitch [um]\nP0,-2.4,-5.98,-9.39\n";
    std::fs::write(&table, rows).expect("written");
    let of_eval = spec(["value = \"-2.4 um\", ", "value = \"-5.98 um\", ", "value = \"-9.39 um\", "]);
    for (rule, code, verdict) in [("guard=3um", 0, "pass".into()), ("iso14253", 2, Value::Null)] {
        let ended = run(&["batch", &path, &table, "--format", "jsonl", "--rule", rule], "");
        assert_eq!(ended.code, Some(code), "{rule}: {}", ended.stderr);
        for line in ended.stdout.lines() {
            let row: Value = serde_json::from_str(line).expect(line);
            assert!(
                row["range_lower_mm"].is_number() && row["range_lower_standard_uncertainty_mm"].is_null(),
                "{line}"
            );
            assert_eq!((&row["verdict"], &row["conformance_probability"]), (&verdict, &Value::Null), "{line}");
            assert_eq!(row["reason"].is_null(), code == 0, "{line}");
        }
    }
    let summary = run(&["batch", &path, &table, "--summary", "--format", "json"], "");
    assert!(!summary.stdout.contains("e+") && summary.code == Some(0), "{}", summary.stdout);
    let ended = run(&["eval", "-", "--format", "json", "--rule", "iso14253", "--no-worst-teeth"], &of_eval);
    let json = ended.json();
    assert_eq!((ended.code, &json["verdict"]), (Some(2), &Value::Null), "{}", ended.stderr);
    assert!(json["combined"]["range_mm"]["lower"].is_number(), "{json}");
    assert!(json["notes"].to_string().contains("no bound of ΔCD is known where errors.p"), "{json}");
}

/// Two pitches near 0 that move against each other: their sum is certain, and that of their magnitudes is not.
#[test]
fn correlated_values_near_zero_prove_nothing() {
    let spec = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = { value = 0, u = \"1 um\" }\n\
        pinion_pitch = { value = 0, u = \"1 um\" }\n[decision]\nrule = \"iso14253\"\n\
        [limits]\ncenter_distance = { upper = 0.002 }\n[[correlation]]\n\
        between = [\"errors.rack_pitch\", \"errors.pinion_pitch\"]\ncoefficient = -1\n";
    let ended = eval(spec);
    assert_eq!(ended.code, Some(3), "{}{}", ended.stdout, ended.stderr);
}
