//! Tables of files whose cells are typed: workbooks, Parquet, stored columns. Their columns are found from the first records.
//! Called by [`Container::table`](super::Container::table).

use crate::diagnostic::{Code, Diagnostic};
use crate::table::Table;
use crate::table::account::Unclosed;
use crate::table::cell::{Cell, Content, Record, head_rows, refuse_many};
use crate::table::contract::{File, Found, Open, found, is_in_rows, needs_all, of_records, with_headings};
use crate::table::layout::OwnRule;
use crate::table::ledger::Tally;
use crate::table::parquet::{ParquetTable, ROWS_TOGETHER, StoredColumn, StoredRows, Unread};
use crate::table::pieces::Place;
use crate::table::rows::stored_record;
use crate::table::stored::Stored;
use crate::table::want::Want;
use crate::table::workbook::Workbook;

/// The table of a workbook: of the sheet that is named, or of the only one with cells.
pub(crate) fn workbook_table(mut book: Workbook, want: &Want) -> Result<Table, Unclosed> {
    let layout = &want.contract();
    let mut filled = Vec::new();
    for name in book.candidates(layout.sheet.as_deref())? {
        if !book.head(&name, layout.range, 1)?.is_empty() {
            filled.push(name);
        }
    }
    let sheet = match filled.as_slice() {
        [] => return Err(Diagnostic::error(Code::BadTable, "no sheet of the workbook has cells").into()),
        [sheet] => sheet.clone(),
        _ => return Err(Unclosed::of(&book.called(""), layout, Open::Sheets { names: filled })),
    };
    let mut head = book.head(&sheet, layout.range, usize::MAX)?;
    let others = book.others(&sheet);
    let records = book.records(&sheet, layout.range);
    let (count, above) = (head.len(), with_headings(layout));
    if let Some(heading) = above {
        head.insert(0, heading);
    }
    let name = records.name.clone();
    let mut file = File::new(&name, "workbook");
    for comment in &records.comments {
        let text = comment.text.lines().collect::<Vec<_>>().join(" ");
        file.comment(layout, &comment.place, &text);
    }
    for (name, digest) in others {
        file.leave_out(layout.own_rule(OwnRule::OtherSheets), digest.into(), &name);
    }
    let mut table = of_records(&file, head, records.records.skip(count), layout, want)?;
    table.place = if table.reading.parts_in == "columns" { Place::Record } else { Place::SheetRow };
    table.reading.notes.extend(records.hidden.map(|hidden| format!("{name}: read like the others: {hidden}")));
    Ok(table)
}

/// Refuses a file without a column that can be read, if one is packed in a way that is not read.
fn refuse_packed(name: &str, file: &ParquetTable) -> Result<(), Diagnostic> {
    let why = |column: &StoredColumn| match &column.leaf {
        Err(Unread::Packing(why)) => Some(why.clone()),
        _ => None,
    };
    let packing = file.columns.iter().find_map(why).filter(|_| file.columns.iter().all(|column| !column.is_read()));
    packing.map_or(Ok(()), |why| {
        let help = "write it with snappy, gzip or no compression, and without DELTA encodings";
        Err(Diagnostic::unreadable(name, &format!("it is {why}")).help(help))
    })
}

/// The table of a Parquet file. Columns that a rule leaves out are not unpacked: the digest is of their stored bytes.
pub(crate) fn parquet_table(name: &str, mut file: ParquetTable, want: &Want) -> Result<Table, Unclosed> {
    let layout = &want.contract();
    file.check()?;
    refuse_packed(name, &file)?;
    let mut of = File::new(name, "Parquet");
    let mut unread = Vec::new();
    for (place, column) in file.columns.iter().enumerate() {
        let Err(why) = &column.leaf else { continue };
        let rule =
            [true, false].into_iter().find_map(|exactly| layout.ignores(&column.name, &column.name, place, exactly));
        if let Some(rule) = rule.or_else(|| layout.ignores_others.then(|| layout.own_rule(OwnRule::Others))) {
            unread.push((rule, place, column.name.clone()));
        } else {
            let (Unread::Type(why) | Unread::Packing(why)) = why;
            let (title, first) = (column.name.clone(), vec![format!("it is {why}")]);
            of.open.push(Open::Column { place, title, first, may_decide: false });
        }
    }
    let of_fields = file.remarks_of_fields().into_iter().map(|(key, value)| format!("{key}: {value}"));
    for text in file.remarks().map(|(key, value)| format!("{key}: {value}")).chain(of_fields) {
        of.comment(layout, "metadata", &text);
    }
    let places: Vec<usize> = (0..file.columns.len()).filter(|place| file.columns[*place].is_read()).collect();
    let titles: Vec<String> = places.iter().map(|place| file.columns[*place].name.clone()).collect();
    if !layout.headings.is_empty() {
        let message = format!("{name} has headings, and --as is for tables without any");
        return Err(Diagnostic::error(Code::Usage, message).help("leave --as out").into());
    }
    let mut head = if needs_all(layout) {
        whole(name, &mut file, &titles)?
    } else {
        let (columns, rows) = file.head(head_rows(titles.len()))?;
        head_records(&titles, &columns, rows)
    };
    file.rewind();
    if !is_in_rows(&head, layout) {
        head = whole(name, &mut file, &titles)?;
        file.rewind();
    }
    let Found { mut table, above, turned, .. } = found(&of, &head, layout, want)?;
    if table.reading.parts_in == "columns" {
        let message = format!("{name}: the parts of a Parquet file are its rows");
        return Err(Diagnostic::error(Code::BadTable, message).into());
    }
    for (rule, place, title) in unread.into_iter().chain(table.left_out_columns(&places)) {
        let tally = Tally { count: 1, first: vec![title], digest: file.stored_digest(place) };
        table.reading.left_out[rule].tally.join(&tally);
    }
    table.reading.header_line = None;
    table.place = Place::Record;
    match turned {
        Some(rows) => table.pieces.give_records(rows.into_iter().skip(above).map(Ok)),
        None => table.pieces.give_file(file),
    }
    Ok(table)
}

/// A table of stored columns, of which these are the first rows.
pub(crate) fn stored_table(
    name: &str,
    format: &'static str,
    titles: &[String],
    head: &[Option<Stored<'_>>],
    want: &Want,
) -> Result<Table, Unclosed> {
    let layout = &want.contract();
    let rows = head.iter().flatten().map(Stored::rows).max().unwrap_or(0).min(head_rows(titles.len()));
    let head = head_records(titles, head, rows);
    let Found { mut table, turned, .. } = found(&File::new(name, format), &head, layout, want)?;
    if turned.is_some() {
        let message = format!("{name}: each row of stored columns is a part");
        return Err(Diagnostic::error(Code::BadTable, message).into());
    }
    table.reading.header_line = None;
    table.place = Place::Record;
    Ok(table)
}

/// All records of a file whose parts are not in rows, the header first.
fn whole(name: &str, file: &mut ParquetTable, titles: &[String]) -> Result<Vec<Record>, Diagnostic> {
    let (mut records, mut cells) = (vec![header(titles)], 0);
    let all = vec![true; titles.len()];
    while let Some(StoredRows { columns, before }) = file.next(&all, ROWS_TOGETHER)? {
        let rows = columns.iter().flatten().map(Stored::rows).max().unwrap_or(0);
        cells = refuse_many(name, cells + rows * titles.len())?;
        records.extend((0..rows).map(|row| stored_record(&columns, row, before)));
    }
    Ok(records)
}

/// The names of stored columns.
fn header(titles: &[String]) -> Record {
    Record::new(titles.iter().map(|title| Cell::from(Content::of_text(title))).collect(), 0)
}

/// The first rows of stored columns as records, below their names.
fn head_records(titles: &[String], head: &[Option<Stored<'_>>], rows: usize) -> Vec<Record> {
    std::iter::once(header(titles)).chain((0..rows).map(|row| stored_record(head, row, 0))).collect()
}
