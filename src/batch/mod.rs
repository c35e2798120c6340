//! The parts of tables of any length: ΔCD of each, through the formulas.
//!
//! The command line reads tables ([`crate::table`]), makes a [`Plan`] from the spec, the first table's columns and the request,
//! and runs each table through a [`Batch`]. Rows come out in the table's order, rejected rows separately and unchanged, and
//! counts and statistics as an [`Outcome`]. Nothing here opens files or prints, or knows from which file a column is.
//!
//! | module | what it is |
//! |---|---|
//! | `layout`, `asked`, `plan`, `source`, `output` | which column holds what; what is computed and written |
//! | `uncertain`, `meshed` | the uncertainty of results; the exact mesh where it judges |
//! | `number`, `write`, `rows` | results as text |
//! | `evaluate`, `results` | some rows: columns of deviations, their results, the verdicts |
//! | `run`, `pack`, `ledger` | pieces through all cores, in order; where results go, and the counts that are kept |
//! | `columns`, `cells`, `parquet` | results in columns, rows that are no parts, and columns as Parquet |
//! | `in_memory` | columns that a program has, in place of files |
//! | `teeth` | tables with a row per tooth, through the exact mesh |
//! | `outcome`, `duplicates`, `statistics`, `capability` | counts, problems, the worst parts, statistics in one pass |
//!
//! # Right to the last digit
//! A cell such as `25.0131` becomes a [`Length`](crate::quantity::Length), from which the nominal value is taken:
//! differences are decimal differences. ΔCD, the combinations and the verdict are computed by the functions that
//! [`evaluate`](crate::evaluation::evaluate) calls.
//!
//! # Example
//! ```
//! use std::sync::Arc;
//! use std::sync::atomic::AtomicBool;
//! use rackmesh::batch::{Batch, Layout, Packing, Plan, Request, RowSink, Sink, Sinks};
//! use rackmesh::spec::Spec;
//! use rackmesh::table::{Container, Source};
//!
//! let spec = "[errors]\nrack_over_roller = { nominal = 25.0 }\n[limits]\ncenter_distance = \"±0.02\"";
//! let spec = Arc::new(Spec::parse("rack.toml", spec)?);
//! let bytes = "part_id,rack_over_roller\nP1,25.0131\nP2,25.0201\n";
//! let container = Container::open("parts.csv", Source::bytes(bytes.into()), &spec.want())?;
//! let table = container.table("parts.csv", &spec.want())?;
//! let plan = Plan::new(&spec, &table, Request::default())?;
//! let layout = Layout::new(&plan, &table)?;
//! let mut rows = Vec::new();
//! let rows_sink = RowSink::Text(Sink { writer: &mut rows, packing: Packing::None });
//! let sinks = Sinks { rows: Some(rows_sink), ..Sinks::default() };
//! let mut batch = Batch::new(&plan, sinks, None);
//! batch.run(table, &layout, &AtomicBool::new(false), &mut |_| {})?;
//! let (outcome, _) = batch.finish();
//! assert_eq!((outcome.counts.pass, outcome.counts.fail), (1, 1));
//! let rows = String::from_utf8(rows).expect("CSV is text");
//! assert_eq!(rows.lines().nth(1), Some("P1,0.013100,0.013100,0.013100,,,0.006900,pass,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod asked;
mod capability;
mod cells;
mod columns;
mod duplicates;
mod evaluate;
mod in_memory;
mod layout;
mod ledger;
mod meshed;
mod number;
mod outcome;
mod output;
mod pack;
mod parquet;
mod plan;
mod request;
mod results;
mod rows;
mod run;
mod source;
mod statistics;
mod teeth;
mod uncertain;
mod write;

pub use asked::refuse_without_uncertainty;
pub use capability::Capability;
pub use cells::CellRows;
pub use columns::{ColumnKind, ResultCell, ResultColumn, ResultColumns, ResultValues};
pub use duplicates::Duplicates;
pub use in_memory::{ColumnEvaluator, ColumnPiece, EvaluatedColumns};
pub use layout::Layout;
pub use ledger::{ColumnSink, RowSink, Sink, Sinks};
pub use number::{Decimals, NoDecimals};
pub use outcome::{Counts, Outcome, Part, PartError, PartSink, Problem, Quantity, RowPlace};
pub use pack::Packing;
pub use parquet::ParquetRows;
pub use plan::Plan;
pub use request::{Request, RowFormat, Rows};
pub use run::{Batch, Progress, RunError};
pub use statistics::{MOST_TESTED, QUANTILES, Statistics};
pub use teeth::{JudgedTeeth, Teeth, TeethJudge, TeethRequest};
