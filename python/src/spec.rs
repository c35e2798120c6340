//! Specs, and the answers of commands about them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyList, PyString, PyType};
use pyo3_arrow::PyRecordBatch;
use rackmesh::cli::{self, Answer, ColumnTable, HeldSpec};
use rackmesh::diagnostic::Diagnostics;
use serde_json::Value;

use crate::arrow;
use crate::error::{diagnostic, raised};

/// A gear spec: TOML text, and keys that are set in place of those of the text. It does not change; `set` returns another one.
#[pyclass(frozen, module = "rackmesh")]
#[derive(Debug, Clone)]
pub(crate) struct Spec {
    pub(crate) held: HeldSpec,
    pub(crate) settings: Vec<String>,
}

impl Spec {
    fn checked(py: Python<'_>, held: HeldSpec, settings: Vec<String>) -> PyResult<Self> {
        rackmesh::spec::Spec::parse_with(&held.name, &held.text, &settings)
            .map_err(|problems| raised(py, &problems))?;
        Ok(Self { held, settings })
    }
}

/// Options of a command as its arguments: `worst_teeth=True` is `--worst-teeth`.
fn flags(options: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<String>> {
    let mut arguments = Vec::new();
    for (name, value) in options.into_iter().flatten() {
        let flag = format!("--{}", name.str()?.to_str()?.replace('_', "-"));
        match value.extract::<bool>() {
            Ok(true) => arguments.push(flag),
            Ok(false) => {}
            Err(_) if value.is_none() => {}
            Err(_) if value.is_instance_of::<PyList>() => {
                arguments.push(flag);
                for one in value.try_iter()? {
                    arguments.push(one?.str()?.to_string());
                }
            }
            Err(_) => arguments.push(format!("{flag}={}", value.str()?)),
        }
    }
    Ok(arguments)
}

/// The answer of a command as a `rackmesh.Answer`; `ask` runs the command and stops when the flag is set.
fn answered<'py>(
    py: Python<'py>,
    command: &str,
    ask: impl FnOnce(&Arc<AtomicBool>) -> Result<Answer, Diagnostics> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let answered = py.detach(|| until_signal(ask))?;
    let Answer { json, markdown, svg, table, warnings, remarks, status } =
        answered.map_err(|problems| raised(py, &problems))?;
    let warnings: Vec<_> = warnings.iter().map(|warning| diagnostic(py, warning)).collect::<PyResult<_>>()?;
    let batch = table.map(|ColumnTable { columns, results }| arrow::batch(&columns, results, None)).transpose();
    let batch = batch.map_err(|error| PyValueError::new_err(error.to_string()))?.map(PyRecordBatch::new);
    let answer = py.import("rackmesh._types")?.getattr("Answer")?;
    answer.call1((command, as_python(py, &json)?, markdown, svg, warnings, remarks, status, batch))
}

impl Spec {
    /// The answer of a command about the spec.
    fn ask<'py>(
        &self,
        py: Python<'py>,
        command: &str,
        mut arguments: Vec<String>,
        options: Option<&Bound<'py, PyDict>>,
        behind: Option<Vec<String>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        arguments.extend(flags(options)?);
        arguments.extend(self.settings.iter().flat_map(|setting| ["--set".to_owned(), setting.clone()]));
        arguments.extend(behind.into_iter().flat_map(|behind| std::iter::once("--".to_owned()).chain(behind)));
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        answered(py, command, |stop| cli::answer(command, &arguments, self.held.clone(), stop))
    }
}

/// Specs side by side: `rackmesh compare`.
#[pyfunction]
#[pyo3(signature = (*specs, **options))]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    specs: Vec<Py<Spec>>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let arguments = flags(options)?;
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let held = specs.iter().map(|spec| (spec.get().held.clone(), spec.get().settings.clone())).collect();
    answered(py, "compare", |stop| cli::compare(&arguments, held, stop))
}

/// Runs a call that checks a flag from time to time. The flag is set when Python has a signal such as Ctrl-C, whose exception is
/// raised in place of the result.
fn until_signal<T: Send>(run: impl FnOnce(&Arc<AtomicBool>) -> T + Send) -> PyResult<T> {
    /// The time between two checks of Python's signals.
    const INTERVAL: Duration = Duration::from_millis(50);
    let (stop, waiting) = (Arc::new(AtomicBool::new(false)), thread::current());
    thread::scope(|scope| {
        let running = scope.spawn(|| {
            let result = run(&stop);
            waiting.unpark();
            result
        });
        let mut signalled = Ok(());
        while !running.is_finished() {
            thread::park_timeout(INTERVAL);
            if signalled.is_ok() {
                signalled = Python::attach(|py| py.check_signals());
                stop.store(signalled.is_err(), Ordering::Relaxed);
            }
        }
        let result = running.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        signalled.map(|()| result)
    })
}

/// Strokes and ΔCD, two iterables of numbers, as a table.
fn trace(measured: &Bound<'_, PyAny>) -> PyResult<String> {
    let column = |at: usize| -> PyResult<Vec<f64>> {
        measured.get_item(at)?.try_iter()?.map(|number| number?.extract()).collect()
    };
    let (strokes, delta_cd) = (column(0)?, column(1)?);
    if measured.len()? != 2 || strokes.len() != delta_cd.len() {
        let message = "measured must be the path of a table, or (strokes, ΔCD) of the same length, in mm";
        return Err(PyValueError::new_err(message));
    }
    let rows = strokes.iter().zip(&delta_cd).map(|(stroke, delta_cd)| format!("{stroke},{delta_cd}\n"));
    Ok(std::iter::once("stroke,delta_cd\n".to_owned()).chain(rows).collect())
}

/// A range of strokes as arguments of a command.
fn stroke(from_mm: Option<f64>, to_mm: Option<f64>) -> Vec<String> {
    let from = from_mm.map(|from_mm| format!("--from={from_mm}"));
    from.into_iter().chain(to_mm.map(|to_mm| format!("--to={to_mm}"))).collect()
}

#[pymethods]
impl Spec {
    /// A spec from its text. Messages call it `name`; paths of tables in it are relative to the folder of `name`.
    #[classmethod]
    #[pyo3(signature = (text, name = "spec.toml"))]
    fn from_toml(class: &Bound<'_, PyType>, text: String, name: &str) -> PyResult<Self> {
        Self::checked(class.py(), HeldSpec { name: name.to_owned(), text }, Vec::new())
    }

    /// A spec from a file.
    #[classmethod]
    fn from_file(class: &Bound<'_, PyType>, path: std::path::PathBuf) -> PyResult<Self> {
        let text = std::fs::read_to_string(&path)
            .map_err(|error| PyOSError::new_err(format!("cannot read {}: {error}", path.display())))?;
        Self::checked(class.py(), HeldSpec { name: path.display().to_string(), text }, Vec::new())
    }

    /// The same spec with a key set, in place of that of the text.
    fn set(&self, py: Python<'_>, key: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let value = if value.is_instance_of::<PyBool>() {
            value.extract::<bool>()?.to_string()
        } else {
            value.str()?.to_string()
        };
        let mut settings = self.settings.clone();
        let before = format!("{key}=");
        settings.retain(|setting| !setting.starts_with(&before));
        settings.push(before + &value);
        Self::checked(py, self.held.clone(), settings)
    }

    /// The TOML text.
    #[getter]
    fn text(&self) -> &str {
        &self.held.text
    }

    /// The name of the spec in messages.
    #[getter]
    fn name(&self) -> &str {
        &self.held.name
    }

    /// ΔCD of each error, combined and judged: `rackmesh eval`.
    #[pyo3(signature = (**options))]
    fn evaluate<'py>(&self, py: Python<'py>, options: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
        self.ask(py, "eval", Vec::new(), options, None)
    }

    /// ΔCD along the stroke by the exact mesh: `rackmesh mesh`. A measured curve is the path of a table, or strokes and ΔCD, mm.
    #[pyo3(signature = (from_mm = None, to_mm = None, *, measured = None, **options))]
    fn mesh<'py>(
        &self,
        py: Python<'py>,
        from_mm: Option<f64>,
        to_mm: Option<f64>,
        measured: Option<&Bound<'py, PyAny>>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut arguments = stroke(from_mm, to_mm);
        let Some(measured) = measured else { return self.ask(py, "mesh", arguments, options, None) };
        if let Ok(path) = measured.extract::<std::path::PathBuf>() {
            arguments.push(format!("--measured={}", path.display()));
            return self.ask(py, "mesh", arguments, options, None);
        }
        let folder = py.import("tempfile")?.call_method0("TemporaryDirectory")?;
        let path = std::path::Path::new(&folder.getattr("name")?.extract::<String>()?).join("measured.csv");
        std::fs::write(&path, trace(measured)?)?;
        arguments.push(format!("--measured={}", path.display()));
        let answer = self.ask(py, "mesh", arguments, options, None);
        folder.call_method0("cleanup")?;
        answer
    }

    /// ΔCD along the stroke with elastic teeth and forces: `rackmesh simulate`.
    #[pyo3(signature = (**options))]
    fn simulate<'py>(&self, py: Python<'py>, options: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
        self.ask(py, "simulate", Vec::new(), options, None)
    }

    /// Random racks, each through the exact mesh: `rackmesh monte-carlo`.
    #[pyo3(signature = (racks = None, from_mm = None, to_mm = None, **options))]
    fn monte_carlo<'py>(
        &self,
        py: Python<'py>,
        racks: Option<u64>,
        from_mm: Option<f64>,
        to_mm: Option<f64>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut arguments = stroke(from_mm, to_mm);
        arguments.extend(racks.map(|racks| format!("--racks={racks}")));
        self.ask(py, "monte-carlo", arguments, options, None)
    }

    /// Tolerances from a limit: `rackmesh budget`.
    #[pyo3(signature = (**options))]
    fn budget<'py>(&self, py: Python<'py>, options: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
        self.ask(py, "budget", Vec::new(), options, None)
    }

    /// The answer of a command about every design: `rackmesh sweep`. `over` has the values of each key, as a list or as a text
    /// such as "18..25:0.5"; `arguments` are those of the command.
    #[pyo3(signature = (over, of = "eval", *, columns = None, arguments = None, **options))]
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        over: &Bound<'py, PyDict>,
        of: &str,
        columns: Option<Vec<String>>,
        arguments: Option<Vec<String>>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut own = vec![format!("--of={of}")];
        own.extend(columns.map(|columns| format!("--columns={}", columns.join(","))));
        for (key, values) in over {
            let values = match values.is_instance_of::<PyString>() {
                true => values.extract::<String>()?,
                false => {
                    let each = values.try_iter()?.map(|value| Ok(value?.str()?.to_string()));
                    each.collect::<PyResult<Vec<_>>>()?.join(",")
                }
            };
            own.push(format!("--over={key}={values}"));
        }
        self.ask(py, "sweep", own, options, arguments)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let spec = slf.get();
        let again = slf.py().import("rackmesh._types")?.getattr("spec_again")?;
        let arguments = (spec.held.text.clone(), spec.held.name.clone(), spec.settings.clone());
        Ok((again, arguments).into_pyobject(slf.py())?.into_any())
    }

    /// A pickled spec from its parts.
    #[classmethod]
    fn _again(class: &Bound<'_, PyType>, text: String, name: String, settings: Vec<String>) -> PyResult<Self> {
        Self::checked(class.py(), HeldSpec { name, text }, settings)
    }

    fn __repr__(&self) -> String {
        let set: String = self.settings.iter().map(|setting| format!(", {setting}")).collect();
        format!("<rackmesh.Spec {}{set}>", self.held.name)
    }
}

/// JSON as Python's own types.
fn as_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(flag) => flag.into_pyobject(py)?.to_owned().into_any(),
        Value::Number(number) => match (number.as_i64(), number.as_u64(), number.as_f64()) {
            (Some(whole), ..) => whole.into_pyobject(py)?.into_any(),
            (None, Some(whole), _) => whole.into_pyobject(py)?.into_any(),
            (.., number) => number.unwrap_or(f64::NAN).into_pyobject(py)?.into_any(),
        },
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Array(values) => {
            let values: Vec<_> = values.iter().map(|value| as_python(py, value)).collect::<PyResult<_>>()?;
            PyList::new(py, values)?.into_any()
        }
        Value::Object(entries) => {
            let all = PyDict::new(py);
            for (key, value) in entries {
                all.set_item(key, as_python(py, value)?)?;
            }
            all.into_any()
        }
    })
}
