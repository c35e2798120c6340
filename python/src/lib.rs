//! rackmesh for Python: specs and their answers, and tables of parts as Arrow data.
//!
//! Each answer is that of a command; each table is judged by the batch of the library. This crate computes nothing.

mod arrow;
mod error;
mod plan;
mod spec;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line with these arguments, the first of which is its name; returns the exit status.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| rackmesh::cli::run_with(arguments))
}

#[pymodule]
fn _rackmesh(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(spec::compare, module)?)?;
    module.add_class::<spec::Spec>()?;
    module.add_class::<plan::Plan>()
}
