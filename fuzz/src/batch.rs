//! The batch reader: any bytes are a table or refused; counts add up, whatever the number of workers; and where
//! the `csv` crate reads the table as it stands, the same records are found.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rackmesh::batch::{Batch, Dialect, Input, Layout, Outcome, Packing, Plan, Request, Sink, Sinks};
use rackmesh::spec::Spec;

const SPEC: &str = "[pair]\nnormal_pressure_angle = 20\n[rack]\nface_width = 19.7\n[limits]\ncenter_distance = \"±0.05\"\n\
                    [errors]\nrack_over_roller = { nominal = 25 }\n[batch.columns]\nrack_pitch = { name = \"dp\" }\n";

/// The same with uncertainties, which decide.
const UNCERTAIN: &str = "[pair]\nnormal_pressure_angle = { value = 20, u = 0.02 }\n[rack]\nface_width = 19.7\n\
                         [limits]\ncenter_distance = \"±0.05\"\n[decision]\nrule = \"iso14253\"\n\
                         [errors]\nrack_over_roller = { nominal = 25, u = 0.001 }\nrack_pitch = { u = \"1 um\", dof = 9 }\n\
                         [batch.columns]\nrack_pitch = { name = \"dp\" }\n";

/// The rows written, the rejected ones, and the outcome.
fn run(spec: &Arc<Spec>, data: &[u8], workers: usize) -> Option<(Vec<u8>, Vec<u8>, Outcome)> {
    let input = Input::open("fuzz.csv", Box::new(std::io::Cursor::new(data.to_vec())), Dialect::default()).ok()?;
    let rule = spec.rule.as_ref().map(|rule| rule.value.clone()).unwrap_or_default();
    let request = Request { rule, statistics: true, failures_kept: 5, problems_kept: usize::MAX, ..Request::default() };
    let plan = Plan::new(spec, &input.header, request).ok()?;
    let layout = Layout::new(&plan, &input.header).ok()?;
    let (mut rows, mut rejects) = (Vec::new(), Vec::new());
    let sinks = Sinks {
        rows: Some(Sink { writer: &mut rows, packing: Packing::None }),
        rejects: Some(Sink { writer: &mut rejects, packing: Packing::None }),
    };
    let mut batch = Batch::new(&plan, sinks, Some(workers));
    // packed files may be broken in the middle
    let _ = batch.run(input, &layout, &AtomicBool::new(false), &mut |_| {});
    let (outcome, _) = batch.finish();
    Some((rows, rejects, outcome))
}

/// Runs the input as a table below a header that is known, and by itself.
pub fn check(data: &[u8]) {
    for spec in [SPEC, UNCERTAIN] {
        check_with(&Arc::new(Spec::parse("fuzz.toml", spec).expect("the spec is valid")), data);
    }
}

fn check_with(spec: &Arc<Spec>, data: &[u8]) {
    // whatever it is: no panic
    let _ = run(spec, data, 1);
    let table = [b"part_id,rack_over_roller,dp\n", data].concat();
    let Some((rows, rejects, outcome)) = run(spec, &table, 1) else { return };
    let counts = outcome.counts;
    assert_eq!(counts.rows, counts.pass + counts.fail + counts.indeterminate + counts.unjudged + counts.rejected);
    assert_eq!(outcome.problems.len() as u64, counts.rejected);
    assert_eq!(outcome.statistics[0].count(), counts.rows - counts.rejected);
    let (again, rejected_again, twice) = run(spec, &table, 3).expect("it ran before");
    assert_eq!((&rows, &rejects, twice.counts), (&again, &rejected_again, counts));
    let written = csv::ReaderBuilder::new().from_reader(rows.as_slice()).into_byte_records();
    let written: Vec<_> = written.map(|row| row.expect("what is written is CSV")).collect();
    assert_eq!(written.len() as u64, counts.rows - counts.rejected);
    let longest = data.split(|byte| *byte == b'\n').map(<[u8]>::len).max().unwrap_or(0);
    if longest < 1 << 17 && !rejects_open_quote(&outcome) {
        let reader = csv::ReaderBuilder::new().flexible(true).from_reader(table.as_slice());
        assert_eq!(reader.into_byte_records().count() as u64, counts.rows);
    }
}

/// A quote that is not closed is refused here, and an end of the table for the `csv` crate.
fn rejects_open_quote(outcome: &Outcome) -> bool {
    outcome.problems.iter().any(|problem| problem.message.starts_with("a quote is not closed"))
}
