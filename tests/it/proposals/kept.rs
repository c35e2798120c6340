//! What a person declared stays, and what stands in the way is told in one go.

use super::{NAMES, SPEC, block, run, status};
use crate::process::Folder;

const GEAR: &str = "[pair]\nnormal_module = 1.9\nnormal_pressure_angle = 20\n[rack]\nface_width = 19.7\n[pinion]\nteeth = 7\n\
                    helix_angle = 25\n[limits]\ncenter_distance = { lower = -0.05, upper = 0.06 }\n";

/// A block that takes the place of the contract judges as that contract does.
#[test]
fn a_pasted_block_judges_as_the_contract_did() {
    let folder = Folder::new("proposals-pasted");
    let columns = "[table.columns]\npart_id = \"Id\"\nrack_over_roller = { name = \"M\", unit = \"mm\", nominal = 25.0, extent = \"one\" }\n\
                   rack_lead = { name = \"fHb\", unit = \"um\", length = 5 }\n";
    let spec = folder.file("rack.toml", format!("{GEAR}{columns}"));
    let file = folder.file("a.csv", "Id,M,fHb,Spindel\nA,25.01,15,4\n");
    let block = block(&[&file], &spec);
    let pasted = folder.file("pasted.toml", format!("{GEAR}{block}"));
    let ignored = folder.file("ignored.toml", format!("{GEAR}[table]\nignore = [\"Spindel\"]\n{columns}"));
    let of = |spec: &str| run(&["batch", spec, &file]).stdout;
    assert!(String::from_utf8_lossy(&of(&ignored)).contains(",fail"), "{block}");
    assert_eq!(of(&pasted), of(&ignored), "{block}");
}

/// A contract in a file of its own is written there.
#[test]
fn a_layout_is_written_where_it_stands() {
    let folder = Folder::new("proposals-layout");
    let spec = folder.file("rack.toml", GEAR);
    let layout = folder.file(
        "layout.toml",
        "# supplier\n[table.columns]\npart_id = \"Id\"\nrack_pitch = { name = \"P\", unit = \"um\" }\n",
    );
    let file = folder.file("a.csv", "Id,P,Spindel\nA,8,4\n");
    let (code, said) = status(&["read", &file, &spec, "--layout", &layout, "--write", "--yes"]);
    let written = |path: &str| std::fs::read_to_string(path).unwrap();
    assert_eq!((code, written(&spec).as_str()), (0, GEAR), "{said}");
    assert!(written(&layout).contains("# supplier\n") && written(&layout).contains("ignore = [\"Spindel\"]"));
    let (code, said) = status(&["batch", &spec, &file, "--layout", &layout]);
    assert_eq!(code, 0, "{said}");
}

/// Where units come per row, no unit is written for the column, and the account says where they come from.
#[test]
fn units_of_rows_stay_units_of_rows() {
    let folder = Folder::new("proposals-units-of-rows");
    let table = "part,rack_pitch,unit\nA,8,µm\nB,0.008,mm\n";
    for (columns, written) in [
        ("[table.columns]\nrack_pitch = { units = \"unit\" }\n", "rack_pitch = { units = \"unit\" }\n"),
        ("", "rack_pitch = { name = \"rack_pitch\", units = \"unit\" }\n"),
    ] {
        let spec = folder.file("rack.toml", format!("{GEAR}{columns}"));
        let file = folder.file("a.csv", table);
        assert!(block(&[&file], &spec).contains(written));
        let accept = if columns.is_empty() { &["--accept", "rack_pitch=unit"][..] } else { &[] };
        let (code, said) = status(&[&["read", &file, &spec, "--write", "--yes"], accept].concat());
        let contract = std::fs::read_to_string(&spec).unwrap();
        assert!(code == 0 && contract.contains(written), "{said}{contract}");
        let (code, said) = status(&["batch", &spec, &file]);
        assert!(code == 0 && said.contains("rack_pitch [unit by column `unit`]"), "{said}");
    }
}

/// One number that cannot be read hides nothing.
#[test]
fn guesses_rest_on_rows_that_can_be_read() {
    let folder = Folder::new("proposals-unreadable");
    let spec = folder.file("rack.toml", SPEC);
    let file = folder.file("a.csv", "Teil;Rollenmaß\nA;25,011\nB;25,0o1\nC;25,012\nA;25,013\n");
    let (_, said) = status(&["read", &file, &spec]);
    for told in ["rack_over_roller = { name = \"Rollenmaß\", unit = \"mm\" }", "the part `A` is there more than once"]
    {
        assert!(said.contains(told), "{told}: {said}");
    }
}

/// Characteristics that a rule leaves out are in the account one by one, as columns are, and so are the columns of their table.
#[test]
fn what_a_rule_leaves_out_is_in_the_account() {
    let folder = Folder::new("proposals-left-out");
    let file = folder.file(
        "a.csv",
        "Teil;Merkmal;Ist;Soll;Einheit;Prüfer\nA;Härte;41;40;HRC;Huber\nA;Rollenmaß;25,013;25,000;mm;Huber\n\
         B;Härte;42;40;HRC;Maier\nB;Rollenmaß;25,012;25,000;mm;Maier\nB;Rauheit;1,6;;µm;Maier\n",
    );
    let spec = folder.file("rack.toml", format!("{SPEC}[table]\nignore = [\"Härte\", \"Rauheit\", \"Prüfer\"]\n"));
    let output = run(&["read", &file, &spec, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let columns = json["account"][0]["columns"].as_array().unwrap();
    let left_out: Vec<_> = columns.iter().filter(|column| column["is"] == "left out").collect();
    let expected = serde_json::json!([
        { "title": "Prüfer", "place": 6, "is": "left out", "unit": null, "why": "`Prüfer`", "first": [] },
        { "title": "Härte", "place": null, "is": "left out", "unit": null, "why": "`Härte`", "first": ["41"] },
        { "title": "Rauheit", "place": null, "is": "left out", "unit": null, "why": "`Rauheit`", "first": ["1,6"] },
    ]);
    assert_eq!(serde_json::json!(left_out), expected);
}

/// The account has every column and every characteristic.
#[test]
fn every_column_is_in_the_account() {
    let folder = Folder::new("proposals-account");
    let spec = folder.file("rack.toml", SPEC);
    let file =
        folder.file("a.csv", "Teil: 0417\nMerkmal;Ist;Soll;Einheit\nRollenmaß;25,013;25,000;mm\nHärte;4,2;0;µm\n");
    let titles = |file: &str| {
        let output = run(&["read", file, &spec, "--format", "json"]).stdout;
        let json: serde_json::Value = serde_json::from_slice(&output).unwrap();
        let columns = json["account"][0]["columns"].as_array().unwrap();
        columns.iter().map(|column| column["title"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(titles(&file), ["Merkmal", "Ist", "Soll", "Einheit", "Rollenmaß", "Soll", "Einheit", "Härte"]);
    let umlaut = folder.file("b.csv", "");
    std::fs::write(&umlaut, b"Teil;Rollenma\xdf [mm]\nA;25,011\n").unwrap();
    assert!(!titles(&umlaut).is_empty());
}

/// A column that is gone has no substitute: only the difference is told. No rule for lines leaves no part.
#[test]
fn no_proposal_throws_checks_away() {
    let folder = Folder::new("proposals-checks");
    let spec = folder.file(
        "rack.toml",
        format!("{GEAR}[table.columns]\npart_id = \"Id\"\nrack_pitch = {{ name = \"Rack pitch\", unit = \"um\" }}\n"),
    );
    let file = folder.file("a.csv", "Id,Spindel\nA,4\nB,5\n");
    let (code, said) = status(&["batch", &spec, &file]);
    assert!(code == 2 && said.contains("new column \"Spindel\"; column \"Rack pitch\" is gone"), "{said}");
    assert!(!said.contains("[table]\n") && !block(&[&file], &spec).contains("name = \"Spindel\""), "{said}");

    let (spec, file) = (folder.file("rack.toml", GEAR), folder.file("a.csv", "part,rack_pitch\nA,4.2 um\n"));
    let (code, said) = status(&["read", &file, &spec]);
    assert!(code == 2 && !said.contains("ignore_lines") && said.contains("`4.2 um` is in µm"), "{said}");
}

/// Columns beside a value are proposed as what their numbers are, and not left out.
#[test]
fn numbers_beside_values_are_proposed_as_such() {
    let folder = Folder::new("proposals-beside");
    let spec = folder.file("rack.toml", SPEC);
    let of = |table: &str| block(&[&folder.file("a.csv", table)], &spec);
    let rows = "P1;25,004;25,000;0,004\nP2;25,010;25,000;0,010\nP3;25,020;25,000;0,020\n";
    let beside = of(&format!("Teil;Rollenmaß [mm];Soll;Abw\n{rows}"));
    let entry = "rack_over_roller = { name = \"Rollenmaß\", unit = \"mm\", nominal = \"Soll\", deviation = \"Abw\" }";
    assert!(beside.contains(entry) && beside.contains("a guess") && !beside.contains("ignore = "), "{beside}");
    let units = of("Teil;Rollenmaß;Einh\nA;25,01;mm\nB;25011;µm\n");
    assert!(units.contains("rack_over_roller = { name = \"Rollenmaß\", units = \"Einh\" }"), "{units}");
}

/// Rejected lines that may be no parts are left out by one list, which also names those of which only the name is there.
#[test]
fn one_list_leaves_out_what_is_no_part() {
    let folder = Folder::new("proposals-one-list");
    let spec = folder.file("rack.toml", SPEC);
    let table = format!("{NAMES}\nP1;25,011;3,1\nP2;25,004;-2,2\nMittelwert;25,008;0,5\nCpk;1,45;\ngeprüft: Huber\n");
    let (code, said) = status(&["batch", &spec, &folder.file("a.csv", &table)]);
    let lists: Vec<&str> = said.lines().filter(|line| line.contains("ignore_lines = [")).collect();
    assert!(code == 2 && lists.len() == 1, "{said}");
    for rule in ["{ like = \"Mittelwert;*\", at_most = 1 }", "\"Cpk;*\"", "\"geprüft: Huber\""] {
        assert!(lists[0].contains(rule), "{rule}: {said}");
    }
}

/// What a hint says closes the table.
#[test]
fn hints_close() {
    let folder = Folder::new("proposals-hints");
    let spec = folder.file("rack.toml", SPEC);
    let file = folder.file("a.txt", "25.011 0.0042\n25.012 0.0032\n");
    let given = "rack_over_roller[mm],rack_pitch[mm]";
    let (_, said) = status(&["batch", &spec, &file, "--as", given]);
    assert!(said.contains("--separator ' ' cuts them"), "{said}");
    let set = "table.columns.rack_pitch.unit=mm";
    let (_, said) = status(&["batch", &spec, &file, "--set", set]);
    assert!(said.contains(&format!("--separator ' ' --as '{given}'")) && !said.contains("ignore_lines"), "{said}");
    let file = folder.file("b.csv", format!("{NAMES}\nP1;25,011;3,1\n"));
    let (_, said) = status(&["batch", &spec, &file, "--ignore", "Teil"]);
    assert!(said.contains("leaves it out") && !said.contains("ignore = ["), "{said}");
}
