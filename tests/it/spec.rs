//! The spec's schema, template and reader agree with each other.

use std::sync::LazyLock;

use jsonschema::Validator;
use rackmesh::evaluation::{Evaluation, evaluate};
use rackmesh::formula::{Model, PartDeviation};
use rackmesh::judge::Stack;
use rackmesh::spec::{Spec, TEMPLATE, json_schema};
use serde_json::Value;

fn evaluated(spec: &Spec, errors: &[PartDeviation]) -> Evaluation {
    let basis = spec.basis().unwrap_or_else(|error| panic!("{error}"));
    evaluate(errors, &spec.limits(), Model::Exact, Stack::Range, &basis).expect("it evaluates")
}

/// A spec as the JSON that a schema-driven editor makes of it.
fn as_json(text: &str) -> Value {
    let table: toml::Table = text.parse().expect("the spec is TOML");
    serde_json::to_value(table).expect("TOML without dates is JSON")
}

static SCHEMA: LazyLock<Validator> =
    LazyLock::new(|| jsonschema::validator_for(&json_schema()).expect("the schema is a schema"));

fn valid(text: &str) -> bool {
    SCHEMA.is_valid(&as_json(text))
}

const EXAMPLES: [&str; 4] = [
    include_str!("../../examples/minimal.toml"),
    include_str!("../../examples/steering.toml"),
    include_str!("../../examples/everything.toml"),
    TEMPLATE,
];

#[test]
fn examples_and_template_evaluate_and_fit_the_schema() {
    for text in EXAMPLES {
        assert!(valid(text), "{text}");
        let spec = Spec::parse("example", text).unwrap_or_else(|error| panic!("{error}"));
        let errors = spec.part_deviations().unwrap_or_else(|error| panic!("{error}"));
        let evaluation = evaluated(&spec, &errors);
        assert!(evaluation.verdict.is_some());
    }
}

#[test]
fn the_schema_and_the_reader_refuse_the_same() {
    for text in [
        "titel = \"x\"",
        "title = 3",
        "[pair]\nnormal_module = 0",
        "[pair]\nnormal_pressure_angle = 45.1",
        "[pair]\nnormal_pressure_angle = 0",
        "[rack]\nface_width = \"20 deg\"",
        "[rack]\nface_width = true",
        "[pinion]\nteeth = 7.5",
        "[pinion]\nteeth = 0",
        "[errors]\nrack_pitch = { measured = 3 }",
        "[errors]\nrack_pitch = { measured = 3, roller = 2 }",
        "[errors]\nrack_lead = { f_h_beta = 3 }",
        "[errors]\npinion_lead = { f_h_beta = 0.008, length = 18 }",
        "[errors]\npinion_lead = \"0.05 deg\"",
        "[errors]\nrack_pitch = { class = 7, every_part = true }",
        "[errors]\nrack_pitch = { nominal = 6.28, every_part = true }",
        "[errors]\nrack_pitch = { value = 1, every_part = \"yes\" }",
        "[table]\nignore = \"Temperature\"",
        "[table]\nignore = [1]",
        "[table]\nothers = \"use\"",
        "[table.columns]\nrack_pitch = { unit = \"deg\" }",
        "[table.columns]\nrack_pitch = { unit = \"um\", length = 18 }",
        "[table.columns]\nrack_lead = { unit = \"grad\" }",
        "[table.columns]\nrack_lead = { length = 0 }",
        "[table.columns]\nrack_pitch = { extent = \"some\" }",
        "[table.columns]\nrack_over_roller = { extent = \"total\" }",
        "[table.columns]\nrack_lead = { extent = \"total\" }",
        "[table.columns]\npinion_lead = { extent = \"total\" }",
        "[table.columns]\npinion_lead = { unit = \"deg\" }",
        "[limits]\ncenter_distance = 0.05",
        "[limits]\ncenter_distance = {}",
        "[limits]\ncenter_distance = \"0.05\"",
        "[limits]\npinion_tip = \"±0.05\"",
        "[errors]\nrack_pitch = { class = 13 }",
        "[errors]\nrack_pitch = { class = 7.5 }",
        "[errors]\nrack_pitch = { class = 7, measured = 3 }",
        "[errors]\nrack_pitch = { value = 0.01, extent = \"some\" }",
        "[errors]\nrack_pitch = { value = 0.01, extent = 3 }",
        "[errors]\nrack_over_roller = { value = 0.01, extent = \"total\" }",
        "[pair]\ncontact = \"one flank\"",
        "[tolerance]\ndiameter = 0",
        "[tolerance]\ndiameter = \"rack\"",
        "[tolerance]\nstandard = 1328",
        "[budget]\nconforming = 1.5",
        "[budget]\nstack = \"range\"",
        "[budget]\nrack_pitch = { weight = 0 }",
        "[budget]\nrack_pitch = { weight = 1, cost = 1 }",
        "[budget]\nrack_pitch = \"fre\"",
        "[budget]\nrack_pitch = { weight = 1, extent = \"some\" }",
        "[budget]\nrack_lead = { cost = 1, extent = \"total\" }",
        "[budget]\nrack_pitch = { class = 7, extent = \"one\" }",
    ] {
        assert!(!valid(text), "the schema accepts {text}");
        assert!(Spec::parse("test", text).is_err(), "the reader accepts {text}");
    }
}

#[test]
fn the_schema_and_the_reader_accept_the_same() {
    for text in [
        "[rack]\nface_width = \"1.97 cm\"",
        "[rack]\nface_width = \"0.5″\"",
        "[rack]\nface_width = \"19.7 MM\"",
        "[limits]\ncenter_distance = \"±5 thou\"",
        "[errors]\nrack_pitch = { value = \"12 microns\", every_part = true }",
        "[errors]\nrack_lead = { f_h_beta = 0.008, length = 18, u = 0.001, every_part = false }",
        "[errors]\nrack_pitch = { value = 0.01, extent = \"total\" }\npinion_radial = { extent = \"part\" }",
        "[pair]\ncontact = \"both flanks\"",
        "[table]\nignore = [\"Temperature*\", \"remark\"]\nothers = \"ignore\"",
        "[table.columns]\nrack_pitch = { unit = \"micron\" }\nrack_lead = { unit = \"um\", length = \"18 mm\" }",
        "[table.columns]\nrack_lead = { unit = \"gon\" }",
        "[table.columns]\nrack_pitch = { extent = \"total\" }\npinion_lead = { extent = \"each\" }",
        "[table.columns]\nrack_over_roller = { extent = \"all\" }\nrack_lead = { extent = \"one\" }",
        "[errors]\npinion_lead = \"8 um\"",
        "[errors]\npinion_lead = { measured = 0.009, nominal = 0.001, u = \"1 um\", every_part = true }",
        "[errors]\npinion_lead = { class = 7 }",
        "[limits]\npinion_lead = \"±10 um\"",
        "[budget]\npinion_lead = { weight = 2 }",
        "[budget]\nrack_pitch = { weight = 2, extent = \"total\" }\nrack_lead = { cost = 2, extent = \"one\" }",
        "[budget]\nrack_pitch = { value = \"8 um\", extent = \"one\" }\npinion_radial = { extent = \"all\" }",
        "[table.columns]\npinion_lead = { name = \"fHb\", unit = \"um\", nominal = 0.001 }",
        "[scatter]\npinion_lead = \"3 um\"",
    ] {
        assert!(valid(text), "the schema refuses {text}");
        assert!(Spec::parse("test", text).is_ok(), "the reader refuses {text}");
    }
}

#[test]
fn the_full_example_names_every_key() {
    let uncommented: String = EXAMPLES[2].lines().map(|line| line.trim_start_matches('#').to_owned() + "\n").collect();
    for (section, schema) in json_schema()["properties"].as_object().expect("properties") {
        for key in schema["properties"].as_object().into_iter().flatten().map(|(key, _)| key) {
            let written = match key.as_str() {
                "deviation" => format!("\n[[{section}.deviation]]"),
                _ => format!("\n{key} = "),
            };
            // limits repeat the errors' names
            assert!(section == "limits" || uncommented.contains(&written), "{section}.{key}");
        }
    }
}

#[test]
fn the_template_is_short_and_names_its_schema() {
    assert!(TEMPLATE.lines().count() <= 60);
    assert!(TEMPLATE.starts_with("#:schema rackmesh.schema.json\n"));
}

/// Every spec below these folders.
fn corpus() -> Vec<String> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders: Vec<_> =
        ["examples", "tests/specs", "tests/tables", "tests/reference"].map(|folder| root.join(folder)).into();
    let mut texts = vec![TEMPLATE.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "toml") {
                texts.push(std::fs::read_to_string(path).expect("a file"));
            }
        }
    }
    texts
}

/// Every place of a table: the keys and indices that lead there.
fn places(value: &toml::Value, above: &[String], found: &mut Vec<Vec<String>>) {
    let inner: Vec<(String, &toml::Value)> = match value {
        toml::Value::Table(table) => table.iter().map(|(key, value)| (key.clone(), value)).collect(),
        toml::Value::Array(list) => list.iter().enumerate().map(|(at, value)| (at.to_string(), value)).collect(),
        _ => Vec::new(),
    };
    for (name, value) in inner {
        let place = [above, &[name]].concat();
        places(value, &place, found);
        found.push(place);
    }
}

fn at<'a>(mut value: &'a mut toml::Value, place: &[String]) -> &'a mut toml::Value {
    for name in place {
        value = match value {
            toml::Value::Array(list) => &mut list[name.parse::<usize>().expect("an index")],
            inner => inner.get_mut(name).expect("a key"),
        };
    }
    value
}

/// What the reader takes, the schema accepts; a key that is misspelt and a value of another type both refuse, in every
/// place of every spec.
#[test]
fn the_schema_and_the_reader_agree_on_every_spec() {
    let accepts =
        |spec: &toml::Value| SCHEMA.is_valid(&serde_json::to_value(spec).expect("TOML without dates is JSON"));
    let mut tried = 0;
    for text in corpus() {
        let Ok(table) = text.parse::<toml::Table>() else { continue };
        // a section by its old name is read with a warning, and an editor marks it
        if table.contains_key("batch") || Spec::parse("corpus", &text).is_err() {
            continue;
        }
        let spec = toml::Value::Table(table);
        assert!(accepts(&spec), "the schema refuses {text}");
        let mut found = Vec::new();
        places(&spec, &[], &mut found);
        for place in found {
            let (last, above) = place.split_last().expect("a place has a name");
            let mut misspelt = spec.clone();
            if let toml::Value::Table(table) = at(&mut misspelt, above) {
                let value = table.remove(last).expect("a key");
                table.insert(format!("{last}x"), value);
            }
            let mut mistyped = spec.clone();
            *at(&mut mistyped, &place) = toml::Value::Array(vec![toml::Value::Array(Vec::new())]);
            for changed in [misspelt, mistyped] {
                let written = toml::to_string(&changed).expect("it can be written");
                if changed != spec {
                    tried += 1;
                    let is_read = Spec::parse("corpus", &written).is_ok();
                    assert!(!is_read, "the reader accepts {place:?} of\n{written}");
                    assert!(!accepts(&changed), "the schema accepts {place:?} of\n{written}");
                }
            }
        }
    }
    assert!(tried > 1000, "{tried} changes");
}

/// 12 µm at α_n = 20°, β_p = 25°, and what a class permits of it: by cos β_b / (2 sin α_n) = 1.3417 in both models.
#[test]
fn a_lead_of_the_pinion_is_a_length() {
    let with = |entry: &str| {
        let text = format!(
            "[pair]\nnormal_module = 1.9\nnormal_pressure_angle = 20\n[pinion]\nteeth = 7\nhelix_angle = 25\n\
             face_width = 30\n[tolerance]\nstandard = \"iso1328-1:1995\"\n[errors]\npinion_lead = {entry}\n"
        );
        let spec = Spec::parse("lead", &text).unwrap_or_else(|error| panic!("{error}"));
        let errors = spec.part_deviations().unwrap_or_else(|error| panic!("{error}"));
        let [error] = errors[..] else { panic!("{errors:?}") };
        [Model::Exact, Model::Paper].map(|model| {
            let delta_cd = error.delta_cd(model).expect("it has a ΔCD").mm();
            delta_cd / error.value().abs().base()
        })
    };
    for entry in ["\"-12 um\"", "{ value = 0.012 }", "{ measured = 0.013, nominal = 0.001 }", "{ class = 7 }"] {
        for gain in with(entry) {
            assert!((gain - 1.341_678).abs() < 1e-6, "{entry}: {gain}");
        }
    }
}

#[test]
fn a_lead_of_the_pinion_needs_a_pressure_angle_only() {
    let spec = Spec::parse("lead", "[errors]\npinion_lead = \"8 um\"").expect("it parses");
    let problem = spec.part_deviations().expect_err("a key is missing").to_string();
    assert!(problem.contains("`pair.normal_pressure_angle` is missing; `pinion_lead` needs it"), "{problem}");
    let text = "[pair]\nnormal_pressure_angle = { value = 20, u = 0.02 }\n[pinion]\nhelix_angle = { value = 25, u = 0.01 }\n\
                [errors]\npinion_lead = { value = \"8 um\", u = \"1 um\" }";
    let spec = Spec::parse("lead", text).expect("it parses");
    let uncertain = spec.uncertainties().expect("they are consistent");
    let sources: Vec<_> = uncertain.inputs().iter().map(|(source, _)| source.key()).collect();
    assert_eq!(sources.len(), 3, "{sources:?}");
    for key in ["errors.pinion_lead", "pair.normal_pressure_angle", "pinion.helix_angle"] {
        assert!(sources.contains(&key), "{sources:?}");
    }
}

#[test]
fn digits_are_taken_from_the_text() {
    let spec = Spec::parse(
        "digits",
        "[errors]\nrack_over_roller = { measured = 25.000000000001000000000000001, nominal = 25.000000000000 }",
    )
    .expect("it parses");
    let errors = spec.part_deviations().expect("it resolves");
    let evaluation = evaluated(&spec, &errors);
    assert_eq!(evaluation.contributions[0].exact.mm(), 1e-12);
}

#[test]
fn every_spelling_of_a_limit() {
    for (limit, verdict_at_20_um) in [
        ("\"±0.02\"", true),
        ("\"+-20 um\"", true),
        ("\"+/- 0.02 mm\"", true),
        ("{ lower = -0.02, upper = 0.02 }", true),
        ("{ upper = \"20 um\" }", true),
        ("{ lower = 0.0200000001 }", false),
        ("\"±0.019999999999\"", false),
    ] {
        let text = format!("[errors]\nrack_over_roller = \"20 um\"\n[limits]\ncenter_distance = {limit}");
        let spec = Spec::parse("limit", &text).unwrap_or_else(|error| panic!("{error}"));
        let errors = spec.part_deviations().expect("it resolves");
        let evaluation = evaluated(&spec, &errors);
        let passes = evaluation.verdict.map(|verdict| verdict.name() == "pass");
        assert_eq!(passes, Some(verdict_at_20_um), "{limit}");
    }
}
