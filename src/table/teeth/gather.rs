//! Groups the rows of a table of spaces or teeth into parts, and refuses columns and rows that are not of a space or tooth.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use super::{LineFault, Measured, PinionTeeth, PinionTooth, RackSpace, RackSpaces, RowExtent, Teeth, ToothedPart};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::evaluation::REJECTED;
use crate::quantity::Angle;
use crate::table::block::{Block, Contradiction, Fault};
use crate::table::column::{Column, Nominal, is_rack};
use crate::table::field::{Field, ValueKind};
use crate::table::{Container, Reading, Source, Table, Want, Wanted};

/// The highest number of a space or tooth. Racks have some thousands at most.
const FARTHEST: u64 = 100_000;

/// Bytes that the rows of a run take at most. The rows of a part may stand anywhere, so all are kept to the end.
const MOST_HELD: usize = 40 << 20;
/// Bytes that a row and a part take, about.
const ROW: usize = 128;
const PART: usize = 768;

const OVER_PIN: &[Field] = &[Field::OverPin, Field::Error(DeviationKind::RackOverRoller)];
const POSITION: &[Field] = &[Field::Position];
const RADIAL: &[Field] = &[Field::Radial, Field::Error(DeviationKind::PinionRadial)];
const LEAD: &[Field] = &[Field::Lead, Field::Error(DeviationKind::RackLead)];

/// Groups the rows of a table into parts.
pub(crate) struct Gatherer {
    name: Arc<str>,
    is_rack: bool,
    columns: Vec<Column>,
    /// Whether a column numbers the spaces or teeth; else they count from 0.
    is_numbered: bool,
    /// How many teeth the spec's pinion has.
    pinion_teeth: Option<i64>,
    parts: Vec<ToothedPart>,
    known: HashMap<String, usize>,
    /// The part that rows without a name belong to: so far only its first row is named, as where cells are merged.
    named_once: Option<usize>,
    records: u64,
    /// Bytes that the rows so far take, about, those of earlier tables included.
    pub(crate) held: usize,
}

impl Gatherer {
    /// A gatherer for the rows of a table.
    ///
    /// # Errors
    /// If its columns are not those of a rack or a pinion, or leave open which they are.
    pub(crate) fn new(table: &Table) -> Result<Self, Diagnostic> {
        check_columns(table)?;
        Ok(Self {
            name: Arc::clone(&table.name),
            is_rack: is_rack(&table.columns, table.index_field),
            columns: table.columns.clone(),
            is_numbered: table.index_field.is_some(),
            pinion_teeth: table.pinion_teeth,
            parts: Vec::new(),
            known: HashMap::new(),
            named_once: None,
            records: 0,
            held: 0,
        })
    }

    /// Whether the rows are spaces of a rack.
    pub(crate) fn is_rack(&self) -> bool {
        self.is_rack
    }

    /// Takes the rows of a block.
    ///
    /// # Errors
    /// The contradiction of the block, and more rows than are kept.
    pub(crate) fn take(&mut self, block: &Block, keeps_raw: bool) -> Result<(), Contradiction> {
        if let Some(found) = &block.contradiction {
            return Err(found.clone());
        }
        let mut faults = block.faults.iter().peekable();
        for row in 0..block.rows() {
            let line = block.lines[row];
            let name = block.name(row).map_or_else(|| "1".to_owned(), std::borrow::Cow::into_owned);
            let number = self.part_of_row(&name, line, self.records + block.records[row]);
            if keeps_raw {
                let raw = block.raw.get(row).map_or(&b""[..], |span| block.bytes(*span));
                self.parts[number].raw.extend_from_slice(raw);
                self.held += raw.len();
            }
            self.held += ROW;
            let mut present = vec![true; self.columns.len()];
            while let Some(fault) = faults.next_if(|fault| fault.row == row) {
                match (fault.is_missing, fault.column) {
                    (true, Some(column)) => present[column] = false,
                    _ => self.refuse(number, line, fault),
                }
            }
            if block.failed.binary_search(&row).is_ok() {
                self.parts[number].rejected_on.get_or_insert(line);
            }
            let value = |column: usize| block.values[column].get(row).filter(|_| present[column]);
            let index = block.index.get(row).copied().flatten();
            self.row(number, line, index, &value);
        }
        self.records += block.record_count;
        if self.held <= MOST_HELD {
            return Ok(());
        }
        let message = format!("the rows of teeth up to here take more than {} MiB", MOST_HELD >> 20);
        let help = "give all rows of some parts in one run, and those of the others in the next";
        Err(Contradiction { line: block.lines.last().copied().unwrap_or(0), column: String::new(), message, help })
    }

    /// The part of a row: that of its name, or of the row before where only the first row of a part is named.
    fn part_of_row(&mut self, name: &str, line: u64, record: u64) -> usize {
        if let Some(part) = self.named_once.filter(|_| name.is_empty()) {
            return part;
        }
        let known = self.known.get(name).copied();
        let part = known.unwrap_or_else(|| {
            let table = self.name.to_string();
            let teeth = if self.is_rack {
                Teeth::Rack(RackSpaces { name: table, rows: Vec::new() })
            } else {
                Teeth::Pinion(PinionTeeth { name: table, rows: Vec::new() })
            };
            let (name, raw, numbers) = (name.to_owned(), Vec::new(), BTreeSet::new());
            self.held += PART + 2 * name.len();
            self.known.insert(name.clone(), self.parts.len());
            let part = ToothedPart { name, line, record, teeth, raw, fault: None, rejected_on: None, numbers };
            self.parts.push(part);
            self.parts.len() - 1
        });
        self.named_once = Some(part).filter(|_| known.is_none() && !name.is_empty());
        part
    }

    fn refuse(&mut self, part: usize, line: u64, fault: &Fault) {
        let column = fault.column.and_then(|column| self.columns.get(column));
        let message = match column {
            Some(column) => format!("column `{}`: {}", column.title, fault.message),
            None if fault.text.is_empty() => fault.message.clone(),
            None => format!("{}: `{}`", fault.message, fault.text),
        };
        self.parts[part].fault.get_or_insert(LineFault { line, message });
    }

    fn row(&mut self, part: usize, line: u64, index: Option<i64>, value: &dyn Fn(usize) -> Option<DeviationValue>) {
        let columns = &self.columns;
        let length = |fields: &[Field]| match value(find(columns, fields)?)? {
            DeviationValue::Length(length) => Some(length),
            _ => None,
        };
        let lead = find(columns, LEAD).and_then(value).and_then(as_angle);
        let measured = |fields: &[Field]| {
            let deviates = columns[find(columns, fields)?].deviates();
            length(fields).map(if deviates { Measured::Deviation } else { Measured::Absolute })
        };
        let part = &mut self.parts[part];
        let number = if self.is_numbered { index } else { i64::try_from(part.numbers.len()).ok() };
        let Some(number) = number else { return };
        let extent = match (0..columns.len()).filter(|column| value(*column).is_some()).count() {
            0 => RowExtent::Nothing,
            all if all == columns.len() => RowExtent::Whole,
            _ => RowExtent::Part,
        };
        let what = match &mut part.teeth {
            Teeth::Rack(rack) => {
                let (over_pin, position) = (measured(OVER_PIN), measured(POSITION));
                rack.rows.push(RackSpace { space: number, over_pin, position, lead, extent, line });
                "space"
            }
            Teeth::Pinion(pinion) => {
                pinion.rows.push(PinionTooth {
                    tooth: number,
                    radial: length(RADIAL),
                    position: length(POSITION),
                    left_pitch: length(&[Field::LeftPitch]),
                    right_pitch: length(&[Field::RightPitch]),
                    lead,
                    extent,
                    line,
                });
                "tooth"
            }
        };
        if number.unsigned_abs() > FARTHEST {
            let message =
                format!("{number} is too large for the number of a {what} ({FARTHEST} at most): check the column");
            part.fault.get_or_insert(LineFault { line, message });
        }
        if !part.numbers.insert(number) {
            part.fault.get_or_insert(LineFault { line, message: format!("{what} {number} has two rows") });
        }
    }

    /// The parts in the order of their first rows. Where all teeth of a pinion are there and count from 1, the last one becomes tooth
    /// 0.
    pub(crate) fn finish(mut self) -> Vec<ToothedPart> {
        let Some(teeth) = self.pinion_teeth else { return self.parts };
        for part in &mut self.parts {
            let Teeth::Pinion(pinion) = &mut part.teeth else { continue };
            if part.numbers.iter().copied().eq(1..=teeth) {
                pinion.rows.iter_mut().for_each(|row| row.tooth %= teeth);
            }
            if usize::try_from(teeth) == Ok(part.numbers.len()) && part.fault.is_none() {
                part.fault = pinion.without_signs();
            }
        }
        self.parts
    }
}

fn as_angle(value: DeviationValue) -> Option<Angle> {
    match value {
        DeviationValue::Angle(angle) => Some(angle),
        slope @ DeviationValue::Slope(_) => Angle::from_degrees(slope.base()).ok(),
        DeviationValue::Length(_) => None,
    }
}

/// The column that holds one of some fields.
fn find(columns: &[Column], fields: &[Field]) -> Option<usize> {
    columns.iter().position(|column| fields.contains(&column.field))
}

/// Refuses columns that are not those of a rack or a pinion, or leave open which they are.
fn check_columns(table: &Table) -> Result<(), Diagnostic> {
    let columns = &table.columns;
    let refused = |what: &str, help: &str| {
        Err(Diagnostic::error(Code::BadTable, format!("{}{what}", table.name)).help(help.to_owned()))
    };
    if columns.is_empty() {
        let help = "a rack has space, over_pin or over_pin_deviation, position or position_deviation, lead_deviation; a pinion \
                    tooth, radial_deviation, left_pitch_deviation, right_pitch_deviation, lead_deviation";
        return refused(" has no column of a rack's spaces or a pinion's teeth", help);
    }
    columns.iter().try_for_each(|column| refuse_unused(&table.name, column))?;
    let title = |fields: &[Field]| find(columns, fields).map(|column| &columns[column].title);
    let flanks = [Field::LeftPitch, Field::RightPitch];
    if let [Some(title), None] | [None, Some(title)] = flanks.map(|flank| title(&[flank])) {
        let other = if find(columns, &flanks[..1]).is_some() { flanks[1] } else { flanks[0] }.key();
        let what = format!(": `{title}` is of one flank side, and no column is of the other");
        return refused(&what, &format!("add a column {other}; 0 says that these flanks stand where they should"));
    }
    for fields in [OVER_PIN, RADIAL, LEAD] {
        let mut same = columns.iter().filter(|column| fields.contains(&column.field)).map(|column| &column.title);
        if let (Some(one), Some(other)) = (same.next(), same.next()) {
            let what = format!(": `{one}` and `{other}` are the same quantity of a space or tooth");
            return refused(&what, "leave one of them out with --ignore");
        }
    }
    let is_of_rack = find(columns, OVER_PIN).is_some() || table.index_field == Some(Field::Space);
    if is_of_rack && !is_rack(columns, table.index_field) {
        return refused(" mixes spaces of a rack with teeth of a pinion", "give them one after the other");
    }
    let radial = find(columns, RADIAL).map(|radial| &columns[radial]);
    if let Some(radial) = radial.filter(|radial| radial.holds == Some(ValueKind::Measured)) {
        let what = format!(": `{}` holds measured radii; their deviations are needed", radial.title);
        return refused(&what, "give the column of radial deviations");
    }
    Ok(())
}

/// Refuses a column that says nothing of a space or tooth, or whose companions could not be used.
fn refuse_unused(name: &str, column: &Column) -> Result<(), Diagnostic> {
    let (code, what, help) = match column.field {
        Field::Error(DeviationKind::PinionPitch) => (
            Code::AmbiguousBlock,
            "of a tooth could be that of its left or its right flank",
            "name it left_pitch or right_pitch",
        ),
        Field::Error(DeviationKind::RackPitch) => (
            Code::BadTable,
            "is a pitch, and spaces of a rack have positions",
            "write columns space and position_deviation, which is the sum of the pitch errors up to that space",
        ),
        Field::Error(DeviationKind::PinionLead) => {
            (Code::BadTable, "is the lead of a whole pinion", "name that of a tooth lead_deviation")
        }
        Field::Position if column.nominal != Nominal::None => (
            Code::BadTable,
            "has nominal positions beside it, and space j stands nominally at (j + 1/2) p_x",
            "give position_deviation, or leave the nominal positions out with --ignore",
        ),
        _ => return Ok(()),
    };
    Err(Diagnostic::error(code, format!("{name}: `{}` {what}", column.title)).help(help))
}

/// The parts of a table. What its rows say besides goes to `reading`.
pub(crate) fn gather(table: Table, reading: &mut Reading) -> Result<Vec<ToothedPart>, Diagnostic> {
    let (name, mut gatherer) = (Arc::clone(&table.name), Gatherer::new(&table)?);
    for block in table.rows(Wanted::default()) {
        let block = block.map_err(|error| Diagnostic::unreadable(&name, &error))?;
        block.tell(reading);
        gatherer.take(&block, false).map_err(|found| found.of(&name))?;
    }
    Ok(gatherer.finish())
}

/// The teeth or spaces of one part, and how their table was read.
pub struct TeethTable {
    /// The teeth or spaces.
    pub teeth: Teeth,
    /// How they were read.
    pub reading: Reading,
}

/// Reads a table of the teeth or spaces of one part, as a spec names it.
///
/// # Errors
/// If it cannot be read, holds what is not understood, or its rows are wrong.
pub fn of_one_part(name: &str, source: Source, want: &Want) -> Result<TeethTable, Diagnostics> {
    let want = Want { teeth: Some(true), ..want.clone() };
    let table = Container::open(name, source, &want)?.table(name, &want)?;
    let mut reading = table.reading.clone();
    let bad = |message: String| Diagnostic::error(Code::BadTable, message);
    let mut parts = gather(table, &mut reading)?.into_iter();
    let Some(part) = parts.next() else { return Err(bad(format!("{name} has no rows")).into()) };
    if parts.next().is_some() {
        return Err(bad(format!("{name} has rows of several parts")).help("give a table of one part").into());
    }
    match (part.fault, part.rejected_on) {
        (Some(LineFault { line, message }), _) => Err(bad(format!("{name}, line {line}: {message}")).into()),
        (None, Some(line)) => {
            let help = "give a table of a part that its status accepts";
            Err(bad(format!("{name}, line {line}: {REJECTED}")).help(help).into())
        }
        (None, None) => Ok(TeethTable { teeth: part.teeth, reading }),
    }
}
