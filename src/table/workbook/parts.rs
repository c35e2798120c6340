//! The sheets of a workbook and the parts of the file that hold them. Found in its XML; nothing here opens a file.

use std::collections::HashMap;
use std::io::{self, Read, Seek, SeekFrom};

use super::xml::{attribute, each_tag, name, unescaped};

/// A sheet of a workbook: its part in small letters, `xl/worksheets/sheet1.xml`, its name, and whether it is hidden.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct SheetPart {
    pub(super) part: String,
    pub(super) name: String,
    pub(super) is_hidden: bool,
}

/// The sheets of a workbook in their order. `workbook` is the XML that lists them, `relations` the XML that says where they are.
pub(super) fn sheet_parts(workbook: &[u8], relations: &[u8]) -> Vec<SheetPart> {
    let mut targets: HashMap<String, String> = HashMap::new();
    each_tag(relations, |tag, _| {
        if name(tag) == "Relationship"
            && let (Some(id), Some(target)) = (attribute(tag, "Id"), attribute(tag, "Target"))
        {
            let part = target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), str::to_owned);
            targets.insert(id.to_owned(), part.to_ascii_lowercase());
        }
    });
    let mut sheets = Vec::new();
    each_tag(workbook, |tag, _| {
        if name(tag) == "sheet" {
            let part = attribute(tag, "id").and_then(|id| targets.get(id)).cloned().unwrap_or_default();
            let name = attribute(tag, "name").map(unescaped).unwrap_or_default();
            let is_hidden = matches!(attribute(tag, "state"), Some("hidden" | "veryHidden"));
            sheets.push(SheetPart { part, name, is_hidden });
        }
    });
    sheets
}

/// How many parts an archive says that it has, in the record at its end; `None` if it has no such record.
pub(super) fn parts_of_archive<S: Read + Seek + ?Sized>(source: &mut S) -> io::Result<Option<u64>> {
    /// The longest end of an archive: its record with a comment, and the place of the record of a large one.
    const LONGEST_END: u64 = (1 << 16) + 64;
    let number = |bytes: &[u8], at: usize, count: usize| {
        let digits = bytes.get(at..at + count)?.iter().rev();
        Some(digits.fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    };
    let length = source.seek(SeekFrom::End(0))?;
    source.seek(SeekFrom::Start(length.saturating_sub(LONGEST_END)))?;
    let mut end = Vec::new();
    source.take(LONGEST_END).read_to_end(&mut end)?;
    let Some(at) = end.windows(4).rposition(|mark| mark == b"PK\x05\x06") else { return Ok(None) };
    let count = number(&end, at + 10, 2);
    if count != Some(u64::from(u16::MAX)) {
        return Ok(count);
    }
    // a large archive has another record, and its place before this one
    let place = at.checked_sub(20).filter(|place| end[*place..].starts_with(b"PK\x06\x07"));
    let Some(place) = place.and_then(|place| number(&end, place + 8, 8)) else { return Ok(count) };
    source.seek(SeekFrom::Start(place))?;
    let mut record = Vec::new();
    source.take(40).read_to_end(&mut record)?;
    Ok(number(&record, 32, 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_archive_says_how_many_parts_it_has() {
        let of = |count: usize| {
            let mut archive = zip::ZipWriter::new(io::Cursor::new(Vec::new()));
            for at in 0..count {
                archive.start_file(at.to_string(), zip::write::SimpleFileOptions::default()).unwrap();
            }
            archive.finish().unwrap()
        };
        for count in [0, 3] {
            assert_eq!(parts_of_archive(&mut of(count)).unwrap(), Some(count as u64));
        }
        assert_eq!(parts_of_archive(&mut io::Cursor::new(b"PK\x03\x04")).unwrap(), None);
        // one more than two bytes count
        let mut many = of(65_536);
        assert_eq!(parts_of_archive(&mut many).unwrap(), Some(65_536));
        let mut cut = many.into_inner();
        cut.drain(..cut.len() - 30);
        assert_eq!(parts_of_archive(&mut io::Cursor::new(cut)).unwrap(), Some(65_535));
    }

    #[test]
    fn sheets_stand_in_the_workbooks_order() {
        let workbook = b"<workbook><sheets><sheet name=\"B &amp; C\" sheetId=\"2\" r:id=\"rId7\"/>\
                         <sheet name=\"A\" state=\"hidden\" sheetId=\"1\" r:id='rId1'/><sheet name=\"?\"/></sheets></workbook>";
        let relations = b"<Relationships><Relationship Id=\"rId1\" Target=\"/xl/worksheets/Sheet1.xml\"/>\
                          <Relationship Target=\"worksheets/sheet2.xml\" Id=\"rId7\"/></Relationships>";
        let sheet =
            |part: &str, name: &str, is_hidden| SheetPart { part: part.to_owned(), name: name.to_owned(), is_hidden };
        let (first, second) = ("xl/worksheets/sheet2.xml", "xl/worksheets/sheet1.xml");
        let expected = [sheet(first, "B & C", false), sheet(second, "A", true), sheet("", "?", false)];
        assert_eq!(sheet_parts(workbook, relations), expected);
    }
}
