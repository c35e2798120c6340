//! Columns that a page shows.

use super::{Folder, NAMES, SPEC, block, status};

/// A column called by the key of a page's detail is proposed as that; one of dates may be its date. A contract keeps its own.
#[test]
fn columns_that_a_page_shows_are_proposed_as_such() {
    let folder = Folder::new("details");
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
    let next = folder.file("b.csv", &table.replace("Datum", "Datum;Spindel").replace(";2026", ";7;2026"));
    status(&["read", &next, &spec, "--write", "--yes"]);
    assert!(
        written().contains("\ndate = \"Datum\"\n") && written().contains("\ndrawing = \"Drawing\"\n"),
        "{}",
        written()
    );
}
