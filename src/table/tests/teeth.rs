//! Rows that are spaces of a rack or teeth of a pinion.

use super::*;

fn one(text: &str) -> Result<Teeth, String> {
    let table = of_one_part("rack.csv", Source::bytes(text.into()), &Want::default());
    table.map(|table| table.teeth).map_err(|problem| problem.to_string())
}

fn rack(text: &str) -> RackSpaces {
    match one(text) {
        Ok(Teeth::Rack(rack)) => rack,
        Ok(Teeth::Pinion(_)) => panic!("{text} is a pinion"),
        Err(problem) => panic!("{text}: {problem}"),
    }
}

fn pinion(text: &str) -> PinionTeeth {
    match one(text) {
        Ok(Teeth::Pinion(pinion)) => pinion,
        Ok(Teeth::Rack(_)) => panic!("{text} is a rack"),
        Err(problem) => panic!("{text}: {problem}"),
    }
}

fn deviation(text: &str) -> Measured {
    Measured::Deviation(text.parse().unwrap())
}

fn absolute(text: &str) -> Measured {
    Measured::Absolute(text.parse().unwrap())
}

/// The parts of a table with rows of several.
fn gathered(text: &str) -> Vec<ToothedPart> {
    let want = Want { teeth: Some(true), ..Want::default() };
    let table = Container::open("teeth", Source::bytes(text.into()), &want).unwrap().table("teeth", &want).unwrap();
    gather(table, &mut Reading::default()).unwrap()
}

#[test]
fn separators_units_and_decimal_marks() {
    let expected = [Some(deviation("0.0125")), Some(deviation("-0.003"))];
    for text in [
        "space,over_pin_deviation [um]\n0,12.5\n1,-3\n",
        "over_pin_deviation_mm;space\r\n0,0125;0\r\n-0,003;1",
        "Over pin deviation (µm)\tspace\n12,5\t0\n-3\t1\n",
        "\u{feff}over_pin_deviation [mm]\n0.0125\n-0.003\n\n",
        "Lücke\t0\t1\nRollenmaß Abweichung [µm]\t12,5\t-3\n",
        "Rollenmaß-Abweichung\tLücke\nµm\t\n12,5\t0\n-3\t1\n",
    ] {
        let rack = rack(text);
        assert_eq!(rack.rows.iter().map(|row| row.over_pin).collect::<Vec<_>>(), expected, "{text}");
        assert_eq!(rack.rows.iter().map(|row| row.space).collect::<Vec<_>>(), [0, 1], "{text}");
    }
}

#[test]
fn a_space_has_measures_and_a_tooth_deviations() {
    let spaces = rack("Lücke\tRollenmaß [mm]\tLage [mm]\tlead [min]\n4\t25,0131\t2,9845\t30\n5\t25,0\t8,95\t0\n");
    assert_eq!((spaces.rows[1].position, spaces.rows[0].over_pin), (Some(absolute("8.95")), Some(absolute("25.0131"))));
    assert_eq!(spaces.rows[0].lead, Some("0.5 deg".parse().unwrap()));
    assert_eq!((spaces.rows[1].line, spaces.rows[1].space), (3, 5));
    let holds: Vec<_> = reading("space;over_pin;lead\n1;25.5;1\n", &Want::default()).columns[1..]
        .iter()
        .map(|column| column.holds)
        .collect();
    assert_eq!(holds, [Some("measured"), Some("deviation")]);
    let teeth = pinion("Zahn;radial [µm];fp links [µm];fp rechts [µm]\n0;1,5;2;3\n1;-1,5;-2;-3\n");
    assert_eq!(teeth.rows[1].right_pitch, Some("-0.003".parse().unwrap()));
    assert_eq!(teeth.rows[0].radial, Some("0.0015".parse().unwrap()));
    assert_eq!((teeth.unmeasured(2), teeth.unmeasured(3)), (None, Some(2)));
}

#[test]
fn what_is_ambiguous_or_wrong_is_refused_with_its_place() {
    for (text, expected) in [
        ("over_pin;space\n25,013;0\n", "`25,013` has a decimal mark or a thousands mark, and nothing tells which"),
        ("over_pin;space\n25,01;0\n25.01;1\n", "`25,01` has a decimal mark or a thousands mark, and nothing tells"),
        ("over_pin,space\n25.0,x\n", "error[bad-table]: rack.csv, line 2: it is not a whole number: `x`"),
        ("over_pin,space\n25.0,\n", "error[bad-table]: rack.csv, line 2: the cell is empty"),
        ("over_pin,space\n25.0,4\n25.1,4\n", "error[bad-table]: rack.csv, line 3: space 4 has two rows"),
        ("over_pin,space\n25.5,3\n25.0,4,x\n", "rack.csv, line 3: `x` stands in column 3, which has no heading"),
        ("over_pin [deg]\n25.0\n", "`over_pin [deg]`: `deg` is no unit of a length"),
        ("Lücke;Rollenmaß\n1;25.0\n", "`Rollenmaß` is rack_over_roller, and nothing tells its unit"),
        ("height\n1\n", "no column is known to hold a rack's spaces or a pinion's teeth: `height`"),
        ("space,over_pin,height [mm]\n1,2,3\n", "column `height [mm]`: 3\n"),
        ("tooth,over_pin\n1,25\n", "error[bad-table]: rack.csv mixes spaces of a rack with teeth of a pinion"),
        ("tooth,left_pitch,pitch_um\n1,2,25\n", "column `pitch_um`: 25"),
        ("tooth,radial measured [mm]\n1,25\n", "column `radial measured [mm]`: 25"),
        ("part,space,over_pin\nA,1,25.5\nB,1,25.5\n", "error[bad-table]: rack.csv has rows of several parts"),
        ("", "rack.csv holds no table: there is nothing in it"),
    ] {
        let found = one(text).err().unwrap_or_else(|| panic!("{text}"));
        assert!(found.contains(expected), "{text}: {found}");
    }
}

#[test]
fn the_rows_of_a_part_may_stand_anywhere() {
    let parts = gathered("part,space,over_pin_deviation [um]\nA,0,1\nB,0,2\nA,1,3\nB,1,4\nC,7,5\n");
    let shown: Vec<_> = parts
        .iter()
        .map(|part| {
            let Teeth::Rack(rack) = &part.teeth else { panic!("racks") };
            let spaces: Vec<_> = rack.rows.iter().map(|row| (row.space, row.line)).collect();
            (part.name.as_str(), part.line, spaces)
        })
        .collect();
    let expected = [("A", 2, vec![(0, 2), (1, 4)]), ("B", 3, vec![(0, 3), (1, 5)]), ("C", 6, vec![(7, 6)])];
    assert_eq!(shown, expected);
    assert!(parts.iter().all(|part| part.fault.is_none()));
}

#[test]
fn a_row_twice_is_a_fault_of_its_part_alone() {
    let parts = gathered("part,tooth,radial_deviation\nA,0,0.1\nB,0,0.2\nA,0,0.3\n");
    let faults: Vec<_> =
        parts.iter().map(|part| part.fault.as_ref().map(|fault| (fault.line, fault.message.as_str()))).collect();
    assert_eq!(faults, [Some((4, "tooth 0 has two rows")), None]);
}

#[test]
fn a_cell_without_a_value_is_a_space_that_was_not_measured() {
    let spaces = rack("space,over_pin [mm],position [mm]\n0,25.01,0.5\n1,25.02,\n3,n.a.,9\n4,25,10\n");
    assert_eq!(spaces.rows.len(), 4);
    assert_eq!((spaces.rows[1].position, spaces.rows[2].over_pin), (None, None));
    assert_eq!(spaces.measured_spaces().into_iter().collect::<Vec<_>>(), [0, 4]);
    let teeth = pinion("tooth,left_pitch,right_pitch\n0,0.01,-\n1,0.01,0.02\n");
    assert_eq!((teeth.unmeasured(1), teeth.rows[0].right_pitch), (Some(0), None));
}
