//! Columns that a page shows.

use super::{NAMES, SPEC, block, status};
use crate::process::Folder;

/// A column called by the key of a page's detail is proposed as that; one of dates may be its date. A contract keeps its own.
#[test]
fn columns_that_a_page_shows_are_proposed_as_such() {
    let folder = Folder::new("proposals-details");
    let table = format!(
        "{NAMES};Drawing;Datum\nP1;25,011;3,1;4711-1;2026-11-03\nP2;25,004;-2,2;4711-2;2026-11-04\nP3;25,002;1,2;4712;2026-11-04\n"
    );
    let (spec, file) = (folder.file("rack.toml", SPEC), folder.file("a.csv", &table));
    let written = || std::fs::read_to_string(&spec).unwrap();
    let block = block(&[&file], &spec);
    for line in [
        "\ndrawing = \"Drawing\"\n",
        "ignore = [\"Datum\"]",
        "in place of the column in `ignore`",
        "\n# date = \"Datum\"\n",
    ] {
        assert!(block.contains(line), "{line}: {block}");
    }
    let (code, said) = status(&["read", &file, &spec, "--write", "--yes", "--accept", "date=Datum"]);
    assert!(
        code == 0 && written().contains("\ndate = \"Datum\"\n") && !written().contains("ignore = ["),
        "{said}{}",
        written()
    );
    let (_, page) = status(&["report", &spec, &file]);
    for shown in ["<dt>date</dt><dd>2026-11-03, 2026-11-04</dd>", "<dt>drawing</dt><dd>4711-1, 4711-2, 4712</dd>"] {
        assert!(page.contains(shown), "{shown}: {page}");
    }
    // another column in the next export: what is known stays
    let next = folder.file("b.csv", table.replace("Datum", "Datum;Spindel").replace(";2026", ";7;2026"));
    status(&["read", &next, &spec, "--write", "--yes"]);
    assert!(
        written().contains("\ndate = \"Datum\"\n") && written().contains("\ndrawing = \"Drawing\"\n"),
        "{}",
        written()
    );
}

/// A title of a few cells above the table is no heading, and of a line of units only what is no unit is told.
#[test]
fn a_title_and_a_unit_that_is_not_known_do_not_hide_the_rest() {
    let folder = Folder::new("proposals-title");
    let spec = folder.file("spec.toml", SPEC);
    let table = |headings: &str, units: &str| {
        let title = "Messprotokoll Zahnstange;Datum: 14.11.2026;Prüfer: K. Huber\n";
        format!("{title}{headings}\n{units}\nZS-1;25,0046;6,3;ja\nZS-2;25,0100;-1,3;ja\nZS-3;25,0154;0,8;ja\n")
    };
    let unknown = folder.file("unknown.csv", table("Teile-Nr.;Rollenmaß M;Teilungsabw. Zahnst.;Bemerkung", ";mm;µm;"));
    let block = block(&[&unknown], &spec);
    assert!(
        block.contains("Messprotokoll") && block.contains("rack_over_roller = { name = \"Rollenmaß M\""),
        "{block}"
    );
    let units =
        folder.file("units.csv", table(&format!("{NAMES};x").replace(" [mm]", "").replace(" [µm]", ""), ";mm;My-m;"));
    let (code, said) = status(&["batch", &spec, &units, "--ignore", "x", "--ignore-lines", "Messprotokoll*"]);
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("`My-m` is no unit of a length") && said.contains("mm, µm or in"), "{said}");
    assert!(!said.contains("nothing tells its unit"), "{said}");
    // a person's rule owns the line: then the contract gives the units
    let columns = ["rack_over_roller=Rollenmaß[mm]", "rack_pitch=Teilungsabweichung Zahnstange[um]"];
    let columns = columns.iter().flat_map(|column| ["--column", column]).collect::<Vec<_>>();
    let rules = ["--ignore", "x", "--ignore-lines", "Messprotokoll*", "--ignore-lines", "*My-m*"];
    let (code, said) = status(&[&["batch", &spec, &units], &rules[..], &columns].concat());
    assert_eq!(code, 0, "{said}");
}

/// Where most rows cannot be read, as without a nominal value, they are not said to be left out: why they are no parts is.
#[test]
fn rows_that_cannot_be_read_are_not_proposed_to_be_left_out() {
    let folder = Folder::new("proposals-unreadable");
    let spec = folder.file("spec.toml", SPEC.replace("{ nominal = 25 }   # as drawn", "0"));
    let rows = "ZS-1;25,0046;6,3\nZS-2;25,0100;-1,3\nZS-3;25,0154;0,8\nStd.-Abw.;0,0062;4,9\n";
    let lot = folder.file("lot.csv", format!("{NAMES}\n{rows}"));
    let (code, said) = status(&["read", &lot, &spec]);
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("most rows are no parts") && said.contains("nominal") && !said.contains("ZS-#"), "{said}");
}
