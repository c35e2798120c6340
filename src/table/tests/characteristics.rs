//! Tables with a row per characteristic, by contract.

use super::*;

fn layout() -> Layout {
    let line = |text| LineRule { pattern: Pattern::of_line(text), at_most: 0 };
    Layout {
        ignore: ["Status", "Ebenheit", "Bohrung*"].map(Pattern::of_heading).to_vec(),
        ignore_lines: vec![line("Prüfplan: *"), line("Ende")],
        ..Layout::default()
    }
}

fn read(text: &str, layout: Layout) -> Result<(Vec<String>, Reading), String> {
    let want = Want { layout: layout.into(), ..want() };
    let table = Container::open("lot", Source::bytes(text.into()), &want).and_then(|found| found.table("lot", &want));
    let table = table.map_err(|problem| problem.to_string())?;
    let mut reading = table.reading.clone();
    let keys: Vec<_> = table.columns.iter().map(|column| column.field.key()).collect();
    let mut parts = Vec::new();
    for block in table.blocks().map_err(|error| error.to_string())? {
        parts.extend((0..block.rows()).map(|row| part(&block, row, &keys)));
        block.tell(&mut reading);
    }
    Ok((parts, reading))
}

const ROWS: &str = "Prüfplan: 7\nMerkmal;Teil;Soll;Ist;Abw.;Einheit;Status\nRollenmaß;P1;25,000;25,011;0,011;mm;i.O.\n\
                    Zahnstangenteilung Fehler;P1;0;3;3;µm;\nEbenheit;P1;0;412;412;mm;\nRollenmaß;P2;25,000;25,004;0,004;mm;i.O.\n\nEnde\n";

#[test]
fn a_row_per_characteristic_is_a_table_of_parts() {
    let text = ROWS.replace("Zahnstangenteilung Fehler", "Rack pitch error");
    let (parts, reading) = read(&text, layout()).unwrap();
    assert_eq!(
        parts,
        ["P1: rack_over_roller 0.011 mm rack_pitch 0.003 mm", "P2: rack_over_roller 0.004 mm rack_pitch missing"]
    );
    assert_eq!(reading.parts_in, "characteristics");
    let counts: Vec<_> = reading.left_out.iter().filter(|rule| rule.tally.count > 0).map(ToString::to_string).collect();
    assert_eq!(counts.len(), 5, "{counts:?}");
}

#[test]
fn what_nobody_owns_is_listed_at_once() {
    let text = ROWS.replace("Ebenheit;P1", "CHR_9;P1").replace("Prüfplan", "Plan").replace("Status", "Neu");
    let problem = read(&text, layout()).unwrap_err();
    for said in [
        "line 1: Plan: 7",
        "column `Neu`: i.O., i.O.",
        "characteristic `CHR_9`: 412",
        "characteristic `Zahnstangenteilung Fehler`: 3",
    ] {
        assert!(problem.contains(said), "{said}: {problem}");
    }
}

/// A measuring program's decision on any row of a part counts for the part.
#[test]
fn the_worst_decision_of_a_part_counts() {
    let decided = |of_pitch: &str| {
        let text = format!(
            "Teil;Merkmal;Ist [mm];Bewertung\nP1;Rollenmaß;25,011;i.O.\nP1;Rack pitch error;0,003;{of_pitch}\nP2;Rollenmaß;25,1;i.O.\n\
             P2;Rack pitch error;0,001;i.O.\n"
        );
        let texts = |text: &str| vec![text.to_owned()];
        let status = StatusColumn { name: "Bewertung".to_owned(), accept: texts("i.O."), reject: texts("n.i.O.") };
        let want = Want { layout: Layout { status: Some(status), ..Layout::default() }.into(), ..want() };
        let container = Container::open("lot", Source::bytes(text.into()), &want).unwrap();
        let blocks = container.table("lot", &want).unwrap().blocks().unwrap();
        let faults: Vec<_> = blocks[0].faults().iter().map(|fault| fault.message.clone()).collect();
        (blocks[0].failed.clone(), faults)
    };
    assert_eq!(decided("i.O."), (vec![], vec![]));
    assert_eq!(decided("n.i.O."), (vec![0], vec![]));
    for (text, said) in [("", "is blank"), ("?", "neither accepted nor rejected")] {
        let (failed, faults) = decided(text);
        assert!(failed.is_empty() && faults.len() == 1 && faults[0].contains(said), "{faults:?}");
    }
}

/// A long table is cut into cells as its start is; of what has no owner the first are kept, and all are counted.
#[test]
fn a_long_table_has_the_separator_of_its_start() {
    let rows = (0..6000).map(|part| format!("P{part};Rollenmaß;25,000;25,{:03};mm\n", part % 100));
    let rows = rows.collect::<Vec<_>>().concat();
    let text = format!("Teil;Merkmal;Soll;Ist;Einheit\n{rows}");
    let (parts, reading) = read(&text, Layout::default()).unwrap();
    assert_eq!((parts.len(), reading.separator), (6000, Some("semicolons".to_owned())));
    assert_eq!(parts[5999], "P5999: rack_over_roller 0.099 mm");
    let unknown = (0..12_000).map(|row| format!("P1;C{row};0;1;mm\n")).collect::<Vec<_>>().concat();
    let problem = read(&(text + &unknown), Layout::default()).unwrap_err();
    assert!(problem.contains("characteristic `C39`: 1") && problem.contains("and 11960 more"), "{problem:.2000}");
}
