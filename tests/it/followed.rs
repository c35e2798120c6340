//! What a refusal proposes can be followed: whoever does what it says gets a verdict, or a shorter list.

use std::path::Path;

use crate::process::Folder;
use crate::proposals::{SPEC, status};

/// What a refusal says: how many things have no owner, the `[table]` that closes them, and the help.
fn refused(said: &str) -> Option<(usize, String, String)> {
    let (_, rest) = said.split_once("error[not-understood]: ")?;
    let (list, help) = rest.split_once("\n = help: ")?;
    let (list, block) = list.split_once("what closes the table, in the spec:\n").unwrap_or((list, ""));
    let block: String = block.lines().flat_map(|line| [line.trim(), "\n"]).collect();
    Some((list.trim_end().lines().count() - 1, block, help.split_whitespace().collect::<Vec<_>>().join(" ")))
}

/// The contracts that a person makes of a proposal: each choice by itself, or the whole if there is none.
fn followed(block: &str) -> Vec<String> {
    let is_choice = |line: &&str| line.starts_with("# ") && !line.ends_with(':') && !line.contains("\"…\"");
    let choices: Vec<&str> = block.lines().filter(is_choice).collect();
    if choices.is_empty() {
        return vec![block.to_owned()];
    }
    choices.into_iter().map(|choice| block.replacen(choice, &choice[2..], 1)).collect()
}

/// Follows every proposal for a file to its end: a verdict, or fewer things without an owner or others each time.
fn follow(folder: &Folder, (spec, text): (&str, &str), command: &[&str], options: &[String], depth: usize) {
    const DEEPEST: usize = 6;
    let (_, said) = status(&[command, &options.iter().map(String::as_str).collect::<Vec<_>>()].concat());
    let Some((count, block, help)) = refused(&said) else { return };
    assert!(depth < DEEPEST, "{said}");
    let smaller = |options: &[String]| {
        let (_, next) = status(&[command, &options.iter().map(String::as_str).collect::<Vec<_>>()].concat());
        let is_smaller = refused(&next).is_none_or(|(left, other, _)| left < count || other != block);
        assert!(is_smaller, "{command:?} {options:?}\n{said}\nthen\n{next}");
    };
    if let Some((before, headings)) = help.split_once("--as '").filter(|_| options.is_empty()) {
        let headings = headings.split('\'').next().unwrap().to_owned();
        let mut options = vec!["--as".to_owned(), headings];
        options.extend(
            before.contains("--separator ' '").then(|| ["--separator", " "].map(str::to_owned)).into_iter().flatten(),
        );
        let (_, next) = status(&[command, &options.iter().map(String::as_str).collect::<Vec<_>>()].concat());
        assert!(!next.contains("values stand there without headings"), "{said}\nthen\n{next}");
        return follow(folder, (spec, text), command, &options, depth + 1);
    }
    if help.contains("give them as a table: ") {
        return;
    }
    assert!(block.lines().count() > 1, "nothing is proposed: {said}");
    for contract in followed(&block) {
        let own = text.split("\n[table]").next().unwrap();
        let next = format!("{own}\n{contract}");
        folder.file(spec, &next);
        smaller(options);
        follow(folder, (spec, &next), command, options, depth + 1);
        folder.file(spec, text);
    }
}

/// Whoever does what a refusal says gets a verdict, or a smaller list: for what fresh users sent, and for the corpus.
#[test]
fn every_proposal_can_be_followed() {
    const STEERING: &str = "[pair]\nnormal_module = 1.9\nnormal_pressure_angle = 20\n[rack]\nface_width = 19.7\n[errors]\n\
                            rack_over_roller = { nominal = 25 }\nrack_pitch = \"+12 um\"\n\
                            rack_lead = { f_h_beta = \"8 um\", length = 18 }\n[limits]\ncenter_distance = \"±0.5\"\n";
    let folder = Folder::new("proposals-followed");
    let spec = folder.file("rack.toml", STEERING);
    for (at, table) in [
        "Rollenmaß [mm]\tTeilung [µm]\n25,011\t14,5\n",
        "25,011\t14,5\n",
        "25.011 14.5\n",
        "rack_over_roller 25.011 mm\nrack_pitch 14.5 um\n",
        "M [mm];Teilung [µm]\n25,011;14,5\n",
        "Teil;M [mm];Teilung [µm];Temp [°C]\nP1;25,011;14,5;20,1\nP2;25,012;3,5;20,2\n",
        "Rollenmaß [mm];Teilungsabweichung Zahnstange [µm];Schrägungswinkel\n25,011;14,5;3\n",
    ]
    .into_iter()
    .enumerate()
    {
        let file = folder.file(&format!("lot{at}.csv"), table);
        follow(&folder, ("rack.toml", STEERING), &["paste", &spec, &file], &[], 0);
    }
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables");
    let manifest: toml::Table = std::fs::read_to_string(corpus.join("cases.toml")).unwrap().parse().unwrap();
    let text = |case: &toml::Value, key: &str| case.get(key).and_then(toml::Value::as_str).map(str::to_owned);
    let is_open = |case: &&toml::Value| {
        text(case, "outcome").is_some_and(|outcome| outcome == "needs")
            && text(case, "command").is_some_and(|command| ["batch", "paste"].contains(&&*command))
            && case.get("options").is_none()
            && case.get("more").is_none()
    };
    let step = if std::env::var_os("RACKMESH_LONG_TESTS").is_some() { 1 } else { 16 };
    for case in manifest["case"].as_array().unwrap().iter().filter(is_open).step_by(step) {
        let Some(file) = text(case, "file") else { continue };
        let spec_text = std::fs::read_to_string(corpus.join(text(case, "spec").unwrap())).unwrap();
        if spec_text.contains("[table") || spec_text.contains("[batch") {
            continue;
        }
        folder.file("rack.toml", &spec_text);
        let file = corpus.join(file).display().to_string();
        follow(&folder, ("rack.toml", &spec_text), &[&*text(case, "command").unwrap(), &spec, &file], &[], 0);
    }
}

/// The proposals say what a column can be, by its numbers and its unit.
#[test]
fn columns_are_proposed_as_what_they_can_be() {
    let folder = Folder::new("proposals-kinds");
    let text = SPEC.replace("[limits]", "rack_lead = { f_h_beta = \"8 um\", length = 18 }\n[limits]");
    let spec = folder.file("rack.toml", &text);
    let said = |table: &str, options: &[&str]| {
        let file = folder.file("a.csv", table);
        let (code, said) = status(&[&["batch", &spec, &file][..], options].concat());
        assert_eq!(code, 2, "{said}");
        said
    };
    let unit = said("Rollenmaß [mm]\tTeilung [µm]\n25,011\t14,5\n", &[]);
    assert!(
        !unit.contains("part_id") && unit.contains("  # rack_pitch = { name = \"Teilung\", unit = \"µm\" }\n"),
        "{unit}"
    );
    assert!(unit.contains("  # \"Teilung [µm]\",\n"), "{unit}");
    let mark = said("25,011\t14,5\n", &["--as", "rack_over_roller[mm],rack_pitch[um]", "--decimal", "comma"]);
    assert!(!mark.contains("not-understood"), "{mark}");
    let separators = said("25,011\t14,5\n", &["--as", "rack_over_roller[mm],rack_pitch[um]"]);
    assert!(separators.contains("  # separator = \"tab\"\n  # separator = \",\"\n"), "{separators}");
    let own = said("M [mm];Teilung [µm]\n25,011;14,5\n", &[]);
    assert!(
        own.contains("  rack_over_roller = { name = \"M\", unit = \"mm\" }\n") && !own.contains("\"M [mm]\""),
        "{own}"
    );
    let blanks = said("25.011 14.5\n", &[]);
    assert!(blanks.contains("--separator ' ' --as 'rack_over_roller[mm],rack_pitch[um]'"), "{blanks}");
    let lines = said("rack_over_roller 25.011 mm\nrack_pitch 14.5 um\n", &[]);
    assert!(lines.contains("`rack_over_roller [mm];rack_pitch [um]`") && !lines.contains("ignore"), "{lines}");
}

/// A measured curve whose headings are not known is closed by the lines that its refusal shows, and `read` knows those of known ones.
#[test]
fn a_curve_is_closed_by_its_roles() {
    let folder = Folder::new("proposals-curve");
    let example = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).display().to_string();
    let (master, trace) = (example("master.toml"), example("trace.csv"));
    let text = std::fs::read_to_string(&master).unwrap();
    let curve = std::fs::read_to_string(&trace).unwrap();
    let (_, rows) = curve.split_once('\n').unwrap();
    let (spec, file) =
        (folder.file("master.toml", &text), folder.file("trace.csv", format!("Hub [mm];Achsabstand [um]\n{rows}")));
    let (code, said) = status(&["mesh", &spec, "--measured", &file]);
    let (_, block, help) = refused(&said).unwrap();
    assert!(code == 2 && !help.contains("rackmesh read") && !block.contains("ignore"), "{said}");
    folder.file("master.toml", format!("{text}\n{block}"));
    assert_eq!(status(&["mesh", &spec, "--measured", &file]).0, 0, "{block}");
    folder.file("master.toml", &text);
    let column = ["--column", "delta_cd=Achsabstand[um]"];
    assert_eq!(status(&[&["mesh", &spec, "--measured", &file][..], &column].concat()).0, 0);
    let bare = folder.file("bare.csv", rows);
    let (_, said) = status(&["mesh", &spec, "--measured", &bare]);
    assert!(said.contains("--as 'stroke[mm],delta_cd[um]'"), "{said}");
    let (code, said) = status(&["read", &trace, &spec]);
    assert!(code == 0 && said.contains("delta_cd = { name = \"ΔCD\", unit = \"µm\" }"), "{said}");
}
