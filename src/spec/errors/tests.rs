use crate::deviation::{DeviationKind, DeviationValue};
use crate::spec::{Spec, WrittenError};

#[test]
fn a_value_may_be_that_of_every_part() {
    let every_part = |entry: &str| Spec::parse("spec.toml", &format!("[errors]\n{entry}")).map(|spec| spec.every_part);
    for (entry, kind) in [
        ("rack_pitch = { value = \"12 um\", every_part = true }", DeviationKind::RackPitch),
        ("pinion_radial = { measured = 8.5, nominal = 8.4, u = 0.01, every_part = true }", DeviationKind::PinionRadial),
        ("rack_over_roller = { measured = 25.1, roller = 4, every_part = true }", DeviationKind::RackOverRoller),
        ("rack_lead = { f_h_beta = 0.008, length = 18, every_part = true }", DeviationKind::RackLead),
    ] {
        assert_eq!(every_part(entry).expect(entry), [kind], "{entry}");
        assert!(every_part(&entry.replace("true", "false")).expect(entry).is_empty(), "{entry}");
    }
    assert!(every_part("rack_pitch = \"12 um\"").expect("a value").is_empty());
}

#[test]
fn every_part_needs_a_value_that_it_is_of() {
    for (entry, message) in [
        ("{ class = 7, every_part = true }", "`rack_pitch` has no value that `every_part` could be of"),
        ("{ nominal = 6.28, every_part = true }", "`rack_pitch` has no value that `every_part` could be of"),
        ("{ every_part = true }", "`rack_pitch` is a table that makes no error"),
        ("{ u = 0.001, every_part = true }", "`rack_pitch` is a table that makes no error"),
        ("{ value = 1, every_part = 1 }", "`every_part` is a whole number; true or false is needed"),
        ("{ value = 1, evry_part = true }", "`rack_pitch` has no key `evry_part`"),
    ] {
        let problem = Spec::parse("spec.toml", &format!("[errors]\nrack_pitch = {entry}")).expect_err(entry);
        assert!(problem.to_string().contains(message), "{problem}");
    }
}

#[test]
fn a_tolerance_has_two_ends_in_order() {
    let lead = "[errors]\nrack_lead = { value = { lower = \"-1 arcmin\", upper = 0.02 }, extent = \"all\" }";
    assert!(Spec::parse("spec.toml", lead).is_ok());
    let slope = "[errors]\nrack_lead = { f_h_beta = { lower = \"-9 um\", upper = \"18 um\" }, length = 18 }";
    let [(_, written)] = &Spec::parse("spec.toml", slope).expect("a tolerance").errors[..] else { panic!("one error") };
    let WrittenError::Tolerance(ends) = written.value else { panic!("{written:?}") };
    assert_eq!((ends.farther, ends.nearer), (DeviationValue::Slope(0.001), Some(DeviationValue::Slope(-0.0005))));
    let uncertain = slope.replace("length", "u = \"1 um\", length");
    let problem = Spec::parse("spec.toml", &uncertain).expect_err("no uncertainty");
    assert!(problem.to_string().contains("what is permitted has no measuring uncertainty"), "{problem}");
    for (entry, message) in [
        ("{ value = { lower = 1 } }", "`rack_pitch`: a tolerance has a `lower` and an `upper` end"),
        ("{ value = { lower = 1, upper = 0 } }", "`rack_pitch`: the lower end is above the upper one"),
        ("{ value = { lower = 0, upper = 1 }, u = 1 }", "`rack_pitch`: what is permitted has no measuring uncertainty"),
        (
            "{ value = { lower = 0, upper = 1 }, extent = \"total\" }",
            "`rack_pitch`: a total cumulative deviation has no sign",
        ),
        ("{ value = { lower = 0, uper = 1 } }", "`value` has no key `uper`"),
    ] {
        let problem = Spec::parse("spec.toml", &format!("[errors]\nrack_pitch = {entry}")).expect_err(entry);
        assert!(problem.to_string().contains(message), "{problem}");
    }
}
