use super::*;
use crate::quantity::AngleUnit;

fn spec(text: &str) -> Spec {
    Spec::parse("spec.toml", text).expect(text)
}

fn measured(mm: &str) -> DeviationValue {
    DeviationValue::Length(mm.parse().unwrap())
}

#[test]
fn a_nominal_value_makes_a_column_measured() {
    let reading = |text: &str| spec(text).nominal_of_column(DeviationKind::RackOverRoller).unwrap();
    assert_eq!(reading(""), None);
    assert_eq!(reading("[errors]\nrack_over_roller = 0.01"), None);
    assert_eq!(reading("[errors]\nrack_over_roller = { nominal = 25.0 }"), Some(measured("25")));
    assert_eq!(reading("[errors]\nrack_over_roller = { nominal = 25, measured = 25.1 }"), Some(measured("25")));
    assert_eq!(reading("[table.columns]\nrack_over_roller = { nominal = \"1 in\" }"), Some(measured("25.4")));
    let both =
        "[errors]\nrack_over_roller = { nominal = 25 }\n[table.columns]\nrack_over_roller = { kind = \"deviation\" }";
    assert_eq!(reading(both), None);
    let roller = "[pair]\nnormal_module = 2.5\nnormal_pressure_angle = 20\n[rack]\ndatum = 21.5\n\
                      [errors]\nrack_over_roller = { roller = 5, measured = 26 }";
    let Some(DeviationValue::Length(nominal)) = reading(roller) else { panic!() };
    assert_eq!(format!("{:.3}", nominal.mm()), "25.915");
}

#[test]
fn contradictions_are_refused_with_their_place() {
    let problem = |text: &str| spec(text).nominal_of_column(DeviationKind::RackPitch).unwrap_err().to_string();
    assert_eq!(
        problem("[table.columns]\nrack_pitch = { kind = \"measured\" }"),
        "spec.toml:2:23: error[missing-key]: the column of `rack_pitch` holds measured values, and there is no nominal value"
    );
    assert!(
        problem("[table.columns]\nrack_pitch = { kind = \"deviation\", nominal = 6.28 }")
            .contains("error[bad-error-entry]: the column of `rack_pitch` holds deviations")
    );
    let unknown = Spec::parse("spec.toml", "[table.columns]\nrack_pitch = { unit = \"N\", nme = \"dp\" }");
    let unknown = unknown.unwrap_err().to_string();
    assert!(unknown.contains("`unit`: `N` is not a unit of a length: write nm, um,"), "{unknown}");
    assert!(unknown.contains("no key `nme`"), "{unknown}");
}

#[test]
fn units_of_columns_by_what_they_hold() {
    let unit = |column: &str| {
        let spec = Spec::parse("spec.toml", &format!("[table.columns]\n{column}"))?;
        let (_, column) = spec.table.columns.into_iter().next().expect("it has a column");
        Ok::<_, Diagnostics>(column.value.unit.expect("it has a unit").value)
    };
    for (column, expected) in [
        ("rack_pitch = { unit = \"Micron\" }", Unit::Length(LengthUnit::Micrometre)),
        ("rack_pitch = { unit = \"1/1000 mm\" }", Unit::Length(LengthUnit::Micrometre)),
        ("rack_pitch = { unit = \"″\" }", Unit::Length(LengthUnit::Inch)),
        ("rack_lead = { unit = \"″\" }", Unit::Angle(AngleUnit::Arcsecond)),
        ("rack_lead = { unit = \"min\" }", Unit::Angle(AngleUnit::Arcminute)),
        ("rack_lead = { unit = \"um\", length = 18 }", Unit::Length(LengthUnit::Micrometre)),
    ] {
        assert_eq!(unit(column).unwrap(), expected, "{column}");
    }
    for (column, message) in [
        (
            "rack_pitch = { unit = \"min\" }",
            "spec.toml:2:23: error[bad-quantity]: `unit`: `min` is a unit of angle, and a length is needed: write nm, um, \
                 µm, mm, cm, m, in or mil",
        ),
        (
            "rack_lead = { unit = \"grad\" }",
            "spec.toml:2:22: error[bad-quantity]: `unit`: `grad` is not a unit of an angle: write deg, °, ', arcmin, \", \
                 arcsec, rad, mrad, µrad or gon; or, of f_Hβ, nm, um, µm, mm, cm, m, in or mil",
        ),
        (
            "rack_pitch = { unit = 3 }",
            "spec.toml:2:23: error[wrong-type]: `unit` is a whole number; a unit in quotes, such as \"um\", is needed",
        ),
        (
            "rack_lead = { unit = \"deg\", length = 18 }",
            "spec.toml:2:38: error[bad-error-entry]: `length` is of f_Hβ, a length, and the unit of the column is deg",
        ),
        (
            "rack_lead = { unit = \"um\", length = 0 }",
            "spec.toml:2:37: error[out-of-domain]: the evaluation length L is 0 mm; it must be above 0 mm",
        ),
    ] {
        assert_eq!(unit(column).unwrap_err().to_string(), message);
    }
    assert!(unit("rack_pitch = { unit = \"um\", length = 18 }").is_err());
}

#[test]
fn what_is_not_used_is_a_list_of_patterns() {
    let layout = spec("[table]\nignore = [\"Temperatur*\", \"Bemerkung\"]\nothers = \"ignore\"").table.layout;
    let patterns: Vec<_> = layout.ignore.iter().map(crate::table::Pattern::text).collect();
    assert_eq!(patterns, ["Temperatur*", "Bemerkung"]);
    assert!(layout.ignores_others);
    assert!(!spec("[table]\nignore = []").table.layout.ignores_others);
    for (text, message) in [
        (
            "ignore = \"Bemerkung\"",
            "`ignore` is text; a list of texts in quotes, such as [\"Temperature*\"], is needed",
        ),
        ("ignore = [1]", "`ignore` is a whole number; text in quotes for each entry of its list is needed"),
        ("others = \"use\"", "`others` must be \"ignore\""),
    ] {
        let problem = Spec::parse("spec.toml", &format!("[table]\n{text}")).unwrap_err().to_string();
        assert!(problem.contains(message), "{problem}");
    }
}

#[test]
fn the_old_name_of_the_section_is_read_with_a_warning() {
    let old = spec("[batch]\nignore = [\"Temp*\"]\n[batch.columns]\nrack_pitch = { name = \"dp\", unit = \"um\" }");
    let new = spec("[table]\nignore = [\"Temp*\"]\n[table.columns]\nrack_pitch = { name = \"dp\", unit = \"um\" }");
    assert_eq!(old.table.layout, new.table.layout);
    assert!(new.suspicions().is_empty());
    assert!(old.suspicions()[0].message.contains("[batch] is called [table]"));
    let both = Spec::parse("spec.toml", "[batch]\nignore = []\n[table]\nignore = []").unwrap_err().to_string();
    assert!(both.contains("both are there"), "{both}");
}

#[test]
fn only_what_a_column_needs_is_required() {
    let spec = spec("[errors]\nrack_lead = 0.1");
    assert!(spec.law(DeviationKind::PinionRadial, "the column").is_ok());
    let missing = spec.law(DeviationKind::RackLead, "column `lead`").unwrap_err().to_string();
    assert!(missing.contains("`pair.normal_pressure_angle` is missing; column `lead` needs it"), "{missing}");
    assert!(missing.contains("`rack.face_width` is missing"), "{missing}");
}
