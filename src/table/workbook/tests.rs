use std::io::{self, Cursor};

use super::*;
use crate::diagnostic::Diagnostics;
use crate::table::{Container, Layout, LineRule, Pattern, Source, StatusColumn, Want};

/// The names of the columns, and the row, name and values of each part, or the problem with its help.
fn rows(bytes: &[u8], sheet: Option<&str>, range: &str) -> Result<Vec<String>, String> {
    let range = if range.is_empty() {
        CellRange::default()
    } else {
        range.parse().map_err(|error: NoCellRange| error.to_string())?
    };
    let layout = Layout { sheet: sheet.map(str::to_owned), range, ..Layout::default() };
    let want = Want { layout: layout.into(), ..Want::default() };
    let in_words = |Diagnostics(problems): Diagnostics| {
        let problem = &problems[0];
        format!("{problem} | {}", problem.help.clone().unwrap_or_default())
    };
    let source = Source::bytes(bytes.to_vec());
    let container = Container::open("lot.xlsx", source, &want).map_err(in_words)?;
    let table = container.table("lot.xlsx", &want).map_err(in_words)?;
    let mut all = vec![format!("{}: {}", table.name, table.titles.join("|"))];
    for block in table.blocks().unwrap() {
        for row in 0..block.rows() {
            let is_there =
                |column: &usize| block.faults().iter().all(|fault| (fault.row, fault.column) != (row, Some(*column)));
            let value = |column| {
                if is_there(&column) { block.values(column).at(row).to_string() } else { String::new() }
            };
            let values: Vec<_> = (0..block.values.len()).map(value).collect();
            let name = block.name(row).unwrap_or_default();
            all.push(format!("{}: {name}|{}", block.lines[row], values.join("|")));
        }
    }
    Ok(all)
}

fn workbook() -> Vec<u8> {
    let mut book = rust_xlsxwriter::Workbook::new();
    let cover = book.add_worksheet();
    cover.set_name("Deckblatt").expect("a name").write_string(0, 0, "Auftrag").expect("a cell");
    let lot = book.add_worksheet();
    lot.set_name("Lot 7").expect("a name");
    lot.write_string(1, 0, "gemessen am 3.4.").expect("a cell");
    for (column, name) in ["Teil", "rack_over_roller [mm]", "rack_pitch [um]"].iter().enumerate() {
        lot.write_string(3, u16::try_from(column).expect("few"), *name).expect("a cell");
    }
    for (row, (name, over_roller)) in [(4, ("a1", 25.0131)), (6, ("a2", 0.1 + 0.2))] {
        lot.write_string(row, 0, name).expect("a cell").write_number(row, 1, over_roller).expect("a cell");
    }
    lot.write_number(6, 2, 12).expect("a cell");
    book.save_to_buffer().expect("a workbook")
}

#[test]
fn the_sheet_that_is_named() {
    let book = workbook();
    let expected = [
        "lot.xlsx, sheet `Lot 7`: Teil|rack_over_roller [mm]|rack_pitch [um]",
        "5: a1|25.0131 mm|",
        "7: a2|0.3 mm|0.012 mm",
    ];
    let several = rows(&book, None, "").unwrap_err();
    assert!(several.contains("several sheets have cells: `Deckblatt`, `Lot 7`"), "{several}");
    assert_eq!(rows(&book, Some("Lot 7"), "A4:C9").unwrap(), expected);
    let above = rows(&book, Some("Lot 7"), "").unwrap_err();
    assert!(above.contains("line 2: gemessen am 3.4."), "{above}");
    let part = ["lot.xlsx, sheet `Lot 7`: rack_over_roller [mm]", "5: |25.0131 mm"];
    assert_eq!(rows(&book, Some("Lot 7"), "$B$4:B5").unwrap(), part);
    let none = rows(&book, Some("Lot 8"), "").unwrap_err();
    assert!(none.contains("no sheet `Lot 8` | its sheets are `Deckblatt`, `Lot 7`"), "{none}");
    assert!(rows(&book, None, "F1:F3").unwrap_err().contains("no sheet of the workbook has cells"));
}

#[test]
fn what_is_no_workbook_or_unpacks_to_too_much_is_refused() {
    assert!(rows(b"PK\x03\x04", None, "").unwrap_err().contains("cannot read lot.xlsx: it is no Excel workbook"));
    assert!(rows(b"", None, "").is_err());
    let book = workbook();
    for cut in [10, book.len() / 2, book.len() - 30] {
        assert!(rows(&book[..cut], None, "").is_err());
    }
    let mut bomb = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    bomb.start_file("xl/sharedStrings.xml", options).expect("a part");
    for _ in 0..97 {
        std::io::Write::write_all(&mut bomb, &vec![b' '; 1 << 20]).expect("written");
    }
    let bomb = bomb.finish().expect("an archive").into_inner();
    assert!(bomb.len() < 200_000);
    let refused = rows(&bomb, None, "").unwrap_err();
    assert!(refused.contains("unpacks to more than 96 MiB"), "{refused}");
}

/// A sheet with every kind of cell, and hidden rows and columns.
fn kinds() -> Vec<u8> {
    use rust_xlsxwriter::{Format, Formula};
    let mut book = rust_xlsxwriter::Workbook::new();
    book.add_worksheet().set_name("A & B").unwrap();
    let sheet = book.add_worksheet();
    let date = Format::new().set_num_format("dd.mm.yyyy");
    let moment = Format::new().set_num_format("yyyy-mm-dd hh:mm");
    let time = Format::new().set_num_format("hh:mm:ss");
    let duration = Format::new().set_num_format("[hh]:mm");
    sheet.write_string(0, 0, "a").unwrap().write_number(0, 1, 25.0131).unwrap();
    sheet.write_boolean(0, 2, true).unwrap().write_number_with_format(0, 3, 45_943, &date).unwrap();
    sheet.write_number_with_format(0, 4, 45_943.5, &moment).unwrap();
    sheet.write_number_with_format(0, 5, 0.25, &time).unwrap();
    sheet.write_number_with_format(0, 6, 1.5, &duration).unwrap();
    sheet.write_formula(2, 0, Formula::new("=1/0").set_result("#DIV/0!")).unwrap();
    sheet.write_formula(2, 1, Formula::new("=SORT(A1:A9)").set_result("#SPILL!")).unwrap();
    sheet.write_string(2, 2, "  ").unwrap().write_string(2, 3, " 1,5 mm ").unwrap();
    sheet.write_number(5, 1, -12).unwrap().write_number(6, 1, 1e-7).unwrap();
    sheet.set_row_hidden(2).unwrap().set_row_hidden(5).unwrap().set_row_hidden(9).unwrap();
    sheet.set_column_hidden(1).unwrap().set_column_hidden(12).unwrap();
    book.save_to_buffer().unwrap()
}

#[test]
fn a_file_that_was_changed_is_unpacked_again() {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    io::Write::write_all(&mut file, &kinds()).unwrap();
    let open = |known| Workbook::open_file("lot.xlsx", file.reopen().unwrap(), known);
    let known = open(None).unwrap().known();
    assert!(open(known.clone()).is_ok());
    file.as_file().set_len(100).unwrap();
    assert!(open(known).is_err());
}

fn shown(records: impl IntoIterator<Item = Record>) -> Vec<String> {
    let cell = |cell: &Cell| match &cell.content {
        Content::Empty => String::new(),
        Content::Text(text) => format!("t:{}", &**text),
        number @ (Content::Number(_) | Content::Measured(_)) => format!("n:{number}"),
        Content::Other(text) => format!("o:{text}"),
        Content::Unlike(text) => format!("u:{text}"),
    };
    let line =
        |record: Record| format!("{}: {}", record.line, record.cells.iter().map(cell).collect::<Vec<_>>().join("|"));
    records.into_iter().map(line).collect()
}

#[test]
fn cells_are_what_the_sheet_holds() {
    let mut book = Workbook::open("lot.xlsx", Cursor::new(kinds())).unwrap();
    assert_eq!(book.sheets(), ["A & B", "Sheet2"]);
    let all = CellRange::default();
    let expected = [
        "1: t:a|n:25.0131|o:true|o:2025-10-13|o:2025-10-13 12:00:00|o:06:00:00|o:36 h",
        "3: t:#DIV/0!|t:#SPILL!||t:1,5 mm",
        "6: |n:-12",
        "7: |n:0.0000001",
    ];
    assert_eq!(shown(book.head("Sheet2", all, 2).unwrap()), expected[..2]);
    assert!(book.head("A & B", all, 2).unwrap().is_empty());
    let sheet = book.records("Sheet2", all);
    assert_eq!(sheet.name, "lot.xlsx, sheet `Sheet2`");
    assert_eq!(shown(sheet.records.map(Result::unwrap)), expected);
}

#[test]
fn hidden_rows_and_columns_are_read_and_counted() {
    for (sheet, range, hidden) in [
        ("Sheet2", "A:XFD", Some("2 hidden rows and 1 hidden column")),
        ("Sheet2", "A1:A5", Some("1 hidden row")),
        ("Sheet2", "C:F", Some("2 hidden rows")),
        ("A & B", "A:XFD", None),
    ] {
        let book = Workbook::open("lot.xlsx", Cursor::new(kinds())).unwrap();
        let records = book.records(sheet, range.parse().unwrap());
        assert_eq!(records.hidden.as_deref(), hidden, "{sheet} {range}");
    }
}

/// The workbook with another XML of its second sheet.
fn with_sheet(change: impl Fn(String) -> String) -> Vec<u8> {
    changed(kinds(), "sheet2.xml", change)
}

/// A workbook with another XML of a part.
fn changed(book: Vec<u8>, part_name: &str, change: impl Fn(String) -> String) -> Vec<u8> {
    let mut archive = zip::ZipArchive::new(Cursor::new(book)).unwrap();
    let mut changed = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for index in 0..archive.len() {
        let mut part = archive.by_index(index).unwrap();
        let name = part.name().unwrap().to_string();
        let mut xml = String::new();
        part.read_to_string(&mut xml).unwrap();
        if name.ends_with(part_name) {
            xml = change(xml);
        }
        changed.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        std::io::Write::write_all(&mut changed, xml.as_bytes()).unwrap();
    }
    changed.finish().unwrap().into_inner()
}

#[test]
fn an_error_without_a_name_is_no_value() {
    let bytes = with_sheet(|xml| xml.replace("#DIV/0!", "#BUSY!"));
    let mut book = Workbook::open("lot.xlsx", Cursor::new(bytes)).unwrap();
    let head = book.head("Sheet2", CellRange::default(), 2).unwrap();
    assert_eq!(shown(head)[1], "3: |t:#SPILL!||t:1,5 mm");
}

#[test]
fn a_sheet_that_ends_in_the_middle_is_said() {
    let bytes = with_sheet(|xml| xml[..xml.len() - 200].to_owned());
    let book = Workbook::open("lot.xlsx", Cursor::new(bytes)).unwrap();
    let last = book.records("Sheet2", CellRange::default()).records.last().unwrap();
    let problem = last.unwrap_err().to_string();
    assert!(problem.contains("cannot read lot.xlsx, sheet `Sheet2`: "), "{problem}");
}

#[test]
fn a_number_format_that_shows_another_unit_is_refused() {
    let book = |format: &str| {
        let mut book = rust_xlsxwriter::Workbook::new();
        let format = rust_xlsxwriter::Format::new().set_num_format(format);
        let sheet = book.add_worksheet();
        for (column, name) in ["Teil", "rack_pitch [um]"].iter().enumerate() {
            sheet.write_string(0, u16::try_from(column).expect("few"), *name).expect("a cell");
        }
        sheet.write_string(1, 0, "a1").expect("a cell");
        sheet.write_number_with_format(1, 1, 12.5, &format).expect("a cell");
        book.save_to_buffer().expect("a workbook")
    };
    let expected = ["lot.xlsx, sheet `Sheet1`: Teil|rack_pitch [um]", "2: a1|0.0125 mm"];
    for format in ["0.000", "0.0\" µm\"", "#,##0.00_-"] {
        assert_eq!(rows(&book(format), None, "").unwrap(), expected, "{format}");
    }
    for format in ["0.000\" mm\"", "0.0%", "\"<\"0.0", "-0.0", "0.0,", "0.0\" i.O.\""] {
        assert_eq!(rows(&book(format), None, "").unwrap(), [expected[0], "2: a1|"], "{format}");
    }
}

/// A table with a name, a status, a value, a column that is not used and a line that is none of it, of which one cell is otherwise.
fn one_cell_is(row: u32, column: u16, format: &rust_xlsxwriter::Format) -> Vec<u8> {
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    let plain = rust_xlsxwriter::Format::new();
    let cells = [
        ["Prüfplan", "", "", ""],
        ["Teil", "rack_pitch [um]", "Bewertung", "Temp"],
        ["1", "12.5", "7", "20"],
        ["Teil2", "2.5", "7", "20"],
    ];
    for (at, (cells, place)) in
        (0..).zip(cells.iter().flat_map(|cells| (0..).zip(cells).map(move |(column, cell)| (cells, (column, cell)))))
    {
        let (line, (place, cell)) = (at / u32::try_from(cells.len()).unwrap(), place);
        let format = if (line, place) == (row, column) { format } else { &plain };
        match cell.parse::<f64>() {
            Ok(number) => _ = sheet.write_number_with_format(line, place, number, format).unwrap(),
            Err(_) if cell.is_empty() => {}
            Err(_) => _ = sheet.write_string_with_format(line, place, *cell, format).unwrap(),
        }
    }
    book.save_to_buffer().unwrap()
}

/// What is read of that table, or the first problem or fault, and what was left out.
fn judged(bytes: Vec<u8>) -> Result<String, String> {
    let status = StatusColumn { name: "Bewertung".to_owned(), accept: vec!["7".to_owned()], reject: Vec::new() };
    let layout = Layout {
        status: Some(status),
        ignore: vec![Pattern::of_heading("Temp")],
        ignore_lines: vec![LineRule { pattern: Pattern::of_line("Prüfplan"), at_most: 0 }],
        ..Layout::default()
    };
    let want = Want { layout: layout.into(), ..Want::default() };
    let in_words = |Diagnostics(problems): Diagnostics| format!("{:?}", problems[0]);
    let container = Container::open("lot.xlsx", Source::bytes(bytes), &want).map_err(in_words)?;
    let table = container.table("lot.xlsx", &want).map_err(in_words)?;
    let mut reading = table.reading.clone();
    let mut all = Vec::new();
    for block in table.blocks().unwrap() {
        all.extend((0..block.rows()).map(|row| block.name(row).unwrap_or_default().into_owned()));
        if let Some(fault) = block.faults().first() {
            return Err(fault.message.clone());
        }
        block.tell(&mut reading);
    }
    Ok(format!("{} {:?}", all.join(" "), reading.left_out))
}

#[test]
fn a_cell_that_is_shown_otherwise_is_not_read_whatever_its_column_is() {
    use rust_xlsxwriter::Format;
    let plain = judged(one_cell_is(9, 9, &Format::new())).unwrap();
    assert!(plain.starts_with("1 Teil2 "), "{plain}");
    let code = |code: &str| Format::new().set_num_format(code);
    let places = [(0, 0), (1, 0), (1, 1), (1, 2), (1, 3), (2, 0), (2, 1), (2, 2), (2, 3), (3, 0)];
    for (row, column) in places {
        let is_text = row < 2 || (row, column) == (3, 0);
        let formats = if is_text { ["@\" n.i.O.\"", ";;;", "0;-0;0;\"Teil\""] } else { ["0.00%", ";;;", "\"n.i.O.\""] };
        for format in formats.map(code).into_iter().chain([Format::new().set_font_strikethrough()]) {
            let after = judged(one_cell_is(row, column, &format));
            assert_ne!(after.as_ref(), Ok(&plain), "row {row}, column {column}: {format:?}");
            // what is not used is in the digest; all else is refused, or its row is rejected
            assert_eq!(after.is_ok(), (row, column) == (2, 3), "row {row}, column {column}: {after:?}");
        }
        for format in ["General", "0.000", "#,##0.0", "_-* #,##0.00_-;-* #,##0.00_-"] {
            assert_eq!(judged(one_cell_is(row, column, &code(format))).as_ref(), Ok(&plain), "{format}");
        }
    }
}

/// What a workbook says beside the cells of its sheet, and what its contract has to own or is refused.
#[test]
fn what_changes_what_a_person_sees_has_an_owner() {
    let with = |from: &str, to: &str| {
        judged(changed(one_cell_is(9, 9, &rust_xlsxwriter::Format::new()), "sheet1.xml", |xml| {
            assert!(xml.contains(from), "{from}: {xml}");
            xml.replacen(from, to, 1)
        }))
    };
    let plain = with("<v>12.5</v>", "<v>12.5</v>").unwrap();
    for (from, to, what) in [
        (
            "</sheetData>",
            "</sheetData><conditionalFormatting sqref=\"B3\"><cfRule type=\"expression\" dxfId=\"0\"/></conditionalFormatting>",
            "",
        ),
        ("</sheetData>", "</sheetData><hyperlinks><hyperlink ref=\"B3\" location=\"A1\"/></hyperlinks>", ""),
        (
            "</sheetData>",
            "</sheetData><hyperlinks><hyperlink ref=\"B3\" tooltip=\"in Zoll\"/></hyperlinks>",
            "prompt of B3",
        ),
        (
            "</sheetData>",
            "</sheetData><conditionalFormatting sqref=\"B3\"><cfRule><dataBar showValue=\"0\"/></cfRule></conditionalFormatting>",
            "shows no numbers",
        ),
        (
            "</sheetData>",
            "</sheetData><extLst><x14:cfRule><x14:dxf><font><strike/></font></x14:dxf></x14:cfRule></extLst>",
            "strikes through",
        ),
        ("<sheetView ", "<sheetView showZeros=\"0\" ", "zeros are not shown"),
        ("<v>12.5</v>", "<v>1<!-- -->2.5</v>", "programs read differently"),
        ("<row r=\"4\"", "<row r=\"3\"", "row 3 stands there twice"),
    ] {
        let after = with(from, to);
        if what.is_empty() {
            assert_eq!(after.as_ref(), Ok(&plain), "{to}");
        } else {
            assert!(after.as_ref().is_err_and(|problem| problem.contains(what)), "{to}: {after:?}");
        }
    }
    let hidden = |from: &str, to: &str| {
        let bytes =
            changed(one_cell_is(9, 9, &rust_xlsxwriter::Format::new()), "sheet1.xml", |xml| xml.replacen(from, to, 1));
        Workbook::open("lot.xlsx", Cursor::new(bytes))
            .unwrap()
            .records("Sheet1", CellRange::default())
            .hidden
            .unwrap_or_default()
    };
    assert_eq!(hidden("<row r=\"3\"", "<row ht=\"0\" customHeight=\"1\" r=\"3\""), "1 hidden row");
    assert_eq!(
        hidden("<sheetData>", "<cols><col min=\"2\" max=\"2\" width=\"0\"/></cols><sheetData>"),
        "1 hidden column"
    );
    assert_eq!(hidden("<sheetFormatPr ", "<sheetFormatPr zeroHeight=\"1\" "), "4 hidden rows");
}

/// A workbook of these parts.
fn of_parts(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (part, xml) in parts {
        archive.start_file(*part, zip::write::SimpleFileOptions::default()).expect("a part");
        io::Write::write_all(&mut archive, xml.as_bytes()).expect("its XML");
    }
    archive.finish().expect("an archive").into_inner()
}

#[test]
fn a_formula_without_a_result_is_no_empty_cell_and_a_chart_no_sheet() {
    const CELLS: &str = "<worksheet><sheetData>\
        <row r=\"1\"><c r=\"A1\" t=\"inlineStr\"><is><t>Teil</t></is></c>\
        <c r=\"B1\" t=\"inlineStr\"><is><t>rack_over_roller [mm]</t></is></c></row>\
        <row r=\"2\"><c r=\"A2\" t=\"inlineStr\"><is><t>A</t></is></c><c r=\"B2\"><v>0.0025</v></c></row>\
        <row r=\"3\"><c r=\"A3\" t=\"inlineStr\"><is><t>B</t></is></c><c r=\"B3\"><f>0.001+0.06</f><v/></c></row>\
        <row r=\"4\"><c r=\"A4\" t=\"inlineStr\"><is><t>C</t></is></c><c r=\"B4\"><f>1/1000</f><v>0.001</v></c></row>\
        <row r=\"5\"><c r=\"A5\" t=\"str\"><f>IF(1,\"\",1)</f><v></v></c></row></sheetData></worksheet>";
    const SHEETS: &str = "<workbook><sheets><sheet name=\"Bild\" sheetId=\"1\" r:id=\"r1\"/><sheet name=\"Lot\" sheetId=\"2\" \
                          r:id=\"r2\"/></sheets></workbook>";
    const TYPE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let root = format!(
        "<Relationships><Relationship Id=\"r0\" Type=\"{TYPE}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
    );
    let relations = format!(
        "<Relationships><Relationship Id=\"r1\" Type=\"{TYPE}/chartsheet\" Target=\"chartsheets/sheet1.xml\"/>\
         <Relationship Id=\"r2\" Type=\"{TYPE}/worksheet\" Target=\"worksheets/sheet1.xml\"/></Relationships>"
    );
    let book = of_parts(&[
        ("_rels/.rels", &root),
        ("xl/workbook.xml", SHEETS),
        ("xl/_rels/workbook.xml.rels", &relations),
        ("xl/chartsheets/sheet1.xml", "<chartsheet><drawing/></chartsheet>"),
        ("xl/worksheets/sheet1.xml", CELLS),
    ]);
    let expected = ["lot.xlsx, sheet `Lot`: Teil|rack_over_roller [mm]", "2: A|0.0025 mm", "3: B|", "4: C|0.001 mm"];
    assert_eq!(rows(&book, None, "").unwrap(), expected);
    let book = Workbook::open("lot.xlsx", Cursor::new(book)).expect("a workbook");
    assert_eq!(book.sheets(), ["Lot"]);
}

/// Each sheet is looked into, so that their number is bounded, and no part is looked into twice.
#[test]
fn too_many_sheets_and_sheets_in_one_part_are_refused() {
    const TYPE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let with_sheets = |count: usize, part_of: &dyn Fn(usize) -> usize| {
        let each = |one: &dyn Fn(usize) -> String| (0..count).map(one).collect::<String>();
        let sheets = each(&|at| format!("<sheet name=\"S{at}\" sheetId=\"{}\" r:id=\"r{at}\"/>", at + 1));
        let relations = each(&|at| {
            let part = part_of(at);
            format!("<Relationship Id=\"r{at}\" Type=\"{TYPE}/worksheet\" Target=\"worksheets/sheet{part}.xml\"/>")
        });
        let root = format!(
            "<Relationships><Relationship Id=\"a\" Type=\"{TYPE}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
        );
        let cells = "<worksheet><sheetData><row r=\"1\"><c r=\"A1\"><v>1</v></c></row></sheetData></worksheet>";
        let book = of_parts(&[
            ("_rels/.rels", &root),
            ("xl/workbook.xml", &format!("<workbook><sheets>{sheets}</sheets></workbook>")),
            ("xl/_rels/workbook.xml.rels", &format!("<Relationships>{relations}</Relationships>")),
            ("xl/worksheets/sheet0.xml", cells),
            ("xl/worksheets/sheet1.xml", cells),
        ]);
        Workbook::open("lot.xlsx", Cursor::new(book))
            .map(|book| book.sheets().len())
            .map_err(|problem| problem.sentence())
    };
    assert_eq!(with_sheets(2, &|at| at), Ok(2));
    let twice = with_sheets(2, &|_| 0).unwrap_err();
    assert!(twice.contains("its sheet `S1` is stored in xl/worksheets/sheet0.xml, like a sheet before it"), "{twice}");
    let many = with_sheets(check::MOST_SHEETS + 1, &|at| at).unwrap_err();
    assert!(many.contains("it has 1001 sheets, and at most 1000 are read: save the sheet"), "{many}");
    assert_eq!(with_sheets(check::MOST_SHEETS, &|at| at), Ok(check::MOST_SHEETS));
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for at in 0..=MOST_PARTS {
        archive.start_file(format!("xl/media/{at}.png"), zip::write::SimpleFileOptions::default()).unwrap();
    }
    let refused = rows(&archive.finish().unwrap().into_inner(), None, "").unwrap_err();
    assert!(refused.contains("it has 20001 parts, and at most 20000 are read | save the table"), "{refused}");
}
