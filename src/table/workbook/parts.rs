//! The sheets of a workbook and the parts of the file that hold them. Found in its XML; nothing here opens a file.

use std::collections::HashMap;

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

#[cfg(test)]
mod tests {
    use super::*;

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
