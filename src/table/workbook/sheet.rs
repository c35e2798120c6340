//! What the XML of a sheet says besides the contents of its cells: hidden rows and columns, cells that are struck through or merged,
//! prompts, page headers, and XML that programs read differently. Found while a sheet is unpacked to count its bytes; nothing here
//! opens a file.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::io::{self, Write};

use super::comments::{Comment, Run, said_in_header, shows_otherwise};
use super::merged::MergedCells;
use super::range::{CellRange, corner};
use super::xml::{ODD, Tags, attribute, attributes, ended, is_odd, name, unescaped};

/// Row and column of a cell, from 0.
type Place = (u32, u32);

/// What is known of a workbook before its sheets are read.
#[derive(Default)]
pub(super) struct Known {
    /// Its texts of which a run is not shown plainly, by their numbers.
    pub(super) odd_runs: HashMap<usize, Run>,
    /// What each conditional format does not show plainly.
    pub(super) conditional: Vec<Option<String>>,
}

/// Reads the XML of a sheet, which comes in pieces.
pub(super) struct SheetReader<'k> {
    known: &'k Known,
    tags: Tags,
    pub(super) sheet: SheetXml,
    /// The part of the XML that is reached.
    part: Part,
    /// First and last column of each run of hidden columns.
    hidden_columns: Vec<Place>,
    /// Whether rows are hidden unless they say otherwise.
    hides_rows: bool,
    row_is_hidden: bool,
    /// The cells of the conditional format that is being read.
    cells: String,
    /// What that format does not show plainly, and on which condition.
    condition: Option<String>,
    cell: CellXml,
}

/// Where in a sheet's XML a tag stands.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
enum Part {
    #[default]
    Above,
    Rows,
    Below,
}

/// What is read of a cell so far.
#[derive(Default)]
struct CellXml {
    /// Its row, from 1, and the column behind it.
    row: u32,
    column: u32,
    kind: CellKind,
    has_formula: bool,
    has_value: bool,
    /// How many tags hold its content.
    values: u32,
    /// Whether a tag of its content is open.
    is_open: bool,
}

/// How a cell stores its content.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
enum CellKind {
    #[default]
    Number,
    /// As the number of a shared text.
    Shared,
    /// As a text that is the result of a formula.
    Text,
    /// As a text of its own.
    Written,
}

/// What the XML of a sheet says.
#[derive(Clone, Default)]
pub(super) struct SheetXml {
    /// The hidden rows and columns that hold values.
    rows: BTreeSet<u32>,
    columns: BTreeSet<u32>,
    /// Cells of which a run is not shown plainly.
    pub(super) odd_runs: HashMap<Place, Run>,
    /// Cells with a formula and no result.
    pub(super) without_result: HashSet<Place>,
    /// Merged cells.
    pub(super) merged: MergedCells,
    /// Texts that stand in no cell: headers and footers of pages, prompts, conditional formats.
    pub(super) beside: Vec<Comment>,
    /// Why programs may read its cells differently.
    pub(super) problem: Option<String>,
    /// Whether the sheet itself is hidden.
    pub(super) is_hidden: bool,
}

/// Cells of a kind that are kept, at most.
const MOST_CELLS: usize = 1 << 20;

impl Write for SheetReader<'_> {
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
        let counts = [(rows, "hidden row"), (columns, "hidden column"), (usize::from(self.is_hidden), "hidden sheet")];
        let counts = counts.into_iter().filter(|(count, _)| *count > 0);
        let counts: Vec<_> =
            counts.map(|(count, what)| format!("{count} {what}{}", if count == 1 { "" } else { "s" })).collect();
        (!counts.is_empty()).then(|| counts.join(" and "))
    }

    /// Of a sheet that is not where programs look for it.
    pub(super) fn missing() -> Self {
        Self { problem: Some("its XML is at another place than workbooks have it".to_owned()), ..Self::default() }
    }

    /// Adds a text that stands in no cell.
    fn note(&mut self, place: String, text: &str) {
        /// How many are kept. A pattern can own more of them.
        const MOST: usize = 10_000;
        if !text.trim().is_empty() && self.beside.len() <= MOST {
            let text = if self.beside.len() < MOST { text } else { "and more" };
            self.beside.push(Comment { place, text: text.trim().to_owned() });
        }
    }

    fn refuse(&mut self, problem: String) {
        self.problem.get_or_insert(problem);
    }
}

impl<'k> SheetReader<'k> {
    pub(super) fn new(known: &'k Known) -> Self {
        Self {
            known,
            tags: Tags::default(),
            sheet: SheetXml::default(),
            part: Part::Above,
            hidden_columns: Vec::new(),
            hides_rows: false,
            row_is_hidden: false,
            cells: String::new(),
            condition: None,
            cell: CellXml::default(),
        }
    }

    fn take(&mut self, tag: &str, text: &str) {
        if is_odd(tag) {
            self.sheet.refuse(format!("its XML has {ODD}"));
        }
        if self.part == Part::Rows { self.take_of_rows(tag, text) } else { self.take_beside(tag, text) }
    }

    /// A tag above or below the rows.
    fn take_beside(&mut self, tag: &str, text: &str) {
        if ended(tag).is_some_and(|name| name.ends_with("Header") || name.ends_with("Footer")) {
            self.sheet.note("page header".to_owned(), &said_in_header(&unescaped(text)));
        }
        if let Some(condition) = self.condition.as_mut().filter(|_| ended(tag) == Some("formula")) {
            *condition += &unescaped(text);
        }
        self.end_of_condition(ended(tag) == Some("cfRule"));
        let is_off = |key: &str| matches!(attribute(tag, key), Some("0" | "false"));
        match name(tag) {
            "sheetData" if self.part == Part::Below => self.sheet.refuse("it has two lists of rows".to_owned()),
            "sheetData" if !tag.ends_with('/') => self.part = Part::Rows,
            "sheetFormatPr" => {
                self.hides_rows = matches!(attribute(tag, "zeroHeight"), Some("1" | "true"));
                if is_tiny(tag, "defaultRowHeight") {
                    self.hides_rows = true;
                }
            }
            "sheetView" => {
                if is_off("showZeros") {
                    self.sheet.note("view".to_owned(), "zeros are not shown");
                }
                if matches!(attribute(tag, "showFormulas"), Some("1" | "true")) {
                    self.sheet.note("view".to_owned(), "formulas are shown, and not their results");
                }
            }
            "col" if is_hidden(tag) || is_tiny(tag, "width") => {
                let number = |key| attribute(tag, key).and_then(|text| text.parse::<u32>().ok()?.checked_sub(1));
                if let (Some(first), Some(last)) = (number("min"), number("max")) {
                    self.hidden_columns.push((first, last));
                }
            }
            "mergeCell" => {
                let range = attribute(tag, "ref").unwrap_or_default();
                match range.parse() {
                    Ok(range) => self.sheet.merged.add(range),
                    Err(_) => self.sheet.refuse(format!("its merged cells `{range}` are none")),
                }
            }
            "dataValidation" => {
                let said = ["promptTitle", "prompt", "errorTitle", "error"].map(|key| attribute(tag, key));
                let said: Vec<_> = said.into_iter().flatten().map(unescaped).collect();
                let cells = attribute(tag, "sqref").unwrap_or_default();
                self.sheet.note(format!("prompt of {cells}"), &said.join(" "));
            }
            "hyperlink" => {
                let said = attribute(tag, "tooltip").map(unescaped).unwrap_or_default();
                self.sheet.note(format!("prompt of {}", attribute(tag, "ref").unwrap_or_default()), &said);
            }
            "conditionalFormatting" => attribute(tag, "sqref").unwrap_or_default().clone_into(&mut self.cells),
            "cfRule" => {
                let format = attribute(tag, "dxfId").and_then(|number| number.parse::<usize>().ok());
                let shows = format.and_then(|number| self.known.conditional.get(number)?.as_ref());
                let condition = ["type", "operator", "text"].map(|key| attribute(tag, key).unwrap_or_default());
                self.condition = shows.map(|shows| format!("{shows}: {}", condition.join(" ")));
                self.end_of_condition(tag.ends_with('/'));
            }
            "dataBar" | "iconSet" if is_off("showValue") => {
                self.sheet.note(format!("conditional format {}", self.cells), "shows no numbers");
            }
            _ => {
                let shows = shows_otherwise(tag).unwrap_or_default();
                self.sheet.note(format!("conditional format {}", self.cells), &shows);
            }
        }
    }

    /// Notes a conditional format that does not show plainly, once its condition is complete.
    fn end_of_condition(&mut self, is_complete: bool) {
        if let Some(condition) = self.condition.take_if(|_| is_complete) {
            self.sheet.note(format!("conditional format {}", self.cells), &condition);
        }
    }

    /// A tag among the rows.
    fn take_of_rows(&mut self, tag: &str, text: &str) {
        if self.cell.is_open && name(tag.trim_start_matches('/')) != "v" {
            self.refuse_cell("holds more than a number or text");
        }
        match (name(tag), ended(tag)) {
            (_, Some("sheetData")) => self.part = Part::Below,
            ("row", _) => self.row(tag),
            ("c", _) => self.cell(tag),
            (_, Some("c")) => self.end_of_cell(),
            ("f", _) => self.cell.has_formula = true,
            ("v", _) if tag.ends_with('/') => self.cell.values += 1,
            ("v", _) => (self.cell.is_open, self.cell.values) = (true, self.cell.values + 1),
            (_, Some("v")) => self.end_of_value(text),
            ("is", _) if self.cell.kind != CellKind::Written => self.refuse_cell("holds more than a number or text"),
            ("is", _) if !tag.ends_with('/') => (self.cell.values, self.cell.has_value) = (self.cell.values + 1, true),
            _ => self.run(Run::of(tag)),
        }
    }

    fn row(&mut self, tag: &str) {
        let next = self.cell.row.saturating_add(1);
        let row = attribute(tag, "r").map_or(Some(next), |text| text.parse().ok());
        if row.is_none_or(|row| row < next) {
            let row = row.map_or_else(String::new, |row| row.to_string());
            self.sheet.refuse(format!("row {row} stands there twice, or below a later one"));
        }
        self.cell = CellXml { row: row.unwrap_or(next).max(next), ..CellXml::default() };
        let is_seen = matches!(attribute(tag, "hidden"), Some("0" | "false"));
        self.row_is_hidden = is_hidden(tag) || is_tiny(tag, "ht") || self.hides_rows && !is_seen;
    }

    fn cell(&mut self, tag: &str) {
        let CellXml { row, column: next, .. } = self.cell;
        let (mut place, mut style, mut kind) = (None, None, None);
        for (name, value) in attributes(tag) {
            match name {
                "r" => place = place.or(Some(value)),
                "s" => style = style.or(Some(value)),
                "t" => kind = kind.or(Some(value)),
                _ => {}
            }
        }
        let column = match place.map(corner) {
            None => next,
            Some(Some((Some(column), Some(own)))) if own.checked_add(1) == Some(row) && column >= next => column,
            _ => {
                let place = place.unwrap_or_default();
                self.sheet.refuse(format!("row {row}: the cell {place} stands there twice, or at another place"));
                next
            }
        };
        if let Some(style) = style.filter(|style| style.parse::<usize>().is_err()) {
            self.sheet.refuse(format!("row {row}: a cell has the style `{style}`"));
        }
        let kind = match kind {
            Some("s") => CellKind::Shared,
            Some("str") => CellKind::Text,
            Some("inlineStr") => CellKind::Written,
            _ => CellKind::Number,
        };
        self.cell = CellXml { row, column: column.saturating_add(1), kind, ..CellXml::default() };
    }

    fn end_of_value(&mut self, text: &str) {
        self.cell.is_open = false;
        self.cell.has_value |= !text.is_empty();
        let is_text = matches!(self.cell.kind, CellKind::Text | CellKind::Written);
        if self.cell.kind == CellKind::Written || !is_text && text.contains('&') {
            self.refuse_cell("holds more than a number or text");
        }
        if self.cell.kind == CellKind::Shared {
            match text.parse::<usize>() {
                Ok(number) => self.run(self.known.odd_runs.get(&number).copied()),
                Err(_) => self.refuse_cell("is the text of no number"),
            }
        }
    }

    fn place(&self) -> Place {
        (self.cell.row.saturating_sub(1), self.cell.column.saturating_sub(1))
    }

    /// Takes how a run of the cell is shown, where that is not plainly.
    fn run(&mut self, run: Option<Run>) {
        if let Some(run) = run {
            let known = self.sheet.odd_runs.entry(self.place()).or_insert(run);
            *known = run.max(*known);
        }
    }

    fn end_of_cell(&mut self) {
        let CellXml { values, has_formula, has_value, kind, .. } = self.cell;
        let place = self.place();
        if values > 1 {
            self.refuse_cell("holds two values");
        }
        // a formula may result in an empty text
        let is_text = matches!(kind, CellKind::Text | CellKind::Written);
        if has_formula && !has_value && !(is_text && values > 0) {
            self.sheet.without_result.insert(place);
        }
        if self.sheet.odd_runs.len().max(self.sheet.without_result.len()) > MOST_CELLS {
            self.sheet.refuse(format!("more than {MOST_CELLS} cells are struck through, or have no result"));
            self.sheet.odd_runs.clear();
            self.sheet.without_result.clear();
        }
        if !has_value {
            return;
        }
        if self.row_is_hidden {
            self.sheet.rows.insert(place.0);
        }
        if self.hidden_columns.iter().any(|(first, last)| (*first..=*last).contains(&place.1)) {
            self.sheet.columns.insert(place.1);
        }
    }

    fn refuse_cell(&mut self, what: &str) {
        let CellXml { row, column, .. } = self.cell;
        self.sheet.refuse(format!("row {row}: the cell of column {column} {what}"));
    }
}

fn is_hidden(tag: &str) -> bool {
    matches!(attribute(tag, "hidden"), Some("1" | "true"))
}

/// Whether a size is too small to see anything.
fn is_tiny(tag: &str, key: &str) -> bool {
    attribute(tag, key).and_then(|size| size.parse::<f64>().ok()).is_some_and(|size| size < 1.0)
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
            let known = Known::default();
            let mut reader = SheetReader::new(&known);
            for piece in SHEET.as_bytes().chunks(length) {
                reader.write_all(piece).unwrap();
            }
            let xml = reader.sheet;
            assert_eq!(xml.problem, None);
            assert_eq!(xml.without_result, [(4, 0)].into());
            assert_eq!((xml.rows.clone(), xml.columns.clone()), ([3, 6].into(), [1].into()), "in pieces of {length}");
            assert_eq!(xml.hidden(range("")).unwrap(), "2 hidden rows and 1 hidden column");
            assert_eq!(xml.hidden(range("A1:A4")).unwrap(), "1 hidden row");
        }
    }

    #[test]
    fn what_programs_read_differently_is_refused() {
        let problem = |rows: &str| {
            let known = Known { odd_runs: [(1, Run::Struck)].into(), ..Known::default() };
            let mut reader = SheetReader::new(&known);
            reader.write_all(format!("<worksheet><sheetData>{rows}</sheetData></worksheet>").as_bytes()).unwrap();
            reader.sheet.problem.unwrap_or_default()
        };
        for (rows, what) in [
            ("<row><c><v>1</v></c><c r=\"C1\" t=\"str\"><f>A1&amp;B1</f><v>a &amp; b</v></c></row><row r=\"7\"/>", ""),
            ("<row><c><v>1<!-- -->2</v></c></row>", "comments, an encoding or the like"),
            ("<row><c><v>1<![CDATA[2]]></v></c></row>", "comments, an encoding or the like"),
            ("<row><c><v>1<b/>2</v></c></row>", "row 1: the cell of column 1 holds more than a number or text"),
            ("<row><c><v>1&#50;</v></c></row>", "holds more than a number"),
            ("<row><c><v>1</v><v>2</v></c></row>", "holds two values"),
            ("<row><c t=\"inlineStr\"><is><t>a</t></is><v>2</v></c></row>", "holds more than a number or text"),
            (
                "<row r=\"1\"><c r=\"A1\"><v>1</v></c><c r=\"A1\"><v>2</v></c></row>",
                "row 1: the cell A1 stands there twice",
            ),
            ("<row r=\"1\"><c r=\"B1\"><v>1</v></c><c r=\"A1\"><v>2</v></c></row>", "row 1: the cell A1"),
            ("<row r=\"1\"><c r=\"B2\"><v>1</v></c></row>", "row 1: the cell B2"),
            ("<row r=\"2\"/><row r=\"2\"/>", "row 2 stands there twice"),
            ("<row r=\"2\"/><row r=\"1\"/>", "row 1 stands there twice, or below"),
            ("</sheetData><sheetData>", "two lists of rows"),
        ] {
            assert!(
                problem(rows).contains(what) && problem(rows).is_empty() == what.is_empty(),
                "{rows}: {}",
                problem(rows)
            );
        }
    }
}
