use super::*;

fn standard(entry: &str, source: Influence) -> Uncertainty {
    let text = format!(
        "[pair]\nnormal_module = 2\nnormal_pressure_angle = {{ value = 20, u = 0.01 }}\n[rack]\ndatum = 22\n\
             face_width = {{ value = 20, half_width = 0.3, distribution = \"rectangular\" }}\n[errors]\n{entry}\n"
    );
    let spec = Spec::parse("test", &text).expect(&text);
    *spec.uncertainties().expect("they are consistent").of(source).expect(entry)
}

#[test]
fn every_way_to_write_an_uncertainty() {
    let pitch = Influence::Error(DeviationKind::RackPitch);
    for (entry, expected) in [
        ("rack_pitch = { value = 0.01, u = \"0.8 um\" }", 0.0008),
        ("rack_pitch = { measured = 6.3, nominal = 6.29, U = \"1.6 um\", k = 2 }", 0.0008),
        ("rack_pitch = { value = 0.01, half_width = 0.003, distribution = \"arcsine\" }", 0.003 / 2.0_f64.sqrt()),
        ("rack_pitch = { value = 0.01, half_width = 0.003, distribution = \"normal\" }", 0.0015),
    ] {
        assert!((standard(entry, pitch).standard - expected).abs() < 1e-15, "{entry}");
    }
    assert_eq!(standard("rack_pitch = { value = 0.01, u = 0.001, dof = 9 }", pitch).dof, 9.0);
    let lead = Influence::Error(DeviationKind::RackLead);
    // Δβ = atan(f/L): u(Δβ) = u(f) L/(L² + f²)
    let slope = standard("rack_lead = { f_h_beta = \"8 um\", length = 20, u = \"1 um\" }", lead).standard;
    let expected = 0.001 * 20.0 / (400.0 + 0.008 * 0.008) * 180.0 / std::f64::consts::PI;
    assert!((slope / expected - 1.0).abs() < 1e-12);
    let angle = standard("rack_lead = { value = \"1 arcmin\", u = \"6 arcsec\" }", lead).standard;
    assert!((angle - 6.0 / 3600.0).abs() < 1e-15);
    // readings: s = 1 µm, of three
    let of_three = 0.001 / 3.0_f64.sqrt();
    for (entry, source, expected) in [
        ("rack_pitch = { values = [0.011, \"13 um\", 0.012] }", pitch, of_three),
        ("rack_pitch = { values = [6.301, 6.303, 6.302], nominal = 6.29 }", pitch, of_three),
        (
            "rack_lead = { values = [\"7 um\", \"9 um\", \"8 um\"], length = 20 }",
            lead,
            of_three * 20.0 / (400.0 + 0.008 * 0.008) * 180.0 / std::f64::consts::PI,
        ),
        ("rack_lead = { values = [0.011, 0.013, 0.012] }", lead, of_three),
        (
            "rack_over_roller = { measured = 25.5, roller = { values = [4, 4.002, 4.001] } }",
            Influence::Roller,
            of_three,
        ),
    ] {
        let found = standard(entry, source);
        assert!((found.standard / expected - 1.0).abs() < 1e-9 && found.dof == 2.0, "{entry}: {found:?}");
    }
    // sizes of the gear, and the roller
    let face = standard("rack_lead = 0.01", Influence::FaceWidth);
    assert!((face.standard - 0.3 / 3.0_f64.sqrt()).abs() < 1e-15);
    let over_roller = "rack_over_roller = { measured = 25.5, roller = { value = 4, u = \"0.5 um\" }, u = 0.001 }";
    assert_eq!(standard(over_roller, Influence::Roller).standard, 0.0005);
    assert_eq!(standard(over_roller, Influence::Error(DeviationKind::RackOverRoller)).standard, 0.001);
}

#[test]
fn readings_that_say_no_uncertainty_are_refused() {
    for (entry, problem) in [
        ("{ values = [0.012] }", "one reading says nothing of its uncertainty"),
        ("{ values = [] }", "one reading says nothing of its uncertainty"),
        ("{ values = [0.012, 0.012, 0.012] }", "all readings are the same"),
        ("{ values = [0.012, 0.013], u = 0.001 }", "`u` stands beside readings"),
        ("{ values = 0.012 }", "`values` is a number; a list of readings is needed"),
        ("{ values = [0.012, true] }", "`values` is true or false"),
    ] {
        let spec = format!("[errors]\npinion_radial = {entry}\n");
        let found = Spec::parse("test", &spec).expect_err(entry).to_string();
        assert!(found.contains(problem), "{entry}: {found}");
    }
}

/// The mean of readings is exact, and their uncertainty is no other value's.
#[test]
fn readings_are_of_their_own_value() {
    let text = "[errors]\nrack_over_roller = { values = [25.011, 25.013, 25.012], nominal = 25 }\n";
    let spec = Spec::parse("test", text).unwrap();
    let [error] = &spec.part_deviations().unwrap()[..] else { panic!("there is one error") };
    assert_eq!(error.value().base(), 0.012);
    assert!(spec.is_uncertain(DeviationKind::RackOverRoller));
    let of_table = spec.for_columns(&[DeviationKind::RackOverRoller]);
    assert!(!of_table.is_uncertain(DeviationKind::RackOverRoller));
    assert!(spec.for_columns(&[DeviationKind::RackPitch]).is_uncertain(DeviationKind::RackOverRoller));
}

#[test]
fn only_what_a_result_follows_from_counts() {
    let text = "[rack]\nface_width = { value = 20, u = 0.1 }\n[errors]\npinion_radial = { value = 0.01, u = 0.001 }\n";
    let spec = Spec::parse("test", text).unwrap();
    let sources: Vec<_> = spec.uncertainties().unwrap().inputs().iter().map(|(source, _)| *source).collect();
    assert_eq!(sources, [Influence::Error(DeviationKind::PinionRadial)]);
    assert!(spec.taken_as_exact().is_empty());
}

#[test]
fn correlations_need_two_uncertain_values() {
    let text = "[errors]\npinion_radial = { value = 0.01, u = 0.001 }\nrack_over_roller = 0.02\n\
                    [[correlation]]\nbetween = [\"pinion_radial\", \"rack_over_roller\"]\ncoefficient = 0.5\n";
    let problem = Spec::parse("test", text).unwrap().uncertainties().unwrap_err().to_string();
    assert!(problem.contains("errors.rack_over_roller is correlated but has no uncertainty"), "{problem}");
}
