//! Tables of parts, judged as `rackmesh batch` judges them.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use arrow_array::RecordBatch;
use arrow_schema::{ArrowError, SchemaRef};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3_arrow::input::AnyRecordBatch;
use pyo3_arrow::{PyRecordBatch, PySchema, PyTable};
use rackmesh::batch::{ColumnEvaluator, ColumnPiece, EvaluatedColumns, Request};
use rackmesh::diagnostic::Diagnostics;
use rackmesh::formula::Model;
use rackmesh::judge::{Rule, Stack};
use rackmesh::spec::keys;
use rackmesh::table::Stored;

use crate::arrow;
use crate::error::raised;
use crate::spec::Spec;

/// The arguments of `Plan`.
#[derive(Debug, Clone)]
struct Asked {
    columns: Option<Vec<String>>,
    stack: String,
    rule: Option<String>,
    model: String,
    ignore: Vec<String>,
    partial: bool,
    threads: usize,
}

/// Judges tables of parts: the ΔCD of each error, the worst case, and the verdict.
#[pyclass(frozen, module = "rackmesh")]
pub(crate) struct Plan {
    spec: Py<Spec>,
    asked: Asked,
    evaluator: Arc<ColumnEvaluator>,
}

/// Rows that are worth a thread of their own.
const LEAST_ROWS: usize = 1 << 14;
/// How often Python's signals are checked.
const CHECKED: Duration = Duration::from_millis(50);

impl Asked {
    fn request(&self, of_spec: Option<Rule>) -> PyResult<Request> {
        let unknown =
            |what: &str, value: &str, known: &str| PyValueError::new_err(format!("{what}={value:?}: write {known}"));
        let rule = match &self.rule {
            None => of_spec.unwrap_or_default(),
            Some(rule) => rule.parse().map_err(|problem| PyValueError::new_err(format!("rule={rule:?}: {problem}")))?,
        };
        Ok(Request {
            model: match self.model.as_str() {
                "exact" => Model::Exact,
                "paper" => Model::Paper,
                other => return Err(unknown("model", other, "'exact' or 'paper'")),
            },
            stack: match self.stack.as_str() {
                "worst_case" | "worst-case" | "worst" | "range" => Stack::Range,
                "rss" => Stack::Rss,
                other => return Err(unknown("stack", other, "'worst_case', 'range' or 'rss'")),
            },
            rule,
            columns: self.columns.clone(),
            partial: self.partial,
            ..Request::default()
        })
    }
}

/// Why a table has no results.
enum NoResults {
    Refused(Diagnostics),
    Arrow(ArrowError),
    /// The exception that a signal raises in Python, such as `KeyboardInterrupt`.
    Signal(PyErr),
}

impl From<ArrowError> for NoResults {
    fn from(error: ArrowError) -> Self {
        Self::Arrow(error)
    }
}

impl From<Diagnostics> for NoResults {
    fn from(problems: Diagnostics) -> Self {
        Self::Refused(problems)
    }
}

impl NoResults {
    fn raised(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Signal(error) => error,
            Self::Refused(problems) => raised(py, &problems),
            Self::Arrow(error) => PyValueError::new_err(error.to_string()),
        }
    }
}

impl Plan {
    fn make(py: Python<'_>, spec: Py<Spec>, asked: Asked) -> PyResult<Self> {
        let Spec { held, settings } = spec.get();
        let judged =
            py.detach(|| rackmesh::cli::judged_spec(held, settings)).map_err(|problems| raised(py, &problems))?;
        let request = asked.request(judged.get(keys::DECISION_RULE))?;
        let evaluator = Arc::new(ColumnEvaluator::new(&Arc::new(judged), &asked.ignore, request));
        Ok(Self { spec, asked, evaluator })
    }

    /// Calls `of` with the columns of a batch, before which the table has so many rows.
    fn with_columns<T>(
        batch: &RecordBatch,
        before: u64,
        of: impl FnOnce(&ColumnPiece<'_>) -> Result<T, Diagnostics>,
    ) -> Result<T, NoResults> {
        let arrays: Vec<_> = batch.columns().iter().map(arrow::plain).collect::<Result<_, _>>()?;
        let columns: Vec<Option<Stored<'_>>> = arrays.iter().map(arrow::stored).collect();
        let titles: Vec<String> = batch.schema_ref().fields().iter().map(|field| field.name().clone()).collect();
        Ok(of(&ColumnPiece { name: "table", before, titles: &titles, columns: &columns })?)
    }

    /// Evaluates batches on the threads of the plan; results are in the order of the batches. Python's signals are checked, so
    /// that Ctrl-C ends the run.
    fn evaluate_all(&self, batches: &[RecordBatch]) -> Result<Vec<RecordBatch>, NoResults> {
        let mut before = 0;
        let pieces: Vec<(u64, RecordBatch)> = batches
            .iter()
            .flat_map(|batch| pieces(batch, self.asked.threads))
            .map(|piece| {
                let rows = piece.num_rows() as u64;
                before += rows;
                (before - rows, piece)
            })
            .collect();
        let workers = self.asked.threads.clamp(1, pieces.len().max(1));
        let mut results: Vec<Option<Result<RecordBatch, NoResults>>> = Vec::new();
        results.resize_with(pieces.len(), || None);
        let (stop, signal) = (AtomicBool::new(false), OnceLock::new());
        let check = || {
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                stop.store(true, Ordering::Relaxed);
                let _ = signal.set(error);
            }
        };
        let evaluate = |(before, batch): &(u64, RecordBatch)| {
            let mut checked = Instant::now();
            let goes_on = || {
                if checked.elapsed() > CHECKED {
                    checked = Instant::now();
                    check();
                }
                !stop.load(Ordering::Relaxed)
            };
            let EvaluatedColumns { columns, results, .. } =
                Self::with_columns(batch, *before, |piece| self.evaluator.evaluate_while(piece, goes_on))?;
            Ok(arrow::batch(&columns, results, Some(Arc::clone(&self.evaluator)))?)
        };
        std::thread::scope(|scope| {
            let mut of_worker: Vec<Vec<_>> = (0..workers).map(|_| Vec::new()).collect();
            for (index, (piece, result)) in pieces.iter().zip(&mut results).enumerate() {
                of_worker[index % workers].push((piece, result));
            }
            let mut rest = of_worker.into_iter();
            let own = rest.next();
            let work = |own: Vec<(&(u64, RecordBatch), &mut Option<_>)>| {
                own.into_iter().for_each(|(piece, result)| *result = Some(evaluate(piece)));
            };
            rest.for_each(|more| drop(scope.spawn(move || work(more))));
            own.into_iter().for_each(work);
        });
        match signal.into_inner() {
            Some(error) => Err(NoResults::Signal(error)),
            None => results.into_iter().flatten().collect(),
        }
    }

    fn schema_of(&self, batch: &RecordBatch) -> Result<SchemaRef, NoResults> {
        let columns = Self::with_columns(batch, 0, |piece| self.evaluator.columns(piece))?;
        Ok(Arc::new(arrow::schema(&columns)))
    }
}

/// A batch in a piece for each of so many threads, or fewer if it is small; one without rows is one piece.
fn pieces(batch: &RecordBatch, threads: usize) -> Vec<RecordBatch> {
    let rows = batch.num_rows();
    let each = rows.div_ceil(threads.max(1)).max(LEAST_ROWS);
    (0..rows.max(1)).step_by(each).map(|start| batch.slice(start, each.min(rows - start))).collect()
}

#[pymethods]
impl Plan {
    #[new]
    #[pyo3(signature = (spec, *, columns = None, stack = "worst_case", rule = None, model = "exact", ignore = Vec::new(), partial = false, threads = 1))]
    #[expect(clippy::too_many_arguments, reason = "options that Python gives by name")]
    fn new(
        py: Python<'_>,
        spec: Py<Spec>,
        columns: Option<Vec<String>>,
        stack: &str,
        rule: Option<String>,
        model: &str,
        ignore: Vec<String>,
        partial: bool,
        threads: usize,
    ) -> PyResult<Self> {
        let (stack, model) = (stack.to_owned(), model.to_owned());
        Self::make(py, spec, Asked { columns, stack, rule, model, ignore, partial, threads })
    }

    /// Judges the parts of a record batch or a table; the result has one row for each, in their order.
    fn evaluate<'py>(&self, py: Python<'py>, data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (batches, schema, is_batch) = match data.extract::<AnyRecordBatch>()? {
            AnyRecordBatch::RecordBatch(batch) => {
                let batch = batch.into_inner();
                let schema = batch.schema();
                (vec![batch], schema, true)
            }
            stream @ AnyRecordBatch::Stream(_) => {
                let (batches, schema) = stream.into_table()?.into_inner();
                (batches, schema, false)
            }
        };
        let empty = RecordBatch::new_empty(schema);
        let batches = if batches.is_empty() { vec![empty] } else { batches };
        let results = py.detach(|| self.evaluate_all(&batches));
        py.check_signals()?;
        let results = results.map_err(|problem| problem.raised(py))?;
        let schema = results[0].schema();
        let table = || PyTable::try_new(results.clone(), Arc::clone(&schema));
        if is_batch {
            let joined = joined(&schema, &results)?;
            return like(py, data, PyRecordBatch::new(joined).into_pyobject(py)?.into_any(), "record_batch");
        }
        like(py, data, table()?.into_pyobject(py)?.into_any(), "table")
    }

    /// The schema of the results of `evaluate` for such data: a record batch, a table or a schema.
    fn schema<'py>(&self, py: Python<'py>, data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let schema = match data.extract::<PySchema>() {
            Ok(schema) => schema.into_inner(),
            Err(_) => data.extract::<AnyRecordBatch>()?.schema()?,
        };
        let schema = self.schema_of(&RecordBatch::new_empty(schema)).map_err(|problem| problem.raised(py))?;
        like(py, data, PySchema::new(schema).into_pyobject(py)?.into_any(), "schema")
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Self { spec, asked, .. } = slf.get();
        let again = py.import("rackmesh._types")?.getattr("plan_again")?;
        let Asked { columns, stack, rule, model, ignore, partial, threads } = asked.clone();
        let arguments = (spec.clone_ref(py), columns, stack, rule, model, ignore, partial, threads);
        Ok((again, arguments).into_pyobject(py)?.into_any())
    }

    fn __repr__(&self) -> String {
        format!("<rackmesh.Plan of {}>", self.spec.get().held.name)
    }
}

/// The pieces of a batch joined to one batch.
fn joined(schema: &SchemaRef, batches: &[RecordBatch]) -> PyResult<RecordBatch> {
    match batches {
        [one] => Ok(one.clone()),
        all => {
            arrow_select::concat::concat_batches(schema, all).map_err(|error| PyValueError::new_err(error.to_string()))
        }
    }
}

/// Results as objects of the library of the data, pyarrow or polars; for other libraries, an object with Arrow's C interface.
fn like<'py>(
    py: Python<'py>,
    data: &Bound<'py, PyAny>,
    results: Bound<'py, PyAny>,
    maker: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let module: String = data.get_type().module()?.extract()?;
    match module.split('.').next() {
        Some("pyarrow") => py.import("pyarrow")?.getattr(maker)?.call1((results,)),
        Some("polars") if maker != "schema" => py.import("polars")?.getattr("DataFrame")?.call1((results,)),
        _ => Ok(results),
    }
}
