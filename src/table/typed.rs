//! Tables of files whose cells are typed: workbooks, Q-DAS files, Parquet. Their columns are found from the first records,
//! and the others follow as they are read. Called by [`Container::table`](super::Container::table).

mod typed_by_contract;

use super::Table;
use super::cell::{Cell, Content, Record};
use super::column::{Column, UnitFrom};
use super::grid::is_unit;
use super::lines::{Beside, of_all_values};
use super::measured::MeasuredValues;
use super::names::{WordList, heading, is_again, is_context, is_value_heading, part_in_title, role, says_more};
use super::parquet::{ParquetTable, ROWS_TOGETHER, StoredRows, Unread};
use super::pieces::Place;
use super::propose::Unclosed;
use super::reading::{AsideReading, NotUsed};
use super::rejection::rejection;
use super::rows::stored_record;
use super::stored::Stored;
use super::strangers::{self, Others, SHEET, Stranger, listed_statistics};
use super::understand::{Understood, said_of_other, understand_records};
use super::unknown::Unknown;
use super::want::Want;
use super::workbook::{Comment, Shown, Workbook, listed};
use crate::deviation::Part;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::quantity::{Decimal, Unit};

/// Records from which columns are found.
const HEAD: usize = 400;

/// A sheet of a workbook, and its first records.
struct Sheet {
    name: String,
    /// As messages call it.
    called: String,
    head: Vec<Record>,
}

/// The sheet that is read, and the others.
struct Sheets {
    read: Sheet,
    others: Vec<Sheet>,
}

pub(crate) fn workbook_table(mut book: Workbook, want: &Want) -> Result<Table, Unclosed> {
    if let Some(layout) = &want.only_contract() {
        return typed_by_contract::workbook(book, layout, want);
    }
    let all_sheets = book.sheets();
    let Sheets { read: Sheet { name: sheet, head, .. }, others } = sheets(&mut book, want)?;
    let records = book.records(&sheet, want.range);
    let name = records.name.clone();
    let want = &*want.of_part(std::iter::once(sheet.clone()));
    let mut rest = records.records;
    let mut all: Vec<Record> = rest.by_ref().take(head.len()).collect::<Result<_, _>>()?;
    let mut understood = understand_records(&name, &all, want)?;
    let in_rows = understood.has_row_per_part();
    if !in_rows {
        all.extend(rest.by_ref().collect::<Result<Vec<_>, _>>()?);
        understood = understand_records(&name, &all, want)?;
    }
    if let Some(refused) = records.shown.iter().find_map(|shown| shown_otherwise(&name, shown, &understood, in_rows)) {
        return Err(refused.into());
    }
    let mut table = Table::new(&name, "workbook", &understood, want);
    // the table may end before the sheet does, if all of it was looked at
    let is_all = all.len() < HEAD;
    if let Some(refused) = understood.false_statistic(&name).filter(|_| !in_rows || is_all) {
        return Err(refused.into());
    }
    table.reading.notes.extend(understood.other_count(&name).filter(|_| !in_rows || is_all));
    let range = understood.shape.data.start..if is_all { understood.shape.data.end } else { all.len() };
    let head: Vec<Record> = all.drain(range).collect();
    table.pieces.give_records(head.into_iter().map(Ok).chain(rest.filter(move |_| !is_all)), None);
    table.place = Place::SheetRow;
    let called = format!("{SHEET}{sheet}");
    if let Some(refused) = said_of_other(&understood.columns, &name, &sheet, &called, want) {
        return Err(refused.into());
    }
    if !WordList::Comparison.has(&sheet) {
        table.take_words(&called, &sheet, true, &understood, want)?;
    }
    for comment in &records.comments {
        table.take_comment(comment, &understood, want)?;
    }
    for other in &others {
        table.take_other(other, &understood, want)?;
    }
    let left_out = all_sheets.into_iter().filter(|name| want.sheet.is_some() && *name != sheet);
    let left_out = left_out.map(|name| NotUsed { title: format!("{SHEET}{name}"), why: "another sheet is named" });
    table.reading.not_used.extend(left_out);
    table.reading.notes.extend(records.hidden.map(|hidden| format!("{name}: read like the others: {hidden}")));
    Ok(table)
}

/// The one sheet that has columns that are known, or the only one with anything in it.
fn sheets(book: &mut Workbook, want: &Want) -> Result<Sheets, Diagnostic> {
    let names = book.candidates(want.sheet.as_deref())?;
    let is_known = |record: &Record| {
        // a letter behind a word for context is no name
        let is_context = record.cells.first().is_some_and(|cell| is_context(&cell.text()));
        let is_name = |cell: &&Cell| !is_context || cell.text().chars().count() > 1;
        record.cells.iter().filter(is_name).any(|cell| is_value_heading(&cell.text(), &want.own))
    };
    let (mut found, mut others): (Vec<Sheet>, Vec<Sheet>) = (Vec::new(), Vec::new());
    for name in &names {
        let head = book.head(name, want.range, HEAD)?;
        let sheet = Sheet { name: name.clone(), called: book.called(name), head };
        if !sheet.head.iter().any(is_known) && (names.len() > 1 || sheet.head.is_empty()) {
            others.push(sheet);
            continue;
        }
        let has_numbers = sheet.head.iter().any(|record| record.numbers() > 0);
        if found.is_empty() || has_numbers { found.push(sheet) } else { others.push(sheet) }
    }
    let is_list = |sheet: &Sheet| sheet.head.len() < HEAD && listed_statistics(&sheet.head).is_some();
    if !found.iter().all(is_list) {
        others.extend(found.extract_if(.., |sheet| is_list(sheet)));
    }
    if found.len() > 1 {
        let all: Vec<String> = found.into_iter().map(|sheet| sheet.name).collect();
        let message = format!("{} sheets have columns that are known: {}", all.len(), listed(&all));
        return Err(Diagnostic::error(Code::AmbiguousBlock, message)
            .help("say which is meant with --sheet; each is read by itself"));
    }
    let read = found.pop().ok_or_else(|| {
        Diagnostic::error(Code::BadTable, "no sheet of the workbook has a column that is known")
            .help(format!("its sheets are {}; say which with --sheet, and where with --range", listed(&names)))
    })?;
    Ok(Sheets { read, others })
}

impl Table {
    /// A remark is not used; one that speaks of a value, or of all of them, is a stranger.
    ///
    /// # Errors
    /// One that states another unit than that of the values.
    fn take_remark(
        &mut self,
        title: &str,
        text: &str,
        is_of_all: bool,
        understood: &Understood,
        want: &Want,
    ) -> Result<(), Diagnostic> {
        if !self.take_words(title, text, is_of_all, understood, want)? {
            self.reading.not_used.push(NotUsed { title: title.to_owned(), why: "no measurement" });
        }
        Ok(())
    }

    /// A comment on a cell is a remark on its value; a number alone may be another value of it, and one on a heading speaks of its
    /// column.
    ///
    /// # Errors
    /// One that states another unit than that of the values.
    fn take_comment(&mut self, comment: &Comment, understood: &Understood, want: &Want) -> Result<(), Diagnostic> {
        let Comment { place, text } = comment;
        let numbers = text.lines().map(|line| Cell::of_text(line.trim(), 0..0)).filter(Cell::is_number);
        let mut values = numbers.filter(|cell| understood.columns.iter().any(|column| column.may_hold(cell)));
        if let Some(value) = values.next() {
            self.take_value(place, Unknown::line("", 0, vec![value]), want);
            return Ok(());
        }
        let row = place.trim_start_matches(|c: char| !c.is_ascii_digit()).parse().ok();
        let is_on_heading = row.is_some() && row == understood.shape.header_line;
        self.take_remark(place, text, is_on_heading, understood, want)
    }

    /// What may be a value is a stranger, whatever the letters of its place say.
    fn take_value(&mut self, title: &str, value: Unknown, want: &Want) {
        let mut sorted = strangers::Sorted::default();
        let value = Unknown { title: title.to_owned(), place: title.to_owned(), ..value }.unread();
        sorted.take(&self.name, &value, want, &Others::default());
        self.strangers.extend(sorted.strangers);
        self.reading.not_used.extend(sorted.not_used);
    }

    /// What words say of values, or of all of them, is a stranger; whether they do, or are ignored.
    fn take_words(
        &mut self,
        title: &str,
        text: &str,
        is_of_all: bool,
        understood: &Understood,
        want: &Want,
    ) -> Result<bool, Diagnostic> {
        let place = format!("{}, {title}", self.name);
        let stated = |line: &str| understood.contradicted_by(&place, line, want);
        if let Some(refused) = text.lines().filter(|_| !want.ignores(title)).find_map(stated) {
            return Err(refused);
        }
        let (names, measured) = (understood.shape.part_names(), MeasuredValues::of(understood));
        let beside =
            Beside { columns: &understood.columns, width: 0, of_parts: Some(&names), measured: Some(&measured) };
        let lines: Vec<Cell> = text.lines().map(|line| Cell::of_text(line, 0..0)).collect();
        let said = rejection(title, &lines, false).filter(|_| !want.ignores(title));
        self.reading.notes.extend(said.map(|said| said.in_words(&self.name)));
        let value = lines.iter().find_map(|line| beside.value_in_remark(line, title, 0));
        let line = AsideReading { line: 0, text: text.to_owned() };
        let of_all = || of_all_values(&line, &understood.columns, want).filter(|_| is_of_all);
        let Some(value) = value.or_else(of_all) else { return Ok(false) };
        self.take_value(title, value, want);
        Ok(true)
    }

    /// What another sheet of the workbook holds is not used; what of it may be measured is a stranger.
    ///
    /// # Errors
    /// A line that states another unit than that of the values.
    fn take_other(&mut self, sheet: &Sheet, understood: &Understood, want: &Want) -> Result<(), Diagnostic> {
        if sheet.head.is_empty() {
            return Ok(());
        }
        let title = format!("{SHEET}{}", sheet.name);
        if !want.ignores(&sheet.name) && !want.ignores(&title) {
            // headings of columns there say nothing of these
            // nor does a list of units
            let is_line = |record: &&Record| {
                let cells = record.filled();
                record.numbers() == 0 && cells.len() <= 2 && !(cells.len() == 1 && is_unit(&cells[0].text()))
            };
            let mut lines = sheet.head.iter().filter(is_line);
            // a sheet that names both parts says nothing of these
            let said: Vec<Part> = lines.clone().filter_map(|line| part_in_title(&line.in_words())).collect();
            let is_of_one = said.iter().all(|part| *part == said[0]);
            let stated = |line: &Record| {
                let (place, text) = (format!("{}, row {}", sheet.called, line.line), line.in_words());
                let unit = understood.contradicted_by(&place, &text, want);
                unit.or_else(|| said_of_other(&understood.columns, &place, &text, &title, want).filter(|_| is_of_one))
            };
            if let Some(refused) = lines.find_map(stated) {
                return Err(refused);
            }
            let said = sheet.head.iter().filter(|record| record.in_words().trim().contains(' '));
            // Freigabe | nein
            let lines = said.clone().map(|record| Cell::of_text(&record.in_words(), 0..0));
            let cells: Vec<Cell> = said.flat_map(|record| record.cells.iter().cloned()).chain(lines).collect();
            let said = rejection(&title, &cells, false);
            self.reading.notes.extend(said.map(|said| said.in_words(&self.name)));
            let found = strangers::of_sheet(&sheet.called, &sheet.name, &sheet.head, understood, want);
            self.strangers
                .extend(found.strangers.into_iter().map(|found| Stranger { pattern: title.clone(), ..found }));
            self.to_be_named.extend(found.to_be_named);
        }
        self.reading.not_used.push(NotUsed { title, why: "another sheet is read" });
        Ok(())
    }
}

/// The refusal of numbers that their format strikes through, or shows with another unit than the one they are read in.
fn shown_otherwise(name: &str, shown: &Shown, understood: &Understood, in_rows: bool) -> Option<Diagnostic> {
    let (row, text, is_struck_through) = (shown.row, &shown.style.text, shown.style.is_struck_through);
    let unit = Unit::from_symbol(text);
    let lists = [WordList::Disapproval, WordList::Rejected, WordList::Scale];
    let is_other = text.contains(['%', '<', '>', '*'])
        || text.contains(says_more)
        || text.starts_with(['-', '\u{2212}', '/', ','])
        || lists.into_iter().any(|list| list.is_in(text));
    if unit.is_none() && !is_other && !is_struck_through {
        return None;
    }
    let ids = understood.shape.ids.as_ref();
    let ids = ids.filter(|ids| is_struck_through && in_rows && ids.place == shown.column);
    let mut columns = understood.columns.iter().filter(|column| !in_rows || column.place == shown.column);
    let is_refused = |column: &&Column| is_struck_through || is_other || unit.is_some_and(|unit| unit != column.unit);
    let other = columns.find(is_refused);
    let title = other.map(|column| &column.title).or(ids.map(|ids| &ids.title))?;
    let (message, help) = if is_struck_through {
        (
            format!("{name}, row {row}: a cell of `{title}` is struck through"),
            "leave its row out of the table; or show the cell plainly, if it counts",
        )
    } else {
        let other = other?;
        let read_in = other.unit.symbol();
        (
            format!(
                "{name}, row {row}: numbers of `{title}` are shown with `{text}` by their format, and would be read in {read_in}"
            ),
            "let the number format show the numbers as they are, with the unit of the heading",
        )
    };
    Some(Diagnostic::error(Code::BadTable, message).help(help))
}

pub(crate) fn parquet_table(name: &str, mut file: ParquetTable, want: &Want) -> Result<Table, Unclosed> {
    if let Some(layout) = &want.only_contract() {
        return typed_by_contract::parquet(name, file, layout, want);
    }
    let not_used = not_read(&file, want)?;
    let read = file.columns.iter().filter(|column| column.is_read());
    let titles: Vec<_> = read.map(|column| column.name.clone()).collect();
    let all = vec![true; titles.len()];
    file.check()?;
    let head = file.next(&all, HEAD)?.map_or_else(Vec::new, |head| head.columns);
    file.rewind();
    let mut table = stored_table(name, "Parquet", &titles, &head, want)?;
    if file.has_units_of_fields() {
        let said = format!("{name}: its schema has units of fields, which are not read");
        if table.columns.iter().any(|column| column.unit_from == UnitFrom::Key) {
            let help = "write each unit into the name of its column, as in `rack_pitch_mm`";
            let message = format!("{said}, and nothing else tells them");
            return Err(Diagnostic::error(Code::BadTable, message).help(help).into());
        }
        table.reading.notes.push(said);
    }
    if table.pieces.are_rows {
        table.pieces.give_file(file);
    } else {
        let understood = understand_records(name, &whole(name, &mut file, &titles)?, want)?;
        table = Table::new(name, "Parquet", &understood, want);
        table.place = Place::Record;
    }
    table.reading.not_used.extend(not_used);
    Ok(table)
}

/// The columns that are not read.
///
/// # Errors
/// The first that may be a measurement, or say something of one.
fn not_read(file: &ParquetTable, want: &Want) -> Result<Vec<NotUsed>, Diagnostic> {
    let mut not_used = Vec::new();
    for (place, column) in file.columns.iter().enumerate() {
        let Err(why) = &column.leaf else { continue };
        let title = column.name.clone();
        let is_known = heading(&title, &want.own).is_some() || role(&title).is_some();
        let number = Cell::from(Content::Number(Decimal::of_i64(1, 0)));
        let may_matter =
            is_known || is_again(&title) || Unknown::column(&title, place, vec![number]).could_be_measured();
        if may_matter && !want.ignores(&title) {
            return Err(file.refused(&title, why));
        }
        let why = if matches!(why, Unread::Type(_)) { "its type is no number" } else { "its packing is not read" };
        not_used.push(NotUsed { title, why });
    }
    Ok(not_used)
}

/// All records of a file whose parts are not in rows, the header first.
fn whole(name: &str, file: &mut ParquetTable, titles: &[String]) -> Result<Vec<Record>, Diagnostic> {
    const MOST_ROWS: usize = 200_000;
    let mut records = vec![header(titles)];
    let all = vec![true; titles.len()];
    while let Some(StoredRows { columns, before }) = file.next(&all, ROWS_TOGETHER)? {
        let rows = columns.iter().flatten().map(Stored::rows).max().unwrap_or(0);
        records.extend((0..rows).map(|row| stored_record(&columns, row, before)));
        if records.len() > MOST_ROWS {
            let message = format!("{name} has more than {MOST_ROWS} rows, and its parts are not in rows");
            return Err(Diagnostic::error(Code::BadTable, message).help("split it, or write a row per part"));
        }
    }
    Ok(records)
}

/// The names of stored columns.
fn header(titles: &[String]) -> Record {
    Record::new(titles.iter().map(|title| Cell::from(Content::of_text(title))).collect(), 0)
}

/// The first rows of stored columns as records, below their names.
fn head_records(titles: &[String], head: &[Option<Stored<'_>>]) -> Vec<Record> {
    let rows = head.iter().flatten().map(Stored::rows).max().unwrap_or(0).min(HEAD);
    std::iter::once(header(titles)).chain((0..rows).map(|row| stored_record(head, row, 0))).collect()
}

/// A table of stored columns, of which these are the first rows; all of them are given later.
pub(crate) fn stored_table(
    name: &str,
    format: &'static str,
    titles: &[String],
    head: &[Option<Stored<'_>>],
    want: &Want,
) -> Result<Table, Diagnostics> {
    if let Some(layout) = &want.layout {
        return Ok(typed_by_contract::stored(name, format, titles, head, (layout, want))?);
    }
    let records = head_records(titles, head);
    let understood = understand_records(name, &records, want)?;
    let mut table = Table::new(name, format, &understood, want);
    table.reading.header_line = None;
    // rows that are no part say so themselves when they are read
    table.reading.asides.clear();
    table.place = Place::Record;
    Ok(table)
}
