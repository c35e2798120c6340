//! Text reports of measuring programs (Calypso, PC-DMIS). The format gives columns and lines a fixed meaning, so that no contract has
//! to. A report is recognised by marks of its format. Called by [`text`](super::text).

use std::collections::HashSet;
use std::sync::Arc;

use super::cell::{Cell, MOST_CELLS, Record};
use super::contract::{File, MOST_LISTED, Open, line_of, list};
use super::field::Beside as Role;
use super::grid::separated;
use super::layout::{Layout, Parts};
use crate::quantity::Decimal;

/// A report as a table with a row per characteristic.
pub(crate) struct Report<'n> {
    pub(crate) file: File<'n>,
    pub(crate) records: Vec<Record>,
    /// The contract with the meaning of the format's columns.
    pub(crate) layout: Layout,
}

/// Reads a text as a report; `None` if it is none.
pub(crate) fn report<'n>(name: &'n str, text: &str, layout: &'n Layout) -> Option<Report<'n>> {
    if is_calypso(text) {
        return Some(calypso(name, text, layout));
    }
    is_pcdmis(text).then(|| pcdmis(name, text, layout))
}

/// Whether a text is such a report, by its start.
pub(crate) fn is_report(start: &str) -> bool {
    is_calypso(start) || is_pcdmis(start)
}

/// Whether a text begins as the report of a gear measuring centre does, numbered lines of names and values:
/// ` 21 :Normalmodul...: 1.9`.
pub(crate) fn is_numbered_report(start: &str) -> bool {
    const LEAST: usize = 3;
    let number = |line: &str| {
        let (number, named) = line.trim_start().split_once(':')?;
        named.contains(':').then(|| number.trim().parse::<u32>().ok()).flatten()
    };
    let lines = start.lines().filter(|line| !line.trim().is_empty());
    let numbers: Vec<u32> = lines.map_while(number).take(LEAST).collect();
    numbers.len() == LEAST && numbers[0] == 1 && numbers.is_sorted_by(|one, next| one < next)
}

/// The columns of Calypso's table that are read, and what they are.
const CALYPSO_ROLES: [(&str, Role); 7] = [
    ("id", Role::Name),
    ("actual", Role::Measured),
    ("nominal", Role::Nominal),
    ("uppertol", Role::Upper),
    ("lowertol", Role::Lower),
    ("deviation", Role::Deviation),
    ("unit", Role::Unit),
];

/// Calypso's other columns, which say nothing of values.
const CALYPSO_COLUMNS: &str = "planid type idsymbol exceed warningLimitCF featureid featuresigma link linkmode mmc useruppertol \
     userlowertol fftphi fftphiunit zoneroundnessangle groupname groupname2 datumAid datumBid datumCid natuppertolid \
     natlowertolid decimalplaces featurePosX featurePosY featurePosZ group1 group2 group3 group4 group5 group6 group7 group8 \
     group9 group10";

/// Calypso's table of characteristics, `_chr.txt`.
fn is_calypso(text: &str) -> bool {
    text.lines().find(|line| !line.trim().is_empty()).is_some_and(|line| line.starts_with("planid\tpartnb\tid\t"))
}

fn calypso<'n>(name: &'n str, text: &str, layout: &Layout) -> Report<'n> {
    let mut records = separated(text.as_bytes(), b'\t', true, 0).0;
    let mut file = File::new(name, "Calypso");
    records.retain(|record| {
        let is_end = line_of(record) == "END";
        if is_end {
            file.said.add(record.line, 0, "END");
        }
        !is_end
    });
    let place = |name: &str| records.first()?.cells.iter().position(|cell| cell.text() == name);
    let roles = CALYPSO_ROLES.into_iter().filter(|(name, _)| place(name).is_some());
    let mut own: Vec<String> = CALYPSO_COLUMNS.split_whitespace().map(str::to_owned).collect();
    // a person writes comments: the format does not own them
    let has_comments = place("comment").is_some_and(|at| records.iter().skip(1).any(|row| !row.cell(at).is_empty()));
    own.extend(Some("comment".to_owned()).filter(|_| !has_comments));
    let layout = Layout {
        parts: Some(Parts::Characteristics),
        of_characteristics: roles.map(|(name, role)| (role, name.to_owned())).collect(),
        of_format: own,
        ..layout.with_part_column("partnb")
    };
    Report { file, records, layout }
}

/// The columns of a PC-DMIS report's axes that are read, and what they are.
const PCDMIS_ROLES: [(&str, Role); 5] = [
    ("NOMINAL", Role::Nominal),
    ("+TOL", Role::Upper),
    ("-TOL", Role::Lower),
    ("MEAS", Role::Measured),
    ("DEV", Role::Deviation),
];
/// Cells of a row of an axis: those, and the names of part, dimension and unit.
const AXIS_CELLS: usize = PCDMIS_ROLES.len() + 3;
/// The other columns, which say nothing new.
const PCDMIS_COLUMNS: [&str; 5] = ["MAX", "MIN", "OUTTOL", "BONUS", "DEVANG"];
/// Letters of an axis at most: it is called X, Y, Z, M, D, TP and the like.
const LONGEST_AXIS: usize = 2;
/// What the lines of its head say besides the part.
const PCDMIS_HEAD: [&str; 4] = ["REV NUMBER", "STATS COUNT", "DATE", "TIME"];

/// PC-DMIS's report: `DIM NAME= …` above a line of headings that begins with `AX`.
fn is_pcdmis(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim);
    lines.any(|line| dimension(line).is_some())
        && lines.any(|line| {
            let mut words = line.split_whitespace();
            words.next() == Some("AX") && words.any(|word| word == "MEAS")
        })
}

/// The name of the dimension that a line begins: `DIM OVER_ROLLER= 2D DISTANCE …`.
fn dimension(line: &str) -> Option<&str> {
    let name = line.strip_prefix("DIM ")?.split('=').next()?.trim();
    (line.contains('=') && !name.is_empty() && !name.contains(char::is_whitespace)).then_some(name)
}

/// The unit that a line states: `UNITS=MM,$`.
fn stated_unit(line: &str) -> Option<String> {
    let text = &line[line.find("UNITS=")? + "UNITS=".len()..];
    let unit: String = text.trim_start().chars().take_while(|c| c.is_alphabetic()).collect();
    Some(unit.to_lowercase())
}

/// The reader of a PC-DMIS report.
struct Pcdmis<'l> {
    layout: &'l Layout,
    report: Report<'l>,
    /// The name of the part, and whether it is its serial number.
    part: Option<(String, bool)>,
    dimension: String,
    unit: String,
    columns: Vec<String>,
    /// The headings that are listed as unknown, with their places.
    unknown: HashSet<(usize, String)>,
    /// The rows of the dimension: axis and record.
    axes: Vec<(String, Record)>,
}

fn pcdmis<'n>(name: &'n str, text: &str, layout: &'n Layout) -> Report<'n> {
    let mut roles: Vec<(Role, String)> = PCDMIS_ROLES.iter().map(|(name, role)| (*role, (*name).to_owned())).collect();
    roles.extend([(Role::Name, "DIM".to_owned()), (Role::Unit, "UNITS".to_owned())]);
    let own = Layout {
        parts: Some(Parts::Characteristics),
        of_characteristics: roles,
        ..layout.with_part_column("SER NUMBER")
    };
    let report = Report { file: File::new(name, "PC-DMIS"), records: Vec::new(), layout: own };
    let (dimension, unit, unknown) = (String::new(), String::new(), HashSet::new());
    let (columns, axes) = (Vec::new(), Vec::new());
    let mut reader = Pcdmis { layout, report, part: None, dimension, unit, columns, unknown, axes };
    for (line, number) in text.lines().zip(1..) {
        if (reader.report.records.len() + reader.axes.len()) * AXIS_CELLS > MOST_CELLS {
            break;
        }
        reader.line(line.trim(), number);
    }
    reader.end_dimension();
    let mut report = reader.report;
    let is_named = report.records.iter().any(|record| !record.cell(0).is_empty());
    if !is_named {
        report.layout.part_id = None;
    }
    let heading = ["SER NUMBER", "DIM", "UNITS"].into_iter().chain(PCDMIS_ROLES.iter().map(|(name, _)| *name));
    let cells = heading.map(|name| Cell::of_text(if is_named || name != "SER NUMBER" { name } else { "" }));
    report.records.insert(0, Record::new(cells.collect(), 0));
    report
}

impl Pcdmis<'_> {
    fn line(&mut self, line: &str, number: u64) {
        if line.is_empty() {
            return;
        }
        if let Some(name) = dimension(line) {
            self.end_dimension();
            (self.dimension, self.unit) = (name.to_owned(), stated_unit(line).unwrap_or_default());
            return self.own(line, number);
        }
        let words = line.split_whitespace();
        if words.clone().next() == Some("AX") && words.clone().any(|word| word == "MEAS") {
            return self.heading(&words.skip(1).collect::<Vec<_>>(), line, number);
        }
        // several entries of the head may stand in a line; most lines have no colon, and are not split
        let heads = line.split("  ").map(str::trim).filter(|head| !head.is_empty());
        let is_head = |head: &str| head.contains(':');
        if is_head(line) && heads.clone().nth(1).is_some() && heads.clone().all(is_head) {
            return heads.for_each(|head| self.line(head, number));
        }
        if self.head(line, number) {
            return;
        }
        if line.starts_with("GRAPH=") || line.starts_with("UNITS=") || line.starts_with("END OF ") {
            self.unit = stated_unit(line).unwrap_or_else(|| std::mem::take(&mut self.unit));
            return self.own(line, number);
        }
        let is_number = |word: &str| Decimal::parse(&word.replace(',', ".")).is_ok();
        let is_axis = !self.dimension.is_empty() && !self.columns.is_empty();
        if is_axis && words.clone().nth(1).is_some_and(is_number) {
            return self.axis(&words.collect::<Vec<_>>(), number);
        }
        // a record is made only where a rule looks at it
        let has_rules = !self.layout.ignore_lines.is_empty();
        let covering = || self.layout.covering(&Record::new(vec![Cell::of_text(line)], number));
        match has_rules.then(covering).flatten() {
            Some(rule) => {
                let rule = self.layout.rule_of_line(rule);
                self.report.file.leave_out(rule, number, line);
            }
            None if self.report.file.open.len() >= MOST_LISTED => self.report.file.more += 1,
            None => self.open(Open::Line { line: number, text: line.to_owned(), is_heading: false }),
        }
    }

    /// Adds what has no owner.
    fn open(&mut self, open: Open) {
        self.report.file.more += list(&mut self.report.file.open, std::iter::once(open));
    }

    /// Counts a text that the format owns.
    fn own(&mut self, text: &str, number: u64) {
        self.report.file.said.add(number, 0, text);
    }

    /// Reads a line of the head, such as `SER NUMBER : 0417`. Returns whether it is one.
    fn head(&mut self, line: &str, number: u64) -> bool {
        let Some((key, value)) = line.split_once(':') else { return false };
        let (key, value) = (key.split_whitespace().collect::<Vec<_>>().join(" "), value.trim());
        match key.as_str() {
            "PART NAME" => {
                self.end_dimension();
                self.part = Some((value.to_owned(), false));
            }
            "SER NUMBER" => {
                self.end_dimension();
                if !value.is_empty() || self.part.as_ref().is_some_and(|(_, is_serial)| *is_serial) {
                    self.part = Some((value.to_owned(), true));
                }
            }
            key if PCDMIS_HEAD.contains(&key) => {}
            _ => return false,
        }
        self.own(line, number);
        true
    }

    /// A line of headings.
    fn heading(&mut self, words: &[&str], line: &str, number: u64) {
        self.columns = words.iter().map(|word| (*word).to_owned()).collect();
        self.own(line, number);
        let is_known = |word: &&str| PCDMIS_COLUMNS.contains(word) || PCDMIS_ROLES.iter().any(|(name, _)| name == word);
        for (place, word) in words.iter().enumerate().filter(|(_, word)| !is_known(word)) {
            let (title, first) = ((*word).to_owned(), vec![format!("line {number}")]);
            if self.unknown.len() < MOST_LISTED && self.unknown.insert((place, title.clone())) {
                self.open(Open::Column { place: place + 1, title, first, may_decide: false });
            }
        }
    }

    /// A row of an axis: a number below each heading, and the bar that a deviation is drawn with.
    fn axis(&mut self, words: &[&str], number: u64) {
        let is_bar = |word: &str| word.len() > 1 && word.chars().all(|c| "<>-#|".contains(c));
        let (numbers, bar) = match words.split_last() {
            Some((bar, rest)) if is_bar(bar) => (&rest[1..], Some(*bar)),
            _ => (&words[1..], None),
        };
        if let Some(bar) = bar {
            self.own(bar, number);
        }
        if numbers.len() < self.columns.len() {
            let what = format!("line {number}: {} values below {} headings", numbers.len(), self.columns.len());
            return self.open(Open::Wrong { what, help: "write a value below each heading".to_owned() });
        }
        let cell = |text: &str| Cell::of_text(text);
        let part = self.part.as_ref().map(|(name, _)| name.as_str()).unwrap_or_default();
        let mut cells = vec![cell(part), Cell::default(), cell(&self.unit)];
        for (name, _) in PCDMIS_ROLES {
            let place = self.columns.iter().position(|column| column == name);
            cells.push(place.map_or_else(Cell::default, |place| cell(numbers[place])));
        }
        for (place, text) in numbers.iter().enumerate() {
            match self.columns.get(place) {
                Some(column) if PCDMIS_COLUMNS.contains(&column.as_str()) => {
                    self.report.file.said.add(number, place + 1, text);
                }
                Some(_) => {}
                None => cells.push(cell(text)),
            }
        }
        self.axes.push((words[0].to_owned(), Record::new(cells, number)));
    }

    /// Ends a dimension. Its rows are called by its name, and by their axis where there are several.
    fn end_dimension(&mut self) {
        let axes = std::mem::take(&mut self.axes);
        let is_one = axes.len() == 1 && axes[0].0.chars().count() <= LONGEST_AXIS;
        for (axis, mut record) in axes {
            let name = if is_one { self.dimension.clone() } else { format!("{} {axis}", self.dimension) };
            if is_one {
                self.report.file.said.add(record.line, 0, &axis);
            }
            Arc::make_mut(&mut record.cells)[1] = Cell::of_text(&name);
            self.report.records.push(record);
        }
        self.dimension.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_told_by_their_marks() {
        assert!(is_report("planid\tpartnb\tid\ttype\n"));
        assert!(is_report("\nPART NAME : A\nDIM LOC1= LOCATION OF CIRCLE CIR1 UNITS=MM\nAX NOMINAL MEAS DEV\n"));
        for text in ["planid;partnb;id\n", "DIM A= B\n", "AX NOMINAL MEAS\nDIM A=\n", "DIM A B\nAX NOMINAL MEAS\n"] {
            assert!(!is_report(text), "{text}");
        }
        assert!(is_numbered_report("  1 :Zahnrad.......: A\n  2 :Datum: 1\n\n  6 :Zeit....: 2\n"));
        for text in ["1 :a: b\n2 :c: d\n", "2 :a: b\n3 :c: d\n4 :e: f\n", "1;2:3\n1;2:3\n1;2:3\n", "1: a\n2: b\n3: c\n"]
        {
            assert!(!is_numbered_report(text), "{text}");
        }
    }

    #[test]
    fn a_pcdmis_report_is_a_table_of_characteristics() {
        let text = "PART NAME  : RACK\nSER NUMBER : 0417\nDIM A= 2D DISTANCE UNITS=IN,$\nGRAPH=OFF\n\
                    AX NOMINAL +TOL -TOL MEAS MAX DEV OUTTOL\nM 1 2 3 4 5 6 7 ---->---\nDIM B= LOCATION UNITS=MM\n\
                    AX NOMINAL MEAS DEV\nX 1 2 3\nY 4 5 6\nEND OF DIMENSION B\nPART NAME:RACK\nSER NUMBER   :\n\
                    DIM A= UNITS=MM\nAX MEAS\nM 7 8\n";
        let layout = Layout::default();
        let report = report("lot", text, &layout).unwrap();
        let lines: Vec<String> = report.records.iter().map(line_of).collect();
        assert_eq!(
            lines,
            [
                "SER NUMBER;DIM;UNITS;NOMINAL;+TOL;-TOL;MEAS;DEV",
                "0417;A;in;1;2;3;4;6",
                "0417;B X;mm;1;;;2;3",
                "0417;B Y;mm;4;;;5;6",
                "RACK;A;mm;;;;7;;8"
            ]
        );
        assert!(report.file.open.is_empty(), "{:?}", report.file.open);
    }

    #[test]
    fn an_unknown_heading_is_listed_once() {
        let dimension = "DIM A= 2D DISTANCE UNITS=MM\nAX MEAS FOO\nM 7 8\n";
        let report = report("lot", &dimension.repeat(3), &Layout::default()).unwrap().file.open;
        assert!(matches!(&report[..], [Open::Column { title, .. }] if title == "FOO"), "{report:?}");
    }
}
