//! A part that the status of its row rejects fails, whatever its values are and whatever its rows stand for.

use crate::process::{Ended, Folder, run};

const SPEC: &str =
    "[pair]\nnormal_module = 1.9\nnormal_pressure_angle = 20\n[errors]\nrack_over_roller = { nominal = 25.0 }\n";
const TOOTHED: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n[rack]\nface_width = 19.7\naddendum = 1.7\n\
    [pinion]\nteeth = 8\nhelix_angle = 21\nprofile_shift = 0.3\nface_width = 30\ntip_diameter = 19.738\n";
const LIMIT: &str = "[limits]\ncenter_distance = \"±0.1\"\n";
const STATUS: &str = "[table.columns]\nstatus = { name = \"Bewertung\", accept = [\"i.O.\"], reject = [\"n.i.O.\"] }\n";
const WHY: &str = "the table says that the part fails by its status";

/// Twelve spaces without a deviation; the status of the space with this number is another one.
fn spaces(rejected: i64) -> String {
    let row = |space| format!("{space};0;0;{}\n", if space == rejected { "n.i.O." } else { "i.O." });
    "space;over_pin_deviation [um];position_deviation [um];Bewertung\n".to_owned()
        + &(0..12).map(row).collect::<String>()
}

/// The commands that judge a file, each with what it says.
fn judged(folder: &Folder, spec: &str, table: &str, commands: &[&[&str]]) -> Vec<Ended> {
    let (spec_path, table_path) = (folder.path("spec.toml"), folder.path("table.csv"));
    std::fs::write(&spec_path, spec).unwrap();
    std::fs::write(&table_path, table).unwrap();
    commands.iter().map(|args| run(&[&args[..1], &[&spec_path, &table_path], &args[1..]].concat(), "")).collect()
}

#[test]
fn one_rejected_tooth_rejects_its_part() {
    let folder = Folder::new("status-teeth");
    let all: [&[&str]; 5] = [
        &["batch", "--teeth"],
        &["batch", "--teeth", "--format", "json"],
        &["paste"],
        &["paste", "--format", "json"],
        &["report", "--teeth"],
    ];
    for limit in [LIMIT, ""] {
        let spec = format!("{TOOTHED}{limit}{STATUS}");
        for ended in judged(&folder, &spec, &spaces(7), &all) {
            assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
            let said = [WHY, "1 of 1 part fails by its status"];
            assert!(said.iter().any(|why| ended.stdout.contains(why)), "{}", ended.stdout);
        }
    }
    let spec = format!("{TOOTHED}{LIMIT}{STATUS}");
    for ended in judged(&folder, &spec, &spaces(12), &all) {
        assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    }
    let named = format!("{TOOTHED}{LIMIT}{STATUS}").replace("addendum", "measured = \"table.csv\"\naddendum");
    for (rejected, code) in [(12, 0), (7, 2)] {
        std::fs::write(folder.path("table.csv"), spaces(rejected)).unwrap();
        std::fs::write(folder.path("named.toml"), &named).unwrap();
        let ended = run(&["eval", &folder.path("named.toml")], "");
        assert_eq!(ended.code, Some(code), "{}{}", ended.stdout, ended.stderr);
        assert_eq!(ended.stderr.contains(&format!("table.csv, line 9: {WHY}")), code == 2, "{}", ended.stderr);
    }
}

#[test]
fn the_only_part_of_a_block_is_judged_as_in_a_batch() {
    let folder = Folder::new("status-paste");
    let all: [&[&str]; 4] = [&["batch"], &["paste"], &["paste", "--format", "json"], &["paste", "--format", "csv"]];
    let (row, characteristic) = (
        "Teil;Rollenmaß [mm];Bewertung\nP2;25,011;n.i.O.\n",
        "Merkmal;Ist;Soll;Einheit;Bewertung\nRollenmaß;25,011;25,000;mm;n.i.O.\n",
    );
    for table in [row, characteristic] {
        for limit in [LIMIT, ""] {
            for ended in judged(&folder, &format!("{SPEC}{limit}{STATUS}"), table, &all) {
                assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
                // without a limit, the rows of a batch have no reasons
                let says_why = ended.stdout.contains(WHY) || limit.is_empty() && ended.stdout.starts_with("part_id");
                assert!(says_why && !ended.stdout.contains("PASS"), "{}", ended.stdout);
            }
        }
    }
    let spec = format!("{SPEC}{LIMIT}{STATUS}");
    let json = &judged(&folder, &spec, row, &all)[2].json();
    assert_eq!((&json["verdict"], &json["reason"]), (&"fail".into(), &WHY.into()));
}

#[test]
fn a_summary_says_who_rejects() {
    let folder = Folder::new("status-summary");
    let of = |rows: &str| {
        let spec = format!("{SPEC}{LIMIT}{STATUS}");
        let table = format!("Teil;Rollenmaß [mm];Bewertung\n{rows}");
        judged(&folder, &spec, &table, &[&["batch", "--summary"], &["report"]])
    };
    let cases = [
        ("A;25,011;n.i.O.\n", "1 of 1 part fails by its status"),
        ("A;25,011;n.i.O.\nB;25,02;n.i.O.\nC;25,02;i.O.\n", "2 of 3 parts fail by their status"),
        ("A;25,4;n.i.O.\n", "1 of 1 part is outside a limit (judged by the worst case)"),
        ("A;25,4;i.O.\nB;25,02;n.i.O.\n", "1 of 2 parts fails by its status; 1 of 2 parts is outside a limit"),
    ];
    for (rows, expected) in cases {
        for ended in of(rows) {
            assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
            assert!(ended.stdout.contains(expected), "{expected}: {}", ended.stdout);
        }
    }
}

/// The part that its status rejects is the worst one on a page, however far it is inside its limits.
#[test]
fn a_page_names_the_part_that_its_status_rejects() {
    let folder = Folder::new("status-page");
    let inside = (0..12).fold(String::new(), |rows, part| rows + &format!("P{part};25,04{part:02};i.O.\n"));
    let table = format!("Teil;Rollenmaß [mm];Bewertung\n{inside}BAD;25,000;n.i.O.\n");
    for ended in judged(&folder, &format!("{SPEC}{LIMIT}{STATUS}"), &table, &[&["report"]]) {
        let worst = ended.stdout.split_once("The worst").expect("a list").1;
        assert!(ended.code == Some(1) && worst.contains("Fail by their status: BAD."), "{}", ended.stdout);
        assert!(worst.find("BAD") < worst.find("P11"), "{worst}");
    }
}

/// Parts outside a limit on ΔCD come before those that only their status rejects, whose margin is the same everywhere.
#[test]
fn a_rejected_part_keeps_its_margin() {
    let folder = Folder::new("status-margin");
    let table = "Teil;Rollenmaß [mm];Bewertung\nBAD;25,02;n.i.O.\nOUT;25,15;i.O.\n";
    let all: [&[&str]; 3] = [&["batch", "--summary"], &["batch", "--format", "csv"], &["report"]];
    let ended = judged(&folder, &format!("{SPEC}{LIMIT}{STATUS}"), table, &all);
    let [summary, rows, page] = &ended[..] else { panic!("three answers") };
    let worst = summary.stdout.split_once("worst parts").expect("a list").1;
    assert!(worst.find("OUT") < worst.find("BAD") && worst.contains("+0.0800  fail"), "{worst}");
    assert!(rows.stdout.contains(",0.080000,fail,"), "{}", rows.stdout);
    assert!(page.stdout.contains("part OUT"), "{}", page.stdout);
    let table = "Teil;Rollenmaß [mm];Bewertung\nBAD;25,02;n.i.O.\nGOOD;25,01;i.O.\n";
    let page = &judged(&folder, &format!("{SPEC}{LIMIT}{STATUS}"), table, &[&["report"]])[0];
    let detail = page.stdout.split_once("part BAD").expect("the worst part").1;
    assert!(detail.contains("the part fails by its status, not by ΔCD"), "{detail}");
}
