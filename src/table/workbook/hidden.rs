//! Which rows and columns of a sheet hold values that nobody sees, and how its numbers are formatted. Found in the XML of the sheets while they are
//! unpacked to be counted; nothing here opens a file.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::{self, Write};

use super::comments::{Comment, unescaped};
use super::format::{STRUCK_RUN, Shown, Style};
use super::merged::MergedCells;
use super::range::{CellRange, corner};
use super::xml::{Tags, attribute, name};

/// Takes the XML of a sheet, in pieces. Rows and columns count from 0 where nothing else is said.
#[derive(Clone, Default)]
pub(super) struct SheetXml {
    tags: Tags,
    /// First and last of neighbouring columns that are hidden.
    hidden_columns: Vec<(u32, u32)>,
    /// The row that the XML has come to, from 1.
    row: u32,
    row_is_hidden: bool,
    /// The column that it has come to, from 1.
    column: u32,
    /// The hidden rows that hold values.
    rows: BTreeSet<u32>,
    /// The hidden columns that hold values.
    columns: BTreeSet<u32>,
    /// The first row, from 1, of the numbers of a style in a column.
    numbers: BTreeMap<(u32, u32), u32>,
    /// The same of texts.
    texts: BTreeMap<(u32, u32), u32>,
    /// Merged cells.
    pub(super) merged: MergedCells,
    /// Texts that are none of its cells: headers and footers of pages, prompts.
    pub(super) beside: Vec<Comment>,
}

impl Write for SheetXml {
    fn write(&mut self, piece: &[u8]) -> io::Result<usize> {
        let mut tags = std::mem::take(&mut self.tags);
        tags.each(piece, &mut |tag, text| self.take(tag, text));
        self.tags = tags;
        Ok(piece.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl SheetXml {
    /// How many hidden rows and columns in a range hold values, in words; `None` if none does.
    pub(super) fn hidden(&self, range: CellRange) -> Option<String> {
        let rows = self.rows.iter().filter(|row| range.has_row(**row)).count();
        let columns = self.columns.iter().filter(|column| range.has_column(**column)).count();
        let counts = [(rows, "hidden row"), (columns, "hidden column")].into_iter().filter(|(count, _)| *count > 0);
        let counts: Vec<_> =
            counts.map(|(count, what)| format!("{count} {what}{}", if count == 1 { "" } else { "s" })).collect();
        (!counts.is_empty()).then(|| counts.join(" and "))
    }

    /// What its numbers in a range are shown with; columns count from the range's first.
    pub(super) fn shown(&self, by_style: &HashMap<u32, Style>, range: CellRange) -> Vec<Shown> {
        let shown = |(&(style, column), &row): (&(u32, u32), &u32)| {
            let is_in_range = range.has_column(column) && range.has_row(row.saturating_sub(1));
            let style = by_style.get(&style).filter(|_| is_in_range)?.clone();
            Some(Shown { column: (column - range.columns.0) as usize, row, style })
        };
        // what a format shows beside numbers is not shown beside texts
        let texts = self.texts.iter().filter_map(shown).filter(|shown| shown.style.is_struck_through);
        let struck = || Style { is_struck_through: true, ..Style::default() };
        let texts = texts.map(|shown| Shown { style: struck(), ..shown });
        self.numbers.iter().filter_map(shown).chain(texts).collect()
    }

    /// Takes a text that is none of its cells.
    fn note(&mut self, place: String, text: &str) {
        /// Whoever has more of them owns them by a pattern.
        const MOST: usize = 10_000;
        if !text.trim().is_empty() && self.beside.len() <= MOST {
            let text = if self.beside.len() < MOST { text } else { "and more" };
            self.beside.push(Comment { place, text: text.trim().to_owned() });
        }
    }

    fn take(&mut self, tag: &str, text: &str) {
        if !text.is_empty() {
            self.note("page header".to_owned(), &said_in_header(&unescaped(text)));
        }
        match name(tag) {
            "mergeCell" => {
                if let Some(range) = attribute(tag, "ref").and_then(|range| range.parse().ok()) {
                    self.merged.add(range);
                }
            }
            "dataValidation" => {
                let said = ["promptTitle", "prompt", "errorTitle", "error"].map(|key| attribute(tag, key));
                let said: Vec<_> = said.into_iter().flatten().map(unescaped).collect();
                let cells = attribute(tag, "sqref").unwrap_or_default();
                self.note(format!("prompt of {cells}"), &said.join(" "));
            }
            "col" if is_hidden(tag) => {
                let number = |key| attribute(tag, key).and_then(|text| text.parse::<u32>().ok()?.checked_sub(1));
                if let (Some(first), Some(last)) = (number("min"), number("max")) {
                    self.hidden_columns.push((first, last));
                }
            }
            "row" => {
                let written = attribute(tag, "r").and_then(|text| text.parse().ok());
                self.row = written.unwrap_or(self.row.saturating_add(1));
                self.row_is_hidden = is_hidden(tag);
                self.column = 0;
            }
            "c" => {
                let style = attribute(tag, "s").and_then(|style| style.parse().ok()).filter(|style| *style > 0);
                let is_number = matches!(attribute(tag, "t"), None | Some("n"));
                if self.hidden_columns.is_empty() && style.is_none() {
                    self.column = self.column.saturating_add(1);
                    return;
                }
                let written = attribute(tag, "r").and_then(corner).and_then(|(column, _)| column);
                self.column = written.unwrap_or(self.column).saturating_add(1);
                if let Some(style) = style.filter(|_| !tag.ends_with('/')) {
                    let styles = if is_number { &mut self.numbers } else { &mut self.texts };
                    styles.entry((style, self.column - 1)).or_insert(self.row);
                }
            }
            "strike" if !matches!(attribute(tag, "val"), Some("0" | "false")) => {
                self.texts.entry((STRUCK_RUN, self.column.saturating_sub(1))).or_insert(self.row);
            }
            // what a cell holds
            "v" | "is" if !tag.ends_with('/') => {
                if self.row_is_hidden {
                    self.rows.insert(self.row.saturating_sub(1));
                }
                let column = self.column.saturating_sub(1);
                if self.hidden_columns.iter().any(|(first, last)| (*first..=*last).contains(&column)) {
                    self.columns.insert(column);
                }
            }
            _ => {}
        }
    }
}

/// What a page's header says by itself: without places, fonts and fields such as the page's number.
fn said_in_header(text: &str) -> String {
    let (mut said, mut rest) = (String::new(), text);
    while let Some((before, code)) = rest.split_once('&') {
        said += before;
        let mut characters = code.chars();
        rest = match characters.next() {
            Some('"') => characters.as_str().split_once('"').map_or("", |(_, rest)| rest),
            Some('K') => characters.as_str().get(6..).unwrap_or_default(),
            Some('0'..='9') => code.trim_start_matches(|c: char| c.is_ascii_digit()),
            _ => characters.as_str(),
        };
        said.push(' ');
    }
    said += rest;
    let has_words = said.contains(char::is_alphanumeric);
    if has_words { said.split_whitespace().collect::<Vec<_>>().join(" ") } else { String::new() }
}

fn is_hidden(tag: &str) -> bool {
    matches!(attribute(tag, "hidden"), Some("1" | "true"))
}

/// The parts of a workbook that hold its sheets, in the sheets' order: small letters, `xl/worksheets/sheet1.xml`.
/// `workbook` is the XML that lists the sheets, `relations` that which says where they are.
pub(super) fn sheet_parts(workbook: &[u8], relations: &[u8]) -> Vec<String> {
    let mut targets: HashMap<String, String> = HashMap::new();
    Tags::default().each(relations, &mut |tag, _| {
        if name(tag) == "Relationship"
            && let (Some(id), Some(target)) = (attribute(tag, "Id"), attribute(tag, "Target"))
        {
            let part = target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), str::to_owned);
            targets.insert(id.to_owned(), part.to_ascii_lowercase());
        }
    });
    let mut parts = Vec::new();
    Tags::default().each(workbook, &mut |tag, _| {
        if name(tag) == "sheet" {
            let part = attribute(tag, "id").and_then(|id| targets.get(id));
            parts.push(part.cloned().unwrap_or_default());
        }
    });
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHEET: &str = "<?xml version=\"1.0\"?><worksheet><cols><col min=\"2\" max=\"3\" hidden=\"1\"/><col min=\"9\" \
                         max=\"16384\" hidden='true' /></cols><sheetData><row r=\"1\"><c r=\"A1\"><v>1</v></c>\
                         <c r=\"B1\" t=\"inlineStr\"><is><t>a &lt; b</t></is></c></row><x:row r=\"4\" spans=\"1:3\" \
                         hidden=\"true\"><x:c r=\"A4\"><x:v>2</x:v></x:c></x:row><row hidden=\"1\"><c><f>A1</f><v/>\
                         </c></row><row hidden=\"1\"><c r=\"C6\" s=\"3\"/></row><row hidden=\"1\"><c><v>7</v></c>\
                         </row></sheetData></worksheet>";

    #[test]
    fn only_what_holds_values_counts() {
        let range = |text: &str| text.parse().unwrap_or_else(|_| CellRange::default());
        for length in [1, 7, SHEET.len()] {
            let mut xml = SheetXml::default();
            for piece in SHEET.as_bytes().chunks(length) {
                xml.write_all(piece).unwrap();
            }
            assert_eq!((xml.rows.clone(), xml.columns.clone()), ([3, 6].into(), [1].into()), "in pieces of {length}");
            assert_eq!(xml.hidden(range("")).unwrap(), "2 hidden rows and 1 hidden column");
            assert_eq!(xml.hidden(range("A1:A4")).unwrap(), "1 hidden row");
        }
    }

    #[test]
    fn sheets_stand_in_the_workbooks_order() {
        let workbook = b"<workbook><sheets><sheet name=\"B &amp; C\" sheetId=\"2\" r:id=\"rId7\"/>\
                         <sheet name=\"A\" sheetId=\"1\" r:id='rId1'/><sheet name=\"?\"/></sheets></workbook>";
        let relations = b"<Relationships><Relationship Id=\"rId1\" Target=\"/xl/worksheets/Sheet1.xml\"/>\
                          <Relationship Target=\"worksheets/sheet2.xml\" Id=\"rId7\"/></Relationships>";
        let expected = ["xl/worksheets/sheet2.xml", "xl/worksheets/sheet1.xml", ""];
        assert_eq!(sheet_parts(workbook, relations), expected);
    }
}
