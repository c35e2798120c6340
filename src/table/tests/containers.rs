//! Files are what their bytes say, whatever they are called.

use std::io::Write as _;

use super::*;

const TABLE: &str = "Teil;Rollenmaß [mm];rack pitch [µm]\nP1;25,0131;12,5\nP2;24,98;-3\n";
const PARTS: [&str; 2] =
    ["P1: rack_over_roller 0.0131 mm rack_pitch 0.0125 mm", "P2: rack_over_roller -0.02 mm rack_pitch -0.003 mm"];

fn file(name: &str, bytes: &[u8]) -> Read {
    read_file(name, bytes, &want()).unwrap_or_else(|problem| panic!("{name}: {problem}"))
}

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn encodings() {
    let latin = encoding_rs::WINDOWS_1252.encode(TABLE).0.into_owned();
    for (bytes, encoding) in [
        (TABLE.as_bytes().to_vec(), None),
        (format!("\u{feff}{TABLE}").into_bytes(), None),
        (latin, Some("windows-1252")),
        (utf16(&format!("\u{feff}{TABLE}"), u16::to_le_bytes), Some("UTF-16LE")),
        (utf16(&format!("\u{feff}{TABLE}"), u16::to_be_bytes), Some("UTF-16BE")),
        (utf16(TABLE, u16::to_le_bytes), Some("UTF-16LE")),
        (utf16(TABLE, u16::to_be_bytes), Some("UTF-16BE")),
    ] {
        let found = file("lot.csv", &bytes);
        assert_eq!(found.parts, PARTS, "{encoding:?}");
        assert_eq!(found.reading.encoding.as_deref(), encoding);
        assert_eq!(found.reading.columns[1].title, "Rollenmaß [mm]");
    }
    let japanese = "部品番号,オーバーローラー寸法 [mm],ラックピッチ誤差 [μm]\nP1,25.0131,12.5\nP2,24.98,-3\n";
    let found = file("lot.csv", &encoding_rs::SHIFT_JIS.encode(japanese).0);
    assert_eq!(
        (found.parts, found.reading.encoding.as_deref()),
        (PARTS.map(str::to_owned).to_vec(), Some("Shift_JIS"))
    );
    // where detection is wrong
    let told = Layout { encoding: Encoding::named("utf-16le").ok(), ..Layout::default() };
    let told = Want { layout: told.into(), ..want() };
    assert_eq!(read_file("lot.csv", &utf16(TABLE, u16::to_le_bytes), &told).unwrap().parts, PARTS);
}

#[test]
fn packed_files() {
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(TABLE.as_bytes()).unwrap();
    let gzip = gzip.finish().unwrap();
    let zstd = ruzstd::encoding::compress_to_vec(TABLE.as_bytes(), ruzstd::encoding::CompressionLevel::Fastest);
    for bytes in [&gzip, &zstd] {
        assert_eq!(file("lot.csv", bytes).parts, PARTS);
        assert!(read_file("lot.csv", &bytes[..bytes.len() / 2], &want()).is_err());
    }
    let mut twice = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    twice.write_all(b"P3;25,1;0\n").unwrap();
    let members = [gzip, twice.finish().unwrap()].concat();
    assert_eq!(file("lot.csv.gz", &members).parts.len(), 3);
}

#[test]
fn a_separator_in_a_line_of_its_own() {
    for (line, separator) in [("sep=;\r\n", ";"), ("sep=;\n", ";"), ("sep=,\n", ","), ("sep=\t\n", "\t")] {
        let table = TABLE.replace("0131", "013").replace(',', ".").replace(';', separator);
        let found = file("lot.csv", format!("\u{feff}{line}{table}").as_bytes());
        assert_eq!(found.parts.len(), 2, "{line}");
        assert_eq!(found.reading.header_line, Some(2), "{line}");
        assert!(found.parts[0].starts_with("P1: rack_over_roller 0.013 mm"), "{line}: {:?}", found.parts);
    }
}

fn workbook() -> Vec<u8> {
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    sheet.write_string(0, 0, "Teil").unwrap().write_string(0, 1, "Rollenmaß [mm]").unwrap();
    sheet.write_string(0, 2, "rack pitch [µm]").unwrap().write_string(1, 0, "P1").unwrap();
    sheet.write_number(1, 1, 25.0131).unwrap().write_number(1, 2, 12.5).unwrap();
    sheet.write_string(2, 0, "P2").unwrap().write_string(2, 1, "24,98").unwrap();
    sheet.write_number(2, 2, -3).unwrap();
    sheet.set_row_hidden(2).unwrap();
    book.save_to_buffer().unwrap()
}

#[test]
fn a_workbook_by_any_name() {
    for name in ["lot.xlsx", "lot.csv", "lot"] {
        let found = file(name, &workbook());
        assert_eq!((found.parts.as_slice(), found.reading.format), (PARTS.map(str::to_owned).as_slice(), "workbook"));
        assert_eq!(found.reading.file, format!("{name}, sheet `Sheet1`"));
        assert!(found.reading.notes[0].contains("read like the others: 1 hidden row"), "{name}");
    }
    let mut rows = rust_xlsxwriter::Workbook::new();
    let sheet = rows.add_worksheet();
    for (row, name) in ["rack_over_roller", "rack_pitch"].into_iter().enumerate() {
        let row = u32::try_from(row).unwrap();
        sheet.write_string(row, 0, name).unwrap();
        sheet.write_number(row, 1, [25.0131, 0.0125][row as usize]).unwrap();
    }
    let turned = file("lot.xlsx", &rows.save_to_buffer().unwrap());
    assert_eq!(turned.parts, ["rack_over_roller 0.0131 mm rack_pitch 0.0125 mm"]);
}

#[test]
fn what_is_no_table_says_what_it_is() {
    let sheet = Layout { sheet: Some("Lot".to_owned()), ..Layout::default() };
    let sheet = Want { layout: sheet.into(), ..want() };
    for (name, bytes, want, expected) in [
        (
            "lot.xls",
            &b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"[..],
            &want(),
            "lot.xls is a workbook of the old Excel format (.xls)",
        ),
        ("lot.csv", b"%PDF-1.7\n", &want(), "lot.csv is a PDF"),
        ("lot.xls", b"\n<html><table>", &want(), "lot.xls is a web page, whatever its name says"),
        ("lot.csv", b"<?xml version=\"1.0\"?>", &want(), "lot.csv is XML"),
        ("lot.csv", b"a;b\n1;\0\n", &want(), "lot.csv is no text"),
        ("lot.xlsx", TABLE.as_bytes(), &want(), "lot.xlsx is not what its name says: it is no .xlsx file"),
        ("lot.parquet", TABLE.as_bytes(), &want(), "lot.parquet is not what its name says: it is no .parquet file"),
        ("lot.csv", TABLE.as_bytes(), &sheet, "a sheet and a range are of Excel workbooks, and lot.csv is none"),
        ("lot.csv", b"PAR1 and no more", &want(), "cannot read lot.csv: it is a Parquet file whose end is missing"),
    ] {
        let found = read_file(name, bytes, want).err().unwrap_or_else(|| panic!("{expected}"));
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn a_qdas_file_by_any_name() {
    let text = "K0100 2\r\nK2001/1 1\r\nK2002/1 Rollenmaß\r\nK2142/1 mm\r\nK2002/2 Teilung Zahnstange\r\nK2142/2 µm\r\n\
                25,0131\u{f}12,5\r\nK0014/0 P1\r\n24,98\u{f}-3\r\nK0014/0 P2\r\n25\u{14}256\u{f}1\r\n";
    let found = file("lot.txt", text.as_bytes());
    assert_eq!(found.parts[..2], PARTS);
    assert_eq!(found.parts[2], "3: rack_over_roller missing rack_pitch 0.001 mm");
    assert_eq!(found.reading.format, "Q-DAS");
    let note = "lot.txt: attribute 256 (deleted): 1 value does not count, the first in line 11";
    assert!(found.reading.notes.contains(&note.to_owned()), "{:?}", found.reading.notes);
    let (definitions, values) = text.split_at(text.find("25,0131").unwrap());
    let source = |text: &str| Source::bytes(text.into());
    let pair = Container::qdas_pair(("lot.dfd", source(definitions)), ("lot.dfx", source(values)), &want()).unwrap();
    assert_eq!(pair.qdas().unwrap().characteristics.len(), 2);
    assert_eq!(pair.table("lot.dfd", &want()).unwrap().blocks().unwrap()[0].rows(), 3);
}

/// Gives a byte at a time, as a slow pipe does.
struct Trickle(std::io::Cursor<Vec<u8>>);

impl std::io::Read for Trickle {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let count = out.len().min(1);
        self.0.read(&mut out[..count])
    }
}

#[test]
fn a_slow_pipe_changes_nothing() {
    let gzip = {
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        gzip.write_all(TABLE.as_bytes()).unwrap();
        gzip.finish().unwrap()
    };
    for bytes in [TABLE.as_bytes().to_vec(), gzip, workbook(), utf16(&format!("\u{feff}{TABLE}"), u16::to_le_bytes)] {
        let source = Source::Stream(Box::new(Trickle(std::io::Cursor::new(bytes))));
        let table = Container::open("pipe", source, &want()).unwrap().table("pipe", &want()).unwrap();
        let blocks = table.blocks().unwrap();
        let found: Vec<_> = blocks
            .iter()
            .flat_map(|block| (0..block.rows()).map(|row| part(block, row, &["rack_over_roller", "rack_pitch"])))
            .collect();
        assert_eq!(found, PARTS);
    }
}

#[test]
fn what_is_read_as_a_whole_has_so_many_cells_at_most() {
    let across = |rows: usize| "Teil;P1;P2\nRollenmaß [mm];25,01;25,02\n".to_owned() + &";;\n".repeat(rows);
    assert_eq!(file("lot.csv", across(1000).as_bytes()).parts.len(), 2);
    let by_value = |rows: usize| "Teil;Merkmal;Ist\nP1;Rollenmaß [mm];25,01\n".to_owned() + &";;\n".repeat(rows);
    assert_eq!(file("lot.csv", by_value(1000).as_bytes()).parts.len(), 1);
    for text in [across(251_000), by_value(251_000)] {
        let refused = read_file("lot.csv", text.as_bytes(), &want()).unwrap_err();
        assert!(refused.contains("more than 600000 cells"), "{refused}");
        assert!(refused.contains("split it, or write a row per part"), "{refused}");
    }
    // a long line below many short ones makes no table of parts in columns
    let ragged = "Teil;P1\nRollenmaß [mm];25,01\n".to_owned() + &"x\n".repeat(400) + &";".repeat(5000) + "x\n";
    let refused = read_file("lot.csv", ragged.as_bytes(), &want()).unwrap_err();
    assert!(refused.contains("no owner"), "{refused}");
    let wide = "Teil;Rollenmaß [mm]".to_owned() + &";c".repeat(20_000) + "\n";
    let refused = read_file("lot.csv", wide.as_bytes(), &want()).unwrap_err();
    assert!(refused.contains("20002 headings, and at most 16384 are read"), "{refused}");
}
