//! Reads the rows of a closed table. What reads a cell owns it; a row with a cell that nothing reads is rejected.

use super::super::block::{Block, Contradiction, Odd, Span};
use super::super::cell::{Cell, Record};
use super::super::contract::{Contract, Owner, line_of};
use super::super::layout::OwnRule;
use super::super::ledger::RowLedger;
use super::super::reading::AsideReading;
use super::{Column, PlainField, Problem, Rows, put, start, swallowed, take_index};
use crate::deviation::DeviationValue;
use crate::quantity::shown;
use crate::table::companions::Companions;
use crate::table::dictionary::LONGEST_HEADING;

impl Contract {
    /// Marks the fields of a line of plain numbers that a rule leaves out, or that have no heading.
    pub(super) fn plain_fields(&self, fields: &mut [PlainField]) {
        for (field, owner) in fields.iter_mut().zip(&self.owners) {
            match (&field, owner) {
                (PlainField::Skipped, Owner::Rule(rule)) => *field = PlainField::LeftOut(*rule),
                (PlainField::Skipped, Owner::Nameless) => *field = PlainField::Nameless,
                _ => {}
            }
        }
    }
}

/// Counts the lines that could be parts and that a rule leaves out.
#[derive(Debug, Default)]
pub(crate) struct Doubtful {
    /// How many lines each rule for lines leaves out.
    counts: Vec<u64>,
    /// The first line beyond the `at_most` of its rule: the rule, and the line.
    beyond: Option<(usize, u64)>,
}

impl Doubtful {
    /// Adds the lines of a block.
    pub(crate) fn add(&mut self, rows: &Rows, block: &Block) {
        for (rule, line, _) in &block.doubtful {
            self.counts.resize(self.counts.len().max(rule + 1), 0);
            self.counts[*rule] += 1;
            if self.counts[*rule] > rows.setup.contract.layout.ignore_lines[*rule].at_most {
                self.beyond.get_or_insert((*rule, *line));
            }
        }
    }

    /// The contradiction, if a rule leaves out more such lines than its `at_most`.
    pub(crate) fn contradiction(&self, rows: &Rows) -> Option<Contradiction> {
        let (rule, line) = self.beyond?;
        let most = rows.setup.contract.layout.ignore_lines[rule].at_most;
        let message = format!("a rule leaves out a line that could be a part, beyond its at_most = {most}");
        let help = "say how many such lines there may be: ignore_lines = [{ like = \"…\", at_most = 1 }]";
        Some(Contradiction { line, column: String::new(), message, help })
    }
}

impl Rows {
    /// Reads a record: a part, a line that a rule leaves out, a repeated heading, or a row that is rejected.
    pub(super) fn owned_row(&self, record: &Record, raw: Span, block: &mut Block) {
        let contract = &self.setup.contract;
        if record.says_nothing() {
            block.blank_lines += 1;
            return;
        }
        if let Some(rule) = contract.layout.covering(record) {
            if self.could_be_part(record) {
                block.doubtful.push((rule, record.line, line_of(record)));
            }
            return no_part(contract.layout.rule_of_line(rule), record, block);
        }
        if contract.is_heading(record) {
            return no_part(contract.layout.own_rule(OwnRule::RepeatedHeadings), record, block);
        }
        if contract.is_other_heading(record) {
            let message = format!("another heading stands here: {}", record.in_words());
            let help = "give tables with other columns one by one";
            let found = Contradiction { line: record.line, column: String::new(), message, help };
            block.contradiction.get_or_insert(found);
            return;
        }
        self.part(record, raw, block);
    }

    /// Whether a line has a value that can be read in every column of values.
    fn could_be_part(&self, record: &Record) -> bool {
        let has_value =
            |column: &Column| matches!(column.value(record.cell(column.place), column.beside_in(record)), Ok(Some(_)));
        self.setup.columns.iter().all(has_value)
    }

    /// Reads a row as a part, or rejects it.
    pub(super) fn part(&self, record: &Record, raw: Span, block: &mut Block) {
        let contract = &self.setup.contract;
        let (ledger, beside) = (RowLedger::new(record), contract.layout.own_rule(OwnRule::BesideValues));
        let name = self.setup.id.map(|place| ledger.read(place));
        let index = self.setup.index.map(|place| ledger.read(place));
        let read = |column: &Column| -> Result<Option<DeviationValue>, Problem> {
            let beside: Companions<&Cell> = column.beside.map(|companion| Some(ledger.read(companion.place)));
            column.value(ledger.read(column.place), beside)
        };
        let values: Vec<_> = self.setup.columns.iter().map(|column| (column, read(column))).collect();
        block.odd.extend(may_be_no_part(record, name, &values));
        for column in &self.setup.columns {
            let value = record.cell(column.place);
            if column.has_finer_deviation(value, &column.beside_in(record)) {
                block.tally(beside).add(record.line, column.place, &value.text());
            }
            for companion in column.beside.iter() {
                let text = record.cell(companion.place).text();
                block.tally(beside).add(record.line, companion.place, &text);
            }
        }
        let status = contract.status().map(|place| {
            let text = ledger.read(place).text();
            block.tally(contract.layout.own_rule(OwnRule::Status)).add(record.line, place, &text);
            contract.layout.accepts(text.trim())
        });
        for (place, rule) in contract.left_out().take_while(|(place, _)| *place < record.cells.len()) {
            block.tally(rule).add(record.line, place, &ledger.read(place).text());
        }
        let surplus = ledger.close().err().map(|unowned| {
            let (text, place) = (unowned.cell.text(), unowned.place + 1);
            format!(
                "`{}` stands in column {place}, which has no heading: ignore = [\"column {place}\"] leaves it out",
                shown(&text)
            )
        });
        let wrong = swallowed(record, self.setup.separator)
            .map(|line| format!("a cell holds a line break and then `{line}`: a quote may be missing"))
            .or(surplus)
            .or_else(|| Contract::no_name(name?))
            .or_else(|| status.clone()?.err());
        if let Some(message) = wrong {
            self.refuse(record.line, raw, block, &record.in_words(), message);
            if let Some(name) = name.filter(|_| index.is_some()) {
                // a rejected space or tooth keeps the name of its part
                let name = block.append(name.text().as_bytes());
                block.names.pop();
                block.names.push(name);
            }
            return;
        }
        start(record.line, raw, block);
        if status == Some(Ok(false)) {
            block.failed.push(block.rows() - 1);
        }
        if let Some(name) = name {
            let name = block.append(name.text().as_bytes());
            block.names.push(name);
        }
        for place in &self.wanted.copied {
            let copied = block.append(record.cell(*place).text().as_bytes());
            block.copied.push(copied);
        }
        for (number, (column, value)) in values.into_iter().enumerate() {
            put(block, number, column, record.cell(column.place), value);
        }
        if let Some(index) = index {
            take_index(block, index);
        }
    }
}

/// A row that is perhaps no part: its name is that of a statistic, or one of its values cannot be read. Of a long one the start is kept.
fn may_be_no_part(
    record: &Record,
    name: Option<&Cell>,
    values: &[(&Column, Result<Option<DeviationValue>, Problem>)],
) -> Option<Odd> {
    let read = values.iter().filter(|(_, value)| matches!(value, Ok(Some(_)))).count();
    let is_named = name.is_some_and(|name| !name.is_missing());
    let is_no_name = name.is_some_and(Contract::is_statistic);
    if read == values.len() && !is_no_name {
        return None;
    }
    let start = |text: &str| text[..text.floor_char_boundary(LONGEST_HEADING)].to_owned();
    let name = start(&name.unwrap_or_else(|| record.cell(0)).text());
    Some(Odd {
        line: record.line,
        text: start(&line_of(record)),
        is_no_name: is_no_name || is_named && !name.chars().any(char::is_alphanumeric),
        has_text: values.iter().any(|(column, _)| !record.cell(column.place).is_empty()),
        could_be_part: read == values.len(),
        name,
    })
}

/// Counts and keeps a line that is no part.
fn no_part(rule: usize, record: &Record, block: &mut Block) {
    block.tally(rule).add(record.line, 0, &line_of(record));
    block.asides.push(AsideReading { line: record.line, text: record.in_words() });
}
