//! The files that belong to a spec, and why its mesh has no solution. Shared by the subcommands that solve one.

use std::path::{Path, PathBuf};

use super::output::{Failure, Output};
use super::tables;
use super::target::is_dash;
use crate::deviation::Part;
use crate::diagnostic::{Code, Diagnostic};
use crate::mesh::MeshError;
use crate::spec::{Located, MeasuredTables, Spec, keys};
use crate::table::{self, Source, TeethTable};

/// Why there is no solution.
impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Diagnostic::from(error).into()
    }
}

/// The path of a table that a spec names, relative to the spec's own folder.
fn table_path(spec_path: &Path, name: &str) -> PathBuf {
    spec_path.parent().unwrap_or(Path::new("")).join(name)
}

/// The files that are read for a spec: itself and the tables that it names.
pub(super) fn files_read(spec: &Spec, spec_path: &Path) -> Vec<PathBuf> {
    let tables = [keys::RACK_MEASURED, keys::PINION_MEASURED].into_iter().filter_map(|key| spec.get(key));
    let paths = tables.map(|table| table_path(spec_path, &table));
    std::iter::once(spec_path.to_owned()).chain(paths).collect()
}

/// Every file that is read for a spec and tables of parts.
pub(super) fn inputs(spec: &Spec, spec_path: &Path, tables: &[PathBuf]) -> Vec<PathBuf> {
    let tables = tables.iter().flat_map(|table| tables::files_read(table));
    files_read(spec, spec_path).into_iter().chain(tables).collect()
}

/// Refuses tables from standard input where the spec comes from there.
pub(super) fn refuse_shared_input(spec_path: &Path, tables: &[PathBuf]) -> Result<(), Diagnostic> {
    if is_dash(spec_path) && tables.iter().any(is_dash) {
        return Err(Diagnostic::usage("the spec and the table cannot both come from standard input"));
    }
    Ok(())
}

/// Reads the tables that a spec names, with how they were read.
pub(super) fn measured_tables(spec: &Spec, spec_path: &Path, output: &mut Output) -> Result<MeasuredTables, Failure> {
    let read = |file: &Located<String>| -> Result<TeethTable, Failure> {
        let path = table_path(spec_path, &file.value);
        let opened = std::fs::File::open(&path).map_err(|error| {
            Diagnostic::unreadable(&path.display().to_string(), &error)
                .at(&spec.source, file.span.clone(), "")
                .help("paths are relative to the spec")
        })?;
        Ok(table::of_one_part(&path.display().to_string(), Source::File(opened), &spec.want())?)
    };
    let mut tables = MeasuredTables::default();
    for (key, part, what) in [
        (keys::RACK_MEASURED, Part::Rack, "spaces of a rack"),
        (keys::PINION_MEASURED, Part::Pinion, "teeth of a pinion"),
    ] {
        let Some(file) = spec.values.located(key) else { continue };
        let TeethTable { teeth, reading } = read(&file)?;
        if teeth.part() != part {
            let message = format!("{} holds no {what}", file.value);
            return Err(Diagnostic::error(Code::BadTable, message).at(&spec.source, file.span, "").into());
        }
        tables = tables.with(teeth);
        if output.keep_reading(&reading) {
            tables::say(&[reading], &[], output);
        }
    }
    Ok(tables)
}
