//! Files through the reader and the batch, as the command line takes them there.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rackmesh::batch::{Batch, Decimals, Layout, Outcome, Packing, Plan, Request, RowSink, Sink, Sinks};
use rackmesh::deviation::{DeviationKind, DeviationValue};
use rackmesh::spec::Spec;
use rackmesh::table::{Container, Source, Table, Want};

/// What a batch made of a table.
pub struct Judged {
    /// Names and verdicts, in the order of the rows written.
    pub verdicts: Vec<Verdict>,
    pub outcome: Outcome,
    /// Whether a limit is not judged.
    pub is_open: bool,
    /// Whether the run came to the table's end.
    pub is_whole: bool,
    /// The rows as they are written.
    pub rows: Vec<u8>,
}

/// A part and its verdict.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    pub name: String,
    pub verdict: String,
}

/// The values of a table, and what is wrong with its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    pub columns: Vec<(DeviationKind, Vec<DeviationValue>)>,
    pub rows: usize,
    /// Rows that are no parts, each once.
    pub faults: Vec<usize>,
    /// How it was read, in words.
    pub reading: String,
}

/// The spec of a text.
pub fn spec(text: &str) -> Arc<Spec> {
    Arc::new(Spec::parse("spec.toml", text).unwrap_or_else(|problem| panic!("{problem}\n{text}")))
}

/// Finds a table's columns; nothing is read of one that is not understood.
pub fn table(bytes: &[u8], want: &Want) -> Result<Table, String> {
    let refused = |problem: rackmesh::diagnostic::Diagnostics| format!("{problem} {:?}", problem.0[0].help);
    let container = Container::open("the table", Source::bytes(bytes.to_vec()), want).map_err(refused)?;
    let table = container.table("the table", want).map_err(refused)?;
    match rackmesh::table::refusal(&table.strangers, &table.to_be_named) {
        Some(problem) => Err(problem.to_string()),
        None => Ok(table),
    }
}

/// Reads the values of a table.
pub fn values(bytes: &[u8], want: &Want) -> Result<Values, String> {
    let table = table(bytes, want)?;
    let kinds: Vec<_> = table.kinds().collect();
    let reading = table.reading.to_string();
    let mut values = Values {
        columns: kinds.iter().map(|kind| (*kind, Vec::new())).collect(),
        rows: 0,
        faults: Vec::new(),
        reading,
    };
    for block in table.blocks().map_err(|error| error.to_string())? {
        for (index, (_, column)) in values.columns.iter_mut().enumerate() {
            block.values(index).for_each(|value| column.push(value));
        }
        values.faults.extend(block.faults().iter().map(|fault| values.rows + fault.row));
        values.rows += block.rows();
    }
    values.faults.dedup();
    Ok(values)
}

impl Values {
    /// The values of an error.
    pub fn of(&self, kind: DeviationKind) -> Option<&[DeviationValue]> {
        self.columns.iter().find(|(other, _)| *other == kind).map(|(_, values)| values.as_slice())
    }
}

/// Judges the parts of a table.
pub fn judge(bytes: &[u8], spec: &Arc<Spec>, workers: usize) -> Result<Judged, String> {
    let table = table(bytes, &spec.want())?;
    let request = Request { decimals: Decimals::Full, problems_kept: 100, statistics: true, ..Request::default() };
    let plan = Plan::new(spec, &table, request).map_err(|problem| problem.to_string())?;
    let layout = Layout::new(&plan, &table).map_err(|problem| problem.to_string())?;
    let mut rows = Vec::new();
    let sinks = Sinks { rows: Some(RowSink::Text(Sink { writer: &mut rows, packing: Packing::None })), rejects: None };
    let mut batch = Batch::new(&plan, sinks, Some(workers));
    let run = batch.run(table, &layout, &AtomicBool::new(false), &mut |_| {});
    let (outcome, _) = batch.finish();
    let mut reader = csv::Reader::from_reader(rows.as_slice());
    let verdicts = reader.records().map(|row| {
        let row = row.unwrap();
        Verdict { name: row[0].to_owned(), verdict: row[row.len() - 1].to_owned() }
    });
    let verdicts = verdicts.collect();
    Ok(Judged { verdicts, outcome, is_open: !plan.unjudged.is_empty(), is_whole: run.is_ok(), rows })
}

impl Judged {
    /// Whether the program would say that everything passes.
    pub fn passes(&self) -> bool {
        let counts = self.outcome.counts;
        self.is_whole && !self.is_open && counts.rows > 0 && counts.pass == counts.rows
    }
}
