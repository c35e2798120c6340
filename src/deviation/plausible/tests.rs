use super::*;

fn length(text: &str) -> Length {
    text.parse().expect(text)
}

fn angle(text: &str) -> Angle {
    text.parse().expect(text)
}

/// What is said of a value: nothing, or how bad it is and what was meant.
fn said(doubt: Option<Doubt>) -> Option<(bool, Meant)> {
    doubt.map(|doubt| (doubt.is_impossible, doubt.meant))
}

#[test]
fn lengths() {
    const MICROMETRES: Meant = Meant::Unit("um");
    for (value, module, expected) in [
        ("0.999999", None, None),
        ("1", None, Some((false, MICROMETRES))),
        ("-12", None, Some((false, MICROMETRES))),
        ("999", None, Some((false, MICROMETRES))),
        ("1000", None, Some((false, Meant::Unknown))),
        ("25.013", None, Some((false, Meant::Size))),
        ("-25.013", None, Some((false, MICROMETRES))),
        ("13.1", None, Some((false, MICROMETRES))),
        ("0.499999", Some("2"), None),
        ("0.5", Some("2"), Some((false, MICROMETRES))),
        ("2", Some("2"), Some((false, MICROMETRES))),
        ("2.01", Some("2"), Some((true, Meant::Size))),
        ("-12", Some("2"), Some((true, MICROMETRES))),
        ("1", Some("20"), Some((false, MICROMETRES))),
    ] {
        let found = deviation(DeviationValue::Length(length(value)), module.map(length));
        assert_eq!(said(found), expected, "{value} {module:?}");
    }
}

#[test]
fn leads() {
    for (value, expected) in [
        (DeviationValue::Angle(angle("0.0017")), None),
        (DeviationValue::Angle(angle("-1.999")), None),
        (DeviationValue::Angle(angle("2")), Some((false, Meant::Unit("arcmin")))),
        (DeviationValue::Angle(angle("-15")), Some((false, Meant::Unit("arcmin")))),
        (DeviationValue::Angle(angle("45")), Some((false, Meant::Unit("arcmin")))),
        (DeviationValue::Angle(angle("46")), Some((true, Meant::Unit("arcmin")))),
        (DeviationValue::Angle(angle("120")), Some((true, Meant::Unknown))),
        (DeviationValue::Slope(0.034), None),
        (DeviationValue::Slope(-0.035), Some((false, Meant::Slope))),
        (DeviationValue::Slope(1.0), Some((false, Meant::Slope))),
        (DeviationValue::Slope(1.01), Some((true, Meant::Slope))),
    ] {
        assert_eq!(said(deviation(value, Some(length("2")))), expected, "{value:?}");
    }
}

#[test]
fn gear_data() {
    const RADIANS: Meant = Meant::Unit("rad");
    for (value, expected) in [
        ("0", None),
        ("0.1", Some((true, Meant::Unknown))),
        ("0.349", Some((true, RADIANS))),
        ("1", Some((false, Meant::Unknown))),
        ("4.9", Some((false, Meant::Unknown))),
        ("5", None),
        ("20", None),
    ] {
        assert_eq!(said(pressure_angle(angle(value))), expected, "{value}");
    }
    for (value, expected) in
        [("0", false), ("0.08", false), ("0.436", true), ("-0.436", true), ("0.88", false), ("-12", false)]
    {
        assert_eq!(helix_angle(angle(value)).is_some(), expected, "{value}");
    }
    assert!(normal_module(length("100")).is_none());
    assert!(normal_module(length("1830")).is_some_and(|doubt| !doubt.is_impossible));
    for (value, module, expected) in [
        ("1000", None, false),
        ("18000", None, true),
        ("183", Some("1.83"), false),
        ("184", Some("1.83"), true),
        ("1001", Some("100"), true),
    ] {
        assert_eq!(face_width(length(value), module.map(length)).is_some(), expected, "{value} {module:?}");
    }
}

#[test]
fn what_to_write_is_what_reads_as_meant() {
    let doubt = deviation(DeviationValue::Length(length("12")), None).expect("much");
    assert_eq!(doubt.remedy(WrittenIn::Spec), "if that is µm, write \"12 um\"");
    assert_eq!(doubt.remedy(WrittenIn::Argument), "if that is µm, write 12um");
    assert_eq!(doubt.of_difference().remedy(WrittenIn::Spec), "check the unit and the decimal mark");
    assert_eq!(length("12 um"), length("0.012"));
    let size = deviation(DeviationValue::Length(length("25.013")), None).expect("much");
    assert_eq!(size.remedy(WrittenIn::Argument), "if that is a measured size, write --measured 25.013 --nominal …");
}
