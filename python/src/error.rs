//! Diagnostics as exceptions. Called wherever the library refuses an input.

use pyo3::prelude::*;
use pyo3::types::PyList;
use rackmesh::diagnostic::{Diagnostic, Diagnostics};

/// The exception `rackmesh.RackmeshError` for these diagnostics.
pub(crate) fn raised(py: Python<'_>, diagnostics: &Diagnostics) -> PyErr {
    let raised = || {
        let all: Vec<_> = diagnostics.0.iter().map(|one| diagnostic(py, one)).collect::<PyResult<_>>()?;
        py.import("rackmesh._types")?.getattr("RackmeshError")?.call1((PyList::new(py, all)?,))
    };
    match raised() {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// A diagnostic as a `rackmesh.Diagnostic`.
pub(crate) fn diagnostic<'py>(py: Python<'py>, diagnostic: &Diagnostic) -> PyResult<Bound<'py, PyAny>> {
    let types = py.import("rackmesh._types")?;
    let place = diagnostic.place.as_ref().map(|place| {
        let (line, column) = place.line_and_column();
        types.getattr("Place")?.call1((&place.source.name, line, column))
    });
    let (code, message, help) = (diagnostic.code.name(), diagnostic.message_with_list(), diagnostic.help.as_deref());
    types.getattr("Diagnostic")?.call1((code, message, place.transpose()?, help))
}
