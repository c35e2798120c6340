//! Keys set on the command line: the same values and the same refusals as in a file, pointing at the option.

use rackmesh::diagnostic::Diagnostics;
use rackmesh::spec::{Spec, keys};

const FILE: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = \"10 um\"\n";

fn set(settings: &[&str]) -> Result<Spec, Diagnostics> {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    Spec::parse_with("rack.toml", FILE, &settings)
}

/// What the errors of a spec come to.
fn errors(spec: &Spec) -> Vec<String> {
    let errors = spec.part_deviations().unwrap_or_else(|error| panic!("{error}"));
    errors.iter().map(|error| format!("{} {}", error.kind().key(), error.value())).collect()
}

#[test]
fn a_setting_is_as_if_it_stood_in_the_file() {
    for (settings, written) in [
        (&["errors.rack_pitch=12um"][..], "[errors]\nrack_pitch = \"12 um\""),
        (&["errors.rack_pitch=0.012"], "[errors]\nrack_pitch = 0.012"),
        (&["errors.rack_pitch='12 um'"], "[errors]\nrack_pitch = '12 um'"),
        (&[" errors . rack_pitch = 12um "], "[errors]\nrack_pitch = \"12um\""),
        (
            &["errors.rack_pitch={ measured = 6.3, nominal = 6.29 }"],
            "[errors]\nrack_pitch = { measured = 6.3, nominal = 6.29 }",
        ),
        (&["errors.rack_pitch={}", "errors.rack_pitch.value=12um"], "[errors]\nrack_pitch = { value = \"12um\" }"),
        (&["errors={ pinion_radial = 1 }"], "[errors]\npinion_radial = 1"),
        (&["errors.pinion_radial=-4um"], "[errors]\nrack_pitch = \"10 um\"\npinion_radial = \"-4 um\""),
    ] {
        let expected = format!("[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n{written}\n");
        let expected = Spec::parse("rack.toml", &expected).expect(written);
        assert_eq!(errors(&set(settings).expect(written)), errors(&expected), "{settings:?}");
    }
    let spec = set(&["limits.center_distance=±0.05", "title=lot 7", "rack.tip_relief={ amount = 0.01, start = 1 }"]);
    let spec = spec.expect("all are understood");
    assert_eq!((spec.limits().len(), spec.title.as_deref()), (1, Some("lot 7")));
    let list = set(&["rack.deviation=[{ teeth = 3, pitch = '1 um' }]", "errors={}"]).expect("it is a list of tables");
    assert_eq!(list.rack_deviations.len(), 1);
}

#[test]
fn what_is_wrong_is_said_where_it_stands() {
    for (setting, expected) in [
        ("errors.rack_pitch=12mym", "1:25: error[bad-quantity]: `rack_pitch`: `mym` is not a unit of a length"),
        ("errors.rack_pitch = 12mym", "1:27: error[bad-quantity]: `rack_pitch`: `mym` is not a unit of a length"),
        ("errors.rack_pitch=[1]#", "1:25: error[bad-quantity]: `rack_pitch`: `[1]#` is not a length"),
        ("errors.rack_pitch=1 # one", "1:25: error[bad-quantity]: `rack_pitch`: `# one` is not a unit"),
        ("errors.rack_pitch=", "1:25: error[bad-quantity]: `rack_pitch`: `` is not a length"),
        ("errors.rack_pitch={ u = 1, v = 2 }", "1:34: error[unknown-key]: `rack_pitch` has no key `v`"),
        ("errors.rack_ptch=1um", "1:14: error[unknown-key]: [errors] has no key `rack_ptch`"),
        ("eror.rack_pitch=1um", "1:7: error[unknown-key]: there is no section `eror`"),
        ("pair.normal_pressure_angle=60", "1:34: error[out-of-domain]: the normal pressure angle α_n is 60°"),
        ("limits.center_distance=0.05", "1:30: error[bad-limit]: `center_distance` is a number"),
        ("errors.rack_pitch=12", "1:25: error[implausible]: `rack_pitch`: 12 mm is too large for a deviation"),
        ("errors.rack_pitch.u=1um", "1:7: error[usage]: `rack_pitch` has no keys to set: it is text"),
        ("errors.rack_pitch", "1:7: error[usage]: `errors.rack_pitch` has no value"),
        ("pair=2", "1:7: error[wrong-type]: `pair` is a whole number; it must be a section"),
    ] {
        let problem = set(&[setting]).expect_err(setting).to_string();
        assert!(problem.starts_with(&format!("command line:{expected}")), "{setting}: {problem}");
    }
}

#[test]
fn the_file_comes_first_and_each_option_has_a_line() {
    let settings = ["rack.helix_angle=95".to_owned(), "rack.addendum=-1".to_owned()];
    let problems = Spec::parse_with("rack.toml", "[rack]\nface_width = 0\nhelix_angle = 91", &settings);
    let places = problems.expect_err("three values are out of their domain").0;
    let places: Vec<_> = places.iter().map(ToString::to_string).collect();
    for (place, start) in places.iter().zip(["rack.toml:2:14: ", "command line:1:24: ", "command line:2:21: "]) {
        assert!(place.starts_with(start), "{place}");
    }
    assert_eq!(places.len(), 3, "{places:?}");
}

#[test]
fn no_setting_is_lost() {
    for settings in [
        ["errors.rack_pitch=1um", "errors.rack_pitch=2um"],
        ["errors.rack_pitch=1um", "errors={}"],
        ["errors.rack_pitch.u=1um", "errors.rack_pitch=2um"],
    ] {
        let settings = settings.map(str::to_owned);
        let problem = Spec::parse_with("rack.toml", "", &settings).expect_err("one of them would be lost").to_string();
        assert!(problem.contains("is set twice"), "{problem}");
    }
    assert!(set(&["errors.rack_pitch=1um", "errors.rack_pitc=2um"]).is_err());
}

#[test]
fn every_key_has_a_place_and_says_what_it_holds() {
    let keys = keys();
    assert!(keys.len() > 100, "{}", keys.len());
    for key in &keys {
        assert!(!key.holds.is_empty() && key.doc.ends_with('.'), "{key:?}");
    }
    for path in
        ["title", "rack.face_width", "rack.tip_relief.amount", "table.columns.rack_lead.length", "scatter.rack_pitch"]
    {
        assert!(keys.iter().any(|key| key.path == path), "{path}");
    }
}
