//! The reader of tables, whatever file they are in: any bytes are a table or refused; what is read is as long as its rows;
//! and a batch of it adds up, whatever the number of workers.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rackmesh::batch::{Batch, Layout, Outcome, Packing, Plan, Request, RowSink, Sink, Sinks};
use rackmesh::spec::Spec;
use rackmesh::table::{Container, Source, Table, Want};

const SPEC: &str = "[pair]\nnormal_pressure_angle = 20\n[rack]\nface_width = 19.7\n[limits]\ncenter_distance = \"±0.05\"\n\
                    [errors]\nrack_over_roller = { nominal = 25 }\n[table.columns]\nrack_pitch = { name = \"dp\", unit = \"mm\" }\n";

/// The same with uncertainties, which decide.
const UNCERTAIN: &str = "[pair]\nnormal_pressure_angle = { value = 20, u = 0.02 }\n[rack]\nface_width = 19.7\n\
                         [limits]\ncenter_distance = \"±0.05\"\n[decision]\nrule = \"iso14253\"\n\
                         [errors]\nrack_over_roller = { nominal = 25, u = 0.001 }\nrack_pitch = { u = \"1 um\" }\n\
                         [table.columns]\nrack_pitch = { name = \"dp\", unit = \"mm\" }\n";

fn table(data: &[u8], want: &Want) -> Option<Table> {
    let container = Container::open("fuzz", Source::bytes(data.to_vec()), want).ok()?;
    container.table("fuzz", want).ok()
}

/// Reads the input as it is, as teeth, and as a batch.
pub fn check(data: &[u8]) {
    for teeth in [None, Some(true), Some(false)] {
        let want = Want { teeth, ..Want::default() };
        let Some(table) = table(data, &want) else { continue };
        assert!(!table.reading.to_string().is_empty());
        let columns = table.kinds().count();
        for block in table.blocks().unwrap_or_default() {
            assert!((0..columns).all(|column| block.values(column).len() == block.rows()));
            assert!(block.faults().iter().all(|fault| fault.row < block.rows()));
        }
    }
    for spec in [SPEC, UNCERTAIN] {
        let spec = Arc::new(Spec::parse("fuzz.toml", spec).expect("the spec is valid"));
        batch(&spec, data);
        batch(&spec, &[b"part_id,rack_over_roller,dp\n", data].concat());
    }
}

fn batch(spec: &Arc<Spec>, data: &[u8]) {
    let Some((rows, rejects, outcome)) = run(spec, data, 1) else { return };
    let counts = outcome.counts;
    assert_eq!(counts.rows, counts.pass + counts.fail + counts.indeterminate + counts.unjudged + counts.rejected);
    assert_eq!(outcome.problems.len() as u64, counts.rejected);
    assert_eq!(outcome.quantities[0].statistics.count(), counts.rows - counts.rejected);
    let (again, rejected_again, twice) = run(spec, data, 3).expect("it ran before");
    assert_eq!((&rows, &rejects, twice.counts), (&again, &rejected_again, counts));
    let written = csv::ReaderBuilder::new().from_reader(rows.as_slice()).into_byte_records();
    let written: Vec<_> = written.map(|row| row.expect("what is written is CSV")).collect();
    assert_eq!(written.len() as u64, counts.rows - counts.rejected);
}

/// The rows written, the rejected ones, and the outcome.
fn run(spec: &Arc<Spec>, data: &[u8], workers: usize) -> Option<(Vec<u8>, Vec<u8>, Outcome)> {
    let table = table(data, &spec.want())?;
    let rule = spec.or_zero(rackmesh::spec::keys::DECISION_RULE);
    let request = Request { rule, statistics: true, failures_kept: 5, problems_kept: usize::MAX, ..Request::default() };
    let plan = Plan::new(spec, &table, request).ok()?;
    let layout = Layout::new(&plan, &table).ok()?;
    let (mut rows, mut rejects) = (Vec::new(), Vec::new());
    let sinks = Sinks {
        rows: Some(RowSink::Text(Sink { writer: &mut rows, packing: Packing::None })),
        rejects: Some(Sink { writer: &mut rejects, packing: Packing::None }),
        parts: None,
    };
    let mut batch = Batch::new(&plan, sinks, Some(workers));
    // packed files may be broken in the middle
    let _ = batch.run(table, &layout, &AtomicBool::new(false), &mut |_| {});
    let (outcome, _) = batch.finish();
    Some((rows, rejects, outcome))
}
