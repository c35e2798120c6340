//! The command line's vocabulary: what a flag means, which values it takes, how long a help is, and that the commands of
//! the help run one after the other.

use std::any::TypeId;
use std::collections::{BTreeMap, BTreeSet};

use clap::{Arg, Command};
use rackmesh::quantity::{Angle, Length};

use crate::process::{Folder, run};

/// A subcommand of any depth with its name, `calc` standing for the formulas below it.
struct Named {
    name: String,
    command: Command,
}

/// Every subcommand but clap's own `help`.
fn commands() -> Vec<Named> {
    let mut root = rackmesh::cli::command();
    root.build();
    let mut found = Vec::new();
    for top in root.get_subcommands().filter(|command| command.get_name() != "help") {
        let below = top.get_subcommands().filter(|command| command.get_name() != "help");
        let name = top.get_name().to_owned();
        found.extend(below.map(|command| Named { name: name.clone(), command: command.clone() }));
        found.push(Named { name, command: top.clone() });
    }
    found
}

fn meaning(arg: &Arg) -> String {
    let help = arg.get_help().unwrap_or_else(|| panic!("--{} says nothing", arg.get_id()));
    help.to_string()
}

/// What the commands together say of one flag.
#[derive(Default)]
struct Flag {
    shorts: BTreeSet<char>,
    meanings: BTreeSet<String>,
}

fn flags() -> BTreeMap<String, Flag> {
    let mut flags: BTreeMap<String, Flag> = BTreeMap::new();
    for Named { name, command } in commands() {
        for arg in command.get_arguments().filter(|arg| !arg.is_positional()) {
            let long = arg.get_long().unwrap_or_else(|| panic!("{name}: {} has no long name", arg.get_id()));
            let flag = flags.entry(long.to_owned()).or_default();
            flag.shorts.extend(arg.get_short());
            flag.meanings.insert(meaning(arg));
        }
    }
    flags
}

#[test]
fn a_flag_means_one_thing_and_has_one_short_letter() {
    let mut of_short: BTreeMap<char, String> = BTreeMap::new();
    for (long, flag) in flags() {
        assert_eq!(flag.meanings.len(), 1, "--{long}: {:?}", flag.meanings);
        assert!(flag.shorts.len() <= 1, "--{long}: {:?}", flag.shorts);
        for short in flag.shorts {
            let other = of_short.insert(short, long.clone());
            assert_eq!(other, None, "-{short}");
        }
    }
    for (short, long) in [('o', "output"), ('f', "format"), ('q', "quiet"), ('j', "threads")] {
        assert_eq!(of_short.get(&short).map(String::as_str), Some(long));
    }
}

#[test]
fn a_flag_with_a_short_letter_has_it_in_every_command() {
    let flags = flags();
    for Named { name, command } in commands() {
        for arg in command.get_arguments().filter(|arg| !arg.is_positional()) {
            let short = arg.get_long().and_then(|long| flags[long].shorts.first().copied());
            assert_eq!(arg.get_short(), short, "{name}: {}", arg.get_id());
        }
    }
}

#[test]
fn every_option_that_takes_a_quantity_takes_a_negative_one() {
    // written as text, because their unit depends on what is asked
    const TEXT: [&str; 3] = ["value", "measured", "nominal"];
    let mut quantities = 0;
    for Named { name, command } in commands() {
        for arg in command.get_arguments() {
            let parsed = arg.get_value_parser().type_id();
            let is_quantity = parsed == TypeId::of::<Length>()
                || parsed == TypeId::of::<Angle>()
                || matches!(arg.get_value_names(), Some([only]) if *only == "LENGTH" || *only == "ANGLE")
                || name == "calc" && TEXT.contains(&arg.get_id().as_str());
            if is_quantity {
                quantities += 1;
                assert!(arg.is_allow_hyphen_values_set(), "{name} {}", arg.get_id());
            }
        }
    }
    assert!(quantities > 30, "only {quantities} are found");
}

#[test]
fn negative_quantities_are_values_and_no_flags() {
    for (arguments, shown) in [
        (&["calc", "rack-pitch", "-12um", "--pressure-angle", "20"][..], "0.01648"),
        (&["calc", "pitch", "12um", "--pressure-angle", "20", "--helix-angle", "-20"], "mm"),
        (&["calc", "radial", "--measured", "-8.5", "--nominal", "-8.4"], "-0.1"),
    ] {
        let ended = run(arguments, "");
        assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stdout.contains(shown), "{arguments:?}: {}", ended.stdout);
    }
    // refused for what it is
    let ended = run(&["calc", "pin", "--normal-module", "-2", "--pressure-angle", "20"], "");
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("error[out-of-domain]"), "{}", ended.stderr);
}

#[test]
fn the_short_help_fits_a_screen_and_the_long_one_has_all_and_an_example() {
    for Named { name, command } in commands() {
        let path = if command.get_name() == name { name } else { format!("{name} {}", command.get_name()) };
        let words: Vec<&str> = path.split(' ').collect();
        let [short, long] = ["-h", "--help"].map(|flag| run(&[&words[..], &[flag]].concat(), "").stdout);
        assert!(short.lines().count() <= 40, "{path}: {} lines", short.lines().count());
        assert!(short.contains("--help has all of it"), "{short}");
        let flags = |help: &str| help.matches("\n      --").count() + help.matches(", --").count();
        assert!(flags(&long) > flags(&short), "{path}: {long}");
        assert!(long.contains(&format!("  rackmesh {path}")), "{path}: {long}");
    }
}

/// A word that is nearly one that the program knows is answered with that, and with the way to it.
#[test]
fn what_is_misspelt_names_the_nearest() {
    let rack = "[errors]\nrack_over_roller = 0.01\n";
    for (arguments, nearest) in [
        (&["evl"][..], "'eval'"),
        (&["eval", "-", "--stak", "rss"], "'--stack'"),
        (&["eval", "-", "--stack", "rs"], "'rss'"),
        (&["eval", "-", "--set", "normal_pressure_angle=25"], "`pair.normal_pressure_angle`"),
        (&["eval", "-", "--set", "normal_presure_angle=25"], "`pair.normal_pressure_angle`"),
        (&["eval", "-", "--set", "pair.face_width=25"], "`rack.face_width` or `pinion.face_width`"),
        (&["eval", "-", "--set", "pitch=25um"], "`errors.rack_pitch` or `errors.pinion_pitch`"),
        (&["simulate", "-", "--preload", "2000"], "--set simulation.preload=2000"),
        (&["explain", "rack-pich"], "`rack-pitch`"),
        (&["explain", "rack.face_widht"], "`rack.face_width`"),
    ] {
        let ended = run(arguments, rack);
        assert!(ended.code == Some(2) && ended.stderr.contains(nearest), "{arguments:?}: {}", ended.stderr);
    }
}

#[test]
fn a_class_asks_for_everything_at_once() {
    for (arguments, options) in [
        (&[][..], &["--standard", "--grade", "--normal-module", "--diameter", "--face-width"][..]),
        (&["--grade", "7"], &["--standard", "--normal-module", "--diameter", "--face-width"]),
        (&["--grade", "7", "--standard", "iso1328-1:1995"], &["--normal-module", "--diameter", "--face-width"]),
    ] {
        let ended = run(&[&["class"], arguments].concat(), "");
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stderr);
        assert!(options.iter().all(|option| ended.stderr.contains(option)), "{arguments:?}: {}", ended.stderr);
    }
}

#[test]
fn the_schema_is_small() {
    assert!(run(&["schema"], "").stdout.len() <= 40_000);
}

#[test]
fn shells_complete_topics_and_standards() {
    let script = run(&["completions", "bash"], "").stdout;
    for word in ["rack-pitch", "pair.normal_module", "iso1328-1:1995"] {
        assert!(script.contains(word), "{word}");
    }
}

#[test]
fn commands_that_sound_alike_are_told_apart_in_their_first_line() {
    let help = run(&["--help"], "").stdout;
    for (command, word) in
        [("simulate", "forces"), ("mesh", "no forces"), ("monte-carlo", "random racks"), ("measure", "virtually")]
    {
        assert!(help.lines().any(|line| line.trim_start().starts_with(command) && line.contains(word)), "{command}");
        let first = run(&[command, "--help"], "").stdout.lines().next().unwrap_or_default().to_owned();
        assert!(first.contains(word), "{command}: {first}");
    }
    assert!(run(&["eval", "--help"], "").stdout.contains("Uncertainty of ΔCD by simulation"));
    let about = help.split_once("About the method:").expect("there is such a part of the help").1;
    assert!(about.contains("  reproduce  "));
    for Named { name, .. } in commands() {
        assert!(help.contains(&format!("  {name}")), "{name}");
    }
}

#[test]
fn the_commands_of_the_help_run_one_after_the_other() {
    let folder = Folder::new("first-steps");
    let spec = folder.path("rack.toml");
    let help = run(&["--help"], "").stdout;
    let examples = help.split_once("Examples:").expect("the help has examples").1;
    let mut seen = BTreeSet::new();
    for line in examples.lines().filter_map(|line| line.trim().strip_prefix("rackmesh ")) {
        // what a command does stands behind it
        let line = line.split("   ").next().unwrap_or_default();
        let (line, written) = line.split_once(" > ").map_or((line, None), |(line, file)| (line, Some(file)));
        let path = |word: &str| if word == "rack.toml" { spec.clone() } else { word.to_owned() };
        let arguments: Vec<String> = line.split_whitespace().map(path).collect();
        let ended = run(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), "");
        assert!(matches!(ended.code, Some(0 | 1)), "{line}: {}", ended.stderr);
        assert!(!ended.stderr.contains("error["), "{line}: {}", ended.stderr);
        if let Some(file) = written {
            std::fs::write(path(file), ended.stdout).expect("the file can be written");
        }
        seen.extend(arguments.into_iter().next());
    }
    for command in ["init", "eval", "mesh", "simulate", "monte-carlo", "calc", "explain"] {
        assert!(seen.contains(command), "the help does not begin with {command}");
    }
}

#[test]
fn a_quiet_command_leaves_out_remarks_and_no_warning() {
    let calc = ["calc", "pitch", "20um", "--pressure-angle", "20"];
    let (told, quiet) = (run(&calc, ""), run(&[&calc[..], &["-q"]].concat(), ""));
    assert_eq!((told.code, &told.stdout), (quiet.code, &quiet.stdout));
    assert!(told.stderr.contains("model: exact") && quiet.stderr.is_empty(), "{}", quiet.stderr);
    let spec = "[errors]\nrack_over_roller = 0.01\n[limits]\nrack_pitch = \"±0.02\"\n";
    let warned = run(&["eval", "-", "-q"], spec);
    assert!(warned.code == Some(2) && warned.stderr.contains("warning"), "{}", warned.stderr);
    let failed = run(&["eval", "no-such-file.toml", "--quiet"], "");
    assert!(failed.code == Some(2) && failed.stderr.contains("error"), "{}", failed.stderr);
}

#[test]
fn a_pasted_part_is_not_called_as_the_spec_is() {
    let folder = Folder::new("pasted-name");
    let (spec, values) = (folder.path("spec.toml"), folder.path("values.txt"));
    std::fs::write(&spec, "title = \"steering rack\"\n[limits]\ncenter_distance = \"±0.05\"\n").unwrap();
    std::fs::write(&values, "rack_over_roller\t0.01\n").unwrap();
    let by_file = run(&["paste", &spec, &values, "-f", "json"], "").json();
    assert_eq!(by_file["title"], "values.txt", "{by_file}");
    let from_input = run(&["paste", &spec, "-f", "json"], "rack_over_roller\t0.01\n").json();
    assert_eq!(from_input["title"], "pasted part", "{from_input}");
}

/// The largest error of the worst case, put back, uses up the ΔCD that was asked of, and no more.
#[test]
fn an_inverse_says_what_the_worst_case_leaves() {
    let (lead, angles) = (["--face-width", "19.7"], ["--pressure-angle", "19.9", "--helix-angle", "12"]);
    let of_lead = [&lead[..], &angles[..]].concat();
    for (formula, gear, extents) in [
        ("over-roller", &[][..], &["all", "each", "one"][..]),
        ("radial", &[], &["all", "part"]),
        ("pitch", &angles, &["one"]),
        ("pinion-pitch", &angles, &["one"]),
        ("pinion-lead", &angles, &["all", "each"]),
        ("lead", &of_lead, &["all", "each", "one"]),
    ] {
        for extent in extents {
            let ask = |question: &[&str]| {
                let ended =
                    run(&[&["calc", formula], question, gear, &["--extent", extent, "-f", "json"]].concat(), "");
                if ended.code == Some(0) { ended.json() } else { panic!("{formula}: {}", ended.stderr) }
            };
            let answer = ask(&["--inverse", "0.05"]);
            let (key, unit) = if formula == "lead" { ("deg", "deg") } else { ("mm", "mm") };
            let value = |name: &str| answer[format!("{name}_{key}")].as_f64().expect("a number");
            let largest = value("worst_case_value");
            assert!(largest <= value("value") && largest > 0.9 * value("value"), "{formula} {extent}: {answer}");
            let farthest = |error: f64| {
                let range = &ask(&[&format!("{error}{unit}")])["range_mm"];
                let end = |name: &str| range[name].as_f64().expect("a number").abs();
                end("lower").max(end("upper"))
            };
            let either = |error: f64| farthest(error).max(farthest(-error));
            assert!(either(largest) <= 0.05 && either(largest * 1.000_001) > 0.05, "{formula} {extent}: {answer}");
        }
    }
    let open = run(&["calc", "pitch", "--inverse", "0.05", "--pressure-angle", "20", "--extent", "all"], "");
    assert_eq!((open.code, open.stdout.as_str()), (Some(2), "0.036397 mm\n"));
    assert!(open.stderr.contains("worst case: open (every pitch)"), "{}", open.stderr);
}

#[test]
fn a_block_of_more_parts_than_are_shown_is_refused() {
    let folder = Folder::new("pasted-many");
    let (spec, values) = (folder.path("spec.toml"), folder.path("values.csv"));
    std::fs::write(&spec, "[limits]\ncenter_distance = \"±0.05\"\n").unwrap();
    for (parts, code) in [(20_000, Some(0)), (20_001, Some(2))] {
        std::fs::write(&values, format!("rack_over_roller\n{}", "0.01\n".repeat(parts))).unwrap();
        let ended = run(&["paste", &spec, &values, "-f", "json"], "");
        assert_eq!(ended.code, code, "{parts}: {}", ended.stderr);
        assert_eq!(ended.stderr.contains("more than 20000 parts"), code == Some(2), "{}", ended.stderr);
    }
}

#[test]
fn a_page_of_measured_parts_is_named_by_their_table_and_by_what_is_set() {
    const LAYOUT: &str = "[table.columns]\npart_id = \"Teil\"\ninspector = \"Who\"\n\
                          rack_over_roller = { name = \"M\", unit = \"mm\", nominal = 25 }\n";
    const REPORT: &str = "[report]\npart = \"0417\"\ninspector = \"Weber\"\norder = \"A-77\"\n";
    let folder = Folder::new("page-names");
    let [spec, table, page] = ["spec.toml", "lot.csv", "page.html"].map(|name| folder.path(name));
    std::fs::write(&spec, format!("{REPORT}[limits]\ncenter_distance = \"±0.05\"\n{LAYOUT}")).unwrap();
    let line = ["report", &spec, &table, "-o", &page, "--partial"];
    for rows in ["0419;25.002;Frey\n", "0419;25.002;Frey\n0420;25.001;Frey\n"] {
        std::fs::write(&table, format!("Teil;M;Who\n{rows}")).unwrap();
        for (set, has) in [(&[][..], false), (&["--set", "report.part=0417", "--set", "report.inspector=Weber"], true)]
        {
            let ended = run(&[&line, set].concat(), "");
            assert_eq!(ended.code, Some(0), "{}", ended.stderr);
            let html = std::fs::read_to_string(&page).unwrap();
            let head = html.split("<pre").next().unwrap();
            assert_eq!(head.contains("0417") && head.contains("Weber"), has, "{rows}: {head}");
            assert!(head.contains("0419") && head.contains("A-77"), "{rows}: {head}");
        }
    }
}

#[test]
fn a_part_that_is_there_twice_is_what_junit_and_the_last_line_say() {
    let folder = Folder::new("twice");
    let [spec, table, junit] = ["spec.toml", "lot.csv", "parts.xml"].map(|name| folder.path(name));
    std::fs::write(&spec, "[limits]\ncenter_distance = \"±0.05\"\n").unwrap();
    std::fs::write(&table, "part_id,rack_over_roller\nP1,0.01\nP2,0.01\nP1,0.01\n").unwrap();
    let ended = run(&["batch", &spec, &table, "--junit", &junit, "-f", "csv"], "");
    assert_eq!((ended.code, ended.stdout.lines().count()), (Some(2), 4), "{}", ended.stderr);
    assert!(!ended.stderr.contains("ends here"), "every row was read: {}", ended.stderr);
    assert!(ended.stderr.contains("3 rows: 3 pass, 0 fail, but part `P1` is there twice\n"), "{}", ended.stderr);
    let report = std::fs::read_to_string(&junit).unwrap();
    assert!(report.contains("part `P1` is there twice") && !report.contains("not read to its end"), "{report}");
}

#[test]
fn decimals_beyond_those_of_a_length_are_zeros() {
    let ended = run(&["calc", "radial", "4um", "--decimals", "30"], "");
    assert_eq!(ended.stdout, format!("0.004{} mm\n", "0".repeat(27)));
}

#[test]
fn a_key_of_a_value_that_is_no_table_is_refused_with_what_to_write() {
    let spec = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = \"+12 um\"\n";
    let ended = run(&["eval", "-", "--set", "errors.rack_pitch.extent=each"], spec);
    let written = "errors.rack_pitch={ value = \"12um\", extent = \"part\" }";
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains(&written.replace("part", "each")), "{}", ended.stderr);
    assert!(run(&["eval", "-", "--set", written], spec).stderr.is_empty());
}
